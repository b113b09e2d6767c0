"""Defers the import of numba to the first call of a kernel; it takes longer than NumPy and OpenCV together.

`--list-agents` imports the agents with their kernels, but does not call a kernel.
"""

from __future__ import annotations

import itertools
import os
import stat
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

_VARIABLE = "NUMBA_CACHE_DIR"
_TEMPORARY = "stubborn-numba-"


class Kernel:
    """A function that numba compiles, or loads from its cache, at the first call."""

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]) -> None:
        """`options` are those of `numba.njit`."""
        self.__doc__ = function.__doc__
        self._function = function
        self._options = options
        self._compiled: Callable[..., Any] | None = None

    def __call__(self, *args: Any) -> Any:
        """Returns the result of the compiled function."""
        return (self._compiled or self.compiled())(*args)

    def compiled(self) -> Callable[..., Any]:
        """Returns numba's function. In the kernel's module it also takes the place of all kernels.

        numba compiles calls of other kernels only where it finds its own functions.
        """
        if self._compiled is None:
            folder = choose_cache()
            import numba

            if folder is not None:
                from numba.core import config

                config.CACHE_DIR = str(folder)  # pyright: ignore[reportAttributeAccessIssue]
            self._compiled = numba.njit(**self._options)(self._function)
            names = self._function.__globals__
            names |= {name: value.compiled() for name, value in names.items() if isinstance(value, Kernel)}
        assert self._compiled is not None
        return self._compiled


def must_compile() -> bool:
    """Returns True if no kernel of the simulator, or no kernel of the agent, is compiled yet.

    Compiling all of them, at their first calls, takes up to a minute.
    """
    choose_cache()
    chosen = os.environ.get(_VARIABLE)
    shared = Path(chosen) if chosen else _user_caches() / "numba"
    packages = Path(__file__).resolve().parents[3]
    for folder in (packages / "sim" / "core" / "geometry", packages / "stubborn" / "kernels"):
        # In a cache that several packages share, numba names a folder after that of the code, and a hash of its path.
        kernels = itertools.chain(folder.rglob("*.nbi"), shared.glob(f"{folder.name}_*/*.nbi"))
        if next(kernels, None) is None:
            return True
    return False


def choose_cache() -> Path | None:
    """Returns a temporary folder for numba's compiled code if no other folder can be written; else None.

    numba uses `NUMBA_CACHE_DIR`, the folder of the code or the user's cache folder, and fails if it can write to none
    of them. `NUMBA_CACHE_DIR` is set to the temporary folder, so that workers share it.
    """
    chosen = os.environ.get(_VARIABLE)
    if chosen:
        return Path(chosen) if Path(chosen) == _temporary() else None
    if any(_can_write(folder) for folder in (Path(__file__).with_name("__pycache__"), _user_caches())):
        return None
    folder = _temporary()
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        about = folder.lstat()
        own = stat.S_ISDIR(about.st_mode) and about.st_uid == os.getuid() and not about.st_mode & 0o077
    except OSError:
        own = False
    if not own:  # another user may have made the folder; this process must not run code from it
        folder = Path(tempfile.mkdtemp(prefix=_TEMPORARY))
    os.environ[_VARIABLE] = str(folder)
    return folder


def _user_caches() -> Path:
    return Path(os.environ.get("XDG_CACHE_HOME") or Path(os.path.expanduser("~")) / ".cache")


def _temporary() -> Path:
    return Path(tempfile.gettempdir()) / f"{_TEMPORARY}{os.getuid()}"


def _can_write(folder: Path) -> bool:
    """Returns whether a folder can be written, or created if it does not exist."""
    existing = next(parent for parent in (folder, *folder.parents) if parent.exists())
    return existing.is_dir() and os.access(existing, os.W_OK | os.X_OK)


def njit(**options: Any) -> Callable[[Callable[..., Any]], Kernel]:
    """Returns a decorator for a function that numba is to compile, with the options of `numba.njit`."""
    return lambda function: Kernel(function, options)
