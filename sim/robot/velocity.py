"""Drives the robot by velocities: each command is held for a period, within the acceleration limits of the base.

The limits of speed and acceleration are those of `DriveConfig`. The wheels' motors follow the command; nothing corrects
position or heading, which is the caller's task. The commanded speed of a wheel stays as near to the measured one as
the torque of the motor can act on, so that a robot that was held up does not first have to slow down to turn back.

A contact blocks the robot if the command pushes for `DriveConfig.blocked_s` and the body moves or turns by less than
`DriveConfig` says in its direction, as in discrete actions. It is a collision once, in the period in which it begins to
block; it blocks until the body follows the command by `FREE_SHARE`, or the command ends.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

from sim.core.interface import Action, wrap_angle
from sim.gl import mujoco
from sim.robot.body import Body
from sim.robot.conditions import NOMINAL, Conditions
from sim.robot.config import RobotConfig
from sim.robot.contacts import ContactLog
from sim.robot.drive import Motion
from sim.robot.motors import Motors
from sim.robot.odometry import Odometry
from sim.robot.profile import towards
from sim.robot.variation import Variation

FREE_SHARE = 0.5
"""A robot that was blocked is free again when it moves or turns by this share of the command."""
SLOW_SHARE = 0.25
"""No command is blocked while the body follows it by this share, however slow it is."""


@dataclass(frozen=True)
class Velocity:
    """A command to a wheeled base."""

    speed_m_s: float
    """Forward; negative: backward."""
    rate_rad_s: float
    """Turn rate, counter-clockwise."""


class VelocityDrive:
    """Drives one robot in one world; it remembers the command and the contacts that block the robot."""

    def __init__(
        self, config: RobotConfig, model: mujoco.MjModel, data: mujoco.MjData, body: Body, odometry: Odometry,
        log: ContactLog,
    ) -> None:  # fmt: skip
        self._model, self._data, self._body, self._log = model, data, body, log
        self._drive, self._steps, self._tick_s = config.drive, config.steps_per_tick, config.drive.tick_s
        self._radius_m, self._half_track_m = config.wheels.radius_m, config.wheels.half_track_m
        self._reach_rad_s = config.wheels.max_torque_nm / config.wheels.motor_gain_nm_s
        self._touch_ticks = math.ceil(self._drive.touch_memory_s / self._tick_s)
        self._motors, self._odometry, self._variation = Motors(config, model, body), odometry, Variation()
        self._moves: deque[float] = deque(maxlen=round(self._drive.blocked_s / self._tick_s))
        """Distance (m) or angle (rad), in the direction of the command, of the last ticks in which it pushed."""
        self.reset(NOMINAL)

    def reset(self, conditions: Conditions) -> None:
        """Starts a new episode, at rest."""
        self._motors.reset(conditions)
        self._variation.reset(conditions)
        self._speed_m_s = self._rate_rad_s = 0.0
        self._blocked, self._last = False, Velocity(0.0, 0.0)
        self._moves.clear()

    def run(self, command: Velocity, period_s: float) -> Motion:
        """Holds a command for a period, which is a whole number of ticks of the controller."""
        self._log.clear()
        errors = self._variation.draw(period_s)
        self._motors.vary(errors)
        self._odometry.vary(errors)
        if self._push_of(command) != self._push_of(self._last):  # nothing ahead blocks a robot that drives back
            self._moves.clear()
        self._last = command
        x0, y0, yaw0, _, _ = self._body.state()
        ticks = round(period_s / self._tick_s)
        begins = False
        for tick in range(ticks):
            self._step(command)
            if self._body.touch[0] > 0.0:
                self._log.sample(tick)
            blocked = self._is_blocked(command)
            begins = begins or (blocked and not self._blocked)
            self._blocked = blocked
        x, y, yaw, _, _ = self._body.state()
        contacts = self._log.contacts(self._tick_s)
        if begins:
            side = math.copysign(1.0, command.speed_m_s) if self._pushes_forward(command) else 0.0
            direction = side * math.cos(yaw), side * math.sin(yaw)
            contacts = self._log.contacts_of_aborted(self._tick_s, ticks, ticks - self._touch_ticks, direction)
            self._blocked = self._blocked and any(contact.stopped for contact in contacts)  # else wheels that spin
        return Motion(
            action=self._nearest_action(command),
            displacement_m=math.hypot(x - x0, y - y0),
            yaw_change_rad=wrap_angle(yaw - yaw0),
            duration_s=ticks * self._tick_s,
            ended="blocked" if self._blocked else "reached",
            contacts=contacts,
        )

    def _step(self, command: Velocity) -> None:
        """Moves the commanded velocity towards the command, applies it for a tick and records the movement."""
        drive = self._drive
        speed = towards(self._speed_m_s, command.speed_m_s, drive.acceleration_m_s2 * self._tick_s)
        rate = towards(self._rate_rad_s, command.rate_rad_s, drive.turn_acceleration_rad_s2 * self._tick_s)
        wheels = []
        for measured, side in zip(self._body.wheel_speeds(), (-1.0, 1.0), strict=True):
            target = (speed + side * rate * self._half_track_m) / self._radius_m
            wheels.append(towards(measured, target, self._reach_rad_s))
        left, right = wheels
        self._motors.command(left, right)
        self._speed_m_s = 0.5 * (left + right) * self._radius_m
        self._rate_rad_s = 0.5 * (right - left) * self._radius_m / self._half_track_m
        x0, y0, yaw0, _, _ = self._body.state()
        mujoco.mj_step(self._model, self._data, self._steps)
        self._odometry.update()
        x, y, yaw, _, _ = self._body.state()
        ahead_m = (x - x0) * math.cos(yaw0) + (y - y0) * math.sin(yaw0)
        forward, turning = self._push_of(command)
        self._moves.append(forward * ahead_m if forward else turning * wrap_angle(yaw - yaw0))

    def _is_blocked(self, command: Velocity) -> bool:
        """Returns whether the command has pushed for long enough without an effect, or not got free since."""
        forward, turning = self._push_of(command)
        if not (forward or turning):
            self._moves.clear()
        if len(self._moves) < (self._moves.maxlen or 0):
            return False
        speed, least = (
            (command.speed_m_s, self._drive.blocked_m) if forward else (command.rate_rad_s, self._drive.blocked_rad)
        )
        expected = len(self._moves) * self._tick_s * abs(speed)
        return sum(self._moves) < (FREE_SHARE * expected if self._blocked else min(least, SLOW_SHARE * expected))

    def _push_of(self, command: Velocity) -> tuple[int, int]:
        """Returns the signs of the speed and of the rate by which a command must move the robot if nothing blocks it.

        One of them is 0, and both if the command is too slow.
        """
        if self._pushes_forward(command):
            return int(math.copysign(1, command.speed_m_s)), 0
        pushes = abs(command.rate_rad_s) >= self._drive.pushing_rad_s
        return 0, int(math.copysign(pushes, command.rate_rad_s))

    def _pushes_forward(self, command: Velocity) -> bool:
        """Returns whether a command must move the robot if nothing blocks it."""
        return abs(command.speed_m_s) >= self._drive.pushing_m_s

    def _nearest_action(self, command: Velocity) -> Action:
        """Returns the discrete action that is most like a command, for records of episodes."""
        if self._pushes_forward(command) or command.rate_rad_s == 0.0:
            return Action.MOVE_FORWARD
        return Action.TURN_LEFT if command.rate_rad_s > 0.0 else Action.TURN_RIGHT
