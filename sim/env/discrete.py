"""The reference controller: performs discrete actions in `ObjectNavVelocityEnv`, from `gps` and `compass` alone."""

from __future__ import annotations

import math
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from sim.core.errors import ConfigError
from sim.core.interface import FORWARD_M, TURN_RAD, Action, wrap_angle

POSITION_TOLERANCE_M = 0.002
"""A forward has reached its end this near to it ..."""
HEADING_TOLERANCE_RAD = math.radians(0.5)
"""... or with this error of the heading."""
REST_M, REST_RAD = 0.001, math.radians(0.2)
"""The robot rests if it moves by less than this in a period."""
HEADING_GAIN = 0.6
"""Share of the heading error to be corrected in a period."""
BACK_OFF_M_S = -0.1
"""Speed of the period in which the robot moves back from what blocked it."""
LONGEST_S = 4.0
"""Longest time of an action."""


class DiscreteActions(gymnasium.Wrapper[dict[str, NDArray], Any, dict[str, NDArray], Any]):
    """Gives `ObjectNavVelocityEnv` the actions of `ObjectNavEnv`: 0 STOP, 1 MOVE_FORWARD, 2 TURN_LEFT, 3 TURN_RIGHT.

    An action is a motion from rest to rest. Like the drive of `ObjectNavEnv` it keeps an absolute heading, and ends
    when the robot is blocked. `info["collided"]` is that of the whole action; the reward is the sum.

    Args:
        env: the environment, or wrappers around it that change neither actions nor observations.

    Raises:
        ConfigError: it is another environment.
    """

    def __init__(self, env: gymnasium.Env[dict[str, NDArray], Any]) -> None:
        from sim.env.velocity import ObjectNavVelocityEnv  # loads MuJoCo, which `import sim.gym` need not

        super().__init__(env)
        base = env.unwrapped
        if not isinstance(base, ObjectNavVelocityEnv):
            raise ConfigError(f"DiscreteActions needs an ObjectNavVelocityEnv, got {type(base).__name__}.")
        self.action_space = spaces.Discrete(len(Action))
        self._period_s = base.period_s
        drive = base.robot_config.drive
        self._most = drive.speed_m_s, drive.turn_speed_rad_s
        self._acceleration, self._turn_acceleration = drive.acceleration_m_s2, drive.turn_acceleration_rad_s2
        self._heading = 0.0
        """Heading reference in the start frame."""
        self._speed = self._rate = 0.0
        """Velocities that the base reaches by the last command, m/s and rad/s."""
        self._last: tuple[Any, ...] = ()
        """The return value of the last period."""

    def reset(self, **options: Any) -> tuple[dict[str, NDArray], dict[str, Any]]:
        """Starts an episode."""
        observation, info = self.env.reset(**options)
        self._speed = self._rate = 0.0
        self._heading, self._last = float(observation["compass"][0]), (observation, 0.0, False, False, info)
        return observation, info

    def step(self, action: int) -> tuple[dict[str, NDArray], float, bool, bool, dict[str, Any]]:
        """Performs one action."""
        if not self._last:
            raise gymnasium.error.ResetNeeded("Call reset() before the first step.")
        action = Action(action)
        self._reward, self._collided = 0.0, False
        if action == Action.STOP:
            self._hold(0.0, 0.0, stop=1.0)
        elif action == Action.MOVE_FORWARD:
            self._forward()
        else:
            self._turn(TURN_RAD if action == Action.TURN_LEFT else -TURN_RAD)
        observation, _, terminated, truncated, info = self._last
        return observation, self._reward, terminated, truncated, info | {"collided": self._collided}

    def _forward(self) -> None:
        """Drives ahead along the heading reference."""
        x0, y0, _ = self._pose
        cos, sin = math.cos(self._heading), math.sin(self._heading)
        for _ in range(round(LONGEST_S / self._period_s)):
            x, y, yaw = self._pose
            left_m = FORWARD_M - ((x - x0) * cos + (y - y0) * sin)
            if abs(left_m) <= POSITION_TOLERANCE_M:
                break
            speed = stopping_velocity(left_m, self._speed, self._acceleration, self._period_s)
            self._hold(speed, self._correction(yaw))
            if self._over or self._collided:
                break
        self._finish()

    def _turn(self, angle_rad: float) -> None:
        """Turns on the spot to the next heading reference; a blocked turn takes the nearest one."""
        before, self._heading = self._heading, wrap_angle(self._heading + angle_rad)
        self._align()
        if abs(wrap_angle(self._heading - self._pose[2])) > 0.5 * abs(angle_rad):
            self._heading = before
        self._finish()

    def _align(self) -> None:
        """Turns until the heading is that of the reference, or something blocks the robot."""
        for _ in range(round(LONGEST_S / self._period_s)):
            error = wrap_angle(self._heading - self._pose[2])
            if abs(error) <= HEADING_TOLERANCE_RAD:
                break
            self._hold(0.0, stopping_velocity(error, self._rate, self._turn_acceleration, self._period_s))
            if self._over or self._collided:
                break

    def _finish(self) -> None:
        """Brings the robot to rest; one that was blocked first moves back a little and turns to its heading."""
        if self._collided and not self._over:
            self._hold(BACK_OFF_M_S, 0.0)
            self._align()
        for _ in range(round(LONGEST_S / self._period_s)):
            before = self._pose
            if self._over:
                return
            self._hold(0.0, self._correction(before[2]))
            x, y, yaw = self._pose
            if math.hypot(x - before[0], y - before[1]) <= REST_M and abs(wrap_angle(yaw - before[2])) <= REST_RAD:
                return

    def _correction(self, yaw_rad: float) -> float:
        """Returns the turn rate that reduces the heading error."""
        return HEADING_GAIN * wrap_angle(self._heading - yaw_rad) / self._period_s

    def _hold(self, speed_m_s: float, rate_rad_s: float, stop: float = 0.0) -> None:
        """Holds velocities for a period."""
        self._last = self.env.step(np.array([speed_m_s, rate_rad_s, stop], np.float32))
        self._speed = _towards(self._speed, self._most[0], speed_m_s, self._acceleration * self._period_s)
        self._rate = _towards(self._rate, self._most[1], rate_rad_s, self._turn_acceleration * self._period_s)
        if self._last[4]["blocked"]:
            self._speed = self._rate = 0.0
        self._reward += float(self._last[1])
        self._collided = self._collided or bool(self._last[4]["collided"])

    @property
    def _pose(self) -> tuple[float, float, float]:
        """Metres forward and left of the start pose, and yaw, as observed."""
        observation = self._last[0]
        x_m, y_m = observation["gps"].tolist()
        return x_m, y_m, float(observation["compass"][0])

    @property
    def _over(self) -> bool:
        return bool(self._last[2] or self._last[3])


