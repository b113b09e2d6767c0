"""The controller of the robot: performs an action as a closed-loop motion along a trapezoid profile.

A motion starts and ends at rest, and ends early when it is blocked. The heading reference is absolute: the start
heading plus a whole number of turns. It is never read from the pose, so that errors do not accumulate. Feedback is the
true pose. Motor commands are constant during a tick of `tick_s`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from sim.gl import mujoco
from sim.interface import Action, wrap_angle
from sim.robot.body import Body
from sim.robot.config import RobotConfig
from sim.robot.contacts import Contact, ContactLog
from sim.robot.profile import Trapezoid

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
    """All contacts of the hull, also those that did not stop the motion."""
    fell: bool = False
    """The robot has driven over an edge (`sim.world.world`)."""

    @property
    def collided(self) -> bool:
        """True: a contact of the hull ended the motion early."""
        return any(contact.stopped for contact in self.contacts)


class Driver:
    """Drives one robot in one world; its only memory between actions is the heading reference."""

    def __init__(
        self, config: RobotConfig, model: mujoco.MjModel, data: mujoco.MjData, body: Body, log: ContactLog
    ) -> None:
        self._model, self._data, self._body, self._log = model, data, body, log
        self._drive = config.drive
        self._steps = config.steps_per_tick
        self._tick_s = config.drive.tick_s
        wheels = config.wheels
        self._radius, self._half_track = wheels.radius_m, wheels.half_track_m
        # A wheel with this difference between commanded and actual speed (m/s) uses its largest torque ...
        self._full_slip = wheels.max_torque_nm / wheels.motor_gain_nm_s * wheels.radius_m
        # ... and with this one the robot pushes half-way between the blocking force and the largest force.
        push_n = 0.5 * (self._drive.blocking_force_n + wheels.max_push_n)
        self._push_slip = self._full_slip * push_n / wheels.max_push_n
        self._touch_ticks = math.ceil(self._drive.touch_memory_s / self._tick_s)
        self._start_yaw = 0.0
        self._turns = 0
        self._ticks = 0
        self._touched_until = 0

    def reset(self, yaw_rad: float) -> None:
        """Starts a new episode: the headings are `yaw_rad` plus multiples of a turn."""
        self._start_yaw, self._turns = yaw_rad, 0

    def run(self, action: Action) -> Motion:
        """Performs one action, from rest to rest."""
        if action == Action.STOP:
            return Motion(action, 0.0, 0.0, 0.0, "reached", ())
        self._log.clear()
        self._ticks = self._touched_until = 0
        x0, y0, yaw0, _, _ = self._body.state()
        if action == Action.MOVE_FORWARD:
            ended, aborted = self._forward()
        else:
            ended, aborted = self._turn(1 if action == Action.TURN_LEFT else -1)
        if aborted is None:
            contacts = self._log.contacts(self._tick_s)
            if self._touching:
                self._realign()
        else:
            contacts = self._log.contacts_of_aborted(self._tick_s, self._ticks - self._touch_ticks, aborted)
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
        return self._start_yaw + self._turns * self._drive.turn_rad

    def _forward(self) -> tuple[Ended, tuple[float, float] | None]:
        """Drives ahead along the heading reference.

        Returns:
            How the motion ended, and its direction in plan when it was aborted.
        """
        drive, body = self._drive, self._body
        reference = self._reference
        cos, sin = math.cos(reference), math.sin(reference)
        profile = Trapezoid(drive.forward_m, drive.speed_m_s, drive.acceleration_m_s2)
        last_tick = math.ceil((profile.duration_s + drive.timeout_s) / self._tick_s)
        pushed_ticks = 0
        stalled_s = 0.0
        x0, y0, _, _, _ = body.state()
        for tick in range(last_tick):
            x, y, yaw, speed, rate = body.state()
            time_s = tick * self._tick_s
            lag = profile.distance(time_s) - ((x - x0) * cos + (y - y0) * sin)
            heading_error = wrap_angle(reference - yaw)
            if time_s >= profile.duration_s and self._at_rest(lag, heading_error, speed, rate):
                return "reached", None
            resistance_n = cos * body.touch[1] + sin * body.touch[2]
            pushed_ticks = pushed_ticks + 1 if resistance_n > drive.blocking_force_n else 0
            stalled_s = stalled_s + self._tick_s if lag > drive.stall_lag_m and speed < drive.stall_speed_m_s else 0.0
            if pushed_ticks >= drive.blocking_ticks or stalled_s >= drive.stall_s:
                return "blocked", (cos, sin)
            planned = profile.speed(time_s + drive.lookahead_s)
            self._command(
                planned + drive.position_gain_1_s * lag,
                drive.heading_gain_1_s * heading_error,
                speed,
                rate,
            )
        x, y, _, _, _ = body.state()
        lag = drive.forward_m - ((x - x0) * cos + (y - y0) * sin)
        return ("reached", None) if abs(lag) <= drive.touching_tolerance_m else ("timeout", (cos, sin))

    def _turn(self, side: int) -> tuple[Ended, tuple[float, float] | None]:
        """Turns on the spot to the next heading reference, left for +1; a blocked turn keeps the last reference.

        Returns:
            How the motion ended, and (0, 0) when it was aborted.
        """
        drive, body = self._drive, self._body
        x0, y0, yaw0, _, _ = body.state()
        self._turns += side
        angle = wrap_angle(self._reference - yaw0)
        sign = math.copysign(1.0, angle)
        profile = Trapezoid(abs(angle), drive.turn_speed_rad_s, drive.turn_acceleration_rad_s2)
        last_tick = math.ceil((profile.duration_s + drive.timeout_s) / self._tick_s)
        stalled_s = 0.0
        for tick in range(last_tick):
            x, y, yaw, speed, rate = body.state()
            time_s = tick * self._tick_s
            lag = sign * profile.distance(time_s) - wrap_angle(yaw - yaw0)
            behind = -((x - x0) * math.cos(yaw) + (y - y0) * math.sin(yaw))
            if time_s >= profile.duration_s and self._at_rest(behind, lag, speed, rate):
                return "reached", None
            stalled = sign * lag > drive.stall_lag_rad and sign * rate < drive.stall_speed_rad_s
            stalled_s = stalled_s + self._tick_s if stalled else 0.0
            if stalled_s >= drive.stall_s:
                break
            planned = profile.speed(time_s + drive.lookahead_s)
            self._command(
                drive.position_gain_1_s * behind,
                sign * planned + drive.heading_gain_1_s * lag,
                speed,
                rate,
            )
        blocked = stalled_s >= drive.stall_s
        if abs(wrap_angle(self._reference - body.state()[2])) > 0.5 * drive.turn_rad:
            self._turns -= side
        return "blocked" if blocked else "timeout", (0.0, 0.0)

    def _back_off(self) -> None:
        """Moves back by a few millimetres from the obstacle that blocked the motion."""
        body, drive = self._body, self._drive
        reference = self._reference
        x0, y0, _, _, _ = body.state()
        cos, sin = math.cos(reference), math.sin(reference)
        for _ in range(round(drive.back_off_max_s / self._tick_s)):
            x, y, yaw, speed, rate = body.state()
            if (x - x0) * cos + (y - y0) * sin <= -drive.back_off_m:
                break
            turn_rate = drive.heading_gain_1_s * wrap_angle(reference - yaw)
            self._command(-drive.back_off_speed_m_s, turn_rate, speed, rate)

    def _realign(self) -> None:
        """Turns back to the heading reference."""
        drive = self._drive
        reference = self._reference
        for _ in range(round(drive.realign_max_s / self._tick_s)):
            _, _, yaw, speed, rate = self._body.state()
            error = wrap_angle(reference - yaw)
            if abs(error) <= drive.heading_tolerance_rad and abs(rate) <= drive.rest_speed_rad_s:
                break
            self._command(0.0, drive.heading_gain_1_s * error, speed, rate)

    def _come_to_rest(self) -> None:
        """Brakes until the robot is at rest."""
        drive = self._drive
        for _ in range(round(drive.rest_max_s / self._tick_s)):
            _, _, _, speed, rate = self._body.state()
            if abs(speed) <= drive.rest_speed_m_s and abs(rate) <= drive.rest_speed_rad_s:
                break
            self._command(0.0, 0.0, speed, rate)
        self._body.ctrl[:] = 0.0

    def _at_rest(self, lag_m: float, heading_error: float, speed: float, rate: float) -> bool:
        drive = self._drive
        tolerance_m = drive.touching_tolerance_m if self._touching else drive.position_tolerance_m
        return (
            abs(lag_m) <= tolerance_m
            and abs(heading_error) <= drive.heading_tolerance_rad
            and abs(speed) <= drive.rest_speed_m_s
            and abs(rate) <= drive.rest_speed_rad_s
        )

    @property
    def _touching(self) -> bool:
        return self._ticks < self._touched_until

    def _command(self, speed_m_s: float, rate_rad_s: float, actual_speed: float, actual_rate: float) -> None:
        """Applies one command of speed and turn rate for a tick.

        While the hull touches an object, or did so shortly before, the command is limited to values near the actual
        motion that saturate no motor, since two saturated motors cannot keep the heading. The turn rate has priority.
        """
        if self._touching:
            rate_rad_s = _clamp(rate_rad_s, actual_rate, self._full_slip / self._half_track)
            spare = self._full_slip - abs(rate_rad_s - actual_rate) * self._half_track
            speed_m_s = _clamp(speed_m_s, actual_speed, min(self._push_slip, spare))
        across = rate_rad_s * self._half_track
        self._body.ctrl[0] = (speed_m_s - across) / self._radius
        self._body.ctrl[1] = (speed_m_s + across) / self._radius
        mujoco.mj_step(self._model, self._data, self._steps)
        self._ticks += 1
        if self._body.touch[0] > 0.0:
            self._touched_until = self._ticks + self._touch_ticks
            self._log.sample(self._ticks)


def _clamp(value: float, centre: float, reach: float) -> float:
    return max(centre - reach, min(centre + reach, value))
