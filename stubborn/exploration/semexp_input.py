"""The input of the global policy of `semexp`, as its published code makes it, in episodes and in training.

The policy gets two squares of the map with the axes of the start frame: the local map, 12 m around the robot, and the
global map, 24 m around the start. The published network begins with a max-pooling of 2 x 2 cells of 5 cm, which is
done here, so that an input has a quarter of the size.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int32, UInt8

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES
from stubborn.exploration.patches import MapPatch, patch_around
from stubborn.mapping.navmap import NavMap

GEOMETRY = ("obstacle", "seen", "robot", "trail")
"""The layers of the local map in their published order; those of the global map follow."""
CELLS = 120
"""Edge of both maps after the max-pooling: cells of 10 cm in the local one, of 20 cm in the global one."""
HEADINGS = 72
"""Number of headings, 5 degrees each."""
GIBSON = ("chair", "sofa", "plant", "bed", "toilet", "tv_monitor", "table", None, "sink", *[None] * 7)
"""The categories of the published network's semantic channels, by our names; None: no goal category."""
_LOCAL_POOL, _GLOBAL_POOL = 2, 4
"""Map cells of 5 cm along the edge of a cell."""


@dataclass(frozen=True, eq=False)
class PolicyInput:
    """The input of the policy at one step; each number of a map is a set of bits."""

    geometry: UInt8[np.ndarray, "cells cells"]
    """Bit i is set where layer i is: those of `GEOMETRY` in the local map, then in the global map."""
    goals: Int32[np.ndarray, "cells cells"]
    """Bit c is set where the category of channel c was seen, in the local map. Its 21 bits fit into a float32."""
    heading: int
    """The heading plus 180 degrees in steps of 5 degrees, rounded: turns of 30 degrees are then never between two."""
    goal: int
    """The channel of the goal category."""
    frame: GridFrame
    """The grid of the local map."""

    def place_xy_m(self, share: Float[np.ndarray, " 2"]) -> tuple[float, float]:
        """Returns the point of the local map at these shares of its rows and columns, each from 0 to 1."""
        (x_m, y_m), edge_m = self.frame.origin_xy_m, self.frame.shape[0] * self.frame.cell_m
        return x_m + float(share[1]) * edge_m, y_m + float(share[0]) * edge_m


def observe(
    navmap: NavMap, pose: Pose, goal: int, channels: Sequence[str | None] = GOAL_CATEGORIES, *, cells: int = CELLS
) -> PolicyInput:
    """Returns the input of the policy for a map.

    Args:
        navmap: the map, with `goals_seen`.
        pose: pose of the robot in the map's frame.
        goal: the channel of the goal category that the policy gets.
        channels: the category that each semantic channel shows; None: the channel is empty.
        cells: edge of both maps.
    """
    near = patch_around(navmap, pose, cells=cells, pool=_LOCAL_POOL)
    far = patch_around(navmap, Pose(0.0, 0.0, 0.0), cells=cells, pool=_GLOBAL_POOL)
    layers = (*_geometry(near, pose), *_geometry(far, pose))
    shown = (
        (near.goals >> GOAL_CATEGORIES.index(name) & 1) << channel for channel, name in enumerate(channels) if name
    )
    goals = functools.reduce(np.bitwise_or, shown, np.zeros_like(near.goals)).astype(np.int32)
    return PolicyInput(
        geometry=functools.reduce(np.bitwise_or, (layer.view(np.uint8) << bit for bit, layer in enumerate(layers))),
        goals=goals,
        heading=round((math.degrees(pose.yaw_rad) + 180.0) / (360.0 / HEADINGS)) % HEADINGS,
        goal=goal,
        frame=near.frame,
    )


def _geometry(patch: MapPatch, pose: Pose) -> tuple[np.ndarray, ...]:
    """Returns the layers of `GEOMETRY`; the robot takes 3 x 3 cells, and none where it is outside of the patch."""
    robot = np.zeros(patch.frame.shape, np.bool_)
    row, col = patch.frame.cell(pose.x_m, pose.y_m)
    robot[max(row - 1, 0) : max(row + 2, 0), max(col - 1, 0) : max(col + 2, 0)] = True
    return patch.obstacle, patch.seen, robot, patch.trail
