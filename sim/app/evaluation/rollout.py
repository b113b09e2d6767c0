"""Runs one episode with one agent and returns its result."""

from __future__ import annotations

import reprlib
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

import msgspec
import numpy as np
from msgspec import UNSET, UnsetType

from sim.app.evaluation.own_code import MAX_CHARACTERS, described, one_line, text_of
from sim.app.evaluation.watch import count_steps, is_stop, marked
from sim.app.viewers.viewer import Moment, Viewer
from sim.core.errors import AgentError, PhysicsError, debug
from sim.core.geometry.pose import Pose
from sim.core.interface import (
    MOVES,
    Action,
    Agent,
    KeepsMemory,
    Observation,
    StatesConfidence,
    StatesModelUse,
    StatesTarget,
    as_action,
)
from sim.core.reading import FARTHEST_M, convert
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.task.result import EpisodeMetrics, ModelUse, RolloutResult, failed_metrics
from sim.task.trajectory import Recording, trajectory_file, write_trajectory

T = TypeVar("T")


def play_episode(
    env: ObjectNavEnv,
    agent: Agent,
    episode: Episode,
    *,
    seed: int,
    seed_of_agent: int | None = None,
    viewers: Sequence[Viewer] = (),
    name: str | None = None,
) -> RolloutResult:
    """Runs the agent until it stops, the steps are used up, or the physics or the agent fail.

    Args:
        env: the environment.
        agent: the agent.
        episode: the episode.
        seed: seed of the environment.
        seed_of_agent: seed of the agent; None: that of the environment.
        viewers: informed of each step; they change nothing.
        name: the agent's name in messages; that of its class when None.

    Returns:
        The result without the episode and the agent.

    Raises:
        AgentError: the agent's `reset` or `model_use` failed; a failure of `act` ends the episode as `error`.
        EpisodeError, HouseError: the episode cannot begin.
    """
    name = type(agent).__name__ if name is None else name
    count_steps(0)
    observation, _ = env.reset(seed=seed, options={"episode": episode})
    goal, seed_of_agent = episode.specs[0].told, seed if seed_of_agent is None else seed_of_agent
    ask(f"Agent '{name}', reset", lambda: agent.reset(goal, seed_of_agent))
    for viewer in viewers:
        viewer.begin(env)
    began_s = time.perf_counter()
    running = _RunningEpisode(env, agent, name, viewers, observation, seed_of_agent)
    while not running.done:
        running.step()
    wall_time_s = time.perf_counter() - began_s
    result = running.result(wall_time_s)
    for viewer in viewers:
        viewer.end(result)
    return result


@dataclass
class _RunningEpisode:
    """A running episode: its environment and agent, and its state so far."""

    env: ObjectNavEnv
    agent: Agent
    name: str
    viewers: Sequence[Viewer]
    observation: Observation
    seed: int
    """Seed of the agent."""
    steps: int = 0
    done: bool = False
    error: str | None = None
    """Message of the error that ended the episode; None: no error."""
    confidence: float | None = None
    """The agent's confidence at its STOP."""

    def step(self) -> None:
        """Asks the agent for an action and carries it out; a failure ends the episode."""
        try:
            action = self._decide()
            self._carry_out(action)
        except AgentError as failure:
            self.error, self.done = str(failure), True
        except PhysicsError as failure:
            self.error, self.done = f"Step {self.steps + 1}: {failure}", True

    def _decide(self) -> Action:
        where = f"Agent '{self.name}', step {self.steps + 1}"
        action = next_action(self.agent, self.observation, where, self.env.actions)
        if action is Action.STOP:
            self.confidence = confidence_of(self.agent, where)
            record_target(self.env, self.observation, target_of(self.agent, where))
        images = self.env.truth_images
        moment = Moment(step=self.steps + 1, observation=self.observation, images=images, action=action)
        for viewer in self.viewers:
            viewer.decided(moment)
        return action

    def _carry_out(self, action: Action) -> None:
        goal_number = self.env.scene.task.goal_number
        self.observation, _, terminated, truncated, info = self.env.step(action)
        self.steps += 1
        count_steps(self.steps)
        self.done = terminated or truncated
        for viewer in self.viewers:
            viewer.moved(info)
        task = self.env.scene.task
        if task.goal_number != goal_number:
            where = f"Agent '{self.name}', step {self.steps}, goal {task.goal_number + 1}"
            give_next_goal(self.agent, task.goals[task.goal_number].told, self.seed, where)

    def result(self, wall_time_s: float) -> RolloutResult:
        """Returns the result of the episode, which took some seconds."""
        rate = self.steps / wall_time_s if self.steps else 0.0
        ended = rollout_result(
            self.env.scene.task.metrics(), self.error, self.confidence, round(wall_time_s, 3), round(rate, 2)
        )
        return msgspec.structs.replace(ended, model_use=model_use_of(self.agent, self.name))


def rollout_result(
    metrics: EpisodeMetrics,
    error: str | None,
    stop_confidence: float | None = None,
    wall_time_s: float = 0.0,
    steps_per_s: float = 0.0,
) -> RolloutResult:
    """Returns the result of an episode from its metrics; with an error it is a failure."""
    return RolloutResult(
        **msgspec.structs.asdict(metrics if error is None else failed_metrics(metrics)),
        stop_confidence=stop_confidence,
        wall_time_s=wall_time_s,
        steps_per_s=steps_per_s,
        error=None if error is None else one_line(error, 2 * MAX_CHARACTERS),
    )


