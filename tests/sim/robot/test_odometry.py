"""The robot knows its motion from encoders and gyro only; errors of these and of the motors show in the true motion."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import FORWARD_M, TURN_RAD, Action
from sim.robot.conditions import NOMINAL, Conditions
from sim.robot.config import DriveConfig, RobotConfig
from sim.robot.drive import Blocking
from sim.world.world import World
from tests.helpers.worlds import open_floor

FORWARD, LEFT = Action.MOVE_FORWARD, Action.TURN_LEFT
DRIVE = DriveConfig()


@pytest.fixture(scope="module")
def world() -> World:
    return World(open_floor(friction=0.7))


def after(world: World, conditions: Conditions, *actions: Action) -> Pose:
    """Returns the pose after some actions from the origin."""
    world.reset(Pose(0.0, 0.0, 0.0), conditions)
    for action in actions:
        assert world.move(action).ended == "reached"
    return world.pose


@pytest.mark.parametrize("scale", [0.9, 1.1])
def test_encoders_that_measure_too_much_make_a_forward_too_short(world, scale):
    pose = after(world, Conditions(encoder_scale=(scale, scale)), FORWARD, FORWARD)
    assert pose.x_m == pytest.approx(2 * FORWARD_M / scale, abs=0.002)
    assert pose.yaw_rad == pytest.approx(0.0, abs=0.002)


@pytest.mark.parametrize("scale", [0.95, 1.05])
def test_a_gyro_that_measures_too_much_makes_turns_too_small_and_their_errors_add_up(world, scale):
    pose = after(world, Conditions(gyro_scale=scale), LEFT, LEFT, LEFT)
    assert pose.yaw_rad == pytest.approx(3 * TURN_RAD / scale, abs=0.005)


def test_the_bias_of_a_gyro_turns_the_robot_while_it_drives(world):
    pose = after(world, Conditions(gyro_bias_rad_s=0.005), FORWARD, FORWARD)
    assert pose.yaw_rad == pytest.approx(-0.005 * (world.data.time - RobotConfig().physics.settle_s), rel=0.2)


def test_without_a_gyro_wheels_of_different_size_bend_the_path():
    config = RobotConfig()
    blind = World(open_floor(), robot=replace(config, drive=replace(config.drive, gyro=False)))
    uneven = Conditions(encoder_scale=(0.98, 1.02))
    bent = after(blind, uneven, FORWARD, FORWARD, FORWARD, FORWARD)
    assert bent.yaw_rad == pytest.approx(-4 * FORWARD_M * 0.04 / (2 * config.wheels.half_track_m), rel=0.1)
    assert after(blind, NOMINAL, FORWARD, FORWARD, FORWARD, FORWARD).yaw_rad == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize(
    "conditions",
    [
        Conditions(motor_latency_s=0.08),
        Conditions(motor_gain_scale=(0.8, 1.1)),
        Conditions(motor_bias_rad_s=(0.15, -0.15)),
    ],
    ids=["latency", "gain", "bias"],
)
def test_the_controller_corrects_errors_of_motors_but_for_millimetres_and_degrees(world, conditions):
    ideal, pose = (after(world, each, FORWARD, LEFT, FORWARD) for each in (NOMINAL, conditions))
    assert pose != ideal
    assert pose.distance_to(ideal) < 0.04
    assert math.degrees(abs(pose.yaw_rad - ideal.yaw_rad)) < 1.5


def ticks_until_blocked(commanded: float, moved_each_tick: float, *, turning: bool = False) -> int | None:
    blocking = Blocking(DRIVE, turning=turning)
    return next((tick for tick in range(100) if blocking.add(commanded, moved_each_tick * tick)), None)


def test_a_body_that_stands_still_for_a_fifth_of_a_second_while_the_motors_push_is_blocked():
    assert ticks_until_blocked(0.3, 0.0) == round(DRIVE.blocked_s / DRIVE.tick_s)
    assert ticks_until_blocked(1.0, 0.0, turning=True) == round(DRIVE.blocked_s / DRIVE.tick_s)


def test_slow_progress_and_a_standstill_without_a_command_are_no_block():
    assert ticks_until_blocked(0.3, 1.1 * DRIVE.blocked_m * DRIVE.tick_s / DRIVE.blocked_s) is None
    assert ticks_until_blocked(0.9 * DRIVE.pushing_m_s, 0.0) is None
