"""LeRobot datasets of recorded runs, and the environment for its policies; `lerobot` itself is not needed."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import av
import gymnasium
import numpy as np
import pytest

from sim.app.analysis.comparison import read_run
from sim.app.bridges.lerobot import features
from sim.app.bridges.lerobot.dataset import image_stats, joined_stats, stats_of
from sim.app.bridges.lerobot.environment import LeRobotEnv
from sim.app.bridges.lerobot.replays import Replayer
from sim.app.commands.export import lerobot
from sim.app.viewers import video as videos
from sim.core.errors import ConfigError, EpisodeError
from sim.core.interface import GOAL_CATEGORIES, MOVES, Action
from sim.episodes.splits import load_split
from sim.task.trajectory import read_trajectory, trajectory_file, write_trajectory
from tests.helpers.submissions import recorded, tiny_split

parquet = pytest.importorskip("pyarrow.parquet", reason="the extra lerobot is not installed")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a tiny split and two recorded runs of it; `noisy` has noise."""
    folder = tmp_path_factory.mktemp("lerobot")
    split = tiny_split(folder)
    recorded(split, folder / "oracle", "oracle")
    recorded(split, folder / "noisy", "random", "--noise", "realsense", episodes=2)
    return folder


def export(folder: Path, run: str, out: Path, **options: Any) -> None:
    assert lerobot.main(lerobot.Args(run=folder / run, out=out, width_px=48, **options)) == 0


def rows_of(file: Path) -> dict[str, Any]:
    return parquet.read_table(file).to_pydict()


def test_actions_goals_and_tasks_in_the_form_of_policies() -> None:
    for action in MOVES:
        assert features.action_of(features.vector_of(action)) is action
    assert features.action_of(np.array([-3.0, -1.0, -2.0, -9.0])) is Action.MOVE_FORWARD
    for wrong in (np.zeros(3), np.array([0.0, np.nan, 0.0, 0.0])):
        with pytest.raises(ConfigError, match="4 values"):
            features.action_of(wrong)
    assert features.goal_of("bed").argmax() == GOAL_CATEGORIES.index("bed")
    assert features.goal_of("the red chair").sum() == 0.0
    tasks = [features.task_of(goal) for goal in ("chair", "tv_monitor", "clothes", "the red chair")]
    assert tasks == ["find a chair", "find a television", "find clothes", "find the red chair"]
    assert features.picture_of(np.zeros((480, 640, 3), np.uint8), 160).shape == (120, 160, 3)
    for width_px in (161, 800):
        with pytest.raises(ConfigError, match="even and at most"):
            features.picture_of(np.zeros((480, 640, 3), np.uint8), width_px)


