"""Basins and taps."""

from __future__ import annotations

from sim.housegen.furniture.item import Look
from sim.housegen.furniture.parts.frames import arched_pipe
from sim.housegen.furniture.parts.spans import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring
from sim.housegen.furniture.workbench import Point, Range, Workbench


def basin(
    w: Workbench, x: Range, y: Range, rim: float, deep: float, wall: float, look: Look, *, floor: Look | None = None
) -> None:
    """Adds an open box of four walls and a floor, its rim at height `rim`."""
    z = (rim - deep, rim)
    w.box((x[0], x[0] + wall), y, z, look)
    w.box((x[1] - wall, x[1]), y, z, look)
    w.box((x[0] + wall, x[1] - wall), (y[0], y[0] + wall), z, look)
    w.box((x[0] + wall, x[1] - wall), (y[1] - wall, y[1]), z, look)
    w.box((x[0] + wall, x[1] - wall), (y[0] + wall, y[1] - wall), (rim - deep, rim - deep + wall), floor or look)


def hollow_rings(rim: float, rx: float, ry: float, deep: float, thick: float, power: float) -> list[Ring]:
    """Returns the upper rings of a lofted bowl, from its outer rim inwards and down to its floor."""
    return [
        Ring(rim, rx, ry, power=power),
        Ring(rim, rx - thick, ry - thick, power=power),
        Ring(rim - 0.6 * deep, 0.84 * (rx - thick), 0.84 * (ry - thick), power=power),
        Ring(rim - deep, 0.45 * rx, 0.45 * ry, power=power),
    ]


def any_tap(w: Workbench, at: Point, reach: float, high: float, look: Look) -> None:
    """Adds a tap of one of five kinds, drawn at random."""
    tap = w.choice((mixer_tap, _swan_neck_tap, _block_tap, _bridge_tap, _pillar_tap))
    tap(w, at, reach, high, look)


def mixer_tap(w: Workbench, at: Point, reach: float, high: float, look: Look) -> None:
    """Adds a mixer: a post, a spout towards +x and a lever."""
    x, y, z = at
    w.rod((x, y, z), (x, y, z + high), 0.014, look, solid=False)
    w.rod((x, y, z + high), (x + reach, y, z + high - 0.02), 0.010, look, solid=False, round_ends=True)
    w.bar((x, y + 0.004, z + high), (x, y + 0.06, z + high + 0.02), 0.014, 0.01, look, solid=False)


def _swan_neck_tap(w: Workbench, at: Point, reach: float, high: float, look: Look) -> None:
    """Adds a post with an arched spout and a lever at its side."""
    x, y, z = at
    w.rod(at, (x, y, z + high), 0.012, look, solid=False)
    arched_pipe(w, (x, y, z + high), (x + reach, y, z + high - 0.02), 0.4 * reach, 0.010, look)
    w.rod((x, y, z + 0.04), (x, y + 0.06, z + 0.05), 0.007, look, solid=False, round_ends=True)


def _block_tap(w: Workbench, at: Point, reach: float, high: float, look: Look) -> None:
    """Adds a tap of square blocks."""
    x, y, z = at
    w.box((x - 0.018, x + 0.018), (y - 0.018, y + 0.018), (z, z + 0.8 * high), look, solid=False)
    w.box((x - 0.018, x + reach), (y - 0.018, y + 0.018), (z + 0.62 * high, z + 0.8 * high), look, solid=False)
    w.box((x - 0.012, x + 0.05), (y - 0.01, y + 0.01), (z + 0.8 * high, z + 0.8 * high + 0.014), look, solid=False)


def _bridge_tap(w: Workbench, at: Point, reach: float, high: float, look: Look) -> None:
    """Adds two cross heads that a pipe joins, with an arched spout in the middle."""
    x, y, z = at
    for side in BOTH_SIDES:
        c = y + side * 0.08
        w.cylinder((x, c), (z, z + 0.07), 0.011, look, solid=False)
        w.box((x - 0.025, x + 0.025), (c - 0.006, c + 0.006), (z + 0.07, z + 0.08), look)
    w.rod((x, y - 0.08, z + 0.045), (x, y + 0.08, z + 0.045), 0.009, look, solid=False)
    w.rod((x, y, z + 0.04), (x, y, z + high), 0.010, look, solid=False)
    arched_pipe(w, (x, y, z + high), (x + reach, y, z + high - 0.02), 0.3 * reach, 0.009, look, 3)


def _pillar_tap(w: Workbench, at: Point, reach: float, high: float, look: Look) -> None:
    """Adds a thick post with a rising spout and a round head on top."""
    x, y, z = at
    w.cylinder((x, y), (z, z + 0.6 * high), 0.02, look, solid=False)
    w.rod((x, y, z + 0.4 * high), (x + reach, y, z + 0.5 * high), 0.011, look, solid=False, round_ends=True)
    w.cylinder((x, y), (z + 0.6 * high, z + 0.6 * high + 0.03), 0.032, look, solid=False)
