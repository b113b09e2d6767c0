"""`--mcap`: writes each episode as an MCAP file of standard ROS 2 messages (https://mcap.dev), the extra `ros`.

Topics, types and quality of service are those of `sim.app.viewers.ros.topics`: images, scan, `/odom`, `/pose`, `/tf`
and the velocity that the action aims at (`/cmd_vel`) once before each action, `/imu` and `/bumper` if the agent
observes them, `/tf_static` once, and `/map` when a storey is entered. The true frame `map` is in `/tf`.

An image or scan that the agent does not observe is the true one. Times are simulated. Metadata `episode` and `result`
hold the identity and the result of the episode as JSON. Each episode has its file `<out>/mcap/<episode_id>.mcap`.
"""

from __future__ import annotations

import contextlib
import importlib.util
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import IO

import cv2
import msgspec
import numpy as np
from numpy.typing import NDArray

from sim.app.viewers.ros import messages
from sim.app.viewers.ros.definitions import definition
from sim.app.viewers.ros.topics import TOPICS, RobotTopics, offered_qos_profiles
from sim.app.viewers.viewer import Moment
from sim.core.errors import ConfigError
from sim.core.files import episode_file, part_file
from sim.core.interface import SCAN, Action
from sim.core.reading import reason_of
from sim.env.objectnav import ObjectNavEnv
from sim.sensors.scan import ScanSensor
from sim.sensors.sensor import SensorContext
from sim.task.result import RolloutResult
from sim.world.freespace import FreeSpace, covered

FOLDER = "mcap"


def require_mcap() -> None:
    """Raises ConfigError where the writer of MCAP files is not installed."""
    if importlib.util.find_spec("mcap_ros2") is None:
        raise ConfigError(
            "--mcap needs the package mcap-ros2-support, an extra: pip install 'stubborn-objectnav[ros]'."
        )


def mcap_file(run: Path, episode_id: str) -> Path:
    """Returns the recording of an episode."""
    return episode_file(run / FOLDER, episode_id, ".mcap")


class RosMessages:
    """Writes messages by topic to one MCAP file.

    Args:
        stream: the file, open for writing.
    """

    def __init__(self, stream: IO[bytes]) -> None:
        from mcap_ros2.writer import Writer

        self._writer = Writer(stream)
        self._channels: set[str] = set()
        names = {topic.type for topic in TOPICS.values()}
        self._schemas = {
            name: self._writer.register_msgdef(name.replace("/", "/msg/"), definition(name)) for name in sorted(names)
        }

    def write(self, topic: str, time_s: float, message: messages.Message) -> None:
        """Writes one message at a simulated time."""
        if topic not in self._channels:
            self._add_channel(topic)
        self._writer.write_message(topic, self._schemas[TOPICS[topic].type], message, round(time_s * 1e9))

    def _add_channel(self, topic: str) -> None:
        """Adds the channel of a topic with its quality of service, for which the writer has no argument."""
        kind, delivery = TOPICS[topic]
        channel = self._writer._writer.register_channel(
            topic=topic,
            message_encoding="cdr",
            schema_id=self._schemas[kind].id,
            metadata={"offered_qos_profiles": offered_qos_profiles(delivery)},
        )
        self._writer._channel_ids[topic] = channel
        self._channels.add(topic)

    def describe(self, name: str, content: Mapping[str, object]) -> None:
        """Writes metadata: a name, and JSON values by key."""
        self._writer.add_metadata(name, {key: json.dumps(value) for key, value in content.items()})

    def finish(self) -> None:
        """Writes the index of the file."""
        self._writer.finish()


