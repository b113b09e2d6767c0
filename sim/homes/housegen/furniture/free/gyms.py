"""Free-form gym equipment of the pool `wide`: frames with pads, stacks, wheels, handles and consoles at random."""

from __future__ import annotations

import math

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.free.details import weight_discs
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts import BOTH_SIDES
from sim.homes.housegen.furniture.shapes import Ring, chamfered_box, loft
from sim.homes.housegen.furniture.workbench import Workbench


def free_cardio(w: Workbench) -> None:
    """Builds a training machine on a long base: a mast with a console, and a wheel, a belt, a seat or steps."""
    long, wide, high = w.depth(1.0, 1.85), w.width(0.5, 0.8), w.length(1.1, 1.5)
    iron, dark = w.look(w.choice(("iron", "dark", "metal", "paint", "appliance"))), w.look("dark")
    x0, x1, half, beam = -0.5 * long, 0.5 * long, 0.5 * wide, w.length(0.04, 0.1)
    w.box((x0, x1), (-0.06, 0.06), (0.03, 0.03 + beam), iron)
    for x in (x0 + 0.05, x1 - 0.05):
        w.rod((x, -half, 0.03), (x, half, 0.03), 0.03, dark)
    mast, top = x0 + w.length(0.12, 0.35), high - 0.05
    lean = w.length(-0.15, 0.12)
    w.bar((mast, 0.0, 0.05), (mast + lean, 0.0, top), w.length(0.06, 0.14), 0.06, iron)
    w.box(parts.centred(mast + lean, 0.05), (-0.15, 0.15), (top - 0.08, top + 0.1), dark, tilt=-0.4)
    w.box(
        parts.centred(mast + lean + 0.03, 0.012),
        (-0.1, 0.1),
        (top - 0.03, top + 0.08),
        w.look("screen"),
        tilt=-0.4,
        solid=False,
    )
    _handlebar(w, mast + lean, top - w.length(0.08, 0.2), w.length(0.18, 0.3), iron)
    kind = w.choice(("bike", "bike", "belt", "steps", "rower"))
    if kind in ("bike", "rower"):
        _wheel(w, mast + w.length(0.05, 0.2), 0.05 + beam, iron, dark)
    if kind == "bike":
        seat, post = w.length(0.75, 0.95), mast + w.length(0.5, 0.65)
        w.bar((min(post - 0.05, x1 - 0.1), 0.0, 0.05), (post, 0.0, seat - 0.03), 0.05, 0.05, iron)
        shape = [Ring(0.0, 0.13, 0.07), Ring(0.05, 0.14, w.length(0.08, 0.14))]
        w.mesh(loft(shape, 12, hull=True), (post, 0.0, seat - 0.05), w.look("leather"))
        crank = mast + 0.3
        w.box((crank - 0.05, crank + 0.05), (-0.05, 0.05), (0.05, 0.38), iron)
        for side in BOTH_SIDES:
            w.bar((crank, side * 0.06, 0.35), (crank + side * 0.12, side * 0.08, 0.35 + side * 0.1), 0.02, 0.02, dark)
            w.box(
                parts.centred(crank + side * 0.12, 0.1),
                parts.centred(side * 0.12, 0.1),
                (0.34 + side * 0.1, 0.37 + side * 0.1),
                dark,
            )
    elif kind == "belt":
        w.box((x0 + 0.1, x1), (-half, half), (0.05, 0.16), iron)
        w.box((x0 + 0.15, x1 + 0.004), (-half + 0.07, half - 0.07), (0.15, 0.165), w.look("rubber"), solid=False)
    elif kind == "steps":
        for side in BOTH_SIDES:
            z = 0.25 + 0.08 * side
            w.bar((mast + 0.05, side * 0.14, 0.1), (x1 - 0.35, side * 0.14, z), 0.05, 0.04, iron)
            w.box((x1 - 0.6, x1 - 0.2), parts.centred(side * 0.14, 0.16), (z, z + 0.04), dark)
            w.box((mast, mast + 0.1), parts.centred(side * 0.14, 0.05), (0.06, 0.14), iron)
            w.box((mast - 0.02, mast + 0.08), parts.on_side(side, 0.0, 0.16), (0.04, 0.1), iron)
    else:
        w.box((mast + 0.2, x1 - 0.05), (-0.035, 0.035), (0.03 + beam, 0.3), w.look("metal"))
        x = w.length(0.0, 0.5) * x1
        parts.leather_pad(w, (0.26, 0.32, 0.07), (x, 0.0, 0.33))
    if kind != "rower" and w.chance(0.35):
        for side in BOTH_SIDES:
            w.rod((mast, side * 0.1, 0.08), (mast + lean, side * 0.22, top - 0.1), 0.018, iron)


