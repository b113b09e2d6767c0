"""Sofas of the pool `wide`."""

from __future__ import annotations

import itertools
import math

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring, loft, pillow
from sim.housegen.furniture.workbench import Workbench


def _loose_cushions(w: Workbench, face: float, inner: float, seat: float) -> None:
    """Adds throw cushions that lean at x = `face`."""
    parts.throw_cushions(w, face, inner, seat, (0, 0, 1, 2, 3), margin=0.26, middle=0.06)


def _sofa_size(w: Workbench, low: float = 1.45, high: float = 2.30) -> tuple[float, float, float]:
    """Returns width, depth and seat height."""
    return w.width(low, high), w.depth(0.78, 1.0), w.length(0.39, 0.46)


def tuxedo(w: Workbench) -> None:
    """Builds a sofa with thin straight arms as high as its thin back."""
    width, depth, seat = _sofa_size(w)
    cover, high, arm = parts.upholstery_look(w, 0.4), w.length(0.70, 0.82), w.length(0.06, 0.12)
    x0, x1, half, foot = -0.5 * depth, 0.5 * depth, 0.5 * width, w.length(0.10, 0.22)
    inner = width - 2 * arm
    parts.pad(w, (arm, width, high - foot), (x0 + 0.5 * arm, 0.0, 0.5 * (high + foot)), cover, 0.02)
    reach = w.choice((0.0, 0.0, 0.12))
    for side in BOTH_SIDES:
        y = side * (half - 0.5 * arm)
        parts.pad(w, (depth - reach, arm, high - foot), (-0.5 * reach, y, 0.5 * (high + foot)), cover, 0.02)
    w.box((x0 + 0.02, x1 - 0.01), (-half + 0.02, half - 0.02), (foot, foot + 0.08), cover)
    pads = w.choice((1, 1, 2, 3))
    thick = seat - foot - 0.07
    for i in range(pads):
        y = (i + 0.5) * inner / pads - 0.5 * inner
        parts.pad(w, (depth - arm, inner / pads - 0.004, thick), (0.5 * arm, y, seat - 0.5 * thick), cover, 0.03)
    columns, rows = max(3, round(inner / 0.30)), w.choice((0, 1, 2))
    for row, i in itertools.product(range(rows), range(columns)):
        tall, wide = (high - seat) / rows, inner / columns
        at = (x0 + arm + 0.03, (i + 0.5) * wide - 0.5 * inner, seat + (row + 0.5) * tall)
        parts.pad(w, (0.07, wide - 0.003, tall - 0.003), at, cover, 0.025)
    metal = w.look(w.choice(("chrome", "brass", "iron", "wood")))
    w.legs((x0 + 0.04, x1 - 0.05), (-half + 0.05, half - 0.05), (0.0, foot + 0.02), w.length(0.02, 0.045), metal)
    face = x0 + arm + (0.065 if rows else 0.0)
    w.top((face, x1), (-0.5 * inner, 0.5 * inner), seat, "seat")
    _loose_cushions(w, face, inner, seat)


def slipcovered(w: Workbench) -> None:
    """Builds a deep sofa under a loose cover, with soft low arms and large back pillows."""
    width, depth, seat = _sofa_size(w, 1.5, 2.4)
    cover, arm, top = w.look(w.choice(("linen", "fabric"))), w.length(0.16, 0.26), w.length(0.54, 0.64)
    x0, half, high = -0.5 * depth, 0.5 * width, w.length(0.72, 0.86)
    inner = width - 2 * arm
    skirt = [Ring(0.0, 0.5 * depth, half, power=9), Ring(seat - 0.14, 0.5 * depth - 0.03, half - 0.02, power=9)]
    w.mesh(loft(skirt, 16, hull=True), (0.0, 0.0, 0.0), cover)
    for side in BOTH_SIDES:
        y = side * (half - 0.5 * arm - 0.01)
        parts.pad(w, (depth - 0.05, arm, top - 0.15), (0.0, y, 0.5 * top + 0.075), cover, w.length(0.04, 0.08))
    back = 0.18
    parts.pad(w, (back, width - 0.10, high - 0.22), (x0 + 0.11, 0.0, 0.5 * high + 0.06), cover, 0.05)
    pads = w.choice((1, 2, 2, 3)) if inner > 1.2 else w.choice((1, 2))
    for i in range(pads):
        y = (i + 0.5) * inner / pads - 0.5 * inner
        parts.pad(w, (depth - back - 0.02, inner / pads - 0.006, 0.17), (0.5 * back, y, seat - 0.085), cover, 0.05)
    pillows = w.whole(2, 4) if inner > 1.2 else 2
    for i in range(pillows):
        y, wide = (i + 0.5) * inner / pillows - 0.5 * inner, inner / pillows
        tall = high - seat + w.length(0.02, 0.10)
        shape = pillow((round(tall, 3), round(wide - 0.01, 3), 0.24), 5.0)
        w.mesh(shape, (x0 + back + 0.10, y, seat + 0.5 * tall - 0.02), cover, tilt=0.5 * math.pi - 0.2)
    w.top((x0 + back + 0.2, 0.5 * depth), (-0.5 * inner, 0.5 * inner), seat, "seat")
    _loose_cushions(w, x0 + back + 0.22, inner, seat)


