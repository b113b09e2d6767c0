"""Divides polygons with axis-parallel sides into rectangles, so that the sides' openings stay whole where possible."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.grid import runs_of
from sim.homes.housegen.floor_plan.rectangles import SIDES, Interval, Rect

Point = tuple[float, float]
TOLERANCE_M = 0.02
"""Coordinates nearer to each other than this become equal."""
MAX_TRIANGLES, MAX_LINES = 20_000, 200
"""Limits of a floor: further triangles are not read; with more coordinates along an axis it gets no rectangles."""


@dataclass(frozen=True)
class Stretch:
    """A part of a wall line: from `span[0]` to `span[1]` along `axis`, at `line_m` of the other axis."""

    axis: Literal["x", "y"]
    line_m: float
    span: Interval


def snapped(values: Iterable[float]) -> dict[float, float]:
    """Returns for each value the one that replaces it: values that are nearly equal become equal."""
    replaced: dict[float, float] = {}
    first = -np.inf
    for value in sorted(set(values)):
        if value - first > TOLERANCE_M:
            first = value
        replaced[value] = first
    return replaced


def slanted_edge(polygon: Sequence[Point]) -> tuple[Point, Point] | None:
    """Returns the first edge of a closed polygon that is parallel to neither axis, or None."""
    for a, b in itertools.pairwise([*polygon, *polygon[:1]]):
        if a[0] != b[0] and a[1] != b[1]:
            return a, b
    return None


def rectangles(polygon: Sequence[Point], keep: Sequence[Stretch] = ()) -> list[Rect]:
    """Returns rectangles without overlap that cover a polygon, the largest first; none for a polygon without area.

    The polygon is cut along one of the axes: along the one that cuts through fewer of the stretches `keep`, which are
    the openings in its sides, then along the one that gives fewer rectangles.

    Args:
        polygon: corners in sequence, every edge parallel to an axis.
        keep: stretches of sides that should belong to one rectangle.
    """
    xs, ys = (sorted({point[axis] for point in polygon}) for axis in (0, 1))
    inside = _cells_inside(polygon, xs, ys)
    upright = [Rect(x0, y0, x1, y1) for x0, x1, y0, y1 in _slabs(inside, xs, ys)]
    level = [Rect(x0, y0, x1, y1) for y0, y1, x0, x1 in _slabs(inside.T, ys, xs)]
    best = min((upright, level), key=lambda rects: (sum(not _is_kept(rects, place) for place in keep), len(rects)))
    return sorted(best, key=lambda rect: -rect.area_m2)


def on_side(rect: Rect, stretch: Stretch) -> Literal["east", "north", "west", "south"] | None:
    """Returns the side of a rectangle that is on one line with a stretch, or None."""
    for side in SIDES:
        if (side in ("north", "south")) == (stretch.axis == "x") and rect.line(side) == stretch.line_m:
            return side
    return None


def _is_kept(rects: Sequence[Rect], stretch: Stretch) -> bool:
    """Returns whether a stretch lies in a side of one of the rectangles, or outside of all of them."""
    touched = False
    for rect in rects:
        side = on_side(rect, stretch)
        if side is None:
            continue
        lo, hi = rect.span(side)
        if lo <= stretch.span[0] and stretch.span[1] <= hi:
            return True
        touched = touched or (lo < stretch.span[1] and stretch.span[0] < hi)
    return not touched


def _cells_inside(polygon: Sequence[Point], xs: Sequence[float], ys: Sequence[float]) -> NDArray[np.bool_]:
    """Returns (len(xs) - 1, len(ys) - 1), whether the middle of each cell lies in the polygon (even-odd rule)."""
    x, y = (0.5 * (np.array(values[:-1]) + np.array(values[1:])) for values in (xs, ys))
    inside = np.zeros((len(x), len(y)), dtype=np.bool_)
    for (ax, ay), (bx, by) in itertools.pairwise([*polygon, *polygon[:1]]):
        if ax == bx:  # an upright edge changes the side of all cells to its left at its height
            inside ^= np.outer(x < ax, (y > min(ay, by)) & (y < max(ay, by)))
    return inside


def _slabs(inside: NDArray[np.bool_], us: Sequence[float], vs: Sequence[float]) -> list[tuple[float, ...]]:
    """Returns (u0, u1, v0, v1) of rectangles, each as long as possible along v, then as wide as possible along u."""
    done: list[tuple[float, ...]] = []
    growing: dict[tuple[float, float], float] = {}  # interval along v: where it began along u
    for i in range(len(inside) + 1):
        runs = [(vs[first], vs[end]) for first, end in runs_of(inside[i])] if i < len(inside) else []
        for run in [run for run in growing if run not in runs]:
            done.append((growing.pop(run), us[i], *run))
        for run in runs:
            growing.setdefault(run, us[i])
    return done


def rectangles_of_triangles(triangles_m: NDArray[np.float64]) -> list[Rect]:
    """Returns rectangles that cover a floor of triangles (n, 3, 2), the largest first.

    The floor is divided at the coordinates of its corners; cells with their middle in a triangle belong to it.
    """
    triangles_m = triangles_m[:MAX_TRIANGLES]
    xs, ys = (sorted(set(snapped(triangles_m[..., axis].ravel().tolist()).values())) for axis in (0, 1))
    if len(xs) < 2 or len(ys) < 2 or max(len(xs), len(ys)) > MAX_LINES:
        return []
    x, y = (0.5 * (np.array(values[:-1]) + np.array(values[1:])) for values in (xs, ys))
    inside = np.zeros((len(x), len(y)), dtype=np.bool_)
    for a, b, c in triangles_m:
        signs = [
            (q[0] - p[0]) * (y[None, :] - p[1]) - (q[1] - p[1]) * (x[:, None] - p[0])
            for p, q in ((a, b), (b, c), (c, a))
        ]
        least, most = np.minimum.reduce(signs), np.maximum.reduce(signs)
        inside |= (least >= -1e-9) | (most <= 1e-9)
    cells = [Rect(x0, y0, x1, y1) for x0, x1, y0, y1 in _slabs(inside, xs, ys)]
    return sorted(cells, key=lambda rect: -rect.area_m2)
