"""Imports houses of Habitat's data sets as a folder of houses: scene data sets, and scans of HM3D and Matterport3D.

    stubborn import habitat hssd-hab --out runs/hssd --houses 5
    stubborn import habitat hm3d/val --out runs/hm3d
    stubborn episodes --split runs/hm3d

Meshes are divided by instance and reduced to --triangles; floors are made flat; what collides are boxes of a grid of
5 cm, or convex parts. Rooms become sites, and the names of bodies are labels. With --episodes, Habitat's own ObjectNav
episodes of these houses become the episodes of the split, and import.json says which of them do not fit.

This command needs the extra `import`. The formats were tested with files that follow their rules; real scans of HM3D
and Matterport3D were not at hand.
"""

from __future__ import annotations

import functools
import json
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from sim.app.commands.importing.folder import REPORT_FILE, Made, MeshArgs, Work, import_all
from sim.core.errors import EpisodeError
from sim.core.files import inside, write_atomically, write_together
from sim.core.reading import read_json, sha256_of
from sim.episodes.splits import write_split
from sim.homes.importers.habitat import Source, find_sources, import_source
from sim.homes.importers.habitat_episodes import Fitted, SceneEpisodes, fit_episodes, read_scenes
from sim.homes.importers.mesh_house import MeshConfig
from sim.homes.importers.surfaces import check_installed
from sim.houses.load import load_house
from sim.task.objectnav import Task
from sim.world.world import World

VERSION = "habitat"
"""Version of a split with Habitat's own episodes."""


@dataclass(frozen=True, kw_only=True)
class Args(MeshArgs):
    """Import houses of Habitat's data sets."""

    path: Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="PATH")]
    """A data set or its folder, a scene, a scan (X.semantic.txt, X.house), or a folder of scans."""
    episodes: Path | None = None
    """Habitat's ObjectNav episodes of these houses: a .json.gz file, or a folder with content/*.json.gz."""


def main(args: Args) -> int:
    """Writes the houses, pictures and import.json; returns 1 if a house could not be imported."""
    check_installed()
    sources = find_sources(args.path)[: args.houses]
    scenes = None if args.episodes is None else read_scenes(args.episodes)
    status = import_all(
        _works(sources), functools.partial(_make, args.out, args.config), args.out, total=len(sources),
        options=f"habitat {args.config}", pictures=args.pictures, workers=args.workers,
    )  # fmt: skip
    if scenes is not None:
        _write_episodes(args.out, [source.name for source in sources], scenes)
    return status


def _write_episodes(out: Path, names: list[str], scenes: Mapping[str, SceneEpisodes]) -> None:
    """Writes the episodes of the houses as those of the split; prints and reports what does not fit."""
    reports = read_json(out / REPORT_FILE, dict[str, dict[str, Any]], what="Report of an import")
    fitted: dict[str, Fitted] = {}
    for name in (each for each in names if each in reports and each in scenes):
        fitted[name] = fit_episodes(
            Task(World(load_house(out / f"{name}.xml"))), scenes[name], reports[name]["lowered_m"]
        )
        reports[name]["episodes"] = dict(fitted[name].report)
    total = Counter[str]()
    for each in fitted.values():
        total.update(each.report)
    other = set(scenes) - set(fitted)
    for sentence, count in sorted(total.items()):
        print(f"{sentence} ({count} x)")
    if other:
        print(f"Episodes of {len(other)} scenes that are not here were left out.")
    write_atomically(out / REPORT_FILE, json.dumps(reports, indent=1, ensure_ascii=False) + "\n")
    episodes = [episode for each in fitted.values() for episode in each.episodes]
    if not episodes:
        raise EpisodeError("No episode of the files fits a house that was imported.")
    write_split(
        out, episodes, {name: each.asks.listed for name, each in fitted.items()}, version=VERSION,
        unreachable={name: each.asks.unreachable for name, each in fitted.items()},
    )  # fmt: skip


def _works(sources: list[Source]) -> Iterator[Work[Source]]:
    for source in sources:
        sums = [sha256_of(file, what="File") for file in source.files()]
        yield Work(source.name, " ".join(sums).encode(), source)


def _make(out: Path, config: MeshConfig, source: Source) -> Made:
    """Writes one house; returns its report."""
    made = import_source(source, config)
    write_together({inside(out, name, what="name of a file"): content for name, content in made.files.items()})
    load_house(out / f"{source.name}.xml")
    return Made(made.report)
