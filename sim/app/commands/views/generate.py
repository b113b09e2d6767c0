"""Generates labelled views as WebDataset shards, for training segmentation networks.

stubborn views --split train --views 100000 --out /data/views --workers 2
stubborn views --pool train --reshape --views 100000 --out /data/views_reshaped --workers 2
stubborn views --pool train --reshape --furniture runs/models --views 100000 --out /data/views_models --workers 2
stubborn views --pool train --reshape --views 15000 --aim rare --out /data/views_rare
stubborn views --split val --views 2000 --out runs/views_val --seed 1
stubborn views --split val --views 2000 --extras instances normals poses --out runs/views_objects
stubborn views --split val --views 2000 --sequence 40 --extras poses --out runs/views_along
stubborn views --house kitchen.xml --labels labels.json --views 500 --out runs/views_kitchen

A shard holds views of one house: first of the houses of the split, in an order drawn from the seed, then (train only)
of new generated ones. With --pool train all houses are new; with --reshape about half of their items have proportions
of their own. With --furniture they are new, too, and have the imported models of the split `train` (docs/furniture.md).
The same command continues a killed run; the same options give the same bytes. Several machines can share the work
with --shard 1/4 to 4/4; the last to finish writes an index of all shards.
"""

from __future__ import annotations

import functools
import shlex
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import Literal

import numpy as np

from sim.app import cli
from sim.app.analysis import display
from sim.app.commands.house_file import HouseFile
from sim.app.evaluation.executors import make_executor
from sim.app.evaluation.parallel import Shard, ordered_map
from sim.core.errors import HouseError
from sim.core.interface import CameraModel, ConfigError
from sim.core.vocabulary import counted
from sim.env.scene import Scene
from sim.episodes.splits import Split, load_split, one_house
from sim.homes.housegen.furniture import CATALOGUE
from sim.homes.housegen.generator import GeneratedHouse, generate_house
from sim.homes.housegen.imported.catalogue import ImportedFurniture
from sim.homes.housegen.imported.library import sha256_of_models
from sim.homes.housegen.splits.recipes import Recipe, train_recipe
from sim.homes.housegen.withheld import Withheld, restricted
from sim.houses.house import House
from sim.renderer.opengl import describe_gl
from sim.renderer.profiles import get_profile
from sim.robot.config import RobotConfig
from sim.training.views.aimed import Aim
from sim.training.views.shards import ShardNote, read_note, shard_name, write_index, write_shard
from sim.training.views.variation import with_other_light
from sim.training.views.views import Extra, sample_views

FRESH_SEEDS_FROM = 1_000_000
"""Smallest seed of new houses; the seeds of the shipped splits are lower."""

MAX_PER_SHARD = 250
"""Views in a shard, if there are enough of them for `MIN_HOUSES` shards."""
MIN_HOUSES = 20


