"""Shelves of laundries and closets, and drying racks.

Usual retail dimensions: utility shelves 0.60-0.90 m wide, 0.35-0.45 m deep and 1.50-1.85 m high; bottles of detergent
0.22-0.28 m high; shoe boxes 0.33 x 0.20 x 0.12 m; drying racks 0.90-1.10 m high.
"""

from __future__ import annotations

from functools import partial

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, centred, inset
from sim.homes.housegen.furniture.shapes import frustum
from sim.homes.housegen.furniture.workbench import Range, Workbench


def _folded(w: Workbench, x: float, y: float, z: float, room: float) -> None:
    """Adds a stack of folded cloths to a board at height z."""
    wide = w.choice((0.22, 0.26))
    for _ in range(w.whole(2, 3)):
        thick = w.choice((0.04, 0.06))
        if room < thick + 0.03:
            return
        material = w.choice(("towel", "linen", "bright"))
        w.box(around(x, 0.14), around(y, 0.5 * wide), (z, z + thick - 0.004), w.new_look(material), solid=False)
        z, room = z + thick, room - thick


def _bottle(w: Workbench, y: float, z: float) -> None:
    """Adds a bottle of detergent."""
    high, look = w.choice((0.19, 0.22, 0.25)), w.new_look("plastic")
    w.mesh(frustum((0.07, 0.11), (0.05, 0.05), high), (0.0, y, z), look, solid=False)
    w.box((-0.02, 0.02), around(y, 0.02), (z + high, z + high + 0.03), w.new_look("plastic"), solid=False)


def _carton(w: Workbench, y: float, z: float) -> None:
    """Adds a carton of washing powder."""
    high = w.length(0.17, 0.24)
    w.box((-0.05, 0.05), around(y, 0.08), (z, z + high), w.new_look("bright"), solid=False)
    w.box((0.05, 0.052), around(y, 0.06), (z + 0.3 * high, z + 0.7 * high), w.look("paper"), solid=False)


def _basket(w: Workbench, x: float, y: float, z: float, wide: float, high: float) -> None:
    """Adds a basket with cloths in it."""
    w.mesh(frustum((0.24, 0.8 * wide), (0.30, wide), high), (x, y, z), w.look("wicker"), solid=False)
    w.mesh(frustum((0.26, 0.9 * wide), (0.14, 0.5 * wide), 0.04), (x, y, z + high), w.new_look("towel"), solid=False)


def _shoe_boxes(w: Workbench, y: float, z: float, room: float) -> None:
    """Adds one to three shoe boxes on top of each other."""
    for _ in range(min(w.whole(1, 3), int(room / 0.13))):
        look = w.new_look(w.choice(("cardboard", "bright", "paper")))
        w.box((-0.16, 0.15), around(y, 0.10), (z, z + 0.115), look, solid=False)
        z += 0.12


def _shoes(w: Workbench, y: float, z: float) -> None:
    """Adds a pair of shoes with their toes to the front."""
    look = w.new_look(w.choice(("leather", "bright", "dark")))
    for side in BOTH_SIDES:
        w.mesh(frustum((0.26, 0.09), (0.10, 0.07), 0.09, (-0.07, 0.0)), (0.0, y + 0.055 * side, z), look, solid=False)


def _stock(w: Workbench, y: Range, z: float, room: float, *, linen: bool) -> None:
    """Fills a board at height z, with `room` metres above it, with the goods of a closet (`linen`) or of a laundry."""
    count = max(1, int((y[1] - y[0]) / 0.31))
    pitch = (y[1] - y[0]) / count
    for i in range(count):
        at = y[0] + (i + 0.5) * pitch
        if linen:
            kind = w.choice(("folded", "folded", "boxes", "shoes"))
            if kind == "folded" or (kind == "boxes" and room < 0.14):
                _folded(w, 0.0, at, z, room)
            elif kind == "boxes":
                _shoe_boxes(w, at, z, room)
            else:
                _shoes(w, at, z)
        else:
            kind = w.choice(("bottles", "bottles", "carton", "basket", "folded"))
            if kind == "bottles":
                for side in BOTH_SIDES:
                    _bottle(w, at + 0.07 * side, z)
            elif kind == "carton":
                _carton(w, at, z)
            elif kind == "basket":
                _basket(w, 0.0, at, z, pitch - 0.05, w.choice((0.15, 0.18)))
            else:
                _folded(w, 0.0, at, z, room)


