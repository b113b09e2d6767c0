"""Conformance tests of generated houses, the same for every seed."""

from __future__ import annotations

import contextlib
import functools
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.core.errors import HouseError
from sim.core.interface import ConfigError
from sim.gl import mujoco
from sim.homes.housegen import generate
from sim.homes.housegen.config import parse_area
from sim.homes.housegen.floor_plan import PlanError
from sim.homes.housegen.floor_plan.rectangles import Rect
from sim.homes.housegen.floor_plan.rooms import PLAN_AREA_M2, draw_plan_kind
from sim.homes.housegen.furnishing.placement import RoomLayout
from sim.homes.housegen.furnishing.placement.floor import put_against_wall
from sim.homes.housegen.furnishing.placement.on_walls import hang_on_wall
from sim.homes.housegen.furniture import CATALOGUE
from sim.homes.housegen.generator import (
    MAX_TRIES,
    GeneratedHouse,
    HouseConfig,
    _draw_plan,
    _draw_size,
    _draw_storeys,
    generate_house,
)
from sim.homes.housegen.splits.recipes import SPLITS, Recipe
from sim.homes.housegen.structure.openings import HALF_WALL_M, plan_rule_faults
from sim.houses.geoms import data_at_rest, world_boxes
from sim.houses.hazards import read_hazards
from sim.houses.house import House, read_rooms
from sim.houses.labels import read_labels
from sim.houses.load import load_house, validate_house
from sim.houses.writing import write_house
from sim.world.check import check_house, is_part_of
from sim.world.leaves import hinged_leaves
from sim.world.plan_requirements import measured
from sim.world.standing import is_in, read_standing
from sim.world.world import World
from tests.helpers import wording
from tests.helpers.sampling import sample

SEEDS = list(range(30))


@pytest.mark.costly
@pytest.mark.parametrize("seed", sample(SEEDS, 2))
def test_any_seed_gives_a_house_in_the_format_that_passes_the_check(seed: int) -> None:
    house = generate_house(seed, HouseConfig(pool="heldout" if seed % 2 else "train"))
    model = house.spec.compile()
    labels = validate_house(House("fresh", house.spec), model)
    assert labels.void_geoms == 0
    assert check_house(house.spec) == []
    assert len(read_rooms(model)) == len(house.plan.rooms)
    lamps = model.light_pos[model.light_type != mujoco.mjtLightType.mjLIGHT_DIRECTIONAL.value]
    assert model.nlight - len(lamps) == 4  # shine everywhere; OpenGL has eight
    for room in read_rooms(model):
        assert any(room.contains(x, y) for x, y, _ in lamps.tolist()), room.name


@functools.cache
def small(seed: int) -> GeneratedHouse:
    return generate_house(seed, HouseConfig(kind="studio", area_m2=55.0))


@pytest.mark.costly
def test_the_same_seed_gives_the_same_bytes_in_another_process() -> None:
    code = "from sim.homes.housegen import generate; print(generate(3, kind='studio', area_m2=55.0).to_xml(), end='')"
    other = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert small(3).spec.to_xml() == other


@pytest.mark.slow
def test_a_reshaped_house_is_in_the_format() -> None:
    house = generate_house(4, HouseConfig(reshape=True, kind="large", area_m2=300.0))
    assert validate_house(House("reshaped", house.spec), house.spec.compile()).void_geoms == 0
    assert check_house(house.spec) == []


@pytest.mark.costly
@pytest.mark.parametrize("area_m2", [52.0, 90.0, 200.0, 500.0])
def test_the_area_and_the_rooms_that_are_asked_for_are_met(area_m2: float) -> None:
    config = HouseConfig(area_m2=area_m2, rooms=("office",) if area_m2 > 80.0 else ())
    for seed in range(2 if area_m2 > 300.0 else 6):
        rng = np.random.default_rng(seed)
        plan, _ = _draw_plan(rng, draw_plan_kind(rng, area_m2), area_m2, config)
        inner_m2 = sum(room.rect.grown(-HALF_WALL_M).area_m2 for room in plan.rooms)
        assert plan.area_m2 == pytest.approx(area_m2, rel=0.05)
        assert inner_m2 == pytest.approx(area_m2, rel=0.05)
        assert set(config.rooms) <= {room.kind for room in plan.rooms}


