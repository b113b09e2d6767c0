"""Further cameras of the robot: turned, tilted, several, and panoramas. Their images have no noise."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from sim.core.errors import ConfigError
from sim.core.geometry.numbers import require_numbers
from sim.core.geometry.pose import BodyPose
from sim.core.interface import SENSORS, CameraModel
from sim.gl import mujoco
from sim.houses.labels import Labels
from sim.renderer.camera import Camera
from sim.renderer.opengl import SharedContext
from sim.renderer.profiles import RenderProfile

Projection = Literal["pinhole", "equirectangular"]
MAX_VIEWS = 36
DEFAULT_HFOV_DEG = 79.0
_FACE_SCALE = 1.5
"""Pixels of a face of the cube in relation to those that it needs in the middle of a panorama."""
_FACES = ((0.0, 0.0), (90.0, 0.0), (180.0, 0.0), (-90.0, 0.0), (0.0, 90.0), (0.0, -90.0))
"""Yaw and pitch of the six faces of a cube around the eye, degrees."""


@dataclass(frozen=True, kw_only=True)
class CameraConfig:
    """A camera that is fixed to the robot's body, in addition to the first one."""

    forward_m: float = 0.0
    """Optical centre ahead of the robot's axis ..."""
    left_m: float = 0.0
    """... to its left ..."""
    height_m: float = 0.88
    """... and above the floor."""
    yaw_deg: float = 0.0
    """Direction, counter-clockwise from the heading."""
    pitch_deg: float = 0.0
    """Tilt; a positive one looks up."""
    width_px: int = 640
    height_px: int = 480
    hfov_deg: float | None = None
    """Horizontal field of view; None: 79 for one view, 360 / views for several."""
    min_depth_m: float = 0.5
    """Nearer surfaces read 0."""
    max_depth_m: float = 5.0
    """Farther surfaces read this value."""
    images: tuple[str, ...] = ("rgb", "depth")
    """Some of `rgb`, `depth` and `semantic`; the latter is ground truth."""
    views: int = 1
    """More than 1: a panorama of so many images, turned counter-clockwise, the first in the camera's direction. Images
    then have an axis of views in front."""
    projection: Projection = "pinhole"
    """`equirectangular`: one image of all directions. Its middle is the camera's direction, columns go clockwise and
    rows down; depth is then the distance from the eye."""

    def __post_init__(self) -> None:
        require_numbers(self)
        if self.projection not in get_args(Projection):
            raise ConfigError(f"CameraConfig.projection must be pinhole or equirectangular, got '{self.projection}'.")
        unknown = [image for image in self.images if image not in SENSORS]
        if unknown or not self.images or len(set(self.images)) < len(self.images):
            raise ConfigError(f"CameraConfig.images must be some of {', '.join(SENSORS)}, got {list(self.images)}.")
        if self.views != int(self.views) or not 1 <= self.views <= MAX_VIEWS:
            raise ConfigError(f"CameraConfig.views must be a whole number from 1 to {MAX_VIEWS}, got {self.views}.")
        if self.projection == "equirectangular" and (self.views > 1 or self.hfov_deg is not None):
            raise ConfigError("An equirectangular camera sees all directions: it takes neither views nor hfov_deg.")
        if not -90.0 <= self.pitch_deg <= 90.0:
            raise ConfigError(f"CameraConfig.pitch_deg must lie in [-90, 90], got {self.pitch_deg}.")
        _ = self.model

    @property
    def model(self) -> CameraModel:
        """The intrinsics of one view, or of a face of the cube of an equirectangular camera."""
        size, hfov_deg, min_depth_m = (self.width_px, self.height_px), self.hfov_deg, self.min_depth_m
        if self.projection == "equirectangular":
            size, hfov_deg = (math.ceil(_FACE_SCALE * max(self.width_px / 4.0, self.height_px / 2.0)),) * 2, 90.0
            min_depth_m /= math.sqrt(3.0)  # the depth of a corner of the cube at this distance
        elif hfov_deg is None:
            hfov_deg = DEFAULT_HFOV_DEG if self.views == 1 else 360.0 / self.views
        return CameraModel(
            width_px=size[0],
            height_px=size[1],
            hfov_rad=math.radians(hfov_deg),
            height_m=self.height_m,
            min_depth_m=min_depth_m,
            max_depth_m=self.max_depth_m,
        )

    def shape(self) -> tuple[int, ...]:
        """Returns the shape of a depth image."""
        return (self.height_px, self.width_px) if self.views == 1 else (self.views, self.height_px, self.width_px)


