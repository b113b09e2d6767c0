"""Plants of many growth forms, and pictures, for the pool `wide`.

Usual retail dimensions: floor plants 0.50-2.00 m high, plants on tops 0.10-0.60 m; pictures 0.30-1.50 m wide.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from sim.houses.furniture.catalogue import Style
from sim.houses.furniture.item import Look, MeshShape
from sim.houses.furniture.shapes import Leaf, Ring, foliage, frustum, loft, named_mesh
from sim.houses.furniture.workbench import Point, Range, Workbench

Blade = tuple[Sequence[Point], float]
_BOTH = (-1, 1)
_TAPER = (0.55, 0.95, 1.0, 0.7, 0.08)


def _polar(radius: float, angle: float, z: float) -> Point:
    return (radius * math.cos(angle), radius * math.sin(angle), z)


def _shifted(point: Point, by: Point) -> Point:
    return (point[0] + by[0], point[1] + by[1], point[2] + by[2])


def _curve(base: Point, angle: float, reach: float, up: float, end: float, steps: int = 5) -> list[Point]:
    """An arc from `base` that rises towards `up` and ends `reach` away at the height `end`, both above the base."""
    points = []
    for t in np.linspace(0.0, 1.0, steps):
        out = 2 * t * (1 - t) * 0.3 * reach + t * t * reach
        points.append(_shifted(base, _polar(float(out), angle, float(2 * t * (1 - t) * up + t * t * end))))
    return points


def _blade(path: Sequence[Point], width: float) -> tuple[np.ndarray, np.ndarray]:
    points = np.asarray(path, float)
    along = np.gradient(points, axis=0)
    level = np.array([points[-1][1] - points[0][1], points[0][0] - points[-1][0], 0.0])
    side = level / np.linalg.norm(level) if np.linalg.norm(level) > 1e-6 else np.array([0.0, 1.0, 0.0])
    half = 0.5 * width * np.array(_TAPER)[:, None]
    below = np.cross(along, side)
    below /= np.linalg.norm(below, axis=1, keepdims=True)
    deep = np.maximum(0.5 * half, 0.0012)
    vertices = np.stack([points - half * side, points + deep * below, points + half * side], axis=1).reshape(-1, 3)
    faces = [(0, 1, 2), (12, 14, 13)]
    for k in range(0, 12, 3):
        for i in range(3):
            a, b = k + i, k + (i + 1) % 3
            faces += [(a, a + 3, b + 3), (a, b + 3, b)]
    triangles = np.array(faces)
    a, b, c = (vertices[triangles[:, i]] - points[0] for i in range(3))
    if np.einsum("ij,ij->", a, np.cross(b, c)) < 0:
        triangles = triangles[:, ::-1]
    return vertices, triangles


def _blades(w: Workbench, blades: Sequence[Blade], look: Look) -> None:
    """Long bent leaves, five points each, six to a mesh."""
    for start in range(0, len(blades), 6):
        made = [_blade(path, width) for path, width in blades[start : start + 6]]
        vertices = np.vstack([v for v, _ in made])
        faces = np.vstack([f + 15 * i for i, (_, f) in enumerate(made)])
        w.mesh(named_mesh("blades", vertices, faces.tolist()), (0.0, 0.0, 0.0), look, solid=False)


def _leaves(w: Workbench, leaves: Sequence[Leaf], look: Look) -> None:
    """Short leaves, fourteen to a mesh."""
    for start in range(0, len(leaves), 14):
        w.mesh(foliage(leaves[start : start + 14]), (0.0, 0.0, 0.0), look, solid=False)


def _soil(w: Workbench, z: float, r: float) -> None:
    look = w.look(w.choice(("soil", "soil", "stone")))
    w.cylinder((0.0, 0.0), (z - 0.004, z + 0.004), r, look, solid=False)


def _round(w: Workbench, rings: Sequence[tuple[float, float]], look: Look, segments: int = 14) -> None:
    skin: MeshShape = loft([Ring(z, r, r) for z, r in rings], segments, hull=True)
    w.mesh(skin, (0.0, 0.0, 0.0), look)


def _planter(w: Workbench, r: float, high: float) -> float:
    """One of seven pots of about this radius and height; the height of its soil."""
    kind = w.whole(0, 6)
    look = w.look(w.choice(("pot", "pot", "ceramic", "masonry", "wicker" if kind == 3 else "paint")))
    z = 0.0
    if kind == 0:
        _round(w, [(0.0, 0.68 * r), (0.82 * high, 0.93 * r), (0.83 * high, r), (high, r)], look)
    elif kind == 1:
        w.cylinder((0.0, 0.0), (0.0, high), 0.92 * r, look)
        w.cylinder((0.0, 0.0), (0.0, 0.08 * high), 1.15 * r, w.look("dark"))
    elif kind == 2:
        low = w.length(1.1, 1.8)
        w.mesh(frustum((low * r, low * r), (1.8 * r, 1.8 * r), high), (0.0, 0.0, 0.0), look)
    elif kind == 3:
        basket = w.look("wicker")
        _round(w, [(0.0, 0.75 * r), (0.3 * high, 1.05 * r), (0.6 * high, 1.08 * r), (high, 0.85 * r)], basket)
        for side in _BOTH:
            y = side * 0.9 * r
            w.bar((0.0, y, 0.9 * high), (0.0, side * 1.0 * r, 1.12 * high), 0.012, 0.35 * r, basket, solid=False)
    elif kind == 4:
        lift = w.length(0.4, 1.1) * high
        wood = w.look(w.choice(("wood", "brass", "dark")))
        thick = 0.1 * r
        for i in range(4):
            angle = 0.25 * math.pi + 0.5 * math.pi * i
            w.rod(_polar(1.05 * r, angle, 0.0), _polar(1.0 * r, angle, lift + 0.5 * high), thick, wood)
            w.rod((0.0, 0.0, lift), _polar(1.0 * r, angle, lift), 0.7 * thick, wood, solid=False)
        w.cylinder((0.0, 0.0), (lift, lift + high), 0.92 * r, look)
        z = lift
    elif kind == 5:
        high *= 1.25
        _round(w, [(0.0, 0.6 * r), (high, r)], look, w.whole(5, 8))
    else:
        _round(
            w,
            [(0.0, 0.45 * r), (0.1 * high, 0.75 * r), (0.45 * high, 1.1 * r), (0.8 * high, r), (high, 0.85 * r)],
            look,
        )
    _soil(w, z + high, 0.72 * r)
    return z + high


def _frond(w: Workbench, base: Point, angle: float, reach: float, up: float, end: float, wide: float) -> Blade:
    """The leaflets, in pairs, of one feathery leaf; its rib."""
    path = _curve(base, angle, reach, up, end, 8)
    side = (-math.sin(angle), math.cos(angle))
    leaves = []
    for k in range(1, 8):
        size = wide * (1.0, 1.15, 1.1, 0.95, 0.75, 0.5, 0.3)[k - 1]
        ahead = tuple(0.6 * (b - a) for a, b in zip(path[k - 1], path[k], strict=True))
        for s in _BOTH:
            tip = _shifted(
                path[k], (ahead[0] + s * size * side[0], ahead[1] + s * size * side[1], ahead[2] - 0.2 * size)
            )
            leaves.append(Leaf(path[k], tip, 0.10 * wide + 0.28 * size))
    w.mesh(foliage(leaves), (0.0, 0.0, 0.0), w.look("foliage"), solid=False)
    return _curve(base, angle, reach, up, end), 0.018


def floor_fern(w: Workbench) -> None:
    """Fern whose feathery fronds arch over all sides of its pot."""
    z = _planter(w, w.length(0.13, 0.19), w.length(0.22, 0.38))
    reach, count, ribs = w.length(0.30, 0.50), w.whole(11, 20), []
    for i in range(count):
        t = (i + 0.5) / count
        out = reach * (0.35 + 0.65 * t) * w.length(0.85, 1.15)
        up = reach * (1.35 - 0.55 * t)
        end = min(0.9 * up, up * (0.75 - 0.85 * t))
        ribs.append(_frond(w, _polar(0.03, 2.4 * i, z - 0.005), 2.4 * i, out, up, max(end, 0.03 - z), 0.24 * reach))
    _blades(w, ribs, w.look("foliage"))


def bamboo(w: Workbench) -> None:
    """Jointed upright canes with tufts of narrow leaves at the joints."""
    r = w.length(0.14, 0.22)
    z = _planter(w, r, w.length(0.25, 0.40))
    tall, thick = w.length(0.8, 1.6), w.length(0.008, 0.016)
    cane = w.look(w.choice(("wood", "foliage", "wicker")))
    leaves = []
    for i in range(w.whole(4, 7)):
        foot = _polar(0.6 * r * math.sqrt((i + 0.3) / 7), 2.4 * i, z - 0.01)
        lean, top = w.length(0.0, 0.12), tall * w.length(0.7, 1.0)
        tip = _shifted(foot, _polar(lean, 2.4 * i, top))
        w.rod(foot, tip, thick, cane)
        joints = w.whole(3, 5)
        for k in range(1, joints + 1):
            t = k / joints
            at: Point = tuple(a + t * (b - a) for a, b in zip(foot, tip, strict=True))  # type: ignore[assignment]
            if k < joints and k < 4:
                w.cylinder((at[0], at[1]), (at[2] - 0.006, at[2] + 0.006), 1.35 * thick, cane, solid=False)
            for m in range(4 if t > 0.4 else 1):
                angle, long = 2.4 * i + 1.9 * m + k, w.length(0.14, 0.30)
                leaves.append(Leaf(at, _shifted(at, _polar(long, angle, long * w.length(-0.3, 0.6))), 0.035, 0.04))
    _leaves(w, leaves[:180], w.look("foliage"))


def dracaena(w: Workbench) -> None:
    """Bare stems of different heights, each with a tuft of sword leaves at its top."""
    r = w.length(0.13, 0.20)
    z = _planter(w, r, w.length(0.22, 0.36))
    tall, thick = w.length(0.35, 1.2), w.length(0.012, 0.032)
    reach, width = w.length(0.25, 0.42), w.length(0.025, 0.055)
    count, droop = w.whole(1, 4), w.length(1.3, 2.6)
    for i in range(count):
        start = w.length(0.0, 6.0)
        foot = _polar(0.4 * r if count > 1 else 0.0, 2.1 * i + start, z - 0.01)
        top = _shifted(foot, _polar(w.length(0.0, 0.12), 2.1 * i + start, tall * (1.0 - 0.24 * i) + 0.1))
        w.rod(foot, top, thick, w.look("wood"))
        blades = []
        for k in range(w.whole(14, 24)):
            t = (k % 12) / 12
            out, up = reach * (0.35 + 0.65 * t), reach * (1.2 - 0.8 * t)
            base = _shifted(top, (0.0, 0.0, -0.12 * t * reach - 0.005))
            blades.append((_curve(base, 2.4 * k + i, out, up, up * (1.0 - droop * t)), width))
        _blades(w, blades, w.look("foliage"))


def braided_ficus(w: Workbench) -> None:
    """Three stems plaited round each other under a round crown of small leaves."""
    z = _planter(w, w.length(0.14, 0.20), w.length(0.22, 0.36))
    tall, twist, out = w.length(0.45, 0.95), w.length(1.6, 3.0), w.length(0.020, 0.032)
    stems, steps = w.whole(2, 3), 7
    bark = w.look("wood")
    for i in range(stems):
        angles = [math.tau * i / stems + twist * math.pi * k / steps for k in range(steps + 1)]
        path = [_polar(out, a, z - 0.01 + tall * k / steps) for k, a in enumerate(angles)]
        for a, b in itertools.pairwise(path):
            w.rod(a, b, 0.7 * out, bark, round_ends=True)
    crown, squash = w.length(0.20, 0.36), w.length(0.8, 1.25)
    middle = (0.0, 0.0, z + tall + 0.75 * crown * squash)
    w.ellipsoid(middle, (0.72 * crown, 0.72 * crown, 0.78 * crown * squash), w.look("hedge"), solid=False)
    leaves, count = [], w.whole(100, 180)
    for k in range(count):
        height = 1.0 - 2.0 * (k + 0.5) / count
        ring = math.sqrt(1.0 - height * height)
        size = w.length(0.8, 1.15)
        base = _shifted(middle, _polar(0.65 * crown * ring, 2.4 * k, 0.65 * crown * squash * height))
        tip = _shifted(middle, _polar(size * crown * ring, 2.4 * k + 0.12, size * crown * squash * height - 0.03))
        leaves.append(Leaf(base, tip, 0.06, 0.02))
    _leaves(w, leaves, w.look("foliage"))


def climber_on_pole(w: Workbench) -> None:
    """Climbing plant: a mossy pole or a bamboo ladder hidden by heart-shaped leaves all the way up."""
    r = w.length(0.12, 0.18)
    z = _planter(w, r, w.length(0.20, 0.32))
    tall, thick = w.length(0.5, 1.3), w.length(0.020, 0.040)
    if w.chance(0.6):
        w.cylinder((0.0, 0.0), (z - 0.01, z + tall), thick, w.look(w.choice(("soil", "wicker", "wood"))))
    else:
        thick = 0.45 * r
        for side in _BOTH:
            w.rod((0.0, 0.6 * side * thick, z - 0.01), (0.0, side * thick, z + tall), 0.007, w.look("wood"))
        for k in range(1, 5):
            y = thick * (0.7 + 0.09 * k)
            w.rod((0.0, -y, z + 0.22 * k * tall), (0.0, y, z + 0.22 * k * tall), 0.006, w.look("wood"), solid=False)
    leaves, count, size = [], w.whole(24, 56), w.length(0.11, 0.20)
    for k in range(count):
        t = k / count
        base = _polar(0.9 * thick if thick < 0.045 else 0.0, 2.4 * k, z + 0.02 + tall * t)
        bend = _shifted(base, _polar(0.35 * size, 2.4 * k, 0.35 * size))
        drawn = size * w.length(0.7, 1.1)
        leaves += [
            Leaf(base, bend, 0.008),
            Leaf(bend, _shifted(bend, _polar(0.8 * drawn, 2.4 * k, -0.7 * drawn)), 0.85 * drawn, 0.1 * drawn),
        ]
    _leaves(w, leaves, w.look("foliage"))


def papyrus(w: Workbench) -> None:
    """Bare reeds, each with an umbrella of thread leaves; or bulrushes with brown heads."""
    r = w.length(0.12, 0.20)
    z = _planter(w, r, w.length(0.20, 0.42))
    tall, count, heads = w.length(0.55, 1.3), w.whole(6, 13), w.chance(0.5)
    green, blades = w.look("foliage"), []
    for i in range(count):
        foot = _polar(0.5 * r * math.sqrt(i / count), 2.4 * i, z - 0.01)
        top = _shifted(foot, _polar(w.length(0.02, 0.30), 2.4 * i, tall * w.length(0.55, 1.0)))
        w.rod(foot, top, 0.005, green)
        if heads:
            w.rod(_shifted(top, (0.0, 0.0, -0.06)), _shifted(top, (0.0, 0.0, 0.07)), 0.016, w.look("wood"), solid=False)
            blades += [(_curve(foot, 2.4 * i + k, 0.28, 0.7 * tall, 0.5 * tall), 0.022) for k in range(2)]
        else:
            size = w.length(0.12, 0.22)
            w.mesh(
                foliage(
                    [Leaf((0.0, 0.0, 0.0), _polar(size, math.tau * k / 13, -0.05), 0.018, 0.05) for k in range(13)]
                ),
                top,
                green,
                solid=False,
            )
    _blades(w, blades, green)


def paddle_leaves(w: Workbench) -> None:
    """Banana or strelitzia: long stalks from the pot, each ending in one big upright paddle."""
    z = _planter(w, w.length(0.15, 0.22), w.length(0.26, 0.42))
    tall, width = w.length(0.8, 1.6), w.length(0.14, 0.26)
    green, blades = w.look("foliage"), []
    for i in range(w.whole(5, 9)):
        angle = math.pi * i + w.length(-0.5, 0.5) if w.chance(0.5) else 2.4 * i
        out, rise = w.length(0.06, 0.28), tall * w.length(0.35, 0.6)
        foot = _polar(0.03, angle, z - 0.01)
        top = _polar(out, angle, z + rise)
        w.rod(foot, top, 0.009, green, round_ends=True)
        long = tall * w.length(0.35, 0.5)
        blades.append((_curve(top, angle, w.length(0.2, 0.6) * long, 0.75 * long, w.length(0.4, 1.0) * long), width))
    _blades(w, blades, green)


def planter_trough(w: Workbench) -> None:
    """Long low box, plain or on legs, with a row of upright grasses or bushy plants."""
    wide, deep, high = w.width(0.60, 1.20), w.length(0.22, 0.34), w.length(0.25, 0.50)
    box, x, y = w.look(w.choice(("lacquer", "wood", "masonry", "metal"))), 0.5 * deep, 0.5 * wide
    lift = w.length(0.10, 0.35) if w.chance(0.4) else 0.0
    w.box((-x, x), (-y, y), (lift, lift + high), box)
    if lift:
        w.legs((-x, x), (-y, y), (0.0, lift), 0.025, w.look("dark"))
    z = lift + high
    w.box((-x + 0.02, x - 0.02), (-y + 0.02, y - 0.02), (z, z + 0.004), w.look("soil"), solid=False)
    count, tall, grass = w.whole(4, 7), w.length(0.25, 0.70), w.chance(0.5)
    green = w.look("foliage")
    for i in range(count):
        c = (0.0, (2 * (i + 0.5) / count - 1.0) * (y - 0.04), z - 0.005)
        if grass:
            blades = []
            for k in range(18):
                up = tall * w.length(0.7, 1.1)
                blades.append((_curve(c, 2.4 * k, up * w.length(0.1, 0.5), up, up * w.length(0.5, 1.0)), 0.02))
            _blades(w, blades, green)
        else:
            leaves = []
            w.rod(c, _shifted(c, (0.0, 0.0, 0.8 * tall)), 0.008, w.look("wood"), solid=False)
            for k in range(42):
                at = _shifted(c, (0.0, 0.0, tall * (0.1 + 0.7 * k / 42)))
                leaves.append(Leaf(at, _shifted(at, _polar(w.length(0.08, 0.16), 2.4 * k, 0.10)), 0.06, 0.02))
            _leaves(w, leaves, green)


def agave(w: Workbench) -> None:
    """Stiff thick leaves in one big rosette straight out of the pot."""
    r = w.length(0.15, 0.24)
    z = _planter(w, r, w.length(0.22, 0.40))
    size, width, count = w.length(0.28, 0.50), w.length(0.06, 0.11), w.whole(16, 30)
    blades = []
    for k in range(count):
        t = k / count
        rise = size * (1.0 - 0.85 * t)
        blades.append(
            (_curve(_polar(0.02, 2.4 * k, z - 0.01), 2.4 * k, size * (0.15 + 0.8 * t), 0.4 * rise, rise), width)
        )
    _blades(w, blades, w.look("foliage"))


def dried_stalks(w: Workbench) -> None:
    """Tall floor vase with plumes or branches that fan out of its narrow mouth."""
    high, r = w.length(0.40, 0.75), w.length(0.11, 0.18)
    look = w.look(w.choice(("ceramic", "wicker", "glass", "pot")))
    shape = w.choice(((0.6, 1.0, 0.9, 0.45, 0.5), (0.9, 0.95, 0.9, 0.8, 0.85), (0.45, 0.6, 1.0, 0.5, 0.6)))
    levels = (0.0, 0.35, 0.6, 0.9, 1.0)
    skin = loft([Ring(high * t, r * s, r * s) for t, s in zip(levels, shape, strict=True)], 14)
    w.mesh(skin, (0.0, 0.0, 0.0), look)
    straw, tall, plumes = w.look(w.choice(("wicker", "linen", "wood"))), w.length(0.45, 0.9), w.chance(0.6)
    leaves = []
    for i in range(w.whole(6, 11)):
        foot = _polar(0.02, 2.4 * i, high - 0.05)
        out, up = w.length(0.08, 0.35), tall * w.length(0.7, 1.0)
        tip = _polar(out, 2.4 * i, high + up)
        w.rod(foot, tip, 0.004, straw, solid=False)
        back = 0.28
        low: Point = tuple(b - back * (b - a) for a, b in zip(foot, tip, strict=True))  # type: ignore[assignment]
        if plumes:
            w.rod(low, tip, w.length(0.018, 0.035), straw, solid=False, round_ends=True)
        else:
            for k in range(6):
                t = 0.35 + 0.13 * k
                at: Point = tuple(a + t * (b - a) for a, b in zip(foot, tip, strict=True))  # type: ignore[assignment]
                leaves.append(Leaf(at, _shifted(at, _polar(0.09, 2.4 * k + i, 0.05)), 0.045, 0.01))
    _leaves(w, leaves, w.look(w.choice(("foliage", "flower"))))


def trailing(w: Workbench) -> None:
    """Vines that spill over the edge of a raised or tall pot and hang down its sides."""
    r, high = w.length(0.06, 0.10), w.length(0.14, 0.26)
    look, kind = w.look(w.choice(("pot", "ceramic", "wicker"))), w.whole(0, 2)
    if kind == 0:
        _round(w, [(0.0, 0.7 * r), (high, r)], look)
    elif kind == 1:
        foot = w.look(w.choice(("wood", "brass", "dark")))
        w.cylinder((0.0, 0.0), (0.0, 0.012), 0.8 * r, foot)
        w.cylinder((0.0, 0.0), (0.012, 0.5 * high), 0.25 * r, foot)
        w.cylinder((0.0, 0.0), (0.5 * high, high), r, look)
    else:
        stand = w.look(w.choice(("dark", "wood", "brass")))
        for i in range(3):
            w.rod(_polar(1.1 * r, 2.1 * i, 0.0), _polar(0.7 * r, 2.1 * i, 0.5 * high), 0.006, stand)
        w.ellipsoid((0.0, 0.0, 0.7 * high), (r, r, 0.3 * high), look)
    _soil(w, high, 0.7 * r)
    leaf, leaves = w.length(0.03, 0.06), []
    for i in range(w.whole(5, 11)):
        angle, out = 2.4 * i, r + w.length(0.015, 0.05)
        drop = (high - 0.03) * w.length(0.4, 1.0)
        path = [_polar(0.4 * r, angle, high), _polar(0.8 * r, angle, high + 0.03), _polar(out, angle, high - 0.01)]
        steps = max(2, int(drop / (0.9 * leaf)))
        path += [
            _polar(out + 0.004 * (k % 2), angle + 0.1 * (k % 3), high - drop * k / steps) for k in range(1, steps + 1)
        ]
        for k, (a, b) in enumerate(itertools.pairwise(path)):
            leaves.append(Leaf(a, b, 0.010))
            tip = _shifted(b, _polar(leaf, angle + (0.9 if k % 2 else -0.9), -0.3 * leaf if b[2] > 0.02 else 0.0))
            leaves.append(Leaf(b, tip, 0.85 * leaf, 0.005))
    for k in range(14):
        leaves.append(
            Leaf((0.0, 0.0, high), _polar(w.length(0.3, 1.1) * r, 2.4 * k, high + w.length(0.02, 0.08)), leaf, 0.01)
        )
    _leaves(w, leaves, w.look("foliage"))


def succulents(w: Workbench) -> None:
    """Low bowl or tray with one to four fleshy rosettes."""
    count = w.whole(1, 4)
    r, high = w.length(0.05, 0.075) * (1.0 + 0.35 * (count > 1)), w.length(0.04, 0.09)
    look, long = w.look(w.choice(("pot", "ceramic", "masonry", "glass"))), 1.0
    if w.chance(0.5):
        _round(w, [(0.0, 0.6 * r), (0.4 * high, 0.95 * r), (high, r)], look)
        _soil(w, high, 0.9 * r)
    else:
        long = 1.0 if count == 1 else w.length(1.2, 2.0)
        w.box((-r, r), (-long * r, long * r), (0.0, high), look)
        w.box(
            (-0.9 * r, 0.9 * r), (-0.92 * long * r, 0.92 * long * r), (high, high + 0.004), w.look("soil"), solid=False
        )
    for i in range(count):
        off = (0.0, 0.0, 0.0) if count == 1 else _polar(0.52 * r, math.tau * i / count + math.pi / 2, 0.0)
        c = (off[0], long * off[1], high)
        size = (1.25 if count == 1 else 0.75) * r * w.length(0.8, 1.2)
        blades = []
        for k in range(w.whole(15, 24)):
            t = k / 20
            rise = size * (0.9 - 0.55 * t)
            out = size * (0.12 + 0.85 * t)
            blades.append((_curve(c, 2.4 * k, out, 0.3 * rise, rise), 0.34 * size + 0.004))
        _blades(w, blades, w.new_look("foliage"))


def orchid(w: Workbench) -> None:
    """Orchid: a few strap leaves at the pot and arching sprays of flat blooms on bare stems."""
    r, high = w.length(0.055, 0.075), w.length(0.09, 0.14)
    look = w.look(w.choice(("pot", "ceramic", "glass")))
    if w.chance(0.5):
        _round(w, [(0.0, 0.75 * r), (high, r)], look)
    else:
        w.box((-r, r), (-r, r), (0.0, high), look)
    _soil(w, high, 0.8 * r)
    green, bloom, heart = w.look("foliage"), w.look("flower"), w.new_look("flower")
    base = (0.0, 0.0, high - 0.004)
    _blades(w, [(_curve(base, 1.2 * i, w.length(0.12, 0.20), 0.10, 0.03), 0.05) for i in range(w.whole(4, 6))], green)
    for i in range(w.whole(1, 3)):
        angle, tall, out = 2.2 * i + w.length(0.0, 1.0), w.length(0.28, 0.48), w.length(0.14, 0.26)
        path = _curve(base, angle, out, 1.5 * tall, tall, 7)
        for a, b in itertools.pairwise(path):
            w.rod(a, b, 0.0028, green, solid=False, round_ends=True)
        size = w.length(0.032, 0.048)
        for at in path[3:]:
            petals = [
                Leaf(
                    at,
                    _shifted(
                        at, (0.5 * size * math.cos(angle), size * math.cos(m * 1.257), size * math.sin(m * 1.257))
                    ),
                    0.8 * size,
                )
                for m in range(5)
            ]
            w.mesh(foliage(petals), (0.0, 0.0, 0.0), bloom, solid=False)
            w.ball(at, 0.2 * size, heart, solid=False)


def herb_box(w: Workbench) -> None:
    """Wooden or tin box, or a tray of three pots, with different herbs side by side."""
    count, each = w.whole(2, 4), w.length(0.09, 0.13)
    high, x, y = w.length(0.08, 0.13), 0.5 * each, 0.5 * count * each
    case = w.look(w.choice(("wood", "metal", "ceramic", "dark")))
    pots = w.chance(0.4)
    if pots:
        w.box((-x, x), (-y, y), (0.0, 0.012), case)
    else:
        w.box((-x, x), (-y, y), (0.0, high), case)
        w.box((-x + 0.008, x - 0.008), (-y + 0.008, y - 0.008), (high, high + 0.004), w.look("soil"), solid=False)
    for i in range(count):
        c = (0.0, -y + (i + 0.5) * each, high)
        green = w.new_look("foliage")
        if pots:
            skin = loft([Ring(0.0, 0.65 * x, 0.65 * x), Ring(high - 0.012, 0.92 * x, 0.92 * x)], 12, hull=True)
            w.mesh(skin, (0.0, c[1], 0.012), w.look("pot"))
        kind, tall = w.whole(0, 2), w.length(0.08, 0.20)
        if kind == 0:
            blades = [
                (_curve(c, 2.4 * k, w.length(0.02, 0.07), tall, tall * w.length(0.6, 1.0)), 0.008) for k in range(24)
            ]
            _blades(w, blades, green)
            continue
        leaves, size = [], (0.05 if kind == 1 else 0.022)
        for k in range(42):
            stem = _polar(0.028 * (k % 3), 2.1 * (k % 5), 0.0)
            at = _shifted(c, (stem[0], stem[1], tall * (k // 6) / 7))
            leaves.append(Leaf(at, _shifted(at, _polar(0.045, 2.4 * k, 0.02)), size, 0.008))
            if k < 5:
                leaves.append(Leaf(c, _shifted(c, (0.5 * stem[0], 0.5 * stem[1], tall)), 0.006))
        _leaves(w, leaves, green)


def cut_flowers(w: Workbench) -> None:
    """Bunch of cut flowers in a vase or a jug."""
    high, r = w.length(0.14, 0.28), w.length(0.04, 0.075)
    shape = w.choice(((0.9, 0.9, 0.9, 0.95), (0.6, 1.1, 0.6, 0.8), (0.5, 0.7, 0.9, 1.1), (0.9, 1.1, 0.7, 0.45)))
    vase = w.look(w.choice(("glass", "glass", "ceramic", "pot", "metal")))
    levels = (0.0, 0.35, 0.75, 1.0)
    skin = loft([Ring(high * t, r * s, r * s) for t, s in zip(levels, shape, strict=True)], 16)
    w.mesh(skin, (0.0, 0.0, 0.0), vase)
    mouth = 0.5 * r * shape[3]
    green, kind, spread = w.look("foliage"), w.whole(0, 3), w.length(0.05, 0.14)
    colours = [w.new_look("flower") for _ in range(w.whole(1, 3))]
    leaves, count = [], w.whole(5, 10)
    for i in range(count):
        angle, ring = 2.4 * i, math.sqrt((i + 0.3) / count)
        foot = _polar(mouth * ring, angle, high - 0.03)
        top = _polar(mouth * ring + spread * ring, angle, high + w.length(0.10, 0.22) * (1.25 - 0.5 * ring))
        w.rod(foot, top, 0.0035, green, solid=False)
        at: Point = tuple(0.5 * (a + b) for a, b in zip(foot, top, strict=True))  # type: ignore[assignment]
        leaves += [Leaf(at, _shifted(at, _polar(0.08, angle + s, 0.03)), 0.03, 0.01) for s in (0.8, -0.8)]
        colour = colours[i % len(colours)]
        if kind == 0:
            w.ellipsoid(_shifted(top, (0.0, 0.0, 0.015)), (0.018, 0.018, 0.028), colour, solid=False)
        elif kind == 1:
            petals = [Leaf(top, _shifted(top, _polar(0.042, 0.628 * k, 0.012)), 0.024) for k in range(10)]
            w.mesh(foliage(petals), (0.0, 0.0, 0.0), colour, solid=False)
            w.ball(_shifted(top, (0.0, 0.0, 0.004)), 0.012, w.look("wicker"), solid=False)
        elif kind == 2:
            w.ball(top, w.length(0.024, 0.042), colour, solid=False)
        else:
            spike = []
            for k in range(14):
                at = _shifted(top, (0.0, 0.0, 0.009 * k - 0.03))
                spike.append(Leaf(at, _shifted(at, _polar(0.030 - 0.0015 * k, 2.4 * k, 0.012)), 0.020))
            w.mesh(foliage(spike), (0.0, 0.0, 0.0), colour, solid=False)
    _leaves(w, leaves, green)


def spider_plant(w: Workbench) -> None:
    """Dense fountain of narrow arching blades, sometimes with plantlets on runners."""
    z = _planter(w, w.length(0.06, 0.09), w.length(0.08, 0.14))
    reach, width, green = w.length(0.14, 0.26), w.length(0.010, 0.022), w.look("foliage")
    upright, blades = w.chance(0.25), []
    for k in range(w.whole(30, 60)):
        out = reach * (w.length(0.15, 0.5) if upright else w.length(0.4, 1.0))
        up = reach * w.length(0.7, 1.3)
        end = up * (w.length(0.6, 1.0) if upright else w.length(-0.1, 0.6))
        blades.append((_curve(_polar(0.015, 2.4 * k, z - 0.005), 2.4 * k, out, up, max(end, 0.01 - z)), width))
    for i in range(0 if upright else w.whole(0, 3)):
        path = _curve((0.0, 0.0, z), 2.0 * i, 1.2 * reach, 0.9 * reach, max(-0.3 * reach, 0.03 - z))
        blades.append((path, 0.006))
        blades += [(_curve(path[-1], 1.3 * k, 0.05, 0.03, -0.01), 0.010) for k in range(5)]
    _blades(w, blades, green)


def lucky_bamboo(w: Workbench) -> None:
    """Curled or straight green stalks bound in a glass of pebbles, leaf tufts at their tops."""
    r, high = w.length(0.04, 0.06), w.length(0.08, 0.16)
    w.cylinder((0.0, 0.0), (0.0, high), r, w.look(w.choice(("glass", "ceramic"))))
    _soil(w, high, 0.85 * r)
    green, curled, blades = w.look("foliage"), w.chance(0.5), []
    stalk = w.new_look("foliage")
    for i in range(w.whole(2, 5)):
        foot, tall = _polar(0.45 * r, 2.4 * i, high - 0.01), w.length(0.15, 0.38)
        path = [foot, _shifted(foot, (0.0, 0.0, 0.6 * tall))]
        if curled:
            for k in range(1, 5):
                path.append(
                    _shifted(foot, _shifted(_polar(0.025, 1.57 * k + i, 0.6 * tall + 0.1 * k * tall), (0.01, 0.0, 0.0)))
                )
        else:
            path.append(_shifted(foot, (0.0, 0.0, tall)))
        for a, b in itertools.pairwise(path):
            w.rod(a, b, 0.006, stalk, solid=False, round_ends=True)
        for k in range(6):
            long = w.length(0.08, 0.15)
            blades.append((_curve(path[-1], 2.4 * k + i, 0.7 * long, 0.8 * long, 0.4 * long), 0.018))
    _blades(w, blades, green)


def _split(low: float, high: float, count: int, gap: float) -> list[Range]:
    each = (high - low - (count - 1) * gap) / count
    return [(low + i * (each + gap), low + i * (each + gap) + each) for i in range(count)]


def _sprig(w: Workbench, x: float, y: float, z: float, tall: float, look: Look) -> None:
    """A flat drawing of a leafy twig."""
    w.box((x - 0.002, x + 0.002), (y - 0.006 * tall, y + 0.006 * tall), (z, z + tall), look, solid=False)
    for k in range(w.whole(3, 6)):
        side, level = (-1 if k % 2 else 1), z + tall * (0.3 + 0.12 * k)
        a = (x, y, level)
        b = (x, y + side * 0.22 * tall, level + 0.12 * tall)
        w.bar(a, b, 0.004, 0.09 * tall, look, solid=False)


def _scene(w: Workbench, x: float, y: Range, z: Range) -> None:
    """Something painted on a sheet: bands, a sprig, blocks, or a skyline."""
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
        for low, high in _split(y[0] + 0.05 * wide, y[1] - 0.05 * wide, 4, 0.03 * wide):
            w.box((x - 0.004, x), (low, high), (z[0], z[0] + tall * w.length(0.2, 0.8)), tower, solid=False)


def poster_on_clips(w: Workbench) -> None:
    """Unframed paper sheet held to the wall by binder clips, tape or pins."""
    wide = w.width(0.35, 0.90)
    high = w.height(0.45, 1.10)
    w.mount_height_m = 1.52 - 0.5 * high
    y, z = 0.5 * wide, high - 0.03
    w.box((0.0, 0.003), (-y, y), (0.0, z), w.look(w.choice(("paper", "linen", "paint"))), solid=False)
    margin = w.length(0.0, 0.08)
    low = w.length(0.05, 0.30)
    _scene(w, 0.006, (-y + margin, y - margin), (low * z, z - margin - 0.02))
    metal, kind = w.look(w.choice(("dark", "chrome", "brass"))), w.whole(0, 2)
    for side in _BOTH:
        c = side * (y - w.choice((0.05, 0.25)) * wide)
        if kind == 0:
            w.box((0.0, 0.014), (c - 0.026, c + 0.026), (z - 0.028, z + 0.004), metal, solid=False)
            w.box((0.0, 0.004), (c - 0.010, c + 0.010), (z, z + 0.03), metal, solid=False)
        elif kind == 1:
            w.box(
                (0.0, 0.005), (c - 0.03, c + 0.03), (z - 0.015, z + 0.02), w.look("linen"), solid=False, roll=0.4 * side
            )
        else:
            w.ball((0.008, c, z - 0.015), 0.008, metal, solid=False)


def panorama(w: Workbench) -> None:
    """Very wide, low picture deep inside a box frame."""
    wide = w.width(0.90, 1.60)
    high, deep, border = w.height(0.28, 0.48), w.length(0.035, 0.07), w.length(0.012, 0.035)
    w.mount_height_m = 1.52 - 0.5 * high
    y, look = 0.5 * wide, w.look(w.choice(("wood", "dark", "lacquer", "metal")))
    for z in ((0.0, border), (high - border, high)):
        w.box((0.0, deep), (-y, y), z, look)
    for c in ((-y, -y + border), (y - border, y)):
        w.box((0.0, deep), c, (border, high - border), look)
    mat = w.length(0.0, 0.06)
    inner, z = y - border, (border, high - border)
    w.box((0.0, 0.010), (-inner, inner), z, w.look("paper"), solid=False)
    inner, z = inner - mat, (border + mat, high - border - mat)
    tall = z[1] - z[0]
    w.box((0.0, 0.012), (-inner, inner), z, w.new_look("paint"), solid=False)
    w.box((0.0, 0.014), (-inner, inner), (z[0], z[0] + tall * w.length(0.2, 0.5)), w.new_look("paint"), solid=False)
    if w.chance(0.6):
        for low, top in _split(-0.9 * inner, 0.9 * inner, w.whole(5, 9), w.length(0.01, 0.08)):
            w.box((0.0, 0.016), (low, top), (z[0], z[0] + tall * w.length(0.25, 0.8)), w.look("dark"), solid=False)


def grid_of_frames(w: Workbench) -> None:
    """Six to nine equal small frames with wide mats in a strict grid or a single row."""
    columns, rows = w.choice(((3, 2), (2, 3), (4, 1), (3, 3), (1, 3), (5, 1)))
    wide = w.width(0.28 * columns, 0.36 * columns)
    high = w.height(0.28 * rows, 0.40 * rows)
    w.mount_height_m = 1.52 - 0.5 * high
    gap, border = w.length(0.03, 0.09), w.length(0.008, 0.02)
    look, thick = w.look(w.choice(("wood", "dark", "bright", "brass"))), w.length(0.015, 0.03)
    same, ink = w.chance(0.5), w.new_look("paint")
    for y in _split(-0.5 * wide, 0.5 * wide, columns, gap):
        for z in _split(0.0, high, rows, gap):
            w.box((0.0, thick), y, z, look)
            inner_y, inner_z = (y[0] + border, y[1] - border), (z[0] + border, z[1] - border)
            w.box((0.0, thick + 0.002), inner_y, inner_z, w.look("paper"), solid=False)
            pad_y, pad_z = 0.24 * (y[1] - y[0]), 0.24 * (z[1] - z[0])
            colour = ink if same else w.new_look("paint")
            picture = ((y[0] + pad_y, y[1] - pad_y), (z[0] + pad_z, z[1] - pad_z))
            w.box((0.0, thick + 0.004), *picture, colour, solid=False)


def picture_ledge(w: Workbench) -> None:
    """Narrow wall ledge with framed pictures of different sizes leaning on it side by side."""
    wide = w.width(0.80, 1.40)
    deep, top = w.length(0.08, 0.12), 0.04
    y, shelf = 0.5 * wide, w.look(w.choice(("wood", "lacquer", "dark")))
    w.box((0.0, deep), (-y, y), (0.0, 0.018), shelf)
    w.box((deep - 0.012, deep), (-y, y), (0.018, top), shelf)
    spans = _split(-y + 0.03, y - 0.03, w.whole(2, 4), w.length(0.01, 0.05))
    highest = 0.0
    for low, high in spans:
        tall = min(w.length(0.9, 1.6) * (high - low), 0.7)
        look, border = w.new_look(w.choice(("wood", "dark", "brass"))), w.length(0.012, 0.035)
        x = w.choice((0.024, 0.034))
        z = (0.018, 0.018 + tall)
        highest = max(highest, z[1])
        w.box((0.0, x), (low, high), z, look)
        inner = ((low + border, high - border), (z[0] + border, z[1] - border))
        w.box((0.0, x + 0.003), *inner, w.look("paper"), solid=False)
        pad = w.length(0.0, 0.05)
        _scene(w, x + 0.006, (inner[0][0] + pad, inner[0][1] - pad), (inner[1][0] + pad, inner[1][1] - pad))
    w.mount_height_m = 1.50 - 0.5 * highest


def glass_sandwich(w: Workbench) -> None:
    """Pressed sprig or print floating between panes in a thin metal rim, hung by a cord from a nail."""
    wide = w.width(0.30, 0.60)
    high, rim = w.height(0.40, 0.80), w.length(0.006, 0.014)
    w.mount_height_m = 1.52 - 0.5 * high
    cord = 0.22 * high
    y, z, metal = 0.5 * wide, high - cord, w.look(w.choice(("brass", "dark", "chrome")))
    w.box((0.0, 0.008), (-y, y), (0.0, z), w.look(w.choice(("bright", "paper", "linen"))), solid=False)
    for c in ((0.0, rim), (z - rim, z)):
        w.box((0.0, 0.018), (-y, y), c, metal)
    for side in _BOTH:
        c = side * (y - 0.5 * rim)
        w.box((0.0, 0.018), (c - 0.5 * rim, c + 0.5 * rim), (0.0, z), metal)
        w.rod((0.006, 0.8 * side * y, z - 0.005), (0.006, 0.0, high - 0.012), 0.0025, metal, solid=False)
    w.rod((0.0, 0.0, high - 0.012), (0.022, 0.0, high - 0.012), 0.008, w.look("metal"), solid=False)
    green, count = w.look(w.choice(("foliage", "char", "wood"))), w.whole(1, 3)
    for low, top in _split(-0.8 * y, 0.8 * y, count, 0.02):
        size = min(0.72 * z, 2.0 * (top - low)) * w.length(0.8, 1.0)
        _sprig(w, 0.010, 0.5 * (low + top), 0.5 * (z - size), size, green)


STYLES = (
    Style("plant", "floor_fern", "wide", floor_fern, ("floor",)),
    Style("plant", "bamboo", "wide", bamboo, ("floor",)),
    Style("plant", "dracaena", "wide", dracaena, ("floor",)),
    Style("plant", "braided_ficus", "wide", braided_ficus, ("floor",)),
    Style("plant", "climber_on_pole", "wide", climber_on_pole, ("floor",)),
    Style("plant", "papyrus", "wide", papyrus, ("floor",)),
    Style("plant", "paddle_leaves", "wide", paddle_leaves, ("floor",)),
    Style("plant", "planter_trough", "wide", planter_trough, ("floor",)),
    Style("plant", "agave", "wide", agave, ("floor",)),
    Style("plant", "dried_stalks", "wide", dried_stalks, ("floor",)),
    Style("plant", "trailing", "wide", trailing, ("top",), "top"),
    Style("plant", "succulents", "wide", succulents, ("top",), "top"),
    Style("plant", "orchid", "wide", orchid, ("top",), "top"),
    Style("plant", "herb_box", "wide", herb_box, ("top",), "top"),
    Style("plant", "cut_flowers", "wide", cut_flowers, ("top",), "top"),
    Style("plant", "spider_plant", "wide", spider_plant, ("top",), "top"),
    Style("plant", "lucky_bamboo", "wide", lucky_bamboo, ("top",), "top"),
    Style("picture", "poster_on_clips", "wide", poster_on_clips, (), "wall"),
    Style("picture", "panorama", "wide", panorama, (), "wall"),
    Style("picture", "grid_of_frames", "wide", grid_of_frames, (), "wall"),
    Style("picture", "picture_ledge", "wide", picture_ledge, (), "wall"),
    Style("picture", "glass_sandwich", "wide", glass_sandwich, (), "wall"),
)
