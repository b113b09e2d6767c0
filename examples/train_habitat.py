"""Trains and evaluates DD-PPO of habitat-baselines on this project, in the environment of `make habitat`.

.venv-habitat/bin/python examples/train_habitat.py habitat_baselines.num_updates=2
.venv-habitat/bin/python examples/train_habitat.py --evaluate
"""

import os
import sys
from pathlib import Path

import stubborn_habitat  # provides habitat_sim, so it must come before habitat

# isort: split
from habitat_baselines.config.default import get_config
from habitat_baselines.run import execute_exp

if __name__ == "__main__":
    evaluate = "--evaluate" in sys.argv
    overrides = [argument for argument in sys.argv[1:] if argument != "--evaluate"]
    if evaluate:
        os.environ["TORCH_FORCE_NO_WEIGHTS_ONLY_LOAD"] = "1"  # checkpoints of habitat-baselines hold its configuration
        checkpoints = list(Path("habitat_ppo/checkpoints").glob("ckpt.*.pth"))
        if not checkpoints:
            sys.exit("error: habitat_ppo/checkpoints has no checkpoint: train first, without --evaluate.")
        last = max(checkpoints, key=lambda file: file.stat().st_mtime)
        overrides = [
            "habitat_baselines.evaluate=True",
            f"habitat_baselines.eval_ckpt_path_dir={last}",  # of a folder, it would wait for further checkpoints
            "habitat_baselines.load_resume_state_config=False",
            "habitat.dataset.type=stubborn-val-hm3d",
            *overrides,
        ]
    config = get_config("habitat_ppo.yaml", overrides, configs_dir=str(Path(__file__).parent))
    Path("habitat_ppo").mkdir(exist_ok=True)
    execute_exp(config, "eval" if evaluate else "train")
    print(f"{stubborn_habitat.configure()}: see habitat_ppo/.")
