"""Fits how `stubborn-plus` fuses the views of an object to tracks whose true category is known.

    stubborn train fusion --split runs/unseen --episodes 100 --out runs/fusion.json

The agent explores without stopping and looks at all candidates. Tracks of all categories are logged: an episode gives
about a hundred. A track is logged with the mean posteriors of its views when these reach certain weights and at the
end of the episode, and once with the number of its pixels of each true category.

The log has one line and one file (tracks/<episode>.npz) per episode. The same command continues it, and more episodes
extend it, as long as split, code and detector are the same. --minutes 0 runs no episode and fits the existing log. Then
`sim.training.fits.fusion` fits the parameters and judges them on houses left out.

The houses should have furniture on which the network was not trained, otherwise the fit overestimates its quality: see
docs/segmentation.md. Nothing is fitted on houses of val and test.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from sim.app.commands.train.episode_logs import LogOptions, checked_split, default_log, lines_of
from sim.app.composition.segmenters import find_segmentation, make_segmenter
from sim.app.evaluation.workers import RunnerSpec
from sim.core.files import write_atomically
from sim.core.interface import ConfigError
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.episodes.seeds import episode_seeds
from sim.episodes.splits import Split
from sim.training.fits.fusion import fit, samples_of
from sim.training.fits.track_log import TrackLine, TrackRecorder, compared, file_of, read_tracks, write_tracks


@dataclass(frozen=True, kw_only=True)
class Args(LogOptions):
    """Log the tracks of episodes, then fit the fusion of views to them."""


def main(args: Args) -> int:
    """Runs the episodes, then fits and writes; returns the exit status."""
    split = checked_split(args)
    episodes = tracks_of(args, split)
    samples = samples_of([{"house": line.house, **tracks} for line, tracks in episodes])
    if not samples:
        raise ConfigError("The log has no tracks: run episodes, with --minutes above 0 or without this option.")
    about = {"episodes": len(episodes), "houses": len({line.house for line, _ in episodes})}
    about["tracks"] = sum(len(tracks["counts"]) for _, tracks in episodes)
    print(", ".join(f"{value} {name}" for name, value in about.items()))
    fusion = fit(samples)
    content = {
        "semantics": args.semantics,
        "command": args.command("fusion", len(episodes)),
        "split": {"name": split.name, "version": split.version},
        **about,
        "fusion": msgspec.to_builtins(fusion),
        "left_out": compared(samples),
    }
    write_atomically(args.out, json.dumps(content, indent=1, allow_nan=False) + "\n")
    for name, quality in content["left_out"].items():
        print(name)
        _print(quality)
    print(f"written: {args.out}")
    return 0


def tracks_of(args: Args, split: Split) -> list[tuple[TrackLine, dict[str, np.ndarray]]]:
    """Returns line and tracks of the first `args.episodes` episodes; those that are not in the log yet are run now."""
    log = args.log or default_log("tracks", args, split)
    runner = RunnerSpec(f"{__name__}:{TrackRunner.__name__}", (args, log))
    lines = lines_of(args, split, log, TrackLine, runner)
    return [(line, read_tracks(file_of(log, line.episode_id))) for line in lines if line.steps]


class TrackRunner:
    """A runner of `sim.app.evaluation.workers` that logs the tracks of whole episodes."""

    def __init__(self, options: tuple[Args, Path]) -> None:
        args, self._log = options
        self._seed = args.seed
        spec = find_segmentation(args.semantics, args.weights).spec
        self._env = ObjectNavEnv(
            split=args.split,
            sensors=("depth", *spec.sensors),
            truth=tuple({"semantic", *spec.truth}),
            max_steps=args.max_steps,
        )
        self._recorder = TrackRecorder(self._env, make_segmenter(args.semantics, self._env, args.weights))

    def run(self, episode: Episode) -> TrackLine:
        """Runs one episode to its last step and writes its tracks; returns its line."""
        arrays = self._recorder.run(episode, episode_seeds(self._seed, episode.episode_id).environment)
        if arrays is None:
            return TrackLine.of(episode)
        write_tracks(self._log, episode.episode_id, arrays)
        return TrackLine.of(episode, self._env.scene.task.num_steps, tracks=len(arrays["counts"]))

    def close(self) -> None:
        """Frees the renderers."""
        self._env.close()


def _print(quality: Mapping[str, Any]) -> None:
    """Prints the quality of probabilities, and a line for each bin of the calibration."""
    print("  " + ", ".join(f"{name} {value}" for name, value in quality.items() if name != "calibration"))
    for row in quality["calibration"]:
        print("  " + ", ".join(f"{name} {value}" for name, value in row.items()))
