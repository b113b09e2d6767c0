"""Trains and evaluates DD-PPO of habitat-baselines on this project, in the environment of `make habitat`.

    habitat/bin/python examples/train_habitat.py habitat_baselines.num_updates=2
    habitat/bin/python examples/train_habitat.py --evaluate
"""

import sys
from pathlib import Path

import stubborn_habitat  # provides habitat_sim, so it must come before habitat
import torch

if torch.version.cuda is None:  # the wheel of torchvision on PyPI loads its operators only beside a torch with CUDA
    for name in ("nms", "qnms"):
        torch.library.define(f"torchvision::{name}", "(Tensor dets, Tensor scores, float iou_threshold) -> Tensor")

from habitat_baselines.config.default import get_config
from habitat_baselines.run import execute_exp

if __name__ == "__main__":
    evaluate = "--evaluate" in sys.argv
    overrides = [argument for argument in sys.argv[1:] if argument != "--evaluate"]
    if evaluate:
        overrides = ["habitat_baselines.evaluate=True", "habitat.dataset.type=stubborn-val-hm3d", *overrides]
    config = get_config("habitat_ppo.yaml", overrides, configs_dir=str(Path(__file__).parent))
    Path("habitat_ppo").mkdir(exist_ok=True)
    execute_exp(config, "eval" if evaluate else "train")
    print(f"{stubborn_habitat.configure()}: see habitat_ppo/.")
