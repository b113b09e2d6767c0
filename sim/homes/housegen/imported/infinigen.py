"""Makes a folder of models with Infinigen's generators, by a process of the user's Python that has Infinigen.

The folder is a source of `stubborn import furniture`: a GLB file for each asset, and `models.csv`. A record in JSON for
each asset says how it was made or why it failed, so that a stopped run resumes. `infinigen_worker` runs in the process.
"""

from __future__ import annotations

import contextlib
import json
import os
import select
import signal
import subprocess
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO

import msgspec

from sim.core.errors import ConfigError
from sim.core.files import csv_text, open_to_grow, write_atomically
from sim.core.reading import parse_json, read_json
from sim.homes.housegen.furniture.item import Mount

WORKER = Path(__file__).with_name("infinigen_worker.py")
VERSION = 1
"""Increased when the same seed gives another file; assets of other versions are made again."""
TABLE, LOG = "models.csv", "infinigen.log"
AUTHOR, LICENCE = "made with Infinigen by its user", "generated; Infinigen is BSD-3-Clause"
MAX_TRIANGLES = 30_000
"""Triangles of a file; the import reduces them further."""
START_S = 300.0
"""Longest time until the process is ready."""
_COLUMNS = ("file", "category", "uses", "width_m", "depth_m", "height_m", "mount", "author", "license")


@dataclass(frozen=True)
class Generator:
    """A generator of Infinigen, and the furniture that its assets are."""

    factory: str
    """Class below `infinigen.assets.objects`, with its module."""
    category: str
    uses: tuple[str, ...] = ()
    mount: Mount = "floor"
    two_sided: bool = False
    """True: leaves, shades or cloth that are seen from both sides."""
    upright: bool = False
    """True: an asset that lies flat is set on its edge."""
    dimensions_m: tuple[tuple[float, float], ...] | None = None
    """Ranges of depth, width and height for generators that take them; None: the generator draws them."""
    options: Mapping[str, object] = field(default_factory=dict)
    """Further arguments of the class."""
    title: str = ""
    """The beginning of the names of its files; "": the name of the class."""

    @property
    def name(self) -> str:
        """The beginning of the names of its files, A-Z and a-z only."""
        return self.title or self.factory.rpartition(".")[2].removesuffix("Factory")


_CABINET, _CLOSED = "shelves.KitchenCabinetFactory", {"drawer_only": True}
"""Each column of this cabinet has a door or drawers at random; without the option, it may be open."""
GENERATORS: tuple[Generator, ...] = (
    Generator("seating.ChairFactory", "chair", ("dining",)),
    Generator("seating.OfficeChairFactory", "chair", ("office",)),
    Generator("seating.ArmChairFactory", "chair", ("arm",)),
    Generator("seating.BarChairFactory", "stool", ("bar",)),
    Generator("seating.SofaFactory", "sofa"),
    Generator("seating.BedFactory", "bed"),
    Generator("seating.PillowFactory", "cushion", ("throw",), "top", upright=True, title="Cushion"),
    Generator("seating.PillowFactory", "cushion", ("floor",), title="FloorCushion"),
    Generator("tables.TableDiningFactory", "table", ("dining",)),
    Generator("tables.CoffeeTableFactory", "table", ("coffee",)),
    Generator("tables.SideTableFactory", "table", ("side",)),
    Generator("shelves.SimpleDeskFactory", "table", ("desk",)),
    Generator("shelves.SidetableDeskFactory", "table", ("nightstand",)),
    Generator("shelves.SingleCabinetFactory", "cabinet", ("display",)),
    Generator(_CABINET, "cabinet", ("sideboard",), dimensions_m=((0.35, 0.45), (0.8, 1.6), (0.7, 0.95)),
              options=_CLOSED, title="Sideboard"),
    Generator(_CABINET, "cabinet", ("wardrobe",), dimensions_m=((0.5, 0.6), (0.9, 1.8), (1.6, 2.1)),
              options=_CLOSED, title="Wardrobe"),
    Generator("shelves.TVStandFactory", "cabinet", ("media",)),
    Generator("shelves.KitchenIslandFactory", "counter", ("island",)),
    Generator("bathroom.ToiletFactory", "toilet"),
    Generator("bathroom.BathtubFactory", "bathtub"),
    Generator("bathroom.StandingSinkFactory", "sink", ("standing",)),
    Generator("clothes.TowelFactory", "towel", ("top",), "top"),
    Generator("clothes.PantsFactory", "clothes", ("floor",)),
    Generator("clothes.ShirtFactory", "clothes", ("floor",)),
    Generator("appliances.TVFactory", "tv_monitor", ("tv",), "top"),
    Generator("appliances.MonitorFactory", "tv_monitor", ("monitor",), "top"),
    Generator("tableware.PlantContainerFactory", "plant", ("top",), "top", two_sided=True),
    Generator("tableware.LargePlantContainerFactory", "plant", ("floor",), two_sided=True),
    Generator("shelves.SimpleBookcaseFactory", "shelving", ("bookcase",)),
    Generator("shelves.LargeShelfFactory", "shelving", ("bookcase",)),
    Generator("shelves.CellShelfFactory", "shelving", ("bookcase",)),
    Generator("lamp.FloorLampFactory", "lighting", ("floor",), two_sided=True),
    Generator("lamp.DeskLampFactory", "lighting", ("table",), "top", two_sided=True),
)  # fmt: skip
"""The generators of assets that rooms ask for. Infinigen lacks chests of drawers, showers, seating, fireplaces and
training machines, and its pictures and hanging towels do not survive the loss of patterns."""


