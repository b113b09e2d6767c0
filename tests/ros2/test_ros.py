"""With ROS 2: `make test-ros` runs them in its environment, other test runs leave them out."""

import json
import math
import os
import subprocess
import sys
import threading
import time
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

rclpy = pytest.importorskip("rclpy")
pytest.importorskip("rosbags")

from rosbags.highlevel import AnyReader  # noqa: E402
from rosbags.typesys import Stores, get_typestore  # noqa: E402

from sim.app.bridges.ros2.loading import has_frames  # noqa: E402
from sim.app.bridges.ros2.node import RobotNode  # noqa: E402
from sim.app.viewers.ros.topics import COLOUR, DEPTH, TOPICS  # noqa: E402
from sim.core.geometry.pose import Pose  # noqa: E402
from sim.core.goals import PICTURE_PX, GoalSpec, PictureCamera  # noqa: E402
from sim.episodes.episode import Episode  # noqa: E402
from sim.episodes.splits import write_split  # noqa: E402
from tests.helpers.worlds import sofa_room  # noqa: E402

ROOT = Path(__file__).parents[2]
STORE = get_typestore(Stores.ROS2_JAZZY)
SMALL = ("camera.width_px=160", "camera.height_px=120")
WITHIN_S = 300.0
_domains = iter(range(int(os.environ.get("ROS_DOMAIN_ID", 40 + os.getpid() % 60)), 230))


