"""Benches of the pool `wide`."""

from __future__ import annotations

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.item import Look
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.workbench import Workbench


def _bench_supports(w: Workbench, width: float, depth: float, top: float, look: Look, kind: str) -> None:
    """Adds the support of a bench near its ends: posts, a hoop, a trapezium, a panel or a cross."""
    for side in BOTH_SIDES:
        y, half = side * (0.5 * width - w.length(0.06, 0.14)), 0.5 * depth - 0.03
        if kind == "hoop":
            parts.tube_along(w, [(-half, y, top), (-half, y, 0.012), (half, y, 0.012), (half, y, top)], 0.012, look)
        elif kind == "trapezium":
            for x in BOTH_SIDES:
                w.bar((x * half, y, 0.0), (0.75 * x * half, y, top), 0.045, 0.03, look)
            w.box((-half, half), (y - 0.022, y + 0.022), (0.0, 0.022), look)
            w.box((-half, half), (y - 0.022, y + 0.022), (top - 0.03, top), look)
        elif kind == "panel":
            w.box((-half, half), (y - 0.02, y + 0.02), (0.0, top), look)
        elif kind == "cross":
            for x in BOTH_SIDES:
                w.bar((x * half, y, 0.0), (-x * half, y, top), 0.035, 0.05, look)
        else:
            for x in BOTH_SIDES:
                w.bar((x * half, y + side * 0.02, 0.0), (0.9 * x * half, y, top), 0.045, 0.045, look)


def slat_bench(w: Workbench) -> None:
    """Builds a bench of long slats on metal or wooden end frames."""
    width, depth, seat = w.width(0.95, 1.60), w.depth(0.34, 0.48), w.length(0.36, 0.46)
    wood, slats = parts.wood_look(w, 0.2), w.whole(4, 10)
    legs = wood if w.chance(0.4) else w.look(w.choice(("iron", "chrome", "dark")))
    each, thick = depth / slats, w.choice((0.025, 0.04))
    for i in range(slats):
        x = (i + 0.5) * each - 0.5 * depth
        w.box((x - 0.36 * each, x + 0.36 * each), (-0.5 * width, 0.5 * width), (seat - thick, seat), wood)
    for side in BOTH_SIDES:
        y = side * (0.5 * width - 0.10)
        w.box(
            (-0.5 * depth + 0.01, 0.5 * depth - 0.01), (y - 0.07, y + 0.07), (seat - thick - 0.02, seat - thick), legs
        )
    _bench_supports(w, width, depth, seat - thick - 0.01, legs, w.choice(("hoop", "trapezium", "posts", "panel")))
    if w.chance(0.25):
        parts.pad(
            w, (depth - 0.02, 0.45 * width, 0.06), (0.0, 0.24 * width, seat + 0.03), parts.upholstery_look(w), 0.02
        )
    w.top((-0.45 * depth, 0.45 * depth), (-0.45 * width, 0.45 * width), seat, "seat")


def woven_bench(w: Workbench) -> None:
    """Builds a bench with corner posts, rails and a seat of cord or straps."""
    width, depth, seat = w.width(0.90, 1.40), w.depth(0.36, 0.46), w.length(0.42, 0.48)
    wood, t = parts.wood_look(w, 0.2), w.length(0.035, 0.05)
    x, y = parts.footprint(depth, width)
    rise = w.choice((0.0, 0.0, 0.06, 0.16))
    w.legs((x[0] + 0.5 * t, x[1] - 0.5 * t), (y[0] + 0.5 * t, y[1] - 0.5 * t), (0.0, seat + rise), t, wood, round_=True)
    for side in BOTH_SIDES:
        for z in (seat - 0.03, w.length(0.12, 0.20)):
            w.rod((side * 0.5 * (depth - t), y[0] + t, z), (side * 0.5 * (depth - t), y[1] - t, z), 0.014, wood)
            w.rod(
                (x[0] + t, side * 0.5 * (width - t), z + 0.02),
                (x[1] - t, side * 0.5 * (width - t), z + 0.02),
                0.014,
                wood,
            )
        if rise > 0.1:
            w.rod(
                (x[0] + t, side * 0.5 * (width - t), seat + rise - 0.03),
                (x[1] - t, side * 0.5 * (width - t), seat + rise - 0.03),
                0.016,
                wood,
            )
    cord = w.look(w.choice(("wicker", "leather", "wicker", "fabric")))
    if w.chance(0.5):
        w.box((x[0] + 0.01, x[1] - 0.01), (y[0] + 0.02, y[1] - 0.02), (seat - 0.045, seat), cord)
    else:
        bands = w.whole(6, 9)
        each = (width - 2 * t) / bands
        for i in range(bands):
            c = y[0] + t + (i + 0.5) * each
            w.box((x[0] + 0.002, x[1] - 0.002), (c - 0.4 * each, c + 0.4 * each), (seat - 0.045, seat - 0.01), cord)
        w.box((-0.09, 0.09), (y[0] + 0.02, y[1] - 0.02), (seat - 0.035, seat - 0.004), cord)
    w.top((0.8 * x[0], 0.8 * x[1]), (0.85 * y[0], 0.85 * y[1]), seat, "seat")


