"""Depth and lidar see through panes of windows, but for a share of their rays."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import MPCAT40_ID, CameraModel
from sim.gl import mujoco
from sim.houses.glass import RETURN_SHARE
from sim.houses.house import House
from sim.renderer.camera import Camera
from sim.sensors.scan import ScanConfig, ScanSensor
from sim.sensors.sensor import SensorContext
from sim.world.world import World
from tests.helpers.worlds import room, with_box

CAMERA = CameraModel(width_px=160, height_px=120)
PANE_M, WALL_M = 1.5, 3.0
WINDOW = MPCAT40_ID["window"]


def glazed(kind: str) -> House:
    """Returns a room with a pane across the view: `clear`, with a `picture` of the outside, or a `solid` panel."""
    house = with_box(room(6.0, 6.0), "window_00", centre_m=(PANE_M + 0.01, 0.0, 1.0), half_m=(0.01, 2.0, 1.0))
    spec = house.spec
    pane = spec.geom("window_00") if spec.geom("window_00") is not None else spec.body("window_00").geoms[0]
    if kind == "clear":
        pane.rgba = (0.8, 0.9, 1.0, 0.3)
    elif kind == "picture":
        flat = mujoco.mjtBuiltin.mjBUILTIN_FLAT
        spec.add_texture(name="view_sky", type=mujoco.mjtTexture.mjTEXTURE_2D, builtin=flat, width=4, height=4)
        spec.add_material(name="outside").textures[int(mujoco.mjtTextureRole.mjTEXROLE_RGB)] = "view_sky"
        pane.material = "outside"
    return house


def look(kind: str, *sensors: str) -> tuple[World, dict[str, np.ndarray]]:
    """Returns a world with the robot in front of the pane, and what its camera sees."""
    world = World(glazed(kind))
    world.reset(Pose(0.0, 0.0, 0.0))
    camera = Camera(world.model, world.labels, camera=CAMERA)
    images = camera.render(world.data, world.camera_pose, sensors)
    camera.close()
    return world, images


@pytest.mark.parametrize(("kind", "behind_m"), [("clear", WALL_M), ("picture", CAMERA.max_depth_m)])
def test_most_pixels_of_a_pane_show_what_is_behind_it(kind: str, behind_m: float) -> None:
    _, images = look(kind, "depth", "semantic", "rgb")
    pane = images["semantic"] == WINDOW
    middle = np.zeros_like(pane)
    middle[40:70, 40:120] = True
    assert pane[middle].all()
    depth_m = images["depth"][middle]
    returned = np.abs(depth_m - PANE_M) < 0.01
    assert returned.mean() == pytest.approx(RETURN_SHARE, abs=0.03)
    np.testing.assert_allclose(depth_m[~returned], behind_m, atol=0.01)
    alone = look(kind, "depth")[1]["depth"]
    np.testing.assert_array_equal(alone, images["depth"])
    np.testing.assert_array_equal(look(kind, "rgb")[1]["rgb"], images["rgb"])


def test_a_panel_that_is_not_glass_is_not_transparent() -> None:
    _, images = look("solid", "depth", "semantic")
    np.testing.assert_allclose(images["depth"][40:70, 40:120], PANE_M, atol=0.01)


@pytest.mark.parametrize(("kind", "behind_m"), [("clear", WALL_M), ("picture", WALL_M), ("solid", PANE_M)])
def test_most_rays_of_a_lidar_go_on_behind_a_pane(kind: str, behind_m: float) -> None:
    world, _ = look(kind, "semantic")
    config = ScanConfig(rays=721)
    sensor = ScanSensor(config=config)
    fields = {"pose": world.body_pose, "model": world.model, "data": world.data, "glass": world.glass}
    ahead = np.abs(config.angles_rad) < math.radians(40.0)
    distance_m = sensor.read(SensorContext(sensor, {}, **fields))[ahead] * np.cos(config.angles_rad[ahead])
    returned = np.abs(distance_m - PANE_M) < 0.01
    np.testing.assert_allclose(distance_m[~returned], behind_m, atol=0.03)
    assert returned.mean() == pytest.approx(1.0 if kind == "solid" else RETURN_SHARE, abs=0.06)
