"""Potted plants.

Usual retail dimensions: floor plants 0.60-1.80 m high in pots 0.25-0.40 m across, table plants 0.15-0.40 m high.
The leaves of a plant are one mesh and do not collide; the pot and the stem do.
"""

from __future__ import annotations

import math
from dataclasses import replace

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.parts import around, polar
from sim.homes.housegen.furniture.parts.leaves import (
    SWORD,
    Body,
    arch,
    blade,
    blossom,
    bush,
    cut_leaf,
    frond,
    joined,
    tube,
)
from sim.homes.housegen.furniture.shapes import turned
from sim.homes.housegen.furniture.workbench import Point, Workbench

_ORIGIN = (0.0, 0.0, 0.0)
_TURN = 2.4
"""Angle between one leaf and the next of a rosette, radians: about the golden angle."""
_CUT = ((0.0, 0.0), (-0.1, -0.2), (0.03, -0.4), (0.22, -0.46), (0.3, -0.2), (0.45, -0.4), (0.52, -0.16), (0.68, -0.29))
"""Right half of the outline of a deeply cut leaf, from its stalk to near its tip."""


def _pot(w: Workbench, r: float, high: float) -> None:
    rings = [(0.0, 0.72), (0.85, 0.95), (0.86, 1.0), (0.98, 1.0), (1.0, 0.96)]
    shape = turned([(z * high, s * r) for z, s in rings], 14, hull=True)
    w.mesh(shape, _ORIGIN, w.look("pot"))
    w.cylinder((0.0, 0.0), around(high, 0.004), 0.9 * r, w.look("soil"), solid=False)


def _tuft(
    at: Point, radius: float, count: int, width: float, reach: tuple[float, float], *, turn: float = 0.0
) -> list[Body]:
    """Returns leaves that point outwards from a ball.

    Args:
        at: middle of the ball.
        radius: its radius.
        count: number of leaves.
        width: width of a leaf.
        reach: where a leaf begins and ends, as shares of the radius.
        turn: angle of the first leaf, radians.
    """
    leaves = []
    for i in range(count):
        a, up = _TURN * i + turn, math.sin(1.9 * i + turn)
        flat = math.sqrt(1.0 - 0.8 * up * up)
        out = (*polar(flat, a), 0.85 * up)
        near, far = ([c + d * share * radius for c, d in zip(at, out, strict=True)] for share in reach)
        middle = [0.6 * n + 0.4 * f for n, f in zip(near, far, strict=True)]
        path = [tuple(near), tuple(middle), (far[0], far[1], far[2] - 0.3 * width)]
        leaves.append(blade(path, width, (1.0,)))  # type: ignore[arg-type]
    return leaves


def broadleaf(w: Workbench) -> None:
    """Builds a plant with big arching leaves in a pot."""
    r, high, tall = w.length(0.14, 0.20), w.length(0.22, 0.32), w.length(0.50, 0.90)
    _pot(w, r, high)
    leaves = []
    for i in range(13):
        a, t = _TURN * i, i / 12
        base = (*polar(0.02, a), high - 0.01)
        path = arch(base, a, (0.16 + 0.38 * t) * tall, (1.0 - 0.5 * t) * tall, (0.04 + 0.22 * t) * tall)
        leaves.append(blade(path, 0.10 + 0.06 * tall, (0.8, 1.0)))
    green = w.look("foliage")
    w.mesh(joined("leaves", leaves), _ORIGIN, green, solid=False)
    w.cylinder((0.0, 0.0), (high, high + 0.4 * tall), 0.02, green)


