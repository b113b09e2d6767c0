"""The tour: its order, its stops, and an apartment."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from sim.core.geometry.grid import Window
from sim.core.geometry.pose import Pose
from sim.core.interface import ConfigError, RobotModel
from stubborn import agents
from stubborn.agent import StubbornAgent
from stubborn.exploration.frontiers import Frontiers
from stubborn.exploration.glance import GlanceConfig
from stubborn.exploration.potentials import PotentialConfig, Potentials
from stubborn.exploration.tour import InformedTourExplorer, TourConfig, TourExplorer, _Paths, _Stop, first_of_best_order
from stubborn.mapping.navmap import NavMap
from stubborn.segmentation.ground_truth import GroundTruthSegmenter
from tests.helpers.gridworld import SMALL_CAMERA, GridWorld, boxes_from_plan, run_episode
from tests.helpers.ground import corridor, ground, route_of, see
from tests.helpers.slopes import Slopes

ALPHA = PotentialConfig(alpha=0.1)
NO_GLANCE = GlanceConfig(gain_per_turn_m2=math.inf)


def explorer(**options: float) -> TourExplorer:
    return TourConfig(glance=NO_GLANCE, turn_m=0.0, **options).make(SMALL_CAMERA)  # type: ignore[arg-type]


def goal_x_m(explore: TourExplorer, navmap: NavMap, pose: Pose) -> float:
    window: Window = navmap.frame.window_at(0.0, 0.0, 300)
    route = route_of(explore, ground(navmap, pose, window))
    x_m, _ = route.frame.centres(*np.nonzero(route.goal.cells))
    return float(x_m.mean())


def test_the_best_order_has_the_least_weighted_latency():
    rng = np.random.default_rng(0)
    for _ in range(20):
        places_m, weight = rng.uniform(-5, 5, (5, 2)), rng.uniform(0.1, 4.0, 5)
        to_m = np.hypot(*places_m.T)
        between_m = np.hypot(*(places_m[:, None] - places_m[None]).transpose(2, 0, 1))

        def latency_m2(order: tuple[int, ...], to_m=to_m, between_m=between_m, weight=weight) -> float:
            length_m, total = 0.0, 0.0
            for number, stop in enumerate(order):
                length_m += 0.5 + (to_m[stop] if number == 0 else between_m[order[number - 1], stop])
                total += weight[stop] * length_m
            return total

        best = min(itertools.permutations(range(5)), key=latency_m2)
        assert first_of_best_order(weight, to_m, between_m, 0.5) == best[0]


def test_a_large_opening_comes_before_a_small_pocket_that_is_nearer():
    navmap = corridor()
    assert goal_x_m(explorer(near_m=0.0), navmap, Pose(0.8, 0.0, 0.0)) > 3.0  # the nearer of two equal ones
    see(navmap, (5.0, 5.1), (-1.1, 1.1), wall=True)  # leaves a metre of unknown ground in the east
    for y_m in ((-1.1, -1.0), (1.0, 1.1)):
        see(navmap, (4.0, 5.1), y_m, wall=True)
    assert goal_x_m(explorer(near_m=0.0), navmap, Pose(0.8, 0.0, 0.0)) < -3.0


@pytest.mark.parametrize(("goal", "wanted_x_m"), [("bed", 4.0), ("chair", -4.0)])
def test_potentials_put_the_frontier_first_behind_which_the_goal_is(goal: str, wanted_x_m: float):
    explore = InformedTourExplorer(
        TourConfig(glance=NO_GLANCE, near_m=0.0, potentials=ALPHA), SMALL_CAMERA, Potentials(ALPHA, Slopes())
    )
    navmap = corridor()
    here = Pose(-math.copysign(0.8, wanted_x_m), 0.0, math.radians(90.0))  # nearer to the other end
    route = route_of(explore, ground(navmap, here, navmap.frame.window_at(0.0, 0.0, 300), goal=goal))
    x_m, _ = route.frame.centres(*np.nonzero(route.goal.cells))
    assert x_m.mean() == pytest.approx(wanted_x_m, abs=0.2)


def test_paths_on_blocks_are_about_as_long_as_on_cells():
    navmap = corridor()
    see(navmap, (0.5, 0.6), (-1.1, 0.2), wall=True)  # a path around a wall
    window = navmap.frame.window_at(0.0, 0.0, 300)
    known = Frontiers.of(ground(navmap, Pose(0.0, 0.0, 0.0), window), own_known_m=1.0, margin_cells=20)
    start = known.free.frame.cell(0.0, -0.5)
    rows, cols = np.nonzero(known.cells & (known.free.frame.centres(*np.indices(known.cells.shape))[0] > 3.0))
    lengths_m = []
    for block_cells in (1, 4):
        paths = _Paths(known, block_cells, 0.4)
        field_m = paths.from_cells(np.array([start[0]]), np.array([start[1]]))
        lengths_m.append(paths.nearest_m(field_m, _Stop(rows, cols, 1.0)))
        assert paths.unknown_m2(rows, cols, 2.0) == pytest.approx(6.3, abs=1.5)
        slow = paths.speed[paths.speed < 1.0]
        assert slow.size > 0
        assert np.all(slow == np.float32(0.4))  # also where a wall is near unknown ground
    assert 4.2 < lengths_m[0] < 4.8
    assert lengths_m[1] == pytest.approx(lengths_m[0], abs=0.3)


def test_ground_seen_from_afar_only_is_visited_when_nothing_is_unknown():
    navmap = corridor()
    for x_m in ((-4.1, -4.0), (4.0, 4.1)):
        see(navmap, x_m, (-1.1, 1.1), wall=True)
    pose = Pose(-1.5, 0.0, 0.0)
    navmap.trail[navmap.frame.cell(-1.5, 0.0)] = True
    assert goal_x_m(explorer(near_m=2.5), navmap, pose) == pytest.approx(2.5, abs=0.5)


def test_ground_seen_from_afar_is_not_inspected_by_coming_near_without_looking():
    navmap, explore = corridor(), explorer(near_m=2.5)
    window = navmap.frame.window_at(0.0, 0.0, 300)
    there = navmap.frame.cell(3.5, 0.0)
    navmap.frames_in_view[there] = 70_000  # 16 bits do not hold it
    route_of(explore, ground(navmap, Pose(0.0, 0.0, 0.0), window))
    assert not explore._inspected[there]
    route_of(explore, ground(navmap, Pose(3.0, 0.0, math.pi), window))  # no new frame shows it
    assert not explore._inspected[there]
    navmap.frames_in_view[there] += 1
    route_of(explore, ground(navmap, Pose(3.0, 0.0, 0.0), window))
    assert explore._inspected[there]


def enclosed() -> NavMap:
    """Returns the corridor with walls at its ends and large marks across it at x = 3 m: nothing is left to see."""
    navmap = corridor()
    for x_m in ((-4.1, -4.0), (4.0, 4.1)):
        see(navmap, x_m, (-1.1, 1.1), wall=True)
    rows, col = slice(navmap.frame.cell(3.0, -1.1)[0], navmap.frame.cell(3.0, 1.1)[0]), navmap.frame.cell(3.0, 0.0)[1]
    navmap.pessimistic_marks[rows, col : col + 3] = navmap.optimistic_marks[rows, col : col + 3] = True
    return navmap


def test_with_nothing_left_to_see_the_robot_stays_on_its_side_of_the_marks():
    navmap, explore = enclosed(), explorer(near_m=0.0)
    navmap.trail[navmap.frame.cell(-1.0, 0.0)] = True  # the ground behind the marks is farthest from the trail
    for _ in range(3):
        assert goal_x_m(explore, navmap, Pose(0.0, 0.0, 0.0)) < 3.0


def test_a_robot_between_large_marks_uses_the_next_layer_when_nothing_is_left_to_see():
    navmap, explore = enclosed(), explorer(near_m=0.0)
    (row_0, col_0), (row_1, col_1) = navmap.frame.cell(-0.3, -0.3), navmap.frame.cell(0.3, 0.3)
    navmap.pessimistic_marks[row_0 : row_1 + 1, [col_0, col_1]] = True
    navmap.pessimistic_marks[[row_0, row_1], col_0 : col_1 + 1] = True
    assert goal_x_m(explore, navmap, Pose(0.0, 0.0, 0.0)) < -3.5


def test_steps_that_cross_no_mark_do_not_count_as_crossing():
    navmap, explore = enclosed(), explorer(near_m=0.0, unmarked_steps=5, keep_steps=1)
    navmap.frames_in_view[:, navmap.frame.cell(3.6, 0.0)[1] :] = 0  # behind the marks something is left to see
    navmap.seen_obstacle[:, navmap.frame.cell(3.6, 0.0)[1] :] = False
    assert goal_x_m(explore, navmap, Pose(0.0, 0.0, 0.0)) > 3.0
    crossed = explore._unmarked_steps
    see(navmap, (3.6, 4.0), (-1.0, 1.0))
    see(navmap, (4.0, 4.1), (-1.1, 1.1), wall=True)
    for _ in range(10):
        goal_x_m(explore, navmap, Pose(0.0, 0.0, 0.0))
    assert explore._unmarked_steps <= crossed + 2  # until the stop is finished


def test_a_stop_is_kept_for_some_steps_and_reset_forgets_it():
    navmap, explore = corridor(), explorer(near_m=0.0)
    first = goal_x_m(explore, navmap, Pose(0.3, 0.0, 0.0))
    assert first > 3.0
    assert goal_x_m(explore, navmap, Pose(-0.6, 0.0, 0.0)) == pytest.approx(first)
    explore.reset()
    assert goal_x_m(explore, navmap, Pose(-0.6, 0.0, 0.0)) < -3.0


@pytest.mark.costly
def test_the_agent_finds_a_bed_two_rooms_away_by_a_tour():
    apartment = boxes_from_plan(
        """
