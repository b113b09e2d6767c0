"""Tables: dining, coffee, desk, side, bedside, console.

Ranges after Neufert, Architects' Data, and Panero & Zelnik: dining tables 0.72-0.76 m high and 0.75-1.00 m deep,
0.60 m of edge a diner; coffee tables 0.35-0.48 m high; desks 0.70-0.76 m high and 0.60-0.80 m deep; side and
bedside tables 0.45-0.65 m high and 0.35-0.55 m wide; consoles 0.75-0.85 m high and 0.30-0.42 m deep.
"""

from __future__ import annotations

import math

from sim.houses.furniture import parts
from sim.houses.furniture.catalogue import Style
from sim.houses.furniture.item import Look
from sim.houses.furniture.shapes import Ring, frustum, loft
from sim.houses.furniture.workbench import Range, Workbench

_BOTH = (-1, 1)


def _slab(w: Workbench, depth: float, width: float, z: Range, look: Look) -> tuple[Range, Range]:
    """A rectangular top that things stand on; its x and y ranges."""
    x, y = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)
    w.box(x, y, z, look)
    w.top((x[0] + 0.05, x[1] - 0.05), (y[0] + 0.05, y[1] - 0.05), z[1])
    return x, y


def _round_top(w: Workbench, radius: float, z: Range, look: Look) -> None:
    """A round top that things stand on."""
    w.cylinder((0.0, 0.0), z, radius, look)
    half = 0.65 * radius
    w.top((-half, half), (-half, half), z[1])


def _apron(w: Workbench, x: Range, y: Range, z: Range, look: Look) -> None:
    """Four boards under a top."""
    for edge in x:
        w.box((edge - 0.011, edge + 0.011), y, z, look)
    for edge in y:
        w.box(x, (edge - 0.011, edge + 0.011), z, look)


# ---- dining ------------------------------------------------------------------------------------------------------


def farmhouse(w: Workbench) -> None:
    """Rectangular wooden table with an apron and four square legs at its corners."""
    width, depth, height = w.width(1.30, 2.00), w.depth(0.80, 0.95), w.length(0.73, 0.76)
    wood = w.look("wood")
    legs = w.look("lacquer") if w.chance(0.35) else wood
    x, y = _slab(w, depth, width, (height - w.length(0.03, 0.05), height), wood)
    _apron(w, (x[0] + 0.06, x[1] - 0.06), (y[0] + 0.06, y[1] - 0.06), (height - 0.13, height - 0.03), legs)
    w.legs((x[0] + 0.03, x[1] - 0.03), (y[0] + 0.03, y[1] - 0.03), (0.0, height - 0.03), w.length(0.06, 0.09), legs)


def splayed(w: Workbench) -> None:
    """Thin top with rounded feel on four splayed, tapering legs."""
    width, depth, height = w.width(1.20, 1.80), w.depth(0.78, 0.90), w.length(0.73, 0.75)
    wood = w.look("wood")
    x, y = _slab(w, depth, width, (height - 0.025, height), w.look("lacquer") if w.chance(0.4) else wood)
    w.box((x[0] + 0.12, x[1] - 0.12), (y[0] + 0.15, y[1] - 0.15), (height - 0.075, height - 0.025), wood)
    for sx in _BOTH:
        for sy in _BOTH:
            leg = frustum((0.030, 0.030), (0.055, 0.055), height - 0.025, (-sx * 0.07, -sy * 0.07))
            w.mesh(leg, (sx * (0.5 * depth - 0.09), sy * (0.5 * width - 0.11), 0.0), wood)


def round_pedestal(w: Workbench) -> None:
    """Round top on one stem that flares into a foot."""
    radius, height = 0.5 * w.width(0.95, 1.25), w.length(0.73, 0.75)
    look = w.look("lacquer")
    _round_top(w, radius, (height - 0.025, height), w.look("stone") if w.chance(0.4) else w.look("wood"))
    foot = 0.52 * radius
    rings = [
        Ring(0.0, foot, foot),
        Ring(0.015, foot, foot),
        Ring(0.06, 0.5 * foot, 0.5 * foot),
        Ring(0.2, 0.05, 0.05),
        Ring(0.6 * height, 0.04, 0.04),
        Ring(height - 0.02, 0.15, 0.15),
    ]
    _stem(w, rings, look)


