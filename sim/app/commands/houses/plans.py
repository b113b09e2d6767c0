"""Writes the plans of houses for the 2-D environment (docs/explorers.md): one npz file for each storey.

    stubborn houses plans --split val --out runs/plans/val --workers 2
    stubborn houses plans --pool train --first-seed 0 --houses 500 --out runs/plans/many --workers 2
    stubborn houses plans --pool train --kind large --area-m2 280 --houses 50 --out runs/plans/large

Houses of a split are read, houses of a pool are generated from consecutive seeds; those of pool `train` use styles and
textures that no house of val, test, large or hazards has. Existing plans are kept, so that the same command resumes a
killed run; a plan that was made with other options or by another generator is refused.
"""

from __future__ import annotations

import functools
import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from sim.app import cli
from sim.app.commands.houses.area import Area
from sim.app.evaluation.parallel import Shard, ordered_map
from sim.core.errors import ConfigError, HouseError
from sim.core.paths import assets_dir
from sim.core.reading import Json
from sim.core.vocabulary import counted
from sim.episodes.splits import load_split
from sim.gl import mujoco
from sim.homes.housegen.config import shown_area
from sim.homes.housegen.floor_plan.rooms import PlanKind
from sim.homes.housegen.furniture.item import Pool
from sim.homes.housegen.generator import GENERATOR_VERSION, HouseConfig, generate_house
from sim.homes.plans.export import export_plans
from sim.homes.plans.plan import read_plan, write_plan
from sim.houses.house import House
from sim.houses.writing import house_text


@dataclass(frozen=True, kw_only=True)
class Args:
    """Write the plans of houses, for training and tests in the 2-D environment."""

    out: cli.OutFolder
    """Folder for the npz files; created if missing."""
    split: str | None = None
    """Name or folder of a split whose houses are exported."""
    houses: cli.Count | None = None
    """Number of houses; by default all of the split, or 1."""
    workers: cli.Count = 1
    """Number of processes."""
    shard: str | None = None
    """Part of the work, "i/n", for several machines."""
    pool: Pool = "train"
    """Without a split: styles and textures that may appear."""
    first_seed: cli.Seed = 0
    """Without a split: the first of consecutive seeds."""
    kind: PlanKind | None = None
    """Without a split: kind of floor plan; sampled when not given."""
    area_m2: Area = None
    """Without a split: floor area such as 90, or a range such as 80:120; sampled when not given."""


@dataclass(frozen=True)
class Exported:
    """The result of one house."""

    name: str
    summary: str
    seconds: float = 0.0
    """Processor time; 0: the plan existed."""
    failed: bool = False


def main(args: Args) -> int:
    """Writes the plans; returns 1 if a house gave no plan."""
    if args.split is not None:
        cli.require_unset(
            args, ("pool", "first_seed", "kind", "area_m2"), "is for generated houses: leave out --split."
        )
    houses, results = _exported(args), []
    args.out.mkdir(parents=True, exist_ok=True)
    for exported in houses:
        results.append(exported)
        print(f"{exported.name}: {exported.summary}", flush=True)
    times = [exported.seconds for exported in results if exported.seconds]
    median = f", median {statistics.median(times):.1f} s each" if times else ""
    print(f"{counted(len(results), 'house')}, {len(times)} exported now{median}")
    return int(any(exported.failed for exported in results))


def _exported(args: Args) -> Iterator[Exported]:
    """Exports the houses that the options name."""
    shard = Shard.parse(args.shard) if args.shard else Shard()
    if args.split is not None:
        split = load_split(args.split)
        names = cli.first_of(list(split.houses), args.houses, option="--houses", source=f"split '{args.split}'")
        export = functools.partial(_export_named, args.out, args.split, split.version)
        return ordered_map(export, shard.select(names), workers=args.workers)
    config = HouseConfig(pool=args.pool, kind=args.kind, area_m2=args.area_m2)
    seeds = range(args.first_seed, args.first_seed + (args.houses or 1))
    return ordered_map(functools.partial(_export_seed, args.out, config), shard.select(seeds), workers=args.workers)


def _export_named(out: Path, split: str, version: str, name: str) -> Exported:
    """Exports one house of a split."""
    return _export(out, name, {"split": split, "version": version}, lambda: load_split(split).load_house(name))


def _export_seed(out: Path, config: HouseConfig, seed: int) -> Exported:
    """Generates the house of a seed and exports it."""
    area_m2 = shown_area(config.area_m2) if isinstance(config.area_m2, tuple) else config.area_m2
    source: dict[str, Json] = {"pool": config.pool, "kind": config.kind, "area_m2": area_m2, "seed": seed}
    source |= {"generator": GENERATOR_VERSION, "exact": config.exact}
    return _export(out, name_of(config, seed), source, lambda: house_of(config, seed))


def name_of(config: HouseConfig, seed: int) -> str:
    """Returns the name of a generated house."""
    return f"{config.pool}_{config.kind or 'any'}_{seed:06d}"


def house_of(config: HouseConfig, seed: int) -> House:
    """Returns the house of a seed.

    Raises:
        HouseError: no house can be generated from it.
    """
    text = house_text(generate_house(seed, config).spec, str(assets_dir() / "textures"))
    return House(name_of(config, seed), mujoco.MjSpec.from_string(text))


def _export(out: Path, name: str, source: dict[str, Json], make: Callable[[], House]) -> Exported:
    """Writes the plans of the house that `make` returns; the lowest storey's is last and marks that all are written.

    Raises:
        ConfigError: there is a plan of that name from another source.
    """
    file = out / f"{name}.npz"
    if file.is_file():
        known = read_plan(file).source
        if known != {key: source.get(key) for key in known}:  # older plans do not name their generator
            raise ConfigError(f"'{file}' was made with other options ({known}, not {source}); take another --out.")
        return Exported(name, "exists")
    began_s = time.process_time()
    try:
        plans = list(export_plans(make(), source))
    except HouseError as error:
        return Exported(name, f"no plan: {error}", failed=True)
    for plan in reversed(plans):
        write_plan(out / f"{plan.name}.npz", plan)
    if not plans:
        return Exported(name, "no plan: it has no free space", failed=True)
    free_m2 = sum(plan.free.sum() * plan.frame.cell_m**2 for plan in plans)
    seconds = time.process_time() - began_s
    counts = f"{counted(len(plans), 'storey')}, {counted(len(plans[0].goals()), 'goal')}"
    summary = f"{free_m2:.0f} m2 of free space, {counts}, {seconds:.1f} s"
    return Exported(name, summary, seconds)
