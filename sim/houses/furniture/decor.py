"""Things on walls and tops: pictures, mirrors, boards, screens; plants; lamps; small objects.

Usual retail dimensions: pictures 0.30-1.20 m wide hung with their middle at 1.45-1.60 m; screens by diagonal
(32 in: 0.72 m wide, 65 in: 1.45 m); floor plants 0.60-1.80 m high; floor lamps 1.40-1.75 m, table lamps 0.35-0.60 m.
"""

from __future__ import annotations

import math

from sim.houses.furniture.catalogue import Style
from sim.houses.furniture.item import Look
from sim.houses.furniture.shapes import Leaf, Ring, foliage, loft
from sim.houses.furniture.workbench import Range, Workbench

_BOTH = (-1, 1)


# ---- pictures, mirrors, boards ------------------------------------------------------------------------------------


def _frame(w: Workbench, width: float, height: float, border: float, thick: float, look: Look) -> None:
    """Four mouldings round a rectangle that starts at z = 0 on the wall."""
    y = 0.5 * width
    w.box((0.0, thick), (-y, y), (0.0, border), look)
    w.box((0.0, thick), (-y, y), (height - border, height), look)
    for side in _BOTH:
        c = side * (y - 0.5 * border)
        w.box((0.0, thick), (c - 0.5 * border, c + 0.5 * border), (border, height - border), look)


def framed_abstract(w: Workbench) -> None:
    """Framed sheet with mat and three to five coloured shapes."""
    width, height = w.width(0.40, 1.00), w.height(0.40, 0.90)
    w.mount_height_m = 1.52 - 0.5 * height
    border = w.length(0.02, 0.045)
    _frame(w, width, height, border, 0.03, w.look("wood") if w.chance(0.6) else w.look("dark"))
    w.box(
        (0.0, 0.012),
        (-0.5 * width + border, 0.5 * width - border),
        (border, height - border),
        w.look("paper"),
        solid=False,
    )
    inner_y, inner_z = 0.5 * width - border - 0.04, 0.5 * height - border - 0.04
    for i in range(w.whole(3, 5)):
        dy, dz = w.length(0.2, 0.6) * inner_y, w.length(0.2, 0.6) * inner_z
        y = w.length(-1.0, 1.0) * (inner_y - dy)
        z = 0.5 * height + w.length(-1.0, 1.0) * (inner_z - dz)
        x = 0.013 + 0.002 * i
        if w.chance(0.5):
            w.box((0.010, x), (y - dy, y + dy), (z - dz, z + dz), w.new_look("paint"), solid=False)
        else:
            w.rod((0.010, y, z), (x, y, z), min(dy, dz), w.new_look("paint"), solid=False)


def canvas_landscape(w: Workbench) -> None:
    """Unframed canvas: sky, sun, bands of hills."""
    width, height = w.width(0.60, 1.20), w.height(0.45, 0.80)
    w.mount_height_m = 1.52 - 0.5 * height
    w.box((0.0, 0.032), (-0.5 * width, 0.5 * width), (0.0, height), w.new_look("paint"))
    level, x = 0.55 * height, 0.034
    w.rod(
        (0.03, 0.22 * width, 0.70 * height),
        (x, 0.22 * width, 0.70 * height),
        0.12 * height,
        w.new_look("paint"),
        solid=False,
    )
    for _ in range(3):
        x += 0.002
        w.box((0.03, x), (-0.5 * width, 0.5 * width), (0.0, level), w.new_look("paint"), solid=False)
        level *= w.length(0.5, 0.75)


def wall_mirror(w: Workbench) -> None:
    """Framed rectangular mirror."""
    width, height = w.width(0.45, 0.80), w.height(0.60, 1.00)
    w.mount_height_m = 1.05
    _frame(w, width, height, 0.025, 0.028, w.look("metal"))
    w.box((0.0, 0.014), (-0.5 * width + 0.02, 0.5 * width - 0.02), (0.02, height - 0.02), w.look("mirror"), solid=False)


def round_mirror(w: Workbench) -> None:
    """Round mirror in a thin rim."""
    r = 0.5 * w.width(0.50, 0.80)
    w.mount_height_m = 1.52 - r
    w.rod((0.0, 0.0, r), (0.022, 0.0, r), r, w.look("brass"))
    w.rod((0.0, 0.0, r), (0.025, 0.0, r), r - 0.02, w.look("mirror"), solid=False)


