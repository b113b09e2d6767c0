"""Toilets of the pool `wide`."""

from __future__ import annotations

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.item import Look
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring, chamfered_box, frustum, loft, named_mesh
from sim.housegen.furniture.toilets import water_look
from sim.housegen.furniture.workbench import Workbench


def _bowl_and_seat(
    w: Workbench, x0: float, x1: float, half: float, seat: float, look: Look, *, low: float = 0.0
) -> None:
    """Adds a pan from x0 to its front end x1, on a foot or hung at the height `low`, with its seat and lid."""
    middle, r, power = 0.5 * (x0 + x1), 0.5 * (x1 - x0), w.choice((2.0, 2.3, 3.2))
    base, waist = w.choice(((0.62, 0.55), (0.9, 0.85), (0.75, 0.5), (0.95, 0.97)))
    if low:
        base, waist = 0.45, 0.75
    back = middle - (1 - base) * r * w.length(0.4, 1.0)
    rim = seat - 0.04
    w.mesh(loft([
        Ring(low, base * r, 0.9 * base * half, back, power=power),
        Ring(low + 0.45 * (rim - low), waist * r, 0.95 * waist * half, back, power=power),
        Ring(rim - 0.07, 0.97 * r, 0.96 * half, middle, power=power),
        Ring(rim, r, half, middle, power=power),
        Ring(rim, 0.68 * r, 0.66 * half, middle + 0.03, power=power),
        Ring(rim - 0.10, 0.5 * r, 0.45 * half, middle + 0.03, power=power),
    ], 16), (0.0, 0.0, 0.0), look)  # fmt: skip
    cover = look if w.chance(0.75) else w.look(w.choice(("wood", "dark", "plastic")))
    state = w.choice(("shut", "shut", "lid up", "both up", "no lid"))
    ring = [Ring(0.0, r, half, power=power), Ring(0.022, 0.99 * r, 0.99 * half, power=power)]
    hole = [Ring(0.022, 0.66 * r, 0.64 * half, 0.02, power=power), Ring(0.0, 0.64 * r, 0.62 * half, 0.02, power=power)]
    if state != "shut":
        at = (middle + 0.03, 0.0, rim - 0.085)
        w.ellipsoid(at, (0.5 * r, 0.45 * half, 0.003), water_look(look), solid=False)
    if state == "shut":
        lid = [*ring, Ring(0.045, 0.95 * r, 0.95 * half, power=power)]
        w.mesh(loft(lid, 16, hull=True), (middle, 0.0, rim), cover)
    elif state != "both up":
        w.mesh(loft([*ring, *hole], 16, loop=True), (middle, 0.0, rim), cover)
    if state == "both up":
        w.mesh(loft([*ring, *hole], 16, loop=True), (x0 + 0.045, 0.0, rim + r), cover, tilt=-1.5)
    if state in ("lid up", "both up"):
        w.mesh(loft(ring, 16, hull=True), (x0 + 0.015, 0.0, rim + r), cover, tilt=-1.5)


def bidet(w: Workbench) -> None:
    """Builds a bidet: a low pan without seat or cistern, with a small tap."""
    half, depth, rim = 0.5 * w.length(0.34, 0.40), w.length(0.50, 0.60), w.length(0.36, 0.42)
    white, power, r = w.look("ceramic"), w.choice((2.2, 3.0, 6.0)), 0.5 * depth
    base = w.choice((0.55, 0.75, 0.96))
    w.mesh(loft([
        Ring(0.0, base * r, base * half, -0.06 * (1 - base), power=power),
        Ring(0.5 * rim, 0.96 * base * r, 0.9 * base * half, -0.06 * (1 - base), power=power),
        Ring(rim - 0.05, r, half, power=power), Ring(rim, r, half, power=power),
        Ring(rim, 0.70 * r, 0.80 * half, 0.06, power=2.2), Ring(rim - 0.12, 0.45 * r, 0.5 * half, 0.05, power=2.2),
    ], 16), (0.0, 0.0, 0.0), white)  # fmt: skip
    w.box((-r, -r + 0.12), (-0.7 * half, 0.7 * half), (0.0 if base > 0.7 else 0.1, rim - 0.01), white)
    metal = parts.fitting_look(w)
    w.cylinder((0.05, 0.0), (rim - 0.122, rim - 0.115), 0.025, metal, solid=False)
    parts.any_tap(w, (-r + 0.08, 0.0, rim - 0.005), 0.11, w.length(0.07, 0.12), metal)