def _side_boards(w: Workbench, x: Range, y: Range, levels: list[float], height: float, look: Look) -> None:
    """Adds two side boards and shelves between them, without a back."""
    for edge in (y[0], y[1] - 0.02):
        w.box(x, (edge, edge + 0.02), (0.0, height), look)
    for z in levels:
        w.box(x, inset(y, 0.02), (z, z + 0.02), look)


def wire_shelf(w: Workbench, *, linen: bool) -> None:
    """Builds four metal boards between round posts, with the goods of a closet (`linen`) or of a laundry."""
    width, depth, height = w.width(0.70, 0.90), w.depth(0.36, 0.42), w.height(1.55, 1.75)
    metal, x, y = w.look("metal"), *parts.footprint(depth, width)
    w.legs(inset(x, 0.013), inset(y, 0.013), (0.0, height), 0.026, metal, round_=True)
    step = (height - 0.16) / 3
    for i in range(4):
        z = 0.12 + i * step
        w.box(inset(x, 0.01), inset(y, 0.01), (z, z + 0.02), metal)
        if i < 3:
            _stock(w, inset(y, 0.04), z + 0.02, step - 0.04, linen=linen)


def hamper_tower(w: Workbench) -> None:
    """Builds a tall case: two tilted laundry bins below, two boards with detergents above."""
    width, depth, height = w.width(0.60, 0.80), w.depth(0.36, 0.42), w.height(1.60, 1.85)
    look, x, y = parts.wood_look(w), *parts.footprint(depth, width)
    parts.open_case(w, x, y, (0.0, height), look)
    for z, room in ((0.74, 0.36), (1.14, height - 1.2)):
        w.box((x[0] + 0.012, x[1]), inset(y, 0.02), (z, z + 0.02), look)
        _stock(w, inset(y, 0.04), z + 0.02, room, linen=False)
    for side in BOTH_SIDES:
        span = parts.on_side(side, 0.01, 0.5 * width - 0.025)
        w.box((x[1] - 0.03, x[1] - 0.01), span, (0.05, 0.70), w.look("wicker"), tilt=0.05)
        w.box(
            (x[1], x[1] + 0.015), around(sum(span) / 2, 0.06), (0.58, 0.62), w.look("dark"),
            solid=False,
        )  # fmt: skip


def walk_in_case(w: Workbench) -> None:
    """Builds an open wardrobe case: drawers below, boards with folded clothes and boxes above."""
    width, depth, height = w.width(0.75, 1.00), w.depth(0.40, 0.46), w.height(1.75, 2.00)
    look, x, y = parts.wood_look(w), *parts.footprint(depth, width)
    parts.open_case(w, x, y, (0.0, height), look)
    w.box(inset(x, 0.012, parts.FRONT_M), inset(y, 0.02), (0.02, 0.62), look)
    parts.plain_drawers(w, x[1] - parts.FRONT_M, inset(y, 0.02), (0.03, 0.61), 3, 1, look, w.look("metal"), "bar")
    step = (height - 0.64) / 3
    for i in range(3):
        z = 0.62 + i * step
        if i:
            w.box((x[0] + 0.012, x[1]), inset(y, 0.02), (z, z + 0.02), look)
        _stock(w, inset(y, 0.04), z + (0.02 if i else 0.0), step - 0.05, linen=True)


def slatted_shelf(w: Workbench, *, linen: bool) -> None:
    """Builds slatted boards between wooden frames with a cross behind, with the goods of a closet or of a laundry."""
    width, depth, height = w.width(0.70, 0.95), w.depth(0.38, 0.44), w.height(1.50, 1.80)
    wood, iron, x, y = w.look("wood"), w.look("iron"), *parts.footprint(depth, width)
    for edge in centred(width, 0.02):
        for front in inset(x, 0.02):
            w.box(around(front, 0.02), around(edge, 0.02), (0.0, height), wood)
    step = (height - 0.10) / 3
    for i in range(4):
        z = 0.08 + i * step - (0.02 if i == 3 else 0.0)
        w.box(inset(x, 0.02), (-0.015, 0.015), (z - 0.02, z), wood, solid=False)
        for n in range(3):
            front = x[0] + 0.005 + n * (depth - 0.01) / 3
            w.box((front, front + (depth - 0.01) / 3 - 0.025), inset(y, 0.01), (z, z + 0.022), wood)
        if i < 3:
            _stock(w, inset(y, 0.06), z + 0.022, step - 0.04, linen=linen)
    for a, b in (inset(y, 0.03), (y[1] - 0.03, y[0] + 0.03)):
        w.bar((x[0], a, 0.15), (x[0], b, height - 0.1), 0.02, 0.004, iron, solid=False)


