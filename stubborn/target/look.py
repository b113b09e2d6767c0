"""Look, then go: whether a track is accepted, rejected, or still to be looked at, and from where."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32

from sim.geometry.pose import Pose
from sim.interface import MAX_STEPS, ConfigError
from stubborn.navmap import NavMap
from stubborn.raster import NearestCells
from stubborn.target.approach import Approach, approach_to
from stubborn.target.evidence import Evidence
from stubborn.target.viewpoints import ViewpointFinder


@dataclass(frozen=True, kw_only=True)
class LookConfig:
    """Probabilities at which a track is visited and accepted, and viewpoints. The values are reasoned, not fitted."""

    visit: float = 0.35
    """A track is looked at from this probability of the goal on."""
    accept: float = 0.6
    """It is accepted from this probability on, once it was seen well from two directions."""
    decisive: float = 0.92
    """From this probability on one direction is enough."""
    settle: float = 0.5
    """Where no further look is possible, it is accepted from this probability on."""
    drop: float = 0.35
    """An accepted track is rejected below this probability."""
    recover: float = 0.8
    """A rejected track is accepted after all from this probability on."""
    most_looks: int = 2
    """A track is looked at this often at most."""
    look_m: tuple[float, float] = (1.3, 2.2)
    """Distances to look from: the camera sees the floor, and so a whole low object, from 1.43 m on."""
    apart_rad: float = math.radians(45.0)
    """Directions less than this apart are one view."""
    per_metre: float = 0.03
    """A doubtful track a metre farther away must be this much more probable to come first."""
    patience_steps: int = 40
    """A track is set aside after so many steps in which the robot pursued tracks and stayed within `patience_m`."""
    patience_m: float = 1.0
    """The distance that ends the count."""
    last_tries: tuple[tuple[int, float], ...] = ((120, 0.3), (60, 0.05))
    """(Steps left, probability): with so few steps left, the best track of at least this probability is tried: a wrong
    STOP costs no more than none."""

    def __post_init__(self) -> None:
        if not 0.0 <= self.drop <= self.settle <= self.accept <= self.decisive <= 1.0:
            raise ConfigError(
                "LookConfig needs 0 <= drop <= settle <= accept <= decisive <= 1, got "
                f"{self.drop}, {self.settle}, {self.accept} and {self.decisive}."
            )
        if not 0.0 < self.look_m[0] < self.look_m[1]:
            raise ConfigError(f"LookConfig.look_m must be two growing distances > 0 m, got {self.look_m}.")

    def last_try(self, step: int) -> float:
        """Returns the probability from which a track is tried at a step without more looks; above 1: none is."""
        return min((least for left, least in self.last_tries if MAX_STEPS - step <= left), default=math.inf)


class Verdicts:
    """The decision on each track, and the number of looks at it."""

    def __init__(self, config: LookConfig, *, exact: bool) -> None:
        """With `exact` posteriors nothing needs a look."""
        self.config = config
        self.exact = exact
        self.accepted: set[int] = set()
        self.rejected: set[int] = set()
        self.looks: dict[int, int] = {}

    def update(self, probability: Float32[np.ndarray, " numbers"], evidence: Evidence) -> None:
        """Accepts and rejects tracks by their probability of the goal and the views of them."""
        c = self.config
        for track in {*np.flatnonzero(probability >= c.visit).tolist(), *self.accepted}:
            p, views = float(probability[track]), self._views(evidence.near_sectors(track))
            if track in self.accepted:
                if p < c.drop:
                    self._reject(track)
            elif track in self.rejected:
                if p >= c.recover:
                    self._accept(track)
            elif p >= c.accept and (self.exact or views >= 2 or (views == 1 and p >= c.decisive)):
                self._accept(track)
            elif self.looks.get(track, 0) >= c.most_looks:
                self.settle(track, p)
            elif views >= 2:
                self._reject(track)

    def looked(self, track: int) -> None:
        """Counts a look at a track."""
        self.looks[track] = self.looks.get(track, 0) + 1

    def settle(self, track: int, probability: float) -> None:
        """Decides on a track that cannot be looked at again."""
        if probability >= self.config.settle:
            self._accept(track)
        else:
            self._reject(track)

    def doubtful(self, probability: Float32[np.ndarray, " numbers"]) -> list[int]:
        """Returns the tracks that are worth a look."""
        decided = self.accepted | self.rejected
        return [t for t in np.flatnonzero(probability >= self.config.visit).tolist() if t not in decided]

    def _accept(self, track: int) -> None:
        self.accepted.add(track)
        self.rejected.discard(track)

    def _reject(self, track: int) -> None:
        self.rejected.add(track)
        self.accepted.discard(track)

    def _views(self, sectors: Bool[np.ndarray, " sectors"]) -> int:
        """Returns 2 for directions that are far enough apart, 1 for others, 0 for none."""
        seen = np.flatnonzero(sectors)
        if seen.size == 0:
            return 0
        gap = np.abs(seen[:, None] - seen[None, :])
        gap = np.minimum(gap, len(sectors) - gap)
        return 2 if gap.max() * math.tau / len(sectors) >= self.config.apart_rad - 1e-9 else 1


def look_at(
    view: NavMap,
    cells: NearestCells,
    middle_xy_m: tuple[float, float],
    seen_from: Bool[np.ndarray, " sectors"],
    pose: Pose,
    finder: ViewpointFinder,
    config: LookConfig,
) -> Approach | None:
    """Returns the approach to a place to look at a track from; None where there is none.

    Args:
        view: a part of the map.
        cells: for each cell of it the nearest one of the track.
        middle_xy_m: the middle of the track.
        seen_from: directions from which it was seen well, numbered around from +x; a new one must be apart from them.
        pose: of the robot.
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