def squat(w: Workbench) -> None:
    """Builds a squat toilet in a raised step, with a cistern and pipe or a bucket."""
    width, depth, step = w.length(0.60, 0.90), w.length(0.75, 1.0), w.length(0.12, 0.28)
    white, base = w.look("ceramic"), w.look(w.choice(("stone", "masonry", "ceramic")))
    x, y = parts.footprint(depth, width)
    px, py, c = 0.5 * w.length(0.48, 0.58), w.length(0.10, 0.14), 0.04
    w.mesh(loft([
        Ring(0.0, x[1], y[1], power=24), Ring(step, x[1], y[1], power=24), Ring(step, px + 0.05, py + 0.12, c, power=5),
    ], 16, hull=True), (0.0, 0.0, 0.0), base)  # fmt: skip
    w.mesh(loft([
        Ring(step - 0.01, px + 0.05, py + 0.12, c, power=5), Ring(step + 0.015, px + 0.05, py + 0.12, c, power=5),
        Ring(step + 0.015, px, py, c, power=2.6), Ring(step + 0.002, 0.8 * px, 0.6 * py, c, power=2.6),
    ], 16), (0.0, 0.0, 0.0), white)  # fmt: skip
    w.ellipsoid((c, 0.0, step + 0.003), (0.8 * px, 0.6 * py, 0.004), w.look("screen"), solid=False)
    for side in BOTH_SIDES:
        for i in range(3):
            a, b = sorted((side * (py + 0.02), side * (py + 0.10)))
            w.box((-0.10 + 0.07 * i, -0.06 + 0.07 * i), (a, b), (step + 0.012, step + 0.024), white, solid=False)
    if w.chance(0.6):
        hood = loft(
            [Ring(0.0, 0.10, py), Ring(0.07, 0.09, 0.9 * py, 0.01), Ring(0.11, 0.05, 0.6 * py, 0.03)], 12, hull=True
        )
        w.mesh(hood, (c + px - 0.05, 0.0, step + 0.01), white)
    if w.chance(0.65):
        z = w.length(0.75, 1.2)
        w.mesh(chamfered_box((0.16, 0.40, 0.34), 0.03), (x[0] + 0.08, 0.0, z + 0.17), white)
        w.rod((x[0] + 0.05, 0.0, step), (x[0] + 0.05, 0.0, z), 0.018, parts.fitting_look(w))
    else:
        rings = [Ring(0.0, 0.09, 0.09), *parts.hollow_rings(0.24, 0.12, 0.12, 0.2, 0.008, 2.0)]
        w.mesh(loft(rings, 14), (x[0] + 0.13, y[1] - 0.13, step), w.look("plastic"))


def smart(w: Workbench) -> None:
    """Builds a tankless toilet with a thick lid, a wide rear housing and often a control arm."""
    half, depth, seat = 0.5 * w.length(0.38, 0.43), w.length(0.64, 0.74), w.length(0.40, 0.46)
    white = w.look(w.choice(("ceramic", "ceramic", "appliance")))
    r, power = 0.5 * depth, w.choice((2.6, 3.4))
    under = w.length(0.75, 0.96)
    w.mesh(loft([
        Ring(0.0, under * r, 0.85 * half, -(1 - under) * r, power=power),
        Ring(0.06, under * r, 0.85 * half, -(1 - under) * r, power=power),
        Ring(0.8 * seat, 0.98 * r, 0.98 * half, power=power), Ring(seat - 0.03, r, half, power=power),
    ], 16, hull=True), (0.0, 0.0, 0.0), white)  # fmt: skip
    back = w.length(0.10, 0.22)
    w.mesh(frustum((0.26, 2 * half), (0.18, 1.9 * half), back, (-0.03, 0.0)), (-r + 0.13, 0.0, seat - 0.04), white)
    lid = loft([
        Ring(0.0, 0.42 * depth, half, power=power), Ring(0.03, 0.42 * depth, half, power=power),
        Ring(0.055, 0.38 * depth, 0.92 * half, power=power),
    ], 16, hull=True)  # fmt: skip
    if w.chance(0.6):
        w.mesh(lid, (0.08 * depth, 0.0, seat - 0.03), white, tilt=0.05)
    else:
        w.mesh(lid, (-r + 0.17, 0.0, seat + 0.42 * depth), white, tilt=-1.4)
        w.ellipsoid((0.08, 0.0, seat - 0.03), (0.24, 0.12, 0.006), w.look("screen"), solid=False)
    side = w.choice(BOTH_SIDES)
    if w.chance(0.7):
        w.box((-0.20, 0.10), (side * (half - 0.05), side * (half + 0.07)), (seat - 0.02, seat + 0.03), white, tilt=0.1)
        w.box((-0.10, 0.06), (side * (half + 0.02), side * (half + 0.06)), (seat + 0.022, seat + 0.036), w.look("dark"))


