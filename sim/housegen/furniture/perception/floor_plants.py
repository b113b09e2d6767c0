"""Plants that stand on the floor, of the pool `wide`."""

from __future__ import annotations

import itertools
import math

from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.perception import greenery
from sim.housegen.furniture.shapes import Leaf, Ring, foliage, loft
from sim.housegen.furniture.workbench import Point, Workbench


def _frond(w: Workbench, base: Point, angle: float, reach: float, up: float, end: float, wide: float) -> greenery.Blade:
    """Adds the leaflets of one feathery leaf, and returns its rib."""
    path = greenery.curve(base, angle, reach, up, end, 8)
    side = (-math.sin(angle), math.cos(angle))
    leaves = []
    for k in range(1, 8):
        size = wide * (1.0, 1.15, 1.1, 0.95, 0.75, 0.5, 0.3)[k - 1]
        ahead = tuple(0.6 * (b - a) for a, b in zip(path[k - 1], path[k], strict=True))
        for s in BOTH_SIDES:
            tip = greenery.shifted(
                path[k], (ahead[0] + s * size * side[0], ahead[1] + s * size * side[1], ahead[2] - 0.2 * size)
            )
            leaves.append(Leaf(path[k], tip, 0.10 * wide + 0.28 * size))
    w.mesh(foliage(leaves), (0.0, 0.0, 0.0), w.look("foliage"), solid=False)
    return greenery.curve(base, angle, reach, up, end), 0.018


def floor_fern(w: Workbench) -> None:
    """Builds a fern with feathery fronds that arch over all sides of its pot."""
    z = greenery.planter(w, w.length(0.13, 0.19), w.length(0.22, 0.38))
    reach, count, ribs = w.length(0.30, 0.50), w.whole(11, 20), []
    for i in range(count):
        t = (i + 0.5) / count
        out = reach * (0.35 + 0.65 * t) * w.length(0.85, 1.15)
        up = reach * (1.35 - 0.55 * t)
        end = min(0.9 * up, up * (0.75 - 0.85 * t))
        ribs.append(
            _frond(w, greenery.polar(0.03, 2.4 * i, z - 0.005), 2.4 * i, out, up, max(end, 0.03 - z), 0.24 * reach)
        )
    greenery.add_blades(w, ribs, w.look("foliage"))


def bamboo(w: Workbench) -> None:
    """Builds upright jointed canes with tufts of narrow leaves."""
    r = w.length(0.14, 0.22)
    z = greenery.planter(w, r, w.length(0.25, 0.40))
    tall, thick = w.length(0.8, 1.6), w.length(0.008, 0.016)
    cane = w.look(w.choice(("wood", "foliage", "wicker")))
    leaves = []
    for i in range(w.whole(4, 7)):
        foot = greenery.polar(0.6 * r * math.sqrt((i + 0.3) / 7), 2.4 * i, z - 0.01)
        lean, top = w.length(0.0, 0.12), tall * w.length(0.7, 1.0)
        tip = greenery.shifted(foot, greenery.polar(lean, 2.4 * i, top))
        w.rod(foot, tip, thick, cane)
        joints = w.whole(3, 5)
        for k in range(1, joints + 1):
            t = k / joints
            at: Point = tuple(a + t * (b - a) for a, b in zip(foot, tip, strict=True))  # type: ignore[assignment]
            if k < joints and k < 4:
                w.cylinder((at[0], at[1]), (at[2] - 0.006, at[2] + 0.006), 1.35 * thick, cane, solid=False)
            for m in range(4 if t > 0.4 else 1):
                angle, long = 2.4 * i + 1.9 * m + k, w.length(0.14, 0.30)
                leaves.append(
                    Leaf(at, greenery.shifted(at, greenery.polar(long, angle, long * w.length(-0.3, 0.6))), 0.035, 0.04)
                )
    greenery.add_leaves(w, leaves[:180], w.look("foliage"))


def dracaena(w: Workbench) -> None:
    """Builds bare stems of different heights with a tuft of sword-shaped leaves on each."""
    r = w.length(0.13, 0.20)
    z = greenery.planter(w, r, w.length(0.22, 0.36))
    tall, thick = w.length(0.35, 1.2), w.length(0.012, 0.032)
    reach, width = w.length(0.25, 0.42), w.length(0.025, 0.055)
    count, droop = w.whole(1, 4), w.length(1.3, 2.6)
    for i in range(count):
        start = w.length(0.0, 6.0)
        foot = greenery.polar(0.4 * r if count > 1 else 0.0, 2.1 * i + start, z - 0.01)
        top = greenery.shifted(
            foot, greenery.polar(w.length(0.0, 0.12), 2.1 * i + start, tall * (1.0 - 0.24 * i) + 0.1)
        )
        w.rod(foot, top, thick, w.look("wood"))
        blades = []
        for k in range(w.whole(14, 24)):
            t = (k % 12) / 12
            out, up = reach * (0.35 + 0.65 * t), reach * (1.2 - 0.8 * t)
            base = greenery.shifted(top, (0.0, 0.0, -0.12 * t * reach - 0.005))
            blades.append((greenery.curve(base, 2.4 * k + i, out, up, up * (1.0 - droop * t)), width))
        greenery.add_blades(w, blades, w.look("foliage"))


