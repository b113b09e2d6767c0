"""Clothes that hang on racks and hooks, lie in heaps or are folded.

Usual retail dimensions: clothes rails 0.90-1.30 m wide and 1.45-1.70 m high, garments 0.35-0.55 m wide and
0.60-1.05 m long, coat hooks 1.60-1.75 m above the floor.
"""

from __future__ import annotations

import math

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.item import MeshShape
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, centred, darker, polar
from sim.homes.housegen.furniture.parts.leaves import bush, joined
from sim.homes.housegen.furniture.shapes import Ring, chamfered_box, drape, hoop, loft, named_mesh, pillow
from sim.homes.housegen.furniture.workbench import Workbench


def _jacket(w: Workbench, x: float, y: float, top: float, high: float, wide: float) -> None:
    """Adds a coat that hangs by its collar: shoulders, a body in folds, and sleeves."""
    cloth = w.new_look("bright") if w.chance(0.5) else w.new_look("denim")
    w.mesh(drape(0.5 * wide, high, 0.14, 2, gather=1.7), (x - 0.005, y, top - high), cloth, solid=False)
    for side in BOTH_SIDES:
        w.rod(
            (x + 0.05, y + side * 0.22 * wide, top - 0.07),
            (x + 0.05, y + side * 0.40 * wide, top - 0.75 * high),
            0.042,
            cloth,
            solid=False,
            round_ends=True,
        )
    w.ellipsoid((x + 0.05, y, top - 0.03), (0.045, 0.24 * wide, 0.05), cloth, solid=False)


def _garment(high: float, *, dress: bool = False) -> MeshShape:
    """Returns a shirt or a dress on a hanger: shoulders along y, about y = 0, lower edge at z = 0."""
    hem = 0.27 if dress else 0.18
    right = [
        (0.06, high),
        (0.20, high - 0.05),
        (0.28, high - 0.30),
        (0.21, high - 0.34),
        (0.15, high - 0.20),
        (0.14, 0.45 * high),
        (hem, 0.0),
        (0.33 * hem, 0.02),
    ]
    outline = [*((-y, z) for y, z in reversed(right)), (0.0, high - 0.05), *right]
    return named_mesh("garment", *_extruded(outline[::-1], (0.0, high - 0.22), 0.035, 0.03))


def _extruded(
    outline: list[tuple[float, float]], centre: tuple[float, float], thick: float, bulge: float
) -> tuple[list[tuple[float, float, float]], list[tuple[int, int, int]]]:
    """Returns vertices and faces of a (y, z) outline extruded along x by `thick`, and by `bulge` more at its centre.

    The outline is star-shaped about `centre` and counter-clockwise as seen from +x.
    """
    n = len(outline)
    vertices = []
    for side in BOTH_SIDES:
        vertices += [(0.5 * side * thick, y, z) for y, z in outline]
        vertices.append((side * (0.5 * thick + bulge), *centre))
    faces = []
    for i in range(n):
        j = (i + 1) % n
        faces += [(j, i, n), (n + 1 + i, n + 1 + j, 2 * n + 1), (i, j, n + 1 + j), (i, n + 1 + j, n + 1 + i)]
    return vertices, faces


def clothes_rack(w: Workbench) -> None:
    """Builds a steel rail on two posts with hanging garments."""
    width, height = w.width(0.9, 1.3), w.length(1.5, 1.7)
    metal = w.look("metal")
    for y in centred(width):
        w.cylinder((0.0, y), (0.02, height), 0.013, metal)
        w.rod_x((y, 0.013), (-0.22, 0.22), 0.013, metal)
    w.rod_y((0.0, height - 0.013), centred(width), 0.013, metal)
    w.rod_y((0.0, 0.12), centred(width), 0.010, metal)
    count = w.whole(5, 8)
    for i in range(count):
        y = (i + 0.5) / count * (width - 0.2) - 0.5 * (width - 0.2)
        high = w.choice((0.70, 0.85, 1.0))
        cloth = w.new_look("bright") if w.chance(0.6) else w.new_look("denim")
        w.mesh(
            _garment(high),
            (0.0, y, height - 0.022 - high),
            cloth,
            turn=0.5 * math.pi + w.length(-0.12, 0.12),
            solid=i % 2 == 0,
        )