@dataclass(frozen=True)
class Asset:
    """The record of an asset that was tried."""

    generator: str
    seed: int
    seconds: float
    extent_m: tuple[float, float, float] | None = None
    """Lengths along Infinigen's x, y and z axes; None if it failed."""
    triangles: int = 0
    error: str = ""
    limit_s: float = 0.0
    """The time limit that it exceeded; 0: it failed for another reason, or did not fail."""
    version: int = VERSION


class _Answer(msgspec.Struct):
    """An answer of the process."""

    ready: str = ""
    extent_m: tuple[float, float, float] | None = None
    triangles: int = 0
    error: str = ""


def make_assets(
    out: Path,
    python: Path,
    generators: Sequence[Generator],
    seeds: Sequence[int],
    *,
    limit_s: float,
) -> Iterator[Asset]:
    """Yields the record of each asset, of every generator for the first seed, then for the next; writes `models.csv`.

    Assets that have a record are not made again, failed ones neither: a seed gives the same asset each time. Those that
    took too long are tried again with a longer limit.

    Raises:
        ConfigError: the Python cannot be started, or has no Infinigen.
    """
    out.mkdir(parents=True, exist_ok=True)
    worker: _Worker | None = None
    try:
        for seed in seeds:
            for generator in generators:
                record = out / f"{generator.name}_{seed:04d}.json"
                asset = _before(record)
                if asset is None or 0.0 < asset.limit_s < limit_s:
                    if worker is None or not worker.runs:
                        worker = _Worker(python, out / LOG)
                    asset = _made(worker, out, generator, seed, limit_s)
                    write_atomically(record, msgspec.json.encode(asset) + b"\n")
                yield asset
    finally:
        if worker is not None:
            worker.end()
        _write_table(out)


def _write_table(out: Path) -> None:
    """Writes `models.csv` with all assets in a folder."""
    by_name = {generator.name: generator for generator in GENERATORS}
    rows = []
    for record in sorted(out.glob("*_[0-9]*.json")):
        asset, model = _before(record), record.with_suffix(".glb")
        generator = by_name.get(asset.generator) if asset is not None else None
        if asset is not None and generator is not None and asset.extent_m is not None and model.is_file():
            rows.append(_row(generator, asset.extent_m, model.name))
    write_atomically(out / TABLE, csv_text(_COLUMNS, rows))