def _handlebar(w: Workbench, x: float, z: float, half: float, look: Look) -> None:
    """Adds handles on both sides that reach backwards or upwards."""
    reach, rise = w.length(-0.05, 0.3), w.length(-0.05, 0.15)
    w.rod((x, -half, z), (x, half, z), 0.016, look)
    for side in BOTH_SIDES:
        w.rod((x, side * half, z), (x + reach, side * half, z + rise), 0.018, w.look("rubber"), round_ends=True)


def _wheel(w: Workbench, x: float, z: float, iron: Look, dark: Look) -> None:
    """Adds a flywheel, bare or in a housing."""
    r, half = w.length(0.18, 0.28), w.length(0.03, 0.07)
    w.rod((x, -half, z + r - 0.02), (x, half, z + r - 0.02), r, w.choice((dark, iron)))
    if w.chance(0.6):
        w.rod((x, -half - 0.01, z + r - 0.02), (x, half + 0.01, z + r - 0.02), w.length(0.3, 0.75) * r, w.look("metal"))


def free_weights(w: Workbench) -> None:
    """Builds a bench with a barbell stand, a rack of dumb-bells or a storage frame with discs."""
    if w.chance(0.5):
        _weight_bench(w)
    else:
        _dumbbell_rack(w)


def _weight_bench(w: Workbench) -> None:
    """Builds a bench of any inclination with uprights and a loaded bar."""
    iron, long, high = w.look(w.choice(("iron", "paint", "dark", "metal"))), w.length(1.05, 1.3), w.length(0.40, 0.5)
    x0, x1, rise = -0.5 * long, 0.5 * long, w.choice((0.0, 0.0, w.length(0.2, 0.75)))
    cut, half = x0 + w.length(0.4, 0.7) * long, 0.5 * w.length(0.24, 0.32)
    w.box((x0 + 0.05, x1 - 0.05), (-0.03, 0.03), (high - 0.12, high - 0.06), iron)
    for x in (x0 + 0.1, x1 - 0.1):
        w.box(parts.centred(x, 0.05), (-0.03, 0.03), (0.0, high - 0.1), iron)
        w.box(parts.centred(x, 0.05), (-w.length(0.2, 0.3), w.length(0.2, 0.3)), (0.0, 0.04), iron)
    parts.leather_pad(w, (x1 - cut, 2 * half, 0.07), (0.5 * (cut + x1), 0.0, high - 0.03))
    reach = (cut - x0) * math.cos(rise)
    at = (cut - 0.5 * reach, 0.0, high - 0.03 + 0.5 * (cut - x0) * math.sin(rise))
    parts.leather_pad(w, (cut - x0, 2 * half, 0.07), at, tilt=rise)
    if rise:
        w.bar((x0 + 0.15, 0.0, high - 0.1), (at[0] - 0.02, 0.0, at[2]), 0.05, 0.05, iron)
    if w.chance(0.75):
        z, y, x = w.length(0.85, 1.15), w.length(0.4, 0.55), x0 + 0.1
        radius, discs = w.length(0.12, 0.22), w.whole(1, 3)
        w.box(parts.centred(x, 0.05), (-y, y), (0.0, 0.05), iron)
        for side in BOTH_SIDES:
            w.box(parts.centred(x, 0.05), parts.centred(side * y, 0.05), (0.0, z), iron)
            end = weight_discs(w, x, side * (y + 0.14), z + 0.012, side, radius, discs)
            w.rod((x, side * (y + 0.1), z + 0.012), (x, end + side * 0.08, z + 0.012), 0.024, w.look("chrome"))
        w.rod((x, -y - 0.2, z + 0.012), (x, y + 0.2, z + 0.012), 0.014, w.look("chrome"))


