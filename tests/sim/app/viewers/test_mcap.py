"""Recordings of ROS 2 messages: read by `rosbags`, which shares no code with the writer, they show the episode."""

from __future__ import annotations

import errno
import json
import math
import os
from collections import defaultdict
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from sim.app.evaluation.rollout import play_episode
from sim.app.viewers import mcap_log
from sim.app.viewers.mcap_log import McapLog, mcap_file
from sim.app.viewers.ros import messages
from sim.app.viewers.ros.definitions import FIELDS, definition
from sim.app.viewers.ros.topics import COLOUR, DEPTH, TOPICS
from sim.core.geometry.pose import Pose
from sim.core.interface import Action, CameraModel, ConfigError, Observation
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.sensors.scan import ScanConfig
from sim.task.result import RolloutResult
from tests.helpers.results import entries_of

rosbags = pytest.importorskip("rosbags", reason="the package rosbags (extra [test]) is not installed")
from rosbags.highlevel import AnyReader  # noqa: E402
from rosbags.typesys import Stores, get_types_from_msg, get_typestore  # noqa: E402

CAMERA = CameraModel(width_px=160, height_px=120)
START = Pose(-1.5, 1.0, math.radians(30.0))
ACTIONS = (Action.MOVE_FORWARD, Action.TURN_LEFT, Action.MOVE_FORWARD, Action.TURN_RIGHT, Action.STOP)
ONCE = {"/map", "/tf_static"}
LIVE = {"/clock", "/goal", "/goal_image", "/episode", "/result"}
"""Topics of a running robot, which a recording does not need."""
WRITTEN = set(TOPICS) - LIVE
STANDARD = get_typestore(Stores.ROS2_JAZZY)
"""The types as ROS 2 Jazzy defines them."""


class Scripted:
    """Carries out a list of actions and keeps its observations and, with an environment, the true poses."""

    def __init__(self, env: ObjectNavEnv | None = None) -> None:
        self.env = env

    def reset(self, goal: str, seed: int) -> None:
        self.seen: list[Observation] = []
        self.poses: list[Pose] = []

    def act(self, observation: Observation) -> Action:
        self.seen.append({name: np.array(value) for name, value in observation.items()})
        if self.env is not None:
            self.poses.append(self.env.scene.world.pose)
        return ACTIONS[len(self.seen) - 1]


def make_env(house: Path, **options: Any) -> ObjectNavEnv:
    settings = {
        "sensors": ("rgb", "depth", "scan", "imu", "bumper", "odometry"),
        "noise": "realsense",
        "scan": ScanConfig(rays=90),
    }
    return ObjectNavEnv(
        house=house, goal="sofa", camera=CAMERA, truth=("rgb", "depth", "semantic"), **settings | options
    )


@pytest.fixture(scope="module")
def recorded(house: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Scripted, RolloutResult]:
    """A recording with the agent that made it and the result of the episode."""
    run, env = tmp_path_factory.mktemp("run"), make_env(house)
    agent, episode = Scripted(env), Episode("an episode/1", "sofa_room", "sofa", START, 1.0)
    line = play_episode(env, agent, episode, seed=0, viewers=[McapLog(run)])
    env.close()
    return mcap_file(run, episode.episode_id), agent, line


@pytest.fixture(scope="module")
def read(recorded: tuple) -> dict[str, list[tuple[int, Any]]]:
    """Time and message of each topic, as the standard types."""
    by_topic: dict[str, list[tuple[int, Any]]] = defaultdict(list)
    with AnyReader([recorded[0]]) as reader:
        for connection, time_ns, raw in reader.messages():
            by_topic[connection.topic].append((time_ns, STANDARD.deserialize_cdr(raw, connection.msgtype)))
    return by_topic


def yaw_of(rotation: Any) -> float:
    return 2.0 * math.atan2(rotation.z, rotation.w)


@pytest.mark.parametrize("name", list(FIELDS))
def test_a_definition_is_that_of_ros(name: str) -> None:
    own = get_typestore(Stores.EMPTY)
    own.register(get_types_from_msg(definition(name), name.replace("/", "/msg/")))
    full = name.replace("/", "/msg/")
    assert own.hash_rihs01(full) == STANDARD.hash_rihs01(full)


def test_every_topic_has_a_message_for_each_action_in_order_of_time(read: dict[str, list]) -> None:
    assert {topic: len(of_topic) for topic, of_topic in read.items()} == dict.fromkeys(
        WRITTEN, len(ACTIONS)
    ) | dict.fromkeys(ONCE, 1)
    for of_topic in read.values():
        times = [time_ns for time_ns, _ in of_topic]
        assert times == sorted(times)
        for time_ns, message in of_topic:
            if hasattr(message, "header"):
                assert message.header.stamp.sec * 10**9 + message.header.stamp.nanosec == time_ns


