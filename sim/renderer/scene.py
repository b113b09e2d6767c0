"""Fills a scene of MuJoCo with chosen geoms, seen from a chosen position, and renders ids and depth."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sim.core.errors import RenderError
from sim.gl import mujoco
from sim.houses.labels import RENDERED_GROUPS
from sim.renderer.opengl import Z_FAR_M, Z_NEAR_M

_HIDDEN_GROUP = 5


class GeomScene:
    """The scene of one model, filled again for each image.

    Args:
        model: compiled world.
        unhidden: ids of geoms that may be shown although their group is not rendered, such as those of the robot.
    """

    def __init__(self, model: mujoco.MjModel, unhidden: Sequence[int] = ()) -> None:
        self._model = model
        self._groups = model.geom_group.copy()
        self._shown_groups = self._groups.copy()
        self._shown_groups[list(unhidden)] = 0
        self._option = _scene_options()
        self._view = mujoco.MjvCamera()
        self.scene = mujoco.MjvScene(model, maxgeom=model.ngeom + 32)

    def fill(
        self,
        data: mujoco.MjData,
        geoms: NDArray[np.intp],
        eye_m: NDArray,
        axes: NDArray,
        slopes: tuple[float, float],
        near_m: float = Z_NEAR_M,
    ) -> None:
        """Fills the scene with these geoms and the active lights, seen from the eye; the headlight is at the eye.

        Args:
            data: state of the model; kinematics must be computed.
            geoms: ids in ascending order.
            eye_m: (3,) optical centre in the world.
            axes: (3, 3) the camera's forward, left and up as rows.
            slopes: tangents of half the horizontal and half the vertical field of view.
            near_m: near plane; nothing nearer to the eye is rendered.

        Raises:
            RenderError: MuJoCo left a geom out.
        """
        group = np.full_like(self._groups, _HIDDEN_GROUP)
        group[geoms] = self._shown_groups[geoms]
        self._model.geom_group[:] = group
        _stand_at(self._view, eye_m, axes[0])
        mujoco.mjv_updateScene(
            self._model, data, self._option, None, self._view, mujoco.mjtCatBit.mjCAT_ALL.value, self.scene
        )
        self._model.geom_group[:] = self._groups
        if self.scene.ngeom != len(geoms):
            raise RenderError(f"The scene holds {self.scene.ngeom} geoms, but {len(geoms)} were expected.")
        _aim(self.scene, eye_m, axes, slopes, near_m)

    def render_ids(self, rect: mujoco.MjrRect, context: mujoco.MjrContext) -> None:
        """Renders each geom of the scene in a colour that encodes its index, without light."""
        flags = self.scene.flags
        flags[:] = 0
        flags[mujoco.mjtRndFlag.mjRND_SEGMENT] = 1
        flags[mujoco.mjtRndFlag.mjRND_IDCOLOR] = 1
        flags[mujoco.mjtRndFlag.mjRND_CULL_FACE] = 1
        mujoco.mjr_restoreBuffer(context)  # the last pass has bound its own frame buffer
        mujoco.mjr_render(rect, self.scene, context)


def _scene_options() -> mujoco.MjvOption:
    """Returns options that show the visual geom groups and no sites."""
    option = mujoco.MjvOption()
    option.geomgroup[:] = 0
    option.geomgroup[:RENDERED_GROUPS] = 1
    option.sitegroup[:] = 0
    return option


def _stand_at(view: mujoco.MjvCamera, eye_m: NDArray, forward: NDArray) -> None:
    """Moves a free camera so that its eye, and with it the headlight, is at a position and looks forward."""
    view.type = mujoco.mjtCamera.mjCAMERA_FREE.value
    view.distance = 1.0
    view.lookat[:] = eye_m + forward
    view.azimuth = math.degrees(math.atan2(forward[1], forward[0]))
    view.elevation = math.degrees(math.asin(max(-1.0, min(1.0, float(forward[2])))))


def _aim(scene: mujoco.MjvScene, eye_m: NDArray, axes: NDArray, slopes: tuple[float, float], near_m: float) -> None:
    """Sets the position, the axes and the frustum of the scene's cameras."""
    top = near_m * slopes[1]
    for gl_camera in scene.camera:  # left and right eye; without stereo MuJoCo renders their average
        gl_camera.pos[:] = eye_m
        gl_camera.forward[:] = axes[0]
        gl_camera.up[:] = axes[2]
        gl_camera.orthographic = 0
        gl_camera.frustum_near, gl_camera.frustum_far = near_m, Z_FAR_M
        gl_camera.frustum_top, gl_camera.frustum_bottom = top, -top
        gl_camera.frustum_center = 0.0
        gl_camera.frustum_width = near_m * slopes[0]