def hall_board(w: Workbench) -> None:
    """Builds a shelf with hooks below it, on which jackets and a bag hang, and a hat on top."""
    width, wood, iron = w.width(0.75, 1.15), w.look("wood"), w.look("iron")
    w.mount_height_m = 0.78
    w.box((0.0, 0.018), centred(width), (0.86, 1.04), wood)
    w.box((0.0, 0.22), centred(width), (1.04, 1.065), wood)
    count = w.whole(3, 4)
    for i in range(count):
        y = (i + 0.5) * width / count - 0.5 * width
        w.rod((0.015, y, 0.93), (0.09, y, 0.95), 0.008, iron, solid=False, round_ends=True)
        _jacket(w, 0.03, y, 0.94, w.choice((0.62, 0.72, 0.85)), min(0.34, width / count - 0.01))
    w.ellipsoid((0.11, 0.2 * width, 1.085), (0.10, 0.14, 0.02), w.look("book"), solid=False)
    w.ellipsoid((0.11, 0.2 * width, 1.12), (0.07, 0.08, 0.06), w.look("book"), solid=False)


def valet(w: Workbench) -> None:
    """Builds a valet stand with a jacket over shaped shoulders, trousers over a bar and shoes below."""
    wood, high = w.look("wood"), w.length(1.10, 1.25)
    w.box((-0.19, 0.19), (-0.22, 0.22), (0.10, 0.13), wood)
    for side in BOTH_SIDES:
        w.cylinder((0.0, side * 0.15), (0.0, high - 0.16), 0.016, wood)
        w.rod_x((side * 0.15, 0.013), (-0.18, 0.18), 0.013, wood)
        w.ellipsoid((0.05, side * 0.07, 0.175), (0.13, 0.045, 0.05), w.look("book"), solid=False)
        w.rod((0.0, side * 0.03, high - 0.04), (0.0, side * 0.22, high - 0.11), 0.025, wood, round_ends=True)
    w.rod_y((0.0, high - 0.30), (-0.15, 0.15), 0.012, wood)
    w.rod_y((0.0, high - 0.14), (-0.15, 0.15), 0.016, wood)
    jacket = w.new_look("denim")
    w.mesh(drape(0.40, 0.60, 0.14, 4), (-0.07, 0.0, high - 0.68), jacket, solid=False)
    w.rod_y((0.0, high - 0.09), (-0.21, 0.21), 0.055, jacket, solid=False, round_ends=True)
    for side in BOTH_SIDES:
        w.rod(
            (0.0, side * 0.24, high - 0.12),
            (0.02, side * 0.25, high - 0.55),
            0.045,
            jacket,
            solid=False,
            round_ends=True,
        )


def folded_pile(w: Workbench) -> None:
    """Builds folded shirts and trousers with a pair of shoes next to them."""
    z = 0.0
    for i in range(w.whole(4, 6)):
        thick = w.choice((0.03, 0.04))
        cloth = w.new_look("denim") if i % 2 else w.new_look("bright")
        w.mesh(chamfered_box((0.30, 0.26, thick), 0.012), (w.choice((-0.01, 0.0, 0.01)), 0.0, z + 0.5 * thick), cloth)
        z += thick - 0.002


def coat_hooks(w: Workbench) -> None:
    """Builds a rail of hooks with coats."""
    width, iron = w.width(0.70, 1.10), w.look("iron")
    w.mount_height_m = 0.75
    w.box((0.0, 0.012), centred(width), (0.95, 0.99), iron)
    count = w.whole(3, 4)
    for i in range(count):
        y = (i + 0.5) / count * width - 0.5 * width
        w.rod((0.01, y, 0.97), (0.08, y, 0.98), 0.008, iron, solid=False, round_ends=True)
        w.ball((0.085, y, 0.985), 0.014, iron, solid=False)
        if i == 0 or w.chance(0.75):
            _jacket(w, 0.02, y, 0.97, w.choice((0.7, 0.8, 0.95)), min(0.34, width / count - 0.01))


