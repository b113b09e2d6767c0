"""Imports houses of MolmoSpaces as a folder of houses, with labels from their metadata.

    stubborn import molmospaces scenes/procthor-10k-train --out runs/molmospaces --houses 20
    stubborn episodes --split runs/molmospaces

Each house becomes one MJCF file with its meshes and textures next to it. Rooms become sites, hinged doors are opened,
the floor comes to z = 0, and labels.json has rules for the names. Objects with free joints stay movable.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from sim import cli
from sim.commands.importing.folder import Made, Work, import_all
from sim.files import inside, write_together
from sim.houses.house import House
from sim.houses.load import validate_house
from sim.houses.mjcf import read_spec
from sim.houses.references import files_of, require_root
from sim.importers.molmospaces import find_houses, import_scene, metadata_file, name_of
from sim.importers.procthor import Doors
from sim.reading import sha256_of


@dataclass(frozen=True, kw_only=True)
class Args:
    """Import houses of MolmoSpaces."""

    path: Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="PATH")]
    """A house file, or a folder of them with their metadata."""
    out: cli.OutFolder
    """Folder of the houses; created if missing."""
    root: Path | None = None
    """A folder whose files the houses may use in addition to their own folder: that of the shared assets."""
    houses: cli.Count | None = None
    """Import only the first houses."""
    doors: Doors = "open"
    """Hinged doors are opened, at most to a right angle, or stay as they are."""
    pictures: cli.Amount = 3
    """Draw the first houses from above, and views of them."""
    workers: cli.Count = 1
    """Number of processes."""


def main(args: Args) -> int:
    """Writes the houses, labels.json, pictures and import.json; returns 1 if a house could not be imported."""
    require_root(args.root)
    files = find_houses(args.path)[: args.houses]
    make = functools.partial(_make, args.out, args.doors, args.root)
    return import_all(
        _works(files, args.root), make, args.out, total=len(files), options=f"molmospaces {args.doors}",
        pictures=args.pictures, workers=args.workers,
    )  # fmt: skip


def _works(files: list[Path], root: Path | None) -> Iterator[Work[Path]]:
    for file in files:
        used = [file, metadata_file(file), *files_of(file, root)] if file.is_file() else []
        sums = [sha256_of(each, what="File") for each in used if each.is_file()]
        yield Work(name_of(file), " ".join(sums).encode(), file)


def _make(out: Path, doors: Doors, root: Path | None, file: Path) -> Made:
    """Writes one house; returns its report and rules."""
    scene = import_scene(file, doors=doors, root=root)
    write_together({inside(out, name, what="name of a file"): content for name, content in scene.files.items()})
    written = out / f"{name_of(file)}.xml"
    spec = read_spec(written)
    validate_house(House(name_of(file), spec, scene.rules, written), spec.compile())
    return Made(scene.report, scene.rules)
