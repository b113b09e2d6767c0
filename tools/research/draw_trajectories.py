"""Draws recorded episodes: the floor plan with the robot's path, and the distance to the goal over the steps.

    python -m tools.research.draw_trajectories runs/mine                  # the failed ones
    python -m tools.research.draw_trajectories runs/mine --episodes val_0007 val_0012
    python -m tools.research.draw_trajectories runs/corners runs/tour     # side by side, where one finds the goal

In the plan: free space white, blocked space grey, the goal's instances green, the area where a STOP succeeds light
green; the path from blue to red, contacts that stopped the robot black, the start a ring, the end a disc, and a yellow
ring where the goal was first seen (0.8 % of a frame). Below: the distance to the goal over the steps, yellow where the
goal was in view. Several runs of the same episodes are drawn side by side. The pictures are made from trajectory files
and houses; no episode is run again.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import tyro
from numpy.typing import NDArray
from rich.console import Console

from sim.app import cli
from sim.app.analysis import display
from sim.app.analysis.comparison import Run, read_run, require_same_episodes
from sim.app.analysis.report.drawings import ground_truth_of, split_of
from sim.core.files import write_picture
from sim.core.geometry.grid import GridFrame
from sim.core.interface import ConfigError
from sim.task.failures import cause_of_failure, first_looping_step, first_trapped_step
from sim.task.ground_truth import GroundTruth
from sim.task.metrics import EXPLORED_SHARE
from sim.task.trajectory import Trajectory, read_trajectory, trajectory_file

Picture = NDArray[np.uint8]
PX_M = 60.0
"""Pixels per metre."""
SMALL_PX_M = 30.0
"""Pixels per metre of several runs side by side."""
GAP_PX = 12
CHART_PX = 140
MIN_WIDTH_PX = 640
"""The heading needs as much."""
SMALL_MIN_WIDTH_PX = 450
"""The same with several runs side by side."""
BLOCKED, FREE, SUCCEEDS, INSTANCE = (150, 150, 150), (255, 255, 255), (214, 240, 205), (60, 160, 70)
CONTACT, SEEN, INK = (0, 0, 0), (230, 180, 0), (30, 30, 30)


@dataclass(frozen=True, kw_only=True)
class Args:
    """Draw episodes of runs that were made with --record."""

    runs: tyro.conf.Positional[tuple[Path, ...]]
    """Folders of runs of the same episodes; the pictures of one episode are side by side, in this order."""
    episodes: tuple[str, ...] = ()
    """Ids of the episodes; if not given, all failed ones of one run, or those that some of several runs failed."""
    out: cli.OutFolder | None = None
    """Folder for the pictures (<first run>/pictures)."""


def main(args: Args) -> int:
    """Draws the episodes; returns the exit status, 1 if none of them has a trajectory."""
    if not args.runs:
        raise ConfigError("Give the folder of a run, or of several runs of the same episodes.")
    console = display.make_console()
    runs = [read_run(path) for path in args.runs]
    wanted = _wanted(runs, args.episodes)
    if not wanted:
        none = "No episode failed" if len(runs) == 1 else "The runs succeed in the same episodes"
        _print(console, f"{none}: nothing to draw. --episodes names episodes.")
    missing = [i for i in wanted if not all(_file(run, i).is_file() for run in runs)]
    if missing:
        why = "written with --record; an episode with an error has none"
        _print(console, f"No trajectory, not drawn: {' '.join(missing)} ({why})")
    first, out = runs[0], args.out or args.runs[0] / "pictures"
    split, truth = split_of(first), None
    for episode_id in sorted(set(wanted) - set(missing), key=lambda i: (first.lines[i]["house"], i)):
        line = first.lines[episode_id]
        if truth is None or truth.world.house.name != line["house"]:
            truth = ground_truth_of(first, split.load_house(line["house"]))
        pictures = []
        file = out / f"{trajectory_file(Path(), episode_id).stem}.png"
        for run in runs:
            trajectory = read_trajectory(_file(run, episode_id))
            words = in_words(episode_id, line["goal"], trajectory)
            if len(runs) > 1:
                words = f"{run.path.name}, {words}"
            pictures.append(draw(truth, line["goal"], trajectory, words, px_m=PX_M if len(runs) == 1 else SMALL_PX_M))
            _print(console, f"{words} -> {file}")
        write_picture(file, _side_by_side(pictures))
    return int(bool(wanted) and len(missing) == len(wanted))


def _wanted(runs: Sequence[Run], given: Sequence[str]) -> Sequence[str]:
    """Returns the ids of the episodes to draw."""
    common = require_same_episodes(*runs)
    unknown = [i for i in given if i not in common]
    if unknown:
        without = next((run.path for run in runs if unknown[0] not in run.lines), runs[0].path)
        raise ConfigError(f"'{without}' has no episode '{unknown[0]}'.")
    if given:
        return given
    found = [[bool(run.lines[i]["success"]) for run in runs] for i in common]
    drawn = [not any(of) if len(runs) == 1 else any(of) and not all(of) for of in found]
    return [i for i, draws in zip(common, drawn, strict=True) if draws]


def _file(run: Run, episode_id: str) -> Path:
    return trajectory_file(run.path, episode_id)


def _side_by_side(pictures: Sequence[Picture]) -> Picture:
    """Returns pictures next to each other, aligned at their lower edges, with a gap between them."""
    height = max(picture.shape[0] for picture in pictures)
    columns = []
    for picture in pictures:
        gap_px = GAP_PX if columns else 0
        columns.append(np.pad(picture, ((height - picture.shape[0], 0), (gap_px, 0), (0, 0)), constant_values=255))
    return np.hstack(columns)


def _print(console: Console, words: str) -> None:
    console.print(words, highlight=False, markup=False, soft_wrap=True)


def in_words(episode_id: str, goal: str, trajectory: Trajectory) -> str:
    """Returns one line: goal, outcome, and the facts that the rules of `sim.task.failures` use."""
    seen = np.flatnonzero(trajectory.goal_share >= EXPLORED_SHARE)
    facts = [f"{trajectory.num_steps} steps", f"{float(trajectory.moved_m.sum()):.1f} m"]
    facts += [f"{int(trajectory.collided.sum())} collisions"]
    facts += [f"seen from step {seen[0]} in {len(seen)} frames" if len(seen) else "never seen"]
    if np.isfinite(trajectory.distance_m).any():
        nearest = int(np.nanargmin(trajectory.distance_m))
        facts.append(f"nearest {trajectory.distance_m[nearest]:.1f} m at step {nearest}")
    for name, step in (
        ("trapped", first_trapped_step(trajectory.positions_m)),
        ("loop", first_looping_step(trajectory)),
    ):
        facts += [f"{name} from step {step}"] if step is not None else []
    outcome = "found" if trajectory.success else f"{cause_of_failure(trajectory)} ({trajectory.end_reason})"
    return f"{episode_id} {goal}: {outcome}; {', '.join(facts)}"


def draw(truth: GroundTruth, goal: str, trajectory: Trajectory, words: str, *, px_m: float = PX_M) -> Picture:
    """Returns plan and chart with a line of text above, uint8 (h, w, 3); the plan has `px_m` pixels per metre."""
    plan = draw_plan(truth, goal, trajectory, px_m)
    width = max(plan.shape[1], MIN_WIDTH_PX if px_m == PX_M else SMALL_MIN_WIDTH_PX)
    parts = [_heading(words, width), _widened(plan, width), draw_chart(trajectory, width)]
    return np.vstack(parts)


def draw_plan(truth: GroundTruth, goal: str, trajectory: Trajectory, px_m: float = PX_M) -> Picture:
    """Returns the storey of the start from above, x to the right and y up."""
    floor_z_m = float(trajectory.poses[0, 3])
    space, target = truth.space(floor_z_m), truth.target(goal, floor_z_m)
    cells = np.where(space.free[..., None], np.array(FREE), np.array(BLOCKED)).astype(np.uint8)
    cells[target.reached] = SUCCEEDS
    scale = px_m * space.frame.cell_m
    size = (round(cells.shape[1] * scale), round(cells.shape[0] * scale))
    image = np.asarray(cv2.resize(cells, size, interpolation=cv2.INTER_NEAREST)[::-1], np.uint8).copy()

    def pixels(points_m: NDArray[np.floating]) -> NDArray[np.int32]:
        return to_pixels(space.frame, points_m, image.shape[0], px_m)

    for footprint in target.region.footprints:
        for part in footprint.parts:
            cv2.fillConvexPoly(image, pixels(part.vertices_m), INSTANCE, cv2.LINE_AA)
    path = pixels(trajectory.positions_m)
    for i in range(len(path) - 1):
        age = i / max(1, len(path) - 2)
        colour = (round(40 + 190 * age), 70, round(220 - 190 * age))
        cv2.line(image, path[i].tolist(), path[i + 1].tolist(), colour, 2, cv2.LINE_AA)
    for contact in pixels(trajectory.contacts[:, 1:]):
        cv2.circle(image, contact.tolist(), 2, CONTACT, -1, cv2.LINE_AA)
    seen = np.flatnonzero(trajectory.goal_share >= EXPLORED_SHARE)
    if len(seen):
        cv2.circle(image, path[seen[0]].tolist(), 11, SEEN, 3, cv2.LINE_AA)
    cv2.circle(image, path[0].tolist(), 8, INK, 2, cv2.LINE_AA)
    cv2.circle(image, path[-1].tolist(), 6, INK, -1, cv2.LINE_AA)
    return image


def draw_chart(trajectory: Trajectory, width_px: int) -> Picture:
    """Returns a chart of the distance to the goal, from 0 at the bottom, over the steps; yellow: goal in view."""
    image = np.full((CHART_PX, width_px, 3), 245, np.uint8)
    known = np.isfinite(trajectory.distance_m)
    top_m = max(1.0, float(trajectory.distance_m[known].max())) if known.any() else 1.0
    x = np.linspace(0, width_px - 1, trajectory.num_steps + 1).round().astype(int)
    y = np.full(len(x), 20.0)
    y[known] = CHART_PX - 2 - (CHART_PX - 22) * trajectory.distance_m[known] / top_m
    for step in np.flatnonzero(trajectory.goal_share >= EXPLORED_SHARE):
        cv2.line(image, (int(x[step]), CHART_PX), (int(x[step]), 20), SEEN, 1)
    for step in np.flatnonzero(trajectory.collided):
        cv2.line(image, (int(x[step]), CHART_PX), (int(x[step]), CHART_PX - 8), CONTACT, 1)
    for step in np.flatnonzero(known[:-1] & known[1:]):
        begin, end = ((int(x[i]), round(float(y[i]))) for i in (step, step + 1))
        cv2.line(image, begin, end, (40, 70, 200), 2, cv2.LINE_AA)
    words = f"{top_m:.1f} m to go at the top" if known.any() else "no path to the goal"
    _write(image, f"{words}; {trajectory.num_steps} steps; collisions as ticks", 14)
    return image


def to_pixels(
    frame: GridFrame, points_m: NDArray[np.floating], height_px: int, px_m: float = PX_M
) -> NDArray[np.int32]:
    """Returns (n, 2) column and row in the picture of points (n, 2) in the world."""
    right_px, up_px = px_m * (np.asarray(points_m, np.float64) - np.asarray(frame.origin_xy_m)).T
    return np.stack([right_px, height_px - up_px], axis=1).round().astype(np.int32)


def _heading(words: str, width_px: int) -> Picture:
    lines = _wrapped(words.split(" "), width_px // 8)
    image = np.full((18 * len(lines) + 8, width_px, 3), 255, np.uint8)
    for i, line in enumerate(lines):
        _write(image, line, 16 + 18 * i)
    return image


def _wrapped(words: Sequence[str], most: int) -> list[str]:
    lines = [""]
    for word in words:
        if lines[-1] and len(lines[-1]) + len(word) >= most:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return lines


def _widened(image: Picture, width_px: int) -> Picture:
    spare = width_px - image.shape[1]
    return np.pad(image, ((0, 0), (0, spare), (0, 0)), constant_values=255)


def _write(image: Picture, words: str, row: int) -> None:
    cv2.putText(image, words, (6, row), cv2.FONT_HERSHEY_SIMPLEX, 0.42, INK, 1, cv2.LINE_AA)


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
