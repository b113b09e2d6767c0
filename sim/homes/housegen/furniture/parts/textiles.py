"""Pads, throw cushions, towels and crumpled cloth."""

from __future__ import annotations

import math
from collections.abc import Sequence

from sim.homes.housegen.furniture.item import Look, MeshShape
from sim.homes.housegen.furniture.shapes import chamfered_box, drape, named_mesh, strip
from sim.homes.housegen.furniture.workbench import Point, Workbench

_GRID = 7
"""Points along each side of a crumpled cloth."""
_CLOTH_M = 0.012
"""Thickness of a crumpled cloth."""


def pad(
    w: Workbench, size: Point, at: Point, look: Look, chamfer: float, *, tilt: float = 0.0, turn: float = 0.0
) -> None:
    """Adds a padded block with chamfered edges and its middle at `at`."""
    rounded = (round(size[0], 3), round(size[1], 3), round(size[2], 3))
    w.mesh(chamfered_box(rounded, chamfer), at, look, tilt=tilt, turn=turn)


def leather_pad(w: Workbench, size: Point, at: Point, *, tilt: float = 0.0) -> None:
    """Adds a leather pad with its middle at `at`, chamfered by a quarter of its smallest side."""
    pad(w, size, at, w.look("leather"), 0.25 * min(size), tilt=tilt)


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


def towel_over_bar(
    w: Workbench, x: float, y: float, z: float, width: float, front: float, back: float, cloth: Look
) -> None:
    """Adds a towel that hangs over a bar at (x, z), smooth or in folds, by `front` and `back` metres on its sides."""
    if w.chance(0.5):
        r = w.length(0.015, 0.025)
        path = [(r, -front), (1.15 * r, -0.5 * front), (r, 0.0), (0.7 * r, 0.7 * r), (0.0, r), (-0.7 * r, 0.7 * r)]
        w.mesh(strip([*path, (-r, 0.0), (-1.1 * r, -0.5 * back), (-r, -back)], 0.010, width), (x, y, z), cloth)
        return
    folds, fold_depth = w.whole(2, 6), w.length(0.02, 0.045)
    w.mesh(drape(width, front, fold_depth, folds, gather=w.length(0.85, 1.1)), (x + 0.004, y, z + 0.012 - front), cloth)
    w.mesh(drape(width, back, 0.02, folds), (x - 0.024, y, z + 0.012 - back), cloth)


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


def crumpled_cloth(w: Workbench, depth: float, width: float, rise: float) -> MeshShape:
    """Returns a sheet of cloth that was dropped: a bumpy grid with irregular edges, highest near its middle.

    Its lowest points are at z = 0.
    """
    n = _GRID
    bumps = w.rng.uniform(0.0, 1.0, (n, n))
    drift = w.rng.uniform(-0.22, 0.22, (2, n, n))
    points = []
    for i in range(n):
        for j in range(n):
            u, v = 2 * (i + drift[0, i, j]) / (n - 1) - 1, 2 * (j + drift[1, i, j]) / (n - 1) - 1
            fall = max(0.0, 1.0 - 0.9 * (u * u + v * v) / 1.2)
            points.append((0.5 * depth * u, 0.5 * width * v, _CLOTH_M + rise * (0.35 + 0.65 * bumps[i, j]) * fall))
    low = [(x, y, z - _CLOTH_M) for x, y, z in points]
    return named_mesh("crumpled", [*points, *low], _sheet_faces(n))


def _sheet_faces(n: int) -> list[tuple[int, int, int]]:
    """Returns the triangles of a closed sheet over an upper and a lower grid of n x n points each."""
    size = n * n
    faces: list[tuple[int, int, int]] = []
    for i in range(n - 1):
        for j in range(n - 1):
            a, b, c, d = i * n + j, (i + 1) * n + j, (i + 1) * n + j + 1, i * n + j + 1
            faces += [(a, b, c), (a, c, d), (size + c, size + b, size + a), (size + d, size + c, size + a)]
    edge = [*((i, 0) for i in range(n - 1)), *((n - 1, j) for j in range(n - 1))]
    edge += [*((i, n - 1) for i in range(n - 1, 0, -1)), *((0, j) for j in range(n - 1, 0, -1))]
    ids = [i * n + j for i, j in edge]
    for p, q in zip(ids, [*ids[1:], ids[0]], strict=True):
        faces += [(q, p, size + p), (q, size + p, size + q)]
    return faces
