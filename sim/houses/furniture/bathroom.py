"""Sinks, toilets, showers, bathtubs.

Ranges after Neufert, Architects' Data, and Panero & Zelnik: washbasins 0.40-0.70 m wide, 0.35-0.52 m deep, rim
0.80-0.90 m high; toilets 0.36-0.42 m wide, 0.60-0.72 m deep, seat 0.38-0.43 m high; showers 0.75-1.20 m square,
1.90-2.10 m high; bathtubs 1.50-1.80 m long, 0.70-0.85 m wide, 0.50-0.62 m high.
"""

from __future__ import annotations

import itertools
import math

from sim.houses.furniture import parts
from sim.houses.furniture.catalogue import Style
from sim.houses.furniture.item import Look
from sim.houses.furniture.shapes import Ring, chamfered_box, loft, named_mesh
from sim.houses.furniture.workbench import Workbench

_BOTH = (-1, 1)


# ---- sinks -------------------------------------------------------------------------------------------------------


def _bowl(
    w: Workbench,
    rx: float,
    ry: float,
    high: float,
    look: Look,
    at: tuple[float, float, float],
    *,
    power: float = 2.0,
    foot: float = 0.6,
) -> None:
    """A hollow bowl standing on `at`, opening upwards."""
    rings = [
        Ring(0.0, foot * rx, foot * ry, power=power),
        Ring(0.55 * high, 0.92 * rx, 0.92 * ry, power=power),
        Ring(high, rx, ry, power=power),
        Ring(high, rx - 0.022, ry - 0.022, power=power),
        Ring(0.55 * high, 0.80 * rx, 0.80 * ry, power=power),
        Ring(0.18 * high, 0.35 * rx, 0.35 * ry, power=power),
    ]
    w.mesh(loft(rings, 16), at, look)
    w.cylinder((at[0], at[1]), (at[2] + 0.17 * high, at[2] + 0.2 * high), 0.022, w.look("chrome"), solid=False)


def pedestal_sink(w: Workbench) -> None:
    """Basin on a column."""
    width, depth, rim = w.width(0.50, 0.62), w.depth(0.42, 0.50), w.length(0.82, 0.86)
    white = w.look("ceramic")
    _bowl(w, 0.5 * depth, 0.5 * width, 0.19, white, (0.0, 0.0, rim - 0.19), power=2.8, foot=0.5)
    w.box((-0.5 * depth, -0.5 * depth + 0.09), (-0.42 * width, 0.42 * width), (rim - 0.10, rim + 0.012), white)
    w.mesh(
        loft(
            [
                Ring(0.0, 0.12, 0.14, -0.04),
                Ring(0.05, 0.09, 0.11, -0.04),
                Ring(0.5, 0.07, 0.09, -0.04),
                Ring(rim - 0.15, 0.11, 0.14, -0.02),
            ],
            12,
            hull=True,
        ),
        (0.0, 0.0, 0.0),
        white,
    )
    parts.tap(w, (-0.5 * depth + 0.05, 0.0, rim + 0.012), 0.11, 0.10, w.look("chrome"))


def wall_basin(w: Workbench) -> None:
    """Rectangular basin hung on the wall with a bottle trap below."""
    width, depth = w.width(0.45, 0.65), w.depth(0.36, 0.46)
    w.mount_height_m = 0.56
    white, chrome, z = w.look("ceramic"), w.look("chrome"), 0.28
    parts.basin(w, (0.10, depth), (-0.5 * width, 0.5 * width), z, 0.13, 0.022, white)
    w.box((0.0, 0.10), (-0.5 * width, 0.5 * width), (z - 0.13, z), white)
    w.rod((0.24, 0.0, 0.05), (0.24, 0.0, z - 0.12), 0.018, chrome, solid=False)
    w.cylinder((0.24, 0.0), (0.0, 0.08), 0.035, chrome, solid=False)
    w.rod((0.0, 0.0, 0.06), (0.24, 0.0, 0.06), 0.015, chrome, solid=False)
    parts.tap(w, (0.05, 0.0, z), 0.11, 0.11, chrome)