def braided_ficus(w: Workbench) -> None:
    """Builds two or three braided stems under a round crown of small leaves."""
    z = greenery.planter(w, w.length(0.14, 0.20), w.length(0.22, 0.36))
    tall, twist, out = w.length(0.45, 0.95), w.length(1.6, 3.0), w.length(0.020, 0.032)
    stems, steps = w.whole(2, 3), 7
    bark = w.look("wood")
    for i in range(stems):
        angles = [math.tau * i / stems + twist * math.pi * k / steps for k in range(steps + 1)]
        path = [greenery.polar(out, a, z - 0.01 + tall * k / steps) for k, a in enumerate(angles)]
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
        base = greenery.shifted(middle, greenery.polar(0.65 * crown * ring, 2.4 * k, 0.65 * crown * squash * height))
        tip = greenery.shifted(
            middle, greenery.polar(size * crown * ring, 2.4 * k + 0.12, size * crown * squash * height - 0.03)
        )
        leaves.append(Leaf(base, tip, 0.06, 0.02))
    greenery.add_leaves(w, leaves, w.look("foliage"))


def climber_on_pole(w: Workbench) -> None:
    """Builds a climbing plant with heart-shaped leaves on a pole or a bamboo ladder."""
    r = w.length(0.12, 0.18)
    z = greenery.planter(w, r, w.length(0.20, 0.32))
    tall, thick = w.length(0.5, 1.3), w.length(0.020, 0.040)
    if w.chance(0.6):
        w.cylinder((0.0, 0.0), (z - 0.01, z + tall), thick, w.look(w.choice(("soil", "wicker", "wood"))))
    else:
        thick = 0.45 * r
        for side in BOTH_SIDES:
            w.rod((0.0, 0.6 * side * thick, z - 0.01), (0.0, side * thick, z + tall), 0.007, w.look("wood"))
        for k in range(1, 5):
            y = thick * (0.7 + 0.09 * k)
            w.rod((0.0, -y, z + 0.22 * k * tall), (0.0, y, z + 0.22 * k * tall), 0.006, w.look("wood"), solid=False)
    leaves, count, size = [], w.whole(24, 56), w.length(0.11, 0.20)
    for k in range(count):
        t = k / count
        base = greenery.polar(0.9 * thick if thick < 0.045 else 0.0, 2.4 * k, z + 0.02 + tall * t)
        bend = greenery.shifted(base, greenery.polar(0.35 * size, 2.4 * k, 0.35 * size))
        length = size * w.length(0.7, 1.1)
        leaves += [
            Leaf(base, bend, 0.008),
            Leaf(
                bend,
                greenery.shifted(bend, greenery.polar(0.8 * length, 2.4 * k, -0.7 * length)),
                0.85 * length,
                0.1 * length,
            ),
        ]
    greenery.add_leaves(w, leaves, w.look("foliage"))


def papyrus(w: Workbench) -> None:
    """Builds bare reeds with umbrellas of thin leaves, or bulrushes with brown heads."""
    r = w.length(0.12, 0.20)
    z = greenery.planter(w, r, w.length(0.20, 0.42))
    tall, count, heads = w.length(0.55, 1.3), w.whole(6, 13), w.chance(0.5)
    green, blades = w.look("foliage"), []
    for i in range(count):
        foot = greenery.polar(0.5 * r * math.sqrt(i / count), 2.4 * i, z - 0.01)
        top = greenery.shifted(foot, greenery.polar(w.length(0.02, 0.30), 2.4 * i, tall * w.length(0.55, 1.0)))
        w.rod(foot, top, 0.005, green)
        if heads:
            w.rod(
                greenery.shifted(top, (0.0, 0.0, -0.06)),
                greenery.shifted(top, (0.0, 0.0, 0.07)),
                0.016,
                w.look("wood"),
                solid=False,
            )
            blades += [(greenery.curve(foot, 2.4 * i + k, 0.28, 0.7 * tall, 0.5 * tall), 0.022) for k in range(2)]
        else:
            size = w.length(0.12, 0.22)
            w.mesh(
                foliage(
                    [
                        Leaf((0.0, 0.0, 0.0), greenery.polar(size, math.tau * k / 13, -0.05), 0.018, 0.05)
                        for k in range(13)
                    ]
                ),
                top,
                green,
                solid=False,
            )
    greenery.add_blades(w, blades, green)


