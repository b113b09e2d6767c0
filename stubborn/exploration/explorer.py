"""The interface of explorers: an explorer proposes goal cells, the agent plans the routes and follows one.

An explorer is one class with two methods and holds no planner:

    class Farthest:
        def reset(self, seed: int) -> None: ...

        def explore(self, ground: Ground) -> Exploration:
            free = ground.free_space()
            route = yield Goal(free, my_choice_of(free.reachable))  # the planned route, or None
            return route
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import Literal, Protocol, TypeVar, runtime_checkable

import numpy as np
from jaxtyping import Bool

from sim.core.geometry.grid import Window
from sim.core.geometry.pose import Pose
from sim.core.interface import Action, CameraModel
from stubborn.mapping.navmap import CollisionLayer, NavMap
from stubborn.planning.planner import FreeSpace, Goal, Planner, Route

T = TypeVar("T")
Search = Generator[Goal, Route | None, Route | None]
"""Yields goals, gets the route to each or None, and returns the route to follow or None."""
Exploration = Generator[Goal, Route | None, Route | Action | None]
"""Like `Search`, but it may also return a turn on the spot, to look around."""


class Explorer(Protocol):
    """Chooses where to go while no candidate is known."""

    def reset(self, seed: int) -> None:
        """Forgets the last episode; random choices of this one come from `seed`."""
        ...

    def explore(self, ground: Ground) -> Exploration:
        """Yields goals until it returns a route to follow, a turn on the spot, or None when no path exists at all.

        It is called at each step of exploration. An explorer that pursues one goal over several steps must remember it.
        """
        ...


@runtime_checkable
class ReadsSemantics(Protocol):
    """An explorer that reads `NavMap.goals_seen`; for other explorers the agent does not fill it, which saves time."""

    reads_semantics: Literal[True]


@runtime_checkable
class ExplorerConfig(Protocol):
    """A frozen dataclass with the parameters of an explorer."""

    def make(self, camera: CameraModel) -> Explorer:
        """Returns a new explorer with these parameters."""
        ...


@dataclass(frozen=True)
class Ground:
    """The map around the robot that an explorer gets. An explorer must not change it."""

    navmap: NavMap
    """The whole map."""
    window: Window
    """The local window, which moves with the robot."""
    pose: Pose
    """The robot's pose in the start frame."""
    layers: tuple[CollisionLayer, ...]
    """Collision layers to plan on, in order of preference."""
    planner: Planner
    """The agent's planner, for the methods of this class."""
    goal: str
    """The goal category."""

    def free_space(
        self,
        window: Window | None = None,
        layer: CollisionLayer | None = None,
        costly: Bool[np.ndarray, "rows cols"] | None = None,
    ) -> FreeSpace:
        """Returns the free space of a window (the local one) on a collision layer (the preferred one).

        Routes avoid `costly` ground, a mask over the window.
        """
        view = self.navmap.view(self.window if window is None else window)
        return self.planner.free_space(view, self.pose, self.layers[0] if layer is None else layer, costly)

    def unseen(self, window: Window) -> Bool[np.ndarray, "rows cols"]:
        """Returns the ground of a window at some distance from all that was in view."""
        return self.planner.unseen(self.navmap.view(window))

    def unknown(self, window: Window) -> Bool[np.ndarray, "rows cols"]:
        """Returns the ground of a window that was never in view, up to the border of the ground that was."""
        return self.planner.unknown(self.navmap.view(window))


def run_explorer(explorer: Explorer, ground: Ground) -> Route | Action | None:
    """Plans to the goals that an explorer yields, and returns its choice."""
    return planned(explorer.explore(ground), ground.planner, ground.pose)


def planned(exploration: Generator[Goal, Route | None, T], planner: Planner, pose: Pose) -> T:
    """Plans to the goals that a generator yields, and returns what it returns."""
    try:
        goal = next(exploration)
        while True:
            goal = exploration.send(planner.route(goal, pose))
    except StopIteration as ended:
        return ended.value
