"""Builds an agent without a simulator and lets it drive a robot over topics of ROS 2 (`sim.app.bridges.ros2`)."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, cast

from sim.app.bridges.ros2.observer import AgentNode, Announced, Wheels
from sim.app.composition.agents import build_agent
from sim.app.composition.own_segmentation import OwnSegmenter
from sim.app.composition.segmenters import NoSegmentation
from sim.app.composition.setup import Setup
from sim.app.evaluation.rollout import ask, confidence_of, give_next_goal, next_action, target_of
from sim.core.errors import AgentError, ConfigError
from sim.core.interface import GOAL_CATEGORIES, Action, Agent, CameraModel, Observation, RobotModel, SuccessRule
from sim.core.vocabulary import with_article
from sim.env.discrete import ActionController, Limits
from sim.robot.config import RobotConfig
from sim.task.config import TaskConfig

WAIT_S = 0.1
"""Longest time for which a call of ROS 2 waits, so that Ctrl-C is noticed."""


@dataclass(frozen=True, kw_only=True)
class DeclaredRobot:
    """A robot as the configuration describes it (`sim.app.composition.agents.KnownRobot`)."""

    camera_model: CameraModel
    robot_config: RobotConfig
    task_config: TaskConfig

    @property
    def robot_model(self) -> RobotModel:
        """The part of the robot that agents know."""
        return self.robot_config.model

    @property
    def success_rule(self) -> SuccessRule:
        """The conditions under which a STOP succeeds."""
        return self.task_config.success


def build_apart(setup: Setup) -> Agent:
    """Returns the agent of a setup, which gets observations and nothing else.

    Raises:
        ConfigError: the agent or its segmentation reads the ground truth of the simulator, or has sensors of its own,
            or the agent reads posteriors that its segmentation does not have.
    """
    spec, config = setup.spec, setup.config
    if spec.uses_ground_truth or setup.truth:
        named = setup.options.agent if spec.uses_ground_truth else f"--semantics {setup.options.semantics}"
        raise ConfigError(f"'{named}' reads ground truth, which a robot does not have.")
    own = [sensor.name for sensor in setup.sensors if not isinstance(sensor, str)]
    if own:
        raise ConfigError(f"The sensor '{own[0]}' is one of the simulator's; a robot has no topic for it.")
    robot = DeclaredRobot(camera_model=config.camera, robot_config=config.robot, task_config=config.task)
    make = cast(Any, setup.segmentation.make)  # a segmenter without ground truth reads the camera alone
    segmenter = make(robot, config.detector) if spec.uses_segmentation else NoSegmentation()
    agent = build_agent(
        setup.options.agent, spec, robot, segmenter=segmenter, verifier=setup.verifier, config=config.agent
    )
    if isinstance(segmenter, OwnSegmenter):
        segmenter.require_read_by(agent, setup.options.agent)
    return agent


class RobotAgent:
    """An agent that drives a robot over topics, episode by episode.

    Args:
        setup: of the agent.
        node: its node.
        stepped: whether the robot waits for an action after each observation.
        words: whether the agent takes goals in words.
        pictures: whether the agent takes pictures as goals; other goals are categories.
    """

    def __init__(
        self, setup: Setup, node: AgentNode, *, stepped: bool, words: bool = False, pictures: bool = False
    ) -> None:
        self._name, self._node, self._stepped = setup.options.agent, node, stepped
        self._spec, self._words, self._pictures = setup.spec, words, pictures
        self._agent = build_apart(setup)
        drive = setup.config.robot.drive
        self._limits = Limits(
            drive.speed_m_s, drive.turn_speed_rad_s, drive.acceleration_m_s2, drive.turn_acceleration_rad_s2
        )

    def run(self, *, once: bool, report: Callable[[str], object] = lambda _: None) -> int:
        """Drives in each episode that the robot announces; returns their number.

        Args:
            once: end when the robot says that its last episode is over; False: wait for others.
            report: called with a sentence about each goal when the search for it begins.

        Raises:
            AgentError: the agent failed, or does not take a goal.
        """
        episodes, last = 0, None
        while True:
            announced = self._node.announced
            if announced is not None and announced.over and once:
                return episodes
            if announced is None or announced.over or announced == last:
                self._node.spin(WAIT_S)
                continue
            self._require_taken(announced)
            if announced.is_next_goal_of(last):
                where = f"Agent '{self._name}', goal {announced.goal_number + 1}"
                give_next_goal(self._agent, announced.goal, announced.seed, where)
            else:
                episodes += 1
                agent, where = self._agent, f"Agent '{self._name}', reset"
                ask(where, functools.partial(agent.reset, announced.goal, announced.seed))
            last = announced
            goal = "the object of the picture" if announced.picture else with_article(announced.goal)
            number = f", goal {announced.goal_number + 1}" if announced.goal_number else ""
            report(f"Episode {episodes}{number}: looking for {goal}.")
            self._pursue(announced)

    def _require_taken(self, announced: Announced) -> None:
        """Raises AgentError if the agent was started without the option for a goal of this kind."""
        if announced.picture and not self._pictures:
            what, takes, option = "goal is a picture", self._spec.pictures, "--pictures"
        elif not announced.picture and announced.goal not in GOAL_CATEGORIES and not self._words:
            what, takes, option = f"goal '{announced.goal}' is in words", self._spec.words, "--words"
        else:
            return
        advice = f"agent '{self._name}' does not take it" if takes is None else f"give {option}"
        raise AgentError(f"The robot's {what}: {advice}.")

    def _pursue(self, announced: Announced) -> None:
        """Drives until the episode, or the goal of a chain, is over."""
        agent = self._agent
        driver = None if self._stepped else _Driver(self._node, announced, self._limits)
        seen_ns, step = announced.stamp_ns - 1, 0
        while (observed := self._next(announced, seen_ns)) is not None:
            (seen_ns, observation), step = observed, step + 1
            where = f"Agent '{self._name}', step {step}"
            action = next_action(agent, observation, where)
            if action is Action.STOP:
                self._node.state(target_of(agent, where), confidence_of(agent, where))
            if driver is None:
                self._node.act(action)
            elif action is Action.STOP:
                return self._node.stop()
            else:
                seen_ns = driver.perform(action)
        return None

    def _next(self, announced: Announced, after_ns: int) -> tuple[int, Observation] | None:
        """Returns the first complete observation after a stamp; None: the goal is over."""
        while self._node.announced == announced:
            if (observed := self._node.observation(after_ns)) is not None:
                return observed
            self._node.spin(WAIT_S)
        return None


class _Driver:
    """Performs discrete actions by velocities."""

    def __init__(self, node: AgentNode, announced: Announced, limits: Limits) -> None:
        self._wheels = Wheels(node, announced)
        period_s = self._wheels.period_s
        self._controller = ActionController(
            self._wheels.hold, limits, period_s, self._wheels.at_rest(), delay_s=period_s
        )

    def perform(self, action: Action) -> int:
        """Performs an action; returns the stamp (ns) of the state after it."""
        self._controller.perform(action)
        return self._wheels.stamp_ns - 1
