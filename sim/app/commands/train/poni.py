"""Trains the predictor of `--agent poni` on house plans, without an agent that acts in them.

    stubborn train poni --plans runs/plans/train runs/plans/large_train --minutes 30 --out runs/poni

First the samples are made, partial maps with the true potentials of their frontiers (`sim.training.poni.potentials`),
one file for each plan in --samples; then the network is trained on them for --minutes. One plan in eight is held back
for `val.csv`: the loss, and how often the best predicted frontier is truly the best one. The same command continues a
killed run: `state.pt` holds weights, their average, optimiser and step. `poni.safetensors` is the averaged network of
the best evaluation so far, `curve.png` the picture of the two curves.
"""

from __future__ import annotations

import torch

from sim.core.invocation import command
from sim.training.packages import require_packages
from sim.training.poni.potentials import SampleConfig
from sim.training.poni.trainer import Args as Args
from sim.training.poni.trainer import Trainer, draw_curve, make_samples
from sim.training.training_files import print_next_commands


def main(args: Args) -> int:
    """Makes the samples and trains; returns the exit status."""
    require_packages("matplotlib")
    torch.set_num_threads(args.threads)
    config = SampleConfig(walks=args.walks, maps=args.maps, most_steps=args.most_steps)
    files = make_samples(args, config)
    Trainer(args, config, files).run()
    draw_curve(args.out)
    weights = args.out / "poni.safetensors"
    chosen = ("--agent", "poni", "--semantics", "gt", "--config", f"agent.explorer.weights={weights}")
    print_next_commands(weights, command("run", *chosen), command("run", *chosen, "--episodes", "2", "--video"))
    return 0
