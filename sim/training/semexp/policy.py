"""The network of `semexp` as a policy of stable-baselines3, which trains it with PPO."""

from __future__ import annotations

from typing import Any

import torch
from gymnasium import spaces
from stable_baselines3.common.distributions import DiagGaussianDistribution, Distribution
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.type_aliases import PyTorchObs, Schedule
from torch import Tensor, nn
from torch.optim import Adam

from stubborn.exploration.semexp_net import NetConfig, SemExpNet


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
