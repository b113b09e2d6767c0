"""Measures the five figures of docs/performance.md in one run, and `mujoco.Renderer` in the same houses.

    stubborn bench
    stubborn bench --quick                     # tests that everything runs; its figures have no meaning

Absolute figures depend on the machine and on its load; the column `times faster` depends on them much less, because
both renderers take turns.
"""

from __future__ import annotations

import copy
import itertools
import math
import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import msgspec
import numpy as np
from numpy.typing import NDArray
from rich.table import Table

from sim.app import cli
from sim.app.analysis import display
from sim.app.composition.segmenters import KINDS, make_segmenter
from sim.core.files import write_atomically
from sim.core.geometry.pose import Pose
from sim.core.interface import Action, Agent, CameraModel
from sim.core.paths import processor
from sim.core.vocabulary import counted
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.splits import load_split
from sim.gl import mujoco
from sim.houses.labels import RENDERED_GROUPS
from sim.renderer.camera import Camera
from sim.renderer.opengl import Z_FAR_M, Z_NEAR_M, describe_gl
from sim.world.world import World
from stubborn import agents
from stubborn.detection.verification import verifier_for

TRIES = 3
"""Number of times that each pose is rendered; the fastest counts."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Measure the figures of docs/performance.md and print them."""

    quick: bool = False
    """Measure as little as possible, to test that everything runs."""
    out: cli.OutFile | None = None
    """A JSON file for the figures."""


@dataclass(frozen=True, kw_only=True)
class Figure:
    """One line of the table."""

    what: str
    value: float
    unit: str
    plain: float | None = None
    """The same images by `mujoco.Renderer`, in the same unit."""

    @property
    def times_faster(self) -> float | None:
        """Ratio to the speed of `mujoco.Renderer`; None without a comparison."""
        if self.plain is None:
            return None
        return self.value / self.plain if self.unit == "/s" else self.plain / self.value


def main(args: Args) -> int:
    """Measures and prints the figures; returns the exit status."""
    os.environ["LP_NUM_THREADS"] = "1"  # llvmpipe reads it when it starts
    cv2.setNumThreads(1)
    houses, poses, steps = (1, 2, 6) if args.quick else (8, 5, 600)
    console = display.make_console()
    images = []
    for sensors in (("rgb", "depth", "semantic"), ("depth", "semantic")):
        console.print(f"Rendering {counted(houses * poses, 'view')} with both renderers: {', '.join(sensors)}")
        images.append(_images(sensors, houses, poses))
    console.print(f"Running {steps} steps of stubborn with each kind of segmentation")
    truth_ms, with_truth_ms = _steps_ms("gt", steps)
    network_ms, _ = _steps_ms("rednet", steps)
    plain_ms = images[1].plain
    assert plain_ms is not None
    figures = [
        *images,
        Figure(what="a step of stubborn, ground truth", value=float(np.median(truth_ms)), unit="ms"),
        Figure(what="a step of stubborn, network", value=float(np.median(network_ms)), unit="ms"),
        Figure(
            what="steps a second of whole episodes, ground truth",
            value=1e3 / float(with_truth_ms.mean()), unit="/s", plain=1e3 / plain_ms,
        ),
    ]  # fmt: skip
    console.print(_table(figures))
    console.print(f"{processor()}, {describe_gl()}, mujoco {mujoco.__version__}", soft_wrap=True)
    if args.out is not None:
        write_atomically(args.out, msgspec.json.format(msgspec.json.encode(figures)))
    return 0


class PlainRenderer:
    """`mujoco.Renderer` used as in its documentation, from our robot's camera: one pass per image.

    Args:
        world: house and robot; its model is not changed. Each lamp casts shadows, which is MuJoCo's default.
    """

    def __init__(self, world: World) -> None:
        camera, model = CameraModel(), default_quality(world.model)
        self._height_m = camera.height_m
        self._renderer = mujoco.Renderer(model, camera.height_px, camera.width_px)
        self._option = mujoco.MjvOption()
        self._option.geomgroup[:] = 0
        self._option.geomgroup[:RENDERED_GROUPS] = 1
        self._eye = mujoco.MjvCamera()
        self._eye.distance, self._eye.elevation = 1.0, 0.0
        self._data = mujoco.MjData(model)
        mujoco.mj_forward(model, self._data)

    def render(self, pose: Pose, sensors: Sequence[str]) -> dict[str, NDArray[np.generic]]:
        """Returns one image for each of `rgb`, `depth` and `semantic` (here geom ids)."""
        self._eye.lookat[:] = pose.x_m + math.cos(pose.yaw_rad), pose.y_m + math.sin(pose.yaw_rad), self._height_m
        self._eye.azimuth = math.degrees(pose.yaw_rad)
        images = {}
        for sensor in sensors:
            if sensor == "depth":
                self._renderer.enable_depth_rendering()
            elif sensor == "semantic":
                self._renderer.enable_segmentation_rendering()
            self._renderer.update_scene(self._data, self._eye, self._option)
            images[sensor] = self._renderer.render()
            self._renderer.disable_depth_rendering()
            self._renderer.disable_segmentation_rendering()
        return images

    def close(self) -> None:
        """Frees the renderer."""
        self._renderer.close()


