"""Generates the episodes of a split next to its house files or its list of houses, in Habitat's ObjectNav layout.

    stubborn episodes --split assets/mjcf_houses/val --workers 2
    stubborn episodes --split my_houses --episodes 100 --recipe large
    stubborn episodes --house kitchen.xml --labels labels.json --episodes 20 --out runs/kitchen

With --house, a split is made of one house: --out gets the house in one file, its meshes and textures, its label rules
and its episodes. `stubborn run --split runs/kitchen` then needs neither the original files nor --labels.

`<name>.json` next to `<name>.xml` may fix start and goal (`sim.houses.sidecar`): the house then has one episode for
each goal that the start reaches, or with `--recipe traps` three with different headings.

The folder's name selects the recipe (`sim.episodes.recipes`): how many episodes each house has, the limits of the
distance from start to goal, and which starts count; other folders use the default recipe, or the one of `--recipe`.

The houses take turns; the next goal of a house is the one with the fewest episodes so far, so that the first N episodes
are balanced for any N. In a house of two storeys, the episodes alternate between them, and only goals on the storey of
the start count as reachable. A start is sampled uniformly from the free space that the recipe allows, and the robot has
no contact there. Goals are categories with an instance that can be reached; instances that cannot be reached are listed
in `unreachable.json`. The same seed, houses, version and success rule give the same bytes.
"""

from __future__ import annotations

import collections
import functools
import itertools
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from sim.app import cli
from sim.app.commands.house_file import HouseFile
from sim.app.evaluation.parallel import ordered_map
from sim.app.viewers.episode_map import draw_episode_map
from sim.core.errors import EpisodeError, HouseError
from sim.core.files import inside, write_picture, write_together
from sim.core.interface import ConfigError, SuccessRule
from sim.core.invocation import command
from sim.core.reading import read_bytes
from sim.core.vocabulary import counted
from sim.episodes.episode import Episode
from sim.episodes.house_episodes import Ask, HouseAsks, StartDrawer, find_house_asks, turned_start
from sim.episodes.house_list import has_house_list, read_house_list
from sim.episodes.recipes import DEFAULT_RECIPE, EPISODE_RECIPES, EpisodeRecipe
from sim.episodes.splits import LABELS_FILE, house_files, house_sidecar, labels_of, write_split
from sim.homes.housegen.splits.recipes import SPLIT_VERSION
from sim.houses.house import House
from sim.houses.labels import read_labels
from sim.houses.load import load_house
from sim.houses.packing import packed
from sim.houses.sidecar import EMPTY_SIDECAR, Sidecar, write_sidecar
from sim.task.config import TaskConfig
from sim.task.objectnav import Task
from sim.world.world import World

Turn = tuple[int, int, Ask]
"""An episode to draw: its number in the split, its number in the house, and its goal."""


@dataclass(frozen=True)
class Args(HouseFile):
    """Generate the episodes of a split next to its houses."""

    split: Path | None = None
    """Folder of the split; its houses are its .xml files, or those in its houses.json."""

    out: cli.OutFolder | None = None
    """With --house: folder of the new split."""
    episodes: cli.Count | None = None
    """Number of episodes of all houses; by default the recipe's number for each house."""
    recipe: str | None = None
    """Name of the recipe (val, test, large, hazards, train, traps); by default the one with the folder's name."""
    seed: cli.Seed = 0
    """Seed of starts and headings."""
    version: str = SPLIT_VERSION
    """Version of the split."""
    workers: cli.Count = 1
    """Number of processes."""
    pictures: cli.OnUnlessNo = True
    """Do not write a map of the starts and goals of each house (pictures/ in the split's folder)."""
    success: SuccessRule = field(default_factory=SuccessRule)
    """Conditions under which a STOP succeeds; distances, view points and unreachable goals depend on them."""


def main(args: Args) -> int:
    """Writes the episodes of the split and prints statistics.

    Raises:
        ConfigError, EpisodeError, HouseError: there are no houses, or a house cannot be used.
    """
    args = with_split(args)
    files, recipe = house_names(folder_of(args)), recipe_of(args)
    began_s = time.perf_counter()
    drawn = ordered_map(functools.partial(_find_asks, args), list(files), workers=args.workers)
    goals: dict[str, HouseAsks] = {}
    for house, asks in zip(files, drawn, strict=True):
        goals[house] = asks
        instances, asked = sum(map(len, asks.listed.values())), len({ask.goal for ask in asks.asks})
        print(
            f"{house}: {counted(len(asks.listed), 'goal')}, {asked} of them asked for, {instances} instances, "
            f"{len(asks.unreachable)} unreachable",
            flush=True,
        )
    most = {house: asks.most for house, asks in goals.items() if asks.most is not None}
    count = args.episodes or sum(min(recipe.per_house, most.get(house, recipe.per_house)) for house in files)
    order = balanced_goals({house: asks.asks for house, asks in goals.items()}, count, most)
    episodes = draw_episodes(args, order)
    write_split(
        folder_of(args),
        episodes,
        {house: asks.listed for house, asks in goals.items()},
        version=args.version,
        unreachable={house: asks.unreachable for house, asks in goals.items()},
    )
    _report(episodes, goals, time.perf_counter() - began_s)
    return 0


