"""Televisions and computer screens.

Usual retail dimensions by diagonal: 24 in is 0.53 m wide, 32 in 0.72 m, 43 in 0.96 m, 65 in 1.45 m.
"""

from __future__ import annotations

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, centred, inset
from sim.homes.housegen.furniture.parts.flat_pictures import show_computer, show_television
from sim.homes.housegen.furniture.shapes import chamfered_box
from sim.homes.housegen.furniture.workbench import Range, Workbench

SHARE_ON = 0.45
"""Share of the televisions and computers that are on."""


def _panel(w: Workbench, x: float, width: float, z: Range, *, computer: bool = False) -> None:
    """Adds a flat screen in a dark case, which shows a picture if it is on."""
    w.box((x - 0.022, x + 0.012), centred(width), z, w.look("dark"))
    w.box((x + 0.012, x + 0.016), centred(width, 0.012), inset(z, 0.02, 0.012), w.look("screen"), solid=False)
    if w.chance(SHARE_ON):
        y, inner = centred(width, 0.02), inset(z, 0.028, 0.02)
        (show_computer if computer else show_television)(w, x + 0.016, y, inner)


def tv_stand(w: Workbench) -> None:
    """Builds a television on two feet, for a bench."""
    width = w.width(0.80, 1.40)
    _panel(w, 0.0, width, (0.07, 0.07 + 0.575 * width))
    for y in (-0.34 * width, 0.34 * width):
        w.bar((-0.11, y, 0.008), (0.11, y, 0.008), 0.03, 0.016, w.look("dark"))
        w.box((-0.015, 0.005), around(y, 0.012), (0.01, 0.08), w.look("dark"))


def tv_wall(w: Workbench) -> None:
    """Builds a television on the wall."""
    width = w.width(0.90, 1.45)
    w.mount_height_m = 0.95
    _panel(w, 0.065, width, (0.0, 0.575 * width))
    w.box((0.0, 0.045), (-0.2, 0.2), (0.18 * width, 0.38 * width), w.look("iron"))


def monitor(w: Workbench) -> None:
    """Builds a computer monitor with a keyboard."""
    width, dark = w.length(0.52, 0.62), w.look("dark")
    _panel(w, 0.0, width, (0.11, 0.11 + 0.58 * width), computer=True)
    w.box((-0.05, -0.02), (-0.03, 0.03), (0.01, 0.30), dark)
    w.box((-0.11, 0.09), (-0.12, 0.12), (0.0, 0.012), dark)
    w.box((0.14, 0.27), (-0.21, 0.21), (0.0, 0.018), dark, solid=False)


def tv_easel(w: Workbench) -> None:
    """Builds a television on a wooden tripod, whose legs pass behind the screen."""
    width, wood = w.width(0.95, 1.25), w.look("wood")
    z0 = w.length(0.62, 0.72)
    _panel(w, 0.0, width, (z0, z0 + 0.575 * width))
    for side in BOTH_SIDES:
        w.rod((0.05, side * 0.40, 0.0), (-0.12, side * 0.05, z0 + 0.5), 0.018, wood)
    w.rod((-0.42, 0.0, 0.0), (-0.12, 0.0, z0 + 0.5), 0.018, wood)
    w.box((-0.11, -0.02), (-0.14, 0.14), (z0 + 0.15, z0 + 0.40), w.look("dark"))


def crt(w: Workbench) -> None:
    """Builds an old television: a wooden box with a bulging screen, knobs and a V-shaped antenna."""
    width = w.length(0.55, 0.65)
    height, depth, wood = 0.72 * width, 0.62 * width, w.look("wood")
    w.box(centred(depth), centred(width), (0.02, height), wood)
    w.legs((-0.4 * depth, 0.4 * depth), (-0.4 * width, 0.4 * width), (0.0, 0.022), 0.03, w.look("dark"))
    w.ellipsoid(
        (0.5 * depth - 0.005, 0.09 * width - 0.1, 0.5 * height),
        (0.028, 0.36 * width, 0.40 * height),
        w.look("screen"),
        solid=False,
    )
    for z in (0.72, 0.5):
        w.rod_x(
            (0.40 * width, z * height), (0.5 * depth - 0.01, 0.5 * depth + 0.02), 0.022, w.look("brass"), solid=False
        )
    for side in BOTH_SIDES:
        w.rod((0.0, 0.0, height), (-0.05, side * 0.2, height + 0.30), 0.004, w.look("chrome"), solid=False)


def tv_arm(w: Workbench) -> None:
    """Builds a television tilted on a wall arm."""
    width, iron = w.width(0.80, 1.15), w.look("iron")
    w.mount_height_m = 1.0
    h = 0.575 * width
    w.box((0.0, 0.02), (-0.09, 0.09), around(0.5 * h, 0.12), iron)
    w.bar((0.01, 0.0, 0.5 * h), (0.21, 0.0, 0.5 * h), 0.05, 0.04, iron)
    w.box((0.215, 0.25), centred(width), (0.0, h), w.look("dark"), tilt=0.06)
    w.box((0.25, 0.255), centred(width, 0.015), (0.02, h - 0.015), w.look("screen"), tilt=0.06, solid=False)
    if w.chance(SHARE_ON):
        show_television(w, 0.255, centred(width, 0.02), (0.025, h - 0.02), tilt=0.06)


