"""Chooses frontiers by predicted potentials: how much area is behind each, and how near the goal object is.

Reference: Ramakrishnan et al. (2022), "PONI: Potential Functions for ObjectGoal Navigation with Interaction-free
Learning", CVPR, arXiv:2201.10029. The robot goes to the frontier with the highest weighted sum of its two potentials
(`stubborn.exploration.potentials`).

The published evaluation (github.com/srama2512/PONI, the scripts `eval_poni.sh`) has other rules: it predicts at every
step, and its goal is the cell with the highest mean of both potentials among all unexplored cells of the local map, on
Gibson without those within 1 m of the robot. Here only frontiers are candidates, on which the network was trained, and
the robot pursues one for up to `replan_steps`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from jaxtyping import Bool, Float32

from sim.core.geometry.fast_marching import travel_times
from sim.core.geometry.grid import GridFrame, Window, cells_near_segment
from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel, ConfigError
from stubborn.exploration.explorer import Exploration, Ground, Search
from stubborn.exploration.frontiers import Frontiers, require_margin, spend_around
from stubborn.exploration.places import MapCells
from stubborn.exploration.potentials import PotentialConfig, Potentials
from stubborn.mapping.masks import connected, large_parts
from stubborn.planning.planner import Goal

if TYPE_CHECKING:
    from stubborn.exploration.poni_net import Predictor

_MOVED_M = 0.05


@dataclass(frozen=True, kw_only=True)
class PoniConfig(PotentialConfig):
    """The potentials, their weights, and the rules by which a frontier is finished."""

    path_weight_per_m: float = 0.0
    """The score of a frontier falls by this for each metre of path to it; 0: as in the reference."""
    replan_steps: int = 25
    """The potentials are predicted again after this many steps, and when a frontier is finished."""
    piece_m: float = 1.0
    """The goal is the part of the frontier within this distance of its cell with the highest score."""
    least_length_m: float = 0.40
    """Shorter frontiers come last: the robot would hardly fit through."""
    own_known_m: float = 1.0
    """Ground within this distance of the trail counts as known (see `FrontierConfig.own_known_m`)."""
    detour_m: float = 2.0
    """A frontier is given up when the path to it becomes this much longer than it was: a wall came into view."""
    stalled_steps: int = 10
    """A frontier is given up when the robot has not moved for this many steps: its path is blocked."""
    arrived_m: float = 0.35
    """A frontier counts as reached within this path length."""
    spent_m: float = 0.60
    """Within this distance of a place where a frontier was reached, no cell counts as a frontier any more."""
    margin_cells: int = 20
    """Margin around the known part of the map within which paths may run."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.piece_m <= 0.0:
            raise ConfigError(f"PoniConfig.piece_m must be > 0 m, got {self.piece_m}.")
        if self.path_weight_per_m < 0.0:
            raise ConfigError(f"PoniConfig.path_weight_per_m must be >= 0, got {self.path_weight_per_m}.")
        if min(self.replan_steps, self.stalled_steps) < 1:
            raise ConfigError(
                f"PoniConfig needs replan_steps and stalled_steps >= 1, got {self.replan_steps} and "
                f"{self.stalled_steps}."
            )
        require_margin("PoniConfig", self.arrived_m, self.spent_m)

    def make(self, camera: CameraModel) -> PoniExplorer:
        """Returns a new explorer with these parameters.

        Raises:
            ConfigError: the weights do not exist or are of another network.
        """
        return PoniExplorer(self, self.predictor())


