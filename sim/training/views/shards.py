"""WebDataset tar shards of views: written completely or not at all; the same seed gives the same bytes.

A shard `views-000012.tar` holds `key.rgb.jpg` (or `.png`), `key.depth.png` (uint16 millimetres), `key.semantic.png`
(uint8 mpcat40 id) and `key.json` for each view; where they were asked for, also `key.instances.png` (uint16) with
`key.coco.json`, and `key.normals.png` (docs/datasets.md). The note next to it, `views-000012.json`, has its statistics
and its checksum; a shard without a note, or with another checksum, is broken and is made again.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import tarfile
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.files import write_atomically
from sim.core.interface import MPCAT40, ConfigError
from sim.core.reading import read_json, sha256_of
from sim.training.views.views import View

JPEG_QUALITY = 92
PNG_OPTIONS = (
    cv2.IMWRITE_PNG_COMPRESSION, 1,
    cv2.IMWRITE_PNG_STRATEGY, cv2.IMWRITE_PNG_STRATEGY_RLE,
    cv2.IMWRITE_PNG_FILTER, cv2.IMWRITE_PNG_FILTER_PAETH,
)  # fmt: skip
"""The fastest level of zlib, for runs of equal bytes, after one filter for all rows.

OpenCV's own choice tries five filters on each row: it takes twice as long, and the files are 10 to 80 % larger.
"""
INDEX_FILE = "index.json"

CARD_FILE = "README.md"
CARD = """---
configs:
- config_name: default
  data_files: "*.tar"
---

# Labelled views

Views of houses in WebDataset's layout: `KEY.rgb.jpg` (or `.png`), `KEY.depth.png` (millimetres), `KEY.semantic.png`
(mpcat40 ids), `KEY.json`. `index.json` has the numbers of views and houses, and the command that made them.

`load_dataset("FOLDER")` reads the views; with the name of the loader, name the shards too:
`load_dataset("webdataset", data_files="FOLDER/*.tar")`.
"""


@dataclass
class ShardNote:
    """Content of the note, the JSON file next to a shard."""

    shard: str
    house: str
    views: int
    sha256: str
    size_bytes: int
    pixels: dict[str, int]
    """Number of pixels of each mpcat40 category."""
    views_with: dict[str, int]
    """Number of views that show each category."""
    config: dict[str, Any] = field(default_factory=dict)
    """Options and versions that the bytes depend on."""
    seconds: dict[str, float] = field(default_factory=dict)
    """Time by stage: render, encode (while the next view is rendered), write."""


def shard_name(number: int) -> str:
    """Returns the name of a shard, for example `views-000012`."""
    return f"views-{number:06d}"


def write_shard(
    folder: Path, name: str, views: Iterable[View], *, house: str, config: Mapping[str, Any], rgb_format: str = "jpg"
) -> ShardNote:
    """Writes views as one shard, then its note, so that a shard with a note is complete.

    Raises:
        ConfigError: the disk is full or cannot be written; partial files are removed.
    """
    tar, note_file = folder / f"{name}.tar", folder / f"{name}.json"
    part = folder / f".{name}.{os.getpid()}.part"
    seconds = {"render": 0.0, "encode": 0.0, "write": 0.0}
    pixels, views_with, count = np.zeros(len(MPCAT40), np.int64), np.zeros(len(MPCAT40), np.int64), 0
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with contextlib.suppress(FileNotFoundError):
            note_file.unlink()
        with part.open("wb") as stream, tarfile.open(fileobj=stream, mode="w", format=tarfile.USTAR_FORMAT) as archive:
            began = time.perf_counter()
            for view in _encoded_beside(views, rgb_format):
                began = _lap(seconds, "render", began)
                seconds["encode"] += view.seconds
                pixels, views_with, count = pixels + view.pixels, views_with + (view.pixels > 0), count + 1
                for suffix, content in view.members:
                    archive.addfile(_entry(f"{view.key}.{suffix}", len(content)), io.BytesIO(content))
                began = _lap(seconds, "write", began)
        digest, size = sha256_of(part, what="Shard"), part.stat().st_size
        os.replace(part, tar)
        note = ShardNote(
            name, house, count, digest, size, _by_name(pixels), _by_name(views_with), dict(config), _rounded(seconds)
        )
        write_atomically(note_file, (json.dumps(note.__dict__, indent=1) + "\n").encode())
    except OSError as error:
        raise ConfigError(
            f"Shard '{tar}' cannot be written: {error.strerror or error}. The finished shards are complete; "
            "run the same command again to continue."
        ) from None
    finally:
        with contextlib.suppress(OSError):
            part.unlink()
    return note


def read_note(folder: Path, name: str, *, verify: bool) -> ShardNote | None:
    """Returns the note of a shard; None if the shard is missing or broken.

    Args:
        folder: folder of the shards.
        name: name of the shard.
        verify: whether to compare the checksum of the file, in addition to its size.
    """
    tar = folder / f"{name}.tar"
    try:
        note = read_json(folder / f"{name}.json", ShardNote, what="Note")
        if tar.stat().st_size != note.size_bytes or (verify and sha256_of(tar, what="Shard") != note.sha256):
            return None
    except (OSError, ConfigError):
        return None
    complete = set(note.pixels) == set(note.views_with) == set(MPCAT40) and note.shard == name
    return note if complete else None


def write_index(folder: Path, notes: Sequence[ShardNote], *, command: str, config: Mapping[str, Any]) -> dict[str, Any]:
    """Writes `index.json`: the shards, counts by category and the command that made them; returns its content.

    A card, `README.md`, tells `datasets.load_dataset` that the data are in the shards; one that exists is kept.
    """
    views = sum(note.views for note in notes)
    total = max(1, sum(sum(note.pixels.values()) for note in notes))
    categories = {
        name: {
            "views": sum(note.views_with[name] for note in notes),
            "pixels": sum(note.pixels[name] for note in notes),
            "pixel_share": round(sum(note.pixels[name] for note in notes) / total, 6),
        }
        for name in MPCAT40
    }
    seconds: dict[str, float] = {}
    for note in notes:
        for part, value in note.seconds.items():
            seconds[part] = round(seconds.get(part, 0.0) + value, 3)
    index = {
        "command": command,
        "config": dict(config),
        "views": views,
        "houses": len({note.house for note in notes}),
        "bytes": sum(note.size_bytes for note in notes),
        "seconds": seconds,
        "categories": categories,
        "shards": [{"shard": f"{n.shard}.tar", "house": n.house, "views": n.views, "sha256": n.sha256} for n in notes],
    }
    write_atomically(folder / INDEX_FILE, (json.dumps(index, indent=1) + "\n").encode())
    if not (folder / CARD_FILE).exists():
        write_atomically(folder / CARD_FILE, CARD)
    return index


@dataclass(frozen=True)
class _Encoded:
    """A view as it is written."""

    key: str
    members: list[tuple[str, bytes]]
    """Suffix and content of its files."""
    pixels: NDArray[np.int64]
    """Number of pixels of each category."""
    seconds: float
    """Time that this took."""


def _encoded_beside(views: Iterable[View], rgb_format: str) -> Iterator[_Encoded]:
    """Yields encoded views; one is encoded in a thread while the caller's thread renders the next."""
    with ThreadPoolExecutor(max_workers=1) as thread:
        earlier: Future[_Encoded] | None = None
        for view in views:
            begun = thread.submit(_encoded, view, rgb_format)
            if earlier is not None:
                yield earlier.result()
            earlier = begun
        if earlier is not None:
            yield earlier.result()