def earth_closet(w: Workbench) -> None:
    """Builds a dry or composting toilet: a boxed bench of boards with a round seat and a lid."""
    width, depth, seat = w.length(0.48, 1.00), w.length(0.50, 0.65), w.length(0.40, 0.48)
    wood, x = w.look(w.choice(("wood", "wood", "lacquer"))), 0.5 * depth
    y = 0.5 * width
    w.box((-x, x), (-y, y), (0.0, seat - 0.03), wood)
    w.box((-x, x + 0.02), (-y - 0.01, y + 0.01), (seat - 0.03, seat), wood)
    for i in range(w.whole(0, 5)):
        c = -y + (i + 1) * width / 6
        w.box((x - 0.002, x + 0.004), (c - 0.004, c + 0.004), (0.02, seat - 0.05), parts.darker(wood), solid=False)
    c, r = x - 0.25, w.length(0.17, 0.20)
    cover = w.look(w.choice(("wood", "plastic", "ceramic")))
    rings = [Ring(0.0, r, r), Ring(0.025, r, r), Ring(0.025, 0.65 * r, 0.62 * r), Ring(0.0, 0.6 * r, 0.6 * r)]
    w.mesh(loft([*rings, Ring(0.0, r, r)], 16), (c, 0.0, seat), cover)
    w.cylinder((c, 0.0), (seat, seat + 0.004), 0.6 * r, w.look("screen"), solid=False)
    lid = loft([Ring(0.0, r, r), Ring(0.02, r, r)], 16, hull=True)
    if w.chance(0.5):
        w.mesh(lid, (c - r - 0.02, 0.0, seat + r), cover, tilt=-1.45)
    else:
        w.mesh(lid, (c, 0.0, seat + 0.025), cover)
        w.cylinder((c, 0.0), (seat + 0.045, seat + 0.075), 0.02, wood, solid=False)
    if w.chance(0.5):
        w.box((-x, -x + 0.03), (-y, y), (seat, seat + w.length(0.25, 0.6)), wood)
    if w.chance(0.4):
        w.cylinder((-x + 0.08, -y + 0.08), (seat, seat + w.length(0.7, 1.3)), 0.05, w.look("plastic"))


def accessible(w: Workbench) -> None:
    """Builds a high toilet between grab rails, a tubular frame or fold-down arms."""
    half, depth, seat = 0.5 * w.length(0.36, 0.40), w.length(0.66, 0.76), w.length(0.45, 0.52)
    white, metal = w.look("ceramic"), w.look(w.choice(("chrome", "plastic", "metal")))
    x0, x1 = -0.5 * depth, 0.5 * depth
    _bowl_and_seat(w, x0 + 0.17, x1, half, seat, white)
    w.box((x0, x0 + 0.25), (-0.10, 0.10), (0.0, seat - 0.045), white)
    w.mesh(chamfered_box((0.16, 2 * half, 0.41), 0.02), (x0 + 0.08, 0.0, seat + 0.155), white)
    reach, grip = half + w.length(0.08, 0.14), seat + w.length(0.20, 0.28)
    if w.chance(0.5):
        for side in BOTH_SIDES:
            y = side * reach
            for x in (x0 + 0.16, x1 - 0.12):
                w.rod((x, y, 0.0), (x, y, grip), 0.014, metal)
            w.rod((x0 + 0.16, y, grip), (x1 - 0.12, y, grip), 0.016, metal, round_ends=True)
            w.rod((x0 + 0.22, y, grip), (x1 - 0.16, y, grip), 0.024, w.look("dark"), solid=False)
        w.rod((x0 + 0.16, -reach, seat - 0.02), (x0 + 0.16, reach, seat - 0.02), 0.012, metal)
    else:
        w.box((x0 - 0.03, x0), (-reach - 0.06, reach + 0.06), (0.0, grip + 0.12), w.look("lacquer"))
        for side in BOTH_SIDES:
            y = side * reach
            up = side > 0 and w.chance(0.3)
            end = (x0 + 0.05, y, grip + 0.55) if up else (x1 - 0.05, y, grip)
            w.box((x0 - 0.005, x0 + 0.02), (y - 0.05, y + 0.05), (grip - 0.2, grip + 0.06), metal, solid=False)
            w.rod((x0, y, grip), end, 0.016, metal, round_ends=True)
            if not up:
                w.rod((x0, y, grip - 0.15), (x1 - 0.10, y, grip - 0.01), 0.014, metal, round_ends=True)


