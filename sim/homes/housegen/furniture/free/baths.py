"""Free-form toilets, sinks, bathtubs and showers of the pool `wide`: lofts of random profiles and random fittings."""

from __future__ import annotations

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.free.bases import LOW, add_base, frame_look
from sim.homes.housegen.furniture.free.details import shower_fittings
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts import BOTH_SIDES
from sim.homes.housegen.furniture.shapes import Ring, chamfered_box, drape, loft
from sim.homes.housegen.furniture.toilets import water_look
from sim.homes.housegen.furniture.workbench import Workbench


def free_toilet(w: Workbench) -> None:
    """Builds a toilet of any pan, seat and cistern."""
    white, half, deep, seat = w.look("ceramic"), 0.5 * w.length(0.34, 0.42), w.length(0.44, 0.56), w.length(0.38, 0.46)
    rim, r, power = seat - 0.03, 0.5 * deep, w.choice((2.0, 2.4, 3.0, 5.0))
    foot, waist, back = w.length(0.5, 0.95), w.length(0.45, 0.95), w.length(0.0, 0.35) * r
    w.mesh(loft([
        Ring(0.0, foot * r, 0.85 * foot * half, -back, power=power),
        Ring(w.length(0.2, 0.5) * rim, waist * r, 0.9 * waist * half, -back, power=power),
        Ring(rim - w.length(0.04, 0.10), 0.97 * r, 0.96 * half, power=power), Ring(rim, r, half, power=power),
        Ring(rim, 0.7 * r, 0.66 * half, 0.02, power=power), Ring(rim - 0.11, 0.5 * r, 0.45 * half, 0.03, power=power),
    ], 16), (0.0, 0.0, 0.0), white)  # fmt: skip
    w.box((-r - 0.04, -0.75 * r), (-0.6 * half, 0.6 * half), (0.0 if w.chance(0.7) else 0.2, rim), white)
    _seat_and_lid(w, r, half, rim, power, white)
    _cistern(w, -r - 0.02, half, rim, white)


def _seat_and_lid(w: Workbench, r: float, half: float, rim: float, power: float, white: Look) -> None:
    """Adds a seat with a lid that is shut, up or missing."""
    cover = white if w.chance(0.75) else w.look(w.choice(("wood", "dark", "plastic")))
    ring = [Ring(0.0, r, half, power=power), Ring(0.02, 0.99 * r, 0.99 * half, power=power)]
    hole = [Ring(0.02, 0.66 * r, 0.64 * half, 0.02, power=power), Ring(0.0, 0.64 * r, 0.62 * half, 0.02, power=power)]
    if w.chance(0.5):
        lid = [*ring, Ring(w.length(0.03, 0.06), 0.93 * r, 0.93 * half, power=power)]
        w.mesh(loft(lid, 16, hull=True), (0.0, 0.0, rim), cover)
        return
    w.ellipsoid((0.03, 0.0, rim - 0.09), (0.5 * r, 0.45 * half, 0.003), water_look(white), solid=False)
    w.mesh(loft([*ring, *hole], 16, loop=True), (0.0, 0.0, rim), cover)
    if w.chance(0.75):
        w.mesh(loft(ring, 16, hull=True), (-r - 0.01, 0.0, rim + r), cover, tilt=-1.5)


