"""A simulated robot behind a `RobotNode`: it is driven by velocities in simulated time, or action by action."""

from __future__ import annotations

import json
import secrets
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import IO

import msgspec
from numpy.typing import NDArray

from sim.app.bridges.ros2.node import RobotNode
from sim.app.bridges.ros2.requests import Pace
from sim.app.evaluation.rollout import play_episode, record_target, rollout_result
from sim.app.evaluation.watch import count_steps
from sim.app.viewers.mcap_log import RosMessages, mcap_file, true_map
from sim.app.viewers.ros import messages
from sim.app.viewers.ros.topics import TOPICS, RobotTopics
from sim.app.viewers.viewer import Viewer
from sim.core.errors import AgentError, ConfigError, PhysicsError
from sim.core.files import part_file
from sim.core.geometry.pose import Pose
from sim.core.interface import Action, Agent, Observation, wrap_angle
from sim.env.objectnav import ObjectNavEnv
from sim.env.velocity import ObjectNavVelocityEnv
from sim.episodes.episode import Episode
from sim.task.result import RolloutResult

SENSORS = ("rgb", "depth", "scan", "imu", "bumper", "odometry")
"""The sensors whose readings are published."""
PUBLISHED = tuple(name for name in TOPICS if name != "/cmd_vel")
BETWEEN_EPISODES_S = 1.0
"""Simulated time between the last message of an episode and the first of the next one."""
BETWEEN_GOALS_S = 0.1
"""Simulated time between the last message for a goal of a chain and the first one for the next: their stamps differ."""
CLOCK_S = 0.1
"""Interval at which `/clock` is repeated while simulated time stands still."""


@dataclass(frozen=True, kw_only=True)
class RosConfig:
    """How a robot runs behind its node."""

    stepped: bool = False
    """Each observation waits for one discrete action; False: the robot is driven by velocities."""
    rate_hz: float = 12.5
    """Observations per simulated second of a robot that is driven by velocities."""
    speed: float = 1.0
    """Simulated seconds in a second; 0: as fast as possible."""
    time_limit_s: float = 600.0
    """Simulated time of an episode that is driven by velocities."""
    command_timeout_s: float = 0.5
    """Simulated time for which a velocity holds if no other one follows."""
    depth: messages.DepthEncoding = "16UC1"
    """Encoding of depth images."""
    wall_time: bool = False
    """Stamps are those of the system's clock, and `/clock` is not published."""
    ground_truth_tf: bool = False
    """Publish the true transform from `map` to `odom`."""
    map: bool = False
    """Publish the true floor plan."""
    wait: bool = False
    """An episode begins when a node publishes velocities or actions."""
    mcap: bool = False
    """Write the published messages of each episode to `mcap/` in the folder of the run."""
    ros_args: str = ""
    """Arguments after `--ros-args`: remappings and parameters of the node."""
    paused: bool = False
    """Simulated time stands still at first, until the service `pause` starts it."""

    def __post_init__(self) -> None:
        if self.speed < 0.0 or self.rate_hz <= 0.0 or self.command_timeout_s <= 0.0:
            raise ConfigError("RosConfig needs speed >= 0, rate_hz > 0 and command_timeout_s > 0.")
        if self.wall_time and (self.stepped or self.speed != 1.0):
            raise ConfigError("--wall-time needs velocities and --speed 1: time does not stand still.")

    @property
    def period_s(self) -> float:
        """Simulated time between two observations."""
        return 1.0 / self.rate_hz

    @property
    def uses_ground_truth(self) -> bool:
        """True: other nodes get the true pose or the true map."""
        return self.ground_truth_tf or self.map


