"""Mirrors.

Usual retail dimensions: wall mirrors 0.45-0.80 m wide, full-length ones 1.50-1.80 m high.
"""

from __future__ import annotations

import math

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, centred
from sim.homes.housegen.furniture.pictures import frame
from sim.homes.housegen.furniture.workbench import Workbench


def wall_mirror(w: Workbench) -> None:
    """Builds a framed rectangular mirror."""
    width, height = w.width(0.45, 0.80), w.height(0.60, 1.00)
    w.mount_height_m = 1.05
    frame(w, width, height, 0.025, 0.028, w.look("metal"))
    w.box((0.0, 0.014), centred(width, 0.02), (0.02, height - 0.02), w.look("mirror"), solid=False)


def round_mirror(w: Workbench) -> None:
    """Builds a round mirror in a thin rim."""
    r = 0.5 * w.width(0.50, 0.80)
    w.mount_height_m = 1.52 - r
    w.rod_x((0.0, r), (0.0, 0.022), r, w.look("brass"))
    w.rod_x((0.0, r), (0.0, 0.025), r - 0.02, w.look("mirror"), solid=False)


def standing_mirror(w: Workbench) -> None:
    """Builds a full-length mirror that leans on a stand."""
    width, height, wood = w.width(0.42, 0.60), w.height(1.50, 1.75), w.look("wood")
    y = 0.5 * width
    lean = 0.12
    for side in BOTH_SIDES:
        w.bar((0.14, side * (y - 0.02), 0.0), (0.14 - lean, side * (y - 0.02), height), 0.04, 0.03, wood)
    for z in (0.12, height - 0.03):
        x = 0.14 - lean * z / height
        w.box(around(x, 0.015), (-y, y), around(z, 0.025), wood)
    w.bar((0.137, 0.0, 0.12), (0.143 - lean, 0.0, height - 0.04), 2 * y - 0.06, 0.012, w.look("mirror"))
    w.bar((-0.22, 0.0, 0.0), (0.04, 0.0, 0.72 * height), 0.05, 0.02, wood)
    w.box((0.04, 0.07), (-y + 0.02, y - 0.02), (0.70 * height, 0.73 * height), wood)


def arched_mirror(w: Workbench) -> None:
    """Builds a full-length mirror with a round top that leans on the wall."""
    width, height = w.width(0.50, 0.70), w.height(1.50, 1.80)
    r, metal = 0.5 * width, w.look("metal")
    straight = height - r
    w.box((0.0, 0.03), (-r, r), (0.0, straight), metal)
    w.rod_x((0.0, straight), (0.0, 0.03), r, metal)
    w.box((0.02, 0.034), (-r + 0.02, r - 0.02), (0.02, straight), w.look("mirror"), solid=False)
    w.rod_x((0.0, straight), (0.02, 0.034), r - 0.02, w.look("mirror"), solid=False)


def mirror_sunburst(w: Workbench) -> None:
    """Builds a round mirror in a ring with rays."""
    r, brass = 0.5 * w.width(0.55, 0.80), w.look("brass")
    inner = 0.62 * r
    w.mount_height_m = 1.25
    w.rod_x((0.0, r), (0.0, 0.02), inner, w.look("mirror"))
    for n in range(12):
        a = math.tau * n / 12
        tip = (0.012, r * math.sin(a), r + r * math.cos(a))
        foot = (0.012, 0.96 * inner * math.sin(a), r + 0.96 * inner * math.cos(a))
        w.rod(foot, tip, 0.011, brass, solid=False)


STYLES = (
    Style("mirror", "mirror_sunburst", "heldout", mirror_sunburst, ("wall",), "wall"),
    Style("mirror", "rectangular", "train", wall_mirror, ("wall",), "wall"),
    Style("mirror", "round", "heldout", round_mirror, ("wall",), "wall"),
    Style("mirror", "standing", "train", standing_mirror, ("standing",)),
    Style("mirror", "arched", "heldout", arched_mirror, ("standing",), "wall"),
)
