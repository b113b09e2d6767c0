"""Command lines from dataclasses; a user's error is one line on stderr and exit status 2."""

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
"""Errors that the user can correct; they are printed in one line, without a traceback."""


def run(args_type: type[ArgsT], main: Callable[[ArgsT], int], argv: Sequence[str] | None = None) -> int:
    """Parses the command line into `args_type` and returns the exit status of `main`; 2 after a `USAGE_ERRORS`."""
    try:
        return main(parse(args_type, argv))
    except USAGE_ERRORS as error:
        print(f"error: {' '.join(str(error).split())}", file=sys.stderr)
        return 2


def parse(args_type: type[ArgsT], argv: Sequence[str] | None = None) -> ArgsT:
    """Returns the command line as an `args_type`.

    Raises:
        ConfigError: an option does not exist or its value cannot be read.
        SystemExit: status 0 after `--help`.
    """
    messages = io.StringIO()
    try:
        with contextlib.redirect_stderr(messages):
            return tyro.cli(args_type, args=argv, config=(tyro.conf.FlagCreatePairsOff,))
    except SystemExit as stop:
        if stop.code in (0, None):
            raise
        raise ConfigError(_message_in_box(messages.getvalue())) from None


def _message_in_box(box: str) -> str:
    """Returns the message inside the frame that tyro prints around it."""
    lines = [re.sub(r"^\W*│|│\W*$", "", line).strip() for line in box.splitlines()]
    body = [
        line for line in lines if line and not line.startswith(("╭", "╰", "For full helptext", "Argument helptext"))
    ]
    rule = next((i for i, line in enumerate(body) if set(line) <= {"─"}), len(body))
    return " ".join(body[:rule]) or "The command line could not be read. Try --help."