def drying_cupboard(w: Workbench) -> None:
    """Builds a low closed cupboard with a board over it on brackets, for detergents, and a rail below the board."""
    width, depth, height = w.width(0.70, 0.90), w.depth(0.38, 0.44), w.height(1.45, 1.65)
    look, metal, x, y = w.look("lacquer"), w.look("chrome"), *parts.footprint(depth, width)
    w.box((x[0], x[1] - parts.FRONT_M), y, (0.06, 0.86), look)
    w.box(inset(x, 0.03, 0.06), inset(y, 0.02), (0.0, 0.06), w.look("dark"))
    parts.plain_doors(w, x[1] - parts.FRONT_M, y, (0.07, 0.85), 2, look, w.look("metal"), "knob")
    _stock(w, inset(y, 0.05), 0.86, 0.3, linen=False)
    for edge in centred(width, 0.015):
        w.box((x[0], x[0] + 0.03), around(edge, 0.015), (0.86, height), look)
    w.box((x[0], x[0] + 0.30), y, (height, height + 0.025), look)
    w.rod_y((x[0] + 0.015, height - 0.12), inset(y, 0.02), 0.01, metal)
    _folded(w, x[0] + 0.15, -0.2 * width, height + 0.025, 0.3)
    _basket(w, x[0] + 0.15, 0.2 * width, height + 0.025, 0.3, 0.16)


def shoe_bench(w: Workbench) -> None:
    """Builds pigeonholes for shoes below a rail-high stack of open boxes with folded clothes."""
    width, depth, height = w.width(0.75, 1.00), w.depth(0.36, 0.42), w.height(1.60, 1.80)
    wood, x, y = w.look("wood"), *parts.footprint(depth, width)
    levels = [0.0, 0.22, 0.44, 0.95, height - 0.02]
    _side_boards(w, x, y, levels, height, wood)
    for z, room in ((0.02, 0.2), (0.24, 0.2)):
        for n in range(3):
            if w.chance(0.7):
                _shoes(w, (n - 1) * 0.3 * width, z)
        w.box((x[0], x[0] + 0.012), inset(y, 0.02), (z, z + room), wood, solid=False)
    for z, room in ((0.46, 0.47), (0.97, height - 1.01)):
        _stock(w, inset(y, 0.04), z, room, linen=True)


def _hung(w: Workbench, x: float, z: float, y: Range, long: float) -> None:
    """Adds two or three cloths that hang over a bar along y."""
    count = w.whole(2, 3)
    pitch = (y[1] - y[0]) / count
    for i in range(count):
        wide, high = w.length(0.65, 0.85) * pitch, w.length(0.6, 1.0) * long
        cloth = w.new_look(w.choice(("towel", "bright", "linen")))
        at = y[0] + (i + 0.5) * pitch
        for side in BOTH_SIDES:
            w.box(
                around(x + 0.012 * side, 0.005), around(at, 0.5 * wide),
                (z - (high if side > 0 else 0.7 * high), z + 0.012), cloth, solid=False, tilt=-0.03 * side,
            )  # fmt: skip


def winged_airer(w: Workbench) -> None:
    """Builds a folding drying rack: crossed legs, five rods and laundry over some of them."""
    width, high = w.length(0.90, 1.05), w.length(0.90, 1.00)
    metal = w.look("metal")
    for y in centred(width):
        for sign in BOTH_SIDES:
            w.bar((sign * 0.26, y, 0.0), (-sign * 0.24, y, high), 0.022, 0.022, metal)
        w.bar((-0.26, y, high), (0.26, y, high), 0.022, 0.022, metal)
    for n in range(5):
        x = -0.24 + 0.12 * n
        w.bar((x, -0.5 * width, high), (x, 0.5 * width, high), 0.010 if n % 4 else 0.02, 0.010, metal)
        if n in (0, 2, 4):
            _hung(w, x, high, (-0.45 * width, 0.45 * width), 0.6)


