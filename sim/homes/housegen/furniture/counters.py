"""Kitchen counters and islands.

Sizes follow the European kitchen grid (EN 1116: modules of 0.60 m, worktop 0.85-0.92 m high and 0.60-0.65 m deep) and
Neufert, Architects' Data, for islands and bars.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, inset
from sim.homes.housegen.furniture.shapes import chamfered_box, drape
from sim.homes.housegen.furniture.workbench import Range, Workbench

_TOP = 0.035
"""Thickness of a worktop."""
_HOB_APART = 0.9
"""Distance between the middles of a sink and a hob that leaves 0.3 m of worktop between them."""
_OPEN_BAY = 0.3
"""Least width of the open shelf next to a cupboard; the cupboard takes up what is less."""


def _run_base(w: Workbench, x: Range, y: Range, z: float, look: Look, hole: tuple[Range, Range] | None) -> None:
    """Adds cupboards under a worktop, lower below a sink, on a recessed plinth."""
    w.box((x[0], x[1] - 0.06), y, (0.0, 0.10), w.look("dark"))
    if hole is None:
        w.box(x, y, (0.10, z), look)
        return
    hy0, hy1 = hole[1]
    w.box(x, (y[0], hy0), (0.10, z), look)
    w.box(x, (hy1, y[1]), (0.10, z), look)
    w.box(x, (hy0, hy1), (0.10, z - 0.16), look)
    w.box((x[1] - 0.04, x[1]), (hy0, hy1), (z - 0.16, z), look)


def _worktop(w: Workbench, x: Range, y: Range, top: float, look: Look, hole: tuple[Range, Range] | None) -> None:
    """Adds a slab with its upper face at `top`, if asked with a hole for a sink, given as x and y ranges."""
    z = (top - _TOP, top)
    if hole is None:
        w.box(x, y, z, look)
        return
    (hx0, hx1), (hy0, hy1) = hole
    w.box(x, (y[0], hy0), z, look)
    w.box(x, (hy1, y[1]), z, look)
    w.box((x[0], hx0), (hy0, hy1), z, look)
    w.box((hx1, x[1]), (hy0, hy1), z, look)


def _fittings(w: Workbench, x: Range, y: Range, z: float, *, back: float = 0.05) -> tuple[Range, Range] | None:
    """Adds a sink and a hob to a worktop with its upper face at z; hints `with_sink`, `with_hob`.

    Objects may stand on the rest of the worktop, `back` away from its rear edge.

    Returns:
        The x and y ranges of the sink's hole, or None.
    """
    width, taken, hole, sink_y = y[1] - y[0], [], None, None
    with_sink = width >= 0.75 and w.flag("with_sink", 0.35)
    with_hob = width > 1.3 and w.flag("with_hob", 0.25)
    if with_sink:
        from_end = 0.38 if with_hob else 0.6  # 0.3 m of worktop before a cooker at the end
        sink_y = w.length(y[0] + from_end, y[1] - from_end) if width > 2 * from_end else 0.5 * (y[0] + y[1])
        low, high = y[1] - 0.36 - _HOB_APART, y[0] + 0.36 + _HOB_APART
        if with_hob and y[0] + 0.3 < low < sink_y < high:
            sink_y = low
        w.put(w.make("sink", use="inset"), (0.0, sink_y, z - 0.18))
        hole = ((-0.20, 0.20), around(sink_y, 0.24))
        taken.append(around(sink_y, 0.30))
    if with_hob:
        places = [p for p in inset(y, 0.36) if sink_y is None or abs(p - sink_y) > _HOB_APART - 0.01]
        if places:
            place = w.choice(places)
            w.put(w.make("appliances", use="hob"), (0.0, place, z))
            taken.append(around(place, 0.32))
    for span in _free_ranges(y, taken):
        w.top(inset(x, back, 0.05), inset(span, 0.05), z)
    return hole


def _free_ranges(y: Range, taken: Sequence[Range]) -> list[Range]:
    """Returns the parts of a range outside the taken ones that are longer than 0.25 m."""
    free, start = [], y[0]
    for low, high in sorted(taken):
        free.append((start, low))
        start = high
    free.append((start, y[1]))
    return [r for r in free if r[1] - r[0] > 0.25]


def kitchen_run(w: Workbench) -> None:
    """Builds a straight run with doors, a row of drawers, a worktop and optionally a sink and a hob."""
    width, depth, height = w.width(1.20, 3.00), w.depth(0.60, 0.64), w.height(0.88, 0.92)
    front, top = w.look("lacquer") if w.chance(0.6) else w.look("wood"), w.look("stone")
    x, y = parts.footprint(depth, width)
    hole = _fittings(w, x, y, height)
    under = height - _TOP
    face = x[1] - 0.04
    _run_base(w, (x[0], face), y, under, front, hole)
    _worktop(w, x, y, height, top, hole)
    count = max(1, round(width / 0.6))
    pitch = width / count
    drawer_unit = w.whole(0, count - 1)
    metal = w.look("metal")
    for i in range(count):
        span = (y[0] + i * pitch, y[0] + (i + 1) * pitch)
        if i == drawer_unit:
            parts.plain_drawers(w, face, span, (0.11, under), 3, 1, front, metal, "bar")
        else:
            parts.plain_doors(w, face, span, (0.11, under), 1, front, metal, "bar")


def island(w: Workbench) -> None:
    """Builds a free-standing block with an overhanging top for stools on its front side."""
    width, depth, height = w.width(1.40, 2.40), w.depth(0.85, 1.05), w.height(0.88, 0.92)
    body, top = w.look("lacquer"), w.look("stone")
    x, y = parts.footprint(depth, width)
    w.box(inset(x, 0.02, 0.28), inset(y, 0.03), (0.08, height - 0.045), body)
    w.box(inset(x, 0.08, 0.32), inset(y, 0.08), (0.0, 0.08), w.look("dark"))
    w.box(x, y, (height - 0.045, height), top)
    panels = max(2, round(width / 0.6))
    pitch = (width - 0.06) / panels
    for i in range(panels):
        y0 = y[0] + 0.03 + i * pitch
        w.box((x[1] - 0.28, x[1] - 0.265), (y0 + 0.03, y0 + pitch - 0.03), (0.14, height - 0.10), body, solid=False)
    w.top(inset(x, 0.1), inset(y, 0.1), height)


def open_run(w: Workbench) -> None:
    """Builds a run with a thick wooden top on a steel frame, a cupboard below its sink and an open shelf of crates."""
    width, depth, height = w.width(1.20, 3.00), w.depth(0.60, 0.66), w.height(0.87, 0.92)
    steel, wood, front = w.look("metal"), w.look("wood"), w.look("lacquer")
    x, y = parts.footprint(depth, width)
    hole = _fittings(w, x, y, height)
    _worktop(w, x, y, height, wood, hole)
    w.legs(inset(x, 0.01, 0.02), inset(y, 0.01), (0.0, height - _TOP), 0.045, steel)
    w.box(inset(x, 0.02, 0.03), inset(y, 0.03), (0.18, 0.205), wood)
    low = high = math.inf
    if hole is not None:
        low, high = hole[1][0] - 0.04, hole[1][1] + 0.04
        if low - y[0] < _OPEN_BAY:
            low = y[0] + 0.07
        if y[1] - high < _OPEN_BAY:
            high = y[1] - 0.07
        body = inset(x, 0.01, 0.045)
        w.box((body[0], body[1] - 0.05), (low, high), (0.0, 0.08), w.look("dark"))
        w.box(body, (low, high), (0.08, height - 0.20), front)
        for side in (low, high):  # cheeks hide the bowl of the sink between the cupboard and the top
            w.box(body, around(side, 0.01), (height - 0.20, height - _TOP), front)
        count = 1 + (high - low > 0.5)
        parts.plain_doors(w, body[1], (low, high), (0.085, height - _TOP - 0.01), count, front, steel, "bar")
    count = min(3, int((width - 0.02) / 0.38))
    for c in ((n + 0.5) * width / count - 0.5 * width for n in range(count)):
        if not low - 0.21 < c < high + 0.21:
            w.mesh(chamfered_box((0.40, 0.34, 0.26), 0.015), (0.0, c, 0.335), w.look("wicker"), solid=False)


def slab_run(w: Workbench) -> None:
    """Builds a modern run with handleless drawers in two tiers, a thick top and a low upstand."""
    width, depth, height = w.width(1.20, 3.00), w.depth(0.60, 0.64), w.height(0.89, 0.93)
    front, top = w.look("lacquer") if w.chance(0.5) else w.look("wood"), w.look("stone")
    x, y = parts.footprint(depth, width)
    hole = _fittings(w, x, y, height, back=0.06)
    under, face = height - _TOP, x[1] - 0.03
    _run_base(w, (x[0], face), y, under, w.look("dark"), hole)
    _worktop(w, x, y, height, top, hole)
    w.box((x[0], x[0] + 0.018), y, (height, height + 0.045), top)
    count = max(1, round(width / 0.9))
    pitch = width / count
    split = 0.11 + 0.62 * (under - 0.11)
    for i in range(count):
        span = (y[0] + i * pitch + 0.003, y[0] + (i + 1) * pitch - 0.003)
        w.box((face, face + 0.02), span, (0.105, split - 0.015), front, solid=False)
        w.box((face, face + 0.02), span, (split + 0.003, under - 0.02), front, solid=False)


def breakfast_bar(w: Workbench) -> None:
    """Builds a free-standing bar with shelves to the kitchen, a panelled front and a raised narrow top for stools."""
    width, depth, height = w.width(1.30, 2.20), w.depth(0.70, 0.85), w.height(0.88, 0.92)
    body, top = w.look("wood"), w.look("stone")
    x, y = parts.footprint(depth, width)
    wall = x[1] - 0.26
    w.box((x[0] + 0.03, wall), inset(y, 0.02), (0.08, height - 0.035), body)
    w.box((x[0] + 0.08, wall), inset(y, 0.06), (0.0, 0.08), w.look("dark"))
    w.box((x[0], wall), y, (height - 0.035, height), top)
    w.box((wall, wall + 0.08), inset(y, 0.02), (0.0, height + 0.14), body)
    w.box((wall - 0.06, x[1]), y, (height + 0.14, height + 0.18), top)
    parts.plain_drawers(
        w,
        x[0] + 0.03 - parts.FRONT_M,
        inset(y, 0.02),
        (0.10, height - 0.04),
        2,
        max(2, round(width / 0.6)),
        body,
        w.look("metal"),
        "none",
    )
    slats = max(6, round(width / 0.14))
    for i in range(slats):
        c = y[0] + 0.02 + (i + 0.5) * (width - 0.04) / slats
        w.box((wall + 0.078, wall + 0.092), around(c, 0.045), (0.06, height + 0.12), body, solid=False)
    w.top((x[0] + 0.06, wall - 0.1), inset(y, 0.1), height)


def trolley(w: Workbench) -> None:
    """Builds an island on legs: a butcher's block over a drawer, a slatted shelf, hooks and a rail."""
    width, depth, height, wood = w.width(1.10, 1.60), w.depth(0.60, 0.75), w.height(0.88, 0.92), w.look("wood")
    frame = w.look("lacquer")
    x, y = parts.footprint(depth, width)
    w.box(x, y, (height - 0.06, height), wood)
    w.box(inset(x, 0.04), inset(y, 0.05), (height - 0.22, height - 0.06), frame)
    parts.plain_drawers(
        w, x[1] - 0.04, inset(y, 0.06), (height - 0.21, height - 0.065), 1, 2, frame, w.look("metal"), "cup"
    )
    w.legs(inset(x, 0.03), inset(y, 0.03), (0.0, height - 0.06), 0.07, frame)
    for z in (0.16, 0.46):
        w.box(inset(x, 0.04), inset(y, 0.04), (z, z + 0.022), wood)
    w.mesh(chamfered_box((0.38, 0.40, 0.24), 0.015), (0.0, -0.22 * width, 0.30), w.look("wicker"), solid=False)
    w.cylinder((0.0, 0.2 * width), (0.48, 0.62), 0.12, w.look("steel"), solid=False)
    w.top(inset(x, 0.1), inset(y, 0.1), height)


