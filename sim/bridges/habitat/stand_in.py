"""A stand-in for the package `habitat`, which cannot be installed from PyPI: it has the few names that agents import.

`install` makes `import habitat` work in this process if the package is not installed. The import of a name that the
stand-in does not have fails as usual, and `lacking` returns a sentence that names it.
"""

from __future__ import annotations

import importlib
import importlib.util
import logging
import re
import sys
from collections.abc import Mapping, Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any

from sim.bridges import habitat as ours

NOTE = "Habitat is not installed: a stand-in of this project provides those of its names that are imported."
"""The sentence that a run prints if it uses the stand-in."""
_ADVICE = "is not part of the stand-in for Habitat, which is not installed here (docs/habitat.md)"
_LOG = logging.getLogger("habitat")
_CONFIG = {"get_config": ours.get_config, "read_write": ours.read_write, "Config": ours.Config}
MODULES: Mapping[str, Mapping[str, Any]] = {
    "habitat": {
        "Agent": ours.Agent,
        "Benchmark": ours.Benchmark,
        "Challenge": ours.Challenge,
        "Config": ours.Config,
        "Env": ours.Env,
        "get_config": ours.get_config,
        "read_write": ours.read_write,
        "logger": _LOG,
    },
    "habitat.config": _CONFIG,
    "habitat.config.default": _CONFIG,
    "habitat.config.read_write": {"read_write": ours.read_write},
    "habitat.core": {},
    "habitat.core.agent": {"Agent": ours.Agent},
    "habitat.core.benchmark": {"Benchmark": ours.Benchmark},
    "habitat.core.challenge": {"Challenge": ours.Challenge},
    "habitat.core.env": {"Env": ours.Env},
    "habitat.core.logging": {"logger": _LOG},
    "habitat.core.simulator": {"Observations": ours.Observations},
    "habitat.sims": {},
    "habitat.sims.habitat_simulator": {},
    "habitat.sims.habitat_simulator.actions": {"HabitatSimActions": ours.HabitatSimActions},
    "habitat.tasks": {},
    "habitat.tasks.nav": {},
    "habitat.tasks.nav.object_nav_task": {
        "ObjectGoal": ours.ObjectGoal,
        "ObjectGoalNavEpisode": ours.ObjectGoalNavEpisode,
    },
}
"""The names of each module of the stand-in."""


def install() -> bool:
    """Provides the stand-in in this process if Habitat is not installed; returns whether this process has it."""
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
    """Removes the stand-in from this process."""
    if installed():
        sys.meta_path.remove(_FINDER)
        _LOG.handlers.clear()
        _LOG.setLevel(logging.NOTSET)
        for name in MODULES:
            sys.modules.pop(name, None)


def lacking(error: BaseException) -> str | None:
    """Returns a sentence that names what the stand-in lacks if an import failed for this reason; else None."""
    if not installed() or not isinstance(error, ImportError) or (error.name or "").partition(".")[0] != "habitat":
        return None
    found = re.match(r"cannot import name '(\w+)'", str(error))
    return f"'{error.name}{f'.{found[1]}' if found else ''}' {_ADVICE}."


class _Finder(MetaPathFinder, Loader):
    """Finds and makes the modules of the stand-in."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Returns the specification of a module of the stand-in."""
        if fullname not in MODULES:
            return None
        is_package = any(name.startswith(f"{fullname}.") for name in MODULES)
        return ModuleSpec(fullname, self, is_package=is_package)

    def exec_module(self, module: ModuleType) -> None:
        """Adds the names to a module; for the package `habitat`, it imports all modules of the stand-in."""

        def missing(name: str) -> Any:
            raise AttributeError(f"'{module.__name__}.{name}' {_ADVICE}")

        vars(module).update(MODULES[module.__name__], __getattr__=missing)
        if module.__name__ == "habitat":
            for name in MODULES:
                importlib.import_module(name)
            for name, names in MODULES.items():
                vars(sys.modules[name]).update(names)  # a function may have the name of a module


_FINDER = _Finder()


def _is_there() -> bool:
    """Returns whether a package `habitat` can be imported; a folder without `__init__.py` does not count."""
    if "habitat" in sys.modules:
        return True
    found = importlib.util.find_spec("habitat")
    return found is not None and found.origin is not None
