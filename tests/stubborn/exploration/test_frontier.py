import re

import numpy as np
import pytest

from sim.core.geometry.grid import GridFrame, Window
from sim.core.geometry.pose import Pose
from sim.core.interface import Action, ConfigError, RobotModel
from stubborn import agents
from stubborn.agent import StubbornAgent
from stubborn.exploration.frontier import FrontierConfig, FrontierExplorer
from stubborn.exploration.frontiers import frontier_cells
from stubborn.mapping.navmap import NavMap
from stubborn.segmentation.ground_truth import GroundTruthSegmenter
from tests.helpers.asciimap import grid_of
from tests.helpers.gridworld import SMALL_CAMERA, GridWorld, boxes_from_plan, run_episode
from tests.helpers.ground import ground, route_of, see

HERE = Pose(0.0, 0.0, 0.0)


def explorer(**options: float) -> FrontierExplorer:
    return FrontierExplorer(FrontierConfig(**options))  # type: ignore[arg-type]


def square(half_m: float) -> NavMap:
    """Returns ground seen in a square around the start, the robot in its middle."""
    navmap = NavMap.empty(GridFrame.around_start(400, 0.05))
    see(navmap, (-half_m, half_m), (-half_m, half_m))
    navmap.trail[navmap.frame.cell(0.0, 0.0)] = True
    return navmap


def window(navmap: NavMap) -> Window:
    return navmap.frame.window_at(0.0, 0.0, 240)


def goal_xy(explore: FrontierExplorer, navmap: NavMap, pose: Pose = HERE) -> tuple[float, float]:
    route = route_of(explore, ground(navmap, pose, window(navmap)))
    x_m, y_m = route.frame.centres(*np.nonzero(route.goal.cells))
    return float(x_m.mean()), float(y_m.mean())


def test_frontier_cells_are_known_free_ones_next_to_open_unknown():
    plan = """
????????
??#..??#
#......#
#.....??
"""
    letters = grid_of(plan)
    cells = frontier_cells(letters == ".", letters == "?")
    brute = np.zeros_like(cells)
    for row, col in np.argwhere(letters == "."):
        around = letters[max(row - 1, 0) : row + 2, max(col - 1, 0) : col + 2]
        brute[row, col] = (around == "?").any()
    assert brute.sum() == 8
    np.testing.assert_array_equal(cells, brute)


def closed_but(navmap: NavMap, half_m: float, doors: list[tuple[str, float]]) -> None:
    """Returns walls around the square, with doors of 1 m at a side `n`, `s`, `e` or `w` and a place along it."""
    for side in "nsew":
        at = half_m if side in "ne" else -half_m
        along = [-half_m, *sorted(v for s, place in doors if s == side for v in (place - 0.5, place + 0.5)), half_m]
        for low, high in zip(along[::2], along[1::2], strict=True):
            if side in "ew":
                see(navmap, (at - 0.05, at + 0.05), (low, high), wall=True)
            else:
                see(navmap, (low, high), (at - 0.05, at + 0.05), wall=True)


def test_it_goes_to_the_frontier_that_is_nearest_by_path():
    navmap = square(3.0)
    closed_but(navmap, 3.0, [("e", 0.0), ("w", 2.0)])
    goal = goal_xy(explorer(), navmap)
    assert goal == pytest.approx((3.1, 0.0), abs=0.3)
    see(navmap, (2.0, 2.1), (-3.0, 3.0), wall=True)  # now the east door cannot be reached, though it is nearer
    goal = goal_xy(explorer(), navmap)
    assert goal == pytest.approx((-3.1, 2.0), abs=0.3)


def test_it_keeps_to_a_frontier_until_that_has_become_known():
    navmap = square(3.0)
    closed_but(navmap, 3.0, [("e", 0.0), ("w", 0.0)])
    explore = explorer()
    first = goal_xy(explore, navmap, Pose(0.3, 0.0, 0.0))
    assert first[0] > 2.5
    kept = goal_xy(explore, navmap, Pose(-0.3, 0.0, 0.0))  # the other one is nearer from here
    assert kept[0] > 2.5
    see(navmap, (3.0, 6.0), (-2.0, 2.0))
    closed = [((6.0, 6.1), (-2.0, 2.0)), ((3.0, 6.0), (-2.1, -2.0)), ((3.0, 6.0), (2.0, 2.1))]
    for x_m, y_m in closed:
        see(navmap, x_m, y_m, wall=True)
    after = goal_xy(explore, navmap, Pose(-0.3, 0.0, 0.0))
    assert after[0] < -2.5


