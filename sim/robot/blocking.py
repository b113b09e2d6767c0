"""Decides whether something blocks a motion: the motors push, and the body does not move."""

from __future__ import annotations

import math

from sim.robot.config import DriveConfig


class Blocking:
    """Compares the commands of the motors with the motion of the body over the last `DriveConfig.blocked_s`.

    It does not matter which part of the robot touches something, how large the force is, or whether the wheels stall or
    slip. Wheel encoders cannot see slip, so that the motion is the true one, which real bases measure with a sensor of
    optical flow that faces the floor.
    """

    def __init__(self, drive: DriveConfig, *, turning: bool) -> None:
        self._ticks = math.ceil(drive.blocked_s / drive.tick_s)
        self._least = drive.blocked_rad if turning else drive.blocked_m
        self._pushing = drive.pushing_rad_s if turning else drive.pushing_m_s
        self._commanded: list[float] = []
        self._moved: list[float] = []

    def add(self, commanded: float, moved: float) -> bool:
        """Adds one tick and returns whether the motion is blocked.

        Args:
            commanded: speed (m/s) or turn rate (rad/s) in the direction of the motion.
            moved: distance (m) or angle (rad) in that direction since its start.
        """
        self._commanded.append(commanded)
        self._moved.append(moved)
        if len(self._moved) <= self._ticks:
            return False
        pushing = min(self._commanded[-self._ticks :]) >= self._pushing
        return pushing and self._moved[-1] - self._moved[-1 - self._ticks] < self._least