def _encoded(view: View, rgb_format: str) -> _Encoded:
    began = time.perf_counter()
    pixels = cv2.calcHist([view.semantic], [0], None, [len(MPCAT40)], [0, len(MPCAT40)])  # exact below 2^24 pixels
    members = _members(view, rgb_format)
    return _Encoded(view.key, members, np.asarray(pixels, np.int64).reshape(-1), time.perf_counter() - began)


def _members(view: View, rgb_format: str) -> list[tuple[str, bytes]]:
    png = PNG_OPTIONS
    rgb_options = (cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY) if rgb_format == "jpg" else png
    members = [
        (f"rgb.{rgb_format}", _image(f".{rgb_format}", cv2.cvtColor(view.rgb, cv2.COLOR_RGB2BGR), rgb_options)),
        ("depth.png", _image(".png", view.depth_mm, png)),
        ("semantic.png", _image(".png", view.semantic, png)),
        ("json", json.dumps(view.record, sort_keys=True).encode()),
    ]
    if view.instances is not None:
        members.append(("instances.png", _image(".png", view.instances, png)))
    if view.annotations is not None:
        members.append(("coco.json", json.dumps(view.annotations, sort_keys=True).encode()))
    if view.normals is not None:
        members.append(("normals.png", _image(".png", cv2.cvtColor(view.normals, cv2.COLOR_RGB2BGR), png)))
    return members


def _image(suffix: str, image: NDArray, options: Sequence[int]) -> bytes:
    succeeded, buffer = cv2.imencode(suffix, image, options)
    if not succeeded:
        raise ConfigError(f"OpenCV cannot write '{suffix}' images here.")
    return buffer.tobytes()


def _entry(name: str, size: int) -> tarfile.TarInfo:
    """Returns an archive member without time and owner, so that the same views give the same bytes."""
    entry = tarfile.TarInfo(name)
    entry.size, entry.mode = size, 0o644
    return entry


def _lap(seconds: dict[str, float], name: str, began: float) -> float:
    now = time.perf_counter()
    seconds[name] += now - began
    return now


def _rounded(seconds: Mapping[str, float]) -> dict[str, float]:
    return {name: round(value, 3) for name, value in seconds.items()}


def _by_name(counts: NDArray[np.int64]) -> dict[str, int]:
    return dict(zip(MPCAT40, counts.tolist(), strict=True))
