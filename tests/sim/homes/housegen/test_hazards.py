"""Hazards of generated houses: their positions, the space that they leave open, and that no camera shows them."""

from __future__ import annotations

import functools
import re

import cv2
import numpy as np
import pytest

from sim.core.interface import CLIMB_M, ConfigError
from sim.gl import mujoco
from sim.homes.housegen.generator import HouseConfig, generate_house
from sim.homes.housegen.hazards import FAMILIES, PlacedHazard, draw_hazards, slabs
from sim.homes.housegen.hazards.floor_map import SPARE_M, FloorMap
from sim.homes.housegen.hazards.hazard import Sketch
from sim.homes.housegen.structure.openings import Opening
from sim.houses.geoms import data_at_rest
from sim.houses.hazards import read_hazards
from sim.houses.labels import collidable_geoms, read_labels, rendered_geoms
from sim.world.check import check_house

SMALL = HouseConfig(pool="heldout", kind="flat", area_m2=80.0, hazards=("glass", "scan"), hazard_count=4)
DOORWAY = Opening("door", 0, 1, "east", 3.0, (1.5, 2.4), 0.0, 2.1)
TWO_ROOMS = """
<mujoco><worldbody>
  <geom name="floor_00" type="plane" size="6 6 1"/>
  <geom name="wall_00" type="box" pos="3 0.75 1.2" size="0.05 0.75 1.2"/>
  <geom name="wall_01" type="box" pos="3 3.2 1.2" size="0.05 0.8 1.2"/>
  <site name="room_bedroom_00" type="box" group="4" pos="1.5 2 1.2" size="1.5 2 1.2"/>
  <site name="room_office_00" type="box" group="4" pos="4.5 2 1.2" size="1.5 2 1.2"/>
</worldbody></mujoco>
"""
"""Two rooms of 3 x 4 m with a doorway 0.9 m wide between them."""


def two_rooms() -> FloorMap:
    return FloorMap(mujoco.MjSpec.from_string(TWO_ROOMS), (DOORWAY,))


def rectangle(x0: float, y0: float, x1: float, y1: float) -> list[np.ndarray]:
    return [np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])]


@functools.cache
def small_house() -> mujoco.MjSpec:
    return generate_house(11, SMALL).spec


def sampled(family: str, seed: int) -> tuple[PlacedHazard, ...]:
    spec = mujoco.MjSpec.from_string(TWO_ROOMS)
    return draw_hazards(np.random.default_rng(seed), (family,), "train", spec, (DOORWAY,), 2)


@pytest.mark.costly
def test_a_house_with_hazards_passes_the_check_and_has_a_site_for_each() -> None:
    model = small_house().compile()
    hazards = read_hazards(model)
    assert 2 <= len(hazards) <= 4
    assert {hazard.kind for hazard in hazards} == {"glass", "scan"}
    assert check_house(small_house()) == []


@pytest.mark.parametrize("family", FAMILIES)
def test_the_same_seed_gives_the_same_hazards(family: str) -> None:
    first, second = ([part.placed for h in sampled(family, 1) for part in h.parts] for _ in range(2))
    assert [(p.x_m, p.y_m, p.yaw_rad) for p in first] == [(p.x_m, p.y_m, p.yaw_rad) for p in second]
    assert [p.item.geoms for p in first] == [p.item.geoms for p in second]


def test_glass_and_scan_artifacts_collide_and_are_not_rendered() -> None:
    model = small_house().compile()
    data = data_at_rest(model)
    labels = read_labels(model, ignore_prefix="")
    invisible = collidable_geoms(model) & ~rendered_geoms(model)
    for hazard in read_hazards(model):
        inside = (hazard.distance_m(data.geom_xpos[:, :2]) == 0.0) & invisible
        categories = {labels.instances[labels.geom_instance[geom]].category for geom in np.flatnonzero(inside)}
        assert categories & ({"misc"} if hazard.kind == "scan" else {"door", "window"}), hazard


@pytest.mark.costly
@pytest.mark.parametrize("family", FAMILIES)
def test_each_family_finds_a_place_and_leaves_both_rooms_connected(family: str) -> None:
    hazards = [hazard for seed in range(3) for hazard in sampled(family, seed)]
    assert hazards
    assert {hazard.kind for hazard in hazards} == {family}
    floor = two_rooms()
    before = floor.clearance() >= SPARE_M
    for hazard in sampled(family, 0):
        assert floor.try_add(hazard.footprints(), 0.0)
    wide = (floor.clearance() >= SPARE_M).astype(np.uint8)
    _, parts, stats, _ = cv2.connectedComponentsWithStats(wide, connectivity=4)
    main = np.asarray(parts) == 1 + int(stats[1:, cv2.CC_STAT_AREA].argmax())
    middle = floor.frame.cell(3.0, 2.0)[1]
    for room in (slice(0, middle), slice(middle, None)):
        assert main[:, room].sum() > 0.4 * before[:, room].sum()


def test_a_hazard_that_closes_the_only_doorway_is_refused_and_changes_nothing() -> None:
    floor = two_rooms()
    before = floor.clearance()
    assert not floor.try_add(rectangle(2.8, 1.55, 2.9, 2.35), 0.0)
    assert np.array_equal(floor.clearance(), before)
    assert floor.try_add(rectangle(1.4, 1.5, 1.5, 2.4), 0.0)
    assert not np.array_equal(floor.clearance(), before)


@pytest.mark.parametrize("seed", range(3))
def test_a_threshold_lies_in_the_doorway_and_is_low_enough_to_be_climbed(seed: int) -> None:
    sketch = Sketch("slab", 1.0, 1.0, 0.3, np.random.default_rng(seed), "heldout", {}, two_rooms())
    assert slabs.threshold(sketch)
    hazard = sketch.finish()
    (part,) = hazard.parts
    assert (part.placed.x_m, part.placed.y_m) == (3.0, 1.95)
    assert 0.004 < part.placed.item.size_m[2] <= CLIMB_M
    assert hazard.footprints() == []


def test_hazards_keep_their_distance_from_each_other() -> None:
    floor = two_rooms()
    assert floor.try_add(rectangle(1.4, 1.5, 1.5, 2.4), 0.0)
    assert not floor.try_add(rectangle(0.9, 1.5, 1.0, 2.4), 0.8)


def test_an_unknown_family_is_refused() -> None:
    with pytest.raises(ConfigError, match=re.escape("'lava'. Available: glass, slab")):
        HouseConfig(hazards=("lava",))
