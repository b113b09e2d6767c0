"""Writes files atomically, so that a reader finds the complete file or none, and keeps names from data in their folder.

Every file of this project is written by this module, except for those that grow line by line (`results.jsonl`).
"""

from __future__ import annotations

import contextlib
import csv
import errno
import glob
import io
import os
import stat
import tempfile
import urllib.parse
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from sim.core.errors import ConfigError

_UMASK = os.umask(0o022)  # it can only be read by setting it
os.umask(_UMASK)
FILE_MODE = 0o666 & ~_UMASK
"""Permissions of a new file, as the user's umask at the start of the process allows."""
_PREFIX_CHARACTERS = 40
"""A part file's name begins with this many characters of the file's name, so that long names stay allowed."""
_TRIAL_BYTES = 4096
"""Number of bytes written to test whether a folder is writable; the test fails on a full disk."""


PICTURE_SUFFIXES = (".png", ".jpg", ".jpeg", ".webp")
"""Ends of the names of files that `write_picture` can write everywhere."""


def file_name(text: str) -> str:
    """Returns a text as a part of a file's name: without characters that separate folders, or modules from names."""
    return text.replace(":", "_").replace("/", "_")


def inside(folder: Path, name: str, *, what: str) -> Path:
    """Returns the path of a name that comes from data, in the folder to which it belongs.

    Every path that data can choose is made by this function, so that no data can cause a file to be written elsewhere.

    Args:
        folder: the folder; it need not exist.
        name: a file name, or a relative path.
        what: kind of the name for the error message, for example "view".

    Raises:
        ConfigError: the name is empty, too long, absolute, or leads out of the folder, also by a symbolic link.
    """
    path = folder / name
    try:
        base, target = folder.resolve(), path.resolve()
        path.is_file()
    except (OSError, ValueError) as error:
        raise ConfigError(f"The {what} {name!r} is not the name of a file: {_reason(error)}.") from None
    if not name or target == base or not target.is_relative_to(base):
        raise ConfigError(f"The {what} {name!r} leads out of its folder '{folder}'; a name inside it is allowed.")
    _require_short(path, f"The {what}")
    return path


def episode_file(folder: Path, episode_id: str, suffix: str) -> Path:
    """Returns the file of an episode in a folder; characters that file names cannot have become %xx."""
    return folder / f"{urllib.parse.quote(episode_id, safe=' ')}{suffix}"


def episode_id_of(file: Path) -> str:
    """Returns the id of the episode to which a file of `episode_file` belongs."""
    return urllib.parse.unquote(file.stem)


def require_writable(path: Path, *, name: str, folder: bool) -> None:
    """Checks that a path can be written, before the result is computed; nothing is created.

    Args:
        path: the file or the folder.
        name: the option that gave it, for the error message.
        folder: whether the path is that of a folder.

    Raises:
        ConfigError: the name is too long, the path is of the other kind, or its folder is not writable.
    """
    try:
        _require_short(path, name)
        if path.exists() and path.is_dir() != folder:
            kinds = ("a folder", "a file")
            raise ConfigError(f"{name} '{path}' is {kinds[folder]}; give the path of {kinds[not folder]}.")
        nearest = path
        while not nearest.exists() and nearest != nearest.parent:
            nearest = nearest.parent
        if nearest == path and not folder:
            nearest = path.parent
        if not nearest.is_dir():
            raise ConfigError(f"{name} '{path}' cannot be written: '{nearest}' is a file, not a folder.")
        with tempfile.TemporaryFile(dir=nearest) as file:  # it has no name, so nothing of it stays
            file.write(b"\0" * _TRIAL_BYTES)
    except ConfigError:
        raise
    except (OSError, ValueError) as error:
        raise ConfigError(f"{name} {str(path)!r} cannot be written: {_reason(error)}.") from None


def write_atomically(path: Path, content: bytes | str, *, sync: bool = False) -> None:
    """Writes a file atomically and creates its folder; text is written as UTF-8.

    Args:
        path: the file.
        content: of the file.
        sync: whether to wait until the file is on the disk, where a power failure cannot take it any more.

    Raises:
        OSError: the file cannot be written; the earlier file, if there is one, is unchanged.
    """
    write_together({path: content}, sync=sync)


