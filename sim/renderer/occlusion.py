"""Finds geoms that a camera cannot see: those outside its view, and those completely behind walls.

Bounds are those of a level camera. The view of one that leans lies within the wider view of a level one with the same
eye and heading.

The image is divided into strips of a few pixel columns. The *wall* of a strip is the nearest opaque upright box that
covers the whole strip and the height of the eye. A geom is hidden in a strip when it is farther than the front of the
wall and, seen from the eye, between the wall's lower and upper edge. A geom is hidden when it is hidden in every strip
that its bounding box reaches. All bounds are conservative: a geom that may be visible is never left out.

- Calculations use image coordinates, *slopes* per metre of depth to the right or left (`u`) and up (`v`). In them the
  extremes of a convex body are at its corners, so the eight corners of a box bound any geom.
- A box that both edge rays of a strip enter contains the segment between the two points of entry. The deeper point is
  therefore a depth at which the whole strip is blocked.
- When the eye is above a floor, or below a ceiling, that extends farther than the wall, nothing is visible below or
  above the wall either.

Only static opaque boxes with a vertical axis hide other geoms. The positions of movable geoms are updated in each call.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.core.interface import CameraModel
from sim.gl import mujoco
from sim.houses.geoms import data_at_rest
from sim.renderer.occlusion_kernels import hidden_by_strip, may_be_seen, nearest_walls, open_past_slabs
from sim.renderer.upright_boxes import UprightBoxes

STRIP_PX = 4
"""Width of a strip: a wall hides nothing in a strip that it does not cover from edge to edge."""
_SLACK_PX = 0.5
"""Geoms are grown by this much in the image, so that rounding in the rasteriser does not matter."""
_SLACK_M = 0.01
"""A hidden geom is farther than the wall by at least this: many times the resolution of the depth buffer."""
_SAME_EYE_M = 0.02
"""Eyes whose heights differ by less have the same walls, which extend 5 cm above and below the eye."""
_MIN_LEVEL = 0.3
"""A camera whose rays are not at least this far ahead of a level one's eye, per metre of depth, sees every geom."""
_SAME_STRIPS = 1e-6
_MIN_SLAB_M = 0.2
"""The near plane may cut floors and ceilings nearer to the eye than this."""
_BOX = int(mujoco.mjtGeom.mjGEOM_BOX)
_UNBOUNDED = (int(mujoco.mjtGeom.mjGEOM_PLANE), int(mujoco.mjtGeom.mjGEOM_HFIELD))  # never left out
_SIGNS = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])  # (8, 3)


class StripWalls(NamedTuple):
    """The wall of each strip; arrays (strips,)."""

    depth_m: NDArray[np.float64]
    """inf for a strip without a wall."""
    low: NDArray[np.float64]
    """Slope of the lower edge."""
    high: NDArray[np.float64]
    """Slope of the upper edge."""


class LevelView(NamedTuple):
    """The view of a level camera that contains the view of a camera that may lean."""

    right_max: float
    """Slope of the right edge."""
    up_max: float
    """Slope of the upper edge."""
    near_m: float
    """Nothing is visible nearer than this."""
    past_near_m: float
    """Everything farther than this is beyond the near plane."""
    edges: NDArray[np.float64]
    """(strips + 1,) slopes to the right of the edges of the strips, one strip width apart."""


