"""Dining chairs of the pool `wide`."""

from __future__ import annotations

import math

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.chairs import DINING_KG
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring, arc_wall, frustum, loft, strip
from sim.housegen.furniture.workbench import Workbench


def wishbone(w: Workbench) -> None:
    """Builds a chair with a bent rail that forms short arms on a forked back, and a cord or padded seat."""
    w.mass_kg = DINING_KG
    seat, half, rail = w.length(0.43, 0.46), 0.5 * w.length(0.48, 0.58), w.length(0.68, 0.80)
    back, front, r = -0.5 * w.length(0.40, 0.46), 0.21, 0.0165
    wood = parts.wood_look(w, 0.3)
    middle = back + half
    reach = w.length(0.30, 0.46) * math.pi
    angles = [reach + (math.tau - 2 * reach) * i / 12 for i in range(13)]
    w.mesh(arc_wall(half, 0.03, rail - 0.03, angles, [rail] * 13), (middle, 0.0, 0.0), wood)
    arc = half - 0.015
    for side in BOTH_SIDES:
        y = side * (half - 0.03)
        w.rod((front, y, 0.0), (front - 0.01, y, seat), r, wood)
        knee = (back + 0.04, side * (half - 0.08), seat)
        w.rod((back + 0.02, side * (half - 0.06), 0.0), knee, r, wood)
        w.rod(knee, (middle - 0.37 * arc, side * 0.93 * arc, rail - 0.01), r, wood, round_ends=True)
        w.rod((front - 0.01, y, 0.26), (back + 0.03, side * (half - 0.07), 0.24), 0.010, wood)
    for x, gap in ((front - 0.01, 0.03), (back + 0.03, 0.07)):
        w.rod((x, -half + gap, 0.33), (x, half - gap, 0.33), 0.010, wood)
    low, x_rail = (back + 0.03, 0.0, seat - 0.02), middle - math.sqrt(arc * arc - 0.0081)
    if w.chance(0.6):
        fork = (0.5 * (low[0] + x_rail), 0.0, seat + 0.35 * (rail - seat))
        w.bar(low, fork, 0.05, 0.012, wood)
        for side in BOTH_SIDES:
            w.bar(fork, (x_rail, side * 0.09, rail - 0.01), 0.025, 0.012, wood)
    else:
        for y in (-0.08, 0.0, 0.08)[:: w.choice((1, 2))]:
            w.bar((low[0], y, low[2]), (x_rail, y, rail - 0.01), 0.03, 0.012, wood)
    cover = w.look("wicker") if w.chance(0.6) else parts.upholstery_look(w, 0.6)
    wide = (2 * half - 0.14, 2 * half - 0.05)
    w.mesh(
        frustum((front - back, wide[1]), (front - back - 0.02, wide[0]), 0.045), (0.5 * (front + back), 0, seat - 0.03),
        cover,
    )  # fmt: skip


def monobloc(w: Workbench) -> None:
    """Builds a one-piece plastic chair with flared legs and a slotted or plain back, with or without arms."""
    w.mass_kg = 3.0
    plastic, seat, half = w.look("plastic"), w.length(0.40, 0.45), 0.5 * w.length(0.42, 0.50)
    height, back, front = w.length(0.76, 0.90), -0.21, 0.22
    top_x = back - w.length(0.06, 0.14)
    parts.pad(w, (front - back, 2 * half, 0.03), (0.0, 0.0, seat - 0.015), plastic, 0.012)
    w.box((front - 0.015, front + 0.005), (-half + 0.02, half - 0.02), (seat - 0.07, seat - 0.01), plastic)
    splay = w.length(0.02, 0.06)
    for sx in BOTH_SIDES:
        for sy in BOTH_SIDES:
            x = (front if sx > 0 else back) - sx * 0.035
            y = sy * (half - 0.025)
            foot, top = (x + sx * splay, y + sy * splay), (x, y)
            shape = frustum((0.04, 0.04), (0.075, 0.055), seat - 0.01, (top[0] - foot[0], top[1] - foot[1]))
            w.mesh(shape, (*foot, 0.0), plastic)
    slats = w.choice((0, 3, 4, 5, 6))
    if slats:
        for i in range(slats):
            y = (i + 0.5) * 2 * (half - 0.05) / slats - half + 0.05
            w.bar((back + 0.01, y, seat - 0.01), (top_x + 0.01, y, height - 0.04), 0.6 * half / slats, 0.01, plastic)
    else:
        w.bar((back + 0.01, 0.0, seat - 0.01), (top_x + 0.01, 0.0, height - 0.06), 2 * half - 0.12, 0.01, plastic)
    for side in BOTH_SIDES:
        w.bar(
            (back + 0.01, side * (half - 0.03), seat - 0.02), (top_x + 0.01, side * (half - 0.04), height - 0.06), 0.05,
            0.025, plastic,
        )  # fmt: skip
    parts.curved_board(w, top_x - 0.02, half - 0.02, (height - 0.10, height), plastic, 0.02, 0.04)
    if w.chance(0.65):
        arm = seat + w.length(0.17, 0.23)
        for side in BOTH_SIDES:
            y = side * (half + 0.015)
            share = (arm - seat) / (height - seat)
            w.bar((front - 0.05, y, arm), (back + share * (top_x - back), y, arm), 0.055, 0.02, plastic)
            w.bar((front - 0.03, side * (half - 0.01), seat - 0.03), (front - 0.05, y, arm), 0.05, 0.03, plastic)


