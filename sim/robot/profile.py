"""Trapezoid motion profiles, in metres or in radians."""

from __future__ import annotations

import math


def towards(value: float, goal: float, step: float) -> float:
    """Returns a value moved towards a goal by at most a step."""
    return max(value - step, min(value + step, goal))


class Trapezoid:
    """A motion that accelerates, keeps its speed and decelerates; short motions only accelerate and decelerate."""

    def __init__(self, distance: float, speed: float, acceleration: float) -> None:
        self._distance = distance
        self._acceleration = acceleration
        self._speed = min(speed, math.sqrt(distance * acceleration))
        self._ramp_s = self._speed / acceleration
        self.duration_s = distance / self._speed + self._ramp_s if self._speed > 0.0 else 0.0

    def distance(self, time_s: float) -> float:
        """Returns the distance covered at a time: 0 before the start, the whole distance after the end."""
        left_s = self.duration_s - time_s
        if time_s <= 0.0:
            return 0.0
        if left_s <= 0.0:
            return self._distance
        if time_s < self._ramp_s:
            return 0.5 * self._acceleration * time_s**2
        if left_s < self._ramp_s:
            return self._distance - 0.5 * self._acceleration * left_s**2
        return self._speed * (time_s - 0.5 * self._ramp_s)

    def speed(self, time_s: float) -> float:
        """Returns the speed at a time: 0 before the start and after the end."""
        ramp = self._acceleration * min(time_s, self.duration_s - time_s)
        return max(0.0, min(self._speed, ramp))
