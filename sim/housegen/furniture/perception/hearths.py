"""Fireplaces of the pool `wide`."""

from __future__ import annotations

import math

import numpy as np

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.item import Look, MeshShape
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.parts.fire import flames
from sim.housegen.furniture.shapes import Ring, frustum, loft, named_mesh
from sim.housegen.furniture.workbench import Point, Range, Workbench


def wall_above_arch(x: Range, half: float, spring: float, rise: float, top: float) -> MeshShape:
    """Returns the wall above an arched opening |y| < half, from the arch that starts at `spring` up to `top`."""
    n = 12
    angles = np.linspace(0.0, math.pi, n)
    y = half * np.cos(angles)
    arc = spring + rise * np.sin(angles)
    rows = [np.column_stack([np.full(n, at), y, z]) for at in x for z in (arc, np.full(n, top))]
    low_b, up_b, low_f, up_f = 0, n, 2 * n, 3 * n
    quads = []
    for i in range(n - 1):
        quads += [
            (low_f + i, up_f + i, up_f + i + 1, low_f + i + 1),
            (low_b + i, low_b + i + 1, up_b + i + 1, up_b + i),
            (low_f + i, low_f + i + 1, low_b + i + 1, low_b + i),
            (up_f + i + 1, up_f + i, up_b + i, up_b + i + 1),
        ]
    e = n - 1
    quads += [(up_f, low_f, low_b, up_b), (low_f + e, up_f + e, up_b + e, low_b + e)]
    faces = [triangle for a, b, c, d in quads for triangle in ((a, b, c), (a, c, d))]
    return named_mesh("arch", np.vstack(rows), faces)


def _extruded(profile_yz: list[tuple[float, float]], x: Range) -> MeshShape:
    """Returns a convex outline in the (y, z) plane extruded from x[0] to x[1]."""
    return named_mesh("prism", [(at, y, z) for at in x for y, z in profile_yz])


def logs(w: Workbench, at: Point, half: float, *, burning: float = 0.7) -> None:
    """Adds logs that lie across each other, with flames with the probability `burning`."""
    x, y, z = at
    wood = w.look("wood")
    r = w.length(0.03, 0.05)
    w.rod((x - 0.05, y - half, z + r), (x - 0.05, y + half, z + r), r, wood)
    w.rod((x + 0.05, y - 0.9 * half, z + r), (x + 0.05, y + 0.8 * half, z + r), r, wood)
    w.rod((x - 0.04, y - 0.6 * half, z + 2.4 * r), (x + 0.04, y + 0.7 * half, z + 2.4 * r), 0.9 * r, wood)
    if w.chance(burning):
        tongues = [(y + w.length(-0.6, 0.6) * half, w.length(0.18, 0.36), 0.05) for _ in range(w.whole(1, 3))]
        flames(w, x, z + 2 * r, tongues)


def _fire_chamber(w: Workbench, x: Range, y: Range, z: Range, thick: float, look: Look) -> None:
    """Adds the back and the sides of a fire chamber that is open to the front."""
    w.box((x[0], x[0] + thick), y, z, look)
    for low in (y[0], y[1] - thick):
        w.box((x[0] + thick, x[1]), (low, low + thick), z, look)


