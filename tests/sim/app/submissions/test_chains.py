"""Runs over chains of goals are recorded, packed, verified and refused like others."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from sim.app.commands import merge, report, submit
from sim.core.errors import ConfigError
from sim.core.geometry.pose import Pose
from sim.core.goals import GoalSpec
from sim.episodes.episode import Episode
from sim.episodes.splits import write_split
from tests.helpers.results import lines_of
from tests.helpers.submissions import checked, content_of, judged, recorded, written
from tests.helpers.worlds import sofa_room, with_box

GOALS = (GoalSpec("sofa", "category"), GoalSpec("the table", "words"), GoalSpec("couch", "words", None, 0))


@pytest.fixture(scope="module")
def chains(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a split of two chains, and a submission of the oracle."""
    folder = tmp_path_factory.mktemp("chains")
    split = folder / "tiny"
    split.mkdir()
    house = with_box(sofa_room(), "table_00", centre_m=(-2.5, 0, 0.4), half_m=(0.4, 0.8, 0.4))
    (split / "home.xml").write_text(house.spec.to_xml())
    starts = (Pose(0.0, 0.0, 0.3), Pose(0.0, 1.0, 2.0))
    episodes = [Episode(f"tiny_{i}", "home", "sofa", start, None, GOALS) for i, start in enumerate(starts)]
    write_split(split, episodes, {"home": {}}, version="1")
    recorded(split, folder / "oracle", "oracle", "--seed-key", "key", episodes=2)
    assert submit.main(submit.Args(run=folder / "oracle", name="The oracle", authors=("A. Author",))) == 0
    return folder


def test_the_line_of_a_chain_has_its_goals_and_the_summary_their_means(chains: Path) -> None:
    lines = [json.loads(line) for line in (chains / "oracle" / "results.jsonl").read_text().splitlines()]
    assert [[goal["success"] for goal in line["goals"]] for line in lines] == [[1.0] * 3] * 2
    assert lines[0]["goals"][2] | {"goal": "couch", "kind": "words", "repeats": 0} == lines[0]["goals"][2]
    summary = json.loads((chains / "oracle" / "summary.json").read_text())
    assert summary["composite_success"]["mean"] == 1.0
    counts = {name: means["goals"] for name, means in summary["goals"].items()}
    assert counts == {"all": 6, "category": 2, "words": 4, "first_visit": 4, "second_visit": 2}


def test_a_recorded_chain_is_verified_equal_and_known_as_the_oracles(chains: Path) -> None:
    verdicts = judged(chains, chains / "oracle.json.gz", frames=1.0)
    assert [(verdict.judgement, verdict.text) for verdict in verdicts] == [("equal", "")] * 2
    assert [verdict.known_path for verdict in verdicts] == ["oracle"] * 2


@pytest.mark.costly
def test_a_run_over_chains_is_resumed_merged_and_reported_as_others(
    chains: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = lines_of(chains / "oracle")
    one = recorded(chains / "tiny", tmp_path / "resumed", "oracle", "--seed-key", "key", episodes=1)
    recorded(chains / "tiny", one, "oracle", "--seed-key", "key", episodes=2)
    assert lines_of(one) == whole
    for shard in ("1/2", "2/2"):
        options = ("--seed-key", "key", "--shard", shard)
        recorded(chains / "tiny", tmp_path / "parts", "oracle", *options, episodes=2)
    assert merge.main(merge.Args(runs=(tmp_path / "parts",))) == 0
    assert lines_of(tmp_path / "parts") == whole
    assert "3 of 3" in capsys.readouterr().out
    assert report.main(report.Args(runs=(one,))) == 0
    page = (one / "report.html").read_text()
    assert "\N{CHECK MARK} sofa, \N{CHECK MARK} the table, \N{CHECK MARK} couch" in page
    groups = "category, first visit|words, first visit|words, second visit"
    assert f'data-goal="{groups}"' in page  # each of the filter's values selects the chain
    for group in groups.split("|"):
        assert f'<option value="{group}">' in page


def _failed(content: dict[str, Any]) -> None:
    content["episodes"][0]["result"]["goals"][1] |= {"success": 0.0, "spl": 0.0, "failure": "misc"}


def _other_goal(content: dict[str, Any]) -> None:
    content["episodes"][0]["result"]["goals"][1]["goal"] = "the chair"


def _no_goals(content: dict[str, Any]) -> None:
    del content["episodes"][0]["result"]["goals"]


@pytest.mark.parametrize(
    ("lie", "message"), [(_failed, "success"), (_other_goal, "not those of the episode"), (_no_goals, "not those of")]
)
def test_goals_that_contradict_the_chain_are_refused(chains: Path, tmp_path: Path, lie, message: str) -> None:
    content = content_of(chains / "oracle.json.gz")
    lie(content)
    with pytest.raises(ConfigError, match=message):
        checked(chains, written(tmp_path / "lie.json.gz", content))


def test_a_replay_finds_a_goal_that_did_not_succeed(chains: Path, tmp_path: Path) -> None:
    content = content_of(chains / "oracle.json.gz")
    entry = content["episodes"][0]
    first = entry["result"]["goals"][0]
    actions = entry["actions"]
    turned = "2" * (first["num_steps"] - 1) + actions[first["num_steps"] - 1 :]  # turns in place of the way to the sofa
    entry["actions"] = turned
    (verdict, _) = judged(chains, written(tmp_path / "lie.json.gz", content))
    assert verdict.judgement == "different"
