"""Renders a top view of each storey without ceilings and room views of houses, and sheets of all furniture styles.

stubborn gallery --houses assets/mjcf_houses/val/val_00.xml --out runs/gallery
stubborn gallery --house kitchen.xml --labels labels.json --out runs/gallery
stubborn gallery --sheet --pool heldout --categories chair sofa --out runs/gallery
stubborn gallery --sheet --furniture runs/models --categories chair --out runs/gallery
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim.app import cli
from sim.app.commands.house_file import HouseFile
from sim.app.viewers.house_pictures import (
    Picture,
    add_backdrop,
    camera_at,
    draw_top,
    draw_views,
    render,
    storeys,
    titled,
)
from sim.app.viewers.text import BOLD, write
from sim.core.files import write_picture
from sim.core.interface import ConfigError
from sim.core.paths import assets_dir
from sim.core.pictures import tiled
from sim.core.vocabulary import counted, plain
from sim.homes.housegen.furniture import CATALOGUE
from sim.homes.housegen.furniture.catalogue import Catalogue, Style
from sim.homes.housegen.furniture.item import Geom, Item, Look, Pool
from sim.homes.housegen.imported.catalogue import style_of
from sim.homes.housegen.imported.library import read_index
from sim.homes.housegen.mjcf.builder import HouseBuilder, Lamp, PlacedItem
from sim.houses.house import House
from sim.houses.load import load_house

TILE_PX = (320, 320)
MAX_COLUMNS = 6
INK = (50, 50, 50)


@dataclass(frozen=True, kw_only=True)
class Args(HouseFile):
    """Render pictures of houses, or sheets of furniture styles."""

    out: cli.OutFolder
    """Folder for the PNG files; created if missing."""
    houses: tuple[Path, ...] = ()
    """House files; each gives a top view of each storey and a sheet of room views."""

    sheet: bool = False
    """Render every furniture style, one sheet per category."""
    categories: tuple[str, ...] = ()
    """With --sheet: the categories; all if not given."""
    pool: Pool = "train"
    """With --sheet: the pool of the styles."""
    furniture: Path | None = None
    """With --sheet: the models of a folder that `stubborn import furniture` made, instead of the shipped styles."""
    seed: cli.Seed = 0
    """With --sheet: seed of sizes and colours."""


def main(args: Args) -> int:
    """Writes the pictures and prints their paths; returns the exit status."""
    if not (assets_dir() / "textures").is_dir():
        raise ConfigError(f"'{assets_dir() / 'textures'}' is missing; install the package again.")
    if not args.houses and args.house is None and not args.sheet:
        raise ConfigError("gallery needs --houses FILE ..., --house FILE or --sheet.")
    args.check_house()
    if not args.sheet:
        cli.require_unset(args, ("categories", "pool", "furniture", "seed"), "needs --sheet.")
    twice = [name for name, count in Counter(path.stem for path in args.houses).items() if count > 1]
    if twice:
        raise ConfigError(f"Two of --houses are called '{twice[0]}', so that their pictures would have one name.")
    catalogue = CATALOGUE if args.furniture is None else _imported(args.furniture, args.pool)
    sheets = {category: catalogue.styles(category) for category in args.categories or catalogue.categories}
    for path in args.houses:
        _draw_house(args.out, load_house(path))
    if args.house is not None:
        _draw_house(args.out, args.load())
    if args.sheet:
        for category, styles in sheets.items():
            of_pool = [style for style in styles if style.pool == args.pool]
            if of_pool:
                copies, name = (2, args.pool) if args.furniture is None else (1, "imported")
                sheet = draw_sheet(of_pool, np.random.default_rng(args.seed), copies, catalogue)
                title = f"{plain(category)}: {counted(len(of_pool), 'style')}, {name}"
                _save(args.out / f"sheet_{name}_{category}.png", titled(sheet, title))
    return 0


def _draw_house(out: Path, house: House) -> None:
    """Writes the pictures of a house."""
    parts = storeys(house)
    for number, storey in enumerate(parts):
        which = f", storey {number + 1} of {len(parts)}" if len(parts) > 1 else ""
        picture = titled(draw_top(storey), f"{house.name}{which}, from above")
        _save(out / f"{house.name}_top{f'_{number}' if number else ''}.png", picture)
    views = draw_views(house)
    if views is None:
        print(f"House '{house.name}' has no room and no labelled object to look at: there are no views.")
    else:
        _save(out / f"{house.name}_views.png", titled(views, f"{house.name}, as the robot sees it"))


def _imported(folder: Path, pool: Pool) -> Catalogue:
    """Returns a catalogue of imported models only, ordered by what they are used for."""
    models = sorted(read_index(folder), key=lambda model: (model.uses, model.name))
    return Catalogue(style_of(folder, model, pool) for model in models)


def draw_sheet(
    styles: Sequence[Style], rng: np.random.Generator, copies: int = 2, catalogue: Catalogue = CATALOGUE
) -> Picture:
    """Renders `copies` items of each of these styles, tiled, (h, w, 3) RGB."""
    tiles = []
    for style in styles:
        for _ in range(copies):
            item = catalogue.make_item(style.category, rng, pool=style.pool, style=style.name)
            tile = np.ascontiguousarray(_portrait(item))
            deep, wide, high = item.size_m
            write(tile, style.name.replace("_", " "), (8, 22), TILE_PX[0] - 16, 17, INK, BOLD)
            write(tile, f"{wide:.2f} m wide, {deep:.2f} m deep, {high:.2f} m high", (8, 40), TILE_PX[0] - 16, 14, INK)
            tiles.append(tile)
    return tiled(tiles, min(MAX_COLUMNS, len(tiles)))


def _portrait(item: Item) -> Picture:
    """Renders one item on a plain ground, from its front and a little above."""
    builder = HouseBuilder("portrait")
    z = {"floor": 0.0, "top": 0.0, "wall": 0.05, "ceiling": item.size_m[2]}[item.mount]
    slab = Geom("box", (3.0, 3.0, 0.01), (0.0, 0.0, -0.011), Look((0.8, 0.8, 0.78, 1.0)))
    builder.add(PlacedItem(item, 0.0, 0.0, z))
    builder.add(PlacedItem(Item("floor", "ground", (6.0, 6.0, 0.0), (slab,))))
    builder.add_lamp(Lamp((2.0, 1.0, 3.0), (0.55, 0.55, 0.53), (-0.6, -0.35, -0.9)))
    builder.add_lamp(Lamp((2.0, -1.0, 2.0), (0.2, 0.2, 0.22), (-0.5, 0.8, -0.3)))
    add_backdrop(builder.spec)
    size = np.array(item.size_m)
    centre = np.array([0.0 if item.mount != "wall" else size[0] / 2, 0.0, z + size[2] / 2])
    if item.mount == "ceiling":
        centre[2] = size[2] / 2
    camera = camera_at(centre, azimuth_deg=205.0, elevation_deg=-18.0)
    camera.distance = 1.75 * float(np.linalg.norm(size)) + 0.1
    return render(builder.spec.compile(), camera, TILE_PX, fovy_deg=38.0)


def _save(path: Path, picture: Picture) -> None:
    write_picture(path, picture)
    print(path)
