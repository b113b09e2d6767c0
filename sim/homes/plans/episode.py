"""ObjectNav in a plan: starts, metrics and end of an episode that a plan can give (docs/task.md)."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from sim.core.errors import EpisodeError
from sim.core.geometry.pose import Pose
from sim.core.interface import MAX_STEPS, Action
from sim.homes.plans.motion_kernels import interpolate
from sim.homes.plans.plan import Plan
from sim.homes.plans.robot import PlanMotion, PlanRobot
from sim.homes.plans.sight import Look, PlanCamera
from sim.task.metrics import EXPLORED_SHARE, per_metre, spl, steps_to_first_sight

MIN_DISTANCE_M = 2.0
"""Least geodesic distance from start to goal; half the largest one in a plan that has no such start."""


class PlanEpisode:
    """One episode: the robot, its camera, and the metrics so far."""

    def __init__(self, camera: PlanCamera, goal: str, start: Pose, *, max_steps: int = MAX_STEPS) -> None:
        """Starts the episode.

        Raises:
            EpisodeError: no STOP for the goal succeeds anywhere in the plan, or the start is off it.
        """
        self.plan: Plan = camera.plan
        require_goal(self.plan, goal)
        if not self.plan.frame.contains(*self.plan.frame.cell(start.x_m, start.y_m)):
            raise EpisodeError(f"Plan '{self.plan.name}': the start ({start.x_m:g}, {start.y_m:g}) m is outside of it.")
        self.camera, self.goal, self.start, self.max_steps = camera, goal, start, max_steps
        camera.reset()
        self.robot = PlanRobot(self.plan)
        self.robot.pose = start
        self.num_steps = 0
        self.path_length_m = 0.0
        self.collisions = 0
        self.first_seen_step: int | None = None
        """Number of actions before the first frame that showed the goal; None: no frame did so."""
        self.success = False
        self.stopped = False
        self.shortest_path_m = self.distance_m()

    @property
    def pose(self) -> Pose:
        """The robot's pose in the start frame."""
        return self.robot.pose.relative_to(self.start)

    @property
    def done(self) -> bool:
        """True: the robot has stopped, or the steps are used up."""
        return self.stopped or self.num_steps >= self.max_steps

    def distance_m(self) -> float:
        """Returns the geodesic distance to the nearest place where a STOP succeeds; inf: no path."""
        pose, frame = self.robot.pose, self.plan.frame
        row, col = frame.cell(pose.x_m, pose.y_m)
        field = self.plan.distance_m(self.goal)
        around = field[max(row - 1, 0) : row + 2, max(col - 1, 0) : col + 2]
        if np.isfinite(around).all() and around.shape == (3, 3):
            v = (pose.y_m - frame.origin_xy_m[1]) / frame.cell_m
            return float(interpolate(field, v, (pose.x_m - frame.origin_xy_m[0]) / frame.cell_m))
        return float(around.min(initial=math.inf))

    def see(self, look: Look) -> None:
        """Counts the frame from the present pose."""
        if self.first_seen_step is None and look.goal_share >= EXPLORED_SHARE:
            self.first_seen_step = self.num_steps

    def act(self, action: Action) -> PlanMotion:
        """Carries out an action.

        Raises:
            EpisodeError: the episode is over.
        """
        if self.done:
            raise EpisodeError("The episode has ended: start another before the next action.")
        motion = self.robot.move(action)
        self.num_steps += 1
        self.path_length_m += motion.moved_m
        self.collisions += motion.collided
        if action is Action.STOP:
            self.stopped = True
            row, col = self.plan.frame.cell(self.robot.pose.x_m, self.robot.pose.y_m)
            self.success = bool(self.plan.success_cells(self.goal)[row, col])
        return motion

    def metrics(self) -> Mapping[str, object]:
        """Returns the metrics so far, under the names of `docs/task.md`."""
        shortest_m = self.shortest_path_m if math.isfinite(self.shortest_path_m) else None
        area_m2 = self.camera.area_seen_m2
        return {
            "success": float(self.success),
            "spl": spl(self.success, shortest_m, self.path_length_m),
            "num_steps": self.num_steps,
            "path_length": self.path_length_m,
            "shortest_path": shortest_m,
            "collisions": self.collisions,
            "gt_explored": self.first_seen_step is not None,
            "first_seen_step": self.first_seen_step,
            "steps_to_first_sight": steps_to_first_sight(self.first_seen_step, self.max_steps),
            "area_seen_m2": area_m2,
            "area_per_metre": per_metre(area_m2, self.path_length_m),
        }


def draw_goal_and_start(plan: Plan, rng: np.random.Generator, goal: str | None = None) -> tuple[str, Pose]:
    """Returns a random goal of a plan, and a start from which it can be reached.

    The starts are those of `sim.episodes.drawing` without its upper limit of the distance: they may be farther away.

    Args:
        plan: the plan.
        rng: draws the goal and the start.
        goal: this goal is used, and only a start for it is sampled.

    Raises:
        EpisodeError: no goal of the plan can be reached, or not the given one.
    """
    goals = rng.permutation(np.array(plan.goals(), np.str_)).tolist() if goal is None else [require_goal(plan, goal)]
    for category in goals:
        distance_m = np.where(plan.slack_m > 0.02, plan.distance_m(category), np.inf)
        reachable = np.isfinite(distance_m)
        far = reachable & (distance_m >= MIN_DISTANCE_M)
        if not far.any() and reachable.any():
            far = reachable & (distance_m >= 0.5 * distance_m[reachable].max())
        cells = np.argwhere(far)
        if len(cells):
            x_m, y_m = plan.frame.to_metres(cells[rng.integers(len(cells))])
            return category, Pose(float(x_m), float(y_m), float(rng.uniform(-math.pi, math.pi)), plan.floor_z_m)
    raise EpisodeError(f"Plan '{plan.name}': {'no goal' if goal is None else f'no {goal}'} can be reached.")


def draw_goal(plan: Plan, rng: np.random.Generator, start: Pose) -> str:
    """Returns a random goal of a plan that can be reached from a start and is not reached there already.

    Raises:
        EpisodeError: the plan has no such goal.
    """
    row, col = plan.frame.cell(start.x_m, start.y_m)
    around = slice(max(row - 1, 0), max(row + 2, 0)), slice(max(col - 1, 0), max(col + 2, 0))
    goals = [goal for goal in plan.goals() if 0.0 < plan.distance_m(goal)[around].min(initial=math.inf) < math.inf]
    if not goals:
        raise EpisodeError(f"Plan '{plan.name}': no path to a goal begins at ({start.x_m:g}, {start.y_m:g}).")
    return goals[rng.integers(len(goals))]


def require_goal(plan: Plan, goal: str) -> str:
    """Returns a goal; raises EpisodeError if no STOP for it succeeds anywhere in the plan."""
    if goal not in plan.goals():
        raise EpisodeError(f"Plan '{plan.name}' has no goal '{goal}'. It has: {', '.join(plan.goals()) or 'no goal'}.")
    return goal
