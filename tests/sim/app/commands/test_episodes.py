"""Generated episodes of a split are balanced, can be run, and are the same each time."""

from __future__ import annotations

import collections
import gzip
import json
import re
from pathlib import Path

import pytest

from sim.app.commands.episodes import Args, balanced_goals, main
from sim.core.errors import EpisodeError
from sim.core.geometry.pose import Pose
from sim.core.interface import ConfigError, SuccessRule
from sim.episodes import habitat
from sim.episodes.house_episodes import Ask
from sim.episodes.recipes import DEFAULT_RECIPE, START_TURNS_RAD
from sim.episodes.splits import load_split, read_unreachable
from sim.task.config import TaskConfig
from sim.task.objectnav import Task
from sim.world.world import World
from tests.helpers import wording
from tests.helpers.foreign import TRAP, write_trap
from tests.helpers.worlds import room, two_storeys, with_box


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    folder = tmp_path / "tiny"
    folder.mkdir()
    first = with_box(room(8, 4), "bed_00", centre_m=(3.3, 0, 0.25), half_m=(0.5, 1.0, 0.25))
    first = with_box(first, "picture_00", centre_m=(-0.5, 1.98, 1.5), half_m=(0.3, 0.02, 0.2))
    second = with_box(room(7, 5), "bed_00", centre_m=(-2.5, 0, 0.25), half_m=(0.5, 1.0, 0.25))
    second = with_box(second, "wall_10", centre_m=(2.2, 0.0, 1.25), half_m=(0.05, 2.5, 1.25))
    second = with_box(second, "sink_00", centre_m=(3.0, 0.0, 0.4), half_m=(0.2, 0.2, 0.4))  # walled in
    (folder / "first.xml").write_text(first.spec.to_xml())
    (folder / "second.XML").write_text(second.spec.to_xml())
    return folder


@pytest.mark.parametrize("count", [3, 7, 20, 60])
def test_the_first_episodes_are_balanced_over_houses_and_goals(count):
    goals = {"a": ("bed", "sofa", "sink"), "b": ("bed", "sofa"), "c": ("sink", "bed", "sofa", "plant")}
    turns = balanced_goals({house: [Ask(goal) for goal in of] for house, of in goals.items()}, count)
    houses = collections.Counter(house for house, _ in turns)
    asked = collections.Counter(ask.goal for _, ask in turns)
    assert all(ask.goal in goals[house] for house, ask in turns)
    assert max(houses.values()) - min(houses.values()) <= 1
    assert max(asked[g] for g in ("bed", "sofa", "sink")) - min(asked[g] for g in ("bed", "sofa", "sink")) <= 1


def test_the_episodes_of_a_house_take_turns_on_its_storeys():
    asks = {"a": [Ask("bed"), Ask("sofa"), Ask("sink"), Ask("bed", 3.0)], "b": [Ask("bed")]}
    in_a = [ask for house, ask in balanced_goals(asks, 16) if house == "a"]
    assert [ask.floor_z_m for ask in in_a] == [0.0, 3.0] * 4
    assert {ask.goal for ask in in_a if ask.floor_z_m == 0.0} == {"bed", "sofa", "sink"}


def test_a_house_without_goals_is_refused():
    with pytest.raises(EpisodeError, match="'b'"):
        balanced_goals({"a": (Ask("bed"),), "b": ()}, 4)


def test_the_episodes_can_be_run_and_goals_that_cannot_be_reached_are_listed(folder, capsys):
    assert main(Args(split=folder, episodes=6)) == 0
    assert re.search(r"second: cannot be reached.*: sink_00", capsys.readouterr().out)
    assert read_unreachable(folder) == {"second": ("sink_00",)}
    split = load_split(folder)
    assert [episode.house for episode in split.episodes] == ["first", "second"] * 3
    assert {episode.goal for episode in split.episodes} == {"bed", "picture"}
    for house in split.houses:
        world = World(split.load_house(house))
        task = Task(world)
        for episode in (episode for episode in split.episodes if episode.house == house):
            world.reset(episode.start)
            task.begin(episode.goal, episode.start)
            assert task.metrics().distance_to_goal == pytest.approx(episode.shortest_path_m, abs=1e-6)
            assert (task.metrics().distance_to_goal or 0.0) > 1.9


def test_a_stop_at_a_view_point_succeeds(folder):
    main(Args(split=folder, episodes=2))
    world = World(load_split(folder).load_house("first"))
    region = Task(world).truth.target("picture").region
    content = json.loads(gzip.decompress((folder / "content" / "first.json.gz").read_bytes()))
    (goal,) = content["goals_by_category"]["first.xml_picture"]
    assert goal["object_name"] == "picture_00"
    assert goal["object_id"] > 0
    assert goal["room_name"] == "room_living_00"
    assert goal["position"] == [-0.5, 1.5, -1.98]
    places = [habitat.from_position(view["agent_state"]["position"]) for view in goal["view_points"]]
    assert 5 < len(places) <= 24
    assert all(region.succeeds(x, y) for x, y, _ in places)