def inset_steel(w: Workbench) -> None:
    """Steel kitchen bowl let into a worktop: origin at the worktop's surface is `rim`; hangs below it."""
    steel = w.look("steel")
    parts.basin(w, (-0.20, 0.20), (-0.24, 0.24), 0.18, 0.18, 0.012, steel)
    w.box((-0.215, 0.215), (-0.255, -0.238), (0.178, 0.184), steel, solid=False)
    w.box((-0.215, 0.215), (0.238, 0.255), (0.178, 0.184), steel, solid=False)
    w.box((-0.215, -0.198), (-0.255, 0.255), (0.178, 0.184), steel, solid=False)
    w.box((0.198, 0.215), (-0.255, 0.255), (0.178, 0.184), steel, solid=False)
    w.cylinder((0.0, 0.0), (0.010, 0.016), 0.03, w.look("dark"), solid=False)
    parts.tap(w, (-0.207, 0.0, 0.18), 0.20, 0.26, w.look("chrome"))


def vessel_round(w: Workbench) -> None:
    """Round bowl that stands on a washstand."""
    r = w.length(0.19, 0.22)
    _bowl(w, r, r, 0.13, w.look("ceramic"), (0.0, 0.0, 0.0))
    parts.tap(w, (-r - 0.02, 0.0, 0.0), 0.16, 0.24, w.look("chrome"))


def vessel_square(w: Workbench) -> None:
    """Shallow rectangular bowl that stands on a washstand."""
    half = 0.5 * w.length(0.44, 0.52)
    parts.basin(w, (-0.17, 0.17), (-half, half), 0.12, 0.12, 0.02, w.look("ceramic"))
    parts.tap(w, (-0.20, 0.0, 0.0), 0.15, 0.22, w.look("chrome"))
    w.cylinder((0.0, 0.0), (0.019, 0.024), 0.022, w.look("chrome"), solid=False)


def console_sink(w: Workbench) -> None:
    """Oval basin in a slab on four metal legs with a rail."""
    width, depth, rim = w.width(0.60, 0.75), w.depth(0.45, 0.52), w.length(0.82, 0.87)
    metal, white = w.look("chrome"), w.look("ceramic")
    x, y = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)
    parts.basin(w, (x[0] + 0.09, x[1]), y, rim, 0.12, 0.05, white)
    w.box((x[0], x[0] + 0.09), y, (rim - 0.06, rim), white)
    w.legs((x[0] + 0.02, x[1] - 0.02), (y[0] + 0.02, y[1] - 0.02), (0.0, rim - 0.06), 0.025, metal, round_=True)
    for side in _BOTH:
        w.rod(
            (x[0] + 0.03, side * (0.5 * width - 0.03), 0.28),
            (x[1] - 0.03, side * (0.5 * width - 0.03), 0.28),
            0.008,
            metal,
        )
    parts.tap(w, (x[0] + 0.045, 0.0, rim), 0.13, 0.12, metal)


def inset_stone(w: Workbench) -> None:
    """Deep stone kitchen bowl let into a worktop."""
    stone = w.look("char")
    parts.basin(w, (-0.20, 0.20), (-0.24, 0.24), 0.18, 0.18, 0.03, stone)
    w.cylinder((0.0, 0.0), (0.028, 0.034), 0.03, w.look("steel"), solid=False)
    parts.tap(w, (-0.19, 0.06, 0.18), 0.20, 0.30, w.look("brass"))


# ---- toilets -----------------------------------------------------------------------------------------------------


def _pan(w: Workbench, x0: float, x1: float, half: float, seat: float, look: Look, *, base: float = 0.6) -> None:
    """Bowl from the wall side x0 to its nose x1, seat ring and lid up to height `seat`."""
    middle, r = x1 - 0.5 * (x1 - x0), 0.5 * (x1 - x0)
    rings = [
        Ring(0.0, base * r, base * half, middle - 0.15 * r, power=2.6),
        Ring(0.35 * seat, (base - 0.04) * r, (base - 0.08) * half, middle - 0.15 * r, power=2.4),
        Ring(seat - 0.10, 0.95 * r, 0.95 * half, middle, power=2.2),
        Ring(seat - 0.04, r, half, middle, power=2.2),
    ]
    w.mesh(loft(rings, 14, hull=True), (0.0, 0.0, 0.0), look)


