"""Configuration of the task: when a STOP succeeds, and how many actions an episode has."""

from __future__ import annotations

from dataclasses import dataclass, field

from sim.core.errors import ConfigError
from sim.core.interface import MAX_STEPS, SuccessRule

MAX_STEP_LIMIT = 1_000_000


@dataclass(frozen=True, kw_only=True)
class TaskConfig:
    """Rules of an episode."""

    success: SuccessRule = field(default_factory=SuccessRule)
    max_steps: int = MAX_STEPS
    """Number of actions after which an episode is truncated."""

    def __post_init__(self) -> None:
        if not isinstance(self.max_steps, int) or not 1 <= self.max_steps <= MAX_STEP_LIMIT:
            raise ConfigError(
                f"TaskConfig.max_steps must be a whole number in [1, {MAX_STEP_LIMIT}], got {self.max_steps!r}."
            )
