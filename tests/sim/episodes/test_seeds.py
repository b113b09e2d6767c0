"""The seeds of an episode: those of the runs that exist, and different for each episode, run and key."""

from __future__ import annotations

import numpy as np

from sim.episodes.seeds import drawing_generator, episode_seeds


def test_seeds_are_those_of_the_runs_that_exist() -> None:
    assert episode_seeds(3, "val_0001", "key") == (2255758523, 3976162300)
    assert episode_seeds(3, "val_0001") == (2255758523, 177268404)
    assert drawing_generator(3, 7).integers(2**32) == np.random.default_rng([3, 7]).integers(2**32)


def test_seeds_differ_by_run_and_episode_and_that_of_the_agent_by_key() -> None:
    seeds = [episode_seeds(run, name, key) for run in (0, 1) for name in ("a", "b") for key in ("k", "l" * 200)]
    assert len({seed.agent for seed in seeds}) == 8
    assert len({seed.environment for seed in seeds}) == 4
