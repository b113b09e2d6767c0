"""Searches for goals in the plans of generated houses, and renders the searches as demonstrations for imitation.

    python -m tools.training.plan_demonstrations --houses 200 --episodes 20 --out runs/demonstrations/searches

A house is generated from its seed and exported as a plan (docs/explorers.md). A demonstrator that knows the free space,
but not where the goal is, explores the plan until the goal is in view and drives to it
(`sim.training.plan_env.walks.search`); the small images are rendered at its poses. Searches that do not find the goal
are left out. A file `<out>/<house>_<number>.npz` is one episode (`sim.training.cloned.demonstrations`); the same
command continues a killed run. Train with `stubborn train cloned`.
"""

from __future__ import annotations

import functools
import json
import sys
import time
from dataclasses import dataclass, replace

import msgspec
import numpy as np

from sim.app import cli
from sim.app.commands.houses.plans import house_of, name_of
from sim.app.evaluation.parallel import ordered_map
from sim.core.errors import EpisodeError, HouseError
from sim.core.files import inside, write_atomically
from sim.core.interface import Action, CameraModel, ConfigError
from sim.core.reading import Count, read_json
from sim.homes.housegen.floor_plan.rooms import PlanKind
from sim.homes.housegen.furniture.item import Pool
from sim.homes.housegen.generator import GENERATOR_VERSION, HouseConfig
from sim.homes.plans.episode import draw_goal_and_start
from sim.homes.plans.export import export_plans
from sim.homes.plans.sight import PlanCamera
from sim.renderer.camera import Camera
from sim.training.cloned.demonstrations import demonstrate, write_demonstration
from sim.training.plan_env.walks import search
from sim.world.world import World

PRINT_EVERY_S = 10.0


class Options(msgspec.Struct):
    """The options on which the demonstrations in a house depend, in addition to its seed and its kind."""

    episodes: Count
    size_px: tuple[Count, Count]
    generator: Count


class Note(msgspec.Struct):
    """Record of the finished work in one house: the JSON file next to its demonstrations."""

    options: Options
    episodes: Count
    failed: Count
    frames: Count


@dataclass(frozen=True, kw_only=True)
class Args:
    """Render searches in plans as demonstrations."""

    out: cli.OutFolder
    """Folder of the demonstrations; houses that are there are kept."""
    houses: cli.Count = 100
    """Number of houses."""
    episodes: cli.Count = 20
    """Episodes in each house."""
    pool: Pool = "train"
    """Styles and textures of the houses."""
    kind: PlanKind | None = None
    """Kind of floor plan; drawn when not given."""
    first_seed: cli.Seed = 0
    """The first of the consecutive seeds of the houses."""
    width_px: cli.Count = 64
    """Width of the images."""
    height_px: cli.Count = 48
    """Height of the images."""
    workers: cli.Count = 1
    """Number of processes."""


@dataclass(frozen=True)
class Rendered:
    """The result of one house."""

    episodes: int = 0
    """With success; those of an earlier call count too."""
    failed: int = 0
    frames: int = 0


def main(args: Args) -> int:
    """Runs and renders; returns the exit status."""
    seeds = range(args.first_seed, args.first_seed + args.houses)
    started_s = printed_s = time.monotonic()
    total = Rendered()
    for done, one in enumerate(ordered_map(functools.partial(render_seed, args), seeds, workers=args.workers), 1):
        total = Rendered(total.episodes + one.episodes, total.failed + one.failed, total.frames + one.frames)
        if time.monotonic() - printed_s > PRINT_EVERY_S:
            printed_s = time.monotonic()
            rate = total.frames / (printed_s - started_s)
            print(f"{done} of {args.houses} houses, {total.frames} frames, {rate:.0f} frames/s", flush=True)
    print(f"{args.out}: {total.episodes} episodes with {total.frames} frames; {total.failed} did not succeed")
    return 0


def render_seed(args: Args, seed: int) -> Rendered:
    """Runs and renders the episodes of one house; none if it has no plan."""
    config = HouseConfig(pool=args.pool, kind=args.kind)
    note = inside(args.out, f"{name_of(config, seed)}.json", what="A house")
    options = Options(args.episodes, (args.width_px, args.height_px), GENERATOR_VERSION)
    if note.is_file():
        known = read_json(note, Note, what="The note of a house")
        if known.options != options:
            raise ConfigError(f"'{args.out}' holds demonstrations with {known.options}; take another folder.")
        return Rendered(known.episodes, known.failed, known.frames)
    rendered = _render(args, config, seed)
    content = Note(options, rendered.episodes, rendered.failed, rendered.frames)
    write_atomically(note, json.dumps(msgspec.to_builtins(content)) + "\n")
    return rendered


def _render(args: Args, config: HouseConfig, seed: int) -> Rendered:
    """Runs and renders the episodes of one house that was not done yet."""
    try:
        house = house_of(config, seed)
        plan = next(export_plans(house, {}), None)
    except HouseError:
        return Rendered()
    if plan is None or not plan.goals():
        return Rendered()
    rng = np.random.default_rng(seed)
    look = PlanCamera(plan)
    world = World(house)
    camera = Camera(world.model, world.labels, camera=CameraModel(width_px=args.width_px, height_px=args.height_px))
    result = Rendered()
    try:
        for number in range(args.episodes):
            try:
                goal, start = draw_goal_and_start(plan, rng)
                poses, actions = search(look, goal, start, rng)
                if actions[-1] is not Action.STOP:
                    raise EpisodeError("The goal was not found.")
                shown = demonstrate(poses, actions, world, camera, goal=goal, house=house.name, success=True)
            except EpisodeError:
                result = replace(result, failed=result.failed + 1)
                continue
            write_demonstration(inside(args.out, f"{house.name}_{number:03d}.npz", what="A house"), shown)
            result = replace(result, episodes=result.episodes + 1, frames=result.frames + len(actions))
    finally:
        camera.close()
    return result


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
