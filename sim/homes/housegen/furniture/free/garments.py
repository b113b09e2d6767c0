"""Garments of which the clothes of the pool `wide` are made."""

from __future__ import annotations

import math

from sim.homes.housegen.furniture.item import Look, MeshShape
from sim.homes.housegen.furniture.parts import BOTH_SIDES
from sim.homes.housegen.furniture.shapes import named_mesh
from sim.homes.housegen.furniture.workbench import Range, Workbench


def _flat_cloth(outline: list[tuple[float, float]], centre: tuple[float, float], thick: float) -> MeshShape:
    """Returns cloth with a (y, z) outline that is star-shaped about `centre`, where it is thickest.

    The outline runs counter-clockwise seen from +x.
    """
    n = len(outline)
    vertices = [(s * 0.35 * thick, y, z) for s in BOTH_SIDES for y, z in outline]
    vertices += [(s * 0.5 * thick, *centre) for s in BOTH_SIDES]
    faces: list[tuple[int, int, int]] = []
    for i in range(n):
        j = (i + 1) % n
        faces += [(j, i, 2 * n), (n + i, n + j, 2 * n + 1), (i, j, n + j), (i, n + j, n + i)]
    return named_mesh("cloth", vertices, faces)


def _mirrored(right: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Returns the outline of a right half, given from the top down, and its mirror image."""
    return [(-y, z) for y, z in right] + [(y, z) for y, z in reversed(right) if y > 0.0]


def garment(w: Workbench, kind: str, high: float, thick: float) -> MeshShape:
    """Returns a garment that hangs flat, with its shoulders or waist at z = `high` and its hem at z = 0."""
    h, s = high, w.length(0.9, 1.15)
    if kind == "trousers":
        flare, hip = w.length(-0.03, 0.05), 0.19 * s
        right = [(0.16 * s, h), (hip, 0.72 * h), (hip + flare, 0.0), (0.06 + 0.5 * flare, 0.0)]
        return _flat_cloth(_mirrored([*right, (0.0, 0.66 * h)]), (0.0, 0.8 * h), thick)
    if kind == "skirt":
        right = [(0.14 * s, h), (0.19 * s, 0.7 * h), (w.length(0.18, 0.34) * s, 0.0)]
        return _flat_cloth(_mirrored(right), (0.0, 0.5 * h), thick)
    if kind == "vest":
        right = [(0.06, h - 0.05), (0.09, h), (0.15 * s, h - 0.02), (0.14 * s, h - 0.22), (0.19 * s, h - 0.28)]
        return _flat_cloth(_mirrored([*right, (w.length(0.18, 0.24) * s, 0.0)]), (0.0, h - 0.3), thick)
    hem = {"dress": w.length(0.22, 0.34), "coat": 0.24, "tee": 0.21, "shirt": 0.20}[kind]
    arm = 0.20 if kind == "tee" else min(0.52, 0.85 * h)
    right = [(0.06, h), (0.20 * s, h - 0.05), (0.25 * s + 0.14 * arm, h - arm), (0.16 * s + 0.11 * arm, h - arm - 0.02)]
    right += [
        (0.19 * s, h - min(0.24, 0.6 * arm + 0.05)),
        ((0.15 if kind == "dress" else 0.19) * s, 0.5 * h),
        (hem * s, 0.0),
    ]
    if kind != "tee":
        right[4] = (0.19 * s, h - 0.22)
    return _flat_cloth(_mirrored(right), (0.0, h - 0.16), thick)


LENGTHS_M = {
    "shirt": (0.62, 0.78),
    "tee": (0.58, 0.72),
    "vest": (0.5, 0.7),
    "dress": (0.8, 1.15),
    "coat": (0.85, 1.1),
    "trousers": (0.9, 1.05),
    "skirt": (0.5, 0.8),
}
"""Shortest and longest usual length of a garment on a hanger, in metres."""


def garment_look(w: Workbench) -> Look:
    """Returns a new look for a garment."""
    return w.new_look(w.choice(("bright", "bright", "denim", "fabric", "linen")))


def hanging_row(w: Workbench, x: float, y: Range, rail: float, room: float, metal: Look, most: int) -> None:
    """Adds garments on hangers in a row under a rail, none longer than `room`."""
    count = min(most, max(2, int((y[1] - y[0]) / w.length(0.07, 0.16))))
    for i in range(count):
        kind = w.choice(tuple(LENGTHS_M))
        high = min(w.length(*LENGTHS_M[kind]), room - 0.10)
        c = y[0] + (i + 0.5) * (y[1] - y[0]) / count
        turn = 0.5 * math.pi + w.length(-0.25, 0.25)
        w.rod((x, c, rail - 0.08), (x, c, rail + 0.012), 0.003, metal, solid=False)
        shape = garment(w, kind, high, w.length(0.03, 0.07))
        w.mesh(shape, (x, c, rail - 0.07 - high), garment_look(w), turn=turn, solid=i % 2 == 0)


def towel_look(w: Workbench) -> Look:
    """Returns a new look for a towel."""
    return w.new_look("towel") if w.chance(0.8) else w.new_look("linen")
