"""One episode: a house, a goal or a chain of goals, and a start pose."""

from __future__ import annotations

from dataclasses import dataclass

from sim.core.errors import EpisodeError
from sim.core.geometry.pose import Pose
from sim.core.goals import NO_GOAL, GoalSpec, require_chain
from sim.core.reading import FARTHEST_M
from sim.core.wishes import require_goal


@dataclass(frozen=True)
class Episode:
    """One episode: the robot starts at a pose in a house and searches for an object."""

    episode_id: str
    house: str
    """Name of the house within its split."""
    goal: str
    """A goal category, the label of one instance (`chair_03`), or words (`sim.core.wishes`): that of the first goal."""
    start: Pose
    shortest_path_m: float | None = None
    """Recorded geodesic distance from the start to the nearest place where a STOP succeeds; None: unknown."""
    goals: tuple[GoalSpec, ...] = ()
    """The goals of a chain in their order, or a single goal that is more than its text; (): `goal` is all."""

    def __post_init__(self) -> None:
        if self.goals != (NO_GOAL,):
            require_goal(self.goal)
        require_start(self.start)
        if self.goals and self.goals[0].text != self.goal:
            raise EpisodeError(f"The goal is '{self.goal}', and the first one of `goals` is '{self.goals[0].text}'.")
        require_chain(self.goals)

    @property
    def specs(self) -> tuple[GoalSpec, ...]:
        """The goals in their order; one, unless the episode is a chain."""
        return self.goals or (GoalSpec.of(self.goal),)

    @property
    def in_picture(self) -> bool:
        """True: the first goal is a picture."""
        return self.specs[0].camera is not None

    @property
    def is_chain(self) -> bool:
        """True: it has several goals."""
        return len(self.goals) > 1


def require_start(start: Pose) -> None:
    """Raises EpisodeError if a number of a start is NaN, infinite or larger than `FARTHEST_M`."""
    if not all(abs(value) <= FARTHEST_M for value in (start.x_m, start.y_m, start.yaw_rad, start.floor_z_m)):
        raise EpisodeError(f"The start {start} is not allowed: finite numbers of at most {FARTHEST_M:g} are.")
