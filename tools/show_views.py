"""Moved for one release: `stubborn views show`."""

import sys

print("tools/show_views.py is now: stubborn views show", file=sys.stderr)
sys.exit(2)
