"""Towels: on rails, hooks, ladders, in stacks.

Usual retail dimensions: hand towels 0.50 x 1.00 m, bath towels 0.70 x 1.40 m, rails 0.45-0.70 m wide.
"""

from __future__ import annotations

import math

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, centred, darker
from sim.homes.housegen.furniture.shapes import chamfered_box, drape
from sim.homes.housegen.furniture.workbench import Workbench


def towel_rail(w: Workbench) -> None:
    """Builds a towel over a rail."""
    width = w.width(0.50, 0.70)
    chrome, cloth = w.look("chrome"), w.look("towel")
    w.mount_height_m = 0.75
    w.rod_y((0.07, 0.5), centred(width), 0.009, chrome)
    for side in (-1, 1):
        w.rod_x((side * (0.5 * width - 0.01), 0.5), (0.0, 0.07), 0.012, chrome)
    w.mesh(drape(width - 0.10, 0.5, 0.02, 4), (0.078, 0.0, 0.0), cloth)
    w.mesh(drape(width - 0.10, 0.36, 0.02, 4), (0.042, 0.0, 0.14), cloth)


def towel_radiator(w: Workbench) -> None:
    """Builds a heated ladder of tubes on the wall with one or two towels over it."""
    width, high = w.width(0.45, 0.60), w.length(1.00, 1.40)
    w.mount_height_m = 0.45
    white = w.look("ceramic") if w.chance(0.5) else w.look("chrome")
    for y in centred(width, 0.015):
        w.box((0.05, 0.08), around(y, 0.015), (0.0, high), white)
        for z in (0.08, high - 0.08):
            w.rod_x((y, z), (0.0, 0.06), 0.012, white, solid=False)
    count = 9
    for i in range(count):
        z = 0.06 + i * (high - 0.12) / (count - 1)
        w.rod_y((0.065, z), centred(width, 0.01), 0.011, white)
    z = 0.06 + 6 * (high - 0.12) / (count - 1)
    w.mesh(drape(width - 0.08, 0.42, 0.025, 3), (0.078, 0.0, z - 0.41), w.look("towel"))
    if w.chance(0.5):
        low = 0.06 + 2 * (high - 0.12) / (count - 1)
        w.mesh(drape(0.6 * width, 0.20, 0.025, 3), (0.078, 0.05, low - 0.19), w.new_look("towel"))


def towel_hooks(w: Workbench) -> None:
    """Builds two or three towels on pegs of a board."""
    width, wood = w.width(0.50, 0.80), w.look("wood")
    w.mount_height_m = 0.70
    w.box((0.0, 0.018), centred(width), (0.86, 0.94), wood)
    count = 2 if width < 0.6 else 3
    for i in range(count):
        y = (i + 0.5) * width / count - 0.5 * width
        w.rod((0.015, y, 0.90), (0.075, y, 0.915), 0.010, w.look("metal"), solid=False, round_ends=True)
        high = w.choice((0.70, 0.80, 0.88))
        w.mesh(drape(0.20, high, 0.09, 3, gather=1.1), (0.02, y, 0.91 - high), w.new_look("towel"))


def towel_ladder(w: Workbench) -> None:
    """Builds a wooden ladder that leans at the wall with towels over its rungs."""
    half, high, wood = 0.5 * w.width(0.45, 0.58), w.length(1.55, 1.80), w.look("wood")
    depth = 0.34
    for side in BOTH_SIDES:
        w.bar(
            (0.5 * depth - 0.02, side * (half - 0.02), 0.0),
            (-0.5 * depth + 0.02, side * (half - 0.02), high),
            0.035,
            0.03,
            wood,
        )
    for i in range(5):
        t = 0.15 + 0.175 * i
        x, z = (0.5 - t) * (depth - 0.04), t * high
        w.rod_y((x, z), (-half + 0.02, half - 0.02), 0.014, wood)
    for k, i in enumerate((4, 2)):
        t = 0.15 + 0.175 * i
        x, z = (0.5 - t) * (depth - 0.04), t * high
        w.mesh(
            drape(2 * half - 0.12, 0.46, 0.025, 4),
            (x + 0.010, 0.0, z - 0.44),
            w.look("towel") if k == 0 else w.new_look("towel"),
        )
        w.mesh(
            drape(2 * half - 0.12, 0.30, 0.022, 4),
            (x - 0.032, 0.0, z - 0.28),
            w.look("towel") if k == 0 else w.look("linen"),
        )


