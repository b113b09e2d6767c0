"""House plans against the real camera, the real map and the real robot's free space, in rooms of a few boxes."""

from __future__ import annotations

import math

import cv2
import numpy as np
import pytest

from sim.core.errors import HouseError
from sim.core.geometry.grid import GridFrame, cells_near_segment
from sim.core.geometry.pose import Pose
from sim.core.interface import Action, CameraModel, RobotModel, SuccessRule
from sim.env.scene import Scene
from sim.homes.plans.export import export_plans
from sim.homes.plans.motion_kernels import mark_square, mark_swept
from sim.homes.plans.plan import HEIGHT_UNIT_M, Plan, read_plan, write_plan
from sim.homes.plans.robot import PlanRobot
from sim.homes.plans.sight import PlanCamera
from sim.houses.house import House
from sim.robot.config import RobotConfig
from sim.task.metrics import goal_share
from sim.world.storeys import storey_floors
from stubborn.mapping.collision_marks import square_ahead
from stubborn.mapping.mapper import Mapper, MappingConfig
from stubborn.mapping.navmap import NavMap
from tests.helpers.worlds import room, two_storeys, with_box

MAP = GridFrame.around_start(480, 0.05)
START = Pose(-2.5, 0.3, 0.2)


def furnished(hiding_m: float) -> House:
    """Returns a room of 7 x 4 m: a bed at the east end, a table top on legs, and a cabinet in front of the bed."""
    house = with_box(room(7, 4), "bed_00", centre_m=(2.4, -0.6, 0.3), half_m=(0.8, 0.9, 0.3))
    house = with_box(house, "table_00", centre_m=(0.3, 1.2, 0.72), half_m=(0.5, 0.4, 0.02))
    for number, (x, y) in enumerate(((-0.15, 0.85), (0.75, 0.85), (-0.15, 1.55), (0.75, 1.55)), start=1):
        house = with_box(house, f"table_{number:02d}", centre_m=(x, y, 0.35), half_m=(0.025, 0.025, 0.35))
    return with_box(house, "cabinet_00", centre_m=(0.7, -0.8, hiding_m / 2), half_m=(0.2, 0.5, hiding_m / 2))


def plan_of(house: House) -> Plan:
    (plan,) = export_plans(house, {})
    return plan


@pytest.mark.costly
@pytest.mark.parametrize("hiding_m", [0.4, 1.0, 2.0])
def test_a_look_shows_the_share_of_the_goal_the_floor_and_the_map_that_the_real_camera_shows(hiding_m):
    house = furnished(hiding_m)
    scene = Scene(house, robot=RobotConfig(), camera=CameraModel(), profile="fast")
    twin, real, mapper = NavMap.empty(MAP), NavMap.empty(MAP), Mapper(CameraModel(), RobotModel(), MappingConfig())
    camera, floor = PlanCamera(plan_of(house)), scene.task.truth.unseen_floor()
    for yaw_rad in (START.yaw_rad, -0.4, -1.2):
        pose = Pose(START.x_m, START.y_m, yaw_rad)
        images = scene.camera.render(scene.world.data, pose, ("depth", "semantic"))
        floor.look(images["semantic"], pose)
        mapper.add_depth(mapper.frame(real, pose.relative_to(START)), images["depth"])
        look = camera.look(pose, "bed", twin, pose.relative_to(START))
        assert look.goal_share == pytest.approx(goal_share(images["semantic"], "bed"), abs=0.004)
    scene.close()
    assert camera.area_seen_m2 == pytest.approx(floor.area_m2, rel=0.07)
    for layer in ("seen_obstacle", "seen_at_eye_level"):
        one, other = getattr(real, layer), getattr(twin, layer)
        assert one.any() == other.any()
        for found, wanted in ((one, other), (other, one)):
            missing = found & ~(cv2.dilate(wanted.view(np.uint8), np.ones((3, 3), np.uint8)) > 0)
            assert missing.sum() <= 0.12 * found.sum(), layer  # surfaces at a flat angle are sampled differently


def test_a_plan_read_from_its_file_is_the_plan_that_was_written(tmp_path):
    plan = plan_of(furnished(1.0))
    write_plan(tmp_path / "room.npz", plan)
    again = read_plan(tmp_path / "room.npz")
    for name in ("floor", "room", "succeeds", "span_start", "span_instance", "categories"):
        np.testing.assert_array_equal(getattr(again, name), getattr(plan, name))
    np.testing.assert_allclose(again.span_high_m, plan.span_high_m, atol=0.51 * HEIGHT_UNIT_M)
    np.testing.assert_allclose(again.slack_m, plan.slack_m, atol=1e-3)
    assert (again.frame, again.rooms, again.instances) == (plan.frame, plan.rooms, plan.instances)
    (tmp_path / "other.npz").write_bytes(b"no plan")
    with pytest.raises(HouseError, match=r"other\.npz"):
        read_plan(tmp_path / "other.npz")


