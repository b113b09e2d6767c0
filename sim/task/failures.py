"""Why an episode failed: one of seven causes, by rules on its recorded trajectory.

The causes are those of the paper's Table I (section III), where people judged videos; here rules judge what the world
recorded, so they can be wrong about intentions. The first rule that fits decides:

1. `misc`: the physics broke.
2. The agent called STOP: `false_detection`, unless some frame showed the goal's category (which instance
   it was is not recorded) and any instance of it is within `AT_IT_M` in plan: then it is taken to have stopped at the
   right thing, but short of it or behind a wall: `misc`. An agent that gives up, or stops at random, counts as a false
   detection, as nothing recorded tells them apart. This comes before `stairs`, as in the paper: the agent that has 7 %
   stairs among its failures with true segmentation has 0.4 % with its own.
3. `stairs`: the storey of the start has no instance.
4. `missed_detection`: the goal covered 0.8 % of a frame, and from then on, before anything of rules 5 and 6 began, the
   agent had its chance: it stood where a STOP would have succeeded and went on for `PATIENCE_STEPS`; or it never came
   within `APPROACHED_M` of such a place, although it drove `CHANCE` times as far as that place was, and `CHANCE_M`.
5. `trapped`: some window of 100 steps in which the robot never got 1 m away from where the window began (the metric).
6. `loop`: some window of `LOOP_STEPS` steps in which the robot drove `LOOP_PATH_M` or more, and less than `LOOP_NEW` of
   that over new ground. New ground is what is farther than `NEW_GROUND_M` from all ground it has seen itself on before.
7. `explore`: the goal never covered 0.8 % of a frame.
8. `misc`: the rest. It saw the goal and the steps ran out on the way, or it came near and could not get nearer.

Rules 4 to 6 together name what went wrong first: who sees the goal, passes by and is trapped in the next room has
missed it; who sees it and is trapped at once is trapped.
"""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from sim.task.metrics import EXPLORED_SHARE, TRAPPED_RADIUS_M, TRAPPED_WINDOW_STEPS
from sim.task.trajectory import Trajectory

Cause = Literal["false_detection", "missed_detection", "loop", "trapped", "explore", "stairs", "misc"]
CAUSES: tuple[str, ...] = get_args(Cause)
"""In the order of the paper's table."""
AT_IT_M = 1.5
"""Who stops this near to an instance (success needs 1.0 m and a free line of sight) meant that instance."""
APPROACHED_M = 1.0
"""Who comes this near to a place where a STOP succeeds, along the way, has approached the goal."""
PATIENCE_STEPS = 20
"""Actions in which an agent at its goal can be expected to stop; a look around takes 12."""
CHANCE, CHANCE_M = 1.5, 3.0
"""Who drives so many times the way to a goal it sees, and so many metres, could have gone there."""
LOOP_STEPS = 150
"""Three tenths of an episode."""
LOOP_PATH_M = 10.0
LOOP_NEW = 0.1
NEW_GROUND_M = 0.75
"""Wider than two ways through one doorway are apart."""


def cause_of_failure(trajectory: Trajectory) -> Cause | None:
    """Why an episode failed, by the rules above; None for a success.

    Raises:
        ValueError: the episode has not ended.
    """
    if trajectory.end_reason is None:
        raise ValueError("an episode that still runs has not failed")
    if trajectory.success:
        return None
    if trajectory.end_reason == "error":
        return "misc"
    seen = np.flatnonzero(trajectory.goal_share >= EXPLORED_SHARE)
    if trajectory.end_reason == "stop":
        nearest_m = trajectory.nearest_instance_m
        at_it = nearest_m is not None and nearest_m <= AT_IT_M and len(seen) > 0
        return "misc" if at_it else "false_detection"
    if not trajectory.goal_on_storey:
        return "stairs"
    trapped, looping = first_trapped_step(trajectory.positions_m), first_looping_step(trajectory)
    free_until = min(step for step in (trapped, looping, trajectory.num_steps) if step is not None)
    if len(seen) and _had_its_chance(trajectory, int(seen[0]), free_until):
        return "missed_detection"
    if trapped is not None:
        return "trapped"
    if looping is not None:
        return "loop"
    return "misc" if len(seen) else "explore"


def first_trapped_step(positions_m: NDArray[np.floating]) -> int | None:
    """The step with which the first window begins that the robot was trapped in; positions (n + 1, 2)."""
    positions = positions_m.astype(np.float64)
    for begin in range(len(positions) - TRAPPED_WINDOW_STEPS):
        window = positions[begin : begin + TRAPPED_WINDOW_STEPS + 1]
        if np.hypot(*(window - window[0]).T).max() < TRAPPED_RADIUS_M:
            return begin
    return None


def first_looping_step(trajectory: Trajectory) -> int | None:
    """The step with which the first window begins that the robot spent on old ground."""
    if trajectory.num_steps < LOOP_STEPS:
        return None
    path_m = np.concatenate([[0.0], np.cumsum(trajectory.moved_m)])
    new_m = NEW_GROUND_M * np.cumsum(on_new_ground(trajectory.positions_m))
    driven_m, gained_m = (total[LOOP_STEPS:] - total[:-LOOP_STEPS] for total in (path_m, new_m))
    begins = np.flatnonzero((driven_m >= LOOP_PATH_M) & (gained_m < LOOP_NEW * driven_m))
    return int(begins[0]) if len(begins) else None


def on_new_ground(positions_m: NDArray[np.floating]) -> NDArray[np.bool_]:
    """(n,) which of the places (n, 2) of a walk are farther than `NEW_GROUND_M` from every such place before."""
    new = np.zeros(len(positions_m), dtype=np.bool_)
    landmarks = np.empty_like(positions_m)
    count = 0
    for i, place in enumerate(positions_m):
        if not np.any(np.hypot(*(landmarks[:count] - place).T) <= NEW_GROUND_M):
            new[i] = True
            landmarks[count] = place
            count += 1
    return new


def _had_its_chance(trajectory: Trajectory, first_seen: int, until: int) -> bool:
    """Rule 4, on the steps from the first sight of the goal to the one in which something else went wrong."""
    if until <= first_seen:
        return False
    distance_m = trajectory.distance_m[first_seen : until + 1]
    stood_there = np.flatnonzero(distance_m <= 0.0)
    if len(stood_there) and until - (first_seen + int(stood_there[0])) >= PATIENCE_STEPS:
        return True
    if np.any(distance_m <= APPROACHED_M) or not np.isfinite(distance_m[0]):
        return False
    driven_m = float(trajectory.moved_m[first_seen:until].sum())
    return driven_m >= max(CHANCE_M, CHANCE * float(distance_m[0]))
