"""The lamps that light an image, and the geoms that cast shadows into it."""

from __future__ import annotations

import numpy as np

from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel
from sim.gl import mujoco
from sim.houses.house import House
from sim.houses.labels import rendered_geoms
from sim.renderer.camera import Camera
from sim.renderer.lamps import MAX_LAMPS, Lamps
from sim.renderer.occlusion import Visibility
from sim.renderer.opengl import Z_NEAR_M
from sim.robot.config import RobotConfig
from sim.world.compile import compile_world
from tests.helpers.worlds import room, with_box

FORWARD = np.array([1.0, 0.0, 0.0])


def two_rooms() -> House:
    """Returns a wall with a doorway at y < -1 between two halves of a room; a lamp in each half, the left one first."""
    house = with_box(room(8, 5), "wall_10", centre_m=(0, 0.75, 1.25), half_m=(0.05, 1.75, 1.25))
    spec = house.spec
    for light in list(spec.lights):
        spec.delete(light)
    for x in (-2.0, 2.0):
        spec.worldbody.add_light(pos=(x, 1.0, 2.3), dir=(0, 0, -1), castshadow=True, cutoff=80, exponent=1)
    return house


class Eye:
    """Returns a camera in a house and the lamps that it chooses."""

    def __init__(self, house: House, *, profile: str = "fast", cull: bool = True) -> None:
        self.model, self.labels, _ = compile_world(house, RobotConfig())
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)
        visual = rendered_geoms(self.model)
        visibility = Visibility(self.model, visual, CameraModel(), Z_NEAR_M)
        self.visibility = visibility
        self.lamps = Lamps(self.model, visibility, np.flatnonzero(visual))
        self.profile, self.cull = profile, cull

    def choose(self, x_m: float, y_m: float) -> list[int]:
        return self.lamps.choose(self.data, np.array([x_m, y_m, 0.88]), FORWARD)

    def rgb(self, pose: Pose) -> np.ndarray:
        camera = Camera(self.model, self.labels, profile=self.profile, cull=self.cull)
        image = camera.render(self.data, pose, ("rgb",))["rgb"]
        camera.close()
        return image


def test_a_lamp_behind_a_wall_is_off_and_one_behind_a_doorway_is_on() -> None:
    eye = Eye(two_rooms())
    assert eye.choose(-3.0, 1.0) == [0]
    assert eye.choose(3.0, 1.0) == [1]
    assert set(eye.choose(0.0, -1.8)) == {0, 1}


def test_the_lamp_nearest_to_the_viewed_region_comes_first_and_their_number_is_limited() -> None:
    house = room(20, 4)
    for x in (-8.0, -4.0, 0.0, 4.0, 8.0):
        house.spec.worldbody.add_light(pos=(x, 0, 2.3), dir=(0, 0, -1))
    chosen = Eye(house).choose(2.0, 0.0)
    assert len(chosen) == MAX_LAMPS
    assert chosen[0] == 4  # of the six lamps, lamp 4 is 0.5 m from the point looked at


def test_directional_lights_are_always_on() -> None:
    house = two_rooms()
    for _ in range(3):
        house.spec.worldbody.add_light(type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, dir=(0, 0, -1))
    eye = Eye(house)
    eye.lamps.switch_on(eye.choose(-3.0, 1.0))
    assert eye.model.light_active.tolist() == [1, 0, 1, 1, 1]
    eye.lamps.restore()
    assert eye.model.light_active.tolist() == [1, 1, 1, 1, 1]


def test_a_lamp_behind_a_wall_changes_no_pixel() -> None:
    alone = two_rooms()
    alone.spec.delete(alone.spec.lights[1])
    pose = Pose(-1.0, 1.5, np.pi, 0.0)
    np.testing.assert_array_equal(Eye(two_rooms()).rgb(pose), Eye(alone).rgb(pose))


def test_an_object_outside_the_image_casts_its_shadow_into_it_and_one_behind_a_wall_does_not() -> None:
    board = with_box(two_rooms(), "picture_00", centre_m=(-2.0, 0.5, 1.8), half_m=(0.5, 0.05, 0.3))
    elsewhere = with_box(board, "table_00", centre_m=(2.0, 0.5, 1.8), half_m=(0.5, 0.05, 0.3))
    pose = Pose(-2.0, 0.9, -np.pi / 2, 0.0)
    shadow = Eye(elsewhere, profile="good").rgb(pose)
    np.testing.assert_array_equal(shadow, Eye(elsewhere, profile="good", cull=False).rgb(pose))
    bare = Eye(two_rooms(), profile="good").rgb(pose)
    assert (np.abs(bare.astype(int) - shadow) > 20).any(axis=2).mean() > 0.03


def test_lamps_of_other_storeys_are_off() -> None:
    house = room(8, 5)
    for light in list(house.spec.lights):
        house.spec.delete(light)
    for z in (2.3, 5.2):
        house.spec.worldbody.add_light(pos=(0, 1.0, z), dir=(0, 0, -1))
    eye = Eye(house)
    assert eye.lamps.choose(eye.data, np.array([-1.0, 1.0, 0.88]), FORWARD) == [0]
    assert eye.lamps.choose(eye.data, np.array([-1.0, 1.0, 2.9 + 0.88]), FORWARD) == [1]


def test_a_movable_object_takes_its_shadow_along() -> None:
    """The picture of a house that was rendered before is that of a new camera, wherever the object is now."""
    house = two_rooms()
    body = house.spec.worldbody.add_body(name="stool_00", pos=(-2.0, 0.2, 1.2))
    body.add_freejoint()
    body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=(0.3, 0.3, 0.05))
    eye, pose = Eye(house), Pose(-2.0, 2.0, -np.pi / 2, 0.0)
    camera = Camera(eye.model, eye.labels)
    before = camera.render(eye.data, pose, ("rgb",))["rgb"]
    joint = eye.model.body_jntadr[eye.model.body("stool_00").id]
    eye.data.qpos[eye.model.jnt_qposadr[joint]] += 0.7
    mujoco.mj_forward(eye.model, eye.data)
    after = camera.render(eye.data, pose, ("rgb",))["rgb"]
    camera.close()
    changed = np.abs(before.astype(int) - after).max(axis=2) > 10
    assert changed[300:].mean() > 0.02
    np.testing.assert_array_equal(after, eye.rgb(pose))
