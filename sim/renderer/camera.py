"""The robot's RGB-D camera with ground-truth segmentation, rendered offscreen in at most two passes.

One pass renders colour. The other renders each geom in a colour that encodes its index; a single read of that frame
buffer gives indices and depth, so that the edges of `depth` and `semantic` agree to the pixel. Only requested images
are rendered. Geoms that cannot be visible (`sim.renderer.occlusion`) are left out of the scene, which changes no pixel.
Depth is that of the surface behind a pane of glass, except for the share of the pixels that the pane returns.
Colours are darkened in corners and in the shadow of the nearest lamp (`sim.renderer.shading`).
"""

from __future__ import annotations

import math
import weakref
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.pose import Pose, as_body_pose
from sim.core.interface import SENSORS, CameraModel, ConfigError
from sim.gl import begin_rendering, mujoco
from sim.houses.glass import clear_panes, picture_panes, returning
from sim.houses.labels import Labels, rendered_geoms
from sim.renderer.lamp_maps import MAP_PX, LampMaps
from sim.renderer.lamps import Lamps
from sim.renderer.occlusion import Visibility
from sim.renderer.opengl import (
    Z_NEAR_M,
    SharedContext,
    free_frame_buffers,
    look_up,
    make_frame_buffer,
    metric_depth,
)
from sim.renderer.profiles import RenderProfile, get_profile
from sim.renderer.scene import GeomScene
from sim.renderer.shading import make_shading