def ask(where: str, call: Callable[[], T]) -> T:
    """Returns what a call of the agent returns.

    Raises:
        AgentError: it raised an error, or called `exit`; the message begins with `where` and ends with the file and
            line of the user's code.
    """
    try:
        with marked(where):
            return call()
    except BaseException as error:  # also `SystemExit`, `CancelledError` and classes of users
        if is_stop(error):
            raise
        if debug():
            traceback.print_exc()
        if isinstance(error, AgentError):  # a part of the agent or a bridge raised it; its message names the place
            raise AgentError(f"{where}: {text_of(error)}") from error
        raise AgentError(f"{where}: {described(error, below=__file__)}") from error


def give_next_goal(agent: Agent, goal: str, seed: int, where: str) -> None:
    """Gives an agent the next goal of a chain: by `next_goal` if it keeps its memory, else by `reset`.

    Raises:
        AgentError: the call failed; the message begins with `where`.
    """
    if isinstance(agent, KeepsMemory):
        ask(where, lambda: agent.next_goal(goal))
    else:
        ask(where, lambda: agent.reset(goal, seed))


def next_action(agent: Agent, observation: Observation, where: str, actions: Sequence[Action] = MOVES) -> Action:
    """Returns the agent's next action.

    Raises:
        AgentError: `act` failed, or returned something else; the message begins with `where`.
    """
    chosen = ask(where, lambda: agent.act(observation))
    action = as_action(chosen)
    if action is not None and action in actions:
        return action
    hint = (
        "" if action is None else " `AgentSpec(looks=True)`, or --config agent.looks=true, allows to tilt the camera."
    )
    names = ", ".join(f"{action.value} {action.name}" for action in actions)
    raise AgentError(f"{where}: act() returned {reprlib.repr(chosen)}; an action is one of {names}.{hint}")


def confidence_of(agent: Agent, where: str) -> float | None:
    """Returns how sure the agent is of the object for which it stops, in [0, 1]; None if it does not state it.

    Raises:
        AgentError: `stop_confidence` failed, or returned something else; the message begins with `where`.
    """
    if not isinstance(agent, StatesConfidence):
        return None
    confidence = ask(where, agent.stop_confidence)
    if confidence is None:
        return None
    if not isinstance(confidence, (int, float, np.number)) or not 0.0 <= confidence <= 1.0:
        raise AgentError(
            f"{where}: stop_confidence() returned {reprlib.repr(confidence)}; it is a number in [0, 1], or None."
        )
    return round(float(confidence), 6)


def model_use_of(agent: Agent, name: str) -> ModelUse | UnsetType:
    """Returns what an agent asked of a model; UNSET if it does not state it.

    Raises:
        AgentError: `model_use` failed, or returned something else.
    """
    if not isinstance(agent, StatesModelUse):
        return UNSET
    where = f"Agent '{name}', model_use"
    return convert(ask(where, agent.model_use), ModelUse, where=where, error=AgentError)


def target_of(agent: Agent, where: str) -> tuple[float, float] | None:
    """Returns the place for which the agent stops, x and y in the start frame; None if it does not state it.

    Raises:
        AgentError: `stop_target_xy_m` failed, or returned something else; the message begins with `where`.
    """
    if not isinstance(agent, StatesTarget):
        return None
    stated = ask(where, agent.stop_target_xy_m)
    if stated is None:
        return None
    try:
        place = np.asarray(stated, np.float64)
    except Exception:  # a tensor with a gradient raises its own
        place = np.zeros(0)
    if place.shape != (2,) or not (np.abs(place) <= FARTHEST_M).all():
        raise AgentError(
            f"{where}: stop_target_xy_m() returned {reprlib.repr(stated)}; it is a pair of numbers, at most "
            f"{FARTHEST_M:g} m from 0, or None."
        )
    x_m, y_m = place.tolist()
    return x_m, y_m


def record_target(env: ObjectNavEnv, observation: Observation, target_xy_m: tuple[float, float] | None) -> None:
    """Records, in the world frame, the place for which an agent stops (`target_of`); None: it states none.

    The place is taken relative to the pose that the agent observed, and applied to the true pose: noise of `gps` and
    `compass` then does not count as a wrong place.
    """
    if target_xy_m is None:
        return
    scene = env.scene
    observed = Pose(float(observation["gps"][0]), float(observation["gps"][1]), float(observation["compass"][0]))
    ahead = Pose(*target_xy_m, 0.0).relative_to(observed)
    x_m, y_m = scene.world.pose.place_of(ahead.x_m, ahead.y_m)
    scene.task.stops_for(round(x_m, 6), round(y_m, 6))


def record_episode(env: ObjectNavEnv, run: Path, recording: Recording) -> None:
    """Writes the trajectory of the episode that has just ended to `trajectories/` in the folder of a run.

    Raises:
        ConfigError: the folder is not writable.
    """
    result, trajectory = recording.scores, env.scene.task.trajectory()
    trajectory = replace(trajectory, success=result.success == 1.0, end_reason=result.end_reason)
    write_trajectory(trajectory_file(run, result.episode_id), trajectory, recording)