def tree(w: Workbench) -> None:
    """Builds a small tree: a stem that forks into branches, and a crown of tufts with leaves around them."""
    r, high, tall = w.length(0.15, 0.20), w.length(0.26, 0.34), w.length(1.20, 1.65)
    _pot(w, r, high)
    crown, bark, green = w.length(0.24, 0.32), w.look("wood"), w.look("hedge")
    light = replace(green, texture=None)
    fork = max(tall - 2.9 * crown, high + 0.1)
    w.rod((0.0, 0.0, high - 0.01), (0.02, 0.0, fork + 0.03), 0.018, bark)
    leaves: list[Body] = []
    tufts = ((0.0, 0.0, 0.0, 0.7), (0.5, 0.3, -0.7, 0.6), (-0.5, 0.4, -0.9, 0.55), (0.05, -0.6, -1.4, 0.55))
    for x, y, z, s in tufts:
        at = (x * crown, y * crown, tall - 0.85 * crown + z * crown)
        w.rod((0.02, 0.0, fork), at, 0.010, bark, solid=False)
        w.ellipsoid(at, (0.6 * s * crown, 0.6 * s * crown, 0.5 * s * crown), green, solid=s > 0.6)
        leaves += _tuft(at, s * crown, 12, 0.15, (0.5, 1.4), turn=5 * s + x)
    w.mesh(joined("leaves", leaves), _ORIGIN, light, solid=False)


def snake_plant(w: Workbench) -> None:
    """Builds a plant with upright sword leaves in a cube pot."""
    half, high, tall = 0.5 * w.length(0.24, 0.34), w.length(0.22, 0.30), w.length(0.45, 0.80)
    w.box((-half, half), (-half, half), (0.0, high), w.look("pot"))
    inner = (-half + 0.015, half - 0.015)
    w.box(inner, inner, (high, high + 0.004), w.look("soil"), solid=False)
    leaves = []
    for i in range(13):
        a, reach, grown = _TURN * i, 0.55 * half * (0.3 + 0.06 * i), tall * (1.0 - 0.045 * i)
        path = [
            (*polar(share * reach, a + turn), high - 0.01 + z * grown)
            for share, z, turn in ((1.0, 0.0, 0.0), (1.25, 0.45, 0.15), (1.3, 0.8, -0.1), (1.7, 1.0, 0.1))
        ]
        leaves.append(blade(path, 0.07, SWORD))
    green = w.look("foliage")
    w.mesh(joined("leaves", leaves), _ORIGIN, green, solid=False)
    w.cylinder((0.0, 0.0), (high, high + 0.5 * tall), 0.03, green)


def palm(w: Workbench) -> None:
    """Builds a palm: three short stems, and feathered fronds that rise and hang over."""
    r, high, tall = w.length(0.14, 0.18), w.length(0.26, 0.34), w.length(1.20, 1.65)
    _pot(w, r, high)
    bark, fronds = w.look("wood"), []
    for k in range(3):
        a = math.tau * k / 3 + 0.3
        top = (*polar(0.05, a), high + 0.25 * (tall - high))
        w.rod((*polar(0.03, a), high - 0.01), top, 0.016, bark)
        for j in range(1 if k == 2 else 2):
            turn, free = a + (j - 0.5) * 1.15, tall - top[2]
            reach, rise = (0.24 + 0.08 * j) * tall, (1.0 - 0.28 * j) * free
            shares = ((0.0, 0.0), (0.1, 0.42), (0.24, 0.7), (0.4, 0.88), (0.58, 0.97), (0.78, 0.98), (1.0, 0.88))
            path = [(top[0] + s * reach * math.cos(turn), top[1] + s * reach * math.sin(turn), top[2] + z * rise)
                    for s, z in shares]  # fmt: skip
            fronds.append(frond(path, 0.19 * tall))
            fronds.append(tube([path[0], path[1], path[4]], (0.008, 0.006, 0.0), 3))
    w.mesh(joined("fronds", fronds), _ORIGIN, w.look("foliage"), solid=False)


def rubber_tree(w: Workbench) -> None:
    """Builds a plant with one stem and big oval leaves at all heights."""
    r, high, tall = w.length(0.14, 0.18), w.length(0.24, 0.32), w.length(0.90, 1.40)
    _pot(w, r, high)
    w.cylinder((0.0, 0.0), (high - 0.01, tall - 0.18), 0.014, w.look("wood"))
    leaves = []
    for i in range(15):
        t = i / 14
        base = (0.0, 0.0, high + 0.14 + (tall - high - 0.34) * t)
        path = arch(base, _TURN * i, 0.34 - 0.17 * t, 0.10 + 0.10 * t, 0.05 * (1.0 - t))
        leaves.append(blade(path, 0.17 - 0.05 * t, (0.85, 0.95)))
    w.mesh(joined("leaves", leaves), _ORIGIN, w.look("foliage"), solid=False)