def test_the_masks_of_a_plan_are_where_the_house_has_its_objects():
    plan = plan_of(furnished(1.0))
    bed, cabinet = (
        np.isin(np.arange(plan.floor.size), plan.span_cell[plan.span_instance == plan.instances.index(name)])
        for name in ("bed_00", "cabinet_00")
    )
    assert bed.sum() * plan.frame.cell_m**2 == pytest.approx(1.6 * 1.8, rel=0.05)
    blocked = plan.occupied(0.9, 0.95).ravel()
    assert blocked[cabinet].all()
    assert not blocked[bed].any()
    inside = (plan.room == plan.rooms.index("room_living_00")).sum() * plan.frame.cell_m**2
    assert inside == pytest.approx(7 * 4, rel=0.05)
    reached = plan.success_cells("bed")
    assert reached.any()
    x_m, y_m = plan.frame.centres(*np.nonzero(reached))
    gap_m = np.hypot(np.maximum(np.abs(x_m - 2.4) - 0.8, 0), np.maximum(np.abs(y_m + 0.6) - 0.9, 0))
    assert gap_m.max() <= 1.05


def test_each_storey_has_a_plan_of_its_own():
    lower, upper = export_plans(two_storeys(), {"seed": 1})
    assert (lower.goals(), upper.goals()) == (("bed",), ("sofa",))
    assert upper.name == "two_storeys_storey_1"
    assert upper.floor_z_m == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("levels_m", "floors_m"),
    [((0.0,), [0.0]), ((-0.6, 0.0), [-0.6]), ((-0.6, 0.0, 2.9), [-0.6, 2.9]), ((0.0, 0.6, 1.2), [0.0, 1.2])],
)
def test_levels_less_than_a_metre_above_the_lowest_one_of_a_storey_belong_to_it(levels_m, floors_m):
    assert storey_floors(levels_m, SuccessRule.same_storey_m) == floors_m


@pytest.mark.parametrize("yaw_deg", [0.0, 90.0, 217.0])
def test_the_robot_stops_where_its_disc_meets_the_wall_and_turns_on_the_spot(yaw_deg):
    robot = PlanRobot(plan_of(room(3, 3)))
    robot.pose = Pose(0.0, 0.0, math.radians(yaw_deg))
    moved = [robot.move(Action.MOVE_FORWARD) for _ in range(8)]
    free_m = (1.5 - 0.18) / max(abs(math.cos(robot.pose.yaw_rad)), abs(math.sin(robot.pose.yaw_rad)))
    assert sum(motion.moved_m for motion in moved) == pytest.approx(free_m, abs=0.015)
    assert moved[-1].collided
    assert not moved[0].collided
    before = robot.pose
    assert not robot.move(Action.TURN_LEFT).collided
    assert robot.pose.xy_m == before.xy_m
    assert math.cos(robot.pose.yaw_rad - before.yaw_rad) == pytest.approx(math.cos(math.radians(30)))


def test_marks_on_the_map_are_those_of_the_agent():
    frame, rng = GridFrame.around_start(80, 0.05), np.random.default_rng(0)
    for _ in range(20):
        (x, y), (x_1, y_1), yaw_rad = rng.uniform(-1, 1, 2), rng.uniform(-1, 1, 2), rng.uniform(-3, 3)
        pose, wanted, found = Pose(x, y, yaw_rad), np.zeros((2, 80, 80), np.bool_), np.zeros((2, 80, 80), np.bool_)
        index, inside = square_ahead(frame, pose, 0.25, 0.15)
        wanted[0][index] |= inside
        index, inside = cells_near_segment(frame, (x, y), (x_1, y_1), 0.18)
        wanted[1][index] |= inside
        row, col, row_1, col_1 = ((v - frame.origin_xy_m[0]) / 0.05 for v in (y, x, y_1, x_1))
        mark_square(found[0], row, col, math.cos(yaw_rad), math.sin(yaw_rad), 3.0, 5.0)
        mark_swept(found[1], row, col, row_1, col_1, 3.6)
        np.testing.assert_array_equal(found, wanted)
