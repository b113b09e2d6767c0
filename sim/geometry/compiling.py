"""Defers the import of numba to the first call of a kernel; it takes longer than NumPy and OpenCV together.

`--list-agents` imports the agents with their kernels, but does not call a kernel.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any


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
            import numba

            self._compiled = numba.njit(**self._options)(self._function)
            names = self._function.__globals__
            names |= {name: value.compiled() for name, value in names.items() if isinstance(value, Kernel)}
        assert self._compiled is not None
        return self._compiled


def must_compile() -> bool:
    """Returns True if numba's cache is empty: compiling all kernels, at their first calls, takes up to a minute."""
    folder = Path(os.environ.get("NUMBA_CACHE_DIR") or Path(__file__).with_name("__pycache__"))
    return not any(folder.rglob("*.nbi"))


def njit(**options: Any) -> Callable[[Callable[..., Any]], Kernel]:
    """Returns a decorator for a function that numba is to compile, with the options of `numba.njit`."""
    return lambda function: Kernel(function, options)
