"""Runs an agent as a node of ROS 2, which drives a robot over topics: `stubborn ros agent`.

    stubborn ros agent --agent stubborn-plus --stepped
    stubborn ros agent --agent stubborn-plus --pose /odom

No simulator runs in this process; the robot may be `stubborn ros`, or a real one (docs/ros.md).
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Literal

from sim.app.bridges.ros2.loading import require_ros
from sim.app.composition.agents import find_agent
from sim.app.options import RunOptions
from sim.core.errors import ConfigError
from sim.core.vocabulary import counted


@dataclass(frozen=True, kw_only=True)
class Args:
    """Run an agent as a node of ROS 2, which drives a robot over topics."""

    stepped: bool = False
    """The robot waits for an action after each observation (`stubborn ros --stepped`); otherwise the node performs each
    action by velocities on /cmd_vel, and reads /odom."""
    pose: Literal["/pose", "/odom"] = "/pose"
    """Topic of the robot's pose: that of ObjectNav's sensors or of a localisation, or the robot's odometry."""
    words: bool = False
    """The robot's goals are in words: the agent gets the sensors that it reads for them in addition."""
    pictures: bool = False
    """The robot's goals may be pictures, on /goal_image: the agent gets the sensors that it reads for them in
    addition."""
    once: bool = False
    """End after the last episode of the robot, in place of waiting for others."""
    ros_args: str = ""
    """What ROS 2 takes after --ros-args, in quotation marks: "-r /pose:=/localization"."""
    agent: str = "stubborn-plus"
    """The agent: a name of `stubborn run --list-agents`, or your own as package.module:NAME."""
    explorer: str | None = None
    """The explorer of agents that take one."""
    semantics: str = "rednet"
    """Source of segmentation: rednet, or your own as package.module:NAME."""
    weights: Path | None = None
    """With --semantics rednet: your network in place of the shipped one."""
    verification: str = "naive-bayes"
    """Method that verifies candidates: naive-bayes (the paper's) or none."""
    verifier: Path | None = None
    """Parameters of verification in place of those shipped for this segmentation."""
    robot: str | None = None
    """The robot, if it is not the default one: an MJCF file with its sidecar next to it, or menagerie:NAME."""
    config: tuple[str, ...] = ()
    """FIELD=VALUE ...: fields of the configuration, for example camera.height_m=1.1 robot.drive.speed_m_s=0.3."""
    config_file: Path | None = None
    """A TOML or JSON file of such fields; --config is applied after it."""


def main(args: Args) -> int:
    """Drives until it is interrupted, or with --once until the robot's last episode; returns the exit status."""
    spec = find_agent(args.agent)
    if args.words and spec.words is None:
        raise ConfigError(f"--words: agent '{args.agent}' takes categories only.")
    if args.pictures and spec.pictures is None:
        raise ConfigError(f"--pictures: agent '{args.agent}' takes no pictures.")
    require_ros()
    from sim.app.bridges.ros2.observer import AgentNode
    from sim.app.composition.ros_agent import RobotAgent
    from sim.app.composition.setup import resolve

    names = {field.name for field in fields(RunOptions)}
    setup = resolve(RunOptions(**{name: value for name, value in vars(args).items() if name in names}), spec)
    words, pictures = (spec.words or ()) if args.words else (), (spec.pictures or ()) if args.pictures else ()
    sensors = dict.fromkeys((*setup.config.sensors, *words, *pictures))
    node = AgentNode(setup.config.camera, (*sensors,), stepped=args.stepped, pose=args.pose, ros_args=args.ros_args)
    try:
        agent = RobotAgent(setup, node, stepped=args.stepped, words=args.words, pictures=args.pictures)
        print(f"{args.agent} waits for a robot.", flush=True)
        episodes = agent.run(once=args.once, report=functools.partial(print, flush=True))
    finally:
        node.close()
    print(f"{args.agent} drove in {counted(episodes, 'episode')}.")
    return 0
