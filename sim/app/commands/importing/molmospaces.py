"""Imports houses of MolmoSpaces as a folder of houses, with labels from their metadata.

    stubborn import molmospaces scenes/procthor-10k-train --out runs/molmospaces --houses 20
    stubborn episodes --split runs/molmospaces

Each house becomes one MJCF file; its meshes and textures are in the folder `files`, which the houses share. Rooms
become sites, hinged doors are opened, the floor comes to z = 0, and labels.json has rules for the names. Objects with
free joints stay movable.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from pathlib import Path

import tyro

from sim.app.commands.importing.folder import Made, SceneArgs, file_works, import_all
from sim.homes.importers.molmospaces import find_houses, import_scene, metadata_file, name_of
from sim.homes.importers.procthor import Doors
from sim.homes.importers.scenes import write_scene
from sim.houses.references import files_of, require_root


@dataclass(frozen=True, kw_only=True)
class Args(SceneArgs):
    """Import houses of MolmoSpaces."""

    path: tyro.conf.Positional[Path]
    """A house file, or a folder of them with their metadata."""
    doors: Doors = "open"
    """Hinged doors are opened, at most to a right angle, or stay as they are."""


def main(args: Args) -> int:
    """Writes the houses, labels.json, pictures and import.json; returns 1 if a house could not be imported."""
    require_root(args.root)
    files = find_houses(args.path)[: args.houses]
    works = file_works(files, lambda file: [metadata_file(file), *files_of(file, args.root)])
    works = (replace(work, name=name_of(work.source)) for work in works)
    options = f"molmospaces {args.doors} {args.texture_px} {args.pack}"
    return import_all(args, works, functools.partial(_make, args), total=len(files), options=options)


def _make(args: Args, file: Path) -> Made:
    """Writes one house; returns its report and rules."""
    scene = import_scene(file, doors=args.doors, root=args.root, texture_px=args.texture_px)
    write_scene(args.out, scene, pack=args.pack)
    return Made(scene.report, scene.rules)
