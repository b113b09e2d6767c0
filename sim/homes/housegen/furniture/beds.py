"""Beds with their bedding.

Sizes follow usual mattress sizes (0.90, 1.40, 1.60, 1.80 m by 1.90-2.10 m; EN 1334) and Neufert: top of the mattress
0.45-0.60 m, headboards 0.80-1.20 m high. The front is the foot end.
"""

from __future__ import annotations

import itertools
import math

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.item import MeshShape
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, centred, inset
from sim.homes.housegen.furniture.shapes import chamfered_box, named_mesh, pillow
from sim.homes.housegen.furniture.workbench import Workbench

_MATTRESS = 0.22


def _mattress_size(w: Workbench) -> tuple[float, float]:
    """Returns the length and width of the mattress; hint `width_m` selects the next standard width below it."""
    hinted = w.hints.get("width_m")
    widths = (0.90, 1.20, 1.40, 1.60, 1.80)
    width = (
        max((v for v in widths if hinted is None or v <= float(hinted) + 1e-6), default=0.90)
        if hinted is not None
        else w.choice(widths[1:])
    )
    return w.choice((1.95, 2.00, 2.05)), width


def _bedding(w: Workbench, x0: float, length: float, width: float, top: float) -> None:
    """Adds a mattress from x0 towards the foot, a duvet over most of it, and one or two pillows at the head."""
    linen, duvet = w.look("linen"), w.look("bedding")
    w.mesh(chamfered_box((length, width, _MATTRESS), 0.04), (x0 + 0.5 * length, 0.0, top - 0.5 * _MATTRESS), linen)
    cover = w.length(0.60, 0.75) * length
    shape = _duvet(w, cover, width + 0.05, 0.19)
    w.mesh(shape, (x0 + length - 0.5 * cover + 0.015, 0.0, top - 0.145), duvet)
    fold = w.length(0.18, 0.28)
    w.mesh(
        chamfered_box((fold, width + 0.06, 0.09), 0.035),
        (x0 + length - cover + 0.5 * fold - 0.02, 0.0, top + 0.02),
        w.new_look("linen"),
    )
    count = 2 if width > 1.1 else 1
    pitch = min(0.72, width / count - 0.06)
    for i in range(count):
        y = (i - 0.5 * (count - 1)) * width / count
        w.mesh(pillow((0.46, pitch, 0.16), 4.0), (x0 + 0.27, y, top + 0.055), linen, tilt=-0.12)
    w.top((x0 + length - cover + 0.3, x0 + length - 0.15), centred(width, 0.15), top + 0.045, "seat")


def _duvet(w: Workbench, length: float, width: float, thick: float) -> MeshShape:
    """Returns a soft cover that lies on z = 0 with its middle at the origin: thick, with shallow folds and round edges.

    Its sides hang straight down; the shape of its folds is drawn.
    """
    xs, ys = (-1.0, -0.55, -0.1, 0.4, 0.85, 1.0), (-1.0, -0.9, -0.62, -0.3, 0.0, 0.32, 0.6, 0.9, 1.0)
    phase, slant, bumps = w.rng.uniform(0.0, 6.28), w.rng.uniform(-2.5, 2.5), w.rng.uniform(-1.0, 1.0, (6, 9))
    rows, columns = len(xs), len(ys)
    points = []
    for i, u in enumerate(xs):
        for j, v in enumerate(ys):
            edge = 0.35 * thick * (abs(v) == 1.0) + 0.3 * thick * (u == 1.0)
            fold = 0.0 if edge else 0.011 * math.sin(7.0 * v + slant * u + phase) + 0.009 * bumps[i, j]
            points.append((0.5 * length * u, 0.5 * width * v, thick - edge + fold))
    rim = [*((0, j) for j in range(columns)), *((i, columns - 1) for i in range(1, rows))]
    rim += [*((rows - 1, j) for j in range(columns - 2, -1, -1)), *((i, 0) for i in range(rows - 2, 0, -1))]
    ids, start = [i * columns + j for i, j in rim], len(points)
    points += [(points[k][0], points[k][1], 0.0) for k in ids]
    points.append((0.0, 0.0, 0.0))
    faces = []
    for i in range(rows - 1):
        for j in range(columns - 1):
            a, b, c, d = i * columns + j, (i + 1) * columns + j, (i + 1) * columns + j + 1, i * columns + j + 1
            faces += [(a, b, c), (a, c, d)]
    for k, upper in enumerate(ids):
        after = (k + 1) % len(ids)
        faces += [(upper, ids[after], start + after), (upper, start + after, start + k)]
        faces.append((start + k, start + after, len(points) - 1))
    return named_mesh("duvet", points, faces)