def _stem(w: Workbench, rings: list[Ring], look: Look) -> None:
    """A turned stem: seen as a loft, touched as its foot and its post, so that legs have room under the top."""
    w.mesh(loft(rings, 12), (0.0, 0.0, 0.0), look, solid=False)
    w.cylinder((0.0, 0.0), (0.0, rings[2].z_m), 0.8 * rings[0].rx_m, look)
    w.cylinder((0.0, 0.0), (rings[2].z_m, rings[-1].z_m), 0.8 * min(r.rx_m for r in rings), look)


def industrial(w: Workbench) -> None:
    """Plank top on two welded steel frames."""
    width, depth, height = w.width(1.40, 2.20), w.depth(0.80, 0.95), w.length(0.74, 0.76)
    steel = w.look("iron")
    _slab(w, depth, width, (height - 0.045, height), w.look("wood"))
    for side in _BOTH:
        y = side * (0.5 * width - 0.22)
        for x in (-0.5 * depth + 0.06, 0.5 * depth - 0.06):
            w.box((x - 0.03, x + 0.03), (y - 0.03, y + 0.03), (0.0, height - 0.045), steel)
        w.box((-0.5 * depth + 0.09, 0.5 * depth - 0.09), (y - 0.03, y + 0.03), (0.0, 0.04), steel)
        w.box((-0.5 * depth + 0.09, 0.5 * depth - 0.09), (y - 0.03, y + 0.03), (height - 0.085, height - 0.045), steel)


def trestle(w: Workbench) -> None:
    """Heavy top on two board ends joined by a stretcher."""
    width, depth, height = w.width(1.50, 2.20), w.depth(0.85, 1.00), w.length(0.74, 0.77)
    wood = w.look("wood")
    _slab(w, depth, width, (height - 0.05, height), wood)
    for side in _BOTH:
        y = side * 0.32 * width
        w.box((-0.22, 0.22), (y - 0.03, y + 0.03), (0.06, height - 0.10), wood)
        w.box((-0.36, 0.36), (y - 0.045, y + 0.045), (0.0, 0.07), wood)
        w.box((-0.34, 0.34), (y - 0.045, y + 0.045), (height - 0.11, height - 0.05), wood)
    w.box((-0.02, 0.02), (-0.32 * width - 0.06, 0.32 * width + 0.06), (0.26, 0.36), wood)


def glass_dining(w: Workbench) -> None:
    """Glass top on a crossed base of bent metal."""
    width, depth, height = w.width(1.30, 1.80), w.depth(0.85, 0.95), w.length(0.73, 0.75)
    _slab(w, depth, width, (height - 0.015, height), w.look("glass"))
    metal = w.look("brass")
    for side in _BOTH:
        foot, head = (side * 0.30, -0.30 * width), (-side * 0.30, 0.30 * width)
        w.bar((*foot, 0.02), (*head, height - 0.03), 0.05, 0.025, metal)
        w.bar((foot[0], -foot[1], 0.02), (head[0], -head[1], height - 0.03), 0.05, 0.025, metal)
    for y in (-0.30 * width, 0.30 * width):
        w.box((-0.33, 0.33), (y - 0.03, y + 0.03), (0.0, 0.03), metal)
        w.box((-0.33, 0.33), (y - 0.03, y + 0.03), (height - 0.04, height - 0.015), metal)


def tulip_legs_round(w: Workbench) -> None:
    """Round table with four straight round legs and a cross under the top."""
    radius, height, wood = 0.5 * w.width(0.95, 1.20), w.length(0.73, 0.76), w.look("wood")
    _round_top(w, radius, (height - 0.03, height), wood)
    half = 0.55 * radius
    w.legs((-half, half), (-half, half), (0.0, height - 0.03), 0.05, wood, round_=True)
    for x0, y0 in ((half, half), (half, -half)):
        w.bar((-x0, -y0, height - 0.06), (x0, y0, height - 0.06), 0.03, 0.06, wood)


# ---- coffee ------------------------------------------------------------------------------------------------------


def coffee_shelf(w: Workbench) -> None:
    """Low rectangular table with a shelf between its legs."""
    width, depth, height = w.width(0.90, 1.25), w.depth(0.50, 0.65), w.length(0.40, 0.47)
    wood = w.look("wood")
    x, y = _slab(w, depth, width, (height - 0.035, height), wood)
    w.legs((x[0] + 0.01, x[1] - 0.01), (y[0] + 0.01, y[1] - 0.01), (0.0, height - 0.035), 0.05, wood)
    w.box((x[0] + 0.03, x[1] - 0.03), (y[0] + 0.03, y[1] - 0.03), (0.13, 0.15), wood)


