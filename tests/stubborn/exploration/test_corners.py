import math
from dataclasses import replace

import numpy as np
import pytest

from sim.geometry.grid import GridFrame, Window
from sim.geometry.pose import Pose
from sim.interface import Action, ConfigError
from stubborn.exploration.corners import CornerExplorer, ExplorationConfig, Route, corner_xy_m, nearest_corner
from stubborn.mapping.collision_marks import CollisionConfig, mark_visited
from stubborn.navmap import NavMap
from stubborn.planning.planner import Planner, PlanningConfig

FRAME = GridFrame.around_start(240, 0.05)
START = Pose(0.0, 0.0, 0.0)
PLANNER = Planner(PlanningConfig(), trust_visited=True)


def explorer(averse: bool = True, bumps: bool = True, **options: object) -> CornerExplorer:
    """An explorer that goes on errands."""
    options = {"unseen_area_m2": (0.25, 0.05), "unvisited_m": (1.5, 1.0, 0.6), "look_around_turns": 11} | options
    return CornerExplorer(ExplorationConfig(**options), PLANNER, averse=averse, bumps=bumps)  # type: ignore[arg-type]


def empty() -> NavMap:
    """A map on which nothing is known but where the robot stands."""
    navmap = NavMap.empty(FRAME)
    mark_visited(navmap, START, START, 0.18, CollisionConfig())
    return navmap


def whole(navmap: NavMap) -> Window:
    return navmap.frame.part(slice(None), slice(None))


def route_of(explore: CornerExplorer, navmap: NavMap, pose: Pose = START) -> Route:
    route = explore.route(navmap, whole(navmap), pose)
    assert route is not None
    return route


def all_seen(navmap: NavMap) -> None:
    navmap.frames_in_view[:] = 1
    navmap.grow_known(*(slice(0, n) for n in FRAME.shape))


def box_in(layer: np.ndarray, half_m: float) -> None:
    """A closed square of obstacle cells around the start."""
    low, _ = FRAME.cell(-half_m, -half_m)
    high, _ = FRAME.cell(half_m, half_m)
    layer[low : high + 1, [low, high]] = True
    layer[[low, high], low : high + 1] = True


def close_quarter(layer: np.ndarray, corner: int) -> None:
    """A wall that cuts a corner of the window off."""
    middle = FRAME.shape[0] // 2
    rows = slice(middle + 20, None) if corner in (0, 3) else slice(None, middle - 20)
    cols = slice(middle + 20, None) if corner in (0, 1) else slice(None, middle - 20)
    layer[rows, middle + 20 if corner in (0, 1) else middle - 20] = True
    layer[middle + 20 if corner in (0, 3) else middle - 20, cols] = True


def test_corners_lie_ten_percent_inside_and_follow_each_other_clockwise():
    places = [corner_xy_m(FRAME, corner, 0.10) for corner in range(4)]
    offset = 0.4 * 240 * 0.05
    middle = np.mean(places, axis=0)
    np.testing.assert_allclose(np.abs(np.array(places) - middle), offset)
    angles = np.unwrap([math.atan2(y - middle[1], x - middle[0]) for x, y in places])
    np.testing.assert_allclose(np.diff(angles), -math.pi / 2)
    assert angles[0] == pytest.approx(math.pi / 4)  # ahead and left of the start


def test_it_is_stubborn_while_there_is_a_way():
    explore, navmap = explorer(), empty()
    for x in np.linspace(0.0, 1.0, 5):
        route_of(explore, navmap, Pose(x, 0.2 * x, 0.0))
        assert explore.corner == 0


@pytest.mark.parametrize("closed", [(0,), (0, 1), (0, 1, 2)])
def test_an_infeasible_corner_gives_way_to_the_next_clockwise_at_once(closed: tuple[int, ...]):
    explore, navmap = explorer(), empty()
    for corner in closed:
        close_quarter(navmap.seen_obstacle, corner)
    assert route_of(explore, navmap) is not None
    assert explore.corner == len(closed)


def test_after_the_last_corner_comes_the_first():
    explore, navmap = explorer(first_corner=3), empty()
    close_quarter(navmap.seen_obstacle, 3)
    route_of(explore, navmap)
    assert explore.corner == 0


def test_a_way_longer_than_the_limit_is_infeasible():
    explore, navmap = explorer(farthest_way_m=6.6), empty()
    assert route_of(explore, navmap) is not None
    assert explore.corner == 0  # 6.3 m off: 4.8 m each way, less the radius of the corner
    middle = FRAME.shape[0] // 2
    navmap.seen_obstacle[middle - 60 : middle + 90, middle + 20] = True
    route_of(explore, navmap)
    assert explore.corner != 0


def test_when_all_four_are_infeasible_ground_that_was_never_in_view_comes_first():
    explore, navmap = explorer(), empty()
    box_in(navmap.seen_obstacle, 1.5)
    all_seen(navmap)
    row, col = FRAME.cell(-0.8, 0.3)
    navmap.frames_in_view[row - 10 : row + 11, col - 10 : col + 11] = 0
    route = route_of(explore, navmap)
    rows, cols = np.nonzero(route.plan.goal)
    assert np.hypot(rows - row, cols - col).max() < 12
    patch_too_small = route_of(explorer(unseen_area_m2=(2.0,), unvisited_m=()), navmap)
    assert patch_too_small.plan.goal.sum() == 1


