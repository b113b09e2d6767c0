"""Details of other items: fires and arches, paintings, fittings of showers, weights."""

from __future__ import annotations

import math

import numpy as np

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.item import Look, MeshShape
from sim.homes.housegen.furniture.parts.fire import flames
from sim.homes.housegen.furniture.shapes import named_mesh
from sim.homes.housegen.furniture.workbench import Point, Range, Workbench


def wall_above_arch(x: Range, half: float, spring: float, rise: float, top: float) -> MeshShape:
    """Returns the wall above an arched opening |y| < half, from the arch that starts at `spring` up to `top`."""
    n = 12
    angles = np.linspace(0.0, math.pi, n)
    y = half * np.cos(angles)
    arc = spring + rise * np.sin(angles)
    rows = [np.column_stack([np.full(n, at), y, z]) for at in x for z in (arc, np.full(n, top))]
    low_b, up_b, low_f, up_f = 0, n, 2 * n, 3 * n
    quads = []
    for i in range(n - 1):
        quads += [
            (low_f + i, up_f + i, up_f + i + 1, low_f + i + 1),
            (low_b + i, low_b + i + 1, up_b + i + 1, up_b + i),
            (low_f + i, low_f + i + 1, low_b + i + 1, low_b + i),
            (up_f + i + 1, up_f + i, up_b + i, up_b + i + 1),
        ]
    e = n - 1
    quads += [(up_f, low_f, low_b, up_b), (low_f + e, up_f + e, up_b + e, low_b + e)]
    faces = [triangle for a, b, c, d in quads for triangle in ((a, b, c), (a, c, d))]
    return named_mesh("arch", np.vstack(rows), faces)


def logs(w: Workbench, at: Point, half: float, *, burning: float = 0.7) -> None:
    """Adds logs that lie across each other, with flames with the probability `burning`."""
    x, y, z = at
    wood = w.look("wood")
    r = w.length(0.03, 0.05)
    w.rod((x - 0.05, y - half, z + r), (x - 0.05, y + half, z + r), r, wood)
    w.rod((x + 0.05, y - 0.9 * half, z + r), (x + 0.05, y + 0.8 * half, z + r), r, wood)
    w.rod((x - 0.04, y - 0.6 * half, z + 2.4 * r), (x + 0.04, y + 0.7 * half, z + 2.4 * r), 0.9 * r, wood)
    if w.chance(burning):
        tongues = [(y + w.length(-0.6, 0.6) * half, w.length(0.18, 0.36), 0.05) for _ in range(w.whole(1, 3))]
        flames(w, x, z + 2 * r, tongues)


def _equal_ranges(low: float, high: float, count: int, gap: float) -> list[Range]:
    """Returns `count` equal ranges between low and high with gaps between them."""
    each = (high - low - (count - 1) * gap) / count
    return [(low + i * (each + gap), low + i * (each + gap) + each) for i in range(count)]


def _sprig(w: Workbench, x: float, y: float, z: float, tall: float, look: Look) -> None:
    """Adds a flat leafy twig."""
    w.box((x - 0.002, x + 0.002), (y - 0.006 * tall, y + 0.006 * tall), (z, z + tall), look, solid=False)
    for k in range(w.whole(3, 6)):
        side, level = (-1 if k % 2 else 1), z + tall * (0.3 + 0.12 * k)
        a = (x, y, level)
        b = (x, y + side * 0.22 * tall, level + 0.12 * tall)
        w.bar(a, b, 0.004, 0.09 * tall, look, solid=False)


