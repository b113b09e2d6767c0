"""Basins and taps."""

from __future__ import annotations

from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts.spans import inset
from sim.homes.housegen.furniture.workbench import Point, Range, Workbench


def basin(w: Workbench, x: Range, y: Range, rim: float, depth: float, wall: float, look: Look) -> None:
    """Adds an open box of four walls and a floor, with its rim at the height `rim`."""
    z = (rim - depth, rim)
    w.box((x[0], x[0] + wall), y, z, look)
    w.box((x[1] - wall, x[1]), y, z, look)
    w.box(inset(x, wall), (y[0], y[0] + wall), z, look)
    w.box(inset(x, wall), (y[1] - wall, y[1]), z, look)
    w.box(inset(x, wall), inset(y, wall), (rim - depth, rim - depth + wall), look)


def mixer_tap(w: Workbench, at: Point, reach: float, height: float, look: Look) -> None:
    """Adds a mixer: a post, a spout towards +x and a lever."""
    x, y, z = at
    w.cylinder((x, y), (z, z + height), 0.014, look, solid=False)
    w.rod((x, y, z + height), (x + reach, y, z + height - 0.02), 0.010, look, solid=False, round_ends=True)
    w.bar((x, y + 0.004, z + height), (x, y + 0.06, z + height + 0.02), 0.014, 0.01, look, solid=False)
