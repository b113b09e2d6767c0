"""Kitchen counters and islands of the pool `wide`."""

from __future__ import annotations

import math

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.item import Look
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring, chamfered_box, loft
from sim.housegen.furniture.workbench import Range, Workbench

_Hole = tuple[Range, Range] | None


def _cupboard_body(w: Workbench, x: Range, y: Range, z: Range, look: Look, hole: _Hole) -> None:
    """Adds the body of the cupboards, which is lower below a sink."""
    if hole is None:
        w.box(x, y, z, look)
        return
    hy0, hy1 = hole[1]
    w.box(x, (y[0], hy0), z, look)
    w.box(x, (hy1, y[1]), z, look)
    w.box(x, (hy0, hy1), (z[0], z[1] - 0.16), look)
    w.box((x[1] - 0.04, x[1]), (hy0, hy1), (z[1] - 0.16, z[1]), look)


def _framed_front(w: Workbench, x: float, y: Range, z: Range, look: Look, knob: Look, *, raised: bool) -> None:
    """Adds a framed door with a knob; its panel is darker, or `raised` inside a darker line."""
    w.box((x, x + 0.02), (y[0] + 0.004, y[1] - 0.004), (z[0] + 0.004, z[1] - 0.004), look, solid=False)
    rim = min(0.06, 0.28 * (z[1] - z[0]))
    w.box((x + 0.019, x + 0.022), (y[0] + rim, y[1] - rim), (z[0] + rim, z[1] - rim), parts.darker(look, 0.7))
    if raised:
        rim += 0.012
        w.box((x + 0.02, x + 0.025), (y[0] + rim, y[1] - rim), (z[0] + rim, z[1] - rim), look, solid=False)
    w.ball((x + 0.03, y[1] - 0.035, 0.5 * (z[0] + z[1]) + 0.2 * (z[1] - z[0])), 0.014, knob, solid=False)


def _upstand(w: Workbench, x: float, y: Range, z: float, look: Look) -> None:
    """Adds a strip of the worktop's material along the wall with a probability of 0.6."""
    if w.chance(0.6):
        w.box((x, x + 0.02), y, (z, z + w.choice((0.06, 0.12, 0.30))), look)


def shaker_run(w: Workbench) -> None:
    """Builds a country kitchen run with framed doors, end posts and a thick overhanging worktop."""
    width, depth, height = w.width(1.10, 2.80), w.depth(0.60, 0.66), w.height(0.86, 0.94)
    body, thick = parts.wood_look(w), w.length(0.03, 0.06)
    top = w.look("wood") if w.chance(0.5) else w.look("stone")
    x, y = parts.footprint(depth, width)
    hole, free = parts.worktop_fittings(w, y, height)
    under, face, foot = height - thick, x[1] - 0.05, w.length(0.07, 0.15)
    _cupboard_body(w, (x[0], face), (y[0] + 0.01, y[1] - 0.01), (foot, under), body, hole)
    parts.worktop(w, x, y, (under, height), top, hole)
    _upstand(w, x[0], y, height, top)
    if w.chance(0.5):
        w.box((x[0], face - 0.06), (y[0] + 0.02, y[1] - 0.02), (0.0, foot), w.look("dark"))
    for side in BOTH_SIDES:
        w.box(
            (face - 0.05, face + 0.025),
            parts.on_side(side, 0.5 * width - 0.075, 0.5 * width - 0.01),
            (0.0, under),
            body,
        )
        w.box((x[0], x[0] + 0.06), parts.on_side(side, 0.5 * width - 0.07, 0.5 * width - 0.01), (0.0, foot), body)
    count = min(5 if hole is None else 4, max(1, round((width - 0.15) / w.length(0.48, 0.85))))
    each, knob = (width - 0.15) / count, w.look(w.choice(("brass", "iron", "wood")))
    split = under - 0.02 if w.chance(0.4) or count > 3 or hole else under - 0.19
    for i in range(count):
        span = (y[0] + 0.075 + i * each, y[0] + 0.075 + (i + 1) * each)
        _framed_front(w, face, span, (foot + 0.02, split), body, knob, raised=hole is None)
        if split < under - 0.1:
            w.box(
                (face, face + 0.02),
                (span[0] + 0.004, span[1] - 0.004),
                (split + 0.01, under - 0.015),
                body,
                solid=False,
            )
            w.ellipsoid((face + 0.02, 0.5 * (span[0] + span[1]), under - 0.1), (0.022, 0.045, 0.017), knob, solid=False)
    for span in free:
        w.top((x[0] + 0.05, x[1] - 0.05), (span[0] + 0.05, span[1] - 0.05), height)


