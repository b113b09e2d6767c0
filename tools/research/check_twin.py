"""Compares the 2-D twin with recorded runs of the real environment (docs/explorers.md).

    python -m tools.research.check_twin --plans runs/plans/val --runs runs/stubborn runs/frontier-avoid --explore

The runs must have been recorded with `--record`. Two comparisons, each by Spearman's rank correlation over episodes of
the explored area and of the step of first sight:

- the recorded poses are replayed in the twin, which isolates its camera;
- with `--explore`, the run's agent, with the explorer and the settings of the run, explores the twin from the same
  starts. A robot that is 1 mm elsewhere may take another door, so the same is done once more from starts moved by
  `--shift-m`: the correlation between these two runs of the twin is what any imitation can reach. Runs with another
  robot, camera, task, segmentation or noise are refused, and so are agents that are more than a `StubbornAgent` with
  a configuration.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import spearmanr

from sim.app import cli
from sim.app.analysis.comparison import Run, read_run
from sim.app.composition.agents import find_explorer
from sim.app.evaluation.rollout import episode_seed
from sim.core.configuration import with_fields
from sim.core.errors import ConfigError
from sim.core.files import inside, write_atomically
from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import MAX_STEPS, CameraModel
from sim.homes.plans.plan import read_plan
from sim.homes.plans.sight import PlanCamera
from sim.robot.config import RobotConfig
from sim.sensors.noise import NoiseConfig
from sim.task.config import TaskConfig
from sim.task.metrics import EXPLORED_SHARE, steps_to_first_sight
from sim.task.trajectory import Trajectory, read_trajectory, trajectory_file
from sim.training.plan_env.agent import TwinAgent, run_episode, twin_config
from stubborn.agent import AgentConfig
from stubborn.agents import PRESETS
from stubborn.detection.seeker import TargetSeekerConfig
from stubborn.mapping.navmap import NavMap

MEASURES = ("area_seen_m2", "steps_to_first_sight")


@dataclass(frozen=True, kw_only=True)
class Args:
    """Options of the command."""

    plans: Path
    """Folder of the plans of the split (`stubborn houses plans`)."""
    runs: tuple[Path, ...]
    """Folders of recorded runs on that split."""
    explore: bool = False
    """Also run the agent of each run in the twin, with the run's explorer and settings."""
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
    line: Mapping[str, Any]
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
            self._cameras[house] = PlanCamera(read_plan(inside(self._folder, f"{house}.npz", what="house")))
        return self._cameras[house]


def main(args: Args) -> int:
    """Prints the correlations."""
    runs = [read_run(path) for path in args.runs]
    agents = [TwinAgent(twin_config(agent_config(run))) if args.explore else None for run in runs]
    cameras = Cameras(args.plans)
    lines: list[dict[str, Any]] = []
    everything: list[tuple[Recorded, dict[str, Any]]] = []
    for run, agent in zip(runs, agents, strict=True):
        recorded = recorded_episodes(run, args.episodes)
        replayed = [replay(cameras.of(each.line["house"]), each) for each in recorded]
        everything += zip(recorded, replayed, strict=True)
        lines += [_line(each, "replay", found) for each, found in zip(recorded, replayed, strict=True)]
        _report(f"{run.path.name}: poses replayed", [each.line for each in recorded], replayed)
        if agent is not None:
            lines += _explored(agent, cameras, recorded, args.shift_m)
    _report("all runs: poses replayed", [each.line for each, _ in everything], [found for _, found in everything])
    if args.out is not None:
        write_atomically(args.out, "".join(json.dumps(line) + "\n" for line in lines))
    return 0


def agent_config(run: Run) -> AgentConfig:
    """Returns the configuration of a run's agent, as the run's `config.json` records it.

    Raises:
        ConfigError: the twin cannot run this agent, or the run had another robot, camera, task, segmentation or noise.
    """
    name = str(run.recorded("agent"))
    config = next((config for there, (_, config) in PRESETS.items() if there == name and _is_playable(config)), None)
    if config is None:
        there = ", ".join(name for name, (_, config) in PRESETS.items() if _is_playable(config))
        raise ConfigError(f"'{run.path}' has the agent '{name}', which the twin cannot run. Available: {there}.")
    if run.config.get("robot"):
        raise ConfigError(f"'{run.path}' has a robot of its own ({run.config['robot']}), which the twin does not have.")
    if run.recorded("semantics") != "gt":
        raise ConfigError(f"'{run.path}' has --semantics {run.recorded('semantics')}; the twin has ground truth (gt).")
    same: Sequence[tuple[str, Any]] = (
        ("camera", CameraModel()), ("robot", RobotConfig()), ("task", TaskConfig()), ("noise", NoiseConfig()),
    )  # fmt: skip
    for part, default in same:
        if with_fields(default, _recorded_tree(run, part)) != default:
            raise ConfigError(f"'{run.path}' has another {part} than the twin: only settings of its agent may differ.")
    if run.config.get("explorer") is not None:
        config = replace(config, explorer=find_explorer(str(run.config["explorer"])))
    return with_fields(config, _recorded_tree(run, "agent"))


