"""Parts (c), (d) and (e): time of an environment step, of an agent step, and of whole episodes."""

from __future__ import annotations

import time

import numpy as np

from sim.app.commands.bench.figures import Figure, Goal, stopwatch
from sim.app.commands.bench.stages import SENSORS, Rig, Setting, stubborn_agent
from sim.app.composition.segmenters import KINDS
from sim.app.evaluation.rollout import play_episode
from sim.env.objectnav import ObjectNavEnv
from sim.renderer.camera import Camera
from sim.task.objectnav import Task
from sim.world.world import World
from stubborn.mapping.mapper import Mapper
from stubborn.segmentation.ground_truth import GroundTruthSegmenter

STEP_GOALS_MS = {"gt": 5.0, "rednet": 45.0}
"""Largest median time of an agent step, by source of segmentation."""
FIXED_EVERY = 20
"""Number of steps between two pieces of fixed work."""
_WORLD = {
    "physics": [(World, "move")],
    "rendering": [(Camera, "render")],
    "task": [(Task, "observe")],
}
_MAPPING = [(Mapper, "add_depth"), (Mapper, "add_scores")]


def environment_step(setting: Setting) -> list[Figure]:
    """(c) Measures a step of the environment and its parts: physics, rendering and task."""
    whole, parts, render = _split_steps(setting, of_agent=False)
    return [
        _against("c", "a step of the environment", whole, render, "the fixed render"),
        *(_share("c", f"of it {name}", ms, whole, "the whole step") for name, ms in parts.items()),
    ]


def agent_step(setting: Setting) -> list[Figure]:
    """(d) Measures a step of the agent and its parts, with ground truth and with the network."""
    figures: list[Figure] = []
    for semantics, bound_ms in STEP_GOALS_MS.items():
        whole, parts, fixed_ms = _split_steps(setting, of_agent=True, semantics=semantics)
        parts["planning"] = whole - sum(parts.values())
        goal = Goal(of="value", sign="<=", bound=bound_ms)
        figures.append(
            _against("d", f"a step of the agent, {semantics}", whole, fixed_ms, "the fixed fast marching", goal)
        )
        for name, ms in sorted(parts.items()):
            figures.append(_share("d", f"of it {name}, {semantics}", ms, whole, "the whole step"))
    return figures


def whole_episodes(setting: Setting) -> list[Figure]:
    """(e) Measures episodes and steps per second of one process, including the loading of houses."""
    env = ObjectNavEnv(split="val", sensors=SENSORS)
    agent, steps, playing_s, cpu_s, fixed_ms = stubborn_agent(env), 0, 0.0, 0.0, []
    episodes = sorted(env.split.episodes[: setting.amount.episodes], key=lambda episode: episode.house)
    began_s = time.perf_counter()
    for episode in episodes:
        env.reset(seed=0, options={"episode": episode})  # compiles a new house and builds its grid
        cpu_began_s = time.process_time()
        line = play_episode(env, agent, episode, seed=0)
        cpu_s += time.process_time() - cpu_began_s
        steps, playing_s = steps + line["num_steps"], playing_s + line["wall_time_s"]
        fixed_ms += [setting.calibrator.render_ms() for _ in range(3)]
    all_s = time.perf_counter() - began_s - 1e-3 * sum(fixed_ms)
    env.close()
    rate, count = steps / playing_s, len(episodes)
    render_rate = 1e3 / float(np.mean(fixed_ms))
    goal = Goal(of="value", sign=">=", bound=60.0)
    return [
        Figure(part="e", what="steps a second, a process, semantics gt, split val", value=rate, unit="/s",
               against="the fixed render", baseline=render_rate, ratio=rate / render_rate, goal=goal, count=count),
        Figure(part="e", what="steps a second of processor time", value=steps / cpu_s, unit="/s",
               against="by the clock", baseline=rate, ratio=steps / cpu_s / rate, count=count),
        Figure(part="e", what="episodes a minute, houses loaded", value=60 * count / all_s, unit="/min",
               against="without loading", baseline=60 * count / playing_s, ratio=playing_s / all_s, count=count),
    ]  # fmt: skip


def _split_steps(
    setting: Setting, *, of_agent: bool, semantics: str = "gt"
) -> tuple[np.ndarray, dict[str, np.ndarray], float]:
    """Returns milliseconds of each step and of its parts over the first episodes of val, and of the fixed work.

    The fixed work is fast marching for the agent and a render for the environment; the value is its median.
    """
    fixed = setting.calibrator.fast_marching_ms if of_agent else setting.calibrator.render_ms
    fixed_ms: list[float] = []
    env = ObjectNavEnv(
        split="val", sensors=("depth", *KINDS[semantics].spec.sensors), truth=KINDS[semantics].spec.truth
    )
    rig = Rig(env, stubborn_agent(env, semantics=semantics), env.split.episodes)
    whole: list[float] = []
    with stopwatch(_parts_of_agent(semantics) if of_agent else _WORLD) as ms:
        parts: dict[str, list[float]] = {name: [] for name in ms}
        rig.step()
        while len(whole) < setting.amount.steps:
            before = dict(ms)
            fresh = rig.over
            agent_ms, env_ms = rig.step()
            if fresh:  # the first step of an episode would count its reset
                continue
            if len(whole) % FIXED_EVERY == 0:
                fixed_ms.append(fixed())
            whole.append(agent_ms if of_agent else env_ms)
            for name, taken in ms.items():
                parts[name].append(taken - before[name])
    env.close()
    return np.array(whole), {name: np.array(taken) for name, taken in parts.items()}, float(np.median(fixed_ms))


def _parts_of_agent(semantics: str) -> dict[str, list[tuple[type, str]]]:
    if semantics == "gt":
        return {"mapping": _MAPPING, "detection": [(GroundTruthSegmenter, "scores")]}
    from stubborn.segmentation.network import NetworkSegmenter  # PyTorch, which the workers of part (i) must not hold

    return {"mapping": _MAPPING, "detection": [(NetworkSegmenter, "scores")]}


def _against(part: str, what: str, ms: np.ndarray, baseline: float, against: str, goal: Goal | None = None) -> Figure:
    median = float(np.median(ms))
    return Figure(
        part=part, what=what, value=median, unit="ms", against=against, baseline=baseline, ratio=median / baseline,
        goal=goal, count=len(ms),
    )  # fmt: skip


def _share(part: str, what: str, ms: np.ndarray, whole: np.ndarray, against: str) -> Figure:
    """Returns the figure of a part of a step; it compares means, because they add up."""
    return Figure(
        part=part, what=what, value=float(ms.mean()), unit="ms", against=against, baseline=float(whole.mean()),
        ratio=float(ms.mean() / whole.mean()), count=len(ms),
    )  # fmt: skip
