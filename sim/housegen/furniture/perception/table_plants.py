"""Plants for tops, of the pool `wide`."""

from __future__ import annotations

import itertools
import math

from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.perception import greenery
from sim.housegen.furniture.shapes import Leaf, Ring, foliage, loft
from sim.housegen.furniture.workbench import Point, Workbench


def trailing(w: Workbench) -> None:
    """Builds vines that hang down from a raised or tall pot."""
    r, high = w.length(0.06, 0.10), w.length(0.14, 0.26)
    look, kind = w.look(w.choice(("pot", "ceramic", "wicker"))), w.whole(0, 2)
    if kind == 0:
        greenery.round_pot(w, [(0.0, 0.7 * r), (high, r)], look)
    elif kind == 1:
        foot = w.look(w.choice(("wood", "brass", "dark")))
        w.cylinder((0.0, 0.0), (0.0, 0.012), 0.8 * r, foot)
        w.cylinder((0.0, 0.0), (0.012, 0.5 * high), 0.25 * r, foot)
        w.cylinder((0.0, 0.0), (0.5 * high, high), r, look)
    else:
        stand = w.look(w.choice(("dark", "wood", "brass")))
        for i in range(3):
            w.rod(greenery.polar(1.1 * r, 2.1 * i, 0.0), greenery.polar(0.7 * r, 2.1 * i, 0.5 * high), 0.006, stand)
        w.ellipsoid((0.0, 0.0, 0.7 * high), (r, r, 0.3 * high), look)
    greenery.soil(w, high, 0.7 * r)
    leaf, leaves = w.length(0.03, 0.06), []
    for i in range(w.whole(5, 11)):
        angle, out = 2.4 * i, r + w.length(0.015, 0.05)
        drop = (high - 0.03) * w.length(0.4, 1.0)
        path = [
            greenery.polar(0.4 * r, angle, high),
            greenery.polar(0.8 * r, angle, high + 0.03),
            greenery.polar(out, angle, high - 0.01),
        ]
        steps = max(2, int(drop / (0.9 * leaf)))
        path += [
            greenery.polar(out + 0.004 * (k % 2), angle + 0.1 * (k % 3), high - drop * k / steps)
            for k in range(1, steps + 1)
        ]
        for k, (a, b) in enumerate(itertools.pairwise(path)):
            leaves.append(Leaf(a, b, 0.010))
            tip = greenery.shifted(
                b, greenery.polar(leaf, angle + (0.9 if k % 2 else -0.9), -0.3 * leaf if b[2] > 0.02 else 0.0)
            )
            leaves.append(Leaf(b, tip, 0.85 * leaf, 0.005))
    for k in range(14):
        leaves.append(
            Leaf(
                (0.0, 0.0, high),
                greenery.polar(w.length(0.3, 1.1) * r, 2.4 * k, high + w.length(0.02, 0.08)),
                leaf,
                0.01,
            )
        )
    greenery.add_leaves(w, leaves, w.look("foliage"))


def succulents(w: Workbench) -> None:
    """Builds a low bowl or tray with one to four fleshy rosettes."""
    count = w.whole(1, 4)
    r, high = w.length(0.05, 0.075) * (1.0 + 0.35 * (count > 1)), w.length(0.04, 0.09)
    look, long = w.look(w.choice(("pot", "ceramic", "masonry", "glass"))), 1.0
    if w.chance(0.5):
        greenery.round_pot(w, [(0.0, 0.6 * r), (0.4 * high, 0.95 * r), (high, r)], look)
        greenery.soil(w, high, 0.9 * r)
    else:
        long = 1.0 if count == 1 else w.length(1.2, 2.0)
        w.box((-r, r), (-long * r, long * r), (0.0, high), look)
        w.box(
            (-0.9 * r, 0.9 * r), (-0.92 * long * r, 0.92 * long * r), (high, high + 0.004), w.look("soil"), solid=False
        )
    for i in range(count):
        off = (0.0, 0.0, 0.0) if count == 1 else greenery.polar(0.52 * r, math.tau * i / count + math.pi / 2, 0.0)
        c = (off[0], long * off[1], high)
        size = (1.25 if count == 1 else 0.75) * r * w.length(0.8, 1.2)
        blades = []
        for k in range(w.whole(15, 24)):
            t = k / 20
            rise = size * (0.9 - 0.55 * t)
            out = size * (0.12 + 0.85 * t)
            blades.append((greenery.curve(c, 2.4 * k, out, 0.3 * rise, rise), 0.34 * size + 0.004))
        greenery.add_blades(w, blades, w.new_look("foliage"))


