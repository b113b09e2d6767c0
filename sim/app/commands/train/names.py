"""Trains the second head of a segmentation network, for everyday names: a fridge or a cooker among the appliances.

    stubborn train names --views runs/views/reshaped --val-views runs/views/selection --minutes 30 --out runs/names

The network itself is not changed; `rednet.safetensors` in --out is the network with the head, of the best evaluation so
far. Agents ask it where goals are in words. The same command continues a killed run.
"""

from __future__ import annotations

import torch

from sim.core.invocation import command
from sim.training.segmentation.naming import Args as Args
from sim.training.segmentation.naming import Trainer
from sim.training.training_files import print_next_commands


def main(args: Args) -> int:
    """Trains; returns the exit status."""
    torch.set_num_threads(args.threads)
    Trainer(args).run()
    weights = args.out / "rednet.safetensors"
    chosen = ("--agent", "stubborn-plus", "--split", "words-seen", "--weights", str(weights))
    print_next_commands(weights, command("run", *chosen, "--episodes", "2"))
    return 0
