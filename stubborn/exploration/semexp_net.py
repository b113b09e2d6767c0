"""The network of `semexp`: a global policy over long-term goals, and the value of a map for its training."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Annotated

import msgspec
import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn.functional import avg_pool2d

from sim.interface import GOAL_CATEGORIES
from stubborn.exploration.semexp_input import GEOMETRY, PolicyInput, ViewConfig
from stubborn.network_files import Family

_Size = Annotated[int, msgspec.Meta(ge=1, le=512)]
_FASTER = 8.0
"""Factor of the shares that the last convolution gets; it makes their weights learn faster."""
_START = {
    GEOMETRY.index("frontier"): 4.0,
    GEOMETRY.index("seen"): -3.0,
    2 * len(GEOMETRY): 3.0,
    2 * len(GEOMETRY) + 2: 2.0,
}
"""Initial logits for a goal cell that is all frontier, all seen, 6 m ahead, 6 m away. The training starts with a policy
that moves into unseen ground, because PPO with few steps does not improve on random goals by itself."""
TRUTH = ("path to the target", "floor never seen", "steps left")
"""Inputs of the critic that the policy does not get: path length in 10 m, area as log(1 + m2 / 20), share of the steps
left."""


@dataclass(frozen=True, kw_only=True)
class NetConfig:
    """Sizes of the network and of its input."""

    goal_cells: _Size = 15
    local_pool: _Size = 4
    global_pool: _Size = 16
    relations: _Size = 8
    """Layers into which the goal categories are mixed, with weights that depend on the goal."""
    width: _Size = 24
    """Channels of the convolutions."""

    def __post_init__(self) -> None:
        self.view  # noqa: B018 - raises for sizes that do not fit each other

    @property
    def view(self) -> ViewConfig:
        """The sizes of the input."""
        return ViewConfig(**{each.name: getattr(self, each.name) for each in fields(ViewConfig)})


class SemExpNet(nn.Module):
    """Scores the cells of a grid over the local window as long-term goals.

    The 21 layers of the goal categories are mixed into a few by weights that belong to the goal, so that the relation
    between two categories is a number that is learned directly. The geometry of each square passes two convolutions of
    stride 2 and meets the categories at the resolution of the goal cells; the features of the global square are then
    interpolated at these. Layers with the position of each goal cell ahead and left of the robot carry the heading. A
    last convolution gives one logit per goal cell; it also gets the shares of each goal cell that are obstacle, seen
    and driven over, so that simple preferences are learned first.

    The value, which only the training uses, also gets facts that no agent knows (`TRUTH`): most of the return depends
    on the distance of the target and on the area that is left to see (an asymmetric critic; Pinto et al. 2018).
    """

    bits: Tensor
    blend: Tensor
    offset: Tensor

    def __init__(self, config: NetConfig) -> None:
        super().__init__()
        self.config = config
        width, half = config.width, max(config.width // 3, 1)
        self.relations = nn.Embedding(len(GOAL_CATEGORIES), config.relations * len(GOAL_CATEGORIES))
        nn.init.normal_(self.relations.weight, std=0.3)
        self.near_geometry, self.far_geometry = (
            nn.Sequential(_convolution(len(GEOMETRY), half, 2), _convolution(half, width, 2)) for _ in range(2)
        )
        both = width + config.relations + 1
        self.near = _convolution(both, width)
        self.far = nn.Sequential(_convolution(both, width), _convolution(width, width))
        self.goal = nn.Embedding(len(GOAL_CATEGORIES), width)
        nn.init.normal_(self.goal.weight, std=0.1)
        self.trunk = nn.Sequential(_convolution(2 * width + 4, width), _convolution(width, width))
        self.logit = nn.Conv2d(width + 4 + 2 * (len(GEOMETRY) + config.relations + 1), 1, 1)
        self.hidden_value, self.value = nn.Linear(3 * width + len(TRUTH), 2 * width), nn.Linear(2 * width, 1)
        self.prior = nn.Linear(len(TRUTH), 1)
        for layer, gain in ((self.logit, 0.3), (self.value, 0.3), (self.prior, 0.0)):
            nn.init.orthogonal_(layer.weight, gain)
            nn.init.zeros_(layer.bias)  # pyright: ignore[reportArgumentType]
        with torch.no_grad():
            self.logit.weight[0, width:, 0, 0] = 0.0
            for number, start in _START.items():
                self.logit.weight[0, width + number, 0, 0] = start / _FASTER
            self.prior.weight[0] = torch.tensor([0.7, 0.2, 0.0])  # about the return of a random policy
        self.register_buffer("bits", torch.arange(32, dtype=torch.int32).view(1, 32, 1, 1), persistent=False)
        self.register_buffer("blend", _blend(config), persistent=False)
        self.register_buffer("offset", _offsets(config), persistent=False)

    def forward(
        self,
        near: Float[Tensor, "n cells cells"],
        near_goals: Float[Tensor, "n blocks blocks"],
        far: Float[Tensor, "n cells cells"],
        far_goals: Float[Tensor, "n blocks blocks"],
        heading: Float[Tensor, "n 2"],
        goal: Float[Tensor, "n 1"],
        truth: Float[Tensor, "n facts"] | None = None,
    ) -> tuple[Float[Tensor, "n goals"], Float[Tensor, " n"]]:
        """Returns the logits of the goal cells, row by row, and the value; without `truth` the value is meaningless.

        Args:
            near: `Square.geometry` of the local square, as floats, like all arguments.
            near_goals: its `Square.goals`.
            far: `Square.geometry` of the global square.
            far_goals: its `Square.goals`.
            heading: cosine and sine of the heading.
            goal: index of the goal category.
            truth: the values that `TRUTH` names.
        """
        target = goal[:, 0].long()
        near_layers, far_layers = (self._unpacked(square, len(GEOMETRY)) for square in (near, far))
        near_mixed, far_mixed = (self._mixed(square, target) for square in (near_goals, far_goals))
        local = self.near(torch.cat((self.near_geometry(near_layers), near_mixed), 1))
        wide = self.far(torch.cat((self.far_geometry(far_layers), far_mixed), 1))
        places = self._places(heading)
        local = local + self.goal(target)[:, :, None, None]
        hidden = self.trunk(torch.cat((local, self._around(wide), places), 1))
        shares, mixed = self._around(avg_pool2d(far_layers, 4)), self._around(far_mixed)
        simple = torch.cat((avg_pool2d(near_layers, 4), shares, places), 1)
        direct = torch.cat((_FASTER * simple, near_mixed, mixed), 1)
        truth = heading.new_zeros(len(heading), len(TRUTH)) if truth is None else truth
        known = torch.cat((hidden.mean((2, 3)), hidden.amax((2, 3)), wide.mean((2, 3)), truth), 1)
        value = self.value(torch.relu(self.hidden_value(known))) + self.prior(truth)
        return self.logit(torch.cat((hidden, direct), 1)).flatten(1), value[:, 0]

    def _around(self, features: Float[Tensor, "n c rows cols"]) -> Float[Tensor, "n c goal_cells goal_cells"]:
        """Returns features of the global square at the goal cells."""
        return torch.einsum("gi,ncij,hj->ncgh", self.blend, features, self.blend)

    def _unpacked(self, packed: Float[Tensor, "n rows cols"], count: int) -> Float[Tensor, "n count rows cols"]:
        """Returns the lowest bits as layers of 0 and 1."""
        return (packed.to(torch.int32)[:, None] >> self.bits[:, :count] & 1).to(packed.dtype)

    def _mixed(self, packed: Float[Tensor, "n rows cols"], target: Tensor) -> Float[Tensor, "n layers rows cols"]:
        """Returns the layers of the mixed categories, and the layer of the goal category."""
        seen = self._unpacked(packed, len(GOAL_CATEGORIES))
        weights = self.relations(target).view(-1, self.config.relations, len(GOAL_CATEGORIES))
        mixed = torch.bmm(weights, seen.flatten(2)).view(-1, self.config.relations, *packed.shape[1:])
        return torch.cat((mixed, seen[torch.arange(len(target)), target][:, None]), 1)

    def _places(self, heading: Float[Tensor, "n 2"]) -> Float[Tensor, "n 4 goal_cells goal_cells"]:
        """Returns the place of each goal cell: ahead and left of the robot, its distance, and the robot's own cell."""
        y, x = self.offset[0], self.offset[1]
        cos, sin = heading[:, 0, None, None], heading[:, 1, None, None]
        away = torch.hypot(x, y).expand(len(heading), -1, -1)
        return torch.stack((cos * x + sin * y, cos * y - sin * x, away, (away < 0.1).to(away.dtype)), 1)