def coffee_drum(w: Workbench) -> None:
    """A solid drum."""
    radius, height = 0.5 * w.width(0.65, 0.90), w.length(0.33, 0.42)
    _round_top(w, radius, (height - 0.02, height), w.look("wood"))
    w.cylinder(
        (0.0, 0.0), (0.0, height - 0.02), radius - 0.02, w.look("wicker") if w.chance(0.5) else w.look("lacquer")
    )


def coffee_hairpin(w: Workbench) -> None:
    """Thick round board on three hairpin legs."""
    radius, height, iron = 0.5 * w.width(0.70, 0.95), w.length(0.38, 0.45), w.look("iron")
    _round_top(w, radius, (height - 0.04, height), w.look("wood"))
    for i in range(3):
        a = math.tau * i / 3 + 0.5
        foot = (0.78 * radius * math.cos(a), 0.78 * radius * math.sin(a), 0.006)
        for turn in (-0.22, 0.22):
            head = (0.62 * radius * math.cos(a + turn), 0.62 * radius * math.sin(a + turn), height - 0.04)
            w.rod(foot, head, 0.006, iron, round_ends=True)


def coffee_glass(w: Workbench) -> None:
    """Glass sheet on a brass frame with a lower rim."""
    width, depth, height, metal = w.width(0.90, 1.20), w.depth(0.55, 0.70), w.length(0.38, 0.45), w.look("brass")
    x, y = _slab(w, depth, width, (height - 0.012, height), w.look("glass"))
    w.legs(x, y, (0.0, height - 0.012), 0.02, metal)
    for z in (height - 0.022, 0.12):
        for side in _BOTH:
            w.box(
                x,
                (side * 0.5 * width - 0.01 - 0.01 * side, side * 0.5 * width + 0.01 - 0.01 * side),
                (z - 0.01, z + 0.01),
                metal,
                solid=False,
            )
            w.box(
                (side * 0.5 * depth - 0.01 - 0.01 * side, side * 0.5 * depth + 0.01 - 0.01 * side),
                y,
                (z - 0.01, z + 0.01),
                metal,
                solid=False,
            )


def coffee_blocks(w: Workbench) -> None:
    """Stone slab on two stone blocks."""
    width, depth, height, stone = w.width(0.95, 1.25), w.depth(0.55, 0.70), w.length(0.32, 0.38), w.look("stone")
    _slab(w, depth, width, (height - 0.05, height), stone)
    for side in _BOTH:
        y = side * 0.28 * width
        w.box((-0.36 * depth, 0.36 * depth), (y - 0.07, y + 0.07), (0.0, height - 0.05), stone)


# ---- desk --------------------------------------------------------------------------------------------------------


def desk_pedestal(w: Workbench) -> None:
    """Desk with drawers on one side and a panel leg on the other."""
    width, depth, height = w.width(1.20, 1.60), w.depth(0.60, 0.75), w.length(0.72, 0.75)
    wood, front = w.look("wood"), w.look("lacquer")
    x, _ = _slab(w, depth, width, (height - 0.03, height), wood)
    side = w.choice(_BOTH)
    near, far = side * (0.5 * width - 0.02), side * (0.5 * width - 0.42)
    low, high = min(near, far), max(near, far)
    w.box((x[0] + 0.02, x[1] - 0.05), (low, high), (0.05, height - 0.03), wood)
    w.box((x[0] + 0.05, x[1] - 0.09), (low + 0.02, high - 0.02), (0.0, 0.05), w.look("dark"))
    parts.drawers(w, x[1] - 0.05, (low, high), (0.06, height - 0.04), 3, 1, front, w.look("chrome"))
    panel = -side * (0.5 * width - 0.035)
    w.box((x[0] + 0.02, x[1] - 0.04), (panel - 0.015, panel + 0.015), (0.0, height - 0.03), wood)
    w.box((x[0] + 0.05, x[0] + 0.068), (min(far, panel), max(far, panel)), (0.30, height - 0.03), wood)