def masonry_run(w: Workbench) -> None:
    """Builds a kitchen run with thick masonry piers and plank doors set back between them."""
    width, depth, height = w.width(1.20, 2.80), w.depth(0.60, 0.68), w.height(0.84, 0.92)
    wall = w.look("masonry") if w.chance(0.6) else w.look("stone")
    wood, thick = w.look("wood"), w.length(0.06, 0.11)
    x, y = parts.footprint(depth, width)
    hole, free = parts.worktop_fittings(w, y, height)
    under, back = height - thick, x[1] - 0.10
    _cupboard_body(w, (x[0], back), y, (0.0, under), wall, hole)
    parts.worktop(w, x, y, (under, height), w.look("stone") if w.chance(0.6) else wall, hole)
    _upstand(w, x[0], y, height, wall)
    pier = w.length(0.08, 0.16)
    count = max(1, round((width - pier) / w.length(0.55, 0.95)))
    each, ledge = (width - pier) / count, w.choice((0.05, 0.10, 0.16))
    planks, iron = w.whole(1, 2), w.look("iron")
    for i in range(count + 1):
        w.box((back, x[1] - 0.02), (y[0] + i * each, y[0] + i * each + pier), (0.0, under), wall)
    w.box((back, x[1] - 0.03), y, (0.0, ledge), wall)
    for i in range(count):
        left, wide = y[0] + i * each + pier + 0.012, each - pier - 0.024
        for k in range(planks):
            span = (left + k * wide / planks + 0.004, left + (k + 1) * wide / planks - 0.004)
            w.box((back, back + 0.025), span, (ledge + 0.015, under - 0.02), wood, solid=False)
        w.box(
            (back + 0.02, back + 0.035),
            (left + 0.05, left + wide - 0.05),
            parts.centred(ledge + 0.75 * (under - ledge), 0.04),
            iron if planks == 2 else wood,
            solid=False,
        )
    for span in free:
        w.top((x[0] + 0.05, x[1] - 0.05), (span[0] + 0.05, span[1] - 0.05), height)


def hovering_run(w: Workbench) -> None:
    """Builds a slim wall-hung run with shallow drawers and a thin worktop."""
    width, depth, height = w.width(1.20, 3.00), w.depth(0.60, 0.64), w.height(0.86, 0.94)
    front, top = parts.wood_look(w), w.look(w.choice(("stone", "steel", "wood")))
    x, y = parts.footprint(depth, width)
    hole, free = parts.worktop_fittings(w, y, height)
    under, face, low = height - 0.02, x[1] - 0.03, w.length(0.24, 0.45)
    _cupboard_body(w, (x[0], face), y, (low, under), front, hole)
    parts.worktop(w, x, y, (under, height), top, hole)
    _upstand(w, x[0], y, height, top)
    w.box((x[0], x[0] + 0.04), y, (0.0, low), w.look("dark") if w.chance(0.5) else front)
    if w.chance(0.4):
        w.box(
            (x[0] + 0.06, face), parts.on_side(w.choice(BOTH_SIDES), 0.5 * width - 0.06, 0.5 * width), (0.0, low), front
        )
    if w.chance(0.4):
        w.box((face - 0.05, face - 0.03), (y[0] + 0.05, y[1] - 0.05), (low - 0.012, low), w.look("glow"), solid=False)
    rows = 1 if low > 0.38 else w.whole(1, 2)
    columns = min(4 if hole is None else 3, max(1, round(width / w.length(0.6, 1.1))))
    handle = w.choice(("none", "bar", "knob"))
    parts.plain_drawers(w, face, y, (low, under - 0.015), rows, columns, front, w.look("metal"), handle)
    for span in free:
        w.top((x[0] + 0.05, x[1] - 0.05), (span[0] + 0.05, span[1] - 0.05), height)


