"""Benchmarks of all parts, on pytest-benchmark; one group compares works that are measured in the same run.

    python -m pytest -p pytest_benchmark.plugin tools/benchmarks/test_speed.py
    python -m pytest -p pytest_benchmark.plugin tools/benchmarks/test_speed.py -k step --benchmark-cprofile=cumtime
    python -m pytest -p pytest_benchmark.plugin tools/benchmarks/test_speed.py --benchmark-json=runs/bench.json

With a checkout of https://github.com/allenai/molmospaces and the package lxml on PYTHONPATH, its renderer takes part:

    PYTHONPATH=molmospaces python -m pytest -p pytest_benchmark.plugin tools/benchmarks/test_speed.py -k test_images

`--benchmark-cprofile=cumtime` shows the stages of a step. To compare two commits, run each with `--benchmark-autosave`;
`pytest-benchmark compare` then shows both. Other work on the machine changes the times, so run them in turns.
"""

from __future__ import annotations

import itertools
import math
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from numpy.typing import NDArray
from pytest_benchmark.fixture import BenchmarkFixture

from sim.app.commands.bench import PlainRenderer, default_quality, free_poses, make_agent, make_env
from sim.core.geometry.pose import Pose
from sim.core.interface import MOVES as EVERY_MOVE
from sim.core.interface import Action, CameraModel
from sim.core.paths import CACHE_VARIABLE
from sim.core.reading import read_text
from sim.core.store import SIZE_VARIABLE
from sim.env.objectnav import ObjectNavEnv
from sim.env.scene import Scene
from sim.episodes.house_list import copy_textures
from sim.episodes.splits import load_split
from sim.gl import mujoco
from sim.homes.housegen.generator import HouseConfig, generate_house
from sim.houses.writing import house_text
from sim.renderer.camera import Camera
from sim.robot.config import RobotConfig
from sim.training.views.shards import write_shard
from sim.training.views.views import sample_views
from sim.world.world import World

os.environ["LP_NUM_THREADS"] = "1"  # llvmpipe reads it when it starts
IMAGES = {"two images": ("depth", "semantic"), "three images": ("rgb", "depth", "semantic")}
MOVES = (Action.MOVE_FORWARD, Action.MOVE_FORWARD, Action.TURN_LEFT, Action.TURN_RIGHT)
SMALL = CameraModel(width_px=128, height_px=96)
VIEWS = 30


class MolmoSpacesRenderer:
    """The OpenGL renderer of MolmoSpaces, called as its environment calls it: one update and one pass per image.

    Args:
        world: house and robot; its model is not changed.
    """

    def __init__(self, world: World) -> None:
        rendering = pytest.importorskip("molmo_spaces.renderer.opengl_rendering")
        camera, self._model = CameraModel(), default_quality(world.model)
        self._height_m = camera.height_m
        self._renderer = rendering.MjOpenGLRenderer(model=self._model, width=camera.width_px, height=camera.height_px)
        self._data = mujoco.MjData(self._model)
        mujoco.mj_forward(self._model, self._data)

    def render(self, pose: Pose, sensors: Sequence[str]) -> dict[str, NDArray[np.generic]]:
        """Returns one image for each of `rgb`, `depth` and `semantic` (here geom, type and body ids)."""
        images = {}
        for sensor in sensors:
            self._renderer.update(self._data, mujoco.MjvCamera())
            for eye in self._renderer.scene.camera:
                eye.pos = pose.x_m, pose.y_m, self._height_m
                eye.forward = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad), 0.0
                eye.up = 0.0, 0.0, 1.0
            if sensor == "depth":
                self._renderer.enable_depth_rendering()
            elif sensor == "semantic":
                self._renderer.enable_segmentation_rendering()
            images[sensor] = self._renderer.render()
            self._renderer.disable_depth_rendering()
            self._renderer.disable_segmentation_rendering()
        return images


@pytest.mark.parametrize("renderer", ["ours", "plain", "molmospaces"])
@pytest.mark.parametrize("name", IMAGES)
def test_images(benchmark: BenchmarkFixture, name: str, renderer: str) -> None:
    """A frame of our camera, of `mujoco.Renderer` and of MolmoSpaces' renderer, at the same poses."""
    benchmark.group = name
    split, sensors = load_split("val"), IMAGES[name]
    world = World(split.load_house(split.houses[0]))
    poses = itertools.cycle(free_poses(world, 20, np.random.default_rng(0)))
    mujoco.mj_forward(world.model, world.data)
    if renderer != "ours":
        other = PlainRenderer(world) if renderer == "plain" else MolmoSpacesRenderer(world)
        benchmark(lambda: other.render(next(poses), sensors))
        return
    camera = Camera(world.model, world.labels, profile="fast")
    benchmark(lambda: camera.render(world.data, next(poses), sensors))


