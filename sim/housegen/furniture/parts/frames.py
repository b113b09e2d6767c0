"""Frames of tubes and pipes, and boards bent around a back."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

from sim.housegen.furniture.item import Look
from sim.housegen.furniture.parts.looks import tube_look, upholstery_look
from sim.housegen.furniture.parts.spans import BOTH_SIDES, centred
from sim.housegen.furniture.parts.textiles import pad
from sim.housegen.furniture.shapes import arc_wall
from sim.housegen.furniture.workbench import Point, Range, Workbench


def tube_along(w: Workbench, points: Sequence[Point], radius: float, look: Look) -> None:
    """Adds a tube through these points."""
    for a, b in itertools.pairwise(points):
        w.rod(a, b, radius, look, round_ends=True)


def arched_pipe(w: Workbench, a: Point, b: Point, rise: float, radius: float, look: Look, pieces: int = 4) -> None:
    """Adds a pipe from a to b, only visual, that is bent upwards by `rise` in its middle."""
    points = []
    for i in range(pieces + 1):
        t = i / pieces
        x, y, z = (p + t * (q - p) for p, q in zip(a, b, strict=True))
        points.append((x, y, z + rise * math.sin(math.pi * t)))
    for p, q in itertools.pairwise(points):
        w.rod(p, q, radius, look, solid=False, round_ends=True)


def tube_frame(w: Workbench, x: Range, y: float, z: Range, thick: float, look: Look) -> None:
    """Adds a rectangular frame of square tube that fills x and z around the plane y."""
    for edge in (x[0] + 0.5 * thick, x[1] - 0.5 * thick):
        w.box(centred(edge, thick), centred(y, thick), z, look)
    for edge in (z[0] + 0.5 * thick, z[1] - 0.5 * thick):
        w.box((x[0] + thick, x[1] - thick), centred(y, thick), centred(edge, thick), look)


def curved_board(w: Workbench, x: float, half: float, z: Range, look: Look, thick: float, bow: float) -> None:
    """Adds a backrest of half width `half` whose rearmost point, its middle, is at x, `bow` behind its ends."""
    radius = (half * half + bow * bow) / (2 * bow)
    angle = math.asin(min(1.0, half / radius))
    angles = [math.pi + angle * (i / 4 - 1.0) for i in range(9)]
    w.mesh(arc_wall(radius, thick, 0.0, angles, [z[1] - z[0]] * 9), (x + radius, 0.0, z[0]), look)


def cage_seat(w: Workbench, width: float, depth: float, seat: float, seats: int) -> float:
    """Adds seat, back and arm cushions inside a cage of bent tubes.

    Returns:
        The x of the face of the back cushions.
    """
    tube, cover, r = tube_look(w), upholstery_look(w, 0.75), w.choice((0.012, 0.017))
    arm, rail = w.length(0.12, 0.16), w.length(0.54, 0.64)
    _cage_with_arms(w, (width, depth, rail), arm, r, tube, cover)
    x0, x1 = -0.5 * depth, 0.5 * depth
    inner = width - 2 * arm - 4 * r
    each = inner / seats
    back, high = arm + 0.02, w.length(0.03, 0.16)
    for i in range(seats):
        y = (i + 0.5) * each - 0.5 * inner
        lower = 0.5 * (seat - 0.14)
        pad(w, (depth - 5 * r, each - 0.006, lower), (0.0, y, 0.13 + 0.5 * lower), cover, 0.025)
        pad(w, (depth - back - 4 * r, each - 0.006, lower + 0.02), (0.5 * back, y, seat - 0.5 * lower), cover, 0.035)
        tall = rail + high - seat + 0.03
        pad(w, (back, each - 0.006, tall), (x0 + 2 * r + 0.5 * back, y, rail + high - 0.5 * tall), cover, 0.035)
    w.top((x0 + back + 2 * r, x1 - 0.03), (-0.5 * inner, 0.5 * inner), seat, "seat")
    return x0 + back + 2 * r


def _cage_with_arms(w: Workbench, size: Point, arm: float, r: float, tube: Look, cover: Look) -> None:
    """Adds the tubes, of radius r, of a cage with this width, depth and height, and its two arm cushions."""
    width, depth, rail = size
    x0, x1, half = -0.5 * depth, 0.5 * depth, 0.5 * width
    for side in BOTH_SIDES:
        y = side * (half - r)
        tube_along(w, [(x1 - r, y, r), (x1 - r, y, rail), (x0 + r, y, rail), (x0 + r, y, r)], r, tube)
        w.rod((x1 - r, y, 0.14), (x0 + r, y, 0.14), r, tube)
        at = (0.0, side * (half - 2 * r - 0.5 * arm), 0.5 * rail + 0.09)
        pad(w, (depth - 4 * r, arm, rail - 0.14), at, cover, 0.03)
    for x, z in ((x1 - r, 0.14), (x0 + r, 0.14), (x0 + r, rail)):
        w.rod((x, -half + r, z), (x, half - r, z), r, tube)