def kiva(w: Workbench) -> None:
    """Builds a rounded adobe fireplace that narrows into a chimney, with a ledge in front."""
    half, deep, top = 0.5 * w.width(0.85, 1.25), 0.5 * w.length(0.55, 0.75), w.height(2.30, 2.50)
    look = w.look("lacquer") if w.chance(0.7) else w.look("pot")
    belly, ledge = w.length(0.95, 1.25), w.length(0.18, 0.42)
    rings = [
        Ring(0.0, deep, half, deep, power=2.6),
        Ring(0.55 * belly, 0.98 * deep, 0.97 * half, 0.98 * deep, power=2.4),
        Ring(belly, 0.72 * deep, 0.70 * half, 0.72 * deep),
        Ring(belly + 0.25, 0.45 * deep, 0.42 * half, 0.45 * deep),
        Ring(top, 0.34 * deep, 0.30 * half, 0.34 * deep),
    ]
    w.mesh(loft(rings, 16), (0.0, 0.0, 0.0), look)
    mouth = w.length(0.42, 0.52) * half
    high = w.length(0.24, 0.32)
    front = 2 * deep
    w.ellipsoid((front - 0.07, 0.0, ledge + 0.8 * high), (0.09, mouth, high), w.look("char"))
    reach = front + w.length(0.18, 0.32)
    w.box((0.3 * deep, reach), (-half - 0.02, half + 0.02), (0.0, ledge), look)
    if w.chance(0.5):
        side = w.choice(BOTH_SIDES)
        y = sorted((side * 0.7 * half, side * (half + w.length(0.35, 0.70))))
        w.box((0.0, 0.9 * deep), (y[0], y[1]), (0.0, ledge + 0.10), look)
    for i in range(3):
        y = 0.35 * (i - 1) * mouth
        w.rod((front + 0.06, 2.0 * y, ledge), (front, 0.6 * y, ledge + 1.2 * high), 0.028, w.look("wood"))
    if w.chance(0.6):
        flames(w, front + 0.05, ledge, ((-0.05, 0.16, 0.035), (0.03, 0.22, 0.04)))
    if w.chance(0.5):
        w.box((0.0, 1.75 * deep), (-0.75 * half, 0.75 * half), (belly - 0.03, belly + 0.03), w.look("wood"))


def smoke_hood(w: Workbench) -> None:
    """Builds an open fire on a plinth under a tapered hood that reaches the ceiling."""
    half, deep, top = 0.5 * w.width(1.00, 1.60), w.length(0.60, 0.85), w.height(2.35, 2.50)
    plinth, hood = w.length(0.18, 0.42), w.length(1.15, 1.45)
    stone = w.look("masonry") if w.chance(0.5) else w.look("stone")
    shell = w.choice(("lacquer", "metal", "brass", "dark"))
    w.box((0.0, deep), (-half, half), (0.0, plinth), stone)
    w.box((0.0, deep + 0.04), (-half - 0.04, half + 0.04), (plinth, plinth + 0.05), w.look("stone"))
    w.box((0.0, 0.06), (-0.92 * half, 0.92 * half), (plinth + 0.05, hood + 0.02), w.look("char"))
    flue = w.length(0.16, 0.30)
    band, rise = w.length(0.06, 0.22), w.length(0.40, 0.75)
    lean = -0.5 * deep + 0.5 * flue
    w.box((0.0, deep), (-half, half), (hood, hood + band), w.look("wood") if w.chance(0.4) else w.look(shell))
    w.mesh(
        frustum((deep - 0.02, 2 * half - 0.02), (flue, 1.4 * flue), rise, (lean, 0.0)),
        (0.5 * deep, 0.0, hood + band),
        w.look(shell),
    )
    w.box((0.0, flue), (-0.7 * flue, 0.7 * flue), (hood + band + rise, top), w.look(shell))
    if w.chance(0.55):
        for side in BOTH_SIDES:
            y = side * (half - 0.07)
            w.rod((deep - 0.07, y, plinth), (deep - 0.07, y, hood), w.length(0.02, 0.06), w.look(shell))
    else:
        for side in BOTH_SIDES:
            y = side * (half - 0.05)
            w.box((0.0, 0.7 * deep), (y - 0.05, y + 0.05), (plinth, hood), stone)
    logs(w, (0.5 * deep, 0.0, plinth + 0.05), 0.35 * half)
    if w.chance(0.4):
        w.box((0.05, 0.35), (-0.7 * half, 0.7 * half), (0.03, plinth - 0.04), w.look("char"), solid=False)
        w.box((deep, deep + 0.004), (-0.6 * half, 0.6 * half), (0.03, plinth - 0.03), w.look("char"), solid=False)