def folding_chair(w: Workbench) -> None:
    """Builds a chair with crossed legs at each side, a thin seat and a panel or slats at the back."""
    w.mass_kg = 4.0
    seat, half, height = w.length(0.43, 0.46), 0.5 * w.length(0.40, 0.46), w.length(0.76, 0.86)
    wooden = w.chance(0.4)
    frame = w.look("wood") if wooden else parts.tube_look(w)
    panel = frame if wooden or w.chance(0.4) else w.look(w.choice(("plastic", "dark", "leather", "wood")))
    front, rear, top_x = w.length(0.20, 0.26), -w.length(0.22, 0.28), -w.length(0.20, 0.26)
    r = 0.013
    for side in BOTH_SIDES:
        y, inner = side * (half - r), side * (half - 3.2 * r)
        if wooden:
            w.bar((front, y, 0.0), (top_x, y, height), 0.022, 0.035, frame)
            w.bar((rear, inner, 0.0), (0.17, inner, seat - 0.02), 0.022, 0.035, frame)
        else:
            w.rod((front, y, r), (top_x, y, height - r), r, frame, round_ends=True)
            w.rod((rear, inner, r), (0.17, inner, seat - 0.015), r, frame, round_ends=True)
    w.rod((rear + 0.04, -half + 0.03, 0.09), (rear + 0.04, half - 0.03, 0.09), 0.009, frame)
    share = 0.10 / height
    x_low = front + share * (top_x - front)
    w.rod((x_low, -half + r, 0.10), (x_low, half - r, 0.10), 0.009, frame)
    if wooden and w.chance(0.7):
        for i in range(6):
            x = -0.19 + i * 0.075
            w.box((x - 0.028, x + 0.028), (-half + 0.02, half - 0.02), (seat - 0.012, seat + 0.008), frame)
        for side in BOTH_SIDES:
            y = side * (half - 0.055)
            w.box((-0.20, 0.20), (y - 0.012, y + 0.012), (seat - 0.04, seat - 0.01), frame)
    else:
        thick = w.choice((0.02, 0.045))
        parts.pad(w, (0.40, 2 * half - 0.02, thick), (0.01, 0.0, seat - 0.5 * thick + 0.01), panel, 0.01)
    boards = w.whole(1, 3) if wooden else 1
    tall = w.length(0.14, 0.24) if boards == 1 else 0.055
    for i in range(boards):
        z = height - 0.02 - 0.5 * tall - i * 0.085
        x = front + (z / height) * (top_x - front)
        tilt = math.atan2(top_x - front, height)
        w.box((x - 0.009, x + 0.009), (-half + 0.005, half - 0.005), (z - 0.5 * tall, z + 0.5 * tall), panel, tilt=tilt)


def medallion(w: Workbench) -> None:
    """Builds a classical chair with an oval upholstered back on two posts and tapered legs."""
    w.mass_kg = 7.0
    seat, half, wood = w.length(0.45, 0.49), 0.5 * w.length(0.46, 0.54), parts.wood_look(w, 0.55)
    cloth = w.look("fabric") if w.chance(0.6) else w.look("linen")
    ry, rz = w.length(0.19, 0.24), w.length(0.20, 0.28)
    back, front = -0.23, 0.23
    bottom = seat + w.length(0.10, 0.16)
    x, z, power = back - 0.05, bottom + rz, w.choice((2.0, 2.0, 3.5))
    for grow, thick, dx, look in ((1.0, 0.04, 0.0, wood), (0.86, 0.06, 0.004, cloth)):
        rings = [
            Ring(-0.5 * thick, grow * rz, grow * ry, power=power),
            Ring(0.5 * thick, grow * rz, grow * ry, power=power),
        ]
        w.mesh(loft(rings, 18, hull=True), (x + dx, 0.0, z), look, tilt=0.5 * math.pi - 0.12)
    w.box((back, front), (-half, half), (seat - 0.12, seat - 0.05), wood)
    rings = [
        Ring(0.0, 0.225, half - 0.005, power=5),
        Ring(0.04, 0.225, half - 0.005, power=5),
        Ring(0.075, 0.17, 0.7 * half, power=4),
    ]
    w.mesh(loft(rings, 16, hull=True), (0.0, 0.0, seat - 0.055), cloth)
    for side in BOTH_SIDES:
        w.bar((back + 0.01, side * 0.10, seat - 0.08), (x + 0.01, side * 0.8 * ry, z - 0.45 * rz), 0.03, 0.03, wood)
        y = side * (half - 0.035)
        w.mesh(frustum((0.022, 0.022), (0.05, 0.05), seat - 0.08), (front - 0.035, y, 0.0), wood)
        w.mesh(frustum((0.025, 0.025), (0.05, 0.05), seat - 0.08, (0.05, 0.0)), (back - 0.015, y, 0.0), wood)
    if w.chance(0.35):
        arm = seat + 0.2
        for side in BOTH_SIDES:
            y = side * (half - 0.01)
            end = (x + 0.02, side * 0.9 * ry, arm + 0.06)
            parts.tube_along(
                w, [(front - 0.10, y, seat - 0.06), (front - 0.13, y, arm), (0.0, y, arm), end], 0.016, wood
            )


