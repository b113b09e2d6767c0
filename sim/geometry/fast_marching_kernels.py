"""The loops of `sim.geometry.fast_marching`, compiled by numba.

Arrays are flat, `width` cells a row, with a frame of impassable cells, so that a stencil needs no test for the border.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sim.geometry.compiling import njit


@njit(cache=True, error_model="numpy")
def advance_second_order(
    passable: NDArray[np.bool_], frozen: NDArray[np.float64], width: int, inverse_area: float
) -> None:
    """Replaces infinity in `frozen`, which holds 0 at sources, by the distance of every cell that can be reached.

    The frame is two cells wide. Cells are frozen in the order of their trial distances, cells of equal distance
    together. A trial distance depends on frozen cells only; it is computed again when a cell one or two steps away
    along an axis is frozen.
    """
    heap = np.empty(frozen.size, np.int32)  # cells, a binary heap ordered by `trial`
    trial = np.empty(frozen.size)  # trial distance of each cell of the heap
    place = np.full(frozen.size, -1, np.int32)  # index of each cell in the heap; -1: it is not in the heap
    equal = np.empty(frozen.size, np.int32)  # cells of one distance
    length = 0
    for cell in range(frozen.size):
        if passable[cell] and frozen[cell] > 0.0 and _nearest_neighbour(frozen, cell, width) == 0.0:
            _move_up(cell, _second_order_distance(frozen, cell, width, inverse_area), length, heap, trial, place)
            length += 1
    while length > 0:
        distance = trial[0]
        count = 0
        while length > 0 and trial[0] == distance:
            equal[count] = heap[0]
            frozen[heap[0]] = distance
            place[heap[0]] = -1
            count += 1
            length -= 1
            if length > 0:
                _move_down(heap[length], trial[length], 0, length, heap, trial, place)
        for cell in equal[:count]:
            for step in (-width, width, -1, 1):
                near = cell + step
                if math.isfinite(frozen[near]):
                    near += step
                    if place[near] < 0:
                        continue
                elif not passable[near]:
                    continue
                changed = _second_order_distance(frozen, near, width, inverse_area)
                length = _put(near, changed, length, heap, trial, place)


@njit(cache=True, error_model="numpy")
def _nearest_neighbour(frozen: NDArray[np.float64], cell: int, width: int) -> float:
    """Returns the smallest distance of the four neighbours of a cell."""
    return min(min(frozen[cell - 1], frozen[cell + 1]), min(frozen[cell - width], frozen[cell + width]))


@njit(cache=True, error_model="numpy")
def _second_order_distance(frozen: NDArray[np.float64], cell: int, width: int, inverse_area: float) -> float:
    """Returns the trial distance of a cell from the frozen cells up to two steps away.

    Where both neighbours on an axis are frozen, the second cell may lie behind the farther one. scikit-fmm does the
    same. Where the second-order equation has no root, the first-order one is solved.
    """
    a = b = c = 0.0  # of the quadratic equation
    for step in (width, 1):
        first, second = math.inf, math.inf
        for side in (-step, step):
            near = frozen[cell + side]
            if near < first:
                first, behind = near, frozen[cell + 2 * side]
                if behind <= near or (near == 0.0 and behind < math.inf):
                    second = behind
        if second < math.inf:
            weight, value = 9.0 / 4.0 * inverse_area, 1.0 / 3.0 * (4.0 * first - second)
        elif first < math.inf:
            weight, value = inverse_area, first
        else:
            continue
        a += weight
        b -= 2.0 * weight * value
        c += weight * (value * value)
    discriminant = b * b - 4.0 * a * (c - 1.0)
    if discriminant < 0.0:
        return _first_order_distance(frozen, cell, width, inverse_area)
    return (-b + math.sqrt(discriminant)) / 2.0 / a


@njit(cache=True, error_model="numpy")
def _first_order_distance(frozen: NDArray[np.float64], cell: int, width: int, inverse_area: float) -> float:
    """Returns the trial distance of a cell from its frozen neighbours; their mean where the equation has no root."""
    a = b = c = 0.0
    for step in (width, 1):
        value = min(frozen[cell - step], frozen[cell + step])
        if value < math.inf:
            a += inverse_area
            b -= 2.0 * inverse_area * value
            c += inverse_area * (value * value)
    discriminant = b * b - 4.0 * a * (c - 1.0)
    if discriminant < 0.0:
        return -b / (2.0 * a)
    return (-b + math.sqrt(discriminant)) / 2.0 / a


@njit(cache=True)
def _put(
    cell: int,
    distance: float,
    length: int,
    heap: NDArray[np.int32],
    trial: NDArray[np.float64],
    place: NDArray[np.int32],
) -> int:
    """Adds a cell to the heap, or changes its trial distance; returns the new length of the heap."""
    index = place[cell]
    if index < 0:
        _move_up(cell, distance, length, heap, trial, place)
        return length + 1
    if distance < trial[index]:
        _move_up(cell, distance, index, heap, trial, place)
    else:
        _move_down(cell, distance, index, length, heap, trial, place)
    return length


@njit(cache=True)
def _move_up(
    cell: int,
    distance: float,
    index: int,
    heap: NDArray[np.int32],
    trial: NDArray[np.float64],
    place: NDArray[np.int32],
) -> None:
    """Writes a cell to the heap at `index`, or above it while its trial distance is the smaller one."""
    while index > 0:
        parent = (index - 1) >> 1
        if trial[parent] <= distance:
            break
        heap[index], trial[index] = heap[parent], trial[parent]
        place[heap[index]] = index
        index = parent
    heap[index], trial[index], place[cell] = cell, distance, index


@njit(cache=True)
def _move_down(
    cell: int,
    distance: float,
    index: int,
    length: int,
    heap: NDArray[np.int32],
    trial: NDArray[np.float64],
    place: NDArray[np.int32],
) -> None:
    """Writes a cell to the heap at `index`, or below it while its trial distance is the larger one."""
    while 2 * index + 1 < length:
        child = 2 * index + 1
        if child + 1 < length and trial[child + 1] < trial[child]:
            child += 1
        if trial[child] >= distance:
            break
        heap[index], trial[index] = heap[child], trial[child]
        place[heap[index]] = index
        index = child
    heap[index], trial[index], place[cell] = cell, distance, index


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
        time: (rows + 2, cols + 2) is overwritten, infinite where there is no goal.
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
    `bucket`; the buckets form a ring that is long enough for the slowest cell. Each is a stack of entries. A cell whose
    time falls gets another entry and leaves its old one behind: an entry counts only while the cell belongs to the
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
    result[: values.size] = values
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