def default_quality(model: mujoco.MjModel) -> mujoco.MjModel:
    """Returns a copy of a model with MuJoCo's quality of rendering, and the field of view of our robot's camera."""
    model, camera, default = copy.copy(model), CameraModel(), mujoco.MjSpec().visual.quality
    for name in ("offsamples", "numslices", "numstacks", "numquads", "shadowsize"):
        setattr(model.vis.quality, name, getattr(default, name))
    model.stat.extent, model.vis.map.znear, model.vis.map.zfar = 1.0, Z_NEAR_M, Z_FAR_M
    model.vis.global_.offwidth, model.vis.global_.offheight = camera.width_px, camera.height_px
    model.vis.global_.fovy = math.degrees(camera.vfov_rad)
    return model


def free_poses(world: World, count: int, rng: np.random.Generator) -> list[Pose]:
    """Returns random free poses of the robot."""
    space = world.free_space()
    cells = np.argwhere(space.largest_part())
    places = space.frame.to_metres(cells[rng.integers(len(cells), size=count)])
    return [Pose(float(x), float(y), float(rng.uniform(-math.pi, math.pi)), 0.0) for x, y in places]


def make_agent(env: ObjectNavEnv, semantics: str) -> Agent:
    """Returns the agent `stubborn` with this kind of segmentation and its verifier."""
    segmenter = make_segmenter(semantics, env)
    verifier = verifier_for(segmenter.spec)
    return agents.make(
        "stubborn", camera=env.camera_model, robot=env.robot_model, segmenter=segmenter, verifier=verifier
    )


def make_env(semantics: str, split: str = "val") -> ObjectNavEnv:
    """Returns the environment of a split with the sensors that this kind of segmentation needs."""
    spec = KINDS[semantics].spec
    return ObjectNavEnv(split=split, sensors=("depth", *spec.sensors), truth=spec.truth)


def _images(sensors: Sequence[str], houses: int, poses: int) -> Figure:
    """Measures our camera and `mujoco.Renderer`, which take turns at the same poses of several houses."""
    split, ms = load_split("val"), list[tuple[float, float]]()
    for number, name in enumerate(split.houses[:houses]):
        world = World(split.load_house(name))
        chosen = free_poses(world, poses, np.random.default_rng([number, 0]))
        mujoco.mj_forward(world.model, world.data)
        plain, camera = PlainRenderer(world), Camera(world.model, world.labels, profile="fast")
        camera.render(world.data, chosen[0], sensors)
        plain.render(chosen[0], sensors)
        for pose in chosen:
            pairs = [
                (
                    _ms(lambda pose=pose, camera=camera, world=world: camera.render(world.data, pose, sensors)),
                    _ms(lambda pose=pose, plain=plain: plain.render(pose, sensors)),
                )
                for _ in range(TRIES)
            ]
            ms.append((min(ours for ours, _ in pairs), min(theirs for _, theirs in pairs)))
        camera.close()
        plain.close()
    ours_ms, plain_ms = np.median(np.array(ms), axis=0).tolist()
    return Figure(what=f"{' + '.join(sensors)}, 640 x 480", value=ours_ms, unit="ms", plain=plain_ms)


def _steps_ms(semantics: str, steps: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns milliseconds (steps,) of the agent and of agent and environment in episodes of val, without resets."""
    env = make_env(semantics)
    agent, agent_ms, whole_ms = make_agent(env, semantics), list[float](), list[float]()
    for episode in itertools.cycle(env.split.episodes):
        observation, _ = env.reset(seed=0, options={"episode": episode})
        agent.reset(episode.goal, 0)
        over = False
        while not over and len(whole_ms) <= steps:
            began_s = time.perf_counter()
            action = agent.act(observation)
            acted_s = time.perf_counter()
            observation, _, terminated, truncated, _ = env.step(Action(action))
            whole_ms.append(1e3 * (time.perf_counter() - began_s))
            agent_ms.append(1e3 * (acted_s - began_s))
            over = terminated or truncated
        if len(whole_ms) > steps:
            break
    env.close()
    return np.array(agent_ms[1:]), np.array(whole_ms[1:])  # the first step compiles code


def _ms(work: Callable[[], object]) -> float:
    """Returns the milliseconds that a call takes."""
    began_s = time.perf_counter()
    work()
    return 1e3 * (time.perf_counter() - began_s)


def _table(figures: Sequence[Figure]) -> Table:
    table = Table("figure", title="Speed", title_justify="left")
    for column in ("measured", "mujoco.Renderer", "times faster"):
        table.add_column(column, justify="right")
    for figure in figures:
        plain = "" if figure.plain is None else f"{figure.plain:.1f} {figure.unit}"
        faster = "" if figure.times_faster is None else f"{figure.times_faster:.1f}"
        table.add_row(figure.what, f"{figure.value:.1f} {figure.unit}", plain, faster)
    return table