def write_together(files: Mapping[Path, bytes | str], *, sync: bool = False) -> None:
    """Writes several files, each atomically; no file is replaced before all of them are complete.

    Args:
        files: content by path.
        sync: whether to wait until the files are on the disk.

    Raises:
        OSError: a file cannot be written; then no earlier file has changed.
    """
    parts: dict[Path, str] = {}
    try:
        for path, content in files.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            handle, parts[path] = tempfile.mkstemp(
                dir=path.parent, prefix=f".{path.name[:_PREFIX_CHARACTERS]}.", suffix=".part"
            )
            with os.fdopen(handle, "wb") as file:
                file.write(content if isinstance(content, bytes) else content.encode("utf-8"))
                if sync:
                    file.flush()
                    os.fsync(file.fileno())
            os.chmod(parts[path], FILE_MODE)  # mkstemp gives permissions to the owner only
        for path, part in parts.items():
            os.replace(part, path)
        for folder in {path.parent for path in files} if sync else ():
            _sync_names(folder)
    except BaseException:  # also on Ctrl-C: the part files are removed
        for part in parts.values():
            with contextlib.suppress(OSError):
                os.unlink(part)
        raise


def _sync_names(folder: Path) -> None:
    """Waits until the names of a folder's files are on the disk; some file systems cannot."""
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def csv_text(header: Sequence[str], rows: Iterable[Iterable[object]], *, end: str = "\n") -> str:
    """Returns a table as CSV with the end of each line; None is an empty cell."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator=end)
    writer.writerow(header)
    writer.writerows(rows)
    return text.getvalue()


def write_picture(file: Path, picture: NDArray[np.uint8]) -> None:
    """Writes a picture, uint8 RGB (h, w, 3), in the format of the file's suffix.

    Raises:
        ConfigError: the suffix does not name a picture format.
        OSError: the file cannot be written.
    """
    import cv2  # only the tools that draw need it

    try:
        _, content = cv2.imencode(file.suffix or "none", np.ascontiguousarray(picture[..., ::-1]))
    except cv2.error:
        raise ConfigError(f"'{file}' has no suffix of a picture format; .png and .jpg are allowed.") from None
    write_atomically(file, content.tobytes())


def open_to_grow(file: Path, mode: str = "ab") -> IO[Any]:
    """Opens a plain file to append lines to it or to truncate it; text is UTF-8.

    Args:
        file: it is created unless the mode begins with "r".
        mode: mode of `open`.

    Raises:
        OSError: the file cannot be opened, or is not a plain file; a pipe is refused without waiting for its reader.
    """
    return open(file, mode, encoding=None if "b" in mode else "utf-8", opener=_plain)


def _plain(path: str, flags: int) -> int:
    """Opens a plain file, for `open`."""
    handle = os.open(path, flags | os.O_NONBLOCK | os.O_CLOEXEC, 0o666)
    if not stat.S_ISREG(os.fstat(handle).st_mode):
        os.close(handle)
        raise OSError(errno.EINVAL, "it is not a plain file", path)
    return handle


def part_file(file: Path, *, what: str) -> Path:
    """Creates an empty part file next to `file` and returns its path; the caller writes it and renames it to `file`.

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
        for left_over in file.parent.glob(f".{glob.escape(file.stem)}.part-*{file.suffix}"):
            left_over.unlink()
        part.touch()
    except OSError as error:
        raise ConfigError(f"Cannot write the {what} '{file}': {error.strerror}.") from None
    return part


def _reason(error: OSError | ValueError) -> str:
    return (error.strerror or str(error)) if isinstance(error, OSError) else str(error)


def _require_short(path: Path, name: str) -> None:
    """Raises ConfigError if a part of a path is longer than file systems allow."""
    for part in path.parts:
        if len(part.encode(errors="surrogateescape")) > 255:
            raise ConfigError(f"{name} has a name of {len(part)} characters, which is too long: at most 255 bytes.")
