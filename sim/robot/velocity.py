"""Drives the robot by velocities: each command is held for a period, within the acceleration limits of the base.

The limits of speed and acceleration are those of `DriveConfig`. The wheels' motors follow the command; nothing corrects
position or heading, which is the caller's task. The commanded speed of a wheel stays as near to the measured one as
the torque of the motor can act on, so that a robot that was held up does not first have to slow down to turn back.

A contact blocks the robot if the command pushes for `DriveConfig.blocked_s` and the body hardly moves. It is a
collision once, in the period in which it begins to block.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

from sim.gl import mujoco
from sim.interface import Action, wrap_angle
from sim.robot.body import Body
from sim.robot.conditions import NOMINAL, Conditions
from sim.robot.config import RobotConfig
from sim.robot.contacts import ContactLog
from sim.robot.drive import Motion
from sim.robot.motors import Motors
from sim.robot.odometry import Odometry

BLOCKED_M = 0.0025
"""The robot is blocked if it has moved by less than this, or if a turn on the spot is blocked as `DriveConfig` says."""


@dataclass(frozen=True)
class Velocity:
    """A command to a wheeled base."""

    speed_m_s: float
    """Forward; negative: backward."""
    rate_rad_s: float
    """Turn rate, counter-clockwise."""


class VelocityDrive:
    """Drives one robot in one world; it remembers the command and what blocks the robot."""

    def __init__(
        self, config: RobotConfig, model: mujoco.MjModel, data: mujoco.MjData, body: Body, odometry: Odometry,
        log: ContactLog,
    ) -> None:  # fmt: skip
        self._model, self._data, self._body, self._log = model, data, body, log
        self._drive, self._steps, self._tick_s = config.drive, config.steps_per_tick, config.drive.tick_s
        self._radius_m, self._half_track_m = config.wheels.radius_m, config.wheels.half_track_m
        self._reach_rad_s = config.wheels.max_torque_nm / config.wheels.motor_gain_nm_s
        self._touch_ticks = math.ceil(self._drive.touch_memory_s / self._tick_s)
        self._motors, self._odometry = Motors(config, model, body), odometry
        self._moves: deque[tuple[float, float]] = deque(maxlen=round(self._drive.blocked_s / self._tick_s))
        """Distance (m) and angle (rad) of each of the last ticks in which the command pushed, without sign."""
        self.reset(NOMINAL)

    def reset(self, conditions: Conditions) -> None:
        """Starts a new episode, at rest."""
        self._motors.reset(conditions)
        self._speed_m_s = self._rate_rad_s = 0.0
        self._blocked, self._last = False, Velocity(0.0, 0.0)
        self._moves.clear()

    def run(self, command: Velocity, period_s: float) -> Motion:
        """Holds a command for a period, which is a whole number of ticks of the controller."""
        self._log.clear()
        if command.speed_m_s * self._last.speed_m_s < 0.0:  # nothing ahead blocks a robot that drives back
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
            self._log.sample(ticks, all_parts=True)
            side = math.copysign(1.0, command.speed_m_s) if self._pushes_forward(command) else 0.0
            direction = side * math.cos(yaw), side * math.sin(yaw)
            contacts = self._log.contacts_of_aborted(self._tick_s, ticks - self._touch_ticks, direction)
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
        speed = _towards(self._speed_m_s, command.speed_m_s, drive.acceleration_m_s2 * self._tick_s)
        rate = _towards(self._rate_rad_s, command.rate_rad_s, drive.turn_acceleration_rad_s2 * self._tick_s)
        wheels = []
        for measured, side in zip(self._body.wheel_speeds(), (-1.0, 1.0), strict=True):
            wanted = (speed + side * rate * self._half_track_m) / self._radius_m
            wheels.append(_towards(measured, wanted, self._reach_rad_s))
        left, right = wheels
        self._motors.command(left, right)
        self._speed_m_s = 0.5 * (left + right) * self._radius_m
        self._rate_rad_s = 0.5 * (right - left) * self._radius_m / self._half_track_m
        x0, y0, yaw0, _, _ = self._body.state()
        mujoco.mj_step(self._model, self._data, self._steps)
        self._odometry.update()
        x, y, yaw, _, _ = self._body.state()
        self._moves.append((math.hypot(x - x0, y - y0), abs(wrap_angle(yaw - yaw0))))

    def _is_blocked(self, command: Velocity) -> bool:
        """Returns whether the command has pushed for long enough without an effect."""
        pushes_forward = self._pushes_forward(command)
        if not pushes_forward and abs(command.rate_rad_s) < self._drive.pushing_rad_s:
            self._moves.clear()
        if len(self._moves) < (self._moves.maxlen or 0):
            return False
        moved_m, turned_rad = (sum(each) for each in zip(*self._moves, strict=True))
        return moved_m < BLOCKED_M if pushes_forward else turned_rad < self._drive.blocked_rad

    def _pushes_forward(self, command: Velocity) -> bool:
        """Returns whether a command must move the robot if nothing blocks it."""
        return abs(command.speed_m_s) >= self._drive.pushing_m_s

    def _nearest_action(self, command: Velocity) -> Action:
        """Returns the discrete action that is most like a command, for records of episodes."""
        if self._pushes_forward(command) or command.rate_rad_s == 0.0:
            return Action.MOVE_FORWARD
        return Action.TURN_LEFT if command.rate_rad_s > 0.0 else Action.TURN_RIGHT


def _towards(value: float, goal: float, step: float) -> float:
    """Returns a value moved towards a goal by at most a step."""
    return max(value - step, min(value + step, goal))
