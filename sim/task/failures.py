"""The cause of a failed episode: one of eight, by rules on its recorded trajectory.

The causes are those of the paper's Table I (section III), where people judged videos, and `stopped_short`, which the
paper counts as `misc`; here rules judge what the world recorded, so they can be wrong about the intention of the agent.
The first rule that applies decides:

1. `misc`: the physics broke. `stairs`: the robot drove over an edge.
2. The agent called STOP. `stopped_short`: it stopped for the goal, but too far from it or behind a wall. An agent that
   states for which place it stops (`sim.core.interface.StatesTarget`) did so if that place is within `TARGET_ON_GOAL_M`
   of the footprint of an instance. One that states none is assumed to have done so if an instance is within
   `STOPPED_AT_GOAL_M` in plan, and the goal covered 0.8 % of one of the last `FACED_FRAMES` frames; this counts a STOP
   for another object next to an instance in view as `stopped_short`, too. Otherwise it is `false_detection`, however
   near an instance is, also for an agent that gives up or stops at random, because the record does not distinguish
   them. This rule comes before `stairs`, as in the paper: the agent that has 7 % stairs among its failures with true
   segmentation has 0.4 % with its own.
3. `stairs`: the storey of the start has no instance.
4. `missed_detection`: the goal covered 0.8 % of a frame, and from then on, before rules 5 and 6 applied, the agent had
   an opportunity: it was where a STOP would have succeeded and continued for `PATIENCE_STEPS`; or it never came within
   `APPROACHED_M` of such a place, although it drove `OPPORTUNITY` times the distance to that place, and at least
   `OPPORTUNITY_M`.
5. `trapped`: some window of 100 steps in which the robot stayed within 1 m of its first position (the metric).
6. `loop`: some window of `LOOP_STEPS` steps in which the robot drove `LOOP_PATH_M` or more, and less than `LOOP_NEW` of
   that over new ground. New ground is farther than `NEW_GROUND_M` from all earlier positions on new ground.
7. `explore`: the goal never covered 0.8 % of a frame.
8. `misc`: the rest. The agent saw the goal and reached `max_steps` on its path to it, or it came near but not to it.

Rules 4 to 6 together name the first problem of an episode: an agent that sees the goal, passes it and is trapped in the
next room has missed the goal; one that is trapped right after it saw the goal is trapped.
"""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from sim.task.metrics import EXPLORED_SHARE, TRAPPED_RADIUS_M, TRAPPED_WINDOW_STEPS
from sim.task.trajectory import Trajectory

Cause = Literal["false_detection", "stopped_short", "missed_detection", "loop", "trapped", "explore", "stairs", "misc"]
CAUSES: tuple[str, ...] = get_args(Cause)
"""The causes in the order of the paper's table, `stopped_short` after `false_detection`."""
TARGET_ON_GOAL_M = 0.3
"""A stated place within this distance of an instance is of that instance: maps have cells, and outlines have errors."""
STOPPED_AT_GOAL_M = 1.5
"""An agent that states no place and stops within this distance of an instance that it faces is assumed to have stopped
for it."""
FACED_FRAMES = 4
"""The last frames in which the agent can have seen what it stopped for: the one of the STOP, and three actions before,
because a low object is below the image when the robot has come near it."""
APPROACHED_M = 1.0
"""An agent within this geodesic distance of a place where a STOP succeeds has approached the goal."""
PATIENCE_STEPS = 20
"""Number of actions within which an agent at its goal can be expected to stop; a full turn takes 12."""
OPPORTUNITY, OPPORTUNITY_M = 1.5, 3.0
"""An agent that drives this many times the distance to a goal that it sees, and this many metres, could reach it."""
LOOP_STEPS = 150
"""Length of the window: three tenths of an episode."""
LOOP_PATH_M = 10.0
LOOP_NEW = 0.1
NEW_GROUND_M = 0.75
"""Larger than the distance between two paths through one doorway."""