def orchid(w: Workbench) -> None:
    """Builds an orchid: a few wide leaves and arching sprays of flat flowers."""
    r, high = w.length(0.055, 0.075), w.length(0.09, 0.14)
    look = w.look(w.choice(("pot", "ceramic", "glass")))
    if w.chance(0.5):
        greenery.round_pot(w, [(0.0, 0.75 * r), (high, r)], look)
    else:
        w.box((-r, r), (-r, r), (0.0, high), look)
    greenery.soil(w, high, 0.8 * r)
    green, bloom, heart = w.look("foliage"), w.look("flower"), w.new_look("flower")
    base = (0.0, 0.0, high - 0.004)
    greenery.add_blades(
        w,
        [(greenery.curve(base, 1.2 * i, w.length(0.12, 0.20), 0.10, 0.03), 0.05) for i in range(w.whole(4, 6))],
        green,
    )
    for i in range(w.whole(1, 3)):
        angle, tall, out = 2.2 * i + w.length(0.0, 1.0), w.length(0.28, 0.48), w.length(0.14, 0.26)
        path = greenery.curve(base, angle, out, 1.5 * tall, tall, 7)
        for a, b in itertools.pairwise(path):
            w.rod(a, b, 0.0028, green, solid=False, round_ends=True)
        size = w.length(0.032, 0.048)
        for at in path[3:]:
            petals = [
                Leaf(
                    at,
                    greenery.shifted(
                        at, (0.5 * size * math.cos(angle), size * math.cos(m * 1.257), size * math.sin(m * 1.257))
                    ),
                    0.8 * size,
                )
                for m in range(5)
            ]
            w.mesh(foliage(petals), (0.0, 0.0, 0.0), bloom, solid=False)
            w.ball(at, 0.2 * size, heart, solid=False)


