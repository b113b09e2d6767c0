"""Appliances on the floor: fridges, stoves, washing machines, dryers, dishwashers.

Usual retail dimensions (0.60 m wide, 0.85 m high; fridges 0.58-0.92 m wide and 1.40-2.00 m high).
"""

from __future__ import annotations

import itertools

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, centred, inset
from sim.homes.housegen.furniture.shapes import chamfered_box
from sim.homes.housegen.furniture.workbench import Workbench


def fridge(w: Workbench) -> None:
    """Builds a fridge with a freezer above or below it, and long handles."""
    width, depth, height = w.width(0.58, 0.70), w.depth(0.60, 0.68), w.height(1.60, 1.90)
    look, metal = w.look("appliance"), w.look("chrome")
    x, y = parts.footprint(depth, width)
    split = height * w.choice((0.36, 0.68))
    w.box((x[0], x[1] - 0.06), y, (0.04, height), look)
    w.box(inset(x, 0.03, 0.08), inset(y, 0.02), (0.0, 0.04), w.look("dark"))
    hand = w.choice(BOTH_SIDES) * (0.5 * width - 0.06)
    for low, high in ((0.05, split - 0.004), (split + 0.004, height)):
        w.mesh(chamfered_box((0.06, width, round(high - low, 3)), 0.008), (x[1] - 0.03, 0.0, 0.5 * (low + high)), look)
        grip = (max(low + 0.10, high - 0.5), high - 0.08) if low < 0.1 else (low + 0.08, min(high - 0.10, low + 0.5))
        w.rod((x[1] + 0.03, hand, grip[0]), (x[1] + 0.03, hand, grip[1]), 0.010, metal, solid=False)
        for z in inset(grip, 0.02):
            w.rod_x((hand, z), (x[1], x[1] + 0.03), 0.008, metal, solid=False)


def retro_fridge(w: Workbench) -> None:
    """Builds a rounded fridge with a single door, a badge and a lever."""
    width, depth, height = w.width(0.58, 0.62), w.depth(0.62, 0.68), w.height(1.40, 1.60)
    look, metal = w.look("appliance"), w.look("chrome")
    w.mesh(chamfered_box((depth - 0.07, width, height - 0.06), 0.05), (-0.035, 0.0, 0.5 * height + 0.03), look)
    w.mesh(
        chamfered_box((0.08, width - 0.01, height - 0.16), 0.035), (0.5 * depth - 0.045, 0.0, 0.5 * height + 0.07), look
    )
    w.box(centred(depth, 0.06, 0.10), centred(width, 0.05), (0.0, 0.07), w.look("dark"))
    w.cylinder((0.5 * depth + 0.02, -0.20), (0.62 * height, 0.62 * height + 0.22), 0.013, metal, solid=False)
    w.box(
        (0.5 * depth - 0.01, 0.5 * depth + 0.02),
        (-0.22, -0.18),
        (0.62 * height + 0.08, 0.62 * height + 0.14),
        metal,
        solid=False,
    )
    w.box((0.5 * depth - 0.006, 0.5 * depth + 0.002), (0.02, 0.18), (height - 0.24, height - 0.20), metal, solid=False)


def stove(w: Workbench) -> None:
    """Builds a free-standing cooker with four rings, knobs and an oven door with a window."""
    width, depth, height = w.width(0.58, 0.62), w.depth(0.60, 0.64), w.height(0.87, 0.91)
    look, dark, metal = w.look("appliance"), w.look("screen"), w.look("chrome")
    x, y = parts.footprint(depth, width)
    w.box((x[0], x[1] - 0.025), y, (0.05, height - 0.01), look)
    w.box(inset(x, 0.03, 0.06), inset(y, 0.02), (0.0, 0.05), w.look("dark"))
    w.box((x[0], x[1]), y, (height - 0.012, height), dark)
    for sx in (-0.13, 0.13):
        for side in BOTH_SIDES:
            w.cylinder(
                (sx, side * 0.14),
                (height, height + 0.012),
                0.085 if sx * side < 0 else 0.07,
                w.look("iron"),
                solid=False,
            )
    w.box((x[1] - 0.025, x[1]), inset(y, 0.005), (0.17, height - 0.14), look, solid=False)
    w.box((x[1], x[1] + 0.004), inset(y, 0.08), (0.27, height - 0.26), dark, solid=False)
    w.rod_y((x[1] + 0.03, height - 0.18), inset(y, 0.06), 0.010, metal, solid=False)
    for side in BOTH_SIDES:
        w.rod_x((side * (0.5 * width - 0.08), height - 0.18), (x[1] - 0.01, x[1] + 0.03), 0.008, metal, solid=False)
    for i in range(5):
        w.rod_x(((i - 2) * 0.10, height - 0.07), (x[1] - 0.03, x[1] + 0.012), 0.018, metal, solid=False)


