"""Variety of a home's furniture: designs, variants, small objects, and the middle of large rooms."""

from __future__ import annotations

import itertools
from collections import defaultdict
from functools import cache

import numpy as np
import pytest

from sim.homes.housegen.floor_plan import PlanError, draw_floor_plan
from sim.homes.housegen.floor_plan.rectangles import Rect
from sim.homes.housegen.furnishing import FurnishError, furnish
from sim.homes.housegen.furnishing.furniture_source import (
    MAX_ALIKE,
    REQUIRED,
    SETS,
    FurnitureSource,
    design_of,
    is_same_design,
)
from sim.homes.housegen.furnishing.placement import RoomLayout
from sim.homes.housegen.furniture import CATALOGUE
from sim.homes.housegen.furniture.item import Item, Pool
from sim.homes.housegen.structure.openings import cut_openings
from sim.homes.housegen.surfaces.materials import palettes

HOMES: tuple[tuple[Pool, int], ...] = (("train", 0), ("train", 1), ("heldout", 0), ("heldout", 1))
BARE_M = 2.0
"""Radius of bare floor that is too much; the doorways and the paths between them need some."""


@cache
def home(pool: Pool, seed: int, clutter: float = 0.6) -> tuple[RoomLayout, ...]:
    """Returns the furnished rooms of a home of about 150 m2."""
    for attempt in range(20):
        rng = np.random.default_rng([seed, attempt])
        try:
            plan = draw_floor_plan(rng, "corridor", 150.0, ("gym", "office"))
            openings = cut_openings(rng, plan)
            source = FurnitureSource(rng, pool, clutter, frozenset(room.kind for room in plan.rooms))
            rooms = [RoomLayout(n, room.kind, room.rect, openings, 2.6) for n, room in enumerate(plan.rooms)]
            for layout in rooms:
                furnish(layout, source)
        except (PlanError, FurnishError):
            continue
        return tuple(rooms)
    raise AssertionError("No plan fits.")


def items(rooms: tuple[RoomLayout, ...]) -> list[Item]:
    return [placement.item for layout in rooms for placement in layout.placements]


def small(rooms: tuple[RoomLayout, ...]) -> list[Item]:
    """Returns objects with the colours of a palette."""
    names = (*palettes("train"), *palettes("heldout"))
    found = [item for item in items(rooms) if item.category == "objects"]
    return [item for item in found if any(geom.look.texture in names for geom in item.geoms)]


def empty_room() -> RoomLayout:
    return RoomLayout(0, "bedroom", Rect(0.0, 0.0, 6.0, 6.0), (), 2.6)


@pytest.mark.costly
@pytest.mark.parametrize(("pool", "seed"), HOMES)
def test_no_design_stands_more_than_twice_in_a_home_outside_the_sets(pool, seed):
    sets = {(category, style.name) for category, use in SETS for style in CATALOGUE.styles(category, pool, use)}
    by_style = defaultdict(list)
    for item in items(home(pool, seed)):
        if (item.category, item.style) not in sets and item.category not in REQUIRED:
            by_style[item.category, item.style].append(design_of(item))
    for style, designs in by_style.items():
        for design in designs:
            assert sum(is_same_design(design, other) for other in designs) <= MAX_ALIKE, style


@pytest.mark.parametrize("pool", ["train", "heldout"])
def test_all_styles_of_a_use_come_before_one_is_repeated(pool):
    source = FurnitureSource(np.random.default_rng(0), pool, 0.5, frozenset())
    layout = empty_room()
    source.enter(layout)
    names = [style.name for style in CATALOGUE.styles("chair", pool, "arm")]
    seen = []
    for n in range(2 * len(names)):
        item = source.make("chair", "arm")
        assert item is not None
        assert source.has_unused("chair", "arm")
        seen.append(item.style)
        layout.add(placement(item, n), 0.0, 1.0)
    assert sorted(seen) == sorted(2 * names)
    assert sorted(seen[: len(names)]) == sorted(names)
    assert not source.has_unused("chair", "arm")


def placement(item: Item, number: int):
    from sim.homes.housegen.furnishing.placement.records import floor_placement

    return floor_placement(item, float(number), 0.0, 0.0)


def test_a_small_object_comes_in_the_colours_of_all_palettes_before_a_new_mesh_is_made():
    source = FurnitureSource(np.random.default_rng(0), "heldout", 0.5, frozenset())
    layout = empty_room()
    source.enter(layout)
    made = []
    for n in range(MAX_ALIKE * len(palettes("heldout"))):
        item = source.make("objects", "cable")
        assert item is not None
        made.append(item)
        layout.add(placement(item, n), 0.0, 0.1)
    assert len({item.geoms[0].mesh.name for item in made}) == 1
    assert {item.geoms[0].look.texture for item in made} == set(palettes("heldout"))


@pytest.mark.costly
def test_clutter_sets_the_number_of_small_objects():
    counts = [len(small(home("train", 0, clutter))) for clutter in (0.0, 0.4, 1.0)]
    assert counts[0] == 0
    assert counts[1] >= 10
    assert counts[2] > 1.5 * counts[1]


@pytest.mark.parametrize(("pool", "seed"), HOMES)
def test_large_rooms_are_not_bare_in_the_middle(pool, seed):
    for layout in home(pool, seed):
        if layout.kind in ("living_room", "bedroom", "gym", "office") and layout.inner.short_m > 3.5:
            assert layout.grid.widest_free()[0] < BARE_M, f"{layout.kind} of {layout.inner.area_m2:.0f} m2"


def test_flat_objects_on_the_floor_do_not_collide_and_the_others_do():
    for pool, use in itertools.product(("train", "heldout"), ("shoes", "bag", "toy", "box", "cable", "flat")):
        for style in CATALOGUE.styles("objects", pool, use):
            item = CATALOGUE.make_item("objects", np.random.default_rng(0), pool=pool, style=style.name)
            assert any(geom.solid for geom in item.geoms) != item.walk_over, style.name
            assert item.size_m[2] <= 0.03 or not item.walk_over, style.name
