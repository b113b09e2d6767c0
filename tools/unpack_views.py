"""Moved for one release: `stubborn views unpack`."""

import sys

print("tools/unpack_views.py is now: stubborn views unpack", file=sys.stderr)
sys.exit(2)
