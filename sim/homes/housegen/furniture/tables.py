"""Dining tables and desks.

Sizes follow Neufert, Architects' Data, and Panero & Zelnik, Human Dimension and Interior Space: dining tables
0.72-0.77 m high and 0.75-1.00 m deep, 0.60 m of edge per diner; desks 0.70-0.77 m high and 0.50-0.80 m deep.
"""

from __future__ import annotations

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, centred, inset
from sim.homes.housegen.furniture.shapes import frustum, turned
from sim.homes.housegen.furniture.workbench import CORNERS, Range, Workbench


def _apron(w: Workbench, x: Range, y: Range, z: Range, look: Look) -> None:
    """Adds four boards under a top."""
    for edge in x:
        w.box(around(edge, 0.011), y, z, look)
    for edge in y:
        w.box(x, around(edge, 0.011), z, look)


def farmhouse(w: Workbench) -> None:
    """Builds a rectangular wooden table with an apron and four square legs at its corners."""
    width, depth, height = w.width(1.30, 2.00), w.depth(0.80, 0.95), w.length(0.73, 0.76)
    wood = w.look("wood")
    legs = w.look("lacquer") if w.chance(0.35) else wood
    x, y = parts.slab(w, depth, width, (height - w.length(0.03, 0.05), height), wood)
    _apron(w, inset(x, 0.06), inset(y, 0.06), (height - 0.13, height - 0.03), legs)
    w.legs(inset(x, 0.03), inset(y, 0.03), (0.0, height - 0.03), w.length(0.06, 0.09), legs)


def splayed(w: Workbench) -> None:
    """Builds a table with a thin rounded top on four splayed, tapering legs."""
    width, depth, height = w.width(1.20, 1.80), w.depth(0.78, 0.90), w.length(0.73, 0.75)
    wood = w.look("wood")
    x, y = parts.slab(w, depth, width, (height - 0.025, height), w.look("lacquer") if w.chance(0.4) else wood)
    w.box(inset(x, 0.12), inset(y, 0.15), (height - 0.075, height - 0.025), wood)
    for sx, sy in CORNERS:
        leg = frustum((0.030, 0.030), (0.055, 0.055), height - 0.025, (-sx * 0.07, -sy * 0.07))
        w.mesh(leg, (sx * (0.5 * depth - 0.09), sy * (0.5 * width - 0.11), 0.0), wood)


def round_pedestal(w: Workbench) -> None:
    """Builds a table with a round top on one stem that flares into a foot."""
    radius, height = 0.5 * w.width(0.95, 1.25), w.length(0.73, 0.75)
    look = w.look("lacquer")
    parts.round_top(w, radius, (height - 0.025, height), w.look("stone") if w.chance(0.4) else w.look("wood"))
    foot = 0.52 * radius
    stem = [(0.0, foot), (0.015, foot), (0.06, 0.5 * foot), (0.2, 0.05), (0.6 * height, 0.04), (height - 0.02, 0.15)]
    w.mesh(turned(stem, 12), (0.0, 0.0, 0.0), look, solid=False)
    # A foot and a post collide, which leaves room for legs under the top.
    w.cylinder((0.0, 0.0), (0.0, 0.06), 0.8 * foot, look)
    w.cylinder((0.0, 0.0), (0.06, height - 0.02), 0.8 * 0.04, look)


def industrial(w: Workbench) -> None:
    """Builds a table with a plank top on two welded steel frames."""
    width, depth, height = w.width(1.40, 2.20), w.depth(0.80, 0.95), w.length(0.74, 0.76)
    steel = w.look("iron")
    parts.slab(w, depth, width, (height - 0.045, height), w.look("wood"))
    for y in centred(width, 0.22):
        for x in centred(depth, 0.06):
            w.box(around(x, 0.03), around(y, 0.03), (0.0, height - 0.045), steel)
        w.box(centred(depth, 0.09), around(y, 0.03), (0.0, 0.04), steel)
        w.box(centred(depth, 0.09), around(y, 0.03), (height - 0.085, height - 0.045), steel)