################################
#          #         #         #
#          #         #    bbb  #
#                         bbb  #
#                              #
#                              #
#          #         #         #
####   #########################
#                              #
#                              #
#                              #
#                              #
################################
""",
        0.3,
    )
    agent = agents.make(
        "stubborn", camera=SMALL_CAMERA, robot=RobotModel(), segmenter=GroundTruthSegmenter(), explorer=TourConfig()
    )
    assert isinstance(agent, StubbornAgent)
    world = GridWorld(apartment, (8.0, 0.9, 0.2), camera=SMALL_CAMERA)
    trace = run_episode(world, agent, "bed", max_steps=250)
    assert trace.stopped
    assert trace.goal_distance_m < 1.0


def test_options_that_make_no_sense_are_refused():
    with pytest.raises(ConfigError, match="most_stops must be 1 to 8, got 9"):
        TourConfig(most_stops=9)
    with pytest.raises(ConfigError, match=r"unknown_speed must lie in \(0, 1\], got 0"):
        TourConfig(unknown_speed=0.0)
    with pytest.raises(ConfigError, match="block_cells >= 1"):
        TourConfig(block_cells=0)
    with pytest.raises(ConfigError, match=r"PotentialConfig.alpha.*\[0.*1\].*2"):
        PotentialConfig(alpha=2.0)
    with pytest.raises(ConfigError, match=r"TourConfig needs .*spent_m >= arrived_m \+ 0\.1, got 0\.5 and 0\.55"):
        TourConfig(arrived_m=0.5, spent_m=0.55)


@pytest.mark.parametrize("layers", [1, 2])
def test_marks_that_close_the_path_to_all_remaining_ground_do_not_count_for_some_steps(layers: int):
    navmap, explore = corridor(), explorer(near_m=0.0, keep_steps=1, unmarked_steps=5)
    see(navmap, (-4.1, -4.0), (-1.1, 1.1), wall=True)
    row_0, col = navmap.frame.cell(3.0, -1.1)
    row_1, _ = navmap.frame.cell(3.0, 1.1)
    for mark in (navmap.pessimistic_marks, navmap.optimistic_marks)[:layers]:
        mark[row_0:row_1, col : col + 3] = True
    goals_x_m = [goal_x_m(explore, navmap, Pose(0.2 * step, 0.0, 0.0)) for step in range(8)]
    beyond = [x_m > 3.5 for x_m in goals_x_m]
    assert beyond == ([True] * 8 if layers == 1 else [True] * 6 + [False] * 2)
    see(navmap, (4.0, 5.5), (-1.0, 1.0))  # new ground: the marks may be crossed again
    assert goal_x_m(explore, navmap, Pose(0.0, 0.0, 0.0)) > 3.5


def test_marks_count_again_where_the_robot_pushes():
    navmap, explore = corridor(), explorer(near_m=0.0, keep_steps=1)
    see(navmap, (-4.1, -4.0), (-1.1, 1.1), wall=True)
    row_0, col = navmap.frame.cell(3.0, -1.1)
    row_1, _ = navmap.frame.cell(3.0, 1.1)
    for mark in (navmap.pessimistic_marks, navmap.optimistic_marks):
        mark[row_0:row_1, col : col + 3] = True
    turning = [goal_x_m(explore, navmap, Pose(2.0, 0.0, yaw_rad)) for yaw_rad in (2.0, 1.5, 1.0, 0.5, 0.0)]
    pushing = [goal_x_m(explore, navmap, Pose(2.0 + 0.01 * step, 0.0, 0.0)) for step in range(4)]
    assert [x_m > 3.5 for x_m in (*turning, *pushing)] == [True] * 6 + [False] * 3
    see(navmap, (4.0, 5.5), (-1.0, 1.0))  # new ground: the marks may be crossed again
    assert goal_x_m(explore, navmap, Pose(2.0, 0.0, 0.0)) > 3.5


def test_a_stop_is_given_up_for_an_equally_good_one_only_where_new_ground_was_seen():
    navmap, explore = corridor(), explorer(near_m=0.0, replan_steps=1, keep_steps=20)
    first = goal_x_m(explore, navmap, Pose(0.3, 0.0, 0.0))
    assert first > 3.0
    to_and_fro = [goal_x_m(explore, navmap, Pose(x_m, 0.0, 0.0)) for x_m in 6 * (-0.6, -0.6, 0.3)]
    assert to_and_fro == pytest.approx([first] * 18)
    see(navmap, (-6.0, -4.0), (-1.0, 1.0))
    goals_x_m = [goal_x_m(explore, navmap, Pose(-0.6, 0.0, 0.0)) for _ in range(2)]
    assert goals_x_m[-1] < -4.0
    explore.reset()
    kept = [goal_x_m(explore, navmap, Pose(x_m, 0.0, 0.0)) for x_m in (2.0, *21 * (-2.0,))]
    assert [x_m > 0.0 for x_m in kept] == [True] * 21 + [False]