def curtained_run(w: Workbench) -> None:
    """Builds a country kitchen: a thick wooden top on painted piers, with cloth curtains instead of doors."""
    width, depth, height = w.width(1.20, 3.00), w.depth(0.60, 0.66), w.height(0.87, 0.91)
    wood, pier, cloth = w.look("wood"), w.look("lacquer"), w.look("curtain")
    x, y = parts.footprint(depth, width)
    hole = _fittings(w, x, y, height)
    under = height - _TOP
    _worktop(w, x, y, height, wood, hole)
    w.box((x[0], x[0] + 0.03), y, (0.0, under), pier)
    bays = max(1, round(width / 0.8))
    pitch = (width - 0.10) / bays
    for i in range(bays + 1):
        c = y[0] + 0.05 + i * pitch
        beside_sink = hole is None or not hole[1][0] - 0.06 < c < hole[1][1] + 0.06
        w.box((x[0] + 0.03 if beside_sink else x[1] - 0.10, x[1] - 0.03), around(c, 0.05), (0.0, under), pier)
    if width <= 0.3:  # two piers, without a curtain between them
        return
    w.rod_y((x[1] - 0.05, under - 0.03), inset(y, 0.1), 0.008, w.look("iron"), solid=False)
    for i in range(bays):
        c = y[0] + 0.05 + (i + 0.5) * pitch
        w.mesh(
            drape(round(pitch - 0.11, 3), round(under - 0.08, 3), 0.035, 6), (x[1] - 0.07, c, 0.05), cloth, solid=False
        )
    w.box(inset(x, 0.03, 0.10), inset(y, 0.1), (0.0, 0.45), w.look("dark"))


