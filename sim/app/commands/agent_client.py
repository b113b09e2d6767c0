"""Writes the client file for agents in a process of their own, which users copy next to their agent.

stubborn agent-client --out stubborn_client.py
stubborn agent-client > stubborn_client.py          # does the same
"""

from __future__ import annotations

import inspect
import re
import sys
from dataclasses import dataclass

from sim.app import cli
from sim.app.bridges import habitat_client, stubborn_client
from sim.core.files import write_atomically

IMPORT = re.compile(r"^from sim\.app\.bridges\.stubborn_client import .*\n", re.MULTILINE)
"""The line of `habitat_client` that one file does not need."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Write the client file for agents that run with --agent process:COMMAND; it needs Python 3.6 and NumPy."""

    out: cli.OutFile | None = None
    """The file to write; by default its content is printed."""


def main(args: Args) -> int:
    """Writes the file."""
    content = client_file()
    if args.out is None:
        sys.stdout.write(content)
    else:
        write_atomically(args.out, content)
    return 0


def client_file() -> str:
    """Returns the content of the file: the module `stubborn_client`, and `habitat_client` without its import of it."""
    protocol, habitat = inspect.getsource(stubborn_client), inspect.getsource(habitat_client)
    return f"{protocol}\n\n{IMPORT.sub('', habitat)}"
