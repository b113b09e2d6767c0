"""Free-form beds, cushions, towels and clothes of the pool `wide`."""

from __future__ import annotations

import math

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.free import garments
from sim.homes.housegen.furniture.free.backs import add_back
from sim.homes.housegen.furniture.free.bases import LOW, add_base, frame_look
from sim.homes.housegen.furniture.free.bedding import bedding, mattress_size
from sim.homes.housegen.furniture.free.garments import hanging_row, towel_look
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts import BOTH_SIDES
from sim.homes.housegen.furniture.shapes import Ring, chamfered_box, loft
from sim.homes.housegen.furniture.workbench import Workbench


def free_bed(w: Workbench) -> None:
    """Builds a bed of any base, headboard and footboard, sometimes with posts or a canopy."""
    length, width = mattress_size(w)
    frame, cloth = frame_look(w, 0.2), parts.upholstery_look(w, 0.3)
    base, thick, over = w.length(0.22, 0.38), w.length(0.16, 0.28), w.length(0.0, 0.05)
    half, rail = 0.5 * width + over, w.length(0.05, 0.2)
    body = w.choice((frame, frame, cloth))
    foot = base - min(rail, base - 0.03) if w.chance(0.85) else 0.0
    w.box((-0.02, length + over), (-half, half), (foot, base), body)
    if foot:
        add_base(w, (0.0, length + over), (-half, half), foot, LOW, frame)
    bedding(w, 0.0, length, width, base + thick, thick, w.choice((0.12, 0.25, thick + 0.05)))
    rise = w.length(0.35, 0.95)
    if w.chance(0.9):
        wide = half + w.choice((0.0, 0.0, w.length(0.0, 0.12)))
        add_back(w, -0.025, wide, (base, base + rise), w.length(0.0, 0.06), frame, cloth)
    if w.chance(0.3):
        add_back(w, length + over + 0.02, half, (base, base + w.length(0.25, 0.45)), 0.0, frame, cloth)
    if w.chance(0.15):
        _posts(w, length + over, half, w.length(1.0, 2.0), frame)


def _posts(w: Workbench, length: float, half: float, high: float, look: Look) -> None:
    """Adds four posts, joined by rails if they are tall."""
    t = w.length(0.03, 0.07)
    for x in (-0.02 - 0.5 * t, length + 0.5 * t):
        for side in BOTH_SIDES:
            w.box(parts.centred(x, t), parts.centred(side * half, t), (0.0, high), look)
        if high > 1.5:
            w.box(parts.centred(x, 0.7 * t), (-half, half), (high - t, high), look)
    if high > 1.5:
        for side in BOTH_SIDES:
            w.box((-0.02, length), parts.centred(side * half, 0.7 * t), (high - t, high), look)


def _cushion_body(w: Workbench, wide: float, tall: float, thick: float, cloth: Look, trim: Look, lean: float) -> None:
    """Adds a stuffed body of any outline that stands on its edge and leans by `lean`, with bands or buttons."""
    power, seam = w.choice((2.0, 3.0, 4.5, 4.5, 8.0)), w.length(0.35, 0.8)
    levels = ((-1.0, seam), (-0.55, 0.5 * (1 + seam)), (0.0, 1.0), (0.55, 0.5 * (1 + seam)), (1.0, seam))
    rings = [Ring(0.5 * z * thick, 0.5 * s * tall, 0.5 * s * wide, power=power) for z, s in levels]
    at = (0.0, 0.0, 0.5 * tall * abs(math.sin(lean)) + 0.5 * seam * thick * abs(math.cos(lean)))
    w.mesh(loft(rings, 16, hull=True), at, cloth, tilt=lean)
    pattern = w.choice(("plain", "plain", "band", "edge", "button"))
    if pattern == "band":
        share, shift = w.length(0.1, 0.35), w.length(-0.2, 0.2) * wide
        band = [Ring(1.03 * r.z_m, 0.99 * r.rx_m, share * r.ry_m, 0.0, shift, power=8) for r in rings]
        w.mesh(loft(band, 12, hull=True), at, trim, tilt=lean, solid=False)
    elif pattern == "edge":
        edge = [Ring(z, 0.51 * tall, 0.51 * wide, power=power) for z in (-0.006, 0.006)]
        w.mesh(loft(edge, 16, hull=True), at, trim, tilt=lean, solid=False)
    elif pattern == "button":
        w.ellipsoid(
            (at[0] + 0.5 * thick * math.sin(lean), 0.0, at[2] + 0.5 * thick * math.cos(lean)),
            (0.02, 0.02, 0.02),
            trim,
            solid=False,
        )


def free_throw(w: Workbench) -> None:
    """Builds one or two throw cushions of any outline and pattern, leaning or flat."""
    wide = w.length(0.34, 0.62)
    tall = wide * w.choice((1.0, 1.0, w.length(0.5, 0.9)))
    lean = w.length(0.9, 1.35) if w.chance(0.75) else 0.0
    _cushion_body(w, wide, tall, w.length(0.10, 0.20), w.look("bright"), w.new_look("bright"), lean)
    if lean == 0.0 and w.chance(0.2):
        w.rod((0.0, -0.4 * wide, 0.16), (0.0, 0.4 * wide, 0.16), 0.08, w.new_look("fabric"))


