"""Coffee and dining tables of the pool `wide`."""

from __future__ import annotations

import math

import numpy as np

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring, frustum, loft, named_mesh
from sim.housegen.furniture.workbench import Workbench


def coffee_nest(w: Workbench) -> None:
    """Builds two coffee tables, the lower one half under the higher one."""
    radius, height = 0.5 * w.width(0.80, 1.10) * 0.66, w.length(0.40, 0.48)
    look, top, power = w.look(w.choice(("iron", "brass", "wood"))), w.look("wood"), w.choice((2.0, 4.0, 8.0))
    if w.chance(0.35):
        top = w.look("stone")
    feet, thick = w.whole(3, 4), w.length(0.012, 0.035)
    for k, (share, y, x) in enumerate(((1.0, -0.5 * radius, 0.0), (w.length(0.7, 0.9), 0.75 * radius, 0.12))):
        r, z = share * radius, height - k * w.length(0.07, 0.12)
        w.mesh(loft([Ring(h, r, r, x_m=x, y_m=y, power=power) for h in (z - thick, z)], 24, hull=True), (0, 0, 0), top)
        for i in range(feet):
            a = math.tau * (i + 0.5) / feet + 0.5 * k
            c, s = 0.8 * r * math.cos(a), 0.8 * r * math.sin(a)
            w.rod((x + c, y + s, 0.0), (x + c, y + s, z - thick), 0.011, look)
    w.top(parts.centred(0.0, radius), parts.centred(-0.7 * radius, radius), height)


def coffee_trunk(w: Workbench) -> None:
    """Builds a travelling trunk with a lid, a lock, handles and straps or corner irons."""
    width, depth, height = w.width(0.80, 1.20), w.depth(0.45, 0.65), w.length(0.38, 0.50)
    body = w.look(w.choice(("wood", "leather", "lacquer", "wicker")))
    metal = w.look("brass") if w.chance(0.5) else w.look("iron")
    x, y, lid, foot = (
        parts.centred(0.0, depth),
        parts.centred(0.0, width),
        height - w.length(0.07, 0.14),
        w.choice((0.0, 0.06)),
    )
    w.box((x[0] + 0.008, x[1] - 0.008), (y[0] + 0.008, y[1] - 0.008), (foot, lid), body)
    w.box(x, y, (lid + 0.006, height), body)
    w.box((x[0] + 0.012, x[1] - 0.012), (y[0] + 0.012, y[1] - 0.012), (lid - 0.01, lid + 0.01), w.look("dark"))
    if foot:
        w.legs(x, y, (0.0, foot), 0.06, w.look("dark"))
    if w.chance(0.6):
        for i in range(w.whole(2, 3)):
            c = (-0.33, 0.33, 0.0)[i] * width
            w.box((x[0] - 0.004, x[1] + 0.004), parts.centred(c, 0.045), (foot, height + 0.004), metal, solid=False)
    else:
        for cx in x:
            for cy in y:
                for z in ((foot, foot + 0.06), (height - 0.06, height + 0.003)):
                    w.box(parts.centred(0.96 * cx, 0.06), parts.centred(0.97 * cy, 0.06), z, metal, solid=False)
    w.box((x[1] - 0.01, x[1] + 0.008), parts.centred(0.0, 0.07), (lid - 0.05, lid + 0.04), metal, solid=False)
    for side in BOTH_SIDES:
        at = side * 0.5 * width
        w.bar((-0.07, at, lid - 0.08), (0.07, at, lid - 0.08), 0.03, 0.025, metal, solid=False)
    w.top((x[0] + 0.06, x[1] - 0.06), (y[0] + 0.06, y[1] - 0.06), height + 0.004)


def coffee_pebble(w: Workbench) -> None:
    """Builds a coffee table with an organic top on three or four thick legs."""
    width, depth, height = w.width(0.85, 1.30), w.depth(0.50, 0.80), w.length(0.32, 0.44)
    top, legs = w.look(w.choice(("wood", "stone", "lacquer"))), w.look(w.choice(("wood", "lacquer")))
    thick, angles = w.length(0.025, 0.06), np.arange(24) * math.tau / 24
    bend, phase = w.rng.uniform(0.05, 0.16), w.rng.uniform(0.0, math.tau)
    reach = 1.0 + bend * np.cos(2 * angles + phase) + 0.6 * bend * np.cos(3 * angles + 2 * phase)
    px, py = 0.5 * depth * reach * np.cos(angles), 0.5 * width * reach * np.sin(angles)
    points = [(a, b, z) for z in (height - thick, height) for a, b in zip(px, py, strict=True)]
    w.mesh(named_mesh("pebble", points), (0.0, 0.0, 0.0), top)
    count, fat, cone = w.whole(3, 4), w.length(0.025, 0.09), w.choice((0.5, 1.0, 1.3))
    rings = [Ring(0.0, cone * fat, cone * fat), Ring(height - thick, fat, fat)]
    for i in range(count):
        a = math.tau * (i + 0.5) / count + (0.0 if count == 4 else 0.3)
        at = (0.27 * depth * math.cos(a), 0.32 * width * math.sin(a), 0.0)
        w.mesh(loft(rings, 12, hull=True), at, legs)
    w.top(parts.centred(0.0, 0.5 * depth), parts.centred(0.0, 0.55 * width), height)


