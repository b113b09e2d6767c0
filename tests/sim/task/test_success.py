"""Places where a STOP succeeds, in rooms of a few boxes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.core.geometry.convex import lines_blocked
from sim.core.interface import CameraModel, SuccessRule
from sim.gl import mujoco
from sim.houses.geoms import data_at_rest
from sim.houses.house import House, read_rooms
from sim.houses.labels import read_labels
from sim.task.ground_truth import GroundTruth
from sim.task.success import GoalRegion, Surroundings, sight_blockers
from sim.world.freespace import FreeSpace
from sim.world.world import World
from tests.helpers.worlds import room, two_storeys, with_box


def compiled(house: House):
    model = house.spec.copy().compile()
    data = data_at_rest(model)
    return model, data, read_labels(model)


CAMERA = CameraModel()


def region(house: House, goal: str, *, floor_z_m: float = 0.0, camera=CAMERA, **rule) -> GoalRegion:
    return region_in(*compiled(house), goal, floor_z_m=floor_z_m, camera=camera, **rule)


def region_in(model, data, labels, goal: str, *, floor_z_m: float = 0.0, camera=CAMERA, **rule) -> GoalRegion:
    success = SuccessRule(**rule)
    sight_height_m = success.sight_height_with(camera)
    around = Surroundings.of(model, data, labels, sight_height_m=sight_height_m, floor_z_m=floor_z_m)
    return GoalRegion(data, labels.of_category(goal), goal, surroundings=around, success=success, floor_z_m=floor_z_m)


def two_rooms(wall: str = "wall_10", *, low_m: float = 0.0, high_m: float = 2.5, group: int = 0) -> House:
    """Returns a room of 6 x 4 m with a wall at x = 0 from `low_m` to `high_m` and a bed at its right side."""
    half = 0.5 * (high_m - low_m)
    house = with_box(room(6, 4), wall, centre_m=(0, 0, low_m + half), half_m=(0.05, 2.0, half), group=group)
    return with_box(house, "bed_00", centre_m=(0.55, 0, 0.25), half_m=(0.5, 0.5, 0.25))


@given(angle=st.floats(0, 6.28), excess=st.sampled_from([-0.002, 0.002]))
@settings(max_examples=30)
def test_a_stop_succeeds_up_to_one_metre_from_the_footprint(angle, excess):
    c, s = np.cos(angle), np.sin(angle)
    corner = np.array([np.copysign(0.3, c), np.copysign(0.2, s)])
    x, y = corner + (1.0 + excess) * np.array([c, s])
    assert TABLE_REGION.succeeds(float(x), float(y)) == (excess < 0)


TABLE_REGION = region(with_box(room(6, 6), "table_00", centre_m=(0, 0, 0.4), half_m=(0.3, 0.2, 0.4)), "table")


def test_a_robot_under_a_table_has_found_it_though_its_edge_is_far():
    house = with_box(room(8, 8), "table_00", centre_m=(0, 0, 1.2), half_m=(2.5, 2.5, 0.02))
    assert region(house, "table").succeeds(0.1, 0.0)


@pytest.mark.parametrize(
    ("wall", "hides"),
    [
        ({"wall": "wall_10"}, True), ({"wall": "door_00"}, True), ({"wall": "window_00"}, True),
        ({"wall": "cabinet_10"}, False), ({"wall": "curtain_00"}, False), ({"wall": "mirror_00"}, False),
        ({"high_m": 0.87}, False), ({"high_m": 0.89}, True), ({"low_m": 0.9}, False), ({"group": 3}, False),
    ],
)  # fmt: skip
def test_rendered_walls_doors_and_windows_at_the_height_of_the_camera_hide_a_goal(wall, hides):
    reached = region(two_rooms(**wall), "bed")
    assert reached.succeeds(1.5, 0.0)
    assert reached.succeeds(-0.4, 0.0) != hides


def test_a_wall_of_two_pieces_has_no_slit_where_they_meet():
    house = room(6, 4)
    for number, y in ((10, 1.0), (11, -1.0)):
        house = with_box(house, f"wall_{number}", centre_m=(0, y, 1.25), half_m=(0.05, 1.0, 1.25))
    house = with_box(house, "bed_00", centre_m=(0.55, 0, 0.25), half_m=(0.5, 0.5, 0.25))
    assert not region(house, "bed").succeeds(-0.4, 0.0)


def test_a_picture_on_a_wall_is_found_from_its_own_room_only():
    house = with_box(two_rooms(), "picture_00", centre_m=(0.06, 1.2, 1.5), half_m=(0.01, 0.3, 0.2))
    reached = region(house, "picture")
    assert reached.succeeds(0.9, 1.2)
    assert reached.succeeds(0.3, 0.5)
    assert not reached.succeeds(-0.3, 1.2)
    assert not reached.succeeds(1.2, 1.2)


def test_a_picture_sunk_into_the_wall_is_found_by_its_visible_part():
    house = with_box(two_rooms(), "picture_00", centre_m=(0.05, 1.2, 1.5), half_m=(0.02, 0.3, 0.2))
    reached = region(house, "picture")
    assert reached.succeeds(0.9, 1.2)
    assert not reached.succeeds(-0.3, 1.2)


def test_a_shower_in_a_corner_is_found_though_two_of_its_sides_lie_in_walls():
    house = with_box(room(4, 4), "shower_00", centre_m=(1.6, 1.6, 1.0), half_m=(0.45, 0.45, 1.0))
    reached = region(house, "shower")
    assert reached.succeeds(0.5, 1.5)
    assert not reached.succeeds(0.0, 1.5)
    assert not reached.succeeds(2.3, 1.6)


def test_a_goal_seen_round_the_end_of_a_wall_counts_at_the_distance_of_its_visible_part():
    # The wall ends at y = 0; from (-0.3, -0.25) the near side of the bed is hidden, its far part is not.
    house = with_box(room(6, 6), "wall_10", centre_m=(0, -1.5, 1.25), half_m=(0.05, 1.5, 1.25))
    house = with_box(house, "bed_00", centre_m=(0.55, 0.0, 0.25), half_m=(0.5, 0.5, 0.25))
    reached = region(house, "bed")
    assert reached.succeeds(-0.3, -0.25)
    assert not reached.succeeds(-0.3, -1.2)


def test_the_boundary_alone_gives_the_result_of_all_points_of_the_footprint():
    house = two_rooms()
    house = with_box(house, "wall_11", centre_m=(1.4, 0.6, 1.25), half_m=(0.05, 0.5, 1.25), yaw_rad=0.4)
    house = with_box(house, "bed_01", centre_m=(1.7, -0.9, 0.2), half_m=(0.5, 0.2, 0.2), yaw_rad=0.7)
    model, data, labels = compiled(house)
    reached = region_in(model, data, labels, "bed")
    grid = np.stack(np.meshgrid(np.arange(-1, 3, 0.02), np.arange(-2, 2, 0.02)), axis=-1).reshape(-1, 2)
    points = np.concatenate([fp.boundary_m.data for fp in reached.footprints])
    inside = grid[np.any([fp.contains(grid) for fp in reached.footprints], axis=0)]
    points = np.concatenate([points, inside])
    blockers = sight_blockers(model, data, labels, 0.88)
    rng = np.random.default_rng(0)
    places = rng.uniform((-1.5, -1.9), (2.9, 1.9), (150, 2))
    for place in places:
        near = points[np.hypot(*(points - place).T) <= 1.0]
        expected = bool((~lines_blocked(np.broadcast_to(place, near.shape), near, blockers)).any())
        assert reached.succeeds(*place) == expected, place


def test_the_mask_has_for_each_free_cell_the_result_of_the_test_at_its_centre():
    house = two_rooms()
    model, data, labels = compiled(house)
    space = FreeSpace(model, data, labels, rooms=read_rooms(model))
    reached = region_in(model, data, labels, "bed")
    mask = reached.mask(space)
    assert not (mask & ~space.free).any()
    assert mask.any()
    cells = np.argwhere(space.free)[::97]
    assert [reached.succeeds(*space.frame.to_metres(cell)) for cell in cells] == [bool(mask[tuple(c)]) for c in cells]


def test_an_instance_on_another_storey_does_not_count():
    house = with_box(room(6, 4), "floor_01", centre_m=(0, 0, 2.95), half_m=(3, 2, 0.05))
    house = with_box(house, "sofa_00", centre_m=(1, 0, 3.3), half_m=(0.4, 0.4, 0.3))
    assert not region(house, "sofa").succeeds(1.0, 1.0)
    assert region(house, "sofa", floor_z_m=3.0).succeeds(1.0, 1.0)
    assert region(house, "sofa", floor_z_m=2.1).succeeds(1.0, 1.0)


def test_geoms_that_are_not_rendered_are_no_part_of_the_footprint():
    spec = with_box(room(8, 4), "sofa_00", centre_m=(0, 0, 0.3), half_m=(0.3, 0.3, 0.3)).spec
    spec.worldbody.add_geom(name="hull", type=mujoco.mjtGeom.mjGEOM_BOX, size=(2, 0.3, 0.3), pos=(0, 0, 0.3), group=3)
    assert not region(House("hull", spec), "sofa").succeeds(1.9, 0.0)


def test_the_footprint_of_a_ring_is_not_its_middle():
    # A square frame of four boxes as one concave mesh would project its hull; its triangles leave the middle out.
    spec = room(12, 12).spec
    corners = [(x, y, z) for r in (3.0, 2.8) for x, y in ((r, r), (-r, r), (-r, -r), (r, -r)) for z in (0.3, 0.5)]
    outer, inner = range(0, 8), range(8, 16)
    faces = []
    for i in range(4):
        a, b = 2 * i, 2 * ((i + 1) % 4)
        for ring, flip in ((outer, False), (inner, True)):
            q = [ring[a], ring[b], ring[b + 1], ring[a + 1]]
            faces += _quad(q[::-1] if flip else q)
        faces += _quad([outer[a + 1], outer[b + 1], inner[b + 1], inner[a + 1]])
        faces += _quad([outer[b], outer[a], inner[a], inner[b]])
    spec.add_mesh(name="ring", uservert=np.ravel(corners).tolist(), userface=np.ravel(faces).tolist())
    spec.worldbody.add_geom(
        name="seating_00", type=mujoco.mjtGeom.mjGEOM_MESH, meshname="ring", contype=0, conaffinity=0
    )
    reached = region(House("ring", spec), "seating")
    assert not reached.succeeds(0.0, 0.0)
    assert reached.succeeds(0.0, 1.9)
    assert reached.succeeds(0.0, 2.9)
    assert not reached.succeeds(0.0, 4.1)


def _show_mesh(spec: mujoco.MjSpec, name: str, mesh: str) -> None:
    spec.worldbody.add_geom(name=name, type=mujoco.mjtGeom.mjGEOM_MESH, meshname=mesh, contype=0, conaffinity=0)


def _quad(q: list[int]) -> list[tuple[int, int, int]]:
    return [(q[0], q[1], q[2]), (q[0], q[2], q[3])]


def test_a_wall_that_is_a_mesh_hides_where_it_is_and_not_where_its_doorway_is():
    spec = room(6, 4).spec
    vertices, faces = [], []
    for y0, y1, z0 in ((-2.0, -0.5, 0.0), (0.5, 2.0, 0.0), (-0.5, 0.5, 2.0)):  # left, right, lintel
        base = len(vertices)
        vertices += [(x, y, z) for x in (-0.05, 0.05) for y in (y0, y1) for z in (z0, 2.5)]
        for q in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)):
            faces += _quad([base + i for i in q])
    spec.add_mesh(name="wall", uservert=np.ravel(vertices).tolist(), userface=np.ravel(faces).tolist())
    _show_mesh(spec, "wall_10", "wall")
    house = House("mesh_wall", spec)
    for number, y in ((0, 0.0), (1, 1.4)):
        house = with_box(house, f"stool_{number:02d}", centre_m=(0.5, y, 0.2), half_m=(0.1, 0.1, 0.2))
    reached = region(house, "stool")
    assert reached.succeeds(-0.4, 0.0)
    assert not reached.succeeds(-0.4, 1.4)


@pytest.mark.parametrize("turned", [False, True])
def test_a_picture_that_is_a_flat_mesh_is_found_from_in_front(turned):
    spec = room(6, 4).spec
    points = [(0.0, y, z) for y in np.linspace(-0.3, 0.3, 40) for z in (1.2, 1.4, 1.6)]
    if turned:
        points = [(y + 2.5, 0.3 * y + 0.5, z) for _, y, z in points]
    faces = [face for i in range(39) for face in _quad([3 * i, 3 * i + 3, 3 * i + 5, 3 * i + 2])]
    spec.add_mesh(
        name="flat", uservert=np.ravel(points).tolist(), userface=np.ravel(faces).tolist(),
        inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
    )  # fmt: skip
    _show_mesh(spec, "picture_00", "flat")
    reached = region(House("flat_picture", spec), "picture")
    x, y = (2.5, 0.5) if turned else (0.0, 0.0)
    assert reached.succeeds(x - 0.9, y)
    assert not reached.succeeds(x - 1.4, y)
    assert reached.nearest_m(x - 0.5, y) == pytest.approx(0.219 if turned else 0.5, abs=0.01)


def test_an_object_of_upright_triangles_alone_is_found_at_its_rim():
    spec, angles = room(6, 4).spec, np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    points = [(0.3 * np.cos(a), 0.3 * np.sin(a), z) for z in (0.0, 0.5) for a in angles]
    faces = [face for i in range(24) for face in _quad([i, (i + 1) % 24, 24 + (i + 1) % 24, 24 + i])]
    spec.add_mesh(
        name="tube", uservert=np.ravel(points).tolist(), userface=np.ravel(faces).tolist(),
        inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
    )  # fmt: skip
    _show_mesh(spec, "stool_00", "tube")
    reached = region(House("tube", spec), "stool")
    assert reached.succeeds(-1.2, 0.0)
    assert not reached.succeeds(-1.4, 0.0)
    assert reached.nearest_m(-1.3, 0.0) == pytest.approx(1.0, abs=0.01)


def test_a_taller_camera_sees_over_a_wall_that_blocks_the_default_one():
    low_wall = two_rooms(high_m=1.2)
    assert not region(low_wall, "bed").succeeds(-0.4, 0.0)
    assert region(low_wall, "bed", camera=CameraModel(height_m=1.3)).succeeds(-0.4, 0.0)
    assert region(low_wall, "bed", sight_height_m=1.3).succeeds(-0.4, 0.0)


def test_the_rule_says_which_floors_are_one_storey():
    house = with_box(room(6, 4), "sofa_00", centre_m=(1, 0, 0.3), half_m=(0.4, 0.4, 0.3))
    assert region(house, "sofa", floor_z_m=0.8).footprints
    assert not region(house, "sofa", floor_z_m=0.8, same_storey_m=0.5).footprints


@pytest.mark.parametrize(
    ("place", "goal", "category"),
    [
        ((1.0, 0.0), "bed", "table"),
        ((1.75, 0.0), "sofa", "table"),  # nearer than the bed
        ((2.97, 0.0), "sofa", "bed"),  # the wall, which is nearer, counts only without an object
        ((1.0, 0.5), "bed", "table"),
        ((1.25, 0.0), "bed", "plant"),  # on the table: the smaller of two outlines
        ((1.25, 0.0), "table", "table"),  # the goal counts first
        ((-2.9, 1.0), "bed", "wall"),
        ((-1.0, 1.0), "bed", None),
        ((0.0, 0.0), "bed", None),  # the lamp hangs from the storey above
    ],
)
def test_a_place_has_the_category_of_the_nearest_object(place, goal, category):
    house = with_box(two_storeys(), "table_00", centre_m=(1.2, 0, 0.4), half_m=(0.5, 0.3, 0.4))
    house = with_box(house, "plant_00", centre_m=(1.3, 0, 0.9), half_m=(0.1, 0.1, 0.1))
    house = with_box(house, "lighting_00", centre_m=(0, 0, 4.0), half_m=(0.1, 0.1, 0.1))
    x_m, y_m = place
    assert GroundTruth(World(house)).category_at(x_m, y_m, 0.0, goal=goal, within_m=0.3) == category
