"""Traps with visible obstacles that are too thin, too low, too narrow, too near or too slippery."""

from __future__ import annotations

import math

from sim.core.geometry.pose import Pose
from sim.homes.housegen.furniture.item import Geom, Look
from sim.homes.housegen.traps.site import FABRIC, STEEL, WHITE, WOOD, TrapSite
from sim.homes.housegen.traps.trap import Trap
from sim.houses.sidecar import Sidecar

MIRROR = Look((0.75, 0.80, 0.84, 1.0), specular=1.0, shininess=1.0)
MIRROR_NOISE = {"depth": {"hole_share": 1.0}}
"""Depth has no return from a perfect mirror."""


def chair_legs() -> Trap:
    """A row of stools: the robot fits between the seats but not between the star feet."""
    site = TrapSite("chair_legs", 8.0, 4.4, kind="dining_room")
    for i in range(5):
        _star_seat(site, "stool", (3.4, 0.42 + 0.72 * i), seat_radius=0.14, reach=0.33, height=0.68)
    site.furniture("bed", 6.9, 1.8, math.pi)
    return Trap(site, Sidecar(
        start=Pose(1.3, 1.6, 0.0), goal="bed", zone_m=(2.6, 0.0, 3.9, 3.8),
        reason="A row of stools: 44 cm are free between the seats, but their thin star feet, 6 cm high, leave no way.",
    ))  # fmt: skip


def narrow_gap() -> Trap:
    """Columns with gaps a little narrower than the robot."""
    site = TrapSite("narrow_gap", 8.0, 5.0)
    gap, width, ledge = 0.34, 0.22, 0.06
    y = 0.0
    while y + width < 4.1:
        site.box("column", (3.5, 3.72), (y, y + width), (0.0, 2.5), WHITE)
        site.box("column", (3.5 - ledge, 3.72 + ledge), (y - ledge, y + width + ledge), (0.0, 0.08), WHITE)
        y += width + gap + 2 * ledge
    site.furniture("bed", 6.7, 1.6, math.pi)
    return Trap(site, Sidecar(
        start=Pose(1.3, 1.6, 0.0), goal="bed", zone_m=(3.0, 0.0, 3.9, 4.3),
        reason="Columns 46 cm apart look passable; their plinths, 8 cm high, leave 34 cm, and the robot is 36 cm wide.",
    ))  # fmt: skip


def low_slab() -> Trap:
    """Slabs below the obstacle band around the start."""
    site = TrapSite("low_slab", 8.5, 5.0)
    height = (0.0, 0.05)
    site.box("objects", (3.4, 3.6), (0.6, 4.4), height, WOOD)
    site.box("objects", (1.9, 3.4), (4.2, 4.4), height, WOOD)
    site.box("objects", (1.9, 3.4), (0.6, 0.8), height, WOOD)
    site.furniture("sofa", 7.8, 2.5, math.pi)
    return Trap(site, Sidecar(
        start=Pose(1.4, 2.5, 0.0), goal="sofa", zone_m=(1.9, 0.8, 3.4, 4.2),
        reason="Planks of 5 cm lie as a U open to the start: too high for wheels, too low for the obstacle band.",
    ))  # fmt: skip


def slippery_floor() -> Trap:
    """A closed glass door behind a wet floor, and an open doorway."""
    site = TrapSite("slippery_floor", 8.0, 6.0, kind="bathroom")
    site.wall_across(4.0, (0.9, 2.1), (4.6, 5.5))
    site.slippery_floor((2.5, 4.6), (0.6, 2.4), 0.03)
    site.pane("door", (4.0, 0.9), (4.0, 2.1))
    site.furniture("bathtub", 7.0, 1.5, math.pi)
    return Trap(site, Sidecar(
        start=Pose(1.2, 1.5, 0.0), goal="bathtub", zone_m=(2.5, 0.6, 4.6, 2.4),
        reason="Soapy tiles before a closed glass door: wheels spin, and on the way back short moves look like bumps.",
    ))  # fmt: skip


