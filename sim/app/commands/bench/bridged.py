"""Part (l): an agent in a process of its own (`--agent process:COMMAND`): time of a step, and steps per second."""

from __future__ import annotations

import sys
import time
from typing import Any

import numpy as np

from sim.app.bridges.process import ProcessAgent
from sim.app.bridges.process_command import ProcessConfig
from sim.app.commands.bench.figures import Figure, Goal, timed
from sim.app.commands.bench.stages import Rig, Setting
from sim.core.interface import Action, Agent, CameraModel, Observation, RobotModel, SuccessRule
from sim.env.objectnav import ObjectNavEnv

MOST_MS = 2.0
"""Largest median time of a step at 640 x 480 with RGB and depth that the benchmark accepts."""
PAUSE_S = 0.005
"""Pause between two steps, as long as the simulator needs to render."""
_AGENT = """
from sim.app.bridges.stubborn_client import TURN_LEFT, serve
class Turner(object):
    def reset(self, goal, seed): pass
    def act(self, observation): return TURN_LEFT
serve(Turner())
"""


def agent_in_a_process(setting: Setting) -> list[Figure]:
    """(l) Measures a step of an agent that does nothing in another process, with shared memory and through pipes."""
    rng, camera = np.random.default_rng(0), CameraModel()
    observation = {
        "rgb": rng.integers(0, 256, (camera.height_px, camera.width_px, 3), np.uint8),
        "depth": rng.random((camera.height_px, camera.width_px), np.float32),
        "gps": np.zeros(2, np.float32),
        "compass": np.zeros(1, np.float32),
        "objectgoal": np.zeros(1, np.int64),
    }
    parts: dict[str, Any] = {"camera": camera, "robot": RobotModel(), "success": SuccessRule(), "max_steps": 500}
    agent = ProcessAgent([sys.executable, "-c", _AGENT], **parts, config=ProcessConfig())
    copies = [timed(lambda: {name: each.copy() for name, each in observation.items()}) for _ in range(20)]
    steps = min(500, setting.amount.steps)
    figures = []
    for channel, goal in (("shared memory", Goal(of="value", sign="<=", bound=MOST_MS)), ("pipes", None)):
        ms = _steps_ms(agent, observation, steps)
        value, baseline = float(np.median(ms)), float(np.median(copies))
        figures.append(
            Figure(
                part="l", what=f"a step in a process of its own, {channel}", value=value, unit="ms",
                against="a copy of the observation", baseline=baseline, ratio=value / baseline, goal=goal, count=steps,
            )
        )  # fmt: skip
        agent.share_no_memory()
    agent.close()
    return [*figures, _steps_per_second(parts, min(300, setting.amount.steps))]


class Turner:
    """The same agent in this process."""

    def reset(self, goal: str, seed: int) -> None:
        """Does nothing."""

    def act(self, observation: Observation) -> Action:
        """Turns left."""
        return Action.TURN_LEFT


def _steps_per_second(parts: dict[str, Any], steps: int) -> Figure:
    """Returns the steps per second with an agent in another process, against the same agent in this one."""
    there, ms = ProcessAgent([sys.executable, "-c", _AGENT], **parts, config=ProcessConfig()), {}
    agents: dict[str, Agent] = {"there": there, "here": Turner()}
    rigs = {}
    for name, agent in agents.items():
        env = ObjectNavEnv(sensors=("rgb", "depth"))
        rigs[name], ms[name] = Rig(env, agent, env.split.episodes), 0.0
    for _ in range(steps):
        for name, rig in rigs.items():
            ms[name] += sum(rig.step())
    there.close()
    for rig in rigs.values():
        rig.env.close()
    rate, baseline = (1e3 * steps / ms[name] for name in ("there", "here"))
    return Figure(
        part="l", what="steps a second, RGB and depth, in a process of its own", value=rate, unit="/s",
        against="in this process", baseline=baseline, ratio=rate / baseline, count=steps,
    )  # fmt: skip


def _steps_ms(agent: ProcessAgent, observation: Observation, steps: int) -> list[float]:
    """Returns the milliseconds of each step, after a few that are not measured."""
    agent.reset("chair", 0)
    taken = []
    for _ in range(steps + 3):
        taken.append(timed(lambda: agent.act(observation)))
        time.sleep(PAUSE_S)
    return taken[3:]
