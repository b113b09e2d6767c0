"""Reads and writes the weights of a network: our safetensors files, and published PyTorch checkpoints.

A checkpoint may wrap its tensors as `{"model_state": {...}}` and prefix each name with `module.`. No pickled code is
run: PyTorch files are read with `torch.load(weights_only=True)`.
"""

from __future__ import annotations

import json
import os
import pickle
import struct
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import Annotated, Any

import msgspec
import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import save
from torch import Tensor

from sim.interface import ConfigError
from sim.reading import Number, convert, reason_of, require_small_zip
from stubborn.segmentation.networks import FAMILIES, Architecture, Network, build_network, family
from stubborn.segmentation.rednet import PUBLISHED

_WRAPPERS = ("model_state", "state_dict", "model")
_PARALLEL_PREFIX = "module."
_CONFIG_KEY = "{family}_config"
_BROKEN_PICKLE = (
    pickle.UnpicklingError, RuntimeError, OSError, EOFError, LookupError, ValueError, TypeError, AttributeError,
    AssertionError, ArithmeticError, MemoryError, struct.error,
)  # fmt: skip
"""What `torch.load` raises for files that are no checkpoints."""
MAX_CHECKPOINT_BYTES = 2 << 30
MAX_SIZE = 4096
"""Largest number of channels, blocks or classes that a header may give."""
MAX_WEIGHT = 1e12


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
        half: store numbers with 16 bits.
    """
    tensors = {
        name: (tensor.half() if half and tensor.is_floating_point() else tensor).contiguous().cpu()
        for name, tensor in model.state_dict().items()
    }
    header = {_CONFIG_KEY.format(family=family(model)): json.dumps(asdict(model.config))}
    header |= {key: json.dumps(value) for key, value in (metadata or {}).items()}
    part = file.with_name(file.name + ".part")
    try:
        part.write_bytes(save(tensors, metadata=header))  # `save_file` writes a file that only its owner can read
        os.replace(part, file)
    except (SafetensorError, OSError) as error:
        part.unlink(missing_ok=True)
        raise ConfigError(f"Weights '{file}' cannot be written: {reason_of(error)}.") from None


def load_network(file: Path) -> tuple[Network, dict[str, Any]]:
    """Returns a network in evaluation mode with the weights of a file, and the file's metadata.

    A `.safetensors` file of ours holds the configuration of its network; any other file must hold the published RedNet.

    Raises:
        ConfigError: the file does not exist, is broken, or holds another network (the first different name is given).
    """
    if not file.is_file():
        raise ConfigError(f"No weights at '{file}'.")
    if file.suffix == ".safetensors":
        tensors, metadata = _read_safetensors(file)
    else:
        tensors, metadata = read_checkpoint(file), {}
    convert(metadata, _Metadata, where=f"Weights '{file}', header")
    config = _config(file, metadata)
    tensors = unwrap(tensors, file)
    with torch.device("meta"):  # takes no memory, so that a size in the header cannot ask for more than the file has
        wanted = build_network(config).state_dict()
    _check(file, tensors, wanted)
    model = build_network(config)
    model.load_state_dict({name: tensors[name] for name in wanted})
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
            decoded[key] = msgspec.json.decode(text)
        except (ValueError, RecursionError):
            decoded[key] = text
    return decoded


def read_checkpoint(file: Path, *, device: torch.device | str = "cpu") -> Mapping[str, Any]:
    """Returns the content of a PyTorch file, without running pickled code.

    Raises:
        ConfigError: the file is broken, expands to more than `MAX_CHECKPOINT_BYTES`, or holds no table.
    """
    if _is_zip(file):
        require_small_zip(file, what="Weights", most=MAX_CHECKPOINT_BYTES)
    try:
        content = torch.load(file, map_location=device, weights_only=True)
    except _BROKEN_PICKLE as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ConfigError(f"Weights '{file}' cannot be read as a PyTorch checkpoint of tensors: {reason}") from None
    if not isinstance(content, Mapping):
        raise ConfigError(f"Weights '{file}' hold a {type(content).__name__}, not a table of tensors.")
    return content


def _is_zip(file: Path) -> bool:
    try:
        return zipfile.is_zipfile(file)
    except zipfile.BadZipFile:  # it is one, in several parts
        return True


def _config(file: Path, metadata: dict[str, Any]) -> Architecture:
    """Takes the configuration of the network out of the metadata and returns it; the published one where there is none.

    Raises:
        ConfigError: the stored configuration is of no network of ours.
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
    for name, tensor in given.items():
        if name not in wanted:
            raise ConfigError(f"Weights '{file}' are of another network: '{name}' is not in it.")
        if tensor.is_floating_point() and not bool((tensor.abs() <= MAX_WEIGHT).all()):  # NaN is not
            raise ConfigError(f"Weights '{file}': '{name}' holds NaN, infinity or a number beyond {MAX_WEIGHT:g}.")


def _whole_numbers(values: Mapping[str, Any]) -> Iterator[int]:
    for value in values.values():
        yield from (each for each in (value if isinstance(value, tuple) else (value,)) if isinstance(each, int))
