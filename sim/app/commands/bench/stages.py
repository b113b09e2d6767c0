"""Defines what the parts share: amounts of work, poses in houses, and an agent that runs step by step."""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sim.app.commands.bench.calibration import Calibrator
from sim.app.composition.segmenters import make_segmenter
from sim.core.geometry.pose import Pose
from sim.core.interface import Action, Agent
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.world.freespace import FreeSpace
from sim.world.world import World
from stubborn import agents
from stubborn.detection.verification import verifier_for

SENSORS = ("depth", "semantic")
"""Image sensors of an agent with ground-truth segmentation."""


@dataclass(frozen=True, kw_only=True)
class Amount:
    """Amounts of work to measure."""

    houses: int = 8
    poses: int = 10
    """Number of poses in each house."""
    repeats: int = 2
    steps: int = 1500
    """Agent steps that are split into their parts."""
    episodes: int = 20
    views: int = 60
    made_houses: int = 6
    pieces: int = 24
    """Pieces of equal work, shared by workers."""
    piece_steps: int = 60
    growth_steps: int = 80
    """Number of steps at each size."""
    memory_episodes: int = 50
    training_steps: int = 200
    """Random steps of each size, set of sensors and vector of environments."""
    image_sizes: int = 4
    vectors: int = 5
    starts: int = 9
    """Starts of a command, and first steps in new houses."""


QUICK = Amount(
    houses=1, poses=2, repeats=1, steps=6, episodes=1, views=2, made_houses=1, pieces=4, piece_steps=3, growth_steps=4,
    memory_episodes=2, training_steps=5, image_sizes=1, vectors=1, starts=1,
)  # fmt: skip
"""Smallest amounts, to test that everything runs; the figures have no meaning."""


@dataclass(frozen=True)
class Setting:
    """The input of each part."""

    amount: Amount
    calibrator: Calibrator
    """Fixed work that is timed between measurements."""


def free_poses(world: World, count: int, rng: np.random.Generator) -> list[Pose]:
    """Returns random free poses of the robot."""
    space = FreeSpace.from_world(world)
    cells = np.argwhere(space.largest_part())
    places = space.frame.to_metres(cells[rng.integers(len(cells), size=count)])
    return [Pose(float(x), float(y), float(rng.uniform(-math.pi, math.pi)), 0.0) for x, y in places]


def stubborn_agent(env: ObjectNavEnv, *, semantics: str = "gt", **options: Any) -> Agent:
    """Returns the agent of the paper with this kind of segmentation and its verifier."""
    segmenter = make_segmenter(semantics, env)
    options.setdefault("verifier", verifier_for(segmenter.spec))
    return agents.make("stubborn", camera=env.camera_model, robot=env.robot_model, segmenter=segmenter, **options)


class Rig:
    """An agent that runs episodes one after the other, one step per call."""

    def __init__(self, env: ObjectNavEnv, agent: Agent, episodes: Sequence[Episode], *, stops: bool = True) -> None:
        """`stops` False: a STOP is replaced by a turn, so that episodes last until their steps are used up."""
        self.env, self.agent = env, agent
        self._episodes: Iterator[Episode] = itertools.cycle(episodes)
        self._stops = stops
        self._observation: Any = None
        self.over = True
        """True: the next step begins an episode."""

    def step(self) -> tuple[float, float]:
        """Runs one step and returns the milliseconds of agent and environment; resets are not timed."""
        if self.over:
            self._begin()
        began_s = time.perf_counter()
        action = self.agent.act(self._observation)
        if not self._stops and action == Action.STOP:
            action = Action.TURN_LEFT
        acted_s = time.perf_counter()
        self._observation, _, terminated, truncated, _ = self.env.step(action)
        ended_s = time.perf_counter()
        self.over = terminated or truncated
        return 1e3 * (acted_s - began_s), 1e3 * (ended_s - acted_s)

    def _begin(self) -> None:
        episode = next(self._episodes)
        self._observation, _ = self.env.reset(seed=0, options={"episode": episode})
        self.agent.reset(episode.goal, 0)
