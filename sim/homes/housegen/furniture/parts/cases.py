"""Tops and bodies of tables and cabinets, and worktops with their sink and hob."""

from __future__ import annotations

from collections.abc import Sequence

from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts.looks import glass_edge, tinted_glass
from sim.homes.housegen.furniture.parts.spans import BOTH_SIDES, around, footprint, inset, on_side
from sim.homes.housegen.furniture.workbench import Range, Workbench

GLASS_EDGE_M = 0.008
"""Width of the opaque edge of a glass top, which is a pixel or more at 3 m."""


def slab(w: Workbench, depth: float, width: float, z: Range, look: Look) -> tuple[Range, Range]:
    """Adds a rectangular top on which objects may stand, and returns its x and y ranges.

    A top of glass gets a visible tint and an opaque edge, as thick glass has.
    """
    x, y = footprint(depth, width)
    if look.rgba[3] < 1.0:
        look = tinted_glass(look)
        rim = (z[0] - 0.001, z[1] + 0.001)
        for end in BOTH_SIDES:
            w.box(on_side(end, 0.5 * depth - GLASS_EDGE_M, 0.5 * depth), y, rim, glass_edge(look), solid=False)
            span = on_side(end, 0.5 * width - GLASS_EDGE_M, 0.5 * width)
            w.box(inset(x, GLASS_EDGE_M), span, rim, glass_edge(look), solid=False)
    w.box(x, y, z, look)
    w.top(inset(x, 0.05), inset(y, 0.05), z[1])
    return x, y


def round_top(w: Workbench, radius: float, z: Range, look: Look) -> None:
    """Adds a round top on which objects may stand."""
    w.cylinder((0.0, 0.0), z, radius, look)
    half = 0.65 * radius
    w.top((-half, half), (-half, half), z[1])


def case(w: Workbench, depth: float, width: float, z: Range, look: Look, *, foot: float = 0.0) -> tuple[float, Range]:
    """Adds a closed body on which objects may stand, on a dark plinth of height `foot`.

    Returns:
        The x of its front plane and its y range.
    """
    x, y = footprint(depth, width)
    w.box(x, y, z, look)
    if foot:
        w.box(inset(x, 0.02, 0.05), inset(y, 0.02), (z[0] - foot, z[0]), w.look("dark"))
    w.top(inset(x, 0.03), inset(y, 0.05), z[1])
    return x[1], y


def open_case(w: Workbench, x: Range, y: Range, z: Range, board: float, look: Look) -> None:
    """Adds the boards of a box that is open in front."""
    for edge in (y[0], y[1] - board):
        w.box(x, (edge, edge + board), z, look)
    for low in (z[0], z[1] - board):
        w.box(x, inset(y, board), (low, low + board), look)
    w.box((x[0], x[0] + 0.012), inset(y, board), inset(z, board), look)


def worktop(w: Workbench, x: Range, y: Range, z: Range, look: Look, hole: tuple[Range, Range] | None) -> None:
    """Adds a slab, if asked with a rectangular hole, given as x and y ranges, for a sink."""
    if hole is None:
        w.box(x, y, z, look)
        return
    (hx0, hx1), (hy0, hy1) = hole
    w.box(x, (y[0], hy0), z, look)
    w.box(x, (hy1, y[1]), z, look)
    w.box((x[0], hx0), (hy0, hy1), z, look)
    w.box((hx1, x[1]), (hy0, hy1), z, look)


_HOB_APART = 0.9
"""Distance between the middles of a sink and a hob that leaves 0.3 m of worktop between them."""


def worktop_fittings(w: Workbench, y: Range, z: float) -> tuple[tuple[Range, Range] | None, list[Range]]:
    """Adds a sink and a hob to a worktop with its upper face at z; hints `with_sink`, `with_hob`.

    Returns:
        The x and y ranges of the sink's hole, or None, and the y ranges that stay free.
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
    return hole, _free_ranges(y, taken)


def _free_ranges(y: Range, taken: Sequence[Range]) -> list[Range]:
    """Returns the parts of a range outside the taken ones that are longer than 0.25 m."""
    free, start = [], y[0]
    for low, high in sorted(taken):
        free.append((start, low))
        start = high
    free.append((start, y[1]))
    return [r for r in free if r[1] - r[0] > 0.25]
