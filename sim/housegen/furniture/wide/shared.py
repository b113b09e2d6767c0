"""Parts that several kinds of furniture share, of the pool `wide`."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Literal

import numpy as np

from sim.housegen.furniture import parts
from sim.housegen.furniture.item import Look, MeshShape
from sim.housegen.furniture.shapes import Ring, arc_wall, chamfered_box, drape, frustum, loft, named_mesh, strip
from sim.housegen.furniture.workbench import Point, Range, Workbench

BOTH = (-1, 1)
Front = Literal["flat", "frame", "raised", "cane", "slats"]
Grip = Literal["bar", "knob", "cup", "drop", "tab", "slot", "rail", "none"]
Feet = Literal["taper", "splay", "bun", "block", "cabriole", "sled", "castor", "plinth"]


def fittings(w: Workbench) -> Look:
    """The metal of taps, pipes and hooks."""
    return w.look(w.choice(("chrome", "chrome", "brass", "dark", "steel")))


def sanitary(w: Workbench) -> Look:
    """What basins and trays are made of."""
    return w.look(w.choice(("ceramic", "ceramic", "ceramic", "stone", "steel", "plastic")))


def arc(w: Workbench, a: Point, b: Point, rise: float, radius: float, look: Look, pieces: int = 4) -> None:
    """A bent pipe from a up and over to b."""
    points = []
    for i in range(pieces + 1):
        t = i / pieces
        x, y, z = (p + t * (q - p) for p, q in zip(a, b, strict=True))
        points.append((x, y, z + rise * math.sin(math.pi * t)))
    for p, q in itertools.pairwise(points):
        w.rod(p, q, radius, look, solid=False, round_ends=True)


def faucet(w: Workbench, at: Point, reach: float, high: float, look: Look) -> None:
    """A tap of one of five kinds: mixer, swan neck, square block, bridge with two cross heads, pillar."""
    x, y, z = at
    kind = w.choice(("mixer", "swan", "block", "bridge", "pillar"))
    if kind == "mixer":
        parts.tap(w, at, reach, high, look)
    elif kind == "swan":
        w.rod(at, (x, y, z + high), 0.012, look, solid=False)
        arc(w, (x, y, z + high), (x + reach, y, z + high - 0.02), 0.4 * reach, 0.010, look)
        w.rod((x, y, z + 0.04), (x, y + 0.06, z + 0.05), 0.007, look, solid=False, round_ends=True)
    elif kind == "block":
        w.box((x - 0.018, x + 0.018), (y - 0.018, y + 0.018), (z, z + 0.8 * high), look, solid=False)
        w.box((x - 0.018, x + reach), (y - 0.018, y + 0.018), (z + 0.62 * high, z + 0.8 * high), look, solid=False)
        w.box((x - 0.012, x + 0.05), (y - 0.01, y + 0.01), (z + 0.8 * high, z + 0.8 * high + 0.014), look, solid=False)
    elif kind == "bridge":
        for side in BOTH:
            w.cylinder((x, y + side * 0.08), (z, z + 0.07), 0.011, look, solid=False)
            w.box(
                (x - 0.025, x + 0.025), (y + side * 0.08 - 0.006, y + side * 0.08 + 0.006), (z + 0.07, z + 0.08), look
            )
        w.rod((x, y - 0.08, z + 0.045), (x, y + 0.08, z + 0.045), 0.009, look, solid=False)
        w.rod((x, y, z + 0.04), (x, y, z + high), 0.010, look, solid=False)
        arc(w, (x, y, z + high), (x + reach, y, z + high - 0.02), 0.3 * reach, 0.009, look, 3)
    else:
        w.cylinder((x, y), (z, z + 0.6 * high), 0.02, look, solid=False)
        w.rod((x, y, z + 0.4 * high), (x + reach, y, z + 0.5 * high), 0.011, look, solid=False, round_ends=True)
        w.cylinder((x, y), (z + 0.6 * high, z + 0.6 * high + 0.03), 0.032, look, solid=False)


def hollow_top(rim: float, rx: float, ry: float, deep: float, thick: float, power: float) -> list[Ring]:
    """Rings that go from the outer rim inwards and down."""
    return [
        Ring(rim, rx, ry, power=power),
        Ring(rim, rx - thick, ry - thick, power=power),
        Ring(rim - 0.6 * deep, 0.84 * (rx - thick), 0.84 * (ry - thick), power=power),
        Ring(rim - deep, 0.45 * rx, 0.45 * ry, power=power),
    ]


def over(w: Workbench, x: float, y: float, z: float, wide: float, front: float, back: float, cloth: Look) -> None:
    """A towel folded over a bar at (x, z): smooth sheet, or in folds on both sides."""
    if w.chance(0.5):
        r = w.length(0.015, 0.025)
        path = [(r, -front), (1.15 * r, -0.5 * front), (r, 0.0), (0.7 * r, 0.7 * r), (0.0, r), (-0.7 * r, 0.7 * r)]
        w.mesh(strip([*path, (-r, 0.0), (-1.1 * r, -0.5 * back), (-r, -back)], 0.010, wide), (x, y, z), cloth)
        return
    folds, deep = w.whole(2, 6), w.length(0.02, 0.045)
    w.mesh(drape(wide, front, deep, folds, gather=w.length(0.85, 1.1)), (x + 0.004, y, z + 0.012 - front), cloth)
    w.mesh(drape(wide, back, 0.02, folds), (x - 0.024, y, z + 0.012 - back), cloth)


def crumpled(w: Workbench, deep: float, wide: float, rise: float, thick: float = 0.012) -> MeshShape:
    """A thrown sheet of cloth: a rumpled grid with wandering edges, highest about its middle, its lowest at z = 0."""
    n = 7
    bumps = w.rng.uniform(0.0, 1.0, (n, n))
    drift = w.rng.uniform(-0.22, 0.22, (2, n, n))
    points = []
    for i in range(n):
        for j in range(n):
            u, v = 2 * (i + drift[0, i, j]) / (n - 1) - 1, 2 * (j + drift[1, i, j]) / (n - 1) - 1
            fall = max(0.0, 1.0 - 0.9 * (u * u + v * v) / 1.2)
            points.append((0.5 * deep * u, 0.5 * wide * v, thick + rise * (0.35 + 0.65 * bumps[i, j]) * fall))
    low = [(x, y, z - thick) for x, y, z in points]
    size = n * n
    faces: list[tuple[int, int, int]] = []
    for i in range(n - 1):
        for j in range(n - 1):
            a, b, c, d = i * n + j, (i + 1) * n + j, (i + 1) * n + j + 1, i * n + j + 1
            faces += [(a, b, c), (a, c, d), (size + c, size + b, size + a), (size + d, size + c, size + a)]
    edge = [*((i, 0) for i in range(n - 1)), *((n - 1, j) for j in range(n - 1))]
    edge += [*((i, n - 1) for i in range(n - 1, 0, -1)), *((0, j) for j in range(n - 1, 0, -1))]
    ids = [i * n + j for i, j in edge]
    for p, q in zip(ids, [*ids[1:], ids[0]], strict=True):
        faces += [(q, p, size + p), (q, size + p, size + q)]
    return named_mesh("crumpled", [*points, *low], faces)


def about(middle: float, width: float) -> Range:
    """The range of this width about a middle."""
    return middle - 0.5 * width, middle + 0.5 * width


def beside(side: int, near: float, far: float) -> Range:
    """The range between two distances from the middle on one side."""
    return min(side * near, side * far), max(side * near, side * far)


def loop(w: Workbench, x: Range, y: float, z: Range, thick: float, look: Look) -> None:
    """A rectangular frame of square tube in the plane of this y."""
    for edge in (x[0] + 0.5 * thick, x[1] - 0.5 * thick):
        w.box(about(edge, thick), about(y, thick), z, look)
    for edge in (z[0] + 0.5 * thick, z[1] - 0.5 * thick):
        w.box((x[0] + thick, x[1] - thick), about(y, thick), about(edge, thick), look)


def path(w: Workbench, points: Sequence[Point], radius: float, look: Look) -> None:
    """A tube bent along these points."""
    for a, b in itertools.pairwise(points):
        w.rod(a, b, radius, look, round_ends=True)


def pad(
    w: Workbench, size: Point, at: Point, look: Look, chamfer: float = 0.025, *, tilt: float = 0.0, turn: float = 0.0
) -> None:
    """A stuffed block with soft edges, its middle at `at`."""
    rounded = (round(size[0], 3), round(size[1], 3), round(size[2], 3))
    w.mesh(chamfered_box(rounded, chamfer), at, look, tilt=tilt, turn=turn)


def upholstery(w: Workbench, leather: float = 0.35) -> Look:
    """Leather, plain cloth or a bright one."""
    if w.chance(leather):
        return w.look("leather")
    return w.look("bright") if w.chance(0.2) else w.look("fabric")


def timber(w: Workbench, painted: float = 0.3) -> Look:
    """Wood, now and then painted."""
    return w.look("lacquer") if w.chance(painted) else w.look("wood")


def tubes(w: Workbench) -> Look:
    """What tubes and wires are made of."""
    return w.look(w.choice(("chrome", "iron", "lacquer", "brass")))


def curved_board(w: Workbench, x: float, half: float, z: Range, look: Look, thick: float, bow: float) -> None:
    """A board across the back whose middle lies `bow` behind its ends, the rearmost at x."""
    radius = (half * half + bow * bow) / (2 * bow)
    angle = math.asin(min(1.0, half / radius))
    angles = [math.pi + angle * (i / 4 - 1.0) for i in range(9)]
    w.mesh(arc_wall(radius, thick, 0.0, angles, [z[1] - z[0]] * 9), (x + radius, 0.0, z[0]), look)


def star(w: Workbench, radius: float, feet: int, look: Look, top: float, *, castors: bool = True) -> None:
    """Feet like a star under a column."""
    dark = w.look("rubber")
    low = 0.06 if castors else 0.02
    for i in range(feet):
        angle = math.tau * i / feet + 0.3
        x, y = radius * math.cos(angle), radius * math.sin(angle)
        w.bar((0.0, 0.0, low + 0.03), (x, y, low), 0.04, 0.025, look)
        if castors:
            w.ball((x, y, 0.028), 0.028, dark)
        else:
            w.cylinder((x, y), (0.0, low), 0.014, dark)
    w.cylinder((0.0, 0.0), (low, top), 0.026, w.look("chrome") if w.chance(0.5) else look)


def cage(w: Workbench, width: float, depth: float, seat: float, seats: int) -> float:
    """Seat, back and arm cushions inside bent tubes; the x of the back cushion's face."""
    tube, cover, r = tubes(w), upholstery(w, 0.75), w.choice((0.012, 0.017))
    arm, rail = w.length(0.12, 0.16), w.length(0.54, 0.64)
    x0, x1, half = -0.5 * depth, 0.5 * depth, 0.5 * width
    inner = width - 2 * arm - 4 * r
    for side in BOTH:
        y = side * (half - r)
        path(w, [(x1 - r, y, 0.0 + r), (x1 - r, y, rail), (x0 + r, y, rail), (x0 + r, y, r)], r, tube)
        w.rod((x1 - r, y, 0.14), (x0 + r, y, 0.14), r, tube)
        pad(
            w,
            (depth - 4 * r, arm, rail - 0.14),
            (0.0, side * (half - 2 * r - 0.5 * arm), 0.5 * rail + 0.09),
            cover,
            0.03,
        )
    for x, z in ((x1 - r, 0.14), (x0 + r, 0.14), (x0 + r, rail)):
        w.rod((x, -half + r, z), (x, half - r, z), r, tube)
    each = inner / seats
    back, high = arm + 0.02, w.length(0.03, 0.16)
    for i in range(seats):
        y = (i + 0.5) * each - 0.5 * inner
        lower = 0.5 * (seat - 0.14)
        pad(w, (depth - 5 * r, each - 0.006, lower), (0.0, y, 0.13 + 0.5 * lower), cover, 0.025)
        pad(w, (depth - back - 4 * r, each - 0.006, lower + 0.02), (0.5 * back, y, seat - 0.5 * lower), cover, 0.035)
        tall = rail + high - seat + 0.03
        pad(w, (back, each - 0.006, tall), (x0 + 2 * r + 0.5 * back, y, rail + high - 0.5 * tall), cover, 0.035)
    w.top((x0 + back + 2 * r, x1 - 0.03), (-0.5 * inner, 0.5 * inner), seat, "seat")
    return x0 + back + 2 * r