class Visibility:
    """Finds the geoms of one model that may be visible; data of static geoms are computed once.

    Args:
        model: compiled world.
        visual: (ngeom,) True for visual geoms.
        camera: intrinsics.
        near_m: depth of the near plane.
    """

    def __init__(self, model: mujoco.MjModel, visual: NDArray[np.bool_], camera: CameraModel, near_m: float) -> None:
        self._model = model
        self._ids = np.flatnonzero(visual)
        self._near_m = near_m
        self._right_max = 0.5 * camera.width_px / camera.focal_px
        self._up_max = 0.5 * camera.height_px / camera.focal_px
        self._slack = _SLACK_PX / camera.focal_px
        self._strip = STRIP_PX / camera.focal_px
        data = data_at_rest(model)
        static = model.body_weldid[model.geom_bodyid] == 0
        self._movable = np.flatnonzero(~static[self._ids])  # indices into `_ids`
        self._bounded = ~np.isin(model.geom_type[self._ids], _UNBOUNDED)
        self._corners = _corners(model, data, self._ids)  # (n, 8, 3) world
        bounded = np.flatnonzero(self._bounded & static[self._ids])
        self._bounds, upright = UprightBoxes.around(model, data, self._ids[bounded])
        self._bound_of = np.full(len(self._ids), -1)  # index into `_bounds`, by index into `_ids`
        self._bound_of[bounded[upright]] = np.arange(len(self._bounds.top))
        solid = self._ids[bounded[upright]]
        self._boxes = self._bounds.take((model.geom_type[solid] == _BOX) & opaque_geoms(model)[solid])
        self._walls_at = (math.nan, self._boxes)  # height of the eye and its walls

    def visible(self, data: mujoco.MjData, eye_m: NDArray, axes: NDArray) -> NDArray[np.intp]:
        """Returns the ids, in ascending order, of the visual geoms that may be visible.

        Args:
            data: state of the model; kinematics must be computed.
            eye_m: (3,) optical centre in the world.
            axes: (3, 3) the camera's forward, left and up as rows.
        """
        if self._movable.size:
            self._corners[self._movable] = _corners(self._model, data, self._ids[self._movable])
        level = self._level_view(axes)
        if level is None:
            return self._ids
        length = math.hypot(axes[0, 0], axes[0, 1])
        yaw = float(axes[0, 0]) / length, float(axes[0, 1]) / length
        walls = self._strip_walls(eye_m, yaw, level)
        view = (level.right_max, level.up_max, self._strip, self._slack, _SLACK_M, *walls)
        seen = may_be_seen(self._corners, self._bounded, eye_m, yaw, level.near_m, *view)
        upright = np.flatnonzero(seen & (self._bound_of >= 0))
        hidden = hidden_by_strip(self._bound_of[upright], *_arrays(self._bounds), eye_m, yaw, level.edges, *view)
        seen[upright[hidden]] = False
        return self._ids[seen]

    def in_sight(self, eye_m: NDArray, positions_m: NDArray) -> NDArray[np.bool_]:
        """Returns (k,) True for positions (k, 3) without a wall in between in plan; a position on a wall is in sight.

        Only walls from floor to ceiling count, so that a position behind a door opening is in sight below the lintel.
        """
        walls = self._walls(float(eye_m[2]))
        entry, leave = walls.cross(eye_m, (positions_m[:, :2] - eye_m[:2]).T)  # (walls, k) shares of the distance
        with np.errstate(invalid="ignore"):
            between = (entry > 0.0) & (leave < 1.0)
        return ~np.asarray(between.any(axis=0), np.bool_)

    def _level_view(self, axes: NDArray) -> LevelView | None:
        """Returns the view of a level camera that contains that of this one; None if a level one cannot see so far.

        A projection between two cameras at one eye maps the image onto a quadrilateral, so that the four corners of the
        image bound the slopes and the depths.
        """
        forward = axes[0]
        length = math.hypot(forward[0], forward[1])
        if length < _MIN_LEVEL:
            return None
        ahead = np.array([forward[0] / length, forward[1] / length, 0.0])
        level = np.array([ahead, [-ahead[1], ahead[0], 0.0], [0.0, 0.0, 1.0]])
        corners = np.array([[1.0, y * self._right_max, z * self._up_max] for y in (-1, 1) for z in (-1, 1)])
        depth, left, up = level @ axes.T @ corners.T  # in the level camera's axes
        if depth.min() < _MIN_LEVEL:
            return None
        right_max, up_max = float(np.abs(left / depth).max()), float(np.abs(up / depth).max())
        strips = math.ceil(2.0 * right_max / self._strip - _SAME_STRIPS)
        edges = np.minimum(np.arange(strips + 1) * self._strip - right_max, right_max)
        near_m, past_near_m = self._near_m * float(depth.min()), self._near_m * float(depth.max())
        return LevelView(right_max, up_max, near_m, past_near_m, edges)

    def _strip_walls(self, eye_m: NDArray, yaw: tuple[float, float], view: LevelView) -> StripWalls:
        """Returns the wall of each strip.

        If the eye is above a floor, or below a ceiling, that reaches past the wall, nothing is visible below or
        above the wall either.
        """
        walls, least_m = self._walls(float(eye_m[2])), view.past_near_m + _SLACK_M
        wall_m, wall = nearest_walls(
            walls.centre, walls.axis, walls.half, eye_m, yaw, view.edges, view.right_max, least_m
        )
        if len(walls.top) == 0:
            return StripWalls(wall_m, -wall_m, wall_m)
        high_m, low_m = walls.top[wall] - eye_m[2], walls.bottom[wall] - eye_m[2]
        high, low = high_m / wall_m, low_m / wall_m
        slabs = _arrays(self._boxes)
        open_past_slabs(*slabs, eye_m, yaw, view.edges, _MIN_SLAB_M, self._slack, low_m, high_m, low, high)
        high[high > view.up_max + 2 * self._slack] = np.inf
        low[low < -view.up_max - 2 * self._slack] = -np.inf
        return StripWalls(wall_m, low, high)

    def _walls(self, eye_z_m: float) -> UprightBoxes:
        """Returns the walls for a height of the eye; they are kept while it changes by less than their slack."""
        if not abs(self._walls_at[0] - eye_z_m) < _SAME_EYE_M:
            self._walls_at = (eye_z_m, self._boxes.tall(eye_z_m))
        return self._walls_at[1]


def _arrays(boxes: UprightBoxes) -> tuple[NDArray, NDArray, NDArray, NDArray, NDArray]:
    """Returns the arrays of boxes in the order of the kernels' arguments."""
    return boxes.centre, boxes.axis, boxes.half, boxes.bottom, boxes.top


def _corners(model: mujoco.MjModel, data: mujoco.MjData, ids: NDArray[np.intp]) -> NDArray[np.float64]:
    """Returns (n, 8, 3) x, y and z in the world of the corners of the oriented bounding box of each geom."""
    box = model.geom_aabb[ids]  # (n, 6) centre and half size in the axes of the geom
    local = box[:, None, :3] + _SIGNS * box[:, None, 3:]  # (n, 8, 3)
    return np.einsum("nij,nkj->nki", data.geom_xmat[ids].reshape(-1, 3, 3), local) + data.geom_xpos[ids][:, None]


def opaque_geoms(model: mujoco.MjModel) -> NDArray[np.bool_]:
    """Returns (ngeom,) True for geoms with an opaque colour, material and texture."""
    opaque = model.geom_rgba[:, 3] >= 1.0
    if model.nmat:
        textures = model.mat_texid  # (nmat, roles) or -1
        clear = model.mat_rgba[:, 3] < 1.0
        if model.ntex:
            clear |= ((textures >= 0) & (model.tex_nchannel[textures] == 4)).any(axis=1)
        opaque &= ~((model.geom_matid >= 0) & clear[model.geom_matid])
    return opaque
