"""Decides whether a track is accepted, rejected or viewed again first, and from which place."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Float32, Int

from sim.core.geometry.pose import Pose
from sim.core.interface import ConfigError
from stubborn.detection.approach import Approach, approach_to
from stubborn.detection.evidence import Evidence
from stubborn.detection.viewpoints import ViewpointFinder
from stubborn.mapping.masks import NearestCells
from stubborn.mapping.navmap import NavMap


@dataclass(frozen=True, kw_only=True)
class LookConfig:
    """Probabilities at which a track is visited and accepted, and viewpoints; see docs/segmentation.md."""

    bar: tuple[tuple[int, float], ...] = ((0, 0.05), (40, 0.05), (100, 0.4), (200, 0.57), (300, 0.69), (500, 0.8))
    """Pairs of steps left and probability, interpolated linearly: a track is accepted from this probability on. A wrong
    STOP costs the chance to succeed later, which falls as the steps run out."""
    slack: float = 0.12
    """The robot keeps approaching an accepted track, and stops at it, until its probability is below the bar by this
    share of the bar: views of one object differ, and to leave an object that was reached costs the whole path."""
    visit: float = 0.3
    """The robot looks at a track below the bar if the track has at least this probability."""
    keep: float = 0.6
    """A look continues until the probability falls below this share of `visit`."""
    straight: float = 0.4
    """The robot looks at a track with at least this probability on the path to it: if it is the goal, nothing is lost.
    It looks at others from another direction at once."""
    detour_m: float = 4.0
    """A look is not worth a route that is longer than the straight line by more than this distance: it may lead around
    the house, over ground never seen, to the other side of an object in a corner."""
    switch: float = 0.2
    """A look ends early if the probability of another track, less its distance's cost, is higher by this."""
    most_looks: int = 2
    """Largest number of looks at one track."""
    look_steps: int = 30
    """Largest number of steps of one look, including those on the path."""
    unseen_steps: float = 120.0
    """The probability that no goal was in view falls with this number of steps, exponentially; see `believed`."""
    missed: float = 0.15
    """Probability that a goal was in view but did not become a track."""
    look_m: tuple[float, float] = (1.3, 2.2)
    """Distances to look from: the camera sees the floor, and so a whole low object, from 1.43 m on."""
    apart_rad: float = math.radians(45.0)
    """Directions that differ by less than this count as one view."""
    step_back_steps: int = 100
    """If at least this many steps are left, the robot first steps back to look at a track above the bar that is nearer
    than 1.2 m and was never seen whole from 1.2 to 3 m: from nearer, the image does not show the whole object."""
    per_metre: float = 0.03
    """For each metre that a track is farther away, it must be this much more probable to come first."""
    steps_per_metre: float = 6.0
    """Steps that a metre of the path takes, including turns: a track that cannot be reached in time is not accepted."""
    patience_steps: int = 40
    """A track is set aside after this many steps in which the robot pursued tracks and stayed within `patience_m`."""
    patience_m: float = 1.0
    """The count restarts when the robot moves farther than this."""

    def __post_init__(self) -> None:
        steps = [steps_left for steps_left, _ in self.bar]
        if not steps or steps != sorted(set(steps)) or not all(0.0 < p <= 1.0 for _, p in self.bar):
            raise ConfigError(
                f"LookConfig.bar must be pairs of growing steps and probabilities in (0, 1], got {self.bar}."
            )
        if not (0.0 <= self.slack <= 1.0 and 0.0 <= self.keep <= 1.0 and 0.0 < self.visit <= 1.0):
            raise ConfigError(
                "LookConfig needs slack and keep in [0, 1] and visit in (0, 1], "
                f"got {self.slack}, {self.keep} and {self.visit}."
            )
        if not (self.unseen_steps > 0.0 and 0.0 <= self.missed <= 1.0):
            raise ConfigError(
                f"LookConfig needs unseen_steps > 0 and missed in [0, 1], got {self.unseen_steps} and {self.missed}."
            )
        if not 0.0 < self.look_m[0] < self.look_m[1]:
            raise ConfigError(f"LookConfig.look_m must be two growing distances > 0 m, got {self.look_m}.")
        for name in (
            "straight",
            "detour_m",
            "switch",
            "most_looks",
            "per_metre",
            "step_back_steps",
            "steps_per_metre",
            "patience_steps",
            "patience_m",
            "look_steps",
        ):
            if not getattr(self, name) >= 0:
                raise ConfigError(f"LookConfig.{name} must be >= 0, got {getattr(self, name)}.")

    def bar_with(self, steps_left: int) -> float:
        """Returns the probability from which a track is accepted when this many steps are left."""
        steps, bar = zip(*self.bar, strict=True)
        return float(np.interp(steps_left, steps, bar))


