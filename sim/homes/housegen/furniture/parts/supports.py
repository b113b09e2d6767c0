"""Feet of cases and star bases of chairs."""

from __future__ import annotations

import itertools
import math
from typing import Literal

from sim.homes.housegen.furniture.item import Look, MeshShape
from sim.homes.housegen.furniture.parts.spans import BOTH_SIDES
from sim.homes.housegen.furniture.shapes import Ring, frustum, loft
from sim.homes.housegen.furniture.workbench import Range, Workbench

FeetKind = Literal["taper", "splay", "bun", "block", "cabriole", "sled", "castor", "plinth"]


def feet(w: Workbench, x: Range, y: Range, height: float, kind: FeetKind, look: Look, thick: float = 0.05) -> None:
    """Adds the support of a case with the footprint x, y, from the floor up to `height`."""
    inset = thick + 0.01
    xs, ys = (x[0] + inset, x[1] - inset), (y[0] + inset, y[1] - inset)
    if kind == "plinth":
        w.box((x[0] + 0.02, x[1] - 0.05), (y[0] + 0.02, y[1] - 0.02), (0.0, height), look)
    elif kind == "sled":
        _sled(w, x, xs, ys, height, look)
    else:
        for (px, sx), (py, sy) in itertools.product(zip(xs, BOTH_SIDES, strict=True), zip(ys, BOTH_SIDES, strict=True)):
            _foot(w, (px, py), (sx, sy), height, kind, look, thick)


def _sled(
    w: Workbench, x: Range, posts: tuple[float, float], runners: tuple[float, float], height: float, look: Look
) -> None:
    """Adds two runners along x, each with two posts."""
    for edge in runners:
        w.box((x[0] + 0.03, x[1] - 0.03), (edge - 0.014, edge + 0.014), (0.0, 0.02), look)
        for post in posts:
            w.box((post - 0.012, post + 0.012), (edge - 0.014, edge + 0.014), (0.02, height), look)


def _foot(
    w: Workbench,
    at: tuple[float, float],
    outwards: tuple[int, int],
    height: float,
    kind: FeetKind,
    look: Look,
    thick: float,
) -> None:
    """Adds one foot at a corner; `outwards` has the signs of the directions out of the case."""
    (px, py), (sx, sy) = at, outwards
    if kind == "bun":
        w.ellipsoid((px, py, 0.5 * height), (0.8 * thick, 0.8 * thick, 0.5 * height), look)
    elif kind == "block":
        w.box((px - 0.6 * thick, px + 0.6 * thick), (py - 0.6 * thick, py + 0.6 * thick), (0.0, height), look)
    elif kind == "cabriole":
        w.mesh(_cabriole_leg(height, thick, sx, sy), (px, py, 0.0), look)
    elif kind == "castor":
        w.rod((px, py - 0.012, 0.5 * height), (px, py + 0.012, 0.5 * height), 0.5 * height, w.look("rubber"))
        w.box((px - 0.01, px + 0.01), (py - 0.02, py + 0.02), (0.6 * height, height), look)
    else:
        lean = 0.3 * height if kind == "splay" else 0.0
        leg = frustum((0.45 * thick, 0.45 * thick), (thick, thick), height, (-sx * lean * 0.5, -sy * lean * 0.5))
        w.mesh(leg, (px + sx * 0.5 * lean * 0.5, py + sy * 0.5 * lean * 0.5, 0.0), look)


def _cabriole_leg(height: float, thick: float, x: int, y: int) -> MeshShape:
    """Returns a leg that bends outwards at its knee and ends in a pad; x and y are the outward signs."""
    out = 0.6 * thick
    rings = [
        Ring(0.0, 0.5 * thick, 0.5 * thick, x * out, y * out),
        Ring(0.12 * height, 0.42 * thick, 0.42 * thick, x * 0.8 * out, y * 0.8 * out),
        Ring(0.3 * height, 0.28 * thick, 0.28 * thick, 0.0, 0.0),
        Ring(0.75 * height, 0.6 * thick, 0.6 * thick, x * 0.7 * out, y * 0.7 * out),
        Ring(height, 0.62 * thick, 0.62 * thick, 0.0, 0.0),
    ]
    return loft(rings, 8)


def star_base(w: Workbench, radius: float, count: int, look: Look, top: float, *, castors: bool = True) -> None:
    """Adds a column with `count` feet in a star, on castors or on glides."""
    dark = w.look("rubber")
    low = 0.06 if castors else 0.02
    for i in range(count):
        angle = math.tau * i / count + 0.3
        x, y = radius * math.cos(angle), radius * math.sin(angle)
        w.bar((0.0, 0.0, low + 0.03), (x, y, low), 0.04, 0.025, look)
        if castors:
            w.ball((x, y, 0.028), 0.028, dark)
        else:
            w.cylinder((x, y), (0.0, low), 0.014, dark)
    w.cylinder((0.0, 0.0), (low, top), 0.026, w.look("chrome") if w.chance(0.5) else look)