def glass_corner(w: Workbench) -> None:
    """Builds a modern block whose fire is visible through glass on two or three sides."""
    half, deep, top = 0.5 * w.width(1.10, 1.80), w.length(0.45, 0.65), w.height(2.35, 2.50)
    base, high = w.length(0.25, 0.55), w.length(0.42, 0.60)
    look = w.look("lacquer") if w.chance(0.65) else w.look("stone")
    open_ends = w.whole(1, 2)
    pier = w.length(0.15, 0.45)
    w.box((0.0, deep), (-half, half), (0.0, base), look)
    w.box((0.0, deep), (-half, half), (base + high, top), look)
    w.box((0.0, 0.06), (-half, half), (base, base + high), w.look("char"))
    left = half if open_ends == 2 else half - pier
    if open_ends == 1:
        w.box((0.06, deep), (left, half), (base, base + high), look)
    dark = w.look("dark")
    w.box((0.06, deep - 0.03), (-half + 0.03, left - 0.02), (base, base + 0.025), w.look("char"), solid=False)
    w.box((deep - 0.015, deep - 0.009), (-half + 0.01, left), (base, base + high), w.look("glass"), solid=False)
    for y in (-half + 0.01, half - 0.016)[:open_ends]:
        w.box((0.06, deep - 0.01), (y, y + 0.006), (base, base + high), w.look("glass"), solid=False)
    for z in (base, base + high - 0.03):
        w.box((deep - 0.03, deep + 0.004), (-half, left), (z, z + 0.03), dark, solid=False)
        w.box((0.05, deep), (-half - 0.003, -half + 0.02), (z, z + 0.03), dark, solid=False)
    logs(w, (0.55 * deep, 0.5 * (left - half), base + 0.02), 0.45 * half, burning=0.85)
    if w.chance(0.5):
        reach = half + w.length(0.3, 0.9)
        w.box((0.0, deep + 0.05), (-half, reach), (base - 0.08, base - 0.02), w.look("stone"))
        w.box((0.0, deep), (reach - 0.06, reach), (0.0, base - 0.08), look)


def inglenook(w: Workbench) -> None:
    """Builds a wide walk-in fireplace under a heavy beam, sometimes with benches inside."""
    half, deep, high = 0.5 * w.width(1.70, 2.40), w.length(0.60, 0.85), w.length(1.25, 1.55)
    pier, top = w.length(0.18, 0.32), w.height(1.95, 2.50)
    brick = w.look("masonry") if w.chance(0.7) else w.look("lacquer")
    _fire_chamber(w, (0.0, deep), (-half, half), (0.0, high), pier, brick)
    w.box((0.0, deep), (-half, half), (high, top), brick)
    wood = w.look("wood")
    w.box((deep - 0.12, deep + 0.07), (-half - 0.03, half + 0.03), (high - 0.02, high + w.length(0.18, 0.28)), wood)
    inner = half - pier
    w.box((pier, pier + 0.02), (-0.45 * inner, 0.45 * inner), (0.0, high), w.look("char"), solid=False)
    w.box((pier, deep + w.length(0.0, 0.35)), (-inner, inner), (0.0, 0.05), w.look("stone"))
    for side in BOTH_SIDES[: w.whole(0, 2)]:
        c = side * (inner - 0.15)
        w.box((pier, deep - 0.05), (c - 0.15, c + 0.15), (0.38, 0.43), wood)
        w.box((pier, deep - 0.10), (c - 0.12, c + 0.12), (0.05, 0.38), brick)
    z = 0.05
    if w.chance(0.6):
        iron = w.look("iron")
        z = 0.20
        w.box((pier + 0.05, deep - 0.08), (-0.30, 0.30), (z - 0.03, z), iron)
        for side in BOTH_SIDES:
            w.box((deep - 0.12, deep - 0.09), (side * 0.28 - 0.015, side * 0.28 + 0.015), (0.05, z + 0.22), iron)
            w.box((pier + 0.05, pier + 0.08), (side * 0.28 - 0.015, side * 0.28 + 0.015), (0.05, z + 0.15), iron)
        w.rod((deep - 0.10, -0.30, z + 0.12), (deep - 0.10, 0.30, z + 0.12), 0.012, iron, solid=False)
        for i in range(5):
            y = 0.11 * (i - 2)
            w.rod((deep - 0.10, y, z - 0.01), (deep - 0.10, y, z + 0.12), 0.008, iron, solid=False)
    logs(w, (0.5 * (pier + deep) - 0.02, 0.0, z), 0.22)


