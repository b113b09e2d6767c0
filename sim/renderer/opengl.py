"""Creates OpenGL contexts and offscreen frame buffers, and converts their content to images."""

from __future__ import annotations

import weakref

import numpy as np
from numpy.typing import NDArray

from sim.core.errors import RenderError
from sim.core.interface import CameraModel
from sim.gl import is_forked, make_context, mujoco
from sim.renderer.image_kernels import look_up_ids, to_metres
from sim.renderer.profiles import RenderProfile

Z_NEAR_M = 0.05
"""Near plane: its farthest corner is 0.07 m from the eye, well inside the robot's radius of 0.18 m."""
Z_FAR_M = 80.0
"""Far plane: beyond the diagonal of the largest house."""
DEPTH_SLOPE, DEPTH_OFFSET = (Z_FAR_M - Z_NEAR_M) / (Z_FAR_M * Z_NEAR_M), 1.0 / Z_FAR_M
"""The depth in metres of a reversed depth buffer is 1 / (DEPTH_SLOPE * value + DEPTH_OFFSET)."""


def make_gl_context(camera: CameraModel) -> mujoco.GLContext:
    """Returns a new OpenGL context.

    Raises:
        RenderError: OpenGL does not start.
    """
    return make_context(camera.width_px, camera.height_px)


def make_frame_buffer(model: mujoco.MjModel, camera: CameraModel, profile: RenderProfile) -> mujoco.MjrContext:
    """Returns an offscreen frame buffer of the camera's size, with the model's meshes and textures.

    It sets the visual settings of the model.

    Raises:
        RenderError: OpenGL does not support an image of this size.
    """
    model.stat.extent = 1.0  # the unit of the clipping planes
    model.vis.map.znear = Z_NEAR_M
    model.vis.map.zfar = Z_FAR_M
    model.vis.global_.offwidth = camera.width_px
    model.vis.global_.offheight = camera.height_px
    model.vis.quality.offsamples = profile.samples
    model.vis.quality.numquads = profile.quads
    model.vis.quality.numslices = profile.slices
    model.vis.quality.numstacks = profile.stacks
    model.vis.quality.shadowsize = 0  # `sim.renderer.shading` computes shadows; a map would take memory, used or not
    context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
    mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, context)
    context.readDepthMap = mujoco.mjtDepthMap.mjDEPTH_ZEROFAR.value
    if context.offWidth < camera.width_px or context.offHeight < camera.height_px:
        raise RenderError(
            f"The frame buffer holds {context.offWidth} x {context.offHeight} pixels, "
            f"the camera needs {camera.width_px} x {camera.height_px}."
        )
    return context


class SharedContext:
    """An OpenGL context for the cameras of one thread, one after the other: a new context takes 0.1 s at its first use.

    Args:
        camera: the size of its images counts.

    Raises:
        RenderError: OpenGL does not start.
    """

    def __init__(self, camera: CameraModel) -> None:
        self.gl = make_gl_context(camera)
        self._finalizer = weakref.finalize(self, _free, self.gl)
        self._finalizer.atexit = False  # OpenGL may be unloaded before the process ends

    def close(self) -> None:
        """Frees the context after all cameras that use it were closed."""
        self._finalizer()


def free_frame_buffers(shared: SharedContext, frame_buffers: set[mujoco.MjrContext], *, is_own: bool) -> None:
    """Frees frame buffers, and their OpenGL context if it is their own."""
    if is_forked():  # this process did not make them
        return
    with shared.gl.as_current():  # freeing deletes objects of the current context
        for frame_buffer in frame_buffers:
            frame_buffer.free()
    if is_own:
        shared.close()


def _free(gl: mujoco.GLContext) -> None:
    if not is_forked():
        gl.free()


def describe_gl() -> str:
    """Returns the name of the renderer: `llvmpipe (LLVM 15.0.6, 256 bits)` on a CPU, the card's name on a GPU.

    Raises:
        RenderError: OpenGL does not start.
    """
    context = make_gl_context(CameraModel())
    from OpenGL import GL  # needs PYOPENGL_PLATFORM, which `sim.gl` has set

    with context.as_current():
        name = GL.glGetString(GL.GL_RENDERER)
    context.free()
    return name.decode() if isinstance(name, bytes) else str(name)


def look_up(color_buffer: NDArray[np.uint8], table: NDArray) -> NDArray:
    """Returns an image (h, w) of the table's entries for the id colours of a frame buffer, the top row first.

    Args:
        color_buffer: (h, w, 3), the bottom row first; red is the low byte of the index, green the high byte.
        table: entry of each index.
    """
    image = np.empty(color_buffer.shape[:2], table.dtype)
    look_up_ids(color_buffer, table, image)
    return image


def metric_depth(buffer: NDArray[np.float32], camera: CameraModel) -> NDArray[np.float32]:
    """Returns the depth image (h, w) of a frame buffer as `sim.core.interface.Observation` defines it, the top row
    first.

    Args:
        buffer: (h, w) reversed depth buffer (1 near, 0 far), the bottom row first.
        camera: its depth range counts.
    """
    depth_m = np.empty_like(buffer)
    slope, offset = np.float32(DEPTH_SLOPE), np.float32(DEPTH_OFFSET)
    to_metres(buffer, slope, offset, np.float32(camera.min_depth_m), np.float32(camera.max_depth_m), depth_m)
    return depth_m
