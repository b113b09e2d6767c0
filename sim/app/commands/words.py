"""Writes a split of episodes with goals in words or pictures, or of chains of goals, in the houses of another split.

    stubborn words --split val --kind seen --out assets/mjcf_houses/words-seen --episodes 150 --workers 2
    stubborn words --split my_houses --kind descriptions --out my_descriptions
    stubborn words --split val --kind chains --out assets/mjcf_houses/chains-val --episodes 120

- `seen`: everyday names of objects ("fridge"); `unseen`: those of `sim.core.vocabulary.UNSEEN`; `synonyms`: other words
  for the names of `seen` ("refrigerator"). All objects of the name are the goal.
- `descriptions`: "the red chair next to the bed in the bedroom". Each provably fits exactly one object
  (`sim.episodes.descriptions`); its level is the number of conditions besides the name.
- `chains`: several goals of all kinds of `KINDS`, one after the other (`sim.episodes.chains`).
- `pictures`: a picture of one object by another camera than the robot's (`sim.episodes.goal_pictures`).

The split lies next to the other one, whose houses it uses. Starts are drawn by the recipe `val`.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Literal

import numpy as np

from sim.app import cli
from sim.app.evaluation.parallel import ordered_map
from sim.core.errors import ConfigError, EpisodeError
from sim.core.goals import GoalSpec
from sim.core.interface import GOAL_CATEGORIES, CameraModel
from sim.core.vocabulary import UNSEEN, counted, vocabulary
from sim.env.scene import Scene
from sim.episodes.chains import ChainDrawer
from sim.episodes.descriptions import Descriptions
from sim.episodes.episode import Episode
from sim.episodes.goal_pictures import GoalPictures
from sim.episodes.house_episodes import Ask, StartDrawer
from sim.episodes.reachable_goals import storeys_of
from sim.episodes.recipes import EPISODE_RECIPES
from sim.episodes.splits import load_split, write_split
from sim.robot.config import RobotConfig
from sim.task.meaning import HouseObject

Kind = Literal["seen", "unseen", "synonyms", "descriptions", "pictures", "chains"]
_MIN_SIZE_M = 0.15
"""Smaller objects are not asked for: the camera would not resolve them."""
_MIN_PICTURED_M = 0.25
"""Smaller objects are not asked for by a picture."""
_UNASKED = frozenset({"blind", "curtain", "wall cabinet", "cooker hood", "glass of water", "cable", "power strip"})
"""Names that are part of the fittings of a room rather than something to go to."""
_MAX_DRAWS = 12
"""Attempts to draw a chain, for each that is wanted."""
_MAX_PICTURES = 8
"""Pictures that are drawn for the chains of a house."""
_PER_LEVEL = 4
"""Descriptions of each level that are written for a house; more of its objects are then not tried."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Write a split of episodes with goals in words or pictures, or of chains, in the houses of another split."""

    out: cli.OutFolder
    """Folder of the new split; its parent is that of the other split."""
    kind: Kind = "seen"
    """seen, unseen, synonyms, descriptions, pictures or chains."""
    split: str = "val"
    """The split whose houses are used: a shipped one, or a folder."""
    episodes: cli.Count = 150
    """Number of episodes."""
    seed: cli.Seed = 0
    """Seed of goals, words and starts."""
    workers: cli.Count = 1
    """Number of processes."""


