"""Stools, for bars and low.

Ranges after Panero & Zelnik, Human Dimension and Interior Space (bar seats 0.62-0.78 m, low stools 0.42-0.47 m high,
0.30-0.40 m across).
"""

from __future__ import annotations

import math

from sim.houses.furniture.catalogue import Style
from sim.houses.furniture.shapes import (
    Ring,
    chamfered_box,
    loft,
)
from sim.houses.furniture.workbench import Workbench

_BOTH = (-1, 1)


def bar_wood(w: Workbench) -> None:
    """Bar stool: square seat, four slightly splayed legs, footrests."""
    w.mass_kg = 5.0
    seat, half, wood = w.length(0.66, 0.76), 0.5 * w.length(0.32, 0.38), w.look("wood")
    w.mesh(
        chamfered_box((2 * half, 2 * half, 0.05), 0.015),
        (0.0, 0.0, seat - 0.025),
        w.look("leather") if w.chance(0.4) else wood,
    )
    for sx in _BOTH:
        for sy in _BOTH:
            w.bar(
                (sx * (half + 0.02), sy * (half + 0.02), 0.0),
                (sx * (half - 0.03), sy * (half - 0.03), seat - 0.05),
                0.036,
                0.036,
                wood,
            )
    for side in _BOTH:
        edge = half + 0.002
        w.box((side * edge - 0.012, side * edge + 0.012), (-edge, edge), (0.24, 0.27), wood)
        w.box((-edge, edge), (side * edge - 0.012, side * edge + 0.012), (0.30, 0.33), wood)


def low_round(w: Workbench) -> None:
    """Low stool: round seat, three or four splayed legs."""
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
    """Backless bar stool: curved saddle seat on a sled of steel rod."""
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
    for side in _BOTH:
        y = side * (half - 0.02)
        for x0, x1 in ((-0.19, -0.10), (0.19, 0.10)):
            w.rod((x0, y, 0.009), (x1, y * 0.8, seat - 0.05), 0.009, iron, round_ends=True)
        w.rod((-0.19, y, 0.009), (0.19, y, 0.009), 0.009, iron)
    for x, z in ((0.163, 0.20), (-0.163, 0.20)):
        w.rod((x, -half + 0.03, z), (x, half - 0.03, z), 0.009, iron)


STYLES = (
    Style("stool", "bar_wood", "train", bar_wood, ("bar",)),
    Style("stool", "low_round", "train", low_round, ("low",)),
    Style("stool", "saddle", "heldout", saddle, ("bar", "low")),
)