@dataclass(frozen=True, kw_only=True)
class Args(HouseFile):
    """Generate labelled views of houses."""

    split: str = "train"
    """Houses of a shipped split, or of a folder with the same layout."""

    pool: Literal["train"] | None = None
    """New houses only, with the styles of this pool."""
    reshape: bool = False
    """With --pool or --furniture: about half of the items get other proportions than those of their styles."""
    furniture: Path | None = None
    """Folder of imported models (`stubborn import furniture`): new houses only, with models of the split train."""
    vary: bool = False
    """Other light in each house (lamps off, dimmed or warmer, another sun), and a body that leans in some views."""
    withheld: Withheld | None = None
    """With --pool or --furniture, for selecting a network: without leaves a fifth of the styles and models out of the
    houses; only prefers these."""
    views: cli.Count = 1000
    """Number of views in all shards."""
    out: cli.OutFolder
    """Folder of the shards; complete shards in it are kept."""
    workers: cli.Count = 1
    """Number of processes."""
    shard: str = "1/1"
    """i/n, from 1/n to n/n: generate every n-th shard from the i-th on."""
    executor: str = "local"
    """Executor: local processes, or ray (extra `ray`) for a cluster whose machines can all access --out."""
    address: str | None = None
    """With --executor ray: HOST:PORT of the cluster's head; by default the cluster that this machine is in."""
    profile: str = "good"
    """Rendering quality: good or fast."""
    seed: cli.Seed = 0
    """Seed of houses and poses."""
    views_per_shard: cli.Count | None = None
    """Number of views in a shard, all of one house; None: 250, or fewer, so that few views still show 20 houses."""
    extras: tuple[Extra, ...] = ()
    """Additional data of each view: instances (ids, COCO boxes and masks), normals, poses (camera to world)."""
    sequence: cli.Count | None = None
    """Views come as sequences of this many along paths of a robot; None: half along paths, half anywhere."""
    aim: Aim | None = None
    """rare: cameras look at stools, cushions, showers and other rare goals from 1 to 3.5 m, partly hidden ones too."""
    shrink: cli.Count = 1
    """Factor by which the views are reduced: 2 gives 320 x 240."""
    rgb: Literal["jpg", "png"] = "jpg"
    """Format of the colour images."""
    check: bool = False
    """Compare the checksums of existing shards, in addition to their sizes."""


@dataclass(frozen=True)
class ShardTask:
    """One shard to generate."""

    number: int
    views: int
    house: str
    fresh_seed: int | None
    """Seed of a new house; None: the house is one of the split."""


def main(args: Args) -> int:
    """Generates the missing shards, then writes the index; returns the exit status."""
    _check_options(args)
    shard = Shard.parse(args.shard)
    executor = make_executor(args.executor, workers=args.workers, address=args.address)
    split = _split(args)
    tasks, config = plan(args, split), _config(args, split)
    args.out.mkdir(parents=True, exist_ok=True)
    notes = {task.number: _kept(args, task, config) for task in tasks}
    missing = [task for task in tasks if notes[task.number] is None]
    todo = [task for task in missing if shard.contains(task.number)]
    if "instances" not in args.extras:
        print("Without --extras instances, the views have no ids of objects, which `train segmentation` needs.")
    complete = f"{len(tasks) - len(missing)} complete, {len(todo)} to generate here."
    print(f"{counted(len(tasks), 'shard')}, {complete}", flush=True)
    began, made = time.perf_counter(), 0
    for note in ordered_map(functools.partial(make_shard, args, config), todo, executor=executor):
        made += note.views
        rate = made / (time.perf_counter() - began)
        views = counted(note.views, "view")
        print(f"{note.shard}: {views} of {note.house}, {note.size_bytes / 1e6:.1f} MB, {rate:.1f} views/s")
        sys.stdout.flush()
        notes[int(note.shard.rsplit("-", 1)[1])] = note
    # Other machines may have finished shards in the meantime.
    complete = [note for task in tasks if (note := notes[task.number] or _kept(args, task, config)) is not None]
    command = "stubborn views " + _command(args)
    write_index(args.out, complete, command=command, config=config)
    print(_summary(complete))
    return 0


def plan(args: Args, split: Split) -> list[ShardTask]:
    """Returns all shards, on all machines."""
    rng = np.random.default_rng([args.seed, 0])
    houses = [split.houses[i] for i in rng.permutation(len(split.houses)).tolist()]
    if not houses:
        raise ConfigError(f"Split '{split.name}' has no houses.")
    tasks = []
    per_shard = views_per_shard(args)
    for number, first in enumerate(range(0, args.views, per_shard)):
        count = min(per_shard, args.views - first)
        of_train = args.split == "train" and args.house is None
        fresh = args.pool is not None or args.furniture is not None or (number >= len(houses) and of_train)
        seed = FRESH_SEEDS_FROM * (1 + args.seed) + number if fresh else None
        house = _recipe(args, seed).name if seed is not None else houses[number % len(houses)]
        tasks.append(ShardTask(number, count, house, seed))
    return tasks


