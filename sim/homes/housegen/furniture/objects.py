"""Small objects on tops and floors: books, vases, bowls, kettles, boxes, baskets.

Usual retail dimensions.
"""

from __future__ import annotations

import math

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, polar
from sim.homes.housegen.furniture.parts.flat_pictures import Page, photograph
from sim.homes.housegen.furniture.parts.leaves import Body, arch, blade, blossom, joined, tube
from sim.homes.housegen.furniture.shapes import chamfered_box, hoop, turned
from sim.homes.housegen.furniture.workbench import CORNERS, Workbench


def book_stack(w: Workbench) -> None:
    """Builds a stack of three or four books."""
    z = 0.0
    for _ in range(w.whole(3, 4)):
        thick, dx, dy = w.length(0.02, 0.04), w.length(0.075, 0.10), w.length(0.10, 0.13)
        w.box((-dx, dx), (-dy, dy), (z, z + thick), w.new_look("book"), turn=w.length(-0.25, 0.25))
        z += thick


def vase(w: Workbench) -> None:
    """Builds a vase with a few flowers."""
    r, high = w.length(0.05, 0.08), w.length(0.16, 0.26)
    w.mesh(
        turned([(0.0, 0.6 * r), (0.4 * high, r), (0.8 * high, 0.45 * r), (high, 0.6 * r)], 12),
        (0.0, 0.0, 0.0),
        w.look("pot"),
    )
    green: list[Body] = []
    flowers: list[Body] = []
    for i in range(5):
        a = math.tau * i / 5
        tip = (*polar(0.07, a), high + 0.13 + 0.025 * i)
        green.append(tube([(0.0, 0.0, 0.9 * high), tip], (0.003, 0.002), 3))
        green.append(blade(arch((0.0, 0.0, 0.95 * high), a + 0.9, 0.09, 0.10, 0.01), 0.04))
        flowers.append(blossom(tip, (1.5 * tip[0], 1.5 * tip[1], 0.06), 0.042))
    w.mesh(joined("leaves", green), (0.0, 0.0, 0.0), w.look("foliage"), solid=False)
    w.mesh(joined("flowers", flowers), (0.0, 0.0, 0.0), w.look("flower"), solid=False)


def box_crate(w: Workbench) -> None:
    """Builds a taped cardboard box."""
    dx, dy, dz = 0.5 * w.length(0.28, 0.42), 0.5 * w.length(0.34, 0.55), w.length(0.24, 0.38)
    w.box((-dx, dx), (-dy, dy), (0.0, dz), w.look("cardboard"))
    w.box((-dx - 0.001, dx + 0.001), (-0.025, 0.025), (dz - 0.08, dz + 0.002), w.look("paper"), solid=False)


def fruit_bowl(w: Workbench) -> None:
    """Builds a shallow bowl of fruit."""
    r = w.length(0.12, 0.16)
    w.mesh(
        turned([(0.0, 0.4 * r), (0.07, r), (0.07, 0.92 * r), (0.025, 0.4 * r)], 14), (0.0, 0.0, 0.0), w.look("ceramic")
    )
    for i in range(4):
        a = math.tau * i / 3
        at = (*polar(0.45 * r, a), 0.07) if i < 3 else (0.0, 0.0, 0.11)
        w.ball(at, 0.042, w.new_look("paint"), solid=False)


def kettle(w: Workbench) -> None:
    """Builds a kettle on its base."""
    look, dark = w.look("steel") if w.chance(0.5) else w.look("appliance"), w.look("dark")
    w.cylinder((0.0, 0.0), (0.0, 0.02), 0.085, dark)
    w.mesh(turned([(0.02, 0.08), (0.06, 0.085), (0.19, 0.06), (0.21, 0.03)], 14, hull=True), (0.0, 0.0, 0.0), look)
    w.rod((0.06, 0.0, 0.12), (0.11, 0.0, 0.18), 0.014, look, solid=False)
    w.rod((-0.055, 0.0, 0.20), (-0.11, 0.0, 0.18), 0.012, dark, solid=False, round_ends=True)
    w.rod((-0.11, 0.0, 0.18), (-0.10, 0.0, 0.06), 0.012, dark, solid=False, round_ends=True)
    w.ball((0.0, 0.0, 0.215), 0.014, dark, solid=False)


def clock(w: Workbench) -> None:
    """Builds a mantel clock."""
    wood = w.look("wood")
    w.box((-0.05, 0.05), (-0.12, 0.12), (0.0, 0.12), wood)
    w.rod_x((0.0, 0.12), (-0.045, 0.045), 0.095, wood)
    w.rod_x((0.0, 0.12), (0.04, 0.052), 0.075, w.look("paper"), solid=False)
    w.bar((0.054, 0.0, 0.12), (0.054, 0.03, 0.155), 0.006, 0.003, w.look("dark"), solid=False)
    w.bar((0.054, 0.0, 0.12), (0.054, -0.01, 0.18), 0.005, 0.003, w.look("dark"), solid=False)


def photo_stand(w: Workbench) -> None:
    """Builds a framed photograph on a stand next to a candle."""
    w.box((-0.01, 0.008), (-0.09, 0.09), (0.005, 0.23), w.look("wood"), tilt=-0.22)
    w.box((0.004, 0.011), (-0.07, 0.07), (0.03, 0.205), w.look("paper"), tilt=-0.22, solid=False)
    page = Page(0.011, (-0.055, 0.055), (0.045, 0.19), -0.22)
    photograph(w, page)
    page.put(w, emission=0.0)
    w.bar((-0.10, 0.0, 0.0), (-0.015, 0.0, 0.15), 0.03, 0.008, w.look("wood"))
    w.cylinder((0.0, 0.17), (0.0, 0.10), 0.035, w.look("linen"))