def free_floor_cushion(w: Workbench) -> None:
    """Builds a floor cushion of any outline, flat, sometimes two in a pile or one bolster on top."""
    wide, thick, power = w.length(0.48, 0.78), w.length(0.09, 0.2), w.choice((2.0, 3.5, 6.0, 12.0))
    deep, seam = wide * w.choice((1.0, 1.0, w.length(0.65, 0.95))), w.length(0.7, 0.95)
    z = 0.0
    for i in range(w.choice((1, 1, 2))):
        levels = ((0.0, seam), (0.3, 1.0), (0.7, 1.0), (1.0, seam))
        rings = [Ring(s * thick, 0.5 * g * deep, 0.5 * g * wide, power=power) for s, g in levels]
        cloth = w.new_look("bright") if i or w.chance(0.6) else w.look("fabric")
        w.mesh(loft(rings, 16, hull=True), (0.0, 0.0, z), cloth, turn=0.3 * i)
        z += thick - 0.005
    if w.chance(0.3):
        w.rod(
            (-0.25 * deep, -0.35 * wide, z + 0.07), (-0.25 * deep, 0.35 * wide, z + 0.07), 0.075, w.new_look("bright")
        )


def free_towel_rail(w: Workbench) -> None:
    """Builds one to four wall bars, a ladder or a ring rail with towels of any size."""
    wide, count, metal = (
        w.width(0.35, 0.80),
        w.whole(1, 4),
        w.look(w.choice(("chrome", "brass", "dark", "wood", "iron"))),
    )
    gap, out = w.length(0.16, 0.42), w.length(0.06, 0.12)
    low = w.length(0.25, 0.5)
    tall = low + (count - 1) * gap + 0.03
    w.mount_height_m = max(0.05, w.length(1.15, 1.7) - tall)
    r, post = w.length(0.006, 0.014), w.length(0.006, 0.02)
    upright = count > 1 and w.chance(0.6)
    for i in range(count):
        z = tall - 0.02 - i * gap
        w.rod((out, -0.5 * wide, z), (out, 0.5 * wide, z), r, metal)
        for side in BOTH_SIDES:
            w.rod((0.0, side * (0.5 * wide - 0.02), z), (out, side * (0.5 * wide - 0.02), z), post, metal)
        if i == 0 or w.chance(0.65):
            span = w.length(0.4, 0.9) * wide
            drop = min(w.length(0.2, 0.7), z)
            y = w.length(-0.5, 0.5) * (wide - span - 0.06)
            parts.towel_over_bar(w, out, y, z, span, drop, w.length(0.4, 1.0) * drop, towel_look(w))
    if upright:
        for side in BOTH_SIDES:
            w.rod((out, side * (0.5 * wide - 0.02), 0.0), (out, side * (0.5 * wide - 0.02), tall), post, metal)


def free_towel_stack(w: Workbench) -> None:
    """Builds a stack of folded towels, rolled ones, or both."""
    deep, wide, z = w.length(0.2, 0.34), w.length(0.26, 0.5), 0.0
    same = towel_look(w) if w.chance(0.5) else None
    for _ in range(w.whole(1, 5)):
        thick = w.length(0.03, 0.09)
        size = (deep * w.length(0.85, 1.0), wide * w.length(0.85, 1.0), thick)
        w.mesh(
            chamfered_box(size, 0.4 * thick),
            (0.0, 0.0, z + 0.5 * thick),
            same or towel_look(w),
            turn=w.length(-0.08, 0.08),
        )
        z += thick - 0.003
    for i in range(w.choice((0, 0, 1, 2, 3))):
        r = w.length(0.035, 0.055)
        y = (i - 1) * 0.12 * wide / 0.4
        w.rod((-0.4 * deep, y, z + r - 0.003), (0.4 * deep, y, z + r - 0.003), r, same or towel_look(w))


def free_rack(w: Workbench) -> None:
    """Builds a clothes rack of any frame with garments, and often a shelf or boxes below them."""
    wide, high, look = w.width(0.75, 1.4), w.length(1.4, 1.8), frame_look(w, 0.6)
    y, spread, r = 0.5 * wide, w.length(0.18, 0.28), w.length(0.011, 0.02)
    kind = w.choice(("posts", "a", "box", "arch"))
    for side in BOTH_SIDES:
        c = side * (y - 0.05)
        if kind == "a":
            for sign in BOTH_SIDES:
                w.rod((sign * spread, c, 0.0), (-0.03 * sign, c, high + 0.03), r, look)
        elif kind == "box":
            parts.tube_frame(w, (-spread, spread), c, (0.0, high), 2 * r, look)
        else:
            w.rod((0.0, c, 0.0), (0.0, c, high), r, look)
            w.rod((-spread, c, r), (spread, c, r), r, look)
    w.rod((0.0, -y, high - r), (0.0, y, high - r), r, look)
    low = 0.02
    if w.chance(0.6):
        low = w.length(0.08, 0.3)
        for i in range(4):
            x = (i - 1.5) * 0.4 * spread
            w.box(parts.centred(x, 0.05), (-y + 0.03, y - 0.03), (low - 0.02, low), look)
        for side in BOTH_SIDES:
            w.rod((-spread, side * (y - 0.05), low - 0.02), (spread, side * (y - 0.05), low - 0.02), r, look)
        for i in range(w.whole(0, 3)):
            size = (0.26, w.length(0.16, 0.24), w.length(0.08, 0.2))
            at = (0.0, -y + 0.2 + 0.28 * i, low + 0.5 * size[2])
            w.mesh(chamfered_box(size, 0.015), at, w.new_look(w.choice(("cardboard", "leather", "fabric"))))
        low += 0.2
    hanging_row(w, 0.0, (-y + 0.1, y - 0.1), high - r, high - low - 0.1, w.look("metal"), 9)


