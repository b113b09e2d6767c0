"""Reads and writes the weights of a network: our safetensors files, and published PyTorch checkpoints.

A checkpoint may wrap its tensors as `{"model_state": {...}}` and prefix each name with `module.`. No pickled code is
run: PyTorch files are read with `torch.load(weights_only=True)`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Annotated, Any

import msgspec
import torch
from torch import Tensor

from sim.core.interface import ConfigError
from sim.core.reading import Number, convert
from stubborn.network_files import read_checkpoint, read_weights, with_weights, write_weights
from stubborn.segmentation.rednet import PUBLISHED, RedNet, RedNetConfig

_WRAPPERS = ("model_state", "state_dict", "model")
_PARALLEL_PREFIX = "module."
_CONFIG_KEY = "rednet_config"
MAX_SIZE = 4096
"""Largest number of channels, blocks or classes that a header may give."""


class _Calibration(msgspec.Struct):
    scale: list[Number]
    offset: list[Number]


class _Metadata(msgspec.Struct):
    """The part of a file's header that the segmenter reads."""

    block_px: Annotated[int, msgspec.Meta(ge=1, le=64)] = 1
    temperature: Annotated[float, msgspec.Meta(gt=0.0, le=1e6)] = 1.0
    calibration: _Calibration | None = None


def save_network(file: Path, model: RedNet, metadata: Mapping[str, Any] | None = None) -> None:
    """Writes weights, with 16 bits, and the size of the network as safetensors. The file is replaced in one step.

    Args:
        file: the file to write.
        model: the network.
        metadata: values that JSON can hold, for the file's header.
    """
    write_weights(file, model, {_CONFIG_KEY: asdict(model.config)} | dict(metadata or {}))


def load_network(file: Path) -> tuple[RedNet, dict[str, Any]]:
    """Returns a network in evaluation mode with the weights of a file, and the file's metadata.

    Our `.safetensors` files hold the configuration of their network; any other file must hold the published RedNet.

    Raises:
        ConfigError: the file does not exist, is broken, or holds another network (the first different name is given).
    """
    if not file.is_file():
        raise ConfigError(f"No weights at '{file}'.")
    if file.suffix == ".safetensors":
        tensors, metadata = read_weights(file)
    else:
        tensors, metadata = read_checkpoint(file), {}
    convert(metadata, _Metadata, where=f"Weights '{file}', header")
    config = _config(file, metadata)
    tensors = unwrap(tensors, file)
    return with_weights(file, tensors, lambda: RedNet(config)), metadata


def mean_of(networks: Sequence[RedNet]) -> RedNet:
    """Returns a network with the mean of the weights of networks of one configuration.

    Integers, such as the counts of batches, are those of the last network.
    """
    *_, mean = networks
    tensors = [network.state_dict() for network in networks]
    for name, last in mean.state_dict().items():
        if torch.is_floating_point(last):
            last.copy_(torch.stack([state[name].float() for state in tensors]).mean(dim=0))
    return mean


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


def _config(file: Path, metadata: dict[str, Any]) -> RedNetConfig:
    """Takes the configuration of the network out of the metadata and returns it; by default the published one.

    Raises:
        ConfigError: the stored configuration does not belong to a network of this project.
    """
    stored = metadata.pop(_CONFIG_KEY, None)
    if stored is None:
        return PUBLISHED
    where = f"Weights '{file}' do not describe a network of this project"
    unknown = sorted(set(stored) - {field.name for field in fields(RedNetConfig)}) if isinstance(stored, dict) else ()
    if unknown:
        raise ConfigError(f"{where}: field '{unknown[0]}' is unknown.")
    config = convert(stored, RedNetConfig, where=where)
    largest = max(_whole_numbers(asdict(config)))
    if largest > MAX_SIZE:
        raise ConfigError(f"{where}: a size of {largest}, at most {MAX_SIZE} is allowed.")
    return config


def _whole_numbers(values: Mapping[str, Any]) -> Iterator[int]:
    for value in values.values():
        yield from (number for number in (value if isinstance(value, tuple) else (value,)) if isinstance(number, int))
