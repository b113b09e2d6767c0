"""Small objects that lie on floors: shoes, bags, toys, cables, boxes; one palette mesh each.

An object that is higher than 3 cm collides as its convex hull; flat objects do not collide.
"""

from __future__ import annotations

import math

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.parts import around, polar
from sim.homes.housegen.furniture.parts.palette_mesh import (
    ACCENTS,
    BROWN,
    CARD,
    CREAM,
    DARK,
    HIDE,
    METAL,
    TINT,
    WHITE,
    PaletteMesh,
    in_one_mesh,
)
from sim.homes.housegen.furniture.workbench import Workbench


def _lace_shoe(m: PaletteMesh, y: float, shift: float, turn: float, column: int) -> None:
    m.box(around(shift, 0.14), around(y, 0.045), (0.0, 0.025), WHITE, turn=turn)
    m.box((shift - 0.135, shift + 0.02), around(y, 0.04), (0.024, 0.095), column, turn=turn)
    m.box((shift - 0.02, shift + 0.13), around(y, 0.042), (0.024, 0.062), column, turn=turn)


def sneakers(w: Workbench, m: PaletteMesh) -> None:
    """Builds a pair of sneakers."""
    column = w.choice((*ACCENTS, DARK))
    _lace_shoe(m, -0.065, 0.0, 0.0, column)
    _lace_shoe(m, 0.065, w.length(-0.04, 0.04), w.length(-0.2, 0.2), column)


def pumps(w: Workbench, m: PaletteMesh) -> None:
    """Builds a pair of low shoes."""
    column = w.choice((*ACCENTS, HIDE, DARK))
    for y in (-0.055, 0.055):
        m.box((-0.125, 0.125), around(y, 0.038), (0.0, 0.03), column, turn=0.5 * y)
        m.box((-0.125, -0.03), around(y, 0.036), (0.028, 0.075), column, turn=0.5 * y)
        m.box((-0.02, 0.07), around(y, 0.026), (0.028, 0.034), CREAM, turn=0.5 * y)


def boots(w: Workbench, m: PaletteMesh) -> None:
    """Builds a pair of boots."""
    column = w.choice((HIDE, DARK, ACCENTS[0], ACCENTS[5]))
    high = w.length(0.20, 0.34)
    for y, x in ((-0.065, 0.0), (0.065, w.length(-0.05, 0.05))):
        m.box((x - 0.13, x + 0.15), around(y, 0.048), (0.0, 0.025), DARK)
        m.box((x - 0.125, x + 0.0), around(y, 0.045), (0.024, high), column)
        m.box((x - 0.01, x + 0.14), around(y, 0.043), (0.024, 0.085), column)


def slippers(w: Workbench, m: PaletteMesh) -> None:
    """Builds a pair of slippers."""
    column = w.choice(ACCENTS)
    for y, turn in ((-0.06, 0.0), (0.07, 0.25)):
        m.round((0.0, y), [(0.0, 0.12), (0.02, 0.125)], CREAM, sides=8, wide=0.42)
        m.box((0.005, 0.10), around(y, 0.045), (0.018, 0.065), column, turn=turn)


def tote_bag(w: Workbench, m: PaletteMesh) -> None:
    """Builds an upright shopping bag with two handles."""
    column = w.choice((*ACCENTS, CARD))
    m.box((-0.07, 0.07), (-0.18, 0.18), (0.0, 0.32), column)
    m.box((-0.071, 0.071), (-0.10, 0.10), (0.10, 0.22), CREAM)
    for x in (-0.06, 0.06):
        for y in (-0.08, 0.08):
            m.box(around(x, 0.006), around(y, 0.014), (0.31, 0.44), HIDE)
        m.box(around(x, 0.006), (-0.09, 0.09), (0.43, 0.455), HIDE)


def backpack(w: Workbench, m: PaletteMesh) -> None:
    """Builds an upright backpack with a pocket and a flap."""
    column = w.choice(ACCENTS)
    m.box((-0.09, 0.09), (-0.15, 0.15), (0.0, 0.40), column)
    m.box((-0.07, 0.08), (-0.13, 0.13), (0.39, 0.45), column)
    m.box((0.08, 0.14), (-0.11, 0.11), (0.04, 0.22), w.choice((DARK, *ACCENTS)))
    m.box((0.085, 0.10), (-0.14, 0.14), (0.30, 0.315), DARK)
    m.box((-0.03, -0.01), (-0.04, 0.04), (0.44, 0.48), DARK)


def duffel(w: Workbench, m: PaletteMesh) -> None:
    """Builds a lying sports bag with straps."""
    column = w.choice((*ACCENTS, DARK))
    m.roll(0.0, 0.12, [(-0.27, 0.09), (-0.25, 0.12), (0.25, 0.12), (0.27, 0.09)], column)
    for y in (-0.13, 0.10):
        m.roll(0.0, 0.12, [(y, 0.124), (y + 0.03, 0.124)], HIDE)
    m.box((-0.012, 0.012), (-0.13, 0.13), (0.25, 0.265), HIDE)
    for y in (-0.12, 0.12):
        m.box((-0.012, 0.012), around(y, 0.01), (0.22, 0.265), HIDE)


