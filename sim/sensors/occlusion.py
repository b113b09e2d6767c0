"""Which geoms a level camera cannot see: those outside its view, and those wholly behind walls; and whose shadows.

The picture is cut into strips of a few pixel columns. In each strip the nearest opaque upright box that covers the
whole strip and spans the height of the eye is its *wall*: nothing that lies farther than the wall's front and, seen
from the eye, between the wall's lower and upper edge can reach a pixel of the strip. A geom is hidden if that is so
in every strip that the box around it reaches into. Every bound errs towards drawing:

- All is reckoned in image coordinates, *slopes* per metre of depth to the left (`u`) and up (`v`). In them the extremes
  of a convex body are at its corners, so eight corners bound a geom whatever its shape.
- A box that both edge rays of a strip enter holds the segment between the two places of entry; the deeper one is
  therefore a depth at which the whole strip is blocked.
- Where the eye stands over a floor, or under a ceiling, that reaches farther than the wall, nothing shows below or
  above the wall either.

Only static opaque boxes with one axis upright hide anything; whatever moves is looked up where it is now.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.gl import mujoco
from sim.interface import CameraModel

STRIP_PX = 4
"""Width of a strip: a wall hides nothing in a strip that it does not cover from edge to edge."""
_SLACK_PX = 0.5
"""How far geoms are grown in the picture, so that no rounding of the rasteriser matters."""
_SLACK_M = 0.01
"""How much farther than a wall a geom must be: many times the resolution of the depth buffer."""
_SHADOW_RIM_M = 0.05
"""How far beside the picture a shadow must end: a pixel of the shadow map is a centimetre or two on the floor."""
_MIN_RISE_M = 0.05
"""Walls must reach this far above and below the eye."""
_MIN_SLAB_M = 0.2
"""Floors and ceilings nearer to the eye than this might be cut by the near plane."""
_UPRIGHT_TOLERANCE = 1e-11
"""1 minus the cosine of a tilt that moves the end of a ten metre wall by less than 0.05 mm."""
_BOX = int(mujoco.mjtGeom.mjGEOM_BOX)
_UNBOUNDED = (int(mujoco.mjtGeom.mjGEOM_PLANE), int(mujoco.mjtGeom.mjGEOM_HFIELD))  # always drawn
_SIGNS = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])  # (8, 3)

Horizon = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]
"""Of each strip's wall, and once more (strips + 1,): depth in metres, slopes of its lower and of its upper edge."""


