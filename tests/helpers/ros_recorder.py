"""Records topics of ROS 2 as an MCAP file with `rosbags`; it imports nothing of this project.

    python tests/helpers/ros_recorder.py FILE_OF_FOLDER TOPIC=TYPE ...

It ends when a message of `/episode` says that the run is over, or with Ctrl-C.
"""

from __future__ import annotations

import importlib
import json
import sys
from pathlib import Path
from typing import Any

from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore


def main(folder: Path, topics: dict[str, str]) -> None:
    rclpy, qos = importlib.import_module("rclpy"), importlib.import_module("rclpy.qos")
    serialization = importlib.import_module("rclpy.serialization")
    rclpy.init()
    node, store, over = rclpy.create_node("recorder"), get_typestore(Stores.ROS2_JAZZY), []
    text = importlib.import_module("std_msgs.msg").String
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        for topic, kind in topics.items():
            package, name = kind.split("/")
            latched = topic in ("/tf_static", "/map", "/goal", "/episode", "/result")
            quality = qos.QoSProfile(
                depth=200,
                reliability=qos.ReliabilityPolicy.RELIABLE if latched else qos.ReliabilityPolicy.BEST_EFFORT,
                durability=qos.DurabilityPolicy.TRANSIENT_LOCAL if latched else qos.DurabilityPolicy.VOLATILE,
            )
            connection = writer.add_connection(topic, f"{package}/msg/{name}", typestore=store)

            def keep(raw: bytes, connection: Any = connection, topic: str = topic) -> None:
                writer.write(connection, node.get_clock().now().nanoseconds, raw)
                if topic == "/episode" and json.loads(serialization.deserialize_message(raw, text).data).get("over"):
                    over.append(True)

            kind_class = getattr(importlib.import_module(f"{package}.msg"), name)
            node.create_subscription(kind_class, topic, keep, quality, raw=True)
        sys.stdout.write("ready\n")
        sys.stdout.flush()
        while not over:
            rclpy.spin_once(node, timeout_sec=0.1)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main(Path(sys.argv[1]), dict(word.split("=") for word in sys.argv[2:]))
