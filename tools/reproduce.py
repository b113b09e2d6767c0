"""Moved for one release: `stubborn reproduce`."""

import sys

print("tools/reproduce.py is now: stubborn reproduce", file=sys.stderr)
sys.exit(2)
