"""Darkens colour images where little light arrives: ambient occlusion and soft shadows of the nearest lamp.

Both are computed from the depth of the image on a grid of every sixth pixel, and multiplied into its colours. It
works for every house and for moving objects, and takes 2 to 3 ms where the shadow maps of OpenGL take 50.

- Ambient occlusion counts how much of its surroundings a surface cannot see. Only surfaces within `RADIUS_M` count, so
  that a chair darkens the floor below it but not the wall behind it.
- A lamp's shadow is a share of the lamp's own light; ambient and other lights stay. The lamp is a disc, so that a
  shadow is sharp at the foot of a chair and blurred below its seat.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sim.core.interface import CameraModel
from sim.gl import mujoco
from sim.renderer.lamp_maps import MAP_SLOPE
from sim.renderer.opengl import DEPTH_OFFSET, DEPTH_SLOPE
from sim.renderer.profiles import RenderProfile
from sim.renderer.shading_kernels import STEP, apply_share, blur, grid_points, open_share, shade

RADIUS_M = 0.6
"""Surfaces farther apart do not occlude each other."""
LAMP_RADIUS_M = 0.16
"""Radius of the disc that a lamp is: it sets the width of penumbras."""
_OCCLUSION = 2.0
"""Share of the light that a completely covered point loses, at strength 1; corners are covered by half."""


class Shading:
    """The shading of the images of one camera.

    Args:
        model: compiled world; its headlight's ambient light counts.
        camera: intrinsics.
        profile: strengths and number of samples.
    """

    def __init__(self, model: mujoco.MjModel, camera: CameraModel, profile: RenderProfile) -> None:
        self._model = model
        self._focal_px = camera.focal_px
        self._taps = _sample_discs(profile.taps)
        self._occlusion, self._shadows = _OCCLUSION * profile.occlusion, profile.shadows
        self._lights = _other_lights(model)
        self._strengths: dict[int, tuple[float, ...]] = {}

    def apply(
        self,
        color: NDArray[np.uint8],
        raw: NDArray[np.float32],
        data: mujoco.MjData,
        lamp: int | None,
        eye_m: NDArray,
        axes: NDArray,
        lamp_map: NDArray[np.float32] | None,
    ) -> NDArray[np.uint8]:
        """Returns the shaded image (h, w, 3), the top row first.

        Args:
            color: (h, w, 3), the bottom row first.
            raw: (h, w) reversed depth buffer, the bottom row first.
            data: state of the model, with the positions of its lights.
            lamp: id of the lamp that casts shadows, or None.
            eye_m: (3,) optical centre in the world.
            axes: (3, 3) the camera's forward, left and up as rows.
            lamp_map: depth map of that lamp, or None without one.
        """
        points = grid_points(raw, DEPTH_SLOPE, DEPTH_OFFSET, self._focal_px)
        share = open_share(points, self._taps, self._focal_px, RADIUS_M, self._occlusion)
        if lamp is not None and lamp_map is not None:
            frame = np.stack([eye_m, -axes[1], axes[2], axes[0]])
            self._lights[1, :3] = axes[0]  # the headlight
            shade(share, points, self._taps, frame, self._lights, self._lamp(data, lamp), lamp_map, self._shadows)
        share = blur(blur(share, points[2]), points[2])
        return apply_share(color, raw, share)

    def _lamp(self, data: mujoco.MjData, lamp: int) -> NDArray[np.float64]:
        """Returns the lamp as `shade` expects it."""
        model = self._model
        if lamp not in self._strengths:
            spot = model.light_type[lamp] == mujoco.mjtLightType.mjLIGHT_SPOT.value
            exponent = model.light_exponent[lamp] if spot else 0.0
            self._strengths[lamp] = model.light_diffuse[lamp].mean(), *model.light_attenuation[lamp], exponent
        return np.array([*data.light_xpos[lamp], *self._strengths[lamp], LAMP_RADIUS_M, MAP_SLOPE])


def make_shading(model: mujoco.MjModel, camera: CameraModel, profile: RenderProfile) -> Shading | None:
    """Returns the shading of a profile; None for a profile without any, and for images smaller than two grid cells."""
    off = profile.occlusion <= 0.0 and profile.shadows <= 0.0
    small = min(camera.width_px, camera.height_px) < 2 * STEP
    return None if off or small else Shading(model, camera, profile)


def _other_lights(model: mujoco.MjModel) -> NDArray[np.float64]:
    """Returns (n, 4) the ambient light (0, 0, 0, strength), then directions and strengths of the headlight and of the
    directional lights. The direction of the headlight depends on the camera.
    """
    head, on = model.vis.headlight, model.light_active.astype(np.bool_)
    directional = on & (model.light_type == mujoco.mjtLightType.mjLIGHT_DIRECTIONAL.value)
    ambient = float(np.mean(head.ambient)) + float(model.light_ambient[on].mean(axis=1).sum())
    rows = [np.array([0.0, 0.0, 0.0, ambient]), np.array([0.0, 0.0, 0.0, float(np.mean(head.diffuse))])]
    for light in np.flatnonzero(directional):
        rows.append(np.append(model.light_dir[light], model.light_diffuse[light].mean()))
    return np.array(rows)


def _sample_discs(count: int) -> NDArray[np.float32]:
    """Returns (4, count, 2) points of the unit disc on spirals, dense at the centre and turned against each other."""
    k = np.arange(count) + 0.5
    golden = math.pi * (3.0 - math.sqrt(5.0))
    turns = np.array([0.0, 2.0, 3.0, 1.0])[:, None] * (0.5 * math.pi / 2.0)
    radius = ((k + np.array([-0.375, 0.125, 0.375, -0.125])[:, None]) / count) ** 0.8
    angles = golden * k + turns
    return np.stack([radius * np.cos(angles), radius * np.sin(angles)], axis=-1).astype(np.float32)
