"""Generated houses with two storeys: the check, the stairwell, and its images in the cameras."""

from __future__ import annotations

import numpy as np
import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import Action
from sim.gl import mujoco
from sim.homes.housegen.floor_plan.rectangles import Rect
from sim.homes.housegen.generator import HouseConfig, generate_house
from sim.homes.housegen.structure.stairs import RISER_M, place_flight
from sim.houses.house import House
from sim.houses.writing import house_text
from sim.renderer.camera import Camera
from sim.world.check import check_house
from sim.world.world import World

CONFIG = HouseConfig(
    pool="heldout", kind="estate", area_m2=340.0, storeys=2, rooms=("stair_hall", "office"), clutter=0.2
)


@pytest.fixture(scope="module", params=[1, pytest.param(2, marks=pytest.mark.slow)])
def house(request: pytest.FixtureRequest) -> House:
    return House("two", generate_house(request.param, CONFIG).spec)


@pytest.fixture(scope="module")
def world(house: House) -> World:
    world = World(house)
    mujoco.mj_forward(world.model, world.data)
    return world


def upper_floor_m(world: World) -> float:
    return max(room.floor_z_m for room in world.rooms)


@pytest.mark.costly
def test_the_house_passes_its_check_and_its_file_is_small_enough(house: House):
    assert check_house(house.spec, furnished=True) == []
    assert len(house_text(house.spec)) <= 1_300_000
    kinds = {room.name for room in World(house).rooms if room.floor_z_m > 2.0}
    assert any("bedroom" in name for name in kinds)


@pytest.mark.costly
def test_no_place_over_the_stairwell_or_on_the_stairs_is_free(world: World):
    up_m = upper_floor_m(world)
    (flight,) = world.labels.of_category("stairs")
    low, high = (world.data.geom_xpos[list(flight.geom_ids), :2].copy() for _ in range(2))
    centre = 0.5 * (low.min(axis=0) + high.max(axis=0))
    for floor_z_m in (0.0, up_m):
        space = world.free_space(floor_z_m)
        assert not space.is_free(*centre)
        assert space.largest_part().sum() > 0.7 * space.free.sum()  # rooms behind leaves that are ajar are left out


def test_both_stair_halls_have_lamps_and_the_landing_is_free(world: World):
    halls = [room for room in world.rooms if "stair_hall" in room.name]
    lamps = [world.data.geom_xpos[list(lamp.geom_ids)].mean(axis=0) for lamp in world.labels.of_category("lighting")]
    for (x, y, z), (half_x, half_y, half_z) in (hall.boxes[0] for hall in halls):
        assert any(np.all(np.abs(lamp - (x, y, z)) < (half_x, half_y, half_z)) for lamp in lamps)
    steps = world.data.geom_xpos[list(world.labels.of_category("stairs")[0].geom_ids)]
    top, bottom = steps[steps[:, 2].argmax(), :2], steps[steps[:, 2].argmin(), :2]
    landing = top - 0.55 * (bottom - top) / np.linalg.norm(bottom - top)
    assert world.free_space(upper_floor_m(world)).is_free(*landing.tolist())


def test_a_robot_upstairs_falls_over_the_open_edge_of_the_stairwell(world: World):
    up_m = upper_floor_m(world)
    steps = world.data.geom_xpos[list(world.labels.of_category("stairs")[0].geom_ids)]
    top, bottom = steps[steps[:, 2].argmax()], steps[steps[:, 2].argmin()]
    down = (bottom - top)[:2] / np.linalg.norm((bottom - top)[:2])
    start = top[:2] - 0.55 * down
    world.reset(Pose(float(start[0]), float(start[1]), float(np.arctan2(down[1], down[0])), up_m))
    motions = [world.move(Action.MOVE_FORWARD)]
    while not motions[-1].fell and len(motions) < 5:
        assert world.pose.floor_z_m == pytest.approx(up_m)
        motions.append(world.move(Action.MOVE_FORWARD))
    assert motions[-1].fell


@pytest.mark.costly
def test_culling_changes_no_pixel_on_either_storey_near_the_stairwell(world: World):
    mujoco.mj_resetData(world.model, world.data)
    mujoco.mj_forward(world.model, world.data)
    culled, whole = (Camera(world.model, world.labels, cull=cull) for cull in (True, False))
    rng = np.random.default_rng(0)
    hall = next(room for room in world.rooms if "stair_hall" in room.name)
    (x, y, _), (half_x, half_y, _) = hall.boxes[0]
    for floor_z_m in (0.0, upper_floor_m(world)):
        space = world.free_space(floor_z_m)
        xs, ys = space.frame.axes()
        near = space.free & np.outer(np.abs(ys - y) < half_y, np.abs(xs - x) < half_x)
        for cell in rng.permutation(np.argwhere(near))[:4]:
            x_m, y_m = space.frame.to_metres(cell).tolist()
            pose = Pose(x_m, y_m, float(rng.uniform(-3.1, 3.1)), floor_z_m)
            first, second = (each.render(world.data, pose, ("rgb", "depth", "semantic")) for each in (culled, whole))
            for name, image in first.items():
                np.testing.assert_array_equal(image, second[name])


def test_steps_are_too_high_for_the_robot_and_comfortable_for_people():
    flight = place_flight(Rect(0.0, 0.0, 5.0, 3.0), [], 0, 2.75, 2.5)
    assert 0.17 <= flight.riser_m <= RISER_M
    assert len(flight.steps) * flight.riser_m == pytest.approx(2.75 - flight.riser_m)
    assert all(0.249 < step.width_m < 0.281 for step in flight.steps)
    assert flight.well.area_m2 > 2.0
