"""Compares explorers in house plans by when they first see the target (docs/explorers.md).

python -m tools.research.compare_explorers --plans runs/plans/train runs/plans/large_train --episodes 200 \
    --explorers corners random-goals semexp semexp:semantics=shuffled semexp:goal=wrong semexp:semantics=none

The whole agent runs, with an exact camera and a map as in the real environment; an episode ends with the first frame
that shows the target, or after 500 steps. All explorers run the same episodes, in the houses that
`stubborn train semexp` holds back; `stubborn train poni` holds back others (--houses held-back-poni). Intervals are
over houses (`sim.app.evaluation.intervals`).
"""

from __future__ import annotations

import functools
import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sim.app import cli
from sim.app.analysis.tables import Cell
from sim.app.evaluation.intervals import estimate, paired_difference
from sim.core.configuration import parse_assignments, with_fields
from sim.core.files import write_atomically
from sim.core.interface import MAX_STEPS, CameraModel, ConfigError
from sim.homes.plans.episode import draw_goal_and_start
from sim.homes.plans.plan import read_plan
from sim.homes.plans.sight import PlanCamera
from sim.training.plan_env.agent import TwinAgent, run_episode, twin_config
from sim.training.plan_split import split_plans
from sim.training.poni import potential_files
from stubborn.agent import AgentConfig
from stubborn.agents import EXPLORERS
from stubborn.exploration.explorer import ExplorerConfig
from stubborn.exploration.semexp import SemExpConfig, SemExpExplorer

RANDOM = "random-goals"
"""The explorer that draws long-term goals as `semexp` does, everywhere in the local map."""
_UNIFORM = 1.7
"""Standard deviation at which the sigmoid of a normal variable is nearly uniform (the logistic one has 1.8)."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Compares explorers in house plans."""

    plans: tuple[Path, ...]
    """Folders of plans (`stubborn houses plans`)."""
    explorers: tuple[str, ...] = ("corners", RANDOM, "semexp")
    """Names of explorers, with fields of their configuration: semexp:semantics=shuffled,goal=wrong or
    informed-tour:potentials.goal=wrong."""
    weights: Path | None = None
    """File of weights of semexp; None: those that ship."""
    houses: str = "held-back"
    """held-back: those that `stubborn train semexp` does not train on; trained: the others; held-back-poni: those that
    `stubborn train poni` does not train on; all."""
    episodes: cli.Count = 100
    """Number of episodes."""
    seed: cli.Seed = 0
    """Seed of the episodes and of the explorers."""
    out: cli.OutFile | None = None
    """File for a JSON line of each episode, written after each explorer."""


@dataclass(frozen=True)
class RandomGoals:
    """Long-term goals anywhere in the local window."""

    def make(self, camera: CameraModel) -> SemExpExplorer:
        """Returns a new explorer."""
        return SemExpExplorer(SemExpConfig(), lambda _: (np.zeros(2), np.full(2, _UNIFORM)))


def main(args: Args) -> int:
    """Prints a row for each explorer as soon as it has run."""
    plans = _plans(args)
    configs = {name: explorer_config(name, args.weights) for name in args.explorers}
    for config in configs.values():
        config.make(CameraModel())  # missing weights are reported before any episode is run
    lines, first = [], None
    print(
        f"{args.episodes} episodes in {len(plans)} plans; steps to first sight count {MAX_STEPS} where it is never seen"
    )
    for name, config in configs.items():
        agent = TwinAgent(twin_config(AgentConfig(explorer=config)))
        results = [episode(agent, plans, number, args.seed) for number in range(args.episodes)]
        lines += [{"explorer": name, **line} for line in results]
        first = results if first is None else first
        print(row(name, results, first), flush=True)
        if args.out is not None:
            write_atomically(args.out, "".join(json.dumps(line) + "\n" for line in lines))
    return 0


def explorer_config(text: str, weights: Path | None) -> ExplorerConfig:
    """Returns the configuration of an explorer from its name and fields.

    Raises:
        ConfigError: there is no such explorer or field.
    """
    name, _, fields = text.partition(":")
    if name == RANDOM:
        if fields:
            raise ConfigError(f"--explorers {text}: {RANDOM} has no fields.")
        return RandomGoals()
    if name not in EXPLORERS:
        raise ConfigError(f"--explorers: there is no '{name}'. Available: {', '.join((*EXPLORERS, RANDOM))}.")
    assignments = [field for field in fields.split(",") if field]
    if name == "semexp" and weights is not None and not any(each.startswith("weights=") for each in assignments):
        assignments.append(f"weights={weights}")
    try:
        return with_fields(EXPLORERS[name], parse_assignments(assignments))
    except ConfigError as error:
        raise ConfigError(f"--explorers {text}: {error}") from None


def episode(agent: TwinAgent, plans: Sequence[Path], number: int, seed: int) -> dict[str, Any]:
    """Runs one episode; its house, goal and start depend on its number and the seed only."""
    file = plans[number % len(plans)]
    plan = _read(file)
    goal, start = draw_goal_and_start(plan, np.random.default_rng((seed, number)))
    found = run_episode(agent, PlanCamera(plan), goal, start, seed=seed + number, until_sight=True)
    return {"house": file.stem, "goal": goal, "episode": number, **found}


def row(name: str, results: Sequence[Mapping[str, Any]], first: Sequence[Mapping[str, Any]]) -> str:
    """Returns the figures of an explorer, and the difference of its steps from those of the first one, as text."""
    steps, others = ([float(line["steps_to_first_sight"]) for line in lines] for lines in (results, first))
    houses = [str(line["house"]) for line in results]
    mean, against = Cell(estimate(steps, houses)), Cell(paired_difference(others, steps, houses), difference=True)
    seen, collisions, metres = (
        float(np.mean([line[key] for line in results])) for key in ("gt_explored", "collisions", "path_length")
    )
    return (
        f"{name:34s} seen {seen:.3f}  steps to first sight {mean.text()}  median {np.median(steps):5.1f}  difference "
        f"{against.text()}  collisions {collisions:.1f}  path {metres:.1f} m"
    )


def _plans(args: Args) -> list[Path]:
    """Returns the plans of the houses that are asked for."""
    trained, held_back = split_plans(args.plans)
    every = sorted(trained + held_back)
    of_poni = [file for file in every if potential_files.held_back(file)]
    parts = {"held-back": held_back, "trained": trained, "held-back-poni": of_poni, "all": every}
    if args.houses not in parts:
        raise ConfigError(f"--houses must be one of {', '.join(parts)}, got '{args.houses}'.")
    if not parts[args.houses]:
        raise ConfigError(f"--houses {args.houses}: none of the plans is of these houses.")
    return parts[args.houses]


_read = functools.lru_cache(256)(read_plan)


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
