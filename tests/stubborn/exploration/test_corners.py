import math
from dataclasses import replace

import numpy as np
import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import Action, ConfigError
from stubborn.exploration.corners import CornerConfig, CornerExplorer, corner_xy_m
from stubborn.exploration.explorer import Explorer
from stubborn.mapping.navmap import CollisionLayer
from stubborn.planning.steering import next_action
from tests.helpers.boxed import FRAME, all_seen, box_in, close_quarter, empty
from tests.helpers.ground import PLANNER, START, ground, route_of


def explorer(**options: object) -> CornerExplorer:
    return CornerExplorer(CornerConfig(**options))  # type: ignore[arg-type]


def test_corners_lie_ten_percent_inside_and_follow_each_other_clockwise():
    places = [corner_xy_m(FRAME, corner, 0.10) for corner in range(4)]
    offset = 0.4 * 240 * 0.05
    middle = np.mean(places, axis=0)
    np.testing.assert_allclose(np.abs(np.array(places) - middle), offset)
    angles = np.unwrap([math.atan2(y - middle[1], x - middle[0]) for x, y in places])
    np.testing.assert_allclose(np.diff(angles), -math.pi / 2)
    assert angles[0] == pytest.approx(math.pi / 4)  # ahead and left of the start


def test_it_is_stubborn_while_there_is_a_path():
    explore, navmap = explorer(), empty()
    for x in np.linspace(0.0, 1.0, 5):
        route_of(explore, ground(navmap, Pose(x, 0.2 * x, 0.0)))
        assert explore.corner == 0


@pytest.mark.parametrize("closed", [(0,), (0, 1), (0, 1, 2)])
def test_an_infeasible_corner_is_replaced_by_the_next_clockwise_at_once(closed: tuple[int, ...]):
    explore, navmap = explorer(), empty()
    for corner in closed:
        close_quarter(navmap.seen_obstacle, corner)
    assert route_of(explore, ground(navmap)) is not None
    assert explore.corner == len(closed)


def test_after_the_last_corner_comes_the_first():
    explore, navmap = explorer(first_corner=3), empty()
    close_quarter(navmap.seen_obstacle, 3)
    route_of(explore, ground(navmap))
    assert explore.corner == 0


def test_a_path_longer_than_the_limit_is_infeasible():
    explore, navmap = explorer(longest_path_m=6.6), empty()
    assert route_of(explore, ground(navmap)) is not None
    assert explore.corner == 0  # 6.3 m away: 4.8 m along x and y, less the radius of the corner
    middle = FRAME.shape[0] // 2
    navmap.seen_obstacle[middle - 60 : middle + 90, middle + 20] = True
    route_of(explore, ground(navmap))
    assert explore.corner != 0


def test_when_all_four_are_infeasible_it_goes_to_the_reachable_cell_nearest_the_corner():
    explore, navmap = explorer(), empty()
    all_seen(navmap)
    box_in(navmap.seen_obstacle, 1.5)
    route = route_of(explore, ground(navmap))
    rows, cols = np.nonzero(route.goal.cells)
    x_m, y_m = FRAME.centres(rows, cols)
    assert x_m.max() < 1.5
    assert y_m.max() < 1.5
    assert x_m.min() > 1.1
    assert y_m.min() > 1.1


def test_boxed_in_it_never_freezes_and_visits_all_corners_of_its_box():
    explore: Explorer = explorer()
    navmap, pose = empty(), START
    all_seen(navmap)
    box_in(navmap.seen_obstacle, 1.5)
    quarters = set()
    for _ in range(150):
        route = route_of(explore, ground(navmap, pose))
        action = next_action(route, pose, PLANNER.config)
        if action is Action.MOVE_FORWARD:
            pose = Pose(*pose.ahead(0.25), pose.yaw_rad)
        else:
            turn = math.radians(30 if action is Action.TURN_LEFT else -30)
            pose = replace(pose, yaw_rad=math.remainder(pose.yaw_rad + turn, math.tau))
        assert max(abs(pose.x_m), abs(pose.y_m)) < 1.45
        if min(abs(pose.x_m), abs(pose.y_m)) > 0.7:
            quarters.add((pose.x_m > 0, pose.y_m > 0))
    assert len(quarters) == 4


def test_the_optimistic_map_is_tried_when_the_pessimistic_one_closes_all_corners():
    navmap = empty()
    box_in(navmap.pessimistic_marks, 1.5)
    explore = explorer()
    route = route_of(explore, ground(navmap))
    assert explore.corner == 0
    assert route.length_m > 5.0  # out of the box
    box_in(navmap.optimistic_marks, 1.5)
    route = route_of(explorer(), ground(navmap))
    assert route.length_m < 2.5


def test_only_the_marks_of_the_given_layers_count():
    navmap = empty()
    box_in(navmap.pessimistic_marks, 1.5)
    route = route_of(explorer(), ground(navmap, layers=(CollisionLayer.OPTIMISTIC,)))
    assert 5.0 < route.length_m < 7.5
    assert route_of(explorer(), ground(navmap, layers=(CollisionLayer.PESSIMISTIC,))).length_m < 2.5
    box_in(navmap.optimistic_marks, 1.5)
    assert route_of(explorer(), ground(navmap, layers=(CollisionLayer.NONE,))).length_m > 5.0


@pytest.mark.parametrize(("seen_cells", "corner"), [(28, None), (29, 0)])
def test_a_corner_given_up_stays_given_up_until_new_ground_has_been_seen(seen_cells: int, corner: int | None):
    explore, navmap = explorer(regain_m2=2.0), empty()
    navmap.grow_known(*(slice(0, n) for n in FRAME.shape))
    close_quarter(navmap.seen_obstacle, 0)
    route_of(explore, ground(navmap))
    assert explore.corner == 1
    navmap.seen_obstacle[:] = False  # as if a step aside had opened the first corner and closed the others
    for closed in (1, 2, 3):
        close_quarter(navmap.seen_obstacle, closed)
    navmap.frames_in_view[:seen_cells, :seen_cells] = 1  # 1.96 m2 or 2.10 m2
    route_of(explore, ground(navmap))
    assert (explore.place is not None) == (corner is None)
    if corner is not None:
        assert explore.corner == corner


def test_a_substitute_place_is_kept_even_when_a_corner_opens_meanwhile():
    explore, navmap = explorer(regain_m2=0.0), empty()
    all_seen(navmap)
    box_in(navmap.seen_obstacle, 1.5)
    first = route_of(explore, ground(navmap))
    navmap.seen_obstacle[:] = False
    second = route_of(explore, ground(navmap))
    np.testing.assert_array_equal(np.argwhere(first.goal.cells), np.argwhere(second.goal.cells))
    (row, col) = np.argwhere(first.goal.cells)[0]
    x_m, y_m = FRAME.centres(row, col)
    there = route_of(explore, ground(navmap, Pose(float(x_m), float(y_m), 0.0)))
    assert explore.place is None
    assert there.goal.marker_xy_m == corner_xy_m(FRAME, explore.corner, 0.10)


def test_reset_begins_with_the_first_corner_again():
    explore, navmap = explorer(), empty()
    close_quarter(navmap.seen_obstacle, 0)
    route_of(explore, ground(navmap))
    assert explore.corner == 1
    explore.reset()
    assert explore.corner == 0


def test_an_inset_of_half_the_window_is_refused():
    with pytest.raises(ConfigError, match=r"got 0\.5"):
        CornerConfig(inset=0.5)
    with pytest.raises(ConfigError, match="got 4"):
        CornerConfig(first_corner=4)
