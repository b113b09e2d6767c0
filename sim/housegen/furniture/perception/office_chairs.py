"""Office chairs of the pool `wide`."""

from __future__ import annotations

import math

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.office_chairs import OFFICE_KG
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring, arc_wall, loft, pillow, strip
from sim.housegen.furniture.workbench import Workbench


def mesh_back(w: Workbench) -> None:
    """Builds an office chair with a net in a frame, a lumbar bar, and often a headrest and arms."""
    w.mass_kg = OFFICE_KG
    seat, half, height = w.length(0.44, 0.50), 0.5 * w.length(0.46, 0.52), w.length(0.92, 1.06)
    frame = w.look(w.choice(("dark", "dark", "plastic", "chrome")))
    net, cloth = w.look(w.choice(("dark", "fabric"))), w.look("fabric")
    parts.star_base(w, w.length(0.29, 0.34), 5, frame, seat - 0.07)
    parts.pad(w, (w.length(0.44, 0.50), 2 * half, 0.08), (0.03, 0.0, seat - 0.04), cloth, 0.03)
    w.box((-0.18, 0.12), (-0.10, 0.10), (seat - 0.12, seat - 0.075), frame)
    low, waist, top = (-0.22, seat + 0.06), (-0.205, seat + 0.22), (-0.22 - w.length(0.06, 0.12), height)
    narrow = half - w.length(0.02, 0.08)
    for side in BOTH_SIDES:
        ends = [
            (low[0], side * narrow, low[1]),
            (waist[0], side * (half - 0.02), waist[1]),
            (top[0], side * narrow, top[1]),
        ]
        parts.tube_along(w, ends, 0.013, frame)
    for x, z in (low, top):
        w.rod((x, -narrow, z), (x, narrow, z), 0.013, frame)
    w.mesh(strip([low, waist, top], 0.006, 2 * narrow + 0.01), (0.0, 0.0, 0.0), net)
    w.bar((-0.15, 0.0, seat - 0.09), (-0.27, 0.0, seat - 0.04), 0.07, 0.025, frame)
    w.bar((-0.265, 0.0, seat - 0.05), (waist[0] - 0.03, 0.0, seat + 0.30), 0.06, 0.025, frame)
    w.box((waist[0] - 0.03, waist[0]), (-narrow, narrow), (waist[1] - 0.02, waist[1] + 0.05), frame)
    if w.chance(0.5):
        w.bar((top[0] - 0.01, 0.0, height - 0.02), (top[0] - 0.01, 0.0, height + 0.10), 0.05, 0.015, frame)
        parts.pad(w, (0.05, 0.28, 0.12), (top[0] + 0.005, 0.0, height + 0.12), w.choice((net, cloth)), 0.02)
    if w.chance(0.75):
        arm = seat + w.length(0.17, 0.24)
        for side in BOTH_SIDES:
            y = side * (half + 0.03)
            w.bar((-0.03, side * 0.09, seat - 0.10), (-0.03, y, seat - 0.09), 0.04, 0.02, frame)
            w.bar((-0.03, y, seat - 0.10), (0.0, y, arm), 0.03, 0.05, frame)
            parts.pad(w, (0.26, 0.08, 0.03), (0.02, y, arm), w.look("rubber"), 0.012)


