"""Imports houses one after the other into a folder that is a split, with progress, a report and pictures."""

from __future__ import annotations

import functools
import hashlib
import itertools
import json
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Generic, TypeVar

import msgspec
import numpy as np
from msgspec import Meta

from sim.app import cli
from sim.app.analysis.display import make_console
from sim.app.evaluation.own_code import one_line
from sim.app.evaluation.parallel import ordered_map
from sim.app.viewers.house_pictures import draw_top, draw_views, titled
from sim.core.errors import ConfigError, ObjectNavError, debug
from sim.core.files import inside, write_atomically, write_picture
from sim.core.interface import GOAL_CATEGORIES
from sim.core.invocation import command
from sim.core.reading import convert, printable, read_json, sha256_of
from sim.core.vocabulary import counted
from sim.episodes.splits import LABELS_FILE, labels_of
from sim.homes.importers.losses import added
from sim.homes.importers.mesh_house import Collision, MeshConfig
from sim.homes.importers.surfaces import MAX_FILE_BYTES
from sim.houses.labels import read_labels
from sim.houses.load import load_house

SourceT = TypeVar("SourceT")
REPORT_FILE = "import.json"
VERSION = 4
"""Increased when the same source gives another house."""
CHUNK = 64
"""Houses that are in memory at a time."""
PROGRESS_S = 5.0
"""A line on the progress is printed about this often."""
VIEWS = 8
"""Smallest number of views of a house."""
MAX_TYPES = 12
"""Largest number of types in a line of the result."""


@dataclass(frozen=True, kw_only=True)
class ImportArgs:
    """The options of every command that imports houses."""

    out: cli.OutFolder
    """Folder of the houses; created if missing."""
    houses: cli.Count | None = None
    """Import only the first houses."""
    pictures: cli.Amount = 3
    """Draw the first houses from above, and views of them."""
    workers: cli.Count = 1
    """Number of processes."""


@dataclass(frozen=True, kw_only=True)
class SceneArgs(ImportArgs):
    """The options of commands that import MJCF scenes with files of their own."""

    root: Path | None = None
    """A folder whose files the houses may use in addition to their own folder."""
    texture_px: Annotated[int, Meta(ge=16, le=8192)] = 1024
    """Longest side of a texture; larger ones are reduced."""
    pack: bool = False
    """Copy all meshes and textures; by default, unchanged ones are hard links to the source's files if possible."""


@dataclass(frozen=True, kw_only=True)
class MeshArgs(ImportArgs):
    """The options of commands that make houses of triangles."""

    collision: Collision = "boxes"
    """Collision geoms: boxes of a grid, or convex parts by CoACD, which take much longer."""
    triangles: cli.Count = 100_000
    """About the largest number of visual triangles of a house."""
    texture_px: cli.Count = 1024
    """Longest side of a picture; larger ones are reduced."""

    @property
    def config(self) -> MeshConfig:
        """The options of a house."""
        return MeshConfig(collision=self.collision, triangles=self.triangles, texture_px=self.texture_px)


@dataclass(frozen=True)
class Work(Generic[SourceT]):
    """A house to import."""

    name: str
    content: bytes
    """The bytes on which the house depends, in addition to the options."""
    source: SourceT
    share: float = 0.0
    """Share of the input that has been read up to this house; 0: unknown."""


class HouseReport(msgspec.Struct):
    """The entries of a house's report that commands read."""

    rooms: int
    area_m2: float
    lowered_m: float = 0.0
    key: str = ""
    """Identifies the source and the options."""
    rules: dict[str, str] = {}

    @classmethod
    def of(cls, report: Mapping[str, object]) -> HouseReport:
        """Returns the entries of a report.

        Raises:
            ConfigError: one of them is missing or has another type.
        """
        return convert(report, cls, where=f"Report of the house '{report.get('house')}'")


@dataclass(frozen=True)
class Made:
    """An imported house."""

    report: Mapping[str, object]
    rules: Mapping[str, str] = field(default_factory=dict)
    """Label rules that it needs."""


