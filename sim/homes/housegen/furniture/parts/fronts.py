"""Fronts of doors and drawers with their handles. A front lies on the plane x and faces +x.

All fronts are flat, with one of four handles.
"""

from __future__ import annotations

from typing import Literal

from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts.looks import darker
from sim.homes.housegen.furniture.parts.spans import around, inset
from sim.homes.housegen.furniture.workbench import Point, Range, Workbench

FRONT_M = 0.018
"""Thickness of a door or drawer front, the usual board."""
GAP_M = 0.004
"""Half the joint between two fronts."""
SHADOW_M = 0.003
"""Thickness of the dark layer behind fronts, which shows in their joints where no shadows are rendered."""

PlainHandleKind = Literal["bar", "knob", "cup", "none"]


def plain_doors(
    w: Workbench,
    x: float,
    y: Range,
    z: Range,
    count: int,
    look: Look,
    metal: Look,
    handle: PlainHandleKind,
    *,
    low_handles: bool = False,
) -> None:
    """Adds flat hinged doors side by side, with handles near the upper or lower edge, or half-way up tall doors."""
    pitch = (y[1] - y[0]) / count
    if count > 1:
        _plain_joints(w, x, y, z, look)
    tall = z[1] - z[0]
    from_edge = min(0.22, 0.35 * tall)
    grip = z[0] + from_edge if low_handles else z[1] - from_edge
    if tall > 1.2:
        grip = z[0] + 0.52 * tall
    for i in range(count):
        left = y[0] + i * pitch
        w.box((x, x + FRONT_M), (left + GAP_M, left + pitch - GAP_M), inset(z, GAP_M), look, solid=False)
        hand = left + (pitch - 0.045 if i % 2 == 0 and count > 1 else 0.045)
        length = min(0.16, 0.4 * tall)
        _plain_handle(w, handle, (x + FRONT_M, hand, grip), (0.0, length), metal)


def plain_drawers(
    w: Workbench,
    x: float,
    y: Range,
    z: Range,
    rows: int,
    columns: int,
    look: Look,
    metal: Look,
    handle: PlainHandleKind = "bar",
) -> None:
    """Adds a grid of equal flat drawer fronts, each with a handle."""
    wide, tall = (y[1] - y[0]) / columns, (z[1] - z[0]) / rows
    if rows * columns > 1:
        _plain_joints(w, x, y, z, look)
    for row in range(rows):
        for column in range(columns):
            y0, z0 = y[0] + column * wide, z[0] + row * tall
            w.box((x, x + FRONT_M), (y0 + GAP_M, y0 + wide - GAP_M), (z0 + GAP_M, z0 + tall - GAP_M), look, solid=False)
            at = (x + FRONT_M, y0 + 0.5 * wide, z0 + 0.55 * tall)
            _plain_handle(w, handle, at, (min(0.22, 0.4 * wide), 0.0), metal)


def _plain_joints(w: Workbench, x: float, y: Range, z: Range, look: Look) -> None:
    """Adds the dark layer behind plain fronts."""
    y, z = inset(y, GAP_M), inset(z, GAP_M)
    w.box((x, x + SHADOW_M), y, z, darker(look), solid=False)


def _plain_handle(w: Workbench, kind: PlainHandleKind, at: Point, lengths: tuple[float, float], look: Look) -> None:
    """Adds a handle at a point of the front; a bar has these lengths along y and z."""
    x, y, z = at
    if kind == "bar":
        dy, dz = (0.5 * length + 0.006 for length in lengths)
        w.box((x, x + 0.024), around(y, dy), around(z, dz), look, solid=False)
    elif kind == "knob":
        w.ball((x + 0.012, y, z), 0.016, look, solid=False)
    elif kind == "cup":
        w.ellipsoid((x, y, z), (0.024, 0.045, 0.018), look, solid=False)
