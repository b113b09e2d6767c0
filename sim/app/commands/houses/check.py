"""Checks fresh houses of a pool, the houses of a split, or one house, and prints the faults of each.

    stubborn houses check --pool heldout --seeds 200 --workers 2
    stubborn houses check --pool heldout --seeds 20 --kind estate
    stubborn houses check --split val
    stubborn houses check --house kitchen.xml --labels labels.json

The check measures the file as users load it: labels, overlaps, support, movable objects at rest, reachability, the
rules for floor plans (`sim.world.plan_requirements`), the furniture that each kind of room must have
(`sim.world.room_requirements`), and pixels of void in views of the robot's camera. What an architect would change
(`sim.world.advice`) is printed as notes. A house of your own needs no room sites and no furniture: only places and
goals that the robot cannot reach are faults, and everything else is printed as notes, unless `--furnished` is given.
The exit status is 1 if any house has a fault.
"""

from __future__ import annotations

import contextlib
import functools
import statistics
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim.app import cli
from sim.app.commands.house_file import HouseFile
from sim.app.commands.houses.area import Area
from sim.app.evaluation.parallel import ordered_map
from sim.core.errors import ConfigError, HouseError
from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel
from sim.core.paths import assets_dir
from sim.core.vocabulary import counted
from sim.env.scene import Scene
from sim.episodes.splits import Split, has_episodes, house_files, labels_of, load_split, split_of_files
from sim.gl import mujoco
from sim.homes.housegen.floor_plan.rooms import PlanKind
from sim.homes.housegen.furniture.item import Pool
from sim.homes.housegen.generator import HouseConfig, generate_house
from sim.homes.housegen.splits.recipes import SPLIT_VERSION, SPLITS
from sim.houses.house import House
from sim.houses.writing import house_text
from sim.robot.config import RobotConfig
from sim.world.check import advise_house, check_house, check_own_house

CAMERA = CameraModel(width_px=160, height_px=120)


@dataclass(frozen=True, kw_only=True)
class Args(HouseFile):
    """Check new houses of a pool, or the houses of a split, for faults."""

    pool: Pool = "heldout"
    """Pool of the fresh houses."""
    seeds: cli.Count = 20
    """Number of fresh houses."""
    first_seed: cli.Seed = 900_000
    """The first of consecutive seeds; no split has seeds from 900000 on."""
    kind: PlanKind | None = None
    """Kind of floor plan; sampled when not given."""
    area_m2: Area = None
    """Floor area such as 90, or a range such as 80:120; sampled when not given."""
    movable: bool = False
    """Whether light furniture can be pushed."""
    split: str | None = None
    """Name of a split, or a folder of houses with or without episodes, which are checked instead of fresh ones."""

    furnished: bool = False
    """Apply all rules of generated houses to a house or split of your own; shipped ones of this version always are."""
    views: cli.Amount = 12
    """Number of views in each house that are searched for void."""
    workers: cli.Count = 1
    """Number of processes."""


@dataclass(frozen=True)
class Checked:
    """The result of one house."""

    name: str
    faults: tuple[str, ...]
    notes: tuple[str, ...] = ()
    """Sentences on properties that do not prevent the use of the house."""
    tries: int = 1
    """Number of attempts that the generator made."""
    rejects: tuple[str, ...] = ()
    """The reason why each earlier try was rejected."""
    seconds: float = 0.0
    """Processor time to generate and check it, without the search for void."""


def main(args: Args) -> int:
    """Checks the houses; returns 1 if one has a fault."""
    results = []
    if args.split is not None and args.house is not None:
        raise ConfigError("--split and --house exclude each other.")
    args.check_house()
    fresh = args.split is None and args.house is None
    if fresh:
        cli.require_unset(args, ("furnished",), "needs --split or --house: new houses are checked by all rules.")
    else:
        of_new = ("pool", "seeds", "first_seed", "kind", "area_m2", "movable")
        cli.require_unset(args, of_new, "is for new houses: leave out --split and --house.")
    for checked in _checked(args):
        results.append(checked)
        tries = f", {counted(checked.tries, 'try', 'tries')}" if fresh else ""
        faults = counted(len(checked.faults), "fault")
        print(f"{checked.name}: {faults}{tries}, {checked.seconds:.2f} s", flush=True)
        for kind, sentences in (("note", checked.notes), ("rejected", checked.rejects), ("fault", checked.faults)):
            for sentence in sentences:
                print(f"    {kind}: {sentence}")
    faulty = sum(bool(checked.faults) for checked in results)
    all_tries = [checked.tries for checked in results]
    tries = f"tries: mean {statistics.mean(all_tries):.2f}, most {max(all_tries)}; " if fresh else ""
    print(
        f"{counted(len(results), 'house')}, {faulty} with faults; {tries}"
        f"median {statistics.median(checked.seconds for checked in results):.2f} s each"
    )
    return int(faulty > 0)