def overmantel(w: Workbench) -> None:
    """Builds a Victorian fireplace: an arched iron insert between columns, with a panel or mirror above."""
    half, deep, shelf = 0.5 * w.width(1.25, 1.60), w.length(0.22, 0.32), w.length(1.10, 1.30)
    wood = parts.wood_look(w)
    insert = w.length(0.42, 0.50)
    mouth, spring = w.length(0.19, 0.26), w.length(0.40, 0.55)
    frame_top = w.length(0.90, 1.00)
    iron, tile = w.look("iron"), w.new_look("ceramic") if w.chance(0.5) else w.new_look("paint")
    w.box((0.0, 0.03), (-half, half), (0.0, shelf), w.look("char"))
    for side in BOTH_SIDES:
        y = sorted((side * insert, side * (half - 0.06)))
        w.box((0.03, deep), (y[0], y[1]), (0.0, shelf), wood)
        y = sorted((side * mouth, side * insert))
        w.box((0.03, deep - 0.03), (y[0], y[1]), (0.0, frame_top), iron)
        y = sorted((side * (mouth + 0.06), side * (insert - 0.03)))
        w.box((deep - 0.03, deep - 0.022), (y[0], y[1]), (0.04, frame_top - 0.06), tile, solid=False)
    w.mesh(wall_above_arch((0.03, deep - 0.03), mouth, spring, mouth, frame_top), (0.0, 0.0, 0.0), iron)
    w.box((0.03, deep), (-insert, insert), (frame_top, shelf), wood)
    w.box((0.0, deep + 0.10), (-half, half), (shelf, shelf + 0.045), wood)
    turned = w.chance(0.5)
    for side in BOTH_SIDES:
        y = side * (half - 0.11)
        if turned:
            w.cylinder((deep + 0.03, y), (0.12, shelf), 0.035, wood)
            w.box((deep - 0.01, deep + 0.08), (y - 0.05, y + 0.05), (0.0, 0.12), wood)
        else:
            w.box((deep, deep + 0.05), (y - 0.06, y + 0.06), (0.0, shelf), wood, solid=False)
    w.box((deep - 0.03, deep + w.length(0.28, 0.42)), (-half, half), (0.0, 0.03), w.look("stone"))
    for z in (0.10, 0.16, 0.22):
        w.rod((deep - 0.04, -mouth, z), (deep - 0.04, mouth, z), 0.009, iron, solid=False)
    w.box((0.03, deep - 0.04), (-mouth, mouth), (0.06, 0.10), iron)
    w.ellipsoid((0.5 * deep, 0.0, 0.13), (0.07, 0.8 * mouth, 0.07), w.look("char"))
    if w.chance(0.6):
        flames(w, 0.5 * deep, 0.17, ((-0.3 * mouth, 0.14, 0.04), (0.0, 0.22, 0.05), (0.3 * mouth, 0.16, 0.04)))
    rise = w.length(0.65, 1.05)
    if w.chance(0.75):
        over = half - w.length(0.06, 0.25)
        z = (shelf + 0.045, shelf + 0.045 + rise)
        w.box((0.0, 0.05), (-over, over), z, wood)
        w.box(
            (0.05, 0.056),
            (-over + 0.12, over - 0.12),
            (z[0] + 0.10, z[1] - 0.10),
            w.look("mirror") if w.chance(0.7) else w.look("stone"),
            solid=False,
        )
        w.box((0.0, 0.12), (-over - 0.04, over + 0.04), (z[1], z[1] + 0.06), wood)
        for side in BOTH_SIDES:
            w.rod((0.09, side * (over - 0.05), z[0]), (0.09, side * (over - 0.05), z[1]), 0.025, wood)
    w.top((0.07, deep + 0.06), (-half + 0.05, half - 0.05), shelf + 0.045)


