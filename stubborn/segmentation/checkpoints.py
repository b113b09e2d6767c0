"""Reads and writes the weights of a network: our safetensors files, and published PyTorch checkpoints.

A checkpoint may wrap its tensors as `{"model_state": {...}}` and prefix each name with `module.`. No pickled code is
run: PyTorch files are read with `torch.load(weights_only=True)`.
"""

from __future__ import annotations

import pickle
import re
import struct
import tarfile
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Annotated, Any, BinaryIO

import msgspec
import numpy as np
import torch
from numpy._core import multiarray
from torch import Tensor

from sim.interface import ConfigError
from sim.reading import Number, convert, open_plain, require_small_zip
from stubborn.network_files import read_weights, with_weights, write_weights
from stubborn.segmentation.networks import FAMILIES, Architecture, Network, build_network, family
from stubborn.segmentation.rednet import PUBLISHED

_WRAPPERS = ("model_state", "state_dict", "model")
_PARALLEL_PREFIX = "module."
_CONFIG_KEY = "{family}_config"
_BROKEN_PICKLE = (
    pickle.UnpicklingError, RuntimeError, OSError, EOFError, LookupError, ValueError, TypeError, AttributeError,
    AssertionError, ArithmeticError, MemoryError, struct.error,
)  # fmt: skip
"""The exceptions that `torch.load` raises for files that are not checkpoints."""
_NUMPY_NUMBERS = [multiarray.scalar, np.dtype, *{type(np.dtype(code)) for code in "?bBhHiIlLqQefd"}]
"""Functions with which pickles make NumPy's numbers; they run no other code. Trainers store metrics as such numbers."""
_TERMINAL_CODE = re.compile(r"\x1b\[[0-9;]*m")
MAX_CHECKPOINT_BYTES = 2 << 30
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


def save_network(file: Path, model: Network, metadata: Mapping[str, Any] | None = None, *, half: bool = True) -> None:
    """Writes weights and the size of the network as safetensors. The file is replaced in one step.

    Args:
        file: the file to write.
        model: the network.
        metadata: values that JSON can hold, for the file's header.
        half: True stores numbers with 16 bits.
    """
    key = _CONFIG_KEY.format(family=family(model))
    write_weights(file, model, {key: asdict(model.config)} | dict(metadata or {}), half=half)


def load_network(file: Path) -> tuple[Network, dict[str, Any]]:
    """Returns a network in evaluation mode with the weights of a file, and the file's metadata.

    A `.safetensors` file of ours holds the configuration of its network; any other file must hold the published RedNet.

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
    return with_weights(file, tensors, lambda: build_network(config)), metadata


def mean_of(networks: Sequence[Network]) -> Network:
    """Returns a network whose weights are the mean of those of networks of one configuration.

    Integers, such as the counts of batches, are those of the last network.
    """
    *_, mean = networks
    tensors = [network.state_dict() for network in networks]
    for name, last in mean.state_dict().items():
        if torch.is_floating_point(last):
            last.copy_(torch.stack([each[name].float() for each in tensors]).mean(dim=0))
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


def read_checkpoint(file: Path, *, device: torch.device | str = "cpu") -> Mapping[str, Any]:
    """Returns the content of a PyTorch file, without running pickled code.

    Raises:
        ConfigError: the file is broken, expands to more than `MAX_CHECKPOINT_BYTES`, or holds no table.
    """
    with open_plain(file, what="Weights") as stream:
        content = _load(file, stream, device)
    if not isinstance(content, Mapping):
        raise ConfigError(f"Weights '{file}' hold a {type(content).__name__}, not a table of tensors.")
    return content


def _load(file: Path, stream: BinaryIO, device: torch.device | str) -> Any:
    """Returns the content of an open PyTorch file; raises ConfigError like `read_checkpoint`."""
    if _is_tar(stream):
        raise ConfigError(f"Weights '{file}' are a tar file, which PyTorch wrote before version 0.4; save them again.")
    if _is_zip(stream):
        require_small_zip(file, what="Weights", most=MAX_CHECKPOINT_BYTES)
    stream.seek(0)
    try:
        with torch.serialization.safe_globals(_NUMPY_NUMBERS):
            return torch.load(stream, map_location=device, weights_only=True)
    except _BROKEN_PICKLE as error:
        reason = _TERMINAL_CODE.sub("", str(error)).partition("WeightsUnpickler error: ")
        reason = " ".join((reason[2] or reason[0]).split("\n")[0].split()) or type(error).__name__
        raise ConfigError(f"Weights '{file}' cannot be read as a PyTorch checkpoint of tensors: {reason}") from None


def _is_tar(stream: BinaryIO) -> bool:
    """Returns whether a file begins with the header of a tar file, which `torch.load` would give to `tarfile`."""
    try:
        tarfile.TarInfo.frombuf(stream.read(tarfile.BLOCKSIZE), "utf-8", "surrogateescape")
    except tarfile.TarError:
        return False
    return True


def _is_zip(stream: BinaryIO) -> bool:
    try:
        return zipfile.is_zipfile(stream)
    except zipfile.BadZipFile:  # it is a zip file, in several parts
        return True


def _config(file: Path, metadata: dict[str, Any]) -> Architecture:
    """Takes the configuration of the network out of the metadata and returns it; by default the published one.

    Raises:
        ConfigError: the stored configuration does not belong to a network of this project.
    """
    for name, (config_class, _) in FAMILIES.items():
        stored = metadata.pop(_CONFIG_KEY.format(family=name), None)
        if stored is None:
            continue
        where = f"Weights '{file}' describe no network of ours"
        unknown = sorted(set(stored) - {each.name for each in fields(config_class)}) if isinstance(stored, dict) else ()
        if unknown:
            raise ConfigError(f"{where}: field '{unknown[0]}' is unknown.")
        config = convert(stored, config_class, where=where)
        largest = max(_whole_numbers(asdict(config)))
        if largest > MAX_SIZE:
            raise ConfigError(f"{where}: a size of {largest}, at most {MAX_SIZE} is allowed.")
        return config
    return PUBLISHED


def _whole_numbers(values: Mapping[str, Any]) -> Iterator[int]:
    for value in values.values():
        yield from (each for each in (value if isinstance(value, tuple) else (value,)) if isinstance(each, int))
