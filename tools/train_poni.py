"""Moved for one release: `stubborn train poni`."""

import sys

print("tools/train_poni.py is now: stubborn train poni", file=sys.stderr)
sys.exit(2)
