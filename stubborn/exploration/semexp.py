"""Goal-oriented semantic exploration: a learned global policy chooses long-term goals on the semantic map.

Reference: Chaplot, Gandhi, Gupta, Salakhutdinov (2020), "Object Goal Navigation using Goal-Oriented Semantic
Exploration", NeurIPS, arXiv 2007.00643. The policy has the inputs, layers and outputs of the published code and loads
its weights; the weights that ship were trained in house plans by `stubborn train semexp`, from random ones. The two
controls of Luo et al. (2022, Section "Analysis of SemExp Agent") are options: the semantic layers shuffled, and a wrong
goal given to the policy.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float

from sim.core.geometry.grid import cells_near_segment
from sim.core.interface import GOAL_CATEGORIES, CameraModel, ConfigError
from stubborn.exploration.explorer import Exploration, Ground, Search
from stubborn.exploration.potentials import GoalKind, SemanticsKind
from stubborn.exploration.semexp_input import CELLS, PolicyInput, observe
from stubborn.planning.planner import FreeSpace, Goal

SHIPPED = Path(__file__).with_name("weights") / "semexp.safetensors"
"""The shipped weights."""

Policy = Callable[[PolicyInput], tuple[Float[np.ndarray, " 2"], Float[np.ndarray, " 2"]]]
"""A function that returns means and standard deviations of an action; its sigmoid is a point of the local map."""


@dataclass(frozen=True, kw_only=True)
class SemExpConfig:
    """The weights, the duration of a long-term goal, and the controls."""

    weights: str | None = None
    """File of weights, also a published checkpoint (`.pth`); None: the shipped weights."""
    goal_steps: int = 25
    """A new long-term goal is chosen after this many steps, and when a goal is reached."""
    goal_radius_m: float = 0.5
    """Any cell within this distance of the long-term goal counts as the goal."""
    arrived_m: float = 0.35
    """A long-term goal counts as reached within this path length."""
    sampled: bool = True
    """True: goals are sampled from the policy, as its published evaluation does; False: its mean is taken."""
    semantics: SemanticsKind = "seen"
    """The goal categories on the map that the policy gets: all of them, all of them exchanged at random in each episode
    (the first control), or no category."""
    goal: GoalKind = "true"
    """The goal that the policy gets: the episode's, or another one, sampled in each episode (the second control)."""

    def __post_init__(self) -> None:
        if self.goal_steps < 1 or self.arrived_m <= 0.0:
            raise ConfigError(
                f"SemExpConfig needs goal_steps >= 1 and arrived_m > 0, got {self.goal_steps} and {self.arrived_m} m."
            )

    def make(self, camera: CameraModel) -> SemExpExplorer:
        """Returns a new explorer with these parameters.

        Raises:
            ConfigError: the file of weights does not exist, or does not hold a network of `semexp`.
        """
        from stubborn.exploration.semexp_net import action_of, load  # imports PyTorch

        net = load(SHIPPED if self.weights is None else Path(self.weights))
        config = net.config
        return SemExpExplorer(
            self, lambda policy_input: action_of(net, policy_input), config.channels, cells=config.cells
        )


class SemExpExplorer:
    """Heads for the long-term goal of the policy for some steps, or for the reachable cell nearest to it."""

    reads_semantics: Literal[True] = True

    def __init__(
        self,
        config: SemExpConfig,
        policy: Policy,
        channels: Sequence[str | None] = GOAL_CATEGORIES,
        *,
        cells: int = CELLS,
    ) -> None:
        """`channels` and `cells` are those of `observe`."""
        self.config = config
        self.policy = policy
        self.channels = tuple(channels)
        self.cells = cells
        self.reset()

    def reset(self, seed: int = 0) -> None:
        """Forgets the last episode; the random choices of this one come from `seed`."""
        self._rng = np.random.default_rng(seed)
        self.shuffled = tuple(self.channels[i] for i in self._rng.permutation(len(self.channels)))
        """The category that each semantic channel shows in the control `shuffled`."""
        self._other = int(self._rng.integers(1, len(self._known)))  # how far the wrong goal is in the list
        self.place_xy_m: tuple[float, float] | None = None
        """The long-term goal."""
        self._age_steps = 0

    def explore(self, ground: Ground) -> Exploration:
        """Returns the route to the long-term goal; None when it is reached, so that the agent pushes on."""
        if self.place_xy_m is not None and self._age_steps < self.config.goal_steps:
            route = yield from self._go_on(self.place_xy_m, ground)
            if route is not None:
                self._age_steps += 1
                return route
        self.place_xy_m, self._age_steps = self._chosen_xy_m(ground), 1
        return (yield from self._go_on(self.place_xy_m, ground))

    def _go_on(self, place_xy_m: tuple[float, float], ground: Ground) -> Search:
        """Returns the route to a long-term goal; None when it is reached on all layers of collisions."""
        for layer in ground.layers:
            route = yield from head_for(place_xy_m, ground.free_space(layer=layer), self.config.goal_radius_m)
            if route is not None and route.length_m > self.config.arrived_m:
                return route
        return None

    @property
    def _known(self) -> list[str]:
        """The categories that have a channel."""
        return [name for name in self.channels if name]

    def policy_goal(self, goal: str) -> str:
        """Returns the goal category that the policy gets.

        Raises:
            ConfigError: the policy has no channel of the goal category.
        """
        if goal not in self._known:
            raise ConfigError(f"The policy of semexp has no category '{goal}', only {', '.join(self._known)}.")
        if self.config.goal == "true":
            return goal
        return self._known[(self._known.index(goal) + self._other) % len(self._known)]

    def _chosen_xy_m(self, ground: Ground) -> tuple[float, float]:
        """Returns the next long-term goal of the policy."""
        shown = {"seen": self.channels, "shuffled": self.shuffled, "none": ()}[self.config.semantics]
        goal = self.channels.index(self.policy_goal(ground.goal))
        policy_input = observe(ground.navmap, ground.pose, goal, shown, cells=self.cells)
        mean, deviation = self.policy(policy_input)
        action = self._rng.normal(mean, deviation) if self.config.sampled else mean
        return policy_input.place_xy_m(sigmoid(action))


def sigmoid(action: Float[np.ndarray, " 2"]) -> Float[np.ndarray, " 2"]:
    """Returns the point of the local map that an action means, as shares of its rows and columns."""
    return 1.0 / (1.0 + np.exp(-np.clip(action, -30.0, 30.0)))


def head_for(place_xy_m: tuple[float, float], free: FreeSpace, radius_m: float) -> Search:
    """Returns the route to a point, else to the reachable cell nearest to it."""
    cells = np.zeros(free.frame.shape, np.bool_)
    index, inside = cells_near_segment(free.frame, place_xy_m, place_xy_m, radius_m)
    cells[index] = inside
    route = yield Goal(free, cells)
    if route is not None:
        return route
    cell_x_m, cell_y_m = free.frame.mesh()
    gap_m = np.where(free.reachable, np.hypot(cell_x_m - place_xy_m[0], cell_y_m - place_xy_m[1]), np.inf)
    return (yield Goal(free, gap_m == gap_m.min()))
