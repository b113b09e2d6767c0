"""Names the networks that can be trained, and adapts a network to other inputs and outputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import torch

from sim.core.interface import ConfigError
from stubborn.segmentation.rednet import COMPACT, PUBLISHED, RedNet, RedNetConfig

NETWORKS: Mapping[str, RedNetConfig] = MappingProxyType(
    {
        "compact": COMPACT,
        "compact-geometry": replace(COMPACT, second="geometry"),
        "compact-both": replace(COMPACT, second="depth-geometry"),
        "published": PUBLISHED,
    }
)
"""Configurations by the name that `--size` of `stubborn train segmentation` takes."""


def with_geometry(network: RedNet) -> RedNet:
    """Returns a network that takes the geometric channels in addition to depth, with the same weights and output.

    The weights of the new channels are zero: training starts from the behaviour of the old network.

    Raises:
        ConfigError: the network's second input is not depth.
    """
    if network.config.second != "depth":
        raise ConfigError(f"The network already has the input {network.config.second!r}.")
    wider, weights = RedNet(replace(network.config, second="depth-geometry")), network.state_dict()
    stem = torch.zeros_like(wider.conv1_d.weight)
    stem[:, : network.conv1_d.in_channels] = network.conv1_d.weight.detach()
    wider.load_state_dict(weights | {"conv1_d.weight": stem})
    return wider.train(network.training)


def without_names(network: RedNet) -> RedNet:
    """Returns a network without its head for names, which fits the network's features as they are now."""
    bare = RedNet(replace(network.config, names=()))
    bare.load_state_dict({key: value for key, value in network.state_dict().items() if "names_head" not in key})
    return bare.train(network.training)
