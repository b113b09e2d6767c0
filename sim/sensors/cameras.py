"""Sensors of further cameras of the robot: `left_rgb`, `left_depth` and `left_semantic` of a camera `left`."""

from __future__ import annotations

import re
import reprlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from sim.core.configuration import as_settings
from sim.core.errors import ConfigError
from sim.core.interface import MPCAT40, CameraModel
from sim.renderer.mounted import CameraConfig
from sim.sensors.sensor import NoiseSettings, Sensor, SensorContext

_NAME = re.compile(r"[a-z][a-z0-9_]{0,30}")
MAX_CAMERAS = 32


@dataclass(frozen=True, kw_only=True)
class CameraSensor:
    """One image of one camera; an image of `semantic` is ground truth."""

    camera: str
    """Name of the camera."""
    image: str = "rgb"
    """`rgb`, `depth` or `semantic`."""
    config: CameraConfig = field(default_factory=CameraConfig)
    noise: NoiseSettings | None = None

    @property
    def name(self) -> str:
        """The key in the observation."""
        return f"{self.camera}_{self.image}"

    @property
    def images(self) -> tuple[str, ...]:
        """The rendered image."""
        return (f"{self.camera}:{self.image}",)

    def space(self, camera: CameraModel) -> spaces.Box:
        """Returns the space of its images: as of the first camera, in this camera's size."""
        shape = self.config.shape()
        if self.image == "rgb":
            return spaces.Box(0, 255, (*shape, 3), np.uint8)
        if self.image == "semantic":
            return spaces.Box(0, len(MPCAT40) - 1, shape, np.uint8)
        return spaces.Box(0.0, self.config.max_depth_m, shape, np.float32)

    def read(self, context: SensorContext) -> NDArray:
        """Returns the rendered image."""
        return context.images[self.images[0]]


def camera_sensors(cameras: Mapping[str, CameraConfig | Mapping[str, object]]) -> tuple[CameraSensor, ...]:
    """Returns the sensors of all images of some cameras.

    Args:
        cameras: configuration, or some of its fields, by the name of the camera.

    Raises:
        ConfigError: a name or a field is not allowed.
    """
    return tuple(
        CameraSensor(camera=name, image=image, config=config)
        for name, config in cameras_by_name(cameras).items()
        for image in config.images
    )


def with_cameras(
    sensors: Sequence[str | Sensor], cameras: Mapping[str, CameraConfig | Mapping[str, object]]
) -> Sequence[str | Sensor]:
    """Returns the sensors of an observation with those of further cameras, which take the place of their names.

    Raises:
        ConfigError: see `camera_sensors`.
    """
    mounted = camera_sensors(cameras)
    names = [sensor.name for sensor in mounted]  # a list: sensors of users need not be hashable
    return [*(sensor for sensor in sensors if sensor not in names), *mounted] if mounted else sensors


def cameras_by_name(cameras: Mapping[str, CameraConfig | Mapping[str, object]]) -> dict[str, CameraConfig]:
    """Returns the configurations of cameras that are given as such, or as some of their fields.

    Raises:
        ConfigError: a name or a field is not allowed.
    """
    if not isinstance(cameras, Mapping):
        raise ConfigError(f"cameras must be a dict of cameras by name, got {reprlib.repr(cameras)}.")
    for name in cameras:
        if not _NAME.fullmatch(name):
            raise ConfigError(f"A camera's name consists of a-z, 0-9 and _, and begins with a letter; got {name!r}.")
    return {name: as_settings(given, CameraConfig(), name=f"camera '{name}'") for name, given in cameras.items()}


def cameras_of(sensors: tuple[Sensor, ...]) -> dict[str, CameraConfig]:
    """Returns the cameras of the sensors of an observation, by name.

    Raises:
        ConfigError: there are too many, or two of one name.
    """
    cameras: dict[str, CameraConfig] = {}
    for sensor in sensors:
        if isinstance(sensor, CameraSensor) and cameras.setdefault(sensor.camera, sensor.config) != sensor.config:
            raise ConfigError(f"Two cameras have the name '{sensor.camera}'; each needs its own.")
    if len(cameras) > MAX_CAMERAS:
        raise ConfigError(f"At most {MAX_CAMERAS} cameras are allowed, got {len(cameras)}.")
    return cameras
