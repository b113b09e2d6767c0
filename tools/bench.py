"""Moved for one release: `stubborn bench`."""

import sys

print("tools/bench.py is now: stubborn bench", file=sys.stderr)
sys.exit(2)
