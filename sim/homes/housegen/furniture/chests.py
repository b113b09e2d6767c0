"""Chests of drawers.

Sizes follow Neufert, Architects' Data (0.40-0.50 m deep) and usual retail dimensions (dressers 0.80-1.50 m wide and
0.70-0.95 m high, tallboys to 1.30 m, bedside chests 0.40-0.52 m wide and 0.45-0.62 m high).
"""

from __future__ import annotations

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, centred, inset
from sim.homes.housegen.furniture.workbench import Workbench


def _drawer_column(
    w: Workbench,
    size: tuple[float, float, float],
    foot: float,
    first: float,
    rows: tuple[int, int],
    metal: str,
    handles: tuple[parts.PlainHandleKind, ...],
) -> None:
    """Adds a body with one column of drawers on a plinth.

    Args:
        w: the workbench.
        size: depth, width and height.
        foot: height of the plinth.
        first: height at which the lowest drawer begins.
        rows: smallest and largest number of drawers.
        metal: material of the handles.
        handles: kinds of handles to draw one from.
    """
    depth, width, height = size
    look = parts.wood_look(w)
    x, y = parts.case(w, depth, width, (foot, height), look, foot=foot)
    drawers = inset(y, 0.01), (first, height - 0.025)
    parts.plain_drawers(w, x, *drawers, w.whole(*rows), 1, look, w.look(metal), w.choice(handles))


def dresser(w: Workbench) -> None:
    """Builds a wide chest with three rows of two drawers on short legs."""
    width, depth, height = w.width(0.95, 1.50), w.depth(0.42, 0.50), w.length(0.74, 0.88)
    look, foot = parts.wood_look(w), w.length(0.08, 0.14)
    x, y = parts.case(w, depth, width, (foot, height), look)
    parts.plain_drawers(
        w,
        x,
        inset(y, 0.012),
        (foot + 0.012, height - 0.03),
        3,
        2,
        look,
        w.look("metal"),
        w.choice(("bar", "knob", "cup")),
    )
    w.legs(centred(depth, 0.03), inset(y, 0.03), (0.0, foot), 0.05, w.look("wood"))


def tallboy(w: Workbench) -> None:
    """Builds a tall narrow chest with four to six drawers."""
    width, depth, height = w.width(0.45, 0.65), w.depth(0.40, 0.46), w.length(1.05, 1.30)
    _drawer_column(w, (depth, width, height), 0.05, 0.06, (4, 6), "metal", ("bar", "knob"))


def handleless(w: Workbench) -> None:
    """Builds a modern chest with three broad fronts and shadow gaps."""
    width, depth, height = w.width(0.80, 1.30), w.depth(0.42, 0.48), w.length(0.70, 0.85)
    body, front = w.look("wood"), w.look("lacquer")
    x, y = parts.case(w, depth, width, (0.04, height), body, foot=0.04)
    w.box((x, x + 0.004), inset(y, 0.008), (0.045, height - 0.01), parts.darker(front), solid=False)
    tall = (height - 0.06) / 3
    for i in range(3):
        z = 0.045 + i * tall
        w.box((x, x + 0.02), inset(y, 0.006), (z + 0.004, z + tall - 0.022), front, solid=False)


def bedside_chest(w: Workbench) -> None:
    """Builds a bedside chest of two or three drawers."""
    width, depth, height = w.width(0.40, 0.52), w.depth(0.36, 0.44), w.length(0.48, 0.62)
    _drawer_column(w, (depth, width, height), 0.06, 0.07, (2, 3), "brass", ("knob", "bar"))


def campaign(w: Workbench) -> None:
    """Builds a chest with brass corners and flush handles on bun feet."""
    width, depth, height = w.width(0.90, 1.20), w.depth(0.44, 0.50), w.length(0.80, 0.95)
    wood, brass = w.look("wood"), w.look("brass")
    x, y = parts.case(w, depth, width, (0.09, height), wood)
    parts.plain_drawers(w, x, y, (0.10, 0.62 * height), 2, 1, wood, brass, "none")
    parts.plain_drawers(w, x, y, (0.62 * height, height - 0.02), 1, 2, wood, brass, "none")
    for share in (0.25, 0.48, 0.80):
        for c in centred(0.5 * width):
            w.box((x + 0.016, x + 0.022), around(c, 0.05), around(share * height, 0.025), brass, solid=False)
    for side in BOTH_SIDES:
        for z in (0.09, height - 0.06):
            edge = side * (0.5 * width - 0.028)
            w.box((x - 0.05, x + 0.021), around(edge, 0.03), (z, z + 0.06), brass, solid=False)
        for sx in centred(depth, 0.06):
            w.ellipsoid((sx, side * (0.5 * width - 0.06), 0.05), (0.05, 0.05, 0.05), wood)


def apothecary(w: Workbench) -> None:
    """Builds a chest of many small square drawers with knobs, on a stand."""
    width, depth, height = w.width(0.80, 1.05), w.depth(0.36, 0.42), w.length(0.95, 1.10)
    wood = w.look("wood")
    x, y = parts.case(w, depth, width, (0.34, height), wood)
    parts.plain_drawers(w, x, inset(y, 0.02), (0.36, height - 0.03), 3, 4, w.look("lacquer"), w.look("brass"), "knob")
    w.legs(centred(depth, 0.01), inset(y, 0.02), (0.0, 0.35), 0.045, wood)
    w.box(centred(depth, 0.02), inset(y, 0.04), (0.10, 0.12), wood)


def bedside_drum(w: Workbench) -> None:
    """Builds a round bedside chest: a drum with two curved fronts."""
    radius, height = 0.5 * w.width(0.40, 0.48), w.length(0.48, 0.58)
    look, metal = w.look("lacquer"), w.look("brass")
    w.cylinder((0.0, 0.0), (0.05, height), radius, look)
    w.cylinder((0.0, 0.0), (0.0, 0.05), radius - 0.04, w.look("dark"))
    for z in (0.06, 0.5 * (height + 0.05), height - 0.012):
        w.cylinder((0.0, 0.0), around(z, 0.006), radius + 0.004, metal, solid=False)
    for z in (0.28 * height + 0.03, 0.72 * height):
        w.ball((radius + 0.012, 0.0, z), 0.016, metal, solid=False)
    half = 0.6 * radius
    w.top((-half, half), (-half, half), height)


STYLES = (
    Style("chest_of_drawers", "dresser", "train", dresser, ("dresser",)),
    Style("chest_of_drawers", "tallboy", "train", tallboy, ("dresser",)),
    Style("chest_of_drawers", "handleless", "train", handleless, ("dresser",)),
    Style("chest_of_drawers", "bedside_chest", "train", bedside_chest, ("nightstand",)),
    Style("chest_of_drawers", "campaign", "heldout", campaign, ("dresser",)),
    Style("chest_of_drawers", "apothecary", "heldout", apothecary, ("dresser",)),
    Style("chest_of_drawers", "bedside_drum", "heldout", bedside_drum, ("nightstand",)),
)
