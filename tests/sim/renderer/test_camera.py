"""The images of the camera agree with the geometry of the house, to the pixel and the millimetre."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import MPCAT40_ID, CameraModel, ConfigError
from sim.gl import mujoco
from sim.houses.house import House
from sim.houses.labels import read_labels
from sim.renderer.camera import Camera
from tests.helpers.worlds import cluttered_room, room, with_box, with_post


class Eye:
    """A camera in a house without a robot."""

    def __init__(self, house: House, **options) -> None:
        self.model = house.spec.copy().compile()
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)
        self.camera = Camera(self.model, read_labels(self.model), **options)

    def see(self, x_m: float, y_m: float, yaw_rad: float, *sensors: str) -> dict[str, np.ndarray]:
        return self.camera.render(self.data, Pose(x_m, y_m, yaw_rad), sensors)


@pytest.fixture(scope="module")
def clutter() -> Iterator[tuple[Eye, Eye]]:
    house = with_post(cluttered_room(60, width_m=8.0), "column_00", xy_m=(1.5, 0.4), radius_m=0.1)
    culled, whole = Eye(house), Eye(house, cull=False)
    yield culled, whole
    culled.camera.close()
    whole.camera.close()


@pytest.mark.parametrize("distance_m", [0.6, 1.0, 2.5, 4.8])
def test_depth_of_a_wall_ahead_is_its_distance_at_every_pixel(distance_m: float) -> None:
    house = with_box(room(30, 30, height_m=30.0), "cabinet_00", centre_m=(distance_m + 1, 0, 0), half_m=(1, 9, 9))
    depth = Eye(house).see(0, 0, 0, "depth")["depth"]
    assert depth.dtype == np.float32
    assert np.abs(depth[:240] - distance_m).max() < 1e-3


def test_depth_of_the_floor_follows_the_pinhole_model() -> None:
    camera = CameraModel()
    depth = Eye(room(30, 30)).see(0, 0, 0.3, "depth")["depth"]
    rows = np.arange(camera.height_px)[:, None]
    below = (rows + 0.5 - camera.height_px / 2) / camera.focal_px  # slope of the ray through the centre of the pixel
    floor_m = camera.height_m / np.maximum(below, 1e-9)
    lower = np.broadcast_to((floor_m > 0.5) & (floor_m < 4.9), depth.shape)
    assert np.abs(depth - floor_m)[lower].max() < 0.02  # half a pixel of slope at 4.9 m


def test_nearer_than_half_a_metre_reads_0_and_farther_than_five_reads_5() -> None:
    house = with_box(room(30, 30, height_m=30.0), "cabinet_00", centre_m=(0.9, 0, 0.88), half_m=(0.5, 0.1, 0.1))
    depth = Eye(house).see(0, 0, 0, "depth")["depth"]
    assert depth[240, 320] == 0.0
    assert depth[100, 320] == 5.0


def test_without_a_geom_depth_and_semantic_read_0() -> None:
    images = Eye(room(30, 30, height_m=1.0)).see(0, 0, 0, "depth", "semantic")
    assert images["depth"][0, 320] == 0.0
    assert images["semantic"][0, 320] == 0


def test_semantic_depth_and_geom_agree_at_the_edges(clutter: tuple[Eye, Eye]) -> None:
    """A column is 1.4 m away in front of a wall at 4 m: no pixel may have the id of one and the depth of the other."""
    images = clutter[0].see(0, 0, math.atan2(0.4, 1.5), "depth", "semantic", "geom")
    column = images["semantic"] == MPCAT40_ID["column"]
    assert column.sum() > 1000
    assert np.abs(images["depth"][column] - math.hypot(1.5, 0.4) + 0.05).max() < 0.06
    assert (np.unique(images["geom"][column]).size, column.any()) == (1, True)


def test_the_back_of_an_open_mesh_is_in_no_image() -> None:
    """A sheet of one face at x = 2 m, which the colour pass shows from its front only."""
    corners = np.array([[0, -1, -1], [0, 1, -1], [0, 1, 1], [0, -1, 1]], float)
    shown: dict[str, np.ndarray] = {}
    for side, order in {"front": (0, 2, 1, 0, 3, 2), "back": (0, 1, 2, 0, 2, 3)}.items():
        spec = room(8, 8).spec.copy()
        spec.add_mesh(
            name="sheet", uservert=corners.ravel(), userface=order, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
        )
        spec.worldbody.add_geom(
            name="cabinet_00",
            type=mujoco.mjtGeom.mjGEOM_MESH,
            meshname="sheet",
            pos=(2, 0, 1),
            contype=0,
            conaffinity=0,
            rgba=(1, 0, 0, 1),
        )
        images = Eye(House(side, spec)).see(0, 0, 0, "rgb", "depth", "semantic")
        shown[side] = images["semantic"] == MPCAT40_ID["cabinet"]
        red = images["rgb"][..., 0] > 2 * images["rgb"][..., 1].astype(int)
        np.testing.assert_array_equal(red, shown[side])
        np.testing.assert_array_equal(np.isclose(images["depth"], 2.0, atol=1e-3), shown[side])
    assert shown["front"].sum() > 10_000
    assert not shown["back"].any()


def test_in_the_good_profile_an_invisible_object_casts_its_shadow() -> None:
    """A cupboard behind the camera, under a lamp further back."""
    spec = with_box(room(8, 8), "cabinet_00", centre_m=(-1.6, 0.0, 1.9), half_m=(0.1, 0.5, 0.3)).spec.copy()
    spec.lights[0].pos, spec.lights[0].dir = (-2.0, 0.0, 2.4), (0.0, 0.0, -1.0)
    house = House("lamp", spec)
    culled, whole = (Eye(house, profile="good", cull=cull) for cull in (True, False))
    bare = Eye(with_box(room(8, 8), "cabinet_00", centre_m=(-3.5, 3.5, 0.5), half_m=(0.1, 0.1, 0.3)), profile="good")
    bare.model.light_pos[:], bare.model.light_dir[:] = (-2.0, 0.0, 2.4), (0.0, 0.0, -1.0)
    mujoco.mj_forward(bare.model, bare.data)
    shadow, same, none = (eye.see(0, 0, 0, "rgb", "depth")["rgb"] for eye in (culled, whole, bare))
    np.testing.assert_array_equal(shadow, same)
    assert (shadow != none).any()


def test_images_never_share_memory(clutter: tuple[Eye, Eye]) -> None:
    first = clutter[0].see(0, 0, 0, "rgb", "depth", "semantic")
    kept = {name: image.copy() for name, image in first.items()}
    clutter[0].see(1, 1, 2, "rgb", "depth", "semantic")
    for name, image in first.items():
        np.testing.assert_array_equal(image, kept[name])


def test_only_requested_images_are_returned(clutter: tuple[Eye, Eye]) -> None:
    assert set(clutter[0].see(0, 0, 0, "depth")) == {"depth"}
    assert clutter[0].see(0, 0, 0) == {}
    with pytest.raises(ConfigError, match="Unknown sensor 'thermal'"):
        clutter[0].see(0, 0, 0, "thermal")


def test_collision_geoms_are_in_no_image() -> None:
    bare = room(8, 8)
    glass = with_box(bare, "cabinet_00", centre_m=(1.5, 0, 1.0), half_m=(0.02, 1.0, 1.0), group=3)
    with_glass, without = (Eye(house).see(0, 0, 0, "rgb", "depth", "semantic") for house in (glass, bare))
    for sensor, image in with_glass.items():
        np.testing.assert_array_equal(image, without[sensor])


def test_left_in_the_world_is_left_in_the_image() -> None:
    house = with_box(room(8, 8), "sofa_00", centre_m=(2.5, 1.0, 0.5), half_m=(0.3, 0.3, 0.5))
    semantic = Eye(house).see(0, 0, 0, "semantic")["semantic"]
    columns = np.nonzero(semantic == MPCAT40_ID["sofa"])[1]
    assert 0 < columns.max() < 320


def test_the_good_profile_does_not_blend_ids(clutter: tuple[Eye, Eye]) -> None:
    house = cluttered_room(40, width_m=6.0)
    fast, good = (Eye(house, profile=name).see(0, 0, 0.4, "semantic", "geom", "rgb") for name in ("fast", "good"))
    np.testing.assert_array_equal(fast["geom"], good["geom"])
    assert (fast["rgb"] != good["rgb"]).any()


def test_the_good_profile_smooths_edges_also_after_the_id_pass() -> None:
    """Between two flat colours there are blended ones, also directly after the pass that must not blend."""
    house = with_box(room(8, 8), "sofa_00", centre_m=(2.5, 0.0, 0.5), half_m=(0.3, 0.3, 0.5), yaw_rad=0.3)
    eyes = {name: Eye(house, profile=name) for name in ("fast", "good")}
    shades = {}
    for name, eye in eyes.items():
        eye.model.light_active[:] = 0
        rgb = eye.see(0, 0, 0.05, "rgb", "semantic")["rgb"]
        shades[name] = len(np.unique(rgb.reshape(-1, 3), axis=0))
    assert shades["good"] > shades["fast"]


def test_deleting_one_camera_does_not_change_the_others() -> None:
    keeper, dropped = Eye(cluttered_room(20)), Eye(cluttered_room(30))
    dropped.see(0, 0, 0, "rgb")
    before = keeper.see(0, 0, 0, "rgb", "geom")
    del dropped
    after = keeper.see(0, 0, 0, "rgb", "geom")
    np.testing.assert_array_equal(before["rgb"], after["rgb"])
    np.testing.assert_array_equal(before["geom"], after["geom"])
