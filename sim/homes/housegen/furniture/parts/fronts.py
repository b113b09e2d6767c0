"""Fronts of doors and drawers with their handles. A front lies on the plane x and faces +x.

The `plain_` functions make flat fronts with one of four handles; the `styled_` functions choose the design of the
front and the handle from more kinds. Their sizes differ, so that the furniture of both is different.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Literal

import numpy as np

from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts.looks import darker
from sim.homes.housegen.furniture.parts.spans import BOTH_SIDES
from sim.homes.housegen.furniture.shapes import chamfered_box
from sim.homes.housegen.furniture.workbench import Point, Range, Workbench

FRONT_M = 0.018
"""Thickness of a door or drawer front, the usual board."""
GAP_M = 0.004
"""Half the joint between two fronts."""
_SHADOW_M = 0.003
"""Thickness of the dark layer behind fronts, which shows in their joints where no shadows are rendered."""

PlainHandleKind = Literal["bar", "knob", "cup", "none"]
HandleKind = Literal["bar", "knob", "cup", "drop", "tab", "slot", "rail", "none"]
FrontKind = Literal["flat", "frame", "raised", "cane", "slats"]


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
    inset = min(0.22, 0.35 * tall)
    grip = z[0] + inset if low_handles else z[1] - inset
    if tall > 1.2:
        grip = z[0] + 0.52 * tall
    for i in range(count):
        left = y[0] + i * pitch
        w.box((x, x + FRONT_M), (left + GAP_M, left + pitch - GAP_M), (z[0] + GAP_M, z[1] - GAP_M), look, solid=False)
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
    y, z = (y[0] + GAP_M, y[1] - GAP_M), (z[0] + GAP_M, z[1] - GAP_M)
    w.box((x, x + _SHADOW_M), y, z, darker(look), solid=False)


def _plain_handle(w: Workbench, kind: PlainHandleKind, at: Point, lengths: tuple[float, float], look: Look) -> None:
    """Adds a handle at a point of the front; a bar has these lengths along y and z."""
    x, y, z = at
    if kind == "bar":
        dy, dz = (0.5 * length + 0.006 for length in lengths)
        w.box((x, x + 0.024), (y - dy, y + dy), (z - dz, z + dz), look, solid=False)
    elif kind == "knob":
        w.ball((x + 0.012, y, z), 0.016, look, solid=False)
    elif kind == "cup":
        w.ellipsoid((x, y, z), (0.024, 0.045, 0.018), look, solid=False)


def styled_doors(
    w: Workbench, x: float, y: Range, z: Range, count: int, look: Look, metal: Look, front: FrontKind, grip: HandleKind
) -> None:
    """Adds hinged doors side by side, with handles where they meet."""
    _styled_joints(w, x, y, z, look)
    pitch, tall = (y[1] - y[0]) / count, z[1] - z[0]
    up = z[0] + (0.5 if tall > 1.0 else 0.68) * tall
    for i in range(count):
        left = y[0] + i * pitch
        face = min(front_panel(w, x, (left, left + pitch), z, look, front), x + FRONT_M + 0.002)
        hand = left + (pitch - 0.035 if i % 2 == 0 and count > 1 else 0.035)
        handle(w, grip, (face, hand, up), min(0.5 * tall if grip == "rail" else 0.18, 0.5 * tall), metal, upright=True)


def styled_drawers(
    w: Workbench,
    x: float,
    y: Range,
    edges: Sequence[float],
    look: Look,
    metal: Look,
    front: FrontKind,
    grip: HandleKind,
    columns: int = 1,
) -> None:
    """Adds drawers in rows between the heights `edges`, in columns side by side."""
    _styled_joints(w, x, y, (edges[0], edges[-1]), look)
    pitch = (y[1] - y[0]) / columns
    for low, high in itertools.pairwise(edges):
        for column in range(columns):
            left = y[0] + column * pitch
            face = front_panel(w, x, (left, left + pitch), (low, high), look, front)
            middle, up = left + 0.5 * pitch, 0.5 * (low + high)
            if grip in ("slot", "rail") or high - low < 0.09:
                up, face = high - 0.025, min(face, x + FRONT_M + 0.002)
            if grip == "knob" and pitch > 0.5:
                for side in BOTH_SIDES:
                    handle(w, grip, (face, middle + side * 0.28 * pitch, up), 0.0, metal)
            else:
                wide = 0.9 * pitch if grip == "rail" else min(0.4 * pitch, 0.26)
                handle(w, grip, (face, middle, up), wide, metal)


def graded_rows(low: float, high: float, rows: int, growth: float) -> list[float]:
    """Returns the edges of rows between two heights; each row is taller than the one above it by `growth`."""
    shares = np.array([growth**i for i in range(rows)][::-1])
    return [low, *(low + (high - low) * np.cumsum(shares / shares.sum())).tolist()]


def front_panel(w: Workbench, x: float, y: Range, z: Range, look: Look, kind: FrontKind) -> float:
    """Adds one door or drawer front.

    Returns:
        The x of its face, where a handle belongs.
    """
    face = x + FRONT_M
    y, z = (y[0] + GAP_M, y[1] - GAP_M), (z[0] + GAP_M, z[1] - GAP_M)
    w.box((x, face), y, z, look, solid=False)
    edge = min(0.06, 0.22 * (y[1] - y[0]), 0.22 * (z[1] - z[0]))
    y, z = (y[0] + edge, y[1] - edge), (z[0] + edge, z[1] - edge)
    if kind == "frame":
        w.box((x, face + 0.001), y, z, darker(look, 0.8), solid=False)
        w.box((x, face + 0.002), (y[0] + 0.006, y[1] - 0.006), (z[0], z[1] - 0.008), look, solid=False)
    elif kind == "raised":
        w.box((x, face + 0.001), y, z, darker(look, 0.7), solid=False)
        size = (0.03, round(y[1] - y[0] - 0.02, 3), round(z[1] - z[0] - 0.02, 3))
        middle = (face, 0.5 * (y[0] + y[1]), 0.5 * (z[0] + z[1]))
        w.mesh(chamfered_box(size, 0.012), middle, look, solid=False)
    elif kind == "cane":
        w.box((x, face + 0.002), y, z, w.look("wicker"), solid=False)
    elif kind == "slats":
        _slats(w, (x, face), y, z, look)
    return face + (0.015 if kind == "raised" else 0.002 if kind in ("frame", "cane") else 0.0)


def _slats(w: Workbench, x: Range, y: Range, z: Range, look: Look) -> None:
    """Adds two to seven horizontal slats before a dark field of a front that reaches from x[0] to x[1]."""
    w.box((x[0], x[1] + 0.001), y, z, darker(look, 0.5), solid=False)
    rows = max(2, min(7, round((z[1] - z[0]) / 0.12)))
    step = (z[1] - z[0]) / rows
    for i in range(rows):
        w.box((x[0], x[1] + 0.008), y, (z[0] + i * step, z[0] + (i + 0.7) * step), look, solid=False)


def _styled_joints(w: Workbench, x: float, y: Range, z: Range, look: Look) -> None:
    """Adds the dark layer behind styled fronts."""
    y, z = (y[0] + 0.003, y[1] - 0.003), (z[0] + 0.003, z[1] - 0.003)
    w.box((x, x + _SHADOW_M), y, z, darker(look), solid=False)


def handle(w: Workbench, kind: HandleKind, at: Point, length: float, look: Look, *, upright: bool = False) -> None:
    """Adds a handle at a point of a front; bars, rails and slots have this length along y, or along z if `upright`."""
    x, y, z = at
    half = 0.5 * length
    dy, dz = (0.007, half) if upright else (half, 0.007)
    if kind in ("bar", "rail"):
        w.box((x, x + 0.025), (y - dy, y + dy), (z - dz, z + dz), look, solid=False)
    elif kind == "knob":
        w.ball((x + 0.012, y, z), 0.017, look, solid=False)
    elif kind == "cup":
        w.ellipsoid((x, y, z), (0.026, 0.048, 0.02), look, solid=False)
    elif kind == "drop":
        w.ellipsoid((x, y, z + 0.008), (0.006, 0.045, 0.022), look, solid=False)
        w.rod((x + 0.012, y - 0.032, z - 0.008), (x + 0.012, y + 0.032, z - 0.008), 0.006, look, solid=False)
    elif kind == "tab":
        w.box((x, x + 0.012), (y - 0.016, y + 0.016), (z - 0.03, z + 0.03), w.look("leather"), solid=False)
    elif kind == "slot":
        w.box((x - 0.002, x + 0.002), (y - dy, y + dy), (z - dz - 0.006, z + dz + 0.006), w.look("dark"), solid=False)