def cork_board(w: Workbench) -> None:
    """Pin board with notes."""
    width, height = w.width(0.60, 1.00), w.height(0.45, 0.70)
    w.mount_height_m = 1.15
    _frame(w, width, height, 0.02, 0.02, w.look("wood"))
    w.box((0.0, 0.010), (-0.5 * width + 0.015, 0.5 * width - 0.015), (0.015, height - 0.015), w.look("wicker"))
    for _ in range(5):
        y, z = w.length(-0.36, 0.36) * width, height * w.length(0.25, 0.75)
        w.box((0.008, 0.013), (y - 0.05, y + 0.05), (z - 0.06, z + 0.06), w.new_look("paper"), solid=False)


def whiteboard(w: Workbench) -> None:
    """White board with a pen tray."""
    width, height, metal = w.width(0.90, 1.40), w.height(0.60, 0.90), w.look("metal")
    w.mount_height_m = 0.95
    _frame(w, width, height, 0.02, 0.022, metal)
    w.box((0.0, 0.012), (-0.5 * width + 0.015, 0.5 * width - 0.015), (0.015, height - 0.015), w.look("ceramic"))
    w.box((0.0, 0.07), (-0.25 * width, 0.25 * width), (-0.012, 0.0), metal)


# ---- screens -----------------------------------------------------------------------------------------------------


def _panel(w: Workbench, x: float, width: float, z: Range) -> None:
    w.box((x - 0.022, x + 0.012), (-0.5 * width, 0.5 * width), z, w.look("dark"))
    w.box(
        (x + 0.012, x + 0.016),
        (-0.5 * width + 0.012, 0.5 * width - 0.012),
        (z[0] + 0.02, z[1] - 0.012),
        w.look("screen"),
        solid=False,
    )


def tv_stand(w: Workbench) -> None:
    """Television on two feet, to stand on a bench."""
    width = w.width(0.80, 1.40)
    _panel(w, 0.0, width, (0.07, 0.07 + 0.575 * width))
    for side in _BOTH:
        y = side * 0.34 * width
        w.bar((-0.11, y, 0.008), (0.11, y, 0.008), 0.03, 0.016, w.look("dark"))
        w.box((-0.015, 0.005), (y - 0.012, y + 0.012), (0.01, 0.08), w.look("dark"))


def tv_wall(w: Workbench) -> None:
    """Television on the wall."""
    width = w.width(0.90, 1.45)
    w.mount_height_m = 0.95
    _panel(w, 0.065, width, (0.0, 0.575 * width))
    w.box((0.0, 0.045), (-0.2, 0.2), (0.18 * width, 0.38 * width), w.look("iron"))


def monitor(w: Workbench) -> None:
    """Computer monitor with keyboard."""
    width, dark = w.length(0.52, 0.62), w.look("dark")
    _panel(w, 0.0, width, (0.11, 0.11 + 0.58 * width))
    w.box((-0.05, -0.02), (-0.03, 0.03), (0.01, 0.30), dark)
    w.box((-0.11, 0.09), (-0.12, 0.12), (0.0, 0.012), dark)
    w.box((0.14, 0.27), (-0.21, 0.21), (0.0, 0.018), dark, solid=False)


def tv_easel(w: Workbench) -> None:
    """Screen on a wooden tripod."""
    width, wood = w.width(0.95, 1.25), w.look("wood")
    z0 = w.length(0.62, 0.72)
    _panel(w, 0.0, width, (z0, z0 + 0.575 * width))
    for side in _BOTH:
        w.rod((0.16, side * 0.36, 0.0), (-0.03, side * 0.05, z0 + 0.5), 0.018, wood)
    w.rod((-0.34, 0.0, 0.0), (-0.035, 0.0, z0 + 0.5), 0.018, wood)
    w.box((-0.06, -0.02), (-0.14, 0.14), (z0 + 0.15, z0 + 0.40), w.look("dark"))


def crt(w: Workbench) -> None:
    """Old television: a wooden box with a bulging screen, knobs and rabbit ears."""
    width = w.length(0.55, 0.65)
    height, depth, wood = 0.72 * width, 0.62 * width, w.look("wood")
    w.box((-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width), (0.02, height), wood)
    w.legs((-0.4 * depth, 0.4 * depth), (-0.4 * width, 0.4 * width), (0.0, 0.022), 0.03, w.look("dark"))
    w.ellipsoid(
        (0.5 * depth - 0.005, 0.09 * width - 0.1, 0.5 * height),
        (0.028, 0.36 * width, 0.40 * height),
        w.look("screen"),
        solid=False,
    )
    for z in (0.72, 0.5):
        w.rod(
            (0.5 * depth - 0.01, 0.40 * width, z * height),
            (0.5 * depth + 0.02, 0.40 * width, z * height),
            0.022,
            w.look("brass"),
            solid=False,
        )
    for side in _BOTH:
        w.rod((0.0, 0.0, height), (-0.05, side * 0.2, height + 0.30), 0.004, w.look("chrome"), solid=False)


