"""Parts (a) and (b): our camera against `mujoco.Renderer`, from the same poses in the same houses."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from sim.app.commands.bench.figures import Figure, Goal, interleaved, speedup
from sim.app.commands.bench.stages import Setting, free_poses
from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel
from sim.episodes.splits import load_split
from sim.gl import mujoco
from sim.houses.labels import RENDERED_GROUPS
from sim.renderer.camera import Camera
from sim.renderer.opengl import Z_FAR_M, Z_NEAR_M
from sim.renderer.profiles import get_profile
from sim.world.world import World

DEFAULT, ONE_SHADOW, FAST = QUALITIES = (
    "default quality",
    "default quality but one lamp's shadow",
    "the settings of fast",
)
"""Qualities of the baseline. In the first, each lamp of the house casts shadows, which is MuJoCo's default."""


class PlainRenderer:
    """`mujoco.Renderer` used as in its documentation, from our robot's camera: one pass per image.

    Args:
        world: house and robot; its model is not changed.
        quality: one of `QUALITIES`.
    """

    def __init__(self, world: World, quality_name: str) -> None:
        fast = quality_name == FAST
        self._camera = CameraModel()
        self._model = model = copy.copy(world.model)
        default = mujoco.MjSpec().visual.quality
        quality, profile = model.vis.quality, get_profile("fast")
        quality.offsamples = profile.samples if fast else default.offsamples
        quality.numslices = profile.slices if fast else default.numslices
        quality.numstacks = profile.stacks if fast else default.numstacks
        quality.numquads = profile.quads if fast else default.numquads
        quality.shadowsize = 0 if fast else default.shadowsize
        if quality_name == ONE_SHADOW:
            model.light_castshadow[np.flatnonzero(model.light_castshadow)[1:]] = 0
        model.stat.extent, model.vis.map.znear, model.vis.map.zfar = 1.0, Z_NEAR_M, Z_FAR_M
        model.vis.global_.offwidth, model.vis.global_.offheight = self._camera.width_px, self._camera.height_px
        model.vis.global_.fovy = math.degrees(self._camera.vfov_rad)
        self._renderer = mujoco.Renderer(model, self._camera.height_px, self._camera.width_px)
        if fast:
            for flag in ("SHADOW", "REFLECTION", "SKYBOX"):
                self._renderer.scene.flags[getattr(mujoco.mjtRndFlag, f"mjRND_{flag}")] = 0
        self._option = mujoco.MjvOption()
        self._option.geomgroup[:] = 0
        self._option.geomgroup[:RENDERED_GROUPS] = 1
        self._eye = mujoco.MjvCamera()
        self._eye.distance, self._eye.elevation = 1.0, 0.0
        self._data = mujoco.MjData(model)
        mujoco.mj_forward(model, self._data)

    def render(self, pose: Pose, sensors: Sequence[str]) -> dict[str, np.ndarray]:
        """Returns one image for each of `rgb`, `depth` and `semantic` (here geom ids)."""
        ahead = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
        self._eye.lookat[:] = pose.x_m + ahead[0], pose.y_m + ahead[1], self._camera.height_m
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


def three_images(setting: Setting) -> list[Figure]:
    """(a) Measures rgb + depth + semantic."""
    return _against_plain(setting, "a", ("rgb", "depth", "semantic"), {DEFAULT: 8.0, ONE_SHADOW: 8.0, FAST: 1.8})


def two_images(setting: Setting) -> list[Figure]:
    """(b) Measures depth + semantic."""
    return _against_plain(setting, "b", ("depth", "semantic"), {DEFAULT: 4.0})


def _against_plain(setting: Setting, part: str, sensors: Sequence[str], goals: Mapping[str, float]) -> list[Figure]:
    amount, split = setting.amount, load_split("val")
    ms: dict[str, list[np.ndarray]] = {"ours": [], **{quality: [] for quality in goals}}
    for number, name in enumerate(split.houses[: amount.houses]):
        world = World(split.load_house(name))
        poses = free_poses(world, amount.poses, np.random.default_rng([number, 0]))
        mujoco.mj_forward(world.model, world.data)
        plain = {quality: PlainRenderer(world, quality) for quality in goals}
        camera = Camera(world.model, world.labels, profile="fast")
        works: dict[str, Callable[[Pose], object]] = {
            "ours": lambda pose, camera=camera, world=world: camera.render(world.data, pose, sensors),
            **{q: lambda pose, renderer=r: renderer.render(pose, sensors) for q, r in plain.items()},
        }
        for quality, taken in interleaved(works, poses, repeats=amount.repeats).items():
            ms[quality].append(taken)
        camera.close()
        for renderer in plain.values():
            renderer.close()
    all_ms = {quality: np.concatenate(taken) for quality, taken in ms.items()}
    return [
        Figure(
            part=part,
            what=" + ".join(sensors) + ", 640 x 480, profile fast",
            value=float(np.median(all_ms["ours"])),
            unit="ms",
            against=f"mujoco.Renderer, {len(sensors)} passes, {quality}",
            baseline=float(np.median(all_ms[quality])),
            ratio=speedup(all_ms["ours"], all_ms[quality]),
            goal=Goal(of="ratio", sign=">=", bound=bound),
            count=len(all_ms["ours"]),
        )
        for quality, bound in goals.items()
    ]
