"""Sinks: free-standing, wall-hung, inset in a worktop, or on a washstand.

Sizes follow Neufert, Architects' Data, and Panero & Zelnik, Human Dimension and Interior Space: washbasins
0.40-0.70 m wide, 0.35-0.52 m deep, rim 0.80-0.90 m high; kitchen bowls about 0.40 x 0.48 m, 0.18 m deep.
"""

from __future__ import annotations

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, centred, inset
from sim.homes.housegen.furniture.shapes import Ring, loft, turned
from sim.homes.housegen.furniture.workbench import Range, Workbench


def _ceramic_basin(
    w: Workbench, x: Range, y: Range, rim: float, depth: float, look: Look, *, power: float = 4.5, taper: float = 0.8
) -> None:
    """Adds a basin of one piece: rounded corners, a rim with a ledge for the tap at -x, and an oval hollow.

    Args:
        w: the workbench.
        x: back and front.
        y: left and right.
        rim: height of the rim.
        depth: height of the outside.
        look: look of the basin.
        power: shape of its outline; 2 is an ellipse.
        taper: size of its lower side as a share of that of its rim.
    """
    middle, rx, ry = 0.5 * (x[0] + x[1]), 0.5 * (x[1] - x[0]), 0.5 * (y[1] - y[0])
    ledge = 0.05
    hollow = [(0.0, 1.0), (-0.55, 0.88), (-0.85, 0.4)]
    rings = [
        Ring(rim - depth, taper * rx, taper * ry, middle - 0.5 * (1.0 - taper) * rx, power=power),
        Ring(rim - 0.035, 0.97 * rx, 0.98 * ry, middle, power=power),
        Ring(rim, rx, ry, middle, power=power),
        *(
            Ring(rim + z * depth, s * (rx - ledge - 0.015), s * (ry - 0.035), middle + ledge, power=2.8)
            for z, s in hollow
        ),
    ]
    w.mesh(loft(rings, 16), (0.0, 0.0, 0.0), look)
    drain = rim - 0.85 * depth
    w.cylinder((middle + ledge, 0.0), (drain, drain + 0.005), 0.022, w.look("chrome"), solid=False)


def pedestal_sink(w: Workbench) -> None:
    """Builds a basin on a column."""
    width, depth, rim = w.width(0.50, 0.62), w.depth(0.42, 0.50), w.length(0.82, 0.86)
    white = w.look("ceramic")
    x, y = parts.footprint(depth, width)
    _ceramic_basin(w, x, y, rim, 0.16, white, taper=0.62)
    column = [Ring(0.0, 0.09, 0.11, -0.06), Ring(0.04, 0.075, 0.09, -0.06), Ring(rim - 0.15, 0.08, 0.095, -0.05)]
    w.mesh(loft(column, 12, hull=True), (0.0, 0.0, 0.0), white)
    parts.mixer_tap(w, (x[0] + 0.05, 0.0, rim), 0.12, 0.13, w.look("chrome"))


def wall_basin(w: Workbench) -> None:
    """Builds a basin hung on the wall with a bottle trap below."""
    width, depth = w.width(0.45, 0.65), w.depth(0.36, 0.46)
    w.mount_height_m = 0.56
    white, chrome, z = w.look("ceramic"), w.look("chrome"), 0.28
    _ceramic_basin(w, (0.0, depth), centred(width), z, 0.14, white, taper=0.75)
    w.cylinder((0.24, 0.0), (0.05, z - 0.12), 0.018, chrome, solid=False)
    w.cylinder((0.24, 0.0), (0.0, 0.08), 0.035, chrome, solid=False)
    w.rod_x((0.0, 0.06), (0.0, 0.24), 0.015, chrome, solid=False)
    parts.mixer_tap(w, (0.05, 0.0, z), 0.12, 0.13, chrome)


