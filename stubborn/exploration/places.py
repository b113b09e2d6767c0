"""Destinations that an explorer pursues over many steps, and the turns on the spot when it arrives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Int

from sim.core.geometry.grid import Window
from sim.core.interface import Action
from stubborn.exploration.explorer import Ground, Search
from stubborn.planning.planner import Goal


@dataclass(frozen=True)
class MapCells:
    """Some cells of the whole map."""

    rows: Int[np.ndarray, " n"]
    cols: Int[np.ndarray, " n"]

    @classmethod
    def of(cls, mask: Bool[np.ndarray, "rows cols"], window: Window) -> MapCells:
        """Returns the cells of a mask over a window."""
        rows, cols = np.nonzero(mask)
        return cls(rows + window.rows.start, cols + window.cols.start)

    def within(self, window: Window) -> Bool[np.ndarray, "rows cols"]:
        """Returns the mask of those cells that lie in a window."""
        mask = np.zeros(window.frame.shape, np.bool_)
        rows, cols = self.rows - window.rows.start, self.cols - window.cols.start
        inside = window.frame.contains(rows, cols)
        mask[rows[inside], cols[inside]] = True
        return mask


@dataclass(frozen=True)
class Place:
    """A place to go to; it is enough to reach any of its cells."""

    cells: MapCells
    margin_cells: int
    """Margin around the known part of the map within which the route may run."""
    arrived_m: float
    """The place counts as reached within this path length."""

    def head_for(self, ground: Ground) -> Search:
        """Returns the route to the place; None when it has been reached, or can no longer be reached."""
        known = ground.navmap.known_window(self.margin_cells)
        free = ground.free_space(known, costly=ground.unseen(known))
        route = yield Goal(free, self.cells.within(known))
        return None if route is None or route.length_m <= self.arrived_m else route


class LookAround:
    """Turns on the spot that show the surroundings."""

    def __init__(self, turns: int) -> None:
        self.turns = turns
        """Number of turns of 30 degrees; 11 turns show all surroundings."""
        self.begin()

    def begin(self) -> None:
        """Starts the turns from the first one."""
        self._left = self.turns

    def next_turn(self) -> Action | None:
        """Returns the next turn, or None when all turns were made."""
        if self._left == 0:
            return None
        self._left -= 1
        return Action.TURN_LEFT
