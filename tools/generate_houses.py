"""Write the houses of a split, or of any seeds, as MJCF files; prints houses a second (of one core) and rejected tries.

The shipped val houses:
    python tools/generate_houses.py --split val --out assets/mjcf_houses/val
Any other ones:
    python tools/generate_houses.py --first-seed 0 --houses 5 --pool train --out /tmp/houses
"""

from __future__ import annotations

import os
import statistics
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import tyro

from sim.errors import HouseError
from sim.houses.build import ASSETS_DIR
from sim.houses.furniture.item import Pool
from sim.houses.generator import GeneratedHouse, HouseConfig, generate_house
from sim.houses.rooms import PlanKind
from sim.houses.splits import SPLITS
from sim.houses.writing import house_text
from sim.interface import ConfigError


@dataclass(frozen=True, kw_only=True)
class Args:
    """What to write and where."""

    out: Path
    """Folder for the XML files; made if missing."""
    split: str | None = None
    """Name of a shipped split; its table fixes seeds, shapes and sizes."""
    houses: int | None = None
    """How many: all of the split, or 1 seed, when not given."""
    first_seed: int = 0
    """Without a split: the first of consecutive seeds."""
    pool: Pool = "train"
    """Without a split: which styles and textures may appear."""
    kind: PlanKind | None = None
    """Without a split: shape of the floor plan; drawn when not given."""
    area_m2: float | None = None
    """Without a split: floor area; drawn when not given."""
    clutter: float | None = None
    """Without a split: 0 bare to 1 full; drawn when not given."""
    movable: bool = False
    """Without a split: light furniture can be pushed."""


def main(args: Args) -> int:
    """Write the houses; the number of seeds that gave none is the exit status."""
    args.out.mkdir(parents=True, exist_ok=True)
    failed, seconds = 0, []
    for name, make in _jobs(args):
        began = time.process_time()
        try:
            house = make()
        except HouseError as error:
            failed += 1
            print(f"{name}: {error}", file=sys.stderr)
            continue
        seconds.append(time.process_time() - began)
        size_kb = _write(house, args.out / f"{name}.xml")
        print(_line(name, house, seconds[-1], size_kb))
        for reason in house.rejects:
            print(f"    rejected: {reason}")
    if seconds:
        print(
            f"{len(seconds)} houses, median {statistics.median(seconds):.2f} s each, "
            f"{len(seconds) / sum(seconds):.2f} houses/s, {failed} seeds failed"
        )
    return failed


def _jobs(args: Args):
    if args.split is not None:
        if args.split not in SPLITS:
            raise ConfigError(f"No split '{args.split}'. There is: {', '.join(SPLITS)}.")
        return [(recipe.name, recipe.make) for recipe in SPLITS[args.split][: args.houses]]
    config = HouseConfig(
        pool=args.pool, kind=args.kind, area_m2=args.area_m2, clutter=args.clutter, movable=args.movable
    )
    seeds = range(args.first_seed, args.first_seed + (args.houses or 1))
    return [(f"house_{seed:05d}", lambda seed=seed: generate_house(seed, config)) for seed in seeds]


def _write(house: GeneratedHouse, path: Path) -> float:
    """Write a house whose textures are found from where it lies; returns kilobytes."""
    textures = os.path.relpath(ASSETS_DIR / "textures", path.parent.resolve())
    xml = house_text(house.spec, textures)
    path.write_text(xml, encoding="utf-8")
    return len(xml) / 1000.0


def _line(name: str, house: GeneratedHouse, seconds: float, size_kb: float) -> str:
    plan = house.plan
    return (
        f"{name}: {plan.kind}, {plan.area_m2:.0f} m2, {len(plan.rooms)} rooms, {house.geoms} geoms, {size_kb:.0f} KB, "
        f"{house.tries} tries, {seconds:.2f} s"
    )


if __name__ == "__main__":
    try:
        sys.exit(main(tyro.cli(Args)))
    except ConfigError as error:
        sys.exit(f"generate_houses: {error}")
