"""Generates the houses of a split, or of any seeds; prints houses per second of one core and rejected tries.

The houses of most splits are written as MJCF files, those of train and large-test as a list with their checksums:
    stubborn houses generate --split val --out assets/mjcf_houses/val --workers 2
    stubborn houses generate --split train --out assets/mjcf_houses/train --workers 2
Houses of other seeds:
    stubborn houses generate --first-seed 0 --houses 5 --pool train --out /tmp/houses
    stubborn houses generate --area-m2 100:140 --rooms gym office --hazards glass slab --out /tmp/houses
    stubborn houses generate --kind estate --storeys 2 --out /tmp/houses
Houses with models that `stubborn import furniture` has imported, and the ten houses of the transfer test:
    stubborn houses generate --furniture runs/models --houses 5 --out /tmp/houses
    stubborn houses generate --furniture runs/models --transfer-test --out runs/transfer

The houses of a split use the folder `textures` next to the split's folder, other houses a folder `textures` in their
own folder; it is created if it is missing. The houses of a list are kept in the cache of `sim.episodes.house_list`,
where `stubborn episodes` reads them.
"""

from __future__ import annotations

import functools
import hashlib
import itertools
import statistics
import sys
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Literal

from sim.app import cli
from sim.app.commands.houses.area import Area
from sim.app.evaluation.parallel import ordered_map
from sim.core.errors import HouseError
from sim.core.files import write_atomically
from sim.core.interface import ConfigError
from sim.core.invocation import command
from sim.core.paths import cache_dir
from sim.core.vocabulary import counted
from sim.episodes.house_list import copy_textures, write_house_list
from sim.homes.housegen.floor_plan.rooms import PlanKind
from sim.homes.housegen.furniture import CATALOGUE
from sim.homes.housegen.furniture.item import Pool
from sim.homes.housegen.generator import HouseConfig, generate_house
from sim.homes.housegen.imported.catalogue import ImportedFurniture
from sim.homes.housegen.imported.library import ModelSplit
from sim.homes.housegen.imported.transfer import TRANSFER_TEST
from sim.homes.housegen.splits.recipes import (
    LISTED,
    MAX_TRAIN_SEEDS,
    SPLIT_VERSION,
    SPLITS,
    TRAIN_HOUSES,
    Recipe,
    train_recipe,
)
from sim.homes.housegen.withheld import Withheld, restricted
from sim.houses.references import SHARED_TEXTURES
from sim.houses.writing import house_text


@dataclass(frozen=True, kw_only=True)
class Args:
    """Generate the houses of a split or of any seeds."""

    out: cli.OutFolder
    """Folder for the XML files (for train and large-test: for the list); created if missing."""
    split: str | None = None
    """Name of a shipped split (val, large-test, train, ...), whose recipes define seeds, plan kinds and sizes."""
    houses: cli.Count | None = None
    """Number of houses; by default all of the split, or 1."""
    workers: cli.Count = 1
    """Number of processes."""
    first_seed: cli.Seed = 0
    """Without a split: the first of consecutive seeds."""
    pool: Pool = "train"
    """Without a split: styles and textures that may appear."""
    withheld: Withheld | None = None
    """Without a split: without leaves out the styles that `stubborn views` withholds; only prefers these."""
    kind: PlanKind | None = None
    """Without a split: kind of floor plan; sampled when not given."""
    area_m2: Area = None
    """Without a split: floor area of the ground storey such as 90, met to within 5 %, or a range such as 80:120;
    sampled when not given."""
    rooms: tuple[str, ...] = ()
    """Without a split: rooms that each house has at least, such as gym or office; two bathrooms: bathroom bathroom."""
    storeys: Literal[1, 2] = 1
    """Without a split: number of storeys."""
    hazards: tuple[str, ...] = ()
    """Without a split: families of hazards (glass, slab, overhang, legs, scan, loose, door)."""
    clutter: cli.Share | None = None
    """Without a split: 0 without small objects to 1 with many; sampled when not given."""
    movable: bool = False
    """Without a split: whether light furniture can be pushed."""
    furniture: Path | None = None
    """Without a split: folder of imported models (`stubborn import furniture`) that furnish the houses as well."""
    furniture_split: ModelSplit = "train"
    """With --furniture: train adds models to our own styles, transfer replaces our own by the models kept apart."""
    only_imported: bool = False
    """With --furniture: the models of train also replace our own styles."""
    transfer_test: bool = False
    """With --furniture: the houses of the transfer test."""


