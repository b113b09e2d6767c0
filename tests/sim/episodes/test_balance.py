"""Episodes of the shipped splits are balanced over houses and goals, and their distances are within the limits."""

from __future__ import annotations

import collections
import functools
import math

import pytest

from sim.core.interface import FORWARD_M, GOAL_CATEGORIES, MAX_STEPS
from sim.episodes.recipes import EPISODE_RECIPES
from sim.episodes.splits import Split, load_split

SPLITS = {
    "val": (30, 1020), "test": (30, 1020), "large": (20, 600), "hazards": (15, 450), "train": (200, 2000),
    "large-test": (20, 600), "hazards-test": (15, 450),
}  # fmt: skip
"""Number of houses and episodes of each split."""
MIN_HOUSES = 5
"""Smallest number of houses with episodes of a category."""
TURNS_AT_START = 6

load = functools.cache(load_split)
every_split = pytest.mark.parametrize("split", SPLITS)
every_split_of_all_goals = pytest.mark.parametrize("split", [n for n in SPLITS if EPISODE_RECIPES[n].rule == "any"])
"""Other rules leave some goals of a house without a start."""


def goals_asked(split: Split) -> collections.Counter[str]:
    return collections.Counter(episode.goal for episode in split.episodes)


@every_split
def test_a_split_has_its_houses_and_episodes(split: str) -> None:
    assert (len(load(split).houses), len(load(split).episodes)) == SPLITS[split]
    assert len({episode.episode_id for episode in load(split).episodes}) == SPLITS[split][1]


@every_split_of_all_goals
def test_each_goal_is_asked_for_equally_often_within_two(split: str) -> None:
    asked = goals_asked(load(split))
    assert set(asked) == set(GOAL_CATEGORIES)
    assert max(asked.values()) - min(asked.values()) <= 2


@every_split
def test_the_order_goes_round_the_houses(split: str) -> None:
    houses = load(split).houses
    order = [episode.house for episode in load(split).episodes]
    assert order == [houses[i % len(houses)] for i in range(len(order))]


@every_split_of_all_goals
def test_any_first_episodes_ask_for_no_goal_much_more_than_for_another(split: str) -> None:
    asked = collections.Counter[str]()
    for number, episode in enumerate(load(split).episodes, 1):
        asked[episode.goal] += 1
        assert asked[episode.goal] <= math.ceil(number / len(GOAL_CATEGORIES)) + 2, number


@every_split_of_all_goals
def test_each_goal_is_asked_for_in_several_houses(split: str) -> None:
    houses = collections.defaultdict[str, set[str]](set)
    for episode in load(split).episodes:
        houses[episode.goal].add(episode.house)
    assert min(len(houses[goal]) for goal in GOAL_CATEGORIES) >= MIN_HOUSES


@every_split
def test_the_distances_are_those_of_the_recipe_and_the_oracle_needs_fewer_steps_than_allowed(split: str) -> None:
    recipe = EPISODE_RECIPES[split]
    least_m = recipe.min_distance_for(1)
    for episode in load(split).episodes:
        assert episode.shortest_path_m is not None
        assert least_m <= episode.shortest_path_m <= recipe.max_distance_m
        forwards = math.ceil(episode.shortest_path_m / FORWARD_M)
        steps = TURNS_AT_START + 2 * forwards + 1  # half a turn, then a turn of 30 degrees at every forward, STOP
        assert steps < MAX_STEPS


def test_start_headings_of_large_are_spread_evenly() -> None:
    quarters = [round(e.start.yaw_rad / (0.5 * math.pi)) % 4 for e in load("large").episodes]
    assert max(collections.Counter(quarters).values()) - min(collections.Counter(quarters).values()) <= 20
