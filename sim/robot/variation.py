"""Errors that change from action to action, drawn from the episode's seed.

Murali et al., "PyRobot: an open-source robotics framework for research and benchmarking", arXiv:1906.08236 (2019),
measured a LoCoBot with a motion capture system; Habitat has its figures (`pyrobot_noisy_controls`). With the controller
ILQR the error of a forward is 14 mm ahead (standard deviation 6), 9 mm sideways (5) and 8 mrad (4), that of a turn is
23 mrad (12), each independent of the others. The mean is a property of one robot, which an episode's constants have
(`sim.robot.conditions`); the standard deviation is what changes from action to action, and what is drawn here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sim.robot.conditions import NOMINAL, Conditions

ACTION_S = 1.2
"""Duration of the longest discrete action, a forward from rest to rest. Errors of a robot that is driven by velocities
change in this time, and windows of `n` actions in the metrics are `n` times as long."""
MAX_SIGMAS = 3.0
"""Larger errors are cut off, as in Habitat."""


@dataclass(frozen=True)
class ActionErrors:
    """The errors of one action."""

    stop_m: float = 0.0
    """A forward ends this much too far, by its own odometry."""
    stop_rad: float = 0.0
    """The heading at which the controller aims is off by this much, by its own odometry."""
    wheel_scale: float = 1.0
    """Measured by true distance of both wheels, in addition to that of the episode."""
    gyro_scale: float = 1.0
    """Measured by true turn rate, in addition to that of the episode."""
    motor_scale: tuple[float, float] = (1.0, 1.0)
    """Factors on the speeds of the left and the right motor, in addition to those of the episode."""


class Variation:
    """Draws the errors of one action after the other."""

    def __init__(self) -> None:
        self.reset(NOMINAL)

    def reset(self, conditions: Conditions) -> None:
        """Starts an episode: the same conditions give the same errors."""
        self._std = np.array(
            [
                conditions.stop_std_m,
                conditions.stop_std_rad,
                conditions.wheel_std,
                conditions.gyro_std,
                conditions.motor_std,
                conditions.motor_std,
            ]
        )
        self._on = bool(self._std.any())
        self._rng = np.random.default_rng(conditions.seed)
        self._last = self._rng.standard_normal(len(self._std)) if self._on else np.zeros(len(self._std))

    def draw(self, after_s: float = math.inf) -> ActionErrors:
        """Returns the errors of the next action, or of a period that ends `after_s` after the last draw.

        Errors of periods are correlated over `ACTION_S`, those of actions are independent.
        """
        if not self._on:
            return ActionErrors()
        kept = math.exp(-after_s / ACTION_S)
        self._last = kept * self._last + math.sqrt(1.0 - kept * kept) * self._rng.standard_normal(len(self._std))
        errors = self._std * np.clip(self._last, -MAX_SIGMAS, MAX_SIGMAS)
        stop_m, stop_rad, wheel, gyro, left, right = errors.tolist()
        return ActionErrors(stop_m, stop_rad, 1.0 + wheel, 1.0 + gyro, (1.0 + left, 1.0 + right))
