"""Approaches and verifies candidates, and accepts or rejects them (paper: Target Object Detection Module)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool

from sim.core.geometry.grid import Window
from sim.core.geometry.pose import Pose
from sim.core.interface import MAX_STEPS, CameraModel, Observation, RobotModel, Segmenter
from stubborn.detection.approach import Approach, approach_on, on_map
from stubborn.detection.candidates import CandidateParts
from stubborn.detection.classifiers import Features
from stubborn.detection.distances import StopDistances, TargetConfig
from stubborn.detection.verification import AcceptAll, RatesCandidates, Verifier
from stubborn.detection.viewpoints import LastResort, ViewpointFinder
from stubborn.detection.wished import WishedSegmenter
from stubborn.mapping.mapper import Sighting
from stubborn.mapping.masks import distance_to
from stubborn.mapping.navmap import CollisionLayer, NavMap
from stubborn.planning.planner import Planner


class Seeker(Protocol):
    """Decides on candidates of the goal: which one to approach, and when to stop."""

    confidence: float | None
    """Probability or score in [0, 1] of the candidate that `judge` last accepted; None: no candidate was accepted."""
    accepted_cell: tuple[int, int] | None
    """Map cell where that candidate scores highest; its other cells may show neighbouring objects."""

    def reset(self, goal: str) -> None:
        """Forgets the last episode."""
        ...

    def next_goal(self, goal: str) -> None:
        """Starts with another goal in the same episode; what it knows about objects stays known."""
        ...

    def observe(self, navmap: NavMap, observation: Observation, pose: Pose, step: int) -> None:
        """Learns from a frame that has been entered into the map."""
        ...

    def in_reach(self, navmap: NavMap, sighting: Sighting) -> tuple[int, int] | None:
        """Returns the map cell of a candidate in the current frame that is near enough to stop, or None."""
        ...

    def approach(self, navmap: NavMap, window: Window, pose: Pose, step: int) -> Approach | None:
        """Returns the approach to a candidate; None: the agent should explore."""
        ...

    def judge(self, navmap: NavMap, cell: tuple[int, int]) -> bool:
        """Returns whether the candidate at a map cell, at which the robot looks, is the goal."""
        ...

    def refuse(self, navmap: NavMap) -> None:
        """Rejects the candidate that `judge` accepted last: another judge takes it for something else."""
        ...

    def one_more_forward(self, navmap: NavMap, approach: Approach, pose: Pose) -> bool:
        """Returns whether to go one forward nearer before the STOP at an accepted candidate that the robot faces."""
        ...

    def postpone(self, navmap: NavMap, step: int) -> None:
        """Sets aside the approached candidates: they cannot be reached on the current map."""
        ...

    def retry(self) -> None:
        """Ends the waiting times of candidates: nothing new was seen for long, and collision marks were removed."""
        ...


@dataclass(frozen=True, kw_only=True)
class SeekerParts:
    """The parts that an agent gives to its seeker."""

    camera: CameraModel
    robot: RobotModel
    segmenter: Segmenter
    planner: Planner
    layers: tuple[CollisionLayer, ...]
    """Collision layers to plan on, in order of preference."""
    target: TargetConfig
    """Distances and steps of the approach."""
    distances: StopDistances
    verifier: Verifier
    """Judges candidates by the paper's features; a seeker need not use it."""
    candidate_score: float
    """Cells with a higher score of the target are candidates."""
    max_steps: int
    """Actions of an episode."""
    wished: WishedSegmenter | None = None
    """The segmenter without levelling, which knows the wish of a goal in words."""


@runtime_checkable
class SeekerConfig(Protocol):
    """A frozen dataclass with the parameters of a seeker."""

    def make(self, parts: SeekerParts) -> Seeker:
        """Returns a new seeker with these parameters."""
        ...


@dataclass(frozen=True, kw_only=True)
class TargetSeekerConfig:
    """The paper's seeker."""

    verify: bool = True
    """False: every candidate is accepted, as by the paper's Single-Frame (Table "ObjIDResults")."""

    def make(self, parts: SeekerParts) -> TargetSeeker:
        """Returns a new seeker with these parameters."""
        return TargetSeeker(
            parts.target,
            parts.planner,
            parts.verifier if self.verify else AcceptAll(),
            layers=parts.layers,
            distances=parts.distances,
            candidate_score=parts.candidate_score,
            least_cells=1 if parts.segmenter.spec.exact_outlines else parts.target.least_cells,
            max_steps=parts.max_steps,
        )


@dataclass(frozen=True)
class _Choice:
    """Some candidates on a part of the map."""

    part: Window
    candidates: Bool[np.ndarray, "rows cols"]
    """A mask over the part."""
    last_resort: LastResort
    acceptable: bool
    """True: they are those that the verifier would accept now."""


