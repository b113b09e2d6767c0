"""Distances and travel times by fast marching: analytic cases, and scikit-fmm as the reference."""

import numpy as np
import pytest
import skfmm

from sim.geometry.fast_marching import distances, travel_times
from stubborn.mapping.masks import connected, distance_to

CELL_M = 0.05


def cluttered(seed: int, rows: int = 70, cols: int = 90):
    """Random walls: passable cells connected to one of them, speeds that fall along walls, a goal of 3 x 3 cells."""
    rng = np.random.default_rng(seed)
    solid = np.zeros((rows, cols), bool)
    for _ in range(14):
        row, col = rng.integers(0, rows - 20), rng.integers(0, cols - 20)
        solid[row : row + rng.integers(1, 20), col : col + rng.integers(1, 4)] = True
        solid[col % rows : col % rows + 2, row : row + rng.integers(1, 20)] = True
    clearance_m = distance_to(solid) * np.float32(CELL_M)
    row, col = np.unravel_index(int(np.argmax(clearance_m)), solid.shape)
    passable = connected(~solid, int(row), int(col), connectivity=4)
    goal = np.zeros_like(solid)
    goal[max(row - 1, 0) : row + 2, max(col - 1, 0) : col + 2] = True
    return goal & passable, passable, np.clip(0.35 + clearance_m / 0.3, 0.35, 1.0).astype(np.float32)


def reference(sources: np.ndarray, passable: np.ndarray, cell_m: float) -> np.ndarray:
    """Second-order distances by scikit-fmm; infinite where there is no path."""
    front = np.ma.MaskedArray(np.where(sources & passable, 0.0, 1.0), mask=~passable)
    return np.where(passable, np.ma.filled(skfmm.distance(front, dx=cell_m), np.inf), np.inf).astype(np.float32)


def one_cell(shape: tuple[int, int], row: int, col: int) -> np.ndarray:
    mask = np.zeros(shape, bool)
    mask[row, col] = True
    return mask


@pytest.mark.parametrize("share", [0.0, 0.1, 0.3, 0.4])
def test_distances_are_those_of_scikit_fmm_to_the_last_bit(share: float):
    rng = np.random.default_rng(int(100 * share))
    for _ in range(40):
        shape = tuple(rng.integers(1, 50, 2).tolist())
        passable = rng.random(shape) >= share
        sources = (rng.random(shape) < rng.choice([0.002, 0.02, 0.2])) & passable
        sources[tuple(rng.integers(0, shape))] = True
        if (sources & passable).any():
            np.testing.assert_array_equal(distances(sources, passable, CELL_M), reference(sources, passable, CELL_M))


@pytest.mark.parametrize("seed", range(6))
def test_distances_among_walls_are_those_of_scikit_fmm(seed: int):
    goal, passable, _ = cluttered(seed, rows=240, cols=240)
    np.testing.assert_array_equal(distances(goal, passable, 0.025), reference(goal, passable, 0.025))


def test_distances_in_the_open_are_straight():
    """The error of the second-order scheme on an empty grid is below 0.4 cells."""
    shape = (121, 161)
    row, col = np.indices(shape)
    straight_m = CELL_M * np.hypot(row - 60, col - 40)
    distance_m = distances(one_cell(shape, 60, 40), np.ones(shape, bool), CELL_M)
    assert np.abs(distance_m - straight_m).max() < 0.4 * CELL_M


def test_a_distance_around_a_wall_leads_past_its_end():
    passable = np.ones((101, 101), bool)
    passable[:81, 50] = False
    distance_m = distances(one_cell(passable.shape, 20, 20), passable, CELL_M)
    around_m = 2 * CELL_M * np.hypot(81 - 20, 50 - 20)
    assert distance_m[20, 80] == pytest.approx(around_m, rel=0.01)
    assert np.isinf(distance_m[:81, 50]).all()


def test_distances_are_infinite_where_no_path_leads():
    passable = np.ones((5, 7), bool)
    passable[:, 3] = False
    distance_m = distances(one_cell((5, 7), 2, 1), passable, CELL_M)
    assert np.isfinite(distance_m[:, :3]).all()
    assert np.isinf(distance_m[:, 3:]).all()
    assert np.isinf(distances(~passable, passable, CELL_M)).all()
    assert (distances(passable, passable, CELL_M)[passable] == 0).all()


@pytest.mark.parametrize("seed", range(6))
def test_times_are_those_of_scikit_fmm_started_half_a_cell_later(seed: int):
    """scikit-fmm starts at the goal's edge, half a cell before the centre of the first cell outside."""
    goal, passable, speed = cluttered(seed)
    speed[distance_to(goal) < 3] = 1.0
    front = np.ma.MaskedArray(np.where(goal, -1.0, 1.0), mask=~passable)
    expected = np.ma.filled(skfmm.travel_time(front, speed, dx=CELL_M, order=1), np.inf)
    time = travel_times(goal, passable, speed, CELL_M)
    np.testing.assert_array_equal(np.isfinite(time), np.isfinite(expected))
    outside = passable & ~goal
    assert (time[goal] == 0).all()
    np.testing.assert_allclose(time[outside], expected[outside] + 0.5 * CELL_M, atol=2e-5)


def test_times_in_the_open_are_those_of_straight_lines():
    """The error of the first-order scheme is below a cell and a half on this grid, and 0 along the axes."""
    shape = (61, 81)
    row, col = np.indices(shape)
    straight_m = CELL_M * np.hypot(row - 30, col - 20)
    time = travel_times(one_cell(shape, 30, 20), np.ones(shape, bool), np.full(shape, 0.5), CELL_M)
    assert np.abs(time - 2.0 * straight_m).max() < 2.0 * 1.5 * CELL_M
    np.testing.assert_allclose(time[30], 2.0 * straight_m[30], rtol=1e-6)


@pytest.mark.parametrize("seed", range(6))
def test_times_computed_before_an_early_end_are_right(seed: int):
    goal, passable, speed = cluttered(seed)
    whole = travel_times(goal, passable, speed, CELL_M)
    finite = np.where(np.isfinite(whole), whole, -1.0)
    middle = np.unravel_index(int(np.argmin(np.abs(finite - 0.5 * finite.max()))), goal.shape)
    half = int(middle[0]), int(middle[1])
    part = travel_times(goal, passable, speed, CELL_M, until=half, beyond_m=0.2)
    known = whole <= whole[half] + 0.2
    np.testing.assert_array_equal(part[known], whole[known])
    assert np.isinf(part[~known]).all()


def test_no_time_is_known_beyond_the_limit():
    goal, passable, speed = cluttered(0)
    whole = travel_times(goal, passable, speed, CELL_M)
    part = travel_times(goal, passable, speed, CELL_M, limit_m=1.0123)
    np.testing.assert_array_equal(part, np.where(whole <= 1.0123, whole, np.inf))


def test_goals_on_impassable_cells_do_not_count():
    row = np.array([[True, True, False, False, True]])
    assert np.isinf(travel_times(~row, row, np.ones((1, 5)), CELL_M)).all()


def test_arguments_are_not_changed():
    goal, passable, speed = cluttered(1)
    copies = goal.copy(), passable.copy(), speed.copy()
    travel_times(goal, passable, speed, CELL_M, until=(0, 0))
    distances(goal, passable, CELL_M)
    for given, before in zip((goal, passable, speed), copies, strict=True):
        np.testing.assert_array_equal(given, before)
