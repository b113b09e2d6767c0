"""How an episode starts, what counts while it runs, and when it ends (contract, section 2)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from sim.errors import EpisodeError
from sim.geometry.pose import Pose
from sim.interface import MAX_STEPS, Action, ConfigError
from sim.robot.drive import Motion
from sim.task import metrics
from sim.task.failures import Cause, cause_of_failure
from sim.task.ground_truth import GroundTruth
from sim.task.trajectory import Recorder, Trajectory
from sim.world.world import World

EndReason = Literal["stop", "max_steps"]
_SURELY_OUTSIDE_M = 0.1
"""A robot this far from the nearest cell that counts need not be tested exactly."""


@dataclass
class _Record:
    """What is known of the running episode."""

    goal: str
    start: Pose
    shortest_path_m: float | None
    """None: no way to the goal, which is on another storey."""
    positions_m: list[tuple[float, float]]
    """Of the robot's centre, the start first."""
    recorder: Recorder
    distance_m: float | None
    """From where the robot stands to the nearest place that satisfies success; None: no way."""
    path_length_m: float = 0.0
    collisions: int = 0
    touches: int = 0
    explored: bool = False
    trapped: bool = False
    success: bool = False
    end_reason: EndReason | None = None
    nearest_instance_m: float | None = None
    """At the end; see `sim.task.trajectory`."""
    failure: Cause | None = None