def pedestal(w: Workbench) -> None:
    """Builds a moulded shell on a stem with a round foot and a loose seat pad."""
    w.mass_kg = 8.0
    seat, half, height = w.length(0.43, 0.47), 0.5 * w.length(0.46, 0.54), w.length(0.76, 0.86)
    body, foot = w.look(w.choice(("plastic", "ceramic"))), w.length(0.22, 0.27)
    flare = [Ring(0.0, foot, foot), Ring(0.012, foot, foot), Ring(0.03, 0.5 * foot, 0.5 * foot), Ring(0.09, 0.04, 0.04),
             Ring(seat - 0.14, 0.025, 0.025), Ring(seat - 0.03, 0.09, 0.09)]  # fmt: skip
    w.mesh(loft(flare, 14), (0.0, 0.0, 0.0), w.look("chrome") if w.chance(0.25) else body)
    bowl = [Ring(0.0, 0.11, 0.12), Ring(0.025, 0.21, 0.9 * half), Ring(0.055, 0.24, half)]
    w.mesh(loft(bowl, 16, hull=True), (0.0, 0.0, seat - 0.05), body)
    n, spread = 9, w.length(0.30, 0.50) * math.pi
    angles = [math.pi + spread * (2 * i / (n - 1) - 1) for i in range(n)]
    rise = height - seat + 0.02
    tops = [max(0.05, rise * math.cos(0.5 * math.pi * abs(2 * i / (n - 1) - 1)) ** 0.7) for i in range(n)]
    w.mesh(arc_wall(0.235, 0.02, 0.0, angles, tops), (0.0, 0.0, seat - 0.02), body, tilt=-0.12)
    parts.pad(w, (0.34, 1.5 * half, 0.04), (0.02, 0.0, seat + 0.02), parts.upholstery_look(w, 0.2), 0.018)


def wire_chair(w: Workbench) -> None:
    """Builds a shell of crossed wires on runners or legs, with or without a thin pad."""
    w.mass_kg = 5.0
    seat, half, height = w.length(0.42, 0.45), 0.5 * w.length(0.46, 0.54), w.length(0.74, 0.86)
    wire, r = parts.tube_look(w), 0.005
    front, back = (0.24, seat + 0.01), (-0.19, seat - 0.03)
    top = (back[0] - w.length(0.08, 0.16), height)
    count, cross = w.whole(6, 8), w.whole(4, 5)
    for i in range(count):
        y = (2 * i / (count - 1) - 1) * (half - r)
        edge = 0.02 if i in (0, count - 1) else 0.0
        parts.tube_along(
            w, [(front[0], y, front[1]), (back[0], y, back[1] + edge), (top[0], y, top[1] - 2 * edge)], r, wire
        )
    for a, b in ((front, back), (back, top)):
        for i in range(cross):
            share = (i + (1 if b == top else 0)) / cross
            x, z = a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])
            w.rod((x, -half + r, z), (x, half - r, z), r, wire)
    sled, s = w.chance(0.6), 0.007
    for side in BOTH_SIDES:
        y, high = side * (half - 0.07), seat - 0.02
        if sled:
            parts.tube_along(w, [(0.10, y, high), (0.22, y, s), (-0.22, y, s), (-0.12, y, high)], s, wire)
        else:
            parts.tube_along(w, [(0.22, y, s), (0.05, y, high), (-0.22, y, s)], s, wire)
    for x in (0.10, -0.12) if sled else (0.05,):
        w.rod((x, -half + 0.07, seat - 0.02), (x, half - 0.07, seat - 0.02), s, wire)
    if w.chance(0.5):
        parts.pad(w, (0.38, 2 * half - 0.06, 0.03), (0.03, 0.0, seat + 0.012), parts.upholstery_look(w, 0.5), 0.012)


