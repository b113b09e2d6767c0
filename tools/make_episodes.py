"""Moved for one release: `stubborn episodes`."""

import sys

print("tools/make_episodes.py is now: stubborn episodes", file=sys.stderr)
sys.exit(2)