def stopping_velocity(remaining: float, velocity: float, acceleration: float, period_s: float) -> float:
    """Returns the largest velocity to command for a period after which the base can still stop at its goal.

    The base moves to the command with its acceleration during the period, and later to 0. With v0 the velocity now and
    v the command, it covers v T + (v0 - v) |v0 - v| / 2a in the period T and v^2 / 2a after it.

    Args:
        left: distance (m) or angle (rad) to the goal; its sign is the direction.
        velocity: present velocity; that away from the goal counts as 0.
        acceleration: limit of the base, > 0.
        period_s: time for which the command is held.
    """
    goal, v0 = abs(remaining), max(0.0, velocity * math.copysign(1.0, remaining))
    faster = (goal + 0.5 * v0 * v0 / acceleration) / (period_s + v0 / acceleration)
    if faster >= v0:
        return math.copysign(faster, remaining)
    half = 0.5 * (period_s - v0 / acceleration)
    root = half * half - (0.5 * v0 * v0 / acceleration - goal) / acceleration
    slower = acceleration * (math.sqrt(root) - half) if root > 0.0 else 0.0
    return math.copysign(max(0.0, slower), remaining)


def _towards(velocity: float, most: float, command: float, change: float) -> float:
    """Returns the velocity after a period in which it moves to a command, which is limited to `most`, by a change."""
    goal = max(-most, min(most, command))
    return max(velocity - change, min(velocity + change, goal))