def satchel(w: Workbench, m: PaletteMesh) -> None:
    """Builds a leather satchel with two buckles."""
    column = w.choice((HIDE, BROWN, ACCENTS[0]))
    m.box((-0.06, 0.06), (-0.19, 0.19), (0.0, 0.28), column)
    m.box((0.055, 0.075), (-0.195, 0.195), (0.10, 0.285), column)
    for y in (-0.10, 0.10):
        m.box((0.07, 0.08), around(y, 0.014), (0.05, 0.20), DARK)
        m.box((0.078, 0.085), around(y, 0.018), (0.08, 0.11), METAL)
    m.box((-0.01, 0.01), (-0.06, 0.06), (0.275, 0.32), DARK)


def toy_blocks(w: Workbench, m: PaletteMesh) -> None:
    """Builds toy blocks, some on top of each other."""
    for x, y, z in ((0.0, 0.0, 0.0), (0.07, 0.09, 0.0), (-0.09, 0.10, 0.0), (0.02, 0.03, 0.06), (0.10, -0.10, 0.0)):
        m.box(around(x, 0.03), around(y, 0.03), (z, z + 0.06), w.choice(ACCENTS), turn=3.0 * x + y)


def toy_ball(w: Workbench, m: PaletteMesh) -> None:
    """Builds a ball of two colours."""
    r = w.length(0.08, 0.12)
    one, two = w.choice(ACCENTS[:3]), w.choice(ACCENTS[3:])
    m.round((0.0, 0.0), [(0.0, 0.3 * r), (0.35 * r, 0.76 * r), (0.8 * r, 0.98 * r)], one, sides=8)
    m.round((0.0, 0.0), [(0.8 * r, 0.98 * r), (1.2 * r, 0.98 * r)], WHITE, sides=8)
    m.round((0.0, 0.0), [(1.2 * r, 0.98 * r), (1.65 * r, 0.76 * r), (2 * r, 0.3 * r)], two, sides=8)


def teddy(w: Workbench, m: PaletteMesh) -> None:
    """Builds a sitting teddy bear."""
    fur = w.choice((CARD, HIDE, WHITE))
    m.ball((0.0, 0.0, 0.10), 0.105, fur)
    m.ball((0.02, 0.0, 0.25), 0.075, fur)
    for y in (-1, 1):
        m.box((-0.01, 0.01), around(0.055 * y, 0.022), (0.29, 0.34), fur)
        m.box((0.05, 0.17), around(0.06 * y, 0.03), (0.0, 0.06), fur, turn=0.3 * y)
        m.box((0.0, 0.05), around(0.09 * y, 0.025), (0.08, 0.19), fur, roll=0.5 * y)
    m.box((0.07, 0.105), (-0.025, 0.025), (0.215, 0.25), CREAM)


def toy_train(w: Workbench, m: PaletteMesh) -> None:
    """Builds a toy engine with two wagons."""
    for n in range(3):
        y = 0.19 * n
        m.box((-0.04, 0.04), around(y, 0.08), (0.025, 0.05), DARK)
        m.box((-0.035, 0.035), (y - 0.075, y + (0.075 if n else 0.0)), (0.05, 0.10 if n else 0.16), w.choice(ACCENTS))
        m.box((-0.048, 0.048), around(y, 0.06), (0.0, 0.03), METAL)
    m.box((-0.025, 0.025), (0.0, 0.075), (0.05, 0.10), w.choice(ACCENTS))
    m.box((-0.012, 0.012), (0.075, 0.12), (0.03, 0.04), DARK)


def power_strip(w: Workbench, m: PaletteMesh) -> None:
    """Builds a power strip with two plugs and a cable; flat, without collisions."""
    m.box((-0.03, 0.03), (-0.17, 0.17), (0.0, 0.024), WHITE)
    for y in (-0.10, 0.02):
        m.box((-0.02, 0.02), around(y, 0.02), (0.02, 0.029), DARK)
    for a, b, turn in ((0.0, 0.30, 0.0), (0.27, 0.55, 0.6), (0.45, 0.75, -0.5)):
        m.box((0.06 + 0.1 * a, 0.068 + 0.1 * a), (a - 0.35, b - 0.35), (0.0, 0.008), DARK, turn=turn)


def cable_coil(w: Workbench, m: PaletteMesh) -> None:
    """Builds a coiled cable with a plug; flat, without collisions."""
    column = w.choice((WHITE, DARK, *ACCENTS))
    for n in range(6):
        a = math.tau * n / 6
        x, y = polar(0.12, a)
        m.box(around(x, 0.005), around(y, 0.07), (0.0, 0.01), column, turn=a)
    m.box((0.11, 0.12), (0.0, 0.30), (0.0, 0.01), column, turn=0.2)
    m.box((0.06, 0.11), (0.29, 0.34), (0.0, 0.026), column)


