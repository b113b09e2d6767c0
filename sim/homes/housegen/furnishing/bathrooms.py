"""Bathrooms: tub or shower, toilet, basin with a mirror, towels."""

from __future__ import annotations

from sim.homes.housegen.furnishing.furniture_source import FurnitureSource
from sim.homes.housegen.furnishing.placement import Placement, RoomLayout
from sim.homes.housegen.furnishing.placement.records import zone_in_front
from sim.homes.housegen.furnishing.placement.walls import Along
from sim.homes.housegen.furnishing.steps import hang, hang_above, lay_rug, place
from sim.world.room_arrangement import TOILET_APART_M
from sim.world.room_requirements import GUEST_TOILET_M2

SMALL_M2 = 5.2
"""Smaller bathrooms get a shower rather than a bathtub, and seldom a wide washstand."""

ALONG: tuple[Along, ...] = ("any", "corner")
"""Positions of a toilet along its wall."""
TUB_FRONT_M = 0.5
TOILET_FRONT_M = 0.62
"""Free floor in front of a toilet; the check of the finished house asks for 0.6 m."""


def furnish_bathroom(layout: RoomLayout, source: FurnitureSource) -> None:
    """Places tub or shower in a corner first, then toilet, basin, a mirror above it, and towels."""
    area = layout.inner.area_m2
    first, second = ("bathtub", "shower") if source.chance(0.5) and area > SMALL_M2 else ("shower", "bathtub")
    tub = None
    if area >= GUEST_TOILET_M2:
        tub = (
            place(layout, source, first, along="corner", front_m=0.5, tries=3)
            or place(layout, source, second, along="corner", front_m=0.5, tries=2)
            or place(layout, source, "shower", along="corner", front_m=0.45, tries=3, width_m=0.8)
        )
    _place_toilet(layout, source, tub)
    basin = _place_basin(layout, source)
    if tub is not None and tub.item.category == first and area > 7.5:
        place(layout, source, second, along="corner", front_m=0.5, tries=2)
    if basin is not None and not hang_above(layout, source, basin, "mirror"):
        hang(layout, source, "mirror")
    for _ in range(1 + source.chance(0.4)):
        hang(layout, source, "towel", "rail")
    if basin is not None and area > 9.5:
        second_basin = _place_basin(layout, source)
        if second_basin is not None:
            hang_above(layout, source, second_basin, "mirror")
    _place_small_items(layout, source, tub or basin)


def _place_toilet(layout: RoomLayout, source: FurnitureSource, tub: Placement | None) -> None:
    """Places a toilet with free floor in front of it, and a gap to the tub and to what is placed later."""
    if tub is not None:
        layout.reserve(tub, [tub.rect.grown(TOILET_APART_M)])
    along = source.pick(ALONG)
    toilet = place(layout, source, "toilet", along=along, front_m=TOILET_FRONT_M, tries=4)
    if tub is not None and tub.side is not None:
        layout.release_zones(tub)
        layout.reserve(tub, [zone_in_front(tub.rect, tub.side, TUB_FRONT_M)])
    if toilet is not None:
        layout.reserve(toilet, [toilet.rect.grown(TOILET_APART_M)])


def _place_small_items(layout: RoomLayout, source: FurnitureSource, mat_host: Placement | None) -> None:
    """Places a bath mat in front of `mat_host`, a towel rack, a stool and a bin, each with its own probability."""
    area = layout.inner.area_m2
    if area > 5.5 and source.chance(0.7) and mat_host is not None:
        x, y = mat_host.to_world(mat_host.item.size_m[0] / 2 + 0.38, 0.0)
        lay_rug(layout, source, x, y, mat_host.placed.yaw_rad, size_m=(0.55, 0.85))
    if area > 7 and source.chance(0.6):
        place(layout, source, "towel", "floor", front_m=0.3)
    if source.chance(0.4):
        place(layout, source, "stool", "low", along="corner", front_m=0.2)
    if source.clutter_chance(0.4):
        place(layout, source, "objects", "bin", along="corner", front_m=0.0)


def _place_basin(layout: RoomLayout, source: FurnitureSource) -> Placement | None:
    """Places a basin on a cabinet of its own, or a free-standing one; a narrow one if no other fits."""
    small = layout.inner.area_m2 < SMALL_M2
    uses = ("cabinet", "vanity") if source.chance(0.2 if small else 0.55) else ("sink", "standing")
    return (
        place(layout, source, *uses, front_m=0.6, tries=2)
        or place(layout, source, "sink", "standing", front_m=0.5, tries=3)
        or place(layout, source, "sink", "standing", front_m=0.4, tries=3, width_m=0.5)
    )