def laundry_basket(w: Workbench) -> None:
    """Builds a woven basket overflowing with clothes."""
    r, high = w.length(0.20, 0.25), w.length(0.45, 0.58)
    w.cylinder((0.0, 0.0), (0.0, high), r, w.look("wicker"))
    w.mesh(hoop(r + 0.008, 0.03, 0.04), (0.0, 0.0, high - 0.01), w.look("wood"), solid=False)
    for i in range(4):
        a = 1.7 * i
        at = (*polar(0.42 * r, a), high + 0.005 + 0.012 * i)
        cloth = w.new_look("denim") if i == 1 else w.new_look("bright")
        w.mesh(joined("cloth", [bush(at, (0.55 * r, 0.45 * r, 0.07), w.rng, 8)]), (0.0, 0.0, 0.0), cloth, solid=False)
    w.mesh(drape(0.16, 0.24, 0.05, 2), (r - 0.012, 0.03, high - 0.20), w.new_look("denim"), solid=False)
    w.ellipsoid((0.75 * r, 0.03, high + 0.03), (0.28 * r, 0.08, 0.03), w.look("denim"), solid=False)


def open_wardrobe(w: Workbench) -> None:
    """Builds a wooden clothes stand: a rail between two A-frames, a shelf with shoes, and garments in a row."""
    width, high, wood = w.width(0.90, 1.25), w.length(1.45, 1.60), w.look("wood")
    for y in centred(width, 0.02):
        w.bar((-0.24, y, 0.0), (0.015, y, high), 0.03, 0.035, wood)
        w.bar((0.24, y, 0.0), (-0.015, y, high), 0.03, 0.035, wood)
        w.box((-0.20, 0.20), around(y, 0.012), (0.20, 0.23), wood)
    w.rod_y((0.0, high - 0.06), centred(width, 0.02), 0.016, wood)
    w.box((-0.20, 0.20), centred(width, 0.02), (0.23, 0.25), wood)
    count = w.whole(4, 6)
    for i in range(count):
        y = (i + 0.5) / count * 0.62 * width - 0.31 * width
        high_i = w.choice((0.65, 0.80, 0.95))
        w.mesh(
            _garment(high_i),
            (0.0, y, high - 0.07 - high_i),
            w.new_look("bright"),
            solid=False,
            turn=0.5 * math.pi + w.length(-0.12, 0.12),
        )
    for dy in (-0.1, 0.0, 0.16):
        w.ellipsoid((0.03, dy, 0.29), (0.13, 0.045, 0.045), w.new_look("book"), solid=False)


def coat_tree(w: Workbench) -> None:
    """Builds a coat stand: a pole on four feet, with coats and a scarf on its arms."""
    wood, high = w.look("wood"), w.length(1.70, 1.85)
    w.cylinder((0.0, 0.0), (0.05, high), 0.022, wood)
    w.ball((0.0, 0.0, high), 0.035, wood)
    for i in range(4):
        a = math.tau * (i + 0.5) / 4
        c, s = math.cos(a), math.sin(a)
        w.rod((0.0, 0.0, 0.16), (0.25 * c, 0.25 * s, 0.014), 0.014, wood, round_ends=True)
        w.rod((0.0, 0.0, high - 0.20), (0.17 * c, 0.17 * s, high - 0.06), 0.012, wood, round_ends=True)
        if i < 3:
            long = w.choice((0.80, 0.95))
            cloth = w.new_look("bright") if i else w.new_look("denim")
            w.mesh(_garment(long), (0.10 * c, 0.10 * s, high - 0.12 - long), cloth, solid=False, turn=a, tilt=-0.04)
            w.mesh(_garment(long), (0.15 * c, 0.15 * s, high - 0.12 - long), cloth, solid=False, turn=a + 0.2)
    w.mesh(drape(0.10, 0.85, 0.05, 1), (0.09, -0.12, high - 0.98), w.new_look("flower"), solid=False, turn=-0.8)


