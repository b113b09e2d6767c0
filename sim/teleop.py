"""Deprecated: names the command that replaces the terminal in which one drove the robot."""

import sys

from sim.core.invocation import command

if __name__ == "__main__":
    print(f"error: A person drives in the browser now: `{command('web')}`.", file=sys.stderr)
    sys.exit(2)
