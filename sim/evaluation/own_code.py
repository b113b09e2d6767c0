"""Finds the line of a user's code in which an error was raised, for messages of one line."""

from __future__ import annotations

import sysconfig
import traceback
from pathlib import Path

_OURS = tuple(Path(__file__).resolve().parents[2] / name for name in ("sim", "stubborn"))
_LIBRARIES = tuple(Path(sysconfig.get_path(name)).resolve() for name in ("stdlib", "platstdlib", "purelib", "platlib"))


def place_of(error: BaseException, *, below: str) -> str:
    """Returns " (mine/agent.py, line 12)": the innermost line of the code that raised an error.

    Code of the user counts before that of this project, and that before libraries: where a network of the user is fed
    an array of a wrong shape, the line of the call is named and not one inside of PyTorch.

    Args:
        error: it has been raised.
        below: file of the function that called the code; its own frames do not count.

    Returns:
        The place in brackets after a blank; "" where there is no frame.
    """
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename != below]
    for tier in (_is_users, _is_not_library, lambda file: True):
        for frame in reversed(frames):
            if tier(Path(frame.filename)):
                return f" ({_short(Path(frame.filename))}, line {frame.lineno})"
    return ""


def _is_users(file: Path) -> bool:
    return _is_not_library(file) and not any(file.resolve().is_relative_to(folder) for folder in _OURS)


def _is_not_library(file: Path) -> bool:
    if str(file).startswith("<"):  # <frozen importlib._bootstrap>
        return False
    return not any(file.resolve().is_relative_to(folder) for folder in _LIBRARIES)


def _short(file: Path) -> str:
    """Returns a path relative to the current folder where the file is below it, else its last two names."""
    try:
        return str(file.resolve().relative_to(Path.cwd().resolve()))
    except ValueError:
        return str(Path(*file.parts[-2:]))