def waterfall(w: Workbench) -> None:
    """Builds an island of stone slabs: the top turns down at both ends, with dark fronts set back between them."""
    width, depth, height, stone = w.width(1.40, 2.40), w.depth(0.85, 1.05), w.height(0.90, 0.94), w.look("stone")
    x, y = parts.footprint(depth, width)
    w.box(x, y, (height - 0.06, height), stone)
    for side in BOTH_SIDES:
        w.box(x, parts.on_side(side, 0.5 * width - 0.06, 0.5 * width), (0.0, height - 0.06), stone)
    body = w.look("lacquer")
    w.box(inset(x, 0.04, 0.30), inset(y, 0.06), (0.08, height - 0.06), body)
    w.box(inset(x, 0.10, 0.36), inset(y, 0.06), (0.0, 0.08), w.look("dark"))
    parts.plain_doors(
        w, x[1] - 0.30, inset(y, 0.07), (0.09, height - 0.07), max(2, round(width / 0.6)), body, w.look("brass"), "none"
    )
    w.top(inset(x, 0.1), inset(y, 0.1), height)


STYLES = (
    Style("counter", "kitchen_run", "train", kitchen_run, ("run",)),
    Style("counter", "island", "train", island, ("island",)),
    Style("counter", "open_run", "heldout", open_run, ("run",)),
    Style("counter", "slab_run", "train", slab_run, ("run",)),
    Style("counter", "breakfast_bar", "train", breakfast_bar, ("island",)),
    Style("counter", "trolley", "train", trolley, ("island",)),
    Style("counter", "curtained_run", "heldout", curtained_run, ("run",)),
    Style("counter", "waterfall", "heldout", waterfall, ("island",)),
)
