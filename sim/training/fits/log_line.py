"""A line of a log of whole episodes to which parameters are fitted."""

from __future__ import annotations

from typing import Self

import msgspec

from sim.core.reading import Count, Name
from sim.episodes.episode import Episode


class LogLine(msgspec.Struct, frozen=True, kw_only=True):
    """A line of a log; each log adds its own fields, with values for a failed episode."""

    episode_id: Name
    goal: Name
    house: Name
    steps: Count
    """0: the episode failed."""

    @classmethod
    def of(cls, episode: Episode, steps: int = 0, **content: object) -> Self:
        """Returns the line of an episode; by default it failed."""
        about = {"episode_id": episode.episode_id, "goal": episode.goal, "house": episode.house}
        return msgspec.convert({**about, "steps": steps, **content}, cls)

    @property
    def is_error(self) -> bool:
        """False: the line of a failed episode stays."""
        return False

    def as_json(self) -> dict[str, object]:
        """Returns the JSON values of the line."""
        return msgspec.to_builtins(self)
