"""Command lines from dataclasses, with one clear line and exit status 2 where a value will not do."""

from __future__ import annotations

import contextlib
import io
import re
import sys
from collections.abc import Callable, Sequence
from typing import TypeVar

import tyro

from sim.errors import ConfigError, EpisodeError, HouseError, RenderError, WorkersError

ArgsT = TypeVar("ArgsT")
USAGE_ERRORS = (ConfigError, EpisodeError, HouseError, RenderError, WorkersError)
"""What a user can mend: told in one line, without a traceback."""


def run(args_type: type[ArgsT], main: Callable[[ArgsT], int], argv: Sequence[str] | None = None) -> int:
    """Parse the command line into `args_type`, call `main` and return its exit status; 2 for what a user can mend."""
    try:
        return main(parse(args_type, argv))
    except USAGE_ERRORS as error:
        print(f"error: {' '.join(str(error).split())}", file=sys.stderr)
        return 2


def parse(args_type: type[ArgsT], argv: Sequence[str] | None = None) -> ArgsT:
    """The command line as an `args_type`.

    Raises:
        ConfigError: an option that does not exist or cannot be read.
        SystemExit: status 0 after `--help`.
    """
    complaints = io.StringIO()
    try:
        with contextlib.redirect_stderr(complaints):
            return tyro.cli(args_type, args=argv, config=(tyro.conf.FlagCreatePairsOff,))
    except SystemExit as stop:
        if stop.code in (0, None):
            raise
        raise ConfigError(_first_sentences(complaints.getvalue())) from None


def _first_sentences(box: str) -> str:
    """The message out of the frame that tyro draws around it."""
    lines = [re.sub(r"^\W*│|│\W*$", "", line).strip() for line in box.splitlines()]
    body = [
        line for line in lines if line and not line.startswith(("╭", "╰", "For full helptext", "Argument helptext"))
    ]
    rule = next((i for i, line in enumerate(body) if set(line) <= {"─"}), len(body))
    return " ".join(body[:rule]) or "The command line could not be read. Try --help."