class LiveRobot:
    """Publishes the observations of an environment.

    Args:
        env: with at least the sensors `SENSORS`.
        node: its node.
        config: what is published, and with which stamps.
        recordings: folder of a run, which gets a file of the published messages of each episode; None: no file.
    """

    def __init__(self, env: ObjectNavEnv, node: RobotNode, config: RosConfig, recordings: Path | None = None) -> None:
        self.env, self.node, self.config, self._recordings = env, node, config, recordings
        self._topics = RobotTopics(
            camera=env.camera_model,
            camera_forward_m=env.robot_model.camera_forward_m,
            scan=env.scan_config,
            depth_encoding=config.depth,
        )
        node.advertise([name for name in PUBLISHED if name != "/map" or config.map])
        self._run = secrets.token_hex(4)
        """Tells the episodes of this run from those of another one."""
        self._number, self._goal_number, self._seed, self._offset_s = 0, 0, 0, 0.0
        self._floor_z_m: float | None = None
        self._before: tuple[float, NDArray] | None = None
        self._stream: IO[bytes] | None = None
        self._out: RosMessages | None = None

    def begin(self, goal: str, seed: int) -> None:
        """Starts an episode, after `env.reset`: its number, goal and the fixed frames are published."""
        self.node.requests.begin()
        self._number, self._goal_number, self._seed = self._number + 1, 0, seed
        self._begin_recording()
        start_s = self._simulated_s()
        if self._number > 1:
            self._offset_s = self.node.now_s + BETWEEN_EPISODES_S - start_s
        self._floor_z_m, self._before = None, None
        if self.config.wait:
            self._wait_for_driver()
        self._announce(goal)
        self._send("/tf_static", self.time_s, self._topics.at_start(self.time_s))
        if self.config.paused and self._number == 1:
            self.node.requests.pause(True)

    def next_goal(self, goal: str) -> None:
        """Announces the next goal of a chain, before the first observation of it."""
        self._goal_number += 1
        self._offset_s += BETWEEN_GOALS_S
        self.node.requests.stop_target = self.node.requests.stop_confidence = None
        self._announce(goal)

    def _announce(self, goal: str) -> None:
        """Publishes a goal, after its picture if it has one."""
        time_s, about = self.time_s, {"run": self._run, "number": self._number, "goal_number": self._goal_number}
        picture = self.env.scene.picture_of(self.env.episode.specs[self._goal_number])
        if picture is not None:
            self._send("/goal_image", time_s, messages.colour_image(time_s, picture))
        about |= {"goal": goal, "seed": self._seed, "stamp": messages.stamp(time_s), "picture": picture is not None}
        self._send("/episode", time_s, messages.text(json.dumps(about)))
        self.node.await_readers("/episode")
        self._send("/goal", time_s, messages.text(goal))

    def publish(self, observation: Observation) -> None:
        """Publishes an observation, and the map of a storey that the robot enters."""
        time_s = self.node.now_s = self.time_s
        true = self.env.scene.world.pose
        if not self.config.wall_time:
            self._send("/clock", time_s, {"clock": messages.stamp(time_s)})
        if self.config.map and true.floor_z_m != self._floor_z_m:
            self._floor_z_m = true.floor_z_m
            self._send("/map", time_s, true_map(self.env, time_s))
        known = true if self.config.ground_truth_tf else None
        velocity = self._velocity(time_s, observation["odometry"])
        for topic, message in self._topics.at(time_s, observation, velocity=velocity, true=known):
            self._send(topic, time_s, message)

    def repeat_clock(self) -> None:
        """Publishes the time again, for nodes that come while it stands still."""
        if not self.config.wall_time:
            self.node.publish("/clock", {"clock": messages.stamp(self.node.now_s)})

    def end(self, result: RolloutResult, wall_s: float) -> None:
        """Publishes the result of an episode, with the numbers of messages and periods."""
        self.node.requests.end()
        counts = asdict(self.node.requests.counts)
        speed = round(result.simulated_s / wall_s, 3) if wall_s > 0.0 else None
        about = {"number": self._number, "result": msgspec.to_builtins(result), "node": counts | {"speed": speed}}
        self._send("/result", self.time_s, messages.text(json.dumps(about)))
        if self._out is not None and self._stream is not None:
            self._out.describe("result", msgspec.to_builtins(result.without_times()))
            self._out.finish()
            self._stream.close()
            self._part.replace(self._file)
            self._stream = self._out = None

    def close(self) -> None:
        """Says that no other episode follows, and ends the node; an unfinished recording is discarded."""
        if self._stream is not None:
            self._stream.close()
            self._part.unlink(missing_ok=True)
        if self._number:
            self.node.publish(
                "/episode", messages.text(json.dumps({"run": self._run, "number": self._number, "over": True}))
            )
        self.node.close()

    @property
    def time_s(self) -> float:
        """The stamp of what is published now."""
        return time.time() if self.config.wall_time else self._offset_s + self._simulated_s()

    def _simulated_s(self) -> float:
        """Returns the time of the physics, or that of the actions where there is no physics."""
        world = self.env.scene.world
        if self.env.robot_config.motion == "contacts":
            return float(world.data.time)
        return float(world.data.time) + self.env.scene.task.metrics().simulated_s

    def _velocity(self, time_s: float, odometry: NDArray) -> tuple[float, float]:
        """Returns the mean velocity since the last message, m/s and rad/s, by the robot's odometry."""
        before, self._before = self._before, (time_s, odometry)
        if before is None or time_s <= before[0]:
            return 0.0, 0.0
        period_s = time_s - before[0]
        last, now = (Pose(*values.tolist()) for values in (before[1], odometry))
        return now.relative_to(last).x_m / period_s, wrap_angle(now.yaw_rad - last.yaw_rad) / period_s

    def _send(self, topic: str, time_s: float, message: messages.Message) -> None:
        self.node.publish(topic, message)
        if self._out is not None:
            self._out.write(topic, time_s, message)

    def _begin_recording(self) -> None:
        if self._recordings is None:
            return
        if self._stream is not None:  # of an episode that failed
            self._stream.close()
        self._file = mcap_file(self._recordings, self.env.episode.episode_id)
        self._part = part_file(self._file, what="recording")
        self._stream = self._part.open("wb")
        self._out = RosMessages(self._stream)

    def _wait_for_driver(self) -> None:
        while not self.node.drivers():
            self.node.requests.wait(CLOCK_S)
            self.repeat_clock()