def desk_frame(w: Workbench) -> None:
    """Plain top on a steel frame with T feet, as in offices."""
    width, depth, height = w.width(1.20, 1.80), w.depth(0.65, 0.80), w.length(0.70, 0.76)
    steel = w.look("metal")
    _slab(w, depth, width, (height - 0.025, height), w.look("lacquer") if w.chance(0.5) else w.look("wood"))
    for side in _BOTH:
        y = side * (0.5 * width - 0.16)
        w.box((-0.03, 0.03), (y - 0.04, y + 0.04), (0.03, height - 0.06), steel)
        w.box((-0.45 * depth, 0.45 * depth), (y - 0.035, y + 0.035), (0.0, 0.035), steel)
        w.box((-0.40 * depth, 0.40 * depth), (y - 0.02, y + 0.02), (height - 0.06, height - 0.025), steel)
    w.box((-0.02, 0.02), (-0.5 * width + 0.16, 0.5 * width - 0.16), (height - 0.10, height - 0.06), steel)


def secretary(w: Workbench) -> None:
    """Writing desk: slender legs, a drawer under the top, a low hutch of pigeonholes at the back."""
    width, depth, height = w.width(0.95, 1.25), w.depth(0.50, 0.60), w.length(0.74, 0.77)
    wood = w.look("wood")
    x, y = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)
    w.box(x, y, (height - 0.02, height), wood)
    w.box((x[0] + 0.03, x[1] - 0.03), (y[0] + 0.03, y[1] - 0.03), (height - 0.13, height - 0.02), wood)
    parts.drawers(
        w,
        x[1] - 0.03,
        (y[0] + 0.05, y[1] - 0.05),
        (height - 0.125, height - 0.025),
        1,
        2,
        wood,
        w.look("brass"),
        "knob",
    )
    w.legs((x[0] + 0.02, x[1] - 0.02), (y[0] + 0.02, y[1] - 0.02), (0.0, height - 0.03), 0.04, wood)
    w.box((x[0], x[0] + 0.18), y, (height + 0.22, height + 0.24), wood)
    w.box((x[0], x[0] + 0.012), y, (height, height + 0.22), wood)
    for i in range(4):
        edge = y[0] + 0.009 + (width - 0.018) * i / 3
        w.box((x[0], x[0] + 0.18), (edge - 0.009, edge + 0.009), (height, height + 0.22), wood)
    w.top((x[0] + 0.22, x[1] - 0.04), (y[0] + 0.05, y[1] - 0.05), height)


# ---- side, bedside, console ---------------------------------------------------------------------------------------


def side_tripod(w: Workbench) -> None:
    """Small round table on three legs."""
    radius, height, wood = 0.5 * w.width(0.38, 0.52), w.length(0.48, 0.60), w.look("wood")
    _round_top(w, radius, (height - 0.022, height), w.look("lacquer") if w.chance(0.4) else wood)
    for i in range(3):
        a = math.tau * i / 3 + 0.4
        c, s = math.cos(a), math.sin(a)
        w.rod(
            (0.9 * radius * c, 0.9 * radius * s, 0.012),
            (0.5 * radius * c, 0.5 * radius * s, height - 0.02),
            0.014,
            wood,
            round_ends=True,
        )


def side_cube(w: Workbench) -> None:
    """Open cube: top, two sides, a shelf."""
    width, height, wood = w.width(0.38, 0.50), w.length(0.45, 0.58), w.look("wood")
    depth = w.depth(0.35, 0.45)
    x, y = _slab(w, depth, width, (height - 0.02, height), wood)
    for side in _BOTH:
        w.box(x, (side * (0.5 * width - 0.01) - 0.01, side * (0.5 * width - 0.01) + 0.01), (0.0, height - 0.02), wood)
    w.box((x[0], x[1] - 0.01), (y[0] + 0.02, y[1] - 0.02), (0.16, 0.18), wood)
    w.box((x[0], x[0] + 0.01), (y[0] + 0.02, y[1] - 0.02), (0.18, height - 0.02), wood)


def bedside_legs(w: Workbench) -> None:
    """Bedside table: one drawer box on four legs."""
    width, depth, height = w.width(0.40, 0.52), w.depth(0.36, 0.44), w.length(0.48, 0.62)
    wood, legs = w.look("lacquer") if w.chance(0.4) else w.look("wood"), w.look("wood")
    x, y = _slab(w, depth, width, (height - 0.02, height), wood)
    w.box((x[0] + 0.01, x[1] - 0.02), (y[0] + 0.01, y[1] - 0.01), (height - 0.20, height - 0.02), wood)
    parts.drawers(
        w,
        x[1] - 0.02,
        (y[0] + 0.01, y[1] - 0.01),
        (height - 0.195, height - 0.025),
        1,
        1,
        wood,
        w.look("brass"),
        w.choice(("knob", "bar")),
    )
    w.legs((x[0] + 0.03, x[1] - 0.04), (y[0] + 0.03, y[1] - 0.03), (0.0, height - 0.19), 0.03, legs, splay=0.015)


