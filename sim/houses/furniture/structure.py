"""Columns and railings.

Ranges after Neufert, Architects' Data: railings 0.90-1.10 m high, balusters at most 0.12 m apart.
"""

from __future__ import annotations

from sim.houses.furniture.catalogue import Style
from sim.houses.furniture.workbench import Workbench

_BOTH = (-1, 1)


def round_column(w: Workbench) -> None:
    """Round pillar with base and capital; hint `height_m` is the room's."""
    high, r, look = w.height(2.5, 2.7), w.length(0.12, 0.17), w.look("lacquer")
    w.cylinder((0.0, 0.0), (0.0, high), r, look)
    for z in ((0.0, 0.12), (high - 0.12, high)):
        w.box((-r - 0.04, r + 0.04), (-r - 0.04, r + 0.04), z, look)


def square_column(w: Workbench) -> None:
    """Square brick or stone pier."""
    high, half = w.height(2.5, 2.7), 0.5 * w.length(0.26, 0.38)
    w.box((-half, half), (-half, half), (0.0, high), w.look("masonry"))


def baluster_railing(w: Workbench) -> None:
    """Hand rail on posts and balusters, along y."""
    width, high, wood, white = w.width(1.0, 2.4), w.length(0.90, 1.05), w.look("wood"), w.look("lacquer")
    w.box((-0.03, 0.03), (-0.5 * width, 0.5 * width), (high - 0.05, high), wood)
    w.box((-0.02, 0.02), (-0.5 * width, 0.5 * width), (0.06, 0.10), white)
    for side in _BOTH:
        c = side * (0.5 * width - 0.04)
        w.box((-0.045, 0.045), (c - 0.045, c + 0.045), (0.0, high + 0.06), wood)
    count = max(3, round(width / 0.14))
    for i in range(1, count):
        w.cylinder((0.0, -0.5 * width + i * width / count), (0.09, high - 0.04), 0.013, white)


def glass_railing(w: Workbench) -> None:
    """Glass pane under a metal rail."""
    width, high, metal = w.width(1.0, 2.4), w.length(0.95, 1.10), w.look("chrome")
    w.rod((0.0, -0.5 * width, high - 0.022), (0.0, 0.5 * width, high - 0.022), 0.022, metal)
    w.box((-0.006, 0.006), (-0.5 * width + 0.03, 0.5 * width - 0.03), (0.05, high - 0.03), w.look("glass"))
    for side in _BOTH:
        c = side * (0.5 * width - 0.02)
        w.box((-0.02, 0.02), (c - 0.02, c + 0.02), (0.0, high - 0.02), metal)
    w.box((-0.03, 0.03), (-0.5 * width, 0.5 * width), (0.0, 0.06), metal)


STYLES = (
    Style("column", "round", "train", round_column),
    Style("column", "square", "heldout", square_column),
    Style("railing", "balusters", "train", baluster_railing),
    Style("railing", "glass", "heldout", glass_railing),
)
