"""Fireplaces, lamps, blinds, columns, railings.

Ranges after Neufert, Architects' Data (fireplace openings 0.60-1.00 m wide and 0.55-0.80 m high, mantels at
1.05-1.30 m; railings 0.90-1.10 m high) and usual retail dimensions of lamps (ceiling lamps 0.30-0.60 m across,
floor lamps 1.40-1.75 m, table lamps 0.35-0.60 m high).
"""

from __future__ import annotations

import math

from sim.houses.furniture.catalogue import Style
from sim.houses.furniture.item import Look
from sim.houses.furniture.shapes import Ring, loft
from sim.houses.furniture.workbench import Range, Workbench

_BOTH = (-1, 1)


# ---- fireplaces --------------------------------------------------------------------------------------------------


def _opening(w: Workbench, x: Range, half: float, z: Range, outer: float, top: float, look: Look) -> None:
    """A block from x[0] to x[1] with a dark recess |y| < half between heights z; outer half width, total height."""
    char = w.look("char")
    for side in _BOTH:
        low, high = sorted((side * half, side * outer))
        w.box(x, (low, high), (0.0, top), look)
    w.box(x, (-half, half), (z[1], top), look)
    w.box((x[0], x[0] + 0.04), (-half, half), (0.0, z[1]), char)
    if z[0] > 0:
        w.box((x[0] + 0.04, x[1]), (-half, half), (0.0, z[0]), look)
    for side in _BOTH:
        edge = side * (half - 0.004)
        w.box((x[0] + 0.04, x[1] - 0.02), (edge - 0.004, edge + 0.004), z, char, solid=False)


def _logs(w: Workbench, x: float, z: float, half: float) -> None:
    """Logs on a grate, a flame or two."""
    wood = w.look("wood")
    w.rod((x, -0.6 * half, z + 0.05), (x, 0.6 * half, z + 0.05), 0.05, wood)
    w.rod((x - 0.06, -0.5 * half, z + 0.13), (x + 0.05, 0.5 * half, z + 0.13), 0.042, wood)
    if w.chance(0.6):
        for y, high in ((-0.2 * half, 0.12), (0.15 * half, 0.17)):
            w.ellipsoid((x - 0.01, y, z + 0.12 + high), (0.04, 0.05, high), w.look("fire"), solid=False)


def mantel(w: Workbench) -> None:
    """Classic surround: pilasters, frieze and shelf round a dark opening on a hearth."""
    half, high = 0.5 * w.length(0.62, 0.80), w.length(0.62, 0.74)
    outer, top, depth = half + w.length(0.18, 0.26), w.length(1.08, 1.22), w.length(0.30, 0.36)
    look = w.look("lacquer") if w.chance(0.5) else w.look("stone")
    _opening(w, (0.0, depth), half, (0.0, high), outer, top - 0.05, look)
    w.box((0.0, depth + 0.08), (-outer - 0.07, outer + 0.07), (top - 0.05, top), look)
    w.box((0.0, depth + 0.03), (-outer - 0.02, outer + 0.02), (top - 0.09, top - 0.05), look, solid=False)
    for side in _BOTH:
        c = side * (half + 0.5 * (outer - half))
        w.box((depth, depth + 0.025), (c - 0.06, c + 0.06), (0.0, top - 0.09), look, solid=False)
    w.box((depth, depth + 0.32), (-outer, outer), (0.0, 0.04), w.look("stone"))
    _logs(w, 0.5 * depth + 0.03, 0.0, half)
    w.top((0.05, depth + 0.03), (-outer, outer), top)