def panel(w: Workbench) -> None:
    """Builds a wooden bed with a panelled headboard, side rails and a low footboard."""
    length, width = _mattress_size(w)
    wood, top, head = w.look("wood"), w.length(0.48, 0.58), w.length(0.90, 1.15)
    half, x1 = 0.5 * width + 0.03, length + 0.02
    w.box((-0.05, 0.0), (-half, half), (0.18, head), wood)
    w.box((-0.065, 0.015), (-half - 0.02, half + 0.02), (head - 0.02, head + 0.03), wood)
    for side in BOTH_SIDES:
        w.box((-0.06, 0.01), around(side * half, 0.035), (0.0, head), wood)
        w.box((0.0, x1), around(side * half, 0.015), (0.20, top - 0.12), wood)
        w.box((x1 - 0.02, x1 + 0.05), around(side * half, 0.035), (0.0, top + 0.04), wood)
    w.box((x1, x1 + 0.03), (-half, half), (0.18, top - 0.04), wood)
    w.box((0.0, x1), (-half, half), (0.22, top - _MATTRESS + 0.01), wood)
    _bedding(w, 0.01, length, width, top)


def platform(w: Workbench) -> None:
    """Builds a low wide platform with an inset mattress, a floating headboard and a recessed plinth."""
    length, width = _mattress_size(w)
    wood, top = w.look("wood"), w.length(0.42, 0.48)
    half = 0.5 * width + 0.14
    w.box((-0.04, length + 0.14), (-half, half), (0.12, top - _MATTRESS + 0.01), wood)
    w.box((0.12, length - 0.05), (-half + 0.18, half - 0.18), (0.0, 0.12), w.look("dark"))
    w.box((-0.08, -0.03), (-half, half), (0.12, w.length(0.75, 0.90)), wood)
    _bedding(w, 0.0, length, width, top)


def upholstered(w: Workbench) -> None:
    """Builds a box bed covered in cloth with a tall tufted headboard."""
    length, width = _mattress_size(w)
    cloth, top, head = w.look("fabric"), w.length(0.52, 0.60), w.length(1.05, 1.25)
    half = 0.5 * width + 0.035
    w.box((0.0, length + 0.03), (-half, half), (0.07, top - 0.14), cloth)
    w.legs((0.05, length - 0.02), (-half + 0.04, half - 0.04), (0.0, 0.08), 0.05, w.look("dark"))
    columns = max(2, round(2 * half / 0.42))
    pitch = 2 * half / columns
    for i in range(columns):
        w.mesh(
            chamfered_box((0.10, round(pitch - 0.004, 3), head - 0.07), 0.025),
            (-0.05, (i + 0.5) * pitch - half, 0.5 * (head + 0.07)),
            cloth,
        )
    _bedding(w, 0.005, length, width, top)


def metal_frame(w: Workbench) -> None:
    """Builds an iron bedstead with arched bars at head and foot."""
    length, width = _mattress_size(w)
    iron, top, head = w.look("iron"), w.length(0.50, 0.58), w.length(0.95, 1.15)
    half = 0.5 * width + 0.02
    for x, high in ((-0.02, head), (length + 0.02, top + 0.12)):
        for side in BOTH_SIDES:
            w.cylinder((x, side * half), (0.0, high - 0.08), 0.017, iron)
            w.ball((x, side * half, high - 0.07), 0.026, w.look("brass"))
            w.rod((x, side * half, high - 0.09), (x, side * 0.4 * half, high - 0.015), 0.013, iron, round_ends=True)
        w.rod_y((x, high - 0.015), (-0.4 * half, 0.4 * half), 0.013, iron)
        w.rod_y((x, top - 0.10), (-half, half), 0.012, iron)
        for i in range(3):
            y = (i - 1) * 0.38 * half
            w.cylinder((x, y), (top - 0.10, high - 0.02), 0.008, iron)
    for side in BOTH_SIDES:
        w.box((0.0, length), around(side * half, 0.02), (top - _MATTRESS - 0.06, top - _MATTRESS), iron)
    w.box((0.0, length), (-half, half), (top - _MATTRESS - 0.03, top - _MATTRESS + 0.005), iron)
    _bedding(w, 0.0, length, width, top)


