"""Measures the robots of MuJoCo Menagerie: their motions, bumps, episodes and pictures.

    python -m tools.research.menagerie_tables --out runs/menagerie              # an hour on one core
    python -m tools.research.menagerie_tables --robots pal_tiago --houses 2 --out runs/tiago

The first table has, for each robot, the speed that it reaches on a floor of friction 0.7, the mean errors of forwards
and turns, and what happens at a wall: the largest overlap with it and the change of heading. The second table has one
episode in each of the first houses of a split, with a start where this robot fits and a goal that it can reach.
`<robot>_body.png` and `<robot>_view.png` show the robot and the first view of its camera in the first house.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim.app import cli
from sim.app.commands import run
from sim.app.evaluation.results import read_results
from sim.app.viewers.chase import ChaseView
from sim.core.errors import EpisodeError
from sim.core.files import write_atomically, write_picture
from sim.core.geometry.pose import Pose
from sim.core.interface import FORWARD_M, TURN_RAD, Action, CameraModel
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.splits import load_split
from sim.gl import mujoco
from sim.houses.house import House
from sim.robot.config import RobotConfig
from sim.robot.foreign import load_robot
from sim.robot.menagerie import ENTRIES, PREFIX
from sim.robot.velocity import Velocity
from sim.task.result import EpisodeResult
from sim.world.world import World
from tools.research.lean_tables import Row, floor, show

DEFAULT = "default"
"""The robot of the simulator, for comparison."""
FRICTION = 0.7
WALL_M = 1.0
"""Distance of the wall from the start of a bump."""
ANGLES_DEG = (0.0, 20.0, 45.0)
"""Angles between the heading and the normal of the wall."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Measure the robots of MuJoCo Menagerie (extra `menagerie`)."""

    out: cli.OutFolder
    """Folder of the runs, tables.json and the pictures."""
    robots: str = ",".join((DEFAULT, *ENTRIES))
    """Names with commas between."""
    agents: str = "stubborn,oracle"
    """Agents of the episodes, with ground truth as segmentation; names with commas between."""
    split: str = "val"
    """Split of the houses."""
    houses: cli.Count = 10
    """Number of houses; each has one episode for each robot and agent."""
    seed: cli.Seed = 0
    """Seed of starts and goals."""


def main(args: Args) -> int:
    """Measures, prints and writes the tables; returns the exit status."""
    robots = cli.chosen(args.robots, (DEFAULT, *ENTRIES), option="--robots")
    args.out.mkdir(parents=True, exist_ok=True)
    tables: dict[str, list[Row]] = {}
    for name, rows in (("motions", motions), ("episodes", episodes)):
        tables[name] = [row for robot in robots for row in rows(args, robot)]
        show(name, tables[name])
        write_atomically(args.out / "tables.json", json.dumps(tables, indent=2) + "\n")
    for robot in robots:
        draw(args, robot)
    return 0


def loaded(robot: str) -> tuple[RobotConfig, CameraModel]:
    """Returns a robot and its camera."""
    return (RobotConfig(), CameraModel()) if robot == DEFAULT else load_robot(PREFIX + robot)


def motions(args: Args, robot: str) -> Iterator[Row]:
    """Yields size and speed of a robot, the errors of its motions, and its bumps."""
    del args
    config, camera = loaded(robot)
    world = World(House("floor", floor(FRICTION)), robot=config)
    overlaps_mm, turned_deg = zip(*(bump(config, math.radians(angle)) for angle in ANGLES_DEG), strict=True)
    yield {
        "robot": robot,
        "radius_m": config.body.radius_m,
        "height_m": config.body.height_m,
        "mass_kg": config.body.mass_kg,
        "climbs_mm": 1000.0 * config.climb_m,
        "camera_m": camera.height_m,
        "speed_m_s": top_speed_m_s(world),
        **errors(world),
        "bump_overlap_mm": max(overlaps_mm),
        "bump_turn_deg": max(turned_deg),
    }


def top_speed_m_s(world: World) -> float:
    """Returns the mean speed of the last second of three, with the largest speed as the command."""
    world.reset(Pose(0.0, 0.0, 0.0))
    places = []
    for _ in range(6):
        places.append(world.pose.x_m)
        world.hold(Velocity(world.config.drive.speed_m_s, 0.0), 0.5)
    return world.pose.x_m - places[-2]


