"""Plan projections of MuJoCo's shapes against values computed by hand, and lines that cross them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.core.geometry.convex import ConvexPolygon, lines_blocked, polygon_from_above
from sim.gl import mujoco
from sim.houses.geoms import CURVE_TOLERANCE_M, data_at_rest, geom_polytope, mesh_triangles


def world(geoms: str, assets: str = ""):
    model = mujoco.MjModel.from_xml_string(
        f"<mujoco><compiler angle='degree'/><asset>{assets}</asset><worldbody>{geoms}</worldbody></mujoco>"
    )
    data = data_at_rest(model)
    return model, data


def projection(geom: str, low=-math.inf, high=math.inf, assets="") -> ConvexPolygon | None:
    model, data = world(geom, assets)
    return polygon_from_above(geom_polytope(model, data, 0), low, high)


def rectangle(x0: float, y0: float, x1: float, y1: float) -> ConvexPolygon:
    polygon = ConvexPolygon.around(np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]], dtype=float))
    assert polygon is not None
    return polygon


def test_a_leaning_box_covers_only_what_lies_between_the_heights():
    # A 2 m rod leaning 45 degrees in xz: at height z its axis is at x = z; thickness 0.1 m gives +- 0.05 sqrt 2.
    rod = '<geom type="box" size="1 .05 .05" euler="0 -45 0"/>'
    polygon = projection(rod, 0.1, 0.4)
    assert polygon is not None
    r = 0.05 * math.sqrt(2.0)
    np.testing.assert_allclose(polygon.bounds_m, (0.1 - r, -0.05, 0.4 + r, 0.05), atol=1e-6)


@pytest.mark.parametrize(
    ("shape", "radius"),
    [
        ('<geom type="cylinder" size=".3 .5"/>', 0.3),
        ('<geom type="sphere" size=".5"/>', 0.5),
        ('<geom type="capsule" size=".2 .5"/>', 0.2),
        ('<geom type="ellipsoid" size=".4 .4 .1"/>', 0.4),
    ],
)
def test_round_shapes_are_circumscribed_within_the_tolerance(shape, radius):
    polygon = projection(shape)
    assert polygon is not None
    assert polygon.offsets_m.min() >= radius - 1e-6
    assert np.linalg.norm(polygon.vertices_m, axis=1).max() <= radius + 2.0 * CURVE_TOLERANCE_M
    assert polygon.offsets_m.max() <= radius + CURVE_TOLERANCE_M


def test_a_sphere_cut_above_its_middle_covers_the_disc_of_the_cut():
    polygon = projection('<geom type="sphere" size=".5" pos="0 0 1"/>', low=0.0, high=0.7)
    assert polygon is not None
    expected = math.sqrt(0.5**2 - 0.3**2)
    assert np.abs(np.linalg.norm(polygon.vertices_m, axis=1) - expected).max() < 2.0 * CURVE_TOLERANCE_M


def test_a_lying_capsule_covers_a_stadium():
    polygon = projection('<geom type="capsule" fromto="0 0 .5 1 0 .5" size=".1"/>')
    assert polygon is not None
    np.testing.assert_allclose(polygon.bounds_m, (-0.1, -0.1, 1.1, 0.1), atol=CURVE_TOLERANCE_M)
    assert polygon.distance(np.array([[1.0 + 0.3, 0.4]]))[0] == pytest.approx(0.4, abs=2 * CURVE_TOLERANCE_M)


def test_a_mesh_covers_its_hull_and_its_triangles_stand_where_it_stands():
    wedge = "<mesh name='w' vertex='0 0 0  1 0 0  0 1 0  0 0 1' />"
    geom = '<body pos="3 1 0" euler="0 0 90"><geom type="mesh" mesh="w"/></body>'
    model, data = world(geom, wedge)
    polygon = polygon_from_above(geom_polytope(model, data, 0))
    assert polygon is not None
    np.testing.assert_allclose(polygon.bounds_m, (2.0, 1.0, 3.0, 2.0), atol=1e-6)
    triangles = mesh_triangles(model, data, 0)
    assert triangles.shape == (4, 3, 3)
    np.testing.assert_allclose(triangles.reshape(-1, 3).min(axis=0), (2.0, 1.0, 0.0), atol=1e-6)


def test_a_plane_blocks_everything_below_itself_and_nothing_above():
    floor = '<geom type="plane" size="0 0 1"/>'
    assert projection(floor, 0.03, 0.88) is None
    below = projection(floor, -0.5, -0.1)
    assert below is not None
    assert below.contains(np.array([[40.0, -40.0]])).all()


def test_a_shape_outside_the_height_band_projects_to_nothing():
    table_top = '<geom type="box" size="1 1 .02" pos="0 0 .92"/>'
    assert projection(table_top, 0.03, 0.88) is None
    assert projection(table_top, 0.03, 0.91) is not None


def test_a_section_of_no_thickness_is_the_cross_section():
    polygon = projection('<geom type="box" size="1 .05 1" pos="0 0 1"/>', 0.88, 0.88)
    assert polygon is not None
    np.testing.assert_allclose(polygon.bounds_m, (-1.0, -0.05, 1.0, 0.05), atol=1e-6)


@given(angle=st.floats(0.0, math.tau), x=st.floats(-2, 2), y=st.floats(-2, 2))
@settings(max_examples=60)
def test_distance_to_a_turned_rectangle_is_the_analytic_one(angle, x, y):
    c, s = math.cos(angle), math.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    corners = np.array([[-0.6, -0.2], [0.6, -0.2], [0.6, 0.2], [-0.6, 0.2]]) @ turn.T
    polygon = ConvexPolygon.around(corners)
    assert polygon is not None
    expected = math.hypot(max(abs(x) - 0.6, 0.0), max(abs(y) - 0.2, 0.0))
    point = turn @ np.array([x, y])
    assert polygon.distance(point[None])[0] == pytest.approx(expected, abs=1e-6)


def test_a_line_is_blocked_by_a_wall_between_and_not_by_one_next_to_it_or_behind():
    wall = [rectangle(1.0, -1.0, 1.1, 1.0)]
    start = np.zeros((4, 2))
    end = np.array([[2.0, 0.0], [0.9, 0.0], [1.0, 3.0], [-2.0, 0.0]])
    assert lines_blocked(start, end, wall).tolist() == [True, False, False, False]


def test_a_line_that_ends_on_the_surface_is_free_and_one_that_ends_inside_is_not():
    wall = [rectangle(1.0, -1.0, 1.1, 1.0)]
    end = np.array([[1.0, 0.3], [1.05, 0.3], [1.1, 0.3]])
    assert lines_blocked(np.zeros((3, 2)), end, wall).tolist() == [False, True, True]


def test_a_line_along_the_joint_of_two_walls_does_not_slip_through():
    walls = [rectangle(1.0, -1.0, 1.1, 0.0), rectangle(1.0, 0.0, 1.1, 1.0)]
    assert lines_blocked(np.array([[0.0, 0.0]]), np.array([[2.0, 0.0]]), walls).all()


def test_a_line_all_but_parallel_to_a_side_is_blocked_like_a_parallel_one():
    wall = [rectangle(2.0, -2.1, 2.1, 2.1)]
    for slant in (0.0, 1e-17, 2e-16, 1e-13, 1e-9):
        start, end = np.array([[2.3, 1.6]]), np.array([[2.05, 1.6 + slant]])
        assert lines_blocked(start, end, wall).all()
