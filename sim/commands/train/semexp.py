"""Trains the global policy of `semexp` in house plans with PPO (needs `pip install 'stubborn-objectnav[train]'`).

stubborn train semexp --plans runs/plans/train runs/plans/large_train --minutes 90 --seed 0 --out runs/semexp_0

Plans are written by `stubborn houses plans`. Every tenth house, by a hash of its name, is held back for comparisons
(`tools.research.compare_explorers` of the repository). The same command continues a killed run, also with another
--minutes or --goals: `state.pt` holds weights, optimiser and progress. `train.csv` and `curve.png` hold the curve,
`semexp.safetensors` the weights so far, `start.safetensors` those at the start.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import torch

from sim import cli
from sim.commands.train.packages import require_packages
from sim.commands.train.plan_split import HELD_BACK, split_plans
from sim.commands.train.training_files import print_next_commands, read_columns
from sim.interface import ConfigError
from sim.invocation import command

_DRAWN = ("episodes", "steps", "steps_to_first_sight")
"""Columns of a curve that are drawn."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Train the global policy of the explorer semexp in house plans."""

    plans: tuple[Path, ...]
    """Folders of plans (`stubborn houses plans`)."""
    minutes: cli.Positive = 90.0
    """Time of the training; that of earlier runs of the same folder counts."""
    goals: cli.Count = 10_000_000
    """Largest number of long-term goals of the training, all environments together."""
    seed: cli.Seed = 0
    """Seed of the network, of its exploration and of the episodes."""
    out: cli.OutFolder = Path("runs/semexp")
    """Folder of the run; an existing run is continued."""
    beside: tuple[Path, ...] = ()
    """Folders of other runs to draw into the curve."""
    envs: cli.Count = 8
    """Number of environments, all in this process."""
    rollout: cli.Count = 30
    """Long-term goals of each environment between two updates."""
    batch: cli.Count = 60
    """Long-term goals in a minibatch."""
    epochs: cli.Count = 2
    """Passes over the goals of an update; the published number is 4. A pass costs more time than new goals do."""
    rate: cli.Positive = 4e-4
    """Learning rate of Adam at the start; it falls to a tenth. The published one is 2.5e-5."""
    discount: cli.Share = 0.99
    """Discount from one long-term goal to the next."""
    entropy: cli.NotNegative = 0.001
    """Weight of the entropy of the policy in the loss."""
    print_s: cli.NotNegative = 20.0
    """Shortest time between two printed lines."""
    save_s: cli.NotNegative = 120.0
    """Shortest time between two writes of the state."""


def main(args: Args) -> int:
    """Trains; returns the exit status."""
    require_packages("matplotlib", "stable_baselines3")
    from sim.commands.train.semexp_trainer import Run  # it imports these packages

    plans, held_back = split_plans(args.plans)
    if not plans:
        raise ConfigError(
            f"No plan to train on: {len(held_back)} are held back, one house in {HELD_BACK}; export more."
        )
    if min(args.batch, args.envs * args.rollout) < 2:
        raise ConfigError(
            f"--batch and --envs x --rollout must be >= 2, got {args.batch} and {args.envs * args.rollout}."
        )
    for folder in args.beside:
        _require_curve(folder / "train.csv")
    torch.set_num_threads(1)  # the network is small
    run = Run(args, plans)
    run.train()
    weights = args.out / "semexp.safetensors"
    chosen = ("--agent", "semexp", "--semantics", "gt", "--config", f"agent.explorer.weights={weights}")
    print_next_commands(weights, command("run", *chosen), command("run", *chosen, "--episodes", "2", "--video"))
    return 0


def _require_curve(file: Path) -> None:
    """Raises ConfigError if a file of curves lacks a column that is drawn; one that does not exist is not drawn."""
    if not file.is_file():
        return
    if not set(_DRAWN) <= set(read_columns(file)):
        raise ConfigError(f"--beside: '{file}' is not a curve of this command.")
