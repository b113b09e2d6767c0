"""Compares habitat-lab's measures with this project's on the same actions, in the environment of habitat-lab.

    .venv-habitat/bin/python -m tools.research.habitat_parity --episodes 50 --out parity.csv

The actions are those of the oracle with 15 % random ones; every third episode stops after 25 actions, so that there are
failures. Each episode is driven three times: in `ObjectNavEnv`, in habitat-lab with this project's rule, and in
habitat-lab with Habitat's rule and view points of `stubborn habitat dataset` (`--view-points FILE`, if given).
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sim.app import cli
from sim.core.files import csv_text, write_atomically
from sim.core.interface import Action
from sim.env.objectnav import ObjectNavEnv
from sim.env.oracle import Oracle

NAMES = ("success", "spl", "soft_spl", "distance_to_goal")
RANDOM_SHARE, EARLY_STOP, EARLY_STEPS = 0.15, 3, 25


@dataclass(frozen=True)
class Args:
    """Compare habitat-lab's measures with this project's on the same actions."""

    episodes: cli.Count = 50
    """The first episodes of the split."""
    split: str = "val"
    """A shipped split."""
    view_points: str | None = None
    """Data path of `stubborn habitat dataset`, such as lab/val/val.json.gz: also compares Habitat's own rule."""
    out: cli.OutFile = Path("parity.csv")
    """A row for each episode."""


def main(args: Args) -> int:
    """Drives the episodes and writes a row for each; returns the exit status."""
    config = _config(args.split)  # provides habitat_sim to this process
    import habitat

    envs = {"lab": habitat.Env(config)}
    if args.view_points:
        envs["view_points"] = habitat.Env(_config(args.split, view_points=args.view_points))
    ours = ObjectNavEnv(split=args.split, sensors=("rgb", "depth"))
    rows, seconds, steps = [], {"ours": 0.0, **dict.fromkeys(envs, 0.0)}, 0
    for number in range(args.episodes):
        row: dict[str, Any] = {}
        actions, row["steps"] = [], 0
        for env in envs.values():
            env.reset()
        name = str(envs["lab"].current_episode.info["stubborn_id"])
        row["episode_id"] = name
        for action in _actions(ours, name, number):
            begin = time.perf_counter()
            info = ours.step(action)[4]
            seconds["ours"] += time.perf_counter() - begin
            actions.append(action)
        row["steps"] = len(actions)
        steps += len(actions)
        row |= {f"ours_{key}": info[key] for key in NAMES}
        for label, env in envs.items():
            if str(env.current_episode.info["stubborn_id"]) != name:
                raise SystemExit(f"{label} is at another episode: {env.current_episode.info}.")
            begin = time.perf_counter()
            for action in actions:
                env.step(int(action))
            seconds[label] += time.perf_counter() - begin
            row |= {f"{label}_{key}": env.get_metrics()[key] for key in NAMES}
        rows.append(row)
    write_atomically(args.out, csv_text(list(rows[0]), (row.values() for row in rows)))
    for label in envs:
        worst = {key: max(abs(row[f"{label}_{key}"] - row[f"ours_{key}"]) for row in rows) for key in NAMES}
        other = [row["episode_id"] for row in rows if row[f"{label}_success"] != row["ours_success"]]
        print(f"{label}: largest differences {worst}; another success in {len(other)} of {len(rows)}: {other}")
        means = {
            key: [float(np.mean([row[f"{who}_{key}"] for row in rows])) for who in ("ours", label)] for key in NAMES
        }
        print(f"    means, ours and {label}: {means}")
    print("steps/s:", {label: round(steps / spent, 1) for label, spent in seconds.items()})
    return 0


def _config(split: str, view_points: str | None = None) -> Any:
    """Returns the configuration in the order of the split."""
    import stubborn_habitat

    order = [
        "habitat.environment.iterator_options.shuffle=False",
        "habitat.environment.iterator_options.group_by_scene=False",
    ]
    config = stubborn_habitat.get_config(split, order, rule="stubborn" if view_points is None else "view_points")
    if view_points is not None:
        from habitat.config.read_write import read_write
        from habitat.core.registry import registry
        from habitat.datasets.object_nav.object_nav_dataset import ObjectNavDatasetV1

        class InOrder(ObjectNavDatasetV1):
            def __init__(self, config: Any = None) -> None:
                super().__init__(config)
                self.episodes = sorted(self.episodes, key=lambda episode: episode.info["stubborn_id"])

        registry.register_dataset(InOrder, name="in-order")
        with read_write(config):
            config.habitat.dataset.type = "in-order"
            config.habitat.dataset.data_path = view_points
    return config


def _actions(env: ObjectNavEnv, episode_id: str, seed: int) -> Any:
    """Yields the actions of an episode, each after the one before was carried out."""
    info = env.reset(options={"episode_id": episode_id})[1]
    oracle, rng = Oracle(env), np.random.default_rng(seed)
    oracle.reset(info["goal"], 0)
    while not (env.scene.task.terminated or env.scene.task.truncated):
        action = oracle.choose()
        if rng.random() < RANDOM_SHARE:
            action = Action(int(rng.integers(1, 4)))
        if seed % EARLY_STOP == 0 and env.scene.task.num_steps == EARLY_STEPS:
            action = Action.STOP
        yield action


if __name__ == "__main__":
    raise SystemExit(cli.run(Args, main))