def test_images_and_scans_are_those_that_the_agent_saw(recorded: tuple, read: dict[str, list]) -> None:
    for i, seen in enumerate(recorded[1].seen):
        image, depth, scan = (read[topic][i][1] for topic in (f"{COLOUR}/image_raw", f"{DEPTH}/image_raw", "/scan"))
        assert (image.encoding, image.step) == ("rgb8", 480)
        np.testing.assert_array_equal(image.data.reshape(120, 160, 3), seen["rgb"])
        depth_m = depth.data.view("<u2").reshape(120, 160) / 1000.0
        np.testing.assert_allclose(depth_m, np.where(seen["depth"] < 5.0, seen["depth"], 0.0), atol=0.00051)
        near = seen["scan"] > 0.0
        np.testing.assert_array_equal(scan.ranges[near], seen["scan"][near])
        assert np.isneginf(scan.ranges[~near]).all()
        assert scan.angle_increment == pytest.approx(math.tau / 90)
        for camera, picture in ((COLOUR, image), (DEPTH, depth)):
            assert read[f"{camera}/camera_info"][i][1].header == picture.header
        motion, felt = read["/imu"][i][1], read["/bumper"][i][1]
        inertia = [getattr(of, axis) for of in (motion.linear_acceleration, motion.angular_velocity) for axis in "xyz"]
        assert inertia == seen["imu"].tolist()
        assert felt.data.tolist() == seen["bumper"].tolist()
    info = read[f"{DEPTH}/camera_info"][0][1]
    assert (info.width, info.height, info.k[0], info.k[2]) == (160, 120, pytest.approx(CAMERA.focal_px), 79.5)


def test_rays_without_a_return_are_infinite() -> None:
    read_m = np.array([0.0, 1.5, 12.0], np.float32)
    assert messages.laser_scan(0.0, read_m, ScanConfig(rays=3))["ranges"] == [-math.inf, 1.5, math.inf]


def test_frames_lead_from_the_map_to_the_true_pose_and_odometry_is_what_was_believed(
    recorded: tuple, read: dict[str, list]
) -> None:
    _, agent, _ = recorded
    fixed = read["/tf_static"][0][1]
    for (_, tree), (_, odometry), (_, located), seen, pose in zip(
        read["/tf"], read["/odom"], read["/pose"], agent.seen, agent.poses, strict=False
    ):
        frames = {transform.child_frame_id: transform for transform in tree.transforms + fixed.transforms}
        parents = {name: transform.header.frame_id for name, transform in frames.items()}
        assert parents == {
            "odom": "map", "base_link": "odom", "camera_link": "base_link", "laser": "base_link",
            "camera_optical_frame": "camera_link",
        }  # fmt: skip
        odom, base = frames["odom"].transform, frames["base_link"].transform
        yaw = yaw_of(odom.rotation)
        x_m = odom.translation.x + math.cos(yaw) * base.translation.x - math.sin(yaw) * base.translation.y
        y_m = odom.translation.y + math.sin(yaw) * base.translation.x + math.cos(yaw) * base.translation.y
        assert (x_m, y_m) == pytest.approx((pose.x_m, pose.y_m), abs=1e-6)
        assert math.remainder(yaw + yaw_of(base.rotation) - pose.yaw_rad, math.tau) == pytest.approx(0.0, abs=1e-6)
        believed, known = messages.pose_of(odometry.pose.pose), messages.pose_of(located.pose)
        assert [believed.x_m, believed.y_m, np.float32(believed.yaw_rad)] == seen["odometry"].tolist()
        assert [known.x_m, known.y_m, np.float32(known.yaw_rad)] == [*seen["gps"].tolist(), seen["compass"][0]]
        assert frames["camera_link"].transform.translation.z == CAMERA.height_m


def test_channels_have_the_quality_of_service_of_their_topics(recorded: tuple) -> None:
    with AnyReader([recorded[0]]) as reader:
        offered = {
            connection.topic: cast(Any, connection.ext).offered_qos_profiles for connection in reader.connections
        }
    assert set(offered) == WRITTEN
    for name, (quality,) in offered.items():
        of_topic = TOPICS[name].delivery
        assert (quality.reliability.name.lower(), quality.durability.name.lower(), quality.depth) == of_topic.value
    assert offered["/map"][0].durability.name == "TRANSIENT_LOCAL"


