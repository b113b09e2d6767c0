"""The network of `semexp`: the published policy over long-term goals, with the names of its published weights.

Reference: Chaplot et al. (2020), "Object Goal Navigation using Goal-Oriented Semantic Exploration", and the policy of
its published code.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import msgspec
import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor, nn

from sim.core.interface import GOAL_CATEGORIES, ConfigError
from stubborn.exploration.semexp_input import CELLS, GEOMETRY, GIBSON, HEADINGS, PolicyInput
from stubborn.network_files import Family, read_checkpoint, with_weights

_POOLINGS = 8
"""Factor by which the network's own poolings reduce the edge of a map."""


@dataclass(frozen=True, kw_only=True)
class NetConfig:
    """Sizes of the network; the defaults are the published ones, for our 21 goal categories."""

    categories: Annotated[int, msgspec.Meta(ge=1, le=24)] = len(GOAL_CATEGORIES)
    """Semantic channels; the published network has 16."""
    cells: Annotated[int, msgspec.Meta(ge=8, le=512, multiple_of=_POOLINGS)] = CELLS
    """Edge of both maps of the input."""
    hidden: Annotated[int, msgspec.Meta(ge=1, le=1024)] = 256
    """Width of the first linear layer."""

    @property
    def channels(self) -> tuple[str | None, ...]:
        """The category of each semantic channel, None for a channel without a category.

        Raises:
            ConfigError: `categories` is not the length of a known list of categories.
        """
        lists = {len(GOAL_CATEGORIES): GOAL_CATEGORIES, len(GIBSON): GIBSON}
        if self.categories not in lists:
            counts = " or ".join(map(str, lists))
            raise ConfigError(f"A network of semexp needs {counts} semantic channels, got {self.categories}.")
        return lists[self.categories]


