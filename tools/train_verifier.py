"""Fits the verifier of a kind of segmentation to candidates that the agent finds in houses of the train split.

    python tools/train_verifier.py --semantics noisy --split train --episodes 2000 --workers 2
    python tools/train_verifier.py --semantics noisy --split val --episodes 200 --judge

The agent runs without stopping. Each candidate that it would verify is logged with its four features, the truth
(whether a STOP there would succeed) and the robot's position; the agent then continues as if it had rejected the
candidate. Candidates that are verified from too far away to stop are not logged, since a STOP there always fails.

The log has one line per episode. The same command continues it, and more episodes extend it, as long as split, modules
and detector are the same. --minutes 0 runs no episode and fits the existing log, whichever code made it. The agent
finds the rest of an object again after such a rejection: of the true candidates of an episode within 2 m of each other
only the first counts, and so for the false ones.

Then each method of verification is fitted for each goal category, and pooled for those with too few true or false
candidates, and written as JSON with the counts and its quality on episodes left out (`stubborn.target.verifier_fit`).
Houses of val and test are for --judge only.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from sim import cli
from sim.composition.segmenters import KINDS, check_semantics, detector_config, detector_record, make_segmenter
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.splits import Episode, Split, load_split
from sim.errors import EpisodeError, PhysicsError
from sim.evaluation.executors import make_executor
from sim.evaluation.results import RunDirectory, read_result_lines
from sim.evaluation.rollout import episode_seed
from sim.evaluation.workers import RunnerSpec
from sim.files import write_atomically
from sim.interface import Action, ConfigError
from sim.paths import code_hash
from sim.reading import Count as ReadCount
from sim.reading import Name, Number
from stubborn.agent import AgentConfig, StubbornAgent
from stubborn.target.classifiers import Features
from stubborn.target.distances import TargetConfig
from stubborn.target.verification import FOLDER, METHODS, FittedVerifier
from stubborn.target.verifier_fit import fit, judge_by_category

NEVER = 1_000_000
"""A step that no episode reaches."""
BATCH = 100
"""Number of episodes that are given to the workers together."""


@dataclass(frozen=True)
class Args:
    """Logs candidates that the agent finds, then fits a verifier to them."""

    semantics: str = "noisy"
    """The kind of segmentation whose errors are learned; one of `sim.run` that needs verification."""
    weights: Path | None = None
    """With --semantics rednet: weights in place of the shipped ones."""
    split: str = "train"
    """A shipped split, or a folder with the same layout."""
    episodes: cli.Count = 400
    """Number of episodes, the first of the split."""
    workers: cli.Count = 1
    """Number of processes."""
    minutes: cli.NotNegative | None = None
    """Time limit of the episodes; 0 runs none."""
    judge: bool = False
    """Fit nothing; judge the existing parameters (--out) on these candidates, by category."""
    max_steps: cli.Count = 200
    """Steps of an episode; an agent never verifies what it first finds after step 200."""
    least_of_either: cli.Count = 20
    """A category with fewer true or fewer false candidates uses the pooled classifier."""
    seed: cli.Seed = 0
    """Seed of the episodes."""
    log: cli.OutFolder | None = None
    """Folder of the log; None: runs/verifier-<semantics>-<split>."""
    out: cli.OutFile | None = None
    """File of the parameters; None: stubborn/target/verifiers/<semantics>.json."""


class CandidateLine(msgspec.Struct):
    """A line of the log."""

    episode_id: Name
    goal: Name
    house: Name
    steps: ReadCount
    candidates: list[tuple[Number, Number, Number, Number, Number, Number, Number]]


class RecordingVerifier:
    """A verifier that rejects every candidate and records it with the truth.

    Candidates that are verified from too far away to stop (`Approach.near_enough` is False) are not recorded: a STOP
    fails there at a true instance too, which would be recorded as a false candidate.
    """

    may_refuse = True

    def __init__(self, env: ObjectNavEnv) -> None:
        self._env = env
        self.agent: StubbornAgent | None = None
        """The agent that asks; None: every candidate is recorded."""
        self.candidates: list[list[float]] = []
        """Features; 1 where a STOP would have succeeded, else 0; the robot's x and y in metres."""

    def accepts(self, goal: str, features: Features) -> bool:
        """Records the candidate and returns False."""
        approach = None if self.agent is None else self.agent.approach
        if approach is not None and not approach.near_enough:
            return False
        world, task = self._env.scene.world, self._env.scene.task
        x_m, y_m, floor_z_m = world.pose.x_m, world.pose.y_m, world.pose.floor_z_m
        truth = task.truth.succeeds_now(goal, x_m, y_m, floor_z_m)
        self.candidates.append([round(float(value), 4) for value in (*features, truth, x_m, y_m)])
        return False

    def would_accept(self, goal: str, features: Features) -> bool:
        """Returns False and records nothing, so that the nearest candidate is visited first."""
        return False


