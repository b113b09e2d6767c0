"""Errors of this project, one class per kind. A message says what was given and what is allowed."""

from __future__ import annotations

import contextlib
import difflib
import os
from collections.abc import Iterable, Iterator

DEBUG_VARIABLE = "STUBBORN_DEBUG"
"""Environment variable that shows tracebacks; `--debug` sets it, and worker processes inherit it."""


class ObjectNavError(Exception):
    """Base class of all errors that this project raises on purpose."""


class ConfigError(ObjectNavError, ValueError):
    """A value given by the user is not allowed; the message names the value and the allowed ones."""


class HouseError(ObjectNavError, ValueError):
    """A house file is missing, unreadable, or breaks a rule of the house format."""


class EpisodeError(ObjectNavError, ValueError):
    """An episode cannot be set up: an unknown goal, a start inside a wall, no path to the goal."""


class PhysicsError(ObjectNavError, RuntimeError):
    """The simulation reached an unphysical state: NaN, an unstable state, a robot that tipped over."""


class RenderError(ObjectNavError, RuntimeError):
    """OpenGL is not available, or the frame buffer is too small."""


class WorkersError(ObjectNavError, RuntimeError):
    """Workers cannot start, or one item of work makes every worker fail."""


class AgentError(ObjectNavError, RuntimeError):
    """An agent raised an error, or returned a value that is not an action; the message names agent and step."""


def did_you_mean(name: str, names: Iterable[str], similarity: float = 0.6) -> str:
    """Returns " Did you mean 'x'?" if the similarity of one of the names is at least this (1: the same), else ""."""
    similar = difflib.get_close_matches(name, names, n=1, cutoff=similarity)
    return f" Did you mean '{similar[0]}'?" if similar else ""


def debug() -> bool:
    """Returns whether tracebacks are shown."""
    return os.environ.get(DEBUG_VARIABLE, "") not in ("", "0")


@contextlib.contextmanager
def debugging(on: bool) -> Iterator[None]:
    """Shows tracebacks inside of the `with` block, also in worker processes that it starts."""
    before = os.environ.get(DEBUG_VARIABLE)
    if on:
        os.environ[DEBUG_VARIABLE] = "1"
    try:
        yield
    finally:
        if on:
            os.environ.pop(DEBUG_VARIABLE)
            if before is not None:
                os.environ[DEBUG_VARIABLE] = before