@pytest.mark.costly
@pytest.mark.parametrize(("run", "codec"), [("oracle", "h264"), ("noisy", "vp9")])
def test_a_dataset_has_the_recorded_actions_poses_and_pictures(
    folder: Path, tmp_path: Path, run: str, codec: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if codec == "vp9":
        monkeypatch.setattr(videos, "CODECS", {"libvpx-vp9": videos.CODECS["libvpx-vp9"]})
    export(folder, run, tmp_path)
    results = read_run(folder / run).results
    info = json.loads((tmp_path / "meta" / "info.json").read_text())
    assert (info["total_episodes"], info["fps"], info["codebase_version"]) == (len(results), 4, "v3.0")
    assert info["features"]["observation.image"]["shape"] == [36, 48, 3]
    assert info["features"]["observation.image"]["info"]["video.codec"] == codec
    first_row = 0
    for number, (episode_id, result) in enumerate(results.items()):
        trajectory = read_trajectory(trajectory_file(folder / run, episode_id))
        place = {"chunk_index": 0, "file_index": number, "video_key": "observation.image"}
        rows = rows_of(tmp_path / info["data_path"].format(**place))
        count = trajectory.num_steps
        assert np.argmax(rows["action"], axis=1).tolist() == trajectory.actions.tolist()
        assert rows["index"] == list(range(first_row, first_row + count))
        assert rows["timestamp"] == [i / 4 for i in range(count)]
        assert rows["next.done"] == [False] * (count - 1) + [True]
        assert rows["next.success"][-1] == bool(result.success)
        assert not any(rows["next.success"][:-1])
        with av.open(str(tmp_path / info["video_path"].format(**place))) as video:
            frames = list(video.decode(video=0))
        assert [frame.time for frame in frames] == rows["timestamp"]
        entry = {
            name: values[0]
            for name, values in rows_of(tmp_path / f"meta/episodes/chunk-000/file-00{number}.parquet").items()
        }
        assert (entry["dataset_from_index"], entry["dataset_to_index"]) == (first_row, first_row + count)
        assert (entry["tasks"], entry["videos/observation.image/to_timestamp"]) == (["find a sofa"], count / 4)
        first_row += count
        if run == "oracle":
            start = trajectory.poses[0]
            ahead = trajectory.positions_m[:-1] - start[:2]
            forward_m = ahead @ np.array([np.cos(start[2]), np.sin(start[2])])
            np.testing.assert_allclose(np.array(rows["observation.state"])[:, 0], forward_m, atol=1e-3)
    assert info["total_frames"] == first_row
    tasks = parquet.read_table(tmp_path / "meta" / "tasks.parquet").to_pylist()
    assert tasks == [{"task_index": 0, "__index_level_0__": "find a sofa"}]


def test_the_pictures_are_those_that_the_robot_saw(folder: Path, tmp_path: Path) -> None:
    export(folder, "oracle", tmp_path)
    run = read_run(folder / "oracle")
    replayer = Replayer(run)
    seen = [features.picture_of(frame.rgb, 48) for frame in replayer.frames(next(iter(run.results)))]
    replayer.close()
    with av.open(str(tmp_path / "videos/observation.image/chunk-000/file-000.mp4")) as video:
        stored = [frame.to_ndarray(format="rgb24") for frame in video.decode(video=0)]
    assert len({picture.tobytes() for picture in seen}) > 3
    for one, other in zip(seen, stored, strict=True):
        assert np.abs(one.astype(int) - other.astype(int)).mean() < 12.0
    assert np.abs(seen[0].astype(int) - stored[-1].astype(int)).mean() > 12.0


@pytest.mark.costly
def test_a_stopped_export_goes_on_and_equals_one_without_a_stop(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    export(folder, "oracle", tmp_path / "whole")
    original, count = Replayer.frames, 0

    def stopping(self: Replayer, episode_id: str) -> Iterator[Any]:
        nonlocal count
        count += 1
        for i, frame in enumerate(original(self, episode_id)):
            if count == 2 and i == 3:
                raise KeyboardInterrupt
            yield frame

    monkeypatch.setattr(Replayer, "frames", stopping)
    with pytest.raises(KeyboardInterrupt):
        export(folder, "oracle", tmp_path / "parts")
    assert len(list((tmp_path / "parts").rglob("*.mp4"))) == 1  # the second video was discarded
    assert not (tmp_path / "parts" / "meta" / "info.json").exists()
    capsys.readouterr()
    export(folder, "oracle", tmp_path / "parts")
    assert "[1/3]" not in capsys.readouterr().out
    files = sorted(file.relative_to(tmp_path / "whole") for file in (tmp_path / "whole").rglob("*") if file.is_file())
    for file in files:
        assert (tmp_path / "whole" / file).read_bytes() == (tmp_path / "parts" / file).read_bytes(), file


def test_the_pictures_have_the_profile_of_the_run(folder: Path, tmp_path: Path) -> None:
    plain = tmp_path / "plain"
    recorded(folder / "tiny", plain, "oracle", "profile.shadows=0", "profile.occlusion=0", episodes=1)
    first = []
    for run in (read_run(folder / "oracle"), read_run(plain)):
        replayer = Replayer(run)
        first.append(next(replayer.frames("tiny_0000")).rgb)
        replayer.close()
    assert (first[0] != first[1]).any()


def test_a_width_that_is_not_allowed_leaves_the_folder_free(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="even and at most"):
        lerobot.main(lerobot.Args(run=folder / "oracle", out=tmp_path / "data", width_px=47))
    assert not (tmp_path / "data").exists()


def test_chains_and_pictures_are_refused(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for split, words in (("chains-val", "several goals"), ("pictures", "a picture as its goal")):
        with pytest.raises(ConfigError, match=words):
            LeRobotEnv(split=split)
    monkeypatch.setattr("sim.app.bridges.lerobot.replays.split_of", lambda run: load_split("chains-val"))
    with pytest.raises(ConfigError, match="several goals"):
        export(folder, "oracle", tmp_path / "data")
    assert not (tmp_path / "data").exists()


def test_an_export_into_another_one_is_refused(folder: Path, tmp_path: Path) -> None:
    export(folder, "oracle", tmp_path)
    with pytest.raises(ConfigError, match=r"another export \(run"):
        export(folder, "noisy", tmp_path)
    with pytest.raises(ConfigError, match="only_success"):
        export(folder, "oracle", tmp_path, only_success=True)


def test_only_successes_are_exported_where_that_is_asked_for(folder: Path, tmp_path: Path) -> None:
    ids = lerobot.exported(read_run(folder / "noisy"), only_success=True)
    assert len(ids) < 2  # the random agent
    if not ids:
        with pytest.raises(ConfigError, match="succeeded; leave out --only-success"):
            export(folder, "noisy", tmp_path, only_success=True)


def bent(run: Path, episode_id: str) -> None:
    """Moves a recorded pose of an episode, so that its replay is another one."""
    file = trajectory_file(run, episode_id)
    trajectory = read_trajectory(file)
    trajectory.poses[2, 0] += 0.05
    write_trajectory(file, trajectory, trajectory.about)


def test_a_replay_that_leaves_the_recorded_path_is_refused(folder: Path, tmp_path: Path) -> None:
    run = read_run(recorded(tiny_split(tmp_path), tmp_path / "run", "oracle", episodes=1))
    episode_id = next(iter(run.results))
    bent(tmp_path / "run", episode_id)
    replayer = Replayer(run)
    with pytest.raises(EpisodeError, match=r"0\.05 m off the recorded path at step 2"):
        list(replayer.frames(episode_id))
    replayer.close()


@pytest.mark.costly
def test_an_episode_whose_replay_is_another_one_is_named_and_left_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = recorded(tiny_split(tmp_path), tmp_path / "run", "oracle")
    ids = list(read_run(run).results)
    bent(run, ids[1])
    args = lerobot.Args(run=run, out=tmp_path / "data", width_px=48)
    capsys.readouterr()
    for attempt in range(2):  # the second one has nothing left to write
        assert lerobot.main(args) == 1
        printed = capsys.readouterr().out
        assert f"[2/3] {ids[1]}: left out" in printed
        assert ("0.05 m off the recorded path" in printed) == (attempt == 0)
        assert "1 episode left out" in printed
        info = json.loads((args.out / "meta" / "info.json").read_text())
        assert (info["total_episodes"], info["splits"]) == (2, {"train": "0:2"})
    last = rows_of(args.out / "data/chunk-000/file-001.parquet")
    trajectory = read_trajectory(trajectory_file(run, ids[2]))
    assert np.argmax(last["action"], axis=1).tolist() == trajectory.actions.tolist()
    assert last["index"][0] == read_trajectory(trajectory_file(run, ids[0])).num_steps
    for episode_id in (ids[0], ids[2]):
        bent(run, episode_id)
    with pytest.raises(ConfigError, match=r"No episode of .* follows its recorded path"):
        lerobot.main(lerobot.Args(run=run, out=tmp_path / "none", width_px=48))
    assert not list((tmp_path / "none").rglob("*.mp4"))


def test_statistics_of_parts_are_those_of_the_whole() -> None:
    rng = np.random.default_rng(0)
    whole = rng.normal(size=(30, 3))
    joined = joined_stats([stats_of(whole[:12]), stats_of(whole[12:])])
    exact = stats_of(whole)
    for name in ("min", "max", "mean", "std", "count"):
        np.testing.assert_allclose(joined[name], exact[name])
    assert set(exact) == {"min", "max", "mean", "std", "count", "q01", "q10", "q50", "q90", "q99"}
    stats = image_stats([np.full((4, 4, 3), 51, np.uint8)] * 5)
    assert (np.shape(stats["mean"]), stats["count"]) == ((3, 1, 1), [5])
    np.testing.assert_allclose(stats["mean"], 0.2)


def test_the_environment_has_observations_and_actions_of_policies(folder: Path) -> None:
    env = LeRobotEnv(split=str(folder / "tiny"), width_px=64, max_steps=5)
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.render()
    observation, info = env.reset(seed=0, options={"episode_id": "tiny_0000"})
    assert env.observation_space.contains(observation)
    assert observation["pixels"].shape == (48, 64, 3)
    assert (env.task, info["is_success"]) == ("find a sofa", False)
    observation, _, terminated, truncated, _ = env.step(features.vector_of(Action.MOVE_FORWARD))
    assert observation["agent_pos"][0] == pytest.approx(0.25, abs=0.02)
    assert (terminated, truncated) == (False, False)
    np.testing.assert_array_equal(env.render(), observation["pixels"])
    *_, terminated, truncated, info = env.step(features.vector_of(Action.STOP))
    assert terminated
    assert info["is_success"] == bool(info["success"])
    env.close()
    vector = gymnasium.vector.SyncVectorEnv([lambda: LeRobotEnv(split=str(folder / "tiny"), width_px=64, max_steps=1)])
    vector.reset(seed=[3])
    assert vector.call("task_description") == ("find a sofa",)
    *_, info = vector.step(np.array([features.vector_of(Action.TURN_LEFT)]))
    assert info["is_success"].tolist() == [False]
    vector.close()