def tv_arm(w: Workbench) -> None:
    """Screen tilted on a wall arm."""
    width, iron = w.width(0.80, 1.15), w.look("iron")
    w.mount_height_m = 1.0
    h = 0.575 * width
    w.box((0.0, 0.02), (-0.09, 0.09), (0.5 * h - 0.12, 0.5 * h + 0.12), iron)
    w.bar((0.01, 0.0, 0.5 * h), (0.21, 0.0, 0.5 * h), 0.05, 0.04, iron)
    w.box((0.215, 0.25), (-0.5 * width, 0.5 * width), (0.0, h), w.look("dark"), tilt=0.06)
    w.box(
        (0.25, 0.255),
        (-0.5 * width + 0.015, 0.5 * width - 0.015),
        (0.02, h - 0.015),
        w.look("screen"),
        tilt=0.06,
        solid=False,
    )


# ---- plants ------------------------------------------------------------------------------------------------------


def _pot(w: Workbench, r: float, high: float) -> None:
    look = w.look("pot")
    w.mesh(
        loft(
            [
                Ring(0.0, 0.72 * r, 0.72 * r),
                Ring(0.85 * high, 0.95 * r, 0.95 * r),
                Ring(0.86 * high, r, r),
                Ring(high, r, r),
            ],
            14,
            hull=True,
        ),
        (0.0, 0.0, 0.0),
        look,
    )
    w.cylinder((0.0, 0.0), (high - 0.004, high + 0.004), 0.9 * r, w.look("soil"), solid=False)


def broadleaf(w: Workbench) -> None:
    """Big arching leaves out of a pot."""
    r, high, tall = w.length(0.14, 0.20), w.length(0.22, 0.32), w.length(0.45, 0.90)
    _pot(w, r, high)
    leaves = []
    for i in range(14):
        a = 2.4 * i
        reach, rise = (0.30 + 0.02 * (i % 4)) * tall / 0.7 * (0.4 + 0.04 * i), tall * (1.05 - 0.045 * i)
        leaves.append(
            Leaf(
                (0.02 * math.cos(a), 0.02 * math.sin(a), high),
                (reach * math.cos(a), reach * math.sin(a), high + rise),
                0.13 + 0.05 * tall,
                0.10 * tall,
            )
        )
    w.mesh(foliage(leaves), (0.0, 0.0, 0.0), w.look("foliage"), solid=False)
    w.cylinder((0.0, 0.0), (high, high + 0.5 * tall), 0.02, w.look("foliage"))


def tree(w: Workbench) -> None:
    """Small tree: bare stem, round crown."""
    r, high, tall = w.length(0.15, 0.20), w.length(0.26, 0.34), w.length(1.20, 1.65)
    _pot(w, r, high)
    crown = w.length(0.24, 0.32)
    w.rod((0.0, 0.0, high - 0.01), (0.02, 0.0, tall - crown), 0.018, w.look("wood"))
    for dx, dy, dz, s in (
        (0.0, 0.0, 0.0, 1.0),
        (0.12, 0.10, -0.12, 0.7),
        (-0.10, 0.12, -0.05, 0.7),
        (0.02, -0.15, -0.10, 0.75),
        (0.0, 0.02, 0.16, 0.6),
    ):
        w.ellipsoid(
            (dx, dy, tall - 0.8 * crown + dz),
            (s * crown, s * crown, 0.8 * s * crown),
            w.look("foliage"),
            solid=dz == 0.0,
        )


STYLES = (
    Style("picture", "framed_abstract", "train", framed_abstract, (), "wall"),
    Style("picture", "canvas_landscape", "heldout", canvas_landscape, (), "wall"),
    Style("mirror", "rectangular", "train", wall_mirror, ("wall",), "wall"),
    Style("mirror", "round", "heldout", round_mirror, ("wall",), "wall"),
    Style("board_panel", "cork_board", "train", cork_board, (), "wall"),
    Style("board_panel", "whiteboard", "heldout", whiteboard, (), "wall"),
    Style("tv_monitor", "tv_stand", "train", tv_stand, ("tv",), "top"),
    Style("tv_monitor", "tv_wall", "train", tv_wall, ("tv_wall",), "wall"),
    Style("tv_monitor", "monitor", "train", monitor, ("monitor",), "top"),
    Style("tv_monitor", "tv_easel", "heldout", tv_easel, ("tv_floor",)),
    Style("tv_monitor", "crt", "heldout", crt, ("tv", "monitor"), "top"),
    Style("tv_monitor", "tv_arm", "heldout", tv_arm, ("tv_wall",), "wall"),
    Style("plant", "broadleaf", "train", broadleaf, ("floor",)),
    Style("plant", "tree", "heldout", tree, ("floor",)),
)
