"""Reads labelled views from WebDataset shards, as arrays and as a PyTorch data set.

A shard is a tar file in which the members of one view share a key: `key.rgb.jpg` (or `.png`), `key.depth.png` (uint16
millimetres), `key.semantic.png` (uint8 mpcat40 id), `key.json` and, if requested, `key.instances.png`,
`key.coco.json` and `key.normals.png` (docs/datasets.md). The `webdataset` package reads them as well, with
`decode_member`; this reader needs only the standard library and OpenCV, and its errors name the broken file and view.
"""

from __future__ import annotations

import contextlib
import math
import tarfile
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

import cv2
import msgspec
import numpy as np
from jaxtyping import Float32, Float64, Shaped, UInt8, UInt16
from torch.utils.data import IterableDataset, get_worker_info

from sim.core.interface import GOAL_CATEGORIES, MPCAT40, MPCAT40_ID, ConfigError
from sim.core.pictures import decode_picture
from sim.core.reading import (
    MAX_BYTES,
    Count,
    PlainMember,
    convert,
    open_plain,
    parse_json,
    read_json,
)
from sim.training.views.coco import MaskRuns

GOAL_IDS = np.array([MPCAT40_ID[name] for name in GOAL_CATEGORIES])
"""mpcat40 ids of the goal categories."""
_PARTS = ("rgb", "depth", "semantic", "json")
_Pixel = Annotated[float, msgspec.Meta(ge=-100_000.0, le=100_000.0)]
_BROKEN_TAR = (tarfile.TarError, OSError, EOFError, ValueError, RecursionError)
"""The exceptions that `tarfile` raises for files that are not tar files."""


class _NoteConfig(msgspec.Struct):
    """Options that the views of a shard were stored with."""

    shrink: Annotated[int, msgspec.Meta(ge=1, le=64)] = 1


class _Note(msgspec.Struct):
    """The JSON note next to a shard: the part that states how its views were stored."""

    config: _NoteConfig = msgspec.field(default_factory=_NoteConfig)


class _Object(msgspec.Struct):
    """An object of a view, as COCO describes it."""

    id: Annotated[int, msgspec.Meta(ge=0, le=65535)]
    name: str
    category_id: Annotated[int, msgspec.Meta(ge=0, lt=len(MPCAT40))]
    area: Count
    bbox: tuple[_Pixel, _Pixel, _Pixel, _Pixel]
    segmentation: MaskRuns


class _PixelNote(msgspec.Struct):
    """The part of a note that counts pixels."""

    pixels: dict[str, Count]


class _CountNote(msgspec.Struct):
    """The part of a note that says how many views the shard has."""

    views: Count | None = None


@dataclass(frozen=True)
class LabelledView:
    """One view as it was stored."""

    key: str
    rgb: UInt8[np.ndarray, "h w 3"]
    depth_m: Float32[np.ndarray, "h w"]
    """Metres; 0: no return or nearer than the camera's range."""
    semantic: UInt8[np.ndarray, "h w"]
    """mpcat40 ids."""
    record: dict[str, Any] = field(default_factory=dict)
    """Content of `key.json`."""
    instances: UInt16[np.ndarray, "h w"] | None = None
    """Number of the instance of each pixel, from 1; 0: no instance. None: the shard has no such member."""
    annotations: list[dict[str, Any]] | None = None
    """The objects in the format of COCO: boxes and masks; None: the shard has no such member."""
    normals: Float32[np.ndarray, "h w 3"] | None = None
    """Unit surface normals in the camera's frame (x right, y down, z forward); 0 where a normal is missing. None: the
    shard has no such member."""


def decode_member(name: str, content: bytes) -> Any:
    """Returns a member of a view as it was stored, for `webdataset.WebDataset(...).decode(decode_member)`.

    The decoders of `webdataset` (`"rgb8"`, `"pil"`) treat every PNG file as a colour image and reduce depth in
    millimetres to 8 bits. This decoder keeps 16 bits.

    Args:
        name: name of the member; its ending selects the decoder: `rgb.jpg`, `depth.png`, ...
        content: the file.

    Returns:
        `rgb` and `normals` as uint8 (h, w, 3), `depth` and `instances` as uint16 (h, w), `semantic` as uint8 (h, w),
        and the content of JSON; None for another ending, so that the next decoder handles it.

    Raises:
        ConfigError: an image or a JSON text cannot be read.
    """
    parts = name.rsplit("/", 1)[-1].lower().split(".")
    if parts[-1] == "json":
        return parse_json(content, Any, where=f"Member '{name}'")
    if parts[-1] not in ("png", "jpg"):
        return None
    in_colour = {"rgb", "normals"} & set(parts[:-1])
    image = decode_picture(content, cv2.IMREAD_COLOR if in_colour else cv2.IMREAD_UNCHANGED, where=f"Member '{name}'")
    return cv2.cvtColor(image, cv2.COLOR_BGR2RGB) if in_colour else image


