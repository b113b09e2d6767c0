"""Trains an agent with PPO to drive to the sofa of a room and to call STOP there (needs `pip install '.[train]'`).

python -m examples.train_ppo --minutes 30 --envs 2 --out runs/ppo

The agent sees the direction of the goal, the depth in sixteen directions and whether it bumped into something; its
reward is `sim.gym.ProgressReward`. Every 1,024 steps a row of `progress.csv` is written and printed: success and return
of the last 100 episodes, and steps per second. At the end `curve.png` shows them, and `policy.zip` is tried in new
episodes, without exploration. The last line is the command that runs and films the policy.
"""

import csv
import io
import json
import shlex
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import gymnasium
import numpy as np
import torch
from gymnasium.wrappers import FilterObservation, FlattenObservation
from numpy.typing import NDArray

import sim.gym
from examples.ppo_agent import CAMERA, GOAL, SENSORS
from sim import Action, ConfigError, Pose
from sim.app import cli
from sim.core.files import write_atomically

try:
    from matplotlib.figure import Figure
    from stable_baselines3 import PPO
    from stable_baselines3.common.callbacks import BaseCallback
    from stable_baselines3.common.monitor import Monitor
    from stable_baselines3.common.vec_env import DummyVecEnv, SubprocVecEnv, VecEnv
except ImportError as error:
    raise SystemExit(f"error: {error}. Install it: pip install --constraint constraints.txt -e '.[train]'") from None

HOUSE = Path(__file__).with_name("my_house.xml")
STEPS_PER_UPDATE = 1024


@dataclass(frozen=True, kw_only=True)
class Args:
    """Trains an agent with PPO to drive to the sofa of a room."""

    minutes: cli.Positive = 30.0
    """Time of the training; the trials at the end need additional time."""
    steps: cli.Count = 10_000_000
    """Most steps of the training, all environments together."""
    envs: cli.Count = 2
    """Number of environments, each in a process of its own; 1: in this process."""
    max_steps: cli.Count = 60
    """Actions after which an episode is truncated."""
    trials: cli.Amount = 50
    """Number of episodes to try the policy in at the end."""
    seed: cli.Seed = 0
    """Seed of the starts, of the network and of its exploration."""
    out: cli.OutFolder = Path("runs/ppo")
    """Folder of the curve and the policy."""


def make_env(max_steps: int, start: Pose | None = None) -> gymnasium.Env[NDArray[np.float32], Any]:
    """Returns the room with a flat observation (20,) and the dense reward; starts are random unless one is given."""
    env = gymnasium.make(
        sim.gym.ENV_ID, house=HOUSE, goal=GOAL, sensors=SENSORS, camera=CAMERA, max_steps=max_steps, start=start
    )
    env = sim.gym.ProgressReward(env, per_step=0.01, per_collision=0.05)
    return FlattenObservation(FilterObservation(env, [sensor.name for sensor in SENSORS]))


def make_vec(args: Args) -> VecEnv:
    """Returns the environments, with the statistics of their episodes; processes are spawned, never forked."""
    makers: list[Callable[[], gymnasium.Env]] = [_Maker(args.max_steps)] * args.envs
    envs = DummyVecEnv(makers) if args.envs == 1 else SubprocVecEnv(makers, start_method="spawn")
    envs.seed(args.seed)
    return envs


@dataclass(frozen=True)
class _Maker:
    """Makes one environment in a process of its own."""

    max_steps: int

    def __call__(self) -> gymnasium.Env:
        return Monitor(make_env(self.max_steps), info_keywords=("success",))


class Progress(BaseCallback):
    """Writes and prints a row for each update of the policy, and stops when the time is up."""

    def __init__(self, file: Path, minutes: float) -> None:
        super().__init__()
        self._file, self._minutes = file, minutes
        self.rows: list[dict[str, Any]] = []
        self._began_s = self._last_s = time.perf_counter()
        self._last_steps = 0

    def _on_step(self) -> bool:
        return time.perf_counter() - self._began_s < 60.0 * self._minutes

    def _on_rollout_end(self) -> None:
        now_s, last = time.perf_counter(), list(self.model.ep_info_buffer or [])
        rate = (self.num_timesteps - self._last_steps) / (now_s - self._last_s)
        self._last_s, self._last_steps = now_s, self.num_timesteps
        row = {"steps": self.num_timesteps, "minutes": round((now_s - self._began_s) / 60.0, 2)}
        row |= {"steps_per_s": round(rate, 1), "episodes": len(last)}
        for name, key in (("success", "success"), ("mean_return", "r"), ("mean_length", "l")):
            row[name] = round(float(np.mean([episode[key] for episode in last])), 3) if last else float("nan")
        self.rows.append(row)
        print("  ".join(f"{name} {value}" for name, value in row.items()), flush=True)
        text = io.StringIO()
        table = csv.DictWriter(text, list(row))
        table.writeheader()
        table.writerows(self.rows)
        write_atomically(self._file, text.getvalue())


