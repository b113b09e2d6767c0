"""A robot falls over an edge but not over a threshold, and the episode records it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.core.errors import PhysicsError
from sim.core.geometry.pose import Pose
from sim.core.interface import Action
from sim.gl import mujoco
from sim.houses.house import House
from sim.robot.config import RobotConfig
from sim.task.objectnav import Task
from sim.world.world import World
from tests.helpers.worlds import ledge, room, with_box

FORWARD = Action.MOVE_FORWARD


def falls(world: World, start: Pose, steps: int) -> list[bool]:
    world.reset(start)
    return [world.move(FORWARD).fell for _ in range(steps)]


@pytest.mark.parametrize("base", ["planar", "free"])
@pytest.mark.parametrize("start_m", [-0.62, -0.8])
@pytest.mark.parametrize("drop_m", [0.6, 2.75])
def test_a_robot_that_drives_over_an_edge_has_fallen_when_its_axle_is_past_it(base, start_m, drop_m):
    world = World(ledge(drop_m), robot=RobotConfig(base=base))
    world.reset(Pose(start_m, 0.0, 0.0))
    fell = False
    for _ in range(4):
        fell = world.move(FORWARD).fell
        if fell:
            break
        assert world.pose.x_m < 0.0
        assert world.pose.floor_z_m == 0.0
    assert fell


@pytest.mark.parametrize("drop_m", [0.06, 0.09, 0.12])
def test_a_robot_that_tips_over_a_low_edge_onto_the_floor_below_has_fallen(drop_m):
    assert any(falls(World(ledge(drop_m)), Pose(-0.8, -0.5, 0.0), 4))


def test_a_robot_that_tips_over_below_two_low_steps_has_not_fallen_over_an_edge():
    house = House("steps", mujoco.MjSpec())
    for number in range(3):
        middle_m = (2.0 * number - 1.0, 0.0, -0.04 * number - 0.05)
        house = with_box(house, f"floor_{number:02d}", centre_m=middle_m, half_m=(1.0, 2.0, 0.05))
    world = World(house)
    assert not any(falls(world, Pose(-0.5, 0.0, 0.0), 14))
    assert world.pose.x_m > 2.3
    joint = world.model.joint("stubborn_robot/free").qposadr[0]
    world.data.qpos[joint + 2 : joint + 7] = (0.10, math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)
    with pytest.raises(PhysicsError, match="tipped over"):
        world.move(FORWARD)


@pytest.mark.parametrize("drop_m", [0.025, 0.04])
def test_a_threshold_is_not_an_edge(drop_m):
    assert not any(falls(World(ledge(drop_m)), Pose(-0.7, 0.0, 0.0), 5))


def test_a_robot_that_drives_along_an_edge_with_one_wheel_over_it_stands_on_its_casters():
    world = World(ledge(0.6))
    assert not any(falls(world, Pose(-0.10, -1.0, 0.5 * np.pi), 4))
    held_upright = World(ledge(0.6), robot=RobotConfig(base="planar"))  # a free base falls before its first action
    assert any(falls(held_upright, Pose(0.01, -1.0, 0.5 * np.pi), 1))


def test_a_rug_and_its_edges_carry_the_robot():
    house = with_box(room(6, 4), "floor_05", centre_m=(0, 0, 0.01), half_m=(0.5, 1.0, 0.01))
    assert not any(falls(World(house), Pose(-1.5, 0.0, 0.0), 10))


def test_a_landing_is_a_level_of_its_own():
    world = World(ledge(0.6))
    world.reset(Pose(1.5, 0.0, 0.0, floor_z_m=-0.6))
    assert world.pose.floor_z_m == pytest.approx(-0.6)


def test_a_fall_ends_the_episode_without_success_and_counts_as_stairs():
    world = World(ledge(0.6))
    task = Task(world)
    world.reset(Pose(-0.7, 0.0, 0.0))
    task.begin("bed", Pose(-0.7, 0.0, 0.0))
    while not task.done:
        task.observe(FORWARD, world.move(FORWARD), {"semantic": np.zeros((4, 4), np.uint8)})
    result = task.metrics()
    assert (result.end_reason, result.failure, result.success) == ("fallen", "stairs", 0.0)
    assert result.distance_to_goal is None
    assert result.soft_spl == 0.0
    assert task.terminated
    assert not task.truncated
