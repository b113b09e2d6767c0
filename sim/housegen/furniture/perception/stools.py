"""Stools of the pool `wide`."""

from __future__ import annotations

import itertools
import math

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.item import Look
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring, frustum, loft, strip
from sim.housegen.furniture.workbench import Workbench


def _legs_in_ring(w: Workbench, count: int, inner: float, outer: float, top: float, r: float, look: Look) -> None:
    """Adds legs in a ring that spread from `inner` below the seat to `outer` on the floor."""
    for i in range(count):
        a = math.tau * (i + 0.5) / count
        c, s = math.cos(a), math.sin(a)
        w.rod((outer * c, outer * s, r), (inner * c, inner * s, top), r, look, round_ends=True)


def bar_backed(w: Workbench) -> None:
    """Builds a bar chair on four legs with footrails and a low curved back."""
    w.mass_kg = 7.0
    seat, half, wood = (
        w.length(0.62, 0.78),
        0.5 * w.length(0.38, 0.46),
        parts.wood_look(w, 0.3) if w.chance(0.6) else parts.tube_look(w),
    )
    t, high = w.length(0.024, 0.036), w.length(0.16, 0.40)
    splay = w.choice((0.0, 0.0, 0.03))
    w.legs((-half, half), (-half, half), (0.0, seat - 0.03), t, wood, splay=splay)
    parts.pad(
        w, (2 * half + 0.02, 2 * half + 0.02, 0.06), (0.0, 0.0, seat - 0.015), parts.upholstery_look(w, 0.5), 0.022
    )
    foot = w.length(0.18, 0.30)
    e = half + splay * (1.0 - foot / seat) - (0.0 if splay else 0.5 * t)
    for side in BOTH_SIDES:
        w.box((-e, e), (side * e - 0.011, side * e + 0.011), (foot, foot + 0.025), wood)
        z = foot + 0.04 * side
        w.box((side * e - 0.011, side * e + 0.011), (-e, e), (z, z + 0.025), wood)
        y = side * (half - 0.5 * t)
        w.bar((-half + 0.01, y, seat - 0.05), (-half - 0.04, y, seat + high), t, t, wood)
    board = wood if w.chance(0.5) else parts.upholstery_look(w, 0.5)
    parts.curved_board(w, -half - 0.06, half, (seat + high - w.length(0.06, 0.14), seat + high), board, 0.025, 0.04)


def bar_screw(w: Workbench) -> None:
    """Builds a workshop stool with a threaded spindle in an iron frame."""
    w.mass_kg = 9.0
    seat, r, iron = w.length(0.62, 0.78), 0.5 * w.length(0.32, 0.38), w.look("iron")
    w.cylinder((0.0, 0.0), (seat - 0.035, seat), r, w.look(w.choice(("wood", "iron", "leather"))))
    w.cylinder((0.0, 0.0), (seat - 0.055, seat - 0.03), 0.6 * r, iron)
    w.cylinder((0.0, 0.0), (0.20, seat - 0.04), 0.018, w.look("metal"))
    w.cylinder((0.0, 0.0), (0.40, 0.52), 0.045, iron)
    outer, count, ring = w.length(0.20, 0.26), w.whole(3, 4), w.length(0.18, 0.26)
    _legs_in_ring(w, count, 0.04, outer, 0.50, 0.013, iron)
    reach = outer - (outer - 0.04) * ring / 0.50
    sides = 12
    points = [
        (reach * math.cos(math.tau * i / sides), reach * math.sin(math.tau * i / sides), ring) for i in range(sides + 1)
    ]
    parts.tube_along(w, points, 0.009, iron)
    if w.chance(0.4):
        w.bar((-0.6 * r, 0.0, seat - 0.04), (-r - 0.03, 0.0, seat + 0.26), 0.04, 0.008, iron)
        parts.curved_board(w, -r - 0.05, 0.15, (seat + 0.18, seat + 0.30), w.look("wood"), 0.02, 0.03)


