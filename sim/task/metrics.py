"""Metrics of an episode as pure functions (docs/task.md).

SPL is that of Anderson et al. 2018 (arXiv:1807.06757), soft SPL that of Habitat; distances are in metres.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sim.core.interface import MPCAT40_ID

TRAPPED_WINDOW_STEPS = 100
TRAPPED_RADIUS_M = 1.0
"""A robot is trapped if it never gets this far from its position at the start of a window of that many steps."""
EXPLORED_SHARE = 0.008
"""Share of a frame that the goal's true mask must cover for GT exploration to be true."""
MOVED_M = 0.01
"""A shorter path is that of a robot that turned on the spot, whose centre drifts by micrometres."""


def path_efficiency(shortest_path_m: float, path_length_m: float) -> float:
    """Returns the shortest over the taken path length, in [0, 1]; 1 where both are 0."""
    longer = max(shortest_path_m, path_length_m)
    return shortest_path_m / longer if longer > 0.0 else 1.0


def spl(success: bool, shortest_path_m: float | None, path_length_m: float) -> float:
    """Returns the success weighted by path length; 0 if there was no path from the start."""
    return path_efficiency(shortest_path_m, path_length_m) if success and shortest_path_m is not None else 0.0


def soft_spl(start_distance_m: float | None, end_distance_m: float | None, path_length_m: float) -> float:
    """Returns the progress to the goal, in [0, 1], weighted by path length; 0 if there is or was no path."""
    if start_distance_m is None or end_distance_m is None:
        return 0.0
    if start_distance_m <= 0.0:
        progress = 1.0 if end_distance_m <= 0.0 else 0.0
    else:
        progress = max(0.0, 1.0 - end_distance_m / start_distance_m)
    return progress * path_efficiency(start_distance_m, path_length_m)


def goal_share(semantic: NDArray[np.uint8], goal: str) -> float:
    """Returns the share of one ground-truth frame (h, w) that the goal's class covers, in [0, 1]."""
    return int(np.count_nonzero(semantic == MPCAT40_ID[goal])) / semantic.size


def steps_to_first_sight(first_seen_step: int | None, max_steps: int) -> int:
    """Returns the time to first sight, censored at the limit: an episode that never showed the goal has `max_steps`.

    Its mean over episodes is the restricted mean time to first sight. It also counts an agent that stops before it has
    seen the goal with the limit, so that an early STOP does not shorten the time.
    """
    return max_steps if first_seen_step is None else first_seen_step


def per_metre(area_m2: float, path_length_m: float) -> float:
    """Returns the floor area seen per metre driven; 0 if the robot has not moved by `MOVED_M`."""
    return area_m2 / path_length_m if path_length_m >= MOVED_M else 0.0


def stayed_near(positions_m: Sequence[tuple[float, float]] | NDArray[np.float64], every: int = 1) -> bool:
    """Returns whether the last window of positions (n, 2) stays within `TRAPPED_RADIUS_M` of its first position.

    False while fewer than `TRAPPED_WINDOW_STEPS` actions were taken; an action takes `every` steps.
    """
    steps = every * TRAPPED_WINDOW_STEPS
    if len(positions_m) <= steps:
        return False
    window = np.asarray(positions_m[-steps - 1 :: every], dtype=np.float64)
    return bool(np.hypot(*(window - window[0]).T).max() < TRAPPED_RADIUS_M)
