"""The input of the global policy of `semexp`, and the places that it can choose, in episodes and in training.

The policy gets two squares around the robot, the local window at a fine resolution and a larger part of the map at a
coarse one, both with the axes of the start frame. It chooses a cell of a coarse grid over the local window.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Int32, UInt8

from sim.geometry.grid import GridFrame
from sim.geometry.pose import Pose
from sim.interface import GOAL_CATEGORIES, ConfigError
from stubborn.exploration.frontiers import frontier_cells
from stubborn.exploration.patches import MapPatch, or_of_blocks, patch_around
from stubborn.mapping.navmap import NavMap

GEOMETRY = ("obstacle", "seen", "trail", "frontier")
"""The layers of `Square.geometry`, bit by bit: those of `MapPatch`, and the free cells next to a cell that was never
seen. The robot has no layer: it is always in the middle."""
_BLOCK = 4
"""Cells along the edge of a block. A goal cell of the local square is such a block, and so is a cell of
`Square.goals`."""


@dataclass(frozen=True, kw_only=True)
class ViewConfig:
    """Sizes of the squares that the policy gets. Weights fit only the sizes that they were trained with."""

    goal_cells: int = 15
    """Edge of the grid of long-term goals over the local square; both squares have four times as many cells."""
    local_pool: int = 4
    """Map cells along the edge of a cell of the local square: 20 cm, 12 m in all."""
    global_pool: int = 16
    """The same for the global square: 80 cm, 48 m in all."""

    def __post_init__(self) -> None:
        if min(self.local_pool, self.global_pool, self.goal_cells) < 1 or self.global_pool % self.local_pool:
            raise ConfigError(
                "ViewConfig needs sizes >= 1 and a global_pool that local_pool divides, got goal_cells "
                f"{self.goal_cells}, local_pool {self.local_pool} and global_pool {self.global_pool}."
            )

    @property
    def cells(self) -> int:
        """Edge of both squares."""
        return _BLOCK * self.goal_cells


class Square(NamedTuple):
    """A square of the map around the robot; each number is a set of bits."""

    geometry: UInt8[np.ndarray, "cells cells"]
    """Bit i is set where the layer `GEOMETRY[i]` is."""
    goals: Int32[np.ndarray, "blocks blocks"]
    """Bit g is set where goal category g was seen in a block of 4 x 4 cells. Its 21 bits fit into a float32."""


@dataclass(frozen=True, eq=False)
class PolicyInput:
    """The input of the policy at one step."""

    near: Square
    """The local square."""
    far: Square
    """The global square."""
    heading: Float32[np.ndarray, " 2"]
    """Cosine and sine of the heading."""
    goal: int
    """Index of the goal category in `GOAL_CATEGORIES`."""
    frame: GridFrame
    """The grid of long-term goals."""

    def place_xy_m(self, choice: int) -> tuple[float, float]:
        """Returns the middle of the goal cell with this row-major number."""
        x_m, y_m = self.frame.centres(*divmod(choice, self.frame.shape[1]))
        return float(x_m), float(y_m)


def observe(
    navmap: NavMap,
    pose: Pose,
    goal: str,
    view: ViewConfig,
    *,
    order: Sequence[int] | None = None,
    semantics: bool = True,
) -> PolicyInput:
    """Returns the input of the policy for a map.

    Args:
        navmap: the map, with `goals_seen`.
        pose: pose of the robot in the map's frame.
        goal: the goal category that the policy gets.
        view: sizes of the squares.
        order: the goal category that each bit shows; by default bit g shows category g.
        semantics: False: no category is shown anywhere.
    """
    pools = (view.local_pool, view.global_pool)
    near, far = (patch_around(navmap, pose, cells=view.cells, pool=pool) for pool in pools)
    edge_m = near.frame.cell_m * _BLOCK
    return PolicyInput(
        near=_square(near, order, semantics),
        far=_square(far, order, semantics),
        heading=np.array([math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)], np.float32),
        goal=GOAL_CATEGORIES.index(goal),
        frame=GridFrame(origin_xy_m=near.frame.origin_xy_m, shape=(view.goal_cells, view.goal_cells), cell_m=edge_m),
    )


def _square(patch: MapPatch, order: Sequence[int] | None, semantics: bool) -> Square:
    """Returns the layers of a patch as bits."""
    frontier = frontier_cells(patch.seen & ~patch.obstacle, ~patch.seen)
    layers = (
        layer.view(np.uint8) << bit for bit, layer in enumerate((patch.obstacle, patch.seen, patch.trail, frontier))
    )
    goals = or_of_blocks(patch.goals, _BLOCK).astype(np.int32) if semantics else None
    if goals is None:
        shown = np.zeros((patch.frame.shape[0] // _BLOCK,) * 2, np.int32)
    elif order is None:
        shown = goals
    else:
        shown = functools.reduce(np.bitwise_or, ((goals >> g & 1) << bit for bit, g in enumerate(order)))
    return Square(functools.reduce(np.bitwise_or, layers), shown)
