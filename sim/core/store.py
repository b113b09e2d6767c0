"""Keeps results that take long to compute in the user's cache, each under a checksum of all that it depends on.

A result is a dataclass, or a container, of numbers, strings and arrays. It is written as MessagePack with a checksum in
front, never as code. A file that is damaged, or that cannot be read, counts as missing. Processes may share the folder:
files are written atomically, and two processes that write one result write the same bytes. The results that were not
used for the longest time are deleted when all of them take more than `STUBBORN_CACHE_MB`; 0 keeps none.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import importlib.metadata
import os
import platform
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import msgspec
import numpy as np
from numpy.typing import NDArray

from sim.core.errors import ConfigError
from sim.core.files import write_atomically
from sim.core.paths import cache_dir, hash_of_packages, processor

T = TypeVar("T")

SIZE_VARIABLE = "STUBBORN_CACHE_MB"
"""Environment variable: megabytes that all results together may take."""
DEFAULT_MB = 2000
_FOLDER = "prepared"
_ARRAY = 1
"""Code of an array among the extension types of MessagePack."""
_PACKAGES = ("core", "houses", "robot", "world", "task")
"""Packages of `sim` that compute the results."""
_LIBRARIES = ("mujoco", "numpy", "numba", "opencv-python-headless", "opencv-python", "scikit-fmm", "scipy")


def key_of(*parts: object) -> str:
    """Returns the key of a result that depends on these values, on the code, its libraries and the kind of processor.

    Args:
        parts: values whose `repr` says all of them, such as strings, numbers and frozen dataclasses of these.
    """
    return hashlib.sha256(repr((_code(), *parts)).encode()).hexdigest()


def kept(key: str | None, kind: Any, make: Callable[[], T]) -> T:
    """Returns the result of a key from the cache; it is made and kept if it is not there.

    Args:
        key: see `key_of`; None: the result is made and not kept.
        kind: type of the result, for its check when it is read.
        make: makes the result.

    Raises:
        ConfigError: `STUBBORN_CACHE_MB` is not a number.
    """
    most = max_bytes()
    if key is None or most == 0:
        return make()
    try:
        file = cache_dir() / _FOLDER / f"{key}.bin"
    except ConfigError:  # the user has no home folder
        return make()
    try:
        content = memoryview(file.read_bytes())
        if zlib.crc32(content[4:]) == int.from_bytes(content[:4], "little"):
            result = msgspec.msgpack.decode(content[4:], type=kind, dec_hook=_as_it_is, ext_hook=_read_array)
            with contextlib.suppress(OSError):  # a folder that is only read
                os.utime(file)  # the order of use
            return result
    except (OSError, msgspec.MsgspecError, ValueError, TypeError):
        pass  # missing, damaged, or made unreadable by another user
    result = make()
    body = msgspec.msgpack.encode(result, enc_hook=_array)
    with contextlib.suppress(OSError):  # a full disk, or a folder that cannot be written
        write_atomically(file, zlib.crc32(body).to_bytes(4, "little") + body)
        _remove_oldest(file.parent, most)
    return result


def max_bytes() -> int:
    """Returns the largest size of all results together.

    Raises:
        ConfigError: the environment variable is not a number.
    """
    text = os.environ.get(SIZE_VARIABLE) or str(DEFAULT_MB)
    if not text.isascii() or not text.isdecimal() or len(text) > 9:
        raise ConfigError(f"{SIZE_VARIABLE} must be a whole number of megabytes from 0 on, got '{text}'.")
    return int(text) << 20


def _remove_oldest(folder: Path, most: int) -> None:
    """Removes the results that were not used for the longest time until the rest is small enough."""
    files = sorted((entry.stat().st_mtime_ns, entry.stat().st_size, entry.path) for entry in os.scandir(folder))
    excess = sum(size for _, size, _ in files) - most
    for _, size, path in files[:-1]:  # the last one is the new one
        if excess <= 0:
            break
        with contextlib.suppress(OSError):  # another process may have removed it
            os.unlink(path)
        excess -= size


@functools.cache
def _code() -> tuple[str, ...]:
    """Returns what all results depend on: the modules that compute them, the libraries and the processor."""
    root = Path(__file__).resolve().parents[1]
    versions = [_version(library) for library in _LIBRARIES]
    sources = hash_of_packages(*(root / name for name in _PACKAGES))
    return (sources, *versions, platform.machine(), processor())


def _version(library: str) -> str:
    try:
        return importlib.metadata.version(library)
    except importlib.metadata.PackageNotFoundError:  # one of the two packages of OpenCV
        return ""


def _array(value: object) -> msgspec.msgpack.Ext:
    """Returns an array as an extension type: its dtype and its shape as text, then its bytes."""
    if not isinstance(value, np.ndarray):
        raise NotImplementedError(f"{type(value)} cannot be kept.")
    head = f"{value.dtype.str} {' '.join(map(str, value.shape))}".encode()
    return msgspec.msgpack.Ext(_ARRAY, bytes([len(head)]) + head + value.tobytes())


def _read_array(code: int, content: memoryview) -> NDArray:
    """Returns the array of an extension type; it shares no memory."""
    if code != _ARRAY:
        raise ValueError(f"Unknown extension type {code}.")
    end = 1 + content[0]
    dtype, *shape = bytes(content[1:end]).decode().split(" ")
    values = np.frombuffer(content[end:], dtype).copy()
    return values.reshape([int(size) for size in shape if size])


def _as_it_is(_: type, value: object) -> object:
    return value
