"""Throw cushions of sofas and duvets of beds."""

from __future__ import annotations

import math
from collections.abc import Sequence

from sim.homes.housegen.furniture.item import MeshShape
from sim.homes.housegen.furniture.shapes import named_mesh
from sim.homes.housegen.furniture.workbench import Workbench


def throw_cushions(
    w: Workbench, face: float, inner: float, seat: float, counts: Sequence[int], *, margin: float, middle: float
) -> None:
    """Adds up to three throw cushions to a sofa, the outer ones first; hint `cushions` sets their number.

    Args:
        w: the workbench.
        face: x of the back on which they lean.
        inner: width between the arms.
        seat: height of the seat.
        counts: numbers of cushions to draw one from without the hint.
        margin: distance of the outer cushions' middles from the arms.
        middle: y of the third cushion.
    """
    hinted = w.hints.get("cushions")
    count = int(hinted) if hinted is not None else w.choice(counts)
    places = (0.5 * inner - margin, -0.5 * inner + margin, middle)
    for y in places[: min(count, 3 if inner > 1.5 else 2)]:
        cushion = w.make("cushion", use="throw")
        w.put(cushion, (face + 0.5 * cushion.size_m[0] - 0.02, y, seat - 0.015), w.length(-0.15, 0.15))


def duvet(w: Workbench, length: float, width: float, thick: float) -> MeshShape:
    """Returns a soft cover that lies on z = 0 with its middle at the origin: thick, with shallow folds and round edges.

    Its sides hang straight down; the shape of its folds is drawn.
    """
    xs, ys = (-1.0, -0.55, -0.1, 0.4, 0.85, 1.0), (-1.0, -0.9, -0.62, -0.3, 0.0, 0.32, 0.6, 0.9, 1.0)
    phase, slant, bumps = w.rng.uniform(0.0, 6.28), w.rng.uniform(-2.5, 2.5), w.rng.uniform(-1.0, 1.0, (6, 9))
    rows, columns = len(xs), len(ys)
    points = []
    for i, u in enumerate(xs):
        for j, v in enumerate(ys):
            edge = 0.35 * thick * (abs(v) == 1.0) + 0.3 * thick * (u == 1.0)
            fold = 0.0 if edge else 0.011 * math.sin(7.0 * v + slant * u + phase) + 0.009 * bumps[i, j]
            points.append((0.5 * length * u, 0.5 * width * v, thick - edge + fold))
    rim = [*((0, j) for j in range(columns)), *((i, columns - 1) for i in range(1, rows))]
    rim += [*((rows - 1, j) for j in range(columns - 2, -1, -1)), *((i, 0) for i in range(rows - 2, 0, -1))]
    ids, start = [i * columns + j for i, j in rim], len(points)
    points += [(points[k][0], points[k][1], 0.0) for k in ids]
    points.append((0.0, 0.0, 0.0))
    faces = []
    for i in range(rows - 1):
        for j in range(columns - 1):
            a, b, c, d = i * columns + j, (i + 1) * columns + j, (i + 1) * columns + j + 1, i * columns + j + 1
            faces += [(a, b, c), (a, c, d)]
    for k, upper in enumerate(ids):
        after = (k + 1) % len(ids)
        faces += [(upper, ids[after], start + after), (upper, start + after, start + k)]
        faces.append((start + k, start + after, len(points) - 1))
    return named_mesh("duvet", points, faces)
