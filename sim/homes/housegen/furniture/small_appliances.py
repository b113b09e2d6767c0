"""Appliances on tops and walls: hobs, hoods, small ovens, coffee machines, toasters.

Usual retail dimensions (hobs 0.58 x 0.51 m, microwaves 0.46-0.52 m wide, hoods 0.60-0.80 m wide).
"""

from __future__ import annotations

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, centred
from sim.homes.housegen.furniture.shapes import chamfered_box, named_mesh
from sim.homes.housegen.furniture.workbench import Workbench


def hob(w: Workbench) -> None:
    """Builds a glass plate with four zones, for a worktop."""
    w.box((-0.25, 0.25), (-0.29, 0.29), (0.0, 0.008), w.look("screen"))
    for x in (-0.11, 0.11):
        for side in BOTH_SIDES:
            w.cylinder((x, side * 0.14), (0.008, 0.011), 0.09 if x * side < 0 else 0.07, w.look("iron"), solid=False)


def gas_hob(w: Workbench) -> None:
    """Builds a steel plate with four burners under cast grids and a row of knobs."""
    steel, iron = w.look("steel"), w.look("iron")
    w.box((-0.25, 0.25), (-0.29, 0.29), (0.0, 0.010), steel)
    for x in (-0.14, 0.08):
        for side in BOTH_SIDES:
            w.cylinder((x, side * 0.14), (0.010, 0.022), 0.055, w.look("chrome"), solid=False)
            w.cylinder((x, side * 0.14), (0.022, 0.034), 0.04, iron, solid=False)
    for side in BOTH_SIDES:
        w.box((-0.23, 0.17), around(side * 0.14, 0.006), (0.010, 0.045), iron, solid=False)
        w.cylinder((0.21, side * 0.10), (0.010, 0.035), 0.018, w.look("chrome"), solid=False)
    for x in (-0.14, 0.08):
        w.box(around(x, 0.006), (-0.25, 0.25), (0.010, 0.045), iron, solid=False)


def microwave(w: Workbench) -> None:
    """Builds a microwave oven with a dark window, a keypad and a handle."""
    look = w.look("appliance")
    width, depth, height = w.length(0.46, 0.52), w.length(0.34, 0.40), w.length(0.26, 0.30)
    x = 0.5 * depth
    w.mesh(chamfered_box((depth, width, height), 0.008), (0.0, 0.0, 0.5 * height), look)
    w.box((x - 0.002, x + 0.006), centred(width, 0.03, 0.14), (0.04, height - 0.04), w.look("screen"), solid=False)
    w.box(
        (x - 0.002, x + 0.004),
        (0.5 * width - 0.11, 0.5 * width - 0.02),
        (0.04, height - 0.04),
        w.look("dark"),
        solid=False,
    )
    w.box(
        (x, x + 0.03), (0.5 * width - 0.135, 0.5 * width - 0.12), (0.05, height - 0.05), w.look("chrome"), solid=False
    )


def toaster_oven(w: Workbench) -> None:
    """Builds a small oven with a glass door and three knobs."""
    look, metal = w.look("appliance"), w.look("chrome")
    w.mesh(chamfered_box((0.32, 0.42, 0.23), 0.02), (0.0, 0.0, 0.125), look)
    w.legs((-0.13, 0.13), (-0.18, 0.18), (0.0, 0.02), 0.03, w.look("rubber"))
    w.box((0.155, 0.166), (-0.19, 0.10), (0.05, 0.21), w.look("screen"), solid=False)
    w.rod_y((0.18, 0.20), (-0.17, 0.08), 0.008, metal, solid=False)
    w.box((0.16, 0.182), (-0.16, -0.15), (0.195, 0.205), metal, solid=False)
    w.box((0.16, 0.182), (0.06, 0.07), (0.195, 0.205), metal, solid=False)
    for z in (0.07, 0.125, 0.18):
        w.rod_x((0.155, z), (0.15, 0.178), 0.018, metal, solid=False)


def range_hood(w: Workbench) -> None:
    """Builds a chimney hood above a hob."""
    width, metal = w.width(0.58, 0.62), w.look("steel")
    w.mount_height_m = 1.55
    hood = [
        (0.0, -0.5 * width, 0.0),
        (0.50, -0.5 * width, 0.0),
        (0.0, -0.5 * width, 0.06),
        (0.50, -0.5 * width, 0.06),
        (0.0, -0.14, 0.30),
        (0.26, -0.14, 0.30),
    ]
    w.mesh(named_mesh("hood", hood + [(x, -y, z) for x, y, z in hood]), (0.0, 0.0, 0.0), metal)
    w.box((0.0, 0.26), (-0.14, 0.14), (0.29, 0.85), metal)
    for i in range(3):
        w.rod_x((0.10 + 0.05 * i, 0.03), (0.495, 0.505), 0.010, w.look("dark"), solid=False)


def slanted_hood(w: Workbench) -> None:
    """Builds a slanted glass hood."""
    width = w.width(0.58, 0.80)
    w.mount_height_m = 1.45
    w.box((0.0, 0.18), (-0.15, 0.15), (0.10, 0.80), w.look("dark"))
    w.bar((0.03, 0.0, 0.47), (0.36, 0.0, 0.06), width, 0.02, w.look("screen"))
    w.bar((0.05, 0.0, 0.42), (0.32, 0.0, 0.09), width - 0.10, 0.05, w.look("dark"))


def coffee_machine(w: Workbench) -> None:
    """Builds an espresso machine with a cup."""
    look, metal = w.look("appliance"), w.look("chrome")
    w.mesh(chamfered_box((0.16, 0.26, 0.36), 0.015), (-0.10, 0.0, 0.18), look)
    w.mesh(chamfered_box((0.36, 0.26, 0.04), 0.01), (0.0, 0.0, 0.02), look)
    w.mesh(chamfered_box((0.30, 0.26, 0.10), 0.015), (-0.03, 0.0, 0.31), look)
    w.cylinder((0.05, 0.0), (0.22, 0.265), 0.035, metal, solid=False)
    w.rod((0.06, 0.0, 0.235), (0.19, 0.0, 0.225), 0.012, w.look("dark"), solid=False)
    w.cylinder((0.05, 0.0), (0.04, 0.10), 0.035, w.look("ceramic"), solid=False)


def toaster(w: Workbench) -> None:
    """Builds a two-slot toaster with a lever."""
    look = w.look("appliance")
    w.mesh(chamfered_box((0.17, 0.28, 0.19), 0.04), (0.0, 0.0, 0.105), look)
    w.legs((-0.06, 0.06), (-0.11, 0.11), (0.0, 0.015), 0.025, w.look("rubber"))
    for x in (-0.03, 0.03):
        w.box(around(x, 0.012), (-0.10, 0.10), (0.19, 0.204), w.look("char"), solid=False)
    w.box((-0.02, 0.02), (0.135, 0.165), (0.12, 0.14), w.look("dark"), solid=False)


STYLES = (
    Style("appliances", "hob", "train", hob, ("hob",), "top"),
    Style("appliances", "gas_hob", "heldout", gas_hob, ("hob",), "top"),
    Style("appliances", "microwave", "train", microwave, ("microwave",), "top"),
    Style("appliances", "toaster_oven", "heldout", toaster_oven, ("microwave",), "top"),
    Style("appliances", "hood_chimney", "train", range_hood, ("hood",), "wall"),
    Style("appliances", "hood_slanted", "heldout", slanted_hood, ("hood",), "wall"),
    Style("appliances", "coffee_machine", "train", coffee_machine, ("small",), "top"),
    Style("appliances", "toaster", "heldout", toaster, ("small",), "top"),
)
