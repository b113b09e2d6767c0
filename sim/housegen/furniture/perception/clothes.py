"""Clothes on racks and hooks, of the pool `wide`."""

from __future__ import annotations

import math

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.item import Look
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.perception import garments
from sim.housegen.furniture.shapes import Ring, chamfered_box, drape, hoop, loft
from sim.housegen.furniture.workbench import Range, Workbench


def hanging_row(w: Workbench, x: float, y: Range, rail: float, room: float, metal: Look, most: int) -> None:
    """Adds garments on hangers in a row under a rail, none longer than `room`."""
    count = min(most, max(2, int((y[1] - y[0]) / w.length(0.07, 0.16))))
    for i in range(count):
        kind = w.choice(tuple(garments.LENGTHS_M))
        high = min(w.length(*garments.LENGTHS_M[kind]), room - 0.10)
        c = y[0] + (i + 0.5) * (y[1] - y[0]) / count
        turn = 0.5 * math.pi + w.length(-0.25, 0.25)
        w.rod((x, c, rail - 0.08), (x, c, rail + 0.012), 0.003, metal, solid=False)
        shape = garments.garment(w, kind, high, w.length(0.03, 0.07))
        w.mesh(shape, (x, c, rail - 0.07 - high), garments.garment_look(w), turn=turn, solid=i % 2 == 0)


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
    hanging_row(w, 0.0, (-y + 0.16, y - 0.16), rail, rail - 0.32, w.look("metal"), 9)


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
        hanging_row(w, 0.0, (-y + 0.10, y - 0.10), middle, middle - 0.1, metal, 6)
    else:
        w.box((-deep, deep), (-y + 0.02, y - 0.02), (0.07, 0.09), metal)
        for i in range(w.whole(1, 3)):
            c = -y + 0.22 + 0.3 * i
            if c < y - 0.15:
                w.mesh(chamfered_box((0.3, 0.26, w.length(0.06, 0.2)), 0.03), (0.0, c, 0.12), garments.garment_look(w))
    hanging_row(w, 0.0, (-y + 0.10, y - 0.10), high, high - middle - 0.03, metal, 7)


def dress_form(w: Workbench) -> None:
    """Builds a dressmaker's dummy on a stand, with a dress, a jacket or a shawl."""
    high, stand = w.length(1.35, 1.65), w.look(w.choice(("wood", "iron", "metal")))
    s = w.length(0.9, 1.1)
    for i in range(w.whole(3, 4)):
        a = 2.1 * i if high < 1.5 else math.tau * i / 3
        w.rod((0.0, 0.0, 0.14), (0.24 * math.cos(a), 0.24 * math.sin(a), 0.012), 0.012, stand)
    w.rod((0.0, 0.0, 0.06), (0.0, 0.0, high - 0.05), 0.016, stand)
    top = high - 0.06
    cloth, form = garments.garment_look(w), w.look("linen")
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
                    w.mesh(chamfered_box((0.02, 0.075, 0.25), 0.009), at, garments.garment_look(w), solid=False)
            elif kind == "over":
                parts.towel_over_bar(w, x, c, z, w.length(0.25, 0.42), room, 0.7 * room, garments.garment_look(w))
            elif kind == "shirt":
                tall = min(0.7, max(0.5, room + 0.15))
                w.mesh(
                    garments.garment(w, w.choice(("tee", "shirt", "vest")), min(tall, z - 0.02), 0.03),
                    (x, c, z - min(tall, z - 0.02)),
                    garments.garment_look(w),
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
                garments.garment_look(w),
            )
    hanging_row(w, out, (-y + 0.10, y - 0.10), rail, rail, metal, 9)


def hung_flat(w: Workbench) -> None:
    """Builds one or two garments on hangers that hang flat on the wall."""
    count = w.whole(1, 2)
    tall = w.length(0.95, 1.25)
    w.mount_height_m = w.length(1.65, 1.95) - tall
    wood = w.look(w.choice(("wood", "metal", "plastic")))
    for i in range(count):
        y = (i - 0.5 * (count - 1)) * w.length(0.62, 0.75)
        kind = w.choice(("shirt", "tee", "vest", "dress", "coat"))
        high = min(w.length(*garments.LENGTHS_M[kind]), tall - 0.13)
        top, cloth = tall - 0.13, garments.garment_look(w)
        w.rod((0.0, y, tall - 0.02), (0.06, y, tall - 0.02), 0.014, wood)
        w.rod((0.045, y, top - 0.02), (0.045, y, tall - 0.01), 0.004, wood, solid=False)
        w.mesh(garments.garment(w, kind, high, 0.06), (0.045, y, top - high), cloth)
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


STYLES: tuple[Style, ...] = (
    Style("clothes", "a_frame", "wide", a_frame, ("rack",)),
    Style("clothes", "double_rail", "wide", double_rail, ("rack",)),
    Style("clothes", "dress_form", "wide", dress_form, ("rack",)),
    Style("clothes", "drying_tower", "wide", drying_tower, ("rack",)),
    Style("clothes", "pipe_rail", "wide", pipe_rail, ("hooks",), "wall"),
    Style("clothes", "hung_flat", "wide", hung_flat, ("hooks",), "wall"),
    Style("clothes", "bathrobe", "wide", bathrobe, ("hooks",), "wall"),
)
