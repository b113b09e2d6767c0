"""The map around the robot at a coarse resolution, as the input of networks that explore."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, UInt8, UInt32
from numpy.typing import NDArray

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES
from stubborn.mapping.navmap import NavMap

LAYERS = ("obstacle", "seen", "trail", "robot")
"""The channels of `MapPatch.channels` before those of the goal categories."""


@dataclass(frozen=True, eq=False)
class MapPatch:
    """A square of the map around the robot, with the axes of the start frame; each cell is a block of map cells.

    Cells outside the map are empty.
    """

    frame: GridFrame
    """The grid of the patch."""
    obstacle: Bool[np.ndarray, "cells cells"]
    """True: an obstacle was seen in the block."""
    seen: Bool[np.ndarray, "cells cells"]
    """True: a part of the block was in view."""
    trail: Bool[np.ndarray, "cells cells"]
    """True: the robot's centre passed through the block."""
    goals: UInt32[np.ndarray, "cells cells"]
    """Bit g is set where goal category g of `GOAL_CATEGORIES` was seen."""
    robot: tuple[int, int]
    """Row and column of the robot's centre."""

    def channels(self, order: Sequence[int] | None = None) -> UInt8[np.ndarray, "channels cells cells"]:
        """Returns the patch as images of 0 and 1: one for each of `LAYERS`, then one for each goal category.

        Args:
            order: the goal category that each channel shows, a permutation of their indices; by default their order.
        """
        goals = np.arange(len(GOAL_CATEGORIES)) if order is None else np.asarray(order)
        channels = np.zeros((len(LAYERS) + goals.size, *self.frame.shape), np.uint8)
        channels[0], channels[1], channels[2] = self.obstacle, self.seen, self.trail
        channels[3][self.robot] = 1
        np.bitwise_and(self.goals >> goals.astype(np.uint32)[:, None, None], 1, out=channels[4:], casting="unsafe")
        return channels


def patch_around(navmap: NavMap, pose: Pose, *, cells: int, pool: int) -> MapPatch:
    """Returns the square of `cells` x `cells` blocks of `pool` x `pool` map cells around the robot.

    The blocks are aligned with the map, so that a wall does not move between them when the robot does.
    """
    frame = navmap.frame
    row, col = (index // pool - cells // 2 for index in frame.cell(pose.x_m, pose.y_m))
    rows, cols = slice(row * pool, (row + cells) * pool), slice(col * pool, (col + cells) * pool)
    edge_m = pool * frame.cell_m
    coarse = GridFrame(
        origin_xy_m=(frame.origin_xy_m[0] + col * edge_m, frame.origin_xy_m[1] + row * edge_m),
        shape=(cells, cells),
        cell_m=edge_m,
    )

    def pooled(layer: NDArray) -> NDArray:
        return or_of_blocks(_cut(layer, rows, cols), pool)

    return MapPatch(
        frame=coarse,
        obstacle=pooled(navmap.seen_obstacle),
        seen=pooled(navmap.frames_in_view) != 0,
        trail=pooled(navmap.trail),
        goals=pooled(navmap.goals_seen),
        robot=coarse.cell(pose.x_m, pose.y_m),
    )


def or_of_blocks(layer: NDArray, pool: int) -> NDArray:
    """Returns the bitwise or of each block of `pool` x `pool` cells of a layer; a last block may be incomplete."""
    missing = [-size % pool for size in layer.shape]
    if any(missing):
        layer = np.pad(layer, [(0, count) for count in missing])
    part = functools.reduce(np.bitwise_or, (layer[row::pool] for row in range(pool)))  # 10 x as fast as ufunc.reduce
    return functools.reduce(np.bitwise_or, (part[:, col::pool] for col in range(pool)))


def _cut(layer: NDArray, rows: slice, cols: slice) -> NDArray:
    """Returns a rectangle of a layer; cells beyond the layer are 0."""
    inside = tuple(slice(max(cut.start, 0), min(cut.stop, n)) for cut, n in zip((rows, cols), layer.shape, strict=True))
    if inside == (rows, cols):
        return layer[rows, cols]
    whole = np.zeros((rows.stop - rows.start, cols.stop - cols.start), layer.dtype)
    part = tuple(
        slice(cut.start - wish.start, max(cut.stop - wish.start, cut.start - wish.start))
        for cut, wish in zip(inside, (rows, cols), strict=True)
    )
    whole[part] = layer[inside]
    return whole
