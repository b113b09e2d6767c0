"""Figures of matplotlib that are drawn to files, without a display."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sim.core.errors import ConfigError

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def empty_figure(width_in: float, height_in: float, *, what: str) -> Figure:
    """Returns an empty figure; its size is in inches.

    Args:
        width_in: width.
        height_in: height.
        what: what is drawn, in the plural, for the error message.

    Raises:
        ConfigError: matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise ConfigError(f"{what} need matplotlib: pip install 'stubborn-objectnav[train]'.") from None
    return Figure(figsize=(width_in, height_in), layout="constrained")
