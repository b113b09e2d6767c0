"""Fit the verifier of a kind of semantics, on candidates that the agent meets in houses of the train split.

    python tools/train_verifier.py --semantics noisy --split train --episodes 2000

The agent plays without stopping: whatever it would verify is logged with its four features, the truth, whether a STOP
there would succeed, and the place; then it goes on as if the candidate had been rejected. A last resort, a place too
far away or out of sight, is left out: no STOP there tells what is true. The log has a line an episode; the same
command goes on where it was, and more episodes add to what is there, while split, modules and rates are the same. What
is left of an object after such a rejection is met again, several times: of the true candidates of an episode within 2 m
of one another only the first counts, and so with the false ones. Then one Gaussian naive Bayes is fitted for each goal
category, and a pooled one for those with too few candidates of either kind, and written as JSON with counts and a table
that says how far probabilities can be believed: cross-validated, episodes never on both sides.
"""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.model_selection import GroupKFold
from sklearn.naive_bayes import GaussianNB

from sim import cli
from sim.env import ObjectNavEnv
from sim.episodes import Episode, Split
from sim.errors import EpisodeError, PhysicsError
from sim.interface import GOAL_CATEGORIES, Action, ConfigError
from sim.paths import code_hash
from sim.results import RunDirectory
from sim.rollout import episode_seed
from sim.segmenters import SEMANTICS, check_semantics, describe_semantics, make_segmenter, truth_needed
from stubborn import agents
from stubborn.agent import StubbornAgent
from stubborn.target import TargetConfig
from stubborn.verification import FOLDER, UNVERIFIED, Features

NEVER = 1_000_000
"""A step that no episode reaches."""
FOLDS = 5
SAME_PLACE_M = 2.0


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
    minutes: float | None = None
    """Play no longer than this; what is there is fitted."""
    max_steps: int = 200
    """Of an episode: what is first found after step 200 is never verified."""
    least_of_either: int = 20
    """A category with fewer true or fewer false candidates takes the pooled classifier."""
    seed: int = 0
    """Of the episodes."""
    log: Path | None = None
    """Folder of the log; runs/verifier-<semantics> when not given."""
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