def believed(
    probability: Float32[np.ndarray, " numbers"],
    step: int,
    config: LookConfig,
    objects: Int[np.ndarray, " numbers"] | None = None,
) -> Float32[np.ndarray, " numbers"]:
    """Returns the probability of the goal for each track, given that the house has a goal.

    The objects are taken as independent, and so is a goal without a track: it was not in view so far, or it was missed.
    The more of the house was seen without another candidate, the more probable is the one that was seen.

    Args:
        probability: probability of the goal for each track, without this knowledge.
        step: step of the episode.
        config: how soon most of a house was in view.
        objects: a number of the object of each track: an object can be several tracks; None: each is its own.
    """
    unseen = math.exp(-step / config.unseen_steps)
    elsewhere = unseen + config.missed * (1.0 - unseen)
    best = probability.astype(np.float64)
    if objects is not None:
        best = np.zeros(len(probability))
        np.maximum.at(best, objects, probability)
    nothing = (1.0 - elsewhere) * np.prod(1.0 - best)
    return (probability / max(1.0 - nothing, 1e-6)).clip(max=1.0).astype(np.float32)


class Verdicts:
    """The decision on each track, and the number of looks at it.

    Args:
        config: probabilities and costs.
        exact: True for posteriors without errors: a track is accepted from a probability of 0.5 on.
        max_steps: actions of an episode.
    """

    def __init__(self, config: LookConfig, *, exact: bool, max_steps: int) -> None:
        self.config = config
        self.exact = exact
        self.max_steps = max_steps
        self.accepted: set[int] = set()
        self.rejected: set[int] = set()
        """Tracks below the bar that had all their looks. They are accepted later if the bar falls below their
        probability, or if new views raise their probability."""
        self.doubtful: list[int] = []
        """Tracks that are worth a look."""
        self.looks: dict[int, int] = {}
        self.bar = 1.0
        """The probability from which a track is accepted now."""
        self.rated: Float32[np.ndarray, " numbers"] = np.zeros(1, np.float32)
        """The probability by which each track is decided on: that of `believed` for tracks that had a look."""

    def update(
        self,
        probability: Float32[np.ndarray, " numbers"],
        distance_m: Float[np.ndarray, " numbers"],
        evidence: Evidence,
        step: int,
        pursued: int | None = None,
        objects: Int[np.ndarray, " numbers"] | None = None,
    ) -> None:
        """Accepts and rejects tracks, and finds those that are worth a look.

        Args:
            probability: probability of the goal for each track.
            distance_m: distance of the robot to each track.
            evidence: the views of the tracks.
            step: step of the episode.
            pursued: the track of the present look.
            objects: see `believed`.
        """
        c = self.config
        steps_left = self.max_steps - step
        self.bar = 0.5 if self.exact else c.bar_with(steps_left)
        self.rated = probability if self.exact else self._rated(probability, evidence, step, objects)
        in_time = c.steps_per_metre * distance_m <= steps_left
        passes = (self.rated >= self.bar) & (in_time | self.exact)
        remains = self.rated >= self.least
        for track in np.flatnonzero(passes & (distance_m <= evidence.config.rings_m[0])).tolist():
            passes[track] = not self._needs_a_step_back(track, evidence, steps_left)
        self.accepted = {t for t in self.accepted if remains[t]} | set(np.flatnonzero(passes).tolist())
        self.rejected -= self.accepted
        least = np.full(len(probability), c.visit)
        if pursued is not None:
            least[pursued] *= c.keep
        self.doubtful = []
        for track in np.flatnonzero(probability >= least).tolist():
            if track in self.accepted or track in self.rejected:
                continue
            if self.looks.get(track, 0) >= c.most_looks or self._is_seen_around(evidence.near_sectors(track)):
                self.rejected.add(track)
            else:
                self.doubtful.append(track)

    @property
    def least(self) -> float:
        """The probability from which an accepted track stays accepted."""
        return (1.0 - self.config.slack) * self.bar

    def _rated(
        self,
        probability: Float32[np.ndarray, " numbers"],
        evidence: Evidence,
        step: int,
        objects: Int[np.ndarray, " numbers"] | None,
    ) -> Float32[np.ndarray, " numbers"]:
        """Returns the probabilities, in place of those of `believed` for tracks that were seen well in a look."""
        result, believed_in = probability.copy(), believed(probability, step, self.config, objects)
        for track in {*self.looks, *self.rejected, *self.accepted}:
            if track in self.rejected or evidence.near_sectors(track).any():
                result[track] = believed_in[track]
        return result

    def _needs_a_step_back(self, track: int, evidence: Evidence, steps_left: int) -> bool:
        """Returns True for a near track that was never seen whole, if it has had no look yet and there is time."""
        if self.exact or track in self.accepted or track in self.rejected or steps_left < self.config.step_back_steps:
            return False
        return self.looks.get(track, 0) == 0 and not evidence.near_sectors(track).any()

    def looked(self, track: int) -> None:
        """Counts a look at a track."""
        self.looks[track] = self.looks.get(track, 0) + 1

    def give_up(self, track: int) -> None:
        """Rejects a track that gets no further look."""
        self.rejected.add(track)
        self.accepted.discard(track)

    def _is_seen_around(self, sectors: Bool[np.ndarray, " sectors"]) -> bool:
        """Returns True for an object that was seen from directions that differ enough."""
        seen = np.flatnonzero(sectors)
        if seen.size < 2:
            return False
        gap = np.abs(seen[:, None] - seen[None, :])
        gap = np.minimum(gap, len(sectors) - gap)
        return bool(gap.max() * math.tau / len(sectors) >= self.config.apart_rad - 1e-9)


