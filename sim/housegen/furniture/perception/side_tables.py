"""Side, bedside and console tables of the pool `wide`."""

from __future__ import annotations

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.item import Look
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring, chamfered_box, loft
from sim.housegen.furniture.workbench import Range, Workbench


def _crossed_bars(w: Workbench, x: Range, y: float, z: Range, thick: float, look: Look) -> None:
    """Adds two crossed bars in the plane y."""
    w.bar((x[0], y, z[0]), (x[1], y, z[1]), thick, thick, look)
    w.bar((x[1], y + 0.004, z[0]), (x[0], y + 0.004, z[1]), thick, thick, look)


def side_c(w: Workbench) -> None:
    """Builds a C-shaped table that reaches over a sofa."""
    width, depth, height = w.width(0.38, 0.55), w.depth(0.28, 0.42), w.length(0.52, 0.68)
    look, top = w.look(w.choice(("iron", "brass", "chrome"))), w.look(w.choice(("wood", "stone", "glass", "lacquer")))
    x, y = parts.slab(w, depth, width, (height - 0.02, height), top)
    side, tube = w.choice(BOTH_SIDES), w.length(0.015, 0.03)
    edge = side * (0.5 * width - 0.02)
    if w.chance(0.35):
        w.box(x, parts.centred(edge, 0.02), (0.0, height - 0.02), look)
        w.box(x, y, (0.0, 0.015), look)
        return
    for c in (x[0] + 0.03, x[1] - 0.03):
        w.box(parts.centred(c, tube), parts.centred(edge, tube), (0.0, height - 0.02), look)
        w.box(parts.centred(c, tube), y, (0.0, tube), look)
        w.box(parts.centred(c, tube), y, (height - 0.02 - tube, height - 0.02), look)
    w.box((x[0] + 0.03, x[1] - 0.03), parts.centred(edge, tube), (0.0, tube), look)


def side_tray(w: Workbench) -> None:
    """Builds a square or round tray on crossed folding legs."""
    width, depth, height = w.width(0.42, 0.60), w.depth(0.36, 0.46), w.length(0.46, 0.62)
    wood, tray = w.look("wood"), w.look(w.choice(("wood", "lacquer", "brass", "wicker")))
    rim = w.length(0.02, 0.06)
    if w.chance(0.4):
        r = 0.5 * width
        w.mesh(
            loft(
                [
                    Ring(z, r * s, r * s)
                    for z, s in ((height, 0.94), (height + rim, 1.0), (height + rim, 0.95), (height + 0.012, 0.9))
                ],
                20,
            ),
            (0.0, 0.0, 0.0),
            tray,
        )
        depth = 0.85 * width
    else:
        x, y = parts.footprint(depth, width)
        w.box(x, y, (height, height + 0.015), tray)
        for c in x:
            w.box(parts.centred(0.98 * c, 0.012), y, (height + 0.01, height + rim), tray)
        for c in y:
            w.box(x, parts.centred(0.98 * c, 0.012), (height + 0.01, height + rim), tray)
    for c in (-0.32 * width, 0.32 * width):
        _crossed_bars(w, (-0.42 * depth, 0.42 * depth), c, (0.012, height - 0.008), 0.024, wood)
    for sx in BOTH_SIDES:
        for z in (0.1, height - 0.02):
            px = sx * 0.42 * depth * abs(2 * z / height - 1)
            w.rod((px, -0.32 * width, z), (px, 0.32 * width, z), 0.01, wood)
    w.top(parts.centred(0.0, 0.6 * depth), parts.centred(0.0, 0.6 * width), height + 0.015)


def side_column(w: Workbench) -> None:
    """Builds a round table on one central support, such as an hourglass, a barrel or a tulip."""
    radius, height = 0.5 * w.width(0.32, 0.52), w.length(0.44, 0.62)
    look = w.look(w.choice(("ceramic", "lacquer", "wood", "stone", "wicker", "brass")))
    profiles = {
        "hourglass": ((0.0, 0.9), (0.3, 0.62), (0.5, 0.42), (0.7, 0.62), (0.96, 0.95)),
        "barrel": ((0.0, 0.72), (0.2, 0.93), (0.5, 1.0), (0.8, 0.93), (0.96, 0.76)),
        "tulip": ((0.0, 0.65), (0.03, 0.6), (0.12, 0.18), (0.6, 0.1), (0.96, 0.3)),
        "cone": ((0.0, 0.85), (0.1, 0.85), (0.5, 0.55), (0.9, 0.3), (0.96, 0.3)),
        "plate": ((0.0, 0.75), (0.04, 0.75), (0.045, 0.08), (0.9, 0.08), (0.96, 0.08)),
    }
    rings = [Ring(z * height, r * radius, r * radius) for z, r in profiles[w.choice(sorted(profiles))]]
    w.mesh(loft(rings, 18), (0.0, 0.0, 0.0), look)
    parts.round_top(w, radius, (0.95 * height, height), look if w.chance(0.5) else w.look("wood"))