def prism(outline: Sequence[tuple[float, float]], high: float) -> MeshShape:
    """An upright prism over a star-shaped outline, counter-clockwise from above, from z = 0."""
    n = len(outline)
    points = np.asarray(outline, dtype=np.float64)
    ring = np.vstack([points, points.mean(axis=0)])
    vertices = np.vstack([np.column_stack([ring, np.full(n + 1, z)]) for z in (0.0, high)])
    faces = []
    for i in range(n):
        j, up = (i + 1) % n, n + 1
        faces += [(i, j, up + j), (i, up + j, up + i), (n, j, i), (up + n, up + i, up + j)]
    return named_mesh("prism", vertices, faces)


def handle(
    w: Workbench, kind: Grip, at: tuple[float, float, float], wide: float, look: Look, *, upright: bool = False
) -> None:
    """A handle on the plane x that is `wide` along y, or along z if `upright`."""
    x, y, z = at
    half = 0.5 * wide
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


def leaf(w: Workbench, x: float, y: Range, z: Range, look: Look, kind: Front) -> float:
    """One door or drawer front on the plane x; where its face is."""
    gap, face = parts.GAP_M, x + parts.FRONT_M
    y, z = (y[0] + gap, y[1] - gap), (z[0] + gap, z[1] - gap)
    w.box((x, face), y, z, look, solid=False)
    edge = min(0.06, 0.22 * (y[1] - y[0]), 0.22 * (z[1] - z[0]))
    y, z = (y[0] + edge, y[1] - edge), (z[0] + edge, z[1] - edge)
    if kind == "frame":
        w.box((x, face + 0.001), y, z, parts.darker(look, 0.8), solid=False)
        w.box((x, face + 0.002), (y[0] + 0.006, y[1] - 0.006), (z[0], z[1] - 0.008), look, solid=False)
    elif kind == "raised":
        w.box((x, face + 0.001), y, z, parts.darker(look, 0.7), solid=False)
        size = (0.03, round(y[1] - y[0] - 0.02, 3), round(z[1] - z[0] - 0.02, 3))
        middle = (face, 0.5 * (y[0] + y[1]), 0.5 * (z[0] + z[1]))
        w.mesh(chamfered_box(size, 0.012), middle, look, solid=False)
    elif kind == "cane":
        w.box((x, face + 0.002), y, z, w.look("wicker"), solid=False)
    elif kind == "slats":
        w.box((x, face + 0.001), y, z, parts.darker(look, 0.5), solid=False)
        rows = max(2, min(7, round((z[1] - z[0]) / 0.12)))
        step = (z[1] - z[0]) / rows
        for i in range(rows):
            w.box((x, face + 0.008), y, (z[0] + i * step, z[0] + (i + 0.7) * step), look, solid=False)
    return face + (0.015 if kind == "raised" else 0.002 if kind in ("frame", "cane") else 0.0)


