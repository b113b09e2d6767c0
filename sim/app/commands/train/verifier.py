"""Fits the verifier of a kind of segmentation to candidates that the agent finds in houses of the train split.

    stubborn train verifier --semantics noisy --split train --episodes 2000 --workers 2 --out runs/verifier.json

The agent runs without stopping. Each candidate that it would verify is logged with its four features, the truth
(whether a STOP there would succeed) and the robot's position; the agent then continues as if it had rejected the
candidate. Candidates that are verified from too far away to stop are not logged, since a STOP there always fails.
After such a rejection, the agent finds the rest of the object again. Therefore, of the true candidates of an episode
that the robot judged from places within 2 m of each other, only the first counts; the same holds for false candidates.

The log has one line per episode. The same command continues it, and more episodes extend it, as long as split, modules
and detector are the same. --minutes 0 runs no episode and fits the existing log, even if older code wrote it.

Then the verifier is fitted and written as JSON with the counts and its quality on houses left out
(`sim.training.fits.verifier`).
Nothing is fitted on houses of val and test.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sim.app import cli
from sim.app.commands.train.episode_logs import LogOptions, checked_split, default_log, lines_of
from sim.app.composition.segmenters import find_segmentation, make_segmenter
from sim.app.evaluation.workers import RunnerSpec
from sim.core.files import write_atomically
from sim.core.interface import ConfigError
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.episodes.seeds import episode_seeds
from sim.episodes.splits import Split
from sim.training.fits.candidates import CandidateLine, CandidateRecorder
from stubborn.detection.verification import NAIVE_BAYES


@dataclass(frozen=True, kw_only=True)
class Args(LogOptions):
    """Log candidates that the agent finds, then fit a verifier to them."""

    split: str = "train"
    """A shipped split, or a folder with the same layout (`stubborn episodes`)."""
    semantics: str = "noisy"
    """The segmentation whose errors are learned: one of `stubborn run`, also your own, that needs verification."""
    episodes: cli.Count = 400
    """Number of episodes, the first of the split."""
    max_steps: cli.Count = 200
    """Steps of an episode; an agent never verifies what it first finds after step 200."""
    least_of_either: cli.Count = 20
    """A category with fewer true or fewer false candidates uses the pooled naive Bayes."""


def main(args: Args) -> int:
    """Runs the episodes, then fits and writes; returns the exit status."""
    if args.least_of_either < 2:
        raise ConfigError(f"--least-of-either must be at least 2, got {args.least_of_either}.")
    split = checked_split(args)
    from sim.training.fits.verifier import fit  # it imports scikit-learn

    lines = candidates_of(args, split)
    about = {"name": split.name, "version": split.version}
    command = args.command("verifier", len(lines), "--least-of-either", str(args.least_of_either))
    content = {"semantics": args.semantics, "command": command, "split": about, **fit(lines, args.least_of_either)}
    write_atomically(args.out, json.dumps(content, indent=1, allow_nan=False) + "\n")
    report(content)
    print(f"written: {args.out}")
    return 0


def candidates_of(args: Args, split: Split) -> Sequence[Mapping[str, object]]:
    """Returns the lines of the first `args.episodes` episodes; those that are not in the log yet are run now."""
    log = args.log or default_log("verifier", args, split)
    runner = RunnerSpec(f"{__name__}:{CandidateRunner.__name__}", args)  # a script is `__main__` in its workers too
    return [line.as_json() for line in lines_of(args, split, log, CandidateLine, runner)]


class CandidateRunner:
    """A runner of `sim.app.evaluation.workers` whose agent records candidates."""

    def __init__(self, args: Args) -> None:
        self._seed = args.seed
        spec = find_segmentation(args.semantics, args.weights).spec
        self._env = ObjectNavEnv(
            split=args.split, sensors=("depth", *spec.sensors), truth=spec.truth, max_steps=args.max_steps
        )
        self._recorder = CandidateRecorder(self._env, make_segmenter(args.semantics, self._env, args.weights))

    def run(self, episode: Episode) -> CandidateLine:
        """Runs one episode to its last step, or until it fails; returns its line."""
        seed = episode_seeds(self._seed, episode.episode_id).environment
        steps = self._recorder.run(episode, seed)
        return CandidateLine.of(episode, steps, candidates=self._recorder.candidates)

    def close(self) -> None:
        """Frees the renderers."""
        self._env.close()


def report(fitted: Mapping[str, Any]) -> None:
    """Prints the counts, and the quality on houses left out, of what `sim.training.fits.verifier.fit` returns."""
    print(f"{fitted['episodes']} episodes")
    method = fitted["methods"][NAIVE_BAYES]
    for goal, pair in fitted["candidates"].items():
        pooled = "" if goal in method["categories"] else "  (pooled)"
        print(f"  {goal:18s} {pair['true']:5d} true {pair['false']:5d} false{pooled}")
    shares = {key: value for key, value in method["left_out"].items() if key != "by_probability"}
    print(f"{NAIVE_BAYES}, on houses left out: " + ", ".join(f"{key} {value}" for key, value in shares.items()))
    for row in method["left_out"]["by_probability"]:
        print("  " + ", ".join(f"{key} {value}" for key, value in row.items()))