def _dumbbell_rack(w: Workbench) -> None:
    """Builds a rack of one to three levels with dumb-bells, balls or discs."""
    iron, wide, levels = w.look(w.choice(("iron", "dark", "metal", "wood"))), w.width(0.7, 1.4), w.whole(1, 3)
    high, deep, slope = w.length(0.35, 0.5) * levels, w.length(0.3, 0.45), w.length(0.0, 0.12)
    for side in BOTH_SIDES:
        y = side * (0.5 * wide - 0.025)
        w.box((-0.5 * deep, 0.5 * deep), parts.centred(y, 0.05), (0.0, 0.05), iron)
        w.bar((-0.2 * deep, y, 0.04), (-0.2 * deep - slope, y, high), 0.05, 0.07, iron)
    count, kind = w.whole(2, 4), w.choice(("hex", "round", "ball"))
    for level in range(levels):
        z = high * (level + 1) / levels - 0.08
        x = -0.2 * deep - slope * z / high
        w.box((x - 0.09, x + 0.16), (-0.5 * wide, 0.5 * wide), (z - 0.025, z), iron)
        for i in range(count):
            y, r = wide * ((i + 0.5) / count - 0.5) * 0.9, w.length(0.04, 0.07)
            look = w.look("rubber") if w.chance(0.6) else w.new_look("bright")
            if kind == "ball":
                w.ball((x + 0.03, y, z + 1.4 * r), 1.4 * r, look)
                continue
            w.rod((x - 0.08, y, z + r), (x + 0.14, y, z + r), 0.015, w.look("chrome"))
            for end in (x - 0.07, x + 0.12):
                if kind == "round":
                    w.rod((end - 0.03, y, z + r), (end + 0.03, y, z + r), r, look)
                else:
                    w.mesh(chamfered_box((0.06, 2 * r, 2 * r), 0.6 * r), (end, y, z + r), look)


def free_small_gym(w: Workbench) -> None:
    """Builds small equipment on the floor: a ball or roller, dumb-bells, a kettlebell, a step, a rolled mat."""
    kinds = ["ball", "mat", "dumbbells", "kettlebell", "step", "roller"]
    w.rng.shuffle(kinds)
    y = 0.0
    for kind in kinds[: w.whole(2, 3)]:
        look, size = w.new_look(w.choice(("bright", "rubber", "paint"))), w.length(0.8, 1.2)
        width = {"ball": 0.6, "mat": 0.18, "dumbbells": 0.32, "kettlebell": 0.24, "step": 0.42, "roller": 0.18}[
            kind
        ] * size
        _small(w, kind, y + 0.5 * width, size, look)
        y += width + 0.05


def _small(w: Workbench, kind: str, y: float, s: float, look: Look) -> None:
    if kind == "ball":
        w.ball((0.0, y, 0.3 * s), 0.3 * s, look)
    elif kind in ("mat", "roller"):
        r, half = (0.07, 0.3) if kind == "mat" else (0.075, 0.22)
        w.rod((-half * s, y, r * s), (half * s, y, r * s), r * s, look)
        w.rod((-half * s - 0.003, y, r * s), (half * s + 0.003, y, r * s), 0.4 * r, w.look("dark"), solid=False)
    elif kind == "dumbbells":
        r = 0.06 * s
        for x in (-0.12, 0.12):
            w.rod((x, y - 0.13 * s, r), (x, y + 0.13 * s, r), 0.015, w.look("chrome"))
            for side in BOTH_SIDES:
                w.rod((x, y + side * 0.08 * s, r), (x, y + side * 0.16 * s, r), r, look)
    elif kind == "kettlebell":
        r = 0.1 * s
        w.ball((0.0, y, 0.9 * r), 0.9 * r, look)
        top = 1.6 * r
        points = [
            (0.0, y - 0.5 * r, top),
            (0.0, y - 0.7 * r, top + 0.6 * r),
            (0.0, y + 0.7 * r, top + 0.6 * r),
            (0.0, y + 0.5 * r, top),
        ]
        parts.tube_along(w, points, 0.016, w.look("iron"))
    else:
        w.mesh(chamfered_box((0.75 * s, 0.4 * s, 0.12), 0.02), (0.0, y, w.length(0.06, 0.1)), look)
        for x in (-0.28, 0.28):
            w.box(parts.centred(x * s, 0.12), parts.centred(y, 0.36 * s), (0.0, 0.08), w.look("dark"))


STYLES: tuple[Style, ...] = (
    Style("gym_equipment", "free_cardio", "wide", free_cardio, ("machine",)),
    Style("gym_equipment", "free_weights", "wide", free_weights, ("weights",)),
    Style("gym_equipment", "free_small", "wide", free_small_gym, ("small",)),
)
