"""Sinks of the pool `wide`."""

from __future__ import annotations

import math

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.item import Look
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring, hoop, loft
from sim.housegen.furniture.workbench import Workbench


def _wall_tap(w: Workbench, x: float, y: float, z: float, reach: float, look: Look) -> None:
    """Adds a wall-mounted tap at x with two heads and a spout."""
    for side in BOTH_SIDES:
        w.rod((x, y + side * 0.08, z), (x + 0.05, y + side * 0.08, z), 0.02, look, solid=False)
    w.rod((x, y - 0.08, z), (x, y + 0.08, z), 0.012, look, solid=False)
    parts.arched_pipe(w, (x, y, z), (x + reach, y, z - 0.03), 0.03, 0.011, look, 2)


def _trap(w: Workbench, x: float, top: float, low: float, look: Look) -> None:
    """Adds a bottle trap below a basin with its pipe into the wall at x = 0."""
    w.rod((x, 0.0, low + 0.03), (x, 0.0, top), 0.016, look, solid=False)
    w.cylinder((x, 0.0), (low, low + 0.09), 0.034, look, solid=False)
    w.rod((0.0, 0.0, low + 0.07), (x, 0.0, low + 0.07), 0.015, look, solid=False)


def half_pedestal(w: Workbench) -> None:
    """Builds a wall basin with a half pedestal or a visible trap."""
    width, depth = w.width(0.45, 0.75), w.depth(0.38, 0.54)
    white, metal = w.look("ceramic"), parts.fitting_look(w)
    tall, power, high = w.length(0.40, 0.50), w.choice((2.0, 2.6, 4.0, 8.0)), w.length(0.12, 0.20)
    w.mount_height_m = w.length(0.82, 0.90) - tall
    rx, ry, middle = 0.5 * (depth - 0.04), 0.5 * width, 0.5 * (depth + 0.04)
    rings = [
        Ring(tall - high, 0.5 * rx, 0.5 * ry, power=power),
        Ring(tall - 0.4 * high, 0.92 * rx, 0.94 * ry, power=power),
    ]
    rings += parts.hollow_rings(tall, rx, ry, 0.75 * high, 0.03, power)
    w.mesh(loft(rings, 16), (middle, 0.0, 0.0), white)
    ledge = 0.10 if power < 3 else 0.07
    w.box((0.0, ledge), (-0.42 * width, 0.42 * width), (tall - 0.11, tall + w.choice((0.004, 0.05))), white)
    w.cylinder((middle, 0.0), (tall - 0.76 * high, tall - 0.74 * high), 0.024, metal, solid=False)
    if w.chance(0.65):
        column = [Ring(0.0, 0.07, 0.08, 0.10), Ring(0.06, 0.09, 0.10, 0.11), Ring(tall - 0.5 * high, 0.13, 0.15, 0.15)]
        w.mesh(loft(column, 12, hull=True), (-0.02, 0.0, 0.0), white)
    else:
        _trap(w, 0.22, tall - 0.8 * high, 0.0, metal)
    parts.any_tap(w, (0.055, 0.0, tall), 0.12, w.length(0.09, 0.18), metal)


def totem(w: Workbench) -> None:
    """Builds a column with a bowl in its top: a cylinder, a cone, an hourglass or a square column."""
    r, rim, power = 0.5 * w.width(0.38, 0.56), w.length(0.82, 0.92), w.choice((2.0, 2.0, 3.5, 12.0))
    look, metal = parts.sanitary_look(w), parts.fitting_look(w)
    foot, waist = w.choice(((1.0, 1.0), (0.55, 0.75), (0.8, 0.5), (0.7, 0.85)))
    rings = [Ring(0.0, foot * r, foot * r, power=power), Ring(0.5 * rim, waist * r, waist * r, power=power)]
    rings += parts.hollow_rings(rim, r, r, w.length(0.10, 0.16), w.length(0.015, 0.05), power)
    w.mesh(loft(rings, 16), (0.0, 0.0, 0.0), look)
    if w.chance(0.5):
        x, top = -r - 0.035, rim + w.length(0.12, 0.28)
        w.cylinder((x, 0.0), (0.0, 0.02), 0.035, metal)
        w.rod((x, 0.0, 0.0), (x, 0.0, top), 0.016, metal)
        w.rod((x, 0.0, top), (x + r, 0.0, top - 0.03), 0.013, metal, solid=False, round_ends=True)
        w.rod((x, 0.0, top), (x, 0.0, top + 0.05), 0.022, metal, solid=False)
    else:
        w.box((-r - 0.03, -r + 0.08), (-0.10, 0.10), (rim - 0.10, rim + 0.005), look)
        parts.any_tap(w, (-r + 0.02, 0.0, rim), 0.13, w.length(0.12, 0.22), metal)