def errors(world: World) -> Row:
    """Returns the mean absolute errors of forwards and turns, and their durations."""
    world.reset(Pose(0.0, 0.0, 0.0))
    absolute: dict[str, list[float]] = {}

    def add(name: str, value: float) -> None:
        absolute.setdefault(name, []).append(abs(value))

    for action in (Action.MOVE_FORWARD, Action.TURN_LEFT, Action.MOVE_FORWARD, Action.TURN_RIGHT) * 6:
        before = world.pose
        motion = world.move(action)
        moved = world.pose.relative_to(before)
        if action == Action.MOVE_FORWARD:
            add("forward_mm", 1000.0 * (moved.x_m - FORWARD_M))
            add("sideways_mm", 1000.0 * moved.y_m)
            add("forward_s", motion.duration_s)
        else:
            add("turn_deg", math.degrees(abs(moved.yaw_rad) - TURN_RAD))
            add("turn_s", motion.duration_s)
    return {name: float(np.mean(values)) for name, values in absolute.items()}


def bump(config: RobotConfig, angle_rad: float) -> tuple[float, float]:
    """Drives against a wall; returns the largest overlap, mm, and the change of heading, deg, nan without a bump."""
    spec = floor(FRICTION)
    spec.worldbody.add_geom(
        name="wall_00", type=mujoco.mjtGeom.mjGEOM_BOX, pos=(WALL_M + 0.1, 0.0, 1.25), size=(0.1, 6.0, 1.25)
    )
    world, deepest_m = World(House("bump", spec), robot=config), 0.0
    wall = world.model.geom("wall_00").id

    def sample(model: mujoco.MjModel, data: mujoco.MjData) -> None:
        nonlocal deepest_m
        del model
        contacts = data.contact
        with_wall = (contacts.geom == wall).any(axis=1)
        if with_wall.any():
            deepest_m = max(deepest_m, -float(contacts.dist[with_wall].min()))

    world.reset(Pose(0.0, 0.0, angle_rad))
    mujoco.set_mjcb_control(sample)
    try:
        for _ in range(math.ceil(WALL_M / math.cos(angle_rad) / FORWARD_M) + 1):
            before = world.pose
            if world.move(Action.MOVE_FORWARD).collided:
                return 1000.0 * deepest_m, abs(math.degrees(world.pose.relative_to(before).yaw_rad))
    finally:
        mujoco.set_mjcb_control(None)
    return math.nan, math.nan


def episodes(args: Args, robot: str) -> Iterator[Row]:
    """Yields the results of each agent with a robot."""
    houses = _houses(args)
    for agent in cli.chosen(args.agents, args.agents.split(","), option="--agents"):
        results = [result for house in houses if (result := episode(args, robot, agent, house)) is not None]
        row: Row = {"robot": robot, "agent": agent, "houses": len(houses), "episodes": len(results)}
        for name in ("success", "spl", "collisions", "num_steps", "path_length"):
            row[name] = float(np.mean([getattr(result, name) for result in results])) if results else math.nan
        yield row


def episode(args: Args, robot: str, agent: str, house: Path) -> EpisodeResult | None:
    """Runs an agent for one episode in a house; returns the result, or None if the robot has no room for one."""
    out = args.out / robot / agent / house.stem
    options = ["--house", str(house), "--agent", agent, "--semantics", "gt", "--episodes", "1"]
    options += ["--seed", str(args.seed), "--step-timeout", "0", "--record", "--out", str(out)]
    if robot != DEFAULT:
        options += ["--robot", PREFIX + robot]
    if run.entry(options) != 0 or not (out / "results.jsonl").is_file():
        return None
    return read_results(out / "results.jsonl").values[0]


def draw(args: Args, robot: str) -> None:
    """Writes pictures of a robot and of the first view of its camera."""
    config, camera = loaded(robot)
    env = ObjectNavEnv(house=_houses(args)[0], robot=config, camera=camera, sensors=("rgb",), profile="good")
    try:
        observation, _ = env.reset(seed=args.seed)
    except EpisodeError as error:
        print(f"{robot}: no picture: {error}")
        return
    try:
        view = ChaseView(env.scene, width_px=800, height_px=600)
        write_picture(args.out / f"{robot}_body.png", view.render())
        write_picture(args.out / f"{robot}_view.png", observation["rgb"])
        view.close()
    finally:
        env.close()


def _houses(args: Args) -> list[Path]:
    split = load_split(args.split)
    return [split.house_file(house) for house in split.houses[: args.houses]]


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
