"""From a candidate to a decision: approach, verify, accept or reject (paper: Target Object Detection Module).

A stop counts where some point of the object is within 1 m of the robot *and* in free line of sight. So the way to a
candidate leads to a stand: a reachable cell near enough to a candidate cell, from which no wall hides it. What stands
as tall as the camera may be a wall; a table or a sofa between robot and object does not matter.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.geometry.grid import Window
from sim.geometry.pose import Pose
from sim.interface import ConfigError
from stubborn.exploration.corners import Route
from stubborn.mapping.mapper import Sighting
from stubborn.navmap import NavMap
from stubborn.planning.planner import Bumps, FreeSpace, Planner
from stubborn.raster import Cells, connected, distance_to, nearest, sight_is_clear
from stubborn.target.classifiers import Features
from stubborn.target.verification import Verifier


@dataclass(frozen=True, kw_only=True)
class TargetConfig:
    """Distances and steps of the approach."""

    candidate_score: float = 0.5
    """A cell with a higher target score is a candidate."""
    stop_in_view_m: float = 0.92
    """A target point in view within this distance ends the approach: it is near and nothing hides it."""
    stand_m: float = 0.85
    """A stand is this near a candidate cell: a metre, less what cells blur."""
    far_stand_m: float = 0.93
    """Where there is no such stand, this will do."""
    outline_margin_m: float = 0.25
    """So much nearer than `stop_in_view_m` and `stand_m` the agent goes, where it can, with a detector that errs: its
    outlines run over what stands beside the target."""
    last_resort_m: float = 1.6
    """Where there is no stand at all, a candidate is verified from the nearest reachable place within this distance;
    late in an episode the agent stops there, which is better than nothing."""
    last_resort_step: int = 420
    """From this step on it stops there."""
    rejection_margin_m: float = 0.25
    """Around rejected cells this much is rejected too."""
    verify_until_step: int = 200
    """A candidate first found later is not verified: no time is left to look elsewhere."""
    retry_after_steps: int = 15
    """A candidate that could not be reached is tried again after so many steps of exploring, then after twice as
    many, and so on."""
    margin_cells: int = 40
    """Ground around the known part of the map on which ways to a far candidate may run."""
    target_edge_m: float = 0.08
    """A wall this near the candidate cell is what the object hangs on, not what hides it."""

    def __post_init__(self) -> None:
        if not 0.0 < self.stand_m <= self.far_stand_m <= self.last_resort_m:
            raise ConfigError(
                "TargetConfig needs 0 < stand_m <= far_stand_m <= last_resort_m, "
                f"got {self.stand_m}, {self.far_stand_m} and {self.last_resort_m} m."
            )
        if not 0.0 <= self.outline_margin_m < min(self.stand_m, self.stop_in_view_m):
            raise ConfigError(
                "TargetConfig needs 0 <= outline_margin_m < stand_m and stop_in_view_m, "
                f"got {self.outline_margin_m}, {self.stand_m} and {self.stop_in_view_m} m."
            )


@dataclass(frozen=True)
class Approach:
    """The way to the nearest stand of the candidates that are pursued."""

    route: Route | None
    """None when the robot stands on one."""
    bearing_rad: float
    """World angle from the robot to its nearest candidate cell."""
    cell: tuple[int, int]
    """Row and column of that candidate cell on the whole map."""
    near_enough: bool = True
    """False: a stop there would not count; it is the place to verify from when no other can be reached."""


class TargetSeeker:
    """Finds candidates on the map, leads to them and judges them."""

    def __init__(
        self, config: TargetConfig, planner: Planner, verifier: Verifier, *, bumps: bool, true_outlines: bool = True
    ) -> None:
        """Without `true_outlines` it goes `outline_margin_m` nearer; without `bumps` no collision mark counts."""
        self.config = config
        margin_m = 0.0 if true_outlines else config.outline_margin_m
        self._stop_in_view_m = config.stop_in_view_m - margin_m
        self.planner = planner
        self.verifier = verifier
        maps: tuple[Bumps, ...] = (Bumps.PESSIMISTIC, Bumps.OPTIMISTIC) if bumps else (Bumps.NONE,)
        # How near a stand must be, and on which maps it may be reached. Nobody crosses marks to get nearer than usual.
        self._kinds_of_stands: list[tuple[float, tuple[Bumps, ...]]] = [
            (config.stand_m, maps),
            (config.far_stand_m, maps),
        ]
        if not true_outlines:
            self._kinds_of_stands.insert(0, (config.stand_m - margin_m, maps[:1]))
        self._last_map = maps[-1]
        self.reset("")

    def reset(self, goal: str) -> None:
        """Forget the last episode."""
        self.goal = goal
        self._retry_step = 0
        self._patience_steps = self.config.retry_after_steps
        self._far = False  # whether the candidate pursued needs more than the local window
        self._pursued: tuple[int, int] | None = None  # map cell of the likely candidate that is approached

    def candidates(self, view: NavMap) -> NDArray[np.bool_]:
        """Cells that look like the target and were neither rejected nor set aside."""
        return (view.score_max > self.config.candidate_score) & ~view.rejected & ~view.set_aside

    def likely(self, navmap: NavMap) -> NDArray[np.bool_]:
        """Cells of the whole map: candidates that the verifier would accept as far as they have been seen by now.

        Also the one that is pursued as such, as long as it is a candidate: else the goal could change with every look.
        That what is found late is not verified does not count here.
        """
        whole = navmap.known_window(margin_cells=self.config.margin_cells)
        view = navmap.view(whole)
        shown = view.score_max > self.config.candidate_score
        count, labels = cv2.connectedComponents(shown.view(np.uint8), connectivity=8)
        parts, cells = np.asarray(labels, np.intp), np.flatnonzero(shown)
        best_last = cells[np.argsort(view.score_sum[shown], kind="stable")]
        best = np.zeros(count, np.intp)
        best[parts.ravel()[best_last]] = best_last
        would = [self.verifier.would_accept(self.goal, features_of(view, flat)) for flat in best[1:].tolist()]
        accepted = np.array([False, *would])
        if self._pursued is not None:
            row, col = self._pursued
            accepted[parts[row - whole.rows.start, col - whole.cols.start]] = True
            accepted[0] = False  # part 0 is the background
        likely = np.zeros(navmap.frame.shape, np.bool_)
        likely[whole.rows, whole.cols] = accepted[parts] & self.candidates(view)
        return likely

    def in_reach(self, navmap: NavMap, sighting: Sighting) -> tuple[int, int] | None:
        """Map cell of the nearest target point in this very frame, when it is near enough to stop."""
        if sighting.nearest_m(navmap) > self._stop_in_view_m:
            return None
        counts = ~navmap.rejected[sighting.rows, sighting.cols]
        nearest = int(np.argmin(np.where(counts, sighting.distance_m, np.inf)))
        return int(sighting.rows[nearest]), int(sighting.cols[nearest])

    def approach(self, navmap: NavMap, window: Window, pose: Pose, step: int) -> Approach | None:
        """The way to the nearest stand of a likely candidate, else of any; None when none can be reached now."""
        whole = navmap.known_window(margin_cells=self.config.margin_cells)
        if step >= self._retry_step:
            navmap.view(whole).set_aside[:] = False
        if not self.candidates(navmap.view(whole)).any():
            self._far, self._pursued = False, None
            return None
        late = step >= self.config.last_resort_step
        for part, candidates, anywhere, is_likely in self._choices(navmap, window, whole, late=late):
            if not candidates.any():
                continue
            found = self._approach_on(navmap.view(part), candidates, pose, late=late, anywhere=anywhere)
            if found is not None:
                row, col = found.cell[0] + part.rows.start, found.cell[1] + part.cols.start
                self._far = part is whole
                self._pursued = (row, col) if is_likely else None
                return replace(found, cell=(row, col))
        self.postpone(navmap, step)
        return None

    def postpone(self, navmap: NavMap, step: int) -> None:
        """Set all candidates aside: they cannot be reached from what is known now."""
        view = navmap.view(navmap.known_window(margin_cells=self.config.margin_cells))
        view.set_aside[self.candidates(view)] = True
        self._far, self._pursued = False, None
        self._retry_step = step + self._patience_steps
        self._patience_steps *= 2

    def judge(self, navmap: NavMap, cell: tuple[int, int]) -> bool:
        """Verify the candidate at a map cell; a rejected one never counts again in this episode."""
        whole = navmap.known_window(margin_cells=self.config.margin_cells)
        view = navmap.view(whole)
        row, col = cell[0] - whole.rows.start, cell[1] - whole.cols.start
        instance = connected(view.score_max > self.config.candidate_score, row, col, connectivity=8)
        # Its edge, which is nearest, shares its cells with what is around it; the cell seen best speaks for the whole.
        features = features_of(view, int(np.argmax(np.where(instance, view.score_sum, -1.0))))
        found_late = bool((view.found_step[instance] > self.config.verify_until_step).all())
        if found_late or self.verifier.accepts(self.goal, features):
            return True
        margin_cells = self.config.rejection_margin_m / navmap.frame.cell_m
        view.rejected[distance_to(instance) <= margin_cells + 1e-3] = True
        return False

    def _choices(
        self, navmap: NavMap, window: Window, whole: Window, *, late: bool
    ) -> Iterator[tuple[Window, NDArray[np.bool_], bool, bool]]:
        """Candidates to try, in this order: the part of the map, cells of it, whether a last resort will do, and whether
        these are the likely ones. For those it never will: doubtful ones that can be got near come before it.
        """
        # A way that needs the whole map is kept on the whole map: else each step could choose another one.
        parts = (whole,) if self._far else (window, whole)
        if self.verifier.may_refuse:
            likely = self.likely(navmap)
            for part in parts:
                yield part, likely[part.rows, part.cols], False, True
        for part in parts:
            yield part, self.candidates(navmap.view(part)), late or (part is whole and self.verifier.may_refuse), False

    def _approach_on(
        self, view: NavMap, candidates: NDArray[np.bool_], pose: Pose, *, late: bool, anywhere: bool
    ) -> Approach | None:
        """The way to the nearest stand of these candidates on one part of the map; the cell is counted in that part.

        `anywhere` takes the nearest reachable place where there is no stand; `late` holds that to be near enough.
        """
        gap_cells, nearest_row, nearest_col = nearest(candidates)
        gap_m = gap_cells * np.float32(view.frame.cell_m)
        here = view.frame.cell(pose.x_m, pose.y_m)
        cell = int(nearest_row[here]), int(nearest_col[here])
        x_m, y_m = view.frame.centres(*cell)
        bearing_rad = math.atan2(float(y_m) - pose.y_m, float(x_m) - pose.x_m)
        for free, stands, is_stand in self._stands(view, pose, gap_m, (nearest_row, nearest_col), anywhere=anywhere):
            if stands[here]:
                return Approach(None, bearing_rad, cell, is_stand or late)
            plan = self.planner.plan(free, stands, pose)
            if plan is not None:
                return Approach(Route(plan, free), bearing_rad, cell, is_stand or late)
        return None

    def _stands(
        self,
        view: NavMap,
        pose: Pose,
        gap_m: NDArray[np.float32],
        ends: Cells,
        *,
        anywhere: bool,
    ) -> Iterator[tuple[FreeSpace, NDArray[np.bool_], bool]]:
        """Reachable cells to stop on, from the best kind to the last resort, and whether they are more than that."""
        edge_cells = self.config.target_edge_m / view.frame.cell_m
        rows, cols = np.nonzero(gap_m <= self.config.far_stand_m)
        seen = ends[0][rows, cols], ends[1][rows, cols]
        in_sight = np.zeros_like(view.rejected)
        in_sight[rows, cols] = sight_is_clear(view.seen_at_eye_level, (rows, cols), seen, edge_cells)
        # What hangs on a wall hides that wall: behind it there may seem to be free ground, on which it cannot be seen.
        shown = (rows - seen[0]) * view.shown_y[seen] + (cols - seen[1]) * view.shown_x[seen]
        in_sight[rows, cols] &= (shown > 0) | (view.frames_in_view[rows, cols] > 0)
        unseen = self.planner.unseen(view)
        free_spaces: dict[Bumps, FreeSpace] = {}
        for within_m, maps in self._kinds_of_stands:
            for bumps in maps:
                if bumps not in free_spaces:
                    free_spaces[bumps] = self.planner.free_space(view, pose, bumps, unseen)
                stands = free_spaces[bumps].reachable & in_sight & (gap_m <= within_m)
                if stands.any():
                    yield free_spaces[bumps], stands, True
        if anywhere:
            free = free_spaces[self._last_map]
            reach_m = np.where(free.reachable, gap_m, np.inf)
            if reach_m.min() <= self.config.last_resort_m:
                # The robot's own ground is free to it and moves with it: without a margin it would push on for ever.
                margin_m = self.planner.config.own_ground_m + view.frame.cell_m
                yield free, reach_m <= reach_m.min() + margin_m, False


def features_of(view: NavMap, flat: int) -> Features:
    """What the object layers hold at a cell of a map, counted in row-major order."""
    at = divmod(flat, view.score_sum.shape[1])
    return Features(
        int(view.frames_in_view[at]),
        float(view.score_sum[at]),
        float(view.score_max[at]),
        float(view.other_max[at]),
    )