class NodeDriver:
    """An agent that publishes each observation and returns the action that another node chooses."""

    def __init__(self, robot: LiveRobot) -> None:
        self.robot = robot
        self.given_up: str = ""
        """The service that ended the episode, `reset` or `next_episode`; "": none."""

    def reset(self, goal: str, seed: int) -> None:
        """Starts an episode."""
        self.given_up = ""
        self.robot.begin(goal, seed)

    def next_goal(self, goal: str) -> None:
        """Announces the next goal of a chain."""
        self.robot.next_goal(goal)

    def act(self, observation: Observation) -> Action:
        """Publishes the observation and waits for an action.

        Raises:
            AgentError: another node called the service `reset` or `next_episode`.
        """
        requests = self.robot.node.requests
        requests.discard_actions()
        self.robot.publish(observation)
        while True:
            if requests.take("stop"):
                return Action.STOP
            held = requests.paused and not requests.asked("step")
            action = None if held else requests.action(CLOCK_S)
            for name in ("reset", "next_episode"):
                if requests.take(name):
                    self.given_up = name
                    raise AgentError(_GIVEN_UP[name])
            if action is not None:
                requests.take("step")
                return action
            if held:
                requests.wait(CLOCK_S)
            self.robot.repeat_clock()

    def stop_confidence(self) -> float | None:
        """Returns the confidence that the other node stated."""
        return self.robot.node.requests.stop_confidence

    def stop_target_xy_m(self) -> tuple[float, float] | None:
        """Returns the place that the other node stated."""
        return self.robot.node.requests.stop_target

    def close(self) -> None:
        """Ends the node."""
        self.robot.close()


_GIVEN_UP = {"reset": "Another node reset the episode.", "next_episode": "Another node gave the episode up."}


