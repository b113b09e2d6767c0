"""Columns and railings.

Sizes follow Neufert, Architects' Data: railings 0.90-1.10 m high, balusters at most 0.12 m apart.
"""

from __future__ import annotations

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, centred
from sim.homes.housegen.furniture.workbench import Workbench


def baluster_railing(w: Workbench) -> None:
    """Builds a railing along y with a hand rail on posts and balusters."""
    width, high, wood, white = w.width(1.0, 2.4), w.length(0.90, 1.05), w.look("wood"), w.look("lacquer")
    w.box((-0.03, 0.03), centred(width), (high - 0.05, high), wood)
    w.box((-0.02, 0.02), centred(width), (0.06, 0.10), white)
    for c in centred(width, 0.04):
        w.box((-0.045, 0.045), around(c, 0.045), (0.0, high + 0.06), wood)
    count = max(3, round(width / 0.14))
    for i in range(1, count):
        w.cylinder((0.0, -0.5 * width + i * width / count), (0.09, high - 0.04), 0.013, white)


def glass_railing(w: Workbench) -> None:
    """Builds a railing with a glass pane under a metal rail."""
    width, high, metal = w.width(1.0, 2.4), w.length(0.95, 1.10), w.look("chrome")
    w.rod_y((0.0, high - 0.022), centred(width), 0.022, metal)
    w.box((-0.006, 0.006), centred(width, 0.03), (0.05, high - 0.03), w.look("glass"))
    for c in centred(width, 0.02):
        w.box((-0.02, 0.02), around(c, 0.02), (0.0, high - 0.02), metal)
    w.box((-0.03, 0.03), centred(width), (0.0, 0.06), metal)


def round_column(w: Workbench) -> None:
    """Builds a round pillar with a base and a capital; hint `height_m` is the height of the room."""
    high, r, look = w.height(2.5, 2.7), w.length(0.12, 0.17), w.look("lacquer")
    w.cylinder((0.0, 0.0), (0.0, high), r, look)
    for z in ((0.0, 0.12), (high - 0.12, high)):
        w.box((-r - 0.04, r + 0.04), (-r - 0.04, r + 0.04), z, look)


def brick_pier(w: Workbench) -> None:
    """Builds a square masonry pier with a stone foot."""
    high, half = w.height(2.5, 2.7), 0.5 * w.length(0.28, 0.38)
    w.box((-half, half), (-half, half), (0.0, high), w.look("masonry"))
    w.box((-half - 0.02, half + 0.02), (-half - 0.02, half + 0.02), (0.0, 0.10), w.look("stone"))


def square_column(w: Workbench) -> None:
    """Builds a timber post with braces under a bolster."""
    high, half, wood = w.height(2.5, 2.7), 0.5 * w.length(0.15, 0.22), w.look("wood")
    w.box((-half, half), (-half, half), (0.0, high), wood)
    w.box((-half, half), (-0.45, 0.45), (high - 0.14, high), wood)
    for side in BOTH_SIDES:
        w.bar((0.0, side * half, high - 0.55), (0.0, side * 0.40, high - 0.12), 0.10, 0.10, wood)


def steel_cable_railing(w: Workbench) -> None:
    """Builds a railing of posts with five cables under a rail."""
    width, high, metal = w.width(1.0, 2.4), w.length(0.92, 1.05), w.look("metal")
    w.box((-0.03, 0.03), centred(width), (high - 0.03, high), w.look("wood"))
    posts = max(2, round(width / 1.0) + 1)
    for i in range(posts):
        c = -0.5 * width + 0.02 + i * (width - 0.04) / (posts - 1)
        w.box((-0.02, 0.02), around(c, 0.02), (0.0, high - 0.02), metal)
    for i in range(5):
        z = 0.12 + i * (high - 0.24) / 4
        w.rod_y((0.0, z), centred(width, 0.01), 0.005, metal)


STYLES = (
    Style("column", "round", "train", round_column),
    Style("railing", "balusters", "train", baluster_railing),
    Style("railing", "glass", "heldout", glass_railing),
    Style("column", "brick_pier", "train", brick_pier),
    Style("column", "square", "heldout", square_column),
    Style("railing", "cables", "train", steel_cable_railing),
)