def drawers(
    w: Workbench,
    x: float,
    y: Range,
    edges: Sequence[float],
    look: Look,
    metal: Look,
    front: Front,
    grip: Grip,
    columns: int = 1,
) -> None:
    """Drawers between these heights, side by side in columns."""
    shade = (edges[0] + 0.003, edges[-1] - 0.003)
    w.box((x, x + 0.003), (y[0] + 0.003, y[1] - 0.003), shade, parts.darker(look), solid=False)
    each = (y[1] - y[0]) / columns
    for low, high in itertools.pairwise(edges):
        for column in range(columns):
            left = y[0] + column * each
            face = leaf(w, x, (left, left + each), (low, high), look, front)
            middle, up = left + 0.5 * each, 0.5 * (low + high)
            if grip in ("slot", "rail") or high - low < 0.09:
                up, face = high - 0.025, min(face, x + parts.FRONT_M + 0.002)
            if grip == "knob" and each > 0.5:
                for side in BOTH:
                    handle(w, grip, (face, middle + side * 0.28 * each, up), 0.0, metal)
            else:
                wide = 0.9 * each if grip == "rail" else min(0.4 * each, 0.26)
                handle(w, grip, (face, middle, up), wide, metal)


def doors(
    w: Workbench, x: float, y: Range, z: Range, count: int, look: Look, metal: Look, front: Front, grip: Grip
) -> None:
    """Hinged doors side by side, handles where they meet."""
    w.box((x, x + 0.003), (y[0] + 0.003, y[1] - 0.003), (z[0] + 0.003, z[1] - 0.003), parts.darker(look), solid=False)
    each, tall = (y[1] - y[0]) / count, z[1] - z[0]
    up = z[0] + (0.5 if tall > 1.0 else 0.68) * tall
    for i in range(count):
        left = y[0] + i * each
        face = min(leaf(w, x, (left, left + each), z, look, front), x + parts.FRONT_M + 0.002)
        hand = left + (each - 0.035 if i % 2 == 0 and count > 1 else 0.035)
        handle(w, grip, (face, hand, up), min(0.5 * tall if grip == "rail" else 0.18, 0.5 * tall), metal, upright=True)