def theatre_row(w: Workbench) -> None:
    """Builds two or three reclining seats with padded backs, headrests and footrests."""
    depth, seat, high = w.depth(0.88, 1.0), w.length(0.43, 0.47), w.length(0.96, 1.08)
    wanted = w.width(1.55, 2.35)
    places = 2 if wanted < 1.95 else 3
    arm, between = w.length(0.17, 0.24), w.choice((0.0, 0.0, 0.24)) if places == 2 else 0.0
    cover, x0, x1, half = parts.upholstery_look(w, 0.65), -0.5 * depth, 0.5 * depth, 0.5 * wanted
    each = (wanted - 2 * arm - between) / places
    w.box((x0 + 0.08, x1 - 0.06), (-half + 0.04, half - 0.04), (0.0, 0.08), w.look("dark"))
    w.box((x0 + 0.04, x1 - 0.05), (-half + 0.02, half - 0.02), (0.06, seat - 0.14), cover)
    for side in BOTH_SIDES:
        y = side * (half - 0.5 * arm)
        parts.pad(w, (depth - 0.04, arm - 0.03, 0.48), (0.02, y, 0.31), cover, 0.03)
        parts.pad(w, (depth - 0.16, arm, 0.11), (0.06, y, 0.58), cover, 0.045)
    for i in range(places):
        y = (i + 0.5) * each - 0.5 * places * each
        if between:
            y += (i - 0.5) * between
        parts.pad(w, (depth - 0.24, each - 0.006, 0.18), (0.12, y, seat - 0.09), cover, 0.05)
        parts.pad(w, (0.10, each - 0.01, seat - 0.18), (x1 - 0.03, y, 0.5 * seat - 0.03), cover, 0.03)
        low = seat + 0.55 * (high - seat)
        parts.pad(
            w,
            (0.24, each - 0.006, low - seat + 0.14),
            (x0 + 0.17, y, 0.5 * (low + seat) - 0.05),
            cover,
            0.06,
            tilt=-0.12,
        )
        parts.pad(
            w, (0.20, each - 0.04, high - low + 0.03), (x0 + 0.12, y, 0.5 * (high + low)), cover, 0.06, tilt=-0.12
        )
    if between:
        w.box((x0 + 0.10, x1 - 0.08), (-0.5 * between, 0.5 * between), (0.10, 0.58), cover)
        for x in (0.18, 0.30):
            w.cylinder((x, 0.0), (0.575, 0.585), 0.045, w.look("dark"), solid=False)
    w.top((x0 + 0.30, x1), (-half + arm, half - arm), seat, "seat")