class PoniExplorer:
    """Goes to the frontier with the highest predicted potential, and pursues it for some steps."""

    reads_semantics: Literal[True] = True

    def __init__(self, config: PoniConfig, predictor: Predictor) -> None:
        self.config = config
        self.potentials = Potentials(config, predictor)
        self.reset()

    def reset(self, seed: int = 0) -> None:
        """Forgets the last episode; the random choices of the controls come from `seed`."""
        self.potentials.reset(seed)
        self._goal: MapCells | None = None
        self._age_steps = 0
        self._path_m = 0.0
        self._still_steps = 0
        self._last_pose: Pose | None = None
        self._spent = np.zeros((0, 0), np.bool_)  # on the whole map; made at the first step of an episode

    def explore(self, ground: Ground) -> Exploration:
        """Returns the route to the pursued frontier, else to the best, else to ground far from the trail."""
        if self._spent.size == 0:
            self._spent = np.zeros(ground.navmap.frame.shape, np.bool_)
        config = self.config
        known = Frontiers.of(ground, own_known_m=config.own_known_m, margin_cells=config.margin_cells)
        return (
            (yield from self._go_on(known, ground.pose))
            or (yield from self._to_best(known, ground))
            or (yield from known.to_least_visited(config.arrived_m))
        )

    def _go_on(self, known: Frontiers, pose: Pose) -> Search:
        """Returns the route to the rest of the pursued frontier; None when it is finished, or after some steps."""
        self._age_steps += 1
        moved = self._last_pose is None or pose.distance_to(self._last_pose) > _MOVED_M
        self._still_steps = 0 if moved else self._still_steps + 1
        self._last_pose = pose
        if self._goal is not None and self._still_steps >= self.config.stalled_steps:
            self._spent[self._goal.rows, self._goal.cols] = True
            self._goal, self._still_steps = None, 0
        if self._goal is None or self._age_steps > self.config.replan_steps:
            return None
        open_cells = known.cells & ~self._spent[known.window.index]
        route = yield Goal(known.free, self._goal.within(known.window) & open_cells)
        if route is not None and route.length_m <= self.config.arrived_m:
            self._spend(known.window, pose)
            return None
        if route is not None and route.length_m > self._path_m + self.config.detour_m:
            return None
        self._path_m = self._path_m if route is None else min(self._path_m, route.length_m)
        return route

    def _to_best(self, known: Frontiers, ground: Ground) -> Search:
        """Returns the route to the open frontier with the highest score: a long one, else any; None without any."""
        spent, score = self._spent[known.window.index], None
        for least_m in (self.config.least_length_m, 0.0):
            while (cells := large_parts(known.cells & ~spent, least_m / known.free.frame.cell_m)).any():
                score = self._score(known, ground) if score is None else score
                piece = self._best_piece(known.free.frame, cells, score)
                route = yield Goal(known.free, piece)
                if route is None:
                    spent |= piece
                elif route.length_m <= self.config.arrived_m:  # the robot is already there
                    self._spend(known.window, ground.pose)
                else:
                    self._goal, self._age_steps = MapCells.of(piece, known.window), 0
                    self._path_m = route.length_m
                    return route
        self._goal = None
        return None

    def _score(self, known: Frontiers, ground: Ground) -> Float32[np.ndarray, "rows cols"]:
        """Returns the score of each frontier cell: its potential less the cost of the path to it; -inf elsewhere."""
        frame, pose = known.free.frame, ground.pose
        score = self.potentials.of(ground, frame, known.cells)
        if self.config.path_weight_per_m > 0.0:
            here = np.zeros(frame.shape, np.bool_)
            here[frame.cell(pose.x_m, pose.y_m)] = True
            path_m = travel_times(here, known.free.reachable, known.free.speed, frame.cell_m)
            score[known.cells] -= np.float32(self.config.path_weight_per_m) * path_m[known.cells]
        return score

    def _best_piece(
        self, frame: GridFrame, cells: Bool[np.ndarray, "rows cols"], score: Float32[np.ndarray, "rows cols"]
    ) -> Bool[np.ndarray, "rows cols"]:
        """Returns the cells that are connected to the one with the highest score and near it."""
        row, col = divmod(int(np.argmax(np.where(cells, score, -np.inf))), frame.shape[1])
        x_m, y_m = (float(value) for value in frame.centres(row, col))
        index, disc = cells_near_segment(frame, (x_m, y_m), (x_m, y_m), self.config.piece_m)
        piece = np.zeros_like(cells)
        piece[index] = disc
        return piece & connected(cells, row, col, connectivity=8)

    def _spend(self, window: Window, pose: Pose) -> None:
        """Closes the frontiers around the robot, because the robot has seen what they show."""
        spend_around(self._spent, window, pose, self.config.spent_m)
        self._goal = None