def graded(low: float, high: float, rows: int, growth: float) -> list[float]:
    """Edges of rows that grow downwards by this factor from one to the next."""
    shares = np.array([growth**i for i in range(rows)][::-1])
    return [low, *(low + (high - low) * np.cumsum(shares / shares.sum())).tolist()]


def _turned_leg(high: float, thick: float, x: int, y: int) -> MeshShape:
    """A cabriole: knee out, ankle in, a pad at the foot."""
    out = 0.6 * thick
    rings = [
        Ring(0.0, 0.5 * thick, 0.5 * thick, x * out, y * out),
        Ring(0.12 * high, 0.42 * thick, 0.42 * thick, x * 0.8 * out, y * 0.8 * out),
        Ring(0.3 * high, 0.28 * thick, 0.28 * thick, 0.0, 0.0),
        Ring(0.75 * high, 0.6 * thick, 0.6 * thick, x * 0.7 * out, y * 0.7 * out),
        Ring(high, 0.62 * thick, 0.62 * thick, 0.0, 0.0),
    ]
    return loft(rings, 8)


def feet(w: Workbench, x: Range, y: Range, high: float, kind: Feet, look: Look, thick: float = 0.05) -> None:
    """What carries a case whose plan is x, y, from the floor up to `high`."""
    inset = thick + 0.01
    corners = [(x[0] + inset, x[1] - inset), (y[0] + inset, y[1] - inset)]
    if kind == "plinth":
        w.box((x[0] + 0.02, x[1] - 0.05), (y[0] + 0.02, y[1] - 0.02), (0.0, high), look)
        return
    if kind == "sled":
        for edge in corners[1]:
            w.box((x[0] + 0.03, x[1] - 0.03), (edge - 0.014, edge + 0.014), (0.0, 0.02), look)
            for post in corners[0]:
                w.box((post - 0.012, post + 0.012), (edge - 0.014, edge + 0.014), (0.02, high), look)
        return
    for i, px in enumerate(corners[0]):
        for j, py in enumerate(corners[1]):
            sx, sy = BOTH[i], BOTH[j]
            if kind == "bun":
                w.ellipsoid((px, py, 0.5 * high), (0.8 * thick, 0.8 * thick, 0.5 * high), look)
            elif kind == "block":
                w.box((px - 0.6 * thick, px + 0.6 * thick), (py - 0.6 * thick, py + 0.6 * thick), (0.0, high), look)
            elif kind == "cabriole":
                w.mesh(_turned_leg(high, thick, sx, sy), (px, py, 0.0), look)
            elif kind == "castor":
                w.rod((px, py - 0.012, 0.5 * high), (px, py + 0.012, 0.5 * high), 0.5 * high, w.look("rubber"))
                w.box((px - 0.01, px + 0.01), (py - 0.02, py + 0.02), (0.6 * high, high), look)
            else:
                lean = 0.3 * high if kind == "splay" else 0.0
                leg = frustum((0.45 * thick, 0.45 * thick), (thick, thick), high, (-sx * lean * 0.5, -sy * lean * 0.5))
                w.mesh(leg, (px + sx * 0.5 * lean * 0.5, py + sy * 0.5 * lean * 0.5, 0.0), look)