def tv_pole(w: Workbench) -> None:
    """Builds a television on a floor stand: two poles on a glass foot, and a shelf with a box between them."""
    width, metal = w.width(0.95, 1.30), w.look("metal")
    high = 0.575 * width
    z0 = w.length(0.55, 0.70)
    _panel(w, 0.0, width, (z0, z0 + high))
    w.box((-0.24, 0.20), (-0.34, 0.34), (0.0, 0.02), w.look("dark"))
    for side in BOTH_SIDES:
        w.cylinder((-0.06, side * 0.12), (0.015, z0 + 0.6 * high), 0.022, metal)
    w.box((-0.20, 0.12), (-0.26, 0.26), (0.34, 0.36), w.look("dark"))
    w.box((-0.12, 0.08), (-0.18, 0.18), (0.36, 0.41), metal, solid=False)
    w.box((-0.05, -0.02), (-0.15, 0.15), (z0 + 0.3 * high, z0 + 0.6 * high), metal)


def laptop(w: Workbench) -> None:
    """Builds an open laptop with a mouse."""
    metal, half = w.look("metal"), 0.5 * w.length(0.32, 0.38)
    w.box((-0.11, 0.12), (-half, half), (0.0, 0.018), metal)
    w.box((-0.08, 0.03), (-half + 0.03, half - 0.03), (0.016, 0.020), w.look("dark"), solid=False)
    w.box((-0.128, -0.118), (-half, half), (0.01, 0.25), metal, tilt=-0.25)
    w.box((-0.121, -0.115), (-half + 0.012, half - 0.012), (0.03, 0.24), w.look("screen"), tilt=-0.25, solid=False)
    if w.chance(SHARE_ON):
        show_computer(w, -0.115, (-half + 0.02, half - 0.02), (0.04, 0.23), tilt=-0.25)
    w.ellipsoid((0.04, half + 0.07, 0.012), (0.05, 0.03, 0.014), w.look("dark"), solid=False)


def soundbar_tv(w: Workbench) -> None:
    """Builds a television on a central foot with a sound bar in front of it."""
    width, dark = w.width(0.90, 1.35), w.look("dark")
    _panel(w, 0.0, width, (0.11, 0.11 + 0.575 * width))
    w.box((-0.13, 0.11), (-0.22, 0.22), (0.0, 0.015), dark)
    w.box((-0.03, 0.0), (-0.07, 0.07), (0.01, 0.2), dark)
    w.mesh(chamfered_box((0.09, round(0.75 * width, 2), 0.07), 0.02), (0.17, 0.0, 0.035), w.look("fabric"))


def dual_monitor(w: Workbench) -> None:
    """Builds two screens in a shallow V on one arm, with a keyboard in front of them."""
    width, dark = w.length(0.48, 0.54), w.look("dark")
    high = 0.58 * width
    w.box((-0.12, 0.0), (-0.10, 0.10), (0.0, 0.02), dark)
    w.cylinder((-0.07, 0.0), (0.01, 0.34), 0.02, dark)
    for side in BOTH_SIDES:
        c, turn = side * 0.5 * width, -side * 0.18
        w.bar((-0.07, 0.0, 0.27), (-0.03, c, 0.27), 0.03, 0.03, dark)
        w.box((-0.02, 0.01), around(c, 0.49 * width), (0.12, 0.12 + high), dark, turn=turn)
        w.box((0.006, 0.014), around(c, 0.47 * width), (0.135, 0.107 + high), w.look("screen"), turn=turn, solid=False)
        if w.chance(SHARE_ON):
            y = around(c, 0.455 * width)
            show_computer(w, 0.014, y, (0.145, 0.097 + high), turn=turn)
    w.box((0.16, 0.29), (-0.22, 0.22), (0.0, 0.018), dark, solid=False)


STYLES = (
    Style("tv_monitor", "tv_stand", "train", tv_stand, ("tv",), "top"),
    Style("tv_monitor", "tv_wall", "train", tv_wall, ("tv_wall",), "wall"),
    Style("tv_monitor", "monitor", "train", monitor, ("monitor",), "top"),
    Style("tv_monitor", "tv_easel", "heldout", tv_easel, ("tv_floor",)),
    Style("tv_monitor", "tv_arm", "heldout", tv_arm, ("tv_wall",), "wall"),
    Style("tv_monitor", "tv_pole", "train", tv_pole, ("tv_floor",)),
    Style("tv_monitor", "laptop", "train", laptop, ("monitor",), "top"),
    Style("tv_monitor", "soundbar_tv", "train", soundbar_tv, ("tv",), "top"),
    Style("tv_monitor", "dual_monitor", "heldout", dual_monitor, ("monitor",), "top"),
    Style("tv_monitor", "crt", "heldout", crt, ("tv",), "top"),
)
