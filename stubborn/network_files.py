"""Reads and writes files of weights: safetensors with the network's size in their header, and PyTorch checkpoints.

A file is written in one step and checked when it is read. The header's values are JSON. One of them, named
`<family>_config`, holds the size; the others describe how the weights were made. Only modules that need PyTorch import
this one.
"""

from __future__ import annotations

import json
import os
import pickle
import re
import struct
import tarfile
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, BinaryIO, Generic, TypeVar

import msgspec
import numpy as np
import torch
from numpy._core import multiarray
from safetensors import SafetensorError, safe_open
from safetensors.torch import save
from torch import Tensor, nn
from torch.overrides import TorchFunctionMode

from sim.core.interface import ConfigError
from sim.core.reading import convert, open_plain, reason_of, require_small_zip

MAX_WEIGHT = 1e12
"""Largest magnitude of a number in a file of weights."""
_BROKEN_PICKLE = (
    pickle.UnpicklingError, RuntimeError, OSError, EOFError, LookupError, ValueError, TypeError, AttributeError,
    AssertionError, ArithmeticError, MemoryError, struct.error,
)  # fmt: skip
"""The exceptions that `torch.load` raises for files that are not checkpoints."""
_NUMPY_NUMBERS = [multiarray.scalar, np.dtype, *{type(np.dtype(code)) for code in "?bBhHiIlLqQefd"}]
"""Functions with which pickles make NumPy's numbers; they run no other code. Trainers store metrics as such numbers."""
_TERMINAL_CODE = re.compile(r"\x1b\[[0-9;]*m")
MAX_CHECKPOINT_BYTES = 2 << 30

ConfigT = TypeVar("ConfigT")
NetworkT = TypeVar("NetworkT", bound=nn.Module)


@dataclass(frozen=True)
class Family(Generic[ConfigT, NetworkT]):
    """A kind of network; the header of a file tells its kind."""

    name: str
    """The header's entry is `<name>_config`."""
    config: type[ConfigT]
    """A frozen dataclass of sizes with bounds, the type of the network's attribute `config`."""
    build: Callable[[ConfigT], NetworkT]
    made_by: str
    """The tool that writes such files."""

    @property
    def key(self) -> str:
        """The header's entry with the size."""
        return f"{self.name}_config"

    def save(self, file: Path, model: NetworkT, metadata: Mapping[str, Any] | None = None) -> None:
        """Writes a network with some JSON values for the header; see `write_weights`."""
        size: Any = model.config
        write_weights(file, model, {self.key: asdict(size)} | dict(metadata or {}))

    def load(self, file: Path) -> tuple[NetworkT, dict[str, Any]]:
        """Returns the network of a file, in evaluation mode, and the rest of the file's header.

        Raises:
            ConfigError: the file does not exist, is broken, or holds another network (the first difference is given).
        """
        if not file.is_file():
            raise ConfigError(f"No weights at '{file}': {self.made_by} makes them.")
        tensors, header = read_weights(file)
        where = f"Weights '{file}' are not of {self.name}"
        if self.key not in header:
            raise ConfigError(f"{where}: their header has no '{self.key}'.")
        config = convert(header.pop(self.key), self.config, where=where)
        return with_weights(file, tensors, lambda: self.build(config)), header


def write_weights(file: Path, model: nn.Module, header: Mapping[str, Any]) -> None:
    """Writes the tensors of a network, floating-point numbers with 16 bits.

    Args:
        file: it is replaced in one step.
        model: the network.
        header: values that JSON can hold.

    Raises:
        ConfigError: a number is not finite in the file, or the file cannot be written.
    """
    tensors = {
        name: (tensor.half() if tensor.is_floating_point() else tensor).detach().contiguous().cpu()
        for name, tensor in model.state_dict().items()
    }
    for name, tensor in tensors.items():
        if tensor.is_floating_point() and not bool(torch.isfinite(tensor).all()):
            raise ConfigError(f"Weights '{file}' are not written: '{name}' has a number that is not finite.")
    part = file.with_name(file.name + ".part")
    try:
        content = save(tensors, metadata={key: json.dumps(value) for key, value in header.items()})
        part.write_bytes(content)  # `save_file` writes a file that only its owner can read
        os.replace(part, file)
    except (SafetensorError, OSError) as error:
        part.unlink(missing_ok=True)
        raise ConfigError(f"Weights '{file}' cannot be written: {reason_of(error)}.") from None