def main(args: Args) -> int:
    """Play, fit, write."""
    _check(args)
    log = args.log or Path("runs") / f"verifier-{args.semantics}"
    env = ObjectNavEnv(
        split=args.split,
        sensors=("depth", *SEMANTICS[args.semantics]),
        truth=truth_needed(args.semantics),
        max_steps=args.max_steps,
    )
    try:
        run = RunDirectory(log, log_config(args, env.split))
        try:
            lines = play(args, env, run)
        finally:
            run.close()
    finally:
        env.close()
    split = {"name": env.split.name, "version": env.split.version}
    content = {"semantics": args.semantics, "command": command(args), "split": split} | fit(lines, args.least_of_either)
    out = args.out or FOLDER / f"{args.semantics}.json"
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(json.dumps(content, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    report(content)
    print(f"written: {out}")
    return 0


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


def play(args: Args, env: ObjectNavEnv, run: RunDirectory) -> list[dict[str, Any]]:
    """The lines of all episodes, those that were there and those played now."""
    witness = Witness(env)
    agent = agents.make(
        "stubborn",
        camera=env.camera_model,
        robot=env.robot_model,
        segmenter=make_segmenter(args.semantics, env, weights=args.weights),
        verifier=witness,
        target=TargetConfig(verify_until_step=NEVER, last_resort_step=NEVER),
    )
    assert isinstance(agent, StubbornAgent)
    witness.agent = agent
    done = {line["episode_id"] for line in run.lines}
    todo = [episode for episode in env.split.episodes[: args.episodes] if episode.episode_id not in done]
    print(f"{len(done)} episodes are there, {len(todo)} to go; log in {run.path}")
    until_s = time.monotonic() + 60.0 * args.minutes if args.minutes is not None else float("inf")
    # House by house in small batches: a house is loaded once in a batch, and a run cut short is still balanced.
    for batch in (todo[first : first + 40] for first in range(0, len(todo), 40)):
        for episode in sorted(batch, key=lambda episode: episode.house):
            if time.monotonic() > until_s:
                return run.lines
            witness.candidates = []
            steps = _one_episode(env, agent, episode, args.seed)
            run.append(
                {"episode_id": episode.episode_id, "goal": episode.goal, "house": episode.house, "steps": steps}
                | {"candidates": witness.candidates}
            )
    return run.lines


def _one_episode(env: ObjectNavEnv, agent: Any, episode: Episode, seed: int) -> int:
    """Play to the last step; returns how many. An episode that breaks ends there."""
    seed = episode_seed(seed, episode.episode_id)
    try:
        observation, _ = env.reset(seed=seed, options={"episode": episode})
        agent.reset(episode.goal, seed)
        for step in range(env.scene.task.max_steps):
            action = agent.act(observation)
            if action == Action.STOP:  # cannot be: everything is refused
                return step
            observation, _, _, truncated, _ = env.step(action)
            if truncated:
                break
        return env.scene.task.num_steps
    except (EpisodeError, PhysicsError):
        return 0


def fit(lines: Sequence[Mapping[str, Any]], least_of_either: int) -> dict[str, Any]:
    """Parameters of the pooled classifier and of each category with enough candidates, counts and calibration.

    Raises:
        ConfigError: there are fewer than `least_of_either` true or false candidates in all.
    """
    goals, groups, features, truth = _table(lines)
    if min(truth.sum(), (~truth).sum()) < least_of_either:
        raise ConfigError(
            f"The log holds {truth.sum()} true and {(~truth).sum()} false candidates; {least_of_either} of either are "
            "needed: play more episodes."
        )
    counts = {goal: [int((~truth[goals == goal]).sum()), int(truth[goals == goal].sum())] for goal in GOAL_CATEGORIES}
    own = [goal for goal, pair in counts.items() if min(pair) >= least_of_either]
    return {
        "features": list(Features._fields),
        "episodes": len(lines),
        "least_of_either": least_of_either,
        "candidates": {goal: {"false": pair[0], "true": pair[1]} for goal, pair in counts.items()},
        "calibration": _calibration(goals, groups, features, truth, own),
        "pooled": _parameters(features, truth),
        "categories": {goal: _parameters(features[goals == goal], truth[goals == goal]) for goal in own},
    }


def _table(
    lines: Sequence[Mapping[str, Any]],
) -> tuple[NDArray[np.str_], NDArray[np.intp], NDArray[np.float64], NDArray[np.bool_]]:
    """Goal, number of the episode, features (n, 4) and truth of all candidates."""
    rows = [(line["goal"], number, *each) for number, line in enumerate(lines) for each in _first_of_each(line)]
    goals = np.array([row[0] for row in rows], np.str_)
    groups = np.array([row[1] for row in rows], np.intp)
    values = np.array([row[2:] for row in rows], np.float64).reshape(-1, len(Features._fields) + 1)
    return goals, groups, values[:, :-1], values[:, -1] > 0.5


def _first_of_each(line: Mapping[str, Any]) -> list[list[float]]:
    """Features and truth of an episode's candidates, without those near an earlier one of the same truth."""
    met: list[tuple[float, float, float]] = []
    kept = []
    for *features, truth, x_m, y_m in line["candidates"]:
        if not any(truth == t and math.hypot(x_m - x, y_m - y) <= SAME_PLACE_M for t, x, y in met):
            kept.append([*features, truth])
            met.append((truth, x_m, y_m))
    return kept


def _parameters(features: NDArray[np.float64], truth: NDArray[np.bool_]) -> dict[str, Any]:
    """Of one Gaussian naive Bayes; class 0 is false, class 1 true."""
    model = GaussianNB().fit(features, truth)
    return {
        "prior": [round(float(value), 6) for value in model.class_prior_],
        "mean": np.round(model.theta_, 6).tolist(),
        "variance": [[float(f"{value:.6g}") for value in row] for row in model.var_],
    }


def _calibration(
    goals: NDArray[np.str_],
    groups: NDArray[np.intp],
    features: NDArray[np.float64],
    truth: NDArray[np.bool_],
    own: Sequence[str],
) -> dict[str, Any]:
    """How good probabilities are on episodes that were not fitted: accuracy, and the true share by probability."""
    classifier = np.where(np.isin(goals, own), goals, "")  # "": the pooled one, which is fitted to all
    probability = np.full(len(truth), np.nan)
    for train, test in GroupKFold(n_splits=min(FOLDS, len(np.unique(groups)))).split(features, truth, groups):
        for name in np.unique(classifier[test]):
            fitted = train if name == "" else train[goals[train] == name]
            asked = test[classifier[test] == name]
            if 0 < truth[fitted].sum() < len(fitted):
                model = GaussianNB().fit(features[fitted], truth[fitted])
                probability[asked] = model.predict_proba(features[asked])[:, 1]
    known = np.isfinite(probability)
    right = (probability > 0.5) == truth
    bins = np.clip(np.floor(np.nan_to_num(probability) * 5.0), 0, 4)
    return {
        "accuracy": _share(right[known]),
        "true_accepted": _share(right[known & truth]),
        "false_rejected": _share(right[known & ~truth]),
        "by_probability": [
            {
                "from": round(0.2 * number, 1),
                "to": round(0.2 * (number + 1), 1),
                "candidates": int((known & (bins == number)).sum()),
                "mean_probability": _share(probability[known & (bins == number)]),
                "true_share": _share(truth[known & (bins == number)]),
            }
            for number in range(5)
            if (known & (bins == number)).any()
        ],
    }


def _share(values: NDArray) -> float | None:
    return round(float(values.mean()), 4) if len(values) else None


def command(args: Args) -> str:
    """What to type to get the same."""
    options = f"--semantics {args.semantics} --split {Path(args.split).name} --episodes {args.episodes}"
    return f"python tools/train_verifier.py {options} --max-steps {args.max_steps} --seed {args.seed}"


def report(content: Mapping[str, Any]) -> None:
    """Print counts and calibration."""
    print(f"{content['episodes']} episodes")
    for goal, pair in content["candidates"].items():
        pooled = "" if goal in content["categories"] else "  (pooled)"
        print(f"  {goal:18s} {pair['true']:5d} true {pair['false']:5d} false{pooled}")
    calibration = dict(content["calibration"])
    rows = calibration.pop("by_probability")
    print("on episodes left out: " + ", ".join(f"{key} {value}" for key, value in calibration.items()))
    for row in rows:
        print("  " + ", ".join(f"{key} {value}" for key, value in row.items()))


def _check(args: Args) -> None:
    check_semantics(args.semantics, args.weights)
    if args.semantics in UNVERIFIED:
        kinds = [kind for kind in SEMANTICS if kind not in UNVERIFIED]
        raise ConfigError(f"--semantics '{args.semantics}' has no verifier to fit. There is: {', '.join(kinds)}.")
    if args.episodes < 1 or args.max_steps < 1 or args.least_of_either < 2:
        raise ConfigError("--episodes and --max-steps must be at least 1, --least-of-either at least 2.")


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