def free_heap(w: Workbench) -> None:
    """Builds clothes on the floor: crumpled and flat garments in a heap, or around a basket of any shape."""
    basket = w.chance(0.5)
    r, z = w.length(0.18, 0.28), 0.0
    if basket:
        high, power, taper = w.length(0.25, 0.55), w.choice((2.0, 3.0, 10.0)), w.length(0.75, 1.0)
        rings = [
            Ring(0.0, taper * r, taper * r, power=power),
            *parts.hollow_rings(high, r, r, 0.3 * high, 0.012, power),
        ]
        w.mesh(loft(rings, 16), (0.0, 0.0, 0.0), w.look(w.choice(("wicker", "plastic", "linen", "metal"))))
        z = 0.72 * high
    for i in range(w.whole(2, 5)):
        a, size = 2.4 * i + w.length(0.0, 1.0), w.length(1.2, 1.9) * r * (0.85 if basket else 1.3)
        out = 0.15 * r if basket else w.length(0.0, 0.6) * r
        rise = w.length(0.1, 0.22)
        shape = parts.crumpled_cloth(w, size, w.length(0.7, 1.0) * size, rise)
        w.mesh(shape, (out * math.cos(a), out * math.sin(a), z), garments.garment_look(w), turn=a, solid=not basket)
        z += 0.03


def free_folded(w: Workbench) -> None:
    """Builds one to three piles of folded clothes of any height."""
    piles = w.whole(1, 3)
    for k in range(piles):
        z, y = 0.0, (k - 0.5 * (piles - 1)) * 0.27
        for _ in range(w.whole(1, 5)):
            thick = w.length(0.02, 0.06)
            size = (w.length(0.22, 0.3), w.length(0.18, 0.26), thick)
            w.mesh(chamfered_box(size, 0.4 * thick), (0.0, y, z + 0.5 * thick), garments.garment_look(w))
            z += thick - 0.002


def free_hooks(w: Workbench) -> None:
    """Builds a wall rail or single hooks of any spacing with garments and bags."""
    wide, count, look = w.width(0.45, 1.2), w.whole(2, 5), frame_look(w)
    tall, out = w.length(0.95, 1.2), w.length(0.05, 0.1)
    w.mount_height_m = w.length(1.6, 1.8) - tall
    board = w.length(0.03, 0.14)
    w.box((0.0, 0.018), (-0.5 * wide, 0.5 * wide), (tall - board, tall), look)
    if w.chance(0.35):
        w.box((0.0, w.length(0.15, 0.26)), (-0.5 * wide, 0.5 * wide), (tall, tall + 0.02), look)
    metal = w.look(w.choice(("brass", "dark", "chrome", "wood")))
    for i in range(count):
        y = wide * ((i + 0.5) / count - 0.5)
        z = tall - 0.5 * board
        w.rod((0.01, y, z), (out, y, z + 0.02), 0.008, metal)
        if i and w.chance(0.25):
            continue
        kind = w.choice(tuple(garments.LENGTHS_M))
        high = min(w.length(*garments.LENGTHS_M[kind]), z - 0.005)
        shape = garments.garment(w, kind, high, w.length(0.05, 0.1))
        w.mesh(shape, (out - 0.01, y, z - high + 0.01), garments.garment_look(w), turn=w.length(-0.2, 0.2))


STYLES: tuple[Style, ...] = (
    Style("bed", "free_bed", "wide", free_bed),
    Style("cushion", "free_throw", "wide", free_throw, ("throw",), "top"),
    Style("cushion", "free_floor", "wide", free_floor_cushion, ("floor",)),
    Style("towel", "free_rail", "wide", free_towel_rail, ("rail",), "wall"),
    Style("towel", "free_stack", "wide", free_towel_stack, ("top",), "top"),
    Style("clothes", "free_rack", "wide", free_rack, ("rack",)),
    Style("clothes", "free_heap", "wide", free_heap, ("floor",)),
    Style("clothes", "free_folded", "wide", free_folded, ("top",), "top"),
    Style("clothes", "free_hooks", "wide", free_hooks, ("hooks",), "wall"),
)
