"""One episode with one agent, to one result line."""

from __future__ import annotations

import math
import time
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from sim.env.objectnav import ObjectNavEnv
from sim.episodes.splits import Episode
from sim.errors import PhysicsError
from sim.interface import Action, Agent
from sim.task.trajectory import trajectory_file, write_trajectory
from sim.viewers.viewer import Moment, Watcher

TIMES = ("wall_time_s", "steps_per_s")
"""What differs between two runs of the same episode."""
OnStep = Callable[[int, Agent, dict[str, Any]], None]
"""Called with the number of the step, the agent and the environment's info after each step; pictures hang on it."""


def episode_seed(seed: int, episode_id: str) -> int:
    """A seed of the agent for this episode: hangs on the run's seed and the episode only, not on who played before."""
    return int(np.random.SeedSequence([seed, zlib.crc32(episode_id.encode())]).generate_state(1)[0])


def play_episode(
    env: ObjectNavEnv,
    agent: Agent,
    episode: Episode,
    *,
    seed: int,
    on_step: OnStep | None = None,
    watchers: Sequence[Watcher] = (),
) -> dict[str, Any]:
    """Run the agent until it stops, the steps are used up or the physics break; the watchers look on.

    Returns:
        The episode's line of `results.jsonl` but for what the run knows (`agent`, `semantics`, `seed`).
    """
    observation, info = env.reset(seed=seed, options={"episode": episode})
    agent.reset(episode.goal, seed)
    for watcher in watchers:
        watcher.begin(env)
    began_s = time.perf_counter()
    steps, error, done = 0, None, False
    while not done:
        action = Action(agent.act(observation))
        moment = Moment(step=steps + 1, observation=observation, images=env.truth_images, action=action)
        for watcher in watchers:
            watcher.decided(moment)
        try:
            observation, _, terminated, truncated, info = env.step(action)
        except PhysicsError as broken:
            error = f"Step {steps + 1}: {broken}"
            break
        steps += 1
        done = terminated or truncated
        if on_step is not None:
            on_step(steps, agent, info)
        for watcher in watchers:
            watcher.moved(info)
    wall_time_s = time.perf_counter() - began_s
    line = {key: _plain(value) for key, value in info.items() if key != "collided"}
    if error is not None:
        line |= broken_metrics(error)
    for watcher in watchers:
        watcher.end(line)
    return line | {"wall_time_s": round(wall_time_s, 3), "steps_per_s": round(steps / wall_time_s, 2) if steps else 0.0}


def record_episode(env: ObjectNavEnv, run: Path, line: Mapping[str, Any], about: Mapping[str, Any]) -> None:
    """Write the trajectory of the episode that has just been played.

    Args:
        env: in which it was played.
        run: folder of the run; the file goes to `trajectories/` in it.
        line: the episode's result line, `episode_id` included.
        about: what else names the episode; JSON's types.

    Raises:
        ConfigError: nothing can be written there.
    """
    start = env.episode.start
    pose = {"x_m": start.x_m, "y_m": start.y_m, "yaw_rad": start.yaw_rad, "floor_z_m": start.floor_z_m}
    scores = {key: value for key, value in line.items() if key not in TIMES}
    trajectory = env.scene.task.trajectory()
    trajectory = replace(trajectory, success=bool(line["success"]), end_reason=line["end_reason"])
    write_trajectory(trajectory_file(run, line["episode_id"]), trajectory, {**about, "start": pose, "scores": scores})


def broken_metrics(error: str) -> dict[str, Any]:
    """What a result line says of an episode that broke."""
    nothing = {"success": 0.0, "spl": 0.0, "soft_spl": 0.0, "failure": "misc"}
    return nothing | {"end_reason": "error", "error": error}


def _plain(value: Any) -> Any:
    """JSON's types, with null for what is not finite."""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