class Camera:
    """Renders the view of a camera that is fixed to the robot's body, in one compiled model.

    It replaces the model's visual settings (clipping planes, quality, buffer size).

    Args:
        model: compiled world.
        labels: category and instance of each geom of `model`.
        camera: intrinsics, mount height and depth range.
        profile: a rendering profile, or the name of one.
        cull: leave out geoms that cannot be visible; False is for tests that compare the two.
        shared: an OpenGL context that other cameras use, too; the caller closes it. None: one of its own.

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
        shared: SharedContext | None = None,
    ) -> None:
        self.camera = camera or CameraModel()
        self.profile = profile if isinstance(profile, RenderProfile) else get_profile(profile)
        self.cull = cull
        self._model = model
        visual = rendered_geoms(model)
        self._visual_ids = np.flatnonzero(visual)
        self._geom_category = labels.geom_category
        self._pictures, self._clear = picture_panes(model, labels), clear_panes(model, labels)
        self._rect = mujoco.MjrRect(0, 0, self.camera.width_px, self.camera.height_px)
        shape = (self.camera.height_px, self.camera.width_px)
        self._color_buffer = np.zeros((*shape, 3), np.uint8)
        self._depth_buffer = np.zeros(shape, np.float32)
        self._returned: NDArray[np.bool_] | None = None  # (h, w) pixels that panes return; made when one is visible
        self._through_clear = np.zeros(shape, np.bool_)
        context = shared or SharedContext(self.camera)
        self._gl = context.gl
        # Id colours must not be blended at edges and need no vertices inside a flat face: they get their own buffer.
        id_profile = replace(self.profile, samples=0, quads=1)
        with self._gl.as_current():  # it is released after each use, so that any thread can render next
            self._id_context = make_frame_buffer(model, self.camera, id_profile)
        self._color_context: mujoco.MjrContext | None = None  # made with the first colour image: it takes 10 to 30 MB
        self._contexts = {self._id_context}
        self._finalizer = weakref.finalize(self, free_frame_buffers, context, self._contexts, is_own=shared is None)
        self._finalizer.atexit = False  # OpenGL may be unloaded before the process ends
        self._reflects = self.profile.reflections and bool((model.mat_reflectance > 0.0).any())
        self._scene = GeomScene(model)
        up = math.tan(0.5 * self.camera.vfov_rad)
        self._slopes = (up * self.camera.width_px / self.camera.height_px, up)
        self._visibility = Visibility(model, visual, self.camera, Z_NEAR_M)
        self._lamps = Lamps(model, self._visibility, self._visual_ids)
        map_px = min(MAP_PX, *shape)
        self._maps = LampMaps(model, labels, self._lamps, self._visual_ids, map_px)
        self._shading = make_shading(model, self.camera, self.profile)

    def render(self, data: mujoco.MjData, pose: Pose, sensors: Sequence[str]) -> dict[str, NDArray]:
        """Returns the images of some sensors as new arrays; see `sim.core.interface.Observation`.

        Args:
            data: state of the model; kinematics must be computed.
            pose: the robot's pose. A `BodyPose` leans, and the camera with it; at any other pose the camera is level.
            sensors: names from `SENSORS`, and `geom`: int32 (h, w), geom id or -1.

        Raises:
            ConfigError: an unknown sensor.
            RenderError: this process was forked from the one that made this camera.
        """
        body = as_body_pose(pose)
        return self.render_from(data, body.point(0.0, 0.0, self.camera.height_m), body.axes, sensors)

    def render_from(
        self, data: mujoco.MjData, eye_m: NDArray, axes: NDArray, sensors: Sequence[str]
    ) -> dict[str, NDArray]:
        """Returns the same, seen from any place in any direction.

        Args:
            data: state of the model; kinematics must be computed.
            eye_m: (3,) optical centre in the world.
            axes: (3, 3) the camera's forward, left and up as rows.
            sensors: as of `render`.
        """
        unknown = [name for name in sensors if name not in (*SENSORS, "geom")]
        if unknown:
            raise ConfigError(f"Unknown sensor '{unknown[0]}'. The sensors are: {', '.join(SENSORS)}, geom.")
        if not sensors:
            return {}
        begin_rendering()
        with self._gl.as_current():
            return self._render(data, eye_m, axes, sensors)

    def _render(self, data: mujoco.MjData, eye_m: NDArray, axes: NDArray, sensors: Sequence[str]) -> dict[str, NDArray]:
        """Returns the images of some sensors; the OpenGL context is current."""
        images: dict[str, NDArray] = {}
        visible = self._visibility.visible(data, eye_m, axes) if self.cull else self._visual_ids
        lamps = self._lamps.choose(data, eye_m, axes[0]) if "rgb" in sensors else []
        first = lamps[0] if lamps and self.profile.shadows > 0.0 and self._lamps.casts_shadows(lamps[0]) else None
        lamp_map = None if first is None else self._maps.of(data, first, self._scene, self._id_context)
        self._fill(data, visible, eye_m, axes, lamps)
        if {"depth", "semantic", "geom"} & set(sensors):
            images |= self._render_ids_and_depth(visible, sensors)
        if "depth" in sensors and self._clear[visible].any():
            self._fill(data, visible[~self._clear[visible]], eye_m, axes, lamps)
            self._see_through_clear_panes(images["depth"])
            if "rgb" in sensors and not self._reflects:
                self._fill(data, visible, eye_m, axes, lamps)
        if "rgb" in sensors:
            if self._reflects:
                self._fill(data, self._visual_ids, eye_m, axes, lamps)
            self._render_color()
            if self._shading is None:
                images["rgb"] = self._color_buffer[::-1].copy()
            else:
                buffers = self._color_buffer, self._depth_buffer
                images["rgb"] = self._shading.apply(*buffers, data, first, eye_m, axes, lamp_map)
        return images

    def close(self) -> None:
        """Frees the renderer. It is safe to call twice, and happens automatically when the camera is deleted."""
        self._finalizer()

    def _fill(
        self, data: mujoco.MjData, geoms: NDArray[np.intp], eye_m: NDArray, axes: NDArray, lamps: list[int]
    ) -> None:
        """Fills the scene with these geoms, given in ascending order, and with the lights, seen from the eye."""
        self._lamps.switch_on(lamps)
        self._scene.fill(data, geoms, eye_m, axes, self._slopes)
        self._lamps.restore()

    def _render_ids_and_depth(self, geoms: NDArray[np.intp], sensors: Sequence[str]) -> dict[str, NDArray]:
        """Returns the requested images of `depth`, `semantic` and `geom` for the geoms of the scene."""
        self._scene.render_ids(self._rect, self._id_context)
        depth = self._depth_buffer if "depth" in sensors else None
        mujoco.mjr_readPixels(self._color_buffer, depth, self._rect, self._id_context)
        images: dict[str, NDArray] = {}
        if "semantic" in sensors:
            images["semantic"] = look_up(self._color_buffer, np.append(np.uint8(0), self._geom_category[geoms]))
        if "geom" in sensors:
            images["geom"] = look_up(self._color_buffer, np.append(np.int32(-1), geoms.astype(np.int32)))
        if "depth" in sensors:
            images["depth"] = metric_depth(self._depth_buffer, self.camera)
            if self._pictures[geoms].any():
                images["depth"][self._passes(self._pictures[geoms])] = self.camera.max_depth_m
            if self._clear[geoms].any():
                self._through_clear = self._passes(self._clear[geoms])
        return images

    def _passes(self, panes: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Returns (h, w) True where the rendered ids show one of these panes of the scene and light passes it."""
        if self._returned is None:
            self._returned = returning(self._depth_buffer.shape)
        return look_up(self._color_buffer, np.append(False, panes)) & ~self._returned

    def _see_through_clear_panes(self, depth_m: NDArray[np.float32]) -> None:
        """Writes the depth of the scene, which must hold no such pane now, where light passes one."""
        self._scene.render_ids(self._rect, self._id_context)
        mujoco.mjr_readPixels(self._color_buffer, self._depth_buffer, self._rect, self._id_context)
        through = self._through_clear
        depth_m[through] = metric_depth(self._depth_buffer, self.camera)[through]

    def _render_color(self) -> None:
        """Renders the scene in colour into the buffers of colour and of depth, the bottom row first."""
        flags = self._scene.scene.flags
        flags[:] = 0
        flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = self.profile.reflections
        flags[mujoco.mjtRndFlag.mjRND_SKYBOX] = self.profile.skybox
        flags[mujoco.mjtRndFlag.mjRND_CULL_FACE] = 1
        context = self._color_context
        if context is None:
            context = self._color_context = make_frame_buffer(self._model, self.camera, self.profile)
            self._contexts.add(context)
        mujoco.mjr_restoreBuffer(context)
        mujoco.mjr_render(self._rect, self._scene.scene, context)
        depth = None if self._shading is None else self._depth_buffer
        mujoco.mjr_readPixels(self._color_buffer, depth, self._rect, context)
