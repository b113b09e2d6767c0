"""Clothes of the pool `wide`."""

from __future__ import annotations

import math

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.item import Look, MeshShape
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring, chamfered_box, drape, hoop, loft, named_mesh
from sim.housegen.furniture.workbench import Range, Workbench


def _flat_cloth(outline: list[tuple[float, float]], centre: tuple[float, float], thick: float) -> MeshShape:
    """Returns cloth with a (y, z) outline that is star-shaped about `centre`, where it is thickest.

    The outline runs counter-clockwise seen from +x.
    """
    n = len(outline)
    vertices = [(s * 0.35 * thick, y, z) for s in BOTH_SIDES for y, z in outline]
    vertices += [(s * 0.5 * thick, *centre) for s in BOTH_SIDES]
    faces: list[tuple[int, int, int]] = []
    for i in range(n):
        j = (i + 1) % n
        faces += [(j, i, 2 * n), (n + i, n + j, 2 * n + 1), (i, j, n + j), (i, n + j, n + i)]
    return named_mesh("cloth", vertices, faces)


def _mirrored(right: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Returns the outline of a right half, given from the top down, and its mirror image."""
    return [(-y, z) for y, z in right] + [(y, z) for y, z in reversed(right) if y > 0.0]


def _garment(w: Workbench, kind: str, high: float, thick: float) -> MeshShape:
    """Returns a garment that hangs flat, with its shoulders or waist at z = `high` and its hem at z = 0."""
    h, s = high, w.length(0.9, 1.15)
    if kind == "trousers":
        flare, hip = w.length(-0.03, 0.05), 0.19 * s
        right = [(0.16 * s, h), (hip, 0.72 * h), (hip + flare, 0.0), (0.06 + 0.5 * flare, 0.0)]
        return _flat_cloth(_mirrored([*right, (0.0, 0.66 * h)]), (0.0, 0.8 * h), thick)
    if kind == "skirt":
        right = [(0.14 * s, h), (0.19 * s, 0.7 * h), (w.length(0.18, 0.34) * s, 0.0)]
        return _flat_cloth(_mirrored(right), (0.0, 0.5 * h), thick)
    if kind == "vest":
        right = [(0.06, h - 0.05), (0.09, h), (0.15 * s, h - 0.02), (0.14 * s, h - 0.22), (0.19 * s, h - 0.28)]
        return _flat_cloth(_mirrored([*right, (w.length(0.18, 0.24) * s, 0.0)]), (0.0, h - 0.3), thick)
    hem = {"dress": w.length(0.22, 0.34), "coat": 0.24, "tee": 0.21, "shirt": 0.20}[kind]
    arm = 0.20 if kind == "tee" else min(0.52, 0.85 * h)
    right = [(0.06, h), (0.20 * s, h - 0.05), (0.25 * s + 0.14 * arm, h - arm), (0.16 * s + 0.11 * arm, h - arm - 0.02)]
    right += [
        (0.19 * s, h - min(0.24, 0.6 * arm + 0.05)),
        ((0.15 if kind == "dress" else 0.19) * s, 0.5 * h),
        (hem * s, 0.0),
    ]
    if kind != "tee":
        right[4] = (0.19 * s, h - 0.22)
    return _flat_cloth(_mirrored(right), (0.0, h - 0.16), thick)


_GARMENT_LENGTHS_M = {
    "shirt": (0.62, 0.78),
    "tee": (0.58, 0.72),
    "vest": (0.5, 0.7),
    "dress": (0.8, 1.15),
    "coat": (0.85, 1.1),
    "trousers": (0.9, 1.05),
    "skirt": (0.5, 0.8),
}
"""Shortest and longest usual length of a garment on a hanger, in metres."""


def _garment_look(w: Workbench) -> Look:
    """Returns a new look for a garment."""
    return w.new_look(w.choice(("bright", "bright", "denim", "fabric", "linen")))


def _hanging_row(w: Workbench, x: float, y: Range, rail: float, room: float, metal: Look, most: int) -> None:
    """Adds garments on hangers in a row under a rail, none longer than `room`."""
    count = min(most, max(2, int((y[1] - y[0]) / w.length(0.07, 0.16))))
    for i in range(count):
        kind = w.choice(tuple(_GARMENT_LENGTHS_M))
        high = min(w.length(*_GARMENT_LENGTHS_M[kind]), room - 0.10)
        c = y[0] + (i + 0.5) * (y[1] - y[0]) / count
        turn = 0.5 * math.pi + w.length(-0.25, 0.25)
        w.rod((x, c, rail - 0.08), (x, c, rail + 0.012), 0.003, metal, solid=False)
        shape = _garment(w, kind, high, w.length(0.03, 0.07))
        w.mesh(shape, (x, c, rail - 0.07 - high), _garment_look(w), turn=turn, solid=i % 2 == 0)


def a_frame(w: Workbench) -> None:
    """Builds an A-frame rack with a pole, hanging garments and often a slatted shelf with shoes."""
    width, high, wood = w.width(0.80, 1.40), w.length(1.35, 1.75), w.look(w.choice(("wood", "wood", "lacquer", "iron")))
    y, spread = 0.5 * width, w.length(0.18, 0.30)
    for side in BOTH_SIDES:
        c = side * (y - 0.06)
        for sign in BOTH_SIDES:
            w.bar((sign * spread, c, 0.0), (-sign * 0.05, c + sign * 0.012, high), 0.02, 0.035, wood)
        w.box((-0.8 * spread, 0.8 * spread), (c - 0.01, c + 0.01), (0.17, 0.20), wood)
    rail = high - 0.10
    w.rod((0.0, -y, rail), (0.0, y, rail), 0.014, wood)
    if w.chance(0.7):
        for i in range(4):
            x = (i - 1.5) * 0.45 * spread
            w.box((x - 0.02, x + 0.02), (-y + 0.06, y - 0.06), (0.20, 0.218), wood)
        for i in range(w.whole(0, 3)):
            c, shoe = -y + 0.25 + 0.26 * i, w.new_look("leather")
            for side in BOTH_SIDES:
                w.ellipsoid((0.0, c + 0.05 * side, 0.25), (0.13, 0.042, 0.045), shoe, solid=False)
    _hanging_row(w, 0.0, (-y + 0.16, y - 0.16), rail, rail - 0.32, w.look("metal"), 9)


def double_rail(w: Workbench) -> None:
    """Builds a steel rack on castors with two levels of garments, or one level above a shelf."""
    width, high, metal = w.width(0.70, 1.20), w.length(1.60, 1.85), w.look(w.choice(("metal", "chrome", "iron")))
    y, deep = 0.5 * width, w.length(0.20, 0.26)
    for side in BOTH_SIDES:
        c = side * (y - 0.02)
        w.rod((0.0, c, 0.08), (0.0, c, high), 0.015, metal)
        w.rod((-deep, c, 0.08), (deep, c, 0.08), 0.015, metal)
        for sign in BOTH_SIDES:
            w.ball((sign * (deep - 0.02), c, 0.035), 0.035, w.look("dark"))
    w.rod((0.0, -y, high), (0.0, y, high), 0.015, metal)
    middle = 0.5 * high + 0.06
    if w.chance(0.6):
        w.rod((0.0, -y + 0.02, middle), (0.0, y - 0.02, middle), 0.013, metal)
        _hanging_row(w, 0.0, (-y + 0.10, y - 0.10), middle, middle - 0.1, metal, 6)
    else:
        w.box((-deep, deep), (-y + 0.02, y - 0.02), (0.07, 0.09), metal)
        for i in range(w.whole(1, 3)):
            c = -y + 0.22 + 0.3 * i
            if c < y - 0.15:
                w.mesh(chamfered_box((0.3, 0.26, w.length(0.06, 0.2)), 0.03), (0.0, c, 0.12), _garment_look(w))
    _hanging_row(w, 0.0, (-y + 0.10, y - 0.10), high, high - middle - 0.03, metal, 7)


def dress_form(w: Workbench) -> None:
    """Builds a dressmaker's dummy on a stand, with a dress, a jacket or a shawl."""
    high, stand = w.length(1.35, 1.65), w.look(w.choice(("wood", "iron", "metal")))
    s = w.length(0.9, 1.1)
    for i in range(w.whole(3, 4)):
        a = 2.1 * i if high < 1.5 else math.tau * i / 3
        w.rod((0.0, 0.0, 0.14), (0.24 * math.cos(a), 0.24 * math.sin(a), 0.012), 0.012, stand)
    w.rod((0.0, 0.0, 0.06), (0.0, 0.0, high - 0.05), 0.016, stand)
    top = high - 0.06
    cloth, form = _garment_look(w), w.look("linen")
    body = [
        Ring(top - 0.66, 0.12 * s, 0.17 * s), Ring(top - 0.52, 0.12 * s, 0.18 * s),
        Ring(top - 0.38, 0.09 * s, 0.125 * s),
        Ring(top - 0.18, 0.12 * s, 0.17 * s, 0.01), Ring(top - 0.07, 0.08 * s, 0.18 * s), Ring(top - 0.03, 0.05, 0.06),
        Ring(top + 0.03, 0.045, 0.05),
    ]  # fmt: skip
    kind = w.choice(("dress", "jacket", "shawl"))
    w.mesh(loft(body, 14), (0.0, 0.0, 0.0), form if kind == "shawl" else cloth)
    w.ellipsoid((0.0, 0.0, top + 0.04), (0.045, 0.05, 0.02), stand if kind == "shawl" else form, solid=False)
    if kind == "dress":
        low, flare = w.length(0.25, 0.65), w.length(0.18, 0.32)
        skirt = [Ring(low, flare, flare * 1.1), Ring(0.5 * (low + top) - 0.2, 0.75 * flare, 0.85 * flare)]
        w.mesh(loft([*skirt, Ring(top - 0.40, 0.10 * s, 0.135 * s)], 16), (0.0, 0.0, 0.0), cloth)
    elif kind == "jacket":
        for side in BOTH_SIDES:
            w.rod(
                (0.0, side * 0.19 * s, top - 0.10),
                (0.03, side * 0.25 * s, top - 0.62),
                0.045,
                cloth,
                solid=False,
                round_ends=True,
            )
        coat = [
            Ring(top - 0.80, 0.15 * s, 0.20 * s),
            Ring(top - 0.4, 0.13 * s, 0.18 * s),
            Ring(top - 0.08, 0.09, 0.18 * s),
        ]
        w.mesh(loft(coat, 14), (0.0, 0.0, 0.0), cloth)
        w.box(
            (0.09 * s, 0.145 * s),
            (-0.012, 0.012),
            (top - 0.78, top - 0.12),
            parts.darker(cloth),
            solid=False,
            tilt=-0.05,
        )
    else:
        w.mesh(drape(0.14, 0.5, 0.05, 2), (0.09, 0.10, top - 0.55), cloth, solid=False)
        w.mesh(hoop(0.12, 0.05, 0.09, 14), (0.0, 0.0, top - 0.04), cloth, solid=False)


def drying_tower(w: Workbench) -> None:
    """Builds an upright drying rack of two or three tiers with garments on them."""
    width, deep, tiers = w.width(0.55, 0.80), w.length(0.22, 0.32), w.whole(2, 3)
    metal = w.look(w.choice(("plastic", "steel", "ceramic")))
    high, y = w.length(1.10, 1.55), 0.5 * width
    for side in BOTH_SIDES:
        for x in (-0.4 * deep, 0.4 * deep):
            w.rod((x, side * y, 0.0), (x, side * y, high), 0.011, metal)
    for t in range(tiers):
        z = high - 0.03 - t * (high - 0.25) / tiers
        for side in BOTH_SIDES:
            w.rod((-deep, side * y, z), (deep, side * y, z), 0.009, metal)
        for x in (-deep, 0.0, deep):
            w.rod((x, -y, z), (x, y, z), 0.006, metal)
        room = (high - 0.30) / tiers
        for x in (-deep, deep):
            kind = w.choice(("socks", "over", "shirt", "over", "shirt"))
            c = w.length(-0.08, 0.08)
            if kind == "socks":
                for k in range(w.whole(2, 4)):
                    at = (x, -y + 0.12 + 0.13 * k, z - 0.12)
                    w.mesh(chamfered_box((0.02, 0.075, 0.25), 0.009), at, _garment_look(w), solid=False)
            elif kind == "over":
                parts.towel_over_bar(w, x, c, z, w.length(0.25, 0.42), room, 0.7 * room, _garment_look(w))
            elif kind == "shirt":
                tall = min(0.7, max(0.5, room + 0.15))
                w.mesh(
                    _garment(w, w.choice(("tee", "shirt", "vest")), min(tall, z - 0.02), 0.03),
                    (x, c, z - min(tall, z - 0.02)),
                    _garment_look(w),
                )


def pipe_rail(w: Workbench) -> None:
    """Builds a wall-mounted rail with garments on hangers, with or without a shelf above it."""
    width, out = w.width(0.60, 1.20), w.length(0.22, 0.32)
    metal, tall = w.look(w.choice(("iron", "brass", "metal", "wood"))), w.length(1.00, 1.35)
    w.mount_height_m = w.length(1.70, 1.85) - tall
    y, rail = 0.5 * width, tall - 0.06
    for side in BOTH_SIDES:
        c = side * (y - 0.04)
        w.rod((0.0, c, rail), (0.02, c, rail), 0.045, metal)
        w.rod((0.0, c, rail), (out, c, rail), 0.014, metal)
    w.rod((out, -y, rail), (out, y, rail), 0.014, metal)
    if w.chance(0.5):
        w.box((0.0, out + 0.05), (-y, y), (tall - 0.046, tall - 0.02), w.look("wood"))
        if w.chance(0.6):
            w.mesh(
                chamfered_box((0.26, 0.32, 0.12), 0.03),
                (0.5 * out, w.length(-0.2, 0.2) * width, tall + 0.035),
                _garment_look(w),
            )
    _hanging_row(w, out, (-y + 0.10, y - 0.10), rail, rail, metal, 9)


def hung_flat(w: Workbench) -> None:
    """Builds one or two garments on hangers that hang flat on the wall."""
    count = w.whole(1, 2)
    tall = w.length(0.95, 1.25)
    w.mount_height_m = w.length(1.65, 1.95) - tall
    wood = w.look(w.choice(("wood", "metal", "plastic")))
    for i in range(count):
        y = (i - 0.5 * (count - 1)) * w.length(0.62, 0.75)
        kind = w.choice(("shirt", "tee", "vest", "dress", "coat"))
        high = min(w.length(*_GARMENT_LENGTHS_M[kind]), tall - 0.13)
        top, cloth = tall - 0.13, _garment_look(w)
        w.rod((0.0, y, tall - 0.02), (0.06, y, tall - 0.02), 0.014, wood)
        w.rod((0.045, y, top - 0.02), (0.045, y, tall - 0.01), 0.004, wood, solid=False)
        w.mesh(_garment(w, kind, high, 0.06), (0.045, y, top - high), cloth)
        for side in BOTH_SIDES:
            w.rod((0.045, y, top + 0.02), (0.045, y + side * 0.17, top - 0.045), 0.009, wood, solid=False)
        if kind in ("shirt", "coat"):
            seam = parts.darker(cloth, 0.6)
            w.box((0.06, 0.072), (y - 0.008, y + 0.008), (top - high + 0.03, top - 0.05), seam, solid=False)
            for side in BOTH_SIDES:
                w.box(
                    (0.06, 0.078),
                    (y + side * 0.04 - 0.025, y + side * 0.04 + 0.025),
                    (top - 0.07, top),
                    cloth,
                    solid=False,
                    roll=side * 0.6,
                )


def bathrobe(w: Workbench) -> None:
    """Builds a bathrobe that hangs from a hook by its collar, with a belt and sometimes a hood."""
    tall, metal = w.length(1.05, 1.35), parts.fitting_look(w)
    cloth = w.new_look(w.choice(("towel", "linen", "bright")))
    w.mount_height_m = w.length(1.60, 1.75) - tall
    top = tall - 0.04
    w.box((0.0, 0.012), (-0.03, 0.03), (tall - 0.10, tall), w.look("wood") if w.chance(0.5) else metal)
    w.rod((0.0, 0.0, tall - 0.05), (0.09, 0.0, tall - 0.03), 0.010, metal, round_ends=True)
    s, low = w.length(0.85, 1.2), w.length(0.0, 0.12)
    rings = [
        Ring(low, 0.085, 0.25 * s, 0.09), Ring(0.45 * top, 0.08, 0.20 * s, 0.085),
        Ring(top - 0.22, 0.085, 0.16 * s, 0.09),
        Ring(top - 0.08, 0.06, 0.10 * s, 0.07), Ring(top, 0.025, 0.03, 0.05),
    ]  # fmt: skip
    w.mesh(loft(rings, 12), (0.0, 0.0, 0.0), cloth)
    if w.chance(0.7):
        w.mesh(
            drape(0.36 * s, top - low - 0.25, 0.08, w.whole(2, 4), gather=1.35), (0.10, 0.0, low), cloth, solid=False
        )
    for side in BOTH_SIDES:
        w.rod(
            (0.08, side * 0.12 * s, top - 0.16),
            (0.10, side * 0.21 * s, top - w.length(0.55, 0.75)),
            0.05,
            cloth,
            solid=False,
            round_ends=True,
        )
    if w.chance(0.5):
        w.ellipsoid((0.12, 0.0, top - 0.12), (0.06, 0.11 * s, 0.13), cloth, solid=False)
    belt = parts.darker(cloth, 0.8)
    w.box((0.155, 0.19), (0.02, 0.055), (0.12, 0.6 * top), belt, solid=False)
    w.box((0.155, 0.19), (-0.06, -0.025), (0.22, 0.6 * top), belt, solid=False)
    w.box((0.03, 0.19), (-0.17 * s, 0.17 * s), (0.58 * top, 0.63 * top), belt, solid=False)


def strewn(w: Workbench) -> None:
    """Builds garments that lie flat and apart on the floor, with socks and sometimes shoes."""
    kinds = [w.choice(("shirt", "tee", "coat", "dress")), w.choice(("trousers", "skirt", "trousers"))]
    if w.chance(0.5):
        kinds.append(w.choice(("tee", "vest")))
    for i, kind in enumerate(kinds):
        turn, high = 2.1 * i + w.length(-0.5, 0.5), w.length(0.55, 0.85)
        at = (w.length(0.0, 0.15) * math.cos(turn), w.length(0.0, 0.15) * math.sin(turn), 0.025 + 0.02 * i)
        w.mesh(_garment(w, kind, high, 0.045), at, _garment_look(w), tilt=-0.5 * math.pi, turn=turn, solid=i == 0)
    w.mesh(
        parts.crumpled_cloth(w, w.length(0.3, 0.5), w.length(0.25, 0.4), w.length(0.08, 0.18)),
        (0.0, 0.0, 0.02),
        _garment_look(w),
    )
    for i in range(w.whole(0, 3)):
        a = 1.3 + 1.7 * i
        w.mesh(
            chamfered_box((0.22, 0.08, 0.025), 0.01),
            (0.38 * math.cos(a), 0.38 * math.sin(a), 0.0125),
            _garment_look(w),
            turn=3 * a,
        )
    if w.chance(0.4):
        shoe = w.new_look("leather")
        for side in BOTH_SIDES:
            w.ellipsoid((0.35, -0.30 + 0.07 * side, 0.045), (0.13, 0.045, 0.045), shoe, turn=0.2 * side)


def mound(w: Workbench) -> None:
    """Builds a high heap of laundry from which legs and sleeves stick out."""
    r, high = w.length(0.22, 0.36), w.length(0.16, 0.38)
    core = [Ring(0.0, 0.7 * r, 0.7 * r), Ring(0.45 * high, 0.55 * r, 0.55 * r), Ring(0.7 * high, 0.2 * r, 0.2 * r)]
    w.mesh(loft(core, 10), (0.0, 0.0, 0.0), _garment_look(w))
    for i in range(w.whole(3, 5)):
        a, out = 2.3 * i, 0.2 * r * i
        at = (out * math.cos(a), out * math.sin(a), 0.11 * high * i)
        shape = parts.crumpled_cloth(w, (2.3 - 0.35 * i) * r, (2.0 - 0.3 * i) * r, (0.95 - 0.12 * i) * high)
        w.mesh(shape, at, _garment_look(w), turn=w.length(0.0, 3.0), solid=False)
    for i in range(w.whole(2, 4)):
        a, cloth = 1.6 * i + w.length(0.0, 1.0), _garment_look(w)
        p = (0.4 * r * math.cos(a), 0.4 * r * math.sin(a), 0.6 * high)
        q = (1.25 * r * math.cos(a), 1.25 * r * math.sin(a), 0.04)
        w.bar(p, q, w.length(0.08, 0.14), 0.04, cloth, solid=False)


def sorted_piles(w: Workbench) -> None:
    """Builds two to four piles of folded laundry on the floor."""
    count = w.whole(2, 4)
    for k in range(count):
        x, y, z = 0.17 * (-1) ** k if count > 2 else 0.0, (k - 0.5 * (count - 1)) * w.length(0.28, 0.36), 0.0
        size = (w.length(0.24, 0.34), w.length(0.20, 0.27))
        for i in range(w.whole(2, 5)):
            thick = w.length(0.03, 0.07)
            shape = chamfered_box((size[0] * w.length(0.9, 1.0), size[1] * w.length(0.9, 1.0), thick), 0.016)
            w.mesh(shape, (x, y, z + 0.5 * thick), _garment_look(w), turn=w.length(-0.1, 0.1), solid=i < 2)
            z += thick - 0.003
        if w.chance(0.4):
            for side in BOTH_SIDES:
                w.ellipsoid((x + 0.05 * side, y, z + 0.03), (0.045, 0.045, 0.035), _garment_look(w), solid=False)


def dress_shirts(w: Workbench) -> None:
    """Builds a pile of folded shirts with collars, and sometimes rolled ties beside it."""
    z, deep, wide = 0.0, w.length(0.30, 0.38), w.length(0.22, 0.27)
    count = w.whole(1, 4)
    for i in range(count):
        thick, cloth = w.length(0.025, 0.04), _garment_look(w)
        w.mesh(
            chamfered_box((deep, wide, thick), 0.010), (0.0, 0.0, z + 0.5 * thick), cloth, turn=w.length(-0.05, 0.05)
        )
        z += thick
        if i == count - 1 or w.chance(0.5):
            x = 0.5 * deep - 0.06
            for side in BOTH_SIDES:
                w.box(
                    (x - 0.02, x + 0.05),
                    (side * 0.045 - 0.035, side * 0.045 + 0.035),
                    (z - 0.004, z + 0.010),
                    cloth,
                    turn=side * 0.6,
                    solid=False,
                )
            z += 0.004
    w.box(
        (-0.45 * deep, 0.5 * deep - 0.06),
        (-0.012, 0.012),
        (z - 0.006, z + 0.001),
        parts.darker(w.look("linen"), 0.8),
        solid=False,
    )
    for i in range(w.whole(0, 3)):
        at = (-0.12 + 0.11 * i, 0.5 * wide + 0.06)
        w.cylinder(at, (0.0, 0.05), 0.04, _garment_look(w))
        w.cylinder(at, (0.048, 0.053), 0.015, w.look("dark"), solid=False)


def hat_and_scarf(w: Workbench) -> None:
    """Builds a hat or a knitted cap with a folded or crumpled scarf, and often gloves."""
    felt, r = w.new_look(w.choice(("fabric", "denim", "bright"))), w.length(0.085, 0.10)
    high = w.length(0.08, 0.13)
    if w.chance(0.6):
        brim = r + w.length(0.03, 0.09)
        rings = [
            Ring(0.0, brim * 1.05, brim),
            Ring(0.012, brim * 1.05, brim),
            Ring(0.02, r * 1.1, r),
            Ring(high, 0.9 * r, 0.78 * r),
        ]
        w.mesh(loft([*rings, Ring(high + 0.015, 0.5 * r, 0.4 * r)], 18), (0.0, 0.0, 0.0), felt)
        w.mesh(
            loft([Ring(0.022, r * 1.12, 1.02 * r), Ring(0.045, r * 1.09, 0.99 * r)], 18, hull=True),
            (0.0, 0.0, 0.0),
            w.look("dark"),
        )
    else:
        w.mesh(
            loft(
                [
                    Ring(0.0, r, r),
                    Ring(0.035, 1.04 * r, 1.04 * r),
                    Ring(0.04, 0.95 * r, 0.95 * r),
                    Ring(high, 0.6 * r, 0.6 * r),
                    Ring(high + 0.02, 0.2 * r, 0.2 * r),
                ],
                16,
            ),
            (0.0, 0.0, 0.0),
            felt,
        )
        w.ball((0.0, 0.0, high + 0.035), w.length(0.02, 0.035), _garment_look(w), solid=False)
    scarf = _garment_look(w)
    if w.chance(0.5):
        thick = w.length(0.04, 0.08)
        at = (0.0, 0.27, 0.5 * thick)
        w.mesh(chamfered_box((0.24, 0.16, thick), 0.018), at, scarf, turn=w.length(-0.3, 0.3))
    else:
        w.mesh(parts.crumpled_cloth(w, 0.34, 0.20, 0.08), (0.0, 0.27, 0.0), scarf, turn=w.length(-0.4, 0.4))
    if w.chance(0.6):
        glove = w.new_look("leather")
        for i in range(2):
            x, z = -0.02 + 0.04 * i, 0.012 + 0.015 * i
            w.box((x - 0.06, x + 0.05), (-0.28, -0.20), (z - 0.012, z + 0.012), glove, turn=0.15 * i)
            w.box((x + 0.04, x + 0.12), (-0.275, -0.205), (z - 0.010, z + 0.010), glove, turn=0.15 * i, solid=False)
            w.rod((x, -0.20, z), (x + 0.05, -0.17, z), 0.011, glove, solid=False, round_ends=True)


STYLES: tuple[Style, ...] = (
    Style("clothes", "a_frame", "wide", a_frame, ("rack",)),
    Style("clothes", "double_rail", "wide", double_rail, ("rack",)),
    Style("clothes", "dress_form", "wide", dress_form, ("rack",)),
    Style("clothes", "drying_tower", "wide", drying_tower, ("rack",)),
    Style("clothes", "pipe_rail", "wide", pipe_rail, ("hooks",), "wall"),
    Style("clothes", "hung_flat", "wide", hung_flat, ("hooks",), "wall"),
    Style("clothes", "bathrobe", "wide", bathrobe, ("hooks",), "wall"),
    Style("clothes", "strewn", "wide", strewn, ("floor",)),
    Style("clothes", "mound", "wide", mound, ("floor",)),
    Style("clothes", "sorted_piles", "wide", sorted_piles, ("floor",)),
    Style("clothes", "dress_shirts", "wide", dress_shirts, ("top",), "top"),
    Style("clothes", "hat_and_scarf", "wide", hat_and_scarf, ("top",), "top"),
)