@pytest.mark.parametrize("semantics", ["gt", "rednet"])
def test_step(benchmark: BenchmarkFixture, semantics: str) -> None:
    """A step of `stubborn` and its environment, in the group of the images that `mujoco.Renderer` renders for it."""
    benchmark.group = "two images" if semantics == "gt" else "three images"
    steps = _steps(semantics)
    benchmark.pedantic(lambda: next(steps), rounds=500, warmup_rounds=2)


@pytest.mark.parametrize("split", ["val", "large"])
def test_step_by_size_of_the_house(benchmark: BenchmarkFixture, split: str) -> None:
    """A step of `stubborn` with ground truth and its environment; homes of `large` have 292 to 684 m2."""
    benchmark.group = "size"
    steps = _steps("gt", split)
    benchmark.pedantic(lambda: next(steps), rounds=500, warmup_rounds=2)


def test_start_of_a_command(benchmark: BenchmarkFixture) -> None:
    """A command that runs no episode."""
    benchmark.pedantic(_python, ("-m", "sim.run", "--list-agents"), rounds=9, warmup_rounds=1)


@pytest.mark.parametrize("split", ["val", "large"])
def test_first_step_in_a_new_house(benchmark: BenchmarkFixture, split: str) -> None:
    """The reset to a house that is not loaded, and one step; homes of `large` have 292 to 684 m2."""
    benchmark.group = "house"
    env = make_env("gt", split)
    firsts = iter({episode.house: episode for episode in env.split.episodes}.values())

    def start() -> None:
        env.reset(seed=0, options={"episode": next(firsts)})
        env.step(Action.TURN_LEFT)

    benchmark.pedantic(start, rounds=9, warmup_rounds=1)