def bar_sled(w: Workbench) -> None:
    """Builds a bar stool of bent tubes with a curved seat and a low back."""
    w.mass_kg = 6.0
    seat, half, tube = w.length(0.62, 0.78), 0.5 * w.length(0.38, 0.46), parts.tube_look(w)
    r = 0.010
    for side in BOTH_SIDES:
        y = side * (half - 0.03)
        loop = [(0.14, y, seat - 0.03), (0.21, y, r), (-0.21, y, r), (-0.14, y, seat - 0.03), (0.14, y, seat - 0.03)]
        parts.tube_along(w, loop, r, tube)
    for x, z in ((0.21, r), (-0.21, r), (0.21 - 0.07 * 0.25 / seat, 0.25)):
        w.rod((x, -half + 0.03, z), (x, half - 0.03, z), r, tube)
    back = w.length(0.03, 0.28)
    path = [
        (-0.20 - 0.3 * back, seat + back),
        (-0.18, seat + 0.02),
        (-0.13, seat - 0.015),
        (0.15, seat - 0.015),
        (0.20, seat - 0.03),
    ]
    cover = w.look(w.choice(("plastic", "wood", "leather", "wicker")))
    w.mesh(strip(path, w.choice((0.014, 0.035)), 2 * half), (0.0, 0.0, 0.0), cover)


def bar_block(w: Workbench) -> None:
    """Builds a bar stool with flat side panels as legs."""
    w.mass_kg = 8.0
    seat, half, look = w.length(0.62, 0.76), 0.5 * w.length(0.32, 0.42), parts.wood_look(w, 0.4)
    pad = w.length(0.03, 0.10)
    for side in BOTH_SIDES:
        y = side * (half - 0.015)
        w.box((-half, half), (y - 0.015, y + 0.015), (0.0, seat - pad + 0.01), look)
    for z in (w.length(0.18, 0.28), seat - pad - 0.02):
        w.box((-half + 0.02, half - 0.02), (-half, half), (z - 0.015, z + 0.015), look)
    parts.pad(
        w, (2 * half + 0.01, 2 * half + 0.01, pad), (0.0, 0.0, seat - 0.5 * pad), parts.upholstery_look(w, 0.6), 0.02
    )
    if w.chance(0.4):
        parts.pad(w, (0.05, 2 * half, 0.24), (-half + 0.02, 0.0, seat + 0.10), parts.upholstery_look(w, 0.6), 0.02)


def plastic_stool(w: Workbench) -> None:
    """Builds a moulded plastic stool with flared legs, or two stacked ones."""
    w.mass_kg = 1.5
    seat, top, foot = w.length(0.42, 0.47), w.length(0.26, 0.32), w.length(0.32, 0.40)
    plastic = w.look("plastic")
    stack = w.chance(0.25)
    seat = seat - 0.05 if stack else seat
    square = w.chance(0.6)
    for k in range(2 if stack else 1):
        z, colour = 0.05 * k, plastic if k == 0 else w.new_look("plastic")
        if square:
            parts.pad(w, (top, top, 0.03), (0.0, 0.0, z + seat - 0.015), colour, 0.012)
            skirt = frustum((top + 0.015, top + 0.015), (top - 0.005, top - 0.005), 0.07)
            w.mesh(skirt, (0.0, 0.0, z + seat - 0.09), colour)
        else:
            w.cylinder((0.0, 0.0), (z + seat - 0.02, z + seat), 0.5 * top + 0.015, colour)
            w.cylinder((0.0, 0.0), (z + seat - 0.07, z + seat - 0.015), 0.5 * top + 0.025, colour)
        for sx, sy in itertools.product(BOTH_SIDES, BOTH_SIDES):
            at = (sx * (0.5 * foot - 0.03), sy * (0.5 * foot - 0.03))
            lean = (sx * (0.5 * top - 0.045) - at[0], sy * (0.5 * top - 0.045) - at[1])
            w.mesh(frustum((0.05, 0.05), (0.08, 0.08), seat - 0.03, lean), (*at, z), colour)


def butterfly_stool(w: Workbench) -> None:
    """Builds a stool of two bent boards back to back, or of one board bent into an arch."""
    w.mass_kg = 3.0
    seat, width, wood = w.length(0.40, 0.46), w.length(0.30, 0.38), w.look("wood")
    if w.chance(0.6):
        path = [(0.20, 0.0), (0.09, 0.10), (0.025, 0.5 * seat), (0.03, seat - 0.08), (0.08, seat - 0.03), (0.22, seat)]
        w.mesh(strip(path[::-1], 0.012, width), (0.0, 0.0, 0.0), wood)
        w.mesh(strip(path[::-1], 0.012, width), (0.0, 0.0, 0.0), wood, turn=math.pi)
        w.rod((-0.05, 0.0, 0.5 * seat), (0.05, 0.0, 0.5 * seat), 0.008, w.look("brass"))
    else:
        lean = w.length(0.0, 0.05)
        path = [
            (-0.20 - lean, 0.0),
            (-0.20, seat - 0.06),
            (-0.17, seat - 0.02),
            (0.17, seat - 0.02),
            (0.20, seat - 0.06),
            (0.20 + lean, 0.0),
        ]
        w.mesh(strip(path, 0.02, width), (0.0, 0.0, 0.0), wood)
        w.rod((-0.20, 0.0, 0.15), (0.20, 0.0, 0.15), 0.012, wood)


