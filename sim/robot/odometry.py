"""Odometry: the pose that the robot itself knows, from its wheel encoders and, where it has one, its gyro."""

from __future__ import annotations

import math

from sim.core.geometry.pose import Pose
from sim.core.interface import wrap_angle
from sim.gl import mujoco
from sim.robot.body import Body
from sim.robot.conditions import NOMINAL, Conditions
from sim.robot.config import RobotConfig
from sim.robot.creep import FREE_SLIP, Creep
from sim.robot.variation import ActionErrors


class Odometry:
    """Integrates wheel angles and turn rates, tick by tick. It never reads the true position.

    Slip (`sim.robot.creep`), edges and springs make it differ from the truth, and so do the errors of encoders and gyro
    of an episode (`sim.robot.conditions`) and of an action (`sim.robot.variation`).
    """

    def __init__(self, config: RobotConfig, model: mujoco.MjModel, data: mujoco.MjData, body: Body) -> None:
        self._body = body
        self._creep = Creep(config, model, data, body)
        self._gyro = config.drive.gyro
        self._tick_s = config.drive.tick_s
        self._radius_m, self._track_m = config.wheels.radius_m, 2.0 * config.wheels.half_track_m
        self.reset(0.0, NOMINAL)

    def reset(self, yaw_rad: float, conditions: Conditions, compression_m: float = 0.0) -> None:
        """Starts an episode at the origin with a known heading.

        Args:
            yaw_rad: the heading.
            conditions: errors of encoders and gyro.
            compression_m: of the loaded tyres; a wheel rolls at the middle of it. A base is calibrated for
                this, and for the slip of wheels that roll freely on a hard floor.
        """
        self.x_m = self.y_m = 0.0
        self.yaw_rad = self._start_yaw_rad = yaw_rad
        self.speed_m_s = self.rate_rad_s = 0.0
        left, right = conditions.encoder_scale
        rolling_m = (self._radius_m - 0.5 * compression_m) / (1.0 + FREE_SLIP)
        self._metres_per_rad = rolling_m * left, rolling_m * right
        self._gyro_scale, self._gyro_bias_rad_s = conditions.gyro_scale, conditions.gyro_bias_rad_s
        self._creep.reset()
        self.vary(ActionErrors())
        self._wheels_rad = self._body.wheel_angles()
        self._gyro_rad = self._body.yaw_rad

    @property
    def since_start(self) -> Pose:
        """The pose relative to the start of the episode: x ahead, y left, yaw in (-pi, pi]."""
        cos, sin = math.cos(self._start_yaw_rad), math.sin(self._start_yaw_rad)
        x_m, y_m = cos * self.x_m + sin * self.y_m, cos * self.y_m - sin * self.x_m
        return Pose(x_m, y_m, wrap_angle(self.yaw_rad - self._start_yaw_rad))

    def vary(self, errors: ActionErrors) -> None:
        """Changes the errors of encoders and gyro for an action."""
        self._errors = errors

    def update(self) -> None:
        """Adds the motion of one tick."""
        (left0, right0), (left1, right1) = self._wheels_rad, self._body.wheel_angles()
        left_m, right_m = self._metres_per_rad[0] * (left1 - left0), self._metres_per_rad[1] * (right1 - right0)
        self._wheels_rad = left1, right1
        if left_m or right_m:
            slip = self._creep.slip()
            left_m = self._errors.wheel_scale * (left_m + abs(left_m) * slip[0])
            right_m = self._errors.wheel_scale * (right_m + abs(right_m) * slip[1])
        ahead_m = 0.5 * (left_m + right_m)
        turned = self._turned_by_gyro() if self._gyro else (right_m - left_m) / self._track_m
        middle = self.yaw_rad + 0.5 * turned
        self.x_m += math.cos(middle) * ahead_m
        self.y_m += math.sin(middle) * ahead_m
        self.yaw_rad += turned
        self.speed_m_s, self.rate_rad_s = self._rates()

    def _turned_by_gyro(self) -> float:
        """Returns the angle of one tick by a gyro that integrates the turn rate."""
        yaw = self._body.yaw_rad
        turned = math.remainder(yaw - self._gyro_rad, math.tau)
        self._gyro_rad = yaw
        return self._gyro_scale * self._errors.gyro_scale * turned + self._gyro_bias_rad_s * self._tick_s

    def _rates(self) -> tuple[float, float]:
        """Returns speed and turn rate at this moment."""
        left, right = self._body.wheel_speeds()
        left_m_s, right_m_s = self._metres_per_rad[0] * left, self._metres_per_rad[1] * right
        rate = self._body.turn_rate_rad_s if self._gyro else (right_m_s - left_m_s) / self._track_m
        return 0.5 * (left_m_s + right_m_s), rate