def list_shards(folder: Path) -> list[Path]:
    """Returns the shards of a folder, sorted by name.

    Raises:
        ConfigError: the folder holds no shard, or two shards that begin with the same view.
    """
    shards = sorted(folder.glob("*.tar"))
    if not shards:
        raise ConfigError(f"No shards (*.tar) in '{folder}'. `stubborn views` makes them.")
    first = dict[str, Path]()
    for shard in shards:
        key = next(_members(shard, frozenset()), ("", {}))[0]
        if key and key in first:
            raise ConfigError(
                f"The shards '{first[key]}' and '{shard}' both hold the view '{key}', which would count twice: remove "
                "one, or keep shards of other commands in folders of their own."
            )
        first[key] = shard
    return shards


def read_shard(file: Path) -> Iterator[LabelledView]:
    """Yields the views of one shard in their order.

    Raises:
        ConfigError: the file is not a tar file or truncated, or a view in it is incomplete.
    """
    for key, parts in _members(file):
        yield decode_view(file, key, parts)


def _members(file: Path, numbers: Collection[int] | None = None) -> Iterator[tuple[str, dict[str, bytes]]]:
    """Yields key and members of the views of a shard in their order; {} for views that are not in `numbers`.

    Raises:
        ConfigError: the file is not a tar file or truncated.
    """

    def content(member: tarfile.TarInfo) -> bytes:
        stream = archive.extractfile(member)
        return b"" if stream is None else stream.read()

    with _opened(file) as archive:
        for number, (key, members) in enumerate(_views(file, archive)):
            is_wanted = numbers is None or number in numbers
            yield key, {kind: content(member) for kind, member in members.items()} if is_wanted else {}


def read_members(file: Path) -> Iterator[tuple[str, dict[str, tuple[int, int]]]]:
    """Yields the key of each view of a shard with offset and size in bytes of its members, without reading them.

    Raises:
        ConfigError: the file is not a tar file or truncated.
    """
    with _opened(file) as archive:
        for key, members in _views(file, archive):
            yield key, {kind: (member.offset_data, member.size) for kind, member in members.items()}


@contextlib.contextmanager
def _opened(file: Path) -> Iterator[tarfile.TarFile]:
    """Opens a shard as a tar file; a compressed one is refused, because it could expand without end.

    Raises:
        ConfigError: the file is not a tar file or truncated.
    """
    try:
        with (
            open_plain(file, what="Shard") as stream,
            tarfile.open(fileobj=stream, mode="r:", tarinfo=PlainMember) as archive,
        ):
            yield archive
    except _BROKEN_TAR as error:
        if isinstance(error, ConfigError):
            raise
        raise ConfigError(f"Shard '{file}' is broken: {error}. `stubborn views` makes it again.") from None


def _views(file: Path, archive: tarfile.TarFile) -> Iterator[tuple[str, dict[str, tarfile.TarInfo]]]:
    """Yields the key of each view of an open shard with its members by kind.

    Raises:
        ConfigError: the shard holds a view twice, or one part of a view twice, such as `rgb.jpg` and `rgb.png`.
    """
    keys, key, members = set[str](), "", dict[str, tarfile.TarInfo]()
    for member in archive:
        _require_small_file(file, member)
        name, _, suffix = member.name.partition(".")
        if name != key or not keys:
            if name in keys:
                raise ConfigError(f"Shard '{file}' holds the view '{name}' twice; a view is stored once.")
            if members:
                yield key, members
            keys.add(name)
            key, members = name, {}
        kind = suffix.split(".")[0]
        if kind in members:
            raise ConfigError(f"Shard '{file}': view '{key}' has '{kind}' twice; a view has one of each kind.")
        members[kind] = member
    if members:
        yield key, members