def hand_basin_tank(w: Workbench) -> None:
    """Builds a toilet whose tall cistern has a small basin and a spout in its lid."""
    half, depth, seat = 0.5 * w.length(0.36, 0.42), w.length(0.66, 0.78), w.length(0.37, 0.43)
    white, tall, deep = w.look("ceramic"), w.length(0.34, 0.50), w.length(0.18, 0.22)
    x0 = -0.5 * depth
    _bowl_and_seat(w, x0 + deep, 0.5 * depth, half, seat, white)
    w.box((x0 + 0.02, x0 + deep + 0.08), (-0.11, 0.11), (0.0, seat - 0.05), white)
    top, power, wide = seat + tall, w.choice((3.0, 6.0)), half * w.length(0.95, 1.25)
    w.mesh(loft([
        Ring(seat - 0.06, 0.42 * deep, 0.8 * wide, power=power),
        Ring(seat + 0.05, 0.5 * deep, 0.95 * wide, power=power),
        *parts.hollow_rings(top, 0.5 * deep, wide, 0.05, 0.02, power),
    ], 16), (x0 + 0.5 * deep, 0.0, 0.0), white)  # fmt: skip
    metal = w.look("chrome")
    parts.arched_pipe(w, (x0 + 0.03, 0.0, top - 0.01), (x0 + 0.6 * deep, 0.0, top + 0.06), 0.07, 0.009, metal, 3)
    w.rod((x0 + deep - 0.01, -0.6 * wide, top - 0.08), (x0 + deep + 0.02, -0.6 * wide, top - 0.08), 0.012, metal)
    w.box(
        (x0 + deep + 0.01, x0 + deep + 0.02),
        (-0.6 * wide, -0.35 * wide),
        (top - 0.087, top - 0.073),
        metal,
        solid=False,
    )


def slim_panel(w: Workbench) -> None:
    """Builds a wall-hung toilet on a narrow tall panel that contains the cistern."""
    half, seat, reach = 0.5 * w.length(0.34, 0.38), w.length(0.40, 0.47), w.length(0.48, 0.58)
    wide, high, thick = 0.5 * w.length(0.46, 0.62), w.length(0.95, 1.25), w.length(0.08, 0.14)
    front = w.look(w.choice(("dark", "ceramic", "stone", "lacquer", "wood")))
    w.box((-thick, 0.0), (-wide, wide), (0.0, high), w.look("steel"))
    w.box((-0.004, 0.012), (-wide - 0.004, wide + 0.004), (0.03, high + 0.008), front)
    white = w.look("ceramic")
    _bowl_and_seat(w, 0.01, reach, half, seat, white, low=w.length(0.08, 0.16))
    w.box((0.0, 0.16), (-0.75 * half, 0.75 * half), (0.16, seat - 0.05), white)
    plate = w.choice(("round", "bar", "none"))
    if plate == "round":
        for side in BOTH_SIDES:
            w.rod((0.01, side * 0.05, 0.85), (0.02, side * 0.05, 0.85), 0.03, w.look("chrome"), solid=False)
    elif plate == "bar":
        w.box((0.01, 0.018), (-0.13, 0.13), (0.82, 0.90), w.look("chrome"), solid=False)