def paddle_leaves(w: Workbench) -> None:
    """Builds a banana plant or strelitzia: long stalks with one large upright leaf each."""
    z = greenery.planter(w, w.length(0.15, 0.22), w.length(0.26, 0.42))
    tall, width = w.length(0.8, 1.6), w.length(0.14, 0.26)
    green, blades = w.look("foliage"), []
    for i in range(w.whole(5, 9)):
        angle = math.pi * i + w.length(-0.5, 0.5) if w.chance(0.5) else 2.4 * i
        out, rise = w.length(0.06, 0.28), tall * w.length(0.35, 0.6)
        foot = greenery.polar(0.03, angle, z - 0.01)
        top = greenery.polar(out, angle, z + rise)
        w.rod(foot, top, 0.009, green, round_ends=True)
        long = tall * w.length(0.35, 0.5)
        blades.append(
            (greenery.curve(top, angle, w.length(0.2, 0.6) * long, 0.75 * long, w.length(0.4, 1.0) * long), width)
        )
    greenery.add_blades(w, blades, green)


def planter_trough(w: Workbench) -> None:
    """Builds a long low planter with a row of grasses or bushy plants."""
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
                blades.append((greenery.curve(c, 2.4 * k, up * w.length(0.1, 0.5), up, up * w.length(0.5, 1.0)), 0.02))
            greenery.add_blades(w, blades, green)
        else:
            leaves = []
            w.rod(c, greenery.shifted(c, (0.0, 0.0, 0.8 * tall)), 0.008, w.look("wood"), solid=False)
            for k in range(42):
                at = greenery.shifted(c, (0.0, 0.0, tall * (0.1 + 0.7 * k / 42)))
                leaves.append(
                    Leaf(at, greenery.shifted(at, greenery.polar(w.length(0.08, 0.16), 2.4 * k, 0.10)), 0.06, 0.02)
                )
            greenery.add_leaves(w, leaves, green)


def agave(w: Workbench) -> None:
    """Builds one large rosette of stiff thick leaves."""
    r = w.length(0.15, 0.24)
    z = greenery.planter(w, r, w.length(0.22, 0.40))
    size, width, count = w.length(0.28, 0.50), w.length(0.06, 0.11), w.whole(16, 30)
    blades = []
    for k in range(count):
        t = k / count
        rise = size * (1.0 - 0.85 * t)
        blades.append(
            (
                greenery.curve(
                    greenery.polar(0.02, 2.4 * k, z - 0.01), 2.4 * k, size * (0.15 + 0.8 * t), 0.4 * rise, rise
                ),
                width,
            )
        )
    greenery.add_blades(w, blades, w.look("foliage"))


def dried_stalks(w: Workbench) -> None:
    """Builds a tall floor vase with plumes or branches."""
    high, r = w.length(0.40, 0.75), w.length(0.11, 0.18)
    look = w.look(w.choice(("ceramic", "wicker", "glass", "pot")))
    shape = w.choice(((0.6, 1.0, 0.9, 0.45, 0.5), (0.9, 0.95, 0.9, 0.8, 0.85), (0.45, 0.6, 1.0, 0.5, 0.6)))
    levels = (0.0, 0.35, 0.6, 0.9, 1.0)
    skin = loft([Ring(high * t, r * s, r * s) for t, s in zip(levels, shape, strict=True)], 14)
    w.mesh(skin, (0.0, 0.0, 0.0), look)
    straw, tall, plumes = w.look(w.choice(("wicker", "linen", "wood"))), w.length(0.45, 0.9), w.chance(0.6)
    leaves = []
    for i in range(w.whole(6, 11)):
        foot = greenery.polar(0.02, 2.4 * i, high - 0.05)
        out, up = w.length(0.08, 0.35), tall * w.length(0.7, 1.0)
        tip = greenery.polar(out, 2.4 * i, high + up)
        w.rod(foot, tip, 0.004, straw, solid=False)
        back = 0.28
        low: Point = tuple(b - back * (b - a) for a, b in zip(foot, tip, strict=True))  # type: ignore[assignment]
        if plumes:
            w.rod(low, tip, w.length(0.018, 0.035), straw, solid=False, round_ends=True)
        else:
            for k in range(6):
                t = 0.35 + 0.13 * k
                at: Point = tuple(a + t * (b - a) for a, b in zip(foot, tip, strict=True))  # type: ignore[assignment]
                leaves.append(Leaf(at, greenery.shifted(at, greenery.polar(0.09, 2.4 * k + i, 0.05)), 0.045, 0.01))
    greenery.add_leaves(w, leaves, w.look(w.choice(("foliage", "flower"))))


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
)
