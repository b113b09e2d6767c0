"""Random episodes can be run: the robot fits, the goal is far enough and can be reached."""

from __future__ import annotations

import numpy as np
import pytest

from sim.core.errors import EpisodeError
from sim.core.geometry.pose import Pose
from sim.core.interface import Action
from sim.episodes.drawing import draw_start, sample_episode
from sim.task.objectnav import Task
from sim.world.world import World
from tests.helpers import wording
from tests.helpers.worlds import room, two_storeys, with_box


def task_in(width_m: float = 8.0) -> Task:
    house = with_box(room(width_m, 4), "bed_00", centre_m=(0.5 * width_m - 0.5, 0, 0.25), half_m=(0.5, 1.0, 0.25))
    house = with_box(house, "table_00", centre_m=(0, 1.5, 0.4), half_m=(0.4, 0.4, 0.4))
    return Task(World(house))


TASK = task_in()


@pytest.mark.parametrize("seed", range(8))
def test_a_sampled_start_is_free_far_enough_and_accepted_by_the_world(seed):
    start = draw_start(TASK, "bed", np.random.default_rng(seed))
    TASK.world.reset(start)
    TASK.begin("bed", start)
    assert TASK.truth.space().is_free(start.x_m, start.y_m)
    assert (TASK.metrics().distance_to_goal or 0.0) >= 1.98  # a place within its cell
    assert not TASK.world.move(Action.STOP).contacts


def test_no_start_is_in_a_closet_without_a_door():
    # A bed on each side of the wall; the area to its right is smaller.
    house = with_box(room(14, 4), "wall_10", centre_m=(1.5, 0, 1.25), half_m=(0.05, 2.0, 1.25))
    for number, x in enumerate((-6.5, 6.5)):
        house = with_box(house, f"bed_{number:02d}", centre_m=(x, 0, 0.25), half_m=(0.3, 1.0, 0.25))
    task = Task(World(house))
    starts = [draw_start(task, "bed", np.random.default_rng(seed)) for seed in range(20)]
    assert max(start.x_m for start in starts) < 1.5


def test_the_same_stream_draws_the_same_episode_and_another_another():
    def sampled(seed):
        return sample_episode(TASK, "h", np.random.default_rng(seed))

    assert sampled(3) == sampled(3)
    assert sampled(3) != sampled(4)
    assert {sampled(seed).goal for seed in range(12)} == {"bed", "table"}


def test_a_given_goal_and_start_are_kept():
    start = Pose(-2.0, 0.0, 1.0)
    episode = sample_episode(TASK, "h", np.random.default_rng(0), goal="bed", start=start, episode_id="mine")
    assert (episode.goal, episode.start, episode.episode_id, episode.house) == ("bed", start, "mine", "h")
    assert episode.shortest_path_m == pytest.approx(4.0, abs=0.03)


def test_a_small_room_gives_starts_in_its_farther_half():
    task = task_in(3.0)
    starts = [draw_start(task, "bed", np.random.default_rng(seed)) for seed in range(6)]
    distances = [task.distance_from("bed", start) for start in starts]
    assert all(distance is not None and 0.1 < distance < 2.0 for distance in distances)


def test_a_start_inside_an_object_and_a_goal_that_is_missing_are_refused():
    rng = np.random.default_rng(0)
    with pytest.raises(EpisodeError, match="bed_00"):
        sample_episode(TASK, "h", rng, start=Pose(3.5, 0.0, 0.0))
    with pytest.raises(EpisodeError, match="'sofa'"):
        sample_episode(TASK, "h", rng, goal="sofa")
    with pytest.raises(EpisodeError, match=wording.NO_PATH_FROM):
        sample_episode(TASK, "h", rng, goal="bed", start=Pose(0.0, 3.0, 0.0))


def test_a_goal_on_another_storey_only_is_named_as_such():
    task = Task(World(two_storeys()))
    with pytest.raises(EpisodeError, match=r"'sofa'.*0"):
        draw_start(task, "sofa", np.random.default_rng(0))
    assert "on another storey only" in str(task.unreachable_error("sofa", Pose(0.5, 0.0, 0.0)))
    assert "no path" in str(task.unreachable_error("bed", Pose(0.5, 0.0, 0.0)))
