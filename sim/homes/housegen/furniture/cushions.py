"""Cushions.

Usual retail dimensions: throw cushions 0.40-0.50 m, floor cushions 0.45-0.70 m.
"""

from __future__ import annotations

import math

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.shapes import pillow, puffed, turned
from sim.homes.housegen.furniture.workbench import Workbench


def square_cushion(w: Workbench) -> None:
    """Builds a throw cushion that leans backwards."""
    side = w.choice((0.40, 0.45, 0.50))
    w.mesh(pillow((side, side, 0.14)), (0.0, 0.0, 0.5 * side), w.look("bright"), tilt=1.25)


def lumbar_cushion(w: Workbench) -> None:
    """Builds a long low cushion."""
    w.mesh(pillow((0.30, w.choice((0.50, 0.55)), 0.14)), (0.0, 0.0, 0.15), w.look("bright"), tilt=1.2)


def bolster(w: Workbench) -> None:
    """Builds a cylindrical cushion."""
    half, r = 0.5 * w.length(0.40, 0.55), w.length(0.08, 0.10)
    w.rod_y((0.0, r), (-half, half), r, w.look("bright"))
    for side in (-1, 1):
        w.rod_y((0.0, r), (side * half, side * (half + 0.006)), 0.4 * r, w.look("dark"), solid=False)


def floor_cushion(w: Workbench) -> None:
    """Builds a large square seat cushion, or two in a stack."""
    side = w.choice((0.55, 0.60, 0.65))
    w.mesh(pillow((side, side, 0.18), 5.0), (0.0, 0.0, 0.09), w.look("bright"))
    if w.chance(0.4):
        w.mesh(pillow((side, side, 0.16), 5.0), (0.01, 0.02, 0.245), w.new_look("bright"), turn=0.2)


def floor_round(w: Workbench) -> None:
    """Builds a round meditation cushion."""
    r, high = 0.5 * w.length(0.45, 0.60), w.length(0.14, 0.20)
    w.mesh(puffed(r, high, firm=2.6), (0.0, 0.0, 0.0), w.look("bright"))
    w.cylinder((0.0, 0.0), (high - 0.002, high + 0.004), 0.02, w.look("dark"), solid=False)


def round_cushion(w: Workbench) -> None:
    """Builds a round throw cushion with a button, standing on its edge."""
    r = 0.5 * w.choice((0.38, 0.42))
    tilt = 1.25
    w.mesh(
        turned([(-0.055, 0.6 * r), (0.0, r), (0.055, 0.6 * r)], 16, hull=True),
        (0.0, 0.0, r),
        w.look("bright"),
        tilt=tilt,
    )
    x, z = 0.055 * math.sin(tilt), r + 0.055 * math.cos(tilt)
    w.ellipsoid((x, 0.0, z), (0.02, 0.02, 0.008), w.look("dark"), solid=False, tilt=tilt)


def banded_cushion(w: Workbench) -> None:
    """Builds a square throw cushion with a broad band of another cloth."""
    side = w.choice((0.42, 0.46, 0.50))
    w.mesh(pillow((side, side, 0.14)), (0.0, 0.0, 0.5 * side), w.look("bright"), tilt=1.25)
    w.mesh(
        pillow((1.01 * side, 0.30 * side, 0.148), 6.0),
        (0.0, 0.0, 0.5 * side),
        w.new_look("bright"),
        tilt=1.25,
        solid=False,
    )


def knot_cushion(w: Workbench) -> None:
    """Builds a cushion that is a knot of thick rolls."""
    loop = [
        (0.0, -0.12, 0.06),
        (0.05, 0.10, 0.06),
        (-0.05, 0.10, 0.15),
        (0.06, -0.08, 0.17),
        (-0.05, -0.06, 0.22),
        (0.0, 0.11, 0.21),
    ]
    w.bent_rod(loop, 0.06, w.look("bright"))


STYLES = (
    Style("cushion", "square", "train", square_cushion, ("throw",), "top"),
    Style("cushion", "lumbar", "train", lumbar_cushion, ("throw",), "top"),
    Style("cushion", "bolster", "heldout", bolster, ("throw",), "top"),
    Style("cushion", "floor_square", "train", floor_cushion, ("floor",)),
    Style("cushion", "floor_round", "heldout", floor_round, ("floor",)),
    Style("cushion", "round", "train", round_cushion, ("throw",), "top"),
    Style("cushion", "banded", "train", banded_cushion, ("throw",), "top"),
    Style("cushion", "knot", "heldout", knot_cushion, ("throw",), "top"),
)
