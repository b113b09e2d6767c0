"""Moved for one release: `stubborn traps`."""

import sys

print("tools/make_traps.py is now: stubborn traps", file=sys.stderr)
sys.exit(2)
