"""Moved for one release: `stubborn train cloned`."""

import sys

print("tools/train_cloned.py is now: stubborn train cloned", file=sys.stderr)
sys.exit(2)
