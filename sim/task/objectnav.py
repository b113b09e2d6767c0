"""The ObjectNav task: start of an episode, its metrics while it runs, and its end (docs/task.md)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import msgspec
import numpy as np
from numpy.typing import NDArray

from sim.core.errors import EpisodeError
from sim.core.geometry.pose import Pose
from sim.core.goals import GoalSpec
from sim.core.interface import GOAL_CATEGORIES, MPCAT40_ID, Action, CameraModel
from sim.robot.drive import Motion
from sim.task import metrics
from sim.task.chain import chain_metrics, goal_result, not_begun
from sim.task.config import TaskConfig
from sim.task.failures import TARGET_ON_GOAL_M, Cause, cause_of_failure
from sim.task.ground_truth import GroundTruth
from sim.task.result import NO_STOP_TARGET, EndReason, EpisodeMetrics, GoalResult, Limit, StopTarget
from sim.task.seen_floor import SeenFloor
from sim.task.trajectory import Recorder, Trajectory, by_action, joined
from sim.world.world import World

_EXACT_TEST_M = 0.1
"""Farther than this from the nearest cell where a STOP succeeds, the exact test of success is left out."""


@dataclass
class _Record:
    """State of the running episode, or of one goal of a chain."""

    spec: GoalSpec
    start: Pose
    shortest_path_m: float | None
    """None: there is no path, because the goal is on another storey."""
    positions_m: list[tuple[float, float]]
    """Positions of the robot's centre, the start first."""
    recorder: Recorder
    floor: SeenFloor
    distance_m: float | None
    """Geodesic distance from the robot to the nearest place where a STOP succeeds; None: no path."""
    path_length_m: float = 0.0
    simulated_s: float = 0.0
    collisions: int = 0
    touches: int = 0
    first_seen_step: int | None = None
    """Number of actions before the first frame that made GT exploration true; None: no frame did so."""
    trapped: bool = False
    success: bool = False
    end_reason: EndReason | None = None
    nearest_instance_m: float | None = None
    """Set at the end; see `sim.task.trajectory`."""
    stop: StopTarget = NO_STOP_TARGET
    failure: Cause | None = None

    @property
    def goal(self) -> str:
        """The text by which the objects are found."""
        return self.spec.text

    @property
    def steps(self) -> int:
        """Number of actions so far."""
        return len(self.positions_m) - 1


