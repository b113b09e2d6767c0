"""The loops of `sim.core.geometry.fast_marching.travel_times`, compiled by numba.

Arrays are flat, `width` cells a row, with a frame of impassable cells, so that a stencil needs no test for the border.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.compiling import njit


@njit(cache=True)
def frame_problem(
    goal: NDArray[np.bool_],
    passable: NDArray[np.bool_],
    speed: NDArray[np.float32],
    cell_m: np.float32,
    cost: NDArray[np.float32],
    time: NDArray[np.float64],
) -> None:
    """Fills `cost`, the seconds to cross a cell, and `time`, 0 at goals; both get a frame of one impassable cell.

    Args:
        goal: (rows, cols); goals that are not passable do not count.
        passable: (rows, cols).
        speed: (rows, cols) metres a second.
        cell_m: edge of a cell.
        cost: (rows + 2, cols + 2) is overwritten, infinite where a cell is not passable.
        time: (rows + 2, cols + 2) is overwritten: 0 at the goal, infinite elsewhere.
    """
    cost[:] = np.inf
    time[:] = np.inf
    for row in range(goal.shape[0]):
        for col in range(goal.shape[1]):
            if passable[row, col]:
                cost[row + 1, col + 1] = cell_m / speed[row, col]
                if goal[row, col]:
                    time[row + 1, col + 1] = 0.0


@njit(cache=True)
def unframed(time: NDArray[np.float64], limit: float) -> NDArray[np.float32]:
    """Returns the times without their frame of one cell; infinite where they are above the limit."""
    rows, cols = time.shape[0] - 2, time.shape[1] - 2
    result = np.empty((rows, cols), np.float32)
    for row in range(rows):
        for col in range(cols):
            inner = time[row + 1, col + 1]
            result[row, col] = inner if inner <= limit else np.inf
    return result


@njit(cache=True, error_model="numpy")
def advance_first_order(
    cost: NDArray[np.float32],
    time: NDArray[np.float64],
    width: int,
    bucket: float,
    limit: float,
    target: int,
    beyond: float,
) -> float:
    """Lowers `time`, which holds 0 at goals and infinity elsewhere, until it is right up to the returned time.

    The frame is one cell wide and its cost infinite. Bucket n holds the cells with times from n to n + 1 times
    `bucket`; the buckets form a ring that is long enough for the slowest cell. Each is a stack of entries. If the time
    of a cell falls, it gets another entry and leaves its old one behind: an entry counts only while the cell is in the
    bucket, and the uppermost of several entries in one bucket comes first.
    """
    slowest = 0.0
    for cell in range(cost.size):
        if slowest < cost[cell] < math.inf:
            slowest = cost[cell]
    ring = int(slowest / bucket) + 3
    top = np.full(ring, -1, np.int32)  # the uppermost entry of each bucket
    bucket_of = np.full(cost.size, -1, np.int32)
    cell_of = np.empty(cost.size, np.int32)  # of each entry
    below = np.empty(cost.size, np.int32)  # the entry below each entry, of its bucket or of the unused ones
    entries, unused = 0, -1
    waiting = 0
    for cell in range(cost.size):
        if time[cell] == 0.0:
            cell_of[entries], below[entries], top[0], bucket_of[cell] = cell, top[0], entries, 0
            entries += 1
            waiting += 1
    number = current = 0
    one, row = np.uint64(1), np.uint64(width)  # of signed indices numba would test whether they count from the end
    while waiting > 0 and number * bucket <= limit:
        while top[current] >= 0:
            entry = top[current]
            cell, top[current] = np.uint64(cell_of[entry]), below[entry]
            below[entry], unused = unused, entry
            if bucket_of[cell] != current:
                continue
            bucket_of[cell] = -1
            waiting -= 1
            for near in (cell - row, cell - one, cell + one, cell + row):
                if time[near] <= time[cell] or not cost[near] < math.inf:
                    continue
                arrival = _first_order_time(time, near, row, float(cost[near]))
                if arrival >= time[near] - 1e-9:
                    continue
                time[near] = arrival
                later = current + max(int(arrival / bucket) - number, 0)
                later -= ring if later >= ring else 0
                if later == bucket_of[near]:
                    continue
                waiting += bucket_of[near] < 0
                bucket_of[near] = later
                if unused >= 0:
                    entry, unused = unused, below[unused]
                else:
                    if entries == cell_of.size:
                        cell_of, below = _doubled(cell_of), _doubled(below)
                    entry = entries
                    entries += 1
                cell_of[entry], below[entry], top[later] = near, top[later], entry
        number += 1
        current = current + 1 if current + 1 < ring else 0
        if target >= 0 and time[target] < number * bucket:
            limit = min(limit, time[target] + beyond)
            target = -1
    return limit


@njit(cache=True)
def _doubled(values: NDArray[np.int32]) -> NDArray[np.int32]:
    """Returns the values in an array of twice their number."""
    result = np.empty(2 * values.size, np.int32)
    for i in range(values.size):  # an assignment to a slice would take seconds to compile
        result[i] = values[i]
    return result


@njit(cache=True)
def _first_order_time(time: NDArray[np.float64], cell: np.uint64, row: np.uint64, crossing: float) -> float:
    """Returns the travel time to a cell that takes `crossing` seconds to cross, from the times of its neighbours.

    Neighbours of one column are `row` cells apart.
    """
    x = min(time[cell - np.uint64(1)], time[cell + np.uint64(1)])
    y = min(time[cell - row], time[cell + row])
    if abs(x - y) >= crossing:
        return min(x, y) + crossing
    return 0.5 * (x + y + math.sqrt(2.0 * crossing * crossing - (x - y) * (x - y)))
