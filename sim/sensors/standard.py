"""The sensors, named as in Habitat where it has them; shapes and units are in `sim.core.interface.Observation`."""

from __future__ import annotations

import string
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from sim.core.errors import ConfigError
from sim.core.goals import PICTURE_PX
from sim.core.interface import (
    CONTEXT_FIELDS,
    GOAL_CATEGORIES,
    MAX_TILT_RAD,
    MPCAT40,
    POSE_SENSORS,
    CameraModel,
)
from sim.core.wishes import MAX_TEXT
from sim.sensors.measured import BumperSensor, ImuSensor, OdometrySensor
from sim.sensors.scan import ScanSensor
from sim.sensors.semantic_map import SemanticMapSensor
from sim.sensors.sensor import NoiseSettings, Sensor, SensorContext, declared_fields


@dataclass(frozen=True, kw_only=True)
class RgbSensor:
    """Colour image."""

    name: str = "rgb"
    images: tuple[str, ...] = ("rgb",)
    noise: NoiseSettings | None = None

    def space(self, camera: CameraModel) -> spaces.Box:
        """Returns the space of uint8 images (h, w, 3)."""
        return spaces.Box(0, 255, (camera.height_px, camera.width_px, 3), np.uint8)

    def read(self, context: SensorContext) -> NDArray:
        """Returns the rendered colour image."""
        return context.images["rgb"]


@dataclass(frozen=True, kw_only=True)
class DepthSensor:
    """Depth image, metres along the optical axis."""

    name: str = "depth"
    images: tuple[str, ...] = ("depth",)
    noise: NoiseSettings | None = None

    def space(self, camera: CameraModel) -> spaces.Box:
        """Returns the space of float32 images (h, w) within the camera's range."""
        return spaces.Box(0.0, camera.max_depth_m, (camera.height_px, camera.width_px), np.float32)

    def read(self, context: SensorContext) -> NDArray:
        """Returns the rendered depth image."""
        return context.images["depth"]


@dataclass(frozen=True, kw_only=True)
class SemanticSensor:
    """Ground-truth segmentation, mpcat40 ids."""

    name: str = "semantic"
    images: tuple[str, ...] = ("semantic",)
    noise: NoiseSettings | None = None

    def space(self, camera: CameraModel) -> spaces.Box:
        """Returns the space of uint8 images (h, w)."""
        return spaces.Box(0, len(MPCAT40) - 1, (camera.height_px, camera.width_px), np.uint8)

    def read(self, context: SensorContext) -> NDArray:
        """Returns the rendered categories."""
        return context.images["semantic"]


@dataclass(frozen=True, kw_only=True)
class GpsSensor:
    """Position relative to the start pose."""

    name: str = "gps"
    images: tuple[str, ...] = ()
    reads: tuple[str, ...] = ("pose", "start")
    noise: NoiseSettings | None = None

    def space(self, camera: CameraModel) -> spaces.Box:
        """Returns the space of float32 positions (2,), unbounded."""
        limit = np.finfo(np.float32).max
        return spaces.Box(-limit, limit, (2,), np.float32)

    def read(self, context: SensorContext) -> NDArray:
        """Returns metres forward and left of the start pose."""
        pose = context.pose.relative_to(context.start)
        return np.array([pose.x_m, pose.y_m], np.float32)


@dataclass(frozen=True, kw_only=True)
class CompassSensor:
    """Yaw relative to the start heading."""

    name: str = "compass"
    images: tuple[str, ...] = ()
    reads: tuple[str, ...] = ("pose", "start")
    noise: NoiseSettings | None = None

    def space(self, camera: CameraModel) -> spaces.Box:
        """Returns the space of float32 angles (1,)."""
        return spaces.Box(-np.float32(np.pi), np.float32(np.pi), (1,), np.float32)

    def read(self, context: SensorContext) -> NDArray:
        """Returns the yaw in (-pi, pi], radians."""
        return np.array([context.pose.relative_to(context.start).yaw_rad], np.float32)


@dataclass(frozen=True, kw_only=True)
class ObjectGoalSensor:
    """Category that the episode asks for."""

    name: str = "objectgoal"
    images: tuple[str, ...] = ()
    reads: tuple[str, ...] = ("goal",)
    noise: NoiseSettings | None = None

    def space(self, camera: CameraModel) -> spaces.Box:
        """Returns the space of int64 indices (1,)."""
        return spaces.Box(-1, len(GOAL_CATEGORIES) - 1, (1,), np.int64)

    def read(self, context: SensorContext) -> NDArray:
        """Returns the index of the goal in `GOAL_CATEGORIES`; -1: the goal is in words or a picture."""
        known = context.goal in GOAL_CATEGORIES
        return np.array([GOAL_CATEGORIES.index(context.goal) if known else -1], np.int64)


_CHARACTERS = frozenset(string.ascii_letters + string.digits + string.punctuation + " ")


@dataclass(frozen=True, kw_only=True)
class GoalSensor:
    """The goal as text."""

    name: str = "goal"
    images: tuple[str, ...] = ()
    reads: tuple[str, ...] = ("goal",)
    noise: NoiseSettings | None = None

    def space(self, camera: CameraModel) -> spaces.Text:
        """Returns the space of texts of printable ASCII characters."""
        return spaces.Text(MAX_TEXT, min_length=0, charset=_CHARACTERS)

    def read(self, context: SensorContext) -> Any:  # a text is the only reading that is no array
        """Returns the text, without characters that are not in the space; "": the goal is a picture."""
        return "".join(filter(_CHARACTERS.__contains__, context.goal))