def ridged_low(w: Workbench) -> None:
    """Builds a low foam sofa of rolls without legs or frame."""
    width, depth, cover = w.width(1.40, 2.30), w.depth(0.88, 1.05), parts.upholstery_look(w, 0.3)
    seat, high, x0 = w.length(0.34, 0.40), w.length(0.66, 0.76), -0.5 * depth
    arms = w.chance(0.4)
    arm = 0.24 if arms else 0.0
    inner = width - 2 * arm
    rolls = w.whole(3, 5)
    each = (depth - 0.12) / rolls
    parts.pad(w, (depth - 0.06, inner, 0.5 * seat), (0.0, 0.0, 0.25 * seat), cover, 0.05)
    for i in range(rolls):
        parts.pad(
            w,
            (each + 0.01, inner - 0.01, 0.55 * seat),
            (0.5 * depth - (i + 0.5) * each, 0.0, 0.725 * seat),
            cover,
            0.045,
        )
    backs = w.whole(2, 4)
    step = (high - 0.5 * seat) / backs
    for i in range(backs):
        x = x0 + 0.17 - 0.04 * i
        z = 0.5 * seat + (i + 0.5) * step
        parts.pad(w, (0.26 - 0.02 * i, inner, step + 0.02), (x, 0.0, z), cover, 0.05, tilt=-0.25)
    if arms:
        for side in BOTH_SIDES:
            y = side * (0.5 * width - 0.5 * arm)
            for i in range(3):
                parts.pad(
                    w,
                    (depth / 3 + 0.01, arm, 0.52 + 0.05 * (2 - i)),
                    (0.5 * depth - (i + 0.5) * depth / 3, y, 0.26 + 0.025 * (2 - i)),
                    cover,
                    0.05,
                )
    w.top((x0 + 0.36, 0.5 * depth), (-0.5 * inner, 0.5 * inner), seat, "seat")
    _loose_cushions(w, x0 + 0.34, inner, seat)


def cage_sofa(w: Workbench) -> None:
    """Builds a sofa of two or three thick cushions in a cage of steel tubes."""
    width, depth, seat = _sofa_size(w, 1.30, 2.20)
    face = parts.cage_seat(w, width, min(depth, 0.84), seat, 2 if width < 1.75 else 3)
    _loose_cushions(w, face, width - 0.4, seat)


def lattice_settee(w: Workbench) -> None:
    """Builds a settee with bars or slats in its bare back and arms, often with thin pads."""
    width, depth, seat = w.width(1.20, 2.0), w.depth(0.58, 0.76), w.length(0.40, 0.45)
    wood, high, arm = (
        w.look(w.choice(("wood", "wood", "wicker", "lacquer"))),
        w.length(0.78, 0.98),
        w.length(0.60, 0.68),
    )
    x0, x1, half, t = -0.5 * depth, 0.5 * depth, 0.5 * width, w.length(0.035, 0.055)
    e = 0.5 * t
    w.box((x0, x1), (-half, half), (seat - 0.05, seat), wood)
    w.legs((x0, x1), (-half, half), (0.0, seat), t, wood)
    w.box((x1 - 0.03, x1 - 0.01), (-half + t, half - t), (seat - 0.11, seat - 0.04), wood)
    for side in BOTH_SIDES:
        y = side * (half - e)
        w.box((x0, x0 + t), (y - e, y + e), (seat, high), wood)
        w.box((x1 - t - 0.04, x1 - 0.04), (y - e, y + e), (seat, arm), wood)
        w.box((x0, x1), (y - e - 0.005, y + e + 0.005), (arm - 0.035, arm), wood)
        for i in range(w.choice((0, 2, 3))):
            x = x0 + (0.25 + 0.2 * i) * depth
            w.box((x - 0.010, x + 0.010), (y - 0.010, y + 0.010), (seat, arm - 0.03), wood)
    w.box((x0, x0 + t), (-half, half), (high - 0.05, high + w.choice((0.0, 0.03))), wood)
    kind, inner = w.choice(("bars", "fret", "slats")), width - 2 * t
    if kind == "slats":
        rows = w.whole(2, 4)
        for i in range(rows):
            z = seat + 0.08 + (high - seat - 0.14) * i / rows
            w.box(
                (x0 + 0.008, x0 + 0.028),
                (-0.5 * inner - 0.01, 0.5 * inner + 0.01),
                (z, z + 0.5 * (high - seat - 0.1) / rows),
                wood,
            )
    else:
        count = max(5, round(inner / w.length(0.10, 0.16)))
        for i in range(min(count, 17)):
            y = (i + 0.5) * inner / min(count, 17) - 0.5 * inner
            w.box((x0 + 0.008, x0 + 0.028), (y - 0.010, y + 0.010), (seat, high - 0.04), wood)
        if kind == "fret":
            for z in (seat + 0.12, high - 0.14):
                w.box((x0 + 0.006, x0 + 0.030), (-0.5 * inner - 0.01, 0.5 * inner + 0.01), (z - 0.012, z + 0.012), wood)
    top, face = seat, x0 + t
    if w.chance(0.85):
        pads = w.choice((1, 2, 3))
        for i in range(pads):
            y = (i + 0.5) * inner / pads - 0.5 * inner
            parts.pad(
                w,
                (depth - t - 0.02, inner / pads - 0.006, 0.07),
                (0.5 * t, y, seat + 0.033),
                parts.upholstery_look(w, 0.1),
                0.025,
            )
        top = seat + 0.068
    w.top((face, x1 - 0.02), (-0.5 * inner, 0.5 * inner), top, "seat")
    _loose_cushions(w, face + 0.01, inner, top)


