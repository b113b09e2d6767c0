"""Checks fresh houses of a pool, or the houses of a split, and prints faults, tries and time for each house.

    stubborn houses check --pool heldout --seeds 200 --workers 2
    stubborn houses check --pool heldout --seeds 20 --kind estate
    stubborn houses check --split val

The check measures the file as users load it: labels, overlaps, support, movable objects at rest, reachability, the
furniture that each kind of room must have (`sim.world.room_requirements`), and pixels of void in views of the robot's
camera. The exit status is 1 if any house has a fault.
"""

from __future__ import annotations

import functools
import statistics
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from sim import cli
from sim.env.scene import Scene
from sim.episodes.splits import load_split
from sim.errors import ConfigError, HouseError
from sim.evaluation.parallel import ordered_map
from sim.geometry.pose import Pose
from sim.gl import mujoco
from sim.housegen.floor_plan.rooms import PlanKind
from sim.housegen.furniture.item import Pool
from sim.housegen.generator import HouseConfig, generate_house
from sim.houses.house import House
from sim.houses.writing import house_text
from sim.interface import CameraModel
from sim.paths import assets_dir
from sim.robot.config import RobotConfig
from sim.world.check import check_house

CAMERA = CameraModel(width_px=160, height_px=120)


@dataclass(frozen=True, kw_only=True)
class Args:
    """Check new houses of a pool, or the houses of a split, for faults."""

    pool: Pool = "heldout"
    """Pool of the fresh houses."""
    seeds: cli.Count = 20
    """Number of fresh houses."""
    first_seed: cli.Seed = 900_000
    """The first of consecutive seeds; no split has seeds from 900000 on."""
    kind: PlanKind | None = None
    """Kind of floor plan; sampled when not given."""
    area_m2: cli.Positive | None = None
    """Floor area; sampled when not given."""
    movable: bool = False
    """Whether light furniture can be pushed."""
    split: str | None = None
    """Name or folder of a split; its houses are checked instead of fresh ones."""
    views: cli.Amount = 12
    """Number of views in each house that are searched for void."""
    workers: cli.Count = 1
    """Number of processes."""


@dataclass(frozen=True)
class Checked:
    """The result of one house."""

    name: str
    faults: tuple[str, ...]
    tries: int = 1
    """Number of attempts that the generator made."""
    rejects: tuple[str, ...] = ()
    """The reason why each earlier try was rejected."""
    seconds: float = 0.0
    """Processor time to generate and check it, without the search for void."""


def main(args: Args) -> int:
    """Checks the houses; returns 1 if one has a fault."""
    if args.workers < 1 or args.seeds < 1 or args.views < 0:
        raise ConfigError("--workers and --seeds must be at least 1, --views at least 0.")
    results = []
    for checked in _check_split(args, args.split) if args.split is not None else _check_seeds(args):
        results.append(checked)
        print(
            f"{checked.name}: {len(checked.faults)} faults, {checked.tries} tries, {checked.seconds:.2f} s", flush=True
        )
        for reason in checked.rejects:
            print(f"    rejected: {reason}")
        for fault in checked.faults:
            print(f"    fault: {fault}")
    faulty = sum(bool(checked.faults) for checked in results)
    all_tries = [checked.tries for checked in results]
    print(
        f"{len(results)} houses, {faulty} with faults; "
        f"tries: mean {statistics.mean(all_tries):.2f}, most {max(all_tries)}; "
        f"median {statistics.median(checked.seconds for checked in results):.2f} s each"
    )
    return int(faulty > 0)


def _check_seeds(args: Args) -> Iterator[Checked]:
    """Checks fresh houses."""
    config = HouseConfig(pool=args.pool, kind=args.kind, area_m2=args.area_m2, movable=args.movable)
    seeds = range(args.first_seed, args.first_seed + args.seeds)
    return ordered_map(functools.partial(_check_seed, config, args.views), seeds, workers=args.workers)


def _check_split(args: Args, split: str) -> Iterator[Checked]:
    """Checks the houses of a split."""
    houses: Sequence[str] = load_split(split).houses
    return ordered_map(functools.partial(_check_named, split, args.views), houses, workers=args.workers)


def _check_seed(config: HouseConfig, views: int, seed: int) -> Checked:
    """Generates the house of a seed and checks what its file contains."""
    name, began_s = f"{config.pool}_{seed}", time.process_time()
    try:
        house = generate_house(seed, config)
    except HouseError as error:
        return Checked(name, (str(error),), seconds=time.process_time() - began_s)
    seconds = time.process_time() - began_s
    spec = mujoco.MjSpec.from_string(house_text(house.spec, str(assets_dir() / "textures")))
    return Checked(name, _faults(House(name, spec), views), house.tries, house.rejects, seconds)


def _check_named(split: str, views: int, name: str) -> Checked:
    """Checks one house of a split."""
    house, began_s = load_split(split).load_house(name), time.process_time()
    faults = _faults(house, views)
    return Checked(name, faults, seconds=time.process_time() - began_s)


def _faults(house: House, views: int) -> tuple[str, ...]:
    """Returns the faults of a house, with one for void in the views from random free positions."""
    faults = check_house(house.spec, furnished=True)
    if views and not faults:
        scene = Scene(house, robot=RobotConfig(), camera=CAMERA, profile="fast")
        void = sum(_void_pixels(scene, views))
        scene.close()
        faults += [f"{void} pixels of {views} views show void"] if void else []
    return tuple(faults)


def _void_pixels(scene: Scene, views: int) -> Iterator[int]:
    """Yields the number of void pixels in each of some views."""
    space, rng = scene.task.truth.space(0.0), np.random.default_rng(0)
    cells = np.argwhere(space.free)
    for _ in range(views):
        x_m, y_m = space.frame.to_metres(cells[rng.integers(len(cells))])
        pose = Pose(float(x_m), float(y_m), float(rng.uniform(-np.pi, np.pi)))
        yield int((scene.camera.render(scene.world.data, pose, ("semantic",))["semantic"] == 0).sum())
