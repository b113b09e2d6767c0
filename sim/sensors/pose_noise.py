"""Source and noise of gps and compass: the true pose or the robot's odometry, and white noise.

A robot without a positioning system knows its pose by odometry alone. Slip, encoders and gyro then make gps and compass
drift, as they follow from the physics of the episode (`sim.robot.odometry`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.core.interface import CameraModel, ConfigError, wrap_angle
from sim.sensors.ranges import require_range
from sim.sensors.sensor import Sensor, SensorContext
from sim.sensors.standard import CompassSensor, GpsSensor


@dataclass(frozen=True, kw_only=True)
class PoseNoise:
    """Source and noise of gps and compass; by default they are the true pose."""

    from_odometry: bool = False
    """True: gps and compass are the robot's odometry, as in the sensor `odometry`."""
    gps_std_m: float = 0.0
    """Standard deviation of the white noise in each direction, as of a localization that does not drift."""
    compass_std_rad: float = 0.0
    """Standard deviation of the white noise."""

    def __post_init__(self) -> None:
        if not isinstance(self.from_odometry, bool):
            raise ConfigError(f"PoseNoise.from_odometry must be true or false, got {self.from_odometry!r}.")
        require_range(self, 0.0, math.inf, "gps_std_m", "compass_std_rad")

    def sensors(self, observed: Sequence[Sensor]) -> tuple[Sensor, ...]:
        """Returns the sensors that are read for an observation of these: with odometry in place of the true pose."""
        return tuple(_BY_ODOMETRY.get(sensor.name, sensor) if self.from_odometry else sensor for sensor in observed)

    def model(self, camera: CameraModel) -> NoisyPose | None:
        """Returns a new model of the white noise; None if it is off."""
        return NoisyPose(self) if self.gps_std_m > 0.0 or self.compass_std_rad > 0.0 else None


@dataclass(frozen=True, kw_only=True)
class OdometryGps(GpsSensor):
    """`gps` by odometry."""

    reads: tuple[str, ...] = ("odometry",)

    def read(self, context: SensorContext) -> NDArray:
        """Returns metres forward and left of the start pose."""
        return np.array([context.odometry.x_m, context.odometry.y_m], np.float32)


@dataclass(frozen=True, kw_only=True)
class OdometryCompass(CompassSensor):
    """`compass` by odometry."""

    reads: tuple[str, ...] = ("odometry",)

    def read(self, context: SensorContext) -> NDArray:
        """Returns the yaw against the start heading in (-pi, pi], radians."""
        return np.array([context.odometry.yaw_rad], np.float32)


_BY_ODOMETRY = {"gps": OdometryGps(), "compass": OdometryCompass()}


class NoisyPose:
    """Adds the white noise of a `PoseNoise` to gps and compass."""

    sensors = ("gps", "compass")
    images = ()

    def __init__(self, config: PoseNoise) -> None:
        self._std = np.array([config.gps_std_m, config.gps_std_m, config.compass_std_rad])

    def begin(self, gloss: NDArray[np.float32]) -> None:
        """Starts an episode; the noise has no memory."""
        del gloss

    def apply(
        self, readings: Mapping[str, NDArray], images: Mapping[str, NDArray], rng: np.random.Generator
    ) -> dict[str, NDArray]:
        """Returns gps (2,) in metres and compass (1,) in radians with noise, in new memory."""
        del images
        gps, compass = readings["gps"], readings["compass"]
        error = self._std * rng.standard_normal(3)
        yaw_rad = _at_most_pi(np.float32(wrap_angle(float(compass[0]) + float(error[2]))))
        return {"gps": (gps + error[:2]).astype(np.float32), "compass": np.array([yaw_rad], np.float32)}


def _at_most_pi(yaw_rad: np.float32) -> np.float32:
    """Returns an angle of (-pi, pi] that does not leave the interval by rounding to float32."""
    return np.clip(yaw_rad, -np.float32(np.pi), np.float32(np.pi))
