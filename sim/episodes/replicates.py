"""Replicates of episodes: the same goal from starts that are moved by a centimetre."""

from __future__ import annotations

import math
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from sim.episodes.episode import Episode

MOVED_M = 0.01
"""Distance of the start of a replicate from that of its episode."""
MARK = "~"
"""Separates the id of an episode and the number of the replicate."""


def with_replicates(episodes: Sequence[Episode], count: int) -> list[Episode]:
    """Returns each episode, followed by its `count - 1` other replicates; `val_0003~1` is the first of `val_0003`.

    The direction in which a start moves depends on the episode's id and the number of the replicate only.
    """
    return [replicate(episode, number) for episode in episodes for number in range(count)]


def replicate(episode: Episode, number: int) -> Episode:
    """Returns a replicate of an episode; number 0 is the episode itself."""
    if number == 0:
        return episode
    angle = np.random.default_rng([zlib.crc32(episode.episode_id.encode()), number]).uniform(0.0, math.tau)
    x_m, y_m = MOVED_M * math.cos(angle), MOVED_M * math.sin(angle)
    start = replace(episode.start, x_m=episode.start.x_m + x_m, y_m=episode.start.y_m + y_m)
    return replace(episode, episode_id=f"{episode.episode_id}{MARK}{number}", start=start, shortest_path_m=None)


def replicate_number(episode_id: str) -> int:
    """Returns the number of the replicate that an episode's id names; 0 for the episode itself."""
    stem, mark, number = episode_id.rpartition(MARK)
    return int(number) if stem and mark and number.isdecimal() else 0


def episode_of(episode_id: str) -> str:
    """Returns the id of the episode that a replicate repeats; the id of an episode itself is returned unchanged."""
    return episode_id.rpartition(MARK)[0] if replicate_number(episode_id) else episode_id


def find_episode(episodes: Mapping[str, Episode], episode_id: str) -> Episode | None:
    """Returns the episode or the replicate with an id; None if it does not exist.

    Args:
        episodes: the episodes of a split by id, without replicates.
        episode_id: for example `val_0003` or `val_0003~1`. Numbers are written in one way: `val_0003~01` is not an id.
    """
    if episode_id in episodes:
        return episodes[episode_id]
    original = episodes.get(episode_id.rpartition(MARK)[0])
    if original is None:
        return None
    copy = replicate(original, replicate_number(episode_id))
    return copy if copy.episode_id == episode_id else None
