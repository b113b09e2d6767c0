"""Runs episodes of a robot that other nodes of ROS 2 drive (`sim.app.bridges.ros2`)."""

from __future__ import annotations

from dataclasses import asdict
from typing import NoReturn

from sim.app.bridges.ros2.node import RobotNode
from sim.app.bridges.ros2.robot import SENSORS, LiveRobot, NodeDriver, RosConfig, run_driven, run_stepped
from sim.app.composition.environments import env_options, make_env
from sim.app.composition.runner import EpisodeRunner, Parts
from sim.app.composition.setup import Setup
from sim.core.configuration import as_json
from sim.core.errors import ConfigError
from sim.core.interface import AgentSpec
from sim.core.invocation import command
from sim.env.velocity import ObjectNavVelocityEnv

RUNNER = "sim.app.composition.ros:runner"
"""Makes the runner, for `run_missing`."""


def _make_nothing(**_: object) -> NoReturn:
    raise ConfigError(f"Other nodes drive a robot of `{command('ros')}`.")


def specification(config: RosConfig) -> AgentSpec:
    """Returns the declaration of the nodes that drive the robot."""
    return AgentSpec(
        make=_make_nothing,
        description="other nodes of ROS 2",
        config=config,
        sensors=SENSORS,
        uses_segmentation=False,
        words=(),
        pictures=(),
        uses_ground_truth=config.uses_ground_truth,
    )


def runner(setup: Setup) -> EpisodeRunner:
    """Returns the runner of a robot that other nodes drive.

    Raises:
        ConfigError: ROS 2 is missing, or an option is not allowed.
    """
    return EpisodeRunner(setup, _make_parts)


def _make_parts(setup: Setup) -> Parts:
    config, options = setup.config.agent, setup.options
    assert isinstance(config, RosConfig)
    if config.stepped:
        env, play = make_env(setup, sensors=setup.sensors), run_stepped
    else:
        env, play = _velocity_env(setup, config), run_driven
    parameters = {name: value for name, value in as_json(asdict(options)).items() if value is not None and value != []}
    parameters |= {name: value for name, value in as_json(asdict(config)).items() if value is not None}
    node = RobotNode(ros_args=config.ros_args, parameters=parameters, stepped=config.stepped)
    robot = LiveRobot(env, node, config, options.out if config.mcap else None)
    return Parts(env, NodeDriver(robot), seen=None, painter=None, play=play)


def _velocity_env(setup: Setup, config: RosConfig) -> ObjectNavVelocityEnv:
    return ObjectNavVelocityEnv(
        period_s=config.period_s, time_limit_s=config.time_limit_s, sensors=setup.sensors, **env_options(setup)
    )
