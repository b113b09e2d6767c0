"""Routes of the search over poses: fewest actions, the narrowest gap, and clearance all along."""

from __future__ import annotations

import numpy as np
import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import FORWARD_M, Action
from sim.world.freespace import FreeSpace
from sim.world.pose_search import PoseRoute, PoseSearch
from tests.helpers.worlds import room
from tests.sim.world.test_freespace import divided_room, free_space

MARGIN_M = 0.01
START = Pose(-2.0, 0.0, 0.0)


def around(space: FreeSpace, x_m: float, y_m: float, radius_m: float) -> np.ndarray:
    x, y = space.frame.mesh()
    return np.hypot(x - x_m, y - y_m) <= radius_m


def search(space: FreeSpace, goal: np.ndarray, start: Pose = START) -> PoseRoute | None:
    return PoseSearch(space, margin_m=MARGIN_M).route(start, goal)


def test_straight_ahead_the_route_is_forwards_only():
    space = free_space(room(6, 4))
    route = search(space, around(space, 0.0, 0.0, 0.05))
    assert route is not None
    assert route.actions == (Action.MOVE_FORWARD,) * 8
    assert np.allclose(route.places_m[:, 0], -2.0 + FORWARD_M * np.arange(9))


def test_a_goal_to_the_left_costs_three_turns():
    space = free_space(room(6, 4))
    route = search(space, around(space, -2.0, 1.0, 0.05))
    assert route is not None
    assert route.actions == (Action.TURN_LEFT,) * 3 + (Action.MOVE_FORWARD,) * 4


@pytest.mark.parametrize(("gap_m", "passes"), [(0.44, True), (0.39, False)])
def test_a_gap_is_passed_where_the_disc_fits_with_the_margin(gap_m: float, passes: bool):
    space = free_space(divided_room(gap_m))
    assert (search(space, around(space, 1.5, 0.0, 0.2), Pose(-2.0, 0.7, 0.3)) is not None) == passes


def test_a_route_keeps_the_margin_at_every_place():
    space = free_space(divided_room(0.5))
    route = search(space, around(space, 1.5, 0.0, 0.2), Pose(-2.0, 1.2, 0.4))
    assert route is not None
    ends = zip(route.places_m[:-1], route.places_m[1:], strict=True)
    path_m = np.concatenate([np.linspace(*pair, 21) for pair in ends])
    assert min(space.clearance(x, y) for x, y in path_m.tolist()) >= space.radius_m + MARGIN_M - 0.001
    lengths_m = np.hypot(*np.diff(route.places_m, axis=0).T)
    forward = np.array(route.actions) == Action.MOVE_FORWARD
    assert np.allclose(lengths_m, np.where(forward, FORWARD_M, 0.0))
