"""Input of the cloned policy for one step: a small depth and category image, its own motion, and the goal."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Int, UInt8

from sim.core.geometry.pose import Pose, wrap_angle
from sim.core.interface import FORWARD_M, GOAL_CATEGORIES, MAX_STEPS, MOVES, MPCAT40, MPCAT40_ID, TURN_RAD, Action

WIDTH_PX, HEIGHT_PX = 64, 48
LEVELS = 255
"""Measured depth has the levels 1 to 255, in equal steps up to `FAR_M`; 0: no depth."""
FAR_M = 5.0
MOTION = ("ahead", "left", "cos", "sin", "moved ahead", "moved left", "turned", "steps done")
"""Position (in units of 10 m) and heading relative to the start; the last motion in units of the commanded motion; the
share of the steps that were made."""
NO_ACTION = len(MOVES)
"""Value for the missing action before the first one."""
GOAL_IDS = np.array([MPCAT40_ID[name] for name in GOAL_CATEGORIES], np.uint8)
"""The mpcat40 id of each goal category."""
_MIRRORED = np.array([Action.STOP, Action.MOVE_FORWARD, Action.TURN_RIGHT, Action.TURN_LEFT, NO_ACTION], np.uint8)
_SIGNS = np.array([1, -1, 1, -1, 1, -1, -1, 1], np.float32)


@dataclass(frozen=True, eq=False)
class Steps:
    """The input of n steps of one episode."""

    depth: UInt8[np.ndarray, "n h w"]
    categories: UInt8[np.ndarray, "n h w"]
    """mpcat40 ids; 0 is unknown."""
    motion: Float32[np.ndarray, "n motion"]
    """The numbers that `MOTION` names."""
    before: UInt8[np.ndarray, " n"]
    """The action before each step; `NO_ACTION` before the first."""
    goal: int
    """Index of the goal category."""

    def mirrored(self) -> Steps:
        """Returns the same episode in the house mirrored left to right."""
        return Steps(
            self.depth[:, :, ::-1],
            self.categories[:, :, ::-1],
            self.motion * _SIGNS,
            _MIRRORED[self.before],
            self.goal,
        )


def mirrored_actions(actions: UInt8[np.ndarray, " n"]) -> UInt8[np.ndarray, " n"]:
    """Returns the actions in the house mirrored left to right."""
    return _MIRRORED[actions]


def depth_levels(depth_m: Float32[np.ndarray, "*shape"]) -> UInt8[np.ndarray, "*shape"]:
    """Returns the level of each depth in metres; 0 where depth is missing."""
    levels = np.ceil(depth_m * (LEVELS / FAR_M))
    return np.clip(levels, 0, LEVELS).astype(np.uint8)


def small_depth(depth_m: Float32[np.ndarray, "h w"]) -> UInt8[np.ndarray, "48 64"]:
    """Returns the levels of the pixels nearest to the middles of the blocks of a small image."""
    return depth_levels(depth_m[_middles(depth_m.shape[0], HEIGHT_PX)[:, None], _middles(depth_m.shape[1], WIDTH_PX)])


def small_categories(posteriors: Float32[np.ndarray, "categories h w"]) -> UInt8[np.ndarray, "48 64"]:
    """Returns the most probable id of each block of a small image; 0 where nothing is known of it."""
    rows, columns = _middles(posteriors.shape[1], HEIGHT_PX), _middles(posteriors.shape[2], WIDTH_PX)
    blocks = posteriors[:, rows[:, None], columns]
    ids = np.argmax(blocks, axis=0).astype(np.uint8) + 1
    ids[blocks.max(axis=0) <= 0.0] = 0
    assert ids.max() < len(MPCAT40)
    return ids


def motion_of(pose: Pose, earlier: Pose | None, step: int) -> Float32[np.ndarray, " motion"]:
    """Returns the numbers that `MOTION` names.

    Args:
        pose: relative to the start pose.
        earlier: pose one step earlier; None at the start.
        step: number of actions so far.
    """
    moved = (0.0, 0.0, 0.0)
    if earlier is not None:
        last = pose.relative_to(earlier)
        moved = (last.x_m / FORWARD_M, last.y_m / FORWARD_M, wrap_angle(last.yaw_rad) / TURN_RAD)
    place = (pose.x_m / 10.0, pose.y_m / 10.0, math.cos(pose.yaw_rad), math.sin(pose.yaw_rad))
    return np.array([*place, *moved, step / MAX_STEPS], np.float32)


def motions(poses: Float32[np.ndarray, "n 3"]) -> Float32[np.ndarray, "n motion"]:
    """Returns the numbers that `MOTION` names, for each pose of an episode (metres and radians, from its start)."""
    path = [Pose(*(float(value) for value in row)) for row in poses]
    rows = [motion_of(pose, path[step - 1] if step else None, step) for step, pose in enumerate(path)]
    return np.array(rows, np.float32).reshape(-1, len(MOTION))


def _middles(size: int, parts: int) -> Int[np.ndarray, " parts"]:
    """Returns the middle pixel of each of `parts` equal parts of an axis."""
    return ((np.arange(parts) + 0.5) * size / parts).astype(np.intp)
