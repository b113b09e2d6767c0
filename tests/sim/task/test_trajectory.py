"""The file of a trajectory keeps all values, is small, and invalid files are refused with a clear message."""

from __future__ import annotations

import errno
import json
from dataclasses import replace
from pathlib import Path
from typing import IO

import numpy as np
import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import Action, ConfigError
from sim.robot.contacts import Contact
from sim.robot.drive import Motion
from sim.task.result import StopTarget
from sim.task.trajectory import (
    Recorder,
    Recording,
    SplitName,
    StartPose,
    Trajectory,
    read_trajectory,
    trajectory_file,
    write_trajectory,
)  # fmt: skip
from tests.helpers import wording
from tests.helpers.results import a_result

RECORDING = Recording(
    profile="fast",
    noise="none",
    split=SplitName("val", "3.0.0"),
    versions={"code": "1"},
    start=StartPose(0.0, 1.0, 0.0, 0.0),
    scores=a_result().without_times(),
)
STOPPED = Contact("chair_00", "leg", (1.0, 2.0, 0.3), (-1.0, 0.0, 0.0), 0.2, stopped=True)


def walked(steps: int) -> Trajectory:
    """Returns a random walk with a collision in every third action."""
    rng = np.random.default_rng(steps)
    recorder = Recorder(Pose(0.0, 0.0, 0.0), distance_m=8.0, goal_on_storey=True)
    recorder.look(0.0)
    for step in range(steps):
        contacts = (STOPPED,) if step % 3 == 0 else ()
        x, y, yaw, moved, share = rng.uniform(0, 1, 5).tolist()
        recorder.move(
            Motion(Action.MOVE_FORWARD, moved, 0.0, 1.0, "blocked" if contacts else "reached", contacts),
            Pose(10 * x, 10 * y, yaw),
            None if step == 1 else 5 * share,
        )
        recorder.look(share)
    return recorder.trajectory(end_reason="max_steps", nearest_instance_m=1.25)


def test_a_trajectory_written_and_read_is_the_same(tmp_path: Path) -> None:
    before, about = walked(30), RECORDING
    write_trajectory(tmp_path / "t" / "e.npz", before, about)
    after = read_trajectory(tmp_path / "t" / "e.npz")
    for name, value in vars(before).items():
        if isinstance(value, np.ndarray):
            np.testing.assert_array_equal(getattr(after, name), value)
        elif name != "about":
            assert getattr(after, name) == value
    assert after.about == about
    assert np.isnan(after.distance_m[2])


@pytest.mark.parametrize("off_m", [0.7, None])
def test_a_stated_place_is_kept(off_m: float | None, tmp_path: Path) -> None:
    stop = StopTarget(stop_target_xy_m=(-1.25, 3.5), stop_target_to_goal_m=off_m, stop_target_category=None)
    write_trajectory(tmp_path / "e.npz", replace(walked(3), stop=stop), None)
    assert read_trajectory(tmp_path / "e.npz").stop == stop


def test_a_file_of_an_older_format_is_refused_with_the_version_that_reads_it(tmp_path: Path) -> None:
    write_trajectory(tmp_path / "e.npz", walked(3), None)
    arrays = _arrays(tmp_path / "e.npz")
    del arrays["duration_s"]
    np.savez(tmp_path / "e.npz", allow_pickle=False, **arrays)
    with pytest.raises(ConfigError, match=r"'duration_s'.*0\.2\.0"):
        read_trajectory(tmp_path / "e.npz")


def test_five_hundred_steps_fit_into_fifty_kilobytes(tmp_path: Path) -> None:
    write_trajectory(tmp_path / "e.npz", walked(500), None)
    assert (tmp_path / "e.npz").stat().st_size < 50_000


def test_a_write_that_fails_leaves_only_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_trajectory(tmp_path / "e.npz", walked(3), None)
    before = (tmp_path / "e.npz").read_bytes()

    def full_disk(stream: IO[bytes], **_: object) -> None:
        stream.write(b"half")
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(np, "savez_compressed", full_disk)
    with pytest.raises(ConfigError, match="No space left"):
        write_trajectory(tmp_path / "e.npz", walked(4), None)
    assert [file.name for file in tmp_path.iterdir()] == ["e.npz"]
    assert (tmp_path / "e.npz").read_bytes() == before


def test_a_folder_that_cannot_be_created_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(ConfigError, match=wording.CANNOT_WRITE_THE_TRAJECTORY):
        write_trajectory(tmp_path / "file" / "e.npz", walked(3), None)


def test_episodes_whose_ids_differ_have_files_that_differ() -> None:
    names = ["a/b", "a%2Fb", "a_b", "../a", "a b", "ä"]
    files = {trajectory_file(Path("run"), name) for name in names}
    assert len(files) == len(names)
    assert all(file.parent == Path("run/trajectories") for file in files)


def _truncated(file: Path) -> None:
    file.write_bytes(file.read_bytes()[:-300])


def _arrays(file: Path) -> dict:
    with np.load(file) as content:
        return dict(content)


def _another_format(file: Path) -> None:
    arrays = _arrays(file)
    head = json.loads(arrays["about"].tobytes()) | {"format": 99}
    np.savez(file, allow_pickle=False, **arrays | {"about": np.frombuffer(json.dumps(head).encode(), np.uint8)})


def _place_of_one_number(file: Path) -> None:
    arrays = _arrays(file)
    head = json.loads(arrays["about"].tobytes())
    head["scalars"]["stop_target_xy_m"] = [1.0]
    np.savez(file, allow_pickle=False, **arrays | {"about": np.frombuffer(json.dumps(head).encode(), np.uint8)})


def _shorter_actions(file: Path) -> None:
    arrays = _arrays(file)
    np.savez(file, allow_pickle=False, **arrays | {"actions": arrays["actions"][:-1]})


def _pickled(file: Path) -> None:
    np.savez(file, poses=np.array([{}], dtype=object))


@pytest.mark.parametrize(
    ("harm", "message"),
    [
        (lambda file: file.unlink(), "--record"),
        (lambda file: file.write_text("no archive"), wording.IS_NOT_A_TRAJECTORY),
        (_truncated, wording.IS_NOT_A_TRAJECTORY),
        (lambda file: np.savez(file, poses=np.zeros(3)), "has no 'actions'|has no"),
        (_pickled, wording.IS_NOT_A_TRAJECTORY),
        (_another_format, wording.ITS_FORMAT_IS_99),
        (_shorter_actions, "for 4 actions"),
        (_place_of_one_number, "stop_target_xy_m"),
    ],
)
def test_a_file_that_is_no_trajectory_is_named(harm, message: str, tmp_path: Path) -> None:
    file = tmp_path / "e.npz"
    write_trajectory(file, walked(5), None)
    harm(file)
    with pytest.raises(ConfigError, match=message) as refusal:
        read_trajectory(file)
    assert "e.npz" in str(refusal.value)


def test_the_part_file_of_a_killed_run_leaves_with_the_next_one(tmp_path: Path):
    (tmp_path / ".e.part-1.npz").write_bytes(b"half")
    (tmp_path / ".e2.part-1.npz").write_bytes(b"of another episode")
    write_trajectory(tmp_path / "e.npz", walked(3), None)
    assert sorted(file.name for file in tmp_path.iterdir()) == [".e2.part-1.npz", "e.npz"]
