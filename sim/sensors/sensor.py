"""The interfaces that a new sensor and a new noise model implement.

A sensor is one object: its key in the observation, its Gymnasium space, the images it needs and how it is read.
`ObjectNavEnv(sensors=("rgb", MySensor()))` takes such objects in addition to the names of `sim.sensors.standard`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from sim.geometry.pose import Pose
from sim.gl import mujoco
from sim.interface import CameraModel, ConfigError
from sim.robot.drive import Motion


@dataclass(frozen=True, eq=False, kw_only=True)
class SensorContext:
    """The true state that sensors are read from, after a reset or an action."""

    images: Mapping[str, NDArray]
    """Rendered images by name, without noise; those that the sensor declares."""
    pose: Pose
    """Pose of the robot in the world."""
    start: Pose
    """Pose of the robot in the world when the episode started."""
    goal: str
    """Category that the episode asks for."""
    motion: Motion | None
    """The last action as it was carried out, with its contacts; None at the first reading of an episode."""
    model: mujoco.MjModel
    """The compiled world; read only."""
    data: mujoco.MjData
    """State of the world; read only."""


class DeclaredImages(dict[str, NDArray]):
    """The rendered images that a sensor declares; it must not read others, such as the truth."""

    def __init__(self, sensor: Sensor, images: Mapping[str, NDArray]) -> None:
        super().__init__({name: images[name] for name in sensor.images})
        self._sensor = sensor.name

    def __missing__(self, name: str) -> NDArray:
        raise ConfigError(f"Sensor '{self._sensor}' reads the image '{name}', which it does not declare in `images`.")


class NoiseModel(Protocol):
    """Noise of the readings of one environment; may keep state during an episode."""

    @property
    def sensors(self) -> tuple[str, ...]:
        """Names of the sensors whose readings it changes; it is used if the observation has all of them."""
        ...

    @property
    def images(self) -> tuple[str, ...]:
        """Rendered images that it needs."""
        ...

    def begin(self, gloss: NDArray[np.float32]) -> None:
        """Starts an episode in a house whose geoms have this gloss, (ngeom,) in [0, 1] (`sim.sensors.gloss`)."""
        ...

    def apply(
        self, readings: Mapping[str, NDArray], images: Mapping[str, NDArray], rng: np.random.Generator
    ) -> Mapping[str, NDArray]:
        """Returns the readings of `sensors` with noise, in new memory; the arguments must not be changed.

        Args:
            readings: reading of each sensor by name.
            images: rendered images by name, without noise.
            rng: this model's own stream of the episode.
        """
        ...


class NoiseSettings(Protocol):
    """Parameters of a noise model, usually a frozen dataclass whose defaults switch it off."""

    def model(self, camera: CameraModel) -> NoiseModel | None:
        """Returns a new noise model for the readings of this camera; None where the noise is switched off."""
        ...


class Sensor(Protocol):
    """One key of the observation. Reading it must not change the world."""

    @property
    def name(self) -> str:
        """Its key in the observation."""
        ...

    @property
    def images(self) -> tuple[str, ...]:
        """Rendered images that it needs, of `rgb`, `depth`, `semantic` and `geom` (`sim.sensors.camera`)."""
        ...

    @property
    def noise(self) -> NoiseSettings | None:
        """Noise of its own, applied after that of `NoiseConfig`; None for none."""
        ...

    def space(self, camera: CameraModel) -> spaces.Space[Any]:
        """Returns the Gymnasium space of its readings."""
        ...

    def read(self, context: SensorContext) -> NDArray:
        """Returns the true reading."""
        ...
