import math
from dataclasses import replace

import numpy as np
import pytest

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import TURN_RAD, Action, CameraModel, ConfigError, wrap_angle
from stubborn.exploration.glance import GlanceConfig, Glancer
from stubborn.mapping.navmap import NavMap

FRAME = GridFrame.around_start(240, 0.05)
START = Pose(0.0, 0.0, 0.0)


def glancer(**options: float) -> Glancer:
    return Glancer(GlanceConfig(**{"gain_per_turn_m2": 0.75, **options}), CameraModel())


def corridor() -> NavMap:
    """Returns seen ground along x between two walls; behind a door in the left one, at x = 0, nothing was seen."""
    navmap = NavMap.empty(FRAME)
    (right, _), (left, middle) = FRAME.cell(0.0, -0.7), FRAME.cell(0.0, 0.7)
    navmap.frames_in_view[right : left + 1] = 1
    navmap.seen_obstacle[[right, left]] = True
    navmap.seen_obstacle[left, middle - 12 : middle + 13] = False
    return navmap


def turned(pose: Pose, action: Action) -> Pose:
    turn_rad = TURN_RAD if action is Action.TURN_LEFT else -TURN_RAD
    return replace(pose, yaw_rad=wrap_angle(pose.yaw_rad + turn_rad))


def look_in(navmap: NavMap, pose: Pose) -> None:
    """Marks the cells that a camera would show without walls."""
    x_m, y_m = FRAME.mesh()
    bearing_rad = np.arctan2(y_m - pose.y_m, x_m - pose.x_m)
    off_rad = np.abs(np.arctan2(np.sin(bearing_rad - pose.yaw_rad), np.cos(bearing_rad - pose.yaw_rad)))
    navmap.frames_in_view[off_rad <= 0.5 * CameraModel().hfov_rad] += 1


def test_an_open_door_at_the_side_is_worth_a_look():
    navmap, glance, pose, turns = corridor(), glancer(), START, []
    while (action := glance.next_turn(navmap, pose)) is not None:
        turns.append(action)
        pose = turned(pose, action)
        look_in(navmap, pose)
    assert 1 <= len(turns) <= 4
    assert set(turns) == {Action.TURN_LEFT}


def test_walls_and_seen_ground_are_not():
    navmap = corridor()
    left, middle = FRAME.cell(0.0, 0.7)
    navmap.seen_obstacle[left, middle - 12 : middle + 13] = True
    assert glancer().next_turn(navmap, START) is None
    assert glancer().hidden_area_m2(navmap, START).sum() < 0.3
    seen = corridor()
    seen.frames_in_view[:] = 1
    assert glancer().next_turn(seen, START) is None


def test_hidden_ground_is_measured_in_square_metres():
    nothing_known = NavMap.empty(FRAME)
    camera = CameraModel()
    nearest_m = camera.height_m / math.tan(0.5 * camera.vfov_rad)
    hidden_m2 = glancer(range_m=3.0).hidden_area_m2(nothing_known, START)
    assert hidden_m2.sum() == pytest.approx(math.pi * (3.0**2 - nearest_m**2), rel=0.08)


def test_it_does_not_look_twice_from_the_same_place():
    """This holds even if the look showed nothing, as behind glass."""
    navmap, glance, pose = corridor(), glancer(), START
    turns = 0
    while (action := glance.next_turn(navmap, pose)) is not None:
        pose, turns = turned(pose, action), turns + 1
        assert turns < 12
    assert glance.next_turn(navmap, START) is None
    glance.reset()
    assert glance.next_turn(navmap, START) is not None


def test_with_an_infinite_gain_it_never_looks():
    assert glancer(gain_per_turn_m2=math.inf).next_turn(NavMap.empty(FRAME), START) is None
    assert glancer().next_turn(NavMap.empty(FRAME), START) is not None


def test_a_range_of_zero_is_refused():
    with pytest.raises(ConfigError, match="got 0"):
        GlanceConfig(range_m=0.0)


def test_a_robot_that_did_something_else_forgets_where_it_was_turning_to():
    navmap, glance = corridor(), glancer()
    assert glance.next_turn(navmap, START) is not None
    navmap.frames_in_view[:] = 1
    assert glance.next_turn(navmap, Pose(2.0, 0.0, 0.0)) is None
