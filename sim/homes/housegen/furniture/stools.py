"""Bar stools and low stools.

Sizes follow Panero & Zelnik, Human Dimension and Interior Space (bar seats 0.62-0.78 m, low stools 0.42-0.47 m high,
0.30-0.40 m across).
"""

from __future__ import annotations

import math

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, inset, polar
from sim.homes.housegen.furniture.shapes import Ring, chamfered_box, frustum, loft, puffed, strip, turned
from sim.homes.housegen.furniture.workbench import CORNERS, Workbench


def bar_wood(w: Workbench) -> None:
    """Builds a bar stool with a square seat, four slightly splayed legs and footrests."""
    w.mass_kg = 5.0
    seat, half, wood = w.length(0.66, 0.76), 0.5 * w.length(0.32, 0.38), w.look("wood")
    w.mesh(
        chamfered_box((2 * half, 2 * half, 0.05), 0.015),
        (0.0, 0.0, seat - 0.025),
        w.look("leather") if w.chance(0.4) else wood,
    )
    for sx, sy in CORNERS:
        w.bar(
            (sx * (half + 0.02), sy * (half + 0.02), 0.0),
            (sx * (half - 0.03), sy * (half - 0.03), seat - 0.05),
            0.036,
            0.036,
            wood,
        )
    for side in BOTH_SIDES:
        edge = half + 0.002
        w.box(around(side * edge, 0.012), (-edge, edge), (0.24, 0.27), wood)
        w.box((-edge, edge), around(side * edge, 0.012), (0.30, 0.33), wood)


def low_round(w: Workbench) -> None:
    """Builds a low stool with a round seat and three or four splayed legs."""
    w.mass_kg = 3.5
    seat, r, wood = w.length(0.43, 0.47), 0.5 * w.length(0.32, 0.38), w.look("wood")
    w.cylinder((0.0, 0.0), (seat - 0.04, seat), r, w.look("lacquer") if w.chance(0.4) else wood)
    count = w.whole(3, 4)
    for i in range(count):
        a = math.tau * (i + 0.5) / count
        c, s = math.cos(a), math.sin(a)
        w.rod(
            ((r + 0.02) * c, (r + 0.02) * s, 0.014),
            (0.6 * r * c, 0.6 * r * s, seat - 0.03),
            0.016,
            wood,
            round_ends=True,
        )


def saddle(w: Workbench) -> None:
    """Builds a bar stool without a back: a curved saddle seat on a sled of steel rod."""
    w.mass_kg = 5.0
    seat, half, iron = w.length(0.62, 0.74), 0.19, w.look("iron")
    w.mesh(
        loft(
            [Ring(-0.03, 0.13, 0.17, power=4), Ring(0.0, 0.16, half, power=4), Ring(0.03, 0.15, half - 0.01, power=4)],
            12,
            hull=True,
        ),
        (0.0, 0.0, seat - 0.03),
        w.look("wood"),
    )
    for y in inset((-half, half), 0.02):
        for x0, x1 in ((-0.19, -0.10), (0.19, 0.10)):
            w.rod((x0, y, 0.009), (x1, y * 0.8, seat - 0.05), 0.009, iron, round_ends=True)
        w.rod_x((y, 0.009), (-0.19, 0.19), 0.009, iron)
    for x, z in ((0.163, 0.20), (-0.163, 0.20)):
        w.rod_y((x, z), (-half + 0.03, half - 0.03), 0.009, iron)


def bar_swivel(w: Workbench) -> None:
    """Builds a bar stool on a trumpet foot with a gas spring and a low back."""
    w.mass_kg = 8.0
    seat, metal, cover = w.length(0.64, 0.76), w.look("chrome"), w.look("leather")
    w.cylinder((0.0, 0.0), (0.0, 0.02), 0.20, metal)
    w.cylinder((0.0, 0.0), (0.015, 0.06), 0.06, metal)
    w.cylinder((0.0, 0.0), (0.05, seat - 0.05), 0.026, metal)
    w.mesh(chamfered_box((0.37, 0.40, 0.08), 0.03), (0.0, 0.0, seat - 0.035), cover)
    w.mesh(chamfered_box((0.06, 0.40, 0.20), 0.025), (-0.17, 0.0, seat + 0.06), cover, tilt=-0.15)
    for a, b in (((0.0, 0.0), (0.16, 0.09)), ((0.16, 0.09), (0.16, -0.09)), ((0.16, -0.09), (0.0, 0.0))):
        w.rod((*a, 0.28), (*b, 0.28), 0.009, metal, round_ends=True)


