"""A search in a plan: it explores until the goal is in view, and stops where a STOP succeeds."""

from __future__ import annotations

import numpy as np
import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import MAX_STEPS, Action
from sim.homes.plans.export import export_plans
from sim.homes.plans.plan import Plan
from sim.homes.plans.sight import PlanCamera
from sim.task.metrics import EXPLORED_SHARE
from sim.training.plan_env.walks import search
from stubborn.mapping.navmap import NavMap
from tests.helpers.worlds import bed_behind_a_wall


@pytest.fixture(scope="module")
def plan() -> Plan:
    """Returns the plan of two rooms in a row, with a bed in a corner of the second one."""
    (exported,) = export_plans(bed_behind_a_wall(-0.7), {})
    return exported


@pytest.mark.parametrize("yaw_rad", [0.0, 2.0, -2.0])
def test_a_search_ends_with_a_stop_in_reach_of_the_goal(plan: Plan, yaw_rad: float):
    start = Pose(-3.5, 1.0, yaw_rad)
    poses, actions = search(PlanCamera(plan), "bed", start, np.random.default_rng(0))
    assert len(poses) == len(actions) < 100
    assert actions[-1] is Action.STOP
    assert Action.STOP not in actions[:-1]
    assert poses[0] == start
    row, col = plan.frame.cell(poses[-1].x_m, poses[-1].y_m)
    assert plan.success_cells("bed")[row, col]


@pytest.mark.costly
def test_it_does_not_know_where_the_goal_is(plan: Plan, monkeypatch: pytest.MonkeyPatch):
    """Until a goal is in view, the search equals one in which no goal ever comes into view."""
    start = Pose(-3.5, 1.0, 2.0)
    camera = PlanCamera(plan)
    poses, actions = search(camera, "bed", start, np.random.default_rng(0))
    camera.reset()
    layers = NavMap.empty(plan.frame)
    shares = [camera.look(pose, "bed", layers, pose).goal_share for pose in poses]
    in_view = next(step for step, share in enumerate(shares) if share >= EXPLORED_SHARE)
    assert in_view > 10
    monkeypatch.setattr("sim.training.plan_env.walks.EXPLORED_SHARE", 2.0)
    blind = search(PlanCamera(plan), "bed", start, np.random.default_rng(0))[1]
    assert blind[:in_view] == actions[:in_view]
    assert blind[: len(actions)] != actions
    monkeypatch.setattr("sim.training.plan_env.walks.EXPLORED_SHARE", -1.0)  # it would see the goal at once
    assert search(PlanCamera(plan), "bed", start, np.random.default_rng(0))[1][:in_view] != actions[:in_view]


def test_a_search_that_does_not_find_the_goal_has_no_stop(plan: Plan, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("sim.training.plan_env.walks.EXPLORED_SHARE", 2.0)  # nothing ever counts as in view
    _, actions = search(PlanCamera(plan), "bed", Pose(-3.5, 1.0, 0.0), np.random.default_rng(0))
    assert len(actions) == MAX_STEPS
    assert Action.STOP not in actions