def curule(w: Workbench) -> None:
    """Builds a low stool on crossed curved legs."""
    w.mass_kg = 5.0
    seat, half, depth = w.length(0.42, 0.47), 0.5 * w.length(0.44, 0.56), w.length(0.34, 0.42)
    frame = w.look(w.choice(("wood", "brass", "chrome", "lacquer")))
    for side in BOTH_SIDES:
        x = side * (0.5 * depth - 0.03)
        for sign in BOTH_SIDES:
            ends = [
                (x, sign * (half - 0.03), 0.0),
                (x, sign * 0.10, 0.38 * seat),
                (x, -sign * 0.10, 0.55 * seat),
                (x, -sign * (half - 0.03), seat - 0.05),
            ]
            for a, b in itertools.pairwise(ends):
                w.bar(a, b, 0.035, 0.025, frame)
    w.rod((-0.5 * depth + 0.03, 0.0, 0.465 * seat), (0.5 * depth - 0.03, 0.0, 0.465 * seat), 0.013, frame)
    parts.pad(w, (depth, 2 * half, w.length(0.06, 0.11)), (0.0, 0.0, seat - 0.035), parts.upholstery_look(w, 0.4), 0.03)


def rush_stool(w: Workbench) -> None:
    """Builds a square stool with four posts, stretchers and a seat of woven cord."""
    w.mass_kg = 3.5
    seat, half, wood = w.length(0.42, 0.47), 0.5 * w.length(0.32, 0.42), parts.wood_look(w, 0.25)
    t = w.length(0.03, 0.045)
    w.legs((-half, half), (-half, half), (0.0, seat - 0.002), t, wood, round_=w.chance(0.5))
    e = half - 0.25 * t
    for z in (0.10, 0.20)[w.whole(0, 1) :]:
        for side in BOTH_SIDES:
            w.rod((-e, side * e, z), (e, side * e, z), 0.010, wood)
            w.rod((side * e, -e, z + 0.04), (side * e, e, z + 0.04), 0.010, wood)
    w.box((-half + 0.005, half - 0.005), (-half + 0.005, half - 0.005), (seat - 0.05, seat - 0.005), w.look("wicker"))
    if w.chance(0.3):
        parts.pad(
            w, (2 * half - 0.02, 2 * half - 0.02, 0.04), (0.0, 0.0, seat + 0.012), parts.upholstery_look(w, 0.1), 0.018
        )


def swivel_low(w: Workbench) -> None:
    """Builds a round padded work stool on a star base."""
    w.mass_kg = 6.0
    seat, r = w.length(0.43, 0.47), 0.5 * w.length(0.32, 0.40)
    parts.star_base(
        w,
        w.length(0.22, 0.27),
        w.choice((4, 5)),
        w.look(w.choice(("chrome", "dark"))),
        seat - 0.06,
        castors=w.chance(0.75),
    )
    thick = w.length(0.06, 0.10)
    puff = [Ring(0.0, 0.92 * r, 0.92 * r), Ring(0.015, r, r), Ring(thick - 0.02, r, r), Ring(thick, 0.88 * r, 0.88 * r)]
    w.mesh(loft(puff, 16, hull=True), (0.0, 0.0, seat - thick), parts.upholstery_look(w, 0.6))
    if w.chance(0.35):
        w.bar((-0.4 * r, 0.0, seat - 0.5 * thick), (-r - 0.04, 0.0, seat + 0.20), 0.04, 0.02, w.look("chrome"))
        parts.pad(w, (0.05, 0.28, 0.11), (-r - 0.03, 0.0, seat + 0.18), parts.upholstery_look(w, 0.6), 0.02)


STYLES: tuple[Style, ...] = (
    Style("stool", "bar_backed", "wide", bar_backed, ("bar",)),
    Style("stool", "bar_screw", "wide", bar_screw, ("bar",)),
    Style("stool", "bar_sled", "wide", bar_sled, ("bar",)),
    Style("stool", "bar_block", "wide", bar_block, ("bar",)),
    Style("stool", "plastic_stool", "wide", plastic_stool, ("low",)),
    Style("stool", "butterfly_stool", "wide", butterfly_stool, ("low",)),
    Style("stool", "curule", "wide", curule, ("low",)),
    Style("stool", "rush_stool", "wide", rush_stool, ("low",)),
    Style("stool", "swivel_low", "wide", swivel_low, ("low",)),
)