@dataclass(frozen=True)
class Made:
    """A generated house as text, or the error."""

    name: str
    text: str = ""
    error: str = ""
    summary: str = ""
    """Kind of plan, size and number of tries."""
    rejects: tuple[str, ...] = ()
    seconds: float = 0.0
    """Processor time."""


def main(args: Args) -> int:
    """Writes the houses; returns 1 if a requested seed gave no house."""
    if args.split is not None and (args.furniture is not None or args.transfer_test):
        raise ConfigError("A shipped split has no imported furniture: leave out --split, or --furniture.")
    if args.furniture is None:
        made_by = f"needs --furniture, a folder that `{command('import', 'furniture')}` made."
        cli.require_unset(args, ("transfer_test", "only_imported", "furniture_split"), made_by)
    if args.split is not None or args.transfer_test:
        set_here = {field.name for field in fields(args)} - {
            "out",
            "split",
            "houses",
            "workers",
            "furniture",
            "transfer_test",
        }
        of = f"--split {args.split}" if args.split else "--transfer-test"
        cli.require_unset(args, set_here, f"has no effect with {of}, whose recipes set it.")
    began_s = time.perf_counter()
    if args.split in LISTED:
        made = list(_write_list(args, args.split))
    elif args.split is not None:
        made = list(_write_split(args, args.split))
    elif args.transfer_test:
        made = list(_write_transfer_test(args))
    else:
        made = list(_write_seeds(args))
    _print_summary(made, time.perf_counter() - began_s)
    return int(args.split != "train" and any(house.error for house in made))


def _write_split(args: Args, split: str) -> Iterator[Made]:
    """Writes the houses of a split that is shipped as files."""
    if split not in SPLITS:
        raise ConfigError(f"No split '{split}'. Available: {', '.join(SPLITS)}, train.")
    recipes = cli.first_of(SPLITS[split], args.houses, option="--houses", source=f"split '{split}'")
    textures = args.out.resolve().parent / "textures"
    if not textures.is_dir():
        copy_textures(textures)
    yield from _written(args, ordered_map(_make, recipes, workers=args.workers))


def _write_list(args: Args, split: str) -> Iterator[Made]:
    """Writes the list of a split's houses; the generated houses are kept in the cache."""
    folder = cache_dir() / SPLIT_VERSION / split
    copy_textures(folder.parent / "textures")
    candidates = map(train_recipe, range(MAX_TRAIN_SEEDS)) if split == "train" else SPLITS[split]
    recipes = {recipe.name: recipe for recipe in candidates}
    target, listed = args.houses or (TRAIN_HOUSES if split == "train" else len(recipes)), []
    waiting = iter(recipes.values())
    while len(listed) < target:
        batch = list(itertools.islice(waiting, target - len(listed)))
        if not batch:
            raise HouseError(f"Only {len(listed)} of {len(recipes)} seeds of {split} gave a house; {target} are asked.")
        for made in ordered_map(_make, batch, workers=args.workers):
            _print_house(made)
            if made.text:
                content = made.text.encode("utf-8")
                write_atomically(folder / f"{made.name}.xml", content)
                listed.append((recipes[made.name], hashlib.sha256(content).hexdigest()))
            yield made
    write_house_list(args.out, listed, version=SPLIT_VERSION)