def herb_box(w: Workbench) -> None:
    """Builds a box or a tray of pots with different herbs."""
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
                (greenery.curve(c, 2.4 * k, w.length(0.02, 0.07), tall, tall * w.length(0.6, 1.0)), 0.008)
                for k in range(24)
            ]
            greenery.add_blades(w, blades, green)
            continue
        leaves, size = [], (0.05 if kind == 1 else 0.022)
        for k in range(42):
            stem = greenery.polar(0.028 * (k % 3), 2.1 * (k % 5), 0.0)
            at = greenery.shifted(c, (stem[0], stem[1], tall * (k // 6) / 7))
            leaves.append(Leaf(at, greenery.shifted(at, greenery.polar(0.045, 2.4 * k, 0.02)), size, 0.008))
            if k < 5:
                leaves.append(Leaf(c, greenery.shifted(c, (0.5 * stem[0], 0.5 * stem[1], tall)), 0.006))
        greenery.add_leaves(w, leaves, green)


def cut_flowers(w: Workbench) -> None:
    """Builds a bunch of cut flowers in a vase."""
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
        foot = greenery.polar(mouth * ring, angle, high - 0.03)
        top = greenery.polar(mouth * ring + spread * ring, angle, high + w.length(0.10, 0.22) * (1.25 - 0.5 * ring))
        w.rod(foot, top, 0.0035, green, solid=False)
        at: Point = tuple(0.5 * (a + b) for a, b in zip(foot, top, strict=True))  # type: ignore[assignment]
        leaves += [
            Leaf(at, greenery.shifted(at, greenery.polar(0.08, angle + s, 0.03)), 0.03, 0.01) for s in (0.8, -0.8)
        ]
        colour = colours[i % len(colours)]
        if kind == 0:
            w.ellipsoid(greenery.shifted(top, (0.0, 0.0, 0.015)), (0.018, 0.018, 0.028), colour, solid=False)
        elif kind == 1:
            petals = [
                Leaf(top, greenery.shifted(top, greenery.polar(0.042, 0.628 * k, 0.012)), 0.024) for k in range(10)
            ]
            w.mesh(foliage(petals), (0.0, 0.0, 0.0), colour, solid=False)
            w.ball(greenery.shifted(top, (0.0, 0.0, 0.004)), 0.012, w.look("wicker"), solid=False)
        elif kind == 2:
            w.ball(top, w.length(0.024, 0.042), colour, solid=False)
        else:
            spike = []
            for k in range(14):
                at = greenery.shifted(top, (0.0, 0.0, 0.009 * k - 0.03))
                spike.append(Leaf(at, greenery.shifted(at, greenery.polar(0.030 - 0.0015 * k, 2.4 * k, 0.012)), 0.020))
            w.mesh(foliage(spike), (0.0, 0.0, 0.0), colour, solid=False)
    greenery.add_leaves(w, leaves, green)


def spider_plant(w: Workbench) -> None:
    """Builds a dense tuft of narrow arching leaves, sometimes with plantlets on runners."""
    z = greenery.planter(w, w.length(0.06, 0.09), w.length(0.08, 0.14))
    reach, width, green = w.length(0.14, 0.26), w.length(0.010, 0.022), w.look("foliage")
    upright, blades = w.chance(0.25), []
    for k in range(w.whole(30, 60)):
        out = reach * (w.length(0.15, 0.5) if upright else w.length(0.4, 1.0))
        up = reach * w.length(0.7, 1.3)
        end = up * (w.length(0.6, 1.0) if upright else w.length(-0.1, 0.6))
        blades.append(
            (greenery.curve(greenery.polar(0.015, 2.4 * k, z - 0.005), 2.4 * k, out, up, max(end, 0.01 - z)), width)
        )
    for i in range(0 if upright else w.whole(0, 3)):
        path = greenery.curve((0.0, 0.0, z), 2.0 * i, 1.2 * reach, 0.9 * reach, max(-0.3 * reach, 0.03 - z))
        blades.append((path, 0.006))
        blades += [(greenery.curve(path[-1], 1.3 * k, 0.05, 0.03, -0.01), 0.010) for k in range(5)]
    greenery.add_blades(w, blades, green)


def lucky_bamboo(w: Workbench) -> None:
    """Builds curled or straight green stalks in a glass."""
    r, high = w.length(0.04, 0.06), w.length(0.08, 0.16)
    w.cylinder((0.0, 0.0), (0.0, high), r, w.look(w.choice(("glass", "ceramic"))))
    greenery.soil(w, high, 0.85 * r)
    green, curled, blades = w.look("foliage"), w.chance(0.5), []
    stalk = w.new_look("foliage")
    for i in range(w.whole(2, 5)):
        foot, tall = greenery.polar(0.45 * r, 2.4 * i, high - 0.01), w.length(0.15, 0.38)
        path = [foot, greenery.shifted(foot, (0.0, 0.0, 0.6 * tall))]
        if curled:
            for k in range(1, 5):
                path.append(
                    greenery.shifted(
                        foot,
                        greenery.shifted(
                            greenery.polar(0.025, 1.57 * k + i, 0.6 * tall + 0.1 * k * tall), (0.01, 0.0, 0.0)
                        ),
                    )
                )
        else:
            path.append(greenery.shifted(foot, (0.0, 0.0, tall)))
        for a, b in itertools.pairwise(path):
            w.rod(a, b, 0.006, stalk, solid=False, round_ends=True)
        for k in range(6):
            long = w.length(0.08, 0.15)
            blades.append((greenery.curve(path[-1], 2.4 * k + i, 0.7 * long, 0.8 * long, 0.4 * long), 0.018))
    greenery.add_blades(w, blades, green)


STYLES = (
    Style("plant", "trailing", "wide", trailing, ("top",), "top"),
    Style("plant", "succulents", "wide", succulents, ("top",), "top"),
    Style("plant", "orchid", "wide", orchid, ("top",), "top"),
    Style("plant", "herb_box", "wide", herb_box, ("top",), "top"),
    Style("plant", "cut_flowers", "wide", cut_flowers, ("top",), "top"),
    Style("plant", "spider_plant", "wide", spider_plant, ("top",), "top"),
    Style("plant", "lucky_bamboo", "wide", lucky_bamboo, ("top",), "top"),
)