def main(args: Args) -> int:
    """Writes the split; returns the exit status.

    Raises:
        ConfigError: the folders do not lie next to each other, or no house has such a goal.
    """
    split = load_split(args.split)
    home = next(iter(split.house_paths.values())).parent
    if args.out.resolve().parent != home.resolve().parent or args.out.resolve() == home.resolve():
        raise ConfigError(f"--out '{args.out}' must be another folder in '{home.parent}', next to the houses.")
    per_house = -(-args.episodes // len(split.houses))
    work = [(number, house, per_house) for number, house in enumerate(split.houses)]
    by_house = list[list[Episode]]()
    while missing := args.episodes - sum(map(len, by_house)):
        batch = work[len(by_house) :][: missing if per_house == 1 else None]  # further houses would be left out
        if not batch:
            break
        made = ordered_map(functools.partial(_draw, args), batch, workers=args.workers)
        for (_, house, _), drawn in zip(batch, made, strict=True):
            by_house.append(drawn)
            print(f"{house}: {counted(len(drawn), 'episode')}", flush=True)
    rounds = [drawn[turn] for turn in range(per_house) for drawn in by_house if turn < len(drawn)]
    name = args.out.resolve().name
    episodes = [replace(episode, episode_id=f"{name}_{i:04d}") for i, episode in enumerate(rounds[: args.episodes])]
    if not episodes:
        raise ConfigError(f"No house of '{args.split}' has a goal for --kind {args.kind}.")
    args.out.mkdir(parents=True, exist_ok=True)
    goals = {house: {} for house in split.houses}
    write_split(args.out, episodes, goals, version=split.version, houses_of=home.name)
    different = {goal for episode in episodes for goal in episode.specs}
    print(f"{counted(len(episodes), 'episode')}, {counted(len(different), 'different goal')}, in {args.out}")
    return 0


def _draw(args: Args, work: tuple[int, str, int]) -> list[Episode]:
    """Returns the episodes of one house."""
    number, house, count = work
    split, rng = load_split(args.split), np.random.default_rng([args.seed, number])
    scene = Scene(split.load_house(house), robot=RobotConfig(), camera=CameraModel(), profile="fast")
    task, recipe = scene.task, EPISODE_RECIPES["val"]
    scene.world.restore()
    drawer, episodes = StartDrawer(task, recipe, house=number, seed=args.seed), []
    try:
        if args.kind == "chains":
            return _chains(scene, drawer, house, count, rng)
        for goal in _goals(args, scene, rng):
            if len(episodes) == count:
                break
            for floor_z_m in rng.permutation(storeys_of(task)).tolist():
                reached = len(task.truth.region(goal.text, floor_z_m).footprints)
                ask, goals = Ask(goal.text, floor_z_m, reached), (goal,) if goal.camera is not None else ()
                episode = _started(drawer, ask, house, len(episodes), rng, goals) if reached else None
                if episode is not None:
                    episodes.append(episode)
                    break
    finally:
        drawer.close()
        scene.close()
    return episodes


def _chains(scene: Scene, drawer: StartDrawer, house: str, count: int, rng: np.random.Generator) -> list[Episode]:
    """Returns chains of goals in one house."""
    task, episodes = scene.task, list[Episode]()
    objects = _objects(scene, rng)
    goals = {kind: list(listed(scene, objects, rng)) for kind, listed in KINDS.items()}
    drawers = [ChainDrawer(task, goals, floor_z_m) for floor_z_m in storeys_of(task)]
    for turn in range(_MAX_DRAWS * count):
        if len(episodes) == count:
            break
        chains = drawers[turn % len(drawers)]
        chain = chains.draw(rng)
        if not chain:
            continue
        floor_z_m, goal = storeys_of(task)[turn % len(drawers)], chain[0].text
        ask = Ask(goal, floor_z_m, len(task.truth.region(goal, floor_z_m).footprints))
        episode = _started(drawer, ask, house, len(episodes), rng, chain)
        episodes += [] if episode is None else [episode]
    return episodes


def _started(
    drawer: StartDrawer, ask: Ask, house: str, number: int, rng: np.random.Generator, goals: tuple[GoalSpec, ...]
) -> Episode | None:
    """Returns an episode from a random start; None: no start of the recipe was found."""
    try:
        drawn = drawer.draw(ask, number, rng)
    except EpisodeError:
        return None
    if not drawn.meets_rule:
        return None
    return Episode(f"{house}_{number}", house, ask.goal, drawn.pose, drawn.distance_m, goals)


def _categories(scene: Scene, objects: Sequence[HouseObject], rng: np.random.Generator) -> Iterable[GoalSpec]:
    """Returns the goal categories of a house."""
    del objects, rng
    return map(GoalSpec.of, scene.task.truth.goals())


def _names(scene: Scene, objects: Sequence[HouseObject], rng: np.random.Generator) -> Iterable[GoalSpec]:
    """Returns everyday names of some objects, and other words for them, that are no goal categories."""
    del scene
    names = list(dict.fromkeys(item.name for item in objects))
    others = [word for name in names for word in rng.permutation(_synonyms(name)).tolist()[:1]]
    return [GoalSpec.of(word) for word in (*names, *others) if word not in GOAL_CATEGORIES]


def _descriptions(scene: Scene, objects: Sequence[HouseObject], rng: np.random.Generator) -> Iterable[GoalSpec]:
    """Returns descriptions of some objects of a house."""
    return map(GoalSpec.of, _described(scene, objects, rng))


def _some_pictures(scene: Scene, objects: Sequence[HouseObject], rng: np.random.Generator) -> Iterable[GoalSpec]:
    """Returns pictures of some objects of a house."""
    return itertools.islice(_pictures(scene, objects, rng), _MAX_PICTURES)


def _goals(args: Args, scene: Scene, rng: np.random.Generator) -> Iterator[GoalSpec]:
    """Yields the goals of a house in random order."""
    objects = _objects(scene, rng)
    if args.kind == "pictures":
        yield from _pictures(scene, objects, rng)
    else:
        yield from map(GoalSpec.of, dict.fromkeys(_texts(args, scene, objects, rng)))


def _pictures(scene: Scene, objects: Sequence[HouseObject], rng: np.random.Generator) -> Iterator[GoalSpec]:
    """Yields pictures of objects of the goal categories, one of each category in turn."""
    pictures, by_category = GoalPictures(scene.task), dict[str, list[HouseObject]]()
    for item in objects:
        if item.instance.category in GOAL_CATEGORIES and item.size_m >= _MIN_PICTURED_M:
            by_category.setdefault(item.instance.category, []).append(item)
    try:
        for item in (item for turn in itertools.zip_longest(*by_category.values()) for item in turn if item):
            camera = pictures.of(item, rng)
            if camera is not None:
                yield GoalSpec(item.instance.name, "picture", camera)
    finally:
        pictures.close()


def _texts(args: Args, scene: Scene, objects: Sequence[HouseObject], rng: np.random.Generator) -> list[str]:
    """Returns names, other words for them, or descriptions, in random order."""
    if args.kind == "descriptions":
        return _described(scene, objects, rng)
    names = list(dict.fromkeys(item.name for item in objects))
    names = [name for name in names if (name in UNSEEN) == (args.kind == "unseen")]
    if args.kind != "synonyms":
        return names
    others = [_synonyms(name) for name in names]
    return [words[int(rng.integers(len(words)))] for words in others if words]


def _objects(scene: Scene, rng: np.random.Generator) -> list[HouseObject]:
    """Returns the objects of a house that may be asked for, in random order."""
    objects = [
        item
        for item in scene.task.truth.meaning.objects
        if item.is_goal and item.size_m >= _MIN_SIZE_M and item.name not in _UNASKED and item.facts.name
    ]
    rng.shuffle(objects)  # type: ignore[arg-type]
    return objects


def _synonyms(name: str) -> list[str]:
    """Returns the words that mean just one name, and are not the name."""
    return sorted(
        word
        for word, (relation, names) in vocabulary().words.items()
        if relation == "synonym" and names == {name} and word not in (name, name.rstrip("s"))
    )


def _described(scene: Scene, objects: Sequence[HouseObject], rng: np.random.Generator) -> list[str]:
    """Returns descriptions of some objects of a house: the levels in turn, each object once."""
    writer, by_level = Descriptions(scene.task, CameraModel()), {level: list[str]() for level in (1, 2, 3)}
    try:
        for item in objects:
            found = list(writer.of(item, rng))
            level = min(by_level, key=lambda level: len(by_level[level]))
            fitting = [description for description in found if description.level == level]
            if fitting:
                by_level[level].append(fitting[int(rng.integers(len(fitting)))].text)
            if min(map(len, by_level.values())) >= _PER_LEVEL:
                break
    finally:
        writer.close()
    most = max(map(len, by_level.values()))
    return [texts[i] for i in range(most) for texts in by_level.values() if i < len(texts)]


Goals = Callable[[Scene, Sequence[HouseObject], np.random.Generator], Iterable[GoalSpec]]
KINDS: Mapping[str, Goals] = MappingProxyType(
    {"category": _categories, "words": _names, "description": _descriptions, "picture": _some_pictures}
)
"""For each kind of goals in chains, what lists those of a house: from objects that may be asked for, at random."""
