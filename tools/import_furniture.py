"""Moved for one release: `stubborn import furniture`."""

import sys

print("tools/import_furniture.py is now: stubborn import furniture", file=sys.stderr)
sys.exit(2)