def views_per_shard(args: Args) -> int:
    """Returns the number of views in a shard, whole sequences where there are sequences."""
    if args.views_per_shard is not None:
        return args.views_per_shard
    houses = MIN_HOUSES if args.house is None else 1
    count, unit = min(MAX_PER_SHARD, -(-args.views // houses)), args.sequence or 1
    return -(-count // unit) * unit


def make_shard(args: Args, config: Mapping[str, object], task: ShardTask) -> ShardNote:
    """Generates one shard, in any process.

    A new house that cannot be generated, or shows too little, is replaced by that of another fixed seed.

    Raises:
        ConfigError: the shard cannot be written.
        HouseError: the house gives no views.
    """
    if task.fresh_seed is None:
        return _shard_of(args, config, task, None)
    try:
        return _shard_of(args, config, task, task.fresh_seed)
    except HouseError:
        return _shard_of(args, config, task, task.fresh_seed + FRESH_SEEDS_FROM // 2)


def _shard_of(args: Args, config: Mapping[str, object], task: ShardTask, fresh_seed: int | None) -> ShardNote:
    """Generates the shard of the house of a seed; None: of a house of the split."""
    began = time.perf_counter()
    house, styles = _house(args, task, fresh_seed)
    if args.vary:
        house = with_other_light(house, np.random.default_rng([args.seed, 2, task.number]))
    scene = Scene(house, robot=RobotConfig(), camera=CameraModel(), profile=args.profile)
    house_s = time.perf_counter() - began
    try:
        name = shard_name(task.number)
        rng = np.random.default_rng([args.seed, 1, task.number])
        shown = task.house if fresh_seed is None else _recipe(args, fresh_seed).name
        record = {"house": shown, "seed": args.seed, "profile": args.profile, "versions": config["versions"]}
        views = sample_views(
            scene, rng, task.views, stem=name, record=record, block_px=args.shrink, extras=args.extras,
            sequence=args.sequence, aim=args.aim, styles=styles, lean=args.vary,
        )  # fmt: skip
        note = write_shard(args.out, name, views, house=task.house, config=config, rgb_format=args.rgb)
    finally:
        scene.close()
    return replace(note, seconds=note.seconds | {"house": round(house_s, 3)})


def _split(args: Args) -> Split:
    if args.house is not None:
        return one_house(args.house, labels=args.labels, root=args.root)
    return load_split(args.split)


def _house(args: Args, task: ShardTask, fresh_seed: int | None) -> tuple[House, Mapping[str, str]]:
    """Returns the house of a shard, and the styles of its instances by their names where it is a new one."""
    if fresh_seed is None:
        return _split(args).load_house(task.house), {}
    made = _made(args, fresh_seed)
    return House(task.house, made.spec), made.styles


def _made(args: Args, seed: int) -> GeneratedHouse:
    config = replace(_recipe(args, seed).config(), reshape=args.reshape)
    if args.furniture is None:
        return generate_house(seed, config, restricted(CATALOGUE, args.withheld))
    return ImportedFurniture(args.furniture).make_house(seed, config, withheld=args.withheld)


def _recipe(args: Args, seed: int) -> Recipe:
    recipe = train_recipe(seed)
    if args.furniture is None and not args.reshape:
        return recipe
    return replace(recipe, name=f"{'models' if args.furniture is not None else 'reshaped'}_{seed}")


def _kept(args: Args, task: ShardTask, config: Mapping[str, object]) -> ShardNote | None:
    """Returns the note of a complete shard; None if it is missing or broken.

    Raises:
        ConfigError: the shard was generated with other options.
    """
    note = read_note(args.out, shard_name(task.number), verify=args.check)
    if note is None:
        return None
    for key in sorted(set(config) | set(note.config)):
        if config.get(key) != note.config.get(key):
            raise ConfigError(
                f"--out '{args.out}' holds shards with {key} = {note.config.get(key)!r}, this run has "
                f"{config.get(key)!r}; use another folder, or the same options to continue."
            )
    return note if (note.house, note.views) == (task.house, task.views) else None


def _config(args: Args, split: Split) -> dict[str, object]:
    """Returns the options and versions that the bytes of a shard depend on, apart from its number."""
    packages = ("stubborn-objectnav", "mujoco", "numpy", "opencv-python-headless")
    return {
        "split": split.name,
        "pool": args.pool,
        **({"reshape": True} if args.reshape else {}),
        **({"vary": True} if args.vary else {}),
        **({"furniture_sha256": sha256_of_models(args.furniture)} if args.furniture is not None else {}),
        **({"withheld": args.withheld} if args.withheld is not None else {}),
        "split_version": split.version,
        "split_sha256": split.sha256,
        "seed": args.seed,
        "profile": asdict(get_profile(args.profile)),
        "views_per_shard": views_per_shard(args),
        "shrink": args.shrink,
        "rgb": args.rgb,
        **({"extras": sorted(args.extras)} if args.extras else {}),
        **({"sequence": args.sequence} if args.sequence is not None else {}),
        **({"aim": args.aim} if args.aim is not None else {}),
        "versions": {name: version(name) for name in packages} | {"gl_renderer": describe_gl()},
    }


def _check_options(args: Args) -> None:
    """Raises ConfigError for options that are not allowed, or not together."""
    camera = CameraModel()
    if camera.width_px % args.shrink or camera.height_px % args.shrink:
        raise ConfigError(f"--shrink must divide {camera.width_px} and {camera.height_px}, got {args.shrink}.")
    if len(set(args.extras)) < len(args.extras):
        raise ConfigError(f"--extras must be different, got '{' '.join(args.extras)}'.")
    if args.sequence is not None and (args.views % args.sequence or views_per_shard(args) % args.sequence):
        raise ConfigError(f"--sequence must divide --views and --views-per-shard, got {args.sequence}.")
    if args.aim is not None and args.sequence is not None:
        raise ConfigError("--aim and --sequence exclude each other.")
    is_new = args.pool is not None or args.furniture is not None
    if is_new and args.split != "train":
        raise ConfigError(f"--pool and --furniture need --split train, got '{args.split}': other houses are files.")
    if not is_new:
        cli.require_unset(args, ("withheld", "reshape"), "needs --pool or --furniture: other houses are files.")
    args.check_house()
    if args.house is not None and (is_new or args.split != "train"):
        raise ConfigError("--house excludes --split, --pool and --furniture.")


def _command(args: Args) -> str:
    """Returns the options that generate the same shards."""
    source = ("split",) if args.house is None else ("house", "labels", "root")
    keys = (
        *source, "pool", "reshape", "vary", "furniture", "withheld", "views", "profile", "seed", "views_per_shard",
        "shrink",
        "rgb", "sequence", "aim",
    )  # fmt: skip
    values = {key: getattr(args, key) for key in keys}
    options = [(key, [] if value is True else [value]) for key, value in values.items() if value not in (None, False)]
    options += [("extras", args.extras)] if args.extras else []
    words = [word for key, shown in options for word in (f"--{key.replace('_', '-')}", *map(str, shown))]
    return shlex.join([*words, "--out", "DIR"])


def _summary(notes: Sequence[ShardNote]) -> str:
    parts = dict.fromkeys(part for note in notes for part in note.seconds)
    seconds = {part: sum(note.seconds.get(part, 0.0) for note in notes) for part in parts}
    total = sum(seconds.values()) or 1.0
    share = ", ".join(f"{part} {100 * value / total:.0f} %" for part, value in seconds.items())
    views, size_bytes = sum(note.views for note in notes), sum(note.size_bytes for note in notes)
    houses = len({note.house for note in notes})
    return (
        f"{counted(views, 'view')} of {counted(houses, 'house')} in "
        f"{counted(len(notes), 'shard')}, {display.file_size(size_bytes)}; of the processes' time: {share}."
    )
