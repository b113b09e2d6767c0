import math
import re
from dataclasses import replace

import numpy as np
import pytest

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import TURN_RAD, Action, ConfigError
from stubborn.mapping.navmap import CollisionLayer, NavMap
from stubborn.planning.avoidance import visited_ground
from stubborn.planning.planner import Goal, Planner, PlanningConfig, Route
from stubborn.planning.steering import next_action, short_term_turn
from tests.helpers.asciimap import enlarged, map_of, mask_of

STRAIGHT = PlanningConfig(edge_speed=1.0, clearance_cost=0.0)


def planned(
    text: str,
    config: PlanningConfig = STRAIGHT,
    layer: CollisionLayer = CollisionLayer.PESSIMISTIC,
    yaw_rad: float = 0.0,
):
    navmap, pose = map_of(text)
    pose = replace(pose, yaw_rad=yaw_rad)
    planner = Planner(config, visited_ground)
    free = planner.free_space(navmap, pose, layer)
    return planner, free, planner.route(Goal(free, mask_of(text, "G")), pose), pose


def drive(planner: Planner, navmap: NavMap, goal: np.ndarray, pose: Pose, steps: int) -> list[Pose]:
    """Follows the planner's actions without a world: every move succeeds."""
    poses = [pose]
    for _ in range(steps):
        free = planner.free_space(navmap, pose, CollisionLayer.PESSIMISTIC)
        if goal[navmap.frame.cell(pose.x_m, pose.y_m)]:
            break
        plan = planner.route(Goal(free, goal), pose)
        assert plan is not None
        action = next_action(plan, pose, planner.config)
        if action is Action.MOVE_FORWARD:
            pose = Pose(*pose.ahead(0.25), pose.yaw_rad)
        else:
            turn = TURN_RAD if action is Action.TURN_LEFT else -TURN_RAD
            pose = replace(pose, yaw_rad=math.remainder(pose.yaw_rad + turn, math.tau))
        poses.append(pose)
    return poses


def test_distance_in_the_open_is_the_straight_line():
    text = "\n".join(["." * 60] * 29 + ["." * 5 + "R" + "." * 48 + "G" + "." * 5] + ["." * 60] * 29)
    _, _, plan, _ = planned(text)
    assert plan is not None
    assert plan.length_m == pytest.approx(49 * 0.05, abs=0.06)


ENCLOSED = enlarged(
    """
..........
.######...
.#....#...
.#....#...
.######...
..........
..........
""",
    4,
)


def test_an_unreachable_cell_is_infinite_and_a_goal_there_has_no_plan():
    navmap, _ = map_of(ENCLOSED)
    pose = Pose(0.3, 0.2, 0.0)
    planner = Planner(STRAIGHT, visited_ground)
    free = planner.free_space(navmap, pose, CollisionLayer.NONE)
    inside = np.zeros(free.frame.shape, bool)
    inside[14:16, 12:14] = True
    assert free.traversable[15, 13]
    assert planner.route(Goal(free, inside), pose) is None
    outside = np.zeros_like(inside)
    outside[-2, -2] = True
    plan = planner.route(Goal(free, outside), pose)
    assert plan is not None
    assert np.isinf(plan.distance_m[15, 13])
    assert np.isinf(plan.distance_m[free.clearance_m == 0]).all()


def test_obstacles_are_dilated_by_fifteen_centimetres():
    navmap, pose = map_of("\n".join(["." * 21] * 10 + ["." * 10 + "#" + "." * 10] + ["." * 20 + "R"] + ["." * 21] * 9))
    free = Planner(STRAIGHT, visited_ground).free_space(navmap, pose, CollisionLayer.NONE)
    x, y = free.frame.mesh()
    centre_x, centre_y = free.frame.centres(10, 10)
    near = np.hypot(x - centre_x, y - centre_y) <= 0.15 + 1e-6
    np.testing.assert_array_equal(free.traversable, ~near)


def test_the_window_has_no_free_border():
    """A wall across the whole window cannot be passed round its ends."""
    text = "\n".join([*["." * 40] * 15, "#" * 40, *["." * 40] * 10, "." * 20 + "R" + "." * 19, *["." * 40] * 5])
    navmap, pose = map_of(text)
    planner = Planner(STRAIGHT, visited_ground)
    free = planner.free_space(navmap, pose, CollisionLayer.NONE)
    goal = np.zeros(free.frame.shape, bool)
    goal[-3, 20] = True
    assert free.traversable[-3, 20]
    assert planner.route(Goal(free, goal), pose) is None


MARKS_ACROSS = ["." * 24 + "www" + "." * 23] * 5
THROUGH_THE_MIDDLE = "." * 5 + "R" + "." * 18 + "www" + "." * 18 + "G" + "." * 4
CHANNEL = "\n".join(["#" * 50, *MARKS_ACROSS, THROUGH_THE_MIDDLE, *MARKS_ACROSS, "#" * 50])


def test_pessimistic_marks_close_what_the_optimistic_map_leaves_open():
    assert planned(CHANNEL, layer=CollisionLayer.PESSIMISTIC)[2] is None
    assert planned(CHANNEL, layer=CollisionLayer.OPTIMISTIC)[2] is not None
    assert planned(CHANNEL.replace("w", "n"), layer=CollisionLayer.OPTIMISTIC)[2] is None
    assert planned(CHANNEL.replace("w", "n"), layer=CollisionLayer.NONE)[2] is not None


