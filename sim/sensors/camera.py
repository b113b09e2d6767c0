"""The robot's RGB-D camera with ground-truth segmentation, rendered offscreen in at most two passes.

One pass renders colour. The other renders each geom in a colour that encodes its index; a single read of that frame
buffer gives indices and depth, so that the edges of `depth` and `semantic` agree to the pixel. Only requested images
are rendered. Geoms that cannot be visible (`sim.sensors.occlusion`) are left out of the scene, which changes no pixel.
With shadows, geoms that may cast one into the image are added; whether a lamp lights a geom is decided at the geom's
centre, so a long geom outside the image may lose its shadow (`sim.sensors.lamps`).
"""

from __future__ import annotations

import math
import weakref
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sim.errors import RenderError
from sim.geometry.pose import Pose
from sim.gl import mujoco
from sim.houses.labels import RENDERED_GROUPS, Labels, rendered_geoms
from sim.interface import SENSORS, CameraModel, ConfigError
from sim.sensors.lamps import Lamps
from sim.sensors.occlusion import Visibility
from sim.sensors.opengl import (
    Z_FAR_M,
    Z_NEAR_M,
    free_contexts,
    look_up,
    make_frame_buffer,
    make_gl_context,
    metric_depth,
)
from sim.sensors.profiles import RenderProfile, get_profile

_HIDDEN_GROUP = 5


