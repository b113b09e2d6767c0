"""Distances and travel times over a grid by the fast marching method (Sethian 1996).

Both functions solve the eikonal equation, |gradient of time| = 1 / speed, with upwind differences over passable cells:

- `distances` is second order at speed 1 and visits every cell that can be reached. The task's reference distances are
  computed with it, by scikit-fmm, so that the judge and the agent do not share code.
- `travel_times` is first order with a speed per cell and stops as soon as the caller's question is answered. The agent
  calls it at every step. It needs no heap: waiting cells lie in buckets of times. A cell is processed again if its time
  falls later, so that the result is not an approximation (Yatziv, Bartesaghi, Sapiro 2006, "O(N) implementation of the
  fast marching algorithm").

The first call of `travel_times` after an installation compiles for some seconds; later processes load the result from
numba's cache.
"""

from __future__ import annotations

import math

import numpy as np
import skfmm
from jaxtyping import Bool, Float, Float32

from sim.core.geometry.fast_marching_kernels import advance_first_order, frame_problem, unframed


def distances(
    sources: Bool[np.ndarray, "rows cols"], passable: Bool[np.ndarray, "rows cols"], cell_m: float
) -> Float32[np.ndarray, "rows cols"]:
    """Returns the length of the shortest path from every passable cell to the nearest source cell, in metres.

    Args:
        sources: True where the distance is 0; source cells that are not passable do not count.
        passable: True where a path may lead.
        cell_m: edge of a cell in metres.

    Returns:
        Metres between cell centres; infinite where no path exists.

    Raises:
        ValueError: `cell_m` is not positive.
    """
    sources = sources & passable
    if not sources.any():  # scikit-fmm raises ValueError
        return np.full(sources.shape, np.inf, np.float32)
    front = np.ascontiguousarray(np.where(sources, 0.0, 1.0))  # scikit-fmm misreads arrays of another memory order
    masked = np.ma.MaskedArray(front, mask=~passable)
    distance = np.ma.filled(skfmm.distance(masked, dx=float(cell_m), order=2), np.inf)
    return np.where(passable, distance, np.inf).astype(np.float32)


def travel_times(
    goal: Bool[np.ndarray, "rows cols"],
    passable: Bool[np.ndarray, "rows cols"],
    speed: Float[np.ndarray, "rows cols"],
    cell_m: float,
    limit_m: float = math.inf,
    *,
    until: tuple[int, int] | None = None,
    beyond_m: float = math.inf,
) -> Float32[np.ndarray, "rows cols"]:
    """Returns the travel time from every passable cell to the nearest goal cell, in seconds at one metre a second.

    Args:
        goal: True where the time is 0; goal cells that are not passable do not count.
        passable: True where a path may lead.
        speed: in (0, 1], relative to one metre a second.
        cell_m: edge of a cell in metres.
        limit_m: times above this are not computed.
        until: (row, col) of a cell; times above that cell's time plus `beyond_m` are not computed.
        beyond_m: see `until`.

    Returns:
        Seconds; infinite where no path exists, and where the time was not computed.
    """
    rows, cols = goal.shape
    cost, time = np.empty((rows + 2, cols + 2), np.float32), np.empty((rows + 2, cols + 2))
    frame_problem(goal, passable, speed, np.float32(cell_m), cost, time)
    target = -1 if until is None else (until[0] + 1) * (cols + 2) + until[1] + 1
    limit = advance_first_order(cost.reshape(-1), time.reshape(-1), cols + 2, 0.5 * cell_m, limit_m, target, beyond_m)
    return unframed(time, limit)
