"""Distances and travel times by fast marching: analytic cases, and for travel times scikit-fmm as the reference."""

import itertools
from typing import Literal

import numpy as np
import pytest
import skfmm

from sim.core.geometry.fast_marching import distances, travel_times
from stubborn.mapping.masks import connected, distance_to
from tests.helpers import wording

CELL_M = 0.05


def cluttered(seed: int, rows: int = 70, cols: int = 90):
    """Returns random walls: connected passable cells, speeds that fall along walls, a goal of 3 x 3 cells."""
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


def steps_over_edges(goal: np.ndarray, passable: np.ndarray) -> np.ndarray:
    """Returns the number of steps over cell edges to the nearest goal cell; -1 if there is no path."""
    steps, reached = np.where(goal, 0, -1), goal.copy()
    for number in itertools.count(1):
        grown = reached.copy()
        grown[1:] |= reached[:-1]
        grown[:-1] |= reached[1:]
        grown[:, 1:] |= reached[:, :-1]
        grown[:, :-1] |= reached[:, 1:]
        grown &= passable
        if (grown == reached).all():
            return steps
        steps[grown & ~reached], reached = number, grown
    raise AssertionError


def one_cell(shape: tuple[int, int], row: int, col: int) -> np.ndarray:
    mask = np.zeros(shape, bool)
    mask[row, col] = True
    return mask


@pytest.mark.parametrize("seed", range(3))
def test_distances_differ_between_neighbours_by_no_more_than_a_cell(seed: int):
    goal, passable, _ = cluttered(seed, rows=120, cols=150)
    distance_m = distances(goal, passable, CELL_M)
    for axis in (0, 1):
        gap_m = np.abs(np.diff(np.where(passable, distance_m, np.nan), axis=axis))
        assert np.nanmax(gap_m) <= 1.3 * CELL_M  # the second-order scheme overshoots behind corners


@pytest.mark.parametrize("seed", range(3))
def test_distances_lie_between_the_straight_line_and_a_path_over_cell_edges(seed: int):
    goal, passable, _ = cluttered(seed)
    distance_m = distances(goal, passable, CELL_M)
    straight_m = CELL_M * distance_to(goal)
    steps = steps_over_edges(goal, passable)
    assert (np.isfinite(distance_m) == passable).all()
    assert (distance_m >= straight_m - 0.7 * CELL_M)[passable].all()
    assert (distance_m <= CELL_M * steps + 1e-5)[passable].all()


@pytest.mark.parametrize("seed", range(3))
def test_distances_to_several_sources_are_those_to_the_nearest_one(seed: int):
    """Where the fronts of two sources meet, the second-order scheme sees both of them."""
    _, passable, _ = cluttered(seed)
    rows, cols = np.nonzero(passable)
    ends = [one_cell(passable.shape, rows[index], cols[index]) for index in (0, -1)]
    alone_m = [distances(end, passable, CELL_M)[passable] for end in ends]
    together_m = distances(ends[0] | ends[1], passable, CELL_M)[passable]
    np.testing.assert_allclose(together_m, np.minimum(*alone_m), atol=0.5 * CELL_M)


def test_distances_of_a_turned_grid_are_the_turned_distances():
    goal, passable, _ = cluttered(2)
    distance_m = distances(goal, passable, CELL_M)
    for turn in (np.flipud, np.fliplr, np.transpose):
        np.testing.assert_allclose(distances(turn(goal), turn(passable), CELL_M), turn(distance_m), atol=0.5 * CELL_M)


@pytest.mark.parametrize("order", ["C", "F"])
def test_distances_do_not_depend_on_the_order_in_memory(order: Literal["C", "F"]):
    goal, passable, _ = cluttered(4)
    spread = np.zeros((140, 180), bool, order=order)
    spread[::2, ::2], view = passable, spread[::2, ::2]
    expected_m = distances(goal, passable, CELL_M)
    np.testing.assert_array_equal(distances(np.array(goal, order=order), view, CELL_M), expected_m)


def test_distances_in_the_open_are_straight():
    """The error of the second-order scheme on an empty grid is below 0.4 cells."""
    shape = (121, 161)
    row, col = np.indices(shape)
    straight_m = CELL_M * np.hypot(row - 60, col - 40)
    distance_m = distances(one_cell(shape, 60, 40), np.ones(shape, bool), CELL_M)
    assert np.abs(distance_m - straight_m).max() < 0.4 * CELL_M


def test_distances_are_infinite_where_no_path_leads():
    passable = np.ones((5, 7), bool)
    passable[:, 3] = False
    distance_m = distances(one_cell((5, 7), 2, 1), passable, CELL_M)
    assert np.isfinite(distance_m[:, :3]).all()
    assert np.isinf(distance_m[:, 3:]).all()
    assert (distances(passable, passable, CELL_M)[passable] == 0).all()


@pytest.mark.parametrize("shape", [(5, 7), (1, 1), (1, 7), (0, 5)])
def test_distances_without_a_passable_source_are_infinite(shape: tuple[int, int]):
    everywhere, nowhere = np.ones(shape, bool), np.zeros(shape, bool)
    for sources, passable in ((nowhere, everywhere), (everywhere, nowhere), (nowhere, nowhere)):
        distance_m = distances(sources, passable, CELL_M)
        assert distance_m.shape == shape
        assert distance_m.dtype == np.float32
        assert np.isinf(distance_m).all()


def test_distances_along_a_single_row_are_exact():
    row = np.ones((1, 9), bool)
    expected_m = CELL_M * np.abs(np.arange(9) - 3)
    np.testing.assert_allclose(distances(one_cell((1, 9), 0, 3), row, CELL_M)[0], expected_m, rtol=1e-6)
    np.testing.assert_allclose(distances(one_cell((9, 1), 3, 0), row.T, CELL_M)[:, 0], expected_m, rtol=1e-6)


def test_a_blocked_source_does_not_count_next_to_a_free_one():
    passable = np.ones((5, 9), bool)
    passable[2, 2] = False
    both = one_cell((5, 9), 2, 2) | one_cell((5, 9), 2, 7)
    np.testing.assert_array_equal(
        distances(both, passable, CELL_M), distances(one_cell((5, 9), 2, 7), passable, CELL_M)
    )


@pytest.mark.parametrize("cell_m", [0.0, -0.05])
def test_a_cell_without_a_size_is_refused(cell_m: float):
    with pytest.raises(ValueError, match=wording.GREATER_THAN_ZERO):
        distances(np.ones((2, 2), bool), np.ones((2, 2), bool), cell_m)


@pytest.mark.parametrize("seed", range(3))
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


@pytest.mark.parametrize("seed", range(3))
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