def stove_iron(w: Workbench) -> None:
    """Iron stove on legs with a glazed door and a flue pipe to the ceiling."""
    iron, width, depth = w.look("iron"), w.length(0.48, 0.60), w.length(0.40, 0.46)
    w.box((-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width), (0.22, 0.82), iron)
    w.legs(
        (-0.5 * depth + 0.02, 0.5 * depth - 0.02), (-0.5 * width + 0.02, 0.5 * width - 0.02), (0.0, 0.23), 0.05, iron
    )
    w.box((-0.5 * depth - 0.02, 0.5 * depth + 0.03), (-0.5 * width - 0.03, 0.5 * width + 0.03), (0.82, 0.85), iron)
    w.box((0.5 * depth, 0.5 * depth + 0.02), (-0.38 * width, 0.38 * width), (0.30, 0.74), iron, solid=False)
    w.box(
        (0.5 * depth + 0.02, 0.5 * depth + 0.026),
        (-0.29 * width, 0.29 * width),
        (0.37, 0.67),
        w.look("fire"),
        solid=False,
    )
    w.rod(
        (0.5 * depth + 0.035, 0.34 * width, 0.46),
        (0.5 * depth + 0.035, 0.34 * width, 0.58),
        0.012,
        w.look("brass"),
        solid=False,
    )
    w.cylinder((-0.05, 0.0), (0.84, 2.30), 0.075, iron)
    w.box(
        (-0.5 * depth - 0.08, 0.5 * depth + 0.30),
        (-0.5 * width - 0.18, 0.5 * width + 0.18),
        (0.0, 0.02),
        w.look("stone"),
    )


# ---- lighting ----------------------------------------------------------------------------------------------------


def pendant(w: Workbench) -> None:
    """Shade on a cord."""
    r, drop = 0.5 * w.length(0.32, 0.50), w.length(0.40, 0.70)
    w.cylinder((0.0, 0.0), (-0.03, 0.0), 0.05, w.look("iron"), solid=False)
    w.rod((0.0, 0.0, -drop), (0.0, 0.0, -0.02), 0.005, w.look("dark"), solid=False)
    w.mesh(
        loft(
            [Ring(-drop - 0.20, r, r), Ring(-drop - 0.02, 0.35 * r, 0.35 * r), Ring(-drop + 0.02, 0.12 * r, 0.12 * r)],
            16,
            hull=True,
        ),
        (0.0, 0.0, 0.0),
        w.look("shade"),
        solid=False,
    )
    w.ball((0.0, 0.0, -drop - 0.18), 0.06, w.look("glow"), solid=False)


def ceiling_disc(w: Workbench) -> None:
    """Flat round ceiling lamp."""
    r = 0.5 * w.length(0.32, 0.50)
    w.cylinder((0.0, 0.0), (-0.05, 0.0), r, w.look("metal"), solid=False)
    w.ellipsoid((0.0, 0.0, -0.05), (0.92 * r, 0.92 * r, 0.06), w.look("glow"), solid=False)


def floor_lamp(w: Workbench) -> None:
    """Disc foot, pole, drum shade."""
    tall, metal, r = w.length(1.45, 1.70), w.look("metal"), 0.5 * w.length(0.32, 0.44)
    w.cylinder((0.0, 0.0), (0.0, 0.025), 0.15, metal)
    w.cylinder((0.0, 0.0), (0.02, tall - 0.05), 0.012, metal)
    w.mesh(
        loft([Ring(tall - 0.28, r, r), Ring(tall, 0.75 * r, 0.75 * r)], 16, hull=True), (0.0, 0.0, 0.0), w.look("shade")
    )
    w.cylinder((0.0, 0.0), (tall - 0.285, tall - 0.27), 0.8 * r, w.look("glow"), solid=False)


def table_lamp(w: Workbench) -> None:
    """Ceramic body, cone shade."""
    tall, r, body = w.length(0.38, 0.56), 0.5 * w.length(0.22, 0.32), w.look("pot")
    w.mesh(
        loft(
            [
                Ring(0.0, 0.06, 0.06),
                Ring(0.08, 0.085, 0.085),
                Ring(0.45 * tall, 0.045, 0.045),
                Ring(0.6 * tall, 0.015, 0.015),
            ],
            12,
            hull=True,
        ),
        (0.0, 0.0, 0.0),
        body,
    )
    w.mesh(
        loft([Ring(0.55 * tall, r, r), Ring(tall, 0.6 * r, 0.6 * r)], 14, hull=True), (0.0, 0.0, 0.0), w.look("shade")
    )


