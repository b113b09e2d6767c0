"""Moved for one release: `stubborn houses plans`."""

import sys

print("tools/export_plans.py is now: stubborn houses plans", file=sys.stderr)
sys.exit(2)