def bedside_tiers(w: Workbench) -> None:
    """Builds a bedside table of two or three drawers, or of drawers or a door below an open niche."""
    width, depth, height = w.width(0.36, 0.60), w.depth(0.34, 0.48), w.length(0.46, 0.70)
    body, front, foot = parts.wood_look(w), parts.wood_look(w), w.length(0.03, 0.14)
    x, y = parts.slab(w, depth, width, (height - 0.02, height), body)
    x, y = (x[0] + 0.01, x[1] - 0.025), (y[0] + 0.01, y[1] - 0.01)
    metal, handle = w.look("metal"), w.choice(("bar", "knob", "cup", "none"))
    full = w.chance(0.5)
    closed = height - 0.02 if full else height - w.length(0.14, 0.22)
    w.box(x, y, (foot, closed), body)
    if full or w.chance(0.4):
        rows = w.whole(2, 3) if full else w.whole(1, 2)
        parts.plain_drawers(w, x[1], y, (foot, closed), rows, 1, front, metal, handle)
    else:
        parts.plain_doors(w, x[1], y, (foot, closed), 1, front, metal, "knob" if handle == "cup" else handle)
    if not full:
        w.box((x[0], x[0] + 0.015), y, (closed, height - 0.02), body)
        for c in (y[0] + 0.009, y[1] - 0.009):
            w.box(x, parts.centred(c, 0.018), (closed, height - 0.02), body)
    if foot < 0.07:
        w.box((x[0] + 0.02, x[1] - 0.03), (y[0] + 0.02, y[1] - 0.02), (0.0, foot), w.look("dark"))
    else:
        w.legs(
            (x[0] + 0.03, x[1] - 0.03),
            (y[0] + 0.03, y[1] - 0.03),
            (0.0, foot + 0.01),
            0.035,
            w.look("wood"),
            round_=True,
        )


def bedside_frame(w: Workbench) -> None:
    """Builds an open bedside rack with one or two shelves, sometimes with a basket."""
    width, depth, height = w.width(0.36, 0.52), w.depth(0.32, 0.44), w.length(0.46, 0.66)
    wood, slats = w.look("wood") if w.chance(0.6) else w.look("iron"), w.chance(0.5)
    x, y = parts.slab(w, depth, width, (height - 0.02, height), w.look("wood"))
    crate, shelves = w.chance(0.4), w.whole(1, 2)
    if crate:
        for side in BOTH_SIDES:
            for i in range(4):
                z = 0.01 + i * (height - 0.02) / 4
                at = parts.centred(side * (0.5 * width - 0.01), 0.014)
                w.box((x[0] + 0.012, x[1] - 0.012), at, (z, z + 0.18 * height), wood)
            for c in (x[0] + 0.01, x[1] - 0.01):
                w.box(
                    parts.centred(c, 0.02),
                    parts.centred(side * (0.5 * width - 0.018), 0.03),
                    (0.0, height - 0.02),
                    wood,
                )
    else:
        w.legs(x, y, (0.0, height - 0.02), w.length(0.02, 0.035), wood)
    for i in range(shelves):
        z = 0.08 + i * 0.5 * (height - 0.1)
        for c in (y[0] + 0.012, y[1] - 0.012):
            w.box((x[0] + 0.005, x[1] - 0.005), parts.centred(c, 0.016), (z - 0.02, z), wood)
        for k in range(4 if slats else 1):
            wide = (depth - 0.01) / (4 if slats else 1)
            a = x[0] + 0.005 + k * wide
            w.box((a, a + (0.7 if slats else 1.0) * wide), (y[0] + 0.004, y[1] - 0.004), (z, z + 0.015), wood)
    if w.chance(0.5):
        tall = w.length(0.10, 0.15)
        size = (depth - 0.08, width - 0.12, tall)
        w.mesh(chamfered_box(size, 0.02), (0.0, 0.0, 0.095 + 0.5 * tall), w.look("wicker"), solid=False)