@dataclass(frozen=True, kw_only=True)
class GoalPictureSensor:
    """The picture of a goal."""

    name: str = "goal_picture"
    images: tuple[str, ...] = ()
    reads: tuple[str, ...] = ("picture",)
    noise: NoiseSettings | None = None
    width_px: int = PICTURE_PX
    height_px: int = PICTURE_PX

    def space(self, camera: CameraModel) -> spaces.Box:
        """Returns the space of uint8 images (h, w, 3)."""
        return spaces.Box(0, 255, (self.height_px, self.width_px, 3), np.uint8)

    def read(self, context: SensorContext) -> NDArray:
        """Returns the picture; 0 everywhere: the goal is text.

        Raises:
            ConfigError: the picture has another size.
        """
        shape = (self.height_px, self.width_px, 3)
        if context.picture is None:
            return np.zeros(shape, np.uint8)
        if context.picture.shape != shape:
            height, width, _ = context.picture.shape
            raise ConfigError(
                f"The picture of the goal has {width} x {height} pixels, and the sensor '{self.name}' "
                f"{self.width_px} x {self.height_px}; give GoalPictureSensor(width_px={width}, height_px={height})."
            )
        return context.picture.copy()


@dataclass(frozen=True, kw_only=True)
class TiltSensor:
    """Tilt of the camera, which LOOK_UP and LOOK_DOWN change."""

    name: str = "tilt"
    images: tuple[str, ...] = ()
    reads: tuple[str, ...] = ("tilt",)
    noise: NoiseSettings | None = None

    def space(self, camera: CameraModel) -> spaces.Box:
        """Returns the space of float32 angles (1,)."""
        return spaces.Box(-np.float32(MAX_TILT_RAD), np.float32(MAX_TILT_RAD), (1,), np.float32)

    def read(self, context: SensorContext) -> NDArray:
        """Returns the tilt in radians, positive: up."""
        return np.array([context.tilt], np.float32)


STANDARD_SENSORS: Mapping[str, Sensor] = MappingProxyType(
    {
        sensor.name: sensor
        for sensor in (
            RgbSensor(), DepthSensor(), SemanticSensor(), GpsSensor(), CompassSensor(), ObjectGoalSensor(),
            ScanSensor(), BumperSensor(), OdometrySensor(), ImuSensor(), TiltSensor(), GoalSensor(),
            GoalPictureSensor(), SemanticMapSensor(),
        )
    }
)  # fmt: skip
"""The sensors that `ObjectNavEnv(sensors=...)` takes by name; those of `POSE_SENSORS` are always present."""


def resolve_sensors(requested: Sequence[str | Sensor]) -> tuple[Sensor, ...]:
    """Returns the sensors of an observation, in its order: those given, then the pose sensors that are missing.

    Raises:
        ConfigError: an unknown name, or two different sensors with one name.
    """
    if isinstance(requested, str):
        raise ConfigError(f"sensors must be a tuple of sensors or their names, got '{requested}'.")
    resolved: dict[str, Sensor] = {}
    for name_or_sensor in requested:
        is_name = isinstance(name_or_sensor, str)
        sensor = _standard_sensor(name_or_sensor) if is_name else _checked(name_or_sensor)
        if resolved.setdefault(sensor.name, sensor) != sensor:
            raise ConfigError(f"Two sensors have the name '{sensor.name}'; each key of the observation needs its own.")
    for name in POSE_SENSORS:
        resolved.setdefault(name, STANDARD_SENSORS[name])
    return tuple(resolved.values())


def _checked(sensor: Sensor) -> Sensor:
    """Returns a user's sensor after a check of its interface.

    Raises:
        ConfigError: it is a class, lacks a member of `Sensor`, or has the name of a standard sensor.
    """
    if isinstance(sensor, type):
        raise ConfigError(f"Sensor {sensor.__name__} is a class; give an object: {sensor.__name__}().")
    missing = [member for member in ("name", "images", "noise", "space", "read") if member not in dir(sensor)]
    if missing:
        raise ConfigError(
            f"Sensor {type(sensor).__name__} has no {', '.join(missing)}; see `sim.sensors.sensor.Sensor` "
            "(images = () for a sensor without images, noise = None for one without noise)."
        )
    for member, names in (("images", sensor.images), ("reads", declared_fields(sensor))):
        if isinstance(names, str):
            raise ConfigError(f"Sensor '{sensor.name}': {member} must be a tuple of names, got '{names}'.")
    unknown = [name for name in declared_fields(sensor) if name not in CONTEXT_FIELDS]
    if unknown:
        raise ConfigError(
            f"Sensor '{sensor.name}': reads names '{unknown[0]}'. Available: {', '.join(CONTEXT_FIELDS)}; images are "
            "declared in `images`."
        )
    standard = STANDARD_SENSORS.get(sensor.name)
    if standard is not None and type(sensor) is not type(standard):
        raise ConfigError(f"Sensor {type(sensor).__name__} has the name of the standard sensor '{sensor.name}'.")
    return sensor


def _standard_sensor(name: str) -> Sensor:
    if name not in STANDARD_SENSORS:
        raise ConfigError(
            f"Unknown sensor '{name}'. Available: {', '.join(STANDARD_SENSORS)}, or an object with the interface "
            "`sim.sensors.sensor.Sensor`."
        )
    return STANDARD_SENSORS[name]
