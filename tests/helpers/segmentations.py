"""Segmentations as a user would bring them, for tests of the composition root."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.core.interface import MPCAT40_ID, Action, Observation, Perceived, Scores, SegmentationSpec, SegmenterSpec
from sim.env.objectnav import ObjectNavEnv

ASKED: list[set[str]] = []
"""Keys of each observation that a `Flat` got in this process."""


@dataclass(frozen=True)
class FlatConfig:
    """The option of `Flat`."""

    level: float = 0.25


class Flat:
    """Gives the same probability to all categories; remembers what it was given."""

    def __init__(self, config: FlatConfig) -> None:
        self.config = config

    def posteriors(self, observation: Observation) -> NDArray:
        ASKED.append(set(observation))
        height, width = observation["rgb"].shape[:2]
        return np.full((40, height // 4, width // 4), self.config.level, np.float32)


FLAT = SegmentationSpec(make=Flat, config=FlatConfig(), spec=SegmenterSpec(sensors=("rgb",), kind="flat"))


class Wrong:
    """Returns what a test says."""

    returned: object = None

    def scores(self, observation: Observation, goal: str) -> object:
        if isinstance(self.returned, Exception):
            raise self.returned
        return self.returned


class WrongNames(Wrong):
    """Returns what a test says as categories, too."""

    def categories(self, observation: Observation) -> object:
        return self.returned


class Truth:
    """Reads the true segmentation in the environment, and declares it."""

    spec = SegmenterSpec(sensors=(), truth=("semantic",), kind="truth")

    def __init__(self, truth: ObjectNavEnv) -> None:
        self.env = truth

    def scores(self, observation: Observation, goal: str) -> Scores:
        target = (self.env.truth_images["semantic"] == 10).astype(np.float32)
        return Scores(target, 1.0 - target)


class Stating:
    """An agent that brings a segmentation of its own and states it."""

    def __init__(self, **parts: object) -> None:
        pass

    def reset(self, goal: str, seed: int) -> None:
        self.seen: Perceived | None = None

    def act(self, observation: Observation) -> Action:
        target = np.full((12, 16), 0.5, np.float32)
        self.seen = Perceived(Scores(target, target), np.full((12, 16), 3, np.uint8))
        return Action.STOP

    def stated_segmentation(self) -> Perceived | None:
        return self.seen


@dataclass(frozen=True)
class BrightConfig:
    """The option of `Bright`."""

    bar: int = 100


class Bright:
    """Takes bright pixels for a sofa and dark ones for a wall."""

    spec = SegmenterSpec(sensors=("rgb",), kind="bright")

    def __init__(self, config: BrightConfig) -> None:
        self.config = config

    def posteriors(self, observation: Observation) -> NDArray:
        bright = observation["rgb"][..., 0] > self.config.bar
        posteriors = np.zeros((40, *bright.shape), np.float32)
        posteriors[MPCAT40_ID["sofa"] - 1], posteriors[MPCAT40_ID["wall"] - 1] = bright, ~bright
        return posteriors


BRIGHT = SegmentationSpec(make=Bright, config=BrightConfig(), spec=Bright.spec)


class BrightGoals:
    """Scores the goal only: bright pixels are a sofa."""

    spec = SegmenterSpec(sensors=("rgb",), kind="bright")

    def scores(self, observation: Observation, goal: str) -> Scores:
        bright = (observation["rgb"][..., 0] > 100).astype(np.float32)
        target = bright if goal == "sofa" else np.zeros_like(bright)
        return Scores(target, 1.0 - target)
