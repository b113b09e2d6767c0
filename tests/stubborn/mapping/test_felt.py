"""Conclusions from several collisions, on poses that a disc would have in front of surfaces."""

import math

import numpy as np
import pytest

from sim.core.errors import ConfigError
from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import RobotModel
from stubborn import agents
from stubborn.mapping.collision_marks import CollisionConfig, mark_collision, mark_visited
from stubborn.mapping.felt import BOTH_LAYERS, FeelConfig, FeltSurfaces, contact_direction
from stubborn.mapping.navmap import CollisionLayer, NavMap
from stubborn.mapping.panes import LineRule
from stubborn.planning.avoidance import visited_ground
from stubborn.planning.planner import Planner, PlanningConfig
from stubborn.segmentation.ground_truth import GroundTruthSegmenter
from tests.helpers.gridworld import SMALL_CAMERA, Box, GridWorld, run_episode

FRAME = GridFrame.around_start(121, 0.05)
RADIUS_M = 0.18
SQUARES = CollisionConfig()
PANE_X_M = 1.0
GLASS_X_M = PANE_X_M + 0.03
HEADINGS = [math.radians(angle) for angle in (0, 40, -55, 20)]


def before_pane(y_m: float, yaw_rad: float = 0.0, x_m: float = PANE_X_M - RADIUS_M) -> Pose:
    return Pose(x_m, y_m, yaw_rad)


def felt(*poses: Pose) -> tuple[NavMap, FeltSurfaces]:
    navmap, surfaces = NavMap.empty(FRAME), FeelConfig().make(RADIUS_M, SQUARES)
    before = Pose(0.0, 0.0, 0.0)
    for pose in poses:
        mark_visited(navmap, before, pose, RADIUS_M, SQUARES)
        surfaces.add(navmap, pose)
        before = pose
    return navmap, surfaces


def squares(*poses: Pose) -> NavMap:
    navmap = NavMap.empty(FRAME)
    for pose in poses:
        mark_collision(navmap, pose, BOTH_LAYERS, SQUARES)
    return navmap


def marked(navmap: NavMap, x_m: float, y_m: float, layer: CollisionLayer = CollisionLayer.OPTIMISTIC) -> bool:
    return bool(navmap.collision_marks(layer)[FRAME.cell(x_m, y_m)])


def passes(navmap: NavMap, y_m: float, layer: CollisionLayer) -> bool:
    """Whether the planner's free space leads through the pane at `y_m`."""
    free = Planner(PlanningConfig(), visited_ground).free_space(navmap, Pose(0.0, 0.0, 0.0), layer)
    return bool(free.traversable[FRAME.cell(GLASS_X_M, y_m)])


def test_one_or_two_stops_leave_the_marks_of_the_paper():
    poses = [before_pane(0.0, 0.3), before_pane(0.5)]
    navmap, surfaces = felt(*poses)
    assert not surfaces.panes
    np.testing.assert_array_equal(navmap.pessimistic_marks, squares(*poses).pessimistic_marks)
    np.testing.assert_array_equal(navmap.optimistic_marks, squares(*poses).optimistic_marks)


@pytest.mark.parametrize("turn_rad", [0.0, 0.5, 2.0])
def test_three_stops_on_a_line_are_marked_on_the_pane_at_any_heading(turn_rad: float):
    poses = [before_pane(0.3 * i, yaw) for i, yaw in enumerate(HEADINGS)]
    cos, sin = math.cos(turn_rad), math.sin(turn_rad)
    turned = [Pose(cos * p.x_m - sin * p.y_m, sin * p.x_m + cos * p.y_m, p.yaw_rad + turn_rad) for p in poses]
    navmap, surfaces = felt(*turned)
    assert [int(pane.stops.sum()) for pane in surfaces.panes] == [4]
    x_m, y_m = FRAME.mesh()
    to_pane_m = np.abs(cos * x_m + sin * y_m - PANE_X_M)
    assert navmap.pessimistic_marks.any()
    assert to_pane_m[np.broadcast_to(navmap.pessimistic_marks, to_pane_m.shape)].max() < 0.07
    for i in range(4):  # between stops 0.3 m apart there is no passage
        y = 0.3 * i + 0.15 * (i < 3)
        assert marked(navmap, cos * GLASS_X_M - sin * y, sin * GLASS_X_M + cos * y)


def test_a_wide_part_between_stops_stays_open_on_the_optimistic_layer():
    navmap, _ = felt(before_pane(0.0), before_pane(0.3), before_pane(0.6), before_pane(1.3))
    assert passes(navmap, 0.95, CollisionLayer.OPTIMISTIC)
    assert not passes(navmap, 0.45, CollisionLayer.OPTIMISTIC)