@dataclass(frozen=True)
class _Failed:
    message: str


def import_all(
    args: ImportArgs,
    works: Iterable[Work[SourceT]],
    make: Callable[[SourceT], Made],
    *,
    total: int | None,
    options: str,
) -> int:
    """Imports houses and prints the outcome; returns 1 if a house could not be imported.

    Args:
        args: the folder, and how many houses are drawn, by how many processes.
        works: the houses.
        make: writes a house into the folder; picklable.
        total: largest number of houses, for the time left; None: the time left follows from `Work.share`.
        options: text of all options on which the houses depend.

    Raises:
        ConfigError: the folder has a report that another program wrote, or there is no house.
    """
    out = args.out
    before = read_reports(out)
    reports: dict[str, dict[str, object]] = {}
    rules: dict[str, str] = {}
    failed = 0
    began_s = said_s = time.monotonic()
    try:
        for work, key, made in _run(works, make, out, before, options, args.workers):
            if isinstance(made, _Failed):
                failed += 1
                print(f"{work.name}: left out: {printable(made.message)}", file=sys.stderr)
            else:
                reports[work.name] = {**made.report, "key": key, "rules": dict(made.rules)}
                rules.update(made.rules)
            done = len(reports) + failed
            share = max(work.share, done / total if total else 0.0)
            if share < 1.0 and time.monotonic() - said_s > PROGRESS_S:
                said_s = time.monotonic()
                left_s = round((said_s - began_s) * (1.0 / max(share, 1e-6) - 1.0))
                print(f"{counted(done, 'house')}, about {left_s // 60} min {left_s % 60} s left.", flush=True)
                _write(out, before, reports, rules)  # a killed import goes on from here
    finally:  # also after Ctrl-C
        if reports or failed:
            _write(out, before, reports, rules)
    if not reports and not failed:
        raise ConfigError("There is no house to import.")
    _print_result(list(reports.values()), failed, out)
    for name in list(reports)[: args.pictures]:
        _draw(out, name)
    return int(failed > 0)


def _run(
    works: Iterable[Work[SourceT]], make: Callable[[SourceT], Made], out: Path,
    before: Mapping[str, Mapping[str, object]], options: str, workers: int,
) -> Iterator[tuple[Work[SourceT], str, Made | _Failed]]:  # fmt: skip
    """Yields each house with its key and its result; complete houses of an earlier import are not made again."""
    todo = iter(works)
    while chunk := list(itertools.islice(todo, CHUNK)):
        keys = [
            hashlib.sha256(f"{VERSION} {options} {work.name} ".encode() + work.content).hexdigest() for work in chunk
        ]
        complete = [
            before.get(work.name, {}).get("key") == key and (out / f"{work.name}.xml").is_file()
            for work, key in zip(chunk, keys, strict=True)
        ]
        new = [work.source for work, done in zip(chunk, complete, strict=True) if not done]
        results = ordered_map(functools.partial(_tried, make), new, workers=workers) if new else iter(())
        for work, key, done in zip(chunk, keys, complete, strict=True):
            yield work, key, _again(before[work.name]) if done else next(results)


def file_works(files: Iterable[Path], used_by: Callable[[Path], Iterable[Path]]) -> Iterator[Work[Path]]:
    """Yields the houses of files, each of which depends on its file and on those that `used_by` returns."""
    for file in files:
        used = [file, *used_by(file)] if file.is_file() else []
        yield Work(file.stem, " ".join(map(_sum_of, used)).encode(), file)


def _sum_of(file: Path) -> str:
    """Returns the hash of a file; "": its reader will refuse it."""
    try:
        return sha256_of(file, what="File") if file.stat().st_size <= MAX_FILE_BYTES else ""
    except (ObjectNavError, OSError, ValueError):
        return ""


def _tried(make: Callable[[SourceT], Made], source: SourceT) -> Made | _Failed:
    try:
        return make(source)
    except ObjectNavError as error:
        return _Failed(str(error))
    except Exception as error:  # data of others can meet any error: it must not end the import of the other houses
        if debug():
            raise
        return _Failed(f"it cannot be imported ({type(error).__name__}: {one_line(str(error), 100)}).")