def cause_of_failure(trajectory: Trajectory) -> Cause | None:
    """Returns the cause of a failure by the rules above; None for a success.

    Raises:
        ValueError: the episode has not ended.
    """
    if trajectory.end_reason is None:
        raise ValueError("The episode still runs; only an ended episode has a cause of failure.")
    if trajectory.success:
        return None
    if trajectory.end_reason == "error":
        return "misc"
    if trajectory.end_reason == "fallen":
        return "stairs"
    seen = np.flatnonzero(trajectory.goal_share >= EXPLORED_SHARE)
    if trajectory.end_reason == "stop":
        return "stopped_short" if _stopped_for_the_goal(trajectory) else "false_detection"
    if not trajectory.goal_on_storey:
        return "stairs"
    trapped, looping = first_trapped_step(trajectory.positions_m), first_looping_step(trajectory)
    problem = min(step for step in (trapped, looping, trajectory.num_steps) if step is not None)
    if len(seen) and _had_opportunity(trajectory, int(seen[0]), problem):
        return "missed_detection"
    if trapped is not None:
        return "trapped"
    if looping is not None:
        return "loop"
    return "misc" if len(seen) else "explore"


def _stopped_for_the_goal(trajectory: Trajectory) -> bool:
    """Returns whether the agent stopped for an instance: by its statement, else near one that it had just seen."""
    if trajectory.stop.stop_target_xy_m is not None:
        off_m = trajectory.stop.stop_target_to_goal_m
        return off_m is not None and off_m <= TARGET_ON_GOAL_M
    nearest_m = trajectory.nearest_instance_m
    if nearest_m is None or nearest_m > STOPPED_AT_GOAL_M:
        return False
    before_stop = trajectory.goal_share[:-1]  # the frame after the STOP shows the same as the one before
    looked = before_stop[~np.isnan(before_stop)]
    return bool(np.any(looked[-FACED_FRAMES:] >= EXPLORED_SHARE))


def first_trapped_step(positions_m: NDArray[np.floating]) -> int | None:
    """Returns the first step of the first window in which the robot was trapped, or None; positions (n + 1, 2)."""
    positions = positions_m.astype(np.float64)
    for begin in range(len(positions) - TRAPPED_WINDOW_STEPS):
        window = positions[begin : begin + TRAPPED_WINDOW_STEPS + 1]
        if np.hypot(*(window - window[0]).T).max() < TRAPPED_RADIUS_M:
            return begin
    return None


def first_looping_step(trajectory: Trajectory) -> int | None:
    """Returns the first step of the first window that the robot spent on old ground; None if no window is."""
    if trajectory.num_steps < LOOP_STEPS:
        return None
    path_m = np.concatenate([[0.0], np.cumsum(trajectory.moved_m)])
    new_m = NEW_GROUND_M * np.cumsum(on_new_ground(trajectory.positions_m))
    driven_m, gained_m = (total[LOOP_STEPS:] - total[:-LOOP_STEPS] for total in (path_m, new_m))
    begins = np.flatnonzero((driven_m >= LOOP_PATH_M) & (gained_m < LOOP_NEW * driven_m))
    return int(begins[0]) if len(begins) else None


def on_new_ground(positions_m: NDArray[np.floating]) -> NDArray[np.bool_]:
    """Returns (n,) whether each position (n, 2) is farther than `NEW_GROUND_M` from all earlier such positions."""
    new = np.zeros(len(positions_m), dtype=np.bool_)
    landmarks = np.empty_like(positions_m)
    count = 0
    for i, position in enumerate(positions_m):
        if not np.any(np.hypot(*(landmarks[:count] - position).T) <= NEW_GROUND_M):
            new[i] = True
            landmarks[count] = position
            count += 1
    return new


def _had_opportunity(trajectory: Trajectory, first_seen: int, until: int) -> bool:
    """Returns whether rule 4 applies from the first frame of the goal to the step of the next problem."""
    if until <= first_seen:
        return False
    distance_m = trajectory.distance_m[first_seen : until + 1]
    at_goal = np.flatnonzero(distance_m <= 0.0)
    if len(at_goal) and until - (first_seen + int(at_goal[0])) >= PATIENCE_STEPS:
        return True
    if np.any(distance_m <= APPROACHED_M) or not np.isfinite(distance_m[0]):
        return False
    driven_m = float(trajectory.moved_m[first_seen:until].sum())
    return driven_m >= max(OPPORTUNITY_M, OPPORTUNITY * float(distance_m[0]))
