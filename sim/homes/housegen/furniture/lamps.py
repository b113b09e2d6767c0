"""Lamps.

Usual retail dimensions: ceiling lamps 0.30-0.60 m across, floor lamps 1.40-1.75 m, table lamps 0.35-0.60 m high.
"""

from __future__ import annotations

import math

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.parts import around, polar
from sim.homes.housegen.furniture.shapes import Ring, loft, turned
from sim.homes.housegen.furniture.workbench import Workbench


def pendant(w: Workbench) -> None:
    """Builds a ceiling lamp with a shade on a cord."""
    r, drop = 0.5 * w.length(0.32, 0.50), w.length(0.40, 0.70)
    w.cylinder((0.0, 0.0), (-0.03, 0.0), 0.05, w.look("iron"), solid=False)
    w.cylinder((0.0, 0.0), (-drop, -0.02), 0.005, w.look("dark"), solid=False)
    w.mesh(
        turned([(-drop - 0.20, r), (-drop - 0.02, 0.35 * r), (-drop + 0.02, 0.12 * r)], 16, hull=True),
        (0.0, 0.0, 0.0),
        w.look("shade"),
        solid=False,
    )
    w.ball((0.0, 0.0, -drop - 0.18), 0.06, w.look("glow"), solid=False)


def ceiling_disc(w: Workbench) -> None:
    """Builds a flat round ceiling lamp."""
    r = 0.5 * w.length(0.32, 0.50)
    w.cylinder((0.0, 0.0), (-0.05, 0.0), r, w.look("metal"), solid=False)
    w.ellipsoid((0.0, 0.0, -0.05), (0.92 * r, 0.92 * r, 0.06), w.look("glow"), solid=False)


def globe_pendant(w: Workbench) -> None:
    """Builds a ceiling lamp with three glass globes that hang at different heights from a bar."""
    w.box((-0.04, 0.04), (-0.35, 0.35), (-0.03, 0.0), w.look("brass"), solid=False)
    for i in range(3):
        drop, y = w.length(0.25, 0.60), (i - 1) * 0.28
        w.cylinder((0.0, y), (-drop, -0.02), 0.004, w.look("dark"), solid=False)
        w.ball((0.0, y, -drop - 0.09), 0.10, w.look("glow"), solid=False)


def floor_lamp(w: Workbench) -> None:
    """Builds a floor lamp with a disc foot, a pole and a drum shade."""
    tall, metal, r = w.length(1.45, 1.70), w.look("metal"), 0.5 * w.length(0.32, 0.44)
    w.cylinder((0.0, 0.0), (0.0, 0.025), 0.15, metal)
    w.cylinder((0.0, 0.0), (0.02, tall - 0.05), 0.012, metal)
    w.mesh(turned([(tall - 0.28, r), (tall, 0.75 * r)], 16, hull=True), (0.0, 0.0, 0.0), w.look("shade"))
    w.cylinder((0.0, 0.0), (tall - 0.285, tall - 0.27), 0.8 * r, w.look("glow"), solid=False)


def tripod_lamp(w: Workbench) -> None:
    """Builds a floor lamp on a wooden tripod."""
    tall, wood, r = w.length(1.40, 1.60), w.look("wood"), 0.5 * w.length(0.40, 0.48)
    for i in range(3):
        a = math.tau * i / 3
        w.rod((*polar(0.26, a), 0.013), (*polar(0.02, a), tall - 0.26), 0.014, wood, round_ends=True)
    w.cylinder((0.0, 0.0), (tall - 0.30, tall), r, w.look("shade"))
    w.cylinder((0.0, 0.0), (tall - 0.305, tall - 0.295), 0.85 * r, w.look("glow"), solid=False)


def table_lamp(w: Workbench) -> None:
    """Builds a table lamp with a ceramic body and a conical shade."""
    tall, r, body = w.length(0.38, 0.56), 0.5 * w.length(0.22, 0.32), w.look("pot")
    w.mesh(
        turned([(0.0, 0.06), (0.08, 0.085), (0.45 * tall, 0.045), (0.6 * tall, 0.015)], 12, hull=True),
        (0.0, 0.0, 0.0),
        body,
    )
    w.mesh(turned([(0.55 * tall, r), (tall, 0.6 * r)], 14, hull=True), (0.0, 0.0, 0.0), w.look("shade"))