def tripod_lamp(w: Workbench) -> None:
    """Floor lamp on a wooden tripod."""
    tall, wood, r = w.length(1.40, 1.60), w.look("wood"), 0.5 * w.length(0.40, 0.48)
    for i in range(3):
        a = math.tau * i / 3
        w.rod(
            (0.26 * math.cos(a), 0.26 * math.sin(a), 0.013),
            (0.02 * math.cos(a), 0.02 * math.sin(a), tall - 0.26),
            0.014,
            wood,
            round_ends=True,
        )
    w.cylinder((0.0, 0.0), (tall - 0.30, tall), r, w.look("shade"))
    w.cylinder((0.0, 0.0), (tall - 0.305, tall - 0.295), 0.85 * r, w.look("glow"), solid=False)


def globe_pendant(w: Workbench) -> None:
    """Three glass globes at different heights from a bar."""
    w.box((-0.04, 0.04), (-0.35, 0.35), (-0.03, 0.0), w.look("brass"), solid=False)
    for i in range(3):
        drop, y = w.length(0.25, 0.60), (i - 1) * 0.28
        w.rod((0.0, y, -drop), (0.0, y, -0.02), 0.004, w.look("dark"), solid=False)
        w.ball((0.0, y, -drop - 0.09), 0.10, w.look("glow"), solid=False)


def mushroom_lamp(w: Workbench) -> None:
    """Table lamp: cylinder foot under a dome."""
    tall, look = w.length(0.34, 0.46), w.look("shade")
    w.cylinder((0.0, 0.0), (0.0, 0.65 * tall), 0.05, w.look("brass"))
    w.cylinder((0.0, 0.0), (0.0, 0.015), 0.09, w.look("brass"))
    w.mesh(
        loft(
            [
                Ring(0.55 * tall, 0.16, 0.16),
                Ring(0.75 * tall, 0.15, 0.15),
                Ring(0.92 * tall, 0.10, 0.10),
                Ring(tall, 0.03, 0.03),
            ],
            14,
            hull=True,
        ),
        (0.0, 0.0, 0.0),
        look,
    )


# ---- structure ---------------------------------------------------------------------------------------------------


def roller_blind(w: Workbench) -> None:
    """Cloth roll half drawn, bar at its lower edge; hangs from the top of the hinted height."""
    width, height = w.width(0.90, 1.60), w.height(1.00, 1.40)
    drawn = w.length(0.35, 0.75) * height
    w.rod((0.04, -0.5 * width, height - 0.03), (0.04, 0.5 * width, height - 0.03), 0.028, w.look("metal"), solid=False)
    w.box(
        (0.038, 0.042), (-0.48 * width, 0.48 * width), (height - drawn, height - 0.03), w.look("curtain"), solid=False
    )
    w.box(
        (0.03, 0.05),
        (-0.485 * width, 0.485 * width),
        (height - drawn - 0.012, height - drawn + 0.012),
        w.look("metal"),
        solid=False,
    )
    for side in _BOTH:
        w.box(
            (0.0, 0.06),
            (side * 0.5 * width - 0.006, side * 0.5 * width + 0.006),
            (height - 0.06, height),
            w.look("metal"),
            solid=False,
        )