def pallet_sofa(w: Workbench) -> None:
    """Builds a sofa of stacked pallets with mattress cushions."""
    width, depth, cloth = w.width(1.20, 2.10), w.depth(0.80, 0.95), parts.upholstery_look(w, 0.0)
    wood, layers = w.look("wood"), w.whole(1, 2)
    x0, x1, half = -0.5 * depth, 0.5 * depth, 0.5 * width
    for layer in range(layers):
        z = 0.14 * layer
        for i in range(3):
            y = (i - 1) * (half - 0.05)
            w.box((x0, x1), (y - 0.05, y + 0.05), (z + 0.02, z + 0.12), wood)
        for i in range(5):
            x = x0 + 0.05 + i * (depth - 0.10) / 4
            w.box((x - 0.045, x + 0.045), (-half, half), (z + 0.12, z + 0.14), wood)
        for x in (x0 + 0.05, x1 - 0.05):
            w.box((x - 0.045, x + 0.045), (-half, half), (z, z + 0.02), wood)
    base = 0.14 * layers
    thick = w.length(0.12, 0.18)
    seat, face, pads = base + thick, x0, w.choice((1, 2, 3))
    if w.chance(0.6):
        high = seat + w.length(0.28, 0.40)
        for side in BOTH_SIDES:
            w.box((x0, x0 + 0.05), (side * 0.8 * half - 0.05, side * 0.8 * half + 0.05), (base - 0.02, high), wood)
        for i in range(3):
            z = base + 0.08 + i * (high - base - 0.10) / 3
            w.box((x0 + 0.05, x0 + 0.07), (-half, half), (z, z + 0.09), wood)
        face = x0 + 0.07
    for i in range(pads):
        y = (i + 0.5) * width / pads - half
        parts.pad(w, (x1 - face, width / pads - 0.004, thick), (0.5 * (x1 + face), y, base + 0.5 * thick), cloth, 0.03)
    backs = w.whole(2, 3)
    for i in range(backs):
        y = (i + 0.5) * width / backs - half
        tall = w.choice((0.40, 0.45))
        parts.pad(
            w, (0.16, width / backs - 0.02, tall), (face + 0.12, y, seat + 0.5 * tall - 0.02), cloth, 0.045, tilt=-0.15
        )
    w.top((face + 0.22, x1), (-half + 0.05, half - 0.05), seat, "seat")
    _loose_cushions(w, face + 0.22, width, seat)