def coffee_drawer(w: Workbench) -> None:
    """Builds a low table with an open shelf above drawers."""
    width, depth, height = w.width(0.85, 1.25), w.depth(0.50, 0.70), w.length(0.36, 0.48)
    body, front, foot = w.look("wood"), parts.wood_look(w), w.length(0.03, 0.16)
    x, y = parts.slab(w, depth, width, (height - 0.03, height), body)
    split = height - 0.03 - w.length(0.09, 0.15) if height - foot > 0.3 else foot + 0.02
    closed = (foot, split) if split > foot + 0.08 else (foot, foot + 0.025)
    w.box((x[0] + 0.02, x[1] - 0.02), (y[0] + 0.02, y[1] - 0.02), closed, body)
    if closed[1] - closed[0] > 0.06:
        parts.plain_drawers(
            w, x[1] - 0.02, (y[0] + 0.02, y[1] - 0.02), closed, 1, w.whole(1, 3), front, w.look("brass"), "knob"
        )
    for c in (y[0] + 0.035, y[1] - 0.035, *((0.0,) if w.chance(0.4) else ())):
        w.box((x[0] + 0.02, x[1] - 0.02), parts.centred(c, 0.03), (closed[1], height - 0.03), body)
    if foot < 0.08:
        w.legs((x[0] + 0.05, x[1] - 0.05), (y[0] + 0.05, y[1] - 0.05), (0.0, foot), 0.05, w.look("dark"), round_=True)
    else:
        w.legs((x[0] + 0.05, x[1] - 0.05), (y[0] + 0.05, y[1] - 0.05), (0.0, foot), 0.035, body, splay=0.03)


def drop_leaf(w: Workbench) -> None:
    """Builds a gateleg table with one or both leaves up, or hanging at the side."""
    width, depth, height = w.width(1.00, 1.60), w.depth(0.75, 0.95), w.length(0.72, 0.76)
    wood, leg = w.look("wood"), w.length(0.035, 0.055)
    up = w.choice(((True, True), (True, False), (True, True)))
    middle = w.length(0.30, 0.5) * width
    leaf, half = 0.5 * (width - middle), 0.5 * middle
    thick, x = 0.022, parts.centred(0.0, depth)
    w.box(x, (-half, half), (height - thick, height), wood)
    frame = (x[0] + 0.08, x[1] - 0.08)
    w.legs(frame, (-half + 0.02, half - 0.02), (0.0, height - thick), leg, wood)
    for side in BOTH_SIDES:
        w.box(frame, parts.centred(side * (half - 0.03), 0.02), (height - 0.14, height - thick), wood)
    for edge in frame:
        w.box(parts.centred(edge * 0.95, 0.02), (-half + 0.03, half - 0.03), (height - 0.14, height - thick), wood)
    w.box(parts.centred(0.0, 0.05), (-half + 0.03, half - 0.03), (0.10, 0.14), wood)
    for side in BOTH_SIDES:
        w.box(frame, parts.centred(side * (half - 0.04), 0.03), (0.10, 0.14), wood)
    for side, raised in zip(BOTH_SIDES, up, strict=True):
        if raised:
            rounded = w.choice((0.55, 0.8, 1.0))
            plate = frustum((depth, leaf), (depth, leaf), thick)
            if rounded < 1.0:
                edge = [
                    (sx * 0.5 * depth * k, side * (half + leaf * t))
                    for sx in BOTH_SIDES
                    for k, t in ((1.0, 0.0), (1.0, 0.5), (rounded, 1.0))
                ]
                plate = named_mesh("leaf", [(a, b, z) for z in (0.0, thick) for a, b in edge])
                w.mesh(plate, (0.0, 0.0, height - thick), wood)
            else:
                w.mesh(plate, (0.0, side * (half + 0.5 * leaf), height - thick), wood)
            gate = side * (half + 0.6 * leaf)
            w.box(parts.centred(0.0, leg), parts.centred(gate, leg), (0.0, height - thick), wood)
            for z in (0.12, height - 0.10):
                w.bar((frame[0] + 0.03, side * (half - 0.03), z), (0.0, gate, z), 0.03, 0.03, wood)
        else:
            drop = min(leaf, height - 0.12)
            w.box(x, parts.on_side(side, half, half + thick), (height - drop, height), wood)
    low, high = -half - (leaf if up[0] else 0.0), half + (leaf if up[1] else 0.0)
    w.top((x[0] + 0.15, x[1] - 0.15), (low + 0.15, high - 0.15), height)


