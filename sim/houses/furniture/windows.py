"""What hangs before windows: curtains and blinds; hint `width_m` is their outer width."""

from __future__ import annotations

from sim.houses.furniture.catalogue import Style
from sim.houses.furniture.shapes import (
    drape,
)
from sim.houses.furniture.workbench import Workbench

_BOTH = (-1, 1)


def single_curtain(w: Workbench) -> None:
    """One panel of many folds, drawn to one side, on a flat track."""
    width, height = w.width(1.4, 2.4), w.height(2.0, 2.3)
    w.box((0.0, 0.10), (-0.5 * width, 0.5 * width), (height - 0.03, height), w.look("metal"), solid=False)
    panel, side = w.length(0.3, 0.45) * width, w.choice((-1, 1))
    w.mesh(
        drape(panel, height - 0.03, 0.09, 9), (0.005, side * 0.5 * (width - panel), 0.0), w.look("curtain"), solid=False
    )


def curtain_pair(w: Workbench) -> None:
    """Two gathered panels on a rod."""
    width, height = w.width(1.4, 2.4), w.height(2.0, 2.3)
    rod, cloth = w.look("iron"), w.look("curtain")
    w.rod((0.08, -0.5 * width, height - 0.02), (0.08, 0.5 * width, height - 0.02), 0.012, rod, solid=False)
    for side in (-1, 1):
        w.ball((0.08, side * 0.5 * width, height - 0.02), 0.022, rod, solid=False)
        w.rod(
            (0.0, side * (0.5 * width - 0.08), height - 0.02),
            (0.08, side * (0.5 * width - 0.08), height - 0.02),
            0.008,
            rod,
            solid=False,
        )
        panel = 0.22 * width
        w.mesh(
            drape(panel, height - 0.03, 0.10, 5, gather=0.9),
            (0.03, side * (0.5 * width - 0.03 - 0.5 * panel), 0.0),
            cloth,
            solid=False,
        )


def roller_blind(w: Workbench) -> None:
    """Cloth roll half drawn, bar at its lower edge; hangs from the top of the hinted height."""
    width, height = w.width(0.90, 1.60), w.height(1.00, 1.40)
    drawn = w.length(0.35, 0.75) * height
    w.rod((0.04, -0.5 * width, height - 0.03), (0.04, 0.5 * width, height - 0.03), 0.028, w.look("metal"), solid=False)
    w.box(
        (0.038, 0.042), (-0.48 * width, 0.48 * width), (height - drawn, height - 0.03), w.look("curtain"), solid=False
    )
    w.box(
        (0.03, 0.05),
        (-0.485 * width, 0.485 * width),
        (height - drawn - 0.012, height - drawn + 0.012),
        w.look("metal"),
        solid=False,
    )
    for side in _BOTH:
        w.box(
            (0.0, 0.06),
            (side * 0.5 * width - 0.006, side * 0.5 * width + 0.006),
            (height - 0.06, height),
            w.look("metal"),
            solid=False,
        )


def slatted_blind(w: Workbench) -> None:
    """Horizontal slats under a head rail."""
    width, height = w.width(0.90, 1.60), w.height(1.00, 1.40)
    look = w.look("wood")
    w.box((0.0, 0.06), (-0.5 * width, 0.5 * width), (height - 0.05, height), look, solid=False)
    count = max(6, min(14, round(0.6 * height / 0.07)))
    for i in range(count):
        z = height - 0.08 - 0.065 * i
        w.box((0.005, 0.055), (-0.49 * width, 0.49 * width), (z - 0.003, z + 0.003), look, tilt=0.5, solid=False)
    for side in _BOTH:
        w.box(
            (0.028, 0.032),
            (side * 0.35 * width - 0.008, side * 0.35 * width + 0.008),
            (height - 0.09 - 0.065 * count, height - 0.05),
            w.look("linen"),
            solid=False,
        )


STYLES = (
    Style("curtain", "single", "heldout", single_curtain, (), "wall"),
    Style("curtain", "pair", "train", curtain_pair, (), "wall"),
    Style("blinds", "roller", "train", roller_blind, (), "wall"),
    Style("blinds", "slatted", "heldout", slatted_blind, (), "wall"),
)
