"""A user's own code: the line of it in which an error was raised, and a hash that tells two versions apart."""

from __future__ import annotations

import hashlib
import sys
import sysconfig
import traceback
from collections.abc import Iterable
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


def hash_of_own(modules: Iterable[str]) -> str:
    """Returns 12 hex digits, a hash of modules of a user and of what they import from their own folder.

    Args:
        modules: names of imported modules; those of this project and of libraries do not count.

    Returns:
        The hash; "" where no module is the user's.
    """
    files: dict[str, Path] = {}
    for name in modules:
        file = _file_of(name)
        if file is None or not _is_users(file):
            continue
        beside = (_file_of(other) for other in tuple(sys.modules))
        files |= {str(each.relative_to(file.parent)): each for each in beside if each and _is_below(each, file.parent)}
    digest = hashlib.sha256()
    for place in sorted(files):
        digest.update(place.encode() + files[place].read_bytes())
    return digest.hexdigest()[:12] if files else ""


def _file_of(module: str) -> Path | None:
    """Returns the Python file of an imported module; None where it has none, such as `sys`."""
    file = getattr(sys.modules[module], "__file__", None)
    return Path(file).resolve() if file and str(file).endswith(".py") and Path(file).is_file() else None


def _is_below(file: Path, folder: Path) -> bool:
    return file.is_relative_to(folder) and _is_users(file)


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
