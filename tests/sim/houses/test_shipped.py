"""Every shipped house keeps its promises: one test a house, a sample of the houses at each commit."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from sim.env import ObjectNavEnv
from sim.episodes import Episode, load_split
from sim.houses.check import check_house
from sim.interface import CameraModel
from sim.pose import Pose
from sim.scene import Scene
from tests.helpers.sampling import sample

SPLITS = ("val", "test")
HOUSES = [(split, house) for split in SPLITS for house in load_split(split).houses]
SMALL = CameraModel(width_px=320, height_px=240)
VIEWS = 40


@pytest.fixture(scope="module", params=sample(HOUSES, 3), ids="-".join)
def played(request: pytest.FixtureRequest) -> Iterator[tuple[Scene, list[Episode]]]:
    """A house ready to play in, and its episodes."""
    split, house = request.param
    env = ObjectNavEnv(split=split, sensors=(), camera=SMALL)
    episodes = [episode for episode in env.split.episodes if episode.house == house]
    env.reset(options={"episode": episodes[0]})
    yield env.scene, episodes
    env.close()


def test_the_check_finds_no_fault(played: tuple[Scene, list[Episode]]) -> None:
    assert check_house(played[0].world.house.spec) == []


def test_each_goal_can_be_reached_from_its_start_by_the_way_that_is_recorded(
    played: tuple[Scene, list[Episode]],
) -> None:
    scene, episodes = played
    assert len(episodes) == 50
    for episode in sample(episodes, 12):
        distance_m = scene.task.distance_from(episode.goal, episode.start)
        assert distance_m is not None, episode
        assert distance_m == pytest.approx(episode.shortest_path_m, abs=0.01)
        assert 2.0 <= distance_m <= 30.0


def test_a_start_touches_nothing_but_the_floor_and_stays_where_it_is(played: tuple[Scene, list[Episode]]) -> None:
    scene, episodes = played
    world = scene.world
    hull = [i for i in range(world.model.ngeom) if world.model.geom(i).name in ("robot/lower_hull", "robot/upper_hull")]
    assert hull
    for episode in sample(episodes, 12):
        world.reset(episode.start)
        assert world.pose.distance_to(episode.start) < 0.002
        touching = world.data.contact.geom[world.data.contact.dist < 0.0]
        assert not np.isin(touching, hull).any(), episode


def test_no_robot_view_shows_void(played: tuple[Scene, list[Episode]]) -> None:
    scene, _ = played
    space, rng = scene.task.truth.space(0.0), np.random.default_rng(0)
    cells = np.argwhere(space.free)
    for _ in range(VIEWS):
        x_m, y_m = space.frame.to_metres(cells[rng.integers(len(cells))])
        pose = Pose(float(x_m), float(y_m), float(rng.uniform(-np.pi, np.pi)))
        semantic = scene.camera.render(scene.world.data, pose, ("semantic",))["semantic"]
        assert (semantic == 0).sum() == 0, pose