def range_cooker(w: Workbench) -> None:
    """Builds a wide range with two ovens, a towel rail, four burners and a low splashback."""
    width, depth, height = w.width(0.60, 0.62), w.depth(0.60, 0.66), 0.90
    look, iron, brass = w.look("appliance"), w.look("iron"), w.look("brass")
    x, y = parts.footprint(depth, width)
    w.box((x[0], x[1] - 0.02), y, (0.08, height), look)
    w.legs(inset(x, 0.03, 0.05), inset(y, 0.03), (0.0, 0.08), 0.04, iron)
    w.box((x[0], x[0] + 0.02), y, (height, height + 0.10), look)
    for side in BOTH_SIDES:
        c = side * 0.25 * width
        w.box((x[1] - 0.02, x[1]), around(c, 0.23 * width), (0.14, 0.70), look, solid=False)
        w.box((x[1], x[1] + 0.006), around(c, 0.12 * width), (0.40, 0.58), w.look("screen"), solid=False)
        for sx in (-0.12, 0.12):
            w.cylinder((sx, side * 0.14), (height, height + 0.02), 0.075, iron, solid=False)
    w.rod_y((x[1] + 0.03, 0.75), inset(y, 0.02), 0.011, brass, solid=False)
    for i in range(4):
        w.rod_x(
            ((i - 1.5) * 0.13, 0.83),
            (x[1] - 0.03, x[1] + 0.035 if i in (0, 3) else x[1] + 0.01),
            0.02,
            brass,
            solid=False,
        )
    for side in BOTH_SIDES:
        w.rod_x((side * (0.5 * width - 0.05), 0.75), (x[1] - 0.02, x[1] + 0.03), 0.008, brass, solid=False)


def front_loader(w: Workbench) -> None:
    """Builds a washing machine with a round door and a panel with a knob."""
    width, depth, height = 0.60, w.depth(0.55, 0.62), w.height(0.84, 0.87)
    look = w.look("appliance")
    x = 0.5 * depth
    w.mesh(chamfered_box((depth, width, height - 0.03), 0.012), (0.0, 0.0, 0.5 * height + 0.015), look)
    w.box((-x + 0.04, x - 0.04), (-0.26, 0.26), (0.0, 0.035), w.look("dark"))
    w.rod_x((0.0, 0.42), (x - 0.01, x + 0.025), 0.19, w.look("chrome"), solid=False)
    w.rod_x((0.0, 0.42), (x, x + 0.035), 0.145, w.look("screen"), solid=False)
    w.box((x - 0.005, x + 0.006), (-0.28, 0.28), (height - 0.13, height - 0.02), w.look("dark"), solid=False)
    w.rod_x((0.06, height - 0.075), (x, x + 0.025), 0.03, w.look("chrome"), solid=False)
    w.box((x, x + 0.010), (-0.27, -0.10), (height - 0.115, height - 0.035), look, solid=False)


def top_loader(w: Workbench) -> None:
    """Builds a washing machine with a lid on top and a raised panel behind."""
    width, depth, height = w.width(0.42, 0.60), w.depth(0.58, 0.62), w.height(0.86, 0.90)
    look = w.look("appliance")
    w.mesh(chamfered_box((depth, width, height - 0.02), 0.015), (0.0, 0.0, 0.5 * height + 0.01), look)
    w.box(centred(depth, 0.04), centred(width, 0.04), (0.0, 0.03), w.look("dark"))
    w.box((-0.5 * depth, -0.5 * depth + 0.12), centred(width, 0.01), (height - 0.005, height + 0.11), look)
    w.rod_x((0.12, height + 0.055), (-0.5 * depth + 0.11, -0.5 * depth + 0.145), 0.03, w.look("chrome"), solid=False)
    w.box(
        (-0.5 * depth + 0.115, -0.5 * depth + 0.125),
        (-0.16, 0.04),
        (height + 0.02, height + 0.09),
        w.look("screen"),
        solid=False,
    )
    w.box(centred(depth, 0.15, 0.04), centred(width, 0.04), (height, height + 0.012), w.look("glass"), solid=False)


def two_door_fridge(w: Workbench) -> None:
    """Builds a side-by-side fridge with a water dispenser."""
    width, depth, height = w.width(0.84, 0.92), w.depth(0.66, 0.74), w.height(1.74, 1.82)
    look, metal = w.look("appliance"), w.look("chrome")
    x = 0.5 * depth
    w.box((-x, x - 0.07), centred(width), (0.04, height), look)
    w.box((-x + 0.03, x - 0.09), centred(width, 0.02), (0.0, 0.04), w.look("dark"))
    split = 0.08 * width
    for low, high in ((-0.5 * width, -split - 0.003), (-split + 0.003, 0.5 * width)):
        w.mesh(
            chamfered_box((0.07, round(high - low, 3), height - 0.06), 0.01),
            (x - 0.035, 0.5 * (low + high), 0.5 * height + 0.03),
            look,
        )
    for y in around(-split, 0.05):
        w.cylinder((x + 0.03, y), (0.65, 1.45), 0.011, metal, solid=False)
        for z in (0.68, 1.42):
            w.rod_x((y, z), (x - 0.01, x + 0.03), 0.009, metal, solid=False)
    w.box((x - 0.002, x + 0.005), (-0.40 * width, -0.22 * width), (1.02, 1.36), w.look("screen"), solid=False)


