"""Runs a robot as a node of ROS 2, which other nodes drive: `stubborn ros`.

    stubborn ros --split val --episodes 20 --out runs/mine
    stubborn ros --stepped --episodes 20 --out runs/stepped

docs/ros.md lists topics, services and parameters. The results are those of `stubborn run`.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, Literal

from sim.app import cli
from sim.app.analysis import display
from sim.app.bridges.ros2.loading import has_frames, overrides, require_ros
from sim.app.options import RunOptions
from sim.core.configuration import with_fields
from sim.core.invocation import command


@dataclass(frozen=True, kw_only=True)
class Args:
    """Run a robot as a node of ROS 2, which other nodes drive to objects."""

    stepped: bool = False
    """Each observation waits for one discrete action on /action; without it, /cmd_vel drives the robot."""
    rate: cli.Positive = 12.5
    """Observations per simulated second; its inverse must be a multiple of 20 ms: 25, 12.5, 10, 5 ..."""
    speed: cli.NotNegative = 1.0
    """Simulated seconds in a second; 0: as fast as possible."""
    time_limit: cli.Positive = 600.0
    """Longest simulated time of an episode, seconds; with --stepped, it ends after 500 actions."""
    command_timeout: cli.Positive = 0.5
    """Simulated seconds after which the robot stops if no other velocity arrives."""
    depth: Literal["16UC1", "32FC1"] = "16UC1"
    """Encoding of depth: whole millimetres, or metres without rounding."""
    wall_time: bool = False
    """Stamps are those of the system's clock, for nodes without use_sim_time; /clock is not published."""
    ground_truth_tf: bool = False
    """Publish the true transform from map to odom; results then use ground truth."""
    map: bool = False
    """Publish the true floor plan on /map; results then use ground truth."""
    wait: bool = False
    """Begin each episode when a node publishes velocities or actions."""
    paused: bool = False
    """Begin with simulated time paused; the service pause starts it."""
    ros_args: str = ""
    """What ROS 2 takes after --ros-args, in quotation marks: "-r /odom:=/wheel/odom -p split:=test". Parameters have
    the names of the options of this command."""
    split: str = "val"
    """A shipped split, or a folder laid out like one."""
    house: Path | None = None
    """One MJCF file in place of a split."""
    labels: Path | None = None
    """With --house: a JSON file {"regex over names": "category"} for a house that has other names."""
    root: Path | None = None
    """With --house: another folder whose files the house may use, in addition to its own folder."""
    robot: str | None = None
    """Replaces the default robot: an MJCF file with its sidecar next to it, or menagerie:NAME (docs/worlds.md)."""
    goal: str | None = None
    """Only this goal category."""
    start_deg: str | None = None
    """With --house: the start pose "X Y YAW" in metres and degrees."""
    episodes: cli.Count = 5
    """The first N episodes of the split; with --house, N episodes are sampled."""
    only: tuple[str, ...] = ()
    """IDs of the episodes of the split to run, in place of the first N."""
    seed: cli.Seed = 0
    """Seed of agents, noise and, with --house, starts and goals."""
    seed_key: str | None = None
    """Key with which agents' seeds are computed from --seed, as for a run."""
    profile: str = "fast"
    """Rendering quality: fast or good."""
    noise: str = "none"
    """Noise of sensors and drive: none, realsense or harsh."""
    config: tuple[str, ...] = ()
    """FIELD=VALUE ...: fields of the configuration, as for a run."""
    config_file: Path | None = None
    """A TOML or JSON file of such fields; --config is applied after it."""
    out: cli.OutFolder | None = None
    """Folder of the results (runs/<time>); an existing run there is resumed."""
    mcap: bool = False
    """Write the published messages of each episode to an MCAP file in <out>/mcap (extra `ros`)."""
    retry_errors: bool = False
    """Run the episodes again that ended with an error in an earlier start of this run."""


def main(args: Args) -> int:
    """Runs the episodes; returns the exit status."""
    require_ros()
    args = with_fields(args, overrides(args.ros_args)) if args.ros_args else args
    if args.mcap:
        from sim.app.viewers.mcap_log import require_mcap

        require_mcap()
    from sim.app.bridges.ros2.robot import RosConfig  # these import MuJoCo
    from sim.app.composition import ros
    from sim.app.composition.environments import episodes_of
    from sim.app.composition.running import run_missing
    from sim.app.composition.setup import resolve
    from sim.app.evaluation.results import NODES_NAME

    names = {field.name for field in fields(RunOptions)} - {"mcap"}
    shared: dict[str, Any] = {name: value for name, value in vars(args).items() if name in names}
    out = args.out or Path("runs") / time.strftime("ros_%Y-%m-%d_%H-%M-%S")
    options = RunOptions(agent=NODES_NAME, **{**shared, "out": out})
    config = RosConfig(
        rate_hz=args.rate,
        time_limit_s=args.time_limit,
        command_timeout_s=args.command_timeout,
        **{name: getattr(args, name) for name in _SAME},
    )
    setup = resolve(options, ros.specification(config))
    console = display.make_console()
    if not has_frames():
        console.print(f"tf2_msgs is not installed: /tf is not published (`{command('ros', 'setup')}` builds it).")
    episodes, split, _ = episodes_of(setup)
    setup = replace(setup, options=replace(options, episodes=len(episodes)))
    if not args.stepped:  # a step is a period
        task = replace(setup.config.task, max_steps=math.ceil(config.time_limit_s / config.period_s - 1e-6))
        setup = replace(setup, config=replace(setup.config, task=task))
    results, summary = run_missing(setup, episodes, split, console, runner=ros.RUNNER)
    display.print_results(console, results, summary)
    return 1 if summary["errors"] else 0


_SAME = ("stepped", "speed", "depth", "wall_time", "ground_truth_tf", "map", "wait", "paused", "mcap", "ros_args")
"""Options that are fields of `RosConfig` of the same name."""
