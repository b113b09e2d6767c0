"""Free-form plants of the pool `wide`: a pot of any profile, stems that branch at random, leaves of any kind."""

from __future__ import annotations

import math

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.free import greenery
from sim.homes.housegen.furniture.free.bases import add_base, frame_look
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.shapes import Leaf, Ring, loft
from sim.homes.housegen.furniture.workbench import Point, Workbench


def _pot(w: Workbench, r: float, high: float) -> float:
    """Adds a pot of random profile, sometimes on a stand, with soil, and returns the height of the soil."""
    if w.chance(0.25):
        return greenery.planter(w, r, high)
    z, power = 0.0, w.choice((2.0, 2.0, 2.0, 3.0, 12.0))
    if w.chance(0.25):
        z = w.length(0.3, 1.2) * high
        add_base(w, (-r, r), (-r, r), z, ("square", "round", "taper", "splay", "hairpin", "frame"), frame_look(w))
    shares = (w.length(0.5, 0.95), w.length(0.7, 1.15), w.length(0.8, 1.1), 1.0)
    heights = (0.0, w.length(0.2, 0.45), w.length(0.55, 0.9), 1.0)
    rings = [Ring(z + s * high, g * r, g * r, power=power) for s, g in zip(heights, shares, strict=True)]
    look = w.look(w.choice(("pot", "pot", "ceramic", "masonry", "wicker", "metal", "paint", "wood")))
    w.mesh(loft(rings, 14), (0.0, 0.0, 0.0), look)
    greenery.soil(w, z + high, 0.75 * r)
    return z + high


def _grow(w: Workbench, z: float, tall: float, pot: float) -> None:
    """Adds a plant of random habit with its top about `tall` above the soil at z."""
    green, habit = w.look("foliage"), w.choice(("rosette", "rosette", "stems", "stems", "trunk", "trunk", "fan"))
    if habit in ("rosette", "fan"):
        _rosette(w, (0.0, 0.0, z - 0.005), tall, w.length(0.35, 0.9) * tall, w.whole(9, 30), green, fan=habit == "fan")
        return
    bark = w.look("wood") if habit == "trunk" or w.chance(0.4) else green
    count = w.whole(1, 3) if habit == "trunk" else w.whole(3, 7)
    thick = w.length(0.008, 0.022) if habit == "trunk" else w.length(0.003, 0.008)
    thick = min(thick, 0.03 * tall)
    tufts: list[Point] = []
    for i in range(count):
        angle, lean = 2.4 * i + w.length(0.0, 1.0), w.length(0.02, 0.25) * tall
        foot = greenery.polar(0.4 * pot if count > 1 else 0.0, angle, z - 0.01)
        tip = greenery.shifted(foot, greenery.polar(lean, angle, tall * w.length(0.45, 0.8)))
        middle = tuple(0.5 * (a + b) + w.length(-0.03, 0.03) for a, b in zip(foot, tip, strict=True))
        knee: Point = (middle[0], middle[1], middle[2])
        w.rod(foot, knee, thick, bark, round_ends=True)
        w.rod(knee, tip, 0.8 * thick, bark, round_ends=True)
        tufts += [tip] if habit == "trunk" else [knee, tip]
    size = w.length(0.16, 0.34) * tall
    leafy = w.choice(("tuft", "cloud", "cloud", "along"))
    if leafy == "tuft":
        for tip in tufts[:4]:
            _rosette(w, tip, 0.7 * size, 1.1 * size, w.whole(9, 18), green, fan=False)
    else:
        _cloud(w, tufts, size, green, dense=leafy == "cloud" and w.chance(0.5))


def _rosette(w: Workbench, base: Point, tall: float, reach: float, count: int, look: Look, *, fan: bool) -> None:
    """Adds long leaves from one point, all round or in a fan."""
    droop, width = w.length(0.2, 1.6), w.length(0.05, 0.22) * reach
    blades = []
    for k in range(count):
        t = (k + 0.5) / count
        angle = 2.4 * k if not fan else (0.0 if k % 2 else math.pi) + w.length(-0.4, 0.4)
        out, up = reach * (0.3 + 0.7 * t) * w.length(0.85, 1.15), tall * (1.35 - 0.6 * t)
        low = 0.02 - base[2]
        blades.append(
            (greenery.curve(base, angle, out, up, max(up * (0.95 - droop * t), low)), width * w.length(0.8, 1.2))
        )
    greenery.add_blades(w, blades, look)


def _cloud(w: Workbench, around: list[Point], size: float, look: Look, *, dense: bool) -> None:
    """Adds short leaves on all sides of some points; `dense` fills the crown with a body."""
    leaves, count = [], min(112, 28 * len(around))
    long, wide = size * w.length(0.35, 0.8), w.length(0.25, 0.75)
    for i in range(count):
        at = around[i % len(around)]
        angle, rise = 2.4 * i, w.length(-0.8, 1.0)
        base = greenery.shifted(at, greenery.polar(w.length(0.15, 0.8) * size, angle, 0.6 * size * rise))
        tip = greenery.shifted(base, greenery.polar(long, angle + w.length(-0.5, 0.5), long * w.length(-0.5, 0.6)))
        leaves.append(Leaf(base, tip, wide * long, 0.1 * long))
    greenery.add_leaves(w, leaves, look)
    if dense:
        for at in around[:4]:
            w.ellipsoid(at, (0.72 * size, 0.72 * size, w.length(0.5, 0.8) * size), w.look("hedge"), solid=False)


def free_floor_plant(w: Workbench) -> None:
    """Builds a plant on the floor of any pot, habit and leaf."""
    r = w.length(0.11, 0.21)
    z = _pot(w, r, w.length(0.18, 0.42))
    _grow(w, z, w.length(0.45, 1.25), r)


def free_table_plant(w: Workbench) -> None:
    """Builds a small plant or flowers of any pot, habit and leaf."""
    r = w.length(0.045, 0.085)
    z = _pot(w, r, w.length(0.06, 0.18))
    tall = w.length(0.12, 0.36)
    if w.chance(0.3):
        _flowers(w, z, tall)
    else:
        _grow(w, z, tall, r)


def _flowers(w: Workbench, z: float, tall: float) -> None:
    """Adds stalks with round or flat flowers and some leaves."""
    green, bloom, size = w.look("foliage"), w.look("flower"), w.length(0.015, 0.04)
    flat = w.chance(0.5)
    for i in range(w.whole(3, 9)):
        foot = (0.0, 0.0, z - 0.01)
        tip = greenery.shifted(foot, greenery.polar(w.length(0.05, 0.45) * tall, 2.4 * i, tall * w.length(0.7, 1.1)))
        w.rod(foot, tip, 0.0028, green, solid=False)
        half = (size, size, (0.35 if flat else 1.0) * size)
        w.ellipsoid(tip, half, bloom if i % 3 else w.new_look("flower"), solid=False, tilt=0.3 if flat else 0.0)
    _rosette(w, (0.0, 0.0, z - 0.005), 0.5 * tall, 0.5 * tall, w.whole(5, 10), green, fan=False)


STYLES: tuple[Style, ...] = (
    Style("plant", "free_floor", "wide", free_floor_plant, ("floor",)),
    Style("plant", "free_top", "wide", free_table_plant, ("top",), "top"),
)
