"""Traps with obstacles that no camera shows: glass, and artifacts of scans."""

from __future__ import annotations

import itertools
import math

from sim.core.geometry.pose import Pose
from sim.homes.housegen.furniture.item import Geom
from sim.homes.housegen.traps.site import STEEL, TrapSite
from sim.homes.housegen.traps.trap import Trap
from sim.houses.sidecar import Sidecar


def glass_pane() -> Trap:
    """A pane across the hall, open at one end."""
    site = TrapSite("glass_pane", 8.0, 5.0)
    site.pane("window", (3.6, 0.0), (3.6, 4.0))
    site.furniture("bed", 6.6, 1.4, math.pi)
    return Trap(site, Sidecar(
        start=Pose(1.3, 1.4, 0.0), goal="bed", zone_m=(2.6, 0.0, 3.7, 4.0),
        reason="A glass pane across the room, invisible to depth; the way round is at its far end.",
    ))  # fmt: skip


def glass_pocket() -> Trap:
    """A U of glass, open towards the start, wider than the agent's collision marks."""
    site = TrapSite("glass_pocket", 9.0, 6.0)
    for begin, end in (((2.6, 2.0), (5.0, 2.0)), ((2.6, 4.0), (5.0, 4.0)), ((5.0, 2.0), (5.0, 4.0))):
        site.pane("window", begin, end)
    site.furniture("sofa", 8.3, 3.0, math.pi)
    return Trap(site, Sidecar(
        start=Pose(1.2, 3.0, 0.0), goal="sofa", zone_m=(2.6, 2.0, 5.0, 4.0),
        reason="A U-shaped pocket of glass, 2.4 m deep, open towards the start, on the straight way to the goal.",
    ))  # fmt: skip


def glass_maze() -> Trap:
    """Three panes, open at alternating ends."""
    site = TrapSite("glass_maze", 8.5, 3.6)
    site.pane("window", (2.4, 0.0), (2.4, 2.8))
    site.pane("window", (3.9, 0.8), (3.9, 3.6))
    site.pane("window", (5.4, 0.0), (5.4, 2.8))
    site.furniture("fireplace", 8.5, 1.2, math.pi)
    return Trap(site, Sidecar(
        start=Pose(1.0, 1.2, 0.0), goal="fireplace", zone_m=(1.6, 0.0, 5.5, 3.6),
        reason="Three glass panes in a row, open at alternating ends: a wrong turn has to be taken back.",
    ))  # fmt: skip


def glass_door_ajar() -> Trap:
    """A doorway with a glass leaf half open, and a free doorway farther off."""
    site = TrapSite("glass_door_ajar", 8.0, 6.0)
    site.wall_across(3.8, (0.9, 1.85), (4.5, 5.4))
    angle = math.radians(18.0)
    site.pane("door", (3.83, 0.92), (3.83 + 0.9 * math.sin(angle), 0.92 + 0.9 * math.cos(angle)))
    site.furniture("bed", 6.7, 1.4, math.pi)
    return Trap(site, Sidecar(
        start=Pose(1.3, 1.4, 0.0), goal="bed", zone_m=(3.1, 0.6, 4.6, 2.2),
        reason="A glass door stands 18 degrees ajar: the doorway looks open, the gap beside the leaf is too narrow.",
    ))  # fmt: skip


def dead_end_corridor() -> Trap:
    """A corridor that ends in glass, and an open one beside it."""
    site = TrapSite("dead_end_corridor", 9.0, 5.0, kind="hallway")
    site.wall((2.2, 6.2), (1.0, 1.1))
    site.wall((2.2, 6.2), (1.85, 1.95))
    site.wall((2.2, 2.3), (0.0, 1.0))
    site.wall((2.2, 2.3), (1.95, 3.9))
    site.pane("door", (5.9, 1.1), (5.9, 1.85))
    site.furniture("bed", 7.8, 1.5, math.pi)
    return Trap(site, Sidecar(
        start=Pose(1.0, 1.5, 0.0), goal="bed", zone_m=(2.2, 1.0, 6.0, 1.95),
        reason="A corridor 0.75 m wide and 3.7 m long ends in a closed glass door, with the goal in view behind it.",
    ))  # fmt: skip


def scan_artifact() -> Trap:
    """An invisible obstacle in a doorway."""
    site = TrapSite("scan_artifact", 8.0, 6.0)
    site.wall_across(3.8, (0.9, 2.1), (4.6, 5.5))
    site.invisible_box("misc", (3.55, 4.05), (1.22, 1.78), (0.0, 0.6), yaw_rad=0.3)
    site.furniture("sofa", 7.3, 1.5, math.pi)
    return Trap(site, Sidecar(
        start=Pose(1.3, 1.5, 0.0), goal="sofa", zone_m=(3.1, 0.6, 4.5, 2.4),
        reason="A scan left an invisible lump in a doorway of 1.2 m; what is left on either side is too narrow.",
    ))  # fmt: skip


