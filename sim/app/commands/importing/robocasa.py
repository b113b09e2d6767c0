"""Imports kitchens of RoboCasa, and other kitchens in MJCF, as a folder of houses.

    stubborn import robocasa kitchens --root robocasa/models/assets --out runs/robocasa
    stubborn episodes --split runs/robocasa

Each kitchen becomes one MJCF file; its meshes and textures are in the folder `files`. Fixtures get their categories by
their names; a robot in the file is removed; floors become rooms. `import.json` lists what was changed. A saved
environment (`env.sim.model.get_xml()`) names its files by absolute paths: give their folder with --root.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from pathlib import Path

import tyro

from sim.app.commands.importing.folder import Made, SceneArgs, file_works, import_all
from sim.homes.importers.robocasa import find_scenes, import_kitchen
from sim.homes.importers.scenes import write_scene
from sim.houses.references import files_of, require_root


@dataclass(frozen=True, kw_only=True)
class Args(SceneArgs):
    """Import kitchens of RoboCasa, and other kitchens in MJCF."""

    path: tyro.conf.Positional[Path]
    """An MJCF file, or a folder of them."""


def main(args: Args) -> int:
    """Writes the houses, labels.json, pictures and import.json; returns 1 if a house could not be imported."""
    require_root(args.root)
    files = find_scenes(args.path)[: args.houses]
    works = file_works(files, lambda file: files_of(file, args.root))
    options = f"robocasa {args.texture_px} {args.pack}"
    return import_all(args, works, functools.partial(_make, args), total=len(files), options=options)


def _make(args: Args, file: Path) -> Made:
    """Writes one house; returns its report and rules."""
    scene = import_kitchen(file, root=args.root, texture_px=args.texture_px)
    write_scene(args.out, scene, pack=args.pack)
    return Made(scene.report, scene.rules)