def bedside_wire(w: Workbench) -> None:
    """Round tray on a wire basket."""
    radius, height, iron = 0.5 * w.width(0.40, 0.48), w.length(0.46, 0.56), w.look("iron")
    _round_top(w, radius, (height - 0.015, height), w.look("wood"))
    n = 8
    for i in range(n):
        a = math.tau * i / n
        w.rod(
            (0.72 * radius * math.cos(a), 0.72 * radius * math.sin(a), 0.0),
            (0.92 * radius * math.cos(a), 0.92 * radius * math.sin(a), height - 0.01),
            0.005,
            iron,
        )
    w.cylinder((0.0, 0.0), (0.0, 0.012), 0.75 * radius, iron)


def console(w: Workbench) -> None:
    """Narrow hall table, slender legs, one or two drawers."""
    width, depth, height = w.width(0.90, 1.30), w.depth(0.30, 0.40), w.length(0.76, 0.84)
    wood = w.look("wood")
    x, y = _slab(w, depth, width, (height - 0.025, height), wood)
    w.box((x[0] + 0.01, x[1] - 0.03), (y[0] + 0.03, y[1] - 0.03), (height - 0.15, height - 0.025), wood)
    parts.drawers(
        w, x[1] - 0.03, (y[0] + 0.04, y[1] - 0.04), (height - 0.145, height - 0.03), 1, 2, wood, w.look("brass"), "knob"
    )
    w.legs((x[0] + 0.01, x[1] - 0.02), (y[0] + 0.02, y[1] - 0.02), (0.0, height - 0.025), 0.04, wood)


def console_arc(w: Workbench) -> None:
    """Narrow hall table: stone shelf on two hoops of metal."""
    width, depth, height, metal = w.width(0.90, 1.20), w.depth(0.30, 0.38), w.length(0.76, 0.82), w.look("brass")
    _slab(w, depth, width, (height - 0.03, height), w.look("stone"))
    for side in _BOTH:
        y = side * (0.5 * width - 0.10)
        w.box((-0.5 * depth + 0.02, 0.5 * depth - 0.02), (y - 0.012, y + 0.012), (0.0, 0.025), metal)
        for x in (-0.5 * depth + 0.03, 0.5 * depth - 0.03):
            w.box((x - 0.012, x + 0.012), (y - 0.012, y + 0.012), (0.0, height - 0.03), metal)
    w.rod(
        (-0.5 * depth + 0.03, -0.5 * width + 0.10, 0.02),
        (-0.5 * depth + 0.03, 0.5 * width - 0.10, height - 0.04),
        0.008,
        metal,
    )


STYLES = (
    Style("table", "farmhouse", "train", farmhouse, ("dining",)),
    Style("table", "splayed", "train", splayed, ("dining",)),
    Style("table", "round_pedestal", "train", round_pedestal, ("dining",)),
    Style("table", "industrial", "train", industrial, ("dining",)),
    Style("table", "trestle", "heldout", trestle, ("dining",)),
    Style("table", "glass_dining", "heldout", glass_dining, ("dining",)),
    Style("table", "round_legs", "heldout", tulip_legs_round, ("dining",)),
    Style("table", "coffee_shelf", "train", coffee_shelf, ("coffee",)),
    Style("table", "coffee_drum", "train", coffee_drum, ("coffee",)),
    Style("table", "coffee_glass", "train", coffee_glass, ("coffee",)),
    Style("table", "coffee_hairpin", "heldout", coffee_hairpin, ("coffee",)),
    Style("table", "coffee_blocks", "heldout", coffee_blocks, ("coffee",)),
    Style("table", "desk_pedestal", "train", desk_pedestal, ("desk",)),
    Style("table", "desk_frame", "train", desk_frame, ("desk",)),
    Style("table", "secretary", "heldout", secretary, ("desk",)),
    Style("table", "side_tripod", "train", side_tripod, ("side",)),
    Style("table", "side_cube", "train", side_cube, ("side", "nightstand")),
    Style("table", "bedside_legs", "train", bedside_legs, ("nightstand",)),
    Style("table", "bedside_wire", "heldout", bedside_wire, ("nightstand", "side")),
    Style("table", "console", "train", console, ("console",)),
    Style("table", "console_arc", "heldout", console_arc, ("console",)),
)