def butler(w: Workbench) -> None:
    """Builds a deep thick-walled sink on piers, wooden legs or an iron frame."""
    width, depth, rim = w.width(0.50, 0.90), w.depth(0.42, 0.52), w.length(0.80, 0.92)
    look, deep = w.look(w.choice(("ceramic", "ceramic", "stone"))), w.length(0.20, 0.30)
    x, y = parts.footprint(depth, width)
    parts.basin(w, x, y, rim, deep, w.length(0.025, 0.05), look)
    w.cylinder((0.0, 0.0), (rim - deep + 0.02, rim - deep + 0.055), 0.035, w.look("chrome"), solid=False)
    low = rim - deep
    support = w.choice(("piers", "legs", "frame"))
    if support == "piers":
        stone = w.look(w.choice(("masonry", "stone", "lacquer")))
        for side in BOTH_SIDES:
            a, b = sorted((side * (y[1] - 0.02), side * (y[1] - 0.14)))
            w.box((x[0] + 0.01, x[1] - 0.03), (a, b), (0.0, low), stone)
    elif support == "legs":
        wood, thick = w.look("wood"), w.length(0.05, 0.08)
        w.legs((x[0] + 0.01, x[1] - 0.01), (y[0] + 0.01, y[1] - 0.01), (0.0, low), thick, wood)
        w.box((x[0] + 0.01, x[1] - 0.01), (y[0] + 0.01, y[1] - 0.01), (low - 0.07, low), wood)
        if w.chance(0.6):
            w.box((x[0] + 0.02, x[1] - 0.02), (y[0] + 0.02, y[1] - 0.02), (0.18, 0.21), wood)
    else:
        iron = w.look("iron")
        w.legs((x[0] + 0.02, x[1] - 0.02), (y[0] + 0.03, y[1] - 0.03), (0.0, low), 0.03, iron, round_=True)
        for side in BOTH_SIDES:
            w.rod(
                (x[0] + 0.02, side * (y[1] - 0.03), 0.20), (x[1] - 0.02, side * (y[1] - 0.03), low - 0.02), 0.01, iron
            )
    metal, back = parts.fitting_look(w), w.length(0.15, 0.45)
    w.box((x[0] - 0.03, x[0] + 0.005), y, (low, rim + back), look if w.chance(0.5) else w.look("masonry"))
    _wall_tap(w, x[0], 0.0, rim + min(0.6 * back, 0.2), 0.5 * depth, metal)


