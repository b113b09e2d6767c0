"""Further cameras: turned, tilted, panoramas; the camera that looks up and down; the map of true categories."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path

import msgspec
import numpy as np
import pytest
import torch
from numpy.typing import NDArray

from sim.app.composition.setup import resolve
from sim.app.options import RunOptions
from sim.app.submissions.contents import Actions
from sim.core.geometry.pose import BodyPose, Pose
from sim.core.interface import MPCAT40, MPCAT40_ID, SENSORS, Action, AgentSpec, CameraModel, ConfigError, as_action
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.splits import load_split
from sim.gl import mujoco
from sim.renderer.mounted import CameraConfig, MountedCameras
from sim.sensors.cameras import CameraSensor
from sim.world.world import World
from tests.helpers.foreign import write_robot

SMALL = {"width_px": 64, "height_px": 48}


def env_with(cameras: Mapping[str, Mapping[str, object]], **options: object) -> ObjectNavEnv:
    options = {"sensors": (), "camera": SMALL} | options
    return ObjectNavEnv(split="val", houses=["val_03"], cameras=cameras, **options)  # type: ignore[arg-type]


def test_a_camera_of_the_defaults_sees_what_the_first_one_sees() -> None:
    env = env_with({"same": {**SMALL, "images": SENSORS}}, sensors=SENSORS)
    observation, _ = env.reset(seed=0)
    assert all(np.array_equal(observation[f"same_{name}"], observation[name]) for name in SENSORS)
    assert env.observation_space.contains(observation)


def test_the_views_of_a_panorama_are_turned_counter_clockwise() -> None:
    views = {f"at_{k}": {**SMALL, "yaw_deg": 30.0 + 90.0 * k, "hfov_deg": 90.0} for k in range(4)}
    env = env_with(views | {"ring": {**SMALL, "yaw_deg": 30.0, "views": 4}})
    observation, _ = env.reset(seed=0)
    for k in range(4):
        assert np.array_equal(observation["ring_rgb"][k], observation[f"at_{k}_rgb"])
    env.step(Action.TURN_LEFT)
    assert observation["ring_depth"].shape == (4, 48, 64)


@pytest.mark.parametrize(("yaw_deg", "pitch_deg"), [(0.0, 0.0), (70.0, -35.0)])
def test_an_equirectangular_image_shows_the_rays_of_its_pixels(yaw_deg: float, pitch_deg: float) -> None:
    split = load_split("val")
    world = World(split.load_house("val_03"))
    world.reset(next(e for e in split.episodes if e.house == "val_03").start)
    config = CameraConfig(
        projection="equirectangular", width_px=720, height_px=360, yaw_deg=yaw_deg, pitch_deg=pitch_deg,
        left_m=0.05, min_depth_m=0.0, max_depth_m=30.0,
    )  # fmt: skip
    cameras = MountedCameras(world.model, world.labels, profile="fast", shared=None)
    images = cameras.render(world.data, world.body_pose, config, ("depth", "semantic"))
    eye_m = world.body_pose.point(0.0, 0.05, 0.88)
    axes = BodyPose(0, 0, math.radians(yaw_deg), pitch_rad=-math.radians(pitch_deg)).axes @ world.body_pose.axes
    errors, same = [], 0
    for row, col in np.random.default_rng(0).integers(0, (360, 720), (200, 2)).tolist():
        yaw, pitch = math.pi - math.tau * (col + 0.5) / 720, 0.5 * math.pi - math.pi * (row + 0.5) / 360
        ray = np.array([math.cos(pitch) * math.cos(yaw), math.cos(pitch) * math.sin(yaw), math.sin(pitch)]) @ axes
        geom = np.zeros((1, 1), np.int32)
        groups = np.array([1, 1, 1, 0, 0, 0], np.uint8)
        distance_m = mujoco.mj_ray(world.model, world.data, eye_m, ray, groups, 1, -1, geom)
        if geom[0, 0] < 0 or world.glass[geom[0, 0]]:
            continue
        errors.append(abs(images["depth"][row, col] - distance_m) / distance_m)
        same += images["semantic"][row, col] == world.labels.geom_category[geom[0, 0]]
    assert len(errors) > 150
    assert np.median(errors) < 0.01
    assert np.mean(np.array(errors) < 0.03) > 0.9
    assert same / len(errors) > 0.95


def test_the_depth_range_of_an_equirectangular_image_counts_along_its_rays() -> None:
    sphere = {"projection": "equirectangular", "width_px": 128, "height_px": 64, "images": ("depth",)}
    env = env_with({"all": {**sphere, "min_depth_m": 0.0}, "far": {**sphere, "min_depth_m": 1.2}})
    observation, _ = env.reset(seed=0)
    everything = observation["all_depth"]
    assert np.any(everything < 1.2)
    assert np.array_equal(observation["far_depth"], np.where(everything < 1.2, 0.0, everything))


def test_nothing_that_a_tilted_camera_could_see_is_left_out() -> None:
    split = load_split("val")
    world = World(split.load_house("val_03"))
    world.reset(next(e for e in split.episodes if e.house == "val_03").start)
    from sim.renderer.camera import Camera

    camera = Camera(world.model, world.labels, camera=CameraModel(width_px=64, height_px=64, hfov_rad=0.5 * math.pi))
    for pitch in (-1.57, -0.8, -0.3, 0.5, 1.2, 1.57):
        for yaw in (0.0, 2.0):
            axes = BodyPose(0, 0, yaw, pitch_rad=-pitch).axes @ world.body_pose.axes
            views = []
            for cull in (True, False):
                camera.cull = cull
                views.append(camera.render_from(world.data, world.body_pose.point(0, 0, 0.88), axes, SENSORS))
            assert all(np.array_equal(views[0][name], views[1][name]) for name in SENSORS), (pitch, yaw)


def test_the_first_camera_looks_up_and_down() -> None:
    cameras = {name: {**SMALL, "pitch_deg": pitch} for name, pitch in (("up", 30.0), ("down", -60.0))}
    env = env_with(cameras, sensors=("rgb", "depth", "tilt"), look=True)
    before, _ = env.reset(seed=0)
    up, _, _, _, info = env.step(Action.LOOK_UP)
    assert up["tilt"] == pytest.approx(math.radians(30.0))
    assert np.abs(up["rgb"].astype(int) - before["up_rgb"]).mean() < 0.5
    assert (info["num_steps"], info["path_length"], info["collided"]) == (1, 0.0, False)
    down = [env.step(Action.LOOK_DOWN)[0] for _ in range(5)][-1]
    assert down["tilt"] == pytest.approx(math.radians(-60.0))
    assert np.abs(down["depth"] - before["down_depth"]).max() < 0.02
    assert np.array_equal(down["gps"], before["gps"])
    again, _ = env.reset(seed=0)
    assert again["tilt"] == 0.0
    assert np.array_equal(again["rgb"], before["rgb"])


def test_looks_are_refused_without_a_declaration() -> None:
    env = env_with({})
    env.reset(seed=0)
    with pytest.raises(ConfigError, match=r"0 STOP, 1 MOVE_FORWARD, 2 TURN_LEFT, 3 TURN_RIGHT; got 4.*look=True"):
        env.step(4)


@pytest.mark.parametrize("value", [1, np.int64(1), np.array(1), torch.tensor(1), Action.MOVE_FORWARD], ids=repr)
def test_integers_of_any_library_are_actions(value: object) -> None:
    assert as_action(value) is Action.MOVE_FORWARD


NO_ACTIONS = (True, 1.0, "1", None, 9, np.array([1, 2]), torch.tensor([1, 2]), torch.tensor(1.5))


@pytest.mark.parametrize("value", NO_ACTIONS, ids=repr)
def test_other_values_are_not(value: object) -> None:
    assert as_action(value) is None


def test_true_images_of_a_camera_need_a_declaration() -> None:
    sensor = CameraSensor(camera="left", image="semantic")
    with pytest.raises(ConfigError, match="'left_semantic' reads ground truth"):
        AgentSpec(make=lambda **_: None, sensors=(sensor,))  # type: ignore[arg-type, return-value]
    with pytest.raises(ConfigError, match="'left_semantic' is ground truth, and agent 'stubborn'"):
        resolve(RunOptions(config=('cameras.left.images=["semantic"]',)))
    with pytest.raises(ConfigError, match="'semantic_map' reads ground truth"):
        AgentSpec(make=lambda **_: None, sensors=("semantic_map",))  # type: ignore[arg-type, return-value]


def test_cameras_are_declared_by_a_configuration_and_by_a_sidecar(tmp_path: Path) -> None:
    words = ("cameras.left.yaw_deg=60", "cameras.left.pitch_deg=-20", 'cameras.back.images=["rgb"]')
    config = resolve(RunOptions(config=words)).config
    assert config.cameras["left"] == CameraConfig(yaw_deg=60, pitch_deg=-20)
    assert config.sensors[-3:] == ("left_rgb", "left_depth", "back_rgb")
    with pytest.raises(ConfigError, match=r"no field 'cameras.left.yaw'. Did you mean 'yaw_deg'"):
        resolve(RunOptions(config=("cameras.left.yaw=60",)))
    robot = write_robot(tmp_path, cameras={"left": {"yaw_deg": 45, **SMALL}})
    both = resolve(RunOptions(robot=str(robot), config=("cameras.left.left_m=0.1",))).config.cameras["left"]
    assert both == CameraConfig(yaw_deg=45, left_m=0.1, width_px=64, height_px=48)


@pytest.mark.parametrize(
    ("fields", "reason"),
    [
        ({"pitch_deg": 100}, "pitch_deg must lie in"), ({"images": ["normals"]}, "images must be some of"),
        ({"views": 2.5}, "views"), ({"projection": "fisheye"}, "projection"), ({"hfov_deg": 200}, "hfov_rad"),
        ({"projection": "equirectangular", "views": 4}, "neither views nor hfov_deg"), ({"hfov_deg": 0}, "hfov_rad"),
    ],
)  # fmt: skip
def test_a_camera_that_cannot_be_is_refused(fields: dict[str, object], reason: str) -> None:
    with pytest.raises(ConfigError, match=reason):
        env_with({"left": fields})


def test_the_map_shows_the_true_categories_around_the_robot() -> None:
    env = env_with({}, sensors=("semantic_map",))
    observation, _ = env.reset(seed=0)
    world, labels = env.scene.world, env.scene.world.labels
    seen: NDArray[np.uint8] = observation["semantic_map"]
    assert seen[100, 100] == MPCAT40_ID["floor"]
    pose: Pose = world.body_pose
    near = [i for i in labels.instances if i.category in ("bed", "sofa", "table", "chest_of_drawers")]
    checked = 0
    for instance in near:
        x, y = world.data.geom_xpos[list(instance.geom_ids), :2].mean(axis=0)
        place = Pose(float(x), float(y), 0.0).relative_to(pose)
        row, col = int(100 - place.x_m / 0.05), int(100 - place.y_m / 0.05)
        if 5 <= row < 195 and 5 <= col < 195:
            window = seen[row - 4 : row + 5, col - 4 : col + 5]
            assert MPCAT40_ID[instance.category] in window, (instance.name, [MPCAT40[c] for c in np.unique(window)])
            checked += 1
    assert checked >= 2


def test_a_sidecar_whose_cameras_are_no_object_is_refused(tmp_path: Path) -> None:
    robot = write_robot(tmp_path, cameras=["left"])
    assert json.loads(robot.with_suffix(".json").read_text())["cameras"] == ["left"]
    with pytest.raises(ConfigError, match='"cameras" in its sidecar must be an object'):
        resolve(RunOptions(robot=str(robot)))


@pytest.mark.parametrize(("actions", "allowed"), [("0123", True), ("1450", True), ("16", False)])
def test_submissions_hold_looks(actions: str, allowed: bool) -> None:
    if allowed:
        assert msgspec.convert(actions, Actions) == actions
    else:
        with pytest.raises(msgspec.ValidationError):
            msgspec.convert(actions, Actions)
