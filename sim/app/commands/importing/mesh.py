"""Imports a home that is one GLB, glTF, OBJ or PLY file as a house.

    stubborn import mesh flat.glb --out runs/flat
    stubborn import mesh flat.glb --categories runs/flat/categories/flat.json --out runs/flat
    stubborn episodes --split runs/flat

The first command proposes the category of each node from its name, its material or its size, and writes them to the
folder `categories`. Edit them, and give the file with --categories. Objects collide as boxes of a grid of 5 cm, or as
convex parts; floors are flat. This command needs the extra `import`.
"""

from __future__ import annotations

import functools
import json
from dataclasses import dataclass
from pathlib import Path

import tyro

from sim.app.commands.importing.folder import Made, MeshArgs, file_works, import_all
from sim.core.files import inside, write_together
from sim.homes.importers.mesh import Axis, files_of, find_files, import_mesh
from sim.homes.importers.surfaces import check_installed
from sim.houses.house import House
from sim.houses.load import compiled, read_rules, validate_house
from sim.houses.mjcf import read_spec

TABLES = "categories"
"""Folder of the tables of categories."""


@dataclass(frozen=True, kw_only=True)
class Args(MeshArgs):
    """Import homes that are one mesh each."""

    path: tyro.conf.Positional[Path]
    """A .glb, .gltf, .obj or .ply file, or a folder of them; lengths are metres."""
    categories: Path | None = None
    """A JSON file {"regex over node names": "category"}; nodes of the category "void" are left out."""
    up: Axis = "auto"
    """The axis that points up; by default z in PLY files and y in others, or the one with a level floor."""


def main(args: Args) -> int:
    """Writes the houses, their tables, pictures and import.json; returns 1 if a house could not be imported."""
    check_installed()
    rules = {} if args.categories is None else read_rules(args.categories)
    files = find_files(args.path)[: args.houses]
    works = file_works(files, files_of)
    options = f"mesh {args.config} {args.up} {json.dumps(rules)}"
    return import_all(args, works, functools.partial(_make, args, rules), total=len(files), options=options)


def _make(args: Args, rules: dict[str, str], file: Path) -> Made:
    """Writes one house and its table; returns its report."""
    scene = import_mesh(file, rules=rules, up=args.up, config=args.config)
    files = {inside(args.out, name, what="name of a file"): content for name, content in scene.house.files.items()}
    table = inside(args.out / TABLES, f"{file.stem}.json", what="name of a house")
    write_together({**files, table: json.dumps(dict(scene.table), indent=1, ensure_ascii=False) + "\n"})
    written = args.out / f"{file.stem}.xml"
    spec = read_spec(written)
    validate_house(House(file.stem, spec, None, written), compiled(spec))
    return Made(scene.house.report)
