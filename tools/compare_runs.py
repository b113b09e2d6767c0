"""Moved for one release: `stubborn compare`."""

import sys

print("tools/compare_runs.py is now: stubborn compare", file=sys.stderr)
sys.exit(2)
