"""The run of `stubborn train semexp`: environments, PPO, curves and the state that continues a run."""

from __future__ import annotations

import functools
import io
import time
from collections import deque
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import torch
from gymnasium import spaces
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.distributions import DiagGaussianDistribution, Distribution
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.type_aliases import PyTorchObs, Schedule
from stable_baselines3.common.vec_env import DummyVecEnv
from torch import Tensor, nn
from torch.optim import Adam

from sim.core.files import write_atomically
from sim.core.reading import Count, Number
from sim.homes.plans.plan import read_plan
from sim.training.figures import empty_figure
from sim.training.semexp.env import SemExpEnv
from sim.training.semexp.options import Args
from sim.training.training_files import (
    HasState,
    append_row,
    cut_rows,
    load_state,
    options_of,
    read_columns,
    require_options,
    save_state,
)
from stubborn.exploration.semexp_net import FILES, NetConfig, SemExpNet

LAST_EPISODES = 300
"""Number of episodes over which a row of the curve is a mean."""
SMOOTHED = 12
"""The thick line of a curve is a running mean over the training divided by this number."""
PLANS_IN_MEMORY = 256
MAY_CHANGE = ("out", "minutes", "goals", "print_s", "save_s")
"""Options in which a continued run may differ from its start."""
_KEYS = ("steps_to_first_sight", "gt_explored", "num_steps", "collisions")


class _Progress(msgspec.Struct):
    """The progress of a run, as `state.pt` holds it."""

    goals: Count
    steps: Count
    spent_s: Number
    options: dict[str, str]
    """See `options_of`."""


class Run:
    """The policy, the environments and the progress of one training."""

    def __init__(self, args: Args, plans: Sequence[Path]) -> None:
        self.args = args
        self.options = options_of(args, may_change=MAY_CHANGE, files={"plans": plans})
        self.net_config = NetConfig()
        read = functools.lru_cache(PLANS_IN_MEMORY)(read_plan)
        self.envs = DummyVecEnv([lambda: SemExpEnv(plans, cells=self.net_config.cells, read=read)] * args.envs)
        self.goals = self.steps = 0
        """Long-term goals and primitive steps so far."""
        self.trained = (0, 0)
        """Long-term goals and primitive steps that the network has been trained on."""
        self.spent_s = 0.0
        args.out.mkdir(parents=True, exist_ok=True)
        self.ppo = PPO(
            SemExpPolicy, self.envs, n_steps=args.rollout, batch_size=args.batch, n_epochs=args.epochs,
            learning_rate=self._rate, gamma=args.discount, gae_lambda=0.95, ent_coef=args.entropy, clip_range=0.2,
            vf_coef=0.5, max_grad_norm=0.5, device="cpu", policy_kwargs={"config": self.net_config},
            seed=args.seed % 2**32,  # NumPy's old generator, which PPO seeds, takes 32 bits
        )  # fmt: skip
        if not self._resumed():
            FILES.save(args.out / "start.safetensors", self.policy.net)
        self.envs.seed(args.seed * 1_000_003 + self.goals)

    @property
    def policy(self) -> SemExpPolicy:
        """The policy of PPO."""
        assert isinstance(self.ppo.policy, SemExpPolicy)
        return self.ppo.policy

    @property
    def is_over(self) -> bool:
        """Whether the time is up or the goals are used."""
        return self.spent_s >= 60.0 * self.args.minutes or self.goals >= self.args.goals

    def train(self) -> None:
        """Trains until the time is up."""
        if not self.is_over:
            self.ppo.learn(2**62, callback=_Watch(self), reset_num_timesteps=False)
            self.save()
        write_atomically(self.args.out / "curve.png", curve(self.args.out / "train.csv"))

    def save(self) -> None:
        """Writes the state and the weights; each file is replaced in one step."""
        goals, steps = self.trained
        progress = {"goals": goals, "steps": steps, "spent_s": self.spent_s}
        save_state(self.args.out / "state.pt", self._parts(), progress | {"options": self.options})
        options = {key: [str(f) for f in v] if isinstance(v, tuple) else v for key, v in asdict(self.args).items()}
        options["out"] = str(self.args.out)
        card = {
            **progress,
            "plans": len(self.envs.get_attr("files")[0]),
            "options": options,
            "torch": torch.__version__,
        }
        FILES.save(self.args.out / "semexp.safetensors", self.policy.net, card)

    def _parts(self) -> dict[str, HasState]:
        """Returns the content of `state.pt` apart from the progress."""
        return {"net": self.policy.net, "optimiser": self.policy.optimizer}

    def _resumed(self) -> bool:
        """Loads the state of the run, and returns whether there is one.

        Raises:
            ConfigError: the state is broken, or of a run with another network, other options or other plans.
        """
        done = load_state(
            self.args.out / "state.pt",
            self._parts(),
            _Progress,
            check=lambda progress: require_options(self.args.out, progress.options, self.options),
        )
        if done is not None:
            self.goals, self.steps, self.spent_s = done.goals, done.steps, done.spent_s
            self.trained = self.goals, self.steps
        cut_rows(self.args.out / "train.csv", "goals", self.goals)  # also of a run that never wrote a state
        if done is None:
            return False
        print(f"continues from {self.steps} steps, {self.spent_s / 60:.1f} minutes", flush=True)
        return True

    def _rate(self, _: float) -> float:
        """Returns the learning rate, which falls with the time."""
        share = min(self.spent_s / (60.0 * self.args.minutes), 1.0)
        return self.args.rate * (1.0 - 0.9 * share)