class Visibility:
    """Finds what may be seen in one model; what does not move is prepared once.

    Args:
        model: compiled world.
        drawable: (ngeom,) True for geoms that are rendered at all.
        camera: intrinsics.
        near_m: depth of the near plane.
    """

    def __init__(self, model: mujoco.MjModel, drawable: NDArray[np.bool_], camera: CameraModel, near_m: float) -> None:
        self._model = model
        self._ids = np.flatnonzero(drawable)
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
        flat = np.flatnonzero(self._bounded & static[self._ids])
        self._bounds, upright = _Boxes.around(model, data, self._ids[flat])
        self._bound_of = np.full(len(self._ids), -1)  # index into `_bounds`, by index into `_ids`
        self._bound_of[flat[upright]] = np.arange(len(self._bounds.top))
        solid = self._ids[flat[upright]]
        self._boxes = self._bounds.take((model.geom_type[solid] == _BOX) & _opaque(model)[solid])
        self._tall_at = (math.nan, self._boxes)

    def visible(self, data: mujoco.MjData, eye_m: NDArray, yaw_rad: float, *, hide: bool = True) -> NDArray[np.intp]:
        """Ids, ascending, of the drawable geoms that may reach a pixel.

        Args:
            data: state of the model; kinematics must be up to date.
            eye_m: (3,) optical centre in the world.
            yaw_rad: heading; the camera is level.
            hide: also leave out what is behind walls.
        """
        if self._movable.size:
            self._corners[:, :, self._movable] = _corners(self._model, data, self._ids[self._movable])
        c, s = math.cos(yaw_rad), math.sin(yaw_rad)
        x, y, z = self._corners[0] - eye_m[0], self._corners[1] - eye_m[1], self._corners[2] - eye_m[2]  # (8, n)
        depth, right = c * x + s * y, s * x - c * y
        limit_u, limit_v = self._right_max + self._slack, self._up_max + self._slack
        wide, high = limit_u * depth, limit_v * depth
        outside = (depth < 0.99 * self._near_m).all(axis=0)
        for beyond in (right > wide, right < -wide, z > high, z < -high):
            outside |= beyond.all(axis=0)
        kept = np.flatnonzero(~(outside & self._bounded))
        if hide:
            horizon = self._horizon(eye_m, (c, s))
            hidden = self._hidden(depth[:, kept], right[:, kept], z[:, kept], horizon)
            kept = kept[~(hidden & self._bounded[kept])]
            upright = np.flatnonzero(self._bound_of[kept] >= 0)
            hidden = self._hidden_by_strip(self._bounds.take(self._bound_of[kept[upright]]), eye_m, (c, s), horizon)
            kept = np.delete(kept, upright[hidden])
        return self._ids[kept]

    def shading(self, light_m: NDArray, eye_m: NDArray, axes: NDArray) -> NDArray[np.bool_]:
        """(drawable,) False where neither a geom nor its shadow can reach the picture; after `visible`, of its state.

        A shadow is what lies behind the geom as seen from the light: the hull of its corners and of the rays from the
        light through them. It misses the picture where all of these lie beyond one of its sides.

        Args:
            light_m: (3,) where the light is.
            eye_m: (3,) optical centre in the world.
            axes: (3, 3) the camera's forward, left and up as rows.
        """
        ahead, left, up = np.einsum("ai,ikn->akn", axes, self._corners - eye_m[:, None, None])
        far_ahead, far_left, far_up = np.einsum("ai,ikn->akn", axes, self._corners - light_m[:, None, None])
        wide, high = self._right_max + self._slack, self._up_max + self._slack
        missed = np.zeros(len(self._ids), np.bool_)
        for inwards, onwards in (
            (ahead, far_ahead),
            (wide * ahead - left, wide * far_ahead - far_left),
            (wide * ahead + left, wide * far_ahead + far_left),
            (high * ahead - up, high * far_ahead - far_up),
            (high * ahead + up, high * far_ahead + far_up),
        ):
            missed |= (inwards < -_SHADOW_RIM_M).all(axis=0) & (onwards < 0.0).all(axis=0)
        return ~(missed & self._bounded)

    def in_sight(self, eye_m: NDArray, places_m: NDArray) -> NDArray[np.bool_]:
        """(k,) True where no wall stands between the eye and a place (k, 3), in plan; on a wall counts as before it.

        The walls are those that reach from floor to ceiling and span the eye; what can be seen through a door can be
        seen under its lintel.
        """
        walls = self._tall(float(eye_m[2]))
        entry, leave = walls.cross(eye_m, (places_m[:, :2] - eye_m[:2]).T)  # (walls, k) shares of the way
        with np.errstate(invalid="ignore"):
            between = (entry > 0.0) & (leave < 1.0)
        return ~np.asarray(between.any(axis=0), np.bool_)

    def _hidden(self, depth: NDArray, right: NDArray, up: NDArray, horizon: Horizon) -> NDArray:
        """(k,) True where a geom with these corners, (8, k) in camera axes, is behind walls."""
        nearest = depth.min(axis=0)
        before = nearest > self._near_m  # slopes mean something only for what is wholly before the eye
        with np.errstate(divide="ignore", invalid="ignore"):
            u, v = right / depth, up / depth
        wall_m, wall_low, wall_high = horizon
        first = np.where(before, np.floor((u.min(axis=0) - self._slack + self._right_max) / self._strip), 0)
        last = np.where(before, np.floor((u.max(axis=0) + self._slack + self._right_max) / self._strip), 0)
        strips = len(wall_m) - 1  # one more follows, so that a range may end with the last strip
        first, last = (np.clip(k, 0, strips - 1).astype(np.intp) for k in (first, last))
        ranges = np.stack([first, last + 1], axis=1).ravel()
        hidden = before & (nearest > np.maximum.reduceat(wall_m, ranges)[::2] + _SLACK_M)
        hidden &= np.minimum(v.max(axis=0), self._up_max) + self._slack < np.minimum.reduceat(wall_high, ranges)[::2]
        hidden &= np.maximum(v.min(axis=0), -self._up_max) - self._slack > np.maximum.reduceat(wall_low, ranges)[::2]
        return hidden

    def _hidden_by_strip(self, boxes: _Boxes, eye_m: NDArray, yaw: tuple[float, float], horizon: Horizon) -> NDArray:
        """(k,) True where an upright box is behind the wall of each strip by what of it is in that very strip.

        Long things need it: a floor, or another room's wall, is near in one strip and high in another, or partly
        behind the eye. What of a convex outline lies in a strip has its corners where the strip's edges enter the
        outline and at the outline's own corners.
        """
        wall_m, wall_low, wall_high = (part[:-1] for part in horizon)
        (c, s), strips = yaw, len(wall_m)
        entry, leave = boxes.cross(eye_m, self._rays(yaw))
        entry[leave < 0.0] = np.nan  # behind the eye
        near = np.fmin(entry[:, :-1], entry[:, 1:])  # (k, strips), nan where neither edge enters
        x, y = boxes.corners()  # (k, 4)
        depth = c * (x - eye_m[0]) + s * (y - eye_m[1])
        with np.errstate(divide="ignore", invalid="ignore"):
            u = (s * (x - eye_m[0]) - c * (y - eye_m[1])) / depth
        for grown in (-self._slack, self._slack):
            at = np.floor((u + grown + self._right_max) / self._strip)
            box, corner = np.nonzero((depth > 0.0) & (at >= 0) & (at < strips))
            np.fmin.at(near, (box, at[box, corner].astype(np.intp)), depth[box, corner])
        rise, drop = np.maximum(boxes.top - eye_m[2], 0.0), np.minimum(boxes.bottom - eye_m[2], 0.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            high, low = rise[:, None] / near, drop[:, None] / near
        behind = near > wall_m + _SLACK_M
        behind &= np.minimum(high, self._up_max) + self._slack < wall_high
        behind &= np.maximum(low, -self._up_max) - self._slack > wall_low
        return (behind | np.isnan(near)).all(axis=1)

    def _rays(self, yaw: tuple[float, float]) -> NDArray:
        """(2, strips + 1) the edges of the strips in plan, metres per metre of depth."""
        c, s = yaw
        return np.stack([c + s * self._edges, s - c * self._edges])

    def _horizon(self, eye_m: NDArray, yaw: tuple[float, float]) -> Horizon:
        """Of each strip's wall, (strips + 1,): its depth (inf without one), its lower and its upper slope."""
        ray = self._rays(yaw)
        walls = self._tall(float(eye_m[2])).in_fan(eye_m, yaw, self._right_max)
        entry, _ = walls.cross(eye_m, ray)
        entry[~(entry > self._near_m + _SLACK_M)] = np.inf
        front = np.maximum(entry[:, :-1], entry[:, 1:])  # (walls, strips)
        if len(front) == 0:
            empty = np.full(len(self._edges), np.inf)
            return empty, empty, -empty
        best = front.argmin(axis=0)
        wall_m = front[best, np.arange(front.shape[1])]
        high_m, low_m = walls.top[best] - eye_m[2], walls.bottom[best] - eye_m[2]
        high, low = high_m / wall_m, low_m / wall_m
        for over_m, reach_m in self._slabs(eye_m, ray):
            if over_m > 0:
                high[(over_m <= high_m) & (over_m / reach_m < high - self._slack)] = np.inf
            else:
                low[(over_m >= low_m) & (over_m / reach_m > low + self._slack)] = -np.inf
        high[high > self._up_max + 2 * self._slack] = np.inf
        low[low < -self._up_max - 2 * self._slack] = -np.inf
        pad = [np.inf]
        return np.append(wall_m, pad), np.append(low, pad), np.append(high, pad)

    def _slabs(self, eye_m: NDArray, ray: NDArray) -> list[tuple[float, NDArray]]:
        """Ceilings over and floors under the eye: the height of the near face over the eye, and (strips,) the depth
        up to which the whole strip is covered.
        """
        boxes, (x, y, z) = self._boxes, eye_m
        dx, dy = x - boxes.centre[:, 0], y - boxes.centre[:, 1]
        along = np.abs(boxes.axis[:, 0] * dx + boxes.axis[:, 1] * dy) < boxes.half[:, 0]
        across = np.abs(boxes.axis[:, 0] * dy - boxes.axis[:, 1] * dx) < boxes.half[:, 1]
        gap = np.where(boxes.bottom > z, boxes.bottom - z, boxes.top - z)
        clear = (boxes.bottom > z + _MIN_SLAB_M) | (boxes.top < z - _MIN_SLAB_M)
        slabs = np.flatnonzero(along & across & clear)
        _, leave = boxes.take(slabs).cross(eye_m, ray)
        return list(zip(gap[slabs].tolist(), np.minimum(leave[:, :-1], leave[:, 1:]), strict=True))

    def _tall(self, eye_z_m: float) -> _Boxes:
        """The walls that count at this height of the eye, which changes only with the storey."""
        if self._tall_at[0] != eye_z_m:
            self._tall_at = (eye_z_m, self._boxes.tall(eye_z_m))
        return self._tall_at[1]


@dataclass(frozen=True)
class _Boxes:
    """Upright boxes: rectangles in plan, each from `bottom` to `top`, in the world."""

    centre: NDArray[np.float64]
    """(n, 2)"""
    axis: NDArray[np.float64]
    """(n, 2) direction of the first side in plan; the second is at a right angle."""
    half: NDArray[np.float64]
    """(n, 2) half the lengths of the sides."""
    bottom: NDArray[np.float64]
    top: NDArray[np.float64]

    @classmethod
    def around(
        cls, model: mujoco.MjModel, data: mujoco.MjData, ids: NDArray[np.intp]
    ) -> tuple[_Boxes, NDArray[np.intp]]:
        """The boxes around those geoms whose own axes have one upright, and which of `ids` these are."""
        axes = data.geom_xmat[ids].reshape(-1, 3, 3).transpose(0, 2, 1)  # rows are the geom's own axes
        is_up = np.abs(axes[:, :, 2]) > 1.0 - _UPRIGHT_TOLERANCE
        kept = np.flatnonzero(is_up.any(axis=1))
        ids, axes, up = ids[kept], axes[kept], is_up[kept].argmax(axis=1)
        n, first, second = np.arange(len(ids)), (up + 1) % 3, (up + 2) % 3
        size = model.geom_aabb[ids, 3:]
        centre = data.geom_xpos[ids] + np.einsum("nij,ni->nj", axes, model.geom_aabb[ids, :3])
        boxes = cls(
            centre=centre[:, :2].copy(),
            axis=axes[n, first, :2].copy(),
            half=np.stack([size[n, first], size[n, second]], axis=1),
            bottom=centre[:, 2] - size[n, up],
            top=centre[:, 2] + size[n, up],
        )
        return boxes, kept

    def take(self, chosen: NDArray) -> _Boxes:
        """Some of them, by mask or index."""
        return _Boxes(self.centre[chosen], self.axis[chosen], self.half[chosen], self.bottom[chosen], self.top[chosen])

    def corners(self) -> tuple[NDArray, NDArray]:
        """x and y of the corners, each (n, 4)."""
        along = self.half[:, :1] * np.array([-1.0, -1.0, 1.0, 1.0])
        across = self.half[:, 1:] * np.array([-1.0, 1.0, -1.0, 1.0])
        ax, ay = self.axis[:, :1], self.axis[:, 1:]
        return self.centre[:, :1] + ax * along - ay * across, self.centre[:, 1:] + ay * along + ax * across

    def tall(self, eye_z_m: float) -> _Boxes:
        """Those that reach the ceiling and the floor, as the most wall does, and so hide most.

        A low wall before a high one would be the nearest of its strip and hide little; that costs frames, never pixels.
        """
        span = self.take((self.bottom < eye_z_m - _MIN_RISE_M) & (self.top > eye_z_m + _MIN_RISE_M))
        length = span.half.max(axis=1)
        span, length = (lambda ok: (span.take(ok), length[ok]))(_highest(span.top - eye_z_m, length))
        return span.take(_highest(eye_z_m - span.bottom, length))

    def in_fan(self, eye_m: NDArray, yaw: tuple[float, float], right_max: float) -> _Boxes:
        """Those of which a part may be in the picture's fan, in plan."""
        c, s = yaw
        dx, dy = self.centre[:, 0] - eye_m[0], self.centre[:, 1] - eye_m[1]
        depth, right = c * dx + s * dy, s * dx - c * dy
        radius = np.hypot(self.half[:, 0], self.half[:, 1])
        slant = np.hypot(1.0, right_max) * radius
        return self.take((depth > -radius) & (np.abs(right) < right_max * depth + slant))

    def cross(self, eye_m: NDArray, ray: NDArray) -> tuple[NDArray, NDArray]:
        """Where rays in plan from the eye enter and leave each box, (n, rays) in lengths of `ray` (2, rays).

        Entry is negative where the eye is inside or past the box, nan where the ray misses.
        """
        ax, ay = self.axis[:, 0, None], self.axis[:, 1, None]
        ox, oy = self.centre[:, 0, None] - eye_m[0], self.centre[:, 1, None] - eye_m[1]
        along, across = _inverse(ax * ray[0] + ay * ray[1]), _inverse(ax * ray[1] - ay * ray[0])
        middle, width = (ax * ox + ay * oy) * along, self.half[:, :1] * np.abs(along)
        middle2, width2 = (ax * oy - ay * ox) * across, self.half[:, 1:] * np.abs(across)
        entry = np.maximum(middle - width, middle2 - width2)
        leave = np.minimum(middle + width, middle2 + width2)
        entry[~(entry <= leave)] = np.nan
        return entry, leave


def _inverse(slope: NDArray) -> NDArray:
    """1 / slope; a ray along a side is turned by a hair, so that it still crosses the box."""
    return 1.0 / np.where(np.abs(slope) < 1e-12, 1e-12, slope)


def _highest(rise_m: NDArray, length_m: NDArray) -> NDArray[np.bool_]:
    """Those that rise at least as far as some level, the level at which height times length of wall is greatest."""
    if len(rise_m) == 0:
        return np.zeros(0, np.bool_)
    order = np.argsort(-rise_m)
    area = rise_m[order] * np.cumsum(length_m[order])
    return rise_m >= rise_m[order[area.argmax()]] - 1e-6


def _corners(model: mujoco.MjModel, data: mujoco.MjData, ids: NDArray[np.intp]) -> NDArray[np.float64]:
    """(3, 8, n) x, y and z in the world of the corners of the oriented box around each geom."""
    box = model.geom_aabb[ids]  # (n, 6) centre and half size in the geom's own axes
    local = box[:, None, :3] + _SIGNS * box[:, None, 3:]  # (n, 8, 3)
    world = np.einsum("nij,nkj->ikn", data.geom_xmat[ids].reshape(-1, 3, 3), local)
    return world + data.geom_xpos[ids].T[:, None, :]


def _opaque(model: mujoco.MjModel) -> NDArray[np.bool_]:
    """(ngeom,) True where neither colour nor material nor texture lets anything through."""
    opaque = model.geom_rgba[:, 3] >= 1.0
    if model.nmat:
        textures = model.mat_texid  # (nmat, roles) or -1
        clear = model.mat_rgba[:, 3] < 1.0
        if model.ntex:
            clear |= ((textures >= 0) & (model.tex_nchannel[textures] == 4)).any(axis=1)
        opaque &= ~((model.geom_matid >= 0) & clear[model.geom_matid])
    return opaque
