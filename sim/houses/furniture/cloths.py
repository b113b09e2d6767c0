"""Towels and clothes.

Usual retail dimensions: hand towels 0.50 x 1.00 m, bath towels 0.70 x 1.40 m; clothes rails 0.90-1.50 m wide and
1.50-1.75 m high, garments 0.40-0.55 m wide.
"""

from __future__ import annotations

from sim.houses.furniture.catalogue import Style
from sim.houses.furniture.shapes import (
    chamfered_box,
    drape,
)
from sim.houses.furniture.workbench import Workbench

_BOTH = (-1, 1)


def towel_rail(w: Workbench) -> None:
    """Towel over a rail."""
    width = w.width(0.50, 0.70)
    chrome, cloth = w.look("chrome"), w.look("towel")
    w.mount_height_m = 0.75
    w.rod((0.07, -0.5 * width, 0.5), (0.07, 0.5 * width, 0.5), 0.009, chrome)
    for side in (-1, 1):
        w.rod((0.0, side * (0.5 * width - 0.01), 0.5), (0.07, side * (0.5 * width - 0.01), 0.5), 0.012, chrome)
    w.mesh(drape(width - 0.10, 0.5, 0.02, 4), (0.078, 0.0, 0.0), cloth)
    w.mesh(drape(width - 0.10, 0.36, 0.02, 4), (0.042, 0.0, 0.14), cloth)


def towel_ring(w: Workbench) -> None:
    """Hand towel in a ring."""
    cloth, brass = w.look("towel"), w.look("brass")
    w.mount_height_m = 0.80
    w.rod((0.0, 0.0, 0.52), (0.05, 0.0, 0.52), 0.02, brass)
    w.rod((0.05, -0.09, 0.42), (0.05, 0.09, 0.42), 0.006, brass)
    for side in (-1, 1):
        w.rod((0.05, side * 0.01, 0.52), (0.05, side * 0.09, 0.42), 0.006, brass)
    w.mesh(drape(0.24, 0.43, 0.05, 4), (0.025, 0.0, 0.0), cloth)


def clothes_rack(w: Workbench) -> None:
    """Rail on two posts with hanging garments."""
    width, height = w.width(0.9, 1.3), w.length(1.5, 1.7)
    metal = w.look("metal")
    for side in (-1, 1):
        y = side * 0.5 * width
        w.rod((0.0, y, 0.02), (0.0, y, height), 0.013, metal)
        w.rod((-0.22, y, 0.013), (0.22, y, 0.013), 0.013, metal)
    w.rod((0.0, -0.5 * width, height - 0.013), (0.0, 0.5 * width, height - 0.013), 0.013, metal)
    count = w.whole(4, 7)
    for i in range(count):
        y = (i + 0.5) / count * (width - 0.2) - 0.5 * (width - 0.2)
        length = w.choice((0.7, 0.85, 1.0))
        w.mesh(
            chamfered_box((0.42, 0.06, length), 0.05),
            (0.0, y, height - 0.05 - 0.5 * length),
            w.new_look("bright"),
            turn=w.length(-0.1, 0.1),
        )
        w.rod((0.0, y, height - 0.08), (0.0, y, height - 0.01), 0.004, metal, solid=False)


def coat_hooks(w: Workbench) -> None:
    """Board with hooks and two to four coats."""
    width, wood, iron = w.width(0.70, 1.10), w.look("wood"), w.look("iron")
    w.mount_height_m = 0.75
    w.box((0.0, 0.02), (-0.5 * width, 0.5 * width), (0.90, 1.00), wood)
    count = w.whole(3, 4)
    for i in range(count):
        y = (i + 0.5) / count * width - 0.5 * width
        w.rod((0.02, y, 0.94), (0.08, y, 0.96), 0.008, iron, solid=False, round_ends=True)
        if i == 0 or w.chance(0.75):
            length = w.choice((0.7, 0.8, 0.9))
            w.mesh(
                drape(0.30, length, 0.16, 3, gather=1.25), (0.02, y, 0.95 - length), w.new_look("bright"), solid=False
            )


STYLES = (
    Style("towel", "rail", "train", towel_rail, ("rail",), "wall"),
    Style("towel", "ring", "heldout", towel_ring, ("rail",), "wall"),
    Style("clothes", "rack", "train", clothes_rack, ("rack",)),
    Style("clothes", "coat_hooks", "heldout", coat_hooks, ("hooks",), "wall"),
)
