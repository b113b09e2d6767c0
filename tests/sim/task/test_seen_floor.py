"""The floor area seen and the time to first sight, in houses with known values."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import BodyPose, Pose, with_view
from sim.core.interface import MPCAT40_ID, Action, CameraModel
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.houses.house import House
from sim.task.seen_floor import SeenFloor
from tests.helpers.worlds import room, two_storeys, with_box

CAMERA = CameraModel()
NEAR_M = CAMERA.height_m / math.tan(0.5 * CAMERA.vfov_rad)
"""Depth of the nearest floor that the camera sees."""
SIDE = math.tan(0.5 * CAMERA.hfov_rad)
LEFT, FORWARD = Action.TURN_LEFT, Action.MOVE_FORWARD


def info_after(tmp_path, house: House, goal: str, start: Pose, *actions: Action, **options) -> dict:
    """Runs a few actions in a real environment and returns the last info."""
    file = tmp_path / "house.xml"
    file.write_text(house.spec.to_xml())
    env = ObjectNavEnv(house=file, sensors=("depth",), **options)
    try:
        _, info = env.reset(seed=0, options={"episode": Episode("e", "house", goal, start)})
        for action in actions:
            info = env.step(action)[-1]
        return info
    finally:
        env.close()


def far_room() -> House:
    """Returns a room of 20 x 8 m with a bed at the east end."""
    return with_box(room(20, 8), "bed_00", centre_m=(9.0, 0, 0.25), half_m=(0.9, 0.9, 0.25))


def test_the_first_frame_shows_the_floor_of_the_view_within_the_depth_range(tmp_path):
    info = info_after(tmp_path, far_room(), "bed", Pose(-6.0, 0.0, math.pi / 2 - 0.2), max_steps=9)
    # y < 4 cuts the view: the wall is 4 m ahead, so look along x, where 5 m are free.
    ahead = info_after(tmp_path, far_room(), "bed", Pose(-6.0, 0.0, 0.0), max_steps=9)
    trapezium_m2 = SIDE * (CAMERA.max_depth_m**2 - NEAR_M**2)
    side_walls_m2 = SIDE * (CAMERA.max_depth_m - 4.0 / SIDE) ** 2
    assert ahead["area_seen_m2"] == pytest.approx(trapezium_m2 - side_walls_m2, rel=0.02)
    assert info["area_seen_m2"] < ahead["area_seen_m2"]
    assert ahead["area_per_metre"] == 0.0


@pytest.mark.costly
def test_floor_that_was_seen_before_does_not_count_again_and_new_floor_does(tmp_path):
    start = Pose(-6.0, 0.0, 0.0)
    once = info_after(tmp_path, far_room(), "bed", start)
    turned = info_after(tmp_path, far_room(), "bed", start, *[LEFT] * 12)
    twice = info_after(tmp_path, far_room(), "bed", start, *[LEFT] * 24)
    assert turned["area_seen_m2"] > 2.0 * once["area_seen_m2"]
    assert twice["area_seen_m2"] == pytest.approx(turned["area_seen_m2"], rel=0.02)
    # A full turn shows the ring between the nearest floor and the depth range, cut by the walls 4 m to each side.
    x, y = np.meshgrid(np.arange(-4, 16, 0.02), np.arange(-4, 4, 0.02))
    reach_m = np.hypot(x, y)
    most_m2 = np.count_nonzero((reach_m > NEAR_M) & (reach_m < CAMERA.max_depth_m / math.cos(CAMERA.hfov_rad / 2)))
    least_m2 = np.count_nonzero((reach_m > NEAR_M / math.cos(CAMERA.hfov_rad / 2)) & (reach_m < CAMERA.max_depth_m))
    assert 0.0004 * least_m2 < turned["area_seen_m2"] < 0.0004 * most_m2
    driven = info_after(tmp_path, far_room(), "bed", start, FORWARD, FORWARD)
    assert driven["area_seen_m2"] == pytest.approx(once["area_seen_m2"] + 0.5 * 8.0, abs=0.6)
    assert driven["area_per_metre"] == pytest.approx(driven["area_seen_m2"] / driven["path_length"])


def test_floor_behind_a_wall_or_on_another_storey_is_not_seen(tmp_path):
    house = with_box(far_room(), "wall_10", centre_m=(-3.0, 0, 1.25), half_m=(0.05, 3.0, 1.25))
    info = info_after(tmp_path, house, "bed", Pose(-6.0, 0.0, 0.0))
    assert info["area_seen_m2"] == pytest.approx(SIDE * (2.95**2 - NEAR_M**2), rel=0.03)
    above = info_after(tmp_path, two_storeys(), "sofa", Pose(-2.5, 0.0, 0.0, 3.0))
    assert 5.0 < above["area_seen_m2"] < 24.0


def test_a_lower_floor_seen_through_a_hole_is_no_floor_of_this_storey():
    frame = GridFrame(origin_xy_m=(0.0, -5.0), shape=(100, 100), cell_m=0.1)
    floor = np.ones(frame.shape, dtype=np.bool_)
    floor[:, 20:60] = False  # a stairwell from x = 2 to 6
    whole, holed = (SeenFloor(frame, mask, 3.0, CAMERA) for mask in (np.ones_like(floor), floor))
    image = np.full((480, 640), MPCAT40_ID["floor"], np.uint8)
    for seen in (whole, holed):
        seen.look(image, Pose(0.0, 0.0, 0.0, 3.0))
    assert whole.area_m2 == pytest.approx(SIDE * (CAMERA.max_depth_m**2 - NEAR_M**2), rel=0.02)
    assert holed.area_m2 == pytest.approx(SIDE * (2.0**2 - NEAR_M**2), rel=0.05)
    before = holed.area_m2
    holed.look(image, Pose(9.0, 0.0, math.pi, 0.0))  # the robot is on another storey
    assert holed.area_m2 == before


@pytest.mark.parametrize("yaw_rad", [0.0, 0.7, 2.5, -1.2])
def test_each_half_of_the_image_shows_the_floor_on_its_side(yaw_rad):
    frame = GridFrame(origin_xy_m=(-8.0, -8.0), shape=(160, 160), cell_m=0.1)
    seen = SeenFloor(frame, np.ones(frame.shape, dtype=np.bool_), 0.0, CAMERA)
    x, y = frame.mesh()
    left = np.broadcast_to(np.cos(yaw_rad) * y - np.sin(yaw_rad) * x > 0.0, frame.shape)
    image = np.zeros((120, 160), np.uint8)
    image[:, :80] = MPCAT40_ID["floor"]
    seen.look(image, Pose(0.0, 0.0, yaw_rad))
    half_m2 = 0.5 * SIDE * (CAMERA.max_depth_m**2 - NEAR_M**2)
    assert seen.area_m2 == pytest.approx(half_m2, rel=0.03)
    assert left[seen.cells].mean() > 0.99
    seen.look(image[:, ::-1], Pose(0.0, 0.0, yaw_rad))
    assert seen.area_m2 == pytest.approx(2.0 * half_m2, rel=0.03)


def test_the_first_sight_is_the_number_of_actions_before_the_frame_that_shows_the_goal(tmp_path):
    near = with_box(room(8, 8), "bed_00", centre_m=(3.0, 0, 0.25), half_m=(0.9, 0.9, 0.25))
    at_once = info_after(tmp_path, near, "bed", Pose(0.0, 0.0, 0.0), LEFT, max_steps=50)
    assert (at_once["first_seen_step"], at_once["steps_to_first_sight"]) == (0, 0)
    # 180 deg away the bed's near edge is 90 to 105 deg from the axis after 3 turns, in view after 4 or 5.
    behind = info_after(tmp_path, near, "bed", Pose(0.0, 0.0, math.pi), *[LEFT] * 6, max_steps=50)
    assert behind["first_seen_step"] in (4, 5)
    assert behind["steps_to_first_sight"] == behind["first_seen_step"]
    assert behind["gt_explored"] is True
    earlier = info_after(tmp_path, near, "bed", Pose(0.0, 0.0, math.pi), *[LEFT] * (behind["first_seen_step"] - 1))
    assert earlier["gt_explored"] is False


def test_a_goal_that_was_never_seen_has_the_step_limit_as_its_time(tmp_path):
    near = with_box(room(8, 8), "bed_00", centre_m=(3.0, 0, 0.25), half_m=(0.9, 0.9, 0.25))
    info = info_after(tmp_path, near, "bed", Pose(0.0, 0.0, math.pi), Action.STOP, max_steps=50)
    assert "first_seen_step" not in info
    assert info["steps_to_first_sight"] == 50
    assert info["gt_explored"] is False


@pytest.mark.parametrize("pitch_deg", [-10.0, 0.0, 10.0])
def test_a_camera_that_leans_sees_the_floor_from_where_its_lowest_ray_meets_it(pitch_deg):
    frame = GridFrame(origin_xy_m=(-8.0, -8.0), shape=(160, 160), cell_m=0.1)
    seen = SeenFloor(frame, np.ones(frame.shape, np.bool_), 0.0, CAMERA)
    body = BodyPose(0.0, 0.0, 0.0, pitch_rad=math.radians(pitch_deg))
    seen.look(np.full((480, 640), MPCAT40_ID["floor"], np.uint8), body)
    rows, cols = np.nonzero(seen.cells)
    x_m, y_m = frame.centres(rows, cols)
    eye_m = body.point(0.0, 0.0, CAMERA.height_m)
    nearest_m = eye_m[0] + eye_m[2] / math.tan(0.5 * CAMERA.vfov_rad + body.pitch_rad)
    assert x_m[np.abs(y_m) < 0.1].min() == pytest.approx(nearest_m, abs=0.1)


@pytest.mark.parametrize("pitch_deg", [30.0, 60.0])
def test_a_tilted_camera_sees_as_much_floor_in_every_direction(pitch_deg):
    frame = GridFrame(origin_xy_m=(-8.0, -8.0), shape=(640, 640), cell_m=0.025)
    areas_m2 = []
    for yaw_rad in np.radians([0.0, 45.0, 50.5, 225.0]).tolist():
        tilted = BodyPose(0.0, 0.0, yaw_rad, pitch_rad=math.radians(pitch_deg)).axes
        seen = SeenFloor(frame, np.ones(frame.shape, np.bool_), 0.0, CAMERA)
        pose = with_view(Pose(0.0, 0.0, yaw_rad), np.array([0.0, 0.0, CAMERA.height_m]), tilted, CAMERA.height_m)
        seen.look(np.full((480, 640), MPCAT40_ID["floor"], np.uint8), pose)
        areas_m2.append(seen.area_m2)
    assert areas_m2 == pytest.approx([areas_m2[0]] * len(areas_m2), rel=0.01)
