"""Trains the global policy of `semexp` in house plans with PPO (needs `pip install 'stubborn-objectnav[train]'`).

stubborn train semexp --plans runs/plans/train runs/plans/large_train --minutes 90 --seed 0 --out runs/semexp_0

Plans are written by `stubborn houses plans`. Every tenth house, by a hash of its name, is held back for comparisons.
The same command continues a killed run, also with another --minutes or --goals: `state.pt` holds weights, optimiser and
progress. `train.csv` and `curve.png` hold the curve, `semexp.safetensors` the weights so far, `start.safetensors` those
at the start.
"""

from __future__ import annotations

import torch

from sim.core.interface import ConfigError
from sim.training.figures import require_packages
from sim.training.plan_split import HELD_BACK, split_plans
from sim.training.semexp.options import Args as Args
from sim.training.training_files import print_next_runs


def main(args: Args) -> int:
    """Trains; returns the exit status."""
    require_packages("matplotlib", "stable_baselines3")
    from sim.training.semexp.trainer import Run  # it imports these packages

    plans, held_back = split_plans(args.plans)
    if not plans:
        raise ConfigError(
            f"No plan to train on: {len(held_back)} are held back, one house in {HELD_BACK}; export more."
        )
    if min(args.batch, args.envs * args.rollout) < 2:
        raise ConfigError(
            f"--batch and --envs x --rollout must be >= 2, got {args.batch} and {args.envs * args.rollout}."
        )
    torch.set_num_threads(1)  # the network is small
    run = Run(args, plans)
    run.train()
    print_next_runs(args.out / "semexp.safetensors", "semexp", "agent.explorer.weights")
    return 0