def roll_arm_bench(w: Workbench) -> None:
    """Builds a window bench: a padded seat between two rolled or square arms, without a back."""
    width, depth, seat = w.width(1.0, 1.45), w.depth(0.40, 0.52), w.length(0.42, 0.48)
    cloth, wood, half = parts.upholstery_look(w, 0.2), w.look(w.choice(("wood", "brass", "lacquer"))), 0.5 * width
    arm = seat + w.length(0.14, 0.26)
    scroll = w.chance(0.6)
    for side in BOTH_SIDES:
        if scroll:
            y = side * (half - 0.085)
            w.box(
                (-0.5 * depth, 0.5 * depth), (y - 0.03, y + 0.03), (seat - 0.10, arm - 0.03), cloth, roll=-0.12 * side
            )
            w.rod(
                (-0.5 * depth, side * (half - 0.06), arm - 0.05),
                (0.5 * depth, side * (half - 0.06), arm - 0.05),
                0.055,
                cloth,
            )
        else:
            parts.pad(
                w,
                (depth, 0.10, arm - seat + 0.14),
                (0.0, side * (half - 0.05), 0.5 * (arm + seat - 0.14)),
                cloth,
                0.025,
            )
    thick = w.length(0.10, 0.16)
    parts.pad(w, (depth, width - 0.16, thick), (0.0, 0.0, seat - 0.5 * thick), cloth, 0.03)
    w.box(
        (-0.5 * depth + 0.02, 0.5 * depth - 0.02),
        (-half + 0.06, half - 0.06),
        (seat - thick - 0.02, seat - thick + 0.04),
        wood,
    )
    if w.chance(0.3):
        w.box((-0.5 * depth + 0.01, 0.5 * depth - 0.01), (-half + 0.05, half - 0.05), (0.0, seat - thick), cloth)
    else:
        splay = w.choice((0.0, 0.03))
        w.legs(
            (-0.5 * depth + 0.05, 0.5 * depth - 0.05),
            (-half + 0.09, half - 0.09),
            (0.0, seat - thick),
            0.042,
            wood,
            splay=splay,
        )
    w.top((-0.4 * depth, 0.4 * depth), (-half + 0.15, half - 0.15), seat, "seat")


def banquette(w: Workbench) -> None:
    """Builds a dining bench on a closed plinth with a tall padded back."""
    width, depth, seat = w.width(1.0, 1.6), w.depth(0.50, 0.60), w.length(0.44, 0.48)
    height, cloth, body = w.length(0.84, 1.10), parts.upholstery_look(w, 0.4), parts.wood_look(w, 0.5)
    x0, x1, half = -0.5 * depth, 0.5 * depth, 0.5 * width
    w.box((x0, x1 - 0.06), (-half + 0.01, half - 0.01), (0.0, 0.09), w.look("dark"))
    w.box((x0, x1 - 0.02), (-half, half), (0.08, seat - 0.09), body)
    w.box((x0, x0 + 0.03), (-half, half), (seat - 0.1, height - 0.02), body)
    pads = w.whole(1, 2)
    for i in range(pads):
        y = (i + 0.5) * width / pads - half
        parts.pad(w, (depth - 0.03, width / pads - 0.004, 0.10), (0.015, y, seat - 0.05), cloth, 0.03)
    channels = w.choice((1, 2, 3, 8, 12))
    thick = w.length(0.07, 0.11)
    for i in range(channels):
        y = (i + 0.5) * width / channels - half
        size = (thick, width / channels - 0.002, height - seat + 0.02)
        parts.pad(w, size, (x0 + 0.03 + 0.5 * thick, y, 0.5 * (height + seat) - 0.01), cloth, 0.03, tilt=-0.03)
    w.top((x0 + 0.15, x1 - 0.03), (-half + 0.1, half - 0.1), seat, "seat")


