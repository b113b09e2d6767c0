"""What many pieces share: fronts of doors and drawers with handles, carcasses, taps, basins, cords."""

from __future__ import annotations

import dataclasses
from typing import Literal

from sim.housegen.furniture.item import Look
from sim.housegen.furniture.workbench import Range, Workbench

FRONT_M = 0.018
"""Thickness of a door or drawer front, the usual board."""
GAP_M = 0.004
"""Half the joint between two fronts."""
Handle = Literal["bar", "knob", "cup", "none"]


def darker(look: Look, factor: float = 0.45) -> Look:
    """A plain, darker version of a look: the shadow in a joint."""
    r, g, b, a = look.rgba
    return dataclasses.replace(
        look, rgba=(round(factor * r, 3), round(factor * g, 3), round(factor * b, 3), a), texture=None
    )


def _joints(w: Workbench, x: float, y: Range, z: Range, look: Look) -> None:
    """What shows between fronts: without it joints vanish where no shadows are drawn."""
    w.box((x, x + 0.003), (y[0] + GAP_M, y[1] - GAP_M), (z[0] + GAP_M, z[1] - GAP_M), darker(look), solid=False)


def doors(
    w: Workbench,
    x: float,
    y: Range,
    z: Range,
    count: int,
    look: Look,
    metal: Look,
    handle: Handle = "bar",
    *,
    high: bool = False,
) -> None:
    """`count` hinged doors side by side on the plane x; handles at meeting stiles, above the middle if `high`."""
    each = (y[1] - y[0]) / count
    if count > 1:
        _joints(w, x, y, z, look)
    tall = z[1] - z[0]
    grip = z[1] - min(0.22, 0.35 * tall) if not high else z[0] + min(0.22, 0.35 * tall)
    if tall > 1.2:
        grip = z[0] + 0.52 * tall
    for i in range(count):
        left = y[0] + i * each
        w.box((x, x + FRONT_M), (left + GAP_M, left + each - GAP_M), (z[0] + GAP_M, z[1] - GAP_M), look, solid=False)
        hand = left + (each - 0.045 if i % 2 == 0 and count > 1 else 0.045)
        length = min(0.16, 0.4 * tall)
        _handle(w, handle, (x + FRONT_M, hand, grip), (0.0, 0.0, length), metal)


def drawers(
    w: Workbench, x: float, y: Range, z: Range, rows: int, columns: int, look: Look, metal: Look, handle: Handle = "bar"
) -> None:
    """A grid of drawer fronts on the plane x, a handle each."""
    wide, tall = (y[1] - y[0]) / columns, (z[1] - z[0]) / rows
    if rows * columns > 1:
        _joints(w, x, y, z, look)
    for row in range(rows):
        for column in range(columns):
            y0, z0 = y[0] + column * wide, z[0] + row * tall
            w.box((x, x + FRONT_M), (y0 + GAP_M, y0 + wide - GAP_M), (z0 + GAP_M, z0 + tall - GAP_M), look, solid=False)
            _handle(
                w, handle, (x + FRONT_M, y0 + 0.5 * wide, z0 + 0.55 * tall), (0.0, min(0.22, 0.4 * wide), 0.0), metal
            )


def _handle(
    w: Workbench, kind: Handle, at: tuple[float, float, float], along: tuple[float, float, float], look: Look
) -> None:
    x, y, z = at
    _, dy, dz = along
    if kind == "bar":
        w.box(
            (x, x + 0.024),
            (y - 0.5 * dy - 0.006, y + 0.5 * dy + 0.006),
            (z - 0.5 * dz - 0.006, z + 0.5 * dz + 0.006),
            look,
            solid=False,
        )
    elif kind == "knob":
        w.ball((x + 0.012, y, z), 0.016, look, solid=False)
    elif kind == "cup":
        w.ellipsoid((x, y, z), (0.024, 0.045, 0.018), look, solid=False)


def basin(
    w: Workbench, x: Range, y: Range, rim: float, deep: float, wall: float, look: Look, *, floor: Look | None = None
) -> None:
    """An open box: four walls and a floor, its rim at height `rim`."""
    z = (rim - deep, rim)
    w.box((x[0], x[0] + wall), y, z, look)
    w.box((x[1] - wall, x[1]), y, z, look)
    w.box((x[0] + wall, x[1] - wall), (y[0], y[0] + wall), z, look)
    w.box((x[0] + wall, x[1] - wall), (y[1] - wall, y[1]), z, look)
    w.box((x[0] + wall, x[1] - wall), (y[0] + wall, y[1] - wall), (rim - deep, rim - deep + wall), floor or look)


def tap(w: Workbench, at: tuple[float, float, float], reach: float, high: float, look: Look) -> None:
    """A mixer: post, spout towards +x, lever."""
    x, y, z = at
    w.rod((x, y, z), (x, y, z + high), 0.014, look, solid=False)
    w.rod((x, y, z + high), (x + reach, y, z + high - 0.02), 0.010, look, solid=False, round_ends=True)
    w.bar((x, y + 0.004, z + high), (x, y + 0.06, z + high + 0.02), 0.014, 0.01, look, solid=False)


def slab(w: Workbench, depth: float, width: float, z: Range, look: Look) -> tuple[Range, Range]:
    """A rectangular top that things stand on; its x and y ranges."""
    x, y = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)
    w.box(x, y, z, look)
    w.top((x[0] + 0.05, x[1] - 0.05), (y[0] + 0.05, y[1] - 0.05), z[1])
    return x, y


def round_top(w: Workbench, radius: float, z: Range, look: Look) -> None:
    """A round top that things stand on."""
    w.cylinder((0.0, 0.0), z, radius, look)
    half = 0.65 * radius
    w.top((-half, half), (-half, half), z[1])


def case(w: Workbench, depth: float, width: float, z: Range, look: Look, *, foot: float = 0.0) -> tuple[float, Range]:
    """A closed body from z[0] to z[1] that things stand on; its front plane and y range."""
    x, y = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)
    w.box(x, y, z, look)
    if foot:
        w.box((x[0] + 0.02, x[1] - 0.05), (y[0] + 0.02, y[1] - 0.02), (z[0] - foot, z[0]), w.look("dark"))
    w.top((x[0] + 0.03, x[1] - 0.03), (y[0] + 0.05, y[1] - 0.05), z[1])
    return x[1], y


def body(w: Workbench) -> Look:
    """Painted or plain wood."""
    return w.look("lacquer") if w.chance(0.45) else w.look("wood")
