"""What the robot measures of itself: contacts on its skirt, odometry, inertia."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.core.geometry.pose import Pose
from sim.core.interface import FORWARD_M, Action, CameraModel, ConfigError, reads_truth
from sim.env.objectnav import ObjectNavEnv
from sim.robot.conditions import Conditions
from sim.robot.velocity import Velocity
from sim.sensors.actuation_noise import ActuationNoise
from sim.sensors.measured import BumperSensor, ImuNoise, ImuSensor, OdometrySensor
from sim.sensors.noise import NoiseConfig
from sim.sensors.sensor import SensorContext
from sim.world.world import World
from tests.helpers.worlds import open_floor

SMALL = CameraModel(width_px=32, height_px=24)
FORWARD, LEFT, RIGHT = Action.MOVE_FORWARD, Action.TURN_LEFT, Action.TURN_RIGHT


def readings(house: Path, sensor: Any, actions: list[Action], start: Pose, **options: Any) -> list[NDArray]:
    env = ObjectNavEnv(house=house, goal="sofa", camera=SMALL, start=start, sensors=(sensor,), **options)
    name = sensor if isinstance(sensor, str) else sensor.name
    try:
        return [env.reset(seed=0)[0][name], *(env.step(action)[0][name] for action in actions)]
    finally:
        env.close()


@pytest.mark.parametrize(
    ("yaw_rad", "sector"), [(math.pi, 0), (math.radians(120.0), 1), (math.radians(-120.0), 5), (math.pi / 2, None)]
)
def test_the_bumper_says_where_the_wall_touches(house: Path, yaw_rad: float, sector: int | None) -> None:
    """The wall is at x = -3 m, 12 cm from the robot."""
    *_, last = readings(house, "bumper", [FORWARD] * 3, Pose(-2.7, 0.0, yaw_rad))
    assert last.tolist() == [int(sector == number) for number in range(6)]


def test_odometry_is_the_true_pose_on_a_dry_floor_and_drifts_with_wrong_encoders(house: Path) -> None:
    start, actions = Pose(-2.0, 0.0, 0.5), [LEFT, FORWARD, FORWARD, RIGHT, FORWARD]
    exact = readings(house, "odometry", actions, start)
    np.testing.assert_allclose(exact[0], 0.0, atol=1e-3)
    gps, compass = (readings(house, name, actions, start)[-1] for name in ("gps", "compass"))
    np.testing.assert_allclose(exact[-1], [*gps, *compass], atol=0.01)
    noise = NoiseConfig(actuation=ActuationNoise(encoder_scale=(1.2, 1.2)))
    wrong, true = (readings(house, name, [FORWARD], start, noise=noise)[-1] for name in ("odometry", "gps"))
    assert wrong[0] == pytest.approx(FORWARD_M, abs=0.005)
    assert true[0] == pytest.approx(FORWARD_M / 1.2, abs=0.005)


def test_odometry_also_counts_velocities() -> None:
    world = World(open_floor())
    world.reset(Pose(1.0, 2.0, 1.0))
    for _ in range(10):
        world.hold(Velocity(0.3, 0.4), 0.1)
    moved = world.pose.relative_to(Pose(1.0, 2.0, 1.0))
    assert moved.x_m > 0.15
    np.testing.assert_allclose(
        [world.odometry.x_m, world.odometry.y_m, world.odometry.yaw_rad],
        [moved.x_m, moved.y_m, moved.yaw_rad],
        atol=0.01,
    )


def read_imu(world: World) -> NDArray:
    sensor = ImuSensor()
    return sensor.read(SensorContext(sensor, {}, model=world.model, data=world.data))


def test_the_imu_measures_gravity_at_rest_and_the_turn_rate_and_thrust_of_a_motion() -> None:
    world = World(open_floor())
    world.reset(Pose(0.0, 0.0, 0.0), Conditions())
    np.testing.assert_allclose(read_imu(world), [0.0, 0.0, 9.81, 0.0, 0.0, 0.0], atol=0.05)
    world.hold(Velocity(0.4, 0.0), 0.1)
    assert read_imu(world)[0] > 0.2
    world.reset(Pose(0.0, 0.0, 0.0))
    for _ in range(10):
        world.hold(Velocity(0.0, 0.8), 0.1)
    assert read_imu(world)[5] == pytest.approx(0.8, rel=0.1)


def test_noise_of_the_imu_has_an_offset_of_the_episode_and_its_standard_deviation() -> None:
    config = ImuNoise(acceleration_std_m_s2=0.1, rate_std_rad_s=0.01, rate_bias_rad_s=1.0)
    model, rng, still = config.model(SMALL), np.random.default_rng(0), {"imu": np.zeros(6, np.float32)}
    assert model is not None
    offsets = []
    for _ in range(2):
        model.begin(np.zeros(1, np.float32))
        seen = np.stack([model.apply(still, {}, rng)["imu"] for _ in range(500)])
        np.testing.assert_allclose(seen.std(0), np.repeat([0.1, 0.01], 3), rtol=0.15)
        np.testing.assert_allclose(seen.mean(0)[:3], 0.0, atol=0.02)
        offsets.append(seen.mean(0)[3:])
    assert np.abs(offsets[0] - offsets[1]).min() > 0.02
    assert ImuNoise().model(SMALL) is None
    with pytest.raises(ConfigError, match="rate_bias_rad_s"):
        ImuNoise(rate_bias_rad_s=-1.0)


@pytest.mark.parametrize("sensor", [BumperSensor(), OdometrySensor(), ImuSensor()])
def test_a_robot_can_measure_it_and_its_readings_are_in_its_space(sensor: Any, house: Path) -> None:
    assert not reads_truth(sensor)
    assert not reads_truth(sensor.name)
    for reading in readings(house, sensor, [FORWARD], Pose(-2.0, 0.0, 0.0)):
        assert sensor.space(SMALL).contains(reading)


def test_a_users_sensor_of_the_same_name_that_reads_the_truth_is_marked() -> None:
    class Imu(ImuSensor):
        pass

    assert reads_truth(Imu())
