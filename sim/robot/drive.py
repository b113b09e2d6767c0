"""The controller of the robot: performs an action as a closed-loop motion along a trapezoid profile.

A motion starts and ends at rest, and ends early when it is blocked (`Blocking`). Feedback is odometry
(`sim.robot.odometry`), never the true pose: a forward is 0.25 m by the wheel encoders. The heading reference is
absolute: the start heading plus a whole number of turns by odometry, so that errors of single motions do not
accumulate. Motor commands are constant during a tick of `tick_s`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from sim.core.interface import Action, wrap_angle
from sim.gl import mujoco
from sim.robot.body import Body
from sim.robot.conditions import NOMINAL, Conditions
from sim.robot.config import DriveConfig, RobotConfig
from sim.robot.contacts import Contact, ContactLog
from sim.robot.motors import Motors
from sim.robot.odometry import Odometry
from sim.robot.profile import Trapezoid, towards
from sim.robot.variation import ActionErrors, Variation

HELD_SHARE = 0.8
"""A forward that an object opposes, and that covers less than this share of its distance, is blocked also if the wheels
have covered it: they slip where the body leans back and unloads them."""
Ended = Literal["reached", "blocked", "timeout"]


@dataclass(frozen=True)
class Motion:
    """The result of one action."""

    action: Action
    displacement_m: float
    """Distance in plan between the robot's positions before and after the action."""
    yaw_change_rad: float
    """Angle in (-pi, pi], counter-clockwise."""
    duration_s: float
    """Simulated time."""
    ended: Ended
    """The reason why it ended: it reached its end, it was blocked, or it did not come to rest in time."""
    contacts: tuple[Contact, ...]
    """All contacts of the hull, also those that did not stop the motion; of wheels and casters those that did."""
    fell: bool = False
    """The robot has driven over an edge (`sim.world.world`)."""

    @property
    def collided(self) -> bool:
        """True: a contact of any part of the robot ended the motion early."""
        return any(contact.stopped for contact in self.contacts)


