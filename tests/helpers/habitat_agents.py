"""Agents as a user of Habitat would write them, for tests of the bridge."""

from __future__ import annotations

import random
from typing import Any

import numpy as np

from sim.app.bridges.habitat_client import Agent, Config
from sim.app.bridges.stubborn_client import MOVE_FORWARD, STOP

SEEN: list[dict[str, Any]] = []
"""Observations that a `Wanderer` got in this process."""


class Wanderer(Agent):
    """Turns where the depth ahead is small, and now and then at random; stops after some steps."""

    def __init__(self, stop_after: int = 100, keep: float = 0.1, **others: Any) -> None:
        self.stop_after, self.keep, self.others = stop_after, keep, others

    def reset(self) -> None:
        self.steps = 0

    def act(self, observations: dict[str, Any]) -> dict[str, Any]:
        SEEN.append(observations)
        self.steps += 1
        if self.steps > self.stop_after:
            return {"action": STOP}
        depth = observations["depth"]
        height, width, _ = depth.shape
        if depth[height // 2, width // 3 : -width // 3].min() < self.keep or np.random.rand() < 0.1:  # noqa: NPY002
            return {"action": random.choice(["TURN_LEFT", "TURN_RIGHT"])}
        return {"action": np.int64(MOVE_FORWARD)}


class Configured(Wanderer):
    """Needs the configuration of the run and a number."""

    def __init__(self, task_config: Config, distance: float) -> None:
        super().__init__(stop_after=2)
        self.task_config, self.distance = task_config, distance


class Placed(Wanderer):
    """Takes its arguments by their places."""

    def __init__(self, first: int = 1, second: int = 2, /) -> None:
        super().__init__()
        self.first, self.second = first, second


class NoAgent:
    """Lacks `act`."""

    def reset(self) -> None: ...


def arguments() -> dict[str, Any]:
    """Returns what a parser of command lines would."""
    import sys

    return {"argv": sys.argv[1:]}