def corner_tank(w: Workbench) -> None:
    """Builds a toilet with a wedge-shaped or round cistern, and sometimes a brush holder."""
    half, seat, white = 0.5 * w.length(0.35, 0.40), w.length(0.38, 0.43), w.look("ceramic")
    depth, tall = w.length(0.66, 0.76), w.length(0.30, 0.40)
    x0, top = -0.5 * depth, seat + tall
    if w.chance(0.5):
        low, high = [(x0 + 0.24, -0.15), (x0 + 0.24, 0.15), (x0, 0.26), (x0, -0.26)], seat - 0.04
        points = [(x, s * y, z) for z, s in ((high, 0.92), (top, 1.0), (top + 0.02, 1.04)) for x, y in low]
        w.mesh(named_mesh("wedge", points), (0.0, 0.0, 0.0), white)
    else:
        w.rod((x0 + 0.12, -0.22, top - 0.13), (x0 + 0.12, 0.22, top - 0.13), 0.12, white)
        w.box((x0 + 0.05, x0 + 0.19), (-0.10, 0.10), (seat - 0.06, top - 0.2), white)
    w.cylinder((x0 + 0.12, 0.0), (top - 0.015, top + 0.03), 0.022, w.look("chrome"), solid=False)
    _bowl_and_seat(w, x0 + 0.22, 0.5 * depth, half, seat, white)
    w.box((x0 + 0.02, x0 + 0.30), (-0.10, 0.10), (0.0, seat - 0.03), white)
    if w.chance(0.5):
        side = w.choice(BOTH_SIDES)
        w.cylinder((x0 + 0.10, side * 0.30), (0.0, 0.12), 0.05, w.look("plastic"))
        w.cylinder((x0 + 0.10, side * 0.30), (0.10, 0.38), 0.009, w.look("chrome"))


def portable(w: Workbench) -> None:
    """Builds a camping toilet of two plastic halves, or a commode with a pail in a tubular frame."""
    body, seat = w.look(w.choice(("ceramic", "ceramic", "plastic"))), w.length(0.34, 0.46)
    half, r = w.length(0.18, 0.22), w.length(0.19, 0.23)
    dark = w.look("dark")
    if w.chance(0.5):
        w.mesh(frustum((2.1 * r, 2.1 * half), (1.9 * r, 1.9 * half), 0.45 * seat), (0.0, 0.0, 0.0), body)
        w.mesh(frustum((1.9 * r, 1.9 * half), (2.1 * r, 2.1 * half), 0.5 * seat), (0.0, 0.0, 0.46 * seat), body)
        w.box((-0.98 * r, 0.98 * r), (-0.98 * half, 0.98 * half), (0.44 * seat, 0.475 * seat), dark)
    else:
        metal, arm = w.look("metal"), seat + 0.22
        for side in BOTH_SIDES:
            y = side * (half + 0.05)
            for x in (-r, r):
                w.rod((x, y, 0.0), (x, y, arm), 0.013, metal)
            w.rod((-r, y, arm), (r, y, arm), 0.016, dark, round_ends=True)
            w.rod((-r, y, seat - 0.05), (r, y, seat - 0.05), 0.012, metal)
        for x in (-r, r):
            w.rod((x, -half - 0.05, seat - 0.05), (x, half + 0.05, seat - 0.05), 0.012, metal)
        w.mesh(loft([Ring(0.12, 0.11, 0.11), Ring(seat - 0.04, 0.15, 0.15)], 14, hull=True), (0.0, 0.0, 0.0), body)
        w.box((-r, r), (-half - 0.04, half + 0.04), (seat - 0.06, seat - 0.035), body)
        if w.chance(0.6):
            w.box((-r - 0.02, -r + 0.02), (-half - 0.05, half + 0.05), (arm, arm + 0.16), dark)
            w.box((-r - 0.012, -r + 0.012), (-half - 0.05, half + 0.05), (arm - 0.02, arm + 0.02), metal)
    rings = [Ring(0.0, r, half, power=2.6), Ring(0.025, r, half, power=2.6), Ring(0.025, 0.66 * r, 0.64 * half)]
    w.mesh(
        loft([*rings, Ring(0.0, 0.6 * r, 0.6 * half), Ring(0.0, r, half, power=2.6)], 16),
        (0.0, 0.0, seat - 0.045),
        body,
    )
    w.cylinder((0.0, 0.0), (seat - 0.045, seat - 0.036), 0.6 * half, w.look("screen"), solid=False)
    lid = loft([Ring(0.0, r, half, power=2.6), Ring(0.022, 0.96 * r, 0.96 * half, power=2.6)], 16, hull=True)
    if w.chance(0.5):
        w.mesh(lid, (-r + 0.02, 0.0, seat + r - 0.05), body, tilt=-1.45)


STYLES: tuple[Style, ...] = (
    Style("toilet", "bidet", "wide", bidet),
    Style("toilet", "squat", "wide", squat),
    Style("toilet", "smart", "wide", smart),
    Style("toilet", "earth_closet", "wide", earth_closet),
    Style("toilet", "accessible", "wide", accessible),
    Style("toilet", "hand_basin_tank", "wide", hand_basin_tank),
    Style("toilet", "slim_panel", "wide", slim_panel),
    Style("toilet", "corner_tank", "wide", corner_tank),
    Style("toilet", "portable", "wide", portable),
)
