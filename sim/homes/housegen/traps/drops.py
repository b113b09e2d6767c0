"""Traps with a drop: an open stairwell, and a sunken area. A robot that drives over their edge falls."""

from __future__ import annotations

import math

from sim.core.geometry.pose import Pose
from sim.homes.housegen.floor_plan.rectangles import Rect
from sim.homes.housegen.traps.site import WOOD, Pit, TrapSite
from sim.homes.housegen.traps.trap import Trap
from sim.houses.sidecar import Sidecar

RISER_M, TREAD_M = 0.18, 0.26
"""Height and depth of the steps."""


def stairwell_edge() -> Trap:
    """A stairwell without a railing on the straight line to the goal; stairs lead down from its far end."""
    hole = Rect(2.9, 0.0, 5.9, 2.6)
    site = TrapSite("stairwell_edge", 9.0, 4.6, kind="hallway", pit=Pit(hole, 2.7))
    for step in range(1, 12):
        x = hole.x1 - step * TREAD_M
        site.box("stairs", (x, x + TREAD_M), (0.0, 1.1), (-2.7, -step * RISER_M), WOOD)
    site.furniture("bed", 7.8, 1.5, math.pi)
    return Trap(site, Sidecar(
        start=Pose(1.2, 1.6, 0.0), goal="bed", zone_m=(2.4, 0.0, 6.4, 3.1),
        reason="An open stairwell, 2.7 m deep and without a railing, lies before the goal; the path is beside it.",
    ))  # fmt: skip


def sunken_area() -> Trap:
    """An area 0.6 m lower across most of the hall, with a low block in it."""
    hole = Rect(3.2, 0.0, 6.2, 4.2)
    site = TrapSite("sunken_area", 9.5, 5.8, pit=Pit(hole, 0.6))
    site.box("objects", (4.2, 5.2), (1.2, 2.0), (-0.6, -0.2), WOOD)
    site.furniture("sofa", 8.9, 1.8, math.pi)
    return Trap(site, Sidecar(
        start=Pose(1.3, 1.8, 0.0), goal="sofa", zone_m=(2.7, 0.0, 6.7, 4.7),
        reason="A sunken area, 0.6 m lower, lies before the goal: depth shows no obstacle there; one side is level.",
    ))  # fmt: skip