def _again(report: Mapping[str, object]) -> Made:
    """Returns the result of a house that was imported before."""
    content = {name: value for name, value in report.items() if name not in ("key", "rules")}
    return Made(content, HouseReport.of(report).rules)


def read_reports(out: Path) -> dict[str, dict[str, object]]:
    """Returns the reports of the houses in a folder by name; none if there is no report.

    Raises:
        ConfigError: another program wrote the report.
    """
    file = out / REPORT_FILE
    return read_json(file, dict[str, dict[str, object]], what="Report of an import") if file.is_file() else {}


def write_reports(out: Path, reports: Mapping[str, Mapping[str, object]]) -> None:
    """Writes the reports of the houses in a folder."""
    write_atomically(out / REPORT_FILE, json.dumps(reports, indent=1, ensure_ascii=False) + "\n")


def _write(
    out: Path,
    before: Mapping[str, Mapping[str, object]],
    reports: Mapping[str, Mapping[str, object]],
    rules: Mapping[str, str],
) -> None:
    """Writes the report, with the houses of earlier imports, and the label rules."""
    write_reports(out, {**before, **reports})
    if rules:
        file = labels_of(out)
        old = read_json(file, dict[str, str], what="Label rules") if file is not None else {}
        # Rules for one name come before those for all names with other numbers.
        both = dict(sorted({**old, **rules}.items(), key=lambda rule: r"\d" in rule[0]))
        write_atomically(out / LABELS_FILE, json.dumps(both, indent=1, ensure_ascii=False) + "\n")


def _print_result(reports: Sequence[Mapping[str, object]], failed: int, out: Path) -> None:
    """Prints the sizes of the houses, and how they differ from their sources."""
    total, read = added(reports), [HouseReport.of(report) for report in reports]
    rooms, area_m2 = sum(report.rooms for report in read), sum(report.area_m2 for report in read)
    sizes = f"{counted(len(reports), 'house')} with {counted(rooms, 'room')}"
    lines = [f"{sizes}, {area_m2:.0f} m2, in {out}; {failed} could not be imported."]
    kept = "furniture" if total.boxes else "objects with a category"
    for title, counts in ((kept, total.furniture), ("labelled boxes", total.boxes), ("left out", total.left_out)):
        most = ", ".join(f"{name} {count}" for name, count in counts.most_common(MAX_TYPES))
        more = f" and {len(counts) - MAX_TYPES} more" if len(counts) > MAX_TYPES else ""
        if counts:
            lines.append(f"{title}: {counted(sum(counts.values()), 'object')} ({most}{more})")
    lines += [f"{sentence} ({count} x)" for sentence, count in total.changes.most_common()]
    if total.moved_m > 0.0:
        lines.append(f"Objects were moved by at most {total.moved_m:.2f} m.")
    lines.append(f"{REPORT_FILE} has the counts of each house.")
    console = make_console()
    for line in lines:
        console.print(line, soft_wrap=True)


def _draw(out: Path, name: str) -> None:
    """Draws a house from above, and views of it, next to it in `pictures`."""
    house = load_house(out / f"{name}.xml", labels_path=labels_of(out))
    folder = out / "pictures"
    write_picture(inside(folder, f"{name}_top.png", what="name of a house"), titled(draw_top(house), name))
    views = draw_views(house, 4, least=VIEWS)
    if views is not None:
        write_picture(inside(folder, f"{name}_views.png", what="name of a house"), np.ascontiguousarray(views))
    print(f"Drew {folder / name}_top.png and _views.png.", flush=True)
    categories = read_labels(house.spec.copy().compile(), rules=house.rules).categories()
    if not set(categories) & set(GOAL_CATEGORIES):
        drive = command("web", "--house", out / f"{name}.xml")
        print(f"{name} has no object of a goal category. It has: {', '.join(categories)}. Drive in it: {drive}")
