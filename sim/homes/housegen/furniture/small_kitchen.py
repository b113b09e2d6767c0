"""Small objects of kitchens, dining tables and bathrooms: crockery, pots, food, bottles; one palette mesh each.

Usual sizes: plates 0.20-0.27 m, cups 0.08 m, pots 0.18-0.24 m wide, bottles 0.25-0.32 m high.
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
    GREEN,
    METAL,
    TINT,
    WHITE,
    WOOD,
    PaletteMesh,
    in_one_mesh,
)
from sim.homes.housegen.furniture.workbench import Workbench

_XY = tuple[float, float]


def _plate(m: PaletteMesh, at: _XY, z: float, radius: float, column: int) -> None:
    m.round(at, [(z, 0.55 * radius), (z + 0.018, radius)], column, sides=9)


def _bottle(m: PaletteMesh, at: _XY, high: float, radius: float, column: int, cap: int) -> None:
    m.round(
        at, [(0.0, radius), (0.6 * high, radius), (0.75 * high, 0.35 * radius), (0.94 * high, 0.35 * radius)], column
    )
    m.round(at, [(0.93 * high, 0.42 * radius), (high, 0.42 * radius)], cap, sides=6)


def dish_pile(w: Workbench, m: PaletteMesh) -> None:
    """Builds a pile of plates with a bowl on it, and two cups."""
    dish = w.choice((WHITE, CREAM, ACCENTS[1]))
    r = w.length(0.11, 0.135)
    for n in range(3):
        _plate(m, (0.0, 0.0), 0.012 * n, r, dish)
    m.cup((0.0, 0.0), (0.034, 0.09), 0.07, w.choice(ACCENTS), sides=8)
    for x in (-0.06, 0.06):
        m.cup((x, 0.19), (0.0, 0.09), 0.04, w.choice(ACCENTS), sides=6)


def tea_set(w: Workbench, m: PaletteMesh) -> None:
    """Builds a teapot and two cups on a tray."""
    pot = w.choice((*ACCENTS, WHITE))
    m.box((-0.13, 0.13), (-0.20, 0.20), (0.0, 0.012), w.choice((WOOD, BROWN)))
    m.round((0.0, -0.07), [(0.012, 0.05), (0.06, 0.085), (0.12, 0.06), (0.135, 0.02), (0.155, 0.016)], pot)
    m.box((-0.012, 0.012), (0.0, 0.075), (0.07, 0.09), pot, roll=0.5)
    for x in (-0.06, 0.06):
        m.cup((x, 0.12), (0.012, 0.07), 0.042, pot, sides=6)


def pot_lid(w: Workbench, m: PaletteMesh) -> None:
    """Builds a cooking pot with a lid and two handles."""
    body, r = w.choice((METAL, ACCENTS[0], ACCENTS[3])), w.length(0.10, 0.125)
    m.round((0.0, 0.0), [(0.0, r), (0.14, r), (0.165, 0.5 * r)], body, sides=10)
    m.round((0.0, 0.0), [(0.16, 0.02), (0.185, 0.024)], DARK, sides=6)
    for side in (-1, 1):
        m.box((-0.04, 0.04), around(side * (r + 0.015), 0.02), (0.10, 0.115), DARK)


def frying_pan(w: Workbench, m: PaletteMesh) -> None:
    """Builds a frying pan, and a jar with wooden spoons."""
    r = w.length(0.11, 0.14)
    m.round((0.0, 0.0), [(0.0, 0.8 * r), (0.05, r), (0.05, 0.94 * r), (0.01, 0.7 * r)], DARK, sides=10)
    m.box((-0.012, 0.012), (-r - 0.17, -0.95 * r), (0.035, 0.05), w.choice((WOOD, METAL)))
    m.cup((0.02, r + 0.08), (0.0, 0.14), 0.055, w.choice((WHITE, *ACCENTS)))
    for n in range(3):
        x = 0.005 + 0.015 * n
        m.box((x, x + 0.012), (r + 0.07, r + 0.082), (0.03, 0.28), WOOD, roll=0.14 * (n - 1), tilt=0.1 * (n - 1))


def bread_board(w: Workbench, m: PaletteMesh) -> None:
    """Builds a board with a loaf of bread, a slice and a knife."""
    m.box((-0.12, 0.12), (-0.20, 0.20), (0.0, 0.018), WOOD)
    for y, r in ((-0.11, 0.035), (-0.06, 0.05), (0.0, 0.048)):
        m.box((-0.05, 0.05), around(y, 0.03), (0.018, 0.04 + r), CARD)
    m.box((-0.05, 0.05), (0.07, 0.082), (0.018, 0.085), CREAM, roll=-0.9)
    m.box((0.07, 0.085), (-0.05, 0.10), (0.018, 0.022), METAL)
    m.box((0.065, 0.09), (0.10, 0.20), (0.018, 0.034), DARK)


def cheese_board(w: Workbench, m: PaletteMesh) -> None:
    """Builds a round board with cheese, grapes and a glass."""
    m.round((0.0, 0.0), [(0.0, 0.15), (0.016, 0.15)], BROWN, sides=10)
    m.box((-0.07, 0.02), (-0.09, -0.01), (0.016, 0.07), ACCENTS[5], turn=0.5)
    for x, y, z in ((0.06, 0.05, 0.034), (0.09, 0.03, 0.034), (0.075, 0.07, 0.034)):
        m.ball((x, y, z), 0.02, GREEN, sides=5)
    m.cup((-0.02, 0.22), (0.0, 0.13), 0.036, TINT, sides=6)


def wine(w: Workbench, m: PaletteMesh) -> None:
    """Builds a bottle and two glasses with stems."""
    _bottle(m, (0.0, -0.10), w.length(0.28, 0.32), 0.038, w.choice((GREEN, DARK)), w.choice(ACCENTS))
    for x in (-0.06, 0.05):
        rings = [(0.0, 0.035), (0.008, 0.006), (0.09, 0.006), (0.12, 0.038), (0.20, 0.032)]
        m.round((x, 0.03), rings, TINT, sides=5)


def jars(w: Workbench, m: PaletteMesh) -> None:
    """Builds a row of three jars, each smaller than the one before."""
    y = 0.0
    body, lid = w.choice((WHITE, TINT, *ACCENTS)), w.choice((WOOD, DARK, METAL))
    for n in range(3):
        r, high = 0.06 - 0.009 * n, 0.19 - 0.035 * n
        m.round((0.0, y), [(0.0, r), (high, r)], body, sides=7)
        m.round((0.0, y), [(high, 0.9 * r), (high + 0.022, 0.9 * r)], lid, sides=7)
        y += 2 * r


def spice_rack(w: Workbench, m: PaletteMesh) -> None:
    """Builds a small rack with three spice tins."""
    m.box((-0.045, 0.045), (-0.12, 0.12), (0.0, 0.012), WOOD)
    m.box((-0.045, -0.035), (-0.12, 0.12), (0.0, 0.10), WOOD)
    for n in range(3):
        m.round((0.008, -0.08 + 0.08 * n), [(0.012, 0.03), (0.10, 0.03)], w.choice(ACCENTS), sides=6)
        m.round((0.008, -0.08 + 0.08 * n), [(0.10, 0.031), (0.115, 0.031)], DARK, sides=6)


def fruit_plate(w: Workbench, m: PaletteMesh) -> None:
    """Builds a shallow plate with round fruit."""
    r = w.length(0.12, 0.15)
    m.round(
        (0.0, 0.0),
        [(0.0, 0.4 * r), (0.05, r), (0.05, 0.92 * r), (0.015, 0.5 * r)],
        w.choice((WHITE, WOOD, TINT)),
        sides=10,
    )
    for n in range(3):
        a = math.tau * n / 3
        at = (*polar(0.42 * r, a), 0.07)
        m.ball(at, 0.042, w.choice((GREEN, ACCENTS[2], ACCENTS[3], ACCENTS[4])), sides=5)


def table_mats(w: Workbench, m: PaletteMesh) -> None:
    """Builds two table mats with plates and glasses."""
    mat, dish = w.choice(ACCENTS), w.choice((WHITE, CREAM))
    for y in (-0.22, 0.22):
        m.box((-0.15, 0.15), around(y, 0.20), (0.0, 0.003), mat)
        _plate(m, (0.0, y), 0.003, 0.12, dish)
        m.cup((-0.11, y + 0.15), (0.003, 0.115), 0.034, TINT, sides=6)


def breakfast(w: Workbench, m: PaletteMesh) -> None:
    """Builds a plate, a bowl, a mug and a carton."""
    _plate(m, (0.03, -0.14), 0.0, 0.12, w.choice((WHITE, CREAM)))
    m.cup((0.03, 0.09), (0.0, 0.06), 0.075, w.choice(ACCENTS))
    m.cup((-0.10, -0.02), (0.0, 0.095), 0.042, w.choice(ACCENTS), sides=6)
    m.box((-0.13, -0.06), (0.12, 0.19), (0.0, 0.20), w.choice((WHITE, *ACCENTS)))
    m.box((-0.131, -0.059), (0.119, 0.191), (0.06, 0.12), w.choice(ACCENTS))


def soap_and_brushes(w: Workbench, m: PaletteMesh) -> None:
    """Builds a cup with two toothbrushes and a bar of soap in a dish."""
    m.cup((0.0, 0.0), (0.0, 0.10), 0.036, w.choice((WHITE, *ACCENTS)), sides=6)
    for n in (-1, 1):
        m.box((-0.005, 0.005), around(0.012 * n, 0.005), (0.015, 0.185), w.choice(ACCENTS), roll=-0.12 * n)
    m.box((-0.04, 0.04), (0.06, 0.17), (0.0, 0.015), w.choice((WHITE, TINT)))
    m.box((-0.025, 0.025), (0.08, 0.15), (0.015, 0.035), w.choice((CREAM, ACCENTS[4])))


def pump_bottles(w: Workbench, m: PaletteMesh) -> None:
    """Builds two bottles with pumps and a jar on a small tray."""
    m.box((-0.05, 0.05), (-0.13, 0.13), (0.0, 0.01), w.choice((WOOD, WHITE, DARK)))
    for y in (-0.085, 0.0):
        m.round(
            (0.0, y),
            [(0.01, 0.033), (0.13, 0.033), (0.145, 0.012), (0.18, 0.012)],
            w.choice((*ACCENTS, WHITE)),
            sides=6,
        )
        m.box((-0.008, 0.05), around(y, 0.008), (0.17, 0.186), DARK)
    m.round((0.0, 0.085), [(0.01, 0.032), (0.07, 0.032)], w.choice((TINT, CREAM)), sides=6)


def paper_holder(w: Workbench, m: PaletteMesh) -> None:
    """Builds a roll of toilet paper on a bracket."""
    metal = w.choice((METAL, DARK))
    w.mount_height_m = 0.68
    m.box((0.0, 0.01), (-0.08, -0.04), (0.02, 0.10), metal)
    m.box((0.0, 0.075), (-0.07, -0.06), (0.055, 0.065), metal)
    m.roll(0.07, 0.06, [(-0.05, 0.055), (0.05, 0.055)], WHITE, sides=10)


def paper_niche(w: Workbench, m: PaletteMesh) -> None:
    """Builds a roll of toilet paper under a small shelf."""
    w.mount_height_m = 0.68
    m.box((0.0, 0.12), (-0.09, 0.09), (0.13, 0.145), w.choice((WOOD, BROWN)))
    m.box((0.0, 0.01), (-0.09, 0.09), (0.05, 0.135), w.choice((WOOD, BROWN)))
    m.roll(0.065, 0.065, [(-0.05, 0.055), (0.05, 0.055)], WHITE, sides=10)


def bottle_rack(w: Workbench, m: PaletteMesh) -> None:
    """Builds a wall rack of two boards with bottles."""
    w.mount_height_m = 1.15
    for z in (0.0, 0.26):
        m.box((0.0, 0.11), (-0.15, 0.15), (z, z + 0.012), METAL)
        for y in (-0.09, 0.0, 0.09):
            high = w.length(0.10, 0.18)
            m.round((0.055, y), [(z + 0.012, 0.032), (z + high, 0.028)], w.choice((*ACCENTS, WHITE)), sides=6)
    m.box((0.0, 0.008), (-0.15, 0.15), (0.0, 0.30), METAL)


def towel_ledge(w: Workbench, m: PaletteMesh) -> None:
    """Builds a wooden ledge on the wall with bottles and a folded cloth."""
    w.mount_height_m = 1.2
    m.box((0.0, 0.14), (-0.24, 0.24), (0.0, 0.02), WOOD)
    for n in range(3):
        high = w.length(0.10, 0.19)
        m.round(
            (0.07, -0.19 + 0.085 * n),
            [(0.02, 0.034), (0.7 * high, 0.034), (high, 0.014)],
            w.choice((*ACCENTS, WHITE)),
            sides=6,
        )
    m.box((0.01, 0.13), (0.06, 0.21), (0.02, 0.08), w.choice((*ACCENTS, WHITE)))


STYLES = (
    Style("objects", "dish_pile", "train", in_one_mesh(dish_pile), ("kitchen",), "top"),
    Style("objects", "pot_lid", "train", in_one_mesh(pot_lid), ("kitchen",), "top"),
    Style("objects", "bread_board", "train", in_one_mesh(bread_board), ("kitchen", "table"), "top"),
    Style("objects", "wine", "train", in_one_mesh(wine), ("table", "kitchen"), "top"),
    Style("objects", "jars", "train", in_one_mesh(jars), ("kitchen",), "top"),
    Style("objects", "table_mats", "train", in_one_mesh(table_mats), ("table",), "top"),
    Style("objects", "tea_set", "heldout", in_one_mesh(tea_set), ("kitchen", "table"), "top"),
    Style("objects", "frying_pan", "heldout", in_one_mesh(frying_pan), ("kitchen",), "top"),
    Style("objects", "cheese_board", "heldout", in_one_mesh(cheese_board), ("kitchen", "table"), "top"),
    Style("objects", "spice_rack", "heldout", in_one_mesh(spice_rack), ("kitchen",), "top"),
    Style("objects", "fruit_plate", "heldout", in_one_mesh(fruit_plate), ("kitchen", "table"), "top"),
    Style("objects", "breakfast", "heldout", in_one_mesh(breakfast), ("table",), "top"),
    Style("objects", "soap_and_brushes", "train", in_one_mesh(soap_and_brushes), ("bath",), "top"),
    Style("objects", "pump_bottles", "heldout", in_one_mesh(pump_bottles), ("bath",), "top"),
    Style("objects", "paper_holder", "train", in_one_mesh(paper_holder), ("toilet_paper",), "wall"),
    Style("objects", "paper_niche", "heldout", in_one_mesh(paper_niche), ("toilet_paper",), "wall"),
    Style("objects", "bottle_rack", "train", in_one_mesh(bottle_rack), ("bath_wall",), "wall"),
    Style("objects", "towel_ledge", "heldout", in_one_mesh(towel_ledge), ("bath_wall",), "wall"),
)
