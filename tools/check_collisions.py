"""Compares two definitions of a collision in a run: a contact stopped the body, and the robot moved less than 0.20 m.

    python tools/check_collisions.py --run runs/mine --episodes 50

The first is that of the world, the second that of the agent. The run must have been made with --record. The forward
actions for which the two differ are listed.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from sim import cli
from sim.evaluation.results import read_result_lines
from sim.interface import Action, ConfigError
from sim.task.trajectory import ENDED, Trajectory, read_trajectory, trajectory_file
from stubborn.mapping.collision_marks import CollisionConfig


@dataclass(frozen=True, kw_only=True)
class Args:
    """Options of the command."""

    run: Path
    """Folder of a run made with --record."""
    episodes: cli.Count = 50
    """Number of episodes, the first ones by id."""
    most: cli.Amount = 40
    """Largest number of listed actions."""


@dataclass
class Counts:
    """Numbers of forward actions."""

    forwards: int = 0
    collided: int = 0
    """Actions that a contact stopped."""
    short: int = 0
    """Actions that moved the robot less than the agent's threshold."""
    differences: list[str] = field(default_factory=list)
    """Descriptions of the actions that are only one of both."""


def main(args: Args) -> int:
    """Counts the actions of each kind and lists the differences."""
    results = args.run / "results.jsonl"
    if not results.is_file():
        raise ConfigError(f"--run '{args.run}' has no results.jsonl.")
    lines = read_result_lines(results).values
    names = sorted(line["episode_id"] for line in lines if line["end_reason"] != "error")[: args.episodes]
    below_m = CollisionConfig().failed_below_m
    counts = Counts()
    for name in names:
        add_episode(counts, name, read_trajectory(trajectory_file(args.run, name)), below_m)
    if counts.forwards == 0:
        raise ConfigError(f"--run '{args.run}': no episode has a forward action.")
    print("\n".join(counts.differences[: args.most]))
    share = 1.0 - len(counts.differences) / counts.forwards
    print(
        f"{len(names)} episodes, {counts.forwards} forwards: {counts.collided} collided, {counts.short} moved less "
        f"than {below_m:.2f} m; both agree in {100 * share:.2f} %."
    )
    return 0


def add_episode(counts: Counts, name: str, trajectory: Trajectory, below_m: float) -> None:
    """Counts the forward actions of one episode."""
    is_forward = trajectory.actions == Action.MOVE_FORWARD
    is_short = trajectory.moved_m < below_m
    counts.forwards += int(is_forward.sum())
    counts.collided += int((is_forward & trajectory.collided).sum())
    counts.short += int((is_forward & is_short).sum())
    for i in np.flatnonzero(is_forward & (is_short != trajectory.collided)).tolist():
        x, y, yaw, _ = trajectory.poses[i]
        counts.differences.append(
            f"{name} action {i}: moved {trajectory.moved_m[i]:.3f} m, {ENDED[trajectory.ended[i]]}, collided "
            f"{trajectory.collided[i]}, at ({x:.2f}, {y:.2f}) m, {np.degrees(yaw):.0f} deg"
        )


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
