"""The folder of imported models: `models.json`, and one compact file of numbers for each model."""

from __future__ import annotations

import hashlib
import io
import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Literal

import msgspec
import numpy as np
from numpy.typing import NDArray

from sim.core.errors import ConfigError, debug
from sim.core.files import inside, write_atomically
from sim.core.invocation import command
from sim.core.paths import assets_dir
from sim.core.reading import MAX_BYTES, printable, read_json, read_npz, reason_of, sha256_of
from sim.homes.housegen.furniture.item import Mount
from sim.homes.housegen.imported.labels import Size
from sim.homes.housegen.imported.meshes import Part, read_parts
from sim.homes.housegen.imported.reduction import MAX_PLANT_TRIANGLES, MAX_TRIANGLES, UNIT_M, reduced
from sim.homes.housegen.imported.solids import collision_boxes, top_of
from sim.homes.housegen.imported.sources import Entry, Skipped

ModelSplit = Literal["train", "transfer"]
INDEX, MESHES = "models.json", "meshes"
VERSION = 1
TRANSFER_PART = 4
"""One model in this many is for the transfer test."""
MIN_FOR_TRANSFER = 3
"""Categories with fewer models are not in the transfer test unless the names of their models are drawn."""
TRANSFER_LIST = "transfer_models.txt"
"""The models of Sweet Home 3D that are for the transfer test: name and hash of the file, among the shipped assets."""
WITH_TOP = frozenset(("table", "cabinet", "chest_of_drawers", "counter", "shelving"))


@dataclass(frozen=True, kw_only=True)
class Model:
    """One imported model, as `models.json` describes it."""

    key: str
    """Its file, and the beginning of the names of its meshes in house files."""
    ident: str
    name: str
    category: str
    uses: tuple[str, ...]
    mount: Mount
    elevation_m: float
    size_m: Size
    author: str
    licence: str
    origin: str
    sha256: str
    """Hash of the file that it was made of."""
    split: ModelSplit
    triangles: int


@dataclass(frozen=True)
class Shape:
    """The geometry of a model."""

    parts: tuple[Part, ...]
    boxes_m: NDArray[np.float64]  # (n, 6)
    top_m: tuple[float, ...]
    """Lowest x, y, highest x, y and height of the top; empty if the model has no top."""


def import_model(entry: Entry) -> tuple[Model, Shape]:
    """Returns a model with its geometry; its split is preliminary until `with_splits`.

    Raises:
        Skipped: the model cannot be used.
    """
    content = entry.read(entry.file)
    is_plant = entry.label.category == "plant"
    parts = reduced(read_parts(entry), MAX_PLANT_TRIANGLES if is_plant else MAX_TRIANGLES)
    top = top_of(parts) if entry.label.category in WITH_TOP else None
    shape = Shape(parts, collision_boxes(parts, entry.label.category), top or ())
    low = np.min([part.vertices_m.min(axis=0) for part in parts], axis=0)
    high = np.max([part.vertices_m.max(axis=0) for part in parts], axis=0)
    depth, width, height = (round(float(v), 3) for v in high - low)
    label = entry.label
    model = Model(
        key=key_of(entry.ident), ident=entry.ident, name=entry.name, category=label.category, uses=label.uses,
        mount=label.mount, elevation_m=round(entry.elevation_m, 3), size_m=(depth, width, height),
        author=entry.author, licence=entry.licence, origin=entry.origin,
        sha256=hashlib.sha256(content).hexdigest(), split="train", triangles=sum(len(p.faces) for p in parts),
    )  # fmt: skip
    return model, shape


def key_of(ident: str) -> str:
    """Returns the short name of a model: the same for the same model on every machine."""
    return "i" + hashlib.sha256(ident.encode()).hexdigest()[:8]


# ---- split -----------------------------------------------------------------------------------------------------------


def with_splits(models: Sequence[Model], listed: Mapping[str, str] | None = None) -> list[Model]:
    """Returns the models with their splits, which depend on names only.

    If the repository lists the source of a model, the model is for the transfer test if it is in that list. Others are
    drawn by a hash of their names, and a category of `MIN_FOR_TRANSFER` models or more has at least one.
    """
    listed = transfer_list() if listed is None else listed
    sources = {ident.partition("#")[0] for ident in listed}
    chosen = {model.ident for model in models if model.ident in listed}
    free = [model for model in models if model.ident.partition("#")[0] not in sources]
    chosen |= {model.ident for model in free if _drawn(model) % TRANSFER_PART == 0}
    for category, count in Counter(model.category for model in free).items():
        of_category = [model for model in free if model.category == category]
        if count >= MIN_FOR_TRANSFER and not any(model.ident in chosen for model in of_category):
            chosen.add(min(of_category, key=_drawn).ident)
    return [replace(model, split="transfer" if model.ident in chosen else "train") for model in models]


def _drawn(model: Model) -> int:
    return int(hashlib.sha256(f"split {model.ident}".encode()).hexdigest()[:12], 16)


