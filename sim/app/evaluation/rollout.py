"""Runs one episode with one agent and returns its result line."""

from __future__ import annotations

import math
import reprlib
import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from sim.app.evaluation.own_code import MOST_LETTERS, one_line, place_of, text_of
from sim.app.evaluation.watch import count_steps, is_stop, marked
from sim.app.viewers.viewer import Moment, Viewer
from sim.core.errors import AgentError, PhysicsError, debug
from sim.core.geometry.pose import Pose
from sim.core.interface import Action, Agent, Observation, StatesConfidence, StatesTarget
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.task.trajectory import FARTHEST_M, trajectory_file, write_trajectory

TIMES = ("wall_time_s", "steps_per_s")
"""Keys of a result line that differ between two runs of the same episode."""
OnStep = Callable[[int, Agent, dict[str, Any]], None]
"""Called with the number of the step, the agent and the environment's info after each step."""


def play_episode(
    env: ObjectNavEnv,
    agent: Agent,
    episode: Episode,
    *,
    seed: int,
    seed_of_agent: int | None = None,
    on_step: OnStep | None = None,
    viewers: Sequence[Viewer] = (),
    name: str | None = None,
) -> dict[str, Any]:
    """Runs the agent until it stops, the steps are used up, or the physics or the agent fail.

    Args:
        env: the environment.
        agent: the agent.
        episode: the episode.
        seed: seed of the environment.
        seed_of_agent: seed of the agent; None: that of the environment.
        on_step: called after each step.
        viewers: informed of each step; they change nothing.
        name: the agent's name in messages; that of its class when None.

    Returns:
        The episode's line of `results.jsonl` without the fields of the run (`agent`, `semantics`, `seed`).

    Raises:
        AgentError: the agent's `reset` failed; a failure of `act` ends the episode as `error`.
        EpisodeError, HouseError: the episode cannot begin.
    """
    name = type(agent).__name__ if name is None else name
    count_steps(0)
    observation, info = env.reset(seed=seed, options={"episode": episode})
    ask(f"Agent '{name}', reset", lambda: agent.reset(episode.goal, seed if seed_of_agent is None else seed_of_agent))
    for viewer in viewers:
        viewer.begin(env)
    began_s = time.perf_counter()
    running = _RunningEpisode(env, agent, name, on_step, viewers, observation, info)
    while not running.done:
        running.step()
    wall_time_s = time.perf_counter() - began_s
    line = running.line()
    for viewer in viewers:
        viewer.end(line)
    rate = running.steps / wall_time_s if running.steps else 0.0
    return line | {"wall_time_s": round(wall_time_s, 3), "steps_per_s": round(rate, 2)}


@dataclass
class _RunningEpisode:
    """A running episode: its environment and agent, and its state so far."""

    env: ObjectNavEnv
    agent: Agent
    name: str
    on_step: OnStep | None
    viewers: Sequence[Viewer]
    observation: Observation
    info: dict[str, Any]
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
        action = next_action(self.agent, self.observation, where)
        if action is Action.STOP:
            self.confidence = confidence_of(self.agent, where)
            self._record_target(target_of(self.agent, where))
        images = self.env.truth_images
        moment = Moment(step=self.steps + 1, observation=self.observation, images=images, action=action)
        for viewer in self.viewers:
            viewer.decided(moment)
        return action

    def _record_target(self, target_xy_m: tuple[float, float] | None) -> None:
        """Records, in the world frame, the place for which the agent stops.

        It is taken relative to the pose that the agent observed, and applied to the true pose: noise of `gps` and
        `compass` then does not count as a wrong place.
        """
        if target_xy_m is None:
            return
        scene, observation = self.env.scene, self.observation
        observed = Pose(float(observation["gps"][0]), float(observation["gps"][1]), float(observation["compass"][0]))
        ahead = Pose(*target_xy_m, 0.0).relative_to(observed)
        x_m, y_m = scene.world.pose.place_of(ahead.x_m, ahead.y_m)
        scene.task.stops_for(round(x_m, 6), round(y_m, 6))

    def _carry_out(self, action: Action) -> None:
        self.observation, _, terminated, truncated, self.info = self.env.step(action)
        self.steps += 1
        count_steps(self.steps)
        self.done = terminated or truncated
        if self.on_step is not None:
            self.on_step(self.steps, self.agent, self.info)
        for viewer in self.viewers:
            viewer.moved(self.info)

    def line(self) -> dict[str, Any]:
        """Returns the result line without times."""
        line = {key: _plain(value) for key, value in self.info.items() if key != "collided"}
        line.setdefault("first_seen_step", None)  # `info` has it from the first sight on
        line["stop_confidence"] = self.confidence
        line |= self.env.scene.task.stop_target()
        return line if self.error is None else line | broken_metrics(self.error)