def _require_small_file(file: Path, member: tarfile.TarInfo) -> None:
    """Raises ConfigError if a member of a shard is a link, a device, a sparse file or too large."""
    if not member.isreg() or member.issparse():
        raise ConfigError(f"Shard '{file}': '{member.name}' is not a plain file; a shard holds plain files only.")
    if member.size > MAX_BYTES:
        raise ConfigError(f"Shard '{file}': '{member.name}' has {member.size >> 20} MB, at most {MAX_BYTES >> 20}.")


class ViewDataset(IterableDataset):
    """A data set of the views of many shards, in a random order that changes with `epoch`.

    The workers of a `DataLoader` share the shards.

    Args:
        shards: files.
        transform: converts a view to a sample; each worker has a random generator of its own. None: the samples are
            the views, `LabelledView`, for which a `DataLoader` needs `collate_fn=list` or `batch_size=None`.
        buffer: number of views from which the next one is sampled.
        seed: seeds the order and the transform, together with the epoch.
        shuffle: False reads in order, for evaluation.
    """

    def __init__(
        self,
        shards: Sequence[Path],
        transform: Callable[[LabelledView, np.random.Generator], Any] | None = None,
        *,
        buffer: int = 1000,
        seed: int = 0,
        shuffle: bool = True,
    ) -> None:
        super().__init__()
        self.shards = list(shards)
        self.transform = transform
        self.buffer = buffer
        self.seed = seed
        self.shuffle = shuffle
        self.epoch = 0

    def __iter__(self) -> Iterator[Any]:
        """Yields the samples of this worker's shards."""
        info = get_worker_info()
        worker, workers = (0, 1) if info is None else (info.id, info.num_workers)
        order = np.random.default_rng([self.seed, self.epoch])
        shards = [self.shards[i] for i in order.permutation(len(self.shards))] if self.shuffle else self.shards
        rng = np.random.default_rng([self.seed, self.epoch, worker])
        views = (view for shard in shards[worker::workers] for view in read_shard(shard))
        for view in _shuffled(views, rng, self.buffer) if self.shuffle else views:
            yield view if self.transform is None else self.transform(view, rng)


def _shuffled(views: Iterator[LabelledView], rng: np.random.Generator, buffer: int) -> Iterator[LabelledView]:
    """Yields the same views in random order; each is sampled from the next `buffer` ones."""
    held: list[LabelledView] = []
    for view in views:
        if len(held) < buffer:
            held.append(view)
            continue
        i = int(rng.integers(len(held)))
        held[i], view = view, held[i]
        yield view
    for i in rng.permutation(len(held)).tolist():
        yield held[i]


def pixel_counts(shards: Sequence[Path]) -> Float64[np.ndarray, " 41"]:
    """Returns the number of pixels of each mpcat40 category.

    The number is read from the JSON note next to each shard, or counted if the note is missing.
    """
    counts = np.zeros(len(MPCAT40))
    for shard in shards:
        note = shard.with_suffix(".json")
        if note.is_file():
            pixels = read_json(note, _PixelNote, what="Note of a shard").pixels
            counts += [pixels.get(name, 0) for name in MPCAT40]
        else:
            for view in read_shard(shard):
                counts += np.bincount(view.semantic.reshape(-1), minlength=len(MPCAT40))
    return counts


def stored_views(shards: Sequence[Path]) -> int | None:
    """Returns the number of views of some shards, from the JSON notes next to them; None if one does not say it."""
    notes = [shard.with_suffix(".json") for shard in shards]
    if not all(note.is_file() for note in notes):
        return None
    counts = [read_json(note, _CountNote, what="Note of a shard").views for note in notes]
    known = [count for count in counts if count is not None]
    return sum(known) if len(known) == len(counts) else None


def stored_block_px(shards: Sequence[Path]) -> int:
    """Returns the factor by which the views were shrunk before they were stored; 1 if the shards have no note.

    Raises:
        ConfigError: the shards have different factors.
    """
    shrinks = set()
    for shard in shards:
        note = shard.with_suffix(".json")
        shrinks.add(read_json(note, _Note, what="Note of a shard").config.shrink if note.is_file() else 1)
    if len(shrinks) > 1:
        folders = ", ".join(sorted({f"'{shard.parent}'" for shard in shards}))
        raise ConfigError(f"The shards in {folders} were shrunk by different factors: {sorted(shrinks)}.")
    return shrinks.pop() if shrinks else 1