class Task:
    """ObjectNav in one world: watches the motions and the true segmentation, and keeps the metrics.

    Call `begin` after `World.reset`, `look` with the first frame, then `observe` after each motion.
    """

    def __init__(self, world: World, *, max_steps: int = MAX_STEPS) -> None:
        if max_steps < 1:
            raise ConfigError(f"max_steps must be at least 1, got {max_steps}.")
        self.truth = GroundTruth(world)
        self.max_steps = max_steps
        self.world = world
        self._record: _Record | None = None

    def begin(self, goal: str, start: Pose) -> None:
        """Start an episode.

        A goal whose only instances are on another storey can be asked for, as Habitat's splits do, but not be reached:
        its distances are None, its SPL 0. A goal that is on this storey and walled in is an episode gone wrong.

        Raises:
            EpisodeError: the goal is no goal category, is not in the house, or is on the storey of the start without
                a way to it.
        """
        self._record = None
        shortest_path_m = self.distance_from(goal, start)
        on_storey = bool(self.truth.target(goal, start.floor_z_m).region.footprints)
        if shortest_path_m is None and on_storey:
            raise self.no_way(goal, start)
        recorder = Recorder(start, distance_m=shortest_path_m, goal_on_storey=on_storey)
        self._record = _Record(
            goal, start, shortest_path_m, [(start.x_m, start.y_m)], recorder, distance_m=shortest_path_m
        )

    def look(self, semantic: NDArray[np.uint8]) -> None:
        """Note what one frame of ground-truth segmentation (h, w) shows."""
        record, share = self._running, metrics.goal_share(semantic, self.goal)
        record.recorder.look(share)
        record.explored = record.explored or share >= metrics.EXPLORED_SHARE

    def observe(self, action: Action, motion: Motion, semantic: NDArray[np.uint8] | None = None) -> None:
        """Count one action, carried out by the world, and the frame seen after it.

        Raises:
            EpisodeError: the episode has not begun or is over.
        """
        record = self._running
        if record.end_reason is not None:
            raise EpisodeError(f"The episode has ended ({record.end_reason}): begin another before the next action.")
        pose = self.world.pose
        record.positions_m.append((pose.x_m, pose.y_m))
        record.path_length_m += motion.displacement_m
        record.collisions += motion.collided
        record.touches += bool(motion.contacts) and not motion.collided
        record.trapped = record.trapped or metrics.stayed_near(record.positions_m)
        if action == Action.STOP:
            record.success = self.truth.succeeds_now(record.goal, pose.x_m, pose.y_m, pose.floor_z_m)
        record.distance_m = self._distance_now()
        record.recorder.move(motion, pose, record.distance_m)
        if semantic is not None:
            self.look(semantic)
        if action == Action.STOP:
            self._end("stop")
        elif self.num_steps >= self.max_steps:
            self._end("max_steps")

    @property
    def goal(self) -> str:
        """The category that the episode asks for."""
        return self._running.goal

    @property
    def start(self) -> Pose:
        """Where the episode started."""
        return self._running.start

    @property
    def num_steps(self) -> int:
        """Actions so far, STOP included."""
        return len(self._running.positions_m) - 1

    @property
    def terminated(self) -> bool:
        """Whether the agent called STOP."""
        return self._running.end_reason == "stop"

    @property
    def truncated(self) -> bool:
        """Whether the steps are used up."""
        return self._running.end_reason == "max_steps"

    @property
    def done(self) -> bool:
        """Whether the episode is over."""
        return self._running.end_reason is not None

    @property
    def success(self) -> bool:
        """Whether the agent called STOP where the goal counts as found."""
        return self._running.success

    def distance_from(self, goal: str, pose: Pose) -> float | None:
        """Geodesic distance from a pose to the nearest place that satisfies success; None where there is no way."""
        target, space = self.truth.target(goal, pose.floor_z_m), self.truth.space(pose.floor_z_m)
        distance_m = space.distance_at(target.distance_m, pose.x_m, pose.y_m)
        if distance_m < _SURELY_OUTSIDE_M and target.region.succeeds(pose.x_m, pose.y_m):
            return 0.0
        return distance_m if math.isfinite(distance_m) else None

    def no_way(self, goal: str, start: Pose) -> EpisodeError:
        """The error that says that a goal cannot be reached from a start."""
        return EpisodeError(
            f"House '{self.world.house.name}': there is no way from ({start.x_m:.2f}, {start.y_m:.2f}) m to a place "
            f"where '{goal}' would count as found."
        )

    def metrics(self) -> dict[str, Any]:
        """The contract's metrics as they stand now; `failure` is None until the episode has failed."""
        record = self._running
        distance_m = record.distance_m
        return {
            "success": float(record.success),
            "spl": metrics.spl(record.success, record.shortest_path_m, record.path_length_m),
            "soft_spl": metrics.soft_spl(record.shortest_path_m, distance_m, record.path_length_m),
            "distance_to_goal": distance_m,
            "num_steps": self.num_steps,
            "path_length": record.path_length_m,
            "shortest_path": record.shortest_path_m,
            "collisions": record.collisions,
            "touches": record.touches,
            "gt_explored": record.explored,
            "trapped": record.trapped,
            "failure": record.failure,
            "end_reason": record.end_reason,
        }

    def trajectory(self) -> Trajectory:
        """What the episode was so far, step by step."""
        record = self._running
        return record.recorder.trajectory(
            success=record.success, end_reason=record.end_reason, nearest_instance_m=record.nearest_instance_m
        )

    def _end(self, reason: EndReason) -> None:
        """The episode is over: say why it failed, if it did."""
        record, pose = self._running, self.world.pose
        record.end_reason = reason
        record.nearest_instance_m = self.truth.nearest_now_m(record.goal, pose.x_m, pose.y_m, pose.floor_z_m)
        record.failure = cause_of_failure(self.trajectory())

    @property
    def _running(self) -> _Record:
        if self._record is None:
            raise EpisodeError("No episode has begun: call begin() first.")
        return self._record

    def _distance_now(self) -> float | None:
        pose, record = self.world.pose, self._running
        if record.success:
            return 0.0
        if abs(pose.floor_z_m - record.start.floor_z_m) >= self.world.rule.same_storey_m:
            return None
        return self.distance_from(record.goal, pose)


class Stage(Protocol):
    """World and task of one house: what whoever knows the truth works with."""

    @property
    def world(self) -> World: ...  # noqa: D102
    @property
    def task(self) -> Task: ...  # noqa: D102
