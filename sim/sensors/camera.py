"""The robot's RGB-D camera with ground-truth segmentation, rendered offscreen in at most two passes.

One pass gives colour. The other draws every geom in the colour of its number; a single read of that frame buffer
gives numbers and depth, so the edges of `depth` and `semantic` agree to the pixel. Only what is asked for is drawn,
and geoms that cannot be seen (`sim.sensors.occlusion`) are left out of the scene, which changes no pixel. Where lamps
throw shadows, what may throw one into the picture is drawn too; what their light reaches goes by the middle of things,
so a long one out of sight may lose its shadow (`sim.sensors.lamps`).
"""

from __future__ import annotations

import math
import weakref
from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.errors import RenderError
from sim.geometry.pose import Pose
from sim.gl import INSTALL_HINT, begin_drawing, mujoco
from sim.houses.labels import RENDERED_GROUPS, Labels, rendered_geoms
from sim.interface import SENSORS, CameraModel, ConfigError
from sim.sensors.lamps import Lamps
from sim.sensors.occlusion import Visibility
from sim.sensors.profiles import RenderProfile, get_profile

Z_NEAR_M = 0.05
"""Near plane: its farthest corner is 0.07 m away, well inside the robot's radius of 0.18 m."""
Z_FAR_M = 80.0
"""Far plane: beyond the diagonal of the largest house."""
_LEFT_OUT_GROUP = 5
_BLOCK_ROWS = 32
"""Rows of a depth image that are converted together: they stay in the processor's cache."""


