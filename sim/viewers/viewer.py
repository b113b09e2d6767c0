"""Who looks on while an episode is played: a video, a window, a log. Looking on changes nothing.

`sim.evaluation.rollout.play_episode` tells each `Watcher` what happens. What the agent believes is drawn by whoever knows the
agent and handed in as a `MapPainter`; `sim.viewers.topview` is one that draws the truth.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from sim.interface import Action, Observation

if TYPE_CHECKING:  # only for its name: the environment needs no watcher
    from sim.env.objectnav import ObjectNavEnv

Colour = tuple[int, int, int]
WATCHED_IMAGES: tuple[str, ...] = ("rgb", "depth", "semantic")
"""What the environment must render (`truth=`) for watchers, whatever the agent asks for."""


@dataclass(frozen=True, kw_only=True)
class Moment:
    """One decision: what was there to see, and what the agent chose to do."""

    step: int
    """Number of the action, from 1."""
    observation: Observation
    """What the agent saw."""
    images: Mapping[str, NDArray]
    """The same moment without noise; holds all of `WATCHED_IMAGES`."""
    action: Action
    """What it does next."""

    def seen(self, name: str) -> NDArray:
        """An image as the agent saw it, the true one where it did not ask for it."""
        return self.observation[name] if name in self.observation else self.images[name]


class Watcher(Protocol):
    """Is told of each step; must not change what it is shown."""

    def begin(self, env: ObjectNavEnv) -> None:
        """An episode has been reset."""
        ...

    def decided(self, moment: Moment) -> None:
        """The agent has seen something and chosen an action; its map is as it was when it chose."""
        ...

    def moved(self, info: Mapping[str, Any]) -> None:
        """That action was carried out; `info` is the environment's."""
        ...

    def end(self, line: Mapping[str, Any]) -> None:
        """The episode is over; `line` holds its metrics, `error` among them if it broke."""
        ...

    def close(self) -> None:
        """Nothing more will be played; an episode that runs is dropped."""
        ...


class MapPainter(Protocol):
    """Draws a map of what is known at this moment."""

    @property
    def legend(self) -> tuple[tuple[str, Colour], ...]:
        """Name and colour of what it draws."""
        ...

    def paint(self, size_px: int) -> NDArray[np.uint8]:
        """RGB (size_px, size_px, 3)."""
        ...

    def words(self) -> str:
        """What the agent is about; "" where nobody knows."""
        ...
