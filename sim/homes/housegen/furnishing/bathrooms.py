"""Bathrooms: tub or shower, toilet, basin with a mirror, towels."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from sim.homes.housegen.floor_plan.rectangles import SIDES
from sim.homes.housegen.furnishing.furniture_source import FurnitureSource
from sim.homes.housegen.furnishing.placement import Placement, RoomLayout
from sim.homes.housegen.furnishing.placement.records import zone_in_front
from sim.homes.housegen.furnishing.placement.walls import Along
from sim.homes.housegen.furnishing.steps import hang, hang_item_above, has_wall_above, lay_rug, place
from sim.world.room_arrangement import SHOWER_TO_WALL_M, TOILET_APART_M
from sim.world.room_requirements import GUEST_TOILET_M2

SMALL_M2 = 5.2
"""Smaller bathrooms get a shower rather than a bathtub, and seldom a wide washstand."""

ALONG: tuple[Along, ...] = ("any", "corner")
"""Positions of a toilet along its wall."""
MIRROR_WIDTHS_M = (None, 0.5, 0.4)
"""Widths of the mirror above a basin: any, and narrow ones where no wall has room for that."""
MAX_TRIES = 5
"""Largest number of times that the fixtures are placed, in two orders, to leave room for a basin with a mirror."""
RIGHT_ONLY = frozenset(("curved_cabin", "pentagon_cabin"))
"""Styles of showers with their open side on the left."""
FIXTURE_FRONT_M = 0.5
"""Floor kept free in front of a tub, a shower and a basin."""
TOILET_FRONT_M = 0.62
"""Free floor in front of a toilet; the check of the finished house asks for 0.6 m."""


def furnish_bathroom(layout: RoomLayout, source: FurnitureSource) -> None:
    """Places tub or shower in a corner first, then toilet, basin with a mirror above it, and towels."""
    area, before = layout.inner.area_m2, layout.snapshot()
    first, second = ("bathtub", "shower") if source.chance(0.5) and area > SMALL_M2 else ("shower", "bathtub")
    tub = basin = None
    for n in range(MAX_TRIES):
        layout.restore(before)
        kinds = (first, second) if n < 2 or area > SMALL_M2 else ()
        tub = _place_tub(layout, source, *kinds) if area >= GUEST_TOILET_M2 else None
        basin = _place_basin(layout, source) if n % 2 else None
        toilet = _place_toilet(layout, source, [fixture for fixture in (tub, basin) if fixture is not None])
        basin = basin or _place_basin(layout, source)
        if toilet is not None and basin is not None:
            break
    if basin is None:
        basin = place(layout, source, "sink", "standing", front_m=0.4, tries=3, width_m=0.45)
    if tub is not None and tub.item.category == first and area > 7.5:
        _place_in_corner(layout, source, second, tries=2)
    for _ in range(1 + source.chance(0.4)):
        hang(layout, source, "towel", "rail")
    if basin is not None and area > 9.5:
        _place_basin(layout, source)
    _place_small_items(layout, source, tub or basin)


def _place_tub(layout: RoomLayout, source: FurnitureSource, *categories: str) -> Placement | None:
    """Places a fixture of the first category that fits, a narrow shower where none does."""
    for category in categories:
        tub = _place_in_corner(layout, source, category, tries=3)
        if tub is not None:
            return tub
    left = partial(_fits_left_corner, layout)
    return place(layout, source, "shower", along="fitted", front_m=0.45, tries=3, width_m=0.8) or place(
        layout, source, "shower", along="corner", front_m=0.45, tries=3, fits=left, width_m=0.8
    )


def _fits_left_corner(layout: RoomLayout, shower: Placement) -> bool:
    """Returns whether a shower whose left side may be at a wall touches two walls."""
    gaps_m = [abs(shower.rect.line(side) - layout.inner.line(side)) for side in SIDES]
    return shower.item.style not in RIGHT_ONLY and sum(gap_m < SHOWER_TO_WALL_M for gap_m in gaps_m) > 1


def _place_in_corner(layout: RoomLayout, source: FurnitureSource, category: str, *, tries: int) -> Placement | None:
    """Places a tub or a shower with its right side at a wall; a tub that fits in no corner away from it."""
    fitted = place(layout, source, category, along="fitted", front_m=FIXTURE_FRONT_M, tries=tries)
    if fitted is not None or category == "shower":
        return fitted
    return place(layout, source, category, along="corner", front_m=FIXTURE_FRONT_M, tries=tries)


def _place_toilet(layout: RoomLayout, source: FurnitureSource, fixtures: Sequence[Placement]) -> Placement | None:
    """Places a toilet with free floor in front of it, and a gap to other fixtures and to what is placed later."""
    for fixture in fixtures:
        layout.reserve(fixture, [fixture.rect.grown(TOILET_APART_M)])
    toilet = place(layout, source, "toilet", along=source.pick(ALONG), front_m=TOILET_FRONT_M, tries=4)
    for fixture in fixtures:
        if fixture.side is not None:
            layout.release_zones(fixture)
            layout.reserve(fixture, [zone_in_front(fixture.rect, fixture.side, FIXTURE_FRONT_M)])
    if toilet is not None:
        layout.reserve(toilet, [toilet.rect.grown(TOILET_APART_M)])
    return toilet


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
    """Places a basin and a mirror above it: on a cabinet of its own or a free-standing one, narrow if no other fits.

    Returns None where no wall has room for both.
    """
    small = layout.inner.area_m2 < SMALL_M2
    uses = ("cabinet", "vanity") if source.chance(0.2 if small else 0.55) else ("sink", "standing")
    for width_m in MIRROR_WIDTHS_M:
        mirror = source.make("mirror", "wall", width_m=width_m)
        if mirror is None:
            continue
        above = partial(has_wall_above, layout, item=mirror)
        basin = (
            place(layout, source, *uses, front_m=0.6, tries=2, fits=above)
            or place(layout, source, "sink", "standing", front_m=0.5, tries=3, fits=above)
            or place(layout, source, "sink", "standing", front_m=0.4, tries=3, width_m=0.45, fits=above)
        )
        if basin is not None:
            hang_item_above(layout, source, basin, mirror)
            return basin
    return None
