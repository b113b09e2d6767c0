"""A stand-in for the package `habitat`, for agents in a Python without it: it has the few names that agents import.

`install` makes `import habitat` work in this process if the package is not installed. The import of a name that the
stand-in does not have fails as usual, and `lacking` returns a sentence that names it. `sim.app.bridges.habitat_client`
lists the names, and provides them to agents in a process of their own.
"""

from __future__ import annotations

import importlib
import importlib.util
import logging
import re
import sys

from sim.app.bridges.habitat.config import get_config
from sim.app.bridges.habitat.conversions import Observations
from sim.app.bridges.habitat_client import HABITAT_MODULES, NOT_IN_THE_STAND_IN, EmptyModules, StandIn, stand_ins

NOTE = "Habitat is not installed: a stand-in of this project provides those of its names that are imported."
"""The sentence that a run prints if it uses the stand-in."""
_LOG = logging.getLogger("habitat")
_FINDER = StandIn(stand_ins(get_config=get_config, Observations=Observations))
_EMPTY = EmptyModules()


def install() -> bool:
    """Provides the stand-in in this process if Habitat is not installed; returns whether this process has it.

    Packages that are not installed and that agents import without using them (`EMPTY_PACKAGES`) become empty modules;
    Habitat's logger says so.
    """
    if _EMPTY not in sys.meta_path:
        sys.meta_path.append(_EMPTY)
    if not installed() and not _is_there():
        _LOG.addHandler(logging.StreamHandler())  # Habitat's logger prints to standard error
        _LOG.setLevel(logging.INFO)
        sys.meta_path.insert(0, _FINDER)  # first: a folder of this name is a namespace package to the other finders
        importlib.import_module("habitat")
    return installed()


def installed() -> bool:
    """Returns whether this process has the stand-in."""
    return _FINDER in sys.meta_path


def remove() -> None:
    """Removes the stand-in and the empty modules from this process."""
    if _EMPTY in sys.meta_path:
        sys.meta_path.remove(_EMPTY)
    empty = {name for name in sys.modules if name.split(".")[0] in _EMPTY.imported}
    _EMPTY.imported.clear()
    if installed():
        sys.meta_path.remove(_FINDER)
        _LOG.handlers.clear()
        _LOG.setLevel(logging.NOTSET)
        empty |= set(HABITAT_MODULES)
    for name in empty:
        sys.modules.pop(name, None)


def lacking(error: BaseException) -> str | None:
    """Returns a sentence that names what the stand-in lacks if an import failed for this reason; else None."""
    if not installed() or not isinstance(error, ImportError) or (error.name or "").partition(".")[0] != "habitat":
        return None
    match = re.match(r"cannot import name '(\w+)'", str(error))
    return f"'{error.name}{f'.{match[1]}' if match else ''}' {NOT_IN_THE_STAND_IN}."


def _is_there() -> bool:
    """Returns whether a package `habitat` can be imported; a folder without `__init__.py` does not count."""
    if "habitat" in sys.modules:
        return True
    spec = importlib.util.find_spec("habitat")
    return spec is not None and spec.origin is not None
