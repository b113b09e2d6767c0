"""Old names of modules and objects: they work for one release and warn, then they are removed."""

from __future__ import annotations

import importlib
import warnings
from collections.abc import Callable, Mapping

REMOVED_IN = "0.4.0"
"""The version that removes the names which 0.3.0 moved."""


def moved_module(old: str, new: str) -> Callable[[str], object]:
    """Returns a module's `__getattr__` that takes each name from the module's new place.

    Args:
        old: the module's earlier name, for example `sim.errors`.
        new: the module that has its names now.
    """

    def get(name: str) -> object:
        if name.startswith("__"):  # the import system asks for `__path__` and others
            raise AttributeError(f"module {old!r} has no attribute {name!r}")
        package = importlib.import_module(new)
        try:
            value = getattr(package, name) if hasattr(package, name) else importlib.import_module(f"{new}.{name}")
        except ModuleNotFoundError:
            raise AttributeError(f"module {old!r} has no attribute {name!r}") from None
        _warn(f"'{old}' is now '{new}'")
        return value

    return get


def moved_names(module: str, places: Mapping[str, str], otherwise: Callable[[str], object]) -> Callable[[str], object]:
    """Returns a package's `__getattr__` that takes some names from another module.

    Args:
        module: the package.
        places: the module that has each moved name now.
        otherwise: returns every other name.
    """

    def get(name: str) -> object:
        if name not in places:
            return otherwise(name)
        value = getattr(importlib.import_module(places[name]), name)
        _warn(f"'{module}.{name}' is now '{places[name]}.{name}'")
        return value

    return get


def _warn(what: str) -> None:
    """Warns at the line that used an old name."""
    warnings.warn(f"{what}; the old name is removed in {REMOVED_IN}.", DeprecationWarning, stacklevel=3)