def topiary(w: Workbench) -> None:
    """Builds a clipped shrub of two balls in a footed urn."""
    r, ball = w.length(0.15, 0.19), w.length(0.18, 0.24)
    rings = [(0.0, 0.8), (0.04, 0.8), (0.06, 0.5), (0.10, 0.35), (0.17, 0.8), (0.30, 1.0), (0.31, 1.1), (0.33, 1.1)]
    w.mesh(turned([(z, s * r) for z, s in rings], 10), _ORIGIN, w.look("pot"))
    green = w.look("hedge")
    w.cylinder((0.0, 0.0), (0.31, 0.34 + 2.6 * ball), 0.018, w.look("wood"))
    leaves: list[Body] = []
    for z, radius, count in ((0.31 + ball, ball, 29), (0.31 + 2.55 * ball, 0.72 * ball, 19)):
        w.ball((0.0, 0.0, z), 0.94 * radius, green)
        leaves += _tuft((0.0, 0.0, z), radius, count, 0.075, (0.8, 1.1))
    w.mesh(joined("leaves", leaves), _ORIGIN, replace(green, texture=None), solid=False)


def table_fern(w: Workbench) -> None:
    """Builds a small pot full of arching leaves."""
    r, high = w.length(0.06, 0.09), w.length(0.08, 0.12)
    _pot(w, r, high)
    leaves = []
    for i in range(17):
        a, t = _TURN * i, i / 16
        path = arch((0.0, 0.0, high - 0.01), a, 0.07 + 0.12 * t, 0.16 - 0.07 * t, 0.01 + 0.08 * t)
        leaves.append(blade(path, 0.038, (1.0, 0.8)))
    w.mesh(joined("leaves", leaves), _ORIGIN, w.look("foliage"), solid=False)


def flower_pot(w: Workbench) -> None:
    """Builds a small flowering plant."""
    r, high = w.length(0.06, 0.08), w.length(0.09, 0.12)
    _pot(w, r, high)
    green: list[Body] = [
        blade(arch((0.0, 0.0, high - 0.01), _TURN * i, 0.11, 0.07 - 0.03 * (i % 2), 0.02), 0.06) for i in range(8)
    ]
    flowers = []
    for i in range(6):
        a, far = math.tau * i / 5, 0.06 if i < 5 else 0.0
        tip = (*polar(far, a), high + 0.13 + 0.025 * (i % 2) + (0.02 if i == 5 else 0.0))
        green.append(tube([(0.0, 0.0, high), tip], (0.003, 0.002), 3))
        flowers.append(blossom(tip, (1.4 * tip[0], 1.4 * tip[1], 0.06), 0.04))
    w.mesh(joined("leaves", green), _ORIGIN, w.look("foliage"), solid=False)
    w.mesh(joined("flowers", flowers), _ORIGIN, w.look("flower"), solid=False)


def cactus(w: Workbench) -> None:
    """Builds a cactus: three ribbed columns of different heights in one pot, and a flower."""
    r, high, tall = w.length(0.13, 0.17), w.length(0.20, 0.28), w.length(0.60, 1.10)
    _pot(w, r, high)
    green, tall = w.look("foliage"), 0.72 * tall
    for share, thick, a in ((1.0, 0.072, 0.4), (0.68, 0.058, 2.6), (0.42, 0.05, 4.6)):
        x, y, out = math.cos(a), math.sin(a), 0.5 * r
        grown = share * tall
        column = [(out * x * (1 + 0.9 * t), out * y * (1 + 0.9 * t), high + t * grown) for t in (-0.02, 0.4, 0.88, 1.0)]
        column.append((column[-1][0], column[-1][1], column[-1][2] + 0.03))
        body = tube(column, (0.85 * thick, thick, 0.95 * thick, 0.62 * thick, 0.0), 12, groove=0.62)
        w.mesh(joined("cactus", [body]), _ORIGIN, green)
        if share == 1.0:
            flower = joined("flowers", [blossom(column[-1], (0.2, 0.1, 1.0), 0.06, 6)])
            w.mesh(flower, _ORIGIN, w.look("flower"), solid=False)


