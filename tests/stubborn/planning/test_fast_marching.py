"""Laws of the agent's march, against scikit-fmm's."""

import numpy as np
import pytest
import skfmm

from stubborn.planning.fast_marching import march
from stubborn.raster import connected, distance_to

CELL_M = 0.05


def cluttered(seed: int, rows: int = 70, cols: int = 90):
    """Random walls: passable cells connected to one of them, speeds that fall along walls, and a goal of 3 x 3."""
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


@pytest.mark.parametrize("seed", range(6))
def test_times_are_those_of_fast_marching_begun_half_a_cell_later(seed: int):
    """scikit-fmm begins at the goal's edge, half a cell before the centre of the first cell outside."""
    goal, passable, speed = cluttered(seed)
    speed[distance_to(goal) < 3] = 1.0
    front = np.ma.MaskedArray(np.where(goal, -1.0, 1.0), mask=~passable)
    expected = np.ma.filled(skfmm.travel_time(front, speed, dx=CELL_M, order=1), np.inf)
    time = march(goal, passable, speed, CELL_M)
    np.testing.assert_array_equal(np.isfinite(time), np.isfinite(expected))
    outside = passable & ~goal
    assert (time[goal] == 0).all()
    np.testing.assert_allclose(time[outside], expected[outside] + 0.5 * CELL_M, atol=2e-5)


@pytest.mark.parametrize("seed", range(6))
def test_what_a_march_that_stops_early_knows_is_right(seed: int):
    goal, passable, speed = cluttered(seed)
    whole = march(goal, passable, speed, CELL_M)
    far = np.where(np.isfinite(whole), whole, -1.0)
    middle = np.unravel_index(int(np.argmin(np.abs(far - 0.5 * far.max()))), goal.shape)
    half = int(middle[0]), int(middle[1])
    part = march(goal, passable, speed, CELL_M, until=half, beyond_m=0.2)
    known = whole <= whole[half] + 0.2
    np.testing.assert_array_equal(part[known], whole[known])
    assert np.isinf(part[~known]).all()


def test_no_time_is_known_beyond_the_limit():
    goal, passable, speed = cluttered(0)
    whole, part = march(goal, passable, speed, CELL_M), march(goal, passable, speed, CELL_M, limit_m=1.0123)
    np.testing.assert_array_equal(part, np.where(whole <= 1.0123, whole, np.inf))


def test_a_goal_that_cannot_be_stood_on_is_no_goal():
    row = np.array([[True, True, False, False, True]])
    time = march(~row, row, np.ones((1, 5)), CELL_M)
    assert np.isinf(time).all()


def test_arrays_that_are_handed_in_stay_as_they_are():
    goal, passable, speed = cluttered(1)
    copies = goal.copy(), passable.copy(), speed.copy()
    march(goal, passable, speed, CELL_M, until=(0, 0))
    for given, before in zip((goal, passable, speed), copies, strict=True):
        np.testing.assert_array_equal(given, before)
