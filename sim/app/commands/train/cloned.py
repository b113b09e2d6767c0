"""Trains the policy of `--agent cloned` on demonstrations: it learns to choose the same actions.

    stubborn train cloned --demonstrations runs/demonstrations --minutes 60 --out runs/cloned

The demonstrations are files of `tools.training.render_demonstrations` and `tools.training.plan_demonstrations`. One
house in ten, by its name, is held back for `val.csv`: the cross entropy, and how many actions are those of the
demonstrator. The same command continues a killed run: `state.pt` holds weights, their average, optimiser and step.
`cloned.safetensors` is the averaged network of the best evaluation so far, `curve.png` the picture of the curves.
"""

from __future__ import annotations

import torch

from sim.core.invocation import command
from sim.training.cloned.demonstrations import list_demonstrations
from sim.training.cloned.trainer import Args as Args
from sim.training.cloned.trainer import Trainer, draw_curve, read_all
from sim.training.packages import require_packages
from sim.training.training_files import print_next_commands


def main(args: Args) -> int:
    """Trains; returns the exit status."""
    require_packages("matplotlib")
    torch.set_num_threads(args.threads)
    files = list_demonstrations(args.demonstrations)
    train, val = read_all(files)
    Trainer(args, train, val, files).run()
    draw_curve(args.out)
    weights = args.out / "cloned.safetensors"
    chosen = ("--agent", "cloned", "--semantics", "gt", "--config", f"agent.weights={weights}")
    print_next_commands(weights, command("run", *chosen), command("run", *chosen, "--episodes", "2", "--video"))
    return 0