def scattered_magazines(w: Workbench, m: PaletteMesh) -> None:
    """Builds magazines that lie about; flat, without collisions."""
    for n, (x, y) in enumerate(((0.0, 0.0), (0.16, 0.14), (-0.10, 0.22))):
        turn = w.length(-0.8, 0.8)
        m.box(around(x, 0.14), around(y, 0.10), (0.003 * n, 0.003 * n + 0.005), w.choice(ACCENTS), turn=turn)
        m.box(around(x, 0.06), around(y, 0.06), (0.003 * n, 0.003 * n + 0.006), WHITE, turn=turn)


def drawings(w: Workbench, m: PaletteMesh) -> None:
    """Builds sheets of paper and two pencils; flat, without collisions."""
    for n, (x, y) in enumerate(((0.0, 0.0), (0.20, 0.10), (0.02, 0.27))):
        turn = w.length(-0.7, 0.7)
        m.box(around(x, 0.15), around(y, 0.105), (0.002 * n, 0.002 * n + 0.003), (WHITE, CREAM)[n % 2], turn=turn)
        m.box(around(x, 0.05), around(y, 0.04), (0.002 * n, 0.002 * n + 0.004), w.choice(ACCENTS), turn=turn)
    for x in (-0.12, 0.24):
        m.box(around(x, 0.08), (-0.10, -0.092), (0.0, 0.008), w.choice(ACCENTS), turn=5.0 * x)


def box_pile(w: Workbench, m: PaletteMesh) -> None:
    """Builds two shoe boxes on a larger box."""
    m.box((-0.17, 0.17), (-0.22, 0.22), (0.0, 0.26), CARD)
    m.box((-0.171, 0.171), (-0.025, 0.025), (0.10, 0.262), CREAM)
    for z, turn in ((0.26, 0.1), (0.375, -0.15)):
        m.box((-0.10, 0.10), (-0.16, 0.16), (z, z + 0.085), w.choice((*ACCENTS, WHITE)), turn=turn)
        m.box((-0.103, 0.103), (-0.163, 0.163), (z + 0.08, z + 0.115), w.choice(ACCENTS), turn=turn)


def storage_tub(w: Workbench, m: PaletteMesh) -> None:
    """Builds a plastic tub with a lid and clips."""
    m.box((-0.18, 0.18), (-0.26, 0.26), (0.0, 0.26), w.choice((TINT, WHITE)))
    m.box((-0.195, 0.195), (-0.275, 0.275), (0.25, 0.285), w.choice(ACCENTS))
    for y in (-1, 1):
        m.box((-0.05, 0.05), around(0.27 * y, 0.01), (0.18, 0.28), DARK)


STYLES = (
    Style("objects", "sneakers", "train", in_one_mesh(sneakers, solid=True), ("shoes",)),
    Style("objects", "pumps", "train", in_one_mesh(pumps, solid=True), ("shoes",)),
    Style("objects", "boots", "heldout", in_one_mesh(boots, solid=True), ("shoes",)),
    Style("objects", "slippers", "heldout", in_one_mesh(slippers, solid=True), ("shoes",)),
    Style("objects", "tote_bag", "train", in_one_mesh(tote_bag, solid=True), ("bag",)),
    Style("objects", "backpack", "train", in_one_mesh(backpack, solid=True), ("bag",)),
    Style("objects", "duffel", "heldout", in_one_mesh(duffel, solid=True), ("bag",)),
    Style("objects", "satchel", "heldout", in_one_mesh(satchel, solid=True), ("bag",)),
    Style("objects", "toy_blocks", "train", in_one_mesh(toy_blocks, solid=True), ("toy",)),
    Style("objects", "toy_ball", "train", in_one_mesh(toy_ball, solid=True), ("toy",)),
    Style("objects", "teddy", "heldout", in_one_mesh(teddy, solid=True), ("toy",)),
    Style("objects", "toy_train", "heldout", in_one_mesh(toy_train, solid=True), ("toy",)),
    Style("objects", "power_strip", "train", in_one_mesh(power_strip), ("cable",), walk_over=True),
    Style("objects", "cable_coil", "heldout", in_one_mesh(cable_coil), ("cable",), walk_over=True),
    Style("objects", "scattered_magazines", "train", in_one_mesh(scattered_magazines), ("flat",), walk_over=True),
    Style("objects", "drawings", "heldout", in_one_mesh(drawings), ("flat",), walk_over=True),
    Style("objects", "box_pile", "train", in_one_mesh(box_pile, solid=True), ("floor", "box")),
    Style("objects", "storage_tub", "heldout", in_one_mesh(storage_tub, solid=True), ("floor", "box")),
)
