"""Agents as a user would declare them, for tests of the composition root."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from sim.core.interface import Action, AgentSpec, CameraModel, Observation
from sim.sensors.sensor import SensorContext

SEEN: list[set[str]] = []
"""Keys of each observation that a `Spy` got in this process."""


@dataclass(frozen=True, kw_only=True)
class SpyConfig:
    """An option that only this agent has."""

    prompt: str = ""
    forwards: int = 2


class Spy:
    """Records the keys of its observations, drives forward a few times and stops."""

    def __init__(self, config: SpyConfig | None = None, **parts: object) -> None:
        self.config = config or SpyConfig()
        self.given = parts

    def reset(self, goal: str, seed: int) -> None:
        self.step = 0

    def act(self, observation: Observation) -> Action:
        SEEN.append(set(observation))
        assert all(isinstance(value, np.ndarray) for value in observation.values())
        self.step += 1
        return Action.MOVE_FORWARD if self.step <= self.config.forwards else Action.STOP


def make_spy(**parts: object) -> Spy:
    """Builds an agent without a declaration of its needs."""
    return Spy(**parts)  # type: ignore[arg-type]


def make_narrow(*, camera: object, robot: object) -> Spy:
    """Builds an agent, but accepts too few arguments."""
    return Spy()


SPY = AgentSpec(make=make_spy, description="notes what it sees", config=SpyConfig(), sensors=("depth",))
CHEAT = AgentSpec(make=make_spy, sensors=("semantic",), uses_ground_truth=True, uses_segmentation=False)
NUMBER = 3


class Ahead:
    """A sensor of the agent's own: the smallest depth in the middle of the image, metres."""

    name, images, noise = "ahead", ("depth",), None

    def space(self, camera: CameraModel) -> spaces.Box:
        return spaces.Box(0.0, camera.max_depth_m, (1,), np.float32)

    def read(self, context: SensorContext) -> NDArray:
        height, width = context.images["depth"].shape
        return context.images["depth"][height // 2, width // 3 : -width // 3].min(keepdims=True)


FEELER = AgentSpec(make=make_spy, sensors=("depth", Ahead()), uses_segmentation=False)


class Looker:
    """Tilts its camera once and stops; it notes on the class that it was freed."""

    freed = False

    def reset(self, goal: str, seed: int) -> None:
        self.actions = [Action.STOP, Action.LOOK_UP]

    def act(self, observation: Observation) -> Action:
        return self.actions.pop()

    def close(self) -> None:
        Looker.freed = True


def make_looker(**parts: object) -> Looker:
    """Builds an agent that tilts its camera."""
    return Looker()


LOOKER = AgentSpec(make=make_looker, sensors=("rgb",), uses_segmentation=False, looks=True)