def trestle(w: Workbench) -> None:
    """Builds a table with a heavy top on two board ends joined by a stretcher."""
    width, depth, height = w.width(1.50, 2.20), w.depth(0.85, 1.00), w.length(0.74, 0.77)
    wood = w.look("wood")
    parts.slab(w, depth, width, (height - 0.05, height), wood)
    for y in (-0.32 * width, 0.32 * width):
        w.box((-0.22, 0.22), around(y, 0.03), (0.06, height - 0.10), wood)
        w.box((-0.36, 0.36), around(y, 0.045), (0.0, 0.07), wood)
        w.box((-0.34, 0.34), around(y, 0.045), (height - 0.11, height - 0.05), wood)
    w.box((-0.02, 0.02), (-0.32 * width - 0.06, 0.32 * width + 0.06), (0.26, 0.36), wood)


def glass_dining(w: Workbench) -> None:
    """Builds a table with a glass top in a metal frame on a crossed base of bent metal."""
    width, depth, height = w.width(1.30, 1.80), w.depth(0.85, 0.95), w.length(0.73, 0.75)
    x, y = parts.slab(w, depth, width, (height - 0.015, height), w.look("glass"))
    metal = w.look("brass")
    for side in BOTH_SIDES:
        edge = side * (0.5 * depth - 0.012)
        w.box(around(edge, 0.012), y, (height - 0.04, height - 0.015), metal, solid=False)
        edge = side * (0.5 * width - 0.012)
        w.box(x, around(edge, 0.012), (height - 0.04, height - 0.015), metal, solid=False)
    for side in BOTH_SIDES:
        foot, head = (side * 0.30, -0.30 * width), (-side * 0.30, 0.30 * width)
        w.bar((*foot, 0.02), (*head, height - 0.03), 0.05, 0.025, metal)
        w.bar((foot[0], -foot[1], 0.02), (head[0], -head[1], height - 0.03), 0.05, 0.025, metal)
    for y in (-0.30 * width, 0.30 * width):
        w.box((-0.33, 0.33), around(y, 0.03), (0.0, 0.03), metal)
        w.box((x[0], x[1]), around(y, 0.03), (height - 0.04, height - 0.015), metal)


def round_legs(w: Workbench) -> None:
    """Builds a round table with four straight round legs and a cross under the top."""
    radius, height, wood = 0.5 * w.width(0.95, 1.20), w.length(0.73, 0.76), w.look("wood")
    parts.round_top(w, radius, (height - 0.03, height), wood)
    half = 0.55 * radius
    w.legs((-half, half), (-half, half), (0.0, height - 0.03), 0.05, wood, round_=True)
    for x0, y0 in ((half, half), (half, -half)):
        w.bar((-x0, -y0, height - 0.06), (x0, y0, height - 0.06), 0.03, 0.06, wood)


def desk_pedestal(w: Workbench) -> None:
    """Builds a desk with drawers on one side and a panel leg on the other."""
    width, depth, height = w.width(1.20, 1.60), w.depth(0.60, 0.75), w.length(0.72, 0.75)
    wood, front = w.look("wood"), w.look("lacquer")
    x, _ = parts.slab(w, depth, width, (height - 0.03, height), wood)
    side = w.choice(BOTH_SIDES)
    block = parts.on_side(side, 0.5 * width - 0.42, 0.5 * width - 0.02)
    w.box(inset(x, 0.02, 0.05), block, (0.05, height - 0.03), wood)
    w.box(inset(x, 0.05, 0.09), inset(block, 0.02), (0.0, 0.05), w.look("dark"))
    parts.plain_drawers(w, x[1] - 0.05, block, (0.06, height - 0.04), 3, 1, front, w.look("chrome"))
    panel = -side * (0.5 * width - 0.035)
    w.box(inset(x, 0.02, 0.04), around(panel, 0.015), (0.0, height - 0.03), wood)
    back = parts.on_side(side, 0.035 - 0.5 * width, 0.5 * width - 0.42)
    w.box((x[0] + 0.05, x[0] + 0.068), back, (0.30, height - 0.03), wood)