class Task:
    """ObjectNav in one world: it computes the metrics from the motions and the true segmentation.

    Call `begin` after `World.reset`, `look` with the first frame, then `observe` after each motion.

    In a chain of goals the end of a goal, by STOP or after `max_steps` actions, is the start of the next one: the robot
    stays where it is, and the metrics of the next goal begin. A fall ends the chain.

    Args:
        world: the compiled house with its robot.
        config: when a STOP succeeds, and the number of actions.
        camera: the robot's camera; see `GroundTruth`.
        steps_per_action: number of steps that take as long as a discrete action. `trapped` and the causes of failures
            look at windows of actions.
        limit: the reason that an episode ends after `max_steps` steps; of equal steps, the number is a time.
    """

    def __init__(
        self,
        world: World,
        config: TaskConfig | None = None,
        *,
        camera: CameraModel | None = None,
        steps_per_action: int = 1,
        limit: Limit = "max_steps",
    ) -> None:
        self.world = world
        self.config = config or TaskConfig()
        self._steps_per_action = steps_per_action
        self._limit: Limit = limit
        self.truth = GroundTruth(world, success=self.config.success, camera=camera)
        self._record: _Record | None = None
        self._ended: list[_Record] = []
        """The goals of a chain before the present one."""
        self._goals: tuple[GoalSpec, ...] = ()
        self._goal_geoms: NDArray[np.bool_] | None = None
        """Which geoms are the goal, where it is not a category."""
        self.ended_goal: GoalResult | None = None
        """The result of the goal that the last action ended; None: it ended none."""

    def begin(self, goals: str | GoalSpec | Sequence[GoalSpec], start: Pose) -> None:
        """Starts an episode with a goal or with a chain of goals.

        A goal whose only instances are on another storey is allowed, as in Habitat's splits, but cannot be reached:
        its distances are None, its SPL is 0. A goal on this storey that is walled in is an error.

        Raises:
            EpisodeError: a goal is unknown, is not in the house, or is on the storey of the start without a path to
                it.
        """
        self._record, self._ended, self.ended_goal = None, [], None
        self._goals = (GoalSpec.of(goals),) if isinstance(goals, str | GoalSpec) else tuple(goals)
        for goal in self._goals:
            target = self.truth.target(goal.text, start.floor_z_m)
            if target.region.footprints and self.distance_from(goal.text, start) is None:
                raise self.unreachable_error(goal.text, start)
        self._begin_goal(self._goals[0], start, self.truth.unseen_floor(start.floor_z_m))

    def _begin_goal(self, spec: GoalSpec, start: Pose, floor: SeenFloor) -> None:
        goal, shortest_path_m = spec.text, self.distance_from(spec.text, start)
        self._goal_geoms = None
        if goal not in GOAL_CATEGORIES:
            self._goal_geoms = np.zeros(
                self.world.model.ngeom + 1, np.bool_
            )  # the last entry is for pixels without one
            self._goal_geoms[[geom for instance in self.truth.instances(goal) for geom in instance.geom_ids]] = True
        on_storey = bool(self.truth.target(goal, start.floor_z_m).region.footprints)
        recorder = Recorder(start, distance_m=shortest_path_m, goal_on_storey=on_storey)
        self._record = _Record(
            spec,
            start,
            shortest_path_m,
            [(start.x_m, start.y_m)],
            recorder,
            floor,
            distance_m=shortest_path_m,
        )

    @property
    def images(self) -> tuple[str, ...]:
        """The true images that `look` needs: in a chain those of all goals, as a frame can be the first of the next."""
        by_category = all(goal.text in GOAL_CATEGORIES for goal in self._goals)
        return ("semantic",) if by_category and not self.is_chain else ("semantic", "geom")

    def goal_mask(self, images: Mapping[str, NDArray]) -> NDArray[np.bool_]:
        """Returns (h, w) the pixels of the goal in the true images that `images` names."""
        if self._goal_geoms is None:
            return images["semantic"] == MPCAT40_ID[self.goal]
        return self._goal_geoms[images["geom"]]

    def look(self, images: Mapping[str, NDArray]) -> None:
        """Counts one frame from the robot's pose: step 0 is the first one.

        Args:
            images: the true images that `images` names, (h, w) each.
        """
        record, semantic = self._running, images["semantic"]
        share = float(np.count_nonzero(self.goal_mask(images)) / semantic.size)
        record.recorder.look(share)
        if record.first_seen_step is None and share >= metrics.EXPLORED_SHARE:
            record.first_seen_step = record.steps
        record.floor.look(semantic, self.world.camera_pose)

    def observe(self, action: Action, motion: Motion, images: Mapping[str, NDArray] | None = None) -> None:
        """Counts one action that the world has carried out, and the frame rendered after it.

        Raises:
            EpisodeError: the episode has not begun or is over.
        """
        self.require_running()
        record, pose, self.ended_goal = self._running, self.world.pose, None
        record.positions_m.append((pose.x_m, pose.y_m))
        record.path_length_m += motion.displacement_m
        record.simulated_s += motion.duration_s
        record.collisions += motion.collided
        record.touches += bool(motion.contacts) and not motion.collided
        record.trapped = record.trapped or metrics.stayed_near(record.positions_m, self._steps_per_action)
        if action == Action.STOP:
            record.success = self.truth.succeeds_now(record.goal, pose.x_m, pose.y_m, pose.floor_z_m)
        record.distance_m = None if motion.fell else self._distance_now()
        record.recorder.move(motion, pose, record.distance_m)
        if images is not None:
            self.look(images)
        if motion.fell:
            self._end("fallen")
        elif action == Action.STOP:
            self._end("stop")
        elif record.steps >= self.config.max_steps:
            self._end(self._limit)
        if self.is_chain and record.end_reason is not None:
            self._go_on(record, images)

    def _go_on(self, record: _Record, images: Mapping[str, NDArray] | None) -> None:
        """Starts the next goal of a chain after one has ended, unless the robot fell."""
        self.ended_goal = goal_result(record.spec, self.goal_metrics())
        following = self.goal_number + 1
        if record.end_reason != "fallen" and following < len(self._goals):
            self._ended.append(record)
            self._begin_goal(self._goals[following], self.world.pose, record.floor)
            if images is not None:
                self.look(images)

    def require_running(self) -> None:
        """Raises EpisodeError if no further action is allowed: the episode has not begun, or is over."""
        if (reason := self._running.end_reason) is not None:
            raise EpisodeError(f"The episode has ended ({reason}): start another before the next action.")

    def stops_for(self, x_m: float, y_m: float) -> None:
        """Records the place in the world for which the agent is about to stop, as it states.

        The cause of a wrong STOP depends on it; to be called before `observe` of the STOP.
        """
        record, floor_z_m = self._running, self.world.pose.floor_z_m
        record.stop = StopTarget(
            stop_target_xy_m=(x_m, y_m),
            stop_target_to_goal_m=self.truth.nearest_now_m(record.goal, x_m, y_m, floor_z_m),
            stop_target_category=self.truth.category_at(
                x_m, y_m, floor_z_m, goal=record.goal, within_m=TARGET_ON_GOAL_M
            ),
        )

    @property
    def goal(self) -> str:
        """What the episode asks for: a category, words, or the label of an instance (`GroundTruth.instances`)."""
        return self._running.goal

    @property
    def goals(self) -> tuple[GoalSpec, ...]:
        """The goals of the episode in their order; one, unless it is a chain."""
        return self._goals

    @property
    def goal_number(self) -> int:
        """Number of the present goal in a chain, from 0 on."""
        return len(self._ended)

    @property
    def is_chain(self) -> bool:
        """True: the episode has several goals."""
        return len(self._goals) > 1

    @property
    def start(self) -> Pose:
        """Start pose of the episode; in a chain that of the present goal."""
        return self._running.start

    @property
    def num_steps(self) -> int:
        """Number of actions so far, STOP included."""
        return sum(record.steps for record in self._ended) + self._running.steps

    @property
    def terminated(self) -> bool:
        """True: the agent called STOP or drove over an edge."""
        return self._running.end_reason in ("stop", "fallen")

    @property
    def truncated(self) -> bool:
        """True: the episode reached its limit of steps or time."""
        return self._running.end_reason == self._limit

    @property
    def done(self) -> bool:
        """True: the episode is over."""
        return self._running.end_reason is not None

    @property
    def success(self) -> bool:
        """True: the agent called STOP where it succeeds; in a chain, its last action was such a STOP."""
        return self._running.success if self.ended_goal is None else bool(self.ended_goal.success)

    def distance_from(self, goal: str, pose: Pose) -> float | None:
        """Returns the geodesic distance from a pose to the nearest place where a STOP succeeds; None: no path."""
        target, space = self.truth.target(goal, pose.floor_z_m), self.truth.space(pose.floor_z_m)
        distance_m = space.distance_at(target.distance_m, pose.x_m, pose.y_m)
        if distance_m < _EXACT_TEST_M and target.region.succeeds(pose.x_m, pose.y_m):
            return 0.0
        return distance_m if math.isfinite(distance_m) else None

    def unreachable_error(self, goal: str, start: Pose) -> EpisodeError:
        """Returns the error for a goal that cannot be reached from a start."""
        if not self.truth.region(goal, start.floor_z_m).footprints:
            return EpisodeError(
                f"House '{self.world.house.name}' has '{goal}' on another storey only; the start is on the one at z = "
                f"{start.floor_z_m:g} m."
            )
        return EpisodeError(
            f"House '{self.world.house.name}': there is no path from ({start.x_m:.2f}, {start.y_m:.2f}) m to a place "
            f"where a STOP for '{goal}' succeeds."
        )

    def metrics(self) -> EpisodeMetrics:
        """Returns the metrics so far; `failure` is None until the episode has failed."""
        return chain_metrics(self.goal_results()) if self.is_chain else self.goal_metrics()

    def goal_metrics(self) -> EpisodeMetrics:
        """Returns the metrics of the present goal so far: those of the episode, unless it is a chain."""
        return self._metrics_of(self._running)

    def goal_results(self) -> list[GoalResult]:
        """Returns the results so far of all goals of a chain."""
        begun = [*self._ended, self._running]
        reason = begun[-1].end_reason
        results = [goal_result(record.spec, self._metrics_of(record)) for record in begun]
        return results + [not_begun(goal, reason) for goal in self._goals[len(begun) :]]

    def _metrics_of(self, record: _Record) -> EpisodeMetrics:
        distance_m = record.distance_m
        return EpisodeMetrics(
            success=float(record.success),
            spl=metrics.spl(record.success, record.shortest_path_m, record.path_length_m),
            soft_spl=metrics.soft_spl(record.shortest_path_m, distance_m, record.path_length_m),
            distance_to_goal=distance_m,
            num_steps=record.steps,
            path_length=record.path_length_m,
            shortest_path=record.shortest_path_m,
            collisions=record.collisions,
            touches=record.touches,
            gt_explored=record.first_seen_step is not None,
            first_seen_step=record.first_seen_step,
            steps_to_first_sight=metrics.steps_to_first_sight(record.first_seen_step, self.config.max_steps),
            area_seen_m2=record.floor.area_m2,
            area_per_metre=metrics.per_metre(record.floor.area_m2, record.path_length_m),
            trapped=record.trapped,
            simulated_s=record.simulated_s,
            failure=record.failure,
            end_reason=record.end_reason,
            **msgspec.structs.asdict(record.stop),
        )

    def trajectory(self) -> Trajectory:
        """Returns the trajectory of the episode so far."""
        return joined([_trajectory_of(record) for record in (*self._ended, self._running)])

    def _end(self, reason: EndReason) -> None:
        """Ends the episode and computes the cause of a failure."""
        record, pose = self._running, self.world.pose
        record.end_reason = reason
        record.nearest_instance_m = self.truth.nearest_now_m(record.goal, pose.x_m, pose.y_m, pose.floor_z_m)
        record.failure = cause_of_failure(by_action(_trajectory_of(record), self._steps_per_action))

    @property
    def _running(self) -> _Record:
        if self._record is None:
            raise EpisodeError("No episode has begun: call begin() first.")
        return self._record

    def _distance_now(self) -> float | None:
        pose, record = self.world.pose, self._running
        if record.success:
            return 0.0
        if abs(pose.floor_z_m - record.start.floor_z_m) >= self.config.success.same_storey_m:
            return None
        return self.distance_from(record.goal, pose)


def _trajectory_of(record: _Record) -> Trajectory:
    return record.recorder.trajectory(
        success=record.success,
        end_reason=record.end_reason,
        nearest_instance_m=record.nearest_instance_m,
        stop=record.stop,
    )