def read_weights(file: Path) -> tuple[dict[str, Tensor], dict[str, Any]]:
    """Returns the tensors of a safetensors file by name, and its header; values that are not JSON remain text.

    Raises:
        ConfigError: the file cannot be read.
    """
    open_plain(file, what="Weights").close()  # safetensors would wait for the writer of a named pipe
    try:
        with safe_open(file, framework="pt") as stream:
            header = stream.metadata() or {}
            tensors = {name: stream.get_tensor(name) for name in stream.keys()}  # noqa: SIM118 - this is not a dict
    except (SafetensorError, OSError) as error:
        raise ConfigError(f"Weights '{file}' cannot be read: {reason_of(error)}.") from None
    decoded: dict[str, Any] = {}
    for key, text in header.items():
        try:
            decoded[key] = msgspec.json.decode(text)
        except (ValueError, RecursionError):
            decoded[key] = text
    return tensors, decoded


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


def with_weights(file: Path, state: Mapping[str, Tensor], build: Callable[[], NetworkT]) -> NetworkT:
    """Returns a network with these weights, in evaluation mode.

    Args:
        file: the file of the tensors, for the message.
        state: the tensors, of any floating-point type.
        build: returns the network. It is first called without memory for its numbers, so that a size in a header
            cannot ask for more than the file has.

    Raises:
        ConfigError: a tensor is missing, is unknown, has another shape, or holds NaN (the first one is named).
    """
    with torch.device("meta"), _NoInitialNumbers():
        expected = build().state_dict()
    _require_fit(file, state, expected)
    model = build()
    model.load_state_dict(state)
    return model.eval()


class _NoInitialNumbers(TorchFunctionMode):
    """Skips random initialisation, which has no effect without memory but loads 80 MB of PyTorch modules."""

    def __torch_function__(
        self, func: Callable[..., Any], types: Any, args: tuple[Any, ...] = (), kwargs: dict[str, Any] | None = None
    ) -> Any:
        named = kwargs or {}
        if func.__name__ in ("normal_", "uniform_", "fill_", "zero_"):
            return args[0] if args else named["tensor"]
        return func(*args, **named)


def _require_fit(file: Path, state: Mapping[str, Tensor], expected: Mapping[str, Tensor]) -> None:
    """Raises ConfigError for the first tensor that is missing, is unknown, has another shape, or holds NaN."""
    for name, tensor in expected.items():
        if name not in state:
            raise ConfigError(f"Weights '{file}' are of another network: '{name}' is missing.")
        if state[name].shape != tensor.shape:
            raise ConfigError(
                f"Weights '{file}' are of another network: '{name}' is {tuple(state[name].shape)}, "
                f"not {tuple(tensor.shape)}."
            )
    for name, tensor in state.items():
        if name not in expected:
            raise ConfigError(f"Weights '{file}' are of another network: '{name}' is not in it.")
        if tensor.is_complex() or (expected[name].is_floating_point() and not tensor.is_floating_point()):
            kind = str(tensor.dtype).removeprefix("torch.")
            raise ConfigError(f"Weights '{file}': '{name}' holds {kind} numbers; it needs floating-point ones.")
        # In 32 bits, since the bound itself is infinity in 16 bits; NaN is not within it.
        if tensor.is_floating_point() and not bool((tensor.float().abs() <= MAX_WEIGHT).all()):
            raise ConfigError(f"Weights '{file}': '{name}' holds NaN, infinity or a number beyond {MAX_WEIGHT:g}.")