def mushroom_lamp(w: Workbench) -> None:
    """Builds a table lamp with a cylindrical foot under a dome."""
    tall, look = w.length(0.34, 0.46), w.look("shade")
    w.cylinder((0.0, 0.0), (0.0, 0.65 * tall), 0.05, w.look("brass"))
    w.cylinder((0.0, 0.0), (0.0, 0.015), 0.09, w.look("brass"))
    w.mesh(
        turned([(0.55 * tall, 0.16), (0.75 * tall, 0.15), (0.92 * tall, 0.10), (tall, 0.03)], 14, hull=True),
        (0.0, 0.0, 0.0),
        look,
    )


def chandelier(w: Workbench) -> None:
    """Builds a chandelier with six candle arms around a hub."""
    metal, glow, drop = w.look("brass"), w.look("glow"), w.length(0.40, 0.60)
    w.cylinder((0.0, 0.0), (-0.03, 0.0), 0.06, metal, solid=False)
    w.cylinder((0.0, 0.0), (-drop, -0.02), 0.008, metal, solid=False)
    w.ellipsoid((0.0, 0.0, -drop), (0.05, 0.05, 0.08), metal, solid=False)
    for i in range(6):
        a = math.tau * i / 6
        tip = (*polar(0.30, a), -drop)
        w.rod((0.0, 0.0, -drop - 0.05), tip, 0.008, metal, solid=False, round_ends=True)
        w.rod(tip, (tip[0], tip[1], -drop + 0.14), 0.014, glow, solid=False, round_ends=True)


def spot_rail(w: Workbench) -> None:
    """Builds a ceiling rail with three spots."""
    metal = w.look("metal")
    w.box((-0.025, 0.025), (-0.40, 0.40), (-0.03, 0.0), metal, solid=False)
    for i in range(3):
        y, a = (i - 1) * 0.28, 0.5 * (i - 1)
        w.cylinder((0.0, y), (-0.09, -0.02), 0.008, metal, solid=False)
        tip = (0.06, y + 0.10 * math.sin(a), -0.16)
        w.rod((-0.02, y, -0.09), tip, 0.042, metal, solid=False)
        w.rod(tip, (tip[0] + 0.004, tip[1], tip[2] - 0.004), 0.034, w.look("glow"), solid=False)


def arc_lamp(w: Workbench) -> None:
    """Builds a floor lamp with a heavy foot and an arc of tube that ends in a dome in front of it."""
    metal, r = w.look("chrome"), w.length(0.14, 0.18)
    w.cylinder((-0.35, 0.0), (0.0, 0.05), 0.16, w.look("stone"))
    arc = [(-0.35, 0.05), (-0.35, 1.00), (-0.24, 1.45), (0.02, 1.72), (0.32, 1.74), (0.52, 1.58)]
    w.bent_rod([(x, 0.0, z) for x, z in arc], 0.012, metal)
    w.mesh(
        turned([(-0.12, r), (-0.04, 0.92 * r), (0.03, 0.5 * r), (0.05, 0.1 * r)], 14, hull=True),
        (0.52, 0.0, 1.55),
        w.look("shade"),
    )
    w.cylinder((0.52, 0.0), (1.425, 1.435), 0.8 * r, w.look("glow"), solid=False)


def reading_lamp(w: Workbench) -> None:
    """Builds a slim floor lamp with a jointed arm and a cone."""
    metal, high = w.look("iron"), w.length(1.25, 1.40)
    w.cylinder((0.0, 0.0), (0.0, 0.02), 0.13, metal)
    w.cylinder((0.0, 0.0), (0.015, high), 0.010, metal)
    w.rod((0.0, 0.0, high - 0.01), (0.28, 0.0, high + 0.14), 0.009, metal, round_ends=True)
    w.mesh(
        turned([(-0.14, 0.085), (0.0, 0.03), (0.03, 0.025)], 14, hull=True), (0.28, 0.0, high + 0.13), metal, tilt=-0.35
    )
    w.cylinder((0.325, 0.0), around(high, 0.005), 0.06, w.look("glow"), solid=False)


