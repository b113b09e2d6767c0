"""Curtains and blinds; hint `width_m` is their outer width."""

from __future__ import annotations

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, centred
from sim.homes.housegen.furniture.shapes import drape
from sim.homes.housegen.furniture.workbench import Workbench


def single_curtain(w: Workbench) -> None:
    """Builds one curtain of many folds on a flat track, drawn to one side."""
    width, height = w.width(1.4, 2.4), w.height(2.0, 2.3)
    w.box((0.0, 0.10), centred(width), (height - 0.03, height), w.look("metal"), solid=False)
    panel, side = w.length(0.3, 0.45) * width, w.choice((-1, 1))
    w.mesh(
        drape(panel, height - 0.03, 0.09, 9), (0.005, side * 0.5 * (width - panel), 0.0), w.look("curtain"), solid=False
    )


def roller_blind(w: Workbench) -> None:
    """Builds a half-drawn roller blind with a bar at its lower edge; it hangs from the top of the hinted height."""
    width, height = w.width(0.90, 1.60), w.height(1.00, 1.40)
    drawn = w.length(0.35, 0.75) * height
    w.rod_y((0.04, height - 0.03), centred(width), 0.028, w.look("metal"), solid=False)
    w.box(
        (0.038, 0.042), (-0.48 * width, 0.48 * width), (height - drawn, height - 0.03), w.look("curtain"), solid=False
    )
    w.box((0.03, 0.05), (-0.485 * width, 0.485 * width), around(height - drawn, 0.012), w.look("metal"), solid=False)
    for side in BOTH_SIDES:
        w.box((0.0, 0.06), around(side * 0.5 * width, 0.006), (height - 0.06, height), w.look("metal"), solid=False)


def slatted_blind(w: Workbench) -> None:
    """Builds a blind of horizontal slats under a head rail."""
    width, height = w.width(0.90, 1.60), w.height(1.00, 1.40)
    look = w.look("wood")
    w.box((0.0, 0.06), centred(width), (height - 0.05, height), look, solid=False)
    count = max(6, min(14, round(0.6 * height / 0.07)))
    for i in range(count):
        z = height - 0.08 - 0.065 * i
        w.box((0.005, 0.055), (-0.49 * width, 0.49 * width), around(z, 0.003), look, tilt=0.5, solid=False)
    for side in BOTH_SIDES:
        w.box(
            (0.028, 0.032),
            around(side * 0.35 * width, 0.008),
            (height - 0.09 - 0.065 * count, height - 0.05),
            w.look("linen"),
            solid=False,
        )


def curtain_pair(w: Workbench) -> None:
    """Builds two gathered curtains on a rod with knobs."""
    width, height = w.width(1.4, 2.4), w.height(2.0, 2.3)
    rod, cloth, half = w.look("iron"), w.look("curtain"), 0.5 * width - 0.022
    z = height - 0.022
    w.rod_y((0.08, z), (-half, half), 0.012, rod, solid=False)
    for side in (-1, 1):
        w.ball((0.08, side * half, z), 0.022, rod, solid=False)
        w.rod_x((side * (half - 0.08), z), (0.0, 0.08), 0.008, rod, solid=False)
        panel = 0.22 * width
        w.mesh(
            drape(panel, height - 0.03, 0.10, 5, gather=0.9),
            (0.03, side * (half - 0.03 - 0.5 * panel), 0.0),
            cloth,
            solid=False,
        )


def tied_back(w: Workbench) -> None:
    """Builds two curtains tied back at half height under a straight pelmet."""
    width, height = w.width(1.4, 2.4), w.height(2.0, 2.3)
    cloth, tie = w.look("curtain"), w.look("brass")
    w.box((0.0, 0.14), centred(width), (height - 0.16, height), cloth, solid=False)
    panel, waist = 0.26 * width, 0.42 * height
    for side in (-1, 1):
        edge = side * (0.5 * width - 0.02)
        upper, lower = (
            drape(panel, height - waist - 0.08, 0.10, 5, gather=0.45),
            drape(0.45 * panel, waist, 0.10, 5, gather=1.6),
        )
        w.mesh(upper, (0.015, edge - side * 0.5 * panel, waist), cloth, solid=False)
        w.mesh(lower, (0.015, edge - side * 0.5 * panel, 0.0), cloth, solid=False)
        w.box((0.0, 0.13), around(edge - side * 0.5 * panel, 0.26 * panel), around(waist, 0.03), tie, solid=False)