def test_the_same_seed_gives_the_same_bytes_and_another_seed_other_starts(folder):
    def made(seed: int) -> list[bytes]:
        main(Args(split=folder, episodes=4, seed=seed))
        return [file.read_bytes() for file in sorted(folder.rglob("*.gz"))]

    assert made(0) == made(0)
    assert made(0) != made(1)


@pytest.mark.slow
def test_two_processes_write_the_same_bytes_as_one(folder):
    def made(workers: int) -> list[bytes]:
        main(Args(split=folder, episodes=4, workers=workers))
        return [file.read_bytes() for file in sorted(folder.rglob("*.gz"))]

    assert made(2) == made(1)


def test_episodes_of_removed_houses_are_removed(folder):
    main(Args(split=folder, episodes=4))
    (folder / "second.XML").unlink()
    main(Args(split=folder, episodes=4))
    assert {episode.house for episode in load_split(folder).episodes} == {"first"}
    assert [file.name for file in (folder / "content").iterdir()] == ["first.json.gz"]


def test_the_success_rule_decides_the_recorded_distances(folder):
    rule = SuccessRule(distance_m=0.5)
    main(Args(split=folder, episodes=3, success=rule))
    split = load_split(folder)
    for episode in split.episodes:
        world = World(split.load_house(episode.house))
        with_rule = Task(world, TaskConfig(success=rule)).distance_from(episode.goal, episode.start)
        by_default = Task(world).distance_from(episode.goal, episode.start)
        assert with_rule is not None
        assert by_default is not None
        assert with_rule == pytest.approx(episode.shortest_path_m, abs=1e-6)
        assert with_rule - by_default == pytest.approx(0.5, abs=0.1)


def test_without_a_number_each_house_has_as_many_episodes_as_the_recipe_says(folder):
    main(Args(split=folder))
    houses = collections.Counter(episode.house for episode in load_split(folder).episodes)
    assert set(houses.values()) == {DEFAULT_RECIPE.per_house}
    with pytest.raises(ConfigError, match="No recipe 'huge'"):
        main(Args(split=folder, recipe="huge"))


def test_starts_of_a_two_storey_house_are_on_both_and_ask_for_goals_of_their_own(tmp_path):
    folder = tmp_path / "tiny"
    folder.mkdir()
    (folder / "duplex.xml").write_text(two_storeys().spec.to_xml())
    main(Args(split=folder, episodes=6))
    episodes = load_split(folder).episodes
    assert {(episode.start.floor_z_m, episode.goal) for episode in episodes} == {(0.0, "bed"), (3.0, "sofa")}
    world = World(load_split(folder).load_house("duplex"))
    for episode in episodes:
        world.reset(episode.start)
        assert Task(world).distance_from(episode.goal, episode.start) == pytest.approx(
            episode.shortest_path_m, abs=1e-6
        )


def test_a_sidecar_fixes_start_and_goal_of_the_episodes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    house = write_trap(tmp_path / "mine")
    assert main(Args(split=house.parent)) == 0
    (episode,) = load_split(house.parent).episodes
    assert (episode.goal, episode.start) == ("sofa", Pose(1.0, 2.5, 0.0))
    assert (house.parent / "pictures" / "pane.png").is_file()
    main(Args(split=house.parent, recipe="traps", pictures=False))
    assert [episode.start.yaw_rad for episode in load_split(house.parent).episodes] == list(START_TURNS_RAD)
    with pytest.raises(EpisodeError, match=wording.THERE_ARE_1_DIFFERENT_EPISODES_AND_4_WERE_ASKED):
        main(Args(split=house.parent, episodes=4))
    house.with_suffix(".json").write_text(json.dumps(TRAP | {"goal": "bed"}))
    with pytest.raises(EpisodeError, match="'bed'"):
        main(Args(split=house.parent))


def test_a_packed_house_keeps_its_sidecar(tmp_path: Path) -> None:
    house = write_trap(tmp_path / "mine")
    main(Args(house=house, out=tmp_path / "packed", pictures=False))
    split = load_split(tmp_path / "packed")
    assert split.sidecar("pane").zone_m == (2.0, 1.0, 4.0, 4.0)
    assert len(split.episodes) == 1


def test_a_house_is_not_overwritten_and_nothing_of_an_earlier_command_changes_it(tmp_path: Path) -> None:
    house = write_trap(tmp_path / "mine")
    before = house.read_bytes()
    with pytest.raises(ConfigError, match=wording.IS_THE_FOLDER_OF_WHICH_WOULD_BE_OVERWRITTEN):
        main(Args(house=house, out=house.parent))
    assert house.read_bytes() == before
    (tmp_path / "packed").mkdir()
    (tmp_path / "packed" / "labels.json").write_text('{"sofa": "bed"}')
    with pytest.raises(ConfigError, match=r"'labels\.json'"):
        main(Args(house=house, out=tmp_path / "packed"))
