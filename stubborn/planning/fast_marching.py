"""Travel times over a grid by a marching front that stops once it knows enough: the agent marches at every step.

The front is that of Sethian (1996), "A fast marching level set method for monotonically advancing fronts", with first
order upwind differences, as scikit-fmm computes it. What is next is not kept in a heap but in buckets of times (the
untidy queue of Yatziv, Bartesaghi, Sapiro 2006, "O(N) implementation of the fast marching algorithm"); a cell that is
improved later is simply taken up again, so that the result is the same, not an approximation. Compiled by numba: the
first call of a fresh installation takes seconds, later ones of new processes a fraction of one.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray


def march(
    goal: NDArray[np.bool_],
    passable: NDArray[np.bool_],
    speed: NDArray[np.floating],
    cell_m: float,
    limit_m: float = math.inf,
    *,
    until: tuple[int, int] | None = None,
    beyond_m: float = math.inf,
) -> NDArray[np.float32]:
    """Travel time from every passable cell to the nearest goal cell, at speeds in (0, 1] (1: metres are seconds).

    Args:
        goal: (rows, cols) where the time is 0; goal cells that are not passable do not count.
        passable: (rows, cols) where the front may go.
        speed: (rows, cols) of the front, relative to 1 in the open.
        cell_m: edge of a cell in metres.
        limit_m: the front stops at this time.
        until: a cell; once its time is known the front goes on for `beyond_m` more and stops.
        beyond_m: see `until`.

    Returns:
        (rows, cols) times in seconds at one metre a second; infinite where there is no way, and where the front did
        not get before it stopped.
    """
    rows, cols = goal.shape
    cost = np.full((rows + 2, cols + 2), np.inf, np.float32)  # seconds to cross a cell; the frame is a wall
    np.divide(np.float32(cell_m), speed, out=cost[1:-1, 1:-1], where=passable, casting="same_kind")
    time = np.full(cost.shape, np.inf)
    time[1:-1, 1:-1][goal & passable] = 0.0
    target = -1 if until is None else (until[0] + 1) * cost.shape[1] + until[1] + 1
    stop = _advance(cost.reshape(-1), time.reshape(-1), cols + 2, 0.5 * cell_m, limit_m, target, beyond_m)
    inner = time[1:-1, 1:-1]
    return np.where(inner <= stop, inner, np.inf).astype(np.float32)


@njit(cache=True)
def _advance(
    cost: NDArray[np.float32],
    time: NDArray[np.float64],
    width: int,
    bucket: float,
    limit: float,
    target: int,
    beyond: float,
) -> float:
    """Lower `time` from infinity until it is right up to the returned time.

    Arrays are flat, `width` cells a row, with a frame around whose cost is infinite. Bucket n holds the cells with
    times from n to n + 1 times `bucket`; the buckets are used in a ring, long enough for the slowest cell.
    """
    slowest = 0.0
    for cell in range(cost.size):
        if math.isfinite(cost[cell]) and cost[cell] > slowest:
            slowest = cost[cell]
    ring = int(slowest / bucket) + 3
    first = np.full(ring, -1, np.int32)  # of each bucket's cells, linked both ways
    after = np.full(cost.size, -1, np.int32)
    before = np.full(cost.size, -1, np.int32)
    slot_of = np.full(cost.size, -1, np.int32)
    waiting = 0
    for cell in range(cost.size):
        if time[cell] == 0.0:
            _link(cell, 0, first, after, before, slot_of)
            waiting += 1
    number = 0
    while waiting > 0 and number * bucket <= limit:
        slot = number % ring
        while first[slot] >= 0:
            cell = first[slot]
            _unlink(cell, first, after, before, slot_of)
            waiting -= 1
            for step in (-width, -1, 1, width):
                near = cell + step
                if not math.isfinite(cost[near]) or time[near] <= time[cell]:
                    continue
                arrival = _arrival(time, near, width, float(cost[near]))
                if arrival >= time[near] - 1e-9:
                    continue
                time[near] = arrival
                later = max(int(arrival / bucket), number) % ring
                if later == slot_of[near]:
                    continue
                if slot_of[near] >= 0:
                    _unlink(near, first, after, before, slot_of)
                    waiting -= 1
                _link(near, later, first, after, before, slot_of)
                waiting += 1
        number += 1
        if target >= 0 and time[target] < number * bucket:
            limit = min(limit, time[target] + beyond)
            target = -1
    return limit


@njit(cache=True)
def _arrival(time: NDArray[np.float64], cell: int, width: int, crossing: float) -> float:
    """When a front that has reached the neighbours reaches a cell that it takes `crossing` to cross (upwind scheme)."""
    x = min(time[cell - 1], time[cell + 1])
    y = min(time[cell - width], time[cell + width])
    if abs(x - y) >= crossing:
        return min(x, y) + crossing
    return 0.5 * (x + y + math.sqrt(2.0 * crossing * crossing - (x - y) * (x - y)))


@njit(cache=True)
def _link(
    cell: int,
    slot: int,
    first: NDArray[np.int32],
    after: NDArray[np.int32],
    before: NDArray[np.int32],
    slot_of: NDArray[np.int32],
) -> None:
    """Put a cell at the head of a bucket."""
    after[cell], before[cell], slot_of[cell] = first[slot], -1, slot
    if first[slot] >= 0:
        before[first[slot]] = cell
    first[slot] = cell


@njit(cache=True)
def _unlink(
    cell: int,
    first: NDArray[np.int32],
    after: NDArray[np.int32],
    before: NDArray[np.int32],
    slot_of: NDArray[np.int32],
) -> None:
    """Take a cell out of its bucket."""
    if before[cell] >= 0:
        after[before[cell]] = after[cell]
    else:
        first[slot_of[cell]] = after[cell]
    if after[cell] >= 0:
        before[after[cell]] = before[cell]
    slot_of[cell] = -1
