"""Writes the client file for agents in a process of their own, which users copy next to their agent.

stubborn agent-client --out stubborn_client.py
stubborn agent-client > stubborn_client.py          # does the same
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

from sim import cli
from sim.bridges import stubborn_client
from sim.files import write_atomically


@dataclass(frozen=True, kw_only=True)
class Args:
    """Write the client file for agents that run with --agent process:COMMAND; it needs Python 3.6 and NumPy."""

    out: cli.OutFile | None = None
    """The file to write; by default its content is printed."""


def main(args: Args) -> int:
    """Writes the file."""
    content = Path(stubborn_client.__file__).read_text(encoding="utf-8")
    if args.out is None:
        sys.stdout.write(content)
    else:
        write_atomically(args.out, content)
    return 0