class Driver:
    """Drives one robot in one world; its memory between actions is odometry and the heading reference."""

    def __init__(
        self, config: RobotConfig, model: mujoco.MjModel, data: mujoco.MjData, body: Body, odometry: Odometry,
        log: ContactLog,
    ) -> None:  # fmt: skip
        self._model, self._data, self._body, self._log = model, data, body, log
        self._motors, self._odometry = Motors(config, model, body), odometry
        self._drive = config.drive
        self._steps = config.steps_per_tick
        self._tick_s = config.drive.tick_s
        wheels = config.wheels
        self._radius, self._half_track = wheels.radius_m, wheels.half_track_m
        # A wheel with this difference between commanded and actual speed (m/s) uses its largest torque ...
        self._full_slip = wheels.max_torque_nm / wheels.motor_gain_nm_s * wheels.radius_m
        self._push_slip = self._full_slip * self._drive.push_share
        self._touch_ticks = math.ceil(self._drive.touch_memory_s / self._tick_s)
        self._blocked_ticks = math.ceil(self._drive.blocked_s / self._tick_s)
        self._start_yaw = 0.0
        self._turns = 0
        self._ticks = 0
        self._touched_until = 0
        self._variation, self._errors = Variation(), ActionErrors()

    def reset(self, yaw_rad: float, conditions: Conditions = NOMINAL) -> None:
        """Starts a new episode: the headings are `yaw_rad` plus multiples of a turn."""
        self._motors.reset(conditions)
        self._odometry.reset(yaw_rad, conditions, self._log.compression_m())
        self._variation.reset(conditions)
        self._errors = ActionErrors()
        self._start_yaw, self._turns = yaw_rad, 0

    def brake(self) -> None:
        """Holds the wheels."""
        self._motors.stop()

    def run(self, action: Action) -> Motion:
        """Performs one action, from rest to rest."""
        if action == Action.STOP:
            return Motion(action, 0.0, 0.0, 0.0, "reached", ())
        self._log.clear()
        self._ticks = self._touched_until = 0
        self._errors = self._variation.draw()
        self._motors.vary(self._errors)
        self._odometry.vary(self._errors)
        x0, y0, yaw0, _, _ = self._body.state()
        since: int | None = None
        if action == Action.MOVE_FORWARD:
            moved_m = self._true_progress()
            ended = self._forward()
            direction = math.cos(yaw0), math.sin(yaw0)
            if ended != "blocked" and self._touched_until and moved_m() < HELD_SHARE * self._drive.forward_m:
                ended, since = "blocked", 0  # it was held while its wheels slipped
        else:
            ended = self._turn(1 if action == Action.TURN_LEFT else -1)
            direction = 0.0, 0.0
        if ended == "reached":
            contacts = self._log.contacts(self._tick_s)
            if self._touching:
                self._realign()
        else:
            since = self._ticks - self._blocked_ticks if since is None else since
            contacts = self._log.contacts_of_aborted(self._tick_s, self._ticks, since, direction)
            if action == Action.MOVE_FORWARD:
                self._back_off()
            self._realign()
        self._come_to_rest()
        x, y, yaw, _, _ = self._body.state()
        return Motion(
            action=action,
            displacement_m=math.hypot(x - x0, y - y0),
            yaw_change_rad=wrap_angle(yaw - yaw0),
            duration_s=self._ticks * self._tick_s,
            ended=ended,
            contacts=contacts,
        )

    @property
    def _reference(self) -> float:
        return self._start_yaw + self._turns * self._drive.turn_rad + self._errors.stop_rad

    def _forward(self) -> Ended:
        """Drives ahead along the heading reference."""
        drive, odometry = self._drive, self._odometry
        # A motion ends when it comes within its tolerance from below.
        aim_m = max(0.0, drive.forward_m + self._errors.stop_m) + 0.5 * drive.position_tolerance_m
        profile = Trapezoid(aim_m, drive.speed_m_s, drive.acceleration_m_s2)
        blocking, moved_m = Blocking(drive, turning=False), self._true_progress()
        remaining_m = self._remaining(aim_m)
        for tick in range(math.ceil((profile.duration_s + drive.timeout_s) / self._tick_s)):
            time_s = tick * self._tick_s
            lag = remaining_m() - (aim_m - profile.distance(time_s))
            heading_error = wrap_angle(self._reference - odometry.yaw_rad)
            if time_s >= profile.duration_s and self._at_rest(lag, heading_error, time_s - profile.duration_s):
                return "reached"
            speed = profile.speed(time_s + drive.lookahead_s) + drive.position_gain_1_s * lag
            self._command(speed, drive.heading_gain_1_s * heading_error)
            if blocking.add(speed, moved_m()):
                return "blocked"
        return "reached" if abs(remaining_m()) <= drive.touching_tolerance_m else "timeout"

    def _turn(self, side: int) -> Ended:
        """Turns on the spot to the next heading reference, left for +1; a blocked turn keeps the last reference."""
        drive, odometry = self._drive, self._odometry
        self._turns += side
        yaw0 = odometry.yaw_rad
        angle = wrap_angle(self._reference - yaw0)
        sign = math.copysign(1.0, angle)
        profile = Trapezoid(abs(angle), drive.turn_speed_rad_s, drive.turn_acceleration_rad_s2)
        blocking, behind_m = Blocking(drive, turning=True), self._remaining(0.0)
        true_yaw, turned = self._body.yaw_rad, 0.0
        ended: Ended = "timeout"
        for tick in range(math.ceil((profile.duration_s + drive.timeout_s) / self._tick_s)):
            time_s = tick * self._tick_s
            lag = sign * profile.distance(time_s) - (odometry.yaw_rad - yaw0)
            if time_s >= profile.duration_s and self._at_rest(behind_m(), lag, time_s - profile.duration_s):
                return "reached"
            rate = sign * profile.speed(time_s + drive.lookahead_s) + drive.heading_gain_1_s * lag
            self._command(drive.position_gain_1_s * behind_m(), rate)
            turned += wrap_angle(self._body.yaw_rad - true_yaw)
            true_yaw = self._body.yaw_rad
            if blocking.add(sign * rate, sign * turned):
                ended = "blocked"
                break
        if abs(wrap_angle(self._reference - odometry.yaw_rad)) > 0.5 * drive.turn_rad:
            self._turns -= side
        return ended

    def _back_off(self) -> None:
        """Moves back by a few millimetres from the obstacle that blocked the motion."""
        drive, remaining_m = self._drive, self._remaining(0.0)
        for _ in range(round(drive.back_off_max_s / self._tick_s)):
            if remaining_m() >= drive.back_off_m:
                break
            turn_rate = drive.heading_gain_1_s * wrap_angle(self._reference - self._odometry.yaw_rad)
            self._command(-drive.back_off_speed_m_s, turn_rate)

    def _realign(self) -> None:
        """Turns back to the heading reference."""
        drive, odometry = self._drive, self._odometry
        for _ in range(round(drive.realign_max_s / self._tick_s)):
            error = wrap_angle(self._reference - odometry.yaw_rad)
            if abs(error) <= drive.heading_tolerance_rad and abs(odometry.rate_rad_s) <= drive.rest_speed_rad_s:
                break
            self._command(0.0, drive.heading_gain_1_s * error)

    def _come_to_rest(self) -> None:
        """Brakes until the robot is at rest."""
        for _ in range(round(self._drive.rest_max_s / self._tick_s)):
            if self._is_still():
                break
            self._command(0.0, 0.0)
        self._motors.stop()

    def _remaining(self, distance_m: float) -> Callable[[], float]:
        """Returns a function of the distance that is left, by odometry, along the heading reference of its call."""
        odometry, x0, y0 = self._odometry, self._odometry.x_m, self._odometry.y_m

        def remaining_m() -> float:
            cos, sin = math.cos(self._reference), math.sin(self._reference)
            return distance_m - ((odometry.x_m - x0) * cos + (odometry.y_m - y0) * sin)

        return remaining_m

    def _true_progress(self) -> Callable[[], float]:
        """Returns a function of the distance that the body has truly moved along its present heading."""
        x0, y0, yaw, _, _ = self._body.state()
        cos, sin = math.cos(yaw), math.sin(yaw)

        def moved_m() -> float:
            x, y = self._body.qpos[:2].tolist()
            return (x - x0) * cos + (y - y0) * sin

        return moved_m

    def _at_rest(self, lag_m: float, heading_error: float, late_s: float) -> bool:
        """Returns whether a motion has reached its end, `late_s` after the end of its profile."""
        drive = self._drive
        coarse = late_s >= drive.coarse_after_s
        tolerance_m = drive.touching_tolerance_m if coarse or self._touching else drive.position_tolerance_m
        tolerance_rad = drive.coarse_heading_rad if coarse else drive.heading_tolerance_rad
        return abs(lag_m) <= tolerance_m and abs(heading_error) <= tolerance_rad and self._is_still()

    def _is_still(self) -> bool:
        drive, odometry = self._drive, self._odometry
        return abs(odometry.speed_m_s) <= drive.rest_speed_m_s and abs(odometry.rate_rad_s) <= drive.rest_speed_rad_s

    @property
    def _touching(self) -> bool:
        return self._ticks < self._touched_until

    def _command(self, speed_m_s: float, rate_rad_s: float) -> None:
        """Applies one command of speed and turn rate for a tick.

        While the hull touches an object, or did so shortly before, the command is limited to values near the actual
        motion that saturate no motor, since two saturated motors cannot keep the heading. The turn rate has priority.
        """
        odometry = self._odometry
        if self._touching:
            rate_rad_s = towards(odometry.rate_rad_s, rate_rad_s, self._full_slip / self._half_track)
            spare = self._full_slip - abs(rate_rad_s - odometry.rate_rad_s) * self._half_track
            speed_m_s = max(speed_m_s, odometry.speed_m_s - spare)
            speed_m_s = min(speed_m_s, odometry.speed_m_s + min(self._push_slip, spare))
        across = rate_rad_s * self._half_track
        self._motors.command((speed_m_s - across) / self._radius, (speed_m_s + across) / self._radius)
        mujoco.mj_step(self._model, self._data, self._steps)
        odometry.update()
        self._ticks += 1
        if self._body.touch[0] > 0.0:
            self._touched_until = self._ticks + self._touch_ticks
            self._log.sample(self._ticks)


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
