"""Upright boxes: rectangles in plan with a bottom and a top, and the rays that cross them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.gl import mujoco

_MIN_RISE_M = 0.05
"""Walls must extend at least this far above and below the eye."""
_UPRIGHT_TOLERANCE = 1e-11
"""1 minus the cosine of a tilt that moves the end of a wall of ten metres by less than 0.05 mm."""


@dataclass(frozen=True)
class UprightBoxes:
    """Boxes with one vertical axis, in the world."""

    centre: NDArray[np.float64]
    """(n, 2) in plan."""
    axis: NDArray[np.float64]
    """(n, 2) direction of the first side in plan; the second side is perpendicular."""
    half: NDArray[np.float64]
    """(n, 2) half the lengths of the sides."""
    bottom: NDArray[np.float64]
    """(n,) height."""
    top: NDArray[np.float64]
    """(n,) height."""

    @classmethod
    def around(
        cls, model: mujoco.MjModel, data: mujoco.MjData, ids: NDArray[np.intp]
    ) -> tuple[UprightBoxes, NDArray[np.intp]]:
        """Returns the bounding boxes of those geoms that have a vertical axis, and the indices of these into `ids`."""
        axes = data.geom_xmat[ids].reshape(-1, 3, 3).transpose(0, 2, 1)  # rows are the axes of the geom
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

    def take(self, chosen: NDArray) -> UprightBoxes:
        """Returns the boxes of a mask or of indices."""
        return UprightBoxes(
            self.centre[chosen], self.axis[chosen], self.half[chosen], self.bottom[chosen], self.top[chosen]
        )

    def tall(self, eye_z_m: float) -> UprightBoxes:
        """Returns the boxes that extend as high and as low as most of the wall length: they hide most.

        A low wall in front of a high one would be the nearest of its strip and hide little. Leaving it out costs
        rendering time but never changes a pixel.
        """
        spanning = self.take((self.bottom < eye_z_m - _MIN_RISE_M) & (self.top > eye_z_m + _MIN_RISE_M))
        length = spanning.half.max(axis=1)
        high = _highest(spanning.top - eye_z_m, length)
        spanning, length = spanning.take(high), length[high]
        return spanning.take(_highest(eye_z_m - spanning.bottom, length))

    def cross(self, eye_m: NDArray, ray: NDArray) -> tuple[NDArray, NDArray]:
        """Returns where rays in plan from the eye enter and leave each box, (n, rays), in lengths of `ray` (2, rays).

        Entry is negative when the eye is inside the box or past it, and nan when the ray misses the box.
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
    """Returns 1 / slope; a ray parallel to a side is turned by a tiny angle, so that it still crosses the box."""
    return 1.0 / np.where(np.abs(slope) < 1e-12, 1e-12, slope)


def _highest(rise_m: NDArray, length_m: NDArray) -> NDArray[np.bool_]:
    """Returns (n,) True for rises of at least the level that maximizes level times total length at that level."""
    if len(rise_m) == 0:
        return np.zeros(0, np.bool_)
    order = np.argsort(-rise_m)
    area = rise_m[order] * np.cumsum(length_m[order])
    return rise_m >= rise_m[order[area.argmax()]] - 1e-6
