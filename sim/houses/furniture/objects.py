"""Small objects on tops and floors, and furniture of no other category.

Usual retail dimensions; pianos 1.10-1.28 m high and 1.42-1.52 m wide, screens 1.65-1.80 m high.
"""

from __future__ import annotations

import math

from sim.houses.furniture.catalogue import Style
from sim.houses.furniture.shapes import (
    Ring,
    loft,
)
from sim.houses.furniture.workbench import Workbench

_BOTH = (-1, 1)


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


def box_crate(w: Workbench) -> None:
    """Cardboard box, taped."""
    dx, dy, dz = 0.5 * w.length(0.28, 0.42), 0.5 * w.length(0.34, 0.55), w.length(0.24, 0.38)
    w.box((-dx, dx), (-dy, dy), (0.0, dz), w.look("wicker"))
    w.box((-dx - 0.001, dx + 0.001), (-0.025, 0.025), (dz - 0.08, dz + 0.002), w.look("paper"), solid=False)


STYLES = (
    Style("furniture", "upright_piano", "train", upright_piano, ("piano",)),
    Style("furniture", "folding_screen", "heldout", folding_screen, ("screen",)),
    Style("objects", "book_stack", "train", book_stack, ("top",), "top"),
    Style("objects", "vase", "heldout", vase, ("top",), "top"),
    Style("objects", "fruit_bowl", "train", fruit_bowl, ("kitchen", "top"), "top"),
    Style("objects", "crate", "train", box_crate, ("floor",)),
)