class _Watch(BaseCallback):
    """Counts, writes a row of the curve for each update, prints by the clock, and stops when the time is up."""

    def __init__(self, run: Run) -> None:
        super().__init__()
        self.run = run
        self._episodes: deque[dict[str, float]] = deque(maxlen=LAST_EPISODES)
        self._before = np.zeros(run.args.envs, np.int64)
        self._returns = np.zeros(run.args.envs)
        self._began_s = time.perf_counter() - run.spent_s
        self._printed_s = self._saved_s = self._last_s = time.perf_counter()
        self._last_steps = run.steps

    def _on_step(self) -> bool:
        infos, dones = self.locals["infos"], self.locals["dones"]
        self._returns += self.locals["rewards"]
        now = np.array([info["num_steps"] for info in infos])
        self.run.steps += int((now - self._before).sum())
        self.run.goals += len(infos)
        for number in np.flatnonzero(dones):
            ended = {key: float(infos[number][key]) for key in _KEYS}
            self._episodes.append(ended | {"return": float(self._returns[number])})
        self._returns[dones] = 0.0
        self._before = np.where(dones, 0, now)
        self.run.spent_s = time.perf_counter() - self._began_s
        return not self.run.is_over

    def _on_rollout_start(self) -> None:
        """Saves the state here, because at the end of a rollout the network has not yet been trained on its goals."""
        now_s = time.perf_counter()
        self.run.trained = self.run.goals, self.run.steps
        if now_s - self._saved_s >= self.run.args.save_s:
            self._saved_s = now_s
            self.run.save()

    def _on_rollout_end(self) -> None:
        now_s, run, logged = time.perf_counter(), self.run, self.model.logger.name_to_value
        rate = (run.steps - self._last_steps) / (now_s - self._last_s)
        self._last_s, self._last_steps = now_s, run.steps
        row = {"minutes": round(run.spent_s / 60, 2), "goals": run.goals, "steps": run.steps}
        row |= {"steps_per_s": round(rate), "episodes": len(self._episodes)}
        for name in ("return", *_KEYS):
            row[name] = (
                round(float(np.mean([episode[name] for episode in self._episodes])), 4) if self._episodes else ""
            )
        for name in ("entropy_loss", "value_loss", "explained_variance", "approx_kl"):  # of the update before
            row[name] = round(float(logged.get(f"train/{name}", np.nan)), 4)
        append_row(run.args.out / "train.csv", row)
        if now_s - self._printed_s >= run.args.print_s:
            self._printed_s = now_s
            print("  ".join(f"{name} {value}" for name, value in row.items()), flush=True)