def _checked(args: Args) -> Iterator[Checked]:
    """Yields the results of the houses that the options name."""
    if args.house is not None:
        house = args.load()
        return iter([_check_loaded(house, args.views, generated=args.furnished)])
    return _check_split(args, args.split) if args.split is not None else _check_seeds(args)


def _check_seeds(args: Args) -> Iterator[Checked]:
    """Checks fresh houses."""
    config = HouseConfig(pool=args.pool, kind=args.kind, area_m2=args.area_m2, movable=args.movable)
    seeds = range(args.first_seed, args.first_seed + args.seeds)
    return ordered_map(functools.partial(_check_seed, config, args.views), seeds, workers=args.workers)


def _check_split(args: Args, split: str) -> Iterator[Checked]:
    """Checks the houses of a split, or those in a folder that has no episodes yet."""
    folder = Path(split)
    if (alone := house_files(folder)) and not has_episodes(folder):
        loaded = split_of_files(tuple(alone.values()), labels=labels_of(folder))
    else:
        loaded = load_split(split)
    generated = args.furnished or _is_generated(loaded)
    check = functools.partial(_check_named, loaded, args.views, generated)
    return ordered_map(check, loaded.houses, workers=args.workers)


def _is_generated(split: Split) -> bool:
    """Returns whether all houses of a split are by the rules of today: those of a shipped split of this version.

    Traps are not.
    """
    if split.version != SPLIT_VERSION:
        return False
    shipped = any(path.parent.parent == assets_dir().resolve() for path in split.house_paths.values())
    return split.house_list is not None or (shipped and split.name in SPLITS)


def _check_seed(config: HouseConfig, views: int, seed: int) -> Checked:
    """Generates the house of a seed and checks what its file contains."""
    name, began_s = f"{config.pool}_{seed}", time.process_time()
    try:
        house = generate_house(seed, config)
    except HouseError as error:
        return Checked(name, (str(error),), seconds=time.process_time() - began_s)
    seconds = time.process_time() - began_s
    spec = mujoco.MjSpec.from_string(house_text(house.spec, str(assets_dir() / "textures")))
    faults = _faults(House(name, spec), views)
    return Checked(name, faults, tuple(advise_house(spec)), tries=house.tries, rejects=house.rejects, seconds=seconds)


def _check_named(split: Split, views: int, generated: bool, name: str) -> Checked:
    """Checks one house of a split."""
    return _check_loaded(split.load_house(name), views, generated=generated)


def _check_loaded(house: House, views: int, *, generated: bool) -> Checked:
    """Checks a house by all rules of generated houses, or only by those for users' houses."""
    began_s = time.process_time()
    if generated:
        faults, notes = _faults(house, views), tuple(advise_house(house.spec))
    else:
        wrong, remarks = check_own_house(house)
        void = _void(house, views) if not wrong else []
        faults, notes = tuple(wrong), (*house.notes, *remarks, *void)
    return Checked(house.name, faults, notes, seconds=time.process_time() - began_s)


def _faults(house: House, views: int) -> tuple[str, ...]:
    """Returns the faults of a house, with one for void in the views from random free positions."""
    faults = check_house(house.spec, furnished=True)
    return tuple(faults or _void(house, views))


def _void(house: House, views: int) -> list[str]:
    """Returns a sentence if views from random free positions show void."""
    if not views:
        return []
    with contextlib.closing(Scene(house, robot=RobotConfig(), camera=CAMERA, profile="fast")) as scene:
        if not scene.task.truth.space(0.0).free.any():
            return ["there is no free place at floor level for views"]
        void = sum(_void_pixels(scene, views))
    share = void / (views * CAMERA.width_px * CAMERA.height_px)
    return (
        [f"{void} pixels of {views} views ({share:.1%}) show void: no surface, or one without a label"] if void else []
    )


def _void_pixels(scene: Scene, views: int) -> Iterator[int]:
    """Yields the number of void pixels in each of some views."""
    space, rng = scene.task.truth.space(0.0), np.random.default_rng(0)
    cells = np.argwhere(space.free)
    for _ in range(views):
        x_m, y_m = space.frame.to_metres(cells[rng.integers(len(cells))])
        pose = Pose(float(x_m), float(y_m), float(rng.uniform(-np.pi, np.pi)))
        yield int((scene.camera.render(scene.world.data, pose, ("semantic",))["semantic"] == 0).sum())
