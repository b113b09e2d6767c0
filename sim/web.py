"""`python -m sim.web` is the same as `stubborn web`."""

import sys

from sim.app.commands.web import entry

if __name__ == "__main__":
    sys.exit(entry())
