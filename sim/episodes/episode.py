"""One episode: a house, a goal and a start pose."""

from __future__ import annotations

from dataclasses import dataclass

from sim.core.errors import EpisodeError
from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES
from sim.core.reading import printable
from sim.core.wishes import WishError, parse_wish
from sim.houses.labels import parse_label

FARTHEST_M = 10_000.0
"""Largest coordinate of a start."""


@dataclass(frozen=True)
class Episode:
    """One episode: the robot starts at a pose in a house and searches for an object."""

    episode_id: str
    house: str
    """Name of the house within its split."""
    goal: str
    """A goal category, the label of one instance (`chair_03`), or words (`sim.core.wishes`)."""
    start: Pose
    shortest_path_m: float | None = None
    """Recorded geodesic distance from the start to the nearest place where a STOP succeeds; None: unknown."""

    def __post_init__(self) -> None:
        require_goal(self.goal)
        require_start(self.start)


def require_goal(goal: str) -> None:
    """Raises EpisodeError if a goal is neither a category, nor the label of an instance, nor words that are known."""
    if goal in GOAL_CATEGORIES or parse_label(goal) is not None:
        return
    try:
        parse_wish(goal)
    except WishError as error:
        raise EpisodeError(
            f"Unknown goal '{printable(goal)}'. {error} Categories: {', '.join(GOAL_CATEGORIES)}."
        ) from None


def require_start(start: Pose) -> None:
    """Raises EpisodeError if a number of a start is NaN, infinite or larger than `FARTHEST_M`."""
    if not all(abs(value) <= FARTHEST_M for value in (start.x_m, start.y_m, start.yaw_rad, start.floor_z_m)):
        raise EpisodeError(f"The start {start} is not allowed: finite numbers of at most {FARTHEST_M:g} are.")
