"""Derives the seeds of a run's episodes from its one seed, `--seed`; nothing else derives a seed of an episode."""

from __future__ import annotations

import hashlib
import zlib
from typing import NamedTuple

import numpy as np


class EpisodeSeeds(NamedTuple):
    """The seeds of one episode, each in [0, 2**32)."""

    environment: int
    """Seed of the noise of sensors and drive; it depends only on the run's seed and the episode's id."""
    agent: int
    """A hash with the key of the run, which no agent gets."""


def episode_seeds(seed: int, episode_id: str, key: str | None = None) -> EpisodeSeeds:
    """Returns the seeds of an episode.

    Args:
        seed: the run's seed.
        episode_id: the episode's id.
        key: the run's key (`--seed-key`). Without one, an agent could identify the episode by its seed, because the
            episodes of public splits are known.
    """
    environment = np.random.SeedSequence([seed, zlib.crc32(episode_id.encode())]).generate_state(1)[0]
    secret = hashlib.sha256((key or "").encode()).digest()
    agent = hashlib.blake2b(f"{seed}/{episode_id}".encode(), key=secret, digest_size=4).digest()
    return EpisodeSeeds(int(environment), int.from_bytes(agent, "big"))


def drawing_generator(seed: int, number: int) -> np.random.Generator:
    """Returns the generator that draws episode `number` in a house, from a run's seed."""
    return np.random.default_rng([seed, number])
