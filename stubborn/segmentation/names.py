"""Probabilities of everyday names within the categories of mpcat40: a fridge or a cooker among the appliances.

A second head of the network gives a logit of each name. The softmax is taken over the names of one category at a time,
so that the head only says which object of a category a pixel shows, and the categories stay those of the first head.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32

from sim.core.interface import MPCAT40_ID, ConfigError
from sim.core.vocabulary import vocabulary


@dataclass(frozen=True, eq=False)
class NameGroups:
    """Names, and which of them each category has."""

    names: tuple[str, ...]
    channels: tuple[int, ...]
    """The posteriors' channels of the categories that have one of the names."""
    members: Bool[np.ndarray, "categories names"]
    """For each of these categories, which names objects of it can have."""

    @classmethod
    def of(cls, names: Sequence[str]) -> NameGroups:
        """Returns the groups of some names.

        Raises:
            ConfigError: a name is not in the vocabulary.
        """
        known = vocabulary().categories
        if unknown := [name for name in names if name not in known]:
            raise ConfigError(f"A network's name '{unknown[0]}' is not in the vocabulary.")
        channels = sorted({MPCAT40_ID[category] - 1 for name in names for category in known[name]})
        members = np.zeros((len(channels), len(names)), np.bool_)
        for number, name in enumerate(names):
            for category in known[name]:
                members[channels.index(MPCAT40_ID[category] - 1), number] = True
        return cls(tuple(names), tuple(channels), members)

    def probabilities(
        self, logits: Float32[np.ndarray, "names h w"], posteriors: Float32[np.ndarray, "classes rows cols"]
    ) -> Float32[np.ndarray, "names h w"]:
        """Returns the probability that a pixel shows an object of a name.

        Args:
            logits: of the second head.
            posteriors: of the categories, at the same resolution or a multiple of it.
        """
        every = posteriors.shape[1] // logits.shape[1]
        of_category = posteriors[list(self.channels), every // 2 :: every, every // 2 :: every]
        odds = np.exp(np.clip(logits - logits.max(axis=0), -60.0, 0.0)).reshape(len(self.names), -1)
        share = of_category.reshape(len(self.channels), -1) / (self.members @ odds)
        return (odds * (self.members.T.astype(np.float32) @ share)).reshape(logits.shape).astype(np.float32)
