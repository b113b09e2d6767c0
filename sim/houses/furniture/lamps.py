"""Lamps.

Usual retail dimensions: ceiling lamps 0.30-0.60 m across, floor lamps 1.40-1.75 m, table lamps 0.35-0.60 m high.
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


def pendant(w: Workbench) -> None:
    """Shade on a cord."""
    r, drop = 0.5 * w.length(0.32, 0.50), w.length(0.40, 0.70)
    w.cylinder((0.0, 0.0), (-0.03, 0.0), 0.05, w.look("iron"), solid=False)
    w.rod((0.0, 0.0, -drop), (0.0, 0.0, -0.02), 0.005, w.look("dark"), solid=False)
    w.mesh(
        loft(
            [Ring(-drop - 0.20, r, r), Ring(-drop - 0.02, 0.35 * r, 0.35 * r), Ring(-drop + 0.02, 0.12 * r, 0.12 * r)],
            16,
            hull=True,
        ),
        (0.0, 0.0, 0.0),
        w.look("shade"),
        solid=False,
    )
    w.ball((0.0, 0.0, -drop - 0.18), 0.06, w.look("glow"), solid=False)


def ceiling_disc(w: Workbench) -> None:
    """Flat round ceiling lamp."""
    r = 0.5 * w.length(0.32, 0.50)
    w.cylinder((0.0, 0.0), (-0.05, 0.0), r, w.look("metal"), solid=False)
    w.ellipsoid((0.0, 0.0, -0.05), (0.92 * r, 0.92 * r, 0.06), w.look("glow"), solid=False)


def globe_pendant(w: Workbench) -> None:
    """Three glass globes at different heights from a bar."""
    w.box((-0.04, 0.04), (-0.35, 0.35), (-0.03, 0.0), w.look("brass"), solid=False)
    for i in range(3):
        drop, y = w.length(0.25, 0.60), (i - 1) * 0.28
        w.rod((0.0, y, -drop), (0.0, y, -0.02), 0.004, w.look("dark"), solid=False)
        w.ball((0.0, y, -drop - 0.09), 0.10, w.look("glow"), solid=False)


def floor_lamp(w: Workbench) -> None:
    """Disc foot, pole, drum shade."""
    tall, metal, r = w.length(1.45, 1.70), w.look("metal"), 0.5 * w.length(0.32, 0.44)
    w.cylinder((0.0, 0.0), (0.0, 0.025), 0.15, metal)
    w.cylinder((0.0, 0.0), (0.02, tall - 0.05), 0.012, metal)
    w.mesh(
        loft([Ring(tall - 0.28, r, r), Ring(tall, 0.75 * r, 0.75 * r)], 16, hull=True), (0.0, 0.0, 0.0), w.look("shade")
    )
    w.cylinder((0.0, 0.0), (tall - 0.285, tall - 0.27), 0.8 * r, w.look("glow"), solid=False)


def tripod_lamp(w: Workbench) -> None:
    """Floor lamp on a wooden tripod."""
    tall, wood, r = w.length(1.40, 1.60), w.look("wood"), 0.5 * w.length(0.40, 0.48)
    for i in range(3):
        a = math.tau * i / 3
        w.rod(
            (0.26 * math.cos(a), 0.26 * math.sin(a), 0.013),
            (0.02 * math.cos(a), 0.02 * math.sin(a), tall - 0.26),
            0.014,
            wood,
            round_ends=True,
        )
    w.cylinder((0.0, 0.0), (tall - 0.30, tall), r, w.look("shade"))
    w.cylinder((0.0, 0.0), (tall - 0.305, tall - 0.295), 0.85 * r, w.look("glow"), solid=False)


def table_lamp(w: Workbench) -> None:
    """Ceramic body, cone shade."""
    tall, r, body = w.length(0.38, 0.56), 0.5 * w.length(0.22, 0.32), w.look("pot")
    w.mesh(
        loft(
            [
                Ring(0.0, 0.06, 0.06),
                Ring(0.08, 0.085, 0.085),
                Ring(0.45 * tall, 0.045, 0.045),
                Ring(0.6 * tall, 0.015, 0.015),
            ],
            12,
            hull=True,
        ),
        (0.0, 0.0, 0.0),
        body,
    )
    w.mesh(
        loft([Ring(0.55 * tall, r, r), Ring(tall, 0.6 * r, 0.6 * r)], 14, hull=True), (0.0, 0.0, 0.0), w.look("shade")
    )


def mushroom_lamp(w: Workbench) -> None:
    """Table lamp: cylinder foot under a dome."""
    tall, look = w.length(0.34, 0.46), w.look("shade")
    w.cylinder((0.0, 0.0), (0.0, 0.65 * tall), 0.05, w.look("brass"))
    w.cylinder((0.0, 0.0), (0.0, 0.015), 0.09, w.look("brass"))
    w.mesh(
        loft(
            [
                Ring(0.55 * tall, 0.16, 0.16),
                Ring(0.75 * tall, 0.15, 0.15),
                Ring(0.92 * tall, 0.10, 0.10),
                Ring(tall, 0.03, 0.03),
            ],
            14,
            hull=True,
        ),
        (0.0, 0.0, 0.0),
        look,
    )


STYLES = (
    Style("lighting", "pendant", "train", pendant, ("ceiling",), "ceiling"),
    Style("lighting", "ceiling_disc", "train", ceiling_disc, ("ceiling",), "ceiling"),
    Style("lighting", "globe_pendant", "heldout", globe_pendant, ("ceiling",), "ceiling"),
    Style("lighting", "floor_lamp", "train", floor_lamp, ("floor",)),
    Style("lighting", "tripod_lamp", "heldout", tripod_lamp, ("floor",)),
    Style("lighting", "table_lamp", "train", table_lamp, ("table",), "top"),
    Style("lighting", "mushroom_lamp", "heldout", mushroom_lamp, ("table",), "top"),
)