def modular_corner(w: Workbench) -> None:
    """Builds low square blocks in an L, each with a seat pad and a back pad."""
    unit, cover = w.length(0.74, 0.92), parts.upholstery_look(w, 0.2)
    seat, high, back = w.length(0.38, 0.43), w.length(0.62, 0.82), w.length(0.16, 0.26)
    across = 2 if 2.6 * unit > float(w.hints.get("width_m") or 9.0) else w.choice((2, 3))
    side, foot = w.choice(BOTH_SIDES), w.choice((0.0, 0.03, 0.12))
    width, depth = across * unit, 2 * unit
    x0, end = -0.5 * depth, side * 0.5 * width
    dark = w.look(w.choice(("dark", "wood", "chrome")))
    places = [(x0 + 0.5 * unit, -end + side * (i + 0.5) * unit) for i in range(across)]
    places.append((x0 + 1.5 * unit, end - side * 0.5 * unit))
    for x, y in places:
        w.box((x - 0.49 * unit, x + 0.49 * unit), (y - 0.49 * unit, y + 0.49 * unit), (foot, seat - 0.15), cover)
        parts.pad(w, (unit - 0.008, unit - 0.008, 0.17), (x, y, seat - 0.085), cover, 0.04)
        if foot:
            w.cylinder((x, y), (0.0, foot + 0.01), 0.30 * unit, dark)
    tall = high - seat + 0.04
    z = high - 0.5 * tall
    for _, y in places[:-1]:
        parts.pad(w, (back, unit - 0.01, tall), (x0 + 0.5 * back, y, z), cover, 0.05)
    for i in range(1 if w.chance(0.3) else 2):
        x = x0 + (i + 0.5) * unit + (0.5 * back if i == 0 else 0.0)
        parts.pad(
            w, (unit - (back if i == 0 else 0.0) - 0.01, back, tall), (x, end - side * 0.5 * back, z), cover, 0.05
        )
    if w.chance(0.6):
        low = w.choice((tall, 0.7 * tall))
        parts.pad(
            w,
            (unit - back - 0.01, back, low),
            (x0 + 0.5 * (unit + back), -end + side * 0.5 * back, seat - 0.04 + 0.5 * low),
            cover,
            0.05,
        )
    inner = width - 2 * back
    w.top((x0 + back, x0 + unit), (-0.5 * inner, 0.5 * inner), seat, "seat")
    _loose_cushions(w, x0 + back, inner, seat)


def split_back(w: Workbench) -> None:
    """Builds a bench sofa with a back of two or three flat panels and slim legs."""
    width, depth, seat = _sofa_size(w, 1.5, 2.1)
    cover, metal, high = (
        parts.upholstery_look(w, 0.45),
        w.look(w.choice(("chrome", "wood", "iron"))),
        w.length(0.74, 0.86),
    )
    x0, half, pads, thick = -0.5 * depth, 0.5 * width, w.whole(2, 3), w.length(0.12, 0.18)
    wide = width / pads
    for i in range(pads):
        y = (i + 0.5) * wide - half
        parts.pad(w, (depth - 0.08, wide - 0.01, thick), (0.04, y, seat - 0.5 * thick), cover, 0.03)
        parts.pad(
            w,
            (0.13, wide - 0.01, high - seat + 0.10),
            (x0 + 0.10, y, 0.5 * (high + seat) - 0.04),
            cover,
            0.03,
            tilt=-0.22,
        )
        for k in range(w.choice((0, 2))):
            z = seat + (0.35 + 0.3 * k) * (high - seat)
            w.box(
                (x0 + 0.10, x0 + 0.165 - 0.22 * (z - seat - 0.1)),
                (y - 0.45 * wide, y + 0.45 * wide),
                (z - 0.004, z + 0.004),
                w.look("dark"),
                solid=False,
            )
    w.box(
        (x0 + 0.08, 0.5 * depth - 0.04),
        (-half + 0.06, half - 0.06),
        (seat - thick - 0.03, seat - thick + 0.03),
        w.look("dark"),
    )
    w.legs(
        (x0 + 0.12, 0.5 * depth - 0.08),
        (-half + 0.12, half - 0.12),
        (0.0, seat - thick - 0.01),
        0.03,
        metal,
        splay=w.choice((0.0, 0.04)),
    )
    if w.chance(0.35):
        for side in BOTH_SIDES:
            w.mesh(pillow((0.62, 0.34, 0.18), 6.0), (0.06, side * (half - 0.10), seat + 0.14), cover, roll=side * 1.25)
    w.top((x0 + 0.22, 0.5 * depth), (-half + 0.1, half - 0.1), seat, "seat")
    _loose_cushions(w, x0 + 0.20, width - 0.3, seat)


STYLES: tuple[Style, ...] = (
    Style("sofa", "tuxedo", "wide", tuxedo),
    Style("sofa", "slipcovered", "wide", slipcovered),
    Style("sofa", "theatre_row", "wide", theatre_row),
    Style("sofa", "ridged_low", "wide", ridged_low),
    Style("sofa", "cage_sofa", "wide", cage_sofa),
    Style("sofa", "lattice_settee", "wide", lattice_settee),
    Style("sofa", "pallet_sofa", "wide", pallet_sofa),
    Style("sofa", "split_back", "wide", split_back),
    Style("sofa", "modular_corner", "wide", modular_corner, ("corner",)),
)