def school_chair(w: Workbench) -> None:
    """Builds a stacking chair of bent tubes with a seat board and a curved back board."""
    w.mass_kg = DINING_KG
    seat, half, height = w.length(0.42, 0.47), 0.5 * w.length(0.38, 0.46), w.length(0.74, 0.86)
    tube, r = parts.tube_look(w), w.choice((0.009, 0.012))
    board = w.look(w.choice(("wood", "plastic", "wood", "leather")))
    padded = board == w.look("leather")
    back, front, top_x = -0.19, 0.19, -w.length(0.23, 0.29)
    kind = w.choice(("legs", "sled", "back_legs"))
    for side in BOTH_SIDES:
        y = side * (half - 0.03)
        upper = [(front - 0.04, y, seat - 0.02), (back + 0.02, y, seat - 0.03), (top_x + 0.02, y, height - 0.04)]
        if kind == "sled":
            parts.tube_along(
                w, [(0.02, y, seat - 0.03), (0.23, y, r), (-0.25, y, r), (back + 0.02, y, seat - 0.03)], r, tube
            )
            parts.tube_along(w, upper, r, tube)
        elif kind == "legs":
            parts.tube_along(w, [(front + 0.02, y, r), *upper], r, tube)
            w.rod((-0.02, y, seat - 0.03), (back - 0.06, y, r), r, tube, round_ends=True)
        else:
            parts.tube_along(w, [(front, y, r), (front - 0.02, y, seat - 0.02), (back, y, seat - 0.02)], r, tube)
            parts.tube_along(w, [(back - 0.06, y, r), (back - 0.01, y, seat), upper[-1]], r, tube)
    w.rod((back + 0.01, -half + 0.03, seat - 0.03), (back + 0.01, half - 0.03, seat - 0.03), r, tube)
    if padded:
        parts.pad(w, (0.40, 2 * half, 0.06), (0.01, 0.0, seat + 0.015), board, 0.025)
    else:
        path = [(0.21, seat - 0.035), (0.18, seat - 0.005), (0.05, seat - 0.008), (-0.12, seat - 0.012), (-0.20, seat)]
        w.mesh(strip(path[::-1], 0.012, 2 * half), (0.0, 0.0, 0.0), board)
    tall = w.length(0.12, 0.26)
    parts.curved_board(
        w, top_x - 0.02, half, (height - tall, height), board, 0.035 if padded else 0.014, w.length(0.03, 0.06)
    )


def plank_chair(w: Workbench) -> None:
    """Builds a chair of boards with solid sides and a plain or split back."""
    w.mass_kg = 6.0
    seat, half, height = w.length(0.42, 0.46), 0.5 * w.length(0.38, 0.46), w.length(0.74, 0.98)
    wood, t = parts.wood_look(w, 0.4), w.choice((0.018, 0.025, 0.032))
    w.box((-0.21, 0.22), (-half, half), (seat - t, seat), wood)
    for side in BOTH_SIDES:
        y = side * (half - w.choice((0.5 * t, 0.04)))
        w.box((-0.20, 0.20), (y - 0.5 * t, y + 0.5 * t), (0.0, seat - t), wood)
    w.box((-0.015, 0.015), (-half + 0.04, half - 0.04), (seat - 0.16, seat - t), wood)
    top_x = -0.21 - w.length(0.03, 0.10)
    if w.chance(0.5):
        w.bar((-0.20, 0.0, seat - t), (top_x, 0.0, height), w.length(0.7, 1.0) * 2 * half, t, wood)
    else:
        gap = 0.06
        for side in BOTH_SIDES:
            wide = half - gap
            y = side * (gap + 0.5 * wide)
            w.bar((-0.20, y, seat - t), (top_x, y, height), wide, t, wood)
        w.box((top_x - 0.01, top_x + 0.03), (-half + 0.01, half - 0.01), (height - 0.07, height), wood)
    if w.chance(0.4):
        parts.pad(w, (0.38, 2 * half - 0.04, 0.045), (0.01, 0.0, seat + 0.02), parts.upholstery_look(w, 0.2), 0.02)


STYLES: tuple[Style, ...] = (
    Style("chair", "wishbone", "wide", wishbone, ("dining",)),
    Style("chair", "monobloc", "wide", monobloc, ("dining",)),
    Style("chair", "folding_chair", "wide", folding_chair, ("dining",)),
    Style("chair", "medallion", "wide", medallion, ("dining",)),
    Style("chair", "pedestal", "wide", pedestal, ("dining",)),
    Style("chair", "wire_chair", "wide", wire_chair, ("dining",)),
    Style("chair", "school_chair", "wide", school_chair, ("dining",)),
    Style("chair", "plank_chair", "wide", plank_chair, ("dining",)),
)