def gaming_chair(w: Workbench) -> None:
    """Builds a racing seat on castors with raised sides, shoulder wings, stripes and pillows."""
    w.mass_kg = 18.0
    seat, half, height = w.length(0.46, 0.52), 0.5 * w.length(0.50, 0.56), w.length(1.20, 1.32)
    hide, stripe, dark = w.look("leather"), w.look("bright"), w.look("dark")
    parts.star_base(w, 0.34, 5, dark, seat - 0.08)
    w.box((-0.20, 0.15), (-0.14, 0.14), (seat - 0.13, seat - 0.09), dark)
    parts.pad(w, (0.50, 2 * half - 0.14, 0.10), (0.04, 0.0, seat - 0.05), hide, 0.02)
    high = height - seat
    lean = -w.length(0.10, 0.22)

    def behind(z: float) -> float:
        """Returns the x of the middle of the back at the height z."""
        return -0.22 + (z - seat) * math.tan(lean)

    parts.pad(
        w,
        (0.10, 2 * half - 0.18, high + 0.1),
        (behind(seat + 0.5 * high - 0.05), 0.0, seat + 0.5 * high - 0.05),
        hide,
        0.035,
        tilt=lean,
    )
    for side in BOTH_SIDES:
        parts.pad(w, (0.50, 0.09, 0.14), (0.04, side * (half - 0.05), seat - 0.03), stripe, 0.03)
        z = seat + 0.28
        parts.pad(w, (0.14, 0.09, 0.40), (behind(z) + 0.03, side * (half - 0.075), z), stripe, 0.03, tilt=lean)
        z = seat + 0.62 * high + 0.06
        parts.pad(
            w,
            (0.12, 0.11, 0.26),
            (behind(z) + 0.02, side * (half - 0.07), z),
            w.choice((stripe, hide)),
            0.04,
            tilt=lean,
        )
        y = side * (half + 0.05)
        w.bar((-0.05, side * 0.13, seat - 0.11), (-0.05, y, seat - 0.10), 0.05, 0.025, dark)
        w.bar((-0.05, y, seat - 0.11), (-0.02, y, seat + 0.21), 0.04, 0.06, dark)
        parts.pad(w, (0.28, 0.10, 0.035), (0.0, y, seat + 0.22), dark, 0.012)
    if w.chance(0.8):
        w.mesh(pillow((0.20, 0.28, 0.11)), (behind(height - 0.14) + 0.08, 0.0, height - 0.14), dark, tilt=1.4)
    if w.chance(0.6):
        w.mesh(pillow((0.24, 0.34, 0.13)), (behind(seat + 0.2) + 0.09, 0.0, seat + 0.17), stripe, tilt=1.4)


def swivel_shell(w: Workbench) -> None:
    """Builds a home-office chair with a round shell on a low star base, on castors or glides."""
    w.mass_kg = 9.0
    seat, half, height = w.length(0.43, 0.50), 0.5 * w.length(0.48, 0.58), w.length(0.72, 0.86)
    shell = w.look("plastic") if w.chance(0.5) else parts.upholstery_look(w)
    base = w.look(w.choice(("wood", "chrome", "lacquer", "dark")))
    parts.star_base(w, w.length(0.24, 0.30), w.choice((4, 5)), base, seat - 0.06, castors=w.chance(0.6))
    bowl = [Ring(0.0, 0.13, 0.13), Ring(0.03, 0.22, half - 0.02, power=2.6), Ring(0.07, 0.235, half, power=2.6)]
    w.mesh(loft(bowl, 16, hull=True), (0.0, 0.0, seat - 0.07), shell)
    side_top, rise = w.length(0.04, 0.20), height - seat + 0.03
    spread, n = w.length(0.42, 0.60) * math.pi, 11
    angles = [math.pi + spread * (2 * i / (n - 1) - 1) for i in range(n)]
    tops = [side_top + (rise - side_top) * math.cos(0.5 * math.pi * abs(2 * i / (n - 1) - 1)) for i in range(n)]
    w.mesh(
        arc_wall(half, w.choice((0.02, 0.05)), 0.0, angles, tops), (half - 0.235, 0.0, seat - 0.03), shell, tilt=-0.08
    )
    if w.chance(0.6):
        parts.pad(w, (0.38, 1.6 * half, 0.045), (0.03, 0.0, seat + 0.015), parts.upholstery_look(w), 0.02)


STYLES: tuple[Style, ...] = (
    Style("chair", "mesh_back", "wide", mesh_back, ("office",)),
    Style("chair", "gaming_chair", "wide", gaming_chair, ("office",)),
    Style("chair", "swivel_shell", "wide", swivel_shell, ("office",)),
)
