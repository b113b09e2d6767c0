"""The interface of viewers: objects such as a video, a window or a log that are informed of each step of an episode.

`sim.app.evaluation.rollout.play_episode` calls the methods of each `Viewer`; a viewer changes no state. The agent's map
is drawn by a `MapPainter` that comes with the agent; `sim.app.viewers.topview` is one that draws the true floor plan.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from sim.core.interface import Action, Observation, Perceived
from sim.task.result import RolloutResult

if TYPE_CHECKING:  # only for the annotation
    from sim.env.objectnav import ObjectNavEnv

Colour = tuple[int, int, int]
VIEWER_IMAGES: tuple[str, ...] = ("rgb", "depth", "semantic")
"""Images that the environment must render (`truth=`) for viewers, in addition to the sensors of the agent."""


@dataclass(frozen=True, kw_only=True)
class Moment:
    """One decision of the agent: the images before it, and the chosen action."""

    step: int
    """Number of the action, from 1."""
    observation: Observation
    """The observation that the agent got."""
    images: Mapping[str, NDArray]
    """The images of the same moment without noise; holds all of `VIEWER_IMAGES`."""
    action: Action
    """The action that the agent chose."""

    def seen(self, name: str) -> NDArray:
        """Returns an image of the observation, or the true image where the agent has no such sensor."""
        return self.observation[name] if name in self.observation else self.images[name]


class Viewer(Protocol):
    """An object that is informed of each step; it must not change what it receives."""

    def begin(self, env: ObjectNavEnv) -> None:
        """Called after an episode has been reset."""
        ...

    def decided(self, moment: Moment) -> None:
        """Called after the agent has chosen an action and before the environment executes it."""
        ...

    def moved(self, info: Mapping[str, object]) -> None:
        """Called after the environment has executed the action; `info` is that of `env.step`."""
        ...

    def end(self, result: RolloutResult) -> None:
        """Called at the end of the episode, also of one that failed."""
        ...

    def close(self) -> None:
        """Called after the last episode, or when a run is interrupted; an unfinished episode is discarded."""
        ...


class SeesFrames(Protocol):
    """Provides the segmentation that an agent acts on to viewers; a call changes nothing."""

    @property
    def name(self) -> str:
        """Returns the name of the segmentation, such as "rednet" or "ground truth"."""
        ...

    @property
    def names(self) -> bool:
        """Returns whether it names the category of each pixel."""
        ...

    def perceived(self, observation: Observation, goal: str) -> Perceived | None:
        """Returns the segmentation of the present frame; None: the agent did not use it."""
        ...


class MapPainter(Protocol):
    """An object that draws a map of the current state."""

    @property
    def legend(self) -> tuple[tuple[str, Colour], ...]:
        """Name and colour of each item in the map."""
        ...

    def paint(self, size_px: int) -> NDArray[np.uint8]:
        """Returns an RGB image (size_px, size_px, 3)."""
        ...

    def words(self) -> str:
        """Returns what the agent is doing, such as "explores"; "" if that is not known."""
        ...
