"""Files that are there whole or not at all."""

from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path

from sim.errors import ConfigError


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file so that whoever looks sees all of it or nothing; makes its folder.

    Raises:
        OSError: it cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, part = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".part")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.chmod(part, 0o644)  # mkstemp's files are the owner's alone
        os.replace(part, path)
    except BaseException:  # Ctrl-C too: nothing is left behind
        with contextlib.suppress(OSError):
            os.unlink(part)
        raise


def part_file(file: Path, *, what: str) -> Path:
    """An empty file beside `file` to write to, and to move there once it is whole; makes their folder.

    What killed processes have left of earlier tries is removed.

    Args:
        file: where the whole will be.
        what: it is, in words.

    Raises:
        ConfigError: nothing can be written there.
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