def folder_of(args: Args) -> Path:
    """Returns the folder of the split; raises ConfigError if the options name none."""
    if args.split is None:
        raise ConfigError("episodes needs --split FOLDER, or --house FILE with --out FOLDER.")
    return args.split


def with_split(args: Args) -> Args:
    """Returns the options with a split: with --house, it is written to --out.

    Raises:
        ConfigError: the options contradict each other, or --out holds other files.
        HouseError: the house cannot be used.
    """
    args.check_house()
    if args.house is None:
        if args.out is not None:
            raise ConfigError("--out needs --house.")
        return args
    if args.split is not None or args.out is None:
        raise ConfigError("--house needs --out FOLDER, and excludes --split.")
    others = [name for name in house_files(args.out) if name != args.house.stem]
    if others:
        raise ConfigError(f"--out '{args.out}' holds the house '{others[0]}' already; give a folder of its own.")
    if args.house.resolve().parent == args.out.resolve():
        raise ConfigError(f"--out '{args.out}' is the folder of '{args.house}', which would be overwritten.")
    house = args.load()
    fixed = house_sidecar(args.house, args.labels)
    for other, is_written in ((LABELS_FILE, args.labels is not None), (f"{house.name}.json", fixed != EMPTY_SIDECAR)):
        if (args.out / other).exists() and not is_written:
            raise ConfigError(f"--out '{args.out}' holds '{other}', which would change the house; delete it first.")
    files = {args.out / name: content for name, content in packed(house, args.house).items()}
    if args.labels is not None:
        files[args.out / LABELS_FILE] = read_bytes(args.labels, what="Label rules")
    write_together(files)
    if fixed != EMPTY_SIDECAR:
        write_sidecar(args.out / f"{house.name}.xml", fixed)
    _require_same(house, load_house(args.out / f"{house.name}.xml", labels_path=labels_of(args.out)))
    return replace(args, split=args.out)


def _require_same(house: House, written: House) -> None:
    """Raises HouseError if a house that was written as one file has other geoms or labels."""
    first, second = house.spec.copy().compile(), written.spec.copy().compile()
    same = first.ngeom == second.ngeom and np.allclose(first.geom_pos, second.geom_pos, atol=1e-4)
    if same:
        pairs = ((first, house.rules), (second, written.rules))
        labels = [read_labels(model, rules=rules, ignore_prefix="") for model, rules in pairs]
        same = np.array_equal(labels[0].geom_category, labels[1].geom_category)
    if not same:
        raise HouseError(f"House '{house.name}' changes when MuJoCo writes it as one file; use it with --house.")


def house_names(folder: Path) -> tuple[str, ...]:
    """Returns the names of the houses in the folder of a split.

    Raises:
        ConfigError: there are no houses.
    """
    names = tuple(read_house_list(folder).recipes if has_house_list(folder) else house_files(folder))
    if not names:
        raise ConfigError(f"There is no house in '{folder}' (`{command('houses', 'generate')}` makes some).")
    return names


def recipe_of(args: Args) -> EpisodeRecipe:
    """Returns the recipe that the options name.

    Raises:
        ConfigError: there is no such recipe.
    """
    if args.recipe is None:
        return EPISODE_RECIPES.get(folder_of(args).resolve().name, DEFAULT_RECIPE)
    if args.recipe not in EPISODE_RECIPES:
        raise ConfigError(f"No recipe '{args.recipe}'. Available: {', '.join(EPISODE_RECIPES)}.")
    return EPISODE_RECIPES[args.recipe]


def balanced_goals(
    asks_of: Mapping[str, Sequence[Ask]], count: int, most: Mapping[str, int] | None = None
) -> list[tuple[str, Ask]]:
    """Returns house and goal of each episode: the houses in turn, and the goal with the fewest episodes so far.

    The episodes of a house alternate between its storeys.

    Args:
        asks_of: the goals of each house.
        count: number of episodes.
        most: largest number of episodes of each house whose sidecar fixes the start.

    Raises:
        EpisodeError: a house has no goal, or there are fewer different episodes than `count`.
    """
    most = most or {}
    for house, asks in asks_of.items():
        if not asks:
            raise EpisodeError(f"House '{house}' has no goal that can be reached from a start of the recipe.")
    if len(most) == len(asks_of) and count > sum(most.values()):
        raise EpisodeError(
            f"The sidecars of the houses fix their starts, so that there are {sum(most.values())} different episodes, "
            f"and {count} were asked for; give --episodes {sum(most.values())}."
        )
    asked, of_house = collections.Counter[str](), collections.Counter[str]()
    asked_here = collections.Counter[tuple[str, str]]()
    order: list[tuple[str, Ask]] = []
    houses = sorted(asks_of)
    for turn in itertools.count():
        for house in houses:
            if len(order) == count:
                return order
            if of_house[house] == most.get(house):
                continue
            storeys = sorted({ask.floor_z_m for ask in asks_of[house]})
            asks = [ask for ask in asks_of[house] if ask.floor_z_m == storeys[turn % len(storeys)]]

            def rank(ask: Ask, house: str = house) -> tuple[int, int, int]:
                here, everywhere = asked_here[house, ask.goal], asked[ask.goal]
                first, second = (here, everywhere) if house in most else (everywhere, here)
                return first, second, asks_of[house].index(ask)

            ask = min(asks, key=rank)
            asked[ask.goal] += 1
            asked_here[house, ask.goal] += 1
            of_house[house] += 1
            order.append((house, ask))
    raise AssertionError("the loop returns")


