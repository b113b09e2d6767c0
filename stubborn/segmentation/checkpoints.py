"""Reads and writes the weights of a network: our safetensors files, and published PyTorch checkpoints.

A checkpoint may wrap its tensors as `{"model_state": {...}}` and prefix each name with `module.`. No pickled code is
run: PyTorch files are read with `torch.load(weights_only=True)`.
"""

from __future__ import annotations

import json
import os
import pickle
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file
from torch import Tensor

from sim.interface import ConfigError
from stubborn.segmentation.networks import FAMILIES, Architecture, Network, build_network, family
from stubborn.segmentation.rednet import PUBLISHED

_WRAPPERS = ("model_state", "state_dict", "model")
_PARALLEL_PREFIX = "module."
_CONFIG_KEY = "{family}_config"


def save_network(file: Path, model: Network, metadata: Mapping[str, Any] | None = None, *, half: bool = True) -> None:
    """Writes weights and the size of the network as safetensors. The file is replaced in one step.

    Args:
        file: the file to write.
        model: the network.
        metadata: values that JSON can hold, for the file's header.
        half: store numbers with 16 bits.
    """
    tensors = {
        name: (tensor.half() if half and tensor.is_floating_point() else tensor).contiguous().cpu()
        for name, tensor in model.state_dict().items()
    }
    header = {_CONFIG_KEY.format(family=family(model)): json.dumps(asdict(model.config))}
    header |= {key: json.dumps(value) for key, value in (metadata or {}).items()}
    part = file.with_name(file.name + ".part")
    save_file(tensors, part, metadata=header)
    os.replace(part, file)


def load_network(file: Path) -> tuple[Network, dict[str, Any]]:
    """Returns a network in evaluation mode with the weights of a file, and the file's metadata.

    A `.safetensors` file of ours holds the configuration of its network; any other file must hold the published RedNet.

    Raises:
        ConfigError: the file does not exist, is broken, or holds another network (the first different name is given).
    """
    if not file.exists():
        raise ConfigError(f"No weights at '{file}'.")
    if file.suffix == ".safetensors":
        tensors, metadata = _read_safetensors(file)
    else:
        tensors, metadata = _read_checkpoint(file), {}
    model = build_network(_config(file, metadata))
    tensors = unwrap(tensors, file)
    _check(file, tensors, model.state_dict())
    model.load_state_dict({name: tensors[name] for name in model.state_dict()})
    return model.eval(), metadata


def unwrap(content: Mapping[str, Any], file: Path) -> dict[str, Tensor]:
    """Returns the tensors of a checkpoint by name, without wrapper and prefix.

    Raises:
        ConfigError: a value is not a tensor.
    """
    for wrapper in _WRAPPERS:
        if isinstance(content.get(wrapper), Mapping):
            content = content[wrapper]
            break
    tensors = {name.removeprefix(_PARALLEL_PREFIX): value for name, value in content.items()}
    for name, value in tensors.items():
        if not isinstance(value, Tensor):
            raise ConfigError(f"Weights '{file}': '{name}' is a {type(value).__name__}, not a tensor.")
    return tensors


def _read_safetensors(file: Path) -> tuple[dict[str, Tensor], dict[str, Any]]:
    try:
        with safe_open(file, framework="pt") as stream:
            header = stream.metadata() or {}
            return {name: stream.get_tensor(name) for name in stream.keys()}, _decoded(header)  # noqa: SIM118 - no dict
    except (SafetensorError, OSError) as error:
        raise ConfigError(f"Weights '{file}' cannot be read: {error}.") from None


def _decoded(header: Mapping[str, str]) -> dict[str, Any]:
    """Returns the header's values decoded from JSON; values that are not JSON (in foreign files) stay strings."""
    decoded: dict[str, Any] = {}
    for key, text in header.items():
        try:
            decoded[key] = json.loads(text)
        except ValueError:
            decoded[key] = text
    return decoded


def _read_checkpoint(file: Path) -> Mapping[str, Any]:
    try:
        content = torch.load(file, map_location="cpu", weights_only=True)
    except (pickle.UnpicklingError, RuntimeError, EOFError, OSError, ValueError, KeyError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ConfigError(f"Weights '{file}' cannot be read as a PyTorch checkpoint of tensors: {reason}") from None
    if not isinstance(content, Mapping):
        raise ConfigError(f"Weights '{file}' hold a {type(content).__name__}, not a table of tensors.")
    return content


def _config(file: Path, metadata: dict[str, Any]) -> Architecture:
    """Takes the configuration of the network out of the metadata and returns it; the published one where there is none.

    Raises:
        ConfigError: the stored configuration is of no network of ours.
    """
    for name, (config_class, _) in FAMILIES.items():
        stored = metadata.pop(_CONFIG_KEY.format(family=name), None)
        if stored is None:
            continue
        try:
            fields: dict[str, Any] = {key: tuple(v) if isinstance(v, list) else v for key, v in stored.items()}
            return config_class(**fields)
        except (TypeError, AttributeError):
            raise ConfigError(f"Weights '{file}' describe no network of ours: {stored!r}.") from None
    return PUBLISHED


def _check(file: Path, given: Mapping[str, Tensor], wanted: Mapping[str, Tensor]) -> None:
    """Raises ConfigError for the first different name or shape, in the network's order."""
    for name, tensor in wanted.items():
        if name not in given:
            raise ConfigError(f"Weights '{file}' are of another network: '{name}' is missing.")
        if given[name].shape != tensor.shape:
            raise ConfigError(
                f"Weights '{file}' are of another network: '{name}' is {tuple(given[name].shape)}, "
                f"not {tuple(tensor.shape)}."
            )
    for name in given:
        if name not in wanted:
            raise ConfigError(f"Weights '{file}' are of another network: '{name}' is not in it.")
