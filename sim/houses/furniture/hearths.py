"""Fireplaces and stoves.

Ranges after Neufert, Architects' Data: openings 0.60-1.00 m wide and 0.55-0.80 m high, mantels at 1.05-1.30 m.
"""

from __future__ import annotations

from sim.houses.furniture.catalogue import Style
from sim.houses.furniture.item import Look
from sim.houses.furniture.workbench import Range, Workbench

_BOTH = (-1, 1)


def _opening(w: Workbench, x: Range, half: float, z: Range, outer: float, top: float, look: Look) -> None:
    """A block from x[0] to x[1] with a dark recess |y| < half between heights z; outer half width, total height."""
    char = w.look("char")
    for side in _BOTH:
        low, high = sorted((side * half, side * outer))
        w.box(x, (low, high), (0.0, top), look)
    w.box(x, (-half, half), (z[1], top), look)
    w.box((x[0], x[0] + 0.04), (-half, half), (0.0, z[1]), char)
    if z[0] > 0:
        w.box((x[0] + 0.04, x[1]), (-half, half), (0.0, z[0]), look)
    for side in _BOTH:
        edge = side * (half - 0.004)
        w.box((x[0] + 0.04, x[1] - 0.02), (edge - 0.004, edge + 0.004), z, char, solid=False)


def _logs(w: Workbench, x: float, z: float, half: float) -> None:
    """Logs on a grate, a flame or two."""
    wood = w.look("wood")
    w.rod((x, -0.6 * half, z + 0.05), (x, 0.6 * half, z + 0.05), 0.05, wood)
    w.rod((x - 0.06, -0.5 * half, z + 0.13), (x + 0.05, 0.5 * half, z + 0.13), 0.042, wood)
    if w.chance(0.6):
        for y, high in ((-0.2 * half, 0.12), (0.15 * half, 0.17)):
            w.ellipsoid((x - 0.01, y, z + 0.12 + high), (0.04, 0.05, high), w.look("fire"), solid=False)


def mantel(w: Workbench) -> None:
    """Classic surround: pilasters, frieze and shelf round a dark opening on a hearth."""
    half, high = 0.5 * w.length(0.62, 0.80), w.length(0.62, 0.74)
    outer, top, depth = half + w.length(0.18, 0.26), w.length(1.08, 1.22), w.length(0.30, 0.36)
    look = w.look("lacquer") if w.chance(0.5) else w.look("stone")
    _opening(w, (0.0, depth), half, (0.0, high), outer, top - 0.05, look)
    w.box((0.0, depth + 0.08), (-outer - 0.07, outer + 0.07), (top - 0.05, top), look)
    w.box((0.0, depth + 0.03), (-outer - 0.02, outer + 0.02), (top - 0.09, top - 0.05), look, solid=False)
    for side in _BOTH:
        c = side * (half + 0.5 * (outer - half))
        w.box((depth, depth + 0.025), (c - 0.06, c + 0.06), (0.0, top - 0.09), look, solid=False)
    w.box((depth, depth + 0.32), (-outer, outer), (0.0, 0.04), w.look("stone"))
    _logs(w, 0.5 * depth + 0.03, 0.0, half)
    w.top((0.05, depth + 0.03), (-outer, outer), top)


def stove_iron(w: Workbench) -> None:
    """Iron stove on legs with a glazed door and a flue pipe to the ceiling."""
    iron, width, depth = w.look("iron"), w.length(0.48, 0.60), w.length(0.40, 0.46)
    w.box((-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width), (0.22, 0.82), iron)
    w.legs(
        (-0.5 * depth + 0.02, 0.5 * depth - 0.02), (-0.5 * width + 0.02, 0.5 * width - 0.02), (0.0, 0.23), 0.05, iron
    )
    w.box((-0.5 * depth - 0.02, 0.5 * depth + 0.03), (-0.5 * width - 0.03, 0.5 * width + 0.03), (0.82, 0.85), iron)
    w.box((0.5 * depth, 0.5 * depth + 0.02), (-0.38 * width, 0.38 * width), (0.30, 0.74), iron, solid=False)
    w.box(
        (0.5 * depth + 0.02, 0.5 * depth + 0.026),
        (-0.29 * width, 0.29 * width),
        (0.37, 0.67),
        w.look("fire"),
        solid=False,
    )
    w.rod(
        (0.5 * depth + 0.035, 0.34 * width, 0.46),
        (0.5 * depth + 0.035, 0.34 * width, 0.58),
        0.012,
        w.look("brass"),
        solid=False,
    )
    w.cylinder((-0.05, 0.0), (0.84, 2.30), 0.075, iron)
    w.box(
        (-0.5 * depth - 0.08, 0.5 * depth + 0.30),
        (-0.5 * width - 0.18, 0.5 * width + 0.18),
        (0.0, 0.02),
        w.look("stone"),
    )


STYLES = (
    Style("fireplace", "mantel", "train", mantel),
    Style("fireplace", "stove_iron", "heldout", stove_iron),
)