def draw_episodes(args: Args, order: Sequence[tuple[str, Ask]]) -> list[Episode]:
    """Returns the episodes, in order; each has a random stream of its own, so that it does not depend on the others."""
    turns: dict[str, list[Turn]] = {house: [] for house in sorted({house for house, _ in order})}
    for i, (house, ask) in enumerate(order):
        turns[house].append((i, len(turns[house]), ask))
    digits = max(4, len(str(len(order) - 1)))
    work = [(number, house, of_house) for number, (house, of_house) in enumerate(turns.items())]
    drawn = ordered_map(functools.partial(_draw, args, digits), work, workers=args.workers)
    episodes: dict[int, Episode] = {}
    for house, (of_one, relaxed) in zip(turns, drawn, strict=True):
        episodes |= dict(of_one)
        note = f", {relaxed} of them do not meet the rule of the recipe" if relaxed else ""
        print(f"{house}: {counted(len(of_one), 'episode')}{note}", flush=True)
    return [episodes[i] for i in range(len(order))]


def _task(args: Args, house: str) -> Task:
    folder = folder_of(args)
    path = read_house_list(folder).fetch(house) if has_house_list(folder) else house_files(folder)[house]
    loaded = load_house(path, labels_path=labels_of(folder))
    return Task(World(loaded, rule=args.success), TaskConfig(success=args.success))


def _find_asks(args: Args, house: str) -> HouseAsks:
    task = _task(args, house)
    task.truth.require_goals()
    return find_house_asks(task, recipe_of(args), _sidecar(args, house))


def _sidecar(args: Args, house: str) -> Sidecar:
    """Returns the sidecar next to a house file of the split; empty if there is none."""
    folder = folder_of(args)
    return EMPTY_SIDECAR if has_house_list(folder) else house_sidecar(house_files(folder)[house], labels_of(folder))


def _draw(args: Args, digits: int, work: tuple[int, str, list[Turn]]) -> tuple[list[tuple[int, Episode]], int]:
    """Returns the episodes of one house, each with its number, and how many do not meet the rule of the recipe."""
    number_of_house, house, turns = work
    task, recipe, fixed = _task(args, house), recipe_of(args), _sidecar(args, house).start
    drawer = StartDrawer(task, recipe, house=number_of_house, seed=args.seed)
    name, episodes, relaxed = folder_of(args).resolve().name, [], 0
    of_goal = collections.Counter[str]()
    for i, number, ask in turns:
        if fixed is None:
            drawn = drawer.draw(ask, number, np.random.default_rng([args.seed, i]))
        else:
            drawn = turned_start(task, ask, fixed, of_goal[ask.goal], recipe)
        of_goal[ask.goal] += 1
        relaxed += not drawn.meets_rule
        episodes.append((i, Episode(f"{name}_{i:0{digits}d}", house, ask.goal, drawn.pose, drawn.distance_m)))
    drawer.close()
    if args.pictures and episodes:
        path = inside(folder_of(args) / "pictures", f"{house}.png", what="name of a house")
        write_picture(path, draw_episode_map(task, [episode for _, episode in episodes]))
    return episodes, relaxed


def _report(episodes: Sequence[Episode], goals: Mapping[str, HouseAsks], took_s: float) -> None:
    """Prints statistics of the episodes."""
    distances = np.array([episode.shortest_path_m for episode in episodes], dtype=np.float64)
    print(
        f"{counted(len(episodes), 'episode')} in {counted(len(goals), 'house')}, "
        f"made in {took_s:.1f} s, {len(goals) / took_s:.2f} houses/s"
    )
    print(f"geodesic distance: {distances.min():.1f} to {distances.max():.1f} m, median {np.median(distances):.1f} m")
    asked = collections.Counter(episode.goal for episode in episodes)
    print("episodes by goal: " + ", ".join(f"{goal} {number}" for goal, number in sorted(asked.items())))
    for house, asks in goals.items():
        if asks.unreachable:
            print(f"{house}: cannot be reached, and thus not asked for: {', '.join(asks.unreachable)}")