def towel_stack(w: Workbench) -> None:
    """Builds a stack of folded towels."""
    z = 0.0
    for i in range(w.whole(3, 4)):
        thick = w.choice((0.055, 0.065))
        w.mesh(chamfered_box((0.26, 0.36 - 0.02 * i, thick), 0.022), (0.0, 0.0, z + 0.5 * thick), w.new_look("towel"))
        z += thick - 0.003


def towel_ring(w: Workbench) -> None:
    """Builds a hand towel drawn through a brass ring."""
    cloth, brass = w.look("towel"), w.look("brass")
    w.mount_height_m = 0.80
    w.rod_x((0.0, 0.56), (0.0, 0.04), 0.022, brass)
    points = [(0.04, 0.085 * math.sin(a), 0.475 + 0.085 * math.cos(a)) for a in (i * math.tau / 8 for i in range(9))]
    w.bent_rod(points, 0.006, brass)
    w.mesh(drape(0.26, 0.40, 0.06, 4), (0.02, 0.0, 0.0), cloth)
    w.mesh(drape(0.20, 0.05, 0.05, 3), (0.022, 0.0, 0.385), cloth)


def swing_rail(w: Workbench) -> None:
    """Builds two bars that swing out of a wall plate, with a towel over each."""
    length, metal = w.length(0.38, 0.45), w.look("chrome")
    w.mount_height_m = 0.75
    w.box((0.0, 0.02), (-0.03, 0.03), (0.42, 0.58), metal)
    for i, (a, z) in enumerate(((-0.75, 0.54), (0.75, 0.47))):
        c, s = math.cos(a), math.sin(a)
        w.rod((0.012, 0.0, z), (length * c, length * s, z), 0.009, metal)
        cloth, high = w.new_look("towel"), 0.44 - 0.02 * i
        at = (0.58 * length * c, 0.58 * length * s)
        w.mesh(
            drape(0.22, high, 0.02, 3),
            (at[0] + 0.006 * s, at[1] - 0.006 * c, z + 0.008 - high),
            cloth,
            turn=a - 0.5 * math.pi,
        )
        w.mesh(
            drape(0.22, high - 0.12, 0.02, 3),
            (at[0] - 0.026 * s, at[1] + 0.026 * c, z + 0.128 - high),
            cloth,
            turn=a - 0.5 * math.pi,
        )


def towel_stand(w: Workbench) -> None:
    """Builds a free-standing rack of two bars with towels."""
    half, high, metal = 0.5 * w.width(0.50, 0.65), w.length(0.85, 1.0), w.look("iron")
    for y in (-half, half):
        w.cylinder((0.0, y), (0.0, high), 0.011, metal)
        w.rod_x((y, 0.011), (-0.13, 0.13), 0.011, metal)
        w.rod((-0.10, y, high - 0.18), (0.10, y, high - 0.06), 0.008, metal)
    for x, z in ((-0.10, high - 0.18), (0.10, high - 0.06)):
        w.rod_y((x, z), (-half, half), 0.009, metal)
        w.mesh(drape(2 * half - 0.14, 0.48, 0.02, 4), (x + 0.007, 0.0, z - 0.47), w.new_look("towel"))
        w.mesh(drape(2 * half - 0.14, 0.36, 0.02, 4), (x - 0.027, 0.0, z - 0.35), w.look("towel"))


def towel_rolls(w: Workbench) -> None:
    """Builds three rolled towels in a pile."""
    r = 0.062
    for y, z in ((-r, r), (r, r), (0.0, r + 1.732 * r)):
        cloth = w.new_look("towel")
        w.rod_x((y, z), (-0.17, 0.17), r, cloth)
        for i, share in enumerate((0.82, 0.7, 0.48, 0.36)):
            ring = cloth if i % 2 else darker(cloth, 0.55)
            at = (0.0006 * (i + 1), y + 0.006 * (i // 2), z)
            w.rod((0.16, *at[1:]), (0.17 + at[0], *at[1:]), share * r, ring, solid=False)


STYLES = (
    Style("towel", "rail", "train", towel_rail, ("rail",), "wall"),
    Style("towel", "radiator", "train", towel_radiator, ("rail",), "wall"),
    Style("towel", "hooks", "train", towel_hooks, ("rail",), "wall"),
    Style("towel", "ladder", "train", towel_ladder, ("floor",)),
    Style("towel", "stack", "train", towel_stack, ("top",), "top"),
    Style("towel", "ring", "heldout", towel_ring, ("rail",), "wall"),
    Style("towel", "swing_rail", "heldout", swing_rail, ("rail",), "wall"),
    Style("towel", "stand", "heldout", towel_stand, ("floor",)),
    Style("towel", "rolls", "heldout", towel_rolls, ("top",), "top"),
)