def test_a_frontier_reached_without_becoming_known_is_left_for_another():
    navmap = square(3.0)
    closed_but(navmap, 3.0, [("e", 0.0), ("w", 0.0)])
    explore = explorer(own_known_m=0.0)
    assert goal_xy(explore, navmap, Pose(1.0, 0.0, 0.0)) == pytest.approx((3.1, 0.0), abs=0.3)
    there = goal_xy(explore, navmap, Pose(3.05, 0.0, 0.0))
    assert there[0] < -2.5


def test_a_short_frontier_is_left_for_last():
    def narrow_in_the_east(*wide: tuple[str, float]) -> NavMap:
        navmap = square(3.0)
        closed_but(navmap, 3.0, [("e", 0.0), *wide])
        for y_m in ((-0.5, -0.3), (0.3, 0.5)):
            see(navmap, (2.95, 3.05), y_m, wall=True)
        return navmap

    near_east = Pose(1.0, 0.0, 0.0)
    any_length = goal_xy(explorer(least_length_m=0.05, own_known_m=0.0), narrow_in_the_east(("w", 0.0)), near_east)
    assert any_length == pytest.approx((3.1, 0.0), abs=0.3)
    goal = goal_xy(explorer(own_known_m=0.0), narrow_in_the_east(("w", 0.0)), near_east)
    assert goal == pytest.approx((-3.1, 0.0), abs=0.3)
    last = goal_xy(explorer(own_known_m=0.0), narrow_in_the_east(), near_east)
    assert last == pytest.approx((3.1, 0.0), abs=0.3)


def test_without_unknown_ground_it_goes_to_the_least_visited_ground():
    navmap = square(3.0)
    closed_but(navmap, 3.0, [])
    route = route_of(explorer(), ground(navmap, HERE, window(navmap)))
    x_m, y_m = route.frame.centres(*np.nonzero(route.goal.cells))
    assert np.hypot(x_m, y_m).min() > 2.5


def test_reset_forgets_frontiers_reached():
    navmap = square(3.0)
    closed_but(navmap, 3.0, [("e", 0.0), ("w", 0.0)])
    explore = explorer(own_known_m=0.0)
    first = goal_xy(explore, navmap, Pose(1.0, 0.0, 0.0))
    goal_xy(explore, navmap, Pose(3.05, 0.0, 0.0))
    explore.reset()
    assert goal_xy(explore, navmap, Pose(1.0, 0.0, 0.0)) == first


APARTMENT = boxes_from_plan(
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
START = (8.0, 0.9, 0.2)


@pytest.mark.costly
def test_the_frontier_agent_finds_a_bed_two_rooms_away():
    agent = agents.make("frontier-avoid", camera=SMALL_CAMERA, robot=RobotModel(), segmenter=GroundTruthSegmenter())
    assert isinstance(agent, StubbornAgent)
    assert isinstance(agent.explorer, FrontierExplorer)
    trace = run_episode(GridWorld(APARTMENT, START, camera=SMALL_CAMERA), agent, "bed", max_steps=250)
    assert trace.stopped
    assert trace.goal_distance_m < 1.0


def test_all_measures_against_collisions_are_on_or_off():
    for name, on in (("frontier", False), ("frontier-avoid", True)):
        agent = agents.make(name, camera=SMALL_CAMERA, robot=RobotModel(), segmenter=GroundTruthSegmenter())
        assert isinstance(agent, StubbornAgent)
        assert set(vars(agent.config.avoidance).values()) == {on}


def test_options_reach_the_explorer_and_sweeps_are_counted():
    agent = agents.make(
        "frontier",
        camera=SMALL_CAMERA,
        robot=RobotModel(),
        segmenter=GroundTruthSegmenter(),
        explorer=FrontierConfig(look_around_turns=3),
    )
    world = GridWorld(APARTMENT, START, camera=SMALL_CAMERA)
    trace = run_episode(world, agent, "sofa", max_steps=3)
    assert trace.actions == [Action.TURN_LEFT] * 3


def test_settings_with_which_the_search_would_not_end_are_refused():
    FrontierConfig(arrived_m=0.2, spent_m=0.3)
    for arrived_m, spent_m in ((0.5, 0.1), (0.5, 0.55), (0.0, 0.6)):
        message = f"FrontierConfig needs arrived_m > 0 and spent_m >= arrived_m + 0.1, got {arrived_m} and {spent_m} m"
        with pytest.raises(ConfigError, match=re.escape(message)):
            FrontierConfig(arrived_m=arrived_m, spent_m=spent_m)
    with pytest.raises(ConfigError, match="look_around_turns must be >= 0, got -1"):
        FrontierConfig(look_around_turns=-1)