def log_wall(w: Workbench) -> None:
    """Builds a long low bench with a framed fire box and niches of stacked logs."""
    half, deep, bench = 0.5 * w.width(1.60, 2.60), w.length(0.40, 0.55), w.length(0.22, 0.45)
    stone, dark = w.look("stone") if w.chance(0.6) else w.look("lacquer"), w.look("dark")
    box, high = w.length(0.35, 0.50), w.length(0.55, 0.85)
    side = w.choice(BOTH_SIDES)
    c = side * (half - box - w.length(0.05, 0.20))
    w.box((0.0, deep + 0.12), (-half, half), (bench - 0.08, bench), stone)
    w.box((0.0, deep + 0.04), (min(c - box, side * half), max(c + box, side * half)), (0.0, bench - 0.08), stone)
    far = sorted((-side * half, -side * (half - 0.08)))
    w.box((0.0, deep + 0.04), (far[0], far[1]), (0.0, bench - 0.08), stone)
    _fire_chamber(w, (0.0, deep), (c - box, c + box), (bench, bench + high), 0.05, dark)
    w.box((0.0, deep), (c - box, c + box), (bench + high, bench + high + 0.05), dark)
    w.box((0.05, deep - 0.05), (c - box + 0.05, c + box - 0.05), (bench, bench + 0.03), w.look("char"))
    logs(w, (0.5 * deep, c, bench + 0.03), 0.22)
    if w.chance(0.6):
        w.box((0.02, deep - 0.08), (c - 0.6 * box, c + 0.6 * box), (bench + high + 0.05, w.height(2.30, 2.50)), stone)
    else:
        w.box(
            (-0.06, 0.0),
            (-half, half),
            (0.0, w.height(1.40, 2.40)),
            w.look("stone") if w.chance(0.5) else w.look("wood"),
        )
    outer = sorted((c - side * (box + 0.04), -side * (half - 0.10)))
    wide = min(outer[1] - outer[0], w.length(0.45, 0.80))
    y0 = outer[0] if side > 0 else outer[1] - wide
    r = w.length(0.055, 0.075)
    columns = max(2, int((wide - 0.04) / (2 * r)))
    rack = w.chance(0.7)
    rows = min(3 if rack else 2, 20 // columns)
    floor = bench
    if rack:
        tall = 2 * r * rows + 0.05
        for y in (y0, y0 + 0.04 + 2 * r * columns):
            w.box((0.06, deep - 0.02), (y, y + 0.02), (floor, floor + tall), dark)
    for row in range(rows):
        for column in range(columns):
            y = y0 + 0.03 + r * (2 * column + 1)
            w.rod(
                (0.08, y, floor + r * (2 * row + 1)),
                (deep - 0.02 * ((row + column) % 3), y, floor + r * (2 * row + 1)),
                r,
                w.look("wood"),
                solid=False,
            )


def bioethanol(w: Workbench) -> None:
    """Builds a free-standing ethanol fire: flames between glass panes on a low base or legs."""
    half, deep = 0.5 * w.width(0.70, 1.30), w.depth(0.30, 0.45)
    body = w.choice(("dark", "lacquer", "steel", "stone"))
    look, z = w.look(body), w.length(0.10, 0.45)
    if w.chance(0.5):
        w.legs((-0.5 * deep, 0.5 * deep), (-half, half), (0.0, z), 0.03, w.look("metal"))
        if w.chance(0.5):
            w.box((-0.5 * deep, 0.5 * deep), (-half, half), (0.06, 0.08), look)
    else:
        w.box((-0.38 * deep, 0.38 * deep), (-0.85 * half, 0.85 * half), (0.0, z), look)
    w.box((-0.5 * deep, 0.5 * deep), (-half, half), (z, z + 0.07), look)
    z += 0.07
    high, long = w.length(0.30, 0.50), w.length(0.45, 0.75) * half
    w.box((-0.07, 0.07), (-long, long), (z, z + 0.03), w.look("char"))
    count = w.whole(3, 6)
    tongues = [(long * (2 * (i + 0.5) / count - 1), w.length(0.12, 0.26), 0.04) for i in range(count)]
    flames(w, 0.0, z + 0.02, tongues)
    for side in BOTH_SIDES:
        x = side * (0.5 * deep - 0.03)
        w.box((x - 0.004, x + 0.004), (-0.9 * half, 0.9 * half), (z, z + high), w.look("glass"))
    if w.chance(0.6):
        for side in BOTH_SIDES:
            y = side * (half - 0.03)
            w.box((-0.5 * deep, 0.5 * deep), (y - 0.03, y + 0.03), (z, z + high), look)
        w.box((-0.5 * deep, 0.5 * deep), (-half, half), (z + high, z + high + 0.06), look)


def gas_radiant(w: Workbench) -> None:
    """Builds a gas heater of the 1970s: a row of glowing bars behind wires in a stepped surround."""
    half, top, deep = 0.5 * w.width(1.10, 1.60), w.length(0.70, 0.95), w.length(0.14, 0.24)
    tiles = w.chance(0.5)
    look = w.look("masonry") if tiles else parts.wood_look(w)
    steps = w.whole(0, 2)
    w.box((0.0, deep), (-0.5 * half if steps == 2 else -half, 0.5 * half if steps == 2 else half), (0.0, top), look)
    if steps == 2:
        for side in BOTH_SIDES:
            for inner, outer, high in ((0.5, 0.75, 0.8), (0.75, 1.0, 0.6)):
                y = sorted((side * inner * half, side * outer * half))
                w.box((0.0, deep), (y[0], y[1]), (0.0, high * top), look)
                w.box((0.0, deep + 0.03), (y[0], y[1]), (high * top, high * top + 0.025), w.look("wood"))
    reach = 0.5 * half if steps == 2 else half
    w.box((0.0, deep + 0.05), (-reach - 0.02, reach + 0.02), (top, top + 0.04), w.look("wood"))
    w.box((deep, deep + 0.30), (-0.8 * half, 0.8 * half), (0.0, 0.04), w.look("stone") if tiles else look)
    case = w.choice(("brass", "steel", "dark", "wood"))
    wide, high = min(w.length(0.26, 0.34), 0.5 * half - 0.02), w.length(0.48, 0.60)
    front = deep + w.length(0.14, 0.22)
    w.box((deep, front), (-wide, wide), (0.06, high + 0.04), w.look(case))
    w.box((deep, front + 0.02), (-wide - 0.02, wide + 0.02), (high + 0.04, high + 0.07), w.look("wood"))
    w.box((deep, front - 0.03), (-wide + 0.02, wide - 0.02), (0.03, 0.07), w.look("dark"))
    w.box((front, front + 0.003), (-wide + 0.03, wide - 0.03), (0.20, high), w.look("char"), solid=False)
    bars = w.whole(3, 5)
    glow = w.look("fire") if w.chance(0.7) else w.look("ceramic")
    for i in range(bars):
        y = (wide - 0.05) * (2 * (i + 0.5) / bars - 1)
        each = 0.38 * (2 * wide - 0.1) / bars
        w.box((front, front + 0.012), (y - each, y + each), (0.23, high - 0.03), glow, solid=False)
    for i in range(4):
        z = 0.24 + (high - 0.28) * i / 3
        w.rod((front + 0.016, -wide + 0.02, z), (front + 0.016, wide - 0.02, z), 0.004, w.look("chrome"), solid=False)
    w.top((0.03, deep + 0.02), (-reach + 0.03, reach - 0.03), top + 0.04)


def arched_oven(w: Workbench) -> None:
    """Builds a brick or plastered block with an arched mouth, often above an arched log store."""
    half, deep = 0.5 * w.width(0.90, 1.40), w.length(0.50, 0.75)
    look = w.look("masonry") if w.chance(0.6) else w.look("lacquer")
    mouth, store = w.length(0.45, 0.62) * half, w.length(0.0, 0.40) if w.chance(0.6) else 0.0
    shelf = store + w.length(0.30, 0.42) if store else w.length(0.05, 0.35)
    spring = shelf + w.length(0.18, 0.38)
    top = spring + mouth + w.length(0.15, 0.40)
    w.box((0.0, 0.10), (-half, half), (0.0, top), w.look("char"))
    for side in BOTH_SIDES:
        y = sorted((side * mouth, side * half))
        w.box((0.10, deep), (y[0], y[1]), (0.0, top), look)
        c = side * (mouth - 0.004)
        w.box((0.10, deep - 0.03), (c - 0.004, c + 0.004), (0.0, spring), w.look("char"), solid=False)
    w.mesh(wall_above_arch((0.10, deep), mouth, spring, mouth * w.length(0.6, 1.0), top), (0.0, 0.0, 0.0), look)
    if store:
        w.box((0.10, deep), (-mouth, mouth), (shelf - 0.08, shelf), look)
        r = 0.055
        count = int(2 * mouth / (2 * r + 0.005))
        for row in range(min(3, int((shelf - 0.09) / (2 * r)))):
            for i in range(count):
                y, z = (i - 0.5 * (count - 1)) * 2 * r, r + 2 * r * row
                w.rod((0.10, y, z), (deep - 0.04 - 0.02 * ((i + row) % 2), y, z), r, w.look("wood"), solid=False)
    else:
        w.box((0.10, deep), (-mouth, mouth), (0.0, shelf), look)
    w.box(
        (deep - 0.02, deep + w.length(0.10, 0.35)), (-half - 0.02, half + 0.02), (shelf - 0.06, shelf), w.look("stone")
    )
    logs(w, (0.5 * deep, 0.0, shelf), 0.55 * mouth)
    kind = w.whole(0, 2)
    if kind == 0:
        w.mesh(
            _extruded([(-half, top), (half, top), (-0.25 * half, 2.4), (0.25 * half, 2.4)], (0.0, deep - 0.02)),
            (0.0, 0.0, 0.0),
            look,
        )
    elif kind == 1:
        w.box((0.0, 0.7 * deep), (-0.45 * half, 0.45 * half), (top, w.length(2.2, 2.5)), look)
    else:
        w.box((0.0, deep + 0.06), (-half - 0.05, half + 0.05), (top, top + 0.06), w.look("wood"))
        w.top((0.05, deep), (-half, half), top + 0.06)


STYLES: tuple[Style, ...] = (
    Style("fireplace", "kiva", "wide", kiva),
    Style("fireplace", "smoke_hood", "wide", smoke_hood),
    Style("fireplace", "glass_corner", "wide", glass_corner),
    Style("fireplace", "inglenook", "wide", inglenook),
    Style("fireplace", "overmantel", "wide", overmantel),
    Style("fireplace", "log_wall", "wide", log_wall),
    Style("fireplace", "bioethanol", "wide", bioethanol),
    Style("fireplace", "gas_radiant", "wide", gas_radiant),
    Style("fireplace", "arched_oven", "wide", arched_oven),
)
