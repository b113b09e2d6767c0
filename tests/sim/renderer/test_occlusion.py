"""Geoms behind walls are left out of an image, and no pixel changes."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from sim.core.geometry.pose import BodyPose, Pose
from sim.core.interface import CameraModel
from sim.core.paths import assets_dir
from sim.gl import mujoco
from sim.houses.house import House
from sim.houses.labels import rendered_geoms
from sim.houses.load import load_house
from sim.renderer.camera import Camera
from sim.renderer.occlusion import Visibility
from sim.renderer.opengl import Z_NEAR_M
from sim.world.world import World
from tests.helpers.sampling import sample
from tests.helpers.worlds import open_floor, room, with_box, with_movable

HOUSES = sorted((assets_dir() / "val").glob("*.xml"))
POSES_A_HOUSE = 25
WALL_HALF_M = (0.05, 2.0, 1.25)
"""A wall across the view, 4 m long and 2.5 m high."""


def rendered(house: House, *, eye: tuple[float, float, float] = (0.0, 0.0, 0.88), yaw_rad: float = 0.0) -> set[str]:
    """Returns the names of the geoms, or of their bodies, that are rendered."""
    model = house.spec.copy().compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    visibility = Visibility(model, rendered_geoms(model), CameraModel(), Z_NEAR_M)
    return {
        model.geom(geom).name or model.body(model.geom_bodyid[geom]).name
        for geom in visibility.visible(data, np.array(eye), BodyPose(0.0, 0.0, yaw_rad).axes)
    }


def with_wall(house: House, name: str = "wall_90", *, x_m: float = 2.0, y_m: float = 0.0, **options) -> House:
    half = options.pop("half_m", WALL_HALF_M)
    return with_box(house, name, centre_m=(x_m, y_m, options.pop("z_m", half[2])), half_m=half, **options)


def with_chair(
    house: House, *, x_m: float = 3.0, y_m: float = 0.0, z_m: float = 0.5, half_m: float = 0.2, **options
) -> House:
    return with_box(house, "chair_00", centre_m=(x_m, y_m, z_m), half_m=(half_m, half_m, half_m), **options)


def test_only_what_is_behind_a_full_wall_is_left_out() -> None:
    names = rendered(with_chair(with_wall(open_floor())))
    assert "wall_90" in names
    assert "chair_00" not in names
    for x_m in (1.5, 2.1):  # in front of the wall, and sticking out of it
        assert "chair_00" in rendered(with_chair(with_wall(open_floor()), x_m=x_m))


def _glassy(spec: mujoco.MjSpec) -> None:
    spec.add_material(name="glass", rgba=(1, 1, 1, 0.5))
    spec.geom("wall_90").material, spec.geom("wall_90").rgba = "glass", (0.5, 0.5, 0.5, 1)


def _round(spec: mujoco.MjSpec) -> None:
    spec.geom("wall_90").type = mujoco.mjtGeom.mjGEOM_ELLIPSOID


def _leaning(spec: mujoco.MjSpec) -> None:
    spec.geom("wall_90").quat = (math.cos(0.2), 0.0, math.sin(0.2), 0.0)


@pytest.mark.parametrize("change", [_glassy, _round, _leaning])
def test_a_wall_that_is_transparent_no_box_or_leaning_hides_nothing(change: Callable[[mujoco.MjSpec], None]) -> None:
    spec = with_chair(with_wall(open_floor())).spec.copy()
    change(spec)
    assert "chair_00" in rendered(House("changed", spec))


def test_a_wall_that_moves_hides_nothing() -> None:
    loose = with_movable(open_floor(), "wall_90", xy_m=(2.0, 0.0), size_m=(0.1, 4.0, 2.5))
    assert "chair_00" in rendered(with_chair(loose))


@pytest.mark.parametrize(
    "wall",
    [
        {"rgba": (0.6, 0.5, 0.4, 0.3)},
        {"half_m": (0.05, 2.0, 0.5)},
        {"half_m": (0.05, 2.0, 0.75), "z_m": 1.75},
        {"group": 3},
    ],
    ids=["glass", "half height", "lintel", "not rendered"],
)
def test_glass_half_walls_and_lintels_hide_no_higher_or_lower_object(wall: dict) -> None:
    assert "chair_00" in rendered(with_chair(with_wall(open_floor(), **wall), z_m=1.0))


def test_objects_behind_a_doorway_or_a_window_are_rendered() -> None:
    door = with_wall(with_wall(open_floor(), y_m=2.5), "wall_91", y_m=-2.5)  # a gap of 1 m ahead
    assert "chair_00" in rendered(with_chair(door))
    assert "chair_00" not in rendered(with_chair(door, x_m=4.0, y_m=3.0))
    sill = with_wall(door, "wall_92", half_m=(0.05, 0.5, 0.4))
    window = with_wall(sill, "wall_93", half_m=(0.05, 0.5, 0.25), z_m=2.25)
    assert "chair_00" in rendered(with_chair(window, z_m=0.8))


def test_a_gap_of_one_pixel_is_a_gap() -> None:
    gap_m = 2.0 / CameraModel().focal_px  # at 2 m
    left = with_wall(open_floor(), y_m=2.0 + 0.5 * gap_m)
    both = with_chair(with_wall(left, "wall_91", y_m=-2.0 - 0.5 * gap_m), x_m=4.0)
    for yaw_rad in np.linspace(-0.5, 0.5, 21):
        assert "chair_00" in rendered(both, yaw_rad=float(yaw_rad)), yaw_rad


def test_an_object_that_is_wider_or_higher_than_a_wall_is_rendered() -> None:
    narrow = with_wall(open_floor(), half_m=(0.05, 1.0, 1.25))  # hides y < 1.46 m at the chair's front
    assert "chair_00" in rendered(with_chair(narrow, y_m=1.3))
    assert "chair_00" not in rendered(with_chair(narrow, y_m=1.15))
    low = with_wall(open_floor(), half_m=(0.05, 2.0, 0.6))  # 0.32 m over the eye at 2 m
    tall = {"x_m": 4.0, "half_m": 0.2}
    assert "chair_00" in rendered(with_chair(low, z_m=1.42, **tall))  # 0.74 m over the eye at 3.8 m
    assert "chair_00" not in rendered(with_chair(low, z_m=1.15, **tall))


def test_an_object_visible_below_a_wall_is_rendered() -> None:
    raised = with_wall(open_floor(), half_m=(0.05, 2.0, 1.0), z_m=1.5)  # 0.38 m under the eye at 2 m
    assert "chair_00" in rendered(with_chair(raised, x_m=4.0, z_m=0.2))


def test_below_a_ceiling_that_covers_the_wall_nothing_is_visible_above_it() -> None:
    """A shelf higher than the wall is visible over the wall without a ceiling, but not below one."""
    walled = with_wall(open_floor(), x_m=4.0, half_m=(0.05, 6.0, 1.25))
    shelf = with_box(walled, "shelving_00", centre_m=(5.0, 0, 3.5), half_m=(0.3, 0.3, 0.5))
    assert "shelving_00" in rendered(shelf)
    assert "shelving_00" not in rendered(with_box(shelf, "ceiling_00", centre_m=(0, 0, 2.55), half_m=(4.5, 6, 0.05)))
    short = with_box(shelf, "ceiling_00", centre_m=(0, 0, 2.55), half_m=(3.0, 6, 0.05))
    assert "shelving_00" in rendered(short)


def test_a_wall_that_extends_behind_the_eye_is_hidden_by_a_nearer_one_without_gaps() -> None:
    near = {"half_m": (5.0, 0.05, 1.25), "y_m": 1.0}
    far = {"half_m": (8.0, 0.05, 1.25), "y_m": 1.5}
    yaw_rad = 0.9  # ahead is the nearer wall's side, its ends are at 11 deg and far behind
    closed = with_wall(with_wall(open_floor(), "wall_91", x_m=0.0, **far), x_m=0.0, **near)
    assert "wall_91" in rendered(closed, yaw_rad=0.0)  # beyond the nearer wall's end
    assert "wall_91" not in rendered(closed, yaw_rad=yaw_rad)
    with_gap = with_wall(with_wall(open_floor(), "wall_91", x_m=0.0, **far), x_m=-4.9, **near)
    with_gap = with_wall(with_gap, "wall_92", x_m=5.12, **near)  # 2 cm, nearly straight to the left
    assert "wall_91" in rendered(with_gap, yaw_rad=yaw_rad)
    higher = with_wall(with_wall(open_floor(), "wall_91", x_m=0.0, **far, z_m=2.75), x_m=0.0, **near)
    assert "wall_91" in rendered(higher, yaw_rad=yaw_rad)
    deeper = with_wall(with_wall(open_floor(), "wall_91", x_m=0.0, **far, z_m=0.25), x_m=0.0, **near)
    assert "wall_91" in rendered(deeper, yaw_rad=yaw_rad)


def test_a_needle_between_two_edge_rays_is_rendered() -> None:
    walled = with_wall(open_floor())
    for y_m in np.linspace(-0.011, 0.011, 9):
        needle = with_box(walled, "plant_00", centre_m=(1.0, float(y_m), 0.9), half_m=(0.0005, 0.0005, 0.5))
        assert "plant_00" in rendered(needle), y_m


def test_a_corner_that_sticks_out_of_a_wall_towards_the_eye_is_rendered() -> None:
    """Turned by 45 degrees, only a tip of 3 mm is visible in the middle of a strip, where no edge ray meets it."""
    walled = with_wall(open_floor())
    front_m = 1.95
    for y_m in np.linspace(-0.02, 0.02, 9):
        tip_m = front_m - 0.012
        box = with_box(
            walled,
            "plant_00",
            centre_m=(tip_m + 0.1 * math.sqrt(2), float(y_m), 0.9),
            half_m=(0.1, 0.1, 0.5),
            yaw_rad=math.pi / 4,
        )
        assert "plant_00" in rendered(box), y_m


@pytest.mark.parametrize("side", [-1.0, 1.0], ids=["right", "left"])
def test_an_object_that_enters_over_the_image_border_is_rendered(side: float) -> None:
    """A plate nearly along the border ray is in front of the wall only where the border cuts it."""
    outer, inner = (1.5, 1.5 * 0.835), (2.4, 2.4 * 0.805)  # the border is at a slope of 0.824
    dx, dy = inner[0] - outer[0], inner[1] - outer[1]
    plate = with_box(
        with_wall(open_floor(), half_m=(0.05, 3.0, 1.25)),
        "plant_00",
        centre_m=(0.5 * (outer[0] + inner[0]), side * 0.5 * (outer[1] + inner[1]), 0.9),
        half_m=(0.5 * math.hypot(dx, dy), 0.0001, 0.4),
        yaw_rad=side * math.atan2(dy, dx),
    )
    assert "plant_00" in rendered(plate)


def test_the_current_position_of_a_movable_object_counts() -> None:
    house = with_movable(with_wall(open_floor()), "chair_00", xy_m=(3.0, 0.0))
    model = house.spec.copy().compile()
    data = mujoco.MjData(model)
    visibility = Visibility(model, rendered_geoms(model), CameraModel(), Z_NEAR_M)
    seen = []
    for x_m in (3.0, 1.2, 3.0):
        data.qpos[0] = x_m
        mujoco.mj_kinematics(model, data)
        seen.append(model.geom("wall_90").id + 1 in visibility.visible(data, np.array([0, 0, 0.88]), np.eye(3)))
    assert seen == [False, True, False]


def test_from_inside_a_wall_and_directly_in_front_of_one_everything_is_rendered() -> None:
    house = with_chair(with_wall(open_floor(), half_m=(0.5, 2.0, 1.25)))
    assert "chair_00" in rendered(house, eye=(2.0, 0, 0.88))
    assert "chair_00" in rendered(house, eye=(1.46, 0, 0.88))  # the near plane cuts the front away
    assert "chair_00" not in rendered(house, eye=(1.40, 0, 0.88))


@pytest.mark.costly
def test_in_a_room_of_many_boxes_a_frame_differs_in_no_pixel() -> None:
    """Walls, half walls, beams and pillars with random poses, many of them very near to the camera."""
    rng = np.random.default_rng(5)
    house = room(12, 12)
    for number in range(70):
        tall = rng.random() < 0.5
        half_z = 1.25 if tall else float(rng.uniform(0.1, 1.0))
        z = 1.25 if tall else float(rng.uniform(half_z, 2.5 - half_z))
        house = with_box(
            house,
            f"{'wall' if tall else 'cabinet'}_{number + 10}",
            centre_m=(float(rng.uniform(-6, 6)), float(rng.uniform(-6, 6)), z),
            half_m=(float(rng.uniform(0.02, 0.9)), float(rng.uniform(0.02, 0.2)), half_z),
            yaw_rad=float(rng.choice([0.0, math.pi / 2, rng.uniform(0, 3)])),
        )
    world = World(house)
    poses = [Pose(float(x), float(y), float(yaw)) for x, y, yaw in rng.uniform(-5, 5, (60, 3))]
    leans = rng.uniform(-0.25, 0.25, (60, 3))
    leaning = [
        BodyPose(pose.x_m, pose.y_m, pose.yaw_rad, 0.0, *lean) for pose, lean in zip(poses, leans.tolist(), strict=True)
    ]
    assert differing_pixels(world, [*poses, *leaning], ("rgb", "depth", "geom")) == 0


@functools.cache
def house_poses() -> list[tuple[Path, int]]:
    return [(path, number) for path in HOUSES for number in range(POSES_A_HOUSE)]


@pytest.mark.costly
def test_in_shipped_houses_no_pixel_changes() -> None:
    """500 poses in 20 houses under `--all-cases`."""
    by_house: dict[Path, list[int]] = {}
    for path, number in sample(house_poses(), 4):
        by_house.setdefault(path, []).append(number)
    for path, numbers in by_house.items():
        world = World(load_house(path))
        assert differing_pixels(world, somewhere(world, numbers), ("rgb", "depth", "geom")) == 0, path.name


def somewhere(world: World, seeds: list[int]) -> list[Pose]:
    """Returns random poses in the robot's free space."""
    space = world.free_space()
    cells, (x, y) = np.argwhere(space.largest_part()), space.frame.axes()
    poses = []
    for seed in seeds:
        rng = np.random.default_rng(seed)
        row, col = rng.choice(cells)
        poses.append(Pose(float(x[col]), float(y[row]), float(rng.uniform(-math.pi, math.pi))))
    return poses


def differing_pixels(world: World, poses: list[Pose], sensors: tuple[str, ...]) -> int:
    """Returns the number of pixels that differ between images of all geoms and of those that may be visible."""
    mujoco.mj_forward(world.model, world.data)
    culled, whole = Camera(world.model, world.labels), Camera(world.model, world.labels, cull=False)
    count = 0
    for pose in poses:
        one, other = (camera.render(world.data, pose, sensors) for camera in (culled, whole))
        count += sum(int((one[name] != other[name]).sum()) for name in sensors)
    culled.close()
    whole.close()
    return count
