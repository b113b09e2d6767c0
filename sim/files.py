"""Writes files atomically: a reader finds the complete file or none."""

from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path

from sim.errors import ConfigError


def write_atomically(path: Path, content: bytes) -> None:
    """Writes a file atomically and creates its folder.

    Raises:
        OSError: the file cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, part = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".part")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.chmod(part, 0o644)  # mkstemp gives permissions to the owner only
        os.replace(part, path)
    except BaseException:  # also on Ctrl-C: the part file is removed
        with contextlib.suppress(OSError):
            os.unlink(part)
        raise


def part_file(file: Path, *, what: str) -> Path:
    """Creates an empty part file beside `file`, for the caller to write and then to rename to `file`; returns its path.

    Part files of earlier, killed processes are removed. The folder is created.

    Args:
        file: path of the complete file.
        what: kind of the file for the error message, for example "video".

    Raises:
        ConfigError: the folder is not writable.
    """
    part = file.with_name(f".{file.stem}.part-{os.getpid()}{file.suffix}")
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        for left_over in file.parent.glob(f".{file.stem}.part-*{file.suffix}"):
            left_over.unlink()
        part.touch()
    except OSError as error:
        raise ConfigError(f"Cannot write the {what} '{file}': {error.strerror}.") from None
    return part