def transfer_list() -> dict[str, str]:
    """Returns the hash of the file of each model that the repository lists for the transfer test, by its name."""
    lines = (assets_dir() / TRANSFER_LIST).read_text(encoding="utf-8").splitlines()
    pairs = (line.rpartition(" ") for line in lines if line and not line.startswith("#"))
    return {ident: sha256 for ident, _, sha256 in pairs}


# ---- files -----------------------------------------------------------------------------------------------------------


def write_shape(folder: Path, model: Model, shape: Shape) -> None:
    """Writes the geometry of a model."""
    arrays: dict[str, NDArray] = {"boxes": shape.boxes_m, "top": np.array(shape.top_m)}
    arrays["rgba"] = np.array([part.rgba for part in shape.parts])
    for n, part in enumerate(shape.parts):
        arrays[f"v{n}"] = np.rint(part.vertices_m / UNIT_M).astype(np.int16)
        arrays[f"f{n}"] = part.faces.astype(np.uint16)
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)  # type: ignore[arg-type]
    write_atomically(folder / MESHES / f"{model.key}.npz", buffer.getvalue())


def read_shape(folder: Path, model: Model) -> Shape:
    """Returns the geometry of a model.

    Raises:
        ConfigError: its file is missing or broken.
    """
    file = inside(folder / MESHES, f"{model.key}.npz", what="key of a model")
    what = "imported model (`stubborn import furniture` makes it again)"
    arrays = read_npz(file, what=what, most_bytes=MAX_BYTES)
    try:
        return _shape_of(arrays)
    except ValueError as error:
        raise ConfigError(f"'{file}' is not an {what}: {error}.") from None


def _shape_of(arrays: Mapping[str, NDArray[Any]]) -> Shape:
    """Returns the geometry in the arrays of a file; raises ValueError if one is missing or has another shape."""
    rgba, boxes_m = _numbers(arrays, "rgba", 4), _numbers(arrays, "boxes", 6)
    parts = tuple(
        Part(
            _numbers(arrays, f"v{n}", 3) * UNIT_M,
            _numbers(arrays, f"f{n}", 3).astype(np.int32),
            (float(red), float(green), float(blue), float(alpha)),
        )
        for n, (red, green, blue, alpha) in enumerate(rgba)
    )
    top = arrays.get("top")
    if top is None or top.shape not in ((0,), (5,)) or top.dtype.kind != "f":
        raise ValueError("'top' must have five numbers or be empty")
    return Shape(parts, boxes_m, tuple(map(float, top)))


def _numbers(arrays: Mapping[str, NDArray[Any]], name: str, columns: int) -> NDArray[Any]:
    """Returns an array of numbers, (n, columns); raises ValueError if it is missing."""
    array = arrays.get(name)
    if array is None:
        raise ValueError(f"it has no '{name}'")
    if array.dtype.kind not in "iuf" or array.ndim != 2 or array.shape[1] != columns:
        raise ValueError(f"'{name}' is {array.dtype} {array.shape}, not numbers in {columns} columns")
    return array


def write_index(folder: Path, models: Sequence[Model], left_out: Sequence[tuple[str, str]]) -> None:
    """Writes `models.json`, with the models that were left out and the reasons."""
    content = {
        "version": VERSION,
        "models": [asdict(model) for model in models],
        "left_out": [{"name": name, "reason": reason} for name, reason in left_out],
    }
    write_atomically(folder / INDEX, (json.dumps(content, indent=1, ensure_ascii=False) + "\n").encode())


def read_index(folder: Path) -> list[Model]:
    """Returns the models of a folder that `stubborn import furniture` made.

    Raises:
        ConfigError: the folder does not exist, or its `models.json` is broken.
    """
    file = folder / INDEX
    if not file.is_file():
        raise ConfigError(f"'{folder}' has no {INDEX}: make it with `{command('import', 'furniture')}`.")
    try:
        content = read_json(file, _Index, what="List of models")
    except ConfigError as error:
        raise ConfigError(f"{error} Import the models again with `{command('import', 'furniture')}`.") from None
    if content.version != VERSION:
        raise ConfigError(f"'{file}' has version {content.version}, not {VERSION}: import the models again.")
    for model in content.models:
        inside(folder / MESHES, f"{model.key}.npz", what="key of a model")
    return content.models


def sha256_of_models(folder: Path) -> str:
    """Returns a hash of the models of a folder.

    Raises:
        ConfigError: the folder does not exist.
    """
    read_index(folder)
    return sha256_of(folder / INDEX, what="Index of models")


class _Index(msgspec.Struct):
    """The content of `models.json`."""

    version: int
    models: list[Model]


def import_entries(entries: Sequence[Entry], folder: Path) -> Iterator[Model | tuple[str, str]]:
    """Yields each imported model, written to the folder, or its name and the reason why it was left out."""
    for entry in entries:
        try:
            model, shape = import_model(entry)
        except Skipped as reason:
            yield entry.name, str(reason)
            continue
        except Exception as error:  # data of others can meet any error: it must not end the import of the other models
            if debug():
                raise
            yield entry.name, f"it cannot be imported ({type(error).__name__}: {printable(reason_of(error))[:100]})"
            continue
        write_shape(folder, model, shape)
        yield model