def _seat_and_lid(w: Workbench, x0: float, x1: float, half: float, seat: float, look: Look, *, open_: bool) -> None:
    middle, r = 0.5 * (x0 + x1), 0.5 * (x1 - x0)
    rings = [
        Ring(seat - 0.042, r, half, middle, power=2.2),
        Ring(seat, r, half, middle, power=2.2),
        Ring(seat, 0.66 * r, 0.64 * half, middle + 0.02, power=2.0),
        Ring(seat - 0.03, 0.60 * r, 0.58 * half, middle + 0.02, power=2.0),
    ]
    if open_:
        w.mesh(loft(rings, 16), (0.0, 0.0, 0.0), look)
        w.ellipsoid((middle + 0.02, 0.0, seat - 0.028), (0.58 * r, 0.56 * half, 0.003), w.look("screen"), solid=False)
        w.mesh(
            loft([Ring(0.0, r, half, power=2.2), Ring(0.018, 0.97 * r, 0.97 * half, power=2.2)], 16, hull=True),
            (x0 + 0.015, 0.0, seat + r),
            look,
            tilt=-1.48,
        )
    else:
        w.mesh(
            loft([*rings[:2], Ring(seat + 0.02, 0.96 * r, 0.96 * half, middle, power=2.2)], 16, hull=True),
            (0.0, 0.0, 0.0),
            look,
        )


def close_coupled(w: Workbench) -> None:
    """Floor-standing pan with its cistern behind."""
    white, half, seat = w.look("ceramic"), 0.5 * w.length(0.36, 0.40), w.length(0.40, 0.43)
    depth = w.length(0.62, 0.70)
    x0 = -0.5 * depth
    w.mesh(chamfered_box((0.18, 2 * half + 0.02, 0.36), 0.025), (x0 + 0.09, 0.0, seat + 0.16), white)
    w.mesh(chamfered_box((0.20, 2 * half + 0.04, 0.035), 0.012), (x0 + 0.10, 0.0, seat + 0.355), white)
    w.cylinder((x0 + 0.10, 0.0), (seat + 0.37, seat + 0.38), 0.025, w.look("chrome"), solid=False)
    w.box((x0 + 0.02, x0 + 0.25), (-0.10, 0.10), (0.0, seat - 0.01), white)
    _pan(w, x0 + 0.15, 0.5 * depth, half, seat, white)
    _seat_and_lid(w, x0 + 0.19, 0.5 * depth, half, seat, white, open_=w.chance(0.5))


def wall_hung(w: Workbench) -> None:
    """Pan hung on a boxed-in cistern with a flush plate."""
    white, half, seat = w.look("ceramic"), 0.5 * w.length(0.35, 0.38), w.length(0.40, 0.43)
    boxed = w.look("lacquer")
    w.box((-0.36, -0.18), (-0.42, 0.42), (0.0, 1.12), boxed)
    w.box((-0.18, -0.172), (-0.12, 0.12), (0.90, 1.06), w.look("chrome"), solid=False)
    rings = [
        Ring(0.10, 0.12, 0.10, -0.08, power=2.6),
        Ring(0.20, 0.20, 0.85 * half, 0.0, power=2.4),
        Ring(seat - 0.04, 0.265, half, 0.075, power=2.4),
    ]
    w.mesh(loft(rings, 14, hull=True), (0.0, 0.0, 0.0), white)
    w.box((-0.19, -0.04), (-0.8 * half, 0.8 * half), (0.16, seat - 0.04), white)
    _seat_and_lid(w, -0.17, 0.34, half, seat, white, open_=w.chance(0.3))