@pytest.mark.parametrize("yaw_rad", [0.0, math.radians(25.0)])
def test_a_hull_that_passed_the_line_touches_the_edge_and_leaves_the_gap_open(yaw_rad: float):
    pane = [before_pane(0.0), before_pane(-0.3), before_pane(-0.6)]
    # Frontal: the gap (0.2 to 0.64) begins at the known part; oblique: its other edge is on the side of the heading.
    beyond_m = 0.09
    sideways_m = math.sqrt(RADIUS_M**2 - (RADIUS_M - beyond_m) ** 2)
    edge_m, gap_m = (0.2, 0.42) if yaw_rad == 0.0 else (0.64, 0.42)
    y_m = edge_m + sideways_m if yaw_rad == 0.0 else edge_m - sideways_m
    stop = before_pane(y_m, yaw_rad, PANE_X_M - RADIUS_M + beyond_m)
    navmap, _ = felt(*pane, stop)
    assert marked(navmap, GLASS_X_M, edge_m - 0.02 if yaw_rad == 0.0 else edge_m + 0.02)
    for layer in BOTH_LAYERS:
        assert passes(navmap, gap_m, layer)
    assert not squares(*pane, stop).optimistic_marks[FRAME.cell(PANE_X_M, edge_m)] or yaw_rad != 0.0
    narrow = squares(*pane, stop)
    mark_visited(narrow, stop, stop, RADIUS_M, SQUARES)
    assert not passes(narrow, gap_m, CollisionLayer.PESSIMISTIC)  # the marks of the paper close it


def test_stops_that_face_apart_are_no_pane():
    poses = [Pose(0.8, 0.3 * i, math.pi * (i % 2)) for i in range(4)]
    assert not felt(*poses)[1].panes


def test_the_same_stop_twice_also_gets_the_marks_straight_ahead():
    poses = [before_pane(0.0), before_pane(0.3), before_pane(0.6)]
    again = before_pane(0.61)
    once, twice = felt(*poses), felt(*poses, again)
    assert not marked(once[0], again.ahead(0.27)[0], again.y_m)
    assert marked(twice[0], again.ahead(0.27)[0], again.y_m)
    assert not once[1].pushes
    assert twice[1].pushes
    twice[1].add(twice[0], before_pane(1.0))
    assert not twice[1].pushes


def test_doubt_drops_single_marks_first_and_panes_next():
    pane, single = [before_pane(0.3 * i) for i in range(3)], Pose(-1.0, -1.0, 2.0)
    navmap, surfaces = felt(*pane, single)
    ahead = single.ahead(0.22)
    assert marked(navmap, *ahead)
    assert surfaces.doubt(navmap)
    assert not marked(navmap, *ahead)
    assert marked(navmap, GLASS_X_M, 0.3)
    assert surfaces.add(navmap, single)
    assert marked(navmap, *ahead)
    assert surfaces.doubt(navmap)
    assert surfaces.doubt(navmap)
    assert not navmap.pessimistic_marks.any()
    assert not surfaces.doubt(navmap)


@pytest.mark.parametrize(
    ("touched", "degrees"), [((0, 1), 0), ((1,), 60), ((5,), -60), ((1, 5), 0), ((2, 1), 60), ((3,), None), ((), None)]
)
def test_the_bumper_shows_where_the_contact_is(touched: tuple[int, ...], degrees: float | None):
    bumper = np.zeros(6, np.int8)
    bumper[list(touched)] = 1
    direction = contact_direction(0.5, bumper)
    if degrees is None:
        assert direction is None
    else:
        assert direction == pytest.approx(0.5 + math.radians(degrees))


def test_without_a_bumper_the_contact_is_ahead():
    assert contact_direction(0.5, None) == 0.5


def test_an_episode_forgets_the_last_one():
    _, surfaces = felt(*(before_pane(0.3 * i) for i in range(3)))
    surfaces.reset()
    navmap = NavMap.empty(FRAME)
    surfaces.add(navmap, before_pane(0.9))
    np.testing.assert_array_equal(navmap.pessimistic_marks, squares(before_pane(0.9)).pessimistic_marks)


def test_a_line_needs_two_stops():
    with pytest.raises(ConfigError, match="least_stops"):
        LineRule(least_stops=1)


@pytest.mark.costly
def test_stubborn_plus_finds_the_gap_in_a_pane_of_glass():
    """The gap is 8 cm wider than the robot, and 1.3 m aside from the straight path; without `feel` 160 steps end."""
    walls = [Box((-0.1, 0.0), (0.0, 4.4)), Box((6.0, 6.1), (0.0, 4.4)), Box((0.0, 6.0), (-0.1, 0.0))]
    glass = [Box((3.0, 3.01), span, (0.0, 2.0), "objects", seen=False) for span in ((0.0, 0.72), (1.16, 4.4))]
    boxes = [*walls, Box((0.0, 6.0), (4.4, 4.5)), *glass, Box((5.0, 5.8), (1.6, 3.0), (0.0, 0.5), "bed")]
    agent = agents.make("stubborn-plus", camera=SMALL_CAMERA, robot=RobotModel(), segmenter=GroundTruthSegmenter())
    trace = run_episode(GridWorld(boxes, (1.0, 2.3, 0.2), camera=SMALL_CAMERA), agent, "bed", max_steps=160)
    assert trace.stopped
    assert trace.goal_distance_m < 1.0