def monstera(w: Workbench) -> None:
    """Builds a plant with broad, deeply cut leaves on long stalks that spread from the pot."""
    r, high, tall = w.length(0.15, 0.20), w.length(0.22, 0.30), w.length(0.60, 0.95)
    _pot(w, r, high)
    bodies: list[Body] = []
    outline = [*_CUT, (1.0, 0.0), *((u, -v) for u, v in reversed(_CUT[1:]))]
    for i in range(6):
        a, t = _TURN * i, i / 5
        path = arch((0.0, 0.0, high - 0.01), a, (0.04 + 0.22 * t) * tall, (1.0 - 0.55 * t) * tall)
        bodies.append(tube([path[0], path[1], path[3]], (0.009, 0.007, 0.005), 3))
        along = (math.cos(a), math.sin(a), -0.75 - 0.45 * math.sin(2.0 * i))
        bodies.append(cut_leaf(path[3], along, outline, (0.42 - 0.1 * abs(t - 0.4)) * (0.6 + 0.5 * tall)))
    green = w.look("foliage")
    for half in (bodies[:6], bodies[6:]):
        w.mesh(joined("leaves", half), _ORIGIN, green, solid=False)
    w.cylinder((0.0, 0.0), (high, high + 0.3 * tall), 0.014, green)


def bonsai(w: Workbench) -> None:
    """Builds a small crooked tree in a flat tray."""
    w.box((-0.07, 0.07), (-0.11, 0.11), (0.0, 0.045), w.look("pot"))
    w.box((-0.06, 0.06), (-0.10, 0.10), (0.045, 0.049), w.look("soil"), solid=False)
    trunk = [(0.0, 0.03, 0.04), (0.005, 0.0, 0.085), (0.0, -0.035, 0.125), (-0.005, -0.005, 0.165), (0.0, 0.03, 0.21)]
    branches = [
        tube(trunk, (0.02, 0.015, 0.012, 0.010, 0.006)),
        tube([trunk[2], (0.01, -0.075, 0.155)], (0.008, 0.005), 4),
        tube([trunk[3], (-0.02, 0.08, 0.17)], (0.007, 0.005), 4),
    ]
    w.mesh(joined("trunk", branches), _ORIGIN, w.look("wood"))
    pads = (((0.0, 0.03, 0.225), 1.0), ((0.015, -0.08, 0.165), 0.8), ((-0.02, 0.09, 0.175), 0.65))
    crown = [bush(at, (0.062 * s, 0.078 * s, 0.038 * s), w.rng) for at, s in pads]
    w.mesh(joined("crown", crown), _ORIGIN, w.look("foliage"), solid=False)


STYLES = (
    Style("plant", "broadleaf", "train", broadleaf, ("floor",)),
    Style("plant", "tree", "heldout", tree, ("floor",)),
    Style("plant", "snake_plant", "train", snake_plant, ("floor",)),
    Style("plant", "palm", "train", palm, ("floor",)),
    Style("plant", "rubber_tree", "train", rubber_tree, ("floor",)),
    Style("plant", "topiary", "train", topiary, ("floor",)),
    Style("plant", "table_fern", "train", table_fern, ("top",), "top"),
    Style("plant", "flower_pot", "train", flower_pot, ("top",), "top"),
    Style("plant", "cactus", "heldout", cactus, ("floor",)),
    Style("plant", "monstera", "heldout", monstera, ("floor",)),
    Style("plant", "bonsai", "heldout", bonsai, ("top",), "top"),
)
