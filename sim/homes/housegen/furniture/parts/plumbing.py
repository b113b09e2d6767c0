"""Basins and taps."""

from __future__ import annotations

from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts.frames import arched_pipe
from sim.homes.housegen.furniture.parts.spans import BOTH_SIDES
from sim.homes.housegen.furniture.shapes import Ring
from sim.homes.housegen.furniture.workbench import Point, Range, Workbench


def basin(w: Workbench, x: Range, y: Range, rim: float, depth: float, wall: float, look: Look) -> None:
    """Adds an open box of four walls and a floor, with its rim at the height `rim`."""
    z = (rim - depth, rim)
    w.box((x[0], x[0] + wall), y, z, look)
    w.box((x[1] - wall, x[1]), y, z, look)
    w.box((x[0] + wall, x[1] - wall), (y[0], y[0] + wall), z, look)
    w.box((x[0] + wall, x[1] - wall), (y[1] - wall, y[1]), z, look)
    w.box((x[0] + wall, x[1] - wall), (y[0] + wall, y[1] - wall), (rim - depth, rim - depth + wall), look)


def hollow_rings(rim: float, rx: float, ry: float, depth: float, wall: float, power: float) -> list[Ring]:
    """Returns the upper rings of a lofted bowl, from its outer rim inwards and down to its floor."""
    return [
        Ring(rim, rx, ry, power=power),
        Ring(rim, rx - wall, ry - wall, power=power),
        Ring(rim - 0.6 * depth, 0.84 * (rx - wall), 0.84 * (ry - wall), power=power),
        Ring(rim - depth, 0.45 * rx, 0.45 * ry, power=power),
    ]


def any_tap(w: Workbench, at: Point, reach: float, height: float, look: Look) -> None:
    """Adds a tap of one of five kinds, drawn at random."""
    tap = w.choice((mixer_tap, _swan_neck_tap, _block_tap, _bridge_tap, _pillar_tap))
    tap(w, at, reach, height, look)


def mixer_tap(w: Workbench, at: Point, reach: float, height: float, look: Look) -> None:
    """Adds a mixer: a post, a spout towards +x and a lever."""
    x, y, z = at
    w.rod((x, y, z), (x, y, z + height), 0.014, look, solid=False)
    w.rod((x, y, z + height), (x + reach, y, z + height - 0.02), 0.010, look, solid=False, round_ends=True)
    w.bar((x, y + 0.004, z + height), (x, y + 0.06, z + height + 0.02), 0.014, 0.01, look, solid=False)


def _swan_neck_tap(w: Workbench, at: Point, reach: float, height: float, look: Look) -> None:
    """Adds a post with an arched spout and a lever at its side."""
    x, y, z = at
    w.rod(at, (x, y, z + height), 0.012, look, solid=False)
    arched_pipe(w, (x, y, z + height), (x + reach, y, z + height - 0.02), 0.4 * reach, 0.010, look)
    w.rod((x, y, z + 0.04), (x, y + 0.06, z + 0.05), 0.007, look, solid=False, round_ends=True)


def _block_tap(w: Workbench, at: Point, reach: float, height: float, look: Look) -> None:
    """Adds a tap of square blocks."""
    x, y, z = at
    w.box((x - 0.018, x + 0.018), (y - 0.018, y + 0.018), (z, z + 0.8 * height), look, solid=False)
    w.box((x - 0.018, x + reach), (y - 0.018, y + 0.018), (z + 0.62 * height, z + 0.8 * height), look, solid=False)
    w.box((x - 0.012, x + 0.05), (y - 0.01, y + 0.01), (z + 0.8 * height, z + 0.8 * height + 0.014), look, solid=False)


def _bridge_tap(w: Workbench, at: Point, reach: float, height: float, look: Look) -> None:
    """Adds two cross heads that a pipe joins, with an arched spout in the middle."""
    x, y, z = at
    for side in BOTH_SIDES:
        c = y + side * 0.08
        w.cylinder((x, c), (z, z + 0.07), 0.011, look, solid=False)
        w.box((x - 0.025, x + 0.025), (c - 0.006, c + 0.006), (z + 0.07, z + 0.08), look)
    w.rod((x, y - 0.08, z + 0.045), (x, y + 0.08, z + 0.045), 0.009, look, solid=False)
    w.rod((x, y, z + 0.04), (x, y, z + height), 0.010, look, solid=False)
    arched_pipe(w, (x, y, z + height), (x + reach, y, z + height - 0.02), 0.3 * reach, 0.009, look, 3)


def _pillar_tap(w: Workbench, at: Point, reach: float, height: float, look: Look) -> None:
    """Adds a thick post with a rising spout and a round head on top."""
    x, y, z = at
    w.cylinder((x, y), (z, z + 0.6 * height), 0.02, look, solid=False)
    w.rod((x, y, z + 0.4 * height), (x + reach, y, z + 0.5 * height), 0.011, look, solid=False, round_ends=True)
    w.cylinder((x, y), (z + 0.6 * height, z + 0.6 * height + 0.03), 0.032, look, solid=False)