def niche_run(w: Workbench) -> None:
    """Builds a run of tall narrow doors with open shelves at one end, on round feet."""
    width, depth, height = w.width(1.20, 2.60), w.depth(0.60, 0.64), w.height(0.86, 0.92)
    body, front = parts.wood_look(w), parts.wood_look(w)
    x, y = parts.footprint(depth, width)
    side, open_ = w.choice(BOTH_SIDES), w.length(0.28, 0.45) if width > 1.15 else 0.0
    closed = (y[0], y[1] - open_) if side > 0 else (y[0] + open_, y[1])
    hole, free = parts.worktop_fittings(w, closed, height)
    under, face, foot = height - 0.04, x[1] - 0.04, w.length(0.06, 0.14)
    top = w.look("stone")
    _cupboard_body(w, (x[0], face), closed, (foot, under), body, hole)
    parts.worktop(w, x, y, (under, height), top, hole)
    _upstand(w, x[0], y, height, top)
    for cx in (x[0] + 0.05, face - 0.05):
        for cy in (y[0] + 0.05, y[1] - 0.05):
            w.cylinder((cx, cy), (0.0, foot), 0.025, w.look("metal"))
    count = max(1, round((closed[1] - closed[0]) / w.length(0.38, 0.6)))
    count = min(count, 5 if hole is None else 4)
    handle = w.choice(("bar", "knob", "none")) if count < 4 else "none"
    parts.plain_doors(w, face, closed, (foot, under), count, front, w.look("metal"), handle)
    if open_:
        near, far = 0.5 * width - open_, 0.5 * width
        w.box((x[0], face), parts.on_side(side, far - 0.02, far), (foot, under), body)
        w.box((x[0], x[0] + 0.02), parts.on_side(side, near, far - 0.02), (foot, under), body)
        shelves = w.whole(2, 3)
        for i in range(shelves):
            z = foot + i * (under - foot) / shelves
            w.box((x[0] + 0.02, face), parts.on_side(side, near, far - 0.02), (z, z + 0.02), body)
            if w.chance(0.6):
                look = w.look("wicker") if w.chance(0.5) else w.new_look("plastic")
                size = (face - x[0] - 0.10, open_ - 0.06, w.length(0.10, 0.17))
                at = (0.5 * (x[0] + face), side * 0.5 * (near + far - 0.02), z + 0.02 + 0.5 * size[2])
                w.mesh(chamfered_box(size, 0.015), at, look, solid=False)
    for span in free:
        w.top((x[0] + 0.05, x[1] - 0.05), (span[0] + 0.05, span[1] - 0.05), height)


def oval_island(w: Workbench) -> None:
    """Builds an island with a rounded footprint, smooth or fluted, whose top overhangs at the front."""
    width, depth, height = w.width(1.40, 2.40), w.depth(0.85, 1.05), w.height(0.88, 0.94)
    body, top, power = parts.wood_look(w), w.look("stone"), w.choice((2.4, 4.0, 6.0))
    thick, rx, ry = w.length(0.02, 0.06), 0.5 * depth, 0.5 * width
    under = height - thick
    bx, by = rx - 0.15, ry - w.length(0.06, 0.14)
    ring = [Ring(z, bx, by, x_m=-0.12, power=power) for z in (0.0, under)]
    w.mesh(loft(ring, 40, hull=True), (0.0, 0.0, 0.0), body)
    w.mesh(loft([Ring(z, rx, ry, power=power) for z in (under, height)], 40, hull=True), (0.0, 0.0, 0.0), top)
    if w.chance(0.5):
        base = [Ring(z, bx + 0.012, by + 0.012, x_m=-0.12, power=power) for z in (0.0, 0.08)]
        w.mesh(loft(base, 40, hull=True), (0.0, 0.0, 0.0), w.look("brass") if w.chance(0.4) else w.look("dark"))
    if w.chance(0.6):
        for i in range(20):
            angle = math.tau * i / 20
            c, s = math.cos(angle), math.sin(angle)
            reach = (abs(c) ** power + abs(s) ** power) ** (-1.0 / power)
            px, py = bx * reach * c - 0.12, by * reach * s
            w.rod((px, py, 0.08), (px, py, under), 0.016, body, solid=False)
    w.top((-0.55 * rx, 0.55 * rx), (-0.55 * ry, 0.55 * ry), height)