def _convolution(before: int, after: int, stride: int = 1) -> nn.Sequential:
    return nn.Sequential(nn.Conv2d(before, after, 3, stride=stride, padding=1), nn.ReLU())


def _offsets(config: NetConfig) -> Tensor:
    """Returns row and column of each goal cell from the robot, (2, goal_cells, goal_cells) in halves of the window."""
    along = (torch.arange(config.goal_cells) + 0.5 - _middle(config)) / (0.5 * config.goal_cells)
    return torch.stack(torch.meshgrid(along, along, indexing="ij"))


def _blend(config: NetConfig) -> Tensor:
    """Returns the shares of the cells of the global features in each goal cell, (goal_cells, goal_cells), for an axis.

    The robot is in the middle of both grids; a global feature is larger than a goal cell by the ratio of the pools.
    """
    count, middle = torch.arange(config.goal_cells), _middle(config)
    at = (count + 0.5 - middle) * config.local_pool / config.global_pool + middle - 0.5
    return (1.0 - (at[:, None] - count).abs()).clamp(min=0.0)


def _middle(config: NetConfig) -> float:
    """Returns the place of the robot along an axis of goal cells: the middle of the square's middle cell."""
    cells = config.view.cells
    return (cells // 2 + 0.5) * config.goal_cells / cells


def as_tensors(given: PolicyInput) -> tuple[Tensor, ...]:
    """Returns the arguments of `SemExpNet` for one input."""
    squares = (*given.near, *given.far)
    return (
        *(torch.from_numpy(square.astype(np.float32))[None] for square in squares),
        torch.from_numpy(given.heading)[None],
        torch.tensor([[float(given.goal)]]),
    )


def scores(net: SemExpNet, given: PolicyInput) -> Float[np.ndarray, " goals"]:
    """Returns the logits of the goal cells."""
    with torch.inference_mode():
        return net(*as_tensors(given))[0][0].numpy()


FILES = Family("semexp", NetConfig, SemExpNet, "`stubborn train semexp`", half=False)
"""Reads and writes files of weights."""