def catering(w: Workbench) -> None:
    """Builds a steel catering sink with a drainer, a splashback and tubular legs."""
    width, depth, rim = w.width(0.55, 1.20), w.depth(0.48, 0.62), w.length(0.84, 0.92)
    steel, deep = w.look("steel"), w.length(0.18, 0.30)
    x, y = parts.footprint(depth, width)
    bowl = (y[0] + 0.03, y[0] + min(width - 0.06, 0.52))
    back = x[0] + 0.10
    parts.basin(w, (back, x[1] - 0.03), bowl, rim, deep, 0.012, steel)
    w.box((x[0], back), y, (rim - 0.04, rim), steel)
    w.box((x[1] - 0.03, x[1]), y, (rim - 0.06, rim), steel)
    w.box((back, x[1] - 0.03), (y[0], bowl[0]), (rim - 0.04, rim), steel)
    w.box((back, x[1] - 0.03), (bowl[1], y[1]), (rim - 0.04, rim - 0.01), steel)
    rest = y[1] - bowl[1]
    for i in range(int(rest / 0.06)):
        c = bowl[1] + 0.04 + 0.06 * i
        w.box((back + 0.02, x[1] - 0.05), (c - 0.006, c + 0.006), (rim - 0.01, rim - 0.004), steel, solid=False)
    w.box((x[0] - 0.015, x[0]), y, (rim - 0.04, rim + w.length(0.08, 0.30)), steel)
    w.legs((x[0] + 0.03, x[1] - 0.03), (y[0] + 0.04, y[1] - 0.04), (0.0, rim - 0.04), 0.04, steel, round_=True)
    if w.chance(0.6):
        w.box((x[0] + 0.02, x[1] - 0.02), (y[0] + 0.03, y[1] - 0.03), (0.15, 0.18), steel)
    middle = 0.5 * (bowl[0] + bowl[1])
    w.cylinder(
        (0.5 * (back + x[1]), middle), (rim - deep + 0.01, rim - deep + 0.016), 0.035, w.look("dark"), solid=False
    )
    if w.chance(0.4):
        top = rim + w.length(0.55, 0.75)
        w.rod((x[0] + 0.05, middle, rim), (x[0] + 0.05, middle, top), 0.014, steel, solid=False)
        parts.arched_pipe(w, (x[0] + 0.05, middle, top), (0.05, middle, rim + 0.25), 0.12, 0.013, w.look("dark"), 5)
        w.rod((0.05, middle, rim + 0.26), (0.05, middle, rim + 0.14), 0.022, steel, solid=False)
    else:
        parts.any_tap(w, (x[0] + 0.05, middle, rim), 0.20, w.length(0.15, 0.30), steel)


def hand_rinse(w: Workbench) -> None:
    """Builds a very small wall basin with a trap below."""
    width, metal, white = w.width(0.30, 0.46), parts.fitting_look(w), parts.sanitary_look(w)
    tall, high, power = w.length(0.24, 0.34), w.length(0.08, 0.16), w.choice((2.0, 3.0, 14.0))
    depth = w.depth(0.20, 0.30)
    w.mount_height_m = w.length(0.82, 0.92) - tall
    rx, ry = 0.5 * depth, 0.5 * width
    rings = [Ring(tall - high, 0.75 * rx, 0.7 * ry, power=power)]
    rings += parts.hollow_rings(tall, rx, ry, 0.7 * high, 0.02, power)
    w.mesh(loft(rings, 16), (rx, 0.0, 0.0), white)
    w.box((0.0, 0.06), (-0.45 * width, 0.45 * width), (tall - high, tall), white)
    side = w.choice((-0.3, 0.0, 0.3)) * width
    parts.any_tap(w, (0.035, side, tall), 0.08, w.length(0.08, 0.13), metal)
    _trap(w, 0.12, tall - high, 0.0, metal)


