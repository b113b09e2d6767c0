"""The seeker of `stubborn-plus`: it decides on tracks, and looks at doubtful ones first."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float32, Float64

from sim.core.geometry.grid import Window, cells_near_segment
from sim.core.geometry.pose import Pose
from sim.core.interface import FORWARD_M, ConfigError, Observation
from stubborn.detection.approach import Approach, approach_from_here, approach_on, on_map
from stubborn.detection.goal_evidence import GoalEvidence
from stubborn.detection.look import LookConfig, Verdicts, look_at
from stubborn.detection.patience import Progress, SetAside
from stubborn.detection.seeker import SeekerParts
from stubborn.detection.tracks import TrackConfig
from stubborn.detection.viewpoints import LastResort, ViewpointFinder
from stubborn.mapping.mapper import Sighting
from stubborn.mapping.masks import nearest
from stubborn.mapping.navmap import NavMap


@dataclass(frozen=True, kw_only=True)
class TrackSeekerConfig:
    """Parameters of the tracks, of the decisions on them, and of the cells that are approached."""

    tracks: TrackConfig = field(default_factory=TrackConfig)
    look: LookConfig = field(default_factory=LookConfig)
    context: Path | None = None
    """File of `stubborn train context`, which says what is near objects of each category; None: the shipped one."""
    context_share: float = 0.5
    """With an imperfect detector, the share of the context's log ratios that counts; 0: none. Of 0, 0.5 and 1, chosen
    on `val`."""
    core_share: float = 0.7
    """The robot does not drive to cells of a track with a mean score below this share of the track's highest one."""
    near_best_m: float = 0.5
    """With an imperfect detector the robot drives to the cells of a track within this distance of its best cell, where
    there is a path: farther cells may belong to a neighbouring object."""
    as_good: float = 0.15
    """Accepted tracks are equally good if their probability is at most this much below the best one's: the robot
    approaches the nearest of them."""
    part_share: float = 0.6
    """A track next to an accepted one, with at least this share of its probability, is approached as a part of it."""
    part_gap_voxels: int = 1
    """Boxes of two tracks with at most this gap are next to each other."""
    late_share: float = 0.6
    """After this share of the actions, or earlier if nothing new comes into view, a goal with conditions (words or a
    picture) takes the best object that is known."""
    counter_m: float = 0.65
    """A track without a viewpoint may have one over an edge as high as the camera within this distance of it, the depth
    of a kitchen counter (0.6 m) and a cell."""
    most_pushes: int = 2
    """After this many steps in which an approach did not move the robot, the agent stops if a STOP counts there."""

    def __post_init__(self) -> None:
        if not 0.0 <= self.context_share <= 1.0:
            raise ConfigError(f"TrackSeekerConfig.context_share must be in [0, 1], got {self.context_share}.")
        if not (0.0 <= self.core_share <= 1.0 and 0.0 <= self.part_share <= 1.0 and self.as_good >= 0.0):
            raise ConfigError(
                "TrackSeekerConfig needs core_share and part_share in [0, 1] and as_good >= 0, got "
                f"{self.core_share}, {self.part_share} and {self.as_good}."
            )
        if self.counter_m < 0.0:
            raise ConfigError(f"TrackSeekerConfig.counter_m must be >= 0 m, got {self.counter_m}.")
        if not 0.0 <= self.late_share <= 1.0:
            raise ConfigError(f"TrackSeekerConfig.late_share must be in [0, 1], got {self.late_share}.")
        if self.near_best_m <= 0.0:
            raise ConfigError(f"TrackSeekerConfig.near_best_m must be > 0 m, got {self.near_best_m}.")
        if self.most_pushes < 1:
            raise ConfigError(f"TrackSeekerConfig.most_pushes must be >= 1, got {self.most_pushes}.")

    def make(self, parts: SeekerParts) -> TrackSeeker:
        """Returns a new seeker with these parameters. It judges tracks itself and does not use the verifier."""
        edge_m = parts.target.target_edge_m
        finder = ViewpointFinder(parts.planner, parts.layers, parts.distances, edge_m, self.counter_m)
        return TrackSeeker(self, parts, finder)