def post_island(w: Workbench) -> None:
    """Builds a farmhouse island whose overhanging top stands on posts at the front corners."""
    width, depth, height = w.width(1.30, 2.40), w.depth(0.90, 1.15), w.height(0.88, 0.94)
    body, top = parts.wood_look(w), w.look("wood") if w.chance(0.6) else w.look("stone")
    x, y = parts.footprint(depth, width)
    thick, post = w.length(0.035, 0.07), w.length(0.06, 0.11)
    under, wall = height - thick, x[1] - w.length(0.30, 0.42)
    w.box(x, y, (under, height), top)
    w.box((x[0] + 0.04, wall), (y[0] + 0.05, y[1] - 0.05), (0.09, under), body)
    w.box((x[0] + 0.08, wall - 0.04), (y[0] + 0.09, y[1] - 0.09), (0.0, 0.09), w.look("dark"))
    turned = w.chance(0.6)
    for side in BOTH_SIDES:
        at = (x[1] - 0.05 - 0.5 * post, side * (0.5 * width - 0.05 - 0.5 * post))
        if turned:
            levels = ((0.0, 0.32), (0.08, 0.42), (0.12, 0.26), (0.45, 0.5), (0.62, 0.28), (0.66, 0.5), (under, 0.5))
            w.mesh(loft([Ring(z, post * r, post * r) for z, r in levels], 12), (*at, 0.0), body)
        else:
            w.box(parts.centred(at[0], post), parts.centred(at[1], post), (0.0, under), body)
        w.box((wall, at[0]), parts.centred(at[1], 0.03), (under - 0.09, under), body)
    w.box(parts.centred(x[1] - 0.05 - 0.5 * post, 0.03), (y[0] + 0.1, y[1] - 0.1), (under - 0.09, under), body)
    count = max(2, round(width / 0.7))
    each = (width - 0.1) / count
    for i in range(count):
        span = (y[0] + 0.05 + i * each, y[0] + 0.05 + (i + 1) * each)
        if w.chance(0.5):
            w.box((wall, wall + 0.012), (span[0] + 0.06, span[1] - 0.06), (0.17, under - 0.12), body, solid=False)
        else:
            a, b = (wall + 0.01, span[0] + 0.06, 0.16), (wall + 0.01, span[1] - 0.06, under - 0.12)
            w.bar(a, b, 0.05, 0.02, body, solid=False)
            w.bar((a[0], a[1], b[2]), (a[0], b[1], a[2]), 0.05, 0.02, body, solid=False)
    metal = w.look("iron")
    parts.plain_drawers(
        w, x[0] + 0.04 - parts.FRONT_M, (y[0] + 0.05, y[1] - 0.05), (0.1, under), w.whole(1, 3), 2, body, metal, "none"
    )
    w.top((x[0] + 0.1, x[1] - 0.1), (y[0] + 0.1, y[1] - 0.1), height)


def table_island(w: Workbench) -> None:
    """Builds an island that continues at one end as a lower dining table."""
    width, depth, height = w.width(1.60, 2.60), w.depth(0.75, 1.0), w.height(0.88, 0.94)
    body, top, board = parts.wood_look(w), w.look("stone"), w.look("wood")
    x = parts.centred(0.0, depth)
    side, split = w.choice(BOTH_SIDES), w.length(0.45, 0.6) * width
    near, far = 0.5 * width - split, 0.5 * width
    block, low = parts.on_side(side, -far, near), w.length(0.72, 0.78)
    bx = (x[0] + 0.02, x[1] - 0.04)
    w.box((bx[0] + 0.04, bx[1] - 0.06), (block[0] + 0.04, block[1] - 0.04), (0.0, 0.09), w.look("dark"))
    w.box(bx, (block[0] + 0.01, block[1] - 0.01), (0.09, height - 0.03), body)
    w.box(x, block, (height - 0.03, height), top)
    count = max(1, round((block[1] - block[0]) / 0.55))
    span = (block[0] + 0.01, block[1] - 0.01)
    if w.chance(0.5):
        parts.plain_drawers(w, bx[1], span, (0.09, height - 0.04), w.whole(2, 3), count, body, w.look("metal"), "bar")
    else:
        parts.plain_doors(
            w, bx[1], span, (0.09, height - 0.04), count, body, w.look("metal"), w.choice(("bar", "knob"))
        )
    inset = w.choice((0.0, 0.06, 0.12))
    tx, thick = (x[0] + inset, x[1] - inset), w.length(0.025, 0.06)
    w.box(tx, parts.on_side(side, near - 0.02, far), (low - thick, low), board)
    if w.chance(0.4):
        w.box((tx[0] + 0.06, tx[1] - 0.06), parts.on_side(side, far - 0.12, far - 0.08), (0.0, low - thick), board)
    else:
        leg = w.length(0.03, 0.07)
        for lx in (tx[0] + 0.04, tx[1] - 0.04 - leg):
            w.box((lx, lx + leg), parts.on_side(side, far - 0.04 - leg, far - 0.04), (0.0, low - thick), w.look("iron"))
    w.top((x[0] + 0.08, x[1] - 0.08), (block[0] + 0.08, block[1] - 0.08), height)
    w.top((tx[0] + 0.08, tx[1] - 0.08), parts.on_side(side, near + 0.06, far - 0.08), low)


STYLES: tuple[Style, ...] = (
    Style("counter", "shaker_run", "wide", shaker_run, ("run",)),
    Style("counter", "masonry_run", "wide", masonry_run, ("run",)),
    Style("counter", "hovering_run", "wide", hovering_run, ("run",)),
    Style("counter", "niche_run", "wide", niche_run, ("run",)),
    Style("counter", "oval_island", "wide", oval_island, ("island",)),
    Style("counter", "post_island", "wide", post_island, ("island",)),
    Style("counter", "table_island", "wide", table_island, ("island",)),
)