def ladder_airer(w: Workbench) -> None:
    """Builds a tower for drying: two upright frames with three tiers of rods."""
    width, high = w.length(0.62, 0.72), w.length(1.45, 1.60)
    metal, plastic = w.look("metal"), w.look("plastic")
    for y in centred(width):
        for x in (-0.22, 0.22):
            w.bar((x, y, 0.0), (x, y, high), 0.024, 0.024, metal)
        w.bar((-0.22, y, high), (0.22, y, high), 0.024, 0.024, plastic)
    for tier in range(3):
        z = high - 0.06 - tier * 0.46
        for side in BOTH_SIDES:
            w.bar((-0.22, side * 0.5 * width, z), (0.22, side * 0.5 * width, z), 0.020, 0.020, metal)
        for x in (-0.22, 0.0, 0.22):
            w.bar((x, -0.5 * width, z), (x, 0.5 * width, z), 0.012, 0.012, metal, solid=x * x > 0.04)
        _hung(w, 0.0, z, (-0.44 * width, 0.44 * width), 0.38)


def clothes_horse(w: Workbench) -> None:
    """Builds a wooden clothes horse: two frames that lean against each other, with bars and laundry."""
    width, high, wood = w.length(0.75, 0.95), w.length(1.05, 1.20), w.look("wood")
    for sign in BOTH_SIDES:
        for side in BOTH_SIDES:
            y = side * (0.5 * width - (0.015 if sign > 0 else 0.045))
            w.bar((sign * 0.27, y, 0.0), (-sign * 0.015, y, high), 0.022, 0.03, wood)
        for share in (0.30, 0.62, 0.94):
            x, z = sign * 0.27 * (1.0 - share), share * high
            w.bar((x, -0.5 * width + 0.01, z), (x, 0.5 * width - 0.01, z), 0.018, 0.018, wood)
            if share > 0.5 and w.chance(0.8):
                _hung(w, x, z, (-0.40 * width, 0.40 * width), 0.45)


def airer_frame(w: Workbench) -> None:
    """Builds a gate-shaped drying rack: a rail high up with hanging sheets, a tray of slats below."""
    width, high, iron = w.length(0.90, 1.10), w.length(1.35, 1.50), w.look("iron")
    for y in centred(width):
        w.bar((0.0, y, 0.02), (0.0, y, high), 0.028, 0.028, iron)
        w.bar((-0.24, y, 0.014), (0.24, y, 0.014), 0.028, 0.028, iron)
        w.bar((-0.20, y, high - 0.05), (0.20, y, high - 0.05), 0.020, 0.020, iron)
    for x in (-0.20, 0.0, 0.20):
        w.bar((x, -0.5 * width, high - 0.05), (x, 0.5 * width, high - 0.05), 0.018, 0.018, iron)
    w.box((-0.18, 0.18), centred(width), (0.22, 0.24), w.look("wood"))
    _basket(w, 0.0, 0.2 * width, 0.24, 0.36, 0.2)
    _hung(w, -0.20, high - 0.05, (-0.42 * width, 0.42 * width), 0.8)
    _hung(w, 0.20, high - 0.05, (-0.42 * width, 0.42 * width), 0.6)


STYLES = (
    Style("shelving", "wire_shelf_laundry", "train", partial(wire_shelf, linen=False), ("laundry",)),
    Style("shelving", "hamper_tower", "train", hamper_tower, ("laundry",)),
    Style("shelving", "slatted_shelf_laundry", "heldout", partial(slatted_shelf, linen=False), ("laundry",)),
    Style("shelving", "drying_cupboard", "heldout", drying_cupboard, ("laundry",)),
    Style("shelving", "wire_shelf_linen", "train", partial(wire_shelf, linen=True), ("linen",)),
    Style("shelving", "walk_in_case", "train", walk_in_case, ("linen",)),
    Style("shelving", "slatted_shelf_linen", "heldout", partial(slatted_shelf, linen=True), ("linen",)),
    Style("shelving", "shoe_bench", "heldout", shoe_bench, ("linen",)),
    Style("clothes", "winged_airer", "train", winged_airer, ("drying",)),
    Style("clothes", "ladder_airer", "train", ladder_airer, ("drying",)),
    Style("clothes", "clothes_horse", "heldout", clothes_horse, ("drying",)),
    Style("clothes", "airer_frame", "heldout", airer_frame, ("drying",)),
)
