"""`stubborn words` in a folder with one house, and runs of the split that it makes."""

from __future__ import annotations

import pytest

from sim.app import cli
from sim.app.commands import words
from sim.app.composition.environments import episodes_of, takes
from sim.app.composition.setup import resolve
from sim.app.options import RunOptions
from sim.core.errors import ConfigError
from sim.core.geometry.pose import Pose
from sim.episodes.episode import Episode
from sim.episodes.splits import load_split, read_index, write_split
from tests.helpers.worlds import furnished


@pytest.fixture(scope="module")
def homes(tmp_path_factory):
    folder = tmp_path_factory.mktemp("data") / "homes"
    folder.mkdir()
    house = furnished()
    (folder / "one.xml").write_text(house.spec.to_xml())
    write_split(folder, [Episode("homes_0000", "one", "table", Pose(0.0, -3.0, 0.0))], {"one": {}}, version="1")
    return folder


def made(homes, kind, name, **options):
    args = words.Args(kind=kind, split=str(homes), out=homes.parent / name, episodes=3, **options)
    assert words.main(args) == 0
    return load_split(args.out)


@pytest.mark.parametrize(
    ("kind", "goals"), [("seen", {"armchair", "desk", "office chair", "desk lamp"}), ("descriptions", set())]
)
def test_a_split_of_goals_in_words_uses_the_houses_beside_it(homes, kind, goals):
    split = made(homes, kind, kind)
    assert split.houses == ("one",)
    assert split.house_file("one") == homes / "one.xml"
    asked = {episode.goal for episode in split.episodes}
    assert asked
    assert asked <= goals if goals else all("chair" in goal or "lamp" in goal or "desk" in goal for goal in asked)
    assert read_index(homes.parent / kind).in_words
    assert not read_index(homes).in_words
    assert all((episode.shortest_path_m or 0.0) >= 4.0 for episode in split.episodes)


def test_houses_that_are_not_needed_are_not_searched(homes, capsys):
    folder = homes.parent / "street"
    folder.mkdir()
    for name in ("one", "two", "three"):
        (folder / f"{name}.xml").write_text((homes / "one.xml").read_text())
    starts = [Episode(f"street_{name}", name, "table", Pose(0.0, -3.0, 0.0)) for name in ("one", "two", "three")]
    write_split(folder, starts, {"one": {}, "two": {}, "three": {}}, version="1")
    assert words.main(words.Args(kind="seen", split=str(folder), out=homes.parent / "short", episodes=2)) == 0
    printed = capsys.readouterr().out
    assert printed.count(": 1 episode") == 2
    assert len({episode.house for episode in load_split(homes.parent / "short").episodes}) == 2


def test_agents_that_take_no_words_get_none_of_these_episodes(homes):
    made(homes, "seen", "again")
    options = {"split": str(homes.parent / "again"), "semantics": "gt", "episodes": 1}
    with pytest.raises(ConfigError, match="Agent 'cloned' takes no goals in words"):
        episodes_of(resolve(RunOptions(agent="cloned", **options)))
    setup = resolve(RunOptions(agent="stubborn-plus", **options))
    assert "rgb" in setup.config.sensors
    assert len(episodes_of(setup).episodes) == 1
    labelled = Episode("labelled", "home", "chair_00", Pose(0.0, 0.0, 0.0))
    assert not takes(setup, labelled)  # only an agent that knows the truth knows which chair that is
    assert takes(resolve(RunOptions(agent="oracle", **options)), labelled)
    assert "rgb" not in resolve(RunOptions(agent="stubborn-plus", semantics="gt")).config.sensors


def test_the_split_must_lie_beside_the_houses(homes, tmp_path):
    with pytest.raises(ConfigError, match="next to the houses"):
        words.main(words.Args(kind="seen", split=str(homes), out=tmp_path / "elsewhere"))
    with pytest.raises(ConfigError, match="No house of"):
        words.main(words.Args(kind="unseen", split=str(homes), out=homes.parent / "none"))
    assert cli.parse(words.Args, ["--kind", "seen", "--out", "x"]).split == "val"


def test_pictures_are_episodes_of_agents_that_take_them(homes):
    split = made(homes, "pictures", "pictured")
    assert all(episode.specs[0].kind == "picture" for episode in split.episodes)
    options = {"split": str(homes.parent / "pictured"), "semantics": "gt", "episodes": 1}
    setup = resolve(RunOptions(agent="stubborn-plus", **options))
    assert {"rgb", "goal_picture"} <= set(setup.config.sensors)
    assert len(episodes_of(setup).episodes) == 1
    with pytest.raises(ConfigError, match="Agent 'cloned' takes no pictures"):
        episodes_of(resolve(RunOptions(agent="cloned", **options)))
