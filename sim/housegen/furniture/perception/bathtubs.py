"""Bathtubs of the pool `wide`."""

from __future__ import annotations

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.item import Look
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring, drape, loft
from sim.housegen.furniture.workbench import Workbench


def _straight_tub(w: Workbench, x: float, y: float, high: float, rim: float, power: float, look: Look) -> None:
    """Adds a tub with straight outer sides and a rounded hollow with a drain; x and y are half sizes."""
    rings = [
        Ring(0.0, x, y, power=24), Ring(high, x, y, power=24), Ring(high, x - rim, y - rim, power=power),
        Ring(0.5 * high, 0.88 * (x - rim), 0.92 * (y - rim), power=power), Ring(0.14, 0.65 * x, 0.78 * y, power=power),
    ]  # fmt: skip
    w.mesh(loft(rings, 16), (0.0, 0.0, 0.0), look)
    w.cylinder((0.0, 0.55 * y), (0.135, 0.148), 0.03, w.look("chrome"), solid=False)


def platform_tub(w: Workbench) -> None:
    """Builds a tub in a broad tiled or wooden deck with one or two steps in front of it."""
    width, depth, high = w.width(1.70, 2.10), w.length(0.90, 1.20), w.length(0.45, 0.60)
    deck, white, metal = w.look(w.choice(("stone", "masonry", "wood"))), w.look("ceramic"), parts.fitting_look(w)
    x, y, power = 0.5 * depth, 0.5 * width, w.choice((2.3, 4.0, 8.0))
    bx, by = x - w.length(0.10, 0.16), y - w.length(0.14, 0.24)
    w.box((-x, -bx), (-y, y), (0.0, high), deck)
    w.box((bx, x), (-y, y), (0.0, high), deck)
    for side in BOTH_SIDES:
        a, b = sorted((side * by, side * y))
        w.box((-bx, bx), (a, b), (0.0, high), deck)
    _straight_tub(w, bx, by, high + 0.012, 0.05, power, white)
    wide = w.length(0.4, 1.0) * width
    steps = w.whole(1, 2)
    for i in range(steps):
        rise = high * (i + 1) / (steps + 1)
        w.box((x, x + 0.27 * (steps - i)), (-0.5 * wide, 0.5 * wide), (0.0, rise), deck)
    parts.any_tap(w, (-x + 0.05, w.choice((0.0, 0.35)) * width, high), 0.18, w.length(0.10, 0.22), metal)
    if w.chance(0.4):
        for side in BOTH_SIDES:
            w.cylinder((x - 0.06, side * (y - 0.06)), (high, 1.1), 0.02, metal)
        w.rod((x - 0.06, -y + 0.06, 1.1), (x - 0.06, y - 0.06, 1.1), 0.015, metal, solid=False)


def curtain_tub(w: Workbench) -> None:
    """Builds a tub with tiles behind it and at the tap end, a shower pipe and a curtain along its front."""
    width, depth, high = w.width(1.40, 1.75), w.depth(0.70, 0.82), w.length(0.38, 0.56)
    tile, white, metal = w.look(w.choice(("ceramic", "stone", "masonry"))), w.look("ceramic"), parts.fitting_look(w)
    x, y, top = 0.5 * depth, 0.5 * width, w.length(1.85, 2.05)
    _straight_tub(w, x, y, high, 0.06, w.choice((3.0, 5.0)), white)
    back = top + 0.12 if w.chance(0.6) else w.length(0.9, 1.3)
    w.box((-x - 0.02, -x + 0.002), (-y, y), (0.0, back), tile)
    w.box((-x - 0.02, x), (y, y + 0.03), (0.0, top + 0.12), tile)
    w.rod((x - 0.03, -y, top), (x - 0.03, y, top), 0.013, metal)
    if back < top:
        w.rod((x - 0.03, -y + 0.015, high), (x - 0.03, -y + 0.015, top), 0.012, metal)
    else:
        w.rod((-x, -y + 0.015, top), (x - 0.03, -y + 0.015, top), 0.012, metal)
    wide, inside = w.length(0.2, 0.85) * width, w.chance(0.4)
    start, low = w.choice((-y + 0.5 * wide, y - 0.5 * wide)), (high - 0.15 if inside else 0.15)
    look = w.look(w.choice(("curtain", "curtain", "sheer")))
    w.mesh(
        drape(wide, top - low, 0.07, w.whole(6, 11)), (x - 0.09 if inside else x - 0.02, start, low), look, solid=False
    )
    w.rod((0.0, y + 0.005, top - 0.02), (0.0, y - 0.14, top - 0.05), 0.011, metal, solid=False)
    w.rod((0.0, y - 0.13, top - 0.04), (0.0, y - 0.18, top - 0.10), 0.05, metal, solid=False)
    w.rod((0.0, y + 0.005, high + 0.14), (0.0, y - 0.14, high + 0.13), 0.02, metal, solid=False)
    w.rod((0.0, y + 0.005, high + 0.45), (0.0, y - 0.03, high + 0.45), 0.07, metal, solid=False)


