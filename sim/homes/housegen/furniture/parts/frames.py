"""Frames of tubes and pipes, and boards bent around a back."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts.spans import centred
from sim.homes.housegen.furniture.shapes import arc_wall
from sim.homes.housegen.furniture.workbench import Point, Range, Workbench


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
    """Adds a backrest of half width `half`; its rearmost point is its middle, at x, `bow` behind its ends."""
    radius = (half * half + bow * bow) / (2 * bow)
    angle = math.asin(min(1.0, half / radius))
    angles = [math.pi + angle * (i / 4 - 1.0) for i in range(9)]
    w.mesh(arc_wall(radius, thick, 0.0, angles, [z[1] - z[0]] * 9), (x + radius, 0.0, z[0]), look)