@pytest.mark.parametrize("area_m2", [82.0, 120.0])
def test_rooms_that_are_asked_for_count_those_that_a_home_has_anyway(area_m2: float) -> None:
    config = HouseConfig(area_m2=area_m2, rooms=("bathroom", "bathroom", "living_room", "kitchen"))
    numbers = []
    for seed in range(8):
        rng = np.random.default_rng(seed)
        plan, _ = _draw_plan(rng, draw_plan_kind(rng, area_m2), area_m2, config)
        counts = Counter(room.kind for room in plan.rooms)
        assert counts["kitchen"] == 1
        assert counts["bedroom"] >= 1
        numbers.append(counts["bathroom"])
    assert min(numbers) == 2, "two bathrooms in all, not two more"
    assert max(numbers) <= 3


def test_the_area_is_drawn_from_a_range() -> None:
    config = HouseConfig(area_m2=(80.0, 120.0))
    areas = [_draw_size(np.random.default_rng(seed), config)[0] for seed in range(30)]
    assert 80.0 <= min(areas) < 90.0
    assert 110.0 < max(areas) <= 120.0


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"area_m2": 12.0}, "50-800 m2, got 12"),
        ({"area_m2": 300.0, "kind": "studio"}, "kind 'studio' has 50-68 m2"),
        ({"kind": "castle"}, "studio, flat"),
        ({"rooms": ("gym",), "kind": "studio"}, wording.NO_PLACE_FOR_FURTHER_ROOMS),
        ({"rooms": ("ballroom",)}, "'ballroom'"),
        ({"area_m2": (120.0, 80.0)}, "smaller to a larger area, got 120:80"),
        ({"area_m2": (30.0, 80.0)}, "50-800 m2, got 30:80"),
        ({"area_m2": (60.0, 200.0), "kind": "flat"}, "62-130 m2, got 60:200"),
        ({"rooms": ("laundry", "laundry")}, "at most 1 of the kind 'laundry', got 2"),
        ({"rooms": ("hallway",)}, "unknown kind 'hallway'"),
    ],
)
def test_a_request_that_cannot_be_met_is_refused(fields: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        HouseConfig(**fields)


def test_a_negative_seed_and_an_unknown_option_are_refused() -> None:
    with pytest.raises(ConfigError, match=r"0.*-1"):
        generate_house(-1)
    with pytest.raises(ConfigError, match="no option 'area'"):
        generate(0, area=70.0)


def test_an_area_is_read_from_the_command_line() -> None:
    assert parse_area("90") == 90.0
    assert parse_area("80:120") == (80.0, 120.0)
    for text in ("large", "80:", "80:100:120", ""):
        with pytest.raises(ConfigError, match="80:120"):
            parse_area(text)


RECIPES = [recipe for recipes in SPLITS.values() for recipe in recipes]


@pytest.mark.parametrize("recipe", sample(RECIPES, 8), ids=lambda recipe: recipe.name)
def test_every_recipe_has_a_plan_without_a_fault(recipe: Recipe) -> None:
    config = recipe.config()
    for attempt in range(MAX_TRIES):
        rng = np.random.default_rng([recipe.seed, attempt])
        with contextlib.suppress(PlanError):
            plan, openings, stairs = _draw_storeys(rng, recipe.kind, recipe.area_m2, config)
            break
    else:
        pytest.fail("no plan")
    further = [(stairs.plan, stairs.openings)] if stairs is not None else []
    assert plan_rule_faults(plan, openings, *further) == []
    assert not Counter(config.rooms) - Counter(room.kind for room in plan.rooms)


def test_a_written_house_is_read_from_its_folder_wherever_that_is(tmp_path: Path) -> None:
    written = write_house(small(3).spec.copy(), tmp_path / "first", "home")
    moved = (tmp_path / "first").rename(tmp_path / "second") / written.name
    house = load_house(moved)
    assert house.name == "home"
    assert all((moved.parent / "textures" / texture.file).is_file() for texture in house.spec.textures if texture.file)


@pytest.mark.parametrize("split", list(SPLITS))
def test_recipes_have_different_seeds_and_sizes_that_suit_their_kind(split: str) -> None:
    recipes = SPLITS[split]
    assert len({recipe.seed for recipe in recipes}) == len(recipes)
    assert len({recipe.name for recipe in recipes}) == len(recipes)
    for recipe in recipes:
        low, high = PLAN_AREA_M2[recipe.kind]
        assert low <= recipe.area_m2 <= high


def test_items_are_inside_rooms() -> None:
    model = small(4).spec.compile()
    data = data_at_rest(model)
    rooms = read_rooms(model)
    labels = read_labels(model)
    for instance in labels.instances:
        if instance.category in ("wall", "floor", "ceiling", "door", "window"):
            continue
        x, y, _ = np.mean(data.geom_xpos[list(instance.geom_ids)], axis=0)
        assert any(room.contains(x, y) for room in rooms), instance.name


def test_a_picture_high_above_a_bed_blocks_no_other_position() -> None:
    rng = np.random.default_rng(0)
    layout = RoomLayout(0, "bedroom", Rect(0.0, 0.0, 5.0, 5.0), [], 2.6)
    bed = CATALOGUE.make_item("bed", rng, pool="train", width_m=1.8)
    picture = CATALOGUE.make_item("picture", rng, pool="train", width_m=0.3)
    assert put_against_wall(layout, rng, bed, sides=["west"], along="middle") is not None
    assert hang_on_wall(layout, rng, picture, sides=["west"], at=2.5, bottom_m=1.7) is not None
    wardrobe = CATALOGUE.make_item("cabinet", rng, pool="train", use="wardrobe")
    assert put_against_wall(layout, rng, wardrobe, sides=["east"]) is not None


def test_a_house_that_breaks_the_format_does_not_replace_a_file(tmp_path: Path) -> None:
    (tmp_path / "mine.xml").write_text("kept")
    spec = mujoco.MjSpec.from_string(
        '<mujoco><worldbody><geom name="table_00" size="1 1 1" type="box"/></worldbody></mujoco>'
    )
    with pytest.raises(HouseError, match="House 'mine'"):
        write_house(spec, tmp_path, "mine")
    assert (tmp_path / "mine.xml").read_text() == "kept"


@pytest.mark.costly
@pytest.mark.parametrize("seed", sample([3, 5, 713], 2))
def test_walls_of_two_rooms_overlap_nowhere_in_sight(seed: int) -> None:
    """Overlapping walls show a strip of the other room's paint."""
    world = World(House("house", generate(seed)))
    model, data, labels = world.model, world.data, world.labels
    low, high = world_boxes(model, data, np.arange(model.ngeom))
    box = mujoco.mjtGeom.mjGEOM_BOX.value
    walls = [g for wall in labels.of_category("wall") for g in wall.geom_ids if model.geom_type[g] == box]
    rooms = [(np.subtract(centre, half), np.add(centre, half)) for room in world.rooms for centre, half in room.boxes]
    for n, a in enumerate(walls):
        for b in walls[n + 1 :]:
            start, end = np.maximum(low[a], low[b]), np.minimum(high[a], high[b])
            if model.geom_matid[a] == model.geom_matid[b] or (end - start).min() < 0.002:
                continue
            for corner, opposite in rooms:
                assert (np.minimum(end, opposite) - np.maximum(start, corner))[:2].min() < -0.001, (start, end)


@pytest.mark.costly
@pytest.mark.parametrize("seed", sample([4, 701, 702], 2))
def test_doors_of_bedrooms_and_bathrooms_have_a_leaf_and_rooms_a_ceiling_lamp(seed: int) -> None:
    """702 has a bed with a canopy below the middle of a ceiling."""
    config = HouseConfig(pool="heldout", exact=False)
    world = World(House("house", generate_house(seed, config).spec))
    doors = measured("door", world.model, world.data, world.labels, world.rooms)
    hinges = np.array([world.data.xanchor[leaf.joint] for leaf in hinged_leaves(world.model, world.data, world.labels)])
    for room in (room for room in world.rooms if room.kind in ("bedroom", "bathroom")):
        for door in doors:
            if any(room.contains(*door.side_point(sign)) for sign in (-1.0, 1.0)):
                away_m = np.hypot(*(hinges[:, :2] - door.centre_m).T)
                assert away_m.min() < 0.7, f"{room.name}: no leaf at {door.centre_m}"
    lamps = [item for item in read_standing(world.model, world.data, world.labels) if item.category == "lighting"]
    for room in world.rooms:
        top_m = max(centre[2] + half[2] for centre, half in room.boxes)
        assert any(is_in(room, lamp) and lamp.high[2] > top_m - 0.1 for lamp in lamps), f"{room.name} has no lamp"


@pytest.mark.costly
def test_a_hazard_in_a_hallway_is_not_judged_as_furniture() -> None:
    config = HouseConfig(pool="heldout", kind="corridor", hazards=("slab",), hazard_count=4, exact=False)
    world = World(House("house", generate_house(21, config).spec))
    hazards = read_hazards(world.model)
    standing = read_standing(world.model, world.data, world.labels)
    parts = [item for item in standing if any(is_part_of(item, hazard) for hazard in hazards)]
    assert len(parts) >= len(hazards) == 4
    assert check_house(world.house.spec, furnished=True) == []