def inset_steel(w: Workbench) -> None:
    """Builds a steel kitchen bowl for a worktop. Its origin is at the surface of the worktop; it extends below."""
    steel = w.look("steel")
    parts.basin(w, (-0.20, 0.20), (-0.24, 0.24), 0.18, 0.18, 0.012, steel)
    w.box((-0.215, 0.215), (-0.255, -0.238), (0.178, 0.184), steel, solid=False)
    w.box((-0.215, 0.215), (0.238, 0.255), (0.178, 0.184), steel, solid=False)
    w.box((-0.215, -0.198), (-0.255, 0.255), (0.178, 0.184), steel, solid=False)
    w.box((0.198, 0.215), (-0.255, 0.255), (0.178, 0.184), steel, solid=False)
    w.cylinder((0.0, 0.0), (0.010, 0.016), 0.03, w.look("dark"), solid=False)
    parts.mixer_tap(w, (-0.207, 0.0, 0.18), 0.20, 0.26, w.look("chrome"))


def vessel_round(w: Workbench) -> None:
    """Builds a round bowl that stands on a washstand."""
    r, high, white = w.length(0.19, 0.22), 0.13, w.look("ceramic")
    outside = [(0.0, 0.6 * r), (0.55 * high, 0.92 * r), (high, r)]
    inside = [(high, r - 0.022), (0.55 * high, 0.80 * r), (0.18 * high, 0.35 * r)]
    w.mesh(turned(outside + inside, 16), (0.0, 0.0, 0.0), white)
    w.cylinder((0.0, 0.0), (0.17 * high, 0.2 * high), 0.022, w.look("chrome"), solid=False)
    parts.mixer_tap(w, (-r - 0.02, 0.0, 0.0), 0.16, 0.24, w.look("chrome"))


def vessel_square(w: Workbench) -> None:
    """Builds a shallow rectangular bowl that stands on a washstand."""
    half = 0.5 * w.length(0.44, 0.52)
    parts.basin(w, (-0.17, 0.17), (-half, half), 0.12, 0.12, 0.02, w.look("ceramic"))
    parts.mixer_tap(w, (-0.20, 0.0, 0.0), 0.15, 0.22, w.look("chrome"))
    w.cylinder((0.0, 0.0), (0.019, 0.024), 0.022, w.look("chrome"), solid=False)


def console_sink(w: Workbench) -> None:
    """Builds a slab with an oval basin below it on four metal legs with a rail."""
    width, depth, rim = w.width(0.60, 0.75), w.depth(0.45, 0.52), w.length(0.82, 0.87)
    metal, white = w.look("chrome"), w.look("ceramic")
    x, y = parts.footprint(depth, width)
    _ceramic_basin(w, x, y, rim, 0.07, white, power=6.0, taper=0.97)
    rx, ry = 0.5 * depth, 0.5 * width
    bowl = [Ring(rim - 0.19, rx - 0.16, ry - 0.22, 0.04), Ring(rim - 0.06, rx - 0.07, ry - 0.07, 0.03)]
    w.mesh(loft(bowl, 14, hull=True), (0.0, 0.0, 0.0), white)
    w.legs(inset(x, 0.04, 0.06), inset(y, 0.05), (0.0, rim - 0.06), 0.025, metal, round_=True)
    for side in BOTH_SIDES:
        w.rod_x((side * (0.5 * width - 0.06), 0.28), inset(x, 0.05, 0.07), 0.008, metal)
    parts.mixer_tap(w, (x[0] + 0.05, 0.0, rim), 0.14, 0.15, metal)


def inset_stone(w: Workbench) -> None:
    """Builds a deep stone kitchen bowl for a worktop."""
    stone = w.look("char")
    parts.basin(w, (-0.20, 0.20), (-0.24, 0.24), 0.18, 0.18, 0.03, stone)
    w.cylinder((0.0, 0.0), (0.028, 0.034), 0.03, w.look("steel"), solid=False)
    parts.mixer_tap(w, (-0.19, 0.06, 0.18), 0.20, 0.30, w.look("brass"))