def slab_wall(w: Workbench) -> None:
    """Builds a thick wall-mounted slab with a shallow hollow."""
    width, depth, thick = w.width(0.55, 1.10), w.depth(0.40, 0.52), w.length(0.05, 0.16)
    look, metal = parts.sanitary_look(w), parts.fitting_look(w)
    tall = w.length(0.30, 0.45)
    w.mount_height_m = w.length(0.82, 0.88) - tall
    power, bx, by = w.choice((2.0, 4.0, 12.0)), 0.34 * depth, min(0.38 * width, 0.30)
    deep = 0.7 * thick
    rings = [
        Ring(tall - thick, 0.5 * depth, 0.5 * width, power=24),
        Ring(tall, 0.5 * depth, 0.5 * width, power=24),
        Ring(tall, bx, by, 0.03, power=power),
        Ring(tall - deep, 0.85 * bx, 0.9 * by, 0.03, power=power),
    ]
    w.mesh(loft(rings, 16), (0.5 * depth, 0.0, 0.0), look)
    w.cylinder((0.5 * depth + 0.03, 0.0), (tall - deep, tall - deep + 0.006), 0.024, metal, solid=False)
    if w.chance(0.5):
        z = tall - thick - 0.07
        w.rod((depth - 0.03, -0.4 * width, z), (depth - 0.03, 0.4 * width, z), 0.009, metal)
        for side in BOTH_SIDES:
            w.rod(
                (depth - 0.03, side * 0.38 * width, z), (depth - 0.03, side * 0.38 * width, tall - thick), 0.008, metal
            )
    if w.chance(0.5):
        board = w.look("wood")
        w.box((0.0, 0.8 * depth), (-0.5 * width, 0.5 * width), (0.0, 0.03), board)
        for side in BOTH_SIDES:
            a, b = sorted((side * 0.5 * width, side * (0.5 * width - 0.03)))
            w.box((0.0, 0.3 * depth), (a, b), (0.03, tall - thick), board)
    else:
        _trap(w, 0.24, tall - thick, 0.0, metal)
    parts.any_tap(w, (0.05, w.choice((0.0, 0.0, 0.6)) * by, tall), 0.13, w.length(0.10, 0.20), metal)


def enamel_stand(w: Workbench) -> None:
    """Builds a bowl in a ring on three or four thin legs, often with a jug on the shelf below."""
    r, rim = w.length(0.17, 0.23), w.length(0.72, 0.86)
    frame, white = w.look(w.choice(("iron", "wood", "metal"))), w.look(w.choice(("ceramic", "steel", "plastic")))
    count, splay, thick = w.whole(3, 4), w.length(0.0, 0.10), w.length(0.008, 0.018)
    low, power = rim - 0.07, w.choice((2.0, 2.0, 3.0))
    rings = [Ring(rim - 0.14, 0.5 * r, 0.5 * r, power=power), Ring(rim - 0.06, 0.9 * r, 0.9 * r, power=power)]
    rings += [Ring(rim, 1.1 * r, 1.1 * r, power=power), Ring(rim + 0.004, 1.06 * r, 1.06 * r, power=power)]
    rings += [Ring(rim - 0.05, 0.8 * r, 0.8 * r, power=power), Ring(rim - 0.12, 0.4 * r, 0.4 * r, power=power)]
    w.mesh(loft(rings, 16), (0.0, 0.0, 0.0), white)
    w.mesh(hoop(1.02 * r, 0.02, 0.025, 16), (0.0, 0.0, low), frame)
    for i in range(count):
        a = math.tau * (i + 0.5) / count
        top, foot = (r * math.cos(a), r * math.sin(a), low), ((r + splay) * math.cos(a), (r + splay) * math.sin(a), 0.0)
        w.rod(foot, top, thick, frame)
    w.cylinder((0.0, 0.0), (0.24, 0.26), r + 0.6 * splay, frame)
    if w.chance(0.7):
        jug = [Ring(0.26, 0.06, 0.06), Ring(0.36, 0.09, 0.09), Ring(0.46, 0.05, 0.05), Ring(0.52, 0.065, 0.055, 0.02)]
        w.mesh(loft(jug, 12), (0.0, 0.0, 0.0), white)
        parts.arched_pipe(w, (-0.05, 0.0, 0.34), (-0.05, 0.0, 0.48), 0.0, 0.008, white, 1)
    x, z = -r - 0.02, rim + 0.25
    if w.chance(0.5):
        w.rod((x + 0.02, 0.0, low), (x, 0.0, z + 0.02), thick, frame)
        parts.arched_pipe(w, (x, 0.0, z), (x + r, 0.0, z - 0.04), 0.04, 0.011, w.look("chrome"), 3)