def high_cistern(w: Workbench) -> None:
    """Old toilet: high cistern on the wall, pipe, wooden seat."""
    white, wood, brass, half, seat = w.look("ceramic"), w.look("wood"), w.look("brass"), 0.19, w.length(0.41, 0.44)
    x0 = -0.30
    w.box((x0 + 0.02, x0 + 0.20), (-0.10, 0.10), (0.10, seat - 0.05), white)
    _pan(w, x0 + 0.06, 0.30, half, seat, white, base=0.55)
    _seat_and_lid(w, x0 + 0.10, 0.30, half, seat, wood, open_=True)
    w.rod((x0 + 0.04, 0.0, 0.30), (x0 + 0.04, 0.0, 1.70), 0.018, brass)
    w.box((x0, x0 + 0.19), (-0.24, 0.24), (1.68, 2.0), white)
    w.box((x0, x0 + 0.20), (-0.25, 0.25), (2.0, 2.02), wood)
    w.rod((x0 + 0.15, 0.22, 1.05), (x0 + 0.15, 0.22, 1.69), 0.004, brass, solid=False)
    w.ball((x0 + 0.15, 0.22, 1.04), 0.02, wood, solid=False)
    for z in (0.8, 1.4):
        w.box((x0, x0 + 0.05), (-0.03, 0.03), (z, z + 0.02), brass, solid=False)


# ---- showers -----------------------------------------------------------------------------------------------------


def _shower_set(w: Workbench, x: float, y: float, metal: Look, *, rain: bool) -> None:
    """Rail, head, hose and mixer on the back wall at x."""
    w.rod((x + 0.05, y, 1.0), (x + 0.05, y, 2.0), 0.010, metal, solid=False)
    for z in (1.0, 1.95):
        w.rod((x, y, z), (x + 0.05, y, z), 0.014, metal, solid=False)
    w.box((x, x + 0.06), (y - 0.13, y + 0.13), (1.02, 1.08), metal, solid=False)
    if rain:
        w.rod((x + 0.05, y, 2.0), (x + 0.32, y, 2.0), 0.010, metal, solid=False)
        w.cylinder((x + 0.32, y), (1.97, 2.0), 0.12, metal, solid=False)
    else:
        w.rod((x + 0.05, y, 1.80), (x + 0.13, y, 1.88), 0.012, metal, solid=False)
        w.rod((x + 0.12, y, 1.885), (x + 0.15, y, 1.865), 0.05, metal, solid=False)


def corner_cabin(w: Workbench) -> None:
    """Square tray with two glass sides; stands in a corner at smallest x and smallest y."""
    side = w.width(0.80, 1.00)
    half, high, metal, glass = 0.5 * side, w.length(1.90, 2.02), w.look("chrome"), w.look("glass")
    w.box((-half, half), (-half, half), (0.0, 0.07), w.look("ceramic"))
    w.cylinder((0.0, 0.0), (0.07, 0.074), 0.045, metal, solid=False)
    w.box((half - 0.010, half - 0.002), (-half, half), (0.09, high), glass)
    w.box((-half, half), (half - 0.010, half - 0.002), (0.09, high), glass)
    for x, y in ((half - 0.012, half - 0.012), (half - 0.012, -half + 0.012), (-half + 0.012, half - 0.012)):
        w.box((x - 0.012, x + 0.012), (y - 0.012, y + 0.012), (0.06, high + 0.015), metal)
    for z in (0.08, high):
        w.box((half - 0.024, half), (-half, half), (z - 0.012, z + 0.012), metal)
        w.box((-half, half), (half - 0.024, half), (z - 0.012, z + 0.012), metal)
    w.rod((half + 0.03, 0.10, 0.95), (half + 0.03, 0.10, 1.20), 0.010, metal, solid=False)
    for z in (0.96, 1.19):
        w.rod((half - 0.005, 0.10, z), (half + 0.03, 0.10, z), 0.006, metal, solid=False)
    _shower_set(w, -half, -0.05, metal, rain=False)


