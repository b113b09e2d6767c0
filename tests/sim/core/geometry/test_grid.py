import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.core.geometry.grid import GridFrame, cells_near_segment
from sim.core.geometry.pose import Pose
from sim.core.interface import ConfigError

FRAME = GridFrame(origin_xy_m=(-1.5, 2.0), shape=(40, 70), cell_m=0.05)


@given(row=st.integers(0, 39), col=st.integers(0, 69))
def test_cell_to_world_and_back_is_identity(row: int, col: int):
    x_m, y_m = FRAME.centres(row, col)
    assert FRAME.cell(float(x_m), float(y_m)) == (row, col)
    rows, cols = FRAME.cells(x_m, y_m)
    assert (int(rows), int(cols)) == (row, col)


@given(x=st.floats(-1.49, 1.99), y=st.floats(2.01, 3.99))
def test_a_point_is_within_half_a_cell_of_its_cells_centre(x: float, y: float):
    centre_x, centre_y = FRAME.centres(*FRAME.cell(x, y))
    assert abs(centre_x - x) <= 0.025 + 1e-9
    assert abs(centre_y - y) <= 0.025 + 1e-9


def test_rows_are_y_and_columns_are_x():
    assert FRAME.cell(-1.5 + 0.06, 2.0 + 0.11) == (2, 1)


def test_the_start_is_the_centre_of_the_middle_cell():
    frame = GridFrame.around_start(1440, 0.05)
    assert frame.cell(0.0, 0.0) == (720, 720)
    np.testing.assert_allclose(frame.centres(720, 720), (0.0, 0.0), atol=1e-9)


@given(row=st.integers(0, 39), col=st.integers(0, 69), size=st.integers(1, 100), off=st.floats(-0.02, 0.02))
def test_a_cell_of_a_window_is_the_same_place_in_the_whole_map(row: int, col: int, size: int, off: float):
    x, y = (float(c) + off for c in FRAME.centres(row, col))
    window = FRAME.window_at(x, y, size)
    part_row, part_col = window.frame.cell(x, y)
    assert (part_row + window.rows.start, part_col + window.cols.start) == (row, col)
    assert window.frame.shape == (min(size, 40), min(size, 70))
    assert np.zeros(FRAME.shape)[window.index].shape == window.frame.shape


def test_a_window_has_its_point_in_the_middle_where_there_is_room():
    window = FRAME.window_at(0.01, 3.01, 20)
    assert window.frame.cell(0.01, 3.01) == (10, 10)


def test_the_cells_near_a_segment_are_those_of_float64_arithmetic():
    frame, rng = GridFrame.around_start(80, 0.05), np.random.default_rng(0)
    for number in range(200):
        x0, y0, x1, y1 = rng.uniform(-2.2, 2.2, 4).tolist()
        x1, y1 = (x0, y0) if number % 4 == 0 else (x1, y1)
        radius_m = 0.05 * math.ceil(rng.uniform(0.0, 8.0))
        patch = frame.patch((x0, x1), (y0, y1), radius_m)
        x_m, y_m = patch.frame.mesh()
        dx, dy = x1 - x0, y1 - y0
        length_sq = dx * dx + dy * dy
        along = np.clip(((x_m - x0) * dx + (y_m - y0) * dy) / length_sq, 0.0, 1.0) if length_sq > 0 else 0.0
        gap_sq = (x_m - x0 - along * dx) ** 2 + (y_m - y0 - along * dy) ** 2
        index, inside = cells_near_segment(frame, (x0, y0), (x1, y1), radius_m)
        assert index == patch.index
        assert np.array_equal(inside, gap_sq <= radius_m * radius_m)


def test_ahead_goes_along_the_heading():
    np.testing.assert_allclose(Pose(1.0, 2.0, math.pi / 2).ahead(0.5), (1.0, 2.5))


def test_a_grid_without_size_is_refused_with_the_given_value():
    with pytest.raises(ConfigError, match=r"cell_m must be > 0 m, got 0"):
        GridFrame(origin_xy_m=(0.0, 0.0), shape=(2, 2), cell_m=0)
    with pytest.raises(ConfigError, match="0 x 2"):
        GridFrame(origin_xy_m=(0.0, 0.0), shape=(0, 2), cell_m=0.05)