class Camera:
    """Renders what a level camera sees from a pose of the robot in one compiled model.

    The model's visual settings (clipping planes, quality, buffer size) are set here; its own do not count.

    Args:
        model: compiled world.
        labels: category and instance of each geom of `model`.
        camera: intrinsics, mount height and depth range.
        profile: name of a rendering profile.
        cull: leave out what cannot be seen; off only to show what it changes.

    Raises:
        RenderError: no OpenGL context, or an image larger than the frame buffer can be.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        labels: Labels,
        *,
        camera: CameraModel | None = None,
        profile: str = "fast",
        cull: bool = True,
    ) -> None:
        self.camera = camera or CameraModel()
        self.profile: RenderProfile = get_profile(profile)
        self.cull = cull
        self._model = model
        self._groups = model.geom_group.copy()
        drawable = rendered_geoms(model)
        self._drawable = np.flatnonzero(drawable)
        self._geom_category = labels.geom_category
        self._rect = mujoco.MjrRect(0, 0, self.camera.width_px, self.camera.height_px)
        shape = (self.camera.height_px, self.camera.width_px)
        self._color_buffer = np.zeros((*shape, 3), np.uint8)
        self._depth_buffer = np.zeros(shape, np.float32)
        self._option = mujoco.MjvOption()
        self._option.geomgroup[:] = 0
        self._option.geomgroup[:RENDERED_GROUPS] = 1
        self._option.sitegroup[:] = 0
        self._gl = _make_gl_context(self.camera)
        self._gl.make_current()
        # Numbers must not be blended at edges and need no vertices inside a flat face, so they have their own buffer.
        number_profile = replace(self.profile, samples=0, quads=1, shadows=False)
        self._number_context = _make_context(model, self.camera, number_profile)
        self._color_context: mujoco.MjrContext | None = None  # made when colour is first asked for: 10 to 30 MB
        self._contexts = {self._number_context}
        self._finalizer = weakref.finalize(self, _free, self._gl, self._contexts)
        self._finalizer.atexit = False  # at the end of the process OpenGL may be gone already
        self._reflects = self.profile.reflections and bool((model.mat_reflectance > 0.0).any())
        self._scene = mujoco.MjvScene(model, maxgeom=model.ngeom + 32)
        self._view = mujoco.MjvCamera()
        self._visibility = Visibility(model, drawable, self.camera, Z_NEAR_M)
        self._lamps = Lamps(model, self._visibility, self._drawable)

    def render(self, data: mujoco.MjData, pose: Pose, sensors: Sequence[str]) -> dict[str, NDArray]:
        """Images of the sensors asked for, each in memory of its own; see `sim.interface.Observation`.

        Args:
            data: state of the model; kinematics must be up to date.
            pose: where the robot stands; the camera looks along its heading, level.
            sensors: names out of `SENSORS`, plus `geom`: int32 (h, w), geom id or -1.

        Raises:
            ConfigError: an unknown sensor.
        """
        unknown = [name for name in sensors if name not in (*SENSORS, "geom")]
        if unknown:
            raise ConfigError(f"Unknown sensor '{unknown[0]}'. There is: {', '.join(SENSORS)}, geom.")
        images: dict[str, NDArray] = {}
        if not sensors:
            return images
        self._gl.make_current()
        eye_m, axes = _camera_frame(pose, self.camera)
        seen = self._visibility.visible(data, eye_m, pose.yaw_rad) if self.cull else self._drawable
        self._fill_scene(data, seen, eye_m, axes)
        if {"depth", "semantic", "geom"} & set(sensors):
            images |= self._numbers_and_depth(seen, sensors)
        if "rgb" in sensors:
            self._light_scene(data, seen, eye_m, axes)
            images["rgb"] = self._color()
        return images

    def close(self) -> None:
        """Free the renderer; safe to call twice, and called for you when the camera is dropped."""
        self._finalizer()

    def _fill_scene(self, data: mujoco.MjData, geoms: NDArray[np.intp], eye_m: NDArray, axes: NDArray) -> None:
        """Put these geoms, given in ascending order, and the lights that shine before the eye."""
        group = np.full_like(self._groups, _LEFT_OUT_GROUP)
        group[geoms] = self._groups[geoms]
        self._model.geom_group[:] = group
        mujoco.mjv_updateScene(
            self._model, data, self._option, None, self._view, mujoco.mjtCatBit.mjCAT_ALL.value, self._scene
        )
        self._model.geom_group[:] = self._groups
        if self._scene.ngeom != len(geoms):
            raise RenderError(f"The scene holds {self._scene.ngeom} geoms where {len(geoms)} were expected.")
        _aim(self._scene, eye_m, axes, self.camera)

    def _light_scene(self, data: mujoco.MjData, seen: NDArray[np.intp], eye_m: NDArray, axes: NDArray) -> None:
        """The scene again, with its lamps, and with what is not seen but throws a shadow or is reflected."""
        lamps = self._lamps.choose(data, eye_m, axes[0])
        geoms = seen
        if self._reflects:
            geoms = self._drawable
        elif self.profile.shadows and lamps and self.cull:
            geoms = np.union1d(seen, self._lamps.casters(data, lamps[0], eye_m, axes))
        self._lamps.light(lamps)
        self._fill_scene(data, geoms, eye_m, axes)
        self._lamps.restore()

    def _numbers_and_depth(self, drawn_ids: NDArray[np.intp], sensors: Sequence[str]) -> dict[str, NDArray]:
        flags = self._scene.flags
        flags[:] = 0
        flags[mujoco.mjtRndFlag.mjRND_SEGMENT] = 1
        flags[mujoco.mjtRndFlag.mjRND_IDCOLOR] = 1
        mujoco.mjr_restoreBuffer(self._number_context)  # the bound frame buffer belongs to the last pass
        mujoco.mjr_render(self._rect, self._scene, self._number_context)
        depth = self._depth_buffer if "depth" in sensors else None
        mujoco.mjr_readPixels(self._color_buffer, depth, self._rect, self._number_context)
        images: dict[str, NDArray] = {}
        if "semantic" in sensors:
            images["semantic"] = _look_up(self._color_buffer, np.append(np.uint8(0), self._geom_category[drawn_ids]))
        if "geom" in sensors:
            images["geom"] = _look_up(self._color_buffer, np.append(np.int32(-1), drawn_ids.astype(np.int32)))
        if "depth" in sensors:
            images["depth"] = _metric_depth(self._depth_buffer, self.camera)
        return images

    def _color(self) -> NDArray[np.uint8]:
        flags = self._scene.flags
        flags[:] = 0
        flags[mujoco.mjtRndFlag.mjRND_SHADOW] = self.profile.shadows
        flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = self.profile.reflections
        flags[mujoco.mjtRndFlag.mjRND_SKYBOX] = self.profile.skybox
        flags[mujoco.mjtRndFlag.mjRND_CULL_FACE] = 1
        context = self._color_context
        if context is None:
            context = self._color_context = _make_context(self._model, self.camera, self.profile)
            self._contexts.add(context)
        mujoco.mjr_restoreBuffer(context)
        mujoco.mjr_render(self._rect, self._scene, context)
        mujoco.mjr_readPixels(self._color_buffer, None, self._rect, context)
        return self._color_buffer[::-1].copy()


def describe_gl() -> str:
    """What draws: `llvmpipe (LLVM 15.0.6, 256 bits)` on a CPU, the card's name on a GPU.

    Raises:
        RenderError: OpenGL does not start.
    """
    context = _make_gl_context(CameraModel())
    context.make_current()
    from OpenGL import GL  # needs PYOPENGL_PLATFORM, which `sim.gl` has set

    name = GL.glGetString(GL.GL_RENDERER)
    context.free()
    return name.decode() if isinstance(name, bytes) else str(name)


def _make_context(model: mujoco.MjModel, camera: CameraModel, profile: RenderProfile) -> mujoco.MjrContext:
    """An offscreen frame buffer of the camera's size with the model's meshes and textures."""
    model.stat.extent = 1.0  # clipping planes are given in units of it
    model.vis.map.znear = Z_NEAR_M
    model.vis.map.zfar = Z_FAR_M
    model.vis.global_.offwidth = camera.width_px
    model.vis.global_.offheight = camera.height_px
    model.vis.quality.offsamples = profile.samples
    model.vis.quality.numquads = profile.quads
    model.vis.quality.numslices = profile.slices
    model.vis.quality.numstacks = profile.stacks
    model.vis.quality.shadowsize = profile.shadow_size_px if profile.shadows else 0  # 2048: 18 MB, drawn or not
    context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
    mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, context)
    context.readDepthMap = mujoco.mjtDepthMap.mjDEPTH_ZEROFAR.value
    if context.offWidth < camera.width_px or context.offHeight < camera.height_px:
        raise RenderError(
            f"The frame buffer holds {context.offWidth} x {context.offHeight} pixels, "
            f"the camera asks for {camera.width_px} x {camera.height_px}."
        )
    return context


def _free(gl: mujoco.GLContext, contexts: set[mujoco.MjrContext]) -> None:
    gl.make_current()  # freeing deletes names in whatever context is current
    for context in contexts:
        context.free()
    gl.free()


def _make_gl_context(camera: CameraModel) -> mujoco.GLContext:
    begin_drawing()
    try:
        return mujoco.GLContext(camera.width_px, camera.height_px)
    except Exception as error:  # EGL, OSMesa and GLFW each raise their own
        raise RenderError(f"OpenGL did not start ({error}). Try: {INSTALL_HINT}") from error


def _camera_frame(pose: Pose, camera: CameraModel) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Optical centre in the world, and the axes (forward, left, up) as rows."""
    c, s = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
    axes = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    return np.array([pose.x_m, pose.y_m, pose.floor_z_m + camera.height_m]), axes


