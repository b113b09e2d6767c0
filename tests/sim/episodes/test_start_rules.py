"""The rules of the splits' recipes: hidden goals, distances, headings, paths past hazards."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from sim.core.geometry.descent_kernels import descend
from sim.episodes.house_episodes import Ask, StartDrawer, find_house_asks
from sim.episodes.recipes import EPISODE_RECIPES, EpisodeRecipe
from sim.episodes.start_rules import Lookout, leads_past, quadrant_headings, start_cells
from sim.gl import mujoco
from sim.houses.hazards import read_hazards
from sim.houses.house import House
from sim.task.objectnav import Task
from sim.world.world import World
from tests.helpers.worlds import room, with_box

HIDDEN = EpisodeRecipe(rule="hidden", min_distance_m=12.0, only_instance_min_distance_m=6.0, max_distance_m=60.0)


def divided() -> House:
    """Returns a room of 24 x 6 m: a wall at x = 0 with a doorway in the north, a bed (west), chairs (both halves)."""
    house = with_box(room(24, 6), "wall_10", centre_m=(0.0, -0.6, 1.25), half_m=(0.05, 2.4, 1.25))
    house = with_box(house, "bed_00", centre_m=(-11.0, -1.5, 0.25), half_m=(0.9, 0.9, 0.25))
    house = with_box(house, "chair_00", centre_m=(-11.5, 2.0, 0.4), half_m=(0.25, 0.25, 0.4))
    return with_box(house, "chair_01", centre_m=(11.5, 2.0, 0.4), half_m=(0.25, 0.25, 0.4))


@pytest.fixture(scope="module")
def task() -> Task:
    return Task(World(divided()))


@pytest.mark.costly
def test_hidden_goals_are_far_away_and_visible_in_no_direction(task):
    asks = find_house_asks(task, HIDDEN).asks
    assert asks == (Ask("bed"),)  # no place is 12 m away from both chairs
    drawer, lookout = StartDrawer(task, HIDDEN, house=0, seed=0), Lookout(task)
    starts = [drawer.draw(asks[0], number, np.random.default_rng(number)) for number in range(12)]
    for start in starts:
        assert start.meets_rule
        assert start.distance_m is not None
        assert start.distance_m >= 6.0
        for yaw_rad in np.linspace(-3.0, 3.0, 13).tolist():
            assert not lookout.sees("bed", replace(start.pose, yaw_rad=yaw_rad))
    drawer.close()
    lookout.close()


def test_a_goal_with_one_instance_may_be_nearer_than_others(task):
    frame = task.truth.space().frame
    only, several = (start_cells(task, "bed", 0.0, HIDDEN, instances) for instances in (1, 2))
    distance_m = task.truth.target("bed").distance_m
    assert only is not None
    assert several is not None
    assert frame.shape == only.shape
    assert distance_m[only].min() == pytest.approx(6.0, abs=0.1)
    assert distance_m[several].min() == pytest.approx(12.0, abs=0.1)
    assert start_cells(task, "bed", 0.0, replace(HIDDEN, max_distance_m=6.02), 1) is None


def test_headings_are_spread_evenly_over_houses_and_over_the_episodes_of_a_house():
    def quadrant(number: int, house: int) -> int:
        low, high = quadrant_headings(number, house, 0)
        assert high - low == pytest.approx(math.pi / 2)
        return round(0.5 * (low + high) / (math.pi / 2)) % 4

    for house, first in itertools.product(range(5), (0, 4, 8)):
        assert {quadrant(number, house) for number in range(first, first + 4)} == {0, 1, 2, 3}
    for number in range(9):
        assert {quadrant(number, house) for house in range(4)} == {0, 1, 2, 3}


def test_paths_past_a_marked_cell_are_those_that_following_the_field_finds(task):
    space, field_m = task.truth.space(), task.truth.target("bed").distance_m
    marked = np.zeros(field_m.shape, dtype=np.bool_)
    x, y = space.frame.mesh()
    marked[np.hypot(x - 1.0, y - 2.2) < 0.3] = True  # east of the doorway
    past = leads_past(field_m, marked)
    cells = np.argwhere(np.isfinite(field_m))[::3001]
    expected = [marked[tuple(descend(field_m, *cell.tolist()).T)].any() for cell in cells]
    assert past[tuple(cells.T)].tolist() == expected
    assert 0 < sum(expected) < len(expected)


def test_starts_near_hazards_lead_past_one_where_the_house_has_such_paths():
    house = divided()
    house.spec.worldbody.add_site(
        name="hazard_slab_00", type=mujoco.mjtGeom.mjGEOM_BOX, pos=(0.8, 2.4, 0.1), size=(0.2, 0.2, 0.1)
    )
    task, recipe = Task(World(house)), EPISODE_RECIPES["hazards"]
    assert {ask.goal for ask in find_house_asks(task, recipe).asks} == {"bed", "chair"}
    drawer, space = StartDrawer(task, recipe, house=0, seed=0), task.truth.space()
    for seed in range(8):
        start = drawer.draw(Ask("bed"), seed, np.random.default_rng(seed))
        cell = tuple(space.frame.to_cells((start.pose.x_m, start.pose.y_m)).tolist())
        path_m = space.frame.to_metres(descend(task.truth.target("bed").distance_m, *cell))
        assert read_hazards(task.world.model)[0].distance_m(path_m).min() <= 0.3
        assert start.meets_rule


def test_a_house_without_hazards_still_has_episodes_but_they_do_not_meet_the_rule(task):
    recipe = EPISODE_RECIPES["hazards"]
    assert {ask.goal for ask in find_house_asks(task, recipe).asks} == {"bed", "chair"}
    start = StartDrawer(task, recipe, house=0, seed=0).draw(Ask("bed"), 0, np.random.default_rng(0))
    assert not start.meets_rule
    assert start.distance_m is not None


def test_an_unreachable_cell_has_no_path_past_a_mark():
    distance_m = np.array([[0.0, 1.0, 2.0, 3.0, np.inf]], np.float32)
    marked = np.array([[False, True, False, False, True]])
    assert leads_past(distance_m, marked).tolist() == [[False, True, True, True, False]]
