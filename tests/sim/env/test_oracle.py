"""The oracle reaches every goal that can be reached, on nearly the shortest path and without contact."""

from __future__ import annotations

import math
from dataclasses import dataclass

import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import Action
from sim.env.oracle import Oracle
from sim.gl import mujoco
from sim.task.objectnav import Task
from sim.task.result import EpisodeMetrics
from sim.world.world import World
from tests.helpers.worlds import open_floor, room, with_box, with_movable


@dataclass
class RunningEpisode:
    world: World
    task: Task

    @property
    def scene(self) -> RunningEpisode:
        return self


def run_oracle(house, goal: str, start: Pose) -> EpisodeMetrics:
    world = World(house)
    task = Task(world)
    world.reset(start)
    task.begin(goal, start)
    oracle = Oracle(RunningEpisode(world, task))
    oracle.reset(goal, seed=0)
    while not task.done:
        action = oracle.act({})
        task.observe(action, world.move(action))
    return task.metrics()


def maze():
    """Returns a room of 8 x 6 m in which two walls form an S, with the bed at its end."""
    house = with_box(room(8, 6), "wall_10", centre_m=(-1.3, -0.6, 1.25), half_m=(0.05, 2.4, 1.25))
    house = with_box(house, "wall_11", centre_m=(1.3, 0.6, 1.25), half_m=(0.05, 2.4, 1.25))
    return with_box(house, "bed_00", centre_m=(3.3, 1.5, 0.25), half_m=(0.5, 0.8, 0.25))


@pytest.mark.costly
@pytest.mark.parametrize("yaw", [0.0, 1.0, 2.5, -2.0])
def test_the_oracle_finds_its_path_through_a_maze_from_any_heading(yaw):
    result = run_oracle(maze(), "bed", Pose(-3.0, -2.0, yaw))
    assert result.success == 1.0
    assert result.spl > 0.9
    assert result.collisions == result.touches == 0
    assert result.num_steps < 100


def test_the_oracle_turns_no_more_than_it_must():
    house = with_box(room(10, 4), "bed_00", centre_m=(4.0, 0, 0.25), half_m=(0.5, 1.0, 0.25))
    result = run_oracle(house, "bed", Pose(-3.0, 0.0, 0.0))
    assert result.num_steps == math.ceil((result.shortest_path or 0.0) / 0.25) + 1


def test_the_oracle_stops_at_once_where_a_stop_succeeds():
    house = with_box(room(6, 4), "bed_00", centre_m=(2.0, 0, 0.25), half_m=(0.5, 1.0, 0.25))
    result = run_oracle(house, "bed", Pose(1.0, 0.0, 0.0))
    assert result.num_steps == 1
    assert result.success == result.spl == 1.0


def test_the_oracle_finds_another_path_around_an_unexpected_obstacle():
    # A heavy box that is moved after the free space was computed.
    house = with_box(room(8, 5), "bed_00", centre_m=(3.5, 0, 0.25), half_m=(0.4, 0.8, 0.25))
    house = with_movable(house, "stool_00", xy_m=(-3.5, 2.0), mass_kg=300.0, friction=1.0)
    world = World(house)
    task = Task(world)
    start = Pose(-2.0, 0.0, 0.0)
    task.truth.target("bed")
    world.reset(start)
    joint = world.model.jnt_qposadr[world.model.body_jntadr[world.model.body("stool_00").id]]
    world.data.qpos[joint : joint + 2] = (0.0, 0.0)
    task.begin("bed", start)
    oracle = Oracle(RunningEpisode(world, task))
    oracle.reset("bed", seed=0)
    while not task.done:
        action = Action(oracle.act({}))
        task.observe(action, world.move(action))
    result = task.metrics()
    assert result.success == 1.0
    assert result.collisions > 0


def test_the_oracle_leaves_a_gap_too_narrow_for_a_whole_step_on_any_of_its_headings():
    half_m = 0.21  # of the gap; a forward of 0.25 m at 15 deg moves 0.065 m to the side
    house = with_box(room(8, 5), "wall_10", centre_m=(-2.4, 1.0 + half_m, 0.6), half_m=(1.0, 1.0, 0.6))
    house = with_box(house, "wall_11", centre_m=(-2.4, -1.0 - half_m, 0.6), half_m=(1.0, 1.0, 0.6))
    house = with_box(house, "bed_00", centre_m=(3.5, 0, 0.25), half_m=(0.4, 0.8, 0.25))
    result = run_oracle(house, "bed", Pose(-2.4, 0.0, math.radians(15.0)))
    assert result.success == 1.0
    assert result.num_steps < 100


def test_the_oracle_goes_on_where_the_goal_was_pushed_away():
    world = World(with_movable(room(10, 6), "chair_00", xy_m=(2.0, 1.0)))
    task, start = Task(world), Pose(-3.0, 0.0, 0.0)
    world.reset(start)
    task.begin("chair", start)
    oracle = Oracle(RunningEpisode(world, task))
    oracle.reset("chair", seed=0)
    world.data.qpos[:2] += (1.5, -2.5)  # the chair is the first free body
    mujoco.mj_forward(world.model, world.data)
    while not task.done:
        action = oracle.act({})
        task.observe(action, world.move(action))
    assert task.metrics().success == 1.0
    assert world.pose.x_m > 2.0


def test_the_oracle_turns_where_the_robot_is_beyond_the_known_floor():
    world = World(with_box(open_floor(), "bed_00", centre_m=(3.0, 0, 0.25), half_m=(0.5, 0.5, 0.25)))
    task = Task(world)
    world.reset(Pose(0.0, 0.0, 0.0))
    task.begin("bed", Pose(0.0, 0.0, 0.0))
    oracle = Oracle(RunningEpisode(world, task))
    oracle.reset("bed", seed=0)
    for x_m in (30.0, -30.0):  # the grid ends 10 m from the bed
        world.reset(Pose(x_m, 0.0, 0.0))
        assert oracle.choose() is Action.TURN_LEFT
