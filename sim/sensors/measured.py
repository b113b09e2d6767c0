"""Sensors of the robot itself: contacts on its skirt (`bumper`), wheel odometry (`odometry`), inertia (`imu`).

They are in the observation only when requested. `odometry` is the pose by which the drive itself moves
(`sim.robot.odometry`): slip, edges and the errors of encoders and gyro are in it. The noise of `imu` is `ImuNoise`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from sim.core.interface import CLIMB_M, CameraModel
from sim.gl import mujoco
from sim.robot.body import PREFIX
from sim.sensors.ranges import require_range, require_whole
from sim.sensors.sensor import NoiseSettings, SensorContext

_LARGEST = np.finfo(np.float32).max


@dataclass(frozen=True, kw_only=True)
class BumperSensor:
    """The sectors of the hull that touched something during the last action."""

    sectors: int = 6
    """Number of equal sectors; sector 0 is centred ahead, the others follow counter-clockwise."""
    name: str = "bumper"
    images: tuple[str, ...] = ()
    reads: tuple[str, ...] = ("motion", "pose")
    noise: NoiseSettings | None = None

    def __post_init__(self) -> None:
        require_whole(self, 1, 360, "sectors")

    def space(self, camera: CameraModel) -> spaces.MultiBinary:
        """Returns the space of int8 flags (sectors,)."""
        return spaces.MultiBinary(self.sectors)

    def read(self, context: SensorContext) -> NDArray:
        """Returns 1 for each sector with a contact; contacts of the wheels with the ground do not count."""
        touched = np.zeros(self.sectors, np.int8)
        pose = context.pose
        for contact in () if context.motion is None else context.motion.contacts:
            x_m, y_m, z_m = contact.position_m
            if z_m - pose.floor_z_m > CLIMB_M:
                bearing = math.atan2(y_m - pose.y_m, x_m - pose.x_m) - pose.yaw_rad
                touched[round(bearing / math.tau * self.sectors) % self.sectors] = 1
        return touched


@dataclass(frozen=True, kw_only=True)
class OdometrySensor:
    """The pose by the robot's own odometry, relative to the start pose."""

    name: str = "odometry"
    images: tuple[str, ...] = ()
    reads: tuple[str, ...] = ("odometry",)
    noise: NoiseSettings | None = None

    def space(self, camera: CameraModel) -> spaces.Box:
        """Returns the space of float32 poses (3,), unbounded."""
        return spaces.Box(-_LARGEST, _LARGEST, (3,), np.float32)

    def read(self, context: SensorContext) -> NDArray:
        """Returns metres forward and left of the start pose, and the yaw against it in (-pi, pi]."""
        pose = context.odometry
        return np.array([pose.x_m, pose.y_m, pose.yaw_rad], np.float32)


@dataclass(frozen=True, kw_only=True)
class ImuSensor:
    """Accelerations and turn rates of the base in the robot's frame; at rest (0, 0, 9.81) m/s2 and no rate."""

    name: str = "imu"
    images: tuple[str, ...] = ()
    reads: tuple[str, ...] = ("model", "data")
    noise: NoiseSettings | None = None

    def space(self, camera: CameraModel) -> spaces.Box:
        """Returns the space of float32 values (6,), unbounded."""
        return spaces.Box(-_LARGEST, _LARGEST, (6,), np.float32)

    def read(self, context: SensorContext) -> NDArray:
        """Returns the accelerations along x, y, z (m/s2), then the turn rates about them (rad/s), (6,)."""
        model, data = context.model, context.data
        base = model.body(PREFIX + "base").id
        mujoco.mj_rnePostConstraint(model, data)  # accelerations of bodies
        rate, acceleration = np.empty(6), np.empty(6)
        mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_BODY, base, rate, 1)
        mujoco.mj_objectAcceleration(model, data, mujoco.mjtObj.mjOBJ_BODY, base, acceleration, 1)
        return np.concatenate((acceleration[3:], rate[:3])).astype(np.float32)


@dataclass(frozen=True, kw_only=True)
class ImuNoise:
    """Noise of the sensor `imu`; every default is off."""

    acceleration_std_m_s2: float = 0.0
    """Standard deviation of each acceleration."""
    rate_std_rad_s: float = 0.0
    """Standard deviation of each turn rate."""
    acceleration_bias_m_s2: float = 0.0
    """Standard deviation of an offset of each acceleration, drawn for each episode."""
    rate_bias_rad_s: float = 0.0
    """The same of each turn rate."""

    def __post_init__(self) -> None:
        names = ("acceleration_std_m_s2", "rate_std_rad_s", "acceleration_bias_m_s2", "rate_bias_rad_s")
        require_range(self, 0.0, math.inf, *names)

    def model(self, camera: CameraModel) -> NoisyImu | None:
        """Returns a new noise model; None if all noise is off."""
        return None if self == ImuNoise() else NoisyImu(self)


class NoisyImu:
    """Applies an `ImuNoise` to the readings (`sim.sensors.sensor.NoiseModel`)."""

    sensors = ("imu",)
    images = ()

    def __init__(self, config: ImuNoise) -> None:
        self._std = np.repeat([config.acceleration_std_m_s2, config.rate_std_rad_s], 3)
        self._bias_std = np.repeat([config.acceleration_bias_m_s2, config.rate_bias_rad_s], 3)
        self._bias: NDArray[np.float64] | None = None

    def begin(self, gloss: NDArray[np.float32]) -> None:
        """Starts an episode with a new offset."""
        del gloss
        self._bias = None

    def apply(
        self, readings: Mapping[str, NDArray], images: Mapping[str, NDArray], rng: np.random.Generator
    ) -> dict[str, NDArray]:
        """Returns the readings (6,) with noise, in new memory."""
        del images
        if self._bias is None:
            self._bias = self._bias_std * rng.standard_normal(6)
        noise = self._bias + self._std * rng.standard_normal(6)
        return {"imu": (readings["imu"] + noise).astype(np.float32)}
