"""The headlight, ambient occlusion and the soft shadows of lamps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sim.core.geometry.pose import Pose
from sim.gl import mujoco
from sim.houses.house import House
from sim.houses.labels import read_labels
from sim.renderer.camera import Camera
from sim.renderer.profiles import PROFILES
from tests.helpers.worlds import room, with_box

FAST = PROFILES["fast"]
PLAIN = replace(FAST, occlusion=0.0, shadows=0.0)


def dark(house: House, *, headlight: float = 0.3, ambient: float = 0.3) -> House:
    """Removes all lights but the headlight."""
    for light in list(house.spec.lights):
        house.spec.delete(light)
    light = house.spec.visual.headlight
    light.ambient, light.diffuse, light.specular = [ambient] * 3, [headlight] * 3, [0.0] * 3
    return house


def picture(house: House, pose: Pose, profile=FAST, sensors: tuple[str, ...] = ("rgb",)) -> np.ndarray:
    """Returns the grey picture (h, w) as floats."""
    model = house.spec.copy().compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    camera = Camera(model, read_labels(model), profile=profile)
    image = camera.render(data, pose, sensors)["rgb"].mean(axis=2)
    camera.close()
    return image


@pytest.mark.parametrize("yaw_rad", [0.0, 2.0, -1.5])
def test_the_headlight_is_at_the_eye_and_shines_forward(yaw_rad: float) -> None:
    """Far from the origin, a wall right ahead gets all of the headlight, whatever the heading."""
    ahead_m = np.array([40.0 + 3.0 * np.cos(yaw_rad), -25.0 + 3.0 * np.sin(yaw_rad)])
    house = dark(room(120, 120), headlight=0.8, ambient=0.0)
    spec = house.spec
    body = spec.worldbody.add_body(name="wall_20", pos=(*ahead_m, 1.0), euler=(0, 0, yaw_rad * 180 / np.pi))
    body.quat = [np.cos(yaw_rad / 2), 0, 0, np.sin(yaw_rad / 2)]
    body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=(0.1, 6, 4), rgba=(1, 1, 1, 1))
    image = picture(house, Pose(40.0, -25.0, yaw_rad, 0.0), PLAIN)
    assert image[200:240, 300:340].mean() > 0.75 * 255


def test_the_floor_is_darker_next_to_a_box_and_the_wall_far_behind_it_is_not() -> None:
    house = with_box(dark(room(12, 12)), "cabinet_00", centre_m=(2.2, 0, 0.5), half_m=(0.3, 0.3, 0.5))
    pose = Pose(0.0, 0.0, 0.0, 0.0)
    share = picture(house, pose, replace(FAST, shadows=0.0)) / np.maximum(picture(house, pose, PLAIN), 1.0)
    foot = share[425:430, 300:340].mean()  # the floor in front of the box, which begins at row 240 + 388 * 0.88 / 1.9
    assert foot < 0.85
    assert share[470:, 300:340].mean() > foot + 0.08
    assert share[215, 150:490].min() > 0.97  # the wall 4 m behind, left and right of the box and above it


def test_a_lamp_casts_a_soft_shadow_and_its_own_shade_casts_no_shadow() -> None:
    house = dark(room(8, 8), headlight=0.1)
    house.spec.worldbody.add_light(pos=(2.0, 0.0, 2.3), dir=(0, 0, -1), diffuse=[0.7] * 3, cutoff=80, castshadow=True)
    shaded = with_box(house, "lighting_00", centre_m=(2.0, 0, 2.1), half_m=(0.3, 0.3, 0.02))
    table = with_box(house, "table_00", centre_m=(2.0, 0, 1.2), half_m=(0.4, 0.4, 0.02))
    pose, profile = Pose(0.0, 0.0, 0.0, 0.0), replace(FAST, occlusion=0.0)
    lower = slice(350, 480)
    bare = picture(shaded, pose, PLAIN)
    np.testing.assert_allclose(picture(shaded, pose, profile)[lower], bare[lower], atol=3.0)
    share = picture(table, pose, profile)[lower] / picture(table, pose, PLAIN)[lower]
    assert share.min() < 0.8 < 0.97 < share.max()
    steps = np.abs(np.diff(share, axis=1))
    assert steps.max() < 0.12  # no hard edge


@pytest.mark.parametrize(("x_m", "y_m"), [(0.5, 0.0), (-0.5, 0.0), (0.0, 0.5), (0.0, -0.5)])
def test_a_shadow_lies_on_the_side_away_from_the_lamp(x_m: float, y_m: float) -> None:
    house = dark(room(12, 12), headlight=0.1)
    house.spec.worldbody.add_light(pos=(3.0, 0.0, 2.3), dir=(0, 0, -1), diffuse=[0.7] * 3, cutoff=80, castshadow=True)
    board = with_box(house, "table_00", centre_m=(3.0 + x_m, y_m, 1.3), half_m=(0.2, 0.2, 0.02))
    pose, profile = Pose(0.0, 0.0, 0.0, 0.0), replace(FAST, occlusion=0.0)
    share = picture(board, pose, profile) / np.maximum(picture(board, pose, PLAIN), 1.0)
    rows, columns = np.nonzero(share < 0.8)
    x = 0.88 * 388.2 / (rows - 239.5)  # on the floor
    y = (319.5 - columns) / 388.2 * x
    floor = rows > 300
    assert floor.sum() > 200
    assert x[floor].mean() == pytest.approx(3.0 + x_m * 2.3, abs=0.2)
    assert y[floor].mean() == pytest.approx(y_m * 2.3, abs=0.2)


def test_colours_do_not_depend_on_the_other_images() -> None:
    house = with_box(dark(room(12, 12)), "cabinet_00", centre_m=(2.2, 0.4, 0.5), half_m=(0.3, 0.3, 0.5))
    pose = Pose(0.0, 0.0, 0.3, 0.0)
    np.testing.assert_array_equal(picture(house, pose), picture(house, pose, FAST, ("rgb", "depth", "semantic")))


def test_an_emissive_material_keeps_its_colour() -> None:
    house = dark(room(8, 8))
    glow = house.spec.add_material(name="glow", rgba=(1, 1, 1, 1), emission=1.0)
    body = house.spec.worldbody.add_body(name="window_00", pos=(3.9, 0, 1.0))
    body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=(0.05, 1.0, 0.8), material=glow.name)
    framed = with_box(house, "cabinet_00", centre_m=(3.6, 0.3, 1.0), half_m=(0.3, 0.2, 1.0))
    white = picture(framed, Pose(1.0, 0.0, 0.0, 0.0), PLAIN) >= 254
    assert white.sum() > 1000
    assert picture(framed, Pose(1.0, 0.0, 0.0, 0.0))[white].min() >= 250