def vessel_oval(w: Workbench) -> None:
    """Builds a long low oval vessel basin."""
    rx, ry = w.length(0.16, 0.21), w.length(0.22, 0.30)
    look, metal, high = parts.sanitary_look(w), parts.fitting_look(w), w.length(0.09, 0.16)
    power, foot = w.choice((2.0, 2.4)), w.length(0.45, 0.9)
    rings = [
        Ring(0.0, foot * rx, foot * ry, power=power),
        Ring(0.5 * high, 0.5 * (1 + foot) * rx, 0.5 * (1 + foot) * ry),
    ]
    rings += parts.hollow_rings(high, rx, ry, 0.8 * high, w.length(0.008, 0.04), power)
    w.mesh(loft(rings, 16), (0.0, 0.0, 0.0), look)
    w.cylinder((0.0, 0.0), (0.0, 0.22 * high), 0.022, metal, solid=False)
    side = w.choice((0.0, 0.0, -0.6)) * ry
    parts.any_tap(w, (-rx - 0.015, side, 0.0), rx, high + w.length(0.06, 0.15), metal)


def vessel_drum(w: Workbench) -> None:
    """Builds a tall vessel basin with straight sides and sometimes bands."""
    r, high = w.length(0.17, 0.22), w.length(0.14, 0.22)
    look, metal, taper = parts.sanitary_look(w), parts.fitting_look(w), w.length(0.75, 1.05)
    rings = [Ring(0.0, taper * r, taper * r), Ring(0.9 * high, 0.99 * r, 0.99 * r)]
    rings += parts.hollow_rings(high, r, r, 0.8 * high, w.length(0.01, 0.03), 2.0)
    w.mesh(loft(rings, 16), (0.0, 0.0, 0.0), look)
    w.cylinder((0.0, 0.0), (0.0, 0.23 * high), 0.022, metal, solid=False)
    for i in range(w.whole(0, 3)):
        t = (0.25, 0.5, 0.95)[i]
        w.mesh(hoop((taper + (1 - taper) * t) * r + 0.008, 0.02, 0.02), (0.0, 0.0, t * high), look, solid=False)
    parts.any_tap(w, (-r - 0.03, 0.0, 0.0), r, high + w.length(0.06, 0.14), metal)


def vessel_cone(w: Workbench) -> None:
    """Builds a thin wide conical vessel basin."""
    r, high, metal = w.length(0.19, 0.24), w.length(0.10, 0.16), parts.fitting_look(w)
    look = w.look(w.choice(("glass", "brass", "pot", "ceramic", "steel", "stone")))
    rings = [
        Ring(0.0, 0.30 * r, 0.30 * r), Ring(0.02, 0.24 * r, 0.24 * r), Ring(high, r, r),
        Ring(high, r - 0.012, r - 0.012), Ring(0.04, 0.2 * r, 0.2 * r),
    ]  # fmt: skip
    w.mesh(loft(rings, 18), (0.0, 0.0, 0.0), look)
    w.cylinder((0.0, 0.0), (0.02, 0.045), 0.022, metal, solid=False)
    parts.any_tap(w, (-r - 0.01, 0.0, 0.0), r, high + w.length(0.06, 0.16), metal)


def _inset_plate(w: Workbench, look: Look, rx: float, ry: float, y: float, power: float, lift: float) -> None:
    """Adds a plate over the worktop's hole with one bowl of 0.18 m depth."""
    px, py = w.length(0.21, 0.24), w.length(0.25, 0.28)
    rings = [
        Ring(0.0, 0.6 * rx, 0.6 * ry, y_m=y, power=power), Ring(0.15, rx, ry, y_m=y, power=power),
        Ring(0.18 + lift, px, py, power=24), Ring(0.18 + lift, rx, ry, y_m=y, power=power),
        Ring(0.08, 0.93 * rx, 0.93 * ry, y_m=y, power=power), Ring(0.012, 0.5 * rx, 0.5 * ry, y_m=y, power=power),
    ]  # fmt: skip
    w.mesh(loft(rings, 16), (0.0, 0.0, 0.0), look)
    w.cylinder((0.0, y), (0.012, 0.020), w.length(0.025, 0.05), w.look("chrome"), solid=False)


