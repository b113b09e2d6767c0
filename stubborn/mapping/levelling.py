"""Turns the images of a camera that leans with the robot's body into those of a level one, by the sensor `imu`.

At rest an accelerometer measures the direction of gravity, and with it pitch and roll. The map and everything after it
need a level camera, in whose image a column is a vertical plane. A rotation about the camera's centre is a projection
from image to image, so that the levelled image is exact but for pixels outside of the original one, which are empty.

The offset of an accelerometer looks like a lean. Floors of homes are level; the median of all readings of an episode is
therefore taken as the offset.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Float32, Int

from sim.core.geometry.pose import BodyPose, Pose
from sim.core.interface import CameraModel, ConfigError, Observation, Scores, Segmenter, SegmenterSpec
from stubborn.kernels.levelling import level_depth

IMU = "imu"
"""The sensor that is read if the observation holds it."""


@dataclass(frozen=True, kw_only=True)
class LevellingConfig:
    """The lean from which images are levelled."""

    from_rad: float = math.radians(0.5)
    """A smaller lean moves a point at 5 m by at most 4 cm; inf: images are never levelled."""
    jump_1_m: float = 0.03
    """Pixels lie on one surface when their 1 / depth differs by less."""

    def __post_init__(self) -> None:
        if not (self.from_rad >= 0.0 and self.jump_1_m >= 0.0):
            raise ConfigError(
                f"LevellingConfig needs from_rad and jump_1_m >= 0, got {self.from_rad} and {self.jump_1_m}."
            )


class Levelling:
    """Levels the images of one camera, frame by frame."""

    def __init__(self, camera: CameraModel, camera_forward_m: float, config: LevellingConfig) -> None:
        self._camera, self._forward_m, self._config = camera, camera_forward_m, config
        self.reset()

    def reset(self) -> None:
        """Starts a new episode."""
        self._readings: list[tuple[float, float]] = []
        self._lean: BodyPose | None = None
        self.raw: Observation = {}
        """The observation as it was read."""

    def level(self, observation: Observation) -> Observation:
        """Returns the observation with the depth image of a level camera and no colours, or itself if it is level."""
        self.raw, self._lean = observation, self._measured(observation)
        if self._lean is None:
            return observation
        depth = np.ascontiguousarray(observation["depth"])
        row, col, ahead = self._source(depth.shape)
        level, jump_1_m = np.empty_like(depth), np.float32(self._config.jump_1_m)
        level_depth(depth, row, col, ahead, np.float32(self._camera.max_depth_m), jump_1_m, level)
        return {**{name: value for name, value in observation.items() if name != "rgb"}, "depth": level}

    def eye(self, pose: Pose) -> Pose:
        """Returns the pose of the point on the floor below the camera, whose mast leans with the body."""
        if self._lean is None:
            return Pose(*pose.ahead(self._forward_m), pose.yaw_rad)
        forward_m, left_m, _ = self._lean.point(self._forward_m, 0.0, self._camera.height_m).tolist()
        return Pose(*pose.place_of(forward_m, left_m), pose.yaw_rad)

    def image(self, image: Float32[np.ndarray, "*channels h w"]) -> Float32[np.ndarray, "*channels h w"]:
        """Returns an image, or a stack of them, as of a level camera; 0 where the camera did not see."""
        if self._lean is None:
            return image
        height, width = image.shape[-2:]
        index, seen = self._nearest((height, width))
        flat = image.reshape(*image.shape[:-2], height * width)
        return np.ascontiguousarray(np.where(seen, flat[..., index], np.float32(0.0)))

    def _measured(self, observation: Observation) -> BodyPose | None:
        """Returns the lean by the accelerometer; None: it is too small to count, or there is no such sensor."""
        reading = observation.get(IMU)
        if reading is None:
            return None
        ahead, left, up = np.asarray(reading, np.float64)[:3].tolist()  # of the force that carries the robot
        self._readings.append((math.atan2(-ahead, math.hypot(left, up)), math.atan2(left, up)))
        pitch_rad, roll_rad = (np.array(self._readings[-1]) - np.median(self._readings, axis=0)).tolist()
        if math.hypot(pitch_rad, roll_rad) < self._config.from_rad:
            return None
        return BodyPose(0.0, 0.0, 0.0, pitch_rad=pitch_rad, roll_rad=roll_rad)

    def _source(
        self, shape: tuple[int, ...]
    ) -> tuple[Float32[np.ndarray, "h w"], Float32[np.ndarray, "h w"], Float32[np.ndarray, "h w"]]:
        """Returns row and column of each pixel of the level image in the original one, and the ratio of the depths."""
        height, width = shape
        assert self._lean is not None
        axes = self._lean.axes.astype(np.float32)
        focal_px = np.float32(self._camera.focal_px * width / self._camera.width_px)
        left = ((0.5 * width - 0.5 - np.arange(width)) / focal_px).astype(np.float32)
        up = ((0.5 * height - 0.5 - np.arange(height)) / focal_px).astype(np.float32)[:, None]
        ahead, sideways, upwards = (axis[0] + axis[1] * left + axis[2] * up for axis in axes)
        scale = focal_px / np.where(ahead > 0.0, ahead, np.float32(np.inf))
        row, col = 0.5 * height - 0.5 - upwards * scale, 0.5 * width - 0.5 - sideways * scale
        return row.astype(np.float32), col.astype(np.float32), ahead

    def _nearest(self, shape: tuple[int, int]) -> tuple[Int[np.ndarray, "h w"], Bool[np.ndarray, "h w"]]:
        """Returns the row-major index of the nearest pixel of the original image, and True where there is one."""
        row, col, ahead = self._source(shape)
        rows, cols = np.rint(row).astype(np.intp), np.rint(col).astype(np.intp)
        seen = (ahead > 0.0) & (rows >= 0) & (rows < shape[0]) & (cols >= 0) & (cols < shape[1])
        return np.where(seen, rows * shape[1] + cols, 0), seen


class LevelledSegmenter:
    """A segmenter that sees the images as they were read; its results are levelled."""

    def __init__(self, segmenter: Segmenter, levelling: Levelling) -> None:
        self._segmenter, self._levelling = segmenter, levelling

    @property
    def spec(self) -> SegmenterSpec:
        """See `sim.core.interface.Segmenter`."""
        return self._segmenter.spec

    def scores(self, observation: Observation, goal: str) -> Scores:
        """Returns the scores of the frame that was levelled last."""
        del observation
        scores = self._segmenter.scores(self._levelling.raw, goal)
        return Scores(*map(self._levelling.image, scores))

    def posteriors(self, observation: Observation) -> Float[np.ndarray, "classes h w"]:
        """Returns the probabilities of the frame that was levelled last."""
        del observation
        return self._levelling.image(self._segmenter.posteriors(self._levelling.raw))
