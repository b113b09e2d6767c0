"""Agents for robots of ROS 2: one whose confidence is a checksum of all that it has seen, one that turns and thinks."""

from __future__ import annotations

import time
import zlib

import numpy as np

from sim.core.interface import GOAL_SENSORS, Action, AgentSpec, Observation

ACTIONS = (
    Action.TURN_LEFT, Action.MOVE_FORWARD, Action.MOVE_FORWARD, Action.TURN_RIGHT, Action.TURN_RIGHT,
    Action.MOVE_FORWARD, Action.STOP,
)  # fmt: skip
READ = ("rgb", "depth", "imu", "odometry", "gps", "compass", "objectgoal")


class Witness:
    """Two runs of it have the same confidence only if their observations are equal bit by bit."""

    def reset(self, goal: str, seed: int) -> None:
        self._sum, self._steps = zlib.crc32(f"{goal} {seed}".encode()), 0

    def act(self, observation: Observation) -> Action:
        for name in READ:
            reading = np.ascontiguousarray(observation[name])
            self._sum = zlib.crc32(f"{name} {reading.dtype} {reading.shape}".encode() + reading.tobytes(), self._sum)
        self._steps += 1
        return ACTIONS[self._steps - 1]

    def stop_confidence(self) -> float:
        return self._sum / 2**32

    def stop_target_xy_m(self) -> tuple[float, float]:
        return 1.25, -0.5


class Remembering(Witness):
    """Turns once and stops at each goal of a chain; its confidence also depends on the order of goals."""

    def next_goal(self, goal: str) -> None:
        self._sum, self._steps = zlib.crc32(f"next {goal}".encode(), self._sum), 0

    def act(self, observation: Observation) -> Action:
        super().act(observation)
        for name in GOAL_SENSORS:
            self._sum = zlib.crc32(np.array(observation[name]).tobytes(), self._sum)
        return Action.STOP if self._steps == 2 else Action.TURN_LEFT


class Turner:
    """Turns on the spot, ten times in a second at most."""

    def reset(self, goal: str, seed: int) -> None:
        pass

    def act(self, observation: Observation) -> Action:
        time.sleep(0.1)
        return Action.TURN_LEFT


TURNER = AgentSpec(make=lambda **_: Turner(), sensors=("rgb", "depth"), uses_segmentation=False)
REMEMBERING = AgentSpec(
    make=lambda **_: Remembering(),
    sensors=("rgb", "depth", "imu", "odometry"),
    uses_segmentation=False,
    words=("goal",),
    pictures=("goal", "goal_picture"),
)
WITNESS = AgentSpec(make=lambda **_: Witness(), sensors=("rgb", "depth", "imu", "odometry"), uses_segmentation=False)
