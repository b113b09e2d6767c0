"""Cushions of the pool `wide`."""

from __future__ import annotations

import itertools
import math

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring, chamfered_box, frustum, loft, pillow
from sim.housegen.furniture.workbench import Workbench


def flanged_cushion(w: Workbench) -> None:
    """Builds a leaning throw cushion with a flat border, and sometimes a smaller cushion before it."""
    side, lean = w.length(0.38, 0.60), w.length(1.05, 1.35)
    high = side * w.choice((1.0, 1.0, 0.75))
    edge, cloth = w.length(0.03, 0.06), w.look("bright")
    border = cloth if w.chance(0.5) else w.new_look("fabric")
    w.mesh(chamfered_box((high, side, 0.016), 0.006), (0.0, 0.0, 0.5 * high * math.sin(lean)), border, tilt=lean)
    inner = pillow((round(high - 2 * edge, 3), round(side - 2 * edge, 3), w.length(0.12, 0.20)))
    w.mesh(inner, (0.0, 0.0, 0.5 * high * math.sin(lean)), cloth, tilt=lean)
    if w.chance(0.3):
        w.mesh(pillow((0.26, 0.36, 0.12)), (0.13, w.length(-0.05, 0.05), 0.14), w.new_look("bright"), tilt=1.0)


def flat_cushion(w: Workbench) -> None:
    """Builds one or two cushions that lie flat and turned by a small angle."""
    side, thick = w.length(0.36, 0.52), w.length(0.10, 0.16)
    other = side * w.choice((1.0, 0.65))
    w.mesh(pillow((other, side, thick)), (0.0, 0.0, 0.5 * thick), w.look("bright"), turn=w.length(-0.4, 0.4))
    if w.chance(0.4):
        turn = w.length(-0.5, 0.5)
        w.mesh(
            pillow((0.9 * other, 0.9 * side, 0.9 * thick)), (0.0, 0.01, 1.4 * thick), w.new_look("bright"), turn=turn
        )


def tasselled_cushion(w: Workbench) -> None:
    """Builds a cushion on its edge with tassels or pompoms at its corners and sometimes stripes."""
    wide, tall, lean = w.length(0.36, 0.60), w.length(0.32, 0.46), 1.25
    cloth, trim, z = w.look("bright"), w.new_look("bright"), 0.5 * tall
    w.mesh(pillow((tall, wide, 0.15)), (0.0, 0.0, z), cloth, tilt=lean)
    for sx, sy in itertools.product(BOTH_SIDES, BOTH_SIDES):
        along = -sx * 0.43 * tall
        at = (along * math.cos(lean), sy * 0.44 * wide, z - along * math.sin(lean))
        if w.chance(0.6):
            w.ball(at, 0.025, trim, solid=False)
        else:
            w.ellipsoid(at, (0.018, 0.035, 0.018), trim, solid=False)
    for i in range(w.choice((0, 1, 2, 3))):
        band = pillow((round(1.005 * tall, 3), round(0.08 * wide, 3), 0.156), 8.0)
        w.mesh(band, (0.0, 0.26 * (i - 1) * wide, z), trim, tilt=lean, solid=False)


def shaped_cushion(w: Workbench) -> None:
    """Builds a cushion in the shape of a ball, a heart, a flower or an animal's face with ears."""
    cloth, kind, r = w.look("bright"), w.choice(("ball", "heart", "flower", "pet")), w.length(0.14, 0.20)
    if kind == "ball":
        w.ball((0.0, 0.0, r), r, cloth)
    elif kind == "heart":
        for side in BOTH_SIDES:
            w.ellipsoid((0.0, side * 0.45 * r, 1.35 * r), (0.07, 0.62 * r, 0.60 * r), cloth, tilt=-0.1)
        point = [Ring(0.0, 0.03, 0.02 * r), Ring(1.045 * r, 0.055, r), Ring(1.375 * r, 0.05, 0.95 * r)]
        w.mesh(loft(point, 12, hull=True), (0.0, 0.0, 0.0), cloth)
    elif kind == "flower":
        for i in range(5):
            a = math.tau * (i + 0.25) / 5
            w.ellipsoid(
                (0.0, 0.62 * r * math.cos(a), 1.05 * r + 0.62 * r * math.sin(a)), (0.05, 0.48 * r, 0.48 * r), cloth
            )
        w.ellipsoid((0.02, 0.0, 1.05 * r), (0.055, 0.36 * r, 0.36 * r), w.new_look("bright"))
    else:
        w.ellipsoid((0.0, 0.0, r), (0.09, 1.15 * r, r), cloth)
        for side in BOTH_SIDES:
            w.ellipsoid((0.0, side * 0.75 * r, 1.8 * r), (0.04, 0.32 * r, 0.38 * r), cloth)
            w.ellipsoid((0.075, side * 0.4 * r, 1.2 * r), (0.02, 0.02, 0.02), w.look("dark"), solid=False)


def mattress_cushion(w: Workbench) -> None:
    """Builds one to three thick square floor cushions with tufts and a side handle in a pile."""
    side, thick, count = w.length(0.50, 0.75), w.length(0.08, 0.16), w.choice((1, 1, 2, 3))
    for k in range(count):
        cloth = w.look("bright") if k == 0 else w.new_look("bright")
        turn = w.length(-0.12, 0.12)
        parts.pad(w, (side, side, thick), (0.0, 0.0, (k + 0.5) * thick), cloth, 0.03, turn=turn)
    top = count * thick
    for sx, sy in itertools.product((-1, 0, 1), repeat=2):
        w.ellipsoid((0.27 * sx * side, 0.27 * sy * side, top), (0.014, 0.014, 0.006), w.look("dark"), solid=False)
    w.box(
        (0.5 * side - 0.04, 0.5 * side + 0.012),
        (-0.06, 0.06),
        (0.35 * thick, 0.60 * thick),
        w.look("dark"),
        solid=False,
    )


def thai_triangle(w: Workbench) -> None:
    """Builds a triangular backrest with a mat of one to three panels that folds out in front of it."""
    wide, deep, high = w.length(0.46, 0.62), w.length(0.36, 0.44), w.length(0.32, 0.42)
    cloth, panels = w.look("bright"), w.whole(1, 3)
    w.mesh(frustum((deep, wide), (0.06, wide), high, (-0.10, 0.0)), (0.0, 0.0, 0.0), cloth)
    for i in range(3):
        z = (0.2 + 0.28 * i) * high
        reach = 0.5 * deep + (0.03 - 0.10 - 0.5 * deep) * z / high
        w.box(
            (reach - 0.01, reach + 0.006),
            (-0.5 * wide + 0.02, 0.5 * wide - 0.02),
            (z - 0.012, z + 0.012),
            w.look("linen"),
            solid=False,
        )
    long = w.length(0.42, 0.52)
    for i in range(panels):
        x = 0.5 * deep + (i + 0.5) * long
        parts.pad(w, (long + 0.006, wide, 0.08), (x, 0.0, 0.04), cloth if i % 2 else w.look("fabric"), 0.03)


STYLES: tuple[Style, ...] = (
    Style("cushion", "flanged", "wide", flanged_cushion, ("throw",), "top"),
    Style("cushion", "flat", "wide", flat_cushion, ("throw",), "top"),
    Style("cushion", "tasselled", "wide", tasselled_cushion, ("throw",), "top"),
    Style("cushion", "shaped", "wide", shaped_cushion, ("throw",), "top"),
    Style("cushion", "mattress_cushion", "wide", mattress_cushion, ("floor",)),
    Style("cushion", "thai_triangle", "wide", thai_triangle, ("floor",)),
)
