"""Fits which objects are near objects of each category, by which `stubborn-plus` weighs what its network reports.

    stubborn houses plans --pool train --houses 250 --out runs/plans
    stubborn train context --plans runs/plans --out runs/context.json

One plan in ten is held back; on it the log loss of the categories is printed: by their frequency alone, and with the
objects nearby. The agent reads the file with `--config agent.seeker.context=FILE`.
"""

from __future__ import annotations

import json
import shlex
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim import cli
from sim.commands.train.plan_split import split_plans
from sim.files import write_atomically
from sim.interface import ConfigError
from sim.plans.plan import Plan, read_plan
from stubborn.detection.context import SHIPPED, content_of
from stubborn.detection.context_fit import Surroundings, fit, log_losses, surroundings


@dataclass(frozen=True, kw_only=True)
class Args:
    """Fit which objects are near objects of each category."""

    plans: tuple[Path, ...]
    """Folders of plans (`stubborn houses plans`)."""
    out: cli.OutFile | None = None
    """File of the parameters."""
    shipped: bool = False
    """Replace the parameters that ship."""
    radius_m: cli.Positive = 2.5
    """Objects are near one another if their middles are nearer than this."""
    seed: cli.Seed = 0
    """Seed of the choice of what is seen of the surroundings."""


def main(args: Args) -> int:
    """Fits, writes and judges; returns the exit status."""
    if (args.out is None) != args.shipped:
        raise ConfigError("Give --out FILE for the parameters, or --shipped to replace those that ship.")
    rng = np.random.default_rng(args.seed)
    fitted, held_back = ([around(read_plan(file), args.radius_m, rng) for file in f] for f in split_plans(args.plans))
    context = fit(fitted, args.radius_m)
    quality: dict[str, object] = {"plans": len(fitted), "objects": sum(len(category) for _, category in fitted)}
    if held_back:
        alone, with_context = log_losses(context, held_back)
        quality |= {"held_back": len(held_back), "log_loss_of_frequency": round(alone, 3)}
        quality |= {"log_loss": round(with_context, 3)}
    words = ["--plans", *map(str, args.plans), "--radius-m", f"{args.radius_m:g}", "--seed", str(args.seed)]
    content = {"command": f"stubborn train context {shlex.join(words)}", **quality, "context": content_of(context)}
    file = args.out or SHIPPED
    write_atomically(file, json.dumps(content, indent=1, allow_nan=False) + "\n")
    print(", ".join(f"{value} {name}" for name, value in quality.items()))
    print(f"written: {file}")
    return 0


def around(plan: Plan, radius_m: float, rng: np.random.Generator) -> Surroundings:
    """Returns what is around the objects of one plan."""
    row_and_col = np.stack(np.divmod(plan.span_cell, plan.frame.shape[1]))
    there = np.unique(plan.span_instance)
    of = np.searchsorted(there, plan.span_instance)
    low, high = np.full((2, there.size), np.inf), np.zeros((2, there.size))
    np.minimum.at(low, (slice(None), of), row_and_col)
    np.maximum.at(high, (slice(None), of), row_and_col)
    middle_m = 0.5 * plan.frame.cell_m * (low + high)
    return surroundings(middle_m[1], middle_m[0], plan.categories[there].astype(np.intp), radius_m, rng)