class MountedCameras:
    """Renders the images of mounted cameras in one compiled model; cameras with the same intrinsics share buffers.

    Args:
        model: compiled world.
        labels: category and instance of each geom of `model`.
        profile: rendering profile.
        shared: OpenGL context.
    """

    def __init__(
        self, model: mujoco.MjModel, labels: Labels, *, profile: str | RenderProfile, shared: SharedContext | None
    ) -> None:
        self._make = functools.partial(Camera, model, labels, profile=profile, shared=shared)
        self._cameras: dict[CameraModel, Camera] = {}

    def render(
        self, data: mujoco.MjData, body: BodyPose, config: CameraConfig, images: Sequence[str]
    ) -> dict[str, NDArray]:
        """Returns some images of a camera, new arrays.

        Args:
            data: state of the model; kinematics must be computed.
            body: pose of the robot's body.
            config: the camera.
            images: names from `SENSORS`.
        """
        model = config.model
        if model not in self._cameras:
            self._cameras[model] = self._make(camera=model)
        camera = self._cameras[model]
        eye_m = body.point(config.forward_m, config.left_m, config.height_m)
        if config.projection == "equirectangular":
            mount = _axes(config.yaw_deg, config.pitch_deg) @ body.axes
            faces = [camera.render_from(data, eye_m, _axes(*face) @ mount, images) for face in _FACES]
            table = _panorama((config.height_px, config.width_px), model.width_px)
            return {name: _unrolled(name, [face[name] for face in faces], table, config) for name in images}
        turns = [config.yaw_deg + 360.0 * view / config.views for view in range(config.views)]
        views = [camera.render_from(data, eye_m, _axes(yaw, config.pitch_deg) @ body.axes, images) for yaw in turns]
        return views[0] if config.views == 1 else {name: np.stack([view[name] for view in views]) for name in images}

    def close(self) -> None:
        """Frees the renderers."""
        for camera in self._cameras.values():
            camera.close()


def _axes(yaw_deg: float, pitch_deg: float) -> NDArray[np.float64]:
    """Returns (3, 3) the axes of a turned and tilted camera as rows ahead, left, up in the frame of its mount."""
    return BodyPose(0.0, 0.0, math.radians(yaw_deg), pitch_rad=-math.radians(pitch_deg)).axes


@functools.lru_cache(maxsize=8)
def _panorama(shape: tuple[int, int], face_px: int) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.float32]]:
    """Returns for each pixel of a panorama (h, w): face, index of its pixel, distance for a depth of 1 there."""
    height, width = shape
    yaw = math.pi - 2.0 * math.pi * (np.arange(width) + 0.5) / width
    pitch = 0.5 * math.pi - math.pi * (np.arange(height) + 0.5) / height
    ray = np.stack(
        np.broadcast_arrays(
            np.cos(pitch)[:, None] * np.cos(yaw), np.cos(pitch)[:, None] * np.sin(yaw), np.sin(pitch)[:, None]
        ),
        axis=-1,
    )  # (h, w, 3) ahead, left, up
    axes = np.array([_axes(*face) for face in _FACES])  # (6, 3, 3)
    along = np.einsum("hwk,fk->hwf", ray, axes[:, 0])
    face = along.argmax(axis=-1)
    ahead, left, up = np.einsum("hwk,hwjk->jhw", ray, axes[face])
    col = np.clip((0.5 - 0.5 * left / ahead) * face_px, 0, face_px - 1).astype(np.intp)
    row = np.clip((0.5 - 0.5 * up / ahead) * face_px, 0, face_px - 1).astype(np.intp)
    return face, row * face_px + col, (1.0 / ahead).astype(np.float32)


def _unrolled(
    name: str,
    faces: list[NDArray],
    table: tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.float32]],
    config: CameraConfig,
) -> NDArray:
    """Returns the panorama of an image of the six faces."""
    face, pixel, distance = table
    flat = np.stack([image.reshape(image.shape[0] * image.shape[1], *image.shape[2:]) for image in faces])
    image = flat[face, pixel]
    if name != "depth":
        return image
    depth = np.minimum(image * distance, np.float32(config.max_depth_m))
    depth[image >= config.max_depth_m] = config.max_depth_m
    depth[depth < config.min_depth_m] = 0.0
    return depth