def _row(generator: Generator, extent_m: tuple[float, float, float], file: str) -> tuple[object, ...]:
    """Returns the row of an asset: its front is towards Infinigen's x axis."""
    depth, width, height = extent_m
    uses = " ".join(generator.uses)
    return file, generator.category, uses, width, depth, height, generator.mount, AUTHOR, LICENCE


def _before(record: Path) -> Asset | None:
    """Returns the record of an asset that was made before; None if it was not made by this version."""
    if not record.is_file():
        return None
    asset = read_json(record, Asset, what="Record of an asset")
    return asset if asset.version == VERSION else None


def _made(worker: _Worker, out: Path, generator: Generator, seed: int, limit_s: float) -> Asset:
    """Returns the record of a new asset."""
    file = out / f"{generator.name}_{seed:04d}.glb"
    began_s = time.monotonic()
    request = {
        "factory": generator.factory, "seed": seed, "file": str(file.resolve()), "two_sided": generator.two_sided,
        "upright": generator.upright, "triangles": MAX_TRIANGLES, "options": dict(generator.options),
        "dimensions_m": generator.dimensions_m,
    }  # fmt: skip
    answer = worker.ask(request, limit_s)
    late = bool(answer.error) and not worker.runs and time.monotonic() - began_s >= limit_s
    error = answer.error or ("" if answer.extent_m and file.is_file() else "no file was written")
    return Asset(
        generator.name, seed, round(time.monotonic() - began_s, 1), None if error else answer.extent_m,
        answer.triangles, error, limit_s if late else 0.0,
    )  # fmt: skip


class _Worker:
    """A process that makes assets, one at a time.

    Raises:
        ConfigError: it cannot be started, or does not become ready.
    """

    def __init__(self, python: Path, log: Path) -> None:
        self._buffer = b""
        try:
            with open_to_grow(log) as errors:
                # -P: modules next to the script do not hide those of the user's environment.
                self._process = subprocess.Popen(
                    [str(python), "-P", str(WORKER)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=errors,
                    bufsize=0, start_new_session=True,
                )  # fmt: skip
        except OSError as error:
            raise ConfigError(f"--python '{python}' cannot be started: {error.strerror}.") from None
        if not (answer := self._answer(START_S)).ready:
            self.end()
            raise ConfigError(f"Infinigen does not start with --python '{python}': {answer.error}. See '{log}'.")

    @property
    def runs(self) -> bool:
        """Whether it can make another asset."""
        return self._process.poll() is None

    def ask(self, request: dict[str, object], limit_s: float) -> _Answer:
        """Returns the answer to a request; an answer with an error, and no running process, after the time limit."""
        try:
            _stream(self._process.stdin).write(json.dumps(request).encode() + b"\n")
        except OSError:
            self.end()
            return _Answer(error="the process has ended")
        return self._answer(limit_s)

    def end(self) -> None:
        """Ends the process and all that it has started."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        for stream in (self._process.stdin, self._process.stdout):
            _stream(stream).close()

    def _answer(self, limit_s: float) -> _Answer:
        line = self._line(time.monotonic() + limit_s)
        if line:
            try:
                return parse_json(line, _Answer, where="the answer of the process")
            except ConfigError as error:
                reason = str(error).rstrip(".")
        else:
            reason = f"no answer within {limit_s:g} s" if self.runs else "the process has ended"
        self.end()
        return _Answer(error=reason)

    def _line(self, until_s: float) -> bytes:
        """Returns the next line, or nothing after the time limit or at the end of the process."""
        stream = _stream(self._process.stdout)
        while b"\n" not in self._buffer:
            ready, _, _ = select.select([stream], [], [], max(0.0, until_s - time.monotonic()))
            chunk = stream.read(65536) if ready else b""
            if not chunk:
                if ready:
                    self._process.wait()
                return b""
            self._buffer += chunk
        line, _, self._buffer = self._buffer.partition(b"\n")
        return line


def _stream(stream: IO[bytes] | None) -> IO[bytes]:
    assert stream is not None
    return stream
