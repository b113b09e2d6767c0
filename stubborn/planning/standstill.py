"""Notices that an episode makes no progress: for many steps neither depth nor contact showed anything new."""

from __future__ import annotations

from dataclasses import dataclass

from sim.core.interface import ConfigError


@dataclass(frozen=True, kw_only=True)
class StandstillConfig:
    """Defines progress."""

    patience_steps: int = 60
    """A loop or a standstill is noticed after this many steps without news."""
    news_m2: float = 0.5
    """This much more ground in view is news."""

    def __post_init__(self) -> None:
        if self.patience_steps < 1 or self.news_m2 <= 0.0:
            raise ConfigError(
                "StandstillConfig needs patience_steps >= 1 and news_m2 > 0 m2, got "
                f"{self.patience_steps} and {self.news_m2}."
            )


class Standstill:
    """Counts the steps since the last news."""

    def __init__(self, config: StandstillConfig) -> None:
        self.config = config
        self.reset()

    def reset(self) -> None:
        """Forgets the last episode."""
        self._steps = 0
        self._seen_m2 = 0.0

    def observe(self, seen_m2: float, felt: bool) -> bool:
        """Counts a step; returns True if it is time to try something else, and then counts anew.

        Args:
            seen_m2: area of the ground that was ever in view.
            felt: whether a collision has changed the map.
        """
        self._steps += 1
        if felt or seen_m2 >= self._seen_m2 + self.config.news_m2:
            self._steps, self._seen_m2 = 0, seen_m2
        if self._steps < self.config.patience_steps:
            return False
        self._steps = 0
        return True
