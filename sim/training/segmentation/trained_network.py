"""The network that `stubborn train segmentation` starts from, its device and its precision."""

from __future__ import annotations

from pathlib import Path

import torch

from sim.core.interface import ConfigError
from stubborn.segmentation.checkpoints import load_network
from stubborn.segmentation.networks import NETWORKS, with_geometry, without_names
from stubborn.segmentation.processor import computes_bf16
from stubborn.segmentation.rednet import RedNet
from stubborn.segmentation.shipped import SHIPPED_REDNET

DEFAULT_SIZE = "compact-both"
OF_TRAINING = ("step", "hours", "options", "code", "averaged", "started_from")
"""Metadata of a network that say how it was trained; the networks that are trained further keep them."""


def start_network(size: str | None, init: Path | None) -> tuple[str, RedNet, dict[str, object]]:
    """Returns the size of the network to train, the network, and the metadata of its earlier training.

    Args:
        size: name in `NETWORKS`; None: that of `init`, else `DEFAULT_SIZE`.
        init: file of initial weights, or `shipped`; None: random ones.

    Raises:
        ConfigError: the file is broken, or of another size.
    """
    if init is None:
        size = size or DEFAULT_SIZE
        return size, RedNet(NETWORKS[size]), {}
    model, metadata = load_network(SHIPPED_REDNET if init == Path("shipped") else init)
    model = without_names(model)
    if size == "compact-both" and model.config == NETWORKS["compact"]:
        model = with_geometry(model)
    known = next((name for name, config in NETWORKS.items() if config == model.config), None)
    if known is None or size not in (None, known):
        raise ConfigError(f"--init '{init}' is not of size '{size or ' or '.join(NETWORKS)}'.")
    return known, model, {key: metadata[key] for key in OF_TRAINING if key in metadata}


def precision_of(name: str, device: torch.device) -> str:
    """Returns bf16 or fp32; `auto` is bf16 on a GPU and on a processor with instructions for it."""
    if name != "auto":
        return name
    return "bf16" if device.type == "cuda" or computes_bf16() else "fp32"


def device_of(name: str) -> torch.device:
    """Returns the device of a name; `auto` is CUDA where there is a device.

    Raises:
        ConfigError: `cuda` was requested, but CUDA is not available.
    """
    if name == "auto":
        return torch.device("cuda" if torch.cuda.is_available() else "cpu")
    if name == "cuda" and not torch.cuda.is_available():
        raise ConfigError("--device cuda: PyTorch sees no CUDA device here.")
    return torch.device(name)