def curve(file: Path) -> bytes:
    """Returns a PNG of a training curve: mean steps to first sight over primitive steps, and its running mean."""
    figure = empty_figure(6.4, 3.2)
    axes = figure.subplots()
    table = {name: np.array(column) for name, column in read_columns(file).items()}
    if table:
        kept = table["episodes"] >= LAST_EPISODES // 3
        steps, sights = table["steps"][kept] / 1e6, table["steps_to_first_sight"][kept]
        axes.plot(steps, sights, linewidth=0.5, alpha=0.4, color="C0")
        width = max(len(sights) // SMOOTHED, 1)
        smooth = [sights[max(0, i - width + 1) : i + 1].mean() for i in range(len(sights))]
        axes.plot(steps, smooth, color="C0")
    axes.set(xlabel="primitive steps of the training, millions", ylabel="mean steps to first sight")
    axes.grid(alpha=0.3)
    content = io.BytesIO()
    figure.savefig(content, format="png", dpi=100)
    return content.getvalue()


class SemExpPolicy(ActorCriticPolicy):
    """The two outputs of a `SemExpNet` are actor and critic; observations are those of `SemExpEnv`."""

    net: SemExpNet

    def __init__(
        self, observation_space: spaces.Space, action_space: spaces.Space, lr_schedule: Schedule, config: NetConfig,
        **_: Any,
    ) -> None:  # fmt: skip
        self._config = config
        super().__init__(observation_space, action_space, lr_schedule)

    def _build(self, lr_schedule: Schedule) -> None:
        self.net = SemExpNet(self._config)
        _initialise(self.net)
        for weight in self.net.parameters():
            if weight.ndim == 4:  # convolutions are quicker with it
                weight.data = weight.data.contiguous(memory_format=torch.channels_last)
        self.optimizer = Adam(self.parameters(), lr=lr_schedule(1), eps=1e-5)

    def _outputs(self, obs: PyTorchObs) -> tuple[Distribution, Tensor]:
        assert isinstance(obs, dict)
        mean, logstd, values = self.net(*(obs[name] for name in ("geometry", "goals", "heading", "goal")))
        assert isinstance(self.action_dist, DiagGaussianDistribution)
        return self.action_dist.proba_distribution(mean, logstd.expand_as(mean)), values[:, None]

    def forward(self, obs: PyTorchObs, deterministic: bool = False) -> tuple[Tensor, Tensor, Tensor]:
        """Returns actions, values and the logarithms of the actions' probabilities."""
        distribution, values = self._outputs(obs)
        actions = distribution.get_actions(deterministic=deterministic)
        return actions, values, distribution.log_prob(actions)

    def evaluate_actions(self, obs: PyTorchObs, actions: Tensor) -> tuple[Tensor, Tensor, Tensor | None]:
        """Returns values, and logarithms of probabilities and entropies of given actions."""
        distribution, values = self._outputs(obs)
        return values, distribution.log_prob(actions), distribution.entropy()

    def get_distribution(self, obs: PyTorchObs) -> Distribution:
        """Returns the distribution of actions."""
        return self._outputs(obs)[0]

    def predict_values(self, obs: PyTorchObs) -> Tensor:
        """Returns the values."""
        return self._outputs(obs)[1]


def _initialise(net: SemExpNet) -> None:
    """Sets the initial weights: orthogonal, so that the features depend on the maps from the start (PyTorch's own
    initial weights of six layers nearly do not), and a policy with its mean near the middle of the local map."""
    for layer in net.modules():
        if isinstance(layer, nn.Conv2d | nn.Linear):
            nn.init.orthogonal_(layer.weight, gain=2.0**0.5)
            assert layer.bias is not None
            nn.init.zeros_(layer.bias)
    nn.init.orthogonal_(net.network.critic_linear.weight, gain=1.0)
    nn.init.orthogonal_(net.dist.fc_mean.weight, gain=0.01)
