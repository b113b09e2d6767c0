"""The network of the cloned policy: a small convolutional encoder and a recurrent unit that gives the next action."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Annotated

import msgspec
import torch
from jaxtyping import Float, UInt8
from torch import Tensor, nn

from sim.core.interface import GOAL_CATEGORIES, MOVES, MPCAT40
from stubborn.baselines.cloned_input import GOAL_IDS, HEIGHT_PX, LEVELS, MOTION, NO_ACTION, WIDTH_PX
from stubborn.network_files import Family

_Size = Annotated[int, msgspec.Meta(ge=1, le=2048)]
_STRIDES = 4
"""Convolutions that halve the image: 64 x 48 becomes 4 x 3."""


@dataclass(frozen=True, kw_only=True)
class NetConfig:
    """Sizes of the network."""

    categories: _Size = 8
    """Length of the embedding of a pixel's category."""
    width: _Size = 32
    """Channels of the first convolution; the others have 2, 4 and 4 times as many."""
    goal: _Size = 32
    """Length of the embeddings of the goal and of the previous action."""
    hidden: _Size = 256
    """Length of an encoded image and of the state of the recurrent unit."""


class ClonedNet(nn.Module):
    """Gives the logits of the next action from a sequence of small images.

    The layer of the goal marks the pixels of the goal category, so that a policy does not have to learn each of the 21
    categories separately; the embedding of the categories shows it where such goals are usual.
    """

    goal_ids: Tensor

    def __init__(self, config: NetConfig = NetConfig()) -> None:
        super().__init__()
        self.config = config
        self.category = nn.Embedding(len(MPCAT40), config.categories)
        widths = (config.categories + 3, config.width, 2 * config.width, 4 * config.width, 4 * config.width)
        layers: list[nn.Module] = []
        for before, after in itertools.pairwise(widths):
            layers += [nn.Conv2d(before, after, 3, stride=2, padding=1), nn.GroupNorm(1, after), nn.ReLU()]
        self.encoder = nn.Sequential(*layers)
        self.encoder.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue] - its stub lacks it
        cells = (WIDTH_PX >> _STRIDES) * (HEIGHT_PX >> _STRIDES)
        self.seen = nn.Sequential(nn.Linear(4 * config.width * cells, config.hidden), nn.ReLU())
        self.goal = nn.Embedding(len(GOAL_CATEGORIES), config.goal)
        self.before = nn.Embedding(NO_ACTION + 1, config.goal)
        self.memory = nn.GRU(config.hidden + 2 * config.goal + len(MOTION), config.hidden)
        self.action = nn.Linear(config.hidden, len(MOVES))
        self.register_buffer("goal_ids", torch.from_numpy(GOAL_IDS.astype("int64")), persistent=False)

    def forward(
        self,
        depth: UInt8[Tensor, "steps n h w"],
        categories: UInt8[Tensor, "steps n h w"],
        motion: Float[Tensor, "steps n motion"],
        before: UInt8[Tensor, "steps n"],
        goal: Tensor,
        state: Float[Tensor, "1 n hidden"] | None = None,
    ) -> tuple[Float[Tensor, "steps n actions"], Float[Tensor, "1 n hidden"]]:
        """Returns the logits of the actions at each step, and the state after the last step.

        Args:
            depth: see `Steps`, also for the next three arguments; n parallel sequences.
            categories: mpcat40 ids.
            motion: the numbers that `MOTION` names.
            before: the action that precedes each step.
            goal: (n,) index of the goal category.
            state: state after the previous step; None at the start of an episode.
        """
        steps, count = depth.shape[:2]
        ids = categories.flatten(0, 1).long()
        marked = ids == self.goal_ids[goal].repeat(steps)[:, None, None]
        level = depth.flatten(0, 1)
        layers = (level.float() / LEVELS, (level == 0).float(), marked.float())
        channels = torch.cat((self.category(ids), *(layer[..., None] for layer in layers)), 3)
        features = self.encoder(channels.permute(0, 3, 1, 2))  # its channels stay last in memory, which is faster
        seen = self.seen(features.flatten(1)).view(steps, count, -1)
        goals = self.goal(goal).expand(steps, -1, -1)
        inputs = torch.cat((seen, goals, self.before(before.long()), motion), 2)
        hidden, after = self.memory(inputs, state)
        return self.action(hidden), after


FILES = Family("cloned", NetConfig, ClonedNet, "`stubborn train cloned`")
"""Reads and writes files of weights."""
