"""Prints the client file for agents in a process of their own, which users copy next to their agent.

stubborn agent-client > stubborn_client.py
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

from sim.bridges import stubborn_client


@dataclass(frozen=True, kw_only=True)
class Args:
    """Print the client file for agents that run with --agent process:COMMAND; it needs Python 3.6 and NumPy."""


def main(args: Args) -> int:
    """Prints the file."""
    sys.stdout.write(Path(stubborn_client.__file__).read_text(encoding="utf-8"))
    return 0