def inset_drainer(w: Workbench) -> None:
    """Builds an inset sink with one bowl beside a ribbed drainer."""
    look = w.look(w.choice(("steel", "steel", "dark", "ceramic", "iron")))
    side, lift = w.choice(BOTH_SIDES), w.length(0.005, 0.02)
    ry = w.length(0.10, 0.13)
    _inset_plate(w, look, w.length(0.12, 0.17), ry, side * (0.23 - ry), w.choice((2.0, 4.0, 10.0)), lift)
    count, top = w.whole(4, 6), 0.18 + lift
    for i in range(count):
        c = -side * (0.20 - 0.20 * i / count)
        w.box((-0.14, 0.17), (c - 0.006, c + 0.006), (top - 0.004, top + 0.006), look, solid=False)
    parts.any_tap(w, (-0.19, side * 0.03, top), 0.18, w.length(0.16, 0.30), parts.fitting_look(w))


def inset_round(w: Workbench) -> None:
    """Builds an inset sink with a round or oval bowl."""
    look = w.look(w.choice(("steel", "ceramic", "dark", "brass")))
    r, lift = w.length(0.15, 0.175), w.length(0.004, 0.015)
    _inset_plate(w, look, r, w.choice((r, 0.2)), 0.0, 2.0, lift)
    parts.any_tap(
        w, (-0.195, w.choice((0.0, -0.10, 0.10)), 0.18 + lift), 0.17, w.length(0.14, 0.32), parts.fitting_look(w)
    )
    if w.chance(0.4):
        w.cylinder((-0.19, -0.18), (0.18, 0.27), 0.014, w.look("chrome"), solid=False)
        w.rod((-0.19, -0.18, 0.27), (-0.14, -0.18, 0.26), 0.008, w.look("chrome"), solid=False, round_ends=True)


def inset_fireclay(w: Workbench) -> None:
    """Builds a thick-walled inset sink whose broad rim is above the worktop, sometimes with a divider."""
    look, lift, thick = w.look(w.choice(("ceramic", "ceramic", "plastic"))), w.length(0.01, 0.03), w.length(0.025, 0.04)
    parts.basin(w, (-0.20, 0.22), (-0.25, 0.25), 0.18 + lift, 0.18 + lift, thick, look)
    w.box((-0.26, -0.20), (-0.25, 0.25), (0.15, 0.18 + lift), look)
    if w.chance(0.4):
        y = w.choice((0.0, 0.06))
        w.box((-0.18, 0.20), (y - 0.015, y + 0.015), (0.02, 0.15), look)
    w.cylinder((0.01, -0.12), (thick - 0.005, thick + 0.004), 0.035, w.look("chrome"), solid=False)
    parts.any_tap(w, (-0.225, 0.0, 0.18 + lift), 0.19, w.length(0.18, 0.28), parts.fitting_look(w))


STYLES: tuple[Style, ...] = (
    Style("sink", "half_pedestal", "wide", half_pedestal, ("standing",), "wall"),
    Style("sink", "totem", "wide", totem, ("standing",)),
    Style("sink", "butler", "wide", butler, ("standing",)),
    Style("sink", "catering", "wide", catering, ("standing",)),
    Style("sink", "hand_rinse", "wide", hand_rinse, ("standing",), "wall"),
    Style("sink", "slab_wall", "wide", slab_wall, ("standing",), "wall"),
    Style("sink", "enamel_stand", "wide", enamel_stand, ("standing",)),
    Style("sink", "vessel_oval", "wide", vessel_oval, ("vessel",), "top"),
    Style("sink", "vessel_drum", "wide", vessel_drum, ("vessel",), "top"),
    Style("sink", "vessel_cone", "wide", vessel_cone, ("vessel",), "top"),
    Style("sink", "inset_drainer", "wide", inset_drainer, ("inset",), "top"),
    Style("sink", "inset_round", "wide", inset_round, ("inset",), "top"),
    Style("sink", "inset_fireclay", "wide", inset_fireclay, ("inset",), "top"),
)
