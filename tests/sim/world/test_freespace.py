"""Free space and geodesic distances against areas and path lengths computed by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.core.geometry.pose import Pose
from sim.core.interface import CLIMB_M, RobotModel, SuccessRule
from sim.gl import mujoco
from sim.houses.geoms import data_at_rest
from sim.houses.house import House, read_rooms
from sim.houses.labels import read_labels
from sim.world.freespace import FreeSpace
from sim.world.world import World
from tests.helpers.worlds import open_floor, room, with_box, with_movable, with_post

RADIUS_M = 0.18


def free_space(house: House, **options) -> FreeSpace:
    model = house.spec.copy().compile()
    data = data_at_rest(model)
    return FreeSpace(model, data, read_labels(model), rooms=read_rooms(model), **options)


def point(space: FreeSpace, x_m: float, y_m: float) -> np.ndarray:
    mask = np.zeros(space.frame.shape, dtype=bool)
    row, col = space.frame.to_cells((x_m, y_m))
    mask[row, col] = True
    return mask


def divided_room(gap_m: float) -> House:
    """Returns a room of 6 x 4 m with a wall along x = 0 that has a gap of `gap_m` in its middle."""
    length = 0.5 * (4.0 - gap_m)
    house = room(6, 4)
    for number, side in ((10, 1), (11, -1)):
        centre = (0.0, side * (0.5 * gap_m + 0.5 * length), 1.25)
        house = with_box(house, f"wall_{number}", centre_m=centre, half_m=(0.05, 0.5 * length, 1.25))
    return house


def test_an_empty_room_is_free_up_to_the_radius_from_its_walls():
    space = free_space(room(4, 3))
    assert space.free.sum() * space.frame.cell_m**2 == pytest.approx((4 - 0.36) * (3 - 0.36), rel=0.01)
    assert space.is_free(2.0 - RADIUS_M - 0.001, 0.0)
    assert not space.is_free(2.0 - RADIUS_M + 0.001, 0.0)


def test_a_path_may_begin_next_to_the_grid():
    space = free_space(room(4, 3))
    space.free[:] = True
    rows, cols = space.frame.shape
    field = np.hypot(*np.indices((rows, cols)) - [[[rows // 2]], [[cols // 2]]]).astype(np.float32)
    x_m, y_m = (cols + 2) * space.frame.cell_m + space.frame.origin_xy_m[0], 0.0
    path = space.path(field, x_m, y_m)
    assert path is not None
    assert path[0].tolist() == [x_m, y_m]
    np.testing.assert_allclose(path[-1], space.frame.to_metres([(rows // 2, cols // 2)])[0])


def test_a_path_from_a_place_that_is_not_free_leads_to_the_nearest_free_cell_first():
    space = free_space(room(4, 3))
    space.free[:] = False
    row, col = space.frame.cell(0.0, 0.0)
    space.free[row, : col + 1] = space.free[row:, col] = True  # two corridors with a corner at (row, col)
    (middle_m,), begin_m = space.frame.to_metres([(row, col)]), 0.2
    for source in ((row, col), (row, 5), (row + 20, col)):
        sources = np.zeros(space.frame.shape, dtype=np.bool_)
        sources[source] = True
        path = space.path(space.geodesic(sources), middle_m[0] + begin_m, middle_m[1] - begin_m / 4)
        assert path is not None
        corners = space.frame.to_cells(path).tolist()
        assert corners[1:] == [[row, col], list(source)][: 1 + (source != (row, col))]


@given(x=st.floats(-1.9, 1.9), y=st.floats(-1.4, 1.4))
@settings(max_examples=50)
def test_a_position_is_free_exactly_when_its_distance_to_a_turned_box_exceeds_the_radius(x, y):
    yaw = 0.6
    space = TURNED_BOX_SPACE
    c, s = math.cos(yaw), math.sin(yaw)
    u, v = c * (x - 0.2) + s * y, -s * (x - 0.2) + c * y
    distance = math.hypot(max(abs(u) - 0.5, 0), max(abs(v) - 0.1, 0))
    if min(abs(distance - RADIUS_M), abs(abs(x) - 1.82), abs(abs(y) - 1.32)) > 1e-4:
        assert space.is_free(x, y) == (distance > RADIUS_M and abs(x) < 1.82 and abs(y) < 1.32)


TURNED_BOX_SPACE = free_space(
    with_box(room(4, 3), "table_00", centre_m=(0.2, 0, 0.4), half_m=(0.5, 0.1, 0.4), yaw_rad=0.6)
)


def test_the_grid_agrees_with_the_exact_test_at_cell_centres():
    space = TURNED_BOX_SPACE
    rng = np.random.default_rng(0)
    cells = np.stack([rng.integers(0, n, 300) for n in space.frame.shape], axis=1)
    inside = [cell for cell in cells if np.all(np.abs(space.frame.to_metres(cell)) < (2.0, 1.5))]
    assert [space.is_free(*space.frame.to_metres(cell)) for cell in inside] == [space.free[tuple(c)] for c in inside]


@pytest.mark.parametrize(
    ("bottom_m", "top_m", "free"),
    [(0.0, CLIMB_M, True), (0.0, CLIMB_M + 0.001, False), (0.879, 1.2, False), (0.881, 1.2, True), (0.5, 0.6, False)],
)
def test_only_geoms_between_climbed_height_and_robot_height_block(bottom_m, top_m, free):
    half = 0.5 * (top_m - bottom_m)
    house = with_box(room(), "shelving_00", centre_m=(0, 0, bottom_m + half), half_m=(0.3, 0.3, half))
    assert free_space(house).is_free(0.0, 0.0) == free


def test_collision_geoms_block_and_visual_geoms_do_not():
    glass = with_box(room(), "window_00", centre_m=(0, 0, 0.5), half_m=(0.3, 0.3, 0.5), group=3)
    assert not free_space(glass).is_free(0.0, 0.0)
    spec = with_box(room(), "plant_00", centre_m=(0, 0, 0.5), half_m=(0.3, 0.3, 0.5)).spec
    spec.geom("plant_00").contype = spec.geom("plant_00").conaffinity = 0
    assert free_space(House("leaves", spec)).is_free(0.0, 0.0)


def test_a_movable_object_blocks_at_its_current_position_and_the_robot_never_does():
    world = World(with_movable(room(), "stool_00", xy_m=(1.0, 0.0)))
    world.reset(Pose(-1.0, 0.0, 0.0))
    space = world.free_space()
    assert not space.is_free(1.0, 0.0)
    assert space.is_free(-1.0, 0.0)
    stool = world.model.body("stool_00").id
    joint = world.model.jnt_qposadr[world.model.body_jntadr[stool]]
    world.data.qpos[joint] = -0.2
    mujoco.mj_kinematics(world.model, world.data)
    moved = world.free_space()
    assert moved.is_free(1.0, 0.0)
    assert not moved.is_free(-0.2, 0.0)


def test_the_outside_is_not_free_although_the_floor_continues():
    space = free_space(room(4, 3))
    assert not space.is_free(2.6, 0.0)
    assert not space.is_free(30.0, 0.0)
    x, y = space.frame.axes()
    assert not space.free[:, np.abs(x) > 2.0].any()
    assert not space.free[np.abs(y) > 1.5].any()


def test_a_floor_without_walls_is_free_around_the_origin():
    space = free_space(open_floor())
    assert space.free.all()
    assert space.is_free(5.0, -5.0)


def test_geodesic_bends_around_the_corner_of_a_wall():
    # A wall along x = 0 from y = -2 to 1: the disc's centre passes the wall's end on an arc of its radius.
    house = with_box(room(6, 4), "wall_10", centre_m=(0, -0.5, 1.25), half_m=(0.001, 1.5, 1.25))
    space = free_space(house)
    distance = space.geodesic(point(space, -1.5, 0.0))
    tangent = math.hypot(1.5, 1.0) ** 2 - RADIUS_M**2
    to_end = math.atan2(1.0, 1.5)
    lean = math.asin(RADIUS_M / math.hypot(1.5, 1.0))
    arc = RADIUS_M * 2 * (to_end + lean)
    expected = 2 * math.sqrt(tangent) + arc
    assert space.distance_at(distance, 1.5, 0.0) == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize(("gap_m", "passes"), [(0.30, False), (0.35, False), (0.40, True), (0.80, True)])
def test_a_gap_joins_two_sides_only_when_the_disc_fits(gap_m, passes):
    space = free_space(divided_room(gap_m))
    distance = space.geodesic(point(space, -1.5, 0.0))
    there = space.distance_at(distance, 1.5, 0.0)
    assert math.isfinite(there) == passes
    assert (space.path(distance, 1.5, 0.0) is not None) == passes
    if passes:
        assert there == pytest.approx(3.0, abs=0.03)


@given(x=st.floats(-2.5, 2.5), y=st.floats(-1.6, 1.6))
@settings(max_examples=30)
def test_distance_between_cells_is_interpolated(x, y):
    space = OPEN_SPACE
    assert space.distance_at(OPEN_DISTANCE, x, y) == pytest.approx(math.hypot(x - 0.0125, y - 0.0125), abs=0.015)


OPEN_SPACE = free_space(room(6, 4))
OPEN_DISTANCE = OPEN_SPACE.geodesic(point(OPEN_SPACE, 0.001, 0.001))


def test_a_position_just_inside_an_obstacle_has_a_distance_and_one_deep_inside_does_not():
    space = free_space(with_box(room(6, 4), "bed_00", centre_m=(1.5, 0, 0.3), half_m=(1.0, 1.0, 0.3)))
    distance = space.geodesic(point(space, -1.0, 0.0))
    assert space.distance_at(distance, 0.5 - 0.12, 0.0) == pytest.approx(1.38, abs=0.03)
    assert math.isinf(space.distance_at(distance, 1.5, 0.0))


def test_the_largest_part_is_the_larger_side_of_a_wall():
    space = free_space(with_box(room(6, 4), "wall_10", centre_m=(1, 0, 1.25), half_m=(0.05, 2.0, 1.25)))
    part = space.largest_part()
    x, _ = space.frame.axes()
    assert (part == (space.free & (x < 1.0))).all()


def test_a_storey_has_its_own_obstacles():
    house = with_box(room(4, 4, height_m=2.5), "floor_01", centre_m=(0, 0, 2.95), half_m=(2, 2, 0.05))
    house = with_box(house, "table_00", centre_m=(0, 0, 3.4), half_m=(0.3, 0.3, 0.4))
    house = with_post(house, "column_00", xy_m=(1.0, 0.0), radius_m=0.1, height_m=2.5)
    ground, upper = free_space(house), free_space(house, floor_z_m=3.0)
    assert ground.is_free(0.0, 0.0)
    assert not upper.is_free(0.0, 0.0)
    assert upper.is_free(1.0, 0.0)
    assert not ground.is_free(1.0, 0.0)


def test_the_rule_says_which_rooms_belong_to_a_storey():
    spec = room(4, 4).spec
    spec.site("room_living_00").pos[2] += 0.5  # its floor is then at z = 0.5 m
    model = spec.compile()
    data = data_at_rest(model)
    spaces = [
        FreeSpace(model, data, read_labels(model), rooms=read_rooms(model), rule=SuccessRule(same_storey_m=same_m))
        for same_m in (1.0, 0.4)
    ]
    assert spaces[0].frame.shape == (180, 180)  # 4 m and 0.25 m on either side, in cells of 2.5 cm
    assert spaces[1].frame.shape != (180, 180)  # no room of this storey: the walls bound it


def floor_with_hole() -> House:
    """Returns four floors around a hole of 2 x 2 m in the middle, without walls."""
    house = House("hole", mujoco.MjSpec())
    for number, (x, y, hx, hy) in enumerate(((-2, 0, 1, 3), (2, 0, 1, 3), (0, -2, 1, 1), (0, 2, 1, 1))):
        house = with_box(house, f"floor_{number:02d}", centre_m=(x, y, -0.05), half_m=(hx, hy, 0.05))
    return house


def test_nothing_is_free_over_a_hole_nor_where_the_disc_overhangs_its_edge():
    space = free_space(floor_with_hole())
    x, y = space.frame.axes()
    beyond = np.hypot(np.maximum(np.abs(x) - 1.0, 0.0)[None, :], np.maximum(np.abs(y) - 1.0, 0.0)[:, None])
    assert not (space.free & (beyond < RADIUS_M - 0.03)).any()
    beside = (np.abs(x)[None, :] > 1.0 + RADIUS_M + 0.03) & (np.abs(y)[:, None] < 2.5)
    inside = np.abs(x)[None, :] < 3.0 - 0.5
    assert space.free[beside & inside].all()
    for x_m, free in ((-1.2, True), (-1.15, False), (0.0, False)):
        assert space.is_free(x_m, 0.0) == free


def test_a_seam_between_two_floors_is_not_an_edge():
    house = House("seam", mujoco.MjSpec())
    for number, x in enumerate((-1.01, 1.01)):
        house = with_box(house, f"floor_{number:02d}", centre_m=(x, 0, -0.05), half_m=(1, 1, 0.05))
    space = free_space(house)
    assert space.is_free(-0.1, 0.0)
    assert space.free[tuple(space.frame.to_cells((-0.1, 0.0)))]


def _space_of(world: str) -> FreeSpace:
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{world}</worldbody></mujoco>")
    data = data_at_rest(model)
    return FreeSpace(model, data, read_labels(model))


FLOOR_OF_6_M = '<geom name="floor_00" type="plane" size="3 3 1"/>'
BACK_WALL = '<geom name="wall_00" type="box" size="0.05 1 1" pos="1 0 1"/>'


def test_a_plane_with_a_size_is_free_where_it_is_rendered() -> None:
    space = _space_of(FLOOR_OF_6_M)
    assert space.is_free(2.7, 0.0)
    assert not space.is_free(3.3, 0.0)


def test_a_single_wall_encloses_no_house() -> None:
    space = _space_of(FLOOR_OF_6_M + BACK_WALL)
    assert space.is_free(-2.0, 0.0)
    assert space.is_free(2.0, 0.0)
    assert not space.is_free(1.0, 0.0)


def test_walls_on_four_sides_enclose_a_house_on_a_larger_floor() -> None:
    sides = (("0.05 1.5", "1.5 0"), ("0.05 1.5", "-1.5 0"), ("1.5 0.05", "0 1.5"), ("1.5 0.05", "0 -1.5"))
    walls = "".join(
        f'<geom name="wall_{i:02}" type="box" size="{size} 1" pos="{at} 1"/>' for i, (size, at) in enumerate(sides)
    )
    space = _space_of(FLOOR_OF_6_M + walls)
    assert space.is_free(0.0, 0.0)
    assert not space.is_free(2.5, 0.0)


@pytest.mark.parametrize(("sill_m", "passes"), [(0.012, True), (0.015, False), (0.02, False)])
def test_a_floor_that_wheels_do_not_climb_divides_a_room(sill_m, passes):
    sill = with_box(room(6, 4), "floor_10", centre_m=(0, 0, 0.5 * sill_m), half_m=(0.1, 2.0, 0.5 * sill_m))
    space = free_space(sill)
    there = space.geodesic(point(space, 2.0, 0.0))[tuple(space.frame.to_cells((-2.0, 0.0)))]
    assert math.isfinite(there) == passes


def test_a_raised_floor_from_wall_to_wall_is_free_and_two_of_one_height_have_no_edge():
    plain = free_space(room(6, 4)).free.sum()
    raised = room(6, 4)
    for number, x_m in enumerate((-1.55, 1.55), start=10):
        raised = with_box(raised, f"floor_{number}", centre_m=(x_m, 0, 0.01), half_m=(1.55, 2.1, 0.01))
    space = free_space(raised)
    assert space.free.sum() == pytest.approx(plain, rel=0.01)
    assert math.isfinite(space.geodesic(point(space, 2.0, 0.0))[tuple(space.frame.to_cells((-2.0, 0.0)))])


def test_a_floor_without_an_end_has_no_edge():
    sunken = with_box(room(6, 4), "floor_10", centre_m=(0, 0, -0.03), half_m=(0.5, 0.5, 0.01))  # below the plane
    assert (free_space(sunken).free == free_space(room(6, 4)).free).all()


@pytest.mark.parametrize(("climb_m", "free"), [(0.02, True), (0.019, False)])
def test_the_robot_decides_which_height_is_free(climb_m, free):
    house = with_box(room(6, 4), "objects_00", centre_m=(0, 0, 0.01), half_m=(0.1, 2.0, 0.01))
    assert free_space(house, robot=RobotModel(climb_m=climb_m)).is_free(0.0, 0.0) == free


def test_a_house_may_be_far_from_the_origin():
    def size(x_m: float) -> tuple[int, int]:
        spec = mujoco.MjSpec()
        spec.worldbody.add_geom(name="floor_00", type=mujoco.mjtGeom.mjGEOM_PLANE, size=(0, 0, 1))
        house = House("far", spec)
        for number, (x, y) in enumerate(((2.0, 0.0), (-2.0, 0.0), (0.0, 2.0), (0.0, -2.0))):
            half = (0.05, 2.05, 1.25) if x else (2.05, 0.05, 1.25)
            house = with_box(house, f"wall_{number:02d}", centre_m=(x_m + x, y, 1.25), half_m=half)
        return free_space(house).free.shape

    assert size(150.0) == pytest.approx(size(0.0), abs=1)
