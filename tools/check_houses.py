"""Moved for one release: `stubborn houses check`."""

import sys

print("tools/check_houses.py is now: stubborn houses check", file=sys.stderr)
sys.exit(2)