def test_when_all_was_seen_it_goes_where_it_has_never_been_and_looks_around_there():
    explore, navmap = explorer(look_around_turns=3), empty()
    assert [explore.looks_around() for _ in range(5)] == [True, True, True, False, False]
    box_in(navmap.seen_obstacle, 2.0)
    all_seen(navmap)
    (right, behind), (left, ahead) = FRAME.cell(-1.6, -1.6), FRAME.cell(1.6, 0.5)
    navmap.trail[right:left, behind:ahead] = True
    route = route_of(explore, navmap)
    assert explore.on_errand
    rows, cols = np.nonzero(route.plan.goal)
    x_m, y_m = route.plan.frame.centres(rows, cols)
    assert x_m.min() > 1.6  # the far side from the trail
    there = Pose(float(x_m[0]), float(y_m[0]), 0.0)
    assert not explore.looks_around()
    explore.route(navmap, whole(navmap), there)
    assert explore.looks_around()


def test_when_nothing_is_left_to_look_at_it_goes_to_the_reachable_cell_nearest_the_corner():
    explore, navmap = explorer(unvisited_m=()), empty()
    all_seen(navmap)
    box_in(navmap.seen_obstacle, 1.5)
    route = route_of(explore, navmap)
    rows, cols = np.nonzero(route.plan.goal)
    x_m, y_m = FRAME.centres(rows, cols)
    assert x_m.max() < 1.5
    assert y_m.max() < 1.5
    assert x_m.min() > 1.1
    assert y_m.min() > 1.1


def test_boxed_in_it_never_freezes_and_visits_all_corners_of_its_box():
    explore, navmap, pose = explorer(unvisited_m=()), empty(), START
    all_seen(navmap)
    box_in(navmap.seen_obstacle, 1.5)
    quarters = set()
    for _ in range(150):
        route = route_of(explore, navmap, pose)
        action = PLANNER.next_action(route.plan, route.free, pose)
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
    box_in(navmap.bumped_wide, 1.5)
    explore = explorer()
    route = route_of(explore, navmap)
    assert explore.corner == 0
    assert route.plan.length_m > 5.0  # out of the box
    box_in(navmap.bumped_narrow, 1.5)
    route = route_of(explorer(), navmap)
    assert route.plan.length_m < 2.5


def test_without_aversion_pessimistic_marks_do_not_count_and_without_layers_none_do():
    navmap = empty()
    box_in(navmap.bumped_wide, 1.5)
    close_quarter(navmap.bumped_wide, 0)
    averse, bold = explorer(), explorer(averse=False)
    route = route_of(bold, navmap)
    assert 5.0 < route.plan.length_m < 7.5
    assert route_of(averse, navmap) is not None
    box_in(navmap.bumped_narrow, 1.5)
    blind = route_of(explorer(bumps=False), navmap)
    assert blind.plan.length_m > 5.0


@pytest.mark.parametrize(("seen_cells", "corner"), [(28, None), (29, 0)])
def test_a_corner_given_up_stays_given_up_until_new_ground_has_been_seen(seen_cells: int, corner: int | None):
    explore, navmap = explorer(regain_m2=2.0), empty()
    navmap.grow_known(*(slice(0, n) for n in FRAME.shape))
    close_quarter(navmap.seen_obstacle, 0)
    route_of(explore, navmap)
    assert explore.corner == 1
    navmap.seen_obstacle[:] = False  # as if a step aside had opened the first corner and closed the others
    for closed in (1, 2, 3):
        close_quarter(navmap.seen_obstacle, closed)
    navmap.frames_in_view[:seen_cells, :seen_cells] = 1  # 1.96 m2 or 2.10 m2
    route_of(explore, navmap)
    assert explore.on_errand == (corner is None)
    if corner is not None:
        assert explore.corner == corner


def test_an_errand_is_seen_through_even_when_a_corner_opens_meanwhile():
    explore, navmap = explorer(regain_m2=0.5), empty()
    box_in(navmap.seen_obstacle, 1.5)
    all_seen(navmap)
    row, col = FRAME.cell(-0.8, 0.3)
    patch = slice(row - 10, row + 11), slice(col - 10, col + 11)
    navmap.frames_in_view[patch] = 0
    first = route_of(explore, navmap)
    navmap.seen_obstacle[:] = False
    second = route_of(explore, navmap)
    np.testing.assert_array_equal(
        np.argwhere(first.plan.goal).mean(axis=0) - first.plan.frame.cell(0.0, 0.0),
        np.argwhere(second.plan.goal).mean(axis=0) - second.plan.frame.cell(0.0, 0.0),
    )
    navmap.frames_in_view[patch] = 1
    explore.route(navmap, whole(navmap), START)
    assert not explore.on_errand


def test_reset_begins_with_the_first_corner_again():
    explore, navmap = explorer(), empty()
    close_quarter(navmap.seen_obstacle, 0)
    route_of(explore, navmap)
    assert explore.corner == 1
    explore.reset()
    assert explore.corner == 0


def test_the_corner_nearest_a_heading():
    assert [nearest_corner(math.radians(a)) for a in (40, -40, -140, 140)] == [0, 1, 2, 3]


def test_an_inset_of_half_the_window_is_refused():
    with pytest.raises(ConfigError, match=r"got 0\.5"):
        ExplorationConfig(inset=0.5)
    with pytest.raises(ConfigError, match="got 4"):
        ExplorationConfig(first_corner=4)
