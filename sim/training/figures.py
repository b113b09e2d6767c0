"""Packages of the extra `train`: whether they are installed, and figures of matplotlib without a display."""

from __future__ import annotations

import importlib.util
from typing import TYPE_CHECKING

from sim.core.errors import ConfigError

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def require_packages(*names: str) -> None:
    """Raises ConfigError if one of these packages is not installed."""
    for name in names:
        if importlib.util.find_spec(name) is None:
            raise ConfigError(f"This command needs the package {name}: pip install 'stubborn-objectnav[train]'.")


def empty_figure(width_in: float, height_in: float) -> Figure:
    """Returns an empty figure of this width and height in inches.

    Raises:
        ConfigError: matplotlib is not installed.
    """
    require_packages("matplotlib")
    from matplotlib.figure import Figure

    return Figure(figsize=(width_in, height_in), layout="constrained")