def storage(w: Workbench) -> None:
    """Builds a bed with drawers in the base and a shelf headboard."""
    length, width = _mattress_size(w)
    look, top = w.look("lacquer"), w.length(0.52, 0.58)
    half = 0.5 * width + 0.02
    w.box((0.0, length + 0.02), (-half, half), (0.05, top - _MATTRESS + 0.02), look)
    w.box((0.04, length - 0.04), (-half + 0.05, half - 0.05), (0.0, 0.05), w.look("dark"))
    for side in BOTH_SIDES:
        for i in range(2):
            x = 0.06 + i * 0.48 * length
            front, knob = parts.on_side(side, half, half + 0.016), around(side * (half + 0.02), 0.012)
            w.box((x, x + 0.46 * length), front, (0.08, top - _MATTRESS), look, solid=False)
            w.box((x + 0.18 * length, x + 0.28 * length), knob, (0.19, 0.21), w.look("metal"), solid=False)
    head = w.length(0.90, 1.05)
    w.box((-0.25, 0.0), (-half, half), (0.0, 0.55), look)
    w.box((-0.25, -0.23), (-half, half), (0.55, head), look)
    w.box((-0.25, 0.0), (-half, half), (head - 0.02, head), look)
    for y in inset((-half, half), 0.01):
        w.box((-0.23, 0.0), around(y, 0.01), (0.55, head - 0.02), look)
    w.top((-0.21, -0.02), (-half + 0.05, half - 0.05), 0.55)
    _bedding(w, 0.005, length, width, top)


def four_poster(w: Workbench) -> None:
    """Builds a bed with four tall posts joined by a rail at the top."""
    length, width = _mattress_size(w)
    wood, top, high = w.look("wood"), w.length(0.54, 0.62), w.length(1.95, 2.10)
    half, x0, x1 = 0.5 * width + 0.035, -0.035, length + 0.035
    for x in (x0, x1):
        for side in BOTH_SIDES:
            w.box(around(x, 0.035), around(side * half, 0.035), (0.0, high), wood)
        w.box(around(x, 0.02), (-half, half), (high - 0.05, high), wood)
    for side in BOTH_SIDES:
        w.box((x0, x1), around(side * half, 0.02), (high - 0.05, high), wood)
        w.box((x0, x1), around(side * half, 0.02), (top - 0.30, top - 0.12), wood)
    w.box(around(x0, 0.02), (-half, half), (0.30, w.length(1.0, 1.2)), wood)
    w.box(around(x1, 0.02), (-half, half), (0.28, top - 0.10), wood)
    w.box((x0, x1), (-half, half), (top - 0.28, top - _MATTRESS + 0.01), wood)
    _bedding(w, 0.0, length, width, top)


def sleigh(w: Workbench) -> None:
    """Builds a bed with a curved head and foot that roll outwards."""
    length, width = _mattress_size(w)
    wood, top, head = w.look("wood"), w.length(0.50, 0.58), w.length(0.95, 1.10)
    half = 0.5 * width + 0.03
    for x, out, high in ((0.0, -1, head), (length + 0.02, 1, top + 0.18)):
        curve = [(x, 0.06), (x + out * 0.02, 0.5 * high), (x + out * 0.07, 0.8 * high), (x + out * 0.15, high - 0.03)]
        for a, b in itertools.pairwise(curve):
            w.bar((a[0], 0.0, a[1]), (b[0], 0.0, b[1] + 0.01), 2 * half, 0.05, wood)
        w.rod_y((x + out * 0.16, high - 0.04), (-half, half), 0.045, wood)
        w.box(around(x, 0.04), (-half, half), (0.0, 0.08), wood)
    for side in BOTH_SIDES:
        w.box((0.0, length + 0.02), around(side * half, 0.02), (0.14, top - 0.12), wood)
    w.box((0.0, length), (-half, half), (0.2, top - _MATTRESS + 0.01), wood)
    _bedding(w, 0.01, length, width, top)


def futon(w: Workbench) -> None:
    """Builds a low slatted base of round timbers with a thin mattress and a roll of cloth as a headrest."""
    length, width = _mattress_size(w)
    wood, top = w.look("wood"), 0.40
    half = 0.5 * width + 0.08
    for side in BOTH_SIDES:
        w.rod_x((side * (half - 0.05), 0.10), (-0.10, length + 0.10), 0.05, wood)
    for i in range(6):
        x = 0.05 + i * (length - 0.1) / 5
        w.box(around(x, 0.05), (-half, half), (0.145, 0.185), wood)
    for x in (0.2, length - 0.2):
        w.box(around(x, 0.05), (-half + 0.02, half - 0.02), (0.0, 0.06), wood)
    _bedding(w, 0.0, length, width, top)
    w.rod_y((-0.09, 0.42), centred(width), 0.10, w.look("fabric"))
    w.box((-0.14, -0.04), centred(width), (0.145, 0.34), wood)


STYLES = (
    Style("bed", "panel", "train", panel),
    Style("bed", "platform", "train", platform),
    Style("bed", "upholstered", "train", upholstered),
    Style("bed", "metal_frame", "train", metal_frame),
    Style("bed", "storage", "train", storage),
    Style("bed", "four_poster", "heldout", four_poster),
    Style("bed", "sleigh", "heldout", sleigh),
    Style("bed", "futon", "heldout", futon),
)
