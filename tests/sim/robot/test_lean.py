"""The body leans by physics: pushes, ramps and tables tilt it, and what it carries leans with it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.core.geometry.pose import BodyPose, Pose
from sim.core.interface import Action
from sim.gl import mujoco
from sim.houses.house import House
from sim.robot.conditions import Conditions
from sim.robot.creep import HARD_STIFFNESS, slip_of
from sim.robot.variation import ActionErrors, Variation
from sim.sensors.measured import ImuSensor
from sim.sensors.noise import NOISE_PRESETS
from sim.sensors.sensor import SensorContext
from sim.world.world import World
from tests.helpers.worlds import open_floor, with_box, with_movable
from tools.research.lean_tables import carpet_floor, floor, largest_push_n, push_chair, ramp

FORWARD = Action.MOVE_FORWARD


def on_ramp(angle_deg: float, forwards: int = 8) -> tuple[World, list]:
    """Returns a world whose robot drove onto a ramp, and its motions."""
    world = World(House("ramp", ramp(math.radians(angle_deg))))
    world.reset(Pose(0.0, 0.0, 0.0))
    return world, [world.move(FORWARD) for _ in range(forwards)]


def test_on_a_flat_floor_at_rest_the_body_is_upright() -> None:
    world = World(open_floor(friction=0.7))
    world.reset(Pose(0.0, 0.0, 0.3))
    for action in (FORWARD, Action.TURN_LEFT, FORWARD, Action.TURN_RIGHT, Action.TURN_RIGHT):
        world.move(action)
        body = world.body_pose
        assert math.degrees(math.hypot(body.pitch_rad, body.roll_rad)) < 0.2
        assert abs(body.rise_m) < 0.001
        assert (body.x_m, body.y_m, body.yaw_rad) == (world.pose.x_m, world.pose.y_m, world.pose.yaw_rad)


def test_on_a_ramp_camera_and_inertia_sensor_have_its_angle_and_the_robot_stays() -> None:
    world, motions = on_ramp(8.0)
    assert not any(motion.collided for motion in motions)
    body = world.camera_pose
    assert math.degrees(body.pitch_rad) == pytest.approx(-8.0, abs=0.2)
    foot_m = body.x_m - 1.0
    eye_m, angle_rad = body.point(0.0, 0.0, 0.88), math.radians(8.0)
    assert eye_m[2] == pytest.approx(foot_m * math.tan(angle_rad) + 0.88 * math.cos(angle_rad), abs=0.01)
    assert eye_m[0] == pytest.approx(body.x_m - 0.88 * math.sin(angle_rad), abs=0.01)
    sensor = ImuSensor()
    acceleration = sensor.read(SensorContext(sensor, {}, model=world.model, data=world.data))[:3]
    assert math.degrees(math.atan2(-acceleration[0], acceleration[2])) == pytest.approx(-8.0, abs=0.5)
    before = world.pose
    mujoco.mj_step(world.model, world.data, nstep=500)  # two seconds
    assert world.pose.distance_to(before) < 0.002


def test_a_ramp_that_is_too_steep_stops_the_robot_with_a_collision() -> None:
    world, motions = on_ramp(12.0)
    assert world.pose.x_m < 1.1
    assert motions[-1].ended == "blocked"
    assert motions[-1].collided


@pytest.mark.parametrize(("contact_m", "mass_kg", "moves"), [(0.45, 4.0, True), (0.45, 6.0, True), (0.6, 8.0, False)])
def test_a_chair_moves_if_traction_can_slide_it(contact_m: float, mass_kg: float, moves: bool) -> None:
    world = World(open_floor())
    slides_n = 0.2 * mass_kg * 9.81
    assert (slides_n < largest_push_n(world.config, contact_m)) is moves
    moved_m, lean_deg, _ = push_chair(contact_m, mass_kg)
    assert (moved_m > 0.1) is moves
    assert 2.0 < lean_deg < 8.0


@pytest.mark.parametrize("edge_m", [0.45, 0.6, 0.75, 0.85])
@pytest.mark.parametrize("angle_rad", [0.0, 0.15, 0.3])
def test_a_robot_that_drives_against_a_table_does_not_fall_and_has_collided(edge_m: float, angle_rad: float) -> None:
    house = with_box(open_floor(friction=0.7), "table_00", centre_m=(1.5, 0.0, edge_m), half_m=(0.5, 0.8, 0.015))
    world = World(house)
    world.reset(Pose(0.68, 0.0, angle_rad))
    motions = [world.move(FORWARD) for _ in range(6)]
    stopped = [motion for motion in motions if motion.displacement_m < 0.2]
    assert stopped
    assert all(motion.collided for motion in stopped)


def test_errors_of_actions_vary_within_an_episode_and_repeat_with_its_seed() -> None:
    world = World(open_floor(friction=0.7))

    def moves(seed: int) -> list[float]:
        world.reset(Pose(0.0, 0.0, 0.0), NOISE_PRESETS["harsh"].actuation.draw(np.random.default_rng(seed)))
        return [world.move(FORWARD).displacement_m for _ in range(6)]

    first = moves(1)
    assert moves(1) == first
    assert np.std(first) > 0.002
    assert moves(2) != first


def test_the_mean_and_spread_of_errors_are_those_of_the_conditions_and_of_periods_are_correlated() -> None:
    variation = Variation()
    variation.reset(Conditions(stop_std_m=0.01, wheel_std=0.02, seed=1))
    drawn = np.array([(errors.stop_m, errors.wheel_scale) for errors in (variation.draw() for _ in range(4000))])
    np.testing.assert_allclose(drawn.mean(axis=0), [0.0, 1.0], atol=0.001)
    np.testing.assert_allclose(drawn.std(axis=0), [0.01, 0.02], rtol=0.05)
    assert np.abs(drawn[:, 0]).max() <= 0.03
    assert abs(np.corrcoef(drawn[1:, 0], drawn[:-1, 0])[0, 1]) < 0.05
    periods = np.array([variation.draw(0.1).stop_m for _ in range(4000)])
    assert np.corrcoef(periods[1:], periods[:-1])[0, 1] == pytest.approx(math.exp(-0.1 / 1.2), abs=0.03)
    variation.reset(Conditions())
    assert variation.draw() == ActionErrors()


def test_a_tyre_slips_more_with_force_less_load_and_less_friction_and_most_before_it_slides() -> None:
    small = slip_of(0.3, 30.0, 0.7, HARD_STIFFNESS)
    assert small == pytest.approx(0.3 / 30.0 / HARD_STIFFNESS, rel=0.01)  # linear
    assert slip_of(-0.3, 30.0, 0.7, HARD_STIFFNESS) == -small
    assert slip_of(6.0, 30.0, 0.25, HARD_STIFFNESS) > 1.2 * slip_of(6.0, 30.0, 0.7, HARD_STIFFNESS)
    assert slip_of(6.0, 15.0, 0.7, HARD_STIFFNESS) > 2.0 * slip_of(6.0, 30.0, 0.7, HARD_STIFFNESS)
    assert slip_of(99.0, 30.0, 0.7, HARD_STIFFNESS) == pytest.approx(3.0 * 0.7 / HARD_STIFFNESS)
    assert slip_of(1.0, 0.0, 0.7, HARD_STIFFNESS) == 0.0


def test_odometry_is_too_long_after_pushing_on_a_wet_floor() -> None:
    wet, dry = (
        too_long(with_movable(open_floor(friction=friction), "stool_00", xy_m=(0.5, 0.0), mass_kg=2.0))
        for friction in (0.25, 0.8)
    )
    assert wet > 0.01
    assert wet > 1.5 * dry


def test_odometry_is_too_long_on_carpet() -> None:
    assert 0.003 < too_long(House("carpet", carpet_floor(0.9))) < 0.015
    assert abs(too_long(House("floor", floor(0.9)))) < 0.001


def too_long(house: House) -> float:
    """Returns the share by which odometry exceeds the true distance of 12 forwards."""
    world = World(house)
    world.reset(Pose(0.0, 0.0, 0.0))
    for _ in range(12):
        world.move(FORWARD)
    return world.odometry.x_m / world.pose.x_m - 1.0


def test_a_body_pose_turns_points_by_yaw_pitch_and_roll() -> None:
    nose_down = BodyPose(1.0, 2.0, math.pi / 2, 0.5, 0.1, math.radians(10.0), 0.0)
    x_m, y_m, z_m = nose_down.point(1.0, 0.0, 0.0).tolist()
    assert (x_m, y_m, z_m) == pytest.approx((1.0, 2.0 + math.cos(0.1745), 0.6 - math.sin(0.1745)), abs=1e-3)
    right_down = BodyPose(0.0, 0.0, 0.0, roll_rad=math.radians(10.0))
    assert right_down.point(0.0, -1.0, 0.0)[2] == pytest.approx(-math.sin(0.1745), abs=1e-3)
    np.testing.assert_allclose(right_down.axes @ right_down.axes.T, np.eye(3), atol=1e-12)