def wedged_spawn() -> Trap:
    """A start between sofa and table, nearer to both than the smallest depth."""
    site = TrapSite("wedged_spawn", 8.0, 4.0)
    site.add("sofa", [
        Geom("box", (0.40, 1.1, 0.21), (-0.40, 0.0, 0.21), FABRIC),
        Geom("box", (0.10, 1.1, 0.40), (-0.70, 0.0, 0.40), FABRIC),
    ], 2.73, 1.5)  # fmt: skip
    site.box("table", (3.27, 3.9), (0.5, 2.6), (0.36, 0.40), WOOD)
    places = [(x, y) for x in (3.30, 3.87) for y in (0.55, 2.55)]
    site.posts("table", places, 0.02, (0.0, 0.36), WOOD)
    site.box("chair", (2.75, 3.25), (0.3, 0.6), (0.0, 0.42), FABRIC)
    site.furniture("bed", 6.9, 1.3, math.pi)
    return Trap(site, Sidecar(
        start=Pose(3.0, 0.9, 0.0), goal="bed", zone_m=(2.7, 0.3, 3.5, 2.5),
        reason="Spawned in the 54 cm between a sofa and a low table: all of it is nearer than depth begins.",
    ))  # fmt: skip


def chair_in_doorway() -> Trap:
    """A chair in a doorway that leaves a gap a little too narrow."""
    site = TrapSite("chair_in_doorway", 8.0, 6.0, kind="dining_room")
    site.wall_across(3.8, (0.9, 1.85), (4.6, 5.5))
    _star_seat(site, "chair", (3.8, 1.2), seat_radius=0.18, reach=0.33, height=0.46, back=True)
    site.furniture("bed", 6.7, 1.5, math.pi)
    return Trap(site, Sidecar(
        start=Pose(1.3, 1.5, 0.0), goal="bed", zone_m=(3.0, 0.6, 4.4, 2.0),
        reason="An office chair pushed into a doorway: 47 cm are free beside its seat, 32 cm beside its star foot.",
    ))  # fmt: skip


def mirror_holes() -> Trap:
    """Mirrors where depth has holes."""
    site = TrapSite("mirror_holes", 8.5, 5.0, kind="bedroom")
    site.box("mirror", (3.6, 3.65), (0.0, 3.9), (0.0, 2.2), MIRROR)
    site.box("mirror", (2.2, 3.6), (3.85, 3.9), (0.0, 2.2), MIRROR)
    site.furniture("bed", 6.9, 1.6, math.pi)
    return Trap(site, Sidecar(
        start=Pose(1.3, 1.6, 0.0), goal="bed", zone_m=(2.2, 0.0, 3.7, 3.9), noise=MIRROR_NOISE,
        reason="Wardrobe mirrors from floor to shoulder: depth has holes on them, so the map shows open floor.",
    ))  # fmt: skip


def string_curtain() -> Trap:
    """Strings that depth shows in some pixels only."""
    site = TrapSite("string_curtain", 8.5, 4.4)
    for x, (low, high) in ((2.8, (0.15, 3.3)), (4.4, (1.1, 4.3))):
        count = round((high - low) / 0.25)
        places = [(x, low + (high - low) * i / count) for i in range(count + 1)]
        site.posts("curtain", places, 0.0005, (0.0, 2.4), WHITE)
    site.furniture("bed", 7.2, 2.2, math.pi)
    return Trap(site, Sidecar(
        start=Pose(1.2, 1.6, 0.0), goal="bed", zone_m=(2.0, 0.0, 4.6, 4.4),
        reason="Two curtains of taut strings of 1 mm, 25 cm apart: thinner than a pixel, each open at another end.",
    ))  # fmt: skip


def _star_seat(
    site: TrapSite, category: str, at: tuple[float, float], *, seat_radius: float, reach: float, height: float,
    back: bool = False,
) -> None:  # fmt: skip
    """Adds a round seat on a stem with four thin feet, 6 cm high, along x and y, that extend beyond the seat."""
    geoms = [
        Geom("cylinder", (seat_radius, 0.02), (0.0, 0.0, height), FABRIC),
        Geom("cylinder", (0.015, 0.5 * height), (0.0, 0.0, 0.5 * height), STEEL),
        Geom("box", (reach, 0.012, 0.012), (0.0, 0.0, 0.05), STEEL),
        Geom("box", (0.012, reach, 0.012), (0.0, 0.0, 0.05), STEEL),
    ]
    if back:
        geoms.append(Geom("box", (0.02, 0.9 * seat_radius, 0.2), (-0.9 * seat_radius, 0.0, height + 0.2), FABRIC))
    site.add(category, geoms, *at)