def wall_pegs_dress(w: Workbench) -> None:
    """Builds a dress and a shirt on hangers from two pegs."""
    wood = w.look("wood")
    w.mount_height_m = 0.70
    for side in BOTH_SIDES:
        y = side * 0.30
        high = 1.05 if side < 0 else 0.75
        w.rod((0.0, y, 1.22), (0.07, y, 1.23), 0.012, wood)
        w.cylinder((0.045, y), (1.13, 1.23), 0.004, w.look("metal"), solid=False)
        w.mesh(_garment(high, dress=side < 0), (0.045, y, 1.16 - high), w.new_look("bright"), solid=False)


def sweater(w: Workbench) -> None:
    """Builds a sweater folded on trousers, with its sleeves crossed over it and its collar towards the wall."""
    trousers, cloth = w.new_look("denim"), w.new_look("bright")
    for i in range(2):
        w.mesh(chamfered_box((0.36, 0.27, 0.028), 0.012), (0.0, 0.0, 0.014 + 0.026 * i), trousers)
    w.mesh(pillow((0.34, 0.31, 0.07), 6.0), (0.0, 0.0, 0.085), cloth)
    for side in BOTH_SIDES:
        w.bar((-0.11, side * 0.13, 0.116), (0.12, -side * 0.03, 0.122), 0.07, 0.02, cloth, solid=False)
    collar = [Ring(z, s * 0.035, s * 0.065) for z, s in ((0.0, 1.0), (0.028, 0.9), (0.028, 0.6), (0.0, 0.7))]
    w.mesh(loft(collar, 12, loop=True), (-0.13, 0.0, 0.108), darker(cloth, 0.8), solid=False)


def clothes_heap(w: Workbench) -> None:
    """Builds a heap of clothes on the floor: crossed shirts, trousers over them, and a crumpled piece on top."""
    for turn, z, high in ((0.3, 0.025, 0.60), (2.2, 0.065, 0.58)):
        at = (*polar(0.5 * high, turn), z)
        w.mesh(_garment(high), at, w.new_look("bright"), tilt=-0.5 * math.pi, turn=turn, solid=z < 0.05)
    trousers = w.new_look("denim")
    leg = pillow((0.62, 0.17, 0.07), 5.0)
    for side in BOTH_SIDES:
        w.mesh(leg, (0.10, 0.02 + side * 0.10, 0.105), trousers, solid=False, turn=1.2 + side * 0.22)
    w.mesh(
        pillow((0.30, 0.34, 0.16), 2.6), (-0.06, -0.07, 0.13), w.new_look("bright"), solid=False, tilt=0.25, turn=0.7
    )
    w.mesh(pillow((0.22, 0.27, 0.11), 2.6), (0.05, 0.03, 0.19), w.new_look("denim"), solid=False, tilt=-0.35, turn=-0.4)
    w.rod((-0.06, -0.15, 0.16), (-0.22, -0.30, 0.045), 0.045, w.new_look("bright"), solid=False, round_ends=True)


STYLES = (
    Style("clothes", "rack", "train", clothes_rack, ("rack",)),
    Style("clothes", "hall_board", "train", hall_board, ("hooks",), "wall"),
    Style("clothes", "valet", "train", valet, ("rack",)),
    Style("clothes", "folded_pile", "train", folded_pile, ("top",), "top"),
    Style("clothes", "coat_hooks", "heldout", coat_hooks, ("hooks",), "wall"),
    Style("clothes", "laundry_basket", "heldout", laundry_basket, ("floor",)),
    Style("clothes", "open_wardrobe", "heldout", open_wardrobe, ("rack",)),
    Style("clothes", "coat_tree", "heldout", coat_tree, ("rack",)),
    Style("clothes", "on_pegs", "heldout", wall_pegs_dress, ("hooks",), "wall"),
    Style("clothes", "sweater", "heldout", sweater, ("top",), "top"),
    Style("clothes", "heap", "train", clothes_heap, ("floor",)),
)