def _is_playable(config: AgentConfig) -> bool:
    """Returns whether the twin has what an agent reads: no object layers of its own, no tracks."""
    return isinstance(config.seeker, TargetSeekerConfig) and not config.layers.latest_frame_only


def _recorded_tree(run: Run, name: str) -> dict[str, Any]:
    """Returns a part of the configuration tree of a run; raises ConfigError if it was not recorded."""
    tree = run.recorded("config").get(name)
    if not isinstance(tree, dict):
        raise ConfigError(f"'{run.path / 'config.json'}' has no field 'config.{name}', which --explore needs.")
    return tree


def replay(camera: PlanCamera, recorded: Recorded) -> dict[str, Any]:
    """Returns area and step of first sight that the recorded poses give in the twin."""
    camera.reset()
    navmap = NavMap.empty(GridFrame.around_start(AgentConfig.map_cells, AgentConfig.cell_m))
    start, goal, first = recorded.start, recorded.line["goal"], None
    for step, pose in enumerate(recorded.trajectory.poses):
        here = Pose(*(float(value) for value in pose))
        look = camera.look(here, goal, navmap, here.relative_to(start), step)
        if first is None and look.goal_share >= EXPLORED_SHARE:
            first = step
    return {"area_seen_m2": camera.area_seen_m2, "steps_to_first_sight": steps_to_first_sight(first, MAX_STEPS)}


def explore(agent: TwinAgent, cameras: Cameras, recorded: Recorded, shift_m: float) -> dict[str, Any]:
    """Returns the metrics of the agent in the twin, from the recorded start moved back by some metres."""
    line, start = recorded.line, recorded.start
    x_m, y_m = start.ahead(-shift_m)
    seed = episode_seed(int(line["seed"]), line["episode_id"])
    return dict(
        run_episode(agent, cameras.of(line["house"]), line["goal"], replace(start, x_m=x_m, y_m=y_m), seed=seed)
    )


def _explored(agent: TwinAgent, cameras: Cameras, recorded: Sequence[Recorded], shift_m: float) -> list[dict[str, Any]]:
    """Lets a run's agent explore the twin twice, prints both correlations, and returns the lines of the episodes."""
    name, run = recorded[0].line["agent"], recorded[0].run.name
    twin = [explore(agent, cameras, each, 0.0) for each in recorded]
    shifted = [explore(agent, cameras, each, shift_m) for each in recorded]
    _report(f"{run}: {name} in the twin", [each.line for each in recorded], twin)
    _report(f"{run}: twin against starts moved by {shift_m} m", twin, shifted)
    kinds = (("explore", twin), ("shifted", shifted))
    return [_line(each, kind, one) for kind, found in kinds for each, one in zip(recorded, found, strict=True)]


def recorded_episodes(run: Run, most: int | None) -> list[Recorded]:
    """Returns the episodes of a run that began and have a trajectory.

    Args:
        run: the run.
        most: only those among its first so many episodes; None: all.

    Raises:
        ConfigError: there is none, a trajectory is broken, or a line lacks what is compared.
    """
    found = []
    for line in list(run.lines.values())[:most]:
        file = trajectory_file(run.path, line["episode_id"])
        if line["end_reason"] == "error" or not file.is_file():
            continue
        lacking = next((name for name in MEASURES if line[name] is None), None)
        if lacking is not None:
            raise ConfigError(f"'{run.path}' is of an older version: its results have no '{lacking}'.")
        found.append(Recorded(run.path, line, read_trajectory(file)))
    if not found:
        raise ConfigError(f"'{run.path}' has no trajectory: give folders of runs made with --record.")
    return found


def _line(recorded: Recorded, kind: str, found: dict[str, Any]) -> dict[str, Any]:
    """Returns the line of an episode with both worlds' measures."""
    real = {key: recorded.line[key] for key in (*MEASURES, "num_steps", "collisions", "success")}
    names = {key: recorded.line[key] for key in ("episode_id", "house", "goal", "agent")}
    return {"run": recorded.run.name, "kind": kind, **names, "real": real, "twin": found}


def _report(title: str, first: Sequence[Mapping[str, Any]], second: Sequence[Mapping[str, Any]]) -> None:
    """Prints the rank correlations of two lists of measures."""
    parts = []
    for key in MEASURES:
        a, b = (np.array([float(each[key]) for each in lines]) for lines in (first, second))
        rank = float(np.asarray(spearmanr(a, b))[0]) if len(a) > 2 else float("nan")
        parts.append(f"{key} {rank:.3f} (medians {np.median(a):.1f}, {np.median(b):.1f})")
    print(f"{title}, {len(first)} episodes: {'; '.join(parts)}", flush=True)


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
