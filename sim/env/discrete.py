"""The reference controller: performs discrete actions by velocities, from poses alone.

`DiscreteActions` applies it to `ObjectNavVelocityEnv`; the node of an agent applies it to any robot of ROS 2.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from sim.core.errors import ConfigError
from sim.core.interface import FORWARD_M, MOVES, TURN_RAD, Action, require_action, wrap_angle
from sim.robot.profile import towards

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
SLOW_SHARE = 0.25
"""A base that follows its command by less than this share does not move as it should."""


class Held(NamedTuple):
    """The state of a base after a period."""

    x_m: float
    """Metres forward of the start pose, as observed."""
    y_m: float
    """Metres to the left of it."""
    yaw_rad: float
    blocked: bool
    """True: a contact blocks the base."""
    collided: bool
    """True: it began to do so in this period."""
    over: bool
    """True: the episode has ended."""


class Limits(NamedTuple):
    """The largest velocities and accelerations of a base."""

    speed_m_s: float
    rate_rad_s: float
    acceleration_m_s2: float
    turn_acceleration_rad_s2: float


class ActionController:
    """Performs motions from rest to rest. It keeps an absolute heading, and ends a motion when the base is blocked.

    Args:
        hold: holds a speed (m/s) and a turn rate (rad/s) for a period and returns the state after it.
        limits: those of the base.
        period_s: time of a period.
        start: the state at the start of the episode.
        delay_s: time until a command has an effect; the controller then predicts the state by it.
    """

    def __init__(
        self,
        hold: Callable[[float, float], Held],
        limits: Limits,
        period_s: float,
        start: Held,
        *,
        delay_s: float = 0.0,
    ) -> None:
        self._base, self._limits, self._period_s, self._last = hold, limits, period_s, start
        self._delay_s = delay_s
        self._heading = start.yaw_rad
        """Heading reference in the start frame."""
        self._speed = self._rate = 0.0
        """Velocities that the base reaches by the last command, m/s and rad/s."""
        self.collided = False
        """Whether a contact ended the last action."""

    def perform(self, action: Action) -> None:
        """Performs MOVE_FORWARD, TURN_LEFT or TURN_RIGHT."""
        self.collided = False
        if action == Action.MOVE_FORWARD:
            self._forward()
        else:
            self._turn(TURN_RAD if action == Action.TURN_LEFT else -TURN_RAD)

    def _forward(self) -> None:
        """Drives ahead along the heading reference."""
        x0, y0 = self._last.x_m, self._last.y_m
        cos, sin = math.cos(self._heading), math.sin(self._heading)
        for _ in range(round(LONGEST_S / self._period_s)):
            x, y, yaw, *_ = self._last
            left_m = FORWARD_M - ((x - x0) * cos + (y - y0) * sin) - self._speed * self._delay_s
            if abs(left_m) <= POSITION_TOLERANCE_M:
                break
            speed = stopping_velocity(left_m, self._speed, self._limits.acceleration_m_s2, self._period_s)
            self._hold(speed, self._correction(yaw))
            if self._last.over or self.collided:
                break
        self._finish()

    def _turn(self, angle_rad: float) -> None:
        """Turns on the spot to the next heading reference; a blocked turn takes the nearest one."""
        before, self._heading = self._heading, wrap_angle(self._heading + angle_rad)
        self._align()
        if abs(wrap_angle(self._heading - self._last.yaw_rad)) > 0.5 * abs(angle_rad):
            self._heading = before
        self._finish()

    def _align(self) -> None:
        """Turns until the heading is that of the reference, or something blocks the robot."""
        for _ in range(round(LONGEST_S / self._period_s)):
            error = wrap_angle(self._heading - self._last.yaw_rad) - self._rate * self._delay_s
            if abs(error) <= HEADING_TOLERANCE_RAD:
                break
            self._hold(0.0, stopping_velocity(error, self._rate, self._limits.turn_acceleration_rad_s2, self._period_s))
            if self._last.over or self.collided:
                break

    def _finish(self) -> None:
        """Brings the robot to rest; one that was blocked first moves back a little and turns to its heading."""
        if self.collided and not self._last.over:
            self._hold(BACK_OFF_M_S, 0.0)
            self._align()
        for _ in range(round(LONGEST_S / self._period_s)):
            before = self._last
            if self._last.over:
                return
            self._hold(0.0, self._correction(before.yaw_rad))
            moved_m = math.hypot(self._last.x_m - before.x_m, self._last.y_m - before.y_m)
            if moved_m <= REST_M and abs(wrap_angle(self._last.yaw_rad - before.yaw_rad)) <= REST_RAD:
                return

    def _correction(self, yaw_rad: float) -> float:
        """Returns the turn rate that reduces the heading error; a base with a delay needs a smaller one."""
        return HEADING_GAIN * wrap_angle(self._heading - yaw_rad) / (self._period_s + 2.0 * self._delay_s)

    def _hold(self, speed_m_s: float, rate_rad_s: float) -> None:
        """Holds velocities for a period."""
        limits = self._limits
        self._last = self._base(speed_m_s, rate_rad_s)
        change, turn = limits.acceleration_m_s2 * self._period_s, limits.turn_acceleration_rad_s2 * self._period_s
        self._speed = towards(self._speed, max(-limits.speed_m_s, min(limits.speed_m_s, speed_m_s)), change)
        self._rate = towards(self._rate, max(-limits.rate_rad_s, min(limits.rate_rad_s, rate_rad_s)), turn)
        if self._last.blocked:
            self._speed = self._rate = 0.0
        self.collided = self.collided or self._last.collided


class DiscreteActions(gymnasium.Wrapper[dict[str, NDArray], Any, dict[str, NDArray], Any]):
    """Gives `ObjectNavVelocityEnv` the actions of `ObjectNavEnv`: 0 STOP, 1 MOVE_FORWARD, 2 TURN_LEFT, 3 TURN_RIGHT.

    An action is a motion from rest to rest. Like the drive of `ObjectNavEnv` it keeps an absolute heading, and ends
    when the robot is blocked. `info["collided"]` is that of the whole action; the reward is the sum.

    Args:
        env: the environment, or wrappers around it that change neither actions nor observations.

    Raises:
        ConfigError: it is another environment; `step` raises it for another action.
    """

    def __init__(self, env: gymnasium.Env[dict[str, NDArray], Any]) -> None:
        from sim.env.velocity import ObjectNavVelocityEnv  # loads MuJoCo, which `import sim.gym` need not

        super().__init__(env)
        base = env.unwrapped
        if not isinstance(base, ObjectNavVelocityEnv):
            raise ConfigError(f"DiscreteActions needs an ObjectNavVelocityEnv, got {type(base).__name__}.")
        self.action_space = spaces.Discrete(len(MOVES))
        self._period_s = base.period_s
        drive = base.robot_config.drive
        self._limits = Limits(
            drive.speed_m_s, drive.turn_speed_rad_s, drive.acceleration_m_s2, drive.turn_acceleration_rad_s2
        )
        self._last: tuple[Any, ...] = ()
        """The return value of the last period."""

    def reset(self, **options: Any) -> tuple[dict[str, NDArray], dict[str, Any]]:
        """Starts an episode."""
        observation, info = self.env.reset(**options)
        self._last = (observation, 0.0, False, False, info)
        start = self._state(blocked=False, collided=False)
        self._controller = ActionController(self._hold, self._limits, self._period_s, start)
        return observation, info

    def step(self, action: int) -> tuple[dict[str, NDArray], float, bool, bool, dict[str, Any]]:
        """Performs one action."""
        if not self._last:
            raise gymnasium.error.ResetNeeded("Call reset() before the first step.")
        chosen, self._reward, collided = require_action(action, MOVES), 0.0, False
        if chosen == Action.STOP:
            self._hold(0.0, 0.0, stop=1.0)
        else:
            self._controller.perform(chosen)
            collided = self._controller.collided
        observation, _, terminated, truncated, info = self._last
        return observation, self._reward, terminated, truncated, info | {"collided": collided}

    def _hold(self, speed_m_s: float, rate_rad_s: float, stop: float = 0.0) -> Held:
        """Holds velocities for a period."""
        self._last = self.env.step(np.array([speed_m_s, rate_rad_s, stop], np.float32))
        self._reward += float(self._last[1])
        return self._state(blocked=bool(self._last[4]["blocked"]), collided=bool(self._last[4]["collided"]))

    def _state(self, *, blocked: bool, collided: bool) -> Held:
        observation, _, terminated, truncated, _ = self._last
        x_m, y_m = observation["gps"].tolist()
        return Held(x_m, y_m, float(observation["compass"][0]), blocked, collided, bool(terminated or truncated))


def stopping_velocity(remaining: float, velocity: float, acceleration: float, period_s: float) -> float:
    """Returns the largest velocity to command for a period after which the base can still stop at its goal.

    The base moves to the command with its acceleration during the period, and later to 0. With v0 the velocity now and
    v the command, it covers v T + (v0 - v) |v0 - v| / 2a in the period T and v^2 / 2a after it.

    Args:
        remaining: distance (m) or angle (rad) to the goal; its sign is the direction.
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