def curved_cabin(w: Workbench) -> None:
    """Quadrant tray with bent glass."""
    side = w.width(0.85, 1.00)
    half, high, metal, glass = 0.5 * side, w.length(1.90, 2.00), w.look("metal"), w.look("glass")
    points = [
        (half, -half),
        (half, -0.1 * half),
        (0.82 * half, 0.45 * half),
        (0.45 * half, 0.82 * half),
        (-0.1 * half, half),
        (-half, half),
    ]
    outline = [(-half, -half), *points]
    tray = [(x, y, z) for x, y in outline for z in (0.0, 0.12)]
    w.mesh(named_mesh("tray", tray), (0.0, 0.0, 0.0), w.look("ceramic"))
    for a, b in itertools.pairwise(points):
        for z in (0.13, high):
            w.bar((*a, z), (*b, z), 0.022, 0.022, metal)
        m = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
        long = ((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2) ** 0.5
        w.box(
            (m[0] - 0.5 * long, m[0] + 0.5 * long),
            (m[1] - 0.003, m[1] + 0.003),
            (0.13, high),
            glass,
            turn=math.atan2(b[1] - a[1], b[0] - a[0]),
        )
    for x, y in (points[0], points[2], points[3], points[-1]):
        w.box((x - 0.011, x + 0.011), (y - 0.011, y + 0.011), (0.12, high), metal)
    _shower_set(w, -half, -0.2 * half, metal, rain=True)


# ---- bathtubs ----------------------------------------------------------------------------------------------------


def built_in(w: Workbench) -> None:
    """Tub in a panelled surround against the wall, with a sloping end; long side along the wall."""
    width, depth, high = w.width(1.55, 1.80), w.depth(0.70, 0.80), w.length(0.52, 0.60)
    white, chrome = w.look("ceramic"), w.look("chrome")
    x, y = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)
    parts.basin(w, x, y, high, high, 0.05, white)
    w.box((x[0] + 0.05, x[1] - 0.05), (y[0] + 0.05, y[1] - 0.05), (0.05, 0.16), white)
    w.box((x[0] + 0.04, x[1] - 0.04), (y[0] + 0.02, y[0] + 0.30), (0.10, high - 0.10), white, roll=0.5, solid=False)
    parts.tap(w, (x[0] + 0.03, y[1] - 0.40, high), 0.16, 0.12, chrome)
    w.rod((0.0, y[1] - 0.052, high - 0.16), (0.0, y[1] - 0.062, high - 0.16), 0.03, chrome, solid=False)


def freestanding(w: Workbench) -> None:
    """Oval tub on the floor with a standing tap."""
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
    w.rod((-rx - 0.06, 0.3, 0.0), (-rx - 0.06, 0.3, 0.92), 0.018, metal)
    w.rod((-rx - 0.06, 0.3, 0.91), (-rx + 0.12, 0.3, 0.89), 0.014, metal, round_ends=True)
    w.cylinder((-rx - 0.06, 0.3), (0.0, 0.015), 0.05, metal)


STYLES = (
    Style("sink", "pedestal", "train", pedestal_sink, ("standing",)),
    Style("sink", "wall_basin", "train", wall_basin, ("standing",), "wall"),
    Style("sink", "inset_steel", "train", inset_steel, ("inset",), "top"),
    Style("sink", "vessel_round", "train", vessel_round, ("vessel",), "top"),
    Style("sink", "vessel_square", "heldout", vessel_square, ("vessel",), "top"),
    Style("sink", "console", "heldout", console_sink, ("standing",)),
    Style("sink", "inset_stone", "heldout", inset_stone, ("inset",), "top"),
    Style("toilet", "close_coupled", "train", close_coupled),
    Style("toilet", "wall_hung", "train", wall_hung),
    Style("toilet", "high_cistern", "heldout", high_cistern),
    Style("shower", "corner_cabin", "train", corner_cabin),
    Style("shower", "curved_cabin", "heldout", curved_cabin),
    Style("bathtub", "built_in", "train", built_in),
    Style("bathtub", "freestanding", "heldout", freestanding),
)