def _cistern(w: Workbench, x: float, half: float, rim: float, white: Look) -> None:
    """Adds a close, low or high cistern, a panel, or a thick housing, behind the pan."""
    kind, wide, deep = (
        w.choice(("close", "close", "low", "high", "panel", "housing")),
        w.length(0.34, 0.5),
        w.length(0.13, 0.2),
    )
    tall, metal = w.length(0.28, 0.42), parts.fitting_look(w)
    low = {"low": rim + w.length(0.12, 0.3), "high": w.length(1.2, 1.55)}.get(kind, rim - 0.02)
    if kind == "panel":
        panel = w.look(w.choice(("ceramic", "stone", "wood", "lacquer", "masonry")))
        w.box((x - 0.16, x), (-w.length(0.24, 0.6), w.length(0.24, 0.6)), (0.0, w.length(0.85, 1.25)), panel)
        w.box((x, x + 0.006), (-0.12, 0.12), (0.72, 0.84), metal, solid=False)
        return
    if kind == "housing":
        w.mesh(chamfered_box((0.22, 1.9 * half, 0.16), 0.04), (x + 0.06, 0.0, rim + 0.03), white)
        return
    power, taper = w.choice((2.6, 5.0, 16.0)), w.length(0.85, 1.0)
    body = [
        Ring(0.0, 0.5 * taper * deep, 0.5 * taper * wide, power=power),
        Ring(tall, 0.5 * deep, 0.5 * wide, power=power),
    ]
    w.mesh(loft(body, 16, hull=True), (x - 0.5 * deep + 0.02, 0.0, low), white)
    lid = [Ring(0.0, 0.52 * deep, 0.52 * wide, power=power), Ring(0.025, 0.5 * deep, 0.5 * wide, power=power)]
    w.mesh(
        loft(lid, 16, hull=True), (x - 0.5 * deep + 0.02, 0.0, low + tall), white if w.chance(0.8) else w.look("wood")
    )
    if kind in ("low", "high"):
        w.rod((x - 0.4 * deep, 0.0, rim - 0.1), (x - 0.4 * deep, 0.0, low + 0.02), w.length(0.018, 0.035), metal)
        w.rod((x - 0.4 * deep, 0.0, rim - 0.1), (x + 0.05, 0.0, rim - 0.1), 0.025, metal)
    if kind != "high" and w.chance(0.5):
        w.bar(
            (x + 0.01, 0.3 * wide, low + 0.8 * tall),
            (x + 0.03, 0.1 * wide, low + 0.8 * tall),
            0.015,
            0.015,
            metal,
            solid=False,
        )
    else:
        w.cylinder((x - 0.5 * deep, 0.0), (low + tall + 0.02, low + tall + 0.032), 0.03, metal, solid=False)


def _bowl(w: Workbench, z: float, tall: float, rx: float, ry: float, look: Look) -> None:
    """Adds a bowl of random profile from z up to its rim, and its drain."""
    power, foot, wall = w.choice((2.0, 2.0, 3.0, 5.0, 12.0)), w.length(0.35, 0.95), w.length(0.012, 0.035)
    rings = [Ring(z, foot * rx, foot * ry, power=power)]
    rings.append(Ring(z + 0.5 * tall, min(1.0, w.length(0.6, 1.1)) * rx, 0.5 * (1 + foot) * ry, power=power))
    hollow = parts.hollow_rings(z + tall, rx, ry, 0.8 * tall, wall, power)
    w.mesh(loft([*rings, *hollow], 16), (0.0, 0.0, 0.0), look)
    w.cylinder((0.0, 0.0), (z + 0.2 * tall, z + 0.2 * tall + 0.01), 0.02, w.look("chrome"), solid=False)


def free_vessel(w: Workbench) -> None:
    """Builds a bowl for a washstand, of any outline and profile, with a tap."""
    look, tall = parts.sanitary_look(w), w.length(0.09, 0.17)
    ry = 0.5 * w.length(0.34, 0.56)
    rx = min(ry, 0.5 * w.length(0.30, 0.42))
    _bowl(w, 0.0, tall, rx, ry, look)
    high = tall + w.length(0.08, 0.18)
    parts.any_tap(w, (-rx - 0.035, 0.0, 0.0), 0.13, high, parts.fitting_look(w))


def free_basin(w: Workbench) -> None:
    """Builds a washbasin of any outline on a column, legs, a shelf or a cupboard, with a tap."""
    look, metal, rim = parts.sanitary_look(w), parts.fitting_look(w), w.length(0.80, 0.92)
    wide, deep, tall = w.width(0.42, 0.85), w.depth(0.38, 0.52), w.length(0.12, 0.2)
    rx, ry, low = 0.5 * deep - 0.03, 0.5 * wide, rim - tall
    kind = w.choice(("column", "base", "cupboard", "column"))
    _bowl(w, low, tall, rx, ry, look)
    w.box((-0.5 * deep, -0.25 * deep), (-0.42 * wide, 0.42 * wide), (rim - 0.09, rim + w.choice((0.003, 0.05))), look)
    x, y = (-0.5 * deep, 0.30 * deep), (-0.40 * wide, 0.40 * wide)
    if kind == "column":
        waist = w.length(0.05, 0.11)
        column = [Ring(0.0, waist + w.length(0.0, 0.06), waist + w.length(0.0, 0.06)), Ring(0.5 * low, waist, waist)]
        power = w.choice((2.0, 2.0, 8.0))
        column = [
            Ring(r.z_m, r.rx_m, r.ry_m, power=power) for r in (*column, Ring(low + 0.02, waist + 0.03, waist + 0.03))
        ]
        w.mesh(loft(column, 12), (-0.06, 0.0, 0.0), look)
    elif kind == "base":
        frame, z = frame_look(w), low + 0.02
        w.box(x, y, (z - 0.04, z), frame)
        add_base(w, x, y, z - 0.04, ("square", "round", "taper", "sled", "frame", "panel", "turned"), frame)
        if w.chance(0.5):
            w.box((x[0] + 0.04, x[1] - 0.04), (y[0] + 0.04, y[1] - 0.04), (0.2, 0.22), frame)
            w.rod((0.0, 0.0, 0.21), (0.0, 0.0, low + 0.02), 0.02, metal)
    else:
        body, z0 = parts.wood_look(w), w.choice((0.0, 0.0, 0.08))
        w.box(x, y, (z0, low + 0.03), body)
        if z0:
            add_base(w, x, y, z0, LOW, body)
        grip = w.choice(("bar", "knob", "none"))
        parts.styled_doors(w, x[1], y, (z0 + 0.01, low), w.whole(1, 2), body, metal, w.choice(("flat", "frame")), grip)
    parts.any_tap(w, (-0.36 * deep, 0.0, rim), 0.13, w.length(0.08, 0.18), metal)