class Camera:
    """Renders the view of a level camera at a pose of the robot in one compiled model.

    It replaces the model's visual settings (clipping planes, quality, buffer size).

    Args:
        model: compiled world.
        labels: category and instance of each geom of `model`.
        camera: intrinsics, mount height and depth range.
        profile: a rendering profile, or the name of one.
        cull: leave out geoms that cannot be visible; False is for tests that compare the two.

    Raises:
        RenderError: there is no OpenGL context, or OpenGL does not support an image of this size.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        labels: Labels,
        *,
        camera: CameraModel | None = None,
        profile: str | RenderProfile = "fast",
        cull: bool = True,
    ) -> None:
        self.camera = camera or CameraModel()
        self.profile = profile if isinstance(profile, RenderProfile) else get_profile(profile)
        self.cull = cull
        self._model = model
        self._groups = model.geom_group.copy()
        visual = rendered_geoms(model)
        self._visual_ids = np.flatnonzero(visual)
        self._geom_category = labels.geom_category
        self._rect = mujoco.MjrRect(0, 0, self.camera.width_px, self.camera.height_px)
        shape = (self.camera.height_px, self.camera.width_px)
        self._color_buffer = np.zeros((*shape, 3), np.uint8)
        self._depth_buffer = np.zeros(shape, np.float32)
        self._option = _scene_options()
        self._gl = make_gl_context(self.camera)
        self._gl.make_current()
        # Id colours must not be blended at edges and need no vertices inside a flat face: they get their own buffer.
        id_profile = replace(self.profile, samples=0, quads=1, shadows=False)
        self._id_context = make_frame_buffer(model, self.camera, id_profile)
        self._color_context: mujoco.MjrContext | None = None  # made with the first colour image: it takes 10 to 30 MB
        self._contexts = {self._id_context}
        self._finalizer = weakref.finalize(self, free_contexts, self._gl, self._contexts)
        self._finalizer.atexit = False  # OpenGL may be unloaded before the process ends
        self._reflects = self.profile.reflections and bool((model.mat_reflectance > 0.0).any())
        self._scene = mujoco.MjvScene(model, maxgeom=model.ngeom + 32)
        self._view = mujoco.MjvCamera()
        self._visibility = Visibility(model, visual, self.camera, Z_NEAR_M)
        self._lamps = Lamps(model, self._visibility, self._visual_ids)

    def render(self, data: mujoco.MjData, pose: Pose, sensors: Sequence[str]) -> dict[str, NDArray]:
        """Returns the images of some sensors as new arrays; see `sim.interface.Observation`.

        Args:
            data: state of the model; kinematics must be computed.
            pose: the robot's pose; the camera looks along its heading, level.
            sensors: names from `SENSORS`, and `geom`: int32 (h, w), geom id or -1.

        Raises:
            ConfigError: an unknown sensor.
        """
        unknown = [name for name in sensors if name not in (*SENSORS, "geom")]
        if unknown:
            raise ConfigError(f"Unknown sensor '{unknown[0]}'. The sensors are: {', '.join(SENSORS)}, geom.")
        images: dict[str, NDArray] = {}
        if not sensors:
            return images
        self._gl.make_current()
        eye_m, axes = _camera_frame(pose, self.camera)
        visible = self._visibility.visible(data, eye_m, pose.yaw_rad) if self.cull else self._visual_ids
        self._fill_scene(data, visible, eye_m, axes)
        if {"depth", "semantic", "geom"} & set(sensors):
            images |= self._render_ids_and_depth(visible, sensors)
        if "rgb" in sensors:
            self._add_lamps(data, visible, eye_m, axes)
            images["rgb"] = self._render_color()
        return images

    def close(self) -> None:
        """Frees the renderer. It is safe to call twice, and happens automatically when the camera is deleted."""
        self._finalizer()

    def _fill_scene(self, data: mujoco.MjData, geoms: NDArray[np.intp], eye_m: NDArray, axes: NDArray) -> None:
        """Fills the scene with these geoms, given in ascending order, and the active lights, seen from the eye."""
        group = np.full_like(self._groups, _HIDDEN_GROUP)
        group[geoms] = self._groups[geoms]
        self._model.geom_group[:] = group
        mujoco.mjv_updateScene(
            self._model, data, self._option, None, self._view, mujoco.mjtCatBit.mjCAT_ALL.value, self._scene
        )
        self._model.geom_group[:] = self._groups
        if self._scene.ngeom != len(geoms):
            raise RenderError(f"The scene holds {self._scene.ngeom} geoms, but {len(geoms)} were expected.")
        _aim(self._scene, eye_m, axes, self.camera)

    def _add_lamps(self, data: mujoco.MjData, visible: NDArray[np.intp], eye_m: NDArray, axes: NDArray) -> None:
        """Fills the scene again with its lamps and with invisible geoms that cast shadows or are reflected."""
        lamps = self._lamps.choose(data, eye_m, axes[0])
        geoms = visible
        if self._reflects:
            geoms = self._visual_ids
        elif self.profile.shadows and lamps and self.cull:
            geoms = np.union1d(visible, self._lamps.shadow_casters(data, lamps[0], eye_m, axes))
        self._lamps.switch_on(lamps)
        self._fill_scene(data, geoms, eye_m, axes)
        self._lamps.restore()

    def _render_ids_and_depth(self, geoms: NDArray[np.intp], sensors: Sequence[str]) -> dict[str, NDArray]:
        """Returns the requested images of `depth`, `semantic` and `geom` for the geoms of the scene."""
        flags = self._scene.flags
        flags[:] = 0
        flags[mujoco.mjtRndFlag.mjRND_SEGMENT] = 1
        flags[mujoco.mjtRndFlag.mjRND_IDCOLOR] = 1
        mujoco.mjr_restoreBuffer(self._id_context)  # the last pass has bound its own frame buffer
        mujoco.mjr_render(self._rect, self._scene, self._id_context)
        depth = self._depth_buffer if "depth" in sensors else None
        mujoco.mjr_readPixels(self._color_buffer, depth, self._rect, self._id_context)
        images: dict[str, NDArray] = {}
        if "semantic" in sensors:
            images["semantic"] = look_up(self._color_buffer, np.append(np.uint8(0), self._geom_category[geoms]))
        if "geom" in sensors:
            images["geom"] = look_up(self._color_buffer, np.append(np.int32(-1), geoms.astype(np.int32)))
        if "depth" in sensors:
            images["depth"] = metric_depth(self._depth_buffer, self.camera)
        return images

    def _render_color(self) -> NDArray[np.uint8]:
        """Returns the colour image (h, w, 3) of the scene."""
        flags = self._scene.flags
        flags[:] = 0
        flags[mujoco.mjtRndFlag.mjRND_SHADOW] = self.profile.shadows
        flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = self.profile.reflections
        flags[mujoco.mjtRndFlag.mjRND_SKYBOX] = self.profile.skybox
        flags[mujoco.mjtRndFlag.mjRND_CULL_FACE] = 1
        context = self._color_context
        if context is None:
            context = self._color_context = make_frame_buffer(self._model, self.camera, self.profile)
            self._contexts.add(context)
        mujoco.mjr_restoreBuffer(context)
        mujoco.mjr_render(self._rect, self._scene, context)
        mujoco.mjr_readPixels(self._color_buffer, None, self._rect, context)
        return self._color_buffer[::-1].copy()


def _scene_options() -> mujoco.MjvOption:
    """Returns options that show the visual geom groups and no sites."""
    option = mujoco.MjvOption()
    option.geomgroup[:] = 0
    option.geomgroup[:RENDERED_GROUPS] = 1
    option.sitegroup[:] = 0
    return option


def _camera_frame(pose: Pose, camera: CameraModel) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the optical centre in the world, and the axes (forward, left, up) as rows."""
    c, s = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
    axes = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    return np.array([pose.x_m, pose.y_m, pose.floor_z_m + camera.height_m]), axes


def _aim(scene: mujoco.MjvScene, eye_m: NDArray, axes: NDArray, camera: CameraModel) -> None:
    """Sets the position, the axes and the frustum of the scene's cameras."""
    top = Z_NEAR_M * math.tan(0.5 * camera.vfov_rad)
    for gl_camera in scene.camera:  # left and right eye; without stereo MuJoCo renders their average
        gl_camera.pos[:] = eye_m
        gl_camera.forward[:] = axes[0]
        gl_camera.up[:] = axes[2]
        gl_camera.orthographic = 0
        gl_camera.frustum_near, gl_camera.frustum_far = Z_NEAR_M, Z_FAR_M
        gl_camera.frustum_top, gl_camera.frustum_bottom = top, -top
        gl_camera.frustum_center = 0.0
        gl_camera.frustum_width = top * camera.width_px / camera.height_px
