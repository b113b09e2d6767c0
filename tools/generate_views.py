"""Moved for one release: `stubborn views`."""

import sys

print("tools/generate_views.py is now: stubborn views", file=sys.stderr)
sys.exit(2)