def free_bathtub(w: Workbench) -> None:
    """Builds a bathtub of any outline and profile: on feet, on the floor or in a box, with a tap."""
    wide, deep, high = w.width(1.40, 1.80), w.depth(0.68, 0.85), w.length(0.48, 0.64)
    look = w.look(w.choice(("ceramic", "ceramic", "ceramic", "stone", "metal", "wood")))
    metal, x, y, power = parts.fitting_look(w), 0.5 * deep, 0.5 * wide, w.choice((2.3, 3.0, 4.5, 8.0))
    kind, lift = w.choice(("feet", "floor", "floor", "box")), 0.0
    outside = "ceramic" if kind == "box" else ""
    if kind == "feet":
        lift = w.length(0.06, 0.16)
        add_base(
            w, (-0.7 * x, 0.7 * x), (-0.75 * y, 0.75 * y), lift + 0.03, ("splay", "turned", "taper", "plinth"), metal
        )
    foot, rise = w.length(0.7, 0.95), w.choice((0.0, 0.0, w.length(0.04, 0.14)))
    if outside:
        panel = w.look(w.choice(("ceramic", "stone", "masonry", "wood", "lacquer")))
        for side in BOTH_SIDES:
            w.box((-x, x), parts.on_side(side, y - 0.07, y), (0.0, high), panel)
            w.box(parts.on_side(side, x - 0.05, x), (-y + 0.07, y - 0.07), (0.0, high), panel)
    inner = [Ring(high, x, y, power=power), Ring(high + 0.015, 0.99 * x, 0.99 * y, power=power)]
    wall = w.length(0.03, 0.07)
    hollow = [(high + 0.015, 1.0), (0.5 * high, 0.9), (lift + 0.13, 0.75)]
    rings = [
        Ring(lift, foot * x, foot * y, power=power),
        Ring(0.5 * (lift + high), w.length(0.82, 1.0) * x, 0.94 * y, power=power),
    ]
    if outside:
        rings = [Ring(0.02, 0.85 * x, 0.85 * y, power=power), Ring(high - 0.02, 0.9 * x, 0.9 * y, power=power)]
        inner = [Ring(high, x + 0.01, y + 0.01, power=24), Ring(high + 0.015, x + 0.01, y + 0.01, power=24)]
    rings += inner + [Ring(z, s * (x - wall), s * (y - wall), power=power) for z, s in hollow]
    w.mesh(loft(rings, 20 if not outside else 16), (0.0, 0.0, 0.0), look)
    if rise:
        back = [Ring(high, 0.9 * x, 0.05, power=4), Ring(high + rise, 0.6 * x, 0.03, power=4)]
        w.mesh(loft(back, 12, hull=True), (0.0, 0.93 * y if not outside else y - 0.03, 0.0), look)
    w.cylinder((0.0, -0.5 * y), (lift + 0.125, lift + 0.137), 0.03, w.look("chrome"), solid=False)
    if kind != "box" and w.chance(0.4):
        tap = w.length(0.75, 1.05)
        w.cylinder((-x - 0.05, 0.0), (0.0, tap), 0.018, metal)
        w.rod((-x - 0.05, 0.0, tap), (-0.6 * x, 0.0, tap - 0.03), 0.014, metal, solid=False, round_ends=True)
    else:
        parts.any_tap(w, (-x + 0.02, w.choice((0.0, 0.3)) * wide, high + 0.01), 0.15, w.length(0.1, 0.2), metal)


