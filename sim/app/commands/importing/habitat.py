"""Imports houses of Habitat's data sets as a folder of houses: scene data sets, and scans of HM3D and Matterport3D.

    stubborn import habitat hssd-hab --out runs/hssd --houses 5
    stubborn import habitat hm3d/val --out runs/hm3d
    stubborn episodes --split runs/hm3d

Meshes are divided by instance and reduced to --triangles; floors are made flat; collision geoms are boxes of a grid of
5 cm, or convex parts. Rooms become sites, and the names of bodies are labels. With --episodes, Habitat's own ObjectNav
episodes of these houses become the episodes of the split, and import.json lists those that do not fit.

This command needs the extra `import`. It was tested with files in the formats of HM3D and Matterport3D, but not with
real scans.
"""

from __future__ import annotations

import functools
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import tyro

from sim.app.commands.importing.folder import HouseReport, Made, MeshArgs, Work, import_all, read_reports, write_reports
from sim.core.errors import EpisodeError
from sim.core.files import inside, write_together
from sim.core.reading import sha256_of
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

    path: tyro.conf.Positional[Path]
    """A data set or its folder, a scene, a scan (X.semantic.txt, X.house), or a folder of scans."""
    episodes: Path | None = None
    """Habitat's ObjectNav episodes of these houses: a .json.gz file, or a folder with content/*.json.gz."""


def main(args: Args) -> int:
    """Writes the houses, pictures and import.json; returns 1 if a house could not be imported."""
    check_installed()
    sources = find_sources(args.path)[: args.houses]
    scenes = None if args.episodes is None else read_scenes(args.episodes)
    make, options = functools.partial(_make, args.out, args.config), f"habitat {args.config}"
    status = import_all(args, _works(sources), make, total=len(sources), options=options)
    if scenes is not None:
        _write_episodes(args.out, [source.name for source in sources], scenes)
    return status


def _write_episodes(out: Path, names: list[str], scenes: Mapping[str, SceneEpisodes]) -> None:
    """Writes the episodes of the houses as those of the split; prints and reports those that do not fit."""
    reports = read_reports(out)
    fitted: dict[str, Fitted] = {}
    for name in (source for source in names if source in reports and source in scenes):
        task, lowered_m = Task(World(load_house(out / f"{name}.xml"))), HouseReport.of(reports[name]).lowered_m
        fitted[name] = fit_episodes(task, scenes[name], lowered_m)
        reports[name]["episodes"] = dict(fitted[name].report)
    total = Counter[str]()
    for house in fitted.values():
        total.update(house.report)
    other = set(scenes) - set(fitted)
    for sentence, count in sorted(total.items()):
        print(f"{sentence} ({count} x)")
    if other:
        print(f"Episodes of {len(other)} scenes that are not here were left out.")
    write_reports(out, reports)
    episodes = [episode for house in fitted.values() for episode in house.episodes]
    if not episodes:
        raise EpisodeError("No episode of the files fits a house that was imported.")
    write_split(
        out, episodes, {name: house.asks.listed for name, house in fitted.items()}, version=VERSION,
        unreachable={name: house.asks.unreachable for name, house in fitted.items()},
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