def main(args: Args) -> int:
    """Runs the episodes, then fits and writes, or judges; returns the exit status."""
    _check(args)
    split = load_split(args.split)
    lines = candidates_of(args, split)
    file = args.out or FOLDER / f"{args.semantics}.json"
    if args.judge:
        print(judgement(lines, file))
        return 0
    about = {"name": split.name, "version": split.version}
    content = {"semantics": args.semantics, "command": command(args), "split": about} | fit(lines, args.least_of_either)
    write_atomically(file, json.dumps(content, indent=1, allow_nan=False) + "\n")
    report(content)
    print(f"written: {file}")
    return 0


def candidates_of(args: Args, split: Split) -> list[dict[str, Any]]:
    """Returns the lines of the first `args.episodes` episodes; those that are not in the log yet are run now."""
    log = args.log or Path("runs") / f"verifier-{args.semantics}-{split.name}"
    if args.minutes == 0:
        lines = read_result_lines(log / "results.jsonl", CandidateLine).values
    else:
        run = RunDirectory(log, log_config(args, split), CandidateLine)
        try:
            run_episodes(args, split, run)
            lines = run.lines
        finally:
            run.discard_if_empty()
            run.close()
    wanted = {episode.episode_id for episode in split.episodes[: args.episodes]}
    return sorted((line for line in lines if line["episode_id"] in wanted), key=lambda line: line["episode_id"])


def log_config(args: Args, split: Split) -> dict[str, Any]:
    """Returns the values that all lines of a log have in common; `RunDirectory` refuses to continue with others.

    The hash of the code is that of the modules without fitted parameters, since the episodes do not use them.
    """
    return {
        "semantics": args.semantics,
        "detector": detector_record(detector_config(args.semantics, args.weights)),
        "seed": args.seed,
        "max_steps": args.max_steps,
        "split_identity": {"name": split.name, "version": split.version, "sha256": split.sha256},
        "code": code_hash(parameters=False),
    }


def run_episodes(args: Args, split: Split, run: RunDirectory) -> None:
    """Runs the episodes that are not in the log yet, until the time is up."""
    done = {line["episode_id"] for line in run.lines}
    todo = [episode for episode in split.episodes[: args.episodes] if episode.episode_id not in done]
    print(f"{len(done)} episodes are in the log {run.path}, {len(todo)} are run now", flush=True)
    until_s = time.monotonic() + 60.0 * args.minutes if args.minutes is not None else float("inf")
    executor = make_executor("local", workers=args.workers)
    spec = RunnerSpec(f"{__name__}:{CandidateRunner.__name__}", args)  # a script is `__main__` in its workers too
    # In batches: a house is loaded once per batch, and a run that is cut short is still balanced.
    for batch in (todo[first : first + BATCH] for first in range(0, len(todo), BATCH)):
        for line in executor.run(spec, batch, on_death=lambda episode: line_of(episode, 0, [])):
            run.append(line)
            if time.monotonic() > until_s:
                return


def line_of(episode: Episode, steps: int, candidates: list[list[float]]) -> dict[str, Any]:
    """Returns a line of the log."""
    about = {"episode_id": episode.episode_id, "goal": episode.goal, "house": episode.house}
    return about | {"steps": steps, "candidates": candidates}