def look_at(
    view: NavMap,
    cells: NearestCells,
    middle_xy_m: tuple[float, float],
    seen_from: Bool[np.ndarray, " sectors"],
    pose: Pose,
    finder: ViewpointFinder,
    config: LookConfig,
) -> Approach | None:
    """Returns the approach to a place from which to look at a track; None if no such place exists.

    Args:
        view: a part of the map.
        cells: for each cell of the view, the nearest cell of the track.
        middle_xy_m: the middle of the track.
        seen_from: directions from which the track was seen well, numbered from +x on; a new direction must differ from
            them.
        pose: pose of the robot.
        finder: finds reachable cells in sight.
        config: distances and angles.
    """
    places = finder.look_from(view, pose, cells, config.look_m)
    rows, cols = np.nonzero(places.cells)
    x_m, y_m = view.frame.centres(rows, cols)
    bearing_rad = np.arctan2(y_m - middle_xy_m[1], x_m - middle_xy_m[0])
    new = np.ones(rows.size, np.bool_)
    for sector in np.flatnonzero(seen_from).tolist():
        off_rad = bearing_rad - sector * math.tau / len(seen_from)
        new &= np.abs(np.arctan2(np.sin(off_rad), np.cos(off_rad))) >= config.apart_rad
    places.cells[rows[~new], cols[~new]] = False
    return approach_to(view, places, cells.rows, cells.cols, pose, finder) if new.any() else None
