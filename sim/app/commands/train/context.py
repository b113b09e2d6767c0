"""Fits which objects are near objects of each category, by which `stubborn-plus` weighs what its network reports.

    stubborn houses plans --pool train --first-seed 0 --houses 240 --out runs/plans/train
    stubborn train context --plans runs/plans/train --out runs/context.json

One plan in ten is held back; on these the log loss of the categories is printed: by their frequency alone, and with the
objects nearby. The agent reads a file of your own with `--config agent.seeker.context=FILE`.
"""

from __future__ import annotations

import json
import shlex
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim.app import cli
from sim.core.files import write_atomically
from sim.homes.plans.plan import read_plan
from sim.training.fits.context import around, fit, log_losses
from sim.training.plan_split import split_plans
from stubborn.detection.context import content_of


@dataclass(frozen=True, kw_only=True)
class Args:
    """Fit which objects are near objects of each category."""

    plans: tuple[Path, ...]
    """Folders of plans (`stubborn houses plans`)."""
    out: cli.OutFile
    """File of the parameters (JSON)."""
    radius_m: cli.Positive = 2.5
    """Two objects are near each other if their middles are nearer than this in the plan."""
    seed: cli.Seed = 0
    """Seed of the random choice of the nearby objects that count as seen."""


def main(args: Args) -> int:
    """Fits, writes and judges; returns the exit status."""
    rng = np.random.default_rng(args.seed)
    fitted, held_back = (
        [around(read_plan(file), args.radius_m, rng) for file in files] for files in split_plans(args.plans)
    )
    context = fit(fitted, args.radius_m)
    quality: dict[str, object] = {"plans": len(fitted), "objects": sum(len(category) for _, category in fitted)}
    print(f"{quality['objects']} objects of {quality['plans']} plans")
    if held_back:
        alone, with_context = log_losses(context, held_back)
        print(f"log loss {with_context:.3f} on {len(held_back)} plans held back, {alone:.3f} by frequency alone")
        quality |= {"held_back": len(held_back), "log_loss_of_frequency": round(alone, 3)}
        quality |= {"log_loss": round(with_context, 3)}
    words = ["--plans", *map(str, args.plans), "--radius-m", f"{args.radius_m:g}", "--seed", str(args.seed)]
    content = {"command": f"stubborn train context {shlex.join(words)}", **quality, "context": content_of(context)}
    write_atomically(args.out, json.dumps(content, indent=1, allow_nan=False) + "\n")
    print(f"written: {args.out}")
    return 0