def console_cross(w: Workbench) -> None:
    """Builds a hall table with frames or crosses at its ends and one or two long shelves."""
    width, depth, height = w.width(0.85, 1.50), w.depth(0.28, 0.42), w.length(0.74, 0.88)
    frame = w.look(w.choice(("iron", "brass", "wood")))
    top, tube = w.look(w.choice(("wood", "stone", "glass"))), w.length(0.02, 0.045)
    x, y = parts.slab(w, depth, width, (height - 0.025, height), top)
    inner, under = (x[0] + 0.01, x[1] - 0.01), height - 0.025
    back = w.chance(0.4)
    for side in BOTH_SIDES:
        c = side * (0.5 * width - 0.01 - 0.5 * tube)
        parts.tube_frame(w, inner, c, (0.0, under), tube, frame)
        if not back:
            _crossed_bars(w, (inner[0] + tube, inner[1] - tube), c, (tube, under - tube), 0.7 * tube, frame)
    if back:
        px = inner[0] + 0.5 * tube
        for sign in BOTH_SIDES:
            a, b = (px, -sign * (0.5 * width - 0.02), 0.03), (px, sign * (0.5 * width - 0.02), under - 0.02)
            w.bar(a, b, 0.6 * tube, 0.6 * tube, frame)
    for i in range(w.whole(1, 2)):
        z = (0.12, 0.45)[i]
        look = top if w.chance(0.7) else frame
        w.box((inner[0] + 0.01, inner[1] - 0.01), (y[0] + 0.02, y[1] - 0.02), (z - 0.012, z + 0.012), look)
    if w.chance(0.4):
        for c in (-0.25, 0.25):
            shape = chamfered_box((0.8 * depth - 0.04, 0.34 * width, 0.22), 0.03)
            w.mesh(shape, (0.0, c * width, 0.132 + 0.11), w.look("wicker"), solid=False)


def console_slabs(w: Workbench) -> None:
    """Builds a heavy narrow table on two slabs, drums, vases or flush sides."""
    width, depth, height = w.width(0.90, 1.60), w.depth(0.30, 0.45), w.length(0.72, 0.88)
    top, kind = w.look(w.choice(("wood", "stone", "lacquer"))), w.choice(("slab", "drum", "vase", "flush"))
    look, thick = w.look(w.choice(("wood", "stone", "lacquer"))), w.length(0.03, 0.08)
    x, y = parts.slab(w, depth, width, (height - thick, height), top)
    under, c = height - thick, w.length(0.26, 0.40) * width
    for side in BOTH_SIDES:
        if kind == "slab":
            w.box((x[0] + 0.03, x[1] - 0.03), parts.centred(side * c, w.length(0.05, 0.16)), (0.0, under), look)
        elif kind == "drum":
            w.cylinder((0.0, side * c), (0.0, under), 0.36 * depth, look)
        elif kind == "vase":
            levels = ((0.0, 0.3), (0.08, 0.36), (0.2, 0.18), (0.55, 0.4), (0.85, 0.22), (1.0, 0.36))
            rings = [Ring(z * under, r * depth, r * depth) for z, r in levels]
            w.mesh(loft(rings, 14), (0.0, side * c, 0.0), look)
        else:
            w.box(x, parts.centred(side * (0.5 * width - 0.5 * thick), thick), (0.0, under), top)
    if kind in ("slab", "flush") and w.chance(0.5):
        z = w.length(0.12, 0.4)
        w.box(
            (x[0] + 0.03, x[1] - 0.03), (y[0] + 0.02, y[1] - 0.02) if kind == "flush" else (-c, c), (z, z + 0.03), look
        )


STYLES: tuple[Style, ...] = (
    Style("table", "side_c", "wide", side_c, ("side",)),
    Style("table", "side_tray", "wide", side_tray, ("side",)),
    Style("table", "side_column", "wide", side_column, ("side",)),
    Style("table", "bedside_tiers", "wide", bedside_tiers, ("nightstand",)),
    Style("table", "bedside_frame", "wide", bedside_frame, ("nightstand",)),
    Style("table", "console_cross", "wide", console_cross, ("console",)),
    Style("table", "console_slabs", "wide", console_slabs, ("console",)),
)