def test_the_visited_trail_opens_the_path_through_marks():
    lines = CHANNEL.split("\n")
    lines[6] = lines[6].replace("www", "vvv").replace(".", "v")
    assert planned("\n".join(lines))[2] is not None


def wall_between(gap_cells: int) -> str:
    """Returns a map with robot and goal on opposite sides of a one-cell wall; the path around its top is long."""
    rows = [["."] * 40 for _ in range(60)]
    for r in range(60 - gap_cells):
        rows[59 - r][20] = "#"
    rows[50][14], rows[50][26] = "R", "G"
    return "\n".join("".join(r) for r in rows)


@pytest.mark.parametrize("dilation_m", [0.15, 0.04])
@pytest.mark.parametrize("yaw_deg", range(0, 360, 30))
def test_no_short_term_goal_lies_across_a_one_cell_wall(yaw_deg: int, dilation_m: float):
    config = PlanningConfig(edge_speed=1.0, dilation_m=dilation_m)
    planner, free, plan, pose = planned(wall_between(gap_cells=14), config, yaw_rad=math.radians(yaw_deg))
    assert plan is not None
    assert plan.length_m > 2.5
    for col in range(10, 17):  # up to where the body touches the wall
        near = replace(pose, x_m=float(free.frame.centres(0, col)[0]))
        navmap, _ = map_of(wall_between(gap_cells=14))
        free = planner.free_space(navmap, near, CollisionLayer.NONE)
        plan = planner.route(Goal(free, plan.goal.cells), near)
        assert plan is not None
        heading = near.yaw_rad + short_term_turn(plan, near, config)
        x_m, _ = replace(near, yaw_rad=heading).ahead(0.25)
        assert x_m < 20 * 0.05


def test_following_the_plan_goes_round_the_wall_and_arrives():
    text = wall_between(gap_cells=14)
    navmap, pose = map_of(text)
    planner = Planner(PlanningConfig(), visited_ground)
    goal = mask_of(text, "G")
    rows, cols = np.nonzero(goal)
    goal[rows[0] - 3 : rows[0] + 4, cols[0] - 3 : cols[0] + 4] = True
    poses = drive(planner, navmap, goal, pose, 60)
    assert goal[navmap.frame.cell(poses[-1].x_m, poses[-1].y_m)]
    assert all(not navmap.seen_obstacle[navmap.frame.cell(p.x_m, p.y_m)] for p in poses)


def test_turn_left_right_or_forward_by_fifteen_degrees():
    frame = GridFrame.around_start(81, 0.05)
    navmap = NavMap.empty(frame)
    planner = Planner(STRAIGHT, visited_ground)
    for bearing_deg, action in ((0, Action.MOVE_FORWARD), (60, Action.TURN_LEFT), (-60, Action.TURN_RIGHT)):
        pose = Pose(0.0, 0.0, 0.0)
        goal = np.zeros(frame.shape, bool)
        bearing = math.radians(bearing_deg)
        goal[frame.cell(1.5 * math.cos(bearing), 1.5 * math.sin(bearing))] = True
        free = planner.free_space(navmap, pose, CollisionLayer.NONE)
        plan = planner.route(Goal(free, goal), pose)
        assert isinstance(plan, Route)
        assert next_action(plan, pose, planner.config) is action


def test_a_robot_hemmed_in_by_its_own_marks_still_leaves_along_its_trail():
    lines = [["."] * 41 for _ in range(41)]
    for r in range(12, 29):
        for c in range(12, 29):
            lines[r][c] = "w"
    for c in range(5, 21):
        for r in (19, 20, 21):
            lines[r][c] = "v"
    lines[20][20], lines[20][2] = "R", "G"
    planner, _, plan, pose = planned("\n".join("".join(r) for r in lines))
    assert plan is not None
    assert abs(short_term_turn(plan, pose, planner.config)) == pytest.approx(math.pi, abs=0.3)


def test_routes_keep_clear_of_obstacles_where_there_is_room():
    rows = [["."] * 60 for _ in range(50)]
    for c in range(10, 50):
        rows[30][c] = "#"
    rows[26][5], rows[26][55] = "R", "G"
    text = "\n".join("".join(r) for r in rows)
    clearances = []
    for config in (STRAIGHT, PlanningConfig()):
        navmap, pose = map_of(text)
        planner = Planner(config, visited_ground)
        goal = mask_of(text, "G")
        goal[20:28, 50:58] = True
        poses = drive(planner, navmap, goal, pose, 40)
        free = planner.free_space(navmap, pose, CollisionLayer.NONE)
        clearances.append(np.mean([free.clearance_m[free.frame.cell(p.x_m, p.y_m)] for p in poses]))
    assert clearances[1] > clearances[0] + 0.02


@pytest.mark.parametrize(
    ("field", "value", "allowed"),
    [
        ("edge_speed", 0.0, "lie in (0, 1]"),
        ("unseen_speed", -0.5, "lie in (0, 1]"),
        ("ring_m", 0.0, "be > 0 m"),
        ("dilation_m", -0.1, "be >= 0"),
        ("clearance_cost", math.nan, "be >= 0"),
    ],
)
def test_a_planner_that_could_not_end_is_refused(field: str, value: float, allowed: str):
    with pytest.raises(ConfigError, match=re.escape(f"PlanningConfig.{field} must {allowed}, got {value}")):
        PlanningConfig(**{field: value})
