"""Chains that are drawn: new objects at each goal unless it is a second visit, and each goal away from the last."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from sim.core.goals import GoalSpec
from sim.episodes.chains import MAX_GOALS, MIN_APART_M, MIN_GOALS, ChainDrawer
from sim.episodes.splits import load_split
from sim.task.objectnav import Task
from sim.world.world import World
from tests.helpers.worlds import room, with_box

PLACES = {"bed": (4.0, 0.0), "table": (-4.0, 2.0), "sofa": (-4.0, -2.0), "chair": (0.0, 2.4), "plant": (0.0, -2.4),
          "sink": (4.0, 2.4), "toilet": (4.0, -2.4)}  # fmt: skip


@pytest.fixture(scope="module")
def task() -> Task:
    house = room(10, 6)
    for name, (x, y) in PLACES.items():
        house = with_box(house, f"{name}_00", centre_m=(x, y, 0.25), half_m=(0.2, 0.2, 0.25))
    return Task(World(house))


def test_chains_keep_their_rules_in_a_small_house(task: Task) -> None:
    goals = {"category": [GoalSpec.of(name) for name in PLACES], "words": [GoalSpec.of("couch"), GoalSpec.of("basin")]}
    drawer, rng = ChainDrawer(task, goals, 0.0), np.random.default_rng(0)
    chains = [chain for _ in range(30) if (chain := drawer.draw(rng))]
    assert len(chains) >= 20
    assert len({len(chain) for chain in chains}) >= 3
    for chain in chains:
        require_rules(task, chain)
    kinds = Counter(goal.kind for chain in chains for goal in chain)
    assert kinds["words"] > 20
    assert any(goal.repeats is not None for chain in chains for goal in chain)
    texts = [(goal.text, chain[goal.repeats].text) for chain in chains for goal in chain if goal.repeats is not None]
    assert any(again != first for again, first in texts)  # in other words


def test_a_house_with_too_few_goals_has_no_chain(task: Task) -> None:
    drawer = ChainDrawer(task, {"category": [GoalSpec.of("bed"), GoalSpec.of("table")]}, 0.0)
    assert [drawer.draw(np.random.default_rng(seed)) for seed in range(5)] == [()] * 5


def require_rules(task: Task, chain: tuple[GoalSpec, ...], floor_z_m: float = 0.0) -> None:
    """Asserts that a chain keeps the rules of the module, computed anew for its texts."""
    assert MIN_GOALS <= len(chain) <= MAX_GOALS
    objects = [frozenset(instance.name for instance in task.truth.instances(goal)) for goal in chain]
    inside = task.truth.space(floor_z_m).largest_part()
    for number, goal in enumerate(chain):
        if goal.repeats is None:
            assert not any(objects[number] & earlier for earlier in objects[:number])
        else:
            assert objects[number] == objects[goal.repeats]
            assert goal.repeats < number - 1
        if number:
            ends = task.truth.target(chain[number - 1].text, floor_z_m).reached & inside
            lengths_m = task.truth.target(goal.text, floor_z_m).distance_m[ends]
            assert MIN_APART_M <= lengths_m.min() <= lengths_m.max() < np.inf


@pytest.mark.costly
def test_the_shipped_chains_mean_what_they_meant_when_they_were_made() -> None:
    split = load_split("chains-val")
    assert len(split.episodes) >= 100
    assert all(episode.is_chain for episode in split.episodes)
    kinds = Counter(goal.kind for episode in split.episodes for goal in episode.specs)
    assert min(kinds[kind] for kind in ("category", "words", "description")) > 100
    again = sum(goal.repeats is not None for episode in split.episodes for goal in episode.specs)
    assert again > 0.1 * kinds.total()
    house = "val_06"
    task = Task(World(split.load_house(house)))
    for episode in split.episodes:
        if episode.house == house:
            require_rules(task, episode.specs, episode.start.floor_z_m)
            assert task.distance_from(episode.goal, episode.start) == pytest.approx(episode.shortest_path_m)
