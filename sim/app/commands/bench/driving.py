"""Parts (m) and (n): steps per second driven by velocities, and with the lidar, against the discrete environment."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import gymnasium
import numpy as np

from sim.app.commands.bench.figures import Figure, timed
from sim.app.commands.bench.stages import SENSORS, Setting
from sim.core.interface import SCAN, Action
from sim.env.discrete import DiscreteActions
from sim.env.objectnav import ObjectNavEnv
from sim.env.velocity import ObjectNavVelocityEnv

MOST_STEPS = 300
"""Steps of each environment at most."""
_MOVES = (Action.MOVE_FORWARD, Action.TURN_LEFT, Action.TURN_RIGHT)


class Walk:
    """An environment that is driven at random, through episodes of `val` in their order; resets are not timed."""

    def __init__(self, env: gymnasium.Env[Any, Any], draw: Callable[[np.random.Generator], Any]) -> None:
        base = env.unwrapped
        assert isinstance(base, ObjectNavEnv)
        self.env, self._draw, self._rng = env, draw, np.random.default_rng(0)
        self._episodes = iter(base.split.episodes)
        self._over = True

    def step_ms(self) -> float:
        """Returns the milliseconds of one step."""
        if self._over:
            self.env.reset(seed=0, options={"episode": next(self._episodes)})
        outcome: list[Any] = []
        action = self._draw(self._rng)
        taken = timed(lambda: outcome.extend(self.env.step(action)))
        self._over = bool(outcome[2] or outcome[3])
        return taken


def velocities(setting: Setting) -> list[Figure]:
    """(m) Measures control periods of velocities, and discrete actions performed by them, against discrete actions."""
    periods, actions = ObjectNavVelocityEnv(sensors=SENSORS), ObjectNavVelocityEnv(sensors=SENSORS)
    space = periods.action_space
    assert isinstance(space, gymnasium.spaces.Box)
    low, high = space.low * [1, 1, 0], space.high * [1, 1, 0]  # no STOP
    walks = {
        "discrete": Walk(ObjectNavEnv(sensors=SENSORS), lambda rng: rng.choice(_MOVES)),
        "periods": Walk(periods, lambda rng: rng.uniform(low, high).astype(np.float32)),
        "by velocities": Walk(DiscreteActions(actions), lambda rng: rng.choice(_MOVES)),
    }
    rates = _rates(walks, min(MOST_STEPS, setting.amount.steps))
    return [
        _figure("m", "control periods a second, 0.1 s each", rates["periods"], rates["discrete"], setting),
        _figure("m", "discrete actions a second by velocities", rates["by velocities"], rates["discrete"], setting),
    ]


def lidar(setting: Setting) -> list[Figure]:
    """(n) Measures steps with the lidar, 360 rays, against those without."""
    with_scan, without = ObjectNavEnv(sensors=(*SENSORS, SCAN)), ObjectNavEnv(sensors=SENSORS)
    walks = {
        name: Walk(env, lambda rng: rng.choice(_MOVES)) for name, env in (("with", with_scan), ("without", without))
    }
    rates = _rates(walks, min(MOST_STEPS, setting.amount.steps))
    figure = _figure("n", "steps a second with the lidar", rates["with"], rates["without"], setting, "without it")
    return [figure]


def _rates(walks: Mapping[str, Walk], count: int) -> dict[str, float]:
    """Returns the steps per second of each environment; they take turns step by step."""
    ms = dict.fromkeys(walks, 0.0)
    for _ in range(count):
        for name, walk in walks.items():
            ms[name] += walk.step_ms()
    for walk in walks.values():
        walk.env.close()
    return {name: 1e3 * count / taken for name, taken in ms.items()}


def _figure(
    part: str, what: str, rate: float, baseline: float, setting: Setting, against: str = "discrete actions"
) -> Figure:
    return Figure(
        part=part, what=what, value=rate, unit="/s", against=against, baseline=baseline, ratio=rate / baseline,
        count=min(MOST_STEPS, setting.amount.steps),
    )  # fmt: skip
