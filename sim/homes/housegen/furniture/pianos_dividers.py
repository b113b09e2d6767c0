"""Furniture that belongs to no other category: pianos and room dividers.

Usual retail dimensions: pianos 1.10-1.28 m high and 1.42-1.52 m wide, screens 1.60-1.80 m high.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, centred, inset
from sim.homes.housegen.furniture.shapes import chamfered_box
from sim.homes.housegen.furniture.workbench import Workbench


def digital_piano(w: Workbench) -> None:
    """Builds a keyboard on crossed legs with a music rest."""
    half, dark, metal = 0.5 * w.length(1.20, 1.35), w.look("dark"), w.look("metal")
    w.mesh(chamfered_box((0.32, 2 * half, 0.12), 0.02), (0.0, 0.0, 0.74), dark)
    w.box((0.0, 0.145), (-half + 0.06, half - 0.06), (0.795, 0.806), w.look("ceramic"), solid=False)
    w.box((0.0, 0.08), (-half + 0.08, half - 0.08), (0.80, 0.814), w.look("char"), solid=False)
    w.box((-0.10, -0.08), (-0.28, 0.28), (0.79, 1.0), dark, tilt=-0.25, solid=False)
    for side in BOTH_SIDES:
        y = side * (half - 0.22)
        w.bar((-0.02, y - side * 0.28, 0.02), (-0.02, y + side * 0.10, 0.69), 0.04, 0.04, metal)
        w.bar((0.03, y + side * 0.10, 0.02), (0.03, y - side * 0.28, 0.69), 0.04, 0.04, metal)
        for dy in (-0.28, 0.10):
            w.box((-0.17, 0.17), around(y + side * dy, 0.02), (0.0, 0.035), metal)


def upright_piano(w: Workbench) -> None:
    """Builds an upright piano with keys, a music desk and pedals."""
    high, half, look = (
        w.length(1.10, 1.28),
        0.5 * w.length(1.42, 1.52),
        w.look("dark") if w.chance(0.5) else w.look("wood"),
    )
    w.box((-0.30, 0.02), (-half, half), (0.05, high), look)
    w.box((-0.31, 0.05), (-half - 0.01, half + 0.01), (high, high + 0.025), look)
    w.box((0.02, 0.28), (-half, half), (0.58, 0.72), look)
    for c in inset((-half, half), 0.03):
        w.box((-0.30, 0.30), around(c, 0.03), (0.0, 0.06), look)
        w.box((0.22, 0.28), around(c, 0.03), (0.05, 0.60), look)
    w.box((0.11, 0.27), (-half + 0.08, half - 0.08), (0.72, 0.735), w.look("ceramic"), solid=False)
    w.box((0.11, 0.20), (-half + 0.10, half - 0.10), (0.735, 0.745), w.look("char"), solid=False)
    w.box((0.02, 0.05), (-0.40, 0.40), (0.86, 1.04), look, tilt=-0.25, solid=False)
    for y in (-0.1, 0.0, 0.1):
        w.box((0.02, 0.14), around(y, 0.015), (0.05, 0.065), w.look("brass"), solid=False)
    w.top((-0.25, 0.0), (-half + 0.1, half - 0.1), high + 0.025)


def folding_screen(w: Workbench) -> None:
    """Builds a room divider of three or four panels in zigzag."""
    panels, panel_m, high = w.whole(3, 4), w.length(0.42, 0.50), w.length(1.65, 1.80)
    wood, cloth = w.look("wood"), w.look("curtain")
    for c, turn in _zigzag(panels, panel_m, 0.35):
        dx, dy = -math.sin(turn), math.cos(turn)
        y = inset(around(c, 0.5 * panel_m), 0.02)
        w.box((-0.008, 0.008), y, (0.10, high - 0.03), cloth, turn=turn)
        for t in centred(panel_m, 0.015):
            w.box(around(t * dx, 0.014), around(c + t * dy, 0.014), (0.0, high), wood, turn=turn)
        for z in (0.10, high - 0.03):
            w.box((-0.012, 0.012), y, around(z, 0.02), wood, turn=turn)


def shoji_screen(w: Workbench) -> None:
    """Builds a room divider of four upright lattice panels of wood and paper in zigzag."""
    panel_m, high = w.length(0.40, 0.46), w.length(1.60, 1.75)
    wood, paper = w.look("wood"), w.look("paper")
    for c, turn in _zigzag(4, panel_m, 0.30):
        dx, dy = -math.sin(turn), math.cos(turn)
        w.box((-0.004, 0.004), around(c, 0.5 * panel_m), (0.05, high - 0.02), paper, turn=turn)
        for t in (-0.5 * panel_m + 0.012, 0.0, 0.5 * panel_m - 0.012):
            w.box(around(t * dx, 0.011), around(c + t * dy, 0.011), (0.0 if t else 0.05, high), wood, turn=turn)
        for z in (0.05, 0.36 * high, 0.68 * high, high - 0.03):
            w.box((-0.010, 0.010), around(c, 0.5 * panel_m), (z, z + 0.03), wood, turn=turn)


def _zigzag(panels: int, panel_m: float, fold_rad: float) -> Iterator[tuple[float, float]]:
    """Yields middle along y and turn of each panel of a folding screen."""
    for i in range(panels):
        yield (i + 0.5 - 0.5 * panels) * panel_m * math.cos(fold_rad), fold_rad if i % 2 == 0 else -fold_rad


STYLES = (
    Style("furniture", "digital_piano", "heldout", digital_piano, ("piano",)),
    Style("furniture", "upright_piano", "train", upright_piano, ("piano",)),
    Style("furniture", "folding_screen", "train", folding_screen, ("screen",)),
    Style("furniture", "shoji_screen", "heldout", shoji_screen, ("screen",)),
)
