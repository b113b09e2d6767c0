"""Finds geoms that a level camera cannot see: those outside its view, and those completely behind walls.

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

from sim.gl import mujoco
from sim.interface import CameraModel
from sim.sensors.upright_boxes import UprightBoxes

STRIP_PX = 4
"""Width of a strip: a wall hides nothing in a strip that it does not cover from edge to edge."""
_SLACK_PX = 0.5
"""Geoms are grown by this much in the image, so that rounding in the rasteriser does not matter."""
_SLACK_M = 0.01
"""A hidden geom is farther than the wall by at least this: many times the resolution of the depth buffer."""
_MIN_SLAB_M = 0.2
"""The near plane may cut floors and ceilings nearer to the eye than this."""
_BOX = int(mujoco.mjtGeom.mjGEOM_BOX)
_UNBOUNDED = (int(mujoco.mjtGeom.mjGEOM_PLANE), int(mujoco.mjtGeom.mjGEOM_HFIELD))  # never left out
_SIGNS = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])  # (8, 3)


class StripWalls(NamedTuple):
    """The wall of each strip; the arrays (strips + 1,) have one more entry, for ranges that end with the last strip."""

    depth_m: NDArray[np.float64]
    """inf for a strip without a wall."""
    low: NDArray[np.float64]
    """Slope of the lower edge."""
    high: NDArray[np.float64]
    """Slope of the upper edge."""


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
        columns = np.append(np.arange(0, camera.width_px, STRIP_PX), camera.width_px)
        self._edges = (columns - 0.5 * camera.width_px) / camera.focal_px  # (strips + 1,) to the right
        self._right_max = 0.5 * camera.width_px / camera.focal_px
        self._up_max = 0.5 * camera.height_px / camera.focal_px
        self._slack = _SLACK_PX / camera.focal_px
        self._strip = STRIP_PX / camera.focal_px
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        static = model.body_weldid[model.geom_bodyid] == 0
        self._movable = np.flatnonzero(~static[self._ids])  # indices into `_ids`
        self._bounded = ~np.isin(model.geom_type[self._ids], _UNBOUNDED)
        self._corners = _corners(model, data, self._ids)  # (3, 8, n) world
        bounded = np.flatnonzero(self._bounded & static[self._ids])
        self._bounds, upright = UprightBoxes.around(model, data, self._ids[bounded])
        self._bound_of = np.full(len(self._ids), -1)  # index into `_bounds`, by index into `_ids`
        self._bound_of[bounded[upright]] = np.arange(len(self._bounds.top))
        solid = self._ids[bounded[upright]]
        self._boxes = self._bounds.take((model.geom_type[solid] == _BOX) & opaque_geoms(model)[solid])
        self._walls_at = (math.nan, self._boxes)  # height of the eye and its walls

    def visible(self, data: mujoco.MjData, eye_m: NDArray, yaw_rad: float) -> NDArray[np.intp]:
        """Returns the ids, in ascending order, of the visual geoms that may be visible.

        Args:
            data: state of the model; kinematics must be computed.
            eye_m: (3,) optical centre in the world.
            yaw_rad: heading; the camera is level.
        """
        if self._movable.size:
            self._corners[:, :, self._movable] = _corners(self._model, data, self._ids[self._movable])
        c, s = yaw = math.cos(yaw_rad), math.sin(yaw_rad)
        x, y, z = self._corners[0] - eye_m[0], self._corners[1] - eye_m[1], self._corners[2] - eye_m[2]  # (8, n)
        depth, right = c * x + s * y, s * x - c * y
        kept = np.flatnonzero(~(self._outside(depth, right, z) & self._bounded))
        walls = self._strip_walls(eye_m, yaw)
        hidden = self._hidden(depth[:, kept], right[:, kept], z[:, kept], walls)
        kept = kept[~(hidden & self._bounded[kept])]
        upright = np.flatnonzero(self._bound_of[kept] >= 0)
        hidden = self._hidden_by_strip(self._bounds.take(self._bound_of[kept[upright]]), eye_m, yaw, walls)
        return self._ids[np.delete(kept, upright[hidden])]

    def in_sight(self, eye_m: NDArray, positions_m: NDArray) -> NDArray[np.bool_]:
        """Returns (k,) True for positions (k, 3) without a wall in between in plan; a position on a wall is in sight.

        Only walls from floor to ceiling count, so that a position behind a door opening is in sight below the lintel.
        """
        walls = self._walls(float(eye_m[2]))
        entry, leave = walls.cross(eye_m, (positions_m[:, :2] - eye_m[:2]).T)  # (walls, k) shares of the distance
        with np.errstate(invalid="ignore"):
            between = (entry > 0.0) & (leave < 1.0)
        return ~np.asarray(between.any(axis=0), np.bool_)

    def _outside(self, depth: NDArray, right: NDArray, up: NDArray) -> NDArray:
        """Returns (n,) True for geoms with all corners (8, n) beyond the same side of the image or the near plane."""
        limit_u, limit_v = self._right_max + self._slack, self._up_max + self._slack
        wide, high = limit_u * depth, limit_v * depth
        outside = np.asarray((depth < 0.99 * self._near_m).all(axis=0), np.bool_)
        for beyond in (right > wide, right < -wide, up > high, up < -high):
            outside |= beyond.all(axis=0)
        return outside

    def _hidden(self, depth: NDArray, right: NDArray, up: NDArray, walls: StripWalls) -> NDArray:
        """Returns (k,) True for geoms with these corners, (8, k) in camera axes, that are behind walls."""
        nearest = depth.min(axis=0)
        in_front = nearest > self._near_m  # slopes are meaningful only for geoms completely in front of the eye
        with np.errstate(divide="ignore", invalid="ignore"):
            u, v = right / depth, up / depth
        first = np.where(in_front, np.floor((u.min(axis=0) - self._slack + self._right_max) / self._strip), 0)
        last = np.where(in_front, np.floor((u.max(axis=0) + self._slack + self._right_max) / self._strip), 0)
        strips = len(walls.depth_m) - 1
        first, last = (np.clip(k, 0, strips - 1).astype(np.intp) for k in (first, last))
        ranges = np.stack([first, last + 1], axis=1).ravel()
        hidden = in_front & (nearest > np.maximum.reduceat(walls.depth_m, ranges)[::2] + _SLACK_M)
        hidden &= np.minimum(v.max(axis=0), self._up_max) + self._slack < np.minimum.reduceat(walls.high, ranges)[::2]
        hidden &= np.maximum(v.min(axis=0), -self._up_max) - self._slack > np.maximum.reduceat(walls.low, ranges)[::2]
        return hidden

    def _hidden_by_strip(
        self, boxes: UprightBoxes, eye_m: NDArray, yaw: tuple[float, float], walls: StripWalls
    ) -> NDArray:
        """Returns (k,) True for upright boxes whose part in each strip is behind the wall of that strip.

        This test is for long geoms. A floor or a wall of another room is near in one strip and high in another, or
        partly behind the eye. The part of a convex outline in a strip has its corners where the edges of the strip
        enter the outline, and at the corners of the outline.
        """
        wall_m, wall_low, wall_high = (part[:-1] for part in walls)
        near = self._nearest_by_strip(boxes, eye_m, yaw)
        rise, drop = np.maximum(boxes.top - eye_m[2], 0.0), np.minimum(boxes.bottom - eye_m[2], 0.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            high, low = rise[:, None] / near, drop[:, None] / near
        behind = near > wall_m + _SLACK_M
        behind &= np.minimum(high, self._up_max) + self._slack < wall_high
        behind &= np.maximum(low, -self._up_max) - self._slack > wall_low
        return (behind | np.isnan(near)).all(axis=1)

    def _nearest_by_strip(self, boxes: UprightBoxes, eye_m: NDArray, yaw: tuple[float, float]) -> NDArray:
        """Returns (k, strips) the smallest depth of each box in each strip; nan for a strip that it does not reach."""
        (c, s), strips = yaw, len(self._edges) - 1
        entry, leave = boxes.cross(eye_m, self._rays(yaw))
        entry[leave < 0.0] = np.nan  # behind the eye
        near = np.fmin(entry[:, :-1], entry[:, 1:])  # nan where neither edge enters
        x, y = boxes.corners()  # (k, 4)
        depth = c * (x - eye_m[0]) + s * (y - eye_m[1])
        with np.errstate(divide="ignore", invalid="ignore"):
            u = (s * (x - eye_m[0]) - c * (y - eye_m[1])) / depth
        for grown in (-self._slack, self._slack):
            strip = np.floor((u + grown + self._right_max) / self._strip)
            box, corner = np.nonzero((depth > 0.0) & (strip >= 0) & (strip < strips))
            np.fmin.at(near, (box, strip[box, corner].astype(np.intp)), depth[box, corner])
        return near

    def _rays(self, yaw: tuple[float, float]) -> NDArray:
        """Returns (2, strips + 1) the edges of the strips in plan, metres per metre of depth."""
        c, s = yaw
        return np.stack([c + s * self._edges, s - c * self._edges])

    def _strip_walls(self, eye_m: NDArray, yaw: tuple[float, float]) -> StripWalls:
        """Returns the wall of each strip."""
        ray = self._rays(yaw)
        walls = self._walls(float(eye_m[2])).in_fan(eye_m, yaw, self._right_max)
        entry, _ = walls.cross(eye_m, ray)
        entry[~(entry > self._near_m + _SLACK_M)] = np.inf
        front = np.maximum(entry[:, :-1], entry[:, 1:])  # (walls, strips)
        if len(front) == 0:
            empty = np.full(len(self._edges), np.inf)
            return StripWalls(empty, empty, -empty)
        best = front.argmin(axis=0)
        wall_m = front[best, np.arange(front.shape[1])]
        high_m, low_m = walls.top[best] - eye_m[2], walls.bottom[best] - eye_m[2]
        high, low = high_m / wall_m, low_m / wall_m
        for face_m, reach_m in self._slabs(eye_m, ray):
            if face_m > 0:
                high[(face_m <= high_m) & (face_m / reach_m < high - self._slack)] = np.inf
            else:
                low[(face_m >= low_m) & (face_m / reach_m > low + self._slack)] = -np.inf
        high[high > self._up_max + 2 * self._slack] = np.inf
        low[low < -self._up_max - 2 * self._slack] = -np.inf
        pad = [np.inf]
        return StripWalls(np.append(wall_m, pad), np.append(low, pad), np.append(high, pad))

    def _slabs(self, eye_m: NDArray, ray: NDArray) -> list[tuple[float, NDArray]]:
        """Returns, for ceilings above and floors below the eye, the height of the near face above the eye and
        (strips,) the depth up to which the slab covers the whole strip.
        """
        boxes, (x, y, z) = self._boxes, eye_m
        dx, dy = x - boxes.centre[:, 0], y - boxes.centre[:, 1]
        along = np.abs(boxes.axis[:, 0] * dx + boxes.axis[:, 1] * dy) < boxes.half[:, 0]
        across = np.abs(boxes.axis[:, 0] * dy - boxes.axis[:, 1] * dx) < boxes.half[:, 1]
        face = np.where(boxes.bottom > z, boxes.bottom - z, boxes.top - z)
        clear = (boxes.bottom > z + _MIN_SLAB_M) | (boxes.top < z - _MIN_SLAB_M)
        slabs = np.flatnonzero(along & across & clear)
        _, leave = boxes.take(slabs).cross(eye_m, ray)
        return list(zip(face[slabs].tolist(), np.minimum(leave[:, :-1], leave[:, 1:]), strict=True))

    def _walls(self, eye_z_m: float) -> UprightBoxes:
        """Returns the walls for a height of the eye; they are kept, since the height changes only with the storey."""
        if self._walls_at[0] != eye_z_m:
            self._walls_at = (eye_z_m, self._boxes.tall(eye_z_m))
        return self._walls_at[1]


def _corners(model: mujoco.MjModel, data: mujoco.MjData, ids: NDArray[np.intp]) -> NDArray[np.float64]:
    """Returns (3, 8, n) x, y and z in the world of the corners of the oriented bounding box of each geom."""
    box = model.geom_aabb[ids]  # (n, 6) centre and half size in the axes of the geom
    local = box[:, None, :3] + _SIGNS * box[:, None, 3:]  # (n, 8, 3)
    world = np.einsum("nij,nkj->ikn", data.geom_xmat[ids].reshape(-1, 3, 3), local)
    return world + data.geom_xpos[ids].T[:, None, :]


def opaque_geoms(model: mujoco.MjModel) -> NDArray[np.bool_]:
    """Returns (ngeom,) True for geoms whose colour, material and texture are opaque."""
    opaque = model.geom_rgba[:, 3] >= 1.0
    if model.nmat:
        textures = model.mat_texid  # (nmat, roles) or -1
        clear = model.mat_rgba[:, 3] < 1.0
        if model.ntex:
            clear |= ((textures >= 0) & (model.tex_nchannel[textures] == 4)).any(axis=1)
        opaque &= ~((model.geom_matid >= 0) & clear[model.geom_matid])
    return opaque
