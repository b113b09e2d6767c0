"""How well two notions of a collision agree in a run: the world's (a contact stopped the body) and the agent's (it
moved less than 0.20 m).

python tools/check_collisions.py --run runs/mine --episodes 50

The run must have been made with --record. Forwards on which they differ are listed.
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim import cli
from sim.interface import Action, ConfigError
from sim.task.trajectory import ENDED, FOLDER, read_trajectory
from stubborn.mapping.collision_marks import CollisionConfig


@dataclass(frozen=True, kw_only=True)
class Args:
    """Which run to look at."""

    run: Path
    """Folder of a run made with --record."""
    episodes: int = 50
    """The first so many lines of its results."""
    most: int = 40
    """How many differing forwards are listed."""


def main(args: Args) -> int:
    """Count, and list the rest."""
    results = args.run / "results.jsonl"
    if not results.is_file():
        raise ConfigError(f"--run '{args.run}' has no results.jsonl.")
    names = sorted(json.loads(line)["episode_id"] for line in results.read_text(encoding="utf-8").splitlines())
    below_m = CollisionConfig().failed_below_m
    forwards = agreed = collided = short = listed = 0
    for name in names[: args.episodes]:
        t = read_trajectory(args.run / FOLDER / f"{name}.npz")
        is_forward = t.actions == Action.MOVE_FORWARD
        is_short = t.moved_m < below_m
        differ = np.flatnonzero(is_forward & (is_short != t.collided))
        forwards += int(is_forward.sum())
        collided += int((is_forward & t.collided).sum())
        short += int((is_forward & is_short).sum())
        agreed += int(is_forward.sum()) - len(differ)
        for i in differ.tolist():
            if listed < args.most:
                x, y, yaw, _ = t.poses[i]
                print(
                    f"{name} action {i}: moved {t.moved_m[i]:.3f} m, {ENDED[t.ended[i]]}, collided {t.collided[i]}, "
                    f"at ({x:.2f}, {y:.2f}) m, {np.degrees(yaw):.0f} deg"
                )
                listed += 1
    if forwards == 0:
        raise ConfigError(f"--run '{args.run}': no episode has a forward.")
    print(
        f"{min(len(names), args.episodes)} episodes, {forwards} forwards: {collided} collided, {short} moved less than "
        f"{below_m:.2f} m; both agree in {100 * agreed / forwards:.2f} %."
    )
    return 0


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
