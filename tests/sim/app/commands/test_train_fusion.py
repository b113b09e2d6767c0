"""The tool that logs tracks and fits the fusion of views: its log, a continued log, refused arguments."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.app.commands.train import fusion as train_tracks
from sim.core.interface import MPCAT40, ConfigError
from sim.training.fits import track_log
from stubborn.detection.fusion import Fusion
from stubborn.detection.track_seeker import TrackSeeker
from tests.helpers import wording


def log_after(split: Path, log: Path, episodes: int) -> list[dict]:
    """Returns the log after this number of episodes; it holds too few tracks for a fit."""
    args = train_tracks.Args(
        split=str(split), semantics="noisy", episodes=episodes, max_steps=30, log=log, out=log / "x.json"
    )
    with pytest.raises(ConfigError, match=r"needed.*run"):  # more samples, or another house
        train_tracks.main(args)
    return [json.loads(line) for line in (log / "results.jsonl").read_text().splitlines()]


def test_the_agent_of_the_log_uses_no_fitted_parameters(seats: Path, tmp_path: Path):
    args = train_tracks.Args(split=str(seats), semantics="noisy", log=tmp_path, out=tmp_path / "x.json")
    runner = train_tracks.TrackRunner((args, tmp_path))
    seeker = runner._recorder._agent.seeker
    assert isinstance(seeker, TrackSeeker)
    assert (seeker.evidence.fusion, seeker.evidence.context) == (Fusion(), None)
    runner.close()


@pytest.mark.costly
def test_it_never_stops_logs_tracks_with_the_truth_and_continues_a_log(seats: Path, tmp_path: Path):
    first = log_after(seats, tmp_path, 2)
    assert [line["steps"] for line in first] == [30, 30]
    for line in first:
        content = train_tracks.read_tracks(tmp_path / "tracks" / f"{line['episode_id']}.npz")
        assert len(content["counts"]) == line["tracks"] > 0
        assert content["mean"].shape == (len(content["sample"]), len(MPCAT40) - 1)
        assert len(content["track"]) == content["sample"].max() + 1
        assert set(content["track"].tolist()) == set(range(line["tracks"]))
        assert len(content["track"]) > line["tracks"]  # most are logged several times
        assert (content["weight"] > 0).all()
        assert content["counts"][:, MPCAT40.index("sofa")].max() > 100
        sofa = int(content["counts"][:, MPCAT40.index("sofa")].argmax())
        seen_as = content["mean"][content["track"][content["sample"]] == sofa].mean(axis=0)
        assert seen_as[MPCAT40.index("sofa") - 1] > 0.2
    more = log_after(seats, tmp_path, 3)
    assert more[:2] == first
    assert [line["episode_id"] for line in more] == ["tiny_0", "tiny_1", "tiny_2"]


@pytest.mark.costly
def test_a_file_holds_the_tracks_only(seats: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """NumPy before 2.2 stores each keyword of `savez_compressed` as an array."""
    stored: list[set[str]] = []
    write = np.savez_compressed
    monkeypatch.setattr(
        np, "savez_compressed", lambda file, **arrays: stored.append(set(arrays)) or write(file, **arrays)
    )
    log_after(seats, tmp_path, 1)
    assert stored == [{"counts", "track", "sample", "view", "mean", "weight"}]


def test_an_episode_without_tracks_is_logged_and_adds_no_samples(
    seats: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(track_log, "MIN_VOXELS", 10**9)
    args = train_tracks.Args(
        split=str(seats), semantics="noisy", episodes=1, max_steps=3, log=tmp_path, out=tmp_path / "x.json"
    )
    with pytest.raises(ConfigError, match=wording.THE_LOG_HAS_NO_TRACKS_RUN_EPISODES):
        train_tracks.main(args)
    line = json.loads((tmp_path / "results.jsonl").read_text())
    assert (line["steps"], line["tracks"]) == (3, 0)
    content = train_tracks.read_tracks(tmp_path / "tracks" / "tiny_0.npz")
    shapes = {name: values.shape for name, values in content.items()}
    assert shapes == {
        "counts": (0, len(MPCAT40)), "track": (0,),
        "sample": (0,), "view": (0,), "mean": (0, len(MPCAT40) - 1), "weight": (0,),
    }  # fmt: skip


def test_a_log_of_another_seed_and_a_broken_file_are_refused(seats: Path, tmp_path: Path):
    args = train_tracks.Args(
        split=str(seats), semantics="noisy", episodes=1, max_steps=3, log=tmp_path, out=tmp_path / "x.json"
    )
    with pytest.raises(ConfigError, match=r"needed.*run"):  # more samples, or another house
        train_tracks.main(args)
    with pytest.raises(ConfigError, match=wording.HOLDS_A_RUN_WITH_SEED):
        train_tracks.main(replace(args, seed=4))
    file = tmp_path / "tracks" / "tiny_0.npz"
    whole = file.read_bytes()
    for broken in (b"PK", whole[: len(whole) // 2], whole[:200] + b"\xff" * 50 + whole[250:]):
        file.write_bytes(broken)
        with pytest.raises(ConfigError, match=r"tiny_0\.npz.*`stubborn train fusion`"):
            train_tracks.main(args)


@pytest.mark.parametrize(
    ("options", "message"),
    [({"split": "val"}, "fitted on houses of 'val'"), ({"semantics": "gt"}, wording.MAKES_NO_ERRORS_TO_LEARN)],
)
def test_it_refuses_val_and_exact_segmentation(options: dict, message: str):
    with pytest.raises(ConfigError, match=message):
        train_tracks.main(train_tracks.Args(**{"split": "val", "out": Path("x.json"), **options}))


def test_merged_tracks_are_counted_together():
    class Merged:
        """Track 2 was merged into track 1; track 3 is too small."""

        in_view = np.array([1, 2, 3])

        @property
        def evidence(self) -> Merged:
            return self

        @staticmethod
        def views(tracks: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            return np.ones((len(tracks), 2, 40), np.float32), np.tile(
                np.array([1.0, 0.0], np.float32), (len(tracks), 1)
            )

        @staticmethod
        def now() -> np.ndarray:
            return np.array([0, 1, 1, 3])

        @staticmethod
        def sizes(tracks: np.ndarray) -> np.ndarray:
            return np.array([0, 50, 0, 2])[tracks]

    counts = np.zeros((5, len(MPCAT40)), np.int64)
    counts[1, 3], counts[2, 3], counts[3, 3] = 10, 5, 2
    samples, tracks = track_log.TrackSamples(), Merged()
    samples.take(tracks, np.array([2]))  # type: ignore[arg-type]
    content = track_log.logged(tracks, counts, samples)  # type: ignore[arg-type]
    assert content["counts"][:, 3].tolist() == [15]
    assert content["track"].tolist() == [0, 0]  # as it was before it was merged, and at the end
    assert content["sample"].tolist() == [0, 1]