def _write_seeds(args: Args) -> Iterator[Made]:
    """Writes houses of consecutive seeds, and the textures into a folder next to them."""
    config = HouseConfig(
        pool=args.pool, kind=args.kind, area_m2=args.area_m2, rooms=args.rooms, storeys=args.storeys,
        hazards=args.hazards, clutter=args.clutter, movable=args.movable,
    )  # fmt: skip
    furniture = None if args.furniture is None else _imported(args)
    if furniture is not None:
        furniture.catalogue(config.pool)  # raises before anything is written
    copy_textures(args.out / SHARED_TEXTURES)
    make = functools.partial(_make_seed, config, furniture, args.withheld)
    seeds = range(args.first_seed, args.first_seed + (args.houses or 1))
    yield from _written(args, ordered_map(make, seeds, workers=args.workers))


def _imported(args: Args) -> ImportedFurniture:
    assert args.furniture is not None
    return ImportedFurniture(args.furniture, args.furniture_split, alone=args.only_imported)


def _write_transfer_test(args: Args) -> Iterator[Made]:
    """Writes the houses of the transfer test, and the textures into a folder next to them."""
    assert args.furniture is not None
    recipes = cli.first_of(TRANSFER_TEST, args.houses, option="--houses", source="the transfer test")
    furniture = ImportedFurniture(args.furniture, "transfer")
    make = functools.partial(_make, textures=SHARED_TEXTURES, furniture=furniture)
    copy_textures(args.out / SHARED_TEXTURES)
    yield from _written(args, ordered_map(make, recipes, workers=args.workers))


def _written(args: Args, houses: Iterable[Made]) -> Iterator[Made]:
    """Writes houses and yields them again."""
    for made in houses:
        _print_house(made)
        if made.text:
            write_atomically(args.out / f"{made.name}.xml", made.text)
        yield made


def _make(recipe: Recipe, textures: str | None = None, furniture: ImportedFurniture | None = None) -> Made:
    """Generates the house of a recipe."""
    return _generate(recipe.name, recipe.seed, recipe.config(), textures, furniture)


def _make_seed(config: HouseConfig, furniture: ImportedFurniture | None, withheld: Withheld | None, seed: int) -> Made:
    """Generates the house of a seed."""
    return _generate(f"house_{seed:05d}", seed, config, SHARED_TEXTURES, furniture, withheld)


def _generate(
    name: str,
    seed: int,
    config: HouseConfig,
    textures: str | None,
    furniture: ImportedFurniture | None = None,
    withheld: Withheld | None = None,
) -> Made:
    """Generates one house, and measures the time."""
    began_s = time.process_time()
    try:
        if furniture is None:
            house = generate_house(seed, config, restricted(CATALOGUE, withheld))
        else:
            house = furniture.make_house(seed, config, withheld=withheld)
    except HouseError as error:
        return Made(name, error=str(error), seconds=time.process_time() - began_s)
    seconds = time.process_time() - began_s
    plan = house.plan
    below = " below" if config.storeys == 2 else ""
    size = f"{plan.area_m2:.0f} m2{below}, {counted(len(plan.rooms), 'room')}{below}"
    summary = f"{plan.kind}, {size}, {len(house.spec.geoms)} geoms" + f", {house.tries} tries" * (house.tries > 1)
    return Made(name, house_text(house.spec, textures), "", summary, house.rejects, seconds)


def _print_house(made: Made) -> None:
    """Prints the line of one house."""
    if made.error:
        print(f"{made.name}: {made.error}", file=sys.stderr)
        return
    print(f"{made.name}: {made.summary}, {len(made.text) / 1000:.0f} KB, {made.seconds:.2f} s", flush=True)
    for reason in made.rejects:
        print(f"    rejected: {reason}")


def _print_summary(made: list[Made], took_s: float) -> None:
    """Prints the speed and the number of rejected tries."""
    good = [house for house in made if house.text]
    if good:
        seconds = [house.seconds for house in good]
        rejected = sum(len(house.rejects) for house in good)
        print(
            f"{counted(len(good), 'house')}, median {statistics.median(seconds):.2f} s each on one core, "
            f"{len(good) / sum(seconds):.2f} houses/s of one core, {len(good) / took_s:.2f} houses/s in total; "
            f"{counted(rejected, 'try', 'tries')} rejected, "
            f"{counted(len(made) - len(good), 'seed')} without a house"
        )