class Robots:
    """Starts processes in a ROS domain of their own and ends those that are left."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.domain = folder, next(_domains)
        self.processes: list[subprocess.Popen[str]] = []
        self.house = folder / "sofa_room.xml"
        self.house.write_text(sofa_room().spec.to_xml())

    def start(self, *words: str) -> subprocess.Popen[str]:
        """Starts Python with these words; its output goes to a file of its number."""
        log = (self.folder / f"log_{len(self.processes)}").open("w")
        environment = {
            **os.environ, "ROS_DOMAIN_ID": str(self.domain), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "PYTHONPATH": str(ROOT),
        }  # fmt: skip
        process = subprocess.Popen(
            [sys.executable, *words], cwd=self.folder, env=environment, stdout=log, stderr=subprocess.STDOUT, text=True
        )
        self.processes.append(process)
        return process

    def robot(self, *words: str, goal: str = "sofa", episodes: int = 1) -> subprocess.Popen[str]:
        """Starts a robot in the house of one room, with a small camera; results are in `run`."""
        return self.start(
            "-m", "sim.app.commands.main", "ros", "--house", str(self.house), "--goal", goal, "--start-deg=-1.5 1 30",
            "--episodes", str(episodes), "--seed-key", "k", "--out", "run", *words,
        )  # fmt: skip

    def said(self, number: int) -> str:
        return (self.folder / f"log_{number}").read_text()

    def wait(self, process: subprocess.Popen[str]) -> int:
        try:
            return process.wait(WITHIN_S)
        except subprocess.TimeoutExpired:
            logs = "\n".join(self.said(number)[-1500:] for number in range(len(self.processes)))
            pytest.fail(f"no end within {WITHIN_S} s:\n{logs}")

    def lines(self, run: str = "run") -> list[dict[str, Any]]:
        return [json.loads(line) for line in (self.folder / run / "results.jsonl").read_text().splitlines()]

    def close(self) -> None:
        for process in self.processes:
            if process.poll() is None:
                process.kill()
                process.wait()


@pytest.fixture
def robots(tmp_path: Path) -> Iterator[Robots]:
    made = Robots(tmp_path)
    yield made
    made.close()


class Peer:
    """A node in this process that keeps what it hears."""

    def __init__(self, domain: int) -> None:
        self.context = rclpy.Context()
        rclpy.init(context=self.context, domain_id=domain)
        self.node = rclpy.create_node("peer", context=self.context)
        self.executor = rclpy.executors.SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.heard: dict[str, list[Any]] = defaultdict(list)

    def hear(self, topic: str, kind: Any, *, latched: bool = False) -> None:
        durability = rclpy.qos.DurabilityPolicy.TRANSIENT_LOCAL if latched else rclpy.qos.DurabilityPolicy.VOLATILE
        reliability = rclpy.qos.ReliabilityPolicy.RELIABLE if latched else rclpy.qos.ReliabilityPolicy.BEST_EFFORT
        quality = rclpy.qos.QoSProfile(depth=50, durability=durability, reliability=reliability)
        self.node.create_subscription(kind, topic, self.heard[topic].append, quality)

    def spin_until(self, done: Any, within_s: float = WITHIN_S) -> None:
        until = time.monotonic() + within_s
        while not done():
            assert time.monotonic() < until, f"nothing within {within_s} s; heard {[*map(str, self.heard)]}"
            self.executor.spin_once(timeout_sec=0.05)

    def call(self, name: str, kind: Any, **request: Any) -> Any:
        client = self.node.create_client(kind, f"/stubborn/{name}")
        self.spin_until(client.service_is_ready)
        future = client.call_async(kind.Request(**request))
        self.spin_until(future.done)
        return future.result()

    def close(self) -> None:
        self.executor.shutdown()
        self.node.destroy_node()
        self.context.try_shutdown()


@pytest.fixture
def peer(robots: Robots) -> Iterator[Peer]:
    made = Peer(robots.domain)
    yield made
    made.close()


def read(recording: Path) -> dict[str, list[Any]]:
    """Returns the messages of each topic."""
    messages = defaultdict(list)
    with AnyReader([recording], default_typestore=STORE) as reader:
        for connection, _, raw in reader.messages():
            messages[connection.topic].append(STORE.deserialize_cdr(raw, connection.msgtype))
    return messages


def plain(message: Any) -> Any:
    """Returns a message as values that can be compared, NaN included."""
    if isinstance(message, np.ndarray):
        return message.dtype.str, message.tobytes()
    if isinstance(message, list):
        return [plain(part) for part in message]
    if hasattr(message, "__dataclass_fields__"):
        return {name: plain(getattr(message, name)) for name in message.__dataclass_fields__ if name[0] != "_"}
    return "nan" if message != message else message


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Robots]:
    """A robot that a foreign node drove to the sofa, with its own recording and that of a subscriber."""
    if not has_frames():
        pytest.skip("tf2_msgs is not installed")
    robots = Robots(tmp_path_factory.mktemp("driven"))
    topics = [f"{name}={topic.type}" for name, topic in TOPICS.items() if name != "/cmd_vel"]
    recorder = robots.start(str(ROOT / "tests" / "helpers" / "ros_recorder.py"), "bag", *topics)
    while "ready" not in robots.said(0):
        assert recorder.poll() is None, robots.said(0)
        time.sleep(0.1)
    robot = robots.robot("--map", "--ground-truth-tf", "--wait", "--mcap", "--depth", "32FC1", "--config", *SMALL)
    driver = robots.start(str(ROOT / "examples" / "ros_drive.py"), "1.55", "0.0")
    try:
        assert robots.wait(driver) == 0, robots.said(2)
        assert robots.wait(robot) == 0, robots.said(1)
        assert robots.wait(recorder) == 0, robots.said(0)
        yield robots
    finally:
        robots.close()


def test_a_foreign_node_drives_to_the_goal_by_map_scan_and_clock(driven: Robots) -> None:
    (line,) = driven.lines()
    assert (line["success"], line["end_reason"], line["collisions"]) == (1.0, "stop", 0)
    assert line["spl"] > 0.7
    assert line["uses_ground_truth"]


def test_a_subscriber_that_records_gets_the_messages_of_mcap(driven: Robots) -> None:
    own, other = read(next((driven.folder / "run" / "mcap").iterdir())), read(driven.folder / "bag")
    assert set(own) == set(TOPICS) - {"/cmd_vel", "/goal_image"}  # the goal is no picture
    lost = 0
    for topic, messages in own.items():
        heard = [plain(message) for message in other[topic]]
        assert all(plain(message) in heard for message in messages[-1:]), topic
        lost += sum(plain(message) not in heard for message in messages)
    assert lost <= 0.01 * sum(map(len, own.values()))  # streams are best effort


def test_time_goes_on_and_frames_form_a_tree(driven: Robots) -> None:
    heard = read(next((driven.folder / "run" / "mcap").iterdir()))
    clock = [message.clock.sec + 1e-9 * message.clock.nanosec for message in heard["/clock"]]
    np.testing.assert_allclose(np.diff(clock)[:-1], 0.08, atol=1e-6)
    for topic in (f"{COLOUR}/image_raw", f"{DEPTH}/camera_info", "/scan", "/imu", "/odom", "/pose"):
        assert [m.header.stamp for m in heard[topic]] == [m.clock for m in heard["/clock"]], topic
    frames = [*heard["/tf"][-1].transforms, *heard["/tf_static"][0].transforms]
    assert {frame.child_frame_id: frame.header.frame_id for frame in frames} == {
        "odom": "map", "base_link": "odom", "camera_link": "base_link", "laser": "base_link",
        "camera_optical_frame": "camera_link",
    }  # fmt: skip
    speeds = [message.twist.twist.linear.x for message in heard["/odom"]]
    assert 0.3 < max(speeds) < 0.55
    assert heard[f"{DEPTH}/image_raw"][0].encoding == "32FC1"


def test_in_stepped_mode_an_agent_sees_bit_by_bit_what_it_sees_in_process(robots: Robots) -> None:
    words = ("--config", *SMALL, "--noise", "realsense")
    robot = robots.robot("--stepped", "--depth", "32FC1", *words, goal="sofa", episodes=2)
    agent = robots.start(
        "-m", "sim.app.commands.main", "ros", "agent", "--agent", "tests.helpers.ros_agents:WITNESS", "--stepped",
        "--once", "--config", *SMALL,
    )  # fmt: skip
    assert robots.wait(robot) == 0, robots.said(0)
    assert robots.wait(agent) == 0, robots.said(1)
    inside = robots.start(
        "-m", "sim.app.commands.main", "run", "--agent", "tests.helpers.ros_agents:WITNESS", "--house",
        str(robots.house), "--goal", "sofa", "--start-deg=-1.5 1 30", "--episodes", "2", "--seed-key", "k", "--out",
        "inside", "--step-timeout", "0", *words,
    )  # fmt: skip
    assert robots.wait(inside) == 0, robots.said(2)
    other = {"agent", "wall_time_s", "steps_per_s"}
    lines, expected = (
        [{name: value for name, value in line.items() if name not in other} for line in robots.lines(run)]
        for run in ("run", "inside")
    )
    assert lines == expected
    assert lines[0]["stop_confidence"] not in (None, lines[1]["stop_confidence"])
    assert lines[0]["stop_target_xy_m"] is not None


def test_an_agent_that_takes_the_place_of_a_killed_one_goes_on(robots: Robots, peer: Peer) -> None:
    from nav_msgs.msg import Odometry

    words = ("-m", "sim.app.commands.main", "ros", "agent", "--agent", "tests.helpers.ros_agents:TURNER", "--stepped")
    robot = robots.robot("--stepped", "--config", *SMALL, "task.max_steps=150")
    peer.hear("/odom", Odometry, latched=True)
    for _ in range(3):
        agent, before = robots.start(*words, "--config", *SMALL), len(peer.heard["/odom"])
        peer.spin_until(lambda before=before: len(peer.heard["/odom"]) > before + 10)
        agent.kill()
        agent.wait()
    robots.start(*words, "--config", *SMALL)
    assert robots.wait(robot) == 0, robots.said(0)
    (line,) = robots.lines()
    assert (line["end_reason"], line["num_steps"]) == ("max_steps", 150)


def test_an_agent_drives_a_robot_in_real_time_by_velocities(robots: Robots) -> None:
    words = ("--noise", "realsense", "--config", *SMALL)
    robot = robots.robot("--wait", "--rate", "25", "--time-limit", "60", *words, episodes=2)
    agent = robots.start(
        "-m", "sim.app.commands.main", "ros", "agent", "--agent", "tests.helpers.ros_agents:WITNESS", "--once",
        "--config", *SMALL,
    )  # fmt: skip
    assert robots.wait(robot) == 0, robots.said(0)
    assert robots.wait(agent) == 0, robots.said(1)
    assert "Episode 1: looking for a sofa.\nEpisode 2: looking for a sofa.\n" in robots.said(1)
    x_m, y_m = -1.5 + 1.25 * math.cos(math.pi / 6) + 0.25, 1.0 + 0.625 - 0.5 * math.cos(math.pi / 6)
    for line in robots.lines():
        assert line["end_reason"] == "stop"
        assert 0.65 < line["path_length"] < 1.2  # 0.75 m; a machine that is busy overshoots and comes back
        assert line["simulated_s"] < 40.0
        assert line["stop_confidence"] > 0.0
        assert line["stop_target_xy_m"] == pytest.approx([x_m, y_m], abs=0.1)


CHAIN = ("sofa", "the couch", "")
"""The last goal is a picture."""


def write_chain(robots: Robots) -> str:
    """Writes a split with a chain of three goals; returns its folder."""
    folder = robots.folder / "chains"
    folder.mkdir()
    robots.house.rename(folder / "home.xml")
    camera = PictureCamera(x_m=0.5, y_m=0.0, z_m=1.2, yaw_rad=0.0, pitch_rad=0.4)
    picture = GoalSpec("sofa_00", "picture", camera)
    goals = tuple(GoalSpec.of(goal) if goal else picture for goal in CHAIN)
    episode = Episode("chain", "home", "sofa", Pose(-1.5, 1.0, 0.5), None, goals)
    write_split(folder, [episode], {"home": {}}, version="1")
    return str(folder)


@pytest.mark.parametrize("mode", [("--stepped", "--depth", "32FC1"), ("--rate", "25", "--time-limit", "60", "--wait")])
def test_each_goal_of_a_chain_is_announced_and_the_agent_keeps_its_memory(
    robots: Robots, peer: Peer, mode: tuple[str, ...]
) -> None:
    from sensor_msgs.msg import Image
    from std_msgs.msg import String

    split, agent = write_chain(robots), "tests.helpers.ros_agents:REMEMBERING"
    common = ("--split", split, "--episodes", "1", "--seed-key", "k")
    for topic in ("/goal", "/episode"):
        peer.hear(topic, String, latched=True)
    peer.hear("/goal_image", Image, latched=True)
    robot = robots.start("-m", "sim.app.commands.main", "ros", *common, "--out", "run", *mode, "--config", *SMALL)
    stepped = mode[:1] if mode[0] == "--stepped" else ()
    driver = robots.start(
        "-m",
        "sim.app.commands.main",
        "ros",
        "agent",
        "--agent",
        agent,
        "--words",
        "--pictures",
        "--once",
        *stepped,
        "--config",
        *SMALL,
    )
    peer.spin_until(lambda: robot.poll() is not None)
    assert robots.wait(robot) == 0, robots.said(0)
    assert robots.wait(driver) == 0, robots.said(1)
    assert "Episode 1, goal 3: looking for the object of the picture.\n" in robots.said(1)
    assert "drove in 1 episode." in robots.said(1)
    assert [message.data for message in peer.heard["/goal"]] == [*CHAIN]
    announced = [json.loads(message.data) for message in peer.heard["/episode"]]
    told = [(about["number"], about["goal_number"], about["goal"]) for about in announced if "over" not in about]
    assert told == [(1, 0, CHAIN[0]), (1, 1, CHAIN[1]), (1, 2, CHAIN[2])]
    (picture,) = peer.heard["/goal_image"]
    assert (picture.width, picture.height, picture.encoding) == (PICTURE_PX, PICTURE_PX, "rgb8")
    last = next(about for about in announced if about.get("picture"))
    assert (last["goal_number"], last["stamp"]["sec"]) == (2, picture.header.stamp.sec)
    (line,) = robots.lines()
    assert [goal["end_reason"] for goal in line["goals"]] == ["stop"] * 3
    if not stepped:
        return
    inside = robots.start(
        "-m", "sim.app.commands.main", "run", "--agent", agent, *common, "--out", "inside", "--step-timeout", "0",
        "--config", *SMALL,
    )  # fmt: skip
    assert robots.wait(inside) == 0, robots.said(2)
    (expected,) = robots.lines("inside")
    other = {"agent", "wall_time_s", "steps_per_s"}
    assert {name: value for name, value in line.items() if name not in other} == {
        name: value for name, value in expected.items() if name not in other
    }


def test_place_and_confidence_of_a_stop_are_read_before_its_action(monkeypatch: pytest.MonkeyPatch) -> None:
    from std_msgs.msg import Float64, UInt8
    from std_srvs.srv import SetBool

    domain = next(_domains)
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    node, peer = RobotNode(stepped=True), Peer(domain)
    try:
        entered, gate, read = threading.Event(), threading.Event(), list[float | None]()
        monkeypatch.setattr(node.requests, "pause", lambda _: entered.set() or gate.wait(20.0))
        monkeypatch.setattr(node.requests, "act", lambda _: read.append(node.requests.stop_confidence))
        kept = rclpy.qos.QoSProfile(depth=5)
        confidence = peer.node.create_publisher(Float64, "/stop_confidence", kept)
        action = peer.node.create_publisher(UInt8, "/action", kept)
        client = peer.node.create_client(SetBool, "/stubborn/pause")
        peer.spin_until(lambda: client.service_is_ready() and node.drivers() == 1)
        peer.spin_until(lambda: confidence.get_subscription_count() and action.get_subscription_count())
        client.call_async(SetBool.Request())
        peer.spin_until(entered.is_set)  # the robot's thread is busy, so that both messages wait
        for publisher, message in ((confidence, Float64(data=0.5)), (action, UInt8(data=0))):
            publisher.publish(message)
            assert publisher.wait_for_all_acked(rclpy.duration.Duration(seconds=20.0))
        gate.set()
        peer.spin_until(lambda: bool(read), within_s=20.0)
        assert read == [0.5]
    finally:
        peer.close()
        node.close()


def test_rough_peers_stop_nothing_and_no_command_is_lost(robots: Robots, peer: Peer) -> None:
    from geometry_msgs.msg import Twist
    from rosgraph_msgs.msg import Clock
    from std_msgs.msg import String
    from std_srvs.srv import SetBool, Trigger

    robot = robots.robot("--wait", "--time-limit", "20", "--rate", "12.5", "--config", *SMALL)
    peer.hear("/result", String, latched=True)
    peer.hear("/clock", Clock)
    publisher = peer.node.create_publisher(Twist, "/cmd_vel", rclpy.qos.QoSProfile(depth=10_000))

    def times() -> list[tuple[int, int]]:
        return [(message.clock.sec, message.clock.nanosec) for message in peer.heard["/clock"]]

    peer.spin_until(lambda: publisher.get_subscription_count() > 0 and len(times()) > 5)  # each has found the other
    listener = "import rclpy; from sensor_msgs.msg import Image; from rclpy.qos import *; rclpy.init(); " \
        "n = rclpy.create_node('slow'); import time; " \
        f"n.create_subscription(Image, '{COLOUR}/image_raw', lambda m: time.sleep(1.0), qos_profile_sensor_data); " \
        "rclpy.spin(n)"  # fmt: skip
    sent = 1  # the one that is not finite
    for _ in range(3):
        killed, begin = robots.start("-c", listener), time.monotonic()
        while time.monotonic() - begin < 2.0:
            publisher.publish(Twist())
            sent += 1
            time.sleep(0.001)
        killed.kill()
    bad = Twist()
    bad.linear.x = math.nan
    publisher.publish(bad)
    peer.call("pause", SetBool, data=True)

    peer.spin_until(lambda: len(times()) > 4 and len(set(times()[-4:])) == 1)  # a clock that runs repeats no time
    stood = times()[-1]
    assert peer.call("step", Trigger).success
    peer.spin_until(lambda: times()[-1] > stood)
    peer.call("pause", SetBool, data=False)
    assert not peer.call("step", Trigger).success
    assert robots.wait(robot) == 0, robots.said(0)
    peer.spin_until(lambda: peer.heard["/result"])
    result = json.loads(peer.heard["/result"][0].data)
    assert result["result"]["end_reason"] == "time_limit"
    assert result["node"]["refused_commands"] == 1
    assert result["node"]["failed_messages"] == 0
    assert result["node"]["commands"] == sent
    (line,) = robots.lines()
    assert line["simulated_s"] == pytest.approx(20.0, abs=0.1)


def test_an_episode_that_was_reset_or_given_up_counts_as_an_error(robots: Robots, peer: Peer) -> None:
    from rcl_interfaces.srv import GetParameters
    from std_msgs.msg import String, UInt8
    from std_srvs.srv import Trigger

    robot = robots.robot("--stepped", "--config", *SMALL, "--noise", "realsense", "--ros-args=-p seed:=7", episodes=2)
    peer.hear("/episode", String, latched=True)
    peer.hear("/goal", String, latched=True)
    peer.spin_until(lambda: peer.heard["/episode"] and peer.heard["/goal"])
    assert peer.heard["/goal"][0].data == "sofa"
    read = peer.call("get_parameters", GetParameters, names=["goal", "noise", "stepped", "seed"]).values
    assert [read[0].string_value, read[1].string_value, read[2].bool_value] == ["sofa", "realsense", True]
    assert read[3].integer_value == 7
    peer.call("reset", Trigger)
    peer.spin_until(lambda: json.loads(peer.heard["/episode"][-1].data)["number"] == 2)
    action = peer.node.create_publisher(UInt8, "/action", 10)
    peer.spin_until(lambda: action.get_subscription_count() > 0)
    action.publish(UInt8(data=9))
    action.publish(UInt8(data=0))
    peer.spin_until(lambda: json.loads(peer.heard["/episode"][-1].data)["number"] == 3)
    assert peer.call("next_episode", Trigger).success
    assert robots.wait(robot) == 1
    lines = robots.lines()
    assert [line["end_reason"] for line in lines] == ["error", "error"]
    assert [line["error"].rpartition(": ")[2] for line in lines] == [
        "Another node reset the episode.", "Another node gave the episode up.",
    ]  # fmt: skip
