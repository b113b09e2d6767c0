"""The tool that lets the agent meet candidates: what it logs, and that it goes on where it was."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from sim.env import ObjectNavEnv
from sim.episodes import Episode, write_split
from sim.interface import ConfigError
from sim.pose import Pose
from stubborn.verification import Features
from tests.helpers.worlds import room, with_box
from tools import train_verifier


@pytest.fixture(scope="module")
def split(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("splits") / "tiny"
    folder.mkdir()
    furnished = with_box(room(7, 5), "sofa_00", centre_m=(3.0, 0.5, 0.4), half_m=(0.4, 0.8, 0.4))
    (folder / "seats.xml").write_text(furnished.spec.to_xml())
    episodes = [Episode(f"tiny_{i}", "seats", "sofa", Pose(-2.0, 0.4 * i, 0.3 * i), 3.5) for i in range(3)]
    write_split(folder, episodes, {"seats": {"sofa": []}}, version="0.0.1")
    return folder


def played(split: Path, log: Path, episodes: int) -> list[dict]:
    """The log after so many episodes; too few candidates to fit anything."""
    args = train_verifier.Args(split=str(split), episodes=episodes, max_steps=30, least_of_either=500, log=log)
    with pytest.raises(ConfigError, match="500 of either are needed"):
        train_verifier.main(args)
    return [json.loads(line) for line in (log / "results.jsonl").read_text().splitlines()]


def test_it_never_stops_logs_candidates_with_the_truth_and_goes_on_where_it_was(split: Path, tmp_path: Path):
    first = played(split, tmp_path, 2)
    assert [line["steps"] for line in first] == [30, 30]
    candidates = [each for line in first for each in line["candidates"]]
    assert any(each[4] == 1.0 for each in candidates)  # it came to the sofa, where a STOP would have succeeded
    for *features, truth, x_m, y_m in candidates:
        views, total, highest, other = Features(*features)
        assert truth in (0.0, 1.0)
        assert abs(x_m) < 3.5
        assert abs(y_m) < 2.5
        assert views >= 1
        assert 0.5 < highest <= 1.0
        assert highest <= total + 1e-3 <= views + 2e-3
        assert 0.0 <= other <= 1.0
    more = played(split, tmp_path, 3)
    assert more[:2] == first
    assert [line["episode_id"] for line in more] == ["tiny_0", "tiny_1", "tiny_2"]


def test_an_outing_cut_short_leaves_whole_lines(split: Path, tmp_path: Path):
    env = ObjectNavEnv(split=split, sensors=("depth",), truth=("geom",), max_steps=30)
    try:
        args = train_verifier.Args(split=str(split), episodes=3, minutes=0.0)
        run = train_verifier.RunDirectory(tmp_path, {})
        assert train_verifier.play(args, env, run) == []
        run.close()
    finally:
        env.close()


def test_semantics_without_anything_to_verify_are_refused():
    with pytest.raises(ConfigError, match=r"'gt' has no verifier to fit\. There is: noisy"):
        train_verifier.main(train_verifier.Args(semantics="gt"))