class SemanticPolicy(nn.Module):
    """Features of the maps, the heading and the goal for the distribution of actions, and the value."""

    def __init__(self, config: NetConfig) -> None:
        super().__init__()
        layers: list[nn.Module] = [nn.Identity()]  # the first pooling, which `semexp_input` has done
        sizes = (config.categories + 2 * len(GEOMETRY), 32, 64, 128, 64, 32)
        for number, (before, after) in enumerate(itertools.pairwise(sizes)):
            layers += [nn.MaxPool2d(2)] if 1 <= number <= 3 else []
            layers += [nn.Conv2d(before, after, 3, padding=1), nn.ReLU()]
        self.main = nn.Sequential(*layers, nn.Flatten())
        self.linear1 = nn.Linear(32 * (config.cells // _POOLINGS) ** 2 + 16, config.hidden)
        self.linear2 = nn.Linear(config.hidden, 256)
        self.critic_linear = nn.Linear(256, 1)
        self.orientation_emb = nn.Embedding(HEADINGS, 8)
        self.goal_emb = nn.Embedding(config.categories, 8)

    def forward(
        self, maps: Float[Tensor, "n layers cells cells"], heading: Tensor, goal: Tensor
    ) -> tuple[Float[Tensor, "n 256"], Float[Tensor, " n"]]:
        """Returns the features and the value; `heading` and `goal` are indices, (n,)."""
        inputs = torch.cat((self.main(maps), self.orientation_emb(heading), self.goal_emb(goal)), 1)
        features = torch.relu(self.linear2(torch.relu(self.linear1(inputs))))
        return features, self.critic_linear(features)[:, 0]


class _Bias(nn.Module):
    """A vector of parameters."""

    def __init__(self, count: int) -> None:
        super().__init__()
        self._bias = nn.Parameter(torch.zeros(count, 1))

    def forward(self) -> Float[Tensor, " count"]:
        """Returns the vector."""
        return self._bias[:, 0]


class _Gaussian(nn.Module):
    """A normal distribution of each action with independent components."""

    def __init__(self, inputs: int, outputs: int) -> None:
        super().__init__()
        self.fc_mean = nn.Linear(inputs, outputs)
        nn.init.orthogonal_(self.fc_mean.weight)
        nn.init.zeros_(self.fc_mean.bias)
        self.logstd = _Bias(outputs)

    def forward(self, features: Tensor) -> tuple[Tensor, Tensor]:
        """Returns the means, (n, outputs), and the logarithms of the standard deviations, (outputs,)."""
        return self.fc_mean(features), self.logstd()


class SemExpNet(nn.Module):
    """Means and deviations of an action, and the value of the maps.

    The sigmoid of the action is a point of the local map.
    """

    bits: Tensor

    def __init__(self, config: NetConfig) -> None:
        super().__init__()
        self.config = config
        self.network = SemanticPolicy(config)
        self.dist = _Gaussian(256, 2)
        self.register_buffer("bits", torch.arange(32, dtype=torch.int32).view(1, 32, 1, 1), persistent=False)

    def forward(
        self,
        geometry: Float[Tensor, "n cells cells"],
        goals: Float[Tensor, "n cells cells"],
        heading: Float[Tensor, "n 1"],
        goal: Float[Tensor, "n 1"],
    ) -> tuple[Float[Tensor, "n 2"], Float[Tensor, " 2"], Float[Tensor, " n"]]:
        """Returns means and logarithms of deviations of the action, and the value; see `PolicyInput` for the input."""
        maps = torch.cat(
            (self._unpacked(geometry, 2 * len(GEOMETRY)), self._unpacked(goals, self.config.categories)), 1
        )
        features, value = self.network(maps, heading[:, 0].long(), goal[:, 0].long())
        return *self.dist(features), value

    def _unpacked(self, packed: Float[Tensor, "n rows cols"], count: int) -> Float[Tensor, "n count rows cols"]:
        """Returns the lowest bits as layers of 0 and 1."""
        return (packed.to(torch.int32)[:, None] >> self.bits[:, :count] & 1).to(packed.dtype)


def as_arrays(policy_input: PolicyInput) -> dict[str, np.ndarray]:
    """Returns an input as float32 arrays, by the names of the arguments of `SemExpNet`."""
    return {
        "geometry": policy_input.geometry.astype(np.float32),
        "goals": policy_input.goals.astype(np.float32),
        "heading": np.array([policy_input.heading], np.float32),
        "goal": np.array([policy_input.goal], np.float32),
    }


def action_of(net: SemExpNet, policy_input: PolicyInput) -> tuple[Float[np.ndarray, " 2"], Float[np.ndarray, " 2"]]:
    """Returns means and standard deviations of the action, before the sigmoid."""
    with torch.inference_mode():
        tensors = {name: torch.from_numpy(array)[None] for name, array in as_arrays(policy_input).items()}
        mean, logstd, _ = net(**tensors)
        return mean[0].numpy(), logstd.exp().numpy()


FILES = Family("semexp", NetConfig, SemExpNet, "`stubborn train semexp`")
"""Reads and writes files of weights."""


def load(file: Path) -> SemExpNet:
    """Returns the network of a file: weights of `stubborn train semexp`, or a published checkpoint (`.pth`).

    Raises:
        ConfigError: the file does not exist, is broken, or holds another network.
    """
    if file.suffix not in (".pth", ".pt"):
        return FILES.load(file)[0]
    checkpoint = read_checkpoint(file)
    names = ("network.goal_emb.weight", "network.linear1.weight")
    if not all(isinstance(checkpoint.get(name), Tensor) and checkpoint[name].ndim == 2 for name in names):
        raise ConfigError(f"Weights '{file}' are not of semexp: they need the tensors {' and '.join(names)}.")
    hidden, inputs = checkpoint[names[1]].shape
    cells = _POOLINGS * round(max(inputs - 16, 0) ** 0.5 / 32**0.5)
    sizes = {"categories": checkpoint[names[0]].shape[0], "cells": cells, "hidden": hidden}
    try:
        config = msgspec.convert(sizes, NetConfig)
    except msgspec.ValidationError as error:
        raise ConfigError(f"Weights '{file}' are not of semexp: {error}.") from None
    return with_weights(file, checkpoint, lambda: SemExpNet(config))