def slatted_blind(w: Workbench) -> None:
    """Horizontal slats under a head rail."""
    width, height = w.width(0.90, 1.60), w.height(1.00, 1.40)
    look = w.look("wood")
    w.box((0.0, 0.06), (-0.5 * width, 0.5 * width), (height - 0.05, height), look, solid=False)
    count = max(6, min(14, round(0.6 * height / 0.07)))
    for i in range(count):
        z = height - 0.08 - 0.065 * i
        w.box((0.005, 0.055), (-0.49 * width, 0.49 * width), (z - 0.003, z + 0.003), look, tilt=0.5, solid=False)
    for side in _BOTH:
        w.box(
            (0.028, 0.032),
            (side * 0.35 * width - 0.008, side * 0.35 * width + 0.008),
            (height - 0.09 - 0.065 * count, height - 0.05),
            w.look("linen"),
            solid=False,
        )


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


# ---- furniture of no other category ---------------------------------------------------------------------------------


def upright_piano(w: Workbench) -> None:
    """Upright piano with keys, music desk and pedals."""
    high, half, look = (
        w.length(1.10, 1.28),
        0.5 * w.length(1.42, 1.52),
        w.look("dark") if w.chance(0.5) else w.look("wood"),
    )
    w.box((-0.30, 0.02), (-half, half), (0.05, high), look)
    w.box((-0.31, 0.05), (-half - 0.01, half + 0.01), (high, high + 0.025), look)
    w.box((0.02, 0.28), (-half, half), (0.58, 0.72), look)
    for side in _BOTH:
        c = side * (half - 0.03)
        w.box((-0.30, 0.30), (c - 0.03, c + 0.03), (0.0, 0.06), look)
        w.box((0.22, 0.28), (c - 0.03, c + 0.03), (0.05, 0.60), look)
    w.box((0.11, 0.27), (-half + 0.08, half - 0.08), (0.72, 0.735), w.look("ceramic"), solid=False)
    w.box((0.11, 0.20), (-half + 0.10, half - 0.10), (0.735, 0.745), w.look("char"), solid=False)
    w.box((0.02, 0.05), (-0.40, 0.40), (0.86, 1.04), look, tilt=-0.25, solid=False)
    for y in (-0.1, 0.0, 0.1):
        w.box((0.02, 0.14), (y - 0.015, y + 0.015), (0.05, 0.065), w.look("brass"), solid=False)
    w.top((-0.25, 0.0), (-half + 0.1, half - 0.1), high + 0.025)


def folding_screen(w: Workbench) -> None:
    """Room divider: three or four panels in zigzag."""
    panels, each, high = w.whole(3, 4), w.length(0.42, 0.50), w.length(1.65, 1.80)
    wood, cloth = w.look("wood"), w.look("curtain")
    fold = 0.35
    run = each * math.cos(fold)
    for i in range(panels):
        sign = 1 if i % 2 == 0 else -1
        c = (i + 0.5 - 0.5 * panels) * run
        dx, dy = -math.sin(sign * fold), math.cos(sign * fold)
        w.box(
            (-0.008, 0.008),
            (c - 0.5 * each + 0.02, c + 0.5 * each - 0.02),
            (0.10, high - 0.03),
            cloth,
            turn=sign * fold,
        )
        for t in (-0.5 * each + 0.015, 0.5 * each - 0.015):
            w.box(
                (t * dx - 0.014, t * dx + 0.014),
                (c + t * dy - 0.014, c + t * dy + 0.014),
                (0.0, high),
                wood,
                turn=sign * fold,
            )
        for z in (0.10, high - 0.03):
            w.box(
                (-0.012, 0.012),
                (c - 0.5 * each + 0.02, c + 0.5 * each - 0.02),
                (z - 0.02, z + 0.02),
                wood,
                turn=sign * fold,
            )


# ---- objects -----------------------------------------------------------------------------------------------------


def book_stack(w: Workbench) -> None:
    """Three or four books lying on each other."""
    z = 0.0
    for _ in range(w.whole(3, 4)):
        thick, dx, dy = w.length(0.02, 0.04), w.length(0.075, 0.10), w.length(0.10, 0.13)
        w.box((-dx, dx), (-dy, dy), (z, z + thick), w.new_look("book"), turn=w.length(-0.25, 0.25))
        z += thick


