"""Moved for one release: `stubborn train segmentation`."""

import sys

print("tools/train_rednet.py is now: stubborn train segmentation", file=sys.stderr)
sys.exit(2)
