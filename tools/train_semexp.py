"""Moved for one release: `stubborn train semexp`."""

import sys

print("tools/train_semexp.py is now: stubborn train semexp", file=sys.stderr)
sys.exit(2)
