"""Moved for one release: `stubborn traps report`."""

import sys

print("tools/trap_report.py is now: stubborn traps report", file=sys.stderr)
sys.exit(2)
