"""Showers and bathtubs.

Sizes follow Neufert, Architects' Data: showers 0.75-1.20 m square, 1.90-2.10 m high; bathtubs 1.50-1.80 m long,
0.70-0.85 m wide, 0.50-0.62 m high.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.item import Look, MeshShape
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around
from sim.homes.housegen.furniture.shapes import Ring, chamfered_box, drape, loft, named_mesh, ring_faces
from sim.homes.housegen.furniture.workbench import CORNERS, Workbench


def _shower_set(w: Workbench, x: float, y: float, tray: float, metal: Look, *, rain: bool) -> None:
    """Adds a slim tower at x, from the tray up, with mixer, rail and a rain head on an arm or a hand shower."""
    w.box((x, x + 0.025), around(y, 0.07), (tray - 0.005, 2.0), w.look("ceramic"), solid=False)
    x += 0.02
    w.cylinder((x + 0.05, y), (1.1, 1.96), 0.009, metal, solid=False)
    for z in (1.1, 1.95):
        w.rod_x((y, z), (x, x + 0.05), 0.012, metal, solid=False)
    w.box((x, x + 0.05), around(y, 0.12), (1.02, 1.07), metal, solid=False)
    if rain:
        w.rod_x((y, 1.97), (x, x + 0.32), 0.010, metal, solid=False)
        w.cylinder((x + 0.32, y), (1.94, 1.97), 0.12, metal, solid=False)
    else:
        w.rod((x + 0.05, y, 1.80), (x + 0.13, y, 1.88), 0.012, metal, solid=False)
        w.rod((x + 0.12, y, 1.885), (x + 0.15, y, 1.865), 0.05, metal, solid=False)


def _rounded_tub(w: Workbench, depth: float, width: float, high: float, look: Look) -> None:
    """Adds a rectangular block with an oval hollow and a drain."""
    x, y = 0.5 * depth, 0.5 * width
    rings = [
        Ring(0.0, x, y, power=24), Ring(high, x, y, power=24), Ring(high, x - 0.06, y - 0.07, power=5),
        Ring(0.45 * high, x - 0.11, y - 0.16, power=4), Ring(0.15, x - 0.19, y - 0.30, power=3),
    ]  # fmt: skip
    w.mesh(loft(rings, 16), (0.0, 0.0, 0.0), look)
    w.cylinder((0.0, y - 0.36), (0.148, 0.156), 0.03, w.look("chrome"), solid=False)


def _pane(w: Workbench, a: tuple[float, float], b: tuple[float, float], low: float, high: float, glass: Look) -> None:
    """Adds an upright pane of glass between two points of the plan."""
    x, y, half = 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * math.dist(a, b)
    turn = math.atan2(b[1] - a[1], b[0] - a[0])
    w.box(around(x, half), around(y, 0.003), (low, high), glass, turn=turn)


def _glazed_tray(
    w: Workbench, points: Sequence[tuple[float, float]], tray: float, high: float, metal: Look, bar: float
) -> None:
    """Adds a corner tray of a height with panes between metal bars along its outline, and one at its right side.

    The outline leads from the right end of the front to the left end of the back wall, at half and -half a side.
    """
    half, low, glass = points[0][0], tray + 0.01, w.look("glass")
    corners = [(x, y, z) for x, y in ((-half, -half), *points) for z in (0.0, tray)]
    w.mesh(named_mesh("tray", corners), (0.0, 0.0, 0.0), w.look("ceramic"))
    _pane(w, (-half, -half + 0.004), (half, -half + 0.004), low, high, glass)
    for a, b in itertools.pairwise(points):
        _pane(w, a, b, low, high, glass)
        for z in (low, high):
            w.bar((*a, z), (*b, z), bar, bar, metal)


def _hollow(
    outline: list[tuple[float, float]], centre: tuple[float, float], rim: float, floor: float, high: float, deep: float
) -> MeshShape:
    """Returns the mesh of a tub with a convex outline.

    The hollow is the outline scaled about `centre` by `rim` at the top and by `floor` at the bottom.
    """

    def ring(scale: float, z: float) -> list[tuple[float, float, float]]:
        return [(centre[0] + scale * (x - centre[0]), centre[1] + scale * (y - centre[1]), z) for x, y in outline]

    vertices = [*ring(1.0, 0.0), *ring(1.0, high), *ring(rim, high), *ring(floor, deep)]
    return named_mesh("tub", vertices, ring_faces(4, len(outline)))


def freestanding(w: Workbench) -> None:
    """Builds an oval tub on the floor with a standing tap."""
    width, depth, high = w.width(1.60, 1.78), w.depth(0.72, 0.82), w.length(0.56, 0.62)
    white, metal = w.look("ceramic"), w.look("chrome")
    rx, ry = 0.5 * depth, 0.5 * width
    rings = [
        Ring(0.0, 0.78 * rx, 0.82 * ry, power=2.4),
        Ring(0.5 * high, 0.92 * rx, 0.93 * ry, power=2.4),
        Ring(high, rx, ry, power=2.4),
        Ring(high, rx - 0.04, ry - 0.04, power=2.4),
        Ring(0.4 * high, 0.76 * rx, 0.80 * ry, power=2.4),
        Ring(0.14, 0.6 * rx, 0.7 * ry, power=2.4),
    ]
    w.mesh(loft(rings, 16), (0.0, 0.0, 0.0), white)
    w.cylinder((-rx - 0.06, 0.3), (0.0, 0.92), 0.018, metal)
    w.rod((-rx - 0.06, 0.3, 0.91), (-rx + 0.12, 0.3, 0.89), 0.014, metal, round_ends=True)
    w.cylinder((-rx - 0.06, 0.3), (0.0, 0.015), 0.05, metal)


def walk_in(w: Workbench) -> None:
    """Builds a shower with a flat tray, one fixed pane, a rain head and a niche tower; one side is open."""
    width, depth, high = w.width(1.10, 1.40), w.depth(0.80, 0.95), w.length(1.95, 2.05)
    metal = w.look("chrome") if w.chance(0.5) else w.look("iron")
    x, y = parts.footprint(depth, width)
    w.box(x, y, (0.0, 0.035), w.look("stone"))
    w.box((-0.06, 0.06), (-0.06, 0.06), (0.035, 0.038), metal, solid=False)
    w.box((x[1] - 0.012, x[1] - 0.002), (y[0], y[1] - 0.45), (0.035, high), w.look("glass"))
    w.box((x[1] - 0.022, x[1] + 0.008), (y[0], y[1] - 0.45), (0.035, 0.055), metal)
    w.rod_x((y[1] - 0.47, high - 0.02), (x[1] - 0.007, x[0]), 0.010, metal, solid=False)
    w.box((x[1] - 0.02, x[1] + 0.006), (y[1] - 0.475, y[1] - 0.45), (0.035, high), metal)
    _shower_set(w, x[0], y[0] + 0.40, 0.035, metal, rain=True)


def curtained(w: Workbench) -> None:
    """Builds a shower tray with a curtain on a rail that runs around the open sides."""
    half, high = 0.5 * w.width(0.80, 0.95), 2.0
    metal, cloth = w.look("chrome"), w.look("curtain")
    w.mesh(chamfered_box((2 * half, 2 * half, 0.13), 0.02), (0.0, 0.0, 0.065), w.look("ceramic"))
    edge = half - 0.03
    w.rod_y((edge, high), (-half, edge), 0.012, metal, solid=False)
    w.rod_x((edge, high), (-half, edge), 0.012, metal, solid=False)
    w.cylinder((edge, edge), (0.12, high), 0.014, metal)
    span = w.length(0.55, 0.75) * 2 * half
    w.mesh(drape(span, high - 0.20, 0.06, 8), (edge - 0.03, edge - 0.03 - 0.5 * span, 0.19), cloth, solid=False)
    w.mesh(drape(0.3, high - 0.20, 0.07, 5), (-half + 0.18, edge + 0.03, 0.19), cloth, solid=False, turn=-0.5 * math.pi)
    _shower_set(w, -half, -0.10, 0.12, metal, rain=False)


def cubicle(w: Workbench) -> None:
    """Builds a prefabricated cabin with an opaque back and side, framed sliding doors and a roof."""
    half, high = 0.5 * w.width(0.80, 0.95), w.length(2.02, 2.12)
    white, metal, glass = w.look("ceramic"), w.look("metal"), w.look("glass")
    w.box((-half, half), (-half, half), (0.0, 0.15), white)
    w.box((-half, -half + 0.02), (-half, half), (0.15, high), white)
    for side in BOTH_SIDES:
        edge = side * (half - 0.01)
        w.box((-half + 0.02, half), around(edge, 0.01), (0.15, high), white if side < 0 else glass)
    w.box((-half, half), (-half, half), (high - 0.02, high + 0.05), white)
    for low, front in ((-half + 0.02, half - 0.012), (-0.02, half - 0.028)):
        span = (low, low + half + 0.01)
        w.box(around(front, 0.004), span, (0.17, high - 0.02), glass)
        for c in span:
            w.box(around(front, 0.010), around(c, 0.012), (0.15, high), metal)
    w.cylinder((half + 0.01, -0.02), (0.95, 1.25), 0.012, metal, solid=False)
    _shower_set(w, -half + 0.02, 0.0, 0.15, metal, rain=False)


def corner_tub(w: Workbench) -> None:
    """Builds a quarter-round tub with an apron, for a corner at smallest x and y."""
    side, high = w.width(1.25, 1.45), w.length(0.54, 0.60)
    white, half = w.look("ceramic"), 0.5 * side
    outer = [
        (-half, -half),
        (half, -half),
        (half, -0.15 * half),
        (0.62 * half, 0.62 * half),
        (-0.15 * half, half),
        (-half, half),
    ]
    w.mesh(_hollow(outer, (-0.12 * half, -0.12 * half), 0.84, 0.66, high, 0.16), (0.0, 0.0, 0.0), white)
    parts.mixer_tap(w, (-half + 0.08, -half + 0.30, high), 0.16, 0.13, w.look("chrome"))
    w.cylinder((-0.12 * half, -0.12 * half), (0.158, 0.168), 0.03, w.look("chrome"), solid=False)


def barrel(w: Workbench) -> None:
    """Builds an oval soaking tub of wooden staves with two hoops and a tap on its rim."""
    rx, ry, high = 0.5 * w.depth(0.70, 0.78), 0.5 * w.width(1.15, 1.40), w.length(0.60, 0.66)
    wood, metal = w.look("wood"), w.look("iron")
    rings = [
        *(Ring(z * high, (0.93 + 0.07 * z) * rx, (0.95 + 0.05 * z) * ry, power=2.3) for z in (0.0, 1.0)),
        Ring(high, rx - 0.045, ry - 0.045, power=2.3),
        Ring(0.14, 0.93 * rx - 0.055, 0.95 * ry - 0.055, power=2.3),
    ]
    w.mesh(loft(rings, 20), (0.0, 0.0, 0.0), wood)
    for share in (0.18, 0.8):
        grown = 0.004 - 0.07 * rx * (1.0 - share)
        band = [
            Ring(share * high + z, rx + grown - inward, ry + grown - inward, power=2.3)
            for z, inward in ((-0.02, 0.001), (0.02, 0.0), (0.02, 0.03), (-0.02, 0.03))
        ]
        w.mesh(loft(band, 20, loop=True), (0.0, 0.0, 0.0), metal, solid=False)
    groove = parts.darker(wood, 0.4)
    for i in range(-5, 6):
        y = 0.16 * i * ry
        x = rx * (1.0 - abs(y / ry) ** 2.3) ** (1.0 / 2.3)
        w.bar((0.931 * x, 0.95 * y, 0.0), (x + 0.0015, y, high - 0.002), 0.006, 0.004, groove, solid=False)
    w.cylinder((0.0, 0.3 * ry), (0.136, 0.146), 0.03, w.look("chrome"), solid=False)
    parts.mixer_tap(w, (-rx + 0.025, 0.0, high - 0.01), 0.16, 0.14, w.look("chrome"))


def clawfoot(w: Workbench) -> None:
    """Builds a slipper tub on four feet with a rolled rim, one raised end and a standing tap."""
    width, depth, high = w.width(1.55, 1.72), w.depth(0.72, 0.80), w.length(0.56, 0.62)
    white, metal = w.look("ceramic"), w.look("brass")
    rx, ry = 0.5 * depth, 0.5 * width
    rings = [
        Ring(0.14, 0.50 * rx, 0.70 * ry, power=2.4),
        Ring(0.35, 0.86 * rx, 0.90 * ry, power=2.4),
        Ring(high - 0.03, 0.94 * rx, 0.96 * ry, power=2.4),
        Ring(high, rx, ry, power=2.4),
        Ring(high, rx - 0.05, ry - 0.05, power=2.4),
        Ring(0.28, 0.66 * rx, 0.74 * ry, power=2.4),
    ]
    w.mesh(loft(rings, 16), (0.0, 0.0, 0.0), white)
    w.ellipsoid((0.0, -ry + 0.05, high), (0.50 * rx, 0.05, 0.09), white, solid=False)
    for sx, sy in CORNERS:
        knee = (sx * 0.66 * rx, sy * 0.66 * ry, 0.17)
        ankle = (sx * 0.60 * rx, sy * 0.64 * ry, 0.06)
        w.rod((sx * 0.50 * rx, sy * 0.58 * ry, 0.26), knee, 0.032, metal, round_ends=True)
        w.rod(knee, ankle, 0.024, metal, round_ends=True)
        w.ellipsoid((sx * 0.66 * rx, sy * 0.66 * ry, 0.028), (0.046, 0.04, 0.028), metal)
    for y in (0.22, 0.36):
        w.cylinder((-rx - 0.04, y), (0.0, high + 0.12), 0.012, metal)
    w.rod_y((-rx - 0.04, high + 0.12), (0.20, 0.38), 0.020, metal, round_ends=True)
    w.rod((-rx - 0.04, 0.29, high + 0.12), (-rx + 0.10, 0.29, high + 0.08), 0.013, metal, round_ends=True)


def built_in(w: Workbench) -> None:
    """Builds a tub in a panelled surround, oval inside, with taps at one end; its long side is along the wall."""
    width, depth, high = w.width(1.55, 1.80), w.depth(0.70, 0.80), w.length(0.52, 0.60)
    white, chrome = w.look("ceramic"), w.look("chrome")
    _rounded_tub(w, depth, width, high, white)
    for i in range(3):
        c = (i - 1) * width / 3
        w.box(
            (0.5 * depth - 0.004, 0.5 * depth + 0.010), around(c, 0.15 * width), (0.05, high - 0.09), white, solid=False
        )
    parts.mixer_tap(w, (-0.5 * depth + 0.035, 0.5 * width - 0.42, high), 0.16, 0.12, chrome)
    for dy in (-0.08, 0.08):
        w.cylinder((-0.5 * depth + 0.035, 0.5 * width - 0.42 + dy), (high, high + 0.05), 0.018, chrome, solid=False)


def with_screen(w: Workbench) -> None:
    """Builds a built-in tub behind a wooden panel, with a glass screen and a shower set above its tap end."""
    width, depth, high = w.width(1.55, 1.80), w.depth(0.70, 0.80), w.length(0.54, 0.60)
    white, chrome = w.look("ceramic"), w.look("chrome")
    x, y = parts.footprint(depth, width)
    _rounded_tub(w, depth, width, high, white)
    w.box((x[1] - 0.005, x[1] + 0.012), y, (0.0, high - 0.05), w.look("wood"), solid=False)
    w.box((x[1] - 0.035, x[1] - 0.027), (y[1] - 0.85, y[1]), (high, 1.95), w.look("glass"))
    w.box((x[1] - 0.041, x[1] - 0.021), (y[1] - 0.02, y[1]), (high, 1.96), chrome)
    rail = (x[0] + 0.03, y[1] - 0.40)
    w.rod((*rail, high), (*rail, 1.95), 0.011, chrome)
    w.rod((*rail, 1.94), (x[0] + 0.30, y[1] - 0.40, 1.94), 0.010, chrome, solid=False, round_ends=True)
    w.cylinder((x[0] + 0.30, y[1] - 0.40), (1.90, 1.94), 0.09, chrome, solid=False)
    w.box((x[0] + 0.02, x[0] + 0.07), (y[1] - 0.52, y[1] - 0.28), (high + 0.08, high + 0.13), chrome, solid=False)


def corner_cabin(w: Workbench) -> None:
    """Builds a square tray glazed on three sides, with a shower tower at the wall and a handle on the front."""
    side = w.width(0.80, 1.00)
    half, high, metal, glass = 0.5 * side, w.length(1.90, 2.02), w.look("chrome"), w.look("glass")
    w.box((-half, half), (-half, half), (0.0, 0.07), w.look("ceramic"))
    w.cylinder((0.0, 0.0), (0.07, 0.074), 0.045, metal, solid=False)
    w.box((half - 0.010, half - 0.002), (-half, half), (0.09, high), glass)
    for sy in BOTH_SIDES:
        w.box((-half, half), parts.on_side(sy, half - 0.010, half - 0.002), (0.09, high), glass)
        for x in (-half + 0.012, half - 0.012):
            y = sy * (half - 0.012)
            w.box(around(x, 0.012), around(y, 0.012), (0.06, high + 0.015), metal)
    for z in (0.08, high):
        w.box((half - 0.024, half), (-half, half), around(z, 0.012), metal)
    w.cylinder((half + 0.03, 0.10), (0.95, 1.20), 0.010, metal, solid=False)
    for z in (0.96, 1.19):
        w.rod_x((0.10, z), (half - 0.005, half + 0.03), 0.006, metal, solid=False)
    _shower_set(w, -half, -0.05, 0.07, metal, rain=False)


def curved_cabin(w: Workbench) -> None:
    """Builds a quadrant tray with bent glass for a corner at smallest x and y; the right side is a straight pane."""
    half, high = 0.5 * w.width(0.85, 1.00), w.length(1.90, 2.00)
    metal = w.look("metal")
    points = [
        (half, -half),
        (half, -0.1 * half),
        (0.82 * half, 0.45 * half),
        (0.45 * half, 0.82 * half),
        (-0.1 * half, half),
        (-half, half),
    ]
    _glazed_tray(w, points, 0.12, high, metal, 0.022)
    for x, y in (points[0], points[2], points[3], points[-1]):
        w.box(around(x, 0.011), around(y, 0.011), (0.12, high), metal)
    _shower_set(w, -half, -0.2 * half, 0.12, metal, rain=True)


def pentagon_cabin(w: Workbench) -> None:
    """Builds a five-sided tray with a door across the corner and a brass frame; the right side is a straight pane."""
    half, high = 0.5 * w.width(0.88, 1.00), w.length(1.92, 2.02)
    metal = w.look("brass")
    points = [(half, -half), (half, -0.05 * half), (-0.05 * half, half), (-half, half)]
    _glazed_tray(w, points, 0.06, high, metal, 0.02)
    for x, y in points:
        w.box(around(x, 0.012), around(y, 0.012), (0.05, high), metal)
    handle = (0.475 * half + 0.035, 0.475 * half + 0.035)
    w.rod((*handle, 0.9), (*handle, 1.2), 0.011, metal, solid=False)
    for z in (0.91, 1.19):
        w.rod((0.475 * half, 0.475 * half, z), (*handle, z), 0.007, metal, solid=False)
    _shower_set(w, -half, -0.1, 0.06, metal, rain=True)


STYLES = (
    Style("shower", "corner_cabin", "train", corner_cabin),
    Style("shower", "curved_cabin", "heldout", curved_cabin),
    Style("bathtub", "freestanding", "heldout", freestanding),
    Style("shower", "walk_in", "train", walk_in),
    Style("shower", "curtained", "train", curtained),
    Style("shower", "cubicle", "train", cubicle),
    Style("shower", "pentagon_cabin", "heldout", pentagon_cabin),
    Style("bathtub", "corner", "train", corner_tub),
    Style("bathtub", "barrel", "train", barrel),
    Style("bathtub", "clawfoot", "heldout", clawfoot),
    Style("bathtub", "built_in", "train", built_in),
    Style("bathtub", "with_screen", "train", with_screen),
)
