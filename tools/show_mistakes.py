"""Moved for one release: `stubborn evaluate mistakes`."""

import sys

print("tools/show_mistakes.py is now: stubborn evaluate mistakes", file=sys.stderr)
sys.exit(2)