def larder_fridge(w: Workbench) -> None:
    """Builds a tall fridge with three drawers below one door and grips cut into the edges."""
    width, depth, height = w.width(0.58, 0.66), w.depth(0.60, 0.68), w.height(1.80, 2.00)
    look, x = w.look("appliance"), 0.5 * depth
    w.box((-x, x - 0.05), centred(width), (0.05, height), look)
    w.box((-x + 0.03, x - 0.09), centred(width, 0.02), (0.0, 0.05), w.look("dark"))
    levels = (0.06, 0.30, 0.52, 0.74, height)
    for low, high in itertools.pairwise(levels):
        w.box((x - 0.05, x), centred(width), (low + 0.012, high - 0.012), look, solid=low > 0.7)
        w.box(
            (x - 0.05, x - 0.03),
            centred(width, 0.005),
            (high - 0.012, high + (0.012 if high < height else 0.0)),
            w.look("char"),
            solid=False,
        )


def dishwasher(w: Workbench) -> None:
    """Builds a dishwasher with one flat door, a panel with buttons and a bar handle."""
    depth, height, look = w.depth(0.57, 0.61), w.height(0.84, 0.87), w.look("appliance")
    x = 0.5 * depth
    w.box((-x, x - 0.02), (-0.30, 0.30), (0.08, height), look)
    w.box((-x + 0.03, x - 0.07), (-0.28, 0.28), (0.0, 0.08), w.look("dark"))
    w.box((x - 0.02, x), (-0.296, 0.296), (0.10, height - 0.13), look, solid=False)
    w.box((x - 0.02, x - 0.003), (-0.296, 0.296), (height - 0.12, height - 0.005), w.look("dark"), solid=False)
    w.rod_y((x + 0.025, height - 0.18), (-0.25, 0.25), 0.010, w.look("chrome"), solid=False)
    for side in BOTH_SIDES:
        w.rod_x((side * 0.23, height - 0.18), (x - 0.005, x + 0.025), 0.008, w.look("chrome"), solid=False)
    for i in range(3):
        w.rod_x((0.10 + 0.05 * i, height - 0.06), (x - 0.01, x + 0.002), 0.012, look, solid=False)


def dishwasher_panelled(w: Workbench) -> None:
    """Builds a dishwasher with a frameless front, a hidden panel, a recessed grip and a light strip."""
    depth, height, look = w.depth(0.57, 0.61), w.height(0.84, 0.87), w.look("appliance")
    x = 0.5 * depth
    w.box((-x, x - 0.03), (-0.30, 0.30), (0.10, height), look)
    w.box((-x + 0.03, x - 0.10), (-0.28, 0.28), (0.0, 0.10), w.look("dark"))
    w.box((x - 0.03, x), (-0.298, 0.298), (0.11, height - 0.05), look, solid=False)
    w.box((x - 0.03, x - 0.012), (-0.298, 0.298), (height - 0.05, height - 0.02), w.look("char"), solid=False)
    w.box((x - 0.005, x + 0.004), (-0.10, 0.10), (0.60, 0.62), w.look("chrome"), solid=False)


def dryer(w: Workbench) -> None:
    """Builds a tumble dryer with a large round window and a panel with a display."""
    depth, height, look = w.depth(0.56, 0.62), w.height(0.84, 0.87), w.look("appliance")
    x = 0.5 * depth
    w.box((-x, x), (-0.30, 0.30), (0.03, height), look)
    w.legs((-x + 0.02, x - 0.02), (-0.28, 0.28), (0.0, 0.035), 0.04, w.look("dark"))
    w.rod_x((0.0, 0.41), (x - 0.005, x + 0.03), 0.23, w.look("dark"), solid=False)
    w.rod_x((0.0, 0.41), (x, x + 0.045), 0.15, w.look("glass"), solid=False)
    w.box((x - 0.003, x + 0.005), (-0.28, 0.28), (height - 0.11, height - 0.02), w.look("metal"), solid=False)
    w.box((x, x + 0.008), (-0.06, 0.10), (height - 0.095, height - 0.035), w.look("screen"), solid=False)
    w.rod_x((-0.20, height - 0.065), (x, x + 0.03), 0.028, w.look("dark"), solid=False)


STYLES = (
    Style("appliances", "fridge", "train", fridge, ("fridge",)),
    Style("appliances", "retro_fridge", "heldout", retro_fridge, ("fridge",)),
    Style("appliances", "stove", "train", stove, ("stove",)),
    Style("appliances", "range_cooker", "heldout", range_cooker, ("stove",)),
    Style("appliances", "front_loader", "train", front_loader, ("washing_machine",)),
    Style("appliances", "top_loader", "heldout", top_loader, ("washing_machine",)),
    Style("appliances", "two_door_fridge", "train", two_door_fridge, ("fridge",)),
    Style("appliances", "larder_fridge", "heldout", larder_fridge, ("fridge",)),
    Style("appliances", "dishwasher", "train", dishwasher, ("dishwasher",)),
    Style("appliances", "dishwasher_panelled", "heldout", dishwasher_panelled, ("dishwasher",)),
    Style("appliances", "dryer", "train", dryer, ("washing_machine",)),
)
