"""Drawn episodes can be played: the robot fits, the goal is far enough and can be reached."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from sim.episodes.drawing import draw_start, sample_episode
from sim.errors import EpisodeError
from sim.geometry.pose import Pose
from sim.interface import Action
from sim.task.objectnav import Task
from sim.world.world import World
from tests.helpers.worlds import room, with_box


@dataclass
class Place:
    world: World
    task: Task


def scene(width_m: float = 8.0) -> Place:
    house = with_box(room(width_m, 4), "bed_00", centre_m=(0.5 * width_m - 0.5, 0, 0.25), half_m=(0.5, 1.0, 0.25))
    house = with_box(house, "table_00", centre_m=(0, 1.5, 0.4), half_m=(0.4, 0.4, 0.4))
    world = World(house)
    return Place(world, Task(world))


PLACE = scene()


@pytest.mark.parametrize("seed", range(8))
def test_a_drawn_start_is_free_far_enough_and_accepted_by_the_world(seed):
    start = draw_start(PLACE.world, PLACE.task, "bed", np.random.default_rng(seed))
    PLACE.world.reset(start)
    PLACE.task.begin("bed", start)
    assert PLACE.task.truth.space().is_free(start.x_m, start.y_m)
    assert PLACE.task.metrics()["distance_to_goal"] >= 1.98  # a place within its cell
    assert not PLACE.world.move(Action.STOP).contacts


def test_nobody_starts_in_a_closet_without_a_door():
    # A bed on either side of the wall; what is right of it is smaller.
    house = with_box(room(14, 4), "wall_10", centre_m=(1.5, 0, 1.25), half_m=(0.05, 2.0, 1.25))
    for number, x in enumerate((-6.5, 6.5)):
        house = with_box(house, f"bed_{number:02d}", centre_m=(x, 0, 0.25), half_m=(0.3, 1.0, 0.25))
    world = World(house)
    task = Task(world)
    starts = [draw_start(world, task, "bed", np.random.default_rng(seed)) for seed in range(20)]
    assert max(start.x_m for start in starts) < 1.5


def test_the_same_stream_draws_the_same_episode_and_another_another():
    def drawn(seed):
        return sample_episode(PLACE, "h", np.random.default_rng(seed))

    assert drawn(3) == drawn(3)
    assert drawn(3) != drawn(4)
    assert {drawn(seed).goal for seed in range(12)} == {"bed", "table"}


def test_what_is_given_is_kept():
    start = Pose(-2.0, 0.0, 1.0)
    episode = sample_episode(PLACE, "h", np.random.default_rng(0), goal="bed", start=start, episode_id="mine")
    assert (episode.goal, episode.start, episode.episode_id, episode.house) == ("bed", start, "mine", "h")
    assert episode.shortest_path_m == pytest.approx(4.0, abs=0.03)


def test_a_small_room_gives_the_farther_half_of_what_there_is():
    small = scene(3.0)
    distances = [
        small.task.distance_from("bed", draw_start(small.world, small.task, "bed", np.random.default_rng(seed)))
        for seed in range(6)
    ]
    assert all(distance is not None and 0.1 < distance < 2.0 for distance in distances)


def test_a_start_inside_a_thing_and_a_goal_that_is_not_there_are_refused():
    rng = np.random.default_rng(0)
    with pytest.raises(EpisodeError, match="bed_00"):
        sample_episode(PLACE, "h", rng, start=Pose(3.5, 0.0, 0.0))
    with pytest.raises(EpisodeError, match=r"has no 'sofa'\. It has: table, bed"):
        sample_episode(PLACE, "h", rng, goal="sofa")
    with pytest.raises(EpisodeError, match="no way from"):
        sample_episode(PLACE, "h", rng, goal="bed", start=Pose(0.0, 3.0, 0.0))
