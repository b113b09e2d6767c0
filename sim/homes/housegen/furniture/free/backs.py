"""Seats, backrests and armrests that the free-form generators of the pool `wide` combine."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts import BOTH_SIDES
from sim.homes.housegen.furniture.shapes import Ring, frustum, loft, strip
from sim.homes.housegen.furniture.workbench import Range, Workbench


@dataclass(frozen=True)
class Seat:
    """The dimensions of a seat for one or more persons, in metres: its top is at `z`, its sides at +-`half`."""

    x: Range
    half: float
    z: float
    thick: float

    @property
    def under(self) -> float:
        """The height of its lower side."""
        return self.z - self.thick


def add_seat(w: Workbench, seat: Seat, frame: Look, cloth: Look) -> None:
    """Adds a seat of a drawn kind: a pad, a tapered or round cushion, slats, a bent board, woven cord."""
    deep, wide, middle = seat.x[1] - seat.x[0], 2 * seat.half, 0.5 * (seat.x[0] + seat.x[1])
    kind = w.choice(("pad", "pad", "taper", "round", "slats", "board", "woven"))
    centre = (middle, 0.0, seat.z - 0.5 * seat.thick)
    if kind == "pad":
        parts.pad(w, (deep, wide, seat.thick), centre, cloth, w.length(0.15, 0.48) * seat.thick)
    elif kind == "taper":
        narrow = w.length(0.74, 0.98)
        w.mesh(frustum((deep, wide), (deep - 0.01, narrow * wide), seat.thick), (middle, 0.0, seat.under), cloth)
    elif kind == "round":
        power, edge = w.choice((2.2, 3.0, 4.5)), 0.3 * seat.thick
        rings = [(0.0, 0.93), (edge, 1.0), (seat.thick - edge, 1.0), (seat.thick, w.length(0.7, 0.95))]
        body = [Ring(z, 0.5 * s * deep, s * seat.half, power=power) for z, s in rings]
        w.mesh(loft(body, 16, hull=True), (middle, 0.0, seat.under), cloth)
    elif kind == "slats":
        count = w.whole(3, 7)
        for i in range(count):
            x = seat.x[0] + (i + 0.5) * deep / count
            w.box(parts.centred(x, 0.8 * deep / count), (-seat.half, seat.half), (seat.z - 0.018, seat.z), frame)
    elif kind == "board":
        dip, x0, x1 = w.length(0.0, 0.03), *seat.x
        path = [(x0, seat.z - 0.015), (x0 + 0.3 * deep, seat.z - 0.015 - dip), (x1 - 0.12 * deep, seat.z - 0.015)]
        w.mesh(strip([*path, (x1, seat.z - 0.03)], 0.015, wide), (0.0, 0.0, 0.0), frame)
    else:
        w.box(seat.x, (-seat.half, seat.half), (seat.z - 0.035, seat.z), w.look("wicker"))
    if kind not in ("pad", "taper", "round"):
        low = min(seat.under, seat.z - 0.035)
        w.box((seat.x[0] + 0.01, seat.x[1] - 0.01), (-seat.half + 0.01, seat.half - 0.01), (low, seat.z - 0.015), frame)


def add_back(w: Workbench, x: float, half: float, z: Range, lean: float, frame: Look, cloth: Look) -> None:
    """Adds a backrest of a drawn kind from z[0], where it is at x, to its top, which is `lean` further back."""
    kind = w.choice(("panel", "pad", "slats", "ladder", "curved", "oval", "cross", "bent", "grid", "split", "hoop"))
    tall, t = z[1] - z[0], w.length(0.016, 0.036)
    w.box((x - 0.018, x + 0.018), (-half, half), (z[0] - 0.03, z[0] - 0.005), frame)

    def at(share: float) -> float:
        return x - share * lean

    if kind in ("slats", "ladder", "cross", "grid", "curved", "split"):
        for side in BOTH_SIDES:
            y = side * (half - 0.5 * t)
            w.bar((x, y, z[0] - 0.02), (at(1.0), y, z[1]), t, t, frame)
    if kind == "panel":
        w.bar((x, 0.0, z[0] - 0.01), (at(1.0), 0.0, z[1]), 2 * half * w.length(0.75, 1.0), t, frame)
    elif kind == "pad":
        thick, low = w.length(0.04, 0.10), w.length(0.0, 0.25) * tall
        size, tilt = (thick, 2 * half, tall - low), math.atan2(-lean, tall)
        parts.pad(w, size, (at(0.5 + 0.5 * low / tall), 0.0, 0.5 * (z[0] + low + z[1])), cloth, 0.4 * thick, tilt=tilt)
        if low:
            for side in BOTH_SIDES:
                w.bar((x, side * 0.7 * half, z[0] - 0.02), (at(0.5), side * 0.7 * half, 0.5 * sum(z)), 0.035, t, frame)
    elif kind == "slats":
        count, share = w.whole(2, 7), w.length(0.25, 0.75)
        w.bar((at(0.97), -half, z[1] - 0.02), (at(0.97), half, z[1] - 0.02), t, w.length(0.03, 0.08), frame)
        for i in range(count):
            y = half * (2 * (i + 0.5) / count - 1) * 0.92
            w.bar((x, y, z[0] - 0.02), (at(0.98), y, z[1] - 0.02), 1.8 * share * half / count, 0.6 * t, frame)
    elif kind in ("ladder", "split", "grid"):
        _rails(w, x, half, z, lean, kind, t, frame if kind != "split" else cloth)
    elif kind == "curved":
        rail = w.length(0.2, 0.9) * tall
        parts.curved_board(w, at(1.0) - 0.03, half, (z[1] - rail, z[1]), w.choice((frame, cloth)), t, 0.04)
    elif kind == "oval":
        power, low = w.choice((2.0, 2.6, 4.0)), w.length(0.05, 0.3)
        rz, middle = 0.5 * (1 - low) * tall, 0.5 * (1 + low)
        rings = [Ring(s * 0.5 * t, g * rz, g * half, power=power) for s, g in ((-1.0, 1.0), (1.0, 1.0), (2.4, 0.8))]
        tilt = 0.5 * math.pi - math.atan2(lean, tall)
        w.mesh(loft(rings, 16, hull=True), (at(middle), 0.0, z[0] + middle * tall), cloth, tilt=tilt)
        for side in BOTH_SIDES:
            w.bar(
                (x, side * 0.5 * half, z[0] - 0.03), (at(middle), side * 0.4 * half, z[0] + middle * tall), t, t, frame
            )
    elif kind == "cross":
        w.bar((at(1.0), -half, z[1] - 0.02), (at(1.0), half, z[1] - 0.02), t, 0.05, frame)
        for side in BOTH_SIDES:
            w.bar(
                (at(0.08), side * 0.95 * half, z[0] + 0.04), (at(0.95), -side * 0.95 * half, z[1] - 0.04), t, t, frame
            )
    elif kind == "bent":
        curl = w.length(-0.05, 0.05)
        path = [
            (at(1.0), z[1]),
            (at(0.6) + curl, z[0] + 0.6 * tall),
            (at(0.2) + curl, z[0] + 0.2 * tall),
            (x + 0.03, z[0] - 0.005),
        ]
        w.mesh(
            strip(path, w.length(0.012, 0.035), 2 * half * w.length(0.8, 1.0)),
            (0.0, 0.0, 0.0),
            w.choice((frame, cloth)),
        )
    elif kind == "hoop":
        _hoop(w, x, half, z, lean, frame)


def _rails(w: Workbench, x: float, half: float, z: Range, lean: float, kind: str, t: float, look: Look) -> None:
    """Adds level rails between two posts: a ladder of bars, one pad with a gap, or a grid."""
    tall = z[1] - z[0]
    count = w.whole(2, 5) if kind != "split" else 1
    part = (tall / count) * (w.length(0.25, 0.75) if kind != "split" else w.length(0.4, 0.75))
    for i in range(count):
        up = z[1] - 0.5 * part - i * tall / count
        px = x - lean * (up - z[0]) / tall
        thick = 0.6 * t if kind != "split" else 2.0 * t
        w.box(
            parts.centred(px, thick), (-half + 0.2 * t, half - 0.2 * t), parts.centred(up, part), look,
            tilt=math.atan2(-lean, tall),
        )  # fmt: skip
    if kind == "grid":
        for y in (-0.35 * half, 0.35 * half)[: w.whole(1, 2)]:
            w.bar((x, y, z[0] - 0.02), (x - lean, y, z[1] - 0.01), t, 0.5 * t, look)


def _hoop(w: Workbench, x: float, half: float, z: Range, lean: float, look: Look) -> None:
    """Adds a bent hoop with spindles."""
    tall, r, n = z[1] - z[0], w.length(0.008, 0.014), 8

    def rim(angle: float) -> tuple[float, float, float]:
        share = math.sin(angle) ** 0.7
        return (x - share * lean, half * math.cos(angle), z[0] - 0.02 + share * (tall + 0.02))

    parts.tube_along(w, [rim(max(0.0, math.pi * i / n)) for i in range(n)] + [(x, -half, z[0] - 0.02)], r, look)
    count = w.whole(2, 6)
    for i in range(count):
        y = half * (2 * (i + 1) / (count + 1) - 1)
        end = rim(math.acos(y / half))
        w.rod((x, 0.85 * y, z[0] - 0.02), end, 0.6 * r, look)


def add_arms(w: Workbench, seat: Seat, back_x: float, rise: float, frame: Look, cloth: Look) -> None:
    """Adds two armrests of a drawn kind, `rise` metres above the seat, that reach to the backrest."""
    kind = w.choice(("post", "loop", "panel", "pad", "slope", "low"))
    z, y, t = seat.z + rise, seat.half + 0.012, w.length(0.018, 0.03)
    front, under = seat.x[1] - w.length(0.02, 0.14), seat.z - 0.5 * seat.thick
    wide = w.length(0.03, 0.07)
    for side in BOTH_SIDES:
        c = side * y
        if kind == "loop":
            parts.tube_along(w, [(front, c, under), (front, c, z), (back_x, c, z), (back_x, c, under)], 0.5 * t, frame)
        elif kind == "panel":
            w.box((back_x - 0.01, front), parts.centred(c, t), (under, z), w.choice((frame, frame)))
        elif kind == "pad":
            size = (front - back_x + 0.02, max(wide, 0.05), z - under)
            parts.pad(w, size, (0.5 * (front + back_x), c, 0.5 * (z + under)), cloth, 0.02)
        else:
            start = z - (0.06 if kind == "slope" else 0.0) - (0.3 * rise if kind == "low" else 0.0)
            w.bar((front + 0.02, c, start), (back_x - 0.02, c, z), wide, t, frame)
            w.bar((front - 0.02, c, under), (front, c, start), t, t, frame)
            w.bar((back_x + 0.03, c, under), (back_x, c, z), t, t, frame)
    if kind != "pad":
        for x in (back_x + 0.01, front - 0.02):
            w.rod((x, -y, under + 0.01), (x, y, under + 0.01), 0.35 * t, frame)