def desk_frame(w: Workbench) -> None:
    """Builds an office desk with a plain top on a steel frame with T feet."""
    width, depth, height = w.width(1.20, 1.80), w.depth(0.65, 0.80), w.length(0.70, 0.76)
    steel = w.look("metal")
    parts.slab(w, depth, width, (height - 0.025, height), w.look("lacquer") if w.chance(0.5) else w.look("wood"))
    for y in centred(width, 0.16):
        w.box((-0.03, 0.03), around(y, 0.04), (0.03, height - 0.06), steel)
        w.box((-0.45 * depth, 0.45 * depth), around(y, 0.035), (0.0, 0.035), steel)
        w.box((-0.40 * depth, 0.40 * depth), around(y, 0.02), (height - 0.06, height - 0.025), steel)
    w.box((-0.02, 0.02), centred(width, 0.16), (height - 0.10, height - 0.06), steel)


def secretary(w: Workbench) -> None:
    """Builds a writing desk with slender legs, a drawer under the top, and a low hutch of pigeonholes at the back."""
    width, depth, height = w.width(0.95, 1.25), w.depth(0.50, 0.60), w.length(0.74, 0.77)
    wood = w.look("wood")
    x, y = parts.footprint(depth, width)
    w.box(x, y, (height - 0.02, height), wood)
    w.box(inset(x, 0.03), inset(y, 0.03), (height - 0.13, height - 0.02), wood)
    parts.plain_drawers(
        w, x[1] - 0.03, inset(y, 0.05), (height - 0.125, height - 0.025), 1, 2, wood, w.look("brass"), "knob"
    )
    w.legs(inset(x, 0.02), inset(y, 0.02), (0.0, height - 0.03), 0.04, wood)
    w.box((x[0], x[0] + 0.18), y, (height + 0.22, height + 0.24), wood)
    w.box((x[0], x[0] + 0.012), y, (height, height + 0.22), wood)
    for i in range(4):
        edge = y[0] + 0.009 + (width - 0.018) * i / 3
        w.box((x[0], x[0] + 0.18), around(edge, 0.009), (height, height + 0.22), wood)
    w.top(inset(x, 0.22, 0.04), inset(y, 0.05), height)


def wing_desk(w: Workbench) -> None:
    """Builds a desk of one board on a block of drawers and a trestle."""
    width, depth, height = w.width(1.20, 1.60), w.depth(0.60, 0.72), w.length(0.72, 0.76)
    top, body, metal = w.look("wood"), w.look("lacquer"), w.look("metal")
    x, y = parts.footprint(depth, width)
    w.box(x, y, (height - 0.035, height), top)
    w.box(inset(x, 0.04), (y[0] + 0.04, y[0] + 0.42), (0.03, height - 0.035), body)
    for n in range(3):
        z = 0.06 + n * (height - 0.12) / 3
        w.box((x[1] - 0.04, x[1] - 0.025), (y[0] + 0.05, y[0] + 0.41), (z, z + 0.19), body, solid=False)
        w.box((x[1] - 0.026, x[1] - 0.01), (y[0] + 0.17, y[0] + 0.29), (z + 0.13, z + 0.145), metal, solid=False)
    for end in inset(x, 0.05):
        w.bar((end, y[1] - 0.06, 0.0), (0.4 * end, y[1] - 0.10, height - 0.035), 0.035, 0.035, metal)
    w.bar((x[0] + 0.08, y[1] - 0.07, 0.14), (x[1] - 0.08, y[1] - 0.07, 0.14), 0.03, 0.03, metal)
    w.top(inset(x, 0.03), inset(y, 0.03), height)


STYLES = (
    Style("table", "farmhouse", "train", farmhouse, ("dining",)),
    Style("table", "splayed", "train", splayed, ("dining",)),
    Style("table", "round_pedestal", "train", round_pedestal, ("dining",)),
    Style("table", "industrial", "train", industrial, ("dining",)),
    Style("table", "trestle", "heldout", trestle, ("dining",)),
    Style("table", "glass_dining", "heldout", glass_dining, ("dining",)),
    Style("table", "round_legs", "heldout", round_legs, ("dining",)),
    Style("table", "desk_pedestal", "train", desk_pedestal, ("desk",)),
    Style("table", "desk_frame", "train", desk_frame, ("desk",)),
    Style("table", "wing_desk", "heldout", wing_desk, ("desk",)),
    Style("table", "secretary", "heldout", secretary, ("desk",)),
)
