"""Showers and bathtubs.

Ranges after Neufert, Architects' Data: showers 0.75-1.20 m square, 1.90-2.10 m high; bathtubs 1.50-1.80 m long,
0.70-0.85 m wide, 0.50-0.62 m high.
"""

from __future__ import annotations

import itertools
import math

from sim.houses.furniture import parts
from sim.houses.furniture.catalogue import Style
from sim.houses.furniture.item import Look
from sim.houses.furniture.shapes import (
    Ring,
    loft,
    named_mesh,
)
from sim.houses.furniture.workbench import Workbench

_BOTH = (-1, 1)


def _shower_set(w: Workbench, x: float, y: float, metal: Look, *, rain: bool) -> None:
    """Rail, head, hose and mixer on the back wall at x."""
    w.rod((x + 0.05, y, 1.0), (x + 0.05, y, 2.0), 0.010, metal, solid=False)
    for z in (1.0, 1.95):
        w.rod((x, y, z), (x + 0.05, y, z), 0.014, metal, solid=False)
    w.box((x, x + 0.06), (y - 0.13, y + 0.13), (1.02, 1.08), metal, solid=False)
    if rain:
        w.rod((x + 0.05, y, 2.0), (x + 0.32, y, 2.0), 0.010, metal, solid=False)
        w.cylinder((x + 0.32, y), (1.97, 2.0), 0.12, metal, solid=False)
    else:
        w.rod((x + 0.05, y, 1.80), (x + 0.13, y, 1.88), 0.012, metal, solid=False)
        w.rod((x + 0.12, y, 1.885), (x + 0.15, y, 1.865), 0.05, metal, solid=False)


def corner_cabin(w: Workbench) -> None:
    """Square tray with two glass sides; stands in a corner at smallest x and smallest y."""
    side = w.width(0.80, 1.00)
    half, high, metal, glass = 0.5 * side, w.length(1.90, 2.02), w.look("chrome"), w.look("glass")
    w.box((-half, half), (-half, half), (0.0, 0.07), w.look("ceramic"))
    w.cylinder((0.0, 0.0), (0.07, 0.074), 0.045, metal, solid=False)
    w.box((half - 0.010, half - 0.002), (-half, half), (0.09, high), glass)
    w.box((-half, half), (half - 0.010, half - 0.002), (0.09, high), glass)
    for x, y in ((half - 0.012, half - 0.012), (half - 0.012, -half + 0.012), (-half + 0.012, half - 0.012)):
        w.box((x - 0.012, x + 0.012), (y - 0.012, y + 0.012), (0.06, high + 0.015), metal)
    for z in (0.08, high):
        w.box((half - 0.024, half), (-half, half), (z - 0.012, z + 0.012), metal)
        w.box((-half, half), (half - 0.024, half), (z - 0.012, z + 0.012), metal)
    w.rod((half + 0.03, 0.10, 0.95), (half + 0.03, 0.10, 1.20), 0.010, metal, solid=False)
    for z in (0.96, 1.19):
        w.rod((half - 0.005, 0.10, z), (half + 0.03, 0.10, z), 0.006, metal, solid=False)
    _shower_set(w, -half, -0.05, metal, rain=False)


def curved_cabin(w: Workbench) -> None:
    """Quadrant tray with bent glass."""
    side = w.width(0.85, 1.00)
    half, high, metal, glass = 0.5 * side, w.length(1.90, 2.00), w.look("metal"), w.look("glass")
    points = [
        (half, -half),
        (half, -0.1 * half),
        (0.82 * half, 0.45 * half),
        (0.45 * half, 0.82 * half),
        (-0.1 * half, half),
        (-half, half),
    ]
    outline = [(-half, -half), *points]
    tray = [(x, y, z) for x, y in outline for z in (0.0, 0.12)]
    w.mesh(named_mesh("tray", tray), (0.0, 0.0, 0.0), w.look("ceramic"))
    for a, b in itertools.pairwise(points):
        for z in (0.13, high):
            w.bar((*a, z), (*b, z), 0.022, 0.022, metal)
        m = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
        long = ((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2) ** 0.5
        w.box(
            (m[0] - 0.5 * long, m[0] + 0.5 * long),
            (m[1] - 0.003, m[1] + 0.003),
            (0.13, high),
            glass,
            turn=math.atan2(b[1] - a[1], b[0] - a[0]),
        )
    for x, y in (points[0], points[2], points[3], points[-1]):
        w.box((x - 0.011, x + 0.011), (y - 0.011, y + 0.011), (0.12, high), metal)
    _shower_set(w, -half, -0.2 * half, metal, rain=True)


def built_in(w: Workbench) -> None:
    """Tub in a panelled surround against the wall, with a sloping end; long side along the wall."""
    width, depth, high = w.width(1.55, 1.80), w.depth(0.70, 0.80), w.length(0.52, 0.60)
    white, chrome = w.look("ceramic"), w.look("chrome")
    x, y = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)
    parts.basin(w, x, y, high, high, 0.05, white)
    w.box((x[0] + 0.05, x[1] - 0.05), (y[0] + 0.05, y[1] - 0.05), (0.05, 0.16), white)
    w.box((x[0] + 0.04, x[1] - 0.04), (y[0] + 0.02, y[0] + 0.30), (0.10, high - 0.10), white, roll=0.5, solid=False)
    parts.tap(w, (x[0] + 0.03, y[1] - 0.40, high), 0.16, 0.12, chrome)
    w.rod((0.0, y[1] - 0.052, high - 0.16), (0.0, y[1] - 0.062, high - 0.16), 0.03, chrome, solid=False)


def freestanding(w: Workbench) -> None:
    """Oval tub on the floor with a standing tap."""
    width, depth, high = w.width(1.60, 1.78), w.depth(0.72, 0.82), w.length(0.56, 0.62)
    white, metal = w.look("ceramic"), w.look("chrome")
    rx, ry = 0.5 * depth, 0.5 * width
    rings = [
        Ring(0.0, 0.78 * rx, 0.82 * ry, power=2.4),
        Ring(0.5 * high, 0.92 * rx, 0.93 * ry, power=2.4),
        Ring(high, rx, ry, power=2.4),
        Ring(high, rx - 0.04, ry - 0.04, power=2.4),
        Ring(0.4 * high, 0.76 * rx, 0.80 * ry, power=2.4),
        Ring(0.14, 0.6 * rx, 0.7 * ry, power=2.4),
    ]
    w.mesh(loft(rings, 16), (0.0, 0.0, 0.0), white)
    w.rod((-rx - 0.06, 0.3, 0.0), (-rx - 0.06, 0.3, 0.92), 0.018, metal)
    w.rod((-rx - 0.06, 0.3, 0.91), (-rx + 0.12, 0.3, 0.89), 0.014, metal, round_ends=True)
    w.cylinder((-rx - 0.06, 0.3), (0.0, 0.015), 0.05, metal)


STYLES = (
    Style("shower", "corner_cabin", "train", corner_cabin),
    Style("shower", "curved_cabin", "heldout", curved_cabin),
    Style("bathtub", "built_in", "train", built_in),
    Style("bathtub", "freestanding", "heldout", freestanding),
)