def basket(w: Workbench) -> None:
    """Builds a wicker basket with a blanket or toys."""
    r, high = w.length(0.17, 0.24), w.length(0.24, 0.38)
    w.cylinder((0.0, 0.0), (0.0, high), r, w.look("wicker"))
    w.mesh(hoop(r + 0.010, 0.03, 0.03), (0.0, 0.0, high - 0.005), w.look("wicker"), solid=False)
    w.ellipsoid((0.02, 0.0, high), (0.75 * r, 0.8 * r, 0.06), w.look("bright"), solid=False)
    for side in BOTH_SIDES:
        w.cylinder((0.0, side * (r + 0.012)), (high - 0.05, high + 0.06), 0.010, w.look("leather"), solid=False)


def place_setting(w: Workbench) -> None:
    """Builds a plate, a bowl and a cup."""
    white = w.look("ceramic")
    w.mesh(turned([(0.0, 0.07), (0.02, 0.13), (0.02, 0.12), (0.006, 0.06)], 16), (0.0, 0.0, 0.0), white)
    w.mesh(turned([(0.006, 0.035), (0.065, 0.075), (0.065, 0.068), (0.02, 0.03)], 14), (0.0, 0.0, 0.0), w.look("pot"))
    w.cylinder((0.02, 0.19), (0.0, 0.085), 0.04, w.look("bright"))
    w.cylinder((0.02, 0.23), (0.025, 0.065), 0.006, w.look("bright"), solid=False)


def bottles(w: Workbench) -> None:
    """Builds two bottles and a jar on a tray."""
    w.box((-0.10, 0.10), (-0.17, 0.17), (0.0, 0.015), w.look("wood"))
    glass = w.new_look("book")
    for y, high in ((-0.10, 0.26), (0.0, 0.30)):
        bottle = [(0.0, 0.035), (0.52, 0.036), (0.62, 0.031), (0.70, 0.016), (0.75, 0.013), (1.0, 0.013)]
        w.mesh(turned([(0.015 + z * (high - 0.015), r) for z, r in bottle], 12), (0.0, y, 0.0), glass)
        w.cylinder((0.0, y), (0.3 * high, 0.5 * high), 0.0372, w.look("paper"), solid=False)
        w.cylinder((0.0, y), (high - 0.03, high + 0.002), 0.0145, w.look("dark"), solid=False)
        glass = w.new_look("book")
    w.cylinder((0.0, 0.10), (0.015, 0.13), 0.05, w.look("ceramic"))
    w.cylinder((0.0, 0.10), (0.13, 0.145), 0.045, w.look("wood"), solid=False)


def waste_bin(w: Workbench) -> None:
    """Builds a pedal bin."""
    r, high, look = w.length(0.12, 0.16), w.length(0.32, 0.60), w.look("appliance")
    w.cylinder((0.0, 0.0), (0.02, high - 0.05), r, look)
    w.cylinder((0.0, 0.0), (0.0, 0.03), r + 0.005, w.look("dark"))
    w.ellipsoid((0.0, 0.0, high - 0.05), (r + 0.004, r + 0.004, 0.05), w.look("dark"))
    w.box((r - 0.01, r + 0.045), (-0.03, 0.03), (0.008, 0.02), w.look("dark"), solid=False)


def suitcase(w: Workbench) -> None:
    """Builds a wheeled suitcase with ribs and a drawn-out handle."""
    high, look, dark = w.length(0.55, 0.68), w.look("bright"), w.look("dark")
    w.mesh(chamfered_box((0.25, 0.42, high), 0.04), (0.0, 0.0, 0.05 + 0.5 * high), look)
    for i in range(4):
        y = (i - 1.5) * 0.09
        w.box((0.12, 0.132), around(y, 0.018), (0.12, high - 0.02), look, solid=False)
    for sx, sy in CORNERS:
        w.ball((sx * 0.09, sy * 0.16, 0.03), 0.03, dark)
    for y in (-0.08, 0.08):
        w.cylinder((-0.08, y), (high + 0.03, high + 0.38), 0.008, w.look("chrome"))
    w.rod_y((-0.08, high + 0.38), (-0.10, 0.10), 0.015, dark, round_ends=True)


STYLES = (
    Style("objects", "book_stack", "train", book_stack, ("top",), "top"),
    Style("objects", "vase", "heldout", vase, ("top",), "top"),
    Style("objects", "crate", "train", box_crate, ("floor", "box"), "floor"),
    Style("objects", "fruit_bowl", "train", fruit_bowl, ("kitchen",), "top"),
    Style("objects", "kettle", "train", kettle, ("kitchen",), "top"),
    Style("objects", "clock", "train", clock, ("top",), "top"),
    Style("objects", "photo_stand", "train", photo_stand, ("top",), "top"),
    Style("objects", "basket", "train", basket, ("floor", "bin")),
    Style("objects", "place_setting", "heldout", place_setting, ("kitchen", "top"), "top"),
    Style("objects", "bottles", "heldout", bottles, ("kitchen", "top"), "top"),
    Style("objects", "waste_bin", "heldout", waste_bin, ("floor", "bin")),
    Style("objects", "suitcase", "heldout", suitcase, ("floor", "box")),
)