class McapLog:
    """A viewer that records each episode as ROS 2 messages (`sim.app.viewers.viewer.Viewer`).

    Args:
        run: folder of the run.
    """

    def __init__(self, run: Path) -> None:
        self._run = run
        self._stream: IO[bytes] | None = None
        self._part = Path()
        self._floor_z_m: float | None = None
        """Floor of the storey whose map was written last."""

    @contextlib.contextmanager
    def _writing(self) -> Iterator[None]:
        """Raises ConfigError with the name of the file where it cannot be written, for example on a full disk."""
        try:
            yield
        except OSError as error:
            file = mcap_file(self._run, self._env.episode.episode_id)
            raise ConfigError(f"Cannot write the recording '{file}': {reason_of(error)}.") from None

    def begin(self, env: ObjectNavEnv) -> None:
        """Starts the episode's file."""
        self.close()
        self._env, self._floor_z_m = env, None
        self._part = part_file(mcap_file(self._run, env.episode.episode_id), what="recording")
        with self._writing():
            self._begin(env)

    def _begin(self, env: ObjectNavEnv) -> None:
        episode = env.episode
        self._stream = self._part.open("wb")
        self._out = RosMessages(self._stream)
        scans = [sensor for sensor in env.sensors if isinstance(sensor, ScanSensor)]
        self._scan = scans[0] if scans else ScanSensor(config=env.scan_config)
        self._robot = RobotTopics(
            camera=env.camera_model, camera_forward_m=env.robot_model.camera_forward_m, scan=self._scan.config
        )
        about = {"episode_id": episode.episode_id, "house": episode.house, "goal": episode.goal}
        self._out.describe("episode", about)
        time_s = float(env.scene.world.data.time)
        self._out.write("/tf_static", time_s, self._robot.at_start(time_s))

    def decided(self, moment: Moment) -> None:
        """Writes what the agent saw, where it was and what it does."""
        with self._writing():
            self._write(moment)

    def _write(self, moment: Moment) -> None:
        env, out = self._env, self._out
        world, time_s = env.scene.world, float(env.scene.world.data.time)
        floor_z_m = world.pose.floor_z_m
        if floor_z_m != self._floor_z_m:
            self._floor_z_m = floor_z_m
            out.write("/map", time_s, true_map(env, time_s))
        own = world.odometry
        readings = {
            "odometry": np.array([own.x_m, own.y_m, own.yaw_rad], np.float32),
            **moment.observation,
            "rgb": moment.seen("rgb"),
            "depth": moment.seen("depth"),
            "scan": self._scan_at(moment),
        }
        for topic, message in self._robot.at(time_s, readings, true=world.pose):
            out.write(topic, time_s, message)
        out.write("/cmd_vel", time_s, self._command(moment.action))

    def moved(self, info: Mapping[str, object]) -> None:
        """Does nothing: the next decision shows the outcome."""

    def end(self, result: RolloutResult) -> None:
        """Writes the result and completes the file."""
        assert self._stream is not None
        with self._writing():
            self._out.describe("result", msgspec.to_builtins(result.without_times()))
            self._out.finish()
            self._stream.close()
        self._stream = None
        self._part.replace(mcap_file(self._run, self._env.episode.episode_id))

    def close(self) -> None:
        """Discards the recording of an unfinished episode."""
        if self._stream is not None:
            with contextlib.suppress(OSError):  # a full disk: `close` writes what it holds, and frees it all the same
                self._stream.close()
            self._stream = None
            self._part.unlink(missing_ok=True)

    def _scan_at(self, moment: Moment) -> NDArray[np.float32]:
        """Returns the scan that the agent observed, or the true one."""
        if SCAN in moment.observation:
            return moment.observation[SCAN]
        world = self._env.scene.world
        fields = {"pose": world.body_pose, "model": world.model, "data": world.data, "glass": world.glass}
        return self._scan.read(SensorContext(self._scan, {}, **fields))

    def _command(self, action: Action) -> messages.Message:
        """Returns the velocity that the drive aims at in an action."""
        drive = self._env.robot_config.drive
        turn = {Action.TURN_LEFT: drive.turn_speed_rad_s, Action.TURN_RIGHT: -drive.turn_speed_rad_s}
        return messages.twist(drive.speed_m_s if action == Action.MOVE_FORWARD else 0.0, turn.get(action, 0.0))


def true_map(env: ObjectNavEnv, time_s: float) -> messages.Message:
    """Returns `nav_msgs/OccupancyGrid` of the floor plan of the storey that the robot is on."""
    floor_z_m = env.scene.world.pose.floor_z_m
    space = env.scene.task.truth.space(floor_z_m)
    return messages.occupancy_grid(time_s, space.frame, *_occupied_and_free(space), floor_z_m)


def _occupied_and_free(space: FreeSpace) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Returns the masks (rows, cols) of obstacles, and of the floor that the robot's body can cover."""
    frame = space.frame
    radius = round(space.radius_m / frame.cell_m)
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * radius + 1, 2 * radius + 1))
    return covered(frame, space.obstacles), cv2.dilate(space.free.astype(np.uint8), disc).astype(np.bool_)