class CandidateRunner:
    """A runner of `sim.evaluation.workers` whose agent records candidates."""

    def __init__(self, args: Args) -> None:
        self._seed = args.seed
        spec = KINDS[args.semantics].spec
        self._env = ObjectNavEnv(
            split=args.split, sensors=("depth", *spec.sensors), truth=spec.truth, max_steps=args.max_steps
        )
        self._recorder = RecordingVerifier(self._env)
        self._agent = self._recorder.agent = StubbornAgent(
            camera=self._env.camera_model,
            robot=self._env.robot_model,
            success=self._env.success_rule,
            segmenter=make_segmenter(args.semantics, self._env, detector_config(args.semantics, args.weights)),
            verifier=self._recorder,
            config=AgentConfig(target=TargetConfig(verify_until_step=NEVER, last_resort_step=NEVER)),
        )

    def run(self, episode: Episode) -> dict[str, Any]:
        """Runs one episode to its last step, or until it fails; returns its line."""
        self._recorder.candidates = []
        seed = episode_seed(self._seed, episode.episode_id)
        try:
            observation, _ = self._env.reset(seed=seed, options={"episode": episode})
            self._agent.reset(episode.goal, seed)
            truncated = False
            while not truncated:
                action = self._agent.act(observation)
                if action == Action.STOP:  # cannot happen: every candidate is rejected
                    break
                observation, _, _, truncated, _ = self._env.step(action)
            steps = self._env.scene.task.num_steps
        except (EpisodeError, PhysicsError):
            steps = 0
        return line_of(episode, steps, self._recorder.candidates)

    def close(self) -> None:
        """Frees the renderers."""
        self._env.close()


def command(args: Args) -> str:
    """Returns the command that gives the same parameters."""
    options = f"--semantics {args.semantics} --split {Path(args.split).name} --episodes {args.episodes}"
    return f"python tools/train_verifier.py {options} --max-steps {args.max_steps} --seed {args.seed}"


def report(content: Mapping[str, Any]) -> None:
    """Prints the counts, and the quality of each method on episodes left out."""
    print(f"{content['episodes']} episodes")
    own = content["methods"]["naive-bayes"]["categories"]
    for goal, pair in content["candidates"].items():
        pooled = "" if goal in own else "  (pooled)"
        print(f"  {goal:18s} {pair['true']:5d} true {pair['false']:5d} false{pooled}")
    for method, fitted in content["methods"].items():
        left_out = dict(fitted["left_out"])
        rows = left_out.pop("by_probability")
        print(f"{method}, on episodes left out: " + ", ".join(f"{key} {value}" for key, value in left_out.items()))
        for row in rows:
            print("  " + ", ".join(f"{key} {value}" for key, value in row.items()))


def judgement(lines: Sequence[Mapping[str, Any]], file: Path) -> str:
    """Returns a Markdown table of the candidates of each category, before and after verification."""
    rows = ["| method | goal | true | false | precision before | precision after | true accepted | false rejected |"]
    rows.append("|---|---|---|---|---|---|---|---|")
    for method in METHODS:
        for goal, found in judge_by_category(lines, FittedVerifier.read(file, method)).items():
            true = round(found["precision_before"] * found["candidates"])
            shares = [found[key] for key in ("precision_before", "precision", "true_accepted", "false_rejected")]
            cells = " | ".join("-" if share is None else f"{share:.2f}" for share in shares)
            rows.append(f"| {method} | {goal} | {true} | {found['candidates'] - true} | {cells} |")
    return "\n".join(rows)


def _check(args: Args) -> None:
    """Raises ConfigError for arguments that are not allowed."""
    check_semantics(args.semantics, args.weights)
    if not KINDS[args.semantics].spec.needs_verification:
        kinds = [name for name, kind in KINDS.items() if kind.spec.needs_verification]
        raise ConfigError(f"--semantics '{args.semantics}' has no verifier to fit. There is: {', '.join(kinds)}.")
    if args.split in ("val", "test") and not args.judge:
        raise ConfigError(f"Verifiers are never fitted on '{args.split}'; use --judge there.")
    if args.workers < 1:
        raise ConfigError(f"--workers must be at least 1, got {args.workers}.")
    if args.minutes is not None and not args.minutes >= 0.0:
        raise ConfigError(f"--minutes must be at least 0, got {args.minutes}.")
    if args.episodes < 1 or args.max_steps < 1 or args.least_of_either < 2:
        raise ConfigError("--episodes and --max-steps must be at least 1, --least-of-either at least 2.")


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