def furniture_u() -> Trap:
    """Glass tables on thin legs that form a U, open towards the start."""
    site = TrapSite("furniture_u", 9.0, 6.0)
    for x, y, yaw in ((3.4, 2.1, 0.0), (4.8, 2.1, 0.0), (3.4, 3.9, 0.0), (4.8, 3.9, 0.0), (5.3, 3.0, math.pi / 2)):
        _glass_table(site, x, y, yaw)
    site.furniture("bed", 7.9, 3.0, math.pi)
    return Trap(site, Sidecar(
        start=Pose(1.2, 3.0, 0.0), goal="bed", zone_m=(2.7, 1.8, 5.6, 4.2),
        reason="Five glass-topped tables form a U open towards the start: depth sees their thin legs, not their tops.",
    ))  # fmt: skip


def hanging_shelf() -> Trap:
    """Glass shelves whose lower edges are at 0.80 m, below the robot's top."""
    site = TrapSite("hanging_shelf", 8.0, 5.0, kind="kitchen")
    site.invisible_box("shelving", (3.5, 3.8), (0.0, 3.9), (0.80, 0.82))
    for y in (0.6, 1.7, 2.8, 3.85):
        site.box("shelving", (3.64, 3.66), (y - 0.01, y + 0.01), (0.9, 2.5), STEEL, solid=False)
    site.furniture("bed", 6.6, 1.4, math.pi)
    return Trap(site, Sidecar(
        start=Pose(1.3, 1.4, 0.0), goal="bed", zone_m=(2.6, 0.0, 3.9, 3.9),
        reason="A glass shelf hangs at 0.80 m: the camera looks over it, the robot of 0.88 m does not fit under it.",
    ))  # fmt: skip


def glass_cell() -> Trap:
    """A cell of glass around the start, open away from the goal."""
    site = TrapSite("glass_cell", 9.0, 5.0)
    corners = [(2.0, 1.4), (4.4, 1.4), (4.4, 3.6), (2.0, 3.6)]
    for begin, end in itertools.pairwise(corners):
        site.pane("window", begin, end)
    site.pane("window", (2.0, 3.6), (2.0, 2.15))
    site.furniture("bed", 7.7, 2.5, math.pi)
    return Trap(site, Sidecar(
        start=Pose(3.2, 2.5, 0.0), goal="bed", zone_m=(2.0, 1.4, 4.4, 3.6),
        reason="The robot starts inside a cell of glass; its one opening, 75 cm wide, is behind it and to one side.",
    ))  # fmt: skip


def scan_forest() -> Trap:
    """Invisible posts in the middle of a hall."""
    site = TrapSite("scan_forest", 9.0, 4.6)
    for row in range(5):
        for i in range(7):
            x, y = 2.6 + 0.62 * row, 0.3 + 0.62 * i + (0.31 if row % 2 else 0.0)
            site.invisible_box("misc", (x - 0.02, x + 0.02), (y - 0.02, y + 0.02), (0.0, 1.2))
    site.furniture("bed", 7.8, 2.3, math.pi)
    return Trap(site, Sidecar(
        start=Pose(1.2, 2.1, 0.0), goal="bed", zone_m=(2.2, 0.0, 5.5, 4.6),
        reason="Invisible posts of 4 cm in staggered rows, 58 cm apart: each mark of a bump closes a gap that is open.",
    ))  # fmt: skip


def glass_comb() -> Trap:
    """Four pockets of glass side by side."""
    site = TrapSite("glass_comb", 9.5, 7.0)
    site.pane("window", (5.2, 1.0), (5.2, 6.0))
    for y in (1.0, 2.25, 3.5, 4.75, 6.0):
        site.pane("window", (3.0, y), (5.2, y))
    site.furniture("sofa", 8.8, 3.0, math.pi)
    return Trap(site, Sidecar(
        start=Pose(1.2, 3.0, 0.0), goal="sofa", zone_m=(2.7, 1.0, 5.2, 6.0),
        reason="Four glass pockets side by side, 2.2 m deep: a robot that leaves one meets the next one.",
    ))  # fmt: skip


def _glass_table(site: TrapSite, x: float, y: float, yaw_rad: float) -> None:
    """Adds a table of 1.4 x 0.5 m, 0.45 m high: four visible legs of 2 cm, an invisible top."""
    places = [(sx * 0.66, sy * 0.22) for sx in (-1, 1) for sy in (-1, 1)]
    site.add("table", [Geom("cylinder", (0.01, 0.215), (a, b, 0.215), STEEL) for a, b in places], x, y, yaw_rad)
    site.invisible_box("table", (x - 0.7, x + 0.7), (y - 0.25, y + 0.25), (0.43, 0.45), yaw_rad=yaw_rad)