def free_shower(w: Workbench) -> None:
    """Builds a shower of any tray, walls, screens, door or curtain; closed at its back and at smallest y."""
    wide, deep, high = w.width(0.80, 1.30), w.depth(0.80, 1.10), w.length(1.90, 2.15)
    metal, tile = (
        parts.fitting_look(w),
        w.look(w.choice(("ceramic", "stone", "masonry", "glass", "tiles", "plastic")[:4])),
    )
    x, y, tray = *parts.footprint(deep, wide), w.choice((0.015, 0.04, 0.08, 0.15))
    w.box(x, y, (0.0, tray), w.look(w.choice(("ceramic", "ceramic", "stone", "plastic"))))
    rim = w.length(0.03, 0.07)
    if tray > 0.05:
        for edge in (x[0], x[1] - rim):
            w.box((edge, edge + rim), y, (tray, tray + 0.03), w.look("ceramic"))
    w.box((x[0], x[0] + 0.025), y, (0.0, high), tile)
    side = tile if w.chance(0.6) else w.look("glass")
    w.box((x[0] + 0.025, x[1]), (y[0], y[0] + (0.025 if side is tile else 0.008)), (0.0, high), side)
    _screens(w, x, y, tray, high, metal)
    shower_fittings(w, x[0] + 0.025, w.length(-0.2, 0.2) * wide, tray, metal)


def _screens(
    w: Workbench, x: tuple[float, float], y: tuple[float, float], low: float, high: float, metal: Look
) -> None:
    """Adds what closes the front and the other side: panes with bars, a half-open door, curtains, or a short screen."""
    kind, frame = (
        w.choice(("panes", "panes", "door", "curtain", "short")),
        w.look(w.choice(("chrome", "dark", "brass", "ceramic"))),
    )
    glass, t, face = w.look("glass"), w.length(0.008, 0.02), x[1] - 0.03
    if kind == "curtain":
        w.rod((face, y[0], high - 0.06), (face, y[1], high - 0.06), 0.012, metal)
        w.rod((x[0], y[1] - 0.03, high - 0.06), (face, y[1] - 0.03, high - 0.06), 0.012, metal)
        cloth, share = w.look("curtain"), w.length(0.35, 0.95)
        span = share * (y[1] - y[0])
        cloth_mesh = drape(span, high - 0.16, 0.06, w.whole(5, 9))
        w.mesh(cloth_mesh, (face - 0.015, y[0] + 0.5 * span, 0.1), cloth, solid=False)
        return
    end = y[0] + w.length(0.45, 0.7) * (y[1] - y[0]) if kind == "short" else y[1]
    w.box((face - 0.004, face + 0.004), (y[0], end), (low, high), glass)
    for z in (low + t, high - t):
        w.box((face - t, face + t), (y[0], end), (z - t, z + t), frame)
    columns, rows = w.choice(((1, 1), (2, 1), (3, 1), (2, 3), (1, 4), (3, 4)))
    for i in range(columns + 1):
        c = y[0] + t + i * (end - y[0] - 2 * t) / columns
        w.box((face - t, face + t), (c - 0.7 * t, c + 0.7 * t), (low, high), frame)
    for i in range(1, rows):
        z = low + i * (high - low) / rows
        w.box((face - 0.7 * t, face + 0.7 * t), (y[0], end), (z - 0.6 * t, z + 0.6 * t), frame, solid=False)
    if kind in ("panes", "door"):
        w.box((x[0], face), (y[1] - 0.008, y[1]), (low, high), glass)
        w.box((x[0], face), (y[1] - 2 * t, y[1]), (high - 2 * t, high), frame)
        at = y[0] + w.length(0.55, 0.9) * (y[1] - y[0])
        w.rod((face + 0.035, at, 0.95), (face + 0.035, at, 1.25), 0.012, metal, solid=False)
        for z in (0.98, 1.22):
            w.rod((face, at, z), (face + 0.035, at, z), 0.008, metal, solid=False)
    elif kind == "short":
        w.rod((x[0], end - 0.01, high - 0.02), (face, end - 0.01, high - 0.02), 0.012, frame)


STYLES: tuple[Style, ...] = (
    Style("toilet", "free_toilet", "wide", free_toilet),
    Style("sink", "free_vessel", "wide", free_vessel, ("vessel",), "top"),
    Style("sink", "free_basin", "wide", free_basin, ("standing",)),
    Style("bathtub", "free_bathtub", "wide", free_bathtub),
    Style("shower", "free_shower", "wide", free_shower),
)
