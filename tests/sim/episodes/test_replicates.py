"""Replicates of episodes."""

from __future__ import annotations

import pytest

from sim.core.geometry.pose import Pose
from sim.episodes.episode import Episode
from sim.episodes.replicates import MOVED_M, find_episode, replicate_number, with_replicates

EPISODES = [Episode(f"val_{number:04d}", "val_00", "bed", Pose(1.0, 2.0, 0.5, 3.0), 4.0) for number in range(3)]


def test_one_replicate_is_the_episode_itself():
    assert with_replicates(EPISODES, 1) == EPISODES


def test_replicates_start_one_centimetre_away_with_the_same_heading_goal_and_house():
    replicates = with_replicates(EPISODES, 3)
    assert [episode.episode_id for episode in replicates[:4]] == ["val_0000", "val_0000~1", "val_0000~2", "val_0001"]
    for index, episode in enumerate(replicates):
        original = EPISODES[index // 3]
        assert (episode.house, episode.goal) == (original.house, original.goal)
        assert (episode.start.yaw_rad, episode.start.floor_z_m) == (0.5, 3.0)
        assert episode.start.distance_to(original.start) == pytest.approx(MOVED_M if index % 3 else 0.0)
        assert episode.shortest_path_m == (None if index % 3 else 4.0)
    assert len({episode.start for episode in replicates}) == 7


def test_replicates_are_the_same_in_every_process_and_for_every_count():
    assert with_replicates(EPISODES, 3)[:3] == with_replicates(EPISODES, 5)[:3]


@pytest.mark.parametrize(
    ("episode_id", "number"), [("val_0003", 0), ("val_0003~12", 12), ("a~b", 0), ("~1", 0), ("a~\u00b2", 0)]
)
def test_an_id_names_its_replicate(episode_id, number):
    assert replicate_number(episode_id) == number


def test_each_id_finds_its_replicate_and_no_other_way_to_write_it_does():
    known = {episode.episode_id: episode for episode in EPISODES}
    for episode in with_replicates(EPISODES, 3):
        assert find_episode(known, episode.episode_id) == episode
    for other in ("val_0000~0", "val_0000~01", "val_0000~", "val_0000~1~1", "val_0009~1", "~1", ""):
        assert find_episode(known, other) is None