class TrackSeeker:
    """A `Seeker` that accepts, rejects and sets aside tracks; see `stubborn.detection.tracks` and `look`.

    Args:
        config: tracks and decisions.
        parts: parts of the agent. The seeker takes more risk as the actions of the episode run out.
        finder: finds viewpoints, and places to stop at.
    """

    reads_posteriors = True
    """See `sim.core.interface.ReadsPosteriors`."""

    def __init__(self, config: TrackSeekerConfig, parts: SeekerParts, finder: ViewpointFinder) -> None:
        self.config = config
        self.target = parts.target
        self.robot = parts.robot
        self.exact = not parts.segmenter.spec.needs_verification
        self.evidence = GoalEvidence(
            config.tracks,
            parts,
            least=config.look.visit,
            context=config.context,
            context_share=config.context_share,
        )
        self.finder = finder
        self.distances = parts.distances
        self.max_steps = parts.max_steps
        self._last_resort_step = parts.target.last_resort_from(parts.max_steps)
        self.reset("")

    def reset(self, goal: str) -> None:
        """See `Seeker`."""
        self.evidence.reset()
        self.next_goal(goal)

    def next_goal(self, goal: str) -> None:
        """See `Seeker`: tracks and their attributes stay, and the decisions on them are those of another goal."""
        self.evidence.next_goal()
        look = self.config.look
        self.goal = goal
        self.step = 0
        self._nothing_new = False
        self.verdicts = Verdicts(look, exact=self.exact, max_steps=self.max_steps)
        self.probability: Float32[np.ndarray, " numbers"] = np.zeros(1, np.float32)
        """Probability of the goal for each track, by its number; entry 0 belongs to no track."""
        self.pursued: int | None = None
        """The doubtful track that the robot looks at."""
        self.confidence: float | None = None
        """See `Seeker`: the probability of the track."""
        self.accepted_cell: tuple[int, int] | None = None
        """See `Seeker`."""
        self._judged = 0  # the track that `judge` accepted last
        self._drawn_rejected: set[int] = set()  # rejected tracks that the map shows
        self._accepted: list[int] = []  # accepted tracks that are not set aside
        self._targets: list[int] = []  # those that are approached
        self._aside = SetAside(self.target.retry_after_steps, self._last_resort_step)
        self._progress = Progress(look.patience_m, look.patience_steps, self.config.most_pushes)
        self._look_steps: dict[int, int] = {}
        self._went_nearer = False
        self._to_best = True  # whether the last approach led to the cells around the best ones
        self._drove = False  # whether it led along a route
        self._pose = Pose(0.0, 0.0, 0.0)
        self._hidden: dict[int, Bool[np.ndarray, " sectors"]] = {}  # directions from which a look did not show a track
        self._recalled = set[int]()  # tracks whose seen side is on the map of this goal

    def observe(self, navmap: NavMap, observation: Observation, pose: Pose, step: int) -> None:
        """See `Seeker`."""
        self.evidence.add(observation, pose, self.goal, navmap.frame)
        self.step, self._pose = step, pose
        self.probability = self.evidence.probabilities(self.goal, late=self._is_late)
        if navmap.sided:
            self._recall_sides(navmap)
        if self._decide(pose):
            navmap.rejected[:] = self.cells_of(navmap, self.verdicts.rejected)  # for pictures of the map

    def _recall_sides(self, navmap: NavMap) -> None:
        """Enters into the map from which side candidates were seen that are remembered from an earlier goal."""
        tracks = self.evidence.of_episode()
        for track in np.flatnonzero(self.probability >= self.config.look.visit).tolist():
            if track not in self._recalled:
                self._recalled.add(track)
                (index, mask), (x, y) = tracks.footprint(track), tracks.evidence.side(track)
                navmap.shown_x[index][mask] += np.float32(x)
                navmap.shown_y[index][mask] += np.float32(y)

    @property
    def _is_late(self) -> bool:
        """Whether an object must be chosen although the conditions of the goal are not certain."""
        return self._nothing_new or self.step >= self.config.late_share * self.max_steps

    def in_reach(self, navmap: NavMap, sighting: Sighting) -> tuple[int, int] | None:
        """See `Seeker`."""
        if not self._accepted or not sighting.is_within(self.distances.in_view_m):
            return None
        cells = self.cells_of(navmap, self._accepted)
        if self._to_best and not self.exact:
            cells &= self._near_best(navmap, self._accepted)
        return sighting.nearest(cells, self.distances.in_view_m)

    def approach(self, navmap: NavMap, window: Window, pose: Pose, step: int) -> Approach | None:
        """See `Seeker`: accepted tracks come first, then doubtful ones; without progress another track is chosen."""
        self._progress.count_pushes(pose, drove=self._drove)
        search = self._pursue(navmap, window, pose, step)
        if self._progress.is_stuck(pose, pursuing=search is not None, times_felt=navmap.times_felt):
            if self.pursued is not None:
                self._aside.add_spot(*self.evidence.of_episode().middle_xy_m(self.pursued), self.step)
            self.postpone(navmap, step)
            self.pursued = None
            search = self._pursue(navmap, window, pose, step)
        if self._looks_too_long():
            search = self._pursue(navmap, window, pose, step)
        self._drove = search is not None and search.route is not None
        return search

    def _looks_too_long(self) -> bool:
        """Counts the steps of looks at the pursued track, and rejects it if there are too many."""
        track = self.pursued
        if track is None or self.exact:
            return False
        self._look_steps[track] = self._look_steps.get(track, 0) + 1
        if self._look_steps[track] <= self.config.look.look_steps:
            return False
        self.verdicts.give_up(track)
        self.verdicts.doubtful.remove(track)
        self.pursued = None
        return True

    def _pursue(self, navmap: NavMap, window: Window, pose: Pose, step: int) -> Approach | None:
        resort = LastResort.STOP if step >= self._last_resort_step else LastResort.NONE
        while self._accepted:
            self._targets = self._best_accepted(pose)
            tracks = self._with_parts(self._targets)
            search = self._stop_here(navmap, window, pose, tracks)
            search = search or self._drive_to(navmap, window, pose, tracks, resort)
            if search is not None:
                self.pursued = None
                return search
            self._set_aside(self._targets)
        self._targets = []
        doubtful = [t for t in self.verdicts.doubtful if self._aside.is_due(t, self.step) and not self._is_near_spot(t)]
        while doubtful:
            track = self._best_doubtful(doubtful, pose)
            search = self._look(navmap, window, pose, track)
            if search is not None:
                self.pursued = track
                return search
            doubtful.remove(track)
        self.pursued = None
        return None

    def judge(self, navmap: NavMap, cell: tuple[int, int]) -> bool:
        """See `Seeker`: ends the look at the pursued track; an accepted track was judged before."""
        if self._accepted:
            at_cell = [t for t in self._accepted if self.cells_of(navmap, [t])[cell]]
            # The cell may belong to a part that is not accepted itself: then the decision is on the approached tracks.
            near = at_cell or [t for t in self._targets if t in self._accepted] or self._accepted
            track = max(near, key=lambda t: self.probability[t])
            least = self.verdicts.bar if self.exact else self.verdicts.least
            if self.verdicts.rated[track] < least:  # it seemed more probable from afar
                self.verdicts.give_up(track)
                self._accepted.remove(track)
                return False
            self.confidence, self._judged = float(self.probability[track]), track
            self.accepted_cell = self._best_cell(navmap, track)
            return True
        if self.pursued is not None:
            self.verdicts.looked(self.pursued)
            self._note_hidden(self.pursued)
            self.pursued = None
        return False

    def refuse(self, navmap: NavMap) -> None:
        """See `Seeker`: the track, and those that may be parts of it, count no longer in this episode."""
        if self.accepted_cell is None:
            return
        refused = self._with_parts([self._judged])
        self.evidence.refuse(refused)
        for track in refused:
            self.probability[track] = 0.0
            self.verdicts.give_up(track)
        self._accepted = [track for track in self._accepted if track not in refused]
        self.confidence = self.accepted_cell = None

    def one_more_forward(self, navmap: NavMap, approach: Approach, pose: Pose) -> bool:
        """See `Seeker`: True at most once, if the candidate is not near enough and the path is free."""
        wanted_m = self.distances.nearer_viewpoint_m
        if self._went_nearer or wanted_m is None or self._progress.pushes_on:
            return False
        x_m, y_m = navmap.frame.centres(*approach.cell)
        if pose.distance_to(Pose(float(x_m), float(y_m), 0.0)) <= wanted_m:
            return False
        index, swept = cells_near_segment(navmap.frame, pose.xy_m, pose.ahead(FORWARD_M), self.robot.radius_m)
        self._went_nearer = not navmap.seen_obstacle[index][swept].any()
        return self._went_nearer

    def postpone(self, navmap: NavMap, step: int) -> None:
        """See `Seeker`."""
        self._set_aside(self._targets if self.pursued is None else [*self._targets, self.pursued])

    def retry(self) -> None:
        """See `Seeker`. From now on, a goal with conditions takes the best object that is known."""
        self._nothing_new = True
        self._aside.end()

    def cells_of(self, navmap: NavMap, tracks: Iterable[int]) -> Bool[np.ndarray, "rows cols"]:
        """Returns the cells of the whole map that some tracks own and that look like the goal."""
        result = np.zeros(navmap.frame.shape, np.bool_)
        for track in tracks:
            index, mask = self._core(navmap, track)
            result[index] |= mask
        return result

    def _core(self, navmap: NavMap, track: int) -> tuple[tuple[slice, slice], Bool[np.ndarray, "rows cols"]]:
        """Returns the part of a track's footprint that looks like the goal: a rectangle, and a mask over it.

        A track may contain a part of a neighbouring object, where the mean score is lower.
        """
        index, mask = self.evidence.of_episode().footprint(track)
        mean = navmap.score_sum[index] / np.maximum(navmap.frames_in_view[index], 1)
        return index, mask & (mean >= self.config.core_share * mean.max(where=mask, initial=0.0))

    def _best_cell(self, navmap: NavMap, track: int) -> tuple[int, int]:
        """Returns the map cell of a track with the highest cumulative score."""
        index, mask = self._core(navmap, track)
        row, col = divmod(int(np.argmax(np.where(mask, navmap.score_sum[index], -1.0))), mask.shape[1])
        return int(index[0].start) + row, int(index[1].start) + col

    def _decide(self, pose: Pose) -> bool:
        """Updates the verdicts on all tracks; returns True if the map does not show the current rejected tracks."""
        tracks = self.evidence.of_episode()
        x_m, y_m = tracks.middles(np.arange(len(self.probability)))
        distance_m = np.hypot(x_m - pose.x_m, y_m - pose.y_m)
        objects = None if self.exact else tracks.objects(self.probability, self.config.part_gap_voxels)
        self.verdicts.update(self.probability, distance_m, tracks.evidence, self.step, self.pursued, objects)
        self._accepted = [t for t in sorted(self.verdicts.accepted) if self._aside.is_due(t, self.step)]
        drawn, self._drawn_rejected = self._drawn_rejected, set(self.verdicts.rejected)
        return drawn != self._drawn_rejected

    def _best_accepted(self, pose: Pose) -> list[int]:
        """Returns the accepted tracks that are about as good as the best one; the nearest of them is approached."""
        worth = self._worth(self._accepted, pose)
        return [
            t for t, w in zip(self._accepted, worth.tolist(), strict=True) if w >= worth.max() - self.config.as_good
        ]

    def _with_parts(self, tracks: list[int]) -> list[int]:
        """Returns some tracks and those next to them that may be parts of them: a bed can be several tracks."""
        result = set(tracks)
        for track in tracks:
            others = np.flatnonzero(self.probability >= self.config.part_share * self.probability[track])
            result.update(self.evidence.of_episode().near(track, others, self.config.part_gap_voxels).tolist())
        return sorted(result)

    def _best_doubtful(self, tracks: list[int], pose: Pose) -> int:
        """Returns the track of the present look, or the one that is most worth a look."""
        worth = dict(zip(tracks, self._worth(tracks, pose).tolist(), strict=True))
        best = max(tracks, key=worth.__getitem__)
        if self.pursued in tracks and worth[best] <= worth[self.pursued] + self.config.look.switch:
            return self.pursued
        return best

    def _worth(self, tracks: list[int], pose: Pose) -> Float64[np.ndarray, " tracks"]:
        """Returns the probability of tracks, less the cost of their distance."""
        x_m, y_m = self.evidence.of_episode().middles(np.array(tracks))
        cost = self.config.look.per_metre * np.hypot(x_m - pose.x_m, y_m - pose.y_m)
        return self.probability[tracks].astype(np.float64) - cost

    def _drive_to(
        self, navmap: NavMap, window: Window, pose: Pose, tracks: list[int], resort: LastResort
    ) -> Approach | None:
        """Returns the approach to the accepted tracks, where possible to the cells around their best ones."""
        cells, approach = self.cells_of(navmap, tracks), None
        if not self.exact:
            near_best = cells & self._near_best(navmap, self._targets)
            approach = self._approach(navmap, window, pose, near_best, LastResort.NONE)
        self._to_best = approach is not None
        return approach or self._approach(navmap, window, pose, cells, resort)

    def _near_best(self, navmap: NavMap, tracks: Iterable[int]) -> Bool[np.ndarray, "rows cols"]:
        """Returns the cells of the whole map around the best cell of each track."""
        result = np.zeros(navmap.frame.shape, np.bool_)
        for track in tracks:
            x_m, y_m = (float(v) for v in navmap.frame.centres(*self._best_cell(navmap, track)))
            index, near = cells_near_segment(navmap.frame, (x_m, y_m), (x_m, y_m), self.config.near_best_m)
            result[index] |= near
        return result

    def _approach(
        self, navmap: NavMap, window: Window, pose: Pose, cells: Bool[np.ndarray, "rows cols"], resort: LastResort
    ) -> Approach | None:
        """Returns the approach to some cells, on the local window if that is enough, else on the whole map."""
        for part in (window, self._known(navmap)):
            whole = part is not window  # what does in place of a viewpoint does so only if the whole map has none
            last, view = resort if whole else LastResort.NONE, navmap.view(part)
            approach = approach_on(view, cells[part.index], pose, self.finder, last, over_counters=whole)
            if approach is not None:
                return on_map(approach, part)
        return None

    def _stop_here(self, navmap: NavMap, window: Window, pose: Pose, tracks: list[int]) -> Approach | None:
        """Returns the approach that ends here, where the robot pushes against something and a STOP counts.

        The planner treats the ground under the robot as free, so a viewpoint on it may be behind the obstacle.
        """
        if not self._progress.pushes_on:
            return None
        approach = approach_from_here(
            navmap.view(window), self.cells_of(navmap, tracks)[window.index], pose, self.finder
        )
        return None if approach is None else on_map(approach, window)

    def _look(self, navmap: NavMap, window: Window, pose: Pose, track: int) -> Approach | None:
        """Returns the approach to a place with a view of a track; None: the track was decided on or set aside.

        The robot looks at a probable track on the path to it first, and at others from a direction that is new.
        """
        look, likely = self.config.look, self.probability[track] >= self.config.look.straight
        tracks, cells = self.evidence.of_episode(), self.cells_of(navmap, [track])
        seen_from, middle_xy_m = tracks.evidence.near_sectors(track), tracks.middle_xy_m(track)
        looked_from = seen_from | self._hidden.get(track, False)
        away_m = math.hypot(middle_xy_m[0] - pose.x_m, middle_xy_m[1] - pose.y_m)
        longest_m = away_m + look.detour_m
        looks = self.verdicts.looks.get(track, 0)
        if likely and looks == 0:
            approach = self._approach(navmap, window, pose, cells, LastResort.NONE)
            if approach is not None and approach.length_m <= longest_m:
                return approach
        for part in (window, self._known(navmap)):
            view, mask = navmap.view(part), cells[part.index]
            if not mask.any():
                continue
            approach = look_at(view, nearest(mask), middle_xy_m, looked_from, pose, self.finder, look)
            if approach is not None and approach.length_m <= longest_m:
                return on_map(approach, part)
        if looks or (seen_from.any() and not likely):
            self.verdicts.give_up(track)
            return None
        approach = self._approach(navmap, window, pose, cells, LastResort.VERIFY)
        if approach is not None and approach.length_m <= longest_m:
            return approach
        if self.probability[track] >= self.verdicts.bar:
            self.verdicts.looked(track)  # no place to step back to exists: the track is accepted now
        self._set_aside([track])
        return None

    def _note_hidden(self, track: int) -> None:
        """Remembers that something hides a track from here, if this look at it did not show it."""
        tracks = self.evidence.of_episode()
        evidence, (x_m, y_m) = tracks.evidence, tracks.middle_xy_m(track)
        bearing_rad = math.atan2(self._pose.y_m - y_m, self._pose.x_m - x_m)
        sector = int(evidence.sector_of(np.array([bearing_rad]))[0])
        if not evidence.near_sectors(track)[sector]:
            self._hidden.setdefault(track, np.zeros(evidence.config.sectors, np.bool_))[sector] = True

    def _is_near_spot(self, track: int) -> bool:
        """Returns whether the robot made no progress in an earlier pursuit near this track, and the track waits."""
        x_m, y_m = self.evidence.of_episode().middle_xy_m(track)
        return self._aside.is_near_spot(x_m, y_m, self.config.look.patience_m, self.step)

    def _set_aside(self, tracks: list[int]) -> None:
        """Tries these tracks again later."""
        self._aside.add(tracks, self.step)
        self._accepted = [t for t in self._accepted if t not in tracks]

    def _known(self, navmap: NavMap) -> Window:
        return navmap.known_window(margin_cells=self.target.margin_cells)