def ask(where: str, call: Callable[[], Any]) -> Any:
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
        reason = f"{type(error).__name__}: {text_of(error)}"
        raise AgentError(f"{where}: {reason}{place_of(error, below=__file__)}") from error


def next_action(agent: Agent, observation: Observation, where: str) -> Action:
    """Returns the agent's next action.

    Raises:
        AgentError: `act` failed, or returned something else; the message begins with `where`.
    """
    given = ask(where, lambda: agent.act(observation))
    try:
        return Action(given)
    except (ValueError, TypeError):
        actions = ", ".join(f"{action.value} {action.name}" for action in Action)
        raise AgentError(f"{where}: act() returned {reprlib.repr(given)}; an action is one of {actions}.") from None


def confidence_of(agent: Agent, where: str) -> float | None:
    """Returns how sure the agent is of the object for which it stops, in [0, 1]; None if it does not state it.

    Raises:
        AgentError: `stop_confidence` failed, or returned something else; the message begins with `where`.
    """
    if not isinstance(agent, StatesConfidence):
        return None
    given = ask(where, agent.stop_confidence)
    if given is None:
        return None
    if not isinstance(given, (int, float, np.number)) or not 0.0 <= given <= 1.0:
        raise AgentError(
            f"{where}: stop_confidence() returned {reprlib.repr(given)}; it is a number in [0, 1], or None."
        )
    return round(float(given), 6)


def target_of(agent: Agent, where: str) -> tuple[float, float] | None:
    """Returns the place for which the agent stops, x and y in the start frame; None if it does not state it.

    Raises:
        AgentError: `stop_target_xy_m` failed, or returned something else; the message begins with `where`.
    """
    if not isinstance(agent, StatesTarget):
        return None
    given = ask(where, agent.stop_target_xy_m)
    if given is None:
        return None
    try:
        place = np.asarray(given, np.float64)
    except Exception:  # a tensor with a gradient raises its own
        place = np.zeros(0)
    if place.shape != (2,) or not (np.abs(place) <= FARTHEST_M).all():
        raise AgentError(
            f"{where}: stop_target_xy_m() returned {reprlib.repr(given)}; it is a pair of numbers, at most "
            f"{FARTHEST_M:g} m from 0, or None."
        )
    x_m, y_m = place.tolist()
    return x_m, y_m


def record_episode(env: ObjectNavEnv, run: Path, line: Mapping[str, Any], about: Mapping[str, Any]) -> None:
    """Writes the trajectory of the episode that has just ended.

    Args:
        env: the environment of the episode.
        run: folder of the run; the file goes to `trajectories/` in it.
        line: the episode's result line, with `episode_id`.
        about: further metadata of the file; JSON types.

    Raises:
        ConfigError: the folder is not writable.
    """
    start = env.episode.start
    pose = {"x_m": start.x_m, "y_m": start.y_m, "yaw_rad": start.yaw_rad, "floor_z_m": start.floor_z_m}
    scores = {key: value for key, value in line.items() if key not in TIMES}
    trajectory = env.scene.task.trajectory()
    trajectory = replace(trajectory, success=bool(line["success"]), end_reason=line["end_reason"])
    write_trajectory(trajectory_file(run, line["episode_id"]), trajectory, {**about, "start": pose, "scores": scores})


def broken_metrics(error: str) -> dict[str, Any]:
    """Returns the entries of a result line for an episode that ended with an error."""
    zero = {"success": 0.0, "spl": 0.0, "soft_spl": 0.0, "failure": "misc"}
    return zero | {"end_reason": "error", "error": one_line(error, 2 * MOST_LETTERS)}


def _plain(value: Any) -> Any:
    """Returns a JSON type, with null for a number that is not finite."""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
