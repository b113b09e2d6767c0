"""The map of the agent: named layers over the ground, on one grid."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from jaxtyping import Bool, Float32, Int8, Int32, UInt32

from sim.core.geometry.grid import GridFrame, Window

_LAYERS: Mapping[str, type] = MappingProxyType(
    {  # the widest types first, so that each layer is aligned
        **dict.fromkeys(("score_sum", "score_max", "other_max", "shown_x", "shown_y"), np.float32),
        **{"goals_seen": np.uint32, "frames_in_view": np.uint32, "found_step": np.int32},
        **dict.fromkeys(("obstacle_evidence", "drop_evidence"), np.int8),
        **dict.fromkeys(("seen_obstacle", "seen_at_eye_level", "pessimistic_marks", "optimistic_marks"), np.bool_),
        **dict.fromkeys(("visited", "trail", "rejected", "set_aside", "seen_drop"), np.bool_),
    }
)


class CollisionLayer(enum.Enum):
    """The collision marks that count as obstacles."""

    NONE = enum.auto()
    OPTIMISTIC = enum.auto()
    """The small marks, `NavMap.optimistic_marks`."""
    PESSIMISTIC = enum.auto()
    """The large marks, `NavMap.pessimistic_marks`."""


@dataclass
class NavMap:
    """The agent's map; every layer is on the grid `frame`. The paper's channel is in brackets.

    Unknown ground counts as free. The ground that was ever in view is where `frames_in_view` is not 0.
    """

    frame: GridFrame
    seen_obstacle: Bool[np.ndarray, "rows cols"]
    """True: depth saw a surface between step height and robot height [1]."""
    obstacle_evidence: Int8[np.ndarray, "rows cols"]
    """Evidence for an obstacle, from depth; `seen_obstacle` is True where there is enough of it."""
    seen_at_eye_level: Bool[np.ndarray, "rows cols"]
    """True: depth saw a surface at the camera's height: a wall or an object of this height."""
    drop_evidence: Int8[np.ndarray, "rows cols"]
    """Evidence that the floor is missing, from depth."""
    seen_drop: Bool[np.ndarray, "rows cols"]
    """True: depth saw through the plane of the floor, so that the robot would fall."""
    pessimistic_marks: Bool[np.ndarray, "rows cols"]
    """True: inside a 25 x 25 cm mark in front of a failed move, or on a surface that collisions suggest
    (`stubborn.mapping.felt`); the pessimistic map [2]."""
    optimistic_marks: Bool[np.ndarray, "rows cols"]
    """True: inside a 15 x 15 cm mark in front of a failed move, or on such a surface; the optimistic map [3]."""
    visited: Bool[np.ndarray, "rows cols"]
    """True: the robot's disc swept over this cell."""
    trail: Bool[np.ndarray, "rows cols"]
    """True: the robot's centre passed here, to a cell."""
    frames_in_view: UInt32[np.ndarray, "rows cols"]
    """Number of frames with a depth point in this cell, floor included [4]."""
    score_sum: Float32[np.ndarray, "rows cols"]
    """Sum over frames of the target's score; each frame adds its highest score in the cell [5]."""
    score_max: Float32[np.ndarray, "rows cols"]
    """Highest score of the target in any frame [6]."""
    other_max: Float32[np.ndarray, "rows cols"]
    """Highest score of any other category in any frame [7]."""
    found_step: Int32[np.ndarray, "rows cols"]
    """Step at which `score_max` made this cell a candidate; meaningful only for candidates."""
    shown_x: Float32[np.ndarray, "rows cols"]
    """Sum over frames of the unit vector from a target point to the robot's centre, x component: the side that was
    seen."""
    shown_y: Float32[np.ndarray, "rows cols"]
    """The y component of the same sum."""
    goals_seen: UInt32[np.ndarray, "rows cols"]
    """Bit g is set where goal category g of `sim.core.interface.GOAL_CATEGORIES` was seen; for explorers that read it
    (`stubborn.exploration.explorer.ReadsSemantics`), else 0."""
    rejected: Bool[np.ndarray, "rows cols"]
    """True: verification rejected a candidate here; it never counts again in this episode."""
    set_aside: Bool[np.ndarray, "rows cols"]
    """True: a candidate here could not be reached; it is tried again later."""
    known: tuple[slice, slice] | None = None
    """Rows and columns of a rectangle that holds all ground seen or driven over; None: no ground yet."""
    sided: bool = False
    """True: objects are remembered from an earlier goal, and the robot may be behind the wall on which one is mounted.
    What seems to be a clear view of it then counts only on the side that was seen, see `ViewpointFinder.in_sight`."""
    times_felt: int = 0
    """Number of collisions that changed the marks, where the agent draws conclusions from several
    (`stubborn.mapping.felt`); else 0."""

    @classmethod
    def empty(cls, frame: GridFrame) -> NavMap:
        """Returns a map on which nothing is known yet.

        The layers share one block of memory. A block of this size comes from the operating system and returns to it,
        and pages that are never written (most of the paper's 72 m) take no memory.
        """
        cells, layers, first = frame.shape[0] * frame.shape[1], {}, 0
        block = np.zeros(cells * sum(np.dtype(dtype).itemsize for dtype in _LAYERS.values()), np.uint8)
        for name, dtype in _LAYERS.items():
            last = first + cells * np.dtype(dtype).itemsize
            layers[name] = block[first:last].view(dtype).reshape(frame.shape)
            first = last
        return cls(frame=frame, **layers)

    def forget_goal(self) -> None:
        """Clears the layers that depend on the goal: its scores and the candidates; the ground stays known.

        `frames_in_view` counts anew from 1, so that means over frames are those of the new goal.
        """
        self.sided = True
        if self.known is None:
            return
        of_goal = ("score_sum", "score_max", "other_max", "found_step", "shown_x", "shown_y", "rejected", "set_aside")
        for name in of_goal:
            getattr(self, name)[self.known] = 0
        np.minimum(self.frames_in_view[self.known], 1, out=self.frames_in_view[self.known])

    def view(self, window: Window) -> NavMap:
        """Returns the part of the map in a window; its layers share memory with this map's."""
        index = window.index
        layers = {name: getattr(self, name)[index] for name in _LAYERS}
        return NavMap(frame=window.frame, sided=self.sided, **layers)

    def collision_marks(self, layer: CollisionLayer) -> Bool[np.ndarray, "rows cols"]:
        """Returns the marks of a collision layer; the mask of `CollisionLayer.NONE` is empty."""
        if layer is CollisionLayer.NONE:
            return np.zeros_like(self.seen_obstacle)
        return self.pessimistic_marks if layer is CollisionLayer.PESSIMISTIC else self.optimistic_marks

    def grow_known(self, rows: slice, cols: slice) -> None:
        """Extends the known rectangle by these rows and columns."""
        if self.known is not None:
            rows, cols = (
                slice(min(old.start, new.start), max(old.stop, new.stop))
                for old, new in zip(self.known, (rows, cols), strict=True)
            )
        self.known = rows, cols

    def known_window(self, margin_cells: int) -> Window:
        """Returns the known rectangle with a margin; the middle of the map when nothing is known."""
        middle = tuple(slice(n // 2, n // 2 + 1) for n in self.frame.shape)
        rows, cols = (
            slice(max(known.start - margin_cells, 0), known.stop + margin_cells) for known in self.known or middle
        )
        return self.frame.part(rows, cols)

    def seen_area_m2(self) -> float:
        """Returns the area of the ground that was ever in view."""
        seen = self.frames_in_view if self.known is None else self.frames_in_view[self.known]
        return float(np.count_nonzero(seen)) * self.frame.cell_m**2