def garden_bench(w: Workbench) -> None:
    """Builds a slatted park bench with arms."""
    width, seat, height = w.width(1.0, 1.5), w.length(0.42, 0.46), w.length(0.76, 0.90)
    wood, half = parts.wood_look(w, 0.25), 0.5 * width
    frame = wood if w.chance(0.4) else w.look("iron")
    t = 0.045 if frame == wood else 0.03
    for side in BOTH_SIDES:
        y = side * (half - 0.5 * t - w.choice((0.0, 0.06)))
        w.bar((0.24, y, 0.0), (0.21, y, seat + 0.20), t, t, frame)
        w.bar((-0.24, y, 0.0), (-0.19, y, seat), t, t, frame)
        w.bar((-0.19, y, seat - 0.03), (-0.29, y, height), t, t, frame)
        w.bar((0.26, y, seat + 0.21), (-0.23, y, seat + 0.19), t + 0.02, 0.025, frame)
        w.bar((0.22, y, seat - 0.04), (-0.20, y, seat - 0.05), t, 0.05, frame)
    count = w.whole(4, 7)
    for i in range(count):
        x = 0.21 - 0.38 * i / (count - 1)
        w.box((x - 0.13 / count, x + 0.13 / count), (-half, half), (seat - 0.022, seat), wood)
    rows = w.whole(2, 5)
    for i in range(rows):
        z = seat + 0.12 + (height - seat - 0.15) * i / max(1, rows - 1)
        x = -0.19 - 0.10 * (z - seat) / (height - seat) + 0.5 * t + 0.005
        tall = 0.6 * (height - seat - 0.1) / rows
        w.box((x - 0.011, x + 0.011), (-half, half), (z - 0.5 * tall, z + 0.5 * tall), wood, tilt=-0.24)
    w.top((-0.12, 0.20), (-half + 0.1, half - 0.1), seat, "seat")


def trunk_bench(w: Workbench) -> None:
    """Builds a chest with a lid, often with a seat cushion."""
    width, depth, seat = w.width(0.80, 1.30), w.depth(0.38, 0.50), w.length(0.40, 0.48)
    body = w.look(w.choice(("wood", "wicker", "lacquer", "leather")))
    x, y = parts.footprint(depth, width)
    foot = w.choice((0.0, 0.04, 0.08))
    w.box((x[0] + 0.012, x[1] - 0.012), (y[0] + 0.012, y[1] - 0.012), (foot, seat - 0.03), body)
    w.box(x, y, (seat - 0.035, seat), body)
    if foot:
        w.legs(x, y, (0.0, foot + 0.02), 0.06, body)
    panels = w.choice((0, 2, 3))
    for i in range(panels + 1 if panels else 0):
        c = y[0] + 0.04 + i * (width - 0.08) / panels
        w.box((x[1] - 0.014, x[1]), (c - 0.028, c + 0.028), (foot, seat - 0.03), body, solid=False)
    if panels:
        for z in (foot + 0.03, seat - 0.06):
            w.box((x[1] - 0.014, x[1] - 0.001), (y[0] + 0.02, y[1] - 0.02), (z - 0.03, z + 0.03), body, solid=False)
    else:
        metal = w.look("brass")
        for c in (-0.28 * width, 0.28 * width):
            w.box((x[1] - 0.014, x[1] + 0.004), (c - 0.02, c + 0.02), (foot, seat), metal, solid=False)
    for side in BOTH_SIDES:
        w.rod(
            (-0.05, side * 0.5 * width, seat - 0.12),
            (0.05, side * 0.5 * width, seat - 0.12),
            0.009,
            w.look("iron"),
            solid=False,
        )
    top = seat
    if w.chance(0.85):
        parts.pad(w, (depth - 0.02, width - 0.02, 0.06), (0.0, 0.0, seat + 0.027), parts.upholstery_look(w, 0.2), 0.02)
        top = seat + 0.057
    w.top((0.8 * x[0], 0.8 * x[1]), (0.85 * y[0], 0.85 * y[1]), top, "seat")


STYLES: tuple[Style, ...] = (
    Style("seating", "slat_bench", "wide", slat_bench, ("bench", "plain")),
    Style("seating", "woven_bench", "wide", woven_bench, ("bench", "plain")),
    Style("seating", "roll_arm_bench", "wide", roll_arm_bench, ("bench", "plain")),
    Style("seating", "banquette", "wide", banquette, ("bench",)),
    Style("seating", "garden_bench", "wide", garden_bench, ("bench",)),
    Style("seating", "trunk_bench", "wide", trunk_bench, ("bench", "plain")),
)
