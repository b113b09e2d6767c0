"""Checks that the packages of the extra `train` are installed, before a command does any work."""

from __future__ import annotations

import importlib.util

from sim.core.interface import ConfigError


def require_packages(*names: str) -> None:
    """Raises ConfigError if one of these packages is not installed."""
    for name in names:
        if importlib.util.find_spec(name) is None:
            raise ConfigError(f"This command needs the package {name}: pip install 'stubborn-objectnav[train]'.")