def ofuro(w: Workbench) -> None:
    """Builds a short deep soaking tub of boards or stone with a broad rim, and sometimes a cover or a stool."""
    width, depth, high = w.width(0.85, 1.35), w.depth(0.75, 1.00), w.length(0.60, 0.80)
    look = w.look(w.choice(("wood", "wood", "stone")))
    x, y, thick = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width), w.length(0.03, 0.06)
    parts.basin(w, x, y, high, high - 0.04, thick, look)
    for side in BOTH_SIDES:
        w.box((x[0] + 0.02, x[1] - 0.02), (side * 0.3 * width - 0.04, side * 0.3 * width + 0.04), (0.0, 0.045), look)
        a, b = sorted((side * (y[1] + 0.03), side * (y[1] - thick - 0.01)))
        w.box((x[0] - 0.03, x[1] + 0.03), (a, b), (high, high + 0.025), look)
        c, d = sorted((side * (x[1] + 0.03), side * (x[1] - thick - 0.01)))
        w.box((c, d), (y[0] + thick, y[1] - thick), (high, high + 0.025), look)
    if w.chance(0.5):
        for i in range(1, w.whole(3, 5)):
            z = i * high / 5
            w.box(
                (x[0] - 0.006, x[1] + 0.006), (y[0] - 0.006, y[1] + 0.006), (z - 0.004, z + 0.004), parts.darker(look)
            )
    if w.chance(0.5):
        end = y[0] + w.length(0.3, 0.7) * width
        count = max(2, int((end - y[0]) / 0.12))
        for i in range(count):
            a = y[0] + i * 0.12
            w.box((x[0], x[1]), (a, a + 0.112), (high + 0.025, high + 0.045), look)
    else:
        w.box(
            (x[0] + thick, x[1] - thick),
            (y[0] + thick, y[1] - thick),
            (0.7 * high, 0.71 * high),
            w.look("glass"),
            solid=False,
        )
    if w.chance(0.6):
        w.box((x[1] + 0.03, x[1] + 0.31), (-0.24, 0.24), (0.24, 0.28), look)
        for side in BOTH_SIDES:
            w.box((x[1] + 0.02, x[1] + 0.29), (side * 0.2 - 0.02, side * 0.2 + 0.02), (0.0, 0.24), look)
    metal, spout = parts.fitting_look(w), y[1] - 0.2
    w.cylinder((x[0] + 0.012, spout), (high + 0.02, high + 0.16), 0.02, metal, solid=False)
    w.rod((x[0] + 0.012, spout, high + 0.14), (x[0] + 0.19, spout, high + 0.13), 0.016, metal, solid=False)


