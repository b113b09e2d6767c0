"""The interfaces that a new sensor and a new noise model implement.

A sensor is one object: its key in the observation, its Gymnasium space, what it reads and how it is read.
`ObjectNavEnv(sensors=("rgb", MySensor()))` takes such objects in addition to the names of `sim.sensors.standard`.

A sensor declares the images (`images`) and the fields of `SensorContext` (`reads`) that it reads; it gets no others. If
a sensor declares ground truth (`sim.core.interface.reads_truth`), the result lines of its agent have
`uses_ground_truth`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from sim.core.geometry.pose import BodyPose, Pose
from sim.core.interface import CONTEXT_FIELDS, CameraModel, ConfigError
from sim.gl import mujoco
from sim.houses.labels import Labels
from sim.robot.drive import Motion


class SensorContext:
    """The state from which one sensor is read after a reset or an action: only the fields that the sensor declares.

    Sensors are read before the task counts the action: its number of steps is still that before the action.

    | field | declared in | meaning |
    |---|---|---|
    | images | `images` | rendered images by name, without noise |
    | goal | `reads` | the goal as text; "": it is a picture |
    | picture | `reads` | the picture of the goal, uint8 (h, w, 3); None: the goal is text |
    | collided | `reads` | whether a contact stopped the last action |
    | odometry | `reads` | pose by the robot's own odometry, relative to the start |
    | tilt | `reads` | tilt of the camera, rad; positive: up |
    | pose | `reads`, truth | pose of the robot's body in the world, with its lean |
    | start | `reads`, truth | pose of the robot in the world when the episode started |
    | motion | `reads`, truth | the last action as it was carried out, with its contacts; None before the first one |
    | model | `reads`, truth | the compiled world; read only |
    | data | `reads`, truth | state of the world; read only |
    | glass | `reads`, truth | (ngeom,) True for panes of windows; read only |
    | labels | `reads`, truth | category and instance of each geom (`sim.houses.labels`) |
    """

    images: Mapping[str, NDArray]
    goal: str
    picture: NDArray[np.uint8] | None
    collided: bool
    odometry: Pose
    pose: BodyPose
    start: Pose
    motion: Motion | None
    model: mujoco.MjModel
    data: mujoco.MjData
    glass: NDArray[np.bool_]
    labels: Labels
    tilt: float

    def __init__(self, sensor: Sensor, images: Mapping[str, NDArray], **fields: Any) -> None:
        """Keeps the declared part of the state.

        Args:
            sensor: the sensor that is read.
            images: all images that were rendered.
            fields: all fields except `images`.
        """
        self.images = DeclaredImages(sensor.name, sensor.images, images)
        self._sensor, self._declared = sensor.name, declared_fields(sensor)
        vars(self).update({name: fields[name] for name in self._declared})

    def __getattr__(self, name: str) -> Any:
        """Raises ConfigError for a field that the sensor does not declare; declared fields are found before."""
        if name in CONTEXT_FIELDS:
            raise ConfigError(
                f"Sensor '{self._sensor}' reads context.{name}, which it does not declare: "
                f"reads = {(*self._declared, name)!r}."
            )
        raise AttributeError(f"SensorContext has no '{name}'. It has: images, {', '.join(CONTEXT_FIELDS)}.")


def declared_fields(sensor: Sensor) -> tuple[str, ...]:
    """Returns the fields of `SensorContext` that a sensor declares; a sensor without `reads` declares none."""
    return getattr(sensor, "reads", ())


class DeclaredImages(dict[str, NDArray]):
    """The rendered images that a reader declares; it must not read others, such as ground truth."""

    def __init__(self, reader: str, declared: Sequence[str], images: Mapping[str, NDArray]) -> None:
        super().__init__({name: images[name] for name in declared})
        self._reader = reader

    def __missing__(self, name: str) -> NDArray:
        raise ConfigError(f"Sensor '{self._reader}' reads the image '{name}', which it does not declare in `images`.")


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
        """Starts an episode in a house; `gloss` (ngeom,) in [0, 1] is that of its geoms (`sim.renderer.gloss`)."""
        ...

    def apply(
        self, readings: Mapping[str, NDArray], images: Mapping[str, NDArray], rng: np.random.Generator
    ) -> Mapping[str, NDArray]:
        """Returns the readings of `sensors` with noise, in new memory; the arguments must not be changed.

        Args:
            readings: reading of each sensor by name.
            images: the rendered images that it declares, by name, without noise.
            rng: this model's own stream of the episode.
        """
        ...


class NoiseSettings(Protocol):
    """Parameters of a noise model, usually a frozen dataclass; its defaults switch the noise off."""

    def model(self, camera: CameraModel) -> NoiseModel | None:
        """Returns a new noise model for the readings of this camera; None if the noise is switched off."""
        ...


class Sensor(Protocol):
    """One key of the observation. Reading it must not change the world.

    A sensor that reads fields of `SensorContext` other than `images` names them in an attribute `reads`, a tuple of
    names of `sim.core.interface.CONTEXT_FIELDS`.
    """

    @property
    def name(self) -> str:
        """The key of the sensor in the observation."""
        ...

    @property
    def images(self) -> tuple[str, ...]:
        """Rendered images that it needs, of `rgb`, `depth`, `semantic` and `geom` (`sim.renderer.camera`)."""
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