def sheer(w: Workbench) -> None:
    """Builds one thin translucent curtain over the whole width, hung by rings."""
    width, height = w.width(1.4, 2.4), w.height(2.0, 2.3)
    metal, cloth = w.look("metal"), w.look("sheer")
    z = height - 0.014
    w.rod_y((0.06, z), centred(width), 0.010, metal, solid=False)
    for side in (-1, 1):
        w.rod_x((side * (0.5 * width - 0.02), z), (0.0, 0.065), 0.014, metal, solid=False)
    w.mesh(drape(width - 0.04, height - 0.02, 0.07, 12), (0.025, 0.0, 0.0), cloth, solid=False)


def cafe(w: Workbench) -> None:
    """Builds a short gathered valance over two narrow curtains."""
    width, height = w.width(1.4, 2.4), w.height(2.0, 2.3)
    wood, cloth = w.look("wood"), w.look("curtain")
    z = height - 0.018
    w.rod_y((0.07, z), centred(width), 0.018, wood, solid=False)
    for side in (-1, 1):
        w.rod_x((side * (0.5 * width - 0.05), z), (0.0, 0.07), 0.010, wood, solid=False)
        panel = 0.17 * width
        w.mesh(
            drape(panel, height - 0.05, 0.08, 4),
            (0.005, side * (0.5 * width - 0.01 - 0.5 * panel), 0.0),
            cloth,
            solid=False,
        )
    w.mesh(drape(width - 0.02, 0.32, 0.06, 11), (0.085, 0.0, height - 0.34), w.new_look("curtain"), solid=False)


def venetian(w: Workbench) -> None:
    """Builds a blind of metal slats, partly let down."""
    width, height = w.width(0.90, 1.60), w.height(1.00, 1.40)
    look = w.look("lacquer")
    w.box((0.0, 0.05), centred(width), (height - 0.04, height), look, solid=False)
    count = w.whole(7, 13)
    for i in range(count):
        z = height - 0.07 - 0.055 * i
        w.box((0.004, 0.046), (-0.49 * width, 0.49 * width), around(z, 0.002), look, tilt=-0.6, solid=False)
    for side in (-1, 1):
        w.box(
            (0.024, 0.027),
            around(side * 0.38 * width, 0.004),
            (height - 0.07 - 0.055 * count, height - 0.04),
            w.look("linen"),
            solid=False,
        )
    w.box(
        (0.010, 0.040),
        (-0.49 * width, 0.49 * width),
        (height - 0.085 - 0.055 * count, height - 0.065 - 0.055 * count),
        look,
        solid=False,
    )


def roman(w: Workbench) -> None:
    """Builds a cloth blind drawn up in soft horizontal folds."""
    width, height = w.width(0.90, 1.60), w.height(1.00, 1.40)
    cloth = w.look("curtain")
    w.box((0.0, 0.045), centred(width), (height - 0.05, height), w.look("wood"), solid=False)
    drawn = w.length(0.35, 0.65) * height
    w.box((0.012, 0.030), (-0.49 * width, 0.49 * width), (height - drawn, height - 0.045), cloth, solid=False)
    for i in range(4):
        z = height - drawn + 0.05 * i + 0.02
        w.rod_y((0.035, z), (-0.49 * width, 0.49 * width), 0.026 - 0.003 * i, cloth, solid=False)


STYLES = (
    Style("curtain", "single", "heldout", single_curtain, (), "wall"),
    Style("curtain", "pair", "train", curtain_pair, (), "wall"),
    Style("blinds", "roller", "train", roller_blind, (), "wall"),
    Style("blinds", "slatted", "heldout", slatted_blind, (), "wall"),
    Style("curtain", "tied_back", "train", tied_back, (), "wall"),
    Style("curtain", "sheer", "train", sheer, (), "wall"),
    Style("curtain", "cafe", "heldout", cafe, (), "wall"),
    Style("blinds", "venetian", "train", venetian, (), "wall"),
    Style("blinds", "roman", "heldout", roman, (), "wall"),
)