def desk_lamp(w: Workbench) -> None:
    """Builds a table lamp with two jointed arms and a small cone."""
    metal = w.look("metal")
    w.cylinder((0.0, 0.0), (0.0, 0.02), 0.08, metal)
    w.rod((0.0, 0.0, 0.015), (-0.10, 0.0, 0.24), 0.008, metal, round_ends=True)
    w.rod((-0.10, 0.0, 0.24), (0.10, 0.0, 0.42), 0.008, metal, round_ends=True)
    w.mesh(turned([(-0.10, 0.075), (0.0, 0.03), (0.02, 0.025)], 14, hull=True), (0.10, 0.0, 0.42), metal, tilt=-0.3)
    w.cylinder((0.128, 0.0), (0.322, 0.330), 0.05, w.look("glow"), solid=False)


def globe_table(w: Workbench) -> None:
    """Builds a table lamp: a glowing ball on a ring of wood."""
    r = w.length(0.10, 0.14)
    w.mesh(turned([(0.0, 0.09), (0.05, 0.07)], 14, hull=True), (0.0, 0.0, 0.0), w.look("wood"))
    w.ball((0.0, 0.0, 0.045 + r), r, w.look("glow"))


def sconce(w: Workbench) -> None:
    """Builds a wall lamp with a bowl that is open at the top."""
    w.mount_height_m = 1.60
    metal = w.look("metal")
    w.box((0.0, 0.02), (-0.05, 0.05), (0.0, 0.20), metal, solid=False)
    w.rod((0.015, 0.0, 0.05), (0.10, 0.0, 0.07), 0.010, metal, solid=False)
    w.mesh(
        loft(
            [Ring(0.06, 0.03, 0.03, 0.11), Ring(0.12, 0.09, 0.09, 0.11), Ring(0.20, 0.105, 0.105, 0.11)], 14, hull=True
        ),
        (0.0, 0.0, 0.0),
        w.look("shade"),
        solid=False,
    )
    w.cylinder((0.11, 0.0), (0.198, 0.206), 0.085, w.look("glow"), solid=False)


def swing_sconce(w: Workbench) -> None:
    """Builds a wall lamp with a shade on a swinging arm."""
    w.mount_height_m = 1.35
    brass = w.look("brass")
    w.rod_x((0.0, 0.12), (0.0, 0.02), 0.05, brass, solid=False)
    w.rod_x((0.0, 0.12), (0.02, 0.24), 0.008, brass, solid=False, round_ends=True)
    w.cylinder((0.24, 0.0), (0.10, 0.16), 0.010, brass, solid=False)
    w.mesh(turned([(0.0, 0.10), (0.17, 0.065)], 14, hull=True), (0.24, 0.0, 0.05), w.look("shade"), solid=False)
    w.cylinder((0.24, 0.0), (0.044, 0.052), 0.08, w.look("glow"), solid=False)


def panel_lamp(w: Workbench) -> None:
    """Builds a square glowing panel on the ceiling."""
    half = 0.5 * w.length(0.40, 0.60)
    w.box((-half, half), (-half, half), (-0.045, 0.0), w.look("metal"), solid=False)
    w.box((-half + 0.02, half - 0.02), (-half + 0.02, half - 0.02), (-0.055, -0.02), w.look("glow"), solid=False)


STYLES = (
    Style("lighting", "pendant", "train", pendant, ("ceiling",), "ceiling"),
    Style("lighting", "ceiling_disc", "train", ceiling_disc, ("ceiling",), "ceiling"),
    Style("lighting", "globe_pendant", "heldout", globe_pendant, ("ceiling",), "ceiling"),
    Style("lighting", "floor_lamp", "train", floor_lamp, ("floor",)),
    Style("lighting", "tripod_lamp", "heldout", tripod_lamp, ("floor",)),
    Style("lighting", "table_lamp", "train", table_lamp, ("table",), "top"),
    Style("lighting", "mushroom_lamp", "heldout", mushroom_lamp, ("table",), "top"),
    Style("lighting", "chandelier", "train", chandelier, ("ceiling",), "ceiling"),
    Style("lighting", "spot_rail", "train", spot_rail, ("ceiling",), "ceiling"),
    Style("lighting", "panel", "heldout", panel_lamp, ("ceiling",), "ceiling"),
    Style("lighting", "arc", "train", arc_lamp, ("floor",)),
    Style("lighting", "reading", "heldout", reading_lamp, ("floor",)),
    Style("lighting", "desk", "train", desk_lamp, ("table",), "top"),
    Style("lighting", "globe", "heldout", globe_table, ("table",), "top"),
    Style("lighting", "sconce", "train", sconce, ("wall",), "wall"),
    Style("lighting", "swing_sconce", "heldout", swing_sconce, ("wall",), "wall"),
)