def utility(w: Workbench) -> None:
    """Builds a deep laundry tub of plastic on a steel stand."""
    half, rim = 0.5 * w.width(0.50, 0.60), w.length(0.84, 0.88)
    depth, white, metal = w.depth(0.46, 0.52), w.look("ceramic"), w.look("metal")
    x = centred(depth)
    rx, lip = 0.5 * depth, 0.05
    tub = [Ring(rim - 0.34, 0.84 * rx, 0.84 * half, power=6), Ring(rim - lip, 0.92 * rx, 0.93 * half, power=6)]
    tub += [Ring(z, rx, half, power=6) for z in (rim - lip, rim)]
    tub += [Ring(rim, rx - 0.035, half - 0.035, power=6), Ring(rim - 0.3, 0.8 * rx, 0.8 * half, power=6)]
    w.mesh(loft(tub, 16), (0.0, 0.0, 0.0), white)
    w.legs(inset(x, 0.05), (-half + 0.05, half - 0.05), (0.0, rim - 0.33), 0.03, metal)
    for side in BOTH_SIDES:
        w.box(inset(x, 0.03), around(side * (half - 0.035), 0.01), (0.16, 0.19), metal)
    w.cylinder((0.0, 0.0), (rim - 0.42, rim - 0.33), 0.025, w.look("dark"), solid=False)
    w.box((x[0] - 0.02, x[0] + 0.01), (-half, half), (rim - 0.02, rim + 0.12), white)
    parts.mixer_tap(w, (x[0] + 0.02, 0.0, rim + 0.02), 0.20, 0.12, w.look("chrome"))


def trough(w: Workbench) -> None:
    """Builds a wide stone wash trough on two brackets, with two taps from the wall."""
    width, depth = w.width(0.85, 1.10), w.depth(0.42, 0.48)
    w.mount_height_m = 0.62
    stone, brass = w.look("stone"), w.look("brass")
    parts.basin(w, (0.0, depth), centred(width), 0.22, 0.14, 0.04, stone)
    for side in BOTH_SIDES:
        y = side * 0.36 * width
        w.box((0.0, 0.03), around(y, 0.02), (0.0, 0.08), w.look("iron"))
        w.bar((0.015, y, 0.02), (depth - 0.10, y, 0.08), 0.03, 0.02, w.look("iron"))
        w.rod_x((side * 0.22 * width, 0.34), (0.0, 0.17), 0.012, brass, solid=False)
        w.rod((0.16, side * 0.22 * width, 0.35), (0.16, side * 0.22 * width, 0.30), 0.012, brass, solid=False)
        w.rod_x((side * 0.22 * width + 0.07, 0.34), (0.0, 0.04), 0.022, brass, solid=False)


def double_steel(w: Workbench) -> None:
    """Builds one steel plate with a large and a small bowl."""
    steel = w.look("steel")
    parts.basin(w, (-0.20, 0.20), (-0.24, 0.05), 0.18, 0.18, 0.012, steel)
    parts.basin(w, (-0.20, 0.20), (0.05, 0.24), 0.18, 0.14, 0.012, steel)
    w.box((-0.215, -0.195), (-0.255, 0.255), (0.178, 0.185), steel, solid=False)
    w.box((0.195, 0.215), (-0.255, 0.255), (0.178, 0.185), steel, solid=False)
    for side in BOTH_SIDES:
        w.box((-0.215, 0.215), around(side * 0.246, 0.009), (0.178, 0.185), steel, solid=False)
    parts.mixer_tap(w, (-0.205, 0.05, 0.18), 0.20, 0.24, w.look("chrome"))


STYLES = (
    Style("sink", "pedestal", "train", pedestal_sink, ("standing",)),
    Style("sink", "wall_basin", "train", wall_basin, ("standing",), "wall"),
    Style("sink", "inset_steel", "train", inset_steel, ("inset",), "top"),
    Style("sink", "vessel_round", "train", vessel_round, ("vessel",), "top"),
    Style("sink", "vessel_square", "heldout", vessel_square, ("vessel",), "top"),
    Style("sink", "console", "heldout", console_sink, ("standing",)),
    Style("sink", "inset_stone", "heldout", inset_stone, ("inset",), "top"),
    Style("sink", "utility", "train", utility, ("standing",)),
    Style("sink", "double_steel", "train", double_steel, ("inset",), "top"),
    Style("sink", "trough", "heldout", trough, ("standing",), "wall"),
)
