"""The tool that logs candidates and fits verifiers: its log, a continued log, refused arguments."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from sim.app.commands.train import episode_logs
from sim.app.commands.train import verifier as train_verifier
from sim.app.composition.segmenters import KINDS
from sim.core.geometry.pose import Pose
from sim.core.interface import ConfigError
from sim.core.paths import assets_dir
from sim.detectors.noisy import NoisyConfig
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.episodes.splits import load_split, write_split
from sim.training.fits import candidates
from stubborn.detection.classifiers import Features
from stubborn.detection.seeker import TargetSeeker
from stubborn.segmentation.ground_truth import GroundTruthSegmenter
from tests.helpers import wording
from tests.helpers.worlds import room, with_box


def log_after(split: Path, log: Path, episodes: int, *, max_steps: int = 30) -> list[dict]:
    """Returns the log after this number of episodes; it holds too few candidates for a fit."""
    args = train_verifier.Args(
        split=str(split), episodes=episodes, max_steps=max_steps, least_of_either=500, log=log, out=log / "x.json"
    )
    with pytest.raises(ConfigError, match=wording.N_500_OF_EACH_ARE_NEEDED):
        train_verifier.main(args)
    return [json.loads(line) for line in (log / "results.jsonl").read_text().splitlines()]


@pytest.mark.costly
def test_it_never_stops_logs_candidates_with_the_truth_and_continues_a_log(seats: Path, tmp_path: Path):
    first = log_after(seats, tmp_path, 2)
    assert [line["steps"] for line in first] == [30, 30]
    candidates = [candidate for line in first for candidate in line["candidates"]]
    assert any(
        candidate[4] == 1.0 for candidate in candidates
    )  # it reached the sofa, where a STOP would have succeeded
    for *features, truth, x_m, y_m in candidates:
        views, total, highest, other = Features(*features)
        assert truth in (0.0, 1.0)
        assert abs(x_m) < 3.5
        assert abs(y_m) < 2.5
        assert views >= 1
        assert 0.5 < highest <= 1.0
        assert highest <= total + 1e-3 <= views + 2e-3
        assert 0.0 <= other <= 1.0
    more = log_after(seats, tmp_path, 3)
    assert more[:2] == first
    assert [line["episode_id"] for line in more] == ["tiny_0", "tiny_1", "tiny_2"]


def test_an_episode_ends_when_the_robot_has_fallen(seats: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    step = ObjectNavEnv.step

    def fallen_after_5(env: ObjectNavEnv, action: int) -> tuple[Any, ...]:
        observation, reward, _, truncated, info = step(env, action)
        return observation, reward, env.scene.task.num_steps >= 5, truncated, info

    monkeypatch.setattr(ObjectNavEnv, "step", fallen_after_5)
    (line,) = log_after(seats, tmp_path, 1)
    assert line["steps"] == 5


def test_the_recorded_command_names_all_options_that_change_the_fit_and_the_episodes():
    args = train_verifier.Args(
        split="runs/my houses",
        semantics="rednet",
        weights=Path("a b.safetensors"),
        minutes=3.0,
        out=Path("x.json"),
    )
    assert replace(args, seed=2).command("verifier", 71, "--least-of-either", "7") == (
        "stubborn train verifier --semantics rednet --weights 'a b.safetensors' --split 'runs/my houses' "
        "--episodes 71 --max-steps 200 --least-of-either 7 --seed 2 --out x.json"
    )


@pytest.mark.costly
@pytest.mark.parametrize("change", ["split_identity", "detector.flicker_rate", "code", "seed", "max_steps"])
def test_a_log_of_another_split_code_or_detector_is_refused_with_the_difference(
    seats: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, change: str
):
    args = train_verifier.Args(
        split=str(seats), episodes=1, max_steps=3, least_of_either=500, log=tmp_path / "log", out=tmp_path / "x.json"
    )
    with pytest.raises(ConfigError, match=wording.N_500_OF_EACH_ARE_NEEDED):
        train_verifier.main(args)
    if change == "split_identity":  # the same name and version, another house
        other = tmp_path / seats.name
        shutil.copytree(seats, other)
        (other / "seats.xml").write_text((seats / "seats.xml").read_text() + "\n")
        args = replace(args, split=str(other))
    elif change == "detector.flicker_rate":
        monkeypatch.setattr(episode_logs, "detector_config", lambda *_: NoisyConfig(flicker_rate=0.5))
    elif change == "code":
        monkeypatch.setattr(episode_logs, "code_hash", lambda **_: "another")
    else:
        args = replace(args, **{change: 4})
    with pytest.raises(ConfigError, match=f"holds a run with {change}"):
        train_verifier.main(args)


@pytest.mark.slow
def test_candidates_that_are_verified_from_too_far_to_stop_are_not_logged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    folder = tmp_path / "fenced"
    folder.mkdir()
    house = with_box(room(7, 5), "sofa_00", centre_m=(3.0, 0.5, 0.4), half_m=(0.4, 0.8, 0.4))
    house = with_box(house, "wall_20", centre_m=(2.0, 0.0, 0.15), half_m=(0.4, 2.5, 0.15))  # before it
    house = with_box(house, "wall_21", centre_m=(-1.5, -0.5, 1.25), half_m=(0.05, 2.0, 1.25))
    house = with_box(house, "sofa_01", centre_m=(-3.0, -1.5, 0.4), half_m=(0.4, 0.8, 0.4))  # reachable
    (folder / "seats.xml").write_text(house.spec.to_xml())
    episodes = [Episode(f"fenced_{i}", "seats", "sofa", Pose(-0.3, 0.4 * i, 0.0)) for i in range(3)]
    write_split(folder, episodes, {"seats": {}}, version="0.0.1")
    asked: list[tuple[bool, int]] = []
    accepts = candidates.CandidateRecorder.accepts

    def spy(self: candidates.CandidateRecorder, goal: str, features: Features) -> bool:
        before = len(self.candidates)
        answer = accepts(self, goal, features)
        near_enough = self.agent.approach is None or self.agent.approach.near_enough
        asked.append((near_enough, len(self.candidates) - before))
        return answer

    judged: list[object] = []
    judge = TargetSeeker.judge
    monkeypatch.setattr(TargetSeeker, "judge", lambda *args: judged.append(args) or judge(*args))
    monkeypatch.setattr(candidates.CandidateRecorder, "accepts", spy)
    exact = replace(KINDS["gt"], spec=replace(GroundTruthSegmenter.spec, needs_verification=True))
    monkeypatch.setattr(train_verifier, "find_segmentation", lambda *_: exact)
    monkeypatch.setattr(train_verifier, "make_segmenter", lambda *_, **__: GroundTruthSegmenter())
    log_after(folder, tmp_path / "log", 3, max_steps=120)
    assert set(asked) == {(True, 1), (False, 0)}
    assert len(asked) == len(judged)  # candidates that are only seen from afar are not logged


@pytest.mark.slow
def test_two_workers_log_the_same_as_one(seats: Path, tmp_path: Path):
    one = log_after(seats, tmp_path / "one", 3)
    args = train_verifier.Args(
        split=str(seats),
        episodes=3,
        max_steps=30,
        least_of_either=500,
        log=tmp_path / "two",
        workers=2,
        out=tmp_path / "x",
    )
    with pytest.raises(ConfigError, match=wording.N_500_OF_EACH_ARE_NEEDED):
        train_verifier.main(args)
    two = [json.loads(line) for line in (tmp_path / "two/results.jsonl").read_text().splitlines()]
    assert sorted(two, key=lambda line: line["episode_id"]) == one


@pytest.mark.costly
def test_a_time_limit_leaves_whole_lines_and_zero_runs_nothing(seats: Path, tmp_path: Path):
    args = train_verifier.Args(
        split=str(seats), episodes=3, max_steps=30, minutes=1e-6, log=tmp_path / "log", out=tmp_path / "x.json"
    )
    loaded = load_split(str(seats))
    assert len(train_verifier.candidates_of(args, loaded)) == 1
    assert len(train_verifier.candidates_of(replace(args, minutes=0.0, seed=9), loaded)) == 1
    assert train_verifier.candidates_of(replace(args, minutes=0.0, log=tmp_path / "none"), loaded) == []
    with pytest.raises(ConfigError, match=r"Log.* = .*--log"):
        train_verifier.candidates_of(replace(args, minutes=0.0, semantics="rednet"), loaded)


def test_nothing_is_fitted_on_val_and_test():
    """Nor on other splits with their houses."""
    for split, houses in (("val", "val"), ("test", "test"), ("words-seen", "val"), ("large-test", "large-test")):
        for named in (split, str(assets_dir() / split)):
            with pytest.raises(ConfigError, match=f"fitted on houses of '{houses}', which judges"):
                train_verifier.main(train_verifier.Args(split=named, out=Path("x.json")))


def test_segmentation_that_needs_no_verification_is_refused():
    with pytest.raises(ConfigError, match="'gt'"):
        train_verifier.main(train_verifier.Args(semantics="gt", out=Path("x.json")))
