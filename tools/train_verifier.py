"""Fit the verifier of a kind of semantics, on candidates that the agent meets in houses of the train split.

    python tools/train_verifier.py --semantics noisy --split train --episodes 2000 --workers 2
    python tools/train_verifier.py --semantics noisy --split val --episodes 200 --judge

The agent plays without stopping: whatever it would verify is logged with its four features, the truth, whether a STOP
there would succeed, and the place; then it goes on as if the candidate had been rejected. A last resort, a place too
far away or out of sight, is left out: no STOP there tells what is true. The log has a line an episode; the same
command goes on where it was, and more episodes add to what is there, while split, modules and rates are the same;
--minutes 0 plays nothing and fits what is there, whatever code played it. What is left of an object after such a
rejection is met again, several times: of the true candidates of an episode within 2 m of one another only the first
counts, and so with the false ones. Then each method of verification is fitted for each goal category, and pooled for
those with too few candidates of either kind, and written as JSON with counts and with what it is worth on episodes left
out (`stubborn/target/verifier_fit.py`). Houses of val and test are for --judge only.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sim import cli
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.splits import Episode, Split, load_split
from sim.errors import EpisodeError, PhysicsError
from sim.evaluation.executors import make_executor
from sim.evaluation.results import RunDirectory
from sim.evaluation.rollout import episode_seed
from sim.evaluation.workers import RunnerSpec
from sim.interface import Action, ConfigError
from sim.paths import code_hash
from sim.segmenters import SEMANTICS, check_semantics, describe_semantics, make_segmenter, truth_needed
from stubborn import agents
from stubborn.agent import StubbornAgent
from stubborn.target.classifiers import Features
from stubborn.target.seeker import TargetConfig
from stubborn.target.verification import FOLDER, METHODS, UNVERIFIED, FittedVerifier
from stubborn.target.verifier_fit import fit, judge_by_category

NEVER = 1_000_000
"""A step that no episode reaches."""
BATCH = 100


@dataclass(frozen=True)
class Args:
    """Let the agent meet candidates, then fit a verifier to them."""

    semantics: str = "noisy"
    """Whose mistakes are learned: a kind of `sim.run` that leaves something to verify."""
    weights: Path | None = None
    """With --semantics rednet: your network in place of the shipped one."""
    split: str = "train"
    """A shipped split, or a folder laid out like one."""
    episodes: int = 400
    """The first N of the split."""
    workers: int = 1
    """Processes."""
    minutes: float | None = None
    """Play no longer than this; 0 plays nothing."""
    judge: bool = False
    """Fit nothing: judge the parameters that are there (--out) on these candidates, by category."""
    max_steps: int = 200
    """Of an episode: what is first found after step 200 is never verified."""
    least_of_either: int = 20
    """A category with fewer true or fewer false candidates takes the pooled classifier."""
    seed: int = 0
    """Of the episodes."""
    log: Path | None = None
    """Folder of the log; runs/verifier-<semantics>-<split> when not given."""
    out: Path | None = None
    """File of the parameters; stubborn/verifiers/<semantics>.json when not given."""


class Witness:
    """A verifier that refuses everything and writes down what it was asked, and what would have been right.

    Not what it is asked from a last resort (`Approach.near_enough` is False), up to 1.6 m away: there a STOP at the
    real thing fails too, so that real objects would be logged as false candidates.
    """

    may_refuse = True

    def __init__(self, env: ObjectNavEnv) -> None:
        self._env = env
        self.agent: StubbornAgent | None = None
        """Who asks: its approach tells from where. None: whatever is asked is written down."""
        self.candidates: list[list[float]] = []
        """Features, then 1 where a STOP would have succeeded, else 0, then the robot's x and y in metres."""

    def accepts(self, goal: str, features: Features) -> bool:
        """False."""
        approach = None if self.agent is None else self.agent.approach
        if approach is not None and not approach.near_enough:
            return False
        world, task = self._env.scene.world, self._env.scene.task
        x_m, y_m, floor_z_m = world.pose.x_m, world.pose.y_m, world.pose.floor_z_m
        truth = task.truth.succeeds_now(goal, x_m, y_m, floor_z_m)
        self.candidates.append([round(float(value), 4) for value in (*features, truth, x_m, y_m)])
        return False

    def would_accept(self, goal: str, features: Features) -> bool:
        """False, and nothing is written down: the nearest candidate is visited first."""
        return False


