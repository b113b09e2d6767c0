import math

import pytest

from sim.core.errors import ConfigError
from sim.core.geometry.pose import Pose
from sim.core.interface import Action
from sim.robot.config import MotionKind, RobotConfig
from sim.robot.velocity import Velocity
from sim.sensors.measured import ImuSensor
from sim.sensors.sensor import SensorContext
from sim.world.world import World
from tests.helpers.worlds import room
from tools.research.lean_tables import add_box

REACH_M = 2.0 - RobotConfig().model.radius_m
"""How far from the middle of a room of 4 x 4 m the middle of the robot can be."""


def moved(motion: MotionKind, start: Pose, *actions: Action) -> tuple[World, list[bool]]:
    world = World(room(4, 4), robot=RobotConfig(motion=motion))
    world.reset(start)
    return world, [world.move(action).collided for action in actions]


@pytest.mark.parametrize("motion", ["no-sliding", "sliding"])
def test_motion_without_physics_is_exact(motion: MotionKind) -> None:
    world, collided = moved(motion, Pose(0.0, 0.0, 0.0), Action.MOVE_FORWARD, Action.TURN_LEFT, Action.STOP)
    assert collided == [False, False, False]
    assert world.pose.xy_m == pytest.approx((0.25, 0.0), abs=1e-9)
    assert world.pose.yaw_rad == pytest.approx(math.radians(30.0), abs=1e-9)
    assert world.odometry.x_m == pytest.approx(0.25, abs=1e-9)


def test_a_wall_ends_a_motion_or_deflects_it() -> None:
    start = Pose(REACH_M - 0.05, 0.0, math.radians(30.0))
    stopped, hit = moved("no-sliding", start, Action.MOVE_FORWARD)
    slid, touched = moved("sliding", start, Action.MOVE_FORWARD)
    assert hit == touched == [True]
    assert stopped.pose.xy_m == pytest.approx((REACH_M, 0.05 * math.tan(math.radians(30.0))), abs=0.03)
    assert slid.pose.xy_m == pytest.approx((REACH_M, 0.125), abs=0.03)
    assert slid.pose.yaw_rad == pytest.approx(start.yaw_rad)


@pytest.mark.parametrize("hit_deg", [30.0, 75.0])
@pytest.mark.parametrize("wall_deg", [7.0, 20.0, 45.0])
def test_the_robot_slides_along_walls_of_all_directions(wall_deg: float, hit_deg: float) -> None:
    """The outline of free space that consists of cells has steps along a wall that is oblique to them."""
    angle_rad = math.radians(wall_deg)
    along, across = (math.cos(angle_rad), math.sin(angle_rad)), (-math.sin(angle_rad), math.cos(angle_rad))
    house = room(10, 10)
    add_box(house.spec, "wall_99", (0.0, 0.0, 0.5), (4.0, 0.05, 0.5))
    house.spec.geom("wall_99").quat = (math.cos(angle_rad / 2), 0.0, 0.0, math.sin(angle_rad / 2))
    x_m, y_m = (-1.5 * a - 0.3 * b for a, b in zip(along, across, strict=True))
    world = World(house, robot=RobotConfig(motion="sliding"))
    world.reset(Pose(x_m, y_m, angle_rad + math.radians(hit_deg)))
    for _ in range(6):
        world.move(Action.MOVE_FORWARD)
    slid_m = (world.pose.x_m - x_m) * along[0] + (world.pose.y_m - y_m) * along[1]
    assert slid_m == pytest.approx(6 * 0.25 * math.cos(math.radians(hit_deg)), rel=0.1)


@pytest.mark.parametrize("motion", ["no-sliding", "sliding"])
def test_without_physics_the_body_rests_at_each_place(motion: MotionKind) -> None:
    """Wheels that overlap a rug push hard, but nothing moves: agents level their images by this sensor."""
    house = room(4, 4)
    add_box(house.spec, "floor_01", (1.0, 0.0, 0.006), (0.5, 1.0, 0.006))
    world = World(house, robot=RobotConfig(motion=motion))
    world.reset(Pose(0.0, 0.0, 0.0))
    sensor = ImuSensor()
    for action in (Action.MOVE_FORWARD, Action.MOVE_FORWARD, Action.TURN_LEFT, Action.MOVE_FORWARD):
        world.move(action)
        reading = sensor.read(SensorContext(sensor, {}, model=world.model, data=world.data))
        assert reading == pytest.approx([0.0, 0.0, 9.81, 0.0, 0.0, 0.0], abs=0.05)


def test_velocities_need_physics() -> None:
    world, _ = moved("sliding", Pose(0.0, 0.0, 0.0))
    with pytest.raises(ConfigError, match="'contacts'"):
        world.hold(Velocity(0.1, 0.0), 0.1)


def test_another_kind_of_motion_is_refused() -> None:
    with pytest.raises(ConfigError, match="sliding"):
        RobotConfig(motion="flying")  # pyright: ignore[reportArgumentType]
