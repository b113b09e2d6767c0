"""Moved for one release: `stubborn gallery`."""

import sys

print("tools/gallery.py is now: stubborn gallery", file=sys.stderr)
sys.exit(2)