def twin_pedestal(w: Workbench) -> None:
    """Builds a long table on two columns with claw feet, drums or wedges."""
    width, depth, height = w.width(1.60, 2.40), w.depth(0.90, 1.10), w.length(0.73, 0.77)
    top, look, power = (
        w.look("wood") if w.chance(0.7) else w.look("stone"),
        parts.wood_look(w),
        w.choice((2.0, 3.0, 6.0)),
    )
    thick, kind = w.length(0.025, 0.05), w.choice(("claw", "drum", "wedge"))
    rings = [Ring(z, 0.5 * depth, 0.5 * width, power=power) for z in (height - thick, height)]
    w.mesh(loft(rings, 40, hull=True), (0.0, 0.0, 0.0), top)
    for side in BOTH_SIDES:
        y = side * 0.24 * width
        if kind == "claw":
            levels = ((0.12, 0.05), (0.2, 0.07), (0.32, 0.04), (0.55, 0.06), (height - thick, 0.09))
            w.mesh(loft([Ring(z, r, r) for z, r in levels], 12), (0.0, y, 0.0), look)
            for i in range(3):
                a = math.tau * i / 3 + (0.0 if side > 0 else math.pi) + 0.5 * math.pi
                tip = (0.36 * math.cos(a), y + 0.30 * math.sin(a), 0.025)
                w.rod((0.0, y, 0.19), tip, 0.025, look, round_ends=True)
        elif kind == "drum":
            w.cylinder((0.0, y), (0.0, height - thick), w.length(0.12, 0.2), look)
        else:
            w.mesh(frustum((0.45, 0.14), (0.25, 0.40), height - thick), (0.0, y, 0.0), look)
    if kind == "claw" and w.chance(0.5):
        w.box(parts.centred(0.0, 0.03), (-0.24 * width, 0.24 * width), (0.24, 0.30), look)
    w.top(parts.centred(0.0, 0.6 * depth), parts.centred(0.0, 0.65 * width), height)


def cafe_cross(w: Workbench) -> None:
    """Builds a bistro table on one slim column with four flat feet or a foot plate."""
    side, height = w.width(0.60, 0.95), w.length(0.71, 0.76)
    metal, thick = w.look("iron") if w.chance(0.6) else w.look("steel"), w.length(0.015, 0.035)
    top = w.look(w.choice(("wood", "stone", "lacquer", "steel")))
    if w.chance(0.5):
        parts.round_top(w, 0.5 * side, (height - thick, height), top)
    else:
        parts.slab(w, side * w.choice((1.0, 0.8)), side, (height - thick, height), top)
    w.cylinder((0.0, 0.0), (0.02, height - thick), w.length(0.022, 0.045), metal)
    for turn in (0.785, -0.785):
        reach = 0.33 * side
        c, s = reach * math.cos(turn), reach * math.sin(turn)
        w.bar((-0.7 * c, -0.7 * s, height - thick - 0.01), (0.7 * c, 0.7 * s, height - thick - 0.01), 0.04, 0.02, metal)
    if w.chance(0.6):
        for i in range(4):
            a = math.tau * (i + 0.5) / 4
            tip = (0.42 * side * math.cos(a), 0.42 * side * math.sin(a), 0.018)
            w.rod((0.0, 0.0, w.choice((0.05, 0.12))), tip, 0.018, metal, round_ends=True)
    else:
        w.cylinder((0.0, 0.0), (0.0, 0.025), 0.34 * side, metal)


def parsons(w: Workbench) -> None:
    """Builds a table with corner legs flush with its top, or a plastic one with tapered legs."""
    width, depth, height = w.width(1.00, 2.00), w.depth(0.75, 1.00), w.length(0.71, 0.76)
    if w.chance(0.5):
        look, thick = parts.wood_look(w), w.length(0.04, 0.10)
        x, y = parts.slab(w, depth, width, (height - thick, height), look)
        w.legs(x, y, (0.0, height - thick), thick * w.choice((1.0, 1.3)), look)
        return
    look = w.look("plastic")
    rings = [Ring(z, 0.5 * depth, 0.5 * width, power=8.0) for z in (height - 0.05, height)]
    w.mesh(loft(rings, 24, hull=True), (0.0, 0.0, 0.0), look)
    for sx in BOTH_SIDES:
        for sy in BOTH_SIDES:
            at = (sx * (0.5 * depth - 0.10), sy * (0.5 * width - 0.10), 0.0)
            w.mesh(frustum((0.04, 0.04), (0.11, 0.11), height - 0.05), at, look)
    w.top((-0.5 * depth + 0.1, 0.5 * depth - 0.1), (-0.5 * width + 0.1, 0.5 * width - 0.1), height)


STYLES: tuple[Style, ...] = (
    Style("table", "coffee_nest", "wide", coffee_nest, ("coffee",)),
    Style("table", "coffee_trunk", "wide", coffee_trunk, ("coffee",)),
    Style("table", "coffee_pebble", "wide", coffee_pebble, ("coffee",)),
    Style("table", "coffee_drawer", "wide", coffee_drawer, ("coffee",)),
    Style("table", "drop_leaf", "wide", drop_leaf, ("dining",)),
    Style("table", "twin_pedestal", "wide", twin_pedestal, ("dining",)),
    Style("table", "cafe_cross", "wide", cafe_cross, ("dining",)),
    Style("table", "parsons", "wide", parsons, ("dining",)),
)