def painting(w: Workbench, x: float, y: Range, z: Range) -> None:
    """Adds a painting to a sheet: bands, a twig, blocks or a skyline."""
    wide, tall, kind = y[1] - y[0], z[1] - z[0], w.whole(0, 3)
    if kind == 0:
        cuts = sorted(w.length(0.1, 0.9) for _ in range(w.whole(1, 3)))
        for low, high in zip([0.0, *cuts], [*cuts, 1.0], strict=True):
            if high - low > 0.01:
                w.box((x - 0.004, x), y, (z[0] + low * tall, z[0] + high * tall), w.new_look("paint"), solid=False)
    elif kind == 1:
        size = min(0.7 * tall, 1.2 * wide)
        _sprig(w, x, 0.5 * (y[0] + y[1]), z[0] + 0.5 * (tall - size), size, w.new_look("foliage"))
    elif kind == 2:
        ink = w.look("char")
        for i in range(w.whole(2, 3)):
            level = z[0] + tall * (0.8 - 0.22 * i)
            end = y[0] + wide * w.length(0.4, 0.92)
            w.box((x - 0.004, x), (y[0] + 0.08 * wide, end), (level - 0.07 * tall, level), ink, solid=False)
    else:
        w.box((x - 0.004, x - 0.001), y, z, w.new_look("paint"), solid=False)
        tower = w.new_look("paint")
        for low, high in _equal_ranges(y[0] + 0.05 * wide, y[1] - 0.05 * wide, 4, 0.03 * wide):
            w.box((x - 0.004, x), (low, high), (z[0], z[0] + tall * w.length(0.2, 0.8)), tower, solid=False)


def shower_fittings(w: Workbench, x: float, y: float, floor: float, metal: Look) -> None:
    """Adds shower fittings to a back wall at x: a rail with hand shower, an arm, an exposed pipe or a column."""
    kind, z = w.choice(("bar", "arm", "exposed", "column")), floor + w.length(0.95, 1.1)
    if kind == "column":
        w.box(
            (x - 0.005, x + 0.04),
            (y - 0.09, y + 0.09),
            (floor + 0.6, 1.95),
            w.look(w.choice(("dark", "steel", "glass"))),
            solid=False,
        )
        for i in range(3):
            w.rod(
                (x + 0.03, y, floor + 0.8 + 0.25 * i), (x + 0.055, y, floor + 0.8 + 0.25 * i), 0.03, metal, solid=False
            )
        w.box((x, x + 0.30), (y - 0.10, y + 0.10), (1.93, 1.96), metal, solid=False)
        return
    w.box((x - 0.005, x + 0.05), (y - 0.13, y + 0.13), (z, z + 0.05), metal, solid=False)
    if kind == "bar":
        w.rod((x + 0.04, y + 0.10, z + 0.04), (x + 0.04, y + 0.10, 1.90), 0.009, metal, solid=False)
        w.rod((x - 0.005, y + 0.10, 1.88), (x + 0.04, y + 0.10, 1.88), 0.012, metal, solid=False)
        w.rod((x + 0.04, y + 0.10, 1.75), (x + 0.13, y + 0.10, 1.83), 0.012, metal, solid=False, round_ends=True)
        w.rod((x + 0.12, y + 0.10, 1.845), (x + 0.145, y + 0.10, 1.82), 0.05, metal, solid=False)
        parts.arched_pipe(w, (x + 0.04, y, z), (x + 0.05, y + 0.10, 1.75), -0.25, 0.006, metal, 4)
    elif kind == "arm":
        w.rod((x - 0.005, y, 2.0), (x + 0.28, y, 2.0), 0.011, metal, solid=False)
        w.cylinder((x + 0.28, y), (1.96, 2.0), w.length(0.06, 0.15), metal, solid=False)
        w.rod((x - 0.005, y, z - 0.15), (x + 0.03, y, z - 0.15), 0.05, metal, solid=False)
    else:
        w.rod((x + 0.04, y, z + 0.04), (x + 0.04, y, 1.95), 0.011, metal, solid=False)
        parts.arched_pipe(w, (x + 0.04, y, 1.95), (x + 0.34, y, 1.97), 0.09, 0.011, metal, 3)
        w.rod((x + 0.34, y, 1.98), (x + 0.34, y, 1.93), 0.022, metal, solid=False)
        w.cylinder((x + 0.34, y), (1.915, 1.935), w.length(0.07, 0.13), metal, solid=False)


def weight_discs(w: Workbench, x: float, y: float, z: float, side: int, radius: float, count: int) -> float:
    """Adds weight discs on a bar along y, outwards from `y`, and returns the y where they end."""
    for i in range(count):
        thick, r = 0.035, radius * (1.0 - 0.18 * i)
        look = w.look("rubber") if i % 2 == 0 else w.look("paint")
        w.rod((x, y, z), (x, y + side * thick, z), r, look)
        y += side * (thick + 0.004)
    return y