def spread_views(shards: Sequence[Path], count: int) -> list[LabelledView]:
    """Returns `count` views, the same number from each shard, evenly spread over it; all views when `count` is 0.

    With fewer views than shards each view is from another shard, evenly spread over the shards. Other views are not
    decoded.
    """
    if 0 < count < len(shards):
        shards = [shards[i] for i in np.linspace(0, len(shards) - 1, count).round().astype(int).tolist()]
    picked: list[LabelledView] = []
    for number, shard in enumerate(shards):
        if count == 0:
            picked += read_shard(shard)
            continue
        views = sum(1 for _ in _members(shard, frozenset()))
        share = min(math.ceil((count - len(picked)) / (len(shards) - number)), views)
        numbers = frozenset(np.linspace(0, views - 1, share).round().astype(int).tolist())
        picked += [decode_view(shard, key, parts) for key, parts in _members(shard, numbers) if parts]
    return picked


def decode_view(file: Path, key: str, parts: dict[str, bytes]) -> LabelledView:
    """Returns the view of a shard with these members.

    Raises:
        ConfigError: a member is missing or broken.
    """
    missing = [part for part in _PARTS if part not in parts]
    if missing:
        raise ConfigError(f"Shard '{file}': view '{key}' has no '{missing[0]}'.")
    rgb = _image(file, key, "rgb", parts, cv2.IMREAD_COLOR)
    depth = _image(file, key, "depth", parts, cv2.IMREAD_UNCHANGED)
    semantic = _image(file, key, "semantic", parts, cv2.IMREAD_UNCHANGED)
    if (depth.dtype, semantic.dtype) != (np.uint16, np.uint8):
        raise ConfigError(
            f"Shard '{file}': view '{key}' has depth of {depth.dtype} and labels of {semantic.dtype}; it needs "
            "uint16 and uint8."
        )
    if not rgb.shape[:2] == depth.shape == semantic.shape:
        raise ConfigError(f"Shard '{file}': the images of view '{key}' differ in size.")
    if semantic.max() >= len(MPCAT40):
        raise ConfigError(f"Shard '{file}': view '{key}' has category {semantic.max()}, mpcat40 ends at 40.")
    record = parse_json(parts["json"], dict[str, Any], where=f"Shard '{file}': the record of view '{key}'")
    colour = np.asarray(cv2.cvtColor(rgb, cv2.COLOR_BGR2RGB), np.uint8)
    view = LabelledView(key, colour, depth.astype(np.float32) / 1000.0, semantic, record)
    return _with_extras(file, view, parts)


def _with_extras(file: Path, view: LabelledView, parts: dict[str, bytes]) -> LabelledView:
    """Returns the view with the optional members that exist; raises ConfigError if one is broken."""
    where = f"Shard '{file}': view '{view.key}'"
    if "instances" in parts:
        instances = _image(file, view.key, "instances", parts, cv2.IMREAD_UNCHANGED)
        if instances.dtype != np.uint16 or instances.shape != view.semantic.shape:
            raise ConfigError(f"{where} has instances of {instances.dtype} {instances.shape}; it needs uint16 (h, w).")
        view = replace(view, instances=instances)
    if "coco" in parts:
        objects = parse_json(parts["coco"], list[dict[str, Any]], where=f"{where}: its objects")
        convert(objects, list[_Object], where=f"{where}: its objects")
        view = replace(view, annotations=objects)
    if "normals" in parts:
        levels = cv2.cvtColor(_image(file, view.key, "normals", parts, cv2.IMREAD_COLOR), cv2.COLOR_BGR2RGB)
        if levels.shape[:2] != view.semantic.shape:
            raise ConfigError(f"{where} has normals of another size.")
        normals = levels.astype(np.float32) / np.float32(127.5) - 1.0
        view = replace(view, normals=normals * levels.any(axis=-1, keepdims=True))
    return view


def _image(file: Path, key: str, part: str, parts: dict[str, bytes], flag: int) -> Shaped[np.ndarray, "h w *channels"]:
    return decode_picture(parts[part], flag, where=f"Shard '{file}': the {part} image of view '{key}'")
