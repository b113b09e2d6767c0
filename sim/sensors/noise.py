"""Noise of all sensors and of the drive: one configuration, presets by name, and the class that applies it.

Every part has a random stream of its own, all of them from the episode's one generator: an agent that also observes
`rgb` gets the same `depth` as one that does not.

A new noise model is one file with its settings (`sim.sensors.sensor.NoiseSettings`), used as a further field of
`NoiseConfig` or as the `noise` of a sensor that is passed to the environment.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.core.interface import CameraModel, ConfigError
from sim.robot.conditions import Conditions
from sim.sensors.actuation_noise import ActuationNoise
from sim.sensors.depth_noise import DepthNoise
from sim.sensors.measured import ImuNoise
from sim.sensors.pose_noise import PoseNoise
from sim.sensors.rgb_noise import RgbNoise
from sim.sensors.scan import ScanSensor
from sim.sensors.scan_noise import NoisyScan, ScanNoise
from sim.sensors.sensor import NoiseModel, Sensor


@dataclass(frozen=True, kw_only=True)
class NoiseConfig:
    """Noise of every sensor and of the drive; all of it is off by default.

    The order of the fields is the order of the random streams: append new fields at the end.
    """

    depth: DepthNoise = field(default_factory=DepthNoise)
    rgb: RgbNoise = field(default_factory=RgbNoise)
    pose: PoseNoise = field(default_factory=PoseNoise)
    actuation: ActuationNoise = field(default_factory=ActuationNoise)
    scan: ScanNoise = field(default_factory=ScanNoise)
    imu: ImuNoise = field(default_factory=ImuNoise)


_D435_FOCAL_BASELINE = 388.0 * 0.05
"""px m: the default focal length times the baseline of a RealSense D435; s px of disparity are s / this in 1 / z."""

NOISE_PRESETS: Mapping[str, NoiseConfig] = MappingProxyType(
    {
        "none": NoiseConfig(),
        # Depth error 0.08 px over windows of 7 px and steps of 1/32 px (Intel); jitter 0.5 px (Handa). The data sheet's
        # 2 % at 2 m are two standard deviations of the systematic error. The share at edges, the holes and the
        # numbers of the other sensors are assumptions for a good wheeled robot indoors.
        "realsense": NoiseConfig(
            depth=DepthNoise(
                axial_m=0.001,
                axial_1_m=round(0.08 / _D435_FOCAL_BASELINE, 5),
                window_px=7,
                bias_1_m=0.005,
                step_1_m=round(1.0 / 32.0 / _D435_FOCAL_BASELINE, 5),
                lateral_px=0.5,
                baseline_m=0.05,
                edge_flying=0.05,
                hole_share=0.8,
            ),
            rgb=RgbNoise(gain_std=0.02, shot_electrons_1=1 / 5000, read_std=1.0),
            pose=PoseNoise(from_odometry=True),
            # About half of the errors of a LoCoBot with the ILQR controller (PyRobot, `sim.robot.variation`): 14 mm a
            # forward, 1.3 deg a turn, of which 6 mm and 0.7 deg vary from action to action. Half of this variance is
            # in where the controller stops, which the odometry knows, and half in wheels and gyro, which it does not.
            actuation=ActuationNoise(
                floor_friction_scale=(0.3, 1.1),
                motor_gain_scale=(0.9, 1.1),
                motor_bias_rad_s=0.05,
                motor_latency_s=0.04,
                encoder_scale=(0.95, 1.05),
                encoder_mismatch=0.01,
                gyro_scale=(0.97, 1.03),
                gyro_bias_rad_s=math.radians(0.01),
                stop_std_m=0.002,
                stop_std_rad=0.003,
                wheel_std=0.008,
                gyro_std=0.008,
                motor_std=0.02,
            ),
            scan=ScanNoise(std_share=0.01),
            # Noise densities of a Bosch BMI055, the IMU of a RealSense D435i, at 100 Hz: 0.014 deg/s and 150 ug per
            # root of 1 Hz; offsets are assumed to be calibrated to a tenth of its data sheet's 1 deg/s and 70 mg.
            imu=ImuNoise(
                acceleration_std_m_s2=0.0147,
                rate_std_rad_s=math.radians(0.14),
                acceleration_bias_m_s2=0.069,
                rate_bias_rad_s=math.radians(0.1),
            ),
        ),
        # An old camera in poor light on a robot with slippery wheels: 2.5 times the random and twice the systematic
        # depth error, window and baseline of a Kinect.
        "harsh": NoiseConfig(
            depth=DepthNoise(
                axial_m=0.003,
                axial_1_m=0.01,
                window_px=9,
                bias_1_m=0.01,
                step_1_m=0.005,
                lateral_px=1.0,
                baseline_m=0.075,
                edge_flying=0.3,
                edge_radius_px=2,
                hole_share=1.0,
                hole_gloss=0.15,
                hole_patch_px=12.0,
            ),
            rgb=RgbNoise(gain_std=0.08, shot_electrons_1=1 / 500, read_std=5.0),
            pose=PoseNoise(from_odometry=True),
            # The errors of that LoCoBot, on floors that may be wet.
            actuation=ActuationNoise(
                floor_friction_scale=(0.2, 1.0),
                motor_gain_scale=(0.6, 1.1),
                motor_bias_rad_s=0.15,
                motor_latency_s=0.06,
                encoder_scale=(0.9, 1.1),
                encoder_mismatch=0.03,
                gyro_scale=(0.92, 1.08),
                gyro_bias_rad_s=math.radians(0.03),
                stop_std_m=0.004,
                stop_std_rad=0.006,
                wheel_std=0.016,
                gyro_std=0.016,
                motor_std=0.05,
            ),
            scan=ScanNoise(std_m=0.015, std_share=0.025, dropout=0.02),
            imu=ImuNoise(
                acceleration_std_m_s2=0.05,
                rate_std_rad_s=math.radians(0.5),
                acceleration_bias_m_s2=0.69,
                rate_bias_rad_s=math.radians(1.0),
            ),
        ),
    }
)
"""The presets that `--noise` and `ObjectNavEnv(noise=...)` take by name."""


def get_noise(name: str) -> NoiseConfig:
    """Returns the preset with this name.

    Raises:
        ConfigError: the preset is unknown.
    """
    if name not in NOISE_PRESETS:
        raise ConfigError(f"Unknown noise '{name}'. Available: {', '.join(NOISE_PRESETS)}.")
    return NOISE_PRESETS[name]


def noise_from_dict(settings: Mapping[str, object] | str) -> NoiseConfig:
    """Returns the noise that a file declares: a preset's name, or `{"preset": "realsense", "depth": {...}, ...}`.

    `preset` is `none` by default; the other keys are the fields of `NoiseConfig`, each with the fields that differ
    from the preset.

    Raises:
        ConfigError: an unknown preset, part or field, or a value that is not allowed.
    """
    if isinstance(settings, str):
        return get_noise(settings)
    if not isinstance(settings, Mapping):
        raise ConfigError(f"Noise must be a preset's name or an object, got {settings!r}.")
    config = get_noise(str(settings.get("preset", "none")))
    parts = [part.name for part in fields(config)]
    changed = {}
    for part, values in settings.items():
        if part == "preset":
            continue
        if part not in parts:
            raise ConfigError(f"Unknown part of noise '{part}'. Available: preset, {', '.join(parts)}.")
        changed[part] = _changed(part, getattr(config, part), values)
    return replace(config, **changed)


def _changed(part: str, config: Any, values: Any) -> Any:
    """Returns the settings of one part with some fields changed."""
    if not isinstance(values, Mapping):
        raise ConfigError(f"Noise '{part}' must be an object of fields and values, got {values!r}.")
    names = [part.name for part in fields(config)]
    for name in values:
        if name not in names:
            raise ConfigError(f"Noise '{part}' has no field '{name}'. Available: {', '.join(names)}.")
    return replace(
        config, **{name: tuple(value) if isinstance(value, list) else value for name, value in values.items()}
    )


class SensorNoise:
    """Applies noise to the observations of one environment, episode by episode. Noise that is off costs nothing."""

    def __init__(self, config: NoiseConfig, camera: CameraModel, sensors: Sequence[Sensor]) -> None:
        """Makes the noise models of the sensors in the observation; a sensor's own noise must change the sensor.

        Args:
            config: noise of the standard sensors and of the drive.
            camera: camera of the images.
            sensors: all sensors of the observation; their own noise is applied after that of `config`.
        """
        self.sensors = config.pose.sensors(sensors)
        """The sensors that are read for an observation: those given, or others of the same names and spaces."""
        self._actuation = config.actuation
        names = [part.name for part in fields(config)]
        self._actuation_part = names.index("actuation")
        own = [(sensor.noise, sensor.name) for sensor in sensors if sensor.noise is not None]
        observed = {sensor.name for sensor in sensors}
        self._models: list[NoiseModel | None] = []  # one for each part; None: off or not observed
        for part, owner in [*((getattr(config, name), "") for name in names), *own]:
            model = _model_of(part, camera, sensors)
            if model is not None and owner and owner not in model.sensors:
                raise ConfigError(
                    f"Sensor '{owner}' has a noise that does not change it but: {', '.join(model.sensors)}."
                )
            self._models.append(model if model is not None and observed.issuperset(model.sensors) else None)
        self._streams: list[np.random.Generator] = []

    @property
    def images(self) -> tuple[str, ...]:
        """Rendered images that the noise models need."""
        return tuple(name for model in self._models if model is not None for name in model.images)

    def begin(self, rng: np.random.Generator, gloss: NDArray[np.float32]) -> Conditions:
        """Starts an episode and returns the conditions of its physics.

        Args:
            rng: generator from which all noise of the episode comes.
            gloss: (ngeom,) gloss of the world's geoms.
        """
        self._streams = rng.spawn(len(self._models))
        for model in self._models:
            if model is not None:
                model.begin(gloss)
        return self._actuation.draw(self._streams[self._actuation_part])

    def apply(self, readings: Mapping[str, NDArray], images: Mapping[str, NDArray]) -> dict[str, NDArray]:
        """Returns an observation with noise; the true readings are not changed.

        Args:
            readings: reading of each of `sensors` by name, without noise.
            images: rendered images, among them those of `images`.
        """
        noisy = dict(readings)
        for model, rng in zip(self._models, self._streams, strict=True):
            if model is not None:
                noisy |= model.apply(noisy, {name: images[name] for name in model.images}, rng)
        return noisy


def _model_of(part: Any, camera: CameraModel, sensors: Sequence[Sensor]) -> NoiseModel | None:
    """Returns the noise model of one part; None if it is off, of the drive, or of a lidar that is not observed."""
    if isinstance(part, ActuationNoise):
        return None
    if isinstance(part, ScanNoise):
        scans = [lidar.config for lidar in sensors if isinstance(lidar, ScanSensor) and lidar.name in NoisyScan.sensors]
        return part.model_of(scans[0]) if scans else None
    return part.model(camera)
