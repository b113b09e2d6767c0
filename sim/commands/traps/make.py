"""Writes the trap scenes and their episodes in the layout of a split: an MJCF file and a sidecar for each trap.

    stubborn traps --out assets/mjcf_houses/traps

Each trap has three episodes: at the start of its sidecar, with three headings. The same code gives the same bytes.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from sim import cli
from sim.episodes import habitat
from sim.episodes.reachable_goals import find_reachable_goals
from sim.episodes.recipes import START_TURNS_RAD
from sim.episodes.splits import Episode, write_split
from sim.errors import HouseError
from sim.files import write_atomically
from sim.housegen.mjcf.builder import TEXTURE_DIR
from sim.housegen.splits.recipes import SPLIT_VERSION
from sim.housegen.traps.catalogue import TRAPS
from sim.housegen.traps.trap import Trap
from sim.houses.load import load_house
from sim.houses.sidecar import write_sidecar
from sim.interface import wrap_angle
from sim.paths import assets_dir
from sim.task.objectnav import Task
from sim.world.world import World


@dataclass(frozen=True, kw_only=True)
class Args:
    """Make the trap scenes and their episodes."""

    out: cli.OutFolder
    """Folder for the scenes; its name is the name of the split."""
    version: str = SPLIT_VERSION
    """Version of the split."""


def main(args: Args) -> int:
    """Writes all scenes and their episodes."""
    episodes: list[Episode] = []
    goals: dict[str, dict[str, list[habitat.Json]]] = {}
    for name, make in TRAPS.items():
        trap = make()
        path = args.out / f"{name}.xml"
        write_scene(path, trap)
        task = Task(World(load_house(path)))
        goals[name] = {goal: listed for goal, listed in find_reachable_goals(task).listed.items() if goal == trap.goal}
        episodes += draw_episodes(name, trap, task)
        print(f"{name}: {episodes[-1].shortest_path_m:.1f} m, {path.stat().st_size / 1000:.0f} KB")
    write_split(args.out, list(in_turns(episodes)), goals, version=args.version)
    return 0


def write_scene(path: Path, trap: Trap) -> None:
    """Writes one scene, which refers to the shipped textures by a relative path, and its sidecar."""
    textures = os.path.relpath(assets_dir() / "textures", path.parent.resolve())
    xml = trap.site.spec.to_xml().replace(f'texturedir="{TEXTURE_DIR}"', f'texturedir="{textures}"', 1)
    write_atomically(path, xml)
    write_sidecar(path, trap.sidecar)


def draw_episodes(name: str, trap: Trap, task: Task) -> list[Episode]:
    """Returns one episode for each start heading.

    Raises:
        HouseError: there is no path from the start to the goal.
    """
    found = []
    for i, yaw_rad in enumerate(START_TURNS_RAD):
        start = replace(trap.start, yaw_rad=round(wrap_angle(trap.start.yaw_rad + yaw_rad), 4))
        task.world.reset(start)
        distance_m = task.distance_from(trap.goal, start)
        if distance_m is None:
            raise HouseError(f"Trap '{name}': there is no path from its start to '{trap.goal}'.")
        found.append(Episode(f"{name}_{i}", name, trap.goal, start, distance_m))
    return found


def in_turns(episodes: list[Episode]) -> Iterator[Episode]:
    """Yields the first episode of every trap, then the second of every trap, and so on."""
    for i in range(len(START_TURNS_RAD)):
        yield from episodes[i :: len(START_TURNS_RAD)]