def run_stepped(
    env: ObjectNavEnv,
    agent: Agent,
    episode: Episode,
    *,
    seed: int,
    seed_of_agent: int | None = None,
    viewers: Sequence[Viewer] = (),
    name: str | None = None,
) -> RolloutResult:
    """Runs an episode action by action, as `play_episode`, and publishes its result.

    After a reset it runs again; its result is then an error, because other episodes have one attempt.
    """
    assert isinstance(agent, NodeDriver)
    was_reset = False
    while True:
        begin_s = time.monotonic()
        result = play_episode(env, agent, episode, seed=seed, seed_of_agent=seed_of_agent, viewers=viewers, name=name)
        agent.robot.end(result, time.monotonic() - begin_s)
        if agent.given_up != "reset":
            return _failed(env, result) if was_reset else result
        was_reset = True


def run_driven(
    env: ObjectNavEnv,
    agent: Agent,
    episode: Episode,
    *,
    seed: int,
    seed_of_agent: int | None = None,
    viewers: Sequence[Viewer] = (),
    name: str | None = None,
) -> RolloutResult:
    """Runs an episode of an `ObjectNavVelocityEnv` at the node's pace, and publishes its result; see `run_stepped`.

    Viewers and the agent, a `NodeDriver`, are not asked: velocities come from other nodes. `viewers` and `name` are
    parameters because every function of the type `sim.app.composition.runner.Play` has them.
    """
    assert isinstance(agent, NodeDriver)
    assert isinstance(env, ObjectNavVelocityEnv)
    del viewers, name
    robot, was_reset = agent.robot, False
    while True:
        observation, _ = env.reset(seed=seed, options={"episode": episode})
        robot.begin(episode.specs[0].told, seed if seed_of_agent is None else seed_of_agent)
        begin_s = time.monotonic()
        error = _drive(robot, env, observation)
        wall_s = time.monotonic() - begin_s
        metrics = env.scene.task.metrics()
        result = rollout_result(
            metrics, error, robot.node.requests.stop_confidence, round(wall_s, 3), round(metrics.num_steps / wall_s, 2)
        )
        robot.end(result, wall_s)
        if error != _GIVEN_UP["reset"]:
            return _failed(env, result) if was_reset else result
        was_reset = True


def _drive(robot: LiveRobot, env: ObjectNavVelocityEnv, observation: Observation) -> str | None:
    """Drives until the episode is over; returns the error that ended it, or None."""
    requests, config, task = robot.node.requests, robot.config, env.scene.task
    pace, done, stopped = Pace(env.period_s, config.speed), False, False
    robot.publish(observation)
    while not done:
        stop = requests.take("stop")
        for name in ("reset", "next_episode"):
            if requests.take(name):
                return _GIVEN_UP[name]
        if requests.paused and not stop and not requests.take("step"):
            requests.wait(CLOCK_S)
            robot.repeat_clock()
            pace.restart()
            continue
        if not stop and not requests.paused and pace.remaining_s() > 0.0:
            requests.wait(pace.remaining_s())
            continue
        requests.counts.periods += 1
        requests.counts.late_periods += pace.begin()
        if stop:
            record_target(env, observation, requests.stop_target)
        goal_number = task.goal_number
        try:
            speed, rate = requests.velocity(robot.node.now_s, config.command_timeout_s)
            observation, _, stopped, out_of_time, _ = env.step((speed, rate, float(stop)))
        except PhysicsError as failure:
            return str(failure)
        count_steps(requests.counts.periods)
        done = stopped or out_of_time
        if task.goal_number != goal_number:
            robot.next_goal(task.goals[task.goal_number].told)
        robot.publish(observation)
    return None


def _failed(env: ObjectNavEnv, result: RolloutResult) -> RolloutResult:
    """Returns the result of an episode that was reset: an error, because other episodes have one attempt."""
    metrics = env.scene.task.metrics()
    return rollout_result(metrics, _GIVEN_UP["reset"], None, result.wall_time_s or 0.0, result.steps_per_s or 0.0)