def draw_curve(rows: list[dict[str, Any]], file: Path) -> None:
    """Draws success and return of the last 100 episodes over the steps of the training."""
    figure = Figure(figsize=(6.4, 3.2), layout="constrained")
    axes = figure.subplots()
    steps = [row["steps"] for row in rows]
    axes.plot(steps, [row["success"] for row in rows], color="tab:blue")
    axes.set(xlabel="steps of the training, all environments", ylim=(0.0, 1.0))
    axes.set_ylabel("success of the last 100 episodes", color="tab:blue")
    returns = axes.twinx()
    returns.plot(steps, [row["mean_return"] for row in rows], color="tab:orange")
    returns.set_ylabel("their mean return", color="tab:orange")
    axes.grid(alpha=0.3)
    content = io.BytesIO()
    figure.savefig(content, format="png", dpi=120)
    write_atomically(file, content.getvalue())


def success_of(policy: PPO, episodes: int, args: Args) -> float:
    """Returns the share of new episodes in which the policy, without exploration, succeeds."""
    env, succeeded = make_env(args.max_steps), 0.0
    for number in range(episodes):
        observation, info = env.reset(seed=args.seed + 1_000_000 + number)
        done = False
        while not done:
            action, _ = policy.predict(observation, deterministic=True)
            observation, _, terminated, truncated, info = env.step(action)
            done = terminated or truncated
        succeeded += info["success"]
    env.close()
    return succeeded / episodes


def main(args: Args) -> int:
    """Trains, saves the policy and tries it; returns the exit status."""
    if STEPS_PER_UPDATE % args.envs:
        raise ConfigError(f"--envs must divide {STEPS_PER_UPDATE}, got {args.envs}.")
    torch.set_num_threads(1)  # the network is small; the cores are for the environments
    envs = make_vec(args)
    policy = PPO(
        "MlpPolicy", envs, n_steps=STEPS_PER_UPDATE // args.envs, batch_size=STEPS_PER_UPDATE // 8, n_epochs=10,
        learning_rate=1e-3, gamma=0.98, ent_coef=0.01, seed=args.seed, device="cpu",
    )  # fmt: skip
    with torch.no_grad():  # an untrained policy would call STOP in one of four steps
        cast(torch.Tensor, policy.policy.action_net.bias)[Action.STOP] = -3.0
    progress = Progress(args.out / "progress.csv", args.minutes)
    policy.learn(args.steps, callback=progress)
    envs.close()
    draw_curve(progress.rows, args.out / "curve.png")
    content = io.BytesIO()
    policy.save(content)
    write_atomically(args.out / "policy.zip", content.getvalue())
    if not progress.rows:
        print(
            f"The training ended before its first row, which comes after {STEPS_PER_UPDATE:,} steps: the policy is "
            "untrained. Give more --minutes."
        )
    settings = args.out / "run.toml"
    write_atomically(
        settings,
        f"agent.policy = {json.dumps(str(args.out / 'policy.zip'))}\n"
        f"camera.min_depth_m = {CAMERA.min_depth_m}\ntask.max_steps = {args.max_steps}\n",
    )
    if args.trials:
        print(f"trying the policy in {args.trials} new episodes", flush=True)
        print(f"success without exploration: {success_of(policy, args.trials, args):.2f} of {args.trials} new episodes")
    print(f"policy: {args.out / 'policy.zip'}")
    print(
        f"stubborn run --agent examples.ppo_agent:AGENT --config-file {shlex.quote(str(settings))} "
        f"--house {shlex.quote(str(HOUSE))} --goal {GOAL} --video"
    )
    return 0


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
