"""Imports houses of ProcTHOR as a folder of houses: rooms, walls, doors, windows, and our furniture in their sizes.

    stubborn import procthor train.jsonl.gz --out runs/procthor --houses 20
    stubborn episodes --split runs/procthor
    stubborn run --split runs/procthor

ProcTHOR's meshes are not available outside of Unity. Each object becomes a piece of our furniture of the same category
in the size of its asset, or a labelled box; `import.json` lists which. The sizes are in ProcTHOR's asset database
(procthor/databases/asset-database.json), which must lie next to the houses or be given with --assets.

A house that was imported before from the same data with the same options is not made again.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import tyro

from sim.app import cli
from sim.app.commands.importing.folder import ImportArgs, Made, Work, import_all
from sim.core.files import inside
from sim.core.reading import open_plain, sha256_of
from sim.homes.housegen.furniture.item import Pool
from sim.homes.importers.procthor import Doors, ProcthorConfig, import_house
from sim.homes.importers.procthor_files import Asset, Source, find_assets, read_assets, read_houses
from sim.houses.writing import write_house


@dataclass(frozen=True, kw_only=True)
class Args(ImportArgs):
    """Import houses of ProcTHOR."""

    path: tyro.conf.Positional[Path]
    """A .json file of one house, or a .jsonl file of one house a line; both may be gzipped."""
    assets: Path | None = None
    """The asset database; by default asset-database.json or asset-database.json.gz next to PATH."""
    doors: Doors = "open"
    """Inner doors are opened to a right angle, or stay as they are in the source."""
    pool: Pool = "heldout"
    """Styles, colours and textures of the furniture."""
    seed: cli.Seed = 0
    """Seed of styles and colours."""


def main(args: Args) -> int:
    """Writes the houses, pictures and import.json; returns 1 if a house could not be imported."""
    open_plain(args.path, what="Houses").close()  # a pointer of Git LFS, for example, is named before its neighbours
    database = find_assets(args.path, args.assets)
    config = ProcthorConfig(doors=args.doors, pool=args.pool, seed=args.seed)
    options = f"procthor {config} {sha256_of(database, what='Asset database')}"
    works, make = itertools.islice(_works(args.path), args.houses), functools.partial(_make, args.out, database, config)
    return import_all(args, works, make, total=args.houses, options=options)


def _works(path: Path) -> Iterator[Work[Source]]:
    for source in read_houses(path):
        yield Work(source.name, source.content, source, source.share)


def _make(out: Path, database: Path, config: ProcthorConfig, source: Source) -> Made:
    """Writes one house; returns its report."""
    inside(out, f"{source.name}.xml", what="name of a house")
    made = import_house(source, _assets(database), config)
    write_house(made.spec, out, source.name)
    return Made(made.report)


@functools.cache
def _assets(database: Path) -> dict[str, Asset]:
    """Returns the asset database, which each process reads once."""
    return dict(read_assets(database))
