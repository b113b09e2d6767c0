"""Moved for one release: `stubborn houses generate`."""

import sys

print("tools/generate_houses.py is now: stubborn houses generate", file=sys.stderr)
sys.exit(2)