@pytest.mark.parametrize("state", ["first", "prepared"])
def test_reset_to_another_house(
    benchmark: BenchmarkFixture, state: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The reset to a house that is not loaded: computed, and from the cache of houses seen before."""
    benchmark.group = "reset"
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path))
    monkeypatch.setenv(SIZE_VARIABLE, "1000")
    env = ObjectNavEnv(split="val", sensors=("depth",), camera=SMALL)
    firsts = list({episode.house: episode for episode in env.split.episodes}.values())[:8]
    for episode in firsts if state == "prepared" else ():
        env.reset(options={"episode": episode})
    episodes = iter(firsts)
    benchmark.pedantic(lambda: env.reset(options={"episode": next(episodes)}), rounds=7, warmup_rounds=1)


@pytest.mark.parametrize("profile", ["fast", "good"])
def test_views(benchmark: BenchmarkFixture, tmp_path: Path, profile: str) -> None:
    """A shard of labelled views, as `stubborn views` writes it."""
    benchmark.group = f"{VIEWS} views to disk"
    split = load_split("val")
    scene = Scene(split.load_house(split.houses[0]), robot=RobotConfig(), camera=CameraModel(), profile=profile)

    def write() -> None:
        views = sample_views(scene, np.random.default_rng(0), VIEWS, stem="v", record={})
        write_shard(tmp_path, profile, views, house="h", config={})

    benchmark.pedantic(write, rounds=3, warmup_rounds=1)


def test_new_house(benchmark: BenchmarkFixture, tmp_path: Path) -> None:
    """A house that is generated, checked and written."""
    copy_textures(tmp_path / "textures")
    seeds = itertools.count()
    file = tmp_path / "house.xml"
    benchmark.pedantic(
        lambda: file.write_text(house_text(generate_house(next(seeds), HouseConfig()).spec, "textures")), rounds=6
    )


@pytest.mark.parametrize("size_px", [(640, 480), (256, 192), (128, 96), (64, 48)], ids=str)
@pytest.mark.parametrize("sensors", [("rgb", "depth"), ("depth",), ()], ids=lambda names: "+".join(names) or "none")
def test_learning(benchmark: BenchmarkFixture, size_px: tuple[int, int], sensors: tuple[str, ...]) -> None:
    """A random step of a training without STOP."""
    benchmark.group = "learning"
    env = ObjectNavEnv(split="val", sensors=sensors, camera=CameraModel(width_px=size_px[0], height_px=size_px[1]))
    benchmark.pedantic(_random_steps(env, MOVES), rounds=200, warmup_rounds=2)


@pytest.mark.parametrize("houses", [1, 2, 20])
def test_learning_with_resets(benchmark: BenchmarkFixture, houses: int) -> None:
    """A random step, a quarter of them STOP, over houses that stay loaded."""
    benchmark.group = "learning"
    names = load_split("val").houses[:houses]
    env = ObjectNavEnv(split="val", houses=names, cached_houses=houses, sensors=("depth",), camera=SMALL)
    for episode in {(episode.house, episode.goal): episode for episode in env.split.episodes}.values():
        env.reset(options={"episode": episode})  # loads the house and computes the distances to the goal
    benchmark.pedantic(_random_steps(env, EVERY_MOVE), rounds=400, warmup_rounds=2)


@pytest.mark.parametrize(("number", "mode"), [(1, "sync"), (2, "sync"), (1, "async"), (2, "async"), (4, "async")])
def test_learning_in_vectors(benchmark: BenchmarkFixture, number: int, mode: str) -> None:
    """A random step of each environment of a vector."""
    benchmark.group = "learning"
    split = load_split("val")
    envs = gymnasium.make_vec(
        "sim.gym:stubborn/ObjectNav-v0", num_envs=number, vectorization_mode=mode,
        vector_kwargs={"context": "spawn"} if mode == "async" else {},
        house=split.house_file(split.houses[0]), sensors=("depth",), camera=SMALL,
    )  # fmt: skip
    rng = np.random.default_rng(0)
    envs.reset(seed=0)
    benchmark.pedantic(lambda: envs.step(rng.choice(MOVES, number)), rounds=200, warmup_rounds=2)
    envs.close()


@pytest.mark.parametrize("workers", [1, 2, 4])
def test_workers(benchmark: BenchmarkFixture, workers: int) -> None:
    """The same 16 episodes with one worker, two and four."""
    benchmark.group = "16 episodes"
    with tempfile.TemporaryDirectory() as out:
        words = ("--episodes", "16", "--semantics", "gt", "--workers", str(workers), "--out", f"{out}/run")
        benchmark.pedantic(_python, ("-m", "sim.run", *words), rounds=1)


@pytest.mark.parametrize(("semantics", "limit_mb"), [("gt", 500.0), ("rednet", 800.0)])
def test_memory_of_a_worker(semantics: str, limit_mb: float) -> None:
    """The largest resident memory of a process in 1,000 steps."""
    code = (
        "from tools.benchmarks import test_speed as t\n"
        f"for _ in zip(range(1000), t._steps({semantics!r})): pass\nprint(t.peak_mb())"
    )
    peak_mb = float(subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout)
    print(f"{semantics}: {peak_mb:.0f} MB")
    assert peak_mb <= limit_mb


def peak_mb() -> float:
    """Returns the largest resident memory of this process so far, in megabytes."""
    lines = read_text(Path("/proc/self/status"), what="Memory").splitlines()
    return next(1024e-6 * int(line.split()[1]) for line in lines if line.startswith("VmHWM"))


def _steps(semantics: str, split: str = "val") -> Iterator[None]:
    """Runs one step of agent and environment at each call, in episodes of a split."""
    env = make_env(semantics, split)
    agent = make_agent(env, semantics)
    for episode in itertools.cycle(env.split.episodes):
        observation, _ = env.reset(seed=0, options={"episode": episode})
        agent.reset(episode.goal, 0)
        over = False
        while not over:
            observation, _, terminated, truncated, _ = env.step(agent.act(observation))
            over = terminated or truncated
            yield


def _random_steps(env: ObjectNavEnv, actions: tuple[Action, ...]) -> Callable[[], None]:
    """Returns a random step, which begins an episode after the last one has ended."""
    rng = np.random.default_rng(0)
    env.reset(seed=0)

    def step() -> None:
        _, _, terminated, truncated, _ = env.step(actions[rng.integers(len(actions))])
        if terminated or truncated:
            env.reset()

    return step


def _python(*words: str) -> None:
    """Runs Python with these arguments."""
    subprocess.run([sys.executable, *words], check=True, stdout=subprocess.DEVNULL)
