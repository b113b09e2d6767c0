"""Writes traps of families and their episodes in the layout of a split: an MJCF file and a sidecar for each trap.

    stubborn traps --family pane_gap --seed 10 --count 5 --difficulty hard --out my_traps
    stubborn traps --split contact-val --out assets/mjcf_houses/contact-val

A trap of a family (`sim.homes.housegen.traps.families`) depends on a difficulty and a seed, and has one episode. The
same code gives the same bytes. The scenes of the split `traps` are fixed: the files of assets/mjcf_houses/traps.
"""

from __future__ import annotations

import functools
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from sim.app import cli
from sim.app.evaluation.parallel import ordered_map
from sim.core.errors import ConfigError, HouseError
from sim.core.files import write_atomically
from sim.core.paths import assets_dir
from sim.core.vocabulary import counted
from sim.episodes import habitat
from sim.episodes.episode import Episode
from sim.episodes.reachable_goals import find_reachable_goals
from sim.episodes.splits import write_split
from sim.homes.housegen.mjcf.builder import TEXTURE_DIR
from sim.homes.housegen.splits.recipes import SPLIT_VERSION
from sim.homes.housegen.traps.families.catalogue import CONTACT_SPLITS, FAMILIES, HELD_OUT, TrapKey, in_turns
from sim.homes.housegen.traps.families.draw import draw_trap
from sim.homes.housegen.traps.families.family import DIFFICULTIES, Difficulty
from sim.homes.housegen.traps.trap import Trap
from sim.houses.load import load_house
from sim.houses.sidecar import write_sidecar
from sim.task.objectnav import Task
from sim.world.world import World

MAX_VIEW_POINTS = 2
"""Largest number of view points of a goal in the episodes."""
SAME_PATH_M = 0.002
"""Largest difference between the path in a scene and in its file, whose numbers are rounded."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Make traps of families and their episodes."""

    out: cli.OutFolder
    """Folder for the scenes; its name is the name of the split."""
    family: str | None = None
    """Family of the traps, for example pane_gap, jam or ledge; give this or --split."""
    split: Literal["contact-val", "contact-test", "contact-heldout"] | None = None
    """Shipped split whose traps are made again; give this or --family."""
    difficulty: Difficulty | None = None
    """With --family: the difficulty; all three when not given."""
    seed: cli.Seed = 10
    """With --family: the first seed. Seeds from 10 on are in no shipped split."""
    count: cli.Count = 1
    """With --family: number of consecutive seeds."""
    workers: cli.Count = 1
    """Number of processes."""
    version: str = SPLIT_VERSION
    """Version of the split."""


def main(args: Args) -> int:
    """Writes the scenes and their episodes.

    Raises:
        ConfigError: neither a family nor a split was given, or both.
    """
    if (args.family is None) == (args.split is None):
        raise ConfigError(f"Name either a family (--family {', '.join(FAMILIES)}) or a split (--split contact-val).")
    if args.split is not None:
        cli.require_unset(args, ("difficulty", "seed", "count"), "needs --family: the traps of a split are fixed.")
        return write_family_traps(args, CONTACT_SPLITS[args.split])
    assert args.family is not None
    if args.family in HELD_OUT:
        print(f"note: '{args.family}' is held out: measure agents on its traps, but develop none on them")
    difficulties = DIFFICULTIES if args.difficulty is None else (args.difficulty,)
    keys = in_turns((args.family,), difficulties, range(args.seed, args.seed + args.count))
    return write_family_traps(args, list(keys))


def write_family_traps(args: Args, keys: Sequence[TrapKey]) -> int:
    """Writes traps, each with one episode."""
    episodes: list[Episode] = []
    goals: dict[str, dict[str, list[habitat.Goal]]] = {}
    write = functools.partial(write_family_trap, args.out)
    for episode, listed, line in ordered_map(write, keys, workers=args.workers):
        episodes.append(episode)
        goals[episode.house] = listed
        print(line, flush=True)
    write_split(args.out, episodes, goals, version=args.version)
    return 0


def write_family_trap(folder: Path, key: TrapKey) -> tuple[Episode, dict[str, list[habitat.Goal]], str]:
    """Writes one trap; returns its episode, its goals in Habitat's form, and a line about it."""
    made = draw_trap(*key)
    facts, trap = made.facts, made.trap
    name = trap.site.spec.modelname
    write_scene(folder / f"{name}.xml", trap)
    task = Task(World(load_house(folder / f"{name}.xml")))
    listed = find_reachable_goals(task, max_view_points=MAX_VIEW_POINTS).listed
    distance_m = task.distance_from(trap.goal, trap.start)
    if distance_m is None or abs(distance_m - facts.shortest_path_m) > SAME_PATH_M:
        raise HouseError(f"Trap '{name}': the path is {distance_m} m long in its file, not {facts.shortest_path_m} m.")
    line = (
        f"{name}: {facts.shortest_path_m:.1f} m instead of {facts.open_path_m:.1f} m, {facts.fewest_actions} actions, "
        f"gap {facts.gap_m:.2f} m, {counted(facts.hidden_objects, 'hidden object')}"
    )
    episode = Episode(f"{name}_0", name, trap.goal, trap.start, distance_m)
    return episode, {goal: places for goal, places in listed.items() if goal == trap.goal}, line


def write_scene(path: Path, trap: Trap) -> None:
    """Writes one scene, which refers to the shipped textures by a relative path, and its sidecar."""
    textures = os.path.relpath(assets_dir() / "textures", path.parent.resolve())
    xml = trap.site.spec.to_xml().replace(f'texturedir="{TEXTURE_DIR}"', f'texturedir="{textures}"', 1)
    write_atomically(path, xml)
    write_sidecar(path, trap.sidecar)
