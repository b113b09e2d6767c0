"""The noise of all sensors: one declared config, presets by name, and what puts it on observations.

Every part has a stream of random numbers of its own, all of them from the episode's one generator: an agent that also
looks at `rgb` gets the same `depth` as one that does not.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.interface import CameraModel, ConfigError
from sim.robot.conditions import Conditions
from sim.sensors.actuation_noise import ActuationNoise
from sim.sensors.depth_noise import DepthNoise, NoisyDepth
from sim.sensors.pose_noise import NoisyPose, PoseNoise
from sim.sensors.rgb_noise import NoisyRgb, RgbNoise


@dataclass(frozen=True, kw_only=True)
class NoiseConfig:
    """Noise of every sensor and of the drive; all of it off by default."""

    depth: DepthNoise = field(default_factory=DepthNoise)
    rgb: RgbNoise = field(default_factory=RgbNoise)
    pose: PoseNoise = field(default_factory=PoseNoise)
    actuation: ActuationNoise = field(default_factory=ActuationNoise)


_D435_FOCAL_BASELINE = 388.0 * 0.05
"""px m: our camera's focal length times a D435's baseline; a disparity of s px is s / this in 1 / z."""

NOISE_PRESETS: Mapping[str, NoiseConfig] = MappingProxyType(
    {
        "none": NoiseConfig(),
        # Depth error 0.08 px and steps of 1/32 px (Intel); jitter 0.5 px (Handa). Shares at edges, holes, and the
        # numbers of the other sensors are of our choosing: a decent wheeled robot indoors.
        "realsense": NoiseConfig(
            depth=DepthNoise(
                axial_m=0.001,
                axial_1_m=round(0.08 / _D435_FOCAL_BASELINE, 5),
                step_1_m=round(1.0 / 32.0 / _D435_FOCAL_BASELINE, 5),
                lateral_px=0.5,
                edge_dropout=0.3,
                edge_flying=0.05,
                hole_share=0.8,
            ),
            rgb=RgbNoise(gain_std=0.02, shot_electrons_1=1 / 5000, read_std=1.0),
            pose=PoseNoise(
                gps_std_m=0.01,
                gps_walk_m=0.002,
                compass_std_rad=math.radians(0.3),
                compass_walk_rad=math.radians(0.03),
            ),
            actuation=ActuationNoise(floor_friction_scale=(0.3, 1.1), motor_gain_scale=(0.9, 1.1)),
        ),
        # A worn camera in bad light on a robot with slippery wheels: 2.5 times the depth error, 4.5 deg of drift after
        # 500 actions.
        "harsh": NoiseConfig(
            depth=DepthNoise(
                axial_m=0.003,
                axial_1_m=0.01,
                step_1_m=0.005,
                lateral_px=1.0,
                edge_dropout=0.5,
                edge_flying=0.3,
                edge_radius_px=2,
                hole_share=1.0,
                hole_gloss=0.15,
                hole_patch_px=12.0,
            ),
            rgb=RgbNoise(gain_std=0.08, shot_electrons_1=1 / 500, read_std=5.0),
            pose=PoseNoise(
                gps_std_m=0.03,
                gps_walk_m=0.006,
                compass_std_rad=math.radians(1.0),
                compass_walk_rad=math.radians(0.2),
            ),
            actuation=ActuationNoise(floor_friction_scale=(0.06, 1.0), motor_gain_scale=(0.6, 1.1)),
        ),
    }
)
"""What `--noise` and `ObjectNavEnv(noise=...)` take by name."""


def get_noise(name: str) -> NoiseConfig:
    """The preset of that name.

    Raises:
        ConfigError: there is none.
    """
    if name not in NOISE_PRESETS:
        raise ConfigError(f"Unknown noise '{name}'. There is: {', '.join(NOISE_PRESETS)}.")
    return NOISE_PRESETS[name]


def noise_from_dict(given: Mapping[str, Any] | str) -> NoiseConfig:
    """Noise as a file has it: a preset's name, or `{"preset": "realsense", "depth": {"hole_share": 1.0}, ...}`.

    `preset` is `none` where it is left out; the other keys are the fields of `NoiseConfig`, each with the fields that
    differ from the preset.

    Raises:
        ConfigError: an unknown preset, part or field, or a value that will not do.
    """
    if isinstance(given, str):
        return get_noise(given)
    if not isinstance(given, Mapping):
        raise ConfigError(f"Noise must be a preset's name or an object, got {given!r}.")
    config = get_noise(str(given.get("preset", "none")))
    parts = [each.name for each in fields(config)]
    changed = {}
    for part, values in given.items():
        if part == "preset":
            continue
        if part not in parts:
            raise ConfigError(f"Unknown part of noise '{part}'. There is: preset, {', '.join(parts)}.")
        changed[part] = _changed(part, getattr(config, part), values)
    return replace(config, **changed)


def _changed(part: str, config: Any, values: Any) -> Any:
    """A part's config with these fields changed."""
    if not isinstance(values, Mapping):
        raise ConfigError(f"Noise '{part}' must be an object of fields and values, got {values!r}.")
    names = [each.name for each in fields(config)]
    for name in values:
        if name not in names:
            raise ConfigError(f"Noise '{part}' has no field '{name}'. There is: {', '.join(names)}.")
    return replace(
        config, **{name: tuple(value) if isinstance(value, list) else value for name, value in values.items()}
    )


class SensorNoise:
    """Puts a `NoiseConfig` on the observations of one environment, episode by episode. What is off costs nothing."""

    def __init__(self, config: NoiseConfig, camera: CameraModel) -> None:
        self.config = config
        self._depth = NoisyDepth(config.depth, camera) if config.depth != DepthNoise() else None
        self._rgb = NoisyRgb(config.rgb, camera) if config.rgb != RgbNoise() else None
        self._pose = NoisyPose(config.pose) if config.pose != PoseNoise() else None
        self._streams: dict[str, np.random.Generator] = {}

    def needs(self, sensors: Sequence[str]) -> tuple[str, ...]:
        """Images that are wanted beside those of `sensors`."""
        return ("geom",) if "depth" in sensors and self._depth is not None and self._depth.needs_geoms else ()

    def begin(self, rng: np.random.Generator, gloss: NDArray[np.float32]) -> Conditions:
        """Start an episode whose noise all comes from `rng`, in a world of this gloss (ngeom,); returns its physics."""
        parts = [each.name for each in fields(self.config)]
        self._streams = dict(zip(parts, rng.spawn(len(parts)), strict=True))
        if self._depth is not None:
            self._depth.begin(gloss)
        if self._pose is not None:
            self._pose.begin()
        return self.config.actuation.draw(self._streams["actuation"])

    def apply(self, truth: Mapping[str, NDArray], images: Mapping[str, NDArray]) -> dict[str, NDArray]:
        """An observation as the sensors give it; `images` holds what `needs` asked for. The truth is not changed."""
        seen = dict(truth)
        if self._depth is not None and "depth" in truth:
            seen["depth"] = self._depth.apply(truth["depth"], images.get("geom"), self._streams["depth"])
        if self._rgb is not None and "rgb" in truth:
            seen["rgb"] = self._rgb.apply(truth["rgb"], self._streams["rgb"])
        if self._pose is not None:
            seen["gps"], seen["compass"] = self._pose.apply(truth["gps"], truth["compass"], self._streams["pose"])
        return seen