def walk_in_tub(w: Workbench) -> None:
    """Builds a high narrow tub with a door in its front, a seat at one end, a grab bar and a hand shower."""
    width, depth, high = w.width(1.20, 1.55), w.depth(0.68, 0.82), w.length(0.85, 1.02)
    white, metal = w.look("ceramic"), w.look("chrome")
    x, y, thick = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width), 0.06
    tap_side = w.choice(BOTH_SIDES)
    parts.basin(w, x, y, high, high, thick, white)
    a, b = sorted((-tap_side * (y[1] - thick), -tap_side * (y[1] - 0.48)))
    w.box((x[0] + thick, x[1] - thick), (a, b), (thick, 0.45), white)
    a, b = sorted((tap_side * 0.03, tap_side * (0.03 + w.length(0.42, 0.50))))
    door = w.look(w.choice(("ceramic", "glass", "plastic")))
    w.box((x[1] - 0.01, x[1] + 0.015), (a, b), (0.12, high - 0.03), parts.darker(white, 0.6), solid=False)
    w.box((x[1], x[1] + 0.022), (a + 0.012, b - 0.012), (0.132, high - 0.042), door)
    w.box(
        (x[1] + 0.02, x[1] + 0.045), (tap_side * 0.09 - 0.015, tap_side * 0.09 + 0.015), (0.5, 0.68), metal, solid=False
    )
    w.rod((x[0] + 0.03, -0.2, high + 0.10), (x[0] + 0.03, 0.2, high + 0.10), 0.014, metal)
    for side in BOTH_SIDES:
        w.rod((x[0] + 0.03, side * 0.19, high), (x[0] + 0.03, side * 0.19, high + 0.10), 0.012, metal)
    parts.any_tap(w, (x[0] + 0.03, tap_side * (y[1] - 0.22), high), 0.14, 0.12, metal)
    if w.chance(0.5):
        at = (x[0] + 0.025, tap_side * (y[1] - 0.05))
        w.cylinder(at, (high, high + 0.75), 0.010, metal)
        w.rod((*at, high + 0.6), (at[0] + 0.10, at[1], high + 0.68), 0.014, metal, solid=False)
    if w.chance(0.5):
        for i in range(4):
            w.rod(
                (x[0] + thick - 0.005, 0.12 * i - 0.2, 0.4),
                (x[0] + thick + 0.01, 0.12 * i - 0.2, 0.4),
                0.025,
                metal,
                solid=False,
            )


def screened_tub(w: Workbench) -> None:
    """Builds a tub behind framed sliding panes up to head height, with an apron and a back panel."""
    width, depth, high = w.width(1.45, 1.80), w.depth(0.70, 0.82), w.length(0.42, 0.58)
    white, metal = w.look("ceramic"), w.look(w.choice(("chrome", "dark", "brass")))
    x, y, top = 0.5 * depth, 0.5 * width, w.length(1.75, 2.0)
    _straight_tub(w, x, y, high, 0.06, w.choice((3.0, 5.0)), white)
    apron = w.choice(("masonry", "wood", "stone", "none"))
    if apron != "none":
        w.box((x - 0.005, x + 0.012), (-y, y), (0.0, high - 0.03), w.look(apron))
    count = w.whole(2, 4)
    each = 2 * y / count
    slide = w.chance(0.5)
    for i in range(count):
        front = x - 0.02 - 0.016 * (i % 2)
        a = -y + i * each
        if slide and i == count - 1:
            a -= 0.6 * each
        w.box((front - 0.003, front + 0.003), (a, a + each), (high, top), w.look("glass"))
        for c in (a + 0.012, a + each - 0.012):
            w.box((front - 0.009, front + 0.009), (c - 0.012, c + 0.012), (high, top), metal)
    w.box((x - 0.055, x - 0.005), (-y, y), (top, top + 0.04), metal)
    w.box((x - 0.05, x - 0.01), (-y, y), (high - 0.002, high + 0.02), metal)
    for c in (-y + 0.012, y - 0.012):
        w.box((x - 0.05, x - 0.01), (c - 0.012, c + 0.012), (high, top), metal)
    w.box((-x - 0.02, -x + 0.002), (-y, y), (0.0, top + 0.1), w.look(w.choice(("ceramic", "stone", "masonry"))))
    w.rod((-x, 0.3 * width, 1.85), (-x + 0.22, 0.3 * width, 1.83), 0.011, metal, solid=False)
    w.cylinder((-x + 0.22, 0.3 * width), (1.79, 1.83), 0.09, metal, solid=False)
    w.box((-x, -x + 0.06), (0.3 * width - 0.12, 0.3 * width + 0.12), (high + 0.2, high + 0.25), metal, solid=False)


STYLES: tuple[Style, ...] = (
    Style("bathtub", "platform", "wide", platform_tub),
    Style("bathtub", "curtain", "wide", curtain_tub),
    Style("bathtub", "ofuro", "wide", ofuro),
    Style("bathtub", "walk_in_tub", "wide", walk_in_tub),
    Style("bathtub", "screened", "wide", screened_tub),
)
