"""The tracks of whole episodes with the truth: the data of the fit of the fusion."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from jaxtyping import Int

from sim.core.files import inside, write_atomically
from sim.core.interface import GOAL_CATEGORIES, MPCAT40, Observation, Segmenter
from sim.core.reading import Count as ReadCount
from sim.core.reading import read_npz
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.training.fits.candidates import run_whole
from sim.training.fits.fusion import PLAUSIBLE, Sample, judge, left_out, probabilities
from sim.training.fits.log_line import LogLine
from stubborn.agent import StubbornAgent
from stubborn.agents import PLUS
from stubborn.detection.fusion import Fusion
from stubborn.detection.look import LookConfig
from stubborn.detection.track_seeker import TrackSeeker, TrackSeekerConfig
from stubborn.detection.tracks import Tracks
from stubborn.segmentation.ground_truth import STRIDE_PX

LOOK_AT_ALL = LookConfig(bar=((0, 1.0),), slack=0.0, visit=0.15)
"""The agent accepts nothing, and looks at everything that may be the goal."""
SEEKER = TrackSeekerConfig()
"""The configuration of `stubborn-plus`."""
MIN_VOXELS = 6
"""The agent does not consider smaller tracks as candidates, and they are not logged."""
LEVELS = (0.4, 1.0, 2.0, 3.5, 6.0)
"""A track is logged when the total weight of its views reaches each of these values."""
MAX_FILE_BYTES = 256 << 20
_ARRAYS = ("counts", "track", "sample", "view", "mean", "weight")


class TrackLine(LogLine, frozen=True, kw_only=True):
    """A line of the log."""

    tracks: ReadCount = 0


def compared(samples: Sequence[Sample]) -> dict[str, object]:
    """Returns the quality on houses left out, and that of plain averages on the same pairs."""
    fitted, plain = left_out(samples), probabilities(Fusion(), samples)
    goals = np.array([MPCAT40.index(name) - 1 for name in GOAL_CATEGORIES])
    among = np.maximum(fitted, plain)[:, goals] >= PLAUSIBLE
    return {name: judge(p, samples, among) for name, p in (("fitted", fitted), ("averages", plain))}


def file_of(log: Path, episode_id: str) -> Path:
    """Returns the file with the tracks of an episode."""
    return inside(log / "tracks", f"{episode_id}.npz", what="An episode of the log")


class TrackSamples:
    """The views of tracks at several steps of an episode."""

    def __init__(self) -> None:
        self._level: dict[int, int] = {}
        self._track: list[int] = []
        self._parts: dict[str, list[np.ndarray]] = {name: [] for name in _ARRAYS[2:]}

    def add(self, tracks: Tracks) -> None:
        """Adds a track in view if the weight of its views has reached a further one of `LEVELS`."""
        numbers = tracks.in_view[tracks.sizes(tracks.in_view) >= MIN_VOXELS]
        _, weight = tracks.evidence.views(numbers)
        level = np.searchsorted(LEVELS, weight.sum(axis=1), side="right")
        grown = [v > self._level.get(n, 0) for n, v in zip(numbers.tolist(), level.tolist(), strict=True)]
        self._level.update(zip(numbers.tolist(), level.tolist(), strict=True))
        self.take(tracks, numbers[np.array(grown, np.bool_)])

    def take(self, tracks: Tracks, numbers: Int[np.ndarray, " n"]) -> None:
        """Adds these tracks as they are now; without any, `arrays` still has the shapes of the arrays."""
        mean, weight = tracks.evidence.views(numbers)
        sample, view = np.nonzero(weight > 0.0)
        added = {
            "sample": (len(self._track) + sample).astype(np.int32),
            "view": view.astype(np.int16),
            "mean": mean[sample, view].astype(np.float16),
            "weight": weight[sample, view].astype(np.float16),
        }
        self._track += numbers.tolist()
        for name, values in added.items():
            self._parts[name].append(values)

    def arrays(self, now: Int[np.ndarray, " numbers"], kept: Int[np.ndarray, " n"]) -> dict[str, np.ndarray]:
        """Returns all samples of the kept tracks; `now` is the track into which each one was merged.

        `track` is the index of a sample's track in `kept`, `sample` the index of a view's sample in `track`.
        """
        index = np.full(len(now), -1)
        index[kept] = np.arange(len(kept))
        track = index[now[np.array(self._track, np.intp)]]
        number = np.cumsum(track >= 0) - 1
        parts = {name: np.concatenate(values) for name, values in self._parts.items()}
        views = track[parts["sample"]] >= 0
        result = {name: parts[name][views] for name in ("view", "mean", "weight")}
        return result | {
            "track": track[track >= 0].astype(np.int32),
            "sample": number[parts["sample"][views]].astype(np.int32),
        }


def logged(tracks: Tracks, counts: Int[np.ndarray, "tracks ids"], samples: TrackSamples) -> dict[str, np.ndarray]:
    """Returns the arrays of an episode that `samples_of` reads."""
    now = tracks.now()
    merged = np.zeros_like(counts)
    np.add.at(merged, now, counts[: len(now)])
    kept = 1 + np.flatnonzero(tracks.sizes(np.arange(1, len(now))) >= MIN_VOXELS)
    samples.take(tracks, kept)
    return {"counts": merged[kept].astype(np.int32)} | samples.arrays(now, kept)


def read_tracks(file: Path) -> dict[str, np.ndarray]:
    """Returns the tracks of an episode.

    Raises:
        ConfigError: the file is missing or broken.
    """
    return read_npz(file, _ARRAYS, what="file of `stubborn train fusion`", most_bytes=MAX_FILE_BYTES)


def write_tracks(log: Path, episode_id: str, arrays: Mapping[str, np.ndarray]) -> None:
    """Writes the tracks of an episode into a log."""
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)  # pyright: ignore[reportArgumentType] - it takes no other keyword
    file = file_of(log, episode_id)
    file.parent.mkdir(exist_ok=True)
    write_atomically(file, buffer.getvalue())


class TrackRecorder:
    """An agent that runs whole episodes, looks at everything, and counts the true categories of its tracks."""

    def __init__(self, env: ObjectNavEnv, segmenter: Segmenter) -> None:
        self._env = env
        self._agent = StubbornAgent(
            camera=env.camera_model,
            robot=env.robot_model,
            success=env.success_rule,
            segmenter=segmenter,
            config=replace(PLUS, seeker=replace(SEEKER, look=LOOK_AT_ALL, context_share=0.0)),
        )
        assert isinstance(self._agent.seeker, TrackSeeker)
        self._agent.seeker.evidence.fusion = Fusion()  # the log must not depend on fitted parameters or on context

    def run(self, episode: Episode, seed: int) -> dict[str, np.ndarray] | None:
        """Runs an episode to its last step; returns its tracks as `samples_of` reads them, None if it failed."""
        counts = np.zeros((SEEKER.tracks.most_tracks, len(MPCAT40)), np.int64)
        samples = TrackSamples()

        def look(observation: Observation) -> None:
            self._count(observation["depth"], counts)
            samples.add(self._tracks())

        if not run_whole(self._env, self._agent, episode, seed, look):
            return None
        return logged(self._tracks(), counts, samples)

    def _tracks(self) -> Tracks:
        seeker = self._agent.seeker
        assert isinstance(seeker, TrackSeeker)
        return seeker.evidence.of_episode()

    def _count(self, depth: np.ndarray, counts: Int[np.ndarray, "tracks ids"]) -> None:
        """Adds the true ids of the pixels of the frame to those of their tracks."""
        truth = self._env.truth_images["semantic"][STRIDE_PX // 2 :: STRIDE_PX, STRIDE_PX // 2 :: STRIDE_PX]
        assert self._agent.pose is not None
        owner = self._tracks().pixels(depth, self._agent.pose, truth.shape[1]).track
        np.add.at(counts, (owner.astype(np.intp), truth.astype(np.intp)), 1)