class TargetSeeker:
    """The paper's `Seeker`: it finds candidates on the map, plans to them and verifies them by their object layers."""

    def __init__(
        self,
        config: TargetConfig,
        planner: Planner,
        verifier: Verifier,
        *,
        layers: tuple[CollisionLayer, ...],
        distances: StopDistances,
        candidate_score: float,
        least_cells: int = 1,
        max_steps: int = MAX_STEPS,
    ) -> None:
        """`layers` are the collision layers to plan on, in order of preference.

        Connected cells with a target score higher than `candidate_score` form a candidate if there are at least
        `least_cells` of them. `max_steps` is the number of actions of an episode.
        """
        self.config = config
        self._last_resort_step = config.last_resort_from(max_steps)
        self.candidate_score = candidate_score
        self.least_cells = least_cells
        self.planner = planner
        self.verifier = verifier
        self.distances = distances
        self._viewpoints = ViewpointFinder(planner, layers, distances, config.target_edge_m)
        self.reset("")

    def reset(self, goal: str) -> None:
        """Forgets the last episode."""
        self.goal = goal
        self._retry_step = 0
        self._wait_steps = self.config.retry_after_steps
        self.confidence: float | None = None
        """See `Seeker`: the verifier's probability, or the candidate's highest score if it has none."""
        self.accepted_cell: tuple[int, int] | None = None
        """See `Seeker`: the cell that is verified."""
        self._far = False  # whether the pursued candidate needs more than the local window
        self._pursued: tuple[int, int] | None = None  # map cell of the acceptable candidate that is approached

    def next_goal(self, goal: str) -> None:
        """See `Seeker`; this seeker knows only the scores of one goal, which are on the map."""
        self.reset(goal)

    def observe(self, navmap: NavMap, observation: Observation, pose: Pose, step: int) -> None:
        """See `Seeker`; this seeker reads everything from the map."""

    def one_more_forward(self, navmap: NavMap, approach: Approach, pose: Pose) -> bool:
        """Returns False: the paper's agent stops where it verifies."""
        return False

    def parts(self, navmap: NavMap) -> CandidateParts:
        """Returns the candidates on the known part of the map, including those set aside."""
        return CandidateParts.of(navmap.view(self._known(navmap)), self.candidate_score, self.least_cells)

    def candidates(self, navmap: NavMap) -> Bool[np.ndarray, "rows cols"]:
        """Returns the cells of the whole map with candidates that are not set aside."""
        return self._on_whole_map(navmap, self.parts(navmap).mask) & ~navmap.set_aside

    def _acceptable(self, navmap: NavMap, parts: CandidateParts) -> Bool[np.ndarray, "rows cols"]:
        """Returns the cells of the whole map with candidates that the verifier would accept now.

        A candidate that is pursued as acceptable stays acceptable: otherwise the goal could change with every frame.
        The rule that late candidates are not verified does not apply here.
        """
        whole = self._known(navmap)
        view = navmap.view(whole)
        best = _seen_best_of_each(view, parts)
        would = [self.verifier.would_accept(self.goal, features_of(view, flat)) for flat in best]
        accepted = np.array([False, *would])
        if self._pursued is not None:
            row, col = self._pursued
            accepted[parts.labels[row - whole.rows.start, col - whole.cols.start]] = True
            accepted[0] = False  # number 0: not a candidate
        return self._on_whole_map(navmap, accepted[parts.labels]) & ~navmap.set_aside

    def in_reach(self, navmap: NavMap, sighting: Sighting) -> tuple[int, int] | None:
        """Returns the map cell of the nearest candidate in the current frame when it is near enough to stop."""
        if not sighting.is_within(self.distances.in_view_m):
            return None
        return sighting.nearest(self._on_whole_map(navmap, self.parts(navmap).mask), self.distances.in_view_m)

    def approach(self, navmap: NavMap, window: Window, pose: Pose, step: int) -> Approach | None:
        """Returns the approach to the nearest acceptable candidate, else to any reachable one, else None."""
        whole = self._known(navmap)
        if step >= self._retry_step:
            navmap.set_aside[whole.index] = False
        # Usually no cell is a candidate, and the highest score shows that in a tenth of the time.
        parts = self.parts(navmap) if navmap.score_max[whole.index].max() > self.candidate_score else None
        if parts is None or not (parts.mask & ~navmap.set_aside[whole.index]).any():
            self._far, self._pursued = False, None
            return None
        candidates = self._on_whole_map(navmap, parts.mask) & ~navmap.set_aside
        acceptable = self._acceptable(navmap, parts) if self.verifier.may_refuse else None
        for choice in self._choices(candidates, acceptable, window, whole, step):
            approach = approach_on(
                navmap.view(choice.part), choice.candidates, pose, self._viewpoints, choice.last_resort
            )
            if approach is not None:
                approach = on_map(approach, choice.part)
                self._far = choice.part is whole
                self._pursued = approach.cell if choice.acceptable else None
                return approach
        self.postpone(navmap, step)
        return None

    def postpone(self, navmap: NavMap, step: int) -> None:
        """Sets all candidates aside: they cannot be reached on the current map."""
        navmap.set_aside[self.candidates(navmap)] = True
        self._far, self._pursued = False, None
        self._retry_step = step + self._wait_steps
        self._wait_steps *= 2

    def retry(self) -> None:
        """See `Seeker`."""
        self._retry_step, self._wait_steps = 0, self.config.retry_after_steps

    def judge(self, navmap: NavMap, cell: tuple[int, int]) -> bool:
        """Verifies the candidate at a map cell; a rejected one never counts again in this episode.

        Returns False without a candidate. A late candidate is accepted without verification.
        """
        whole = self._known(navmap)
        view, parts = navmap.view(whole), self.parts(navmap)
        number = parts.labels[cell[0] - whole.rows.start, cell[1] - whole.cols.start]
        if number == 0:
            return False
        instance = parts.labels == number
        # The nearest cells are at its edge and also show neighbouring objects, so the best-seen cell represents it.
        best = _seen_best(view, instance)
        features = features_of(view, best)
        found_late = bool((view.found_step[instance] > self.config.verify_until_step).all())
        if found_late or self.verifier.accepts(self.goal, features):
            self.confidence = self._rated(features)
            row, col = divmod(best, view.frame.shape[1])
            self.accepted_cell = row + whole.rows.start, col + whole.cols.start
            return True
        self._reject(view, instance)
        return False

    def refuse(self, navmap: NavMap) -> None:
        """See `Seeker`."""
        if self.accepted_cell is None:
            return
        whole, parts = self._known(navmap), self.parts(navmap)
        row, col = self.accepted_cell
        number = parts.labels[row - whole.rows.start, col - whole.cols.start]
        self._reject(navmap.view(whole), parts.labels == number)
        self.confidence = self.accepted_cell = None

    def _reject(self, view: NavMap, instance: Bool[np.ndarray, "rows cols"]) -> None:
        """Marks the cells of a candidate, and those around them, as rejected for the rest of the episode."""
        margin_cells = self.config.rejection_margin_m / view.frame.cell_m
        view.rejected[distance_to(instance) <= margin_cells + 1e-3] = True

    def _rated(self, features: Features) -> float:
        """Returns the probability of a candidate by the verifier, else its highest score."""
        verifier = self.verifier
        return verifier.probability(self.goal, features) if isinstance(verifier, RatesCandidates) else features.maximum

    def _on_whole_map(
        self, navmap: NavMap, mask: Bool[np.ndarray, "known_rows known_cols"]
    ) -> Bool[np.ndarray, "rows cols"]:
        """Returns a mask over the known part of the map as one over the whole map."""
        result = np.zeros(navmap.frame.shape, np.bool_)
        result[self._known(navmap).index] = mask
        return result

    def _known(self, navmap: NavMap) -> Window:
        return navmap.known_window(margin_cells=self.config.margin_cells)

    def _choices(
        self,
        candidates: Bool[np.ndarray, "rows cols"],
        acceptable: Bool[np.ndarray, "rows cols"] | None,
        window: Window,
        whole: Window,
        step: int,
    ) -> Iterator[_Choice]:
        """Yields candidates in order of preference, first on the local window, then on the whole map.

        Acceptable candidates with a viewpoint come first, then other candidates with a viewpoint, then last resorts.
        """
        # An approach on the whole map stays on the whole map: otherwise each step could choose another candidate.
        parts = (whole,) if self._far else (window, whole)
        if acceptable is not None:
            for part in parts:
                yield _Choice(part, acceptable[part.index], LastResort.NONE, acceptable=True)
        for part in parts:
            last_resort = LastResort.VERIFY if part is whole and self.verifier.may_refuse else LastResort.NONE
            if step >= self._last_resort_step:
                last_resort = LastResort.STOP
            yield _Choice(part, candidates[part.index], last_resort, acceptable=False)


def _seen_best(view: NavMap, instance: Bool[np.ndarray, "rows cols"]) -> int:
    """Returns the row-major cell of an instance with the highest cumulative score."""
    return int(np.argmax(np.where(instance, view.score_sum, -1.0)))


def _seen_best_of_each(view: NavMap, parts: CandidateParts) -> list[int]:
    """Returns `_seen_best` of each candidate, in the order of their numbers."""
    rows, cols = np.nonzero(parts.labels)
    number = parts.labels[rows, cols]
    order = np.lexsort((-view.score_sum[rows, cols], number))  # stable: the first cell of those that score the same
    first = order[np.searchsorted(number[order], np.arange(1, parts.count + 1))]
    return (rows[first] * view.score_sum.shape[1] + cols[first]).tolist()


def features_of(view: NavMap, flat: int) -> Features:
    """Returns the object layers at a cell of a map, counted in row-major order."""
    at = divmod(flat, view.score_sum.shape[1])
    return Features(
        int(view.frames_in_view[at]),
        float(view.score_sum[at]),
        float(view.score_max[at]),
        float(view.other_max[at]),
    )