def step_stool(w: Workbench) -> None:
    """Builds a step stool: two treads between solid sides."""
    w.mass_kg = 5.0
    high, half, look = (
        w.length(0.42, 0.46),
        0.5 * w.length(0.36, 0.42),
        w.look("lacquer") if w.chance(0.5) else w.look("wood"),
    )
    for y in inset((-half, half), 0.012):
        w.box((-0.20, 0.0), around(y, 0.012), (0.0, high - 0.025), look)
        w.box((0.0, 0.20), around(y, 0.012), (0.0, 0.5 * high - 0.025), look)
    w.box((-0.21, 0.01), (-half, half), (high - 0.025, high), look)
    w.box((0.0, 0.21), (-half, half), (0.5 * high - 0.025, 0.5 * high), look)
    w.box((-0.20, -0.185), (-half + 0.02, half - 0.02), (0.08, high - 0.03), look)


def vanity_stool(w: Workbench) -> None:
    """Builds a round upholstered seat on a ring of brass legs."""
    w.mass_kg = 5.0
    seat, r, metal = w.length(0.43, 0.47), 0.5 * w.length(0.36, 0.42), w.look("brass")
    w.mesh(puffed(r, 0.10, firm=4.0), (0.0, 0.0, seat - 0.10), w.look("bright"))
    for i in range(4):
        a = math.tau * (i + 0.5) / 4
        w.rod((*polar(0.9 * r, a), 0.0), (*polar(0.9 * r, a), seat - 0.08), 0.012, metal)
    w.rod((0.64 * r, 0.64 * r, 0.10), (-0.64 * r, -0.64 * r, 0.10), 0.007, metal)
    w.rod((0.64 * r, -0.64 * r, 0.10), (-0.64 * r, 0.64 * r, 0.10), 0.007, metal)


def bar_steel(w: Workbench) -> None:
    """Builds a stacking bar stool of pressed steel with a square seat and legs that spread into a square."""
    w.mass_kg = 5.5
    seat, steel = w.length(0.64, 0.76), w.look("lacquer") if w.chance(0.5) else w.look("metal")
    w.mesh(chamfered_box((0.31, 0.31, 0.03), 0.012), (0.0, 0.0, seat - 0.015), steel)
    for sx, sy in CORNERS:
        w.mesh(
            frustum((0.03, 0.03), (0.07, 0.07), seat - 0.02, (-sx * 0.075, -sy * 0.075)),
            (sx * 0.195, sy * 0.195, 0.0),
            steel,
        )
    for side in BOTH_SIDES:
        w.box(around(side * 0.172, 0.006), (-0.17, 0.17), (0.26, 0.30), steel)
        w.box((-0.17, 0.17), around(side * 0.172, 0.006), (0.26, 0.30), steel)


def stump(w: Workbench) -> None:
    """Builds a solid wooden stool in the shape of an hourglass."""
    w.mass_kg = 12.0
    high, r = w.length(0.42, 0.46), 0.5 * w.length(0.30, 0.36)
    shares = [(0.0, 0.97), (0.03, 1.0), (0.25, 0.82), (0.5, 0.7), (0.75, 0.82), (0.97, 1.0), (1.0, 0.97)]
    w.mesh(turned([(z * high, s * r) for z, s in shares], 20), (0.0, 0.0, 0.0), w.look("wood"))


def folding_stool(w: Workbench) -> None:
    """Builds a camp stool with crossed legs under a sling of cloth."""
    w.mass_kg = 3.0
    seat, half, wood = w.length(0.42, 0.46), 0.5 * w.length(0.36, 0.42), w.look("wood")
    for y in inset((-half, half), 0.015):
        w.bar((-0.20, y, 0.0), (0.20, y, seat), 0.022, 0.03, wood)
        w.bar((0.20, y * 0.88, 0.0), (-0.20, y * 0.88, seat), 0.022, 0.03, wood)
    for x in (-0.20, 0.20):
        w.rod_y((x, seat - 0.01), (-half, half), 0.015, wood)
        w.rod_y((x * 0.9, 0.05), (-half + 0.02, half - 0.02), 0.010, wood)
    w.mesh(
        strip([(-0.21, seat), (-0.10, seat - 0.035), (0.10, seat - 0.035), (0.21, seat)], 0.008, 2 * half - 0.05),
        (0.0, 0.0, 0.0),
        w.look("bright"),
    )


STYLES = (
    Style("stool", "bar_wood", "train", bar_wood, ("bar",)),
    Style("stool", "low_round", "train", low_round, ("low",)),
    Style("stool", "bar_swivel", "train", bar_swivel, ("bar",)),
    Style("stool", "step_stool", "train", step_stool, ("low",)),
    Style("stool", "vanity_stool", "train", vanity_stool, ("low",)),
    Style("stool", "bar_steel", "train", bar_steel, ("bar",)),
    Style("stool", "saddle", "heldout", saddle, ("bar",)),
    Style("stool", "stump", "heldout", stump, ("low",)),
    Style("stool", "folding", "heldout", folding_stool, ("low",)),
)