def test_depth_in_metres_is_exact_and_says_what_is_too_near_and_too_far() -> None:
    seen_m = np.array([[0.0, 0.5, 1.2345678], [3.999, 4.9999995, 5.0]], np.float32)
    camera = CameraModel(width_px=3, height_px=2)
    image = messages.depth_image(0.0, seen_m, camera, "32FC1")
    content = image["data"]
    assert isinstance(content, bytes)
    values = np.frombuffer(content, "<f4")
    assert np.isnan(values[0])
    assert np.isposinf(values[5])
    np.testing.assert_array_equal(messages.depth_of(content, "32FC1", camera), seen_m)
    rounded = messages.depth_image(0.0, seen_m, camera)["data"]
    assert isinstance(rounded, bytes)
    expected_m = np.array([[0.0, 0.5, 1.235], [3.999, 5.0, 0.0]], np.float32)
    np.testing.assert_array_equal(messages.depth_of(rounded, "16UC1", camera), expected_m)
    far = np.full((2, 3), 7200, "<u2").tobytes()  # of a real camera
    assert (messages.depth_of(far, "16UC1", camera) == 5.0).all()
    with pytest.raises(ConfigError, match="use 16UC1 or 32FC1"):
        messages.depth_of(content, "8UC1", camera)


def test_the_optical_frame_looks_ahead_with_y_down() -> None:
    turn = messages._TO_OPTICAL
    x, y, z, w = turn["x"], turn["y"], turn["z"], turn["w"]
    ahead = (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))  # the frame's z axis
    down = (2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x))
    assert ahead == pytest.approx((1.0, 0.0, 0.0))
    assert down == pytest.approx((0.0, 0.0, -1.0))


def test_the_map_shows_walls_sofa_and_floor_where_they_are(read: dict[str, list]) -> None:
    ((_, grid),) = read["/map"]
    cells = grid.data.reshape(grid.info.height, grid.info.width)
    origin = grid.info.origin.position

    def at(x_m: float, y_m: float) -> int:
        return int(cells[int((y_m - origin.y) / grid.info.resolution), int((x_m - origin.x) / grid.info.resolution)])

    assert (at(2.5, 0.0), at(-1.5, 1.0), at(2.5, 1.5)) == (messages.OCCUPIED, messages.FREE, messages.FREE)
    assert (at(2.5, -0.85), at(2.5, -0.75)) == (messages.FREE, messages.OCCUPIED)
    assert grid.header.frame_id == "map"


def test_commands_are_the_velocities_of_the_actions(read: dict[str, list]) -> None:
    commands = [(message.linear.x, message.angular.z) for _, message in read["/cmd_vel"]]
    assert commands == [(0.5, 0.0), (0.0, 1.8), (0.5, 0.0), (0.0, -1.8), (0.0, 0.0)]


def test_metadata_has_the_episode_and_its_result(recorded: tuple) -> None:
    from mcap.reader import make_reader

    file, _, line = recorded
    with file.open("rb") as stream:
        metadata = {record.name: record.metadata for record in make_reader(stream).iter_metadata()}
    assert metadata["episode"]["episode_id"] == '"an episode/1"'
    result = {key: json.loads(value) for key, value in metadata["result"].items()}
    assert result == json.loads(json.dumps(entries_of(line)))
    assert file.name == "an episode%2F1.mcap"


def test_recording_changes_no_result_and_needs_no_sensor_of_the_agent(house: Path, tmp_path: Path) -> None:
    lines = []
    for viewers in ([], [McapLog(tmp_path)]):
        env = make_env(house, sensors=())
        lines.append(
            play_episode(env, Scripted(), Episode("a", "sofa_room", "sofa", START, 1.0), seed=0, viewers=viewers)
        )
        env.close()
    assert lines[0].without_times() == lines[1].without_times()
    with AnyReader([mcap_file(tmp_path, "a")]) as reader:
        assert {connection.topic for connection in reader.connections} == WRITTEN - {"/imu", "/bumper"}


def test_an_unfinished_recording_is_discarded(house: Path, tmp_path: Path) -> None:
    env, log = make_env(house), McapLog(tmp_path)
    env.reset(seed=0, options={"episode": Episode("a", "sofa_room", "sofa", START, 1.0)})
    log.begin(env)
    assert len(list((tmp_path / "mcap").iterdir())) == 1
    log.close()
    assert list((tmp_path / "mcap").iterdir()) == []
    env.close()


def test_without_the_writer_the_message_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mcap_log.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ConfigError, match=r"pip install .*\[ros\]"):
        mcap_log.require_mcap()


def test_a_full_disk_is_one_line_with_the_file_and_leaves_no_part(
    house: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    for name in ("write", "finish"):
        with monkeypatch.context() as patched:
            patched.setattr(mcap_log.RosMessages, name, full)
            env, log = make_env(house), McapLog(tmp_path)
            episode = Episode("one", "sofa_room", "sofa", START, 1.0)
            with pytest.raises(ConfigError, match=r"recording '.*one\.mcap': No space left"):
                play_episode(env, Scripted(), episode, seed=0, viewers=[log])
            log.close()
            env.close()
        assert not [file for file in tmp_path.rglob("*") if file.is_file()]
