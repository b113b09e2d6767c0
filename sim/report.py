"""`python -m sim.report` is the same as `stubborn report`."""

import sys

from sim.app import cli
from sim.app.commands.report import Args, main

if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
