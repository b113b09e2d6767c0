"""Tops and bodies of tables and cabinets."""

from __future__ import annotations

from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts.looks import glass_edge, tinted_glass
from sim.homes.housegen.furniture.parts.spans import BOTH_SIDES, footprint, inset, on_side
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


def open_case(w: Workbench, x: Range, y: Range, z: Range, look: Look) -> None:
    """Adds the boards of a box that is open in front."""
    board = 0.02
    for edge in (y[0], y[1] - board):
        w.box(x, (edge, edge + board), z, look)
    for low in (z[0], z[1] - board):
        w.box(x, inset(y, board), (low, low + board), look)
    w.box((x[0], x[0] + 0.012), inset(y, board), inset(z, board), look)