def main(args: Args) -> int:
    """Play, then fit and write, or judge."""
    _check(args)
    split = load_split(args.split)
    lines = candidates_of(args, split)
    file = args.out or FOLDER / f"{args.semantics}.json"
    if args.judge:
        print(judgement(lines, file))
        return 0
    about = {"name": split.name, "version": split.version}
    content = {"semantics": args.semantics, "command": command(args), "split": about} | fit(lines, args.least_of_either)
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps(content, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    report(content)
    print(f"written: {file}")
    return 0


def candidates_of(args: Args, split: Split) -> list[dict[str, Any]]:
    """The lines of the log's first `args.episodes` episodes, those that were there and those played now."""
    log = args.log or Path("runs") / f"verifier-{args.semantics}-{split.name}"
    if args.minutes == 0:
        text = (log / "results.jsonl").read_text(encoding="utf-8") if (log / "results.jsonl").is_file() else ""
        lines = [json.loads(line) for line in text.splitlines()]
    else:
        run = RunDirectory(log, log_config(args, split))
        try:
            play(args, split, run)
            lines = run.lines
        finally:
            run.close()
    wanted = {episode.episode_id for episode in split.episodes[: args.episodes]}
    return sorted((line for line in lines if line["episode_id"] in wanted), key=lambda line: line["episode_id"])


def log_config(args: Args, split: Split) -> dict[str, Any]:
    """What all lines of a log have in common: with anything else `RunDirectory` refuses to go on.

    The code is that of the modules only: what is fitted here is not used while playing, and would end its own log.
    """
    return {
        "semantics": args.semantics,
        **describe_semantics(args.semantics, args.weights),
        "seed": args.seed,
        "max_steps": args.max_steps,
        "split_identity": {"name": split.name, "version": split.version, "sha256": split.sha256},
        "code": code_hash(parameters=False),
    }


def play(args: Args, split: Split, run: RunDirectory) -> None:
    """Play what is not in the log yet, until the time is up."""
    done = {line["episode_id"] for line in run.lines}
    todo = [episode for episode in split.episodes[: args.episodes] if episode.episode_id not in done]
    print(f"{len(done)} episodes are there, {len(todo)} to go; log in {run.path}", flush=True)
    until_s = time.monotonic() + 60.0 * args.minutes if args.minutes is not None else float("inf")
    executor = make_executor("local", workers=args.workers)
    spec = RunnerSpec(f"{__name__}:{Outing.__name__}", args)  # a script is `__main__` to its workers too
    # In batches: a house is loaded once in a batch, and a run cut short is still balanced.
    for batch in (todo[first : first + BATCH] for first in range(0, len(todo), BATCH)):
        for line in executor.run(spec, batch, on_death=lambda episode: line_of(episode, 0, [])):
            run.append(line)
            if time.monotonic() > until_s:
                return


def line_of(episode: Episode, steps: int, candidates: list[list[float]]) -> dict[str, Any]:
    """A line of the log."""
    about = {"episode_id": episode.episode_id, "goal": episode.goal, "house": episode.house}
    return about | {"steps": steps, "candidates": candidates}


class Outing:
    """One process's environment, agent and witness; see `sim.evaluation.workers`."""

    def __init__(self, args: Args) -> None:
        self._seed = args.seed
        self._env = ObjectNavEnv(
            split=args.split,
            sensors=("depth", *SEMANTICS[args.semantics]),
            truth=truth_needed(args.semantics),
            max_steps=args.max_steps,
        )
        self.witness = Witness(self._env)
        agent = agents.make(
            "stubborn",
            camera=self._env.camera_model,
            robot=self._env.robot_model,
            segmenter=make_segmenter(args.semantics, self._env, weights=args.weights),
            verifier=self.witness,
            target=TargetConfig(verify_until_step=NEVER, last_resort_step=NEVER),
        )
        assert isinstance(agent, StubbornAgent)
        self._agent = self.witness.agent = agent

    def run(self, episode: Episode) -> dict[str, Any]:
        """One episode to its last step; one that breaks ends there."""
        self.witness.candidates = []
        seed = episode_seed(self._seed, episode.episode_id)
        try:
            observation, _ = self._env.reset(seed=seed, options={"episode": episode})
            self._agent.reset(episode.goal, seed)
            truncated = False
            while not truncated:
                action = self._agent.act(observation)
                if action == Action.STOP:  # cannot be: everything is refused
                    break
                observation, _, _, truncated, _ = self._env.step(action)
            steps = self._env.scene.task.num_steps
        except (EpisodeError, PhysicsError):
            steps = 0
        return line_of(episode, steps, self.witness.candidates)

    def close(self) -> None:
        """Free the renderers."""
        self._env.close()


def command(args: Args) -> str:
    """What to type to get the same."""
    options = f"--semantics {args.semantics} --split {Path(args.split).name} --episodes {args.episodes}"
    return f"python tools/train_verifier.py {options} --max-steps {args.max_steps} --seed {args.seed}"


def report(content: Mapping[str, Any]) -> None:
    """Print counts, and what each method is worth on episodes left out."""
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
    """A Markdown table: candidates of each category before and after verification by the parameters of a file."""
    rows = ["| method | goal | true | false | precision before | precision after | true accepted | false rejected |"]
    rows.append("|---|---|---|---|---|---|---|---|")
    for method in METHODS:
        for goal, found in judge_by_category(lines, FittedVerifier.read(file, method)).items():
            true = round(found["precision_before"] * found["candidates"])
            shares = [found[key] for key in ("precision_before", "precision", "true_accepted", "false_rejected")]
            told = " | ".join("-" if share is None else f"{share:.2f}" for share in shares)
            rows.append(f"| {method} | {goal} | {true} | {found['candidates'] - true} | {told} |")
    return "\n".join(rows)


def _check(args: Args) -> None:
    check_semantics(args.semantics, args.weights)
    if args.semantics in UNVERIFIED:
        kinds = [kind for kind in SEMANTICS if kind not in UNVERIFIED]
        raise ConfigError(f"--semantics '{args.semantics}' has no verifier to fit. There is: {', '.join(kinds)}.")
    if args.split in ("val", "test") and not args.judge:
        raise ConfigError(f"Verifiers are never fitted on '{args.split}'; --judge judges one there.")
    if args.workers < 1:
        raise ConfigError(f"--workers must be at least 1, got {args.workers}.")
    if args.minutes is not None and not args.minutes >= 0.0:
        raise ConfigError(f"--minutes must be at least 0, got {args.minutes}.")
    if args.episodes < 1 or args.max_steps < 1 or args.least_of_either < 2:
        raise ConfigError("--episodes and --max-steps must be at least 1, --least-of-either at least 2.")


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
