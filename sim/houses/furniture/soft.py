"""Cloth things: cushions, towels, curtains, clothes, rugs.

Usual retail dimensions: throw cushions 0.40-0.50 m, floor cushions 0.55-0.70 m, hand towels 0.50 x 1.00 m, bath
towels 0.70 x 1.40 m, clothes rails 0.90-1.50 m wide and 1.50-1.75 m high, garments 0.40-0.55 m wide.
"""

from __future__ import annotations

from sim.houses.furniture.catalogue import Style
from sim.houses.furniture.shapes import Ring, chamfered_box, drape, loft, pillow
from sim.houses.furniture.workbench import Workbench


def square_cushion(w: Workbench) -> None:
    """Throw cushion leaning backwards."""
    side = w.choice((0.40, 0.45, 0.50))
    w.mesh(pillow((side, side, 0.14)), (0.0, 0.0, 0.5 * side), w.look("bright"), tilt=1.25)


def lumbar_cushion(w: Workbench) -> None:
    """Long low cushion."""
    w.mesh(pillow((0.30, w.choice((0.50, 0.55)), 0.14)), (0.0, 0.0, 0.15), w.look("bright"), tilt=1.2)


def bolster(w: Workbench) -> None:
    """A roll."""
    half, r = 0.5 * w.length(0.40, 0.55), w.length(0.08, 0.10)
    w.rod((0.0, -half, r), (0.0, half, r), r, w.look("bright"))
    for side in (-1, 1):
        w.rod((0.0, side * half, r), (0.0, side * (half + 0.006), r), 0.4 * r, w.look("dark"), solid=False)


def floor_cushion(w: Workbench) -> None:
    """Large square seat cushion, maybe two on top of each other."""
    side = w.choice((0.55, 0.60, 0.65))
    w.mesh(pillow((side, side, 0.18), 5.0), (0.0, 0.0, 0.09), w.look("bright"))
    if w.chance(0.4):
        w.mesh(pillow((side, side, 0.16), 5.0), (0.01, 0.02, 0.245), w.new_look("bright"), turn=0.2)


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


def curtain_pair(w: Workbench) -> None:
    """Two gathered panels on a rod."""
    width, height = w.width(1.4, 2.4), w.height(2.0, 2.3)
    rod, cloth = w.look("iron"), w.look("curtain")
    w.rod((0.08, -0.5 * width, height - 0.02), (0.08, 0.5 * width, height - 0.02), 0.012, rod, solid=False)
    for side in (-1, 1):
        w.ball((0.08, side * 0.5 * width, height - 0.02), 0.022, rod, solid=False)
        w.rod(
            (0.0, side * (0.5 * width - 0.08), height - 0.02),
            (0.08, side * (0.5 * width - 0.08), height - 0.02),
            0.008,
            rod,
            solid=False,
        )
        panel = 0.22 * width
        w.mesh(
            drape(panel, height - 0.03, 0.10, 5, gather=0.9),
            (0.03, side * (0.5 * width - 0.03 - 0.5 * panel), 0.0),
            cloth,
            solid=False,
        )


def rug(w: Workbench) -> None:
    """A patterned rug."""
    width, depth = w.width(1.4, 2.4), w.depth(0.9, 1.7)
    w.box((-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width), (0.0, 0.008), w.look("rug"), solid=False)


def floor_round(w: Workbench) -> None:
    """Round meditation cushion."""
    r, high = 0.5 * w.length(0.45, 0.60), w.length(0.14, 0.20)
    rings = [
        Ring(0.0, 0.85 * r, 0.85 * r),
        Ring(0.3 * high, r, r),
        Ring(0.7 * high, r, r),
        Ring(high, 0.85 * r, 0.85 * r),
    ]
    w.mesh(loft(rings, 16, hull=True), (0.0, 0.0, 0.0), w.look("bright"))


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


def single_curtain(w: Workbench) -> None:
    """One panel of many folds, drawn to one side, on a flat track."""
    width, height = w.width(1.4, 2.4), w.height(2.0, 2.3)
    w.box((0.0, 0.10), (-0.5 * width, 0.5 * width), (height - 0.03, height), w.look("metal"), solid=False)
    panel, side = w.length(0.3, 0.45) * width, w.choice((-1, 1))
    w.mesh(
        drape(panel, height - 0.03, 0.09, 9), (0.005, side * 0.5 * (width - panel), 0.0), w.look("curtain"), solid=False
    )


def round_rug(w: Workbench) -> None:
    """Round rug with rings."""
    r = 0.5 * w.width(1.2, 2.0)
    for i, share in enumerate((1.0, 0.86, 0.5)):
        w.cylinder((0.0, 0.0), (0.0, 0.006 + 0.002 * i), share * r, w.new_look("fabric"), solid=False)


STYLES = (
    Style("cushion", "square", "train", square_cushion, ("throw",), "top"),
    Style("cushion", "lumbar", "train", lumbar_cushion, ("throw",), "top"),
    Style("cushion", "bolster", "heldout", bolster, ("throw",), "top"),
    Style("cushion", "floor_square", "train", floor_cushion, ("floor",)),
    Style("cushion", "floor_round", "heldout", floor_round, ("floor",)),
    Style("towel", "rail", "train", towel_rail, ("rail",), "wall"),
    Style("towel", "ring", "heldout", towel_ring, ("rail",), "wall"),
    Style("clothes", "rack", "train", clothes_rack, ("rack",)),
    Style("clothes", "coat_hooks", "heldout", coat_hooks, ("hooks",), "wall"),
    Style("curtain", "single", "heldout", single_curtain, (), "wall"),
    Style("curtain", "pair", "train", curtain_pair, (), "wall"),
    Style("floor", "rug_rectangle", "train", rug, ("rug",), walk_over=True),
    Style("floor", "rug_round", "heldout", round_rug, ("rug",), walk_over=True),
)
