"""Compares the 2-D twin with recorded runs of the real environment (docs/plans.md).

    python tools/check_twin.py --plans runs/plans/val --runs runs/val_stubborn runs/val_frontier-avoid --explore

The runs must have been recorded with `--record`. Two comparisons, each by Spearman's rank correlation over episodes of
the explored area and of the step of first sight:

- the recorded poses are replayed in the twin, which isolates its camera;
- with `--explore`, the run's agent explores the twin from the same starts. A robot that is 1 mm elsewhere may take
  another door, so the same is done once more from starts moved by `--shift-m`: the correlation between these two runs
  of the twin is what any imitation can reach.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import spearmanr

from sim import cli
from sim.errors import ConfigError
from sim.evaluation.rollout import episode_seed
from sim.geometry.grid import GridFrame
from sim.geometry.pose import Pose
from sim.plans.plan import read_plan
from sim.plans.sight import PlanCamera
from sim.task.metrics import EXPLORED_SHARE, steps_to_first_sight
from sim.task.trajectory import Trajectory, read_trajectory, trajectory_file
from sim.twin.agent import TwinAgent, play, twin_config
from stubborn.agent import AgentConfig
from stubborn.agents import SPECS
from stubborn.navmap import NavMap

MEASURES = ("area_seen_m2", "steps_to_first_sight")


@dataclass(frozen=True, kw_only=True)
class Args:
    """Options of the command."""

    plans: Path
    """Folder of the plans of the split (tools/export_plans.py)."""
    runs: tuple[Path, ...]
    """Folders of recorded runs on that split."""
    explore: bool = False
    """Also run the agent of each run in the twin."""
    episodes: cli.Count | None = None
    """Only the first so many episodes of each run."""
    shift_m: cli.NotNegative = 0.01
    """Distance by which the starts of the second run in the twin are moved."""
    out: cli.OutFile | None = None
    """File for a JSON line of each episode."""


@dataclass(frozen=True)
class Recorded:
    """An episode of a run."""

    run: Path
    line: dict[str, Any]
    trajectory: Trajectory

    @property
    def start(self) -> Pose:
        """Start pose in the world."""
        x_m, y_m, yaw_rad, floor_z_m = (float(value) for value in self.trajectory.poses[0])
        return Pose(x_m, y_m, yaw_rad, floor_z_m)


class Cameras:
    """The cameras of the plans, read on first use."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._cameras: dict[str, PlanCamera] = {}

    def of(self, house: str) -> PlanCamera:
        """Returns the camera of a house's lowest storey."""
        if house not in self._cameras:
            self._cameras[house] = PlanCamera(read_plan(self._folder / f"{house}.npz"))
        return self._cameras[house]


def main(args: Args) -> int:
    """Prints the correlations."""
    cameras, lines = Cameras(args.plans), []
    everything = []
    for run in args.runs:
        recorded = list(_recorded(run, args.episodes))
        replayed = [replay(cameras.of(each.line["house"]), each) for each in recorded]
        everything += list(zip(recorded, replayed, strict=True))
        lines += [_line(each, "replay", found) for each, found in zip(recorded, replayed, strict=True)]
        _report(f"{run.name}: poses replayed", [each.line for each in recorded], replayed)
        if args.explore and (name := json.loads((run / "config.json").read_text())["agent"]) in SPECS:
            agent = TwinAgent(twin_config(_config(name)))
            twin = [explore(agent, cameras, each, 0.0) for each in recorded]
            shifted = [explore(agent, cameras, each, args.shift_m) for each in recorded]
            lines += [_line(each, "explore", found) for each, found in zip(recorded, twin, strict=True)]
            lines += [_line(each, "shifted", found) for each, found in zip(recorded, shifted, strict=True)]
            _report(f"{run.name}: {name} in the twin", [each.line for each in recorded], twin)
            _report(f"{run.name}: twin against starts moved by {args.shift_m} m", twin, shifted)
    _report("all runs: poses replayed", [each.line for each, _ in everything], [found for _, found in everything])
    if args.out is not None:
        args.out.parent.mkdir(parents=True, exist_ok=True)
        args.out.write_text("".join(json.dumps(line) + "\n" for line in lines), encoding="utf-8")
    return 0


def replay(camera: PlanCamera, recorded: Recorded) -> dict[str, Any]:
    """Returns area and step of first sight that the recorded poses give in the twin."""
    camera.reset()
    navmap = NavMap.empty(GridFrame.around_start(1440, 0.05))
    start, goal, first = recorded.start, recorded.line["goal"], None
    for step, pose in enumerate(recorded.trajectory.poses):
        here = Pose(*(float(value) for value in pose))
        look = camera.look(here, goal, navmap, here.relative_to(start), step)
        if first is None and look.goal_share >= EXPLORED_SHARE:
            first = step
    return {"area_seen_m2": camera.area_seen_m2, "steps_to_first_sight": steps_to_first_sight(first, 500)}


def explore(agent: TwinAgent, cameras: Cameras, recorded: Recorded, shift_m: float) -> dict[str, Any]:
    """Returns the metrics of the agent in the twin, from the recorded start moved back by some metres."""
    line, start = recorded.line, recorded.start
    x_m, y_m = start.ahead(-shift_m)
    seed = episode_seed(int(line["seed"]), line["episode_id"])
    return dict(play(agent, cameras.of(line["house"]), line["goal"], replace(start, x_m=x_m, y_m=y_m), seed=seed))


def _recorded(run: Path, most: int | None) -> Iterator[Recorded]:
    """Yields the episodes of a run that began and have a trajectory."""
    file = run / "results.jsonl"
    if not file.is_file():
        raise ConfigError(f"'{run}' has no results.jsonl: give folders of runs made with --record.")
    for text in file.read_text(encoding="utf-8").splitlines()[:most]:
        line = json.loads(text)
        trajectory = trajectory_file(run, line["episode_id"])
        if line["end_reason"] != "error" and trajectory.is_file():
            yield Recorded(run, line, read_trajectory(trajectory))


def _config(name: str) -> AgentConfig:
    """Returns the configuration of a named agent that builds a map."""
    config = SPECS[name].config
    if not isinstance(config, AgentConfig):
        raise ConfigError(f"Agent '{name}' builds no map: the twin runs the agents of `AgentConfig` only.")
    return config


def _line(recorded: Recorded, kind: str, found: dict[str, Any]) -> dict[str, Any]:
    """Returns the line of an episode with both worlds' measures."""
    real = {key: recorded.line[key] for key in (*MEASURES, "num_steps", "collisions", "success")}
    names = {key: recorded.line[key] for key in ("episode_id", "house", "goal", "agent")}
    return {"run": recorded.run.name, "kind": kind, **names, "real": real, "twin": found}


def _report(title: str, first: Sequence[dict[str, Any]], second: Sequence[dict[str, Any]]) -> None:
    """Prints the rank correlations of two lists of measures."""
    parts = []
    for key in MEASURES:
        a, b = (np.array([float(each[key]) for each in lines]) for lines in (first, second))
        rank = float(np.asarray(spearmanr(a, b))[0]) if len(a) > 2 else float("nan")
        parts.append(f"{key} {rank:.3f} (medians {np.median(a):.1f}, {np.median(b):.1f})")
    print(f"{title}, {len(first)} episodes: {'; '.join(parts)}", flush=True)


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