def tops(w: Workbench, x: Range, y: Range, z: float) -> None:
    """The lid of a case as a place to put things, short of its edges."""
    w.top((x[0] + 0.04, x[1] - 0.04), (y[0] + 0.04, y[1] - 0.04), z)


def plan(depth: float, width: float) -> tuple[Range, Range]:
    """The x and y ranges of a rectangle about the origin."""
    return (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)


def open_case(w: Workbench, x: Range, y: Range, z: Range, board: float, look: Look, *, back: bool = True) -> None:
    """Sides, floor, lid and back of a box that is open in front."""
    for edge in (y[0], y[1] - board):
        w.box(x, (edge, edge + board), z, look)
    for low in (z[0], z[1] - board):
        w.box(x, (y[0] + board, y[1] - board), (low, low + board), look)
    if back:
        w.box((x[0], x[0] + 0.012), (y[0] + board, y[1] - board), (z[0] + board, z[1] - board), look)


def things(w: Workbench, x: Range, y: Range, z: float, count: int, free: float) -> None:
    """Books, boxes, bowls and vases in a row on a shelf with this much room above it."""
    each = (y[1] - y[0]) / count
    for i in range(count):
        at, room = y[0] + (i + 0.5) * each, min(0.8 * free, 0.24)
        half = min(0.42 * each, 0.09)
        middle = 0.5 * (x[0] + x[1])
        kind = w.choice(("book", "pot", "ceramic", "cardboard", "none"))
        if kind in ("book", "cardboard"):
            deep = min(0.1, 0.35 * (x[1] - x[0]))
            high = z + w.length(0.5, 0.95) * room
            w.box((middle - deep, middle + deep), (at - half, at + half), (z, high), w.new_look(kind), solid=False)
        elif kind != "none":
            w.cylinder((middle, at), (z, z + w.length(0.3, 0.8) * room), 0.8 * half, w.new_look(kind), solid=False)