def _aim(scene: mujoco.MjvScene, eye_m: NDArray, axes: NDArray, camera: CameraModel) -> None:
    top = Z_NEAR_M * math.tan(0.5 * camera.vfov_rad)
    for gl_camera in scene.camera:  # left and right eye; without stereo MuJoCo draws their average
        gl_camera.pos[:] = eye_m
        gl_camera.forward[:] = axes[0]
        gl_camera.up[:] = axes[2]
        gl_camera.orthographic = 0
        gl_camera.frustum_near, gl_camera.frustum_far = Z_NEAR_M, Z_FAR_M
        gl_camera.frustum_top, gl_camera.frustum_bottom = top, -top
        gl_camera.frustum_center = 0.0
        gl_camera.frustum_width = top * camera.width_px / camera.height_px


def _look_up(color_buffer: NDArray[np.uint8], table: NDArray) -> NDArray:
    """What a table says for the number that each pixel's red (and green) holds; the uppermost row first.

    Args:
        color_buffer: (h, w, 3) the lowest row first, as OpenGL has it.
        table: by number.
    """
    if len(table) <= 256 and table.dtype == np.uint8:
        red = cv2.flip(cv2.extractChannel(color_buffer, 0), 0)
        return np.asarray(cv2.LUT(red, np.pad(table, (0, 256 - len(table)))), np.uint8)
    numbers = color_buffer[::-1, :, 0].astype(np.uint16)
    if len(table) > 256:
        numbers |= color_buffer[::-1, :, 1].astype(np.uint16) << 8
    return table[numbers]


def _metric_depth(buffer: NDArray[np.float32], camera: CameraModel) -> NDArray[np.float32]:
    """Metres along the optical axis, the uppermost row first, in the sensor's conventions.

    Args:
        buffer: (h, w) reversed depth buffer (1 near, 0 far), the lowest row first.
        camera: for its depth range.
    """
    depth_m = np.empty_like(buffer)
    for row in range(0, len(buffer), _BLOCK_ROWS):
        block, raw = depth_m[row : row + _BLOCK_ROWS], buffer[::-1][row : row + _BLOCK_ROWS]
        np.multiply(raw, np.float32((Z_FAR_M - Z_NEAR_M) / (Z_FAR_M * Z_NEAR_M)), out=block)
        block += np.float32(1.0 / Z_FAR_M)
        np.reciprocal(block, out=block)
        np.minimum(block, np.float32(camera.max_depth_m), out=block)
        block *= block >= camera.min_depth_m
        block *= raw > 0.0  # nothing was drawn there: no return
    return depth_m
