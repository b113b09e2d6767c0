"""`python -m sim.run` is the same as `stubborn run`."""

import sys

from sim.app.commands.run import entry

if __name__ == "__main__":
    sys.exit(entry())
