"""The motion of each action in free space, and that obstacles stop it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.core.geometry.pose import Pose
from sim.core.interface import CLIMB_M, FORWARD_M, TURN_RAD, Action, wrap_angle
from sim.houses.house import House
from sim.robot.config import Base, RobotConfig
from sim.robot.drive import Motion
from sim.robot.profile import Trapezoid
from sim.world.world import World
from tests.helpers.worlds import open_floor, room, with_box, with_movable, with_post

FORWARD, LEFT, RIGHT = Action.MOVE_FORWARD, Action.TURN_LEFT, Action.TURN_RIGHT
BASES: tuple[Base, ...] = ("planar", "free")
ORIGIN = Pose(0.0, 0.0, 0.0)


def world_with(house: House, *, base: Base = "planar", start: Pose = ORIGIN) -> World:
    world = World(house, robot=RobotConfig(base=base))
    world.reset(start)
    return world


def drive(world: World, *actions: Action) -> list[Motion]:
    return [world.move(action) for action in actions]


@given(
    distance=st.floats(0.0, 5.0),
    speed=st.floats(0.1, 3.0),
    acceleration=st.floats(0.1, 10.0),
    share=st.floats(0.0, 1.0),
)
def test_a_profile_covers_its_distance_within_its_limits(distance, speed, acceleration, share):
    profile = Trapezoid(distance, speed, acceleration)
    time_s, step_s = share * profile.duration_s, 1e-6
    assert profile.distance(profile.duration_s) == pytest.approx(distance, abs=1e-12)
    assert -1e-12 <= profile.distance(time_s) <= distance + 1e-9
    assert 0.0 <= profile.speed(time_s) <= speed
    slope = (profile.distance(time_s + step_s) - profile.distance(time_s - step_s)) / (2 * step_s)
    assert slope == pytest.approx(profile.speed(time_s), abs=2 * acceleration * step_s + 1e-6)


@pytest.mark.costly
@pytest.mark.parametrize("base", BASES)
def test_500_free_actions_are_exact_and_do_not_drift(base):
    start = Pose(0.0, 0.0, 0.3)
    world = world_with(open_floor(), base=base, start=start)
    rng = np.random.default_rng(0)
    heading = start.yaw_rad
    for action in map(Action, rng.integers(1, 4, size=500).tolist()):
        before = world.pose
        motion = world.move(action)
        moved = world.pose.relative_to(before)
        turned = {FORWARD: 0.0, LEFT: TURN_RAD, RIGHT: -TURN_RAD}[action]
        heading += turned
        assert (motion.ended, motion.contacts, motion.collided) == ("reached", (), False)
        assert motion.duration_s < (1.15 if action == FORWARD else 0.75)
        assert moved.x_m == pytest.approx(FORWARD_M if action == FORWARD else 0.0, abs=0.001)
        assert moved.y_m == pytest.approx(0.0, abs=0.001)
        assert math.degrees(wrap_angle(moved.yaw_rad - turned)) == pytest.approx(0.0, abs=0.2)
        assert math.degrees(wrap_angle(world.pose.yaw_rad - heading)) == pytest.approx(0.0, abs=0.1)


def test_a_motion_agrees_with_the_change_of_the_pose():
    world = world_with(open_floor())
    for action in (FORWARD, LEFT, RIGHT):
        before, time_s = world.pose, world.data.time
        motion = world.move(action)
        assert motion.action == action
        assert motion.displacement_m == pytest.approx(world.pose.distance_to(before), abs=1e-12)
        assert motion.yaw_change_rad == pytest.approx(world.pose.relative_to(before).yaw_rad, abs=1e-12)
        assert motion.duration_s == pytest.approx(world.data.time - time_s, abs=1e-9)


def test_every_action_ends_at_rest():
    house = with_movable(
        with_box(open_floor(), "wall_00", centre_m=(1, 0, 1), half_m=(0.1, 2, 1)), "chair_00", xy_m=(0.6, 0.3)
    )
    world = world_with(house)
    base = slice(0, 2)
    for action in (FORWARD, FORWARD, FORWARD, LEFT, FORWARD, FORWARD, RIGHT, FORWARD):
        world.move(action)
        robot = world.model.body("stubborn_robot/base").dofadr[0]
        assert np.abs(world.data.qvel[robot + base.start : robot + base.stop]).max() < 0.01


def test_stop_changes_no_state():
    world = world_with(open_floor())
    before = world.data.qpos.copy(), world.data.time
    motion = world.move(Action.STOP)
    assert (motion.displacement_m, motion.yaw_change_rad, motion.duration_s) == (0.0, 0.0, 0.0)
    assert (motion.ended, motion.contacts, motion.collided) == ("reached", (), False)
    np.testing.assert_array_equal(world.data.qpos, before[0])
    assert world.data.time == before[1]


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("angle_deg", [0, 15, 30, 45, 60])
def test_a_wall_stops_the_robot_and_leaves_its_heading(base, angle_deg):
    angle, gap_m = math.radians(angle_deg), 0.05
    house = with_box(open_floor(), "wall_00", centre_m=(1.0, 0.0, 1.0), half_m=(0.1, 5.0, 1.0))
    world = world_with(house, base=base, start=Pose(0.9 - 0.18 - gap_m * math.cos(angle), 0.0, angle))
    motion = world.move(FORWARD)
    assert motion.ended == "blocked"
    assert motion.collided
    assert gap_m - 0.007 < motion.displacement_m < gap_m + 0.025
    assert abs(math.degrees(motion.yaw_change_rad)) < 0.3
    assert world.pose.x_m + 0.18 < 0.9 + 0.001
    again = world.move(FORWARD)
    assert again.collided
    assert again.displacement_m < 0.01  # springs and slip while it is pushed for 0.2 s
    turn = world.move(LEFT)
    assert turn.ended == "reached"
    assert math.degrees(turn.yaw_change_rad) == pytest.approx(30.0, abs=0.4)


@pytest.mark.parametrize("offset_m", [0.0, 0.05, 0.10, 0.15])
@pytest.mark.parametrize("obstacle", ["corner", "leg"])
def test_corners_and_thin_legs_stop_the_robot_and_leave_its_heading(obstacle, offset_m):
    if obstacle == "corner":
        house = with_box(open_floor(), "table_00", centre_m=(0.8, offset_m + 0.3, 0.4), half_m=(0.3, 0.3, 0.4))
    else:
        house = with_post(open_floor(), "table_00", xy_m=(0.5, offset_m))
    world = world_with(house, start=Pose(0.2, 0.0, 0.0))
    motion = world.move(FORWARD)
    grazes = obstacle == "corner" and offset_m == 0.15  # it may slide past while the encoders measure 0.25 m
    assert motion.collided or (grazes and motion.contacts)
    assert abs(math.degrees(motion.yaw_change_rad)) < 0.3
    assert motion.displacement_m < FORWARD_M


@pytest.mark.parametrize("speed_m_s", [1.0, 4.0])
@pytest.mark.parametrize("offset_m", [0.0, 0.1])
def test_no_speed_tunnels_through_a_thin_leg(speed_m_s, offset_m):
    world = world_with(with_post(open_floor(), "table_00", xy_m=(0.5, offset_m)))
    world.data.qvel[world.model.joint("stubborn_robot/x").dofadr[0]] = speed_m_s
    drive(world, *[FORWARD] * 6)
    beyond_m = 0.5 + math.sqrt((0.18 + 0.01) ** 2 - offset_m**2)
    assert world.pose.x_m < 0.5 or abs(world.pose.y_m - offset_m) > 0.18
    assert world.pose.x_m < beyond_m or abs(world.pose.y_m - offset_m) > 0.18


@pytest.mark.parametrize(("gap_m", "passes"), [(0.30, False), (0.35, False), (0.37, True), (0.40, True)])
def test_the_robot_passes_a_gap_wider_than_itself(gap_m, passes):
    house = open_floor()
    for number, side in enumerate((1, -1)):
        house = with_box(
            house, f"wall_0{number}", centre_m=(0.5, side * (0.5 * gap_m + 0.5), 1.0), half_m=(0.1, 0.5, 1.0)
        )
    world = world_with(house)
    motions = drive(world, *[FORWARD] * 5)
    assert (world.pose.x_m > 1.2) is passes
    assert any(motion.collided for motion in motions) is not passes


@pytest.mark.parametrize(
    ("bottom_m", "top_m", "passes"),
    [
        (0.0, CLIMB_M, True),
        (0.0, 0.020, False),
        (0.0, 0.05, False),
        (0.80, 0.90, False),
        (0.89, 0.99, True),
        (0.40, 0.42, False),
    ],
)
def test_the_robot_is_stopped_by_what_it_does_not_climb_or_pass_under(bottom_m, top_m, passes):
    house = with_box(
        open_floor(),
        "table_00",
        centre_m=(0.5, 0.0, 0.5 * (bottom_m + top_m)),
        half_m=(0.1, 0.5, 0.5 * (top_m - bottom_m)),
    )
    world = world_with(house)
    drive(world, *[FORWARD] * 5)
    assert (world.pose.x_m > 1.2) is passes


def test_a_light_object_is_pushed_along_and_a_heavy_one_stops_the_robot():
    light = world_with(with_movable(open_floor(), "chair_00", xy_m=(0.5, 0.0), mass_kg=2.0))
    motions = drive(light, FORWARD, FORWARD, FORWARD)
    assert [motion.ended for motion in motions] == ["reached"] * 3
    assert not any(motion.collided for motion in motions)
    assert motions[-1].contacts[0].instance == "chair_00"
    assert not motions[-1].contacts[0].stopped
    heavy = world_with(with_movable(open_floor(), "chair_00", xy_m=(0.5, 0.0), mass_kg=30.0))
    assert drive(heavy, FORWARD, FORWARD)[-1].collided


def test_wheels_that_spin_on_ice_are_blocked_without_a_collision():
    world = world_with(open_floor(friction=0.0))
    for action in (FORWARD, LEFT):
        motion = world.move(action)
        assert motion.ended == "blocked"
        assert not motion.collided
        assert motion.contacts == ()


def test_a_blocked_turn_does_not_change_the_heading_reference():
    world = world_with(open_floor(friction=0.0))
    assert world.move(LEFT).ended == "blocked"
    world.model.geom("floor_00").friction[0] = 1.0
    world.move(LEFT)
    assert math.degrees(world.pose.yaw_rad) == pytest.approx(30.0, abs=0.2)


@pytest.mark.parametrize("label", ["floor_01", "door_00"])
@pytest.mark.parametrize("base", BASES)
def test_an_edge_of_20_mm_stops_the_robot_with_a_collision_whatever_its_label(base, label):
    house = with_box(open_floor(), label, centre_m=(1.05, 0.0, 0.010), half_m=(0.5, 1.0, 0.010))
    motions = drive(world_with(house, base=base), *[FORWARD] * 4)
    assert sum(motion.displacement_m for motion in motions) < 0.6
    assert motions[-1].collided
    assert motions[-1].contacts[0].instance == label


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("rug_m", [0.005, 0.01, CLIMB_M])
def test_a_solid_rug_is_climbed(rug_m, base):
    """Encoders measure the path of the wheels up its edge, where they slip: that forward is shorter by up to 3 cm."""
    house = with_box(open_floor(), "floor_01", centre_m=(1.0, 0.0, 0.5 * rug_m), half_m=(0.5, 1.0, 0.5 * rug_m))
    world = world_with(house, base=base)
    motions = drive(world, *[FORWARD] * 8)
    assert not any(motion.collided for motion in motions)
    for motion in motions:
        assert motion.displacement_m == pytest.approx(FORWARD_M, abs=0.03)
    assert sum(abs(motion.displacement_m - FORWARD_M) < 0.001 for motion in motions) >= 4


@pytest.mark.parametrize("phase_m", [0.0, 0.06, 0.12])
@pytest.mark.parametrize("angle_deg", [0, 45])
@pytest.mark.parametrize(("edge_m", "friction", "climbed"), [(CLIMB_M, 0.7, True), (0.020, 1.0, False)])
def test_height_and_not_friction_decides_which_edge_is_climbed(edge_m, friction, climbed, angle_deg, phase_m):
    house = with_box(
        open_floor(friction=friction), "door_00", centre_m=(1, 0, 0.5 * edge_m), half_m=(0.035, 4, 0.5 * edge_m)
    )
    angle, away_m = math.radians(angle_deg), 0.4 + phase_m
    start = Pose(0.965 - away_m * math.cos(angle), -away_m * math.sin(angle), angle)
    house.spec.geom("door_00").friction[0] = friction
    world = world_with(house, base="free", start=start)
    motions = drive(world, *[FORWARD] * 6)
    assert (world.pose.x_m > 1.2) is climbed
    assert climbed or any(motion.collided for motion in motions)


def test_a_robot_that_leans_against_a_table_can_turn_and_drive_away():
    """The edge of the top at 0.75 m stops it; it leans back, which unloads its wheels."""
    house = with_box(open_floor(), "table_00", centre_m=(1.0, 0.0, 0.75), half_m=(0.5, 0.8, 0.015))
    world = world_with(house, base="free", start=Pose(0.0, 0.0, 0.3))
    assert drive(world, FORWARD, FORWARD, FORWARD)[-1].collided
    motions = drive(world, *[LEFT] * 6)
    assert not any(motion.collided for motion in motions)
    assert drive(world, FORWARD)[0].displacement_m == pytest.approx(FORWARD_M, abs=0.005)


def test_odometry_sees_wheels_that_slip_as_a_motion():
    """The encoders turn by 0.25 m while the robot is held back by a heavy object on a slippery floor."""
    world = world_with(with_movable(open_floor(friction=0.15), "chair_00", xy_m=(0.5, 0.0), mass_kg=2.5))
    motions = drive(world, FORWARD, FORWARD, FORWARD)
    assert motions[0].displacement_m < FORWARD_M + 0.01
    assert min(motion.displacement_m for motion in motions) < FORWARD_M - 0.005


def test_seams_between_floor_boxes_do_not_disturb_the_motion():
    house = room(6.0, 6.0, box_floor=True)
    for number in range(12):
        centre = (-0.2 + 0.3 * number, 0.0, -0.02)
        house = with_box(house, f"floor_{number + 1:02d}", centre_m=centre, half_m=(0.15, 3.0, 0.02))
    world = world_with(house)
    for motion in drive(world, *[FORWARD] * 8):
        assert motion.displacement_m == pytest.approx(FORWARD_M, abs=0.001)


def test_headings_stay_multiples_of_a_turn_after_collisions():
    house = with_post(with_post(open_floor(), "table_00", xy_m=(0.4, 0.1)), "table_01", xy_m=(0.3, -0.4))
    world = world_with(house, start=Pose(0.0, 0.0, 0.2))
    rng = np.random.default_rng(3)
    for action in map(Action, rng.choice([1, 1, 2, 3], size=40).tolist()):
        world.move(action)
        off = math.remainder(world.pose.yaw_rad - 0.2, TURN_RAD)
        assert abs(math.degrees(off)) < 0.2