def vase(w: Workbench) -> None:
    """Vase with a few flowers."""
    r, high = w.length(0.05, 0.08), w.length(0.16, 0.26)
    w.mesh(
        loft(
            [
                Ring(0.0, 0.6 * r, 0.6 * r),
                Ring(0.4 * high, r, r),
                Ring(0.8 * high, 0.45 * r, 0.45 * r),
                Ring(high, 0.6 * r, 0.6 * r),
            ],
            12,
        ),
        (0.0, 0.0, 0.0),
        w.look("pot"),
    )
    for i in range(3):
        a = math.tau * i / 3
        tip = (0.07 * math.cos(a), 0.07 * math.sin(a), high + 0.13 + 0.02 * i)
        w.rod((0.0, 0.0, 0.9 * high), tip, 0.003, w.look("foliage"), solid=False)
        w.ball(tip, 0.028, w.look("flower"), solid=False)


def box_crate(w: Workbench) -> None:
    """Cardboard box, taped."""
    dx, dy, dz = 0.5 * w.length(0.28, 0.42), 0.5 * w.length(0.34, 0.55), w.length(0.24, 0.38)
    w.box((-dx, dx), (-dy, dy), (0.0, dz), w.look("wicker"))
    w.box((-dx - 0.001, dx + 0.001), (-0.025, 0.025), (dz - 0.08, dz + 0.002), w.look("paper"), solid=False)


def fruit_bowl(w: Workbench) -> None:
    """Shallow bowl of fruit."""
    r = w.length(0.12, 0.16)
    w.mesh(
        loft(
            [
                Ring(0.0, 0.4 * r, 0.4 * r),
                Ring(0.07, r, r),
                Ring(0.07, 0.92 * r, 0.92 * r),
                Ring(0.025, 0.4 * r, 0.4 * r),
            ],
            14,
        ),
        (0.0, 0.0, 0.0),
        w.look("ceramic"),
    )
    for i in range(4):
        a = math.tau * i / 3
        at = (0.45 * r * math.cos(a), 0.45 * r * math.sin(a), 0.07) if i < 3 else (0.0, 0.0, 0.11)
        w.ball(at, 0.042, w.new_look("paint"), solid=False)


STYLES = (
    Style("fireplace", "mantel", "train", mantel),
    Style("fireplace", "stove_iron", "heldout", stove_iron),
    Style("lighting", "pendant", "train", pendant, ("ceiling",), "ceiling"),
    Style("lighting", "ceiling_disc", "train", ceiling_disc, ("ceiling",), "ceiling"),
    Style("lighting", "globe_pendant", "heldout", globe_pendant, ("ceiling",), "ceiling"),
    Style("lighting", "floor_lamp", "train", floor_lamp, ("floor",)),
    Style("lighting", "tripod_lamp", "heldout", tripod_lamp, ("floor",)),
    Style("lighting", "table_lamp", "train", table_lamp, ("table",), "top"),
    Style("lighting", "mushroom_lamp", "heldout", mushroom_lamp, ("table",), "top"),
    Style("blinds", "roller", "train", roller_blind, (), "wall"),
    Style("blinds", "slatted", "heldout", slatted_blind, (), "wall"),
    Style("column", "round", "train", round_column),
    Style("column", "square", "heldout", square_column),
    Style("railing", "balusters", "train", baluster_railing),
    Style("railing", "glass", "heldout", glass_railing),
    Style("furniture", "upright_piano", "train", upright_piano, ("piano",)),
    Style("furniture", "folding_screen", "heldout", folding_screen, ("screen",)),
    Style("objects", "book_stack", "train", book_stack, ("top",), "top"),
    Style("objects", "vase", "heldout", vase, ("top",), "top"),
    Style("objects", "fruit_bowl", "train", fruit_bowl, ("kitchen", "top"), "top"),
    Style("objects", "crate", "train", box_crate, ("floor",)),
)
