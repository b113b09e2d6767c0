"""The worker of `bench_against`: it runs the parts of one version of the code, a round at each line of input.

PYTHONPATH=FOLDER python tools/maintenance/turns.py FOLDER PART,PART,...

FOLDER holds that version. Of its code only what has long been there is used, so that old versions can be measured. Each
line read from stdin is the name of a part; the answer is a line of JSON with the seconds of processor time of
one step, image, view, house or start.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from itertools import cycle, islice
from pathlib import Path
from typing import Any

FOLDER = Path(sys.argv[1]) if __name__ == "__main__" else Path()
if __name__ == "__main__":
    os.environ |= {"LP_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}

import numpy as np  # noqa: E402 - its threads are set above

STEPS, FRAMES, VIEWS = 20, 6, 6
"""Numbers of steps, images and views in a round."""


class Step:
    """Whole steps of `stubborn` with ground-truth segmentation in val: environment and agent."""

    def __init__(self) -> None:
        from sim.app.composition.segmenters import make_segmenter
        from sim.env.objectnav import ObjectNavEnv
        from stubborn import agents

        self._env = ObjectNavEnv(split="val", sensors=("depth", "semantic"))
        camera, robot = self._env.camera_model, self._env.robot_model
        self._agent = agents.make("stubborn", camera=camera, robot=robot, segmenter=make_segmenter("gt", self._env))
        self._episodes = cycle(self._env.split.episodes[:12])
        self._left = 0
        self._observation: Any = None

    def __call__(self) -> dict[str, float]:
        """Runs some steps; four rounds are in one episode, and its reset does not count."""
        if self._left == 0:
            episode = next(self._episodes)
            self._observation, _ = self._env.reset(seed=0, options={"episode": episode})
            self._agent.reset(episode.goal, 0)
            self._left = 4
        self._left -= 1
        agent_s = env_s = 0.0
        for _ in range(STEPS):
            began_s = time.process_time()
            action = self._agent.act(self._observation) or 2  # a turn in place of STOP
            acted_s = time.process_time()
            self._observation, *_ = self._env.step(action)
            agent_s, env_s = agent_s + acted_s - began_s, env_s + time.process_time() - acted_s
        taken_s = {"a step, gt": agent_s + env_s, "of the agent": agent_s, "of the environment": env_s}
        return {name: seconds / STEPS for name, seconds in taken_s.items()}


class Images:
    """Images of fixed poses: depth and segmentation, and those with colour."""

    def __init__(self) -> None:
        self._scene, poses = _scene("fast"), _poses()
        self._poses = cycle(poses)

    def __call__(self) -> dict[str, float]:
        """Renders some poses with each choice of sensors."""
        poses = list(islice(self._poses, FRAMES))
        works = {"depth + semantic": ("depth", "semantic"), "rgb + depth + semantic": ("rgb", "depth", "semantic")}
        data, camera = self._scene.world.data, self._scene.camera
        return {
            name: _cpu_s(lambda sensors=sensors: [camera.render(data, pose, sensors) for pose in poses]) / FRAMES
            for name, sensors in works.items()
        }


class Views:
    """Views written to disk."""

    def __init__(self) -> None:
        self._scenes = {profile: _scene(profile) for profile in ("fast", "good")}
        self._seeds: Iterator[int] = iter(range(1_000_000))

    def __call__(self) -> dict[str, float]:
        """Writes a small shard of each profile."""
        from sim.training.views.shards import write_shard
        from sim.training.views.views import sample_views

        seed, taken_s = next(self._seeds), {}
        for profile, scene in self._scenes.items():
            with tempfile.TemporaryDirectory() as folder:
                views = sample_views(scene, np.random.default_rng(seed), VIEWS, stem="v", record={})
                taken_s[f"views to disk, {profile}"] = _cpu_s(
                    lambda views=views, folder=folder: write_shard(Path(folder), "v", views, house="h", config={})
                )
        return {name: seconds / VIEWS for name, seconds in taken_s.items()}


class House:
    """The first step in a house that was not loaded before."""

    def __init__(self) -> None:
        from sim.env.objectnav import ObjectNavEnv

        self._env = ObjectNavEnv(split="val", sensors=("depth", "semantic"))
        firsts = {episode.house: episode for episode in reversed(self._env.split.episodes)}
        self._episodes = cycle(firsts.values())
        self()

    def __call__(self) -> dict[str, float]:
        """Starts an episode in the next house and turns once."""
        episode = next(self._episodes)

        def first_step() -> None:
            self._env.reset(seed=0, options={"episode": episode})
            self._env.step(2)

        return {"a new house, with one step": _cpu_s(first_step)}


class Start:
    """The start of the program, in a process of its own."""

    def __init__(self) -> None:
        self()  # the first start reads the files from disk

    def __call__(self) -> dict[str, float]:
        """Lists the agents."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [sys.executable, "-m", "sim.run", "--list-agents"]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, cwd=FOLDER)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return {"sim.run --list-agents": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime}


PARTS: dict[str, Callable[[], Callable[[], dict[str, float]]]] = {
    "step": Step, "images": Images, "views": Views, "house": House, "start": Start,
}  # fmt: skip
"""Parts by name; each is made once and then called for each round."""


def _scene(profile: str) -> Any:
    from sim.core.interface import CameraModel
    from sim.env.scene import Scene
    from sim.episodes.splits import load_split
    from sim.gl import mujoco
    from sim.robot.config import RobotConfig

    scene = Scene(load_split("val").load_house("val_03"), robot=RobotConfig(), camera=CameraModel(), profile=profile)
    mujoco.mj_forward(scene.world.model, scene.world.data)
    return scene


def _poses() -> list[Any]:
    """Returns start poses of the episodes in val_03, in several directions."""
    from sim.core.geometry.pose import Pose
    from sim.episodes.splits import load_split

    starts = [episode.start for episode in load_split("val").episodes if episode.house == "val_03"]
    return [Pose(s.x_m, s.y_m, s.yaw_rad + turn, s.floor_z_m) for s in starts for turn in (0.0, 1.5, 3.0)]


def _cpu_s(work: Callable[[], object]) -> float:
    """Returns the processor time of all threads of this process during a call."""
    began_s = time.process_time()
    work()
    return time.process_time() - began_s


def main() -> None:
    """Makes the parts, then runs a round of one at each line of input."""
    import cv2

    cv2.setNumThreads(1)
    parts = {name: PARTS[name]() for name in sys.argv[2].split(",")}
    for line in sys.stdin:
        print(json.dumps(parts[line.strip()]()), flush=True)


if __name__ == "__main__":
    main()
