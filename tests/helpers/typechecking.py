"""Runtime checks of array annotations, under pytest only: dtypes and shapes by jaxtyping and beartype.

pyright checks all other annotations.
"""

from __future__ import annotations

import typing
from collections.abc import Callable
from typing import Any, TypeVar

import beartype
from jaxtyping import AbstractArray, install_import_hook

CHECKED = (
    "sim.core.geometry.convex",
    "sim.core.geometry.fast_marching",
    "sim.core.geometry.grid",
    "stubborn.exploration",
    "stubborn.mapping",
    "stubborn.planning",
    "stubborn.segmentation",
    "stubborn.detection",
)
"""Modules and packages that are checked. Kernels are not: numba compiles their functions."""

FunctionT = TypeVar("FunctionT", bound=Callable[..., Any])


def install() -> None:
    """Checks all modules of `CHECKED` that are imported from now on."""
    install_import_hook(CHECKED, f"{__name__}.check_arrays")


def check_arrays(function: FunctionT) -> FunctionT:
    """Returns a function that checks those of its arguments and results whose annotation holds an array type."""
    hints = function.__annotations__
    function.__annotations__ = {name: hint if _holds_array(hint) else Any for name, hint in hints.items()}
    return beartype.beartype(function)


def _holds_array(hint: Any) -> bool:
    """Returns True for an array type of jaxtyping, and for a union, a tuple or another generic type of such."""
    if isinstance(hint, type) and issubclass(hint, AbstractArray):
        return True
    return any(_holds_array(argument) for argument in typing.get_args(hint))
