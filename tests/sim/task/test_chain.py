"""Chains of goals: each goal is measured like an episode that starts where the one before it ended."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest

from sim.core.errors import EpisodeError
from sim.core.geometry.pose import Pose
from sim.core.goals import GoalSpec
from sim.core.interface import Action
from sim.task.config import TaskConfig
from sim.task.objectnav import Task
from sim.task.result import EpisodeMetrics, failed_metrics
from sim.world.world import World
from tests.helpers.worlds import room, two_storeys, with_box

FORWARD, LEFT, STOP = Action.MOVE_FORWARD, Action.TURN_LEFT, Action.STOP
BED, TABLE, BED_AGAIN = (
    GoalSpec("bed", "category"),
    GoalSpec("the table", "words"),
    GoalSpec("bed", "category", None, 0),
)
TURN_ROUND = [LEFT] * 6
TO_TABLE, TO_BED = [*TURN_ROUND, *[FORWARD] * 12, STOP], [*TURN_ROUND, *[FORWARD] * 12, STOP]


def chain(*goals: GoalSpec, max_steps: int = 500) -> tuple[World, Task]:
    """Begins a chain at x = 0.5 in a room of 8 x 4 m with a bed that begins at x = 2 and a table that ends at -3."""
    house = with_box(room(8, 4), "bed_00", centre_m=(2.5, 0, 0.25), half_m=(0.5, 1.0, 0.25))
    world = World(with_box(house, "table_00", centre_m=(-3.5, 0, 0.25), half_m=(0.5, 1.0, 0.25)))
    task = Task(world, TaskConfig(max_steps=max_steps))
    world.reset(Pose(0.5, 0.0, 0.0))
    task.begin(goals, Pose(0.5, 0.0, 0.0))
    return world, task


def act(world: World, task: Task, *actions: Action) -> EpisodeMetrics:
    images = {"semantic": np.zeros((4, 4), np.uint8), "geom": np.full((4, 4), -1, np.int32)}
    for action in actions:
        task.observe(action, world.move(action), images)
    return task.metrics()


def test_a_stop_ends_a_goal_and_the_next_one_is_measured_from_there():
    world, task = chain(BED, TABLE, BED_AGAIN)
    act(world, task, FORWARD, FORWARD, STOP)
    assert task.ended_goal is not None
    assert (task.ended_goal.success, task.ended_goal.goal) == (1.0, "bed")
    assert task.success
    assert (task.goal, task.goal_number, task.done, task.num_steps) == ("the table", 1, False, 3)
    assert task.goal_metrics().shortest_path == pytest.approx(3.0, abs=0.05)
    act(world, task, LEFT)
    assert task.ended_goal is None
    result = act(world, task, *TO_TABLE[1:], *TO_BED)
    assert (task.done, task.terminated, result.end_reason) == (True, True, "stop")
    assert result.goals is not None
    assert [goal.num_steps for goal in result.goals] == [3, 19, 19]
    assert [goal.kind for goal in result.goals] == ["category", "words", "category"]
    for goal in result.goals:  # SPL restarts at each goal
        assert (goal.success, goal.failure) == (1.0, None)
        assert goal.spl == pytest.approx(1.0, abs=0.03)
    assert (result.success, result.composite_success, result.second_visit_success) == (1.0, 1.0, 1.0)
    assert result.second_visit_spl == result.goals[2].spl
    assert (result.num_steps, result.failure) == (41, None)
    assert result.path_length == pytest.approx(6.5, abs=0.02)


def test_a_wrong_stop_goes_on_with_the_next_goal_and_goats_rule_is_judged_beside_ours():
    world, task = chain(BED, TABLE)
    result = act(world, task, FORWARD, STOP, STOP)  # 0.25 m and 2.75 m from the nearest place that counts
    assert result.goals is not None
    assert [goal.success for goal in result.goals] == [0.0, 0.0]
    assert [goal.distance_to_goal for goal in result.goals] == pytest.approx([0.23, 2.75], abs=0.04)
    assert [goal.goat_success for goal in result.goals] == [1.0, 0.0]
    assert result.goals[0].goat_spl == pytest.approx(1.0, abs=0.05)
    assert (result.success, result.composite_success, result.goat_success) == (0.0, 0.0, 0.5)
    assert result.second_visit_spl is None
    assert (result.failure, result.end_reason) == (result.goals[0].failure, "stop")
    assert result.failure is not None


def test_steps_are_counted_for_each_goal():
    world, task = chain(BED, TABLE, max_steps=3)
    act(world, task, LEFT, LEFT, LEFT)
    assert (task.goal_number, task.done) == (1, False)
    result = act(world, task, LEFT, LEFT, LEFT)
    assert (task.truncated, result.num_steps, result.end_reason) == (True, 6, "max_steps")
    with pytest.raises(EpisodeError, match="has ended"):
        act(world, task, LEFT)


def test_the_trajectory_of_a_chain_is_that_of_all_goals():
    world, task = chain(BED, TABLE)
    act(world, task, FORWARD, FORWARD, STOP, LEFT, FORWARD, STOP)
    trajectory = task.trajectory()
    assert trajectory.actions.tolist() == [1, 1, 0, 2, 1, 0]
    assert len(trajectory.poses) == 7
    assert trajectory.distance_m[2] == pytest.approx(0.0, abs=0.01)
    assert trajectory.distance_m[3] == pytest.approx(3.0, abs=0.05)


def test_a_goal_that_was_not_begun_counts_as_a_failure():
    world, task = chain(BED, TABLE)
    result = act(world, task, FORWARD)
    assert result.goals is not None
    assert [(goal.goal, goal.success, goal.num_steps) for goal in result.goals] == [("bed", 0, 1), ("the table", 0, 0)]
    broken = failed_metrics(act(world, task, FORWARD, STOP))
    assert broken.goals is not None
    assert (broken.success, broken.goals[0].success, broken.goals[0].end_reason) == (0.0, 0.0, "error")


def test_a_chain_that_broke_has_no_score_by_any_rule():
    world, task = chain(BED, TABLE, BED_AGAIN)
    reached = act(world, task, FORWARD, FORWARD, STOP, *TO_TABLE, *TO_BED)
    assert min(reached.goat_success or 0.0, reached.second_visit_success or 0.0) > 0.0
    broken = failed_metrics(reached)
    scores = broken.composite_success, broken.second_visit_success, broken.second_visit_spl, broken.goat_success
    assert (*scores, broken.goat_spl) == (0.0,) * 5
    assert failed_metrics(act(*chain(BED, TABLE), STOP)).second_visit_success is None


def test_a_chain_with_a_goal_that_cannot_be_reached_is_refused():
    world = World(two_storeys())
    task = Task(world)
    start = Pose(0.0, 0.0, 0.0)
    world.reset(start)
    task.begin([BED, GoalSpec("sofa", "category")], start)  # on the other storey: allowed, as in Habitat's splits
    assert task.metrics().goals is not None
    with pytest.raises(EpisodeError, match="chair"):
        task.begin([BED, GoalSpec("chair", "category")], start)


def test_the_metrics_of_an_episode_with_one_goal_have_no_chain():
    world, task = chain(BED)
    fields = msgspec.to_builtins(act(world, task, FORWARD, FORWARD, STOP))
    assert fields["success"] == 1.0
    assert not {"goals", "goat_success", "composite_success", "second_visit_spl"} & set(fields)
