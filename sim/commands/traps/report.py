"""Reports which agent escapes from which trap: a table (terminal, Markdown, CSV) and pictures of the paths.

    stubborn traps report --out runs/traps

Each agent runs every trap from the start headings of the split. An interrupted run is resumed. A picture shows the trap
from above with the robot's true path (blue) and the contacts that stopped it (red), and the agent's map at the end.
"""

from __future__ import annotations

import csv
import io
import json
import os
from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from rich.table import Table

from sim import cli
from sim.analysis import display
from sim.commands.traps.picture import draw_trial
from sim.commands.traps.trial import Trial, run_trial
from sim.composition.agents import build_agent, find_agent
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.splits import Episode
from sim.files import open_to_grow, write_together
from sim.files import write_picture as save_picture
from sim.interface import Agent, ConfigError
from sim.reading import Count as ReadCount
from sim.reading import Name, Number, read_lines
from stubborn.agent import StubbornAgent
from stubborn.detection.verification import AcceptAll
from stubborn.drawing import map_painter
from stubborn.segmentation.ground_truth import GroundTruthSegmenter

DEFAULT_AGENTS = ("oracle", "stubborn-i", "stubborn-ii", "stubborn-iii", "stubborn-iv", "stubborn-v")
COLUMNS: tuple[str, ...] = (
    "trap", "episode_id", "agent", "escaped", "steps", "steps_in_trap", "collisions", "trapped", "spl",
    "forward_mean_m", "deepest_mm",
)  # fmt: skip
"""Columns of the CSV, which has one row for each episode."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Report which agent escapes from which trap: a table, and pictures of the paths."""

    out: cli.OutFolder
    """Folder for results.jsonl, traps.csv, traps.md and pictures/."""
    split: str = "traps"
    """The traps: a shipped split, or a folder of yours with episodes (`stubborn episodes --recipe traps`)."""
    agents: tuple[str, ...] = DEFAULT_AGENTS
    """Agents of `stubborn run`, also your own as package.module:NAME."""
    traps: tuple[str, ...] = ()
    """Names of traps; all if not given."""
    headings: cli.Count = 3
    """Number of start headings of each trap."""
    max_steps: cli.Count = 500
    """Largest number of actions of an episode."""
    pictures: cli.OnUnlessNo = True
    """Do not draw paths; by default, the path of the first heading of each trap is drawn, and that of every episode in
    which the agent did not escape."""


def main(args: Args) -> int:
    """Runs the missing episodes, then writes the table."""
    console = display.make_console()
    results = args.out / "results.jsonl"
    found = read_lines(results, Row, what="Results")
    if found.torn:
        console.print(found.torn, markup=False)
        os.truncate(results, found.whole_bytes)
    rows = found.values
    for name in args.agents:
        done = {row["episode_id"] for row in rows if row["agent"] == name}
        for trial in run_trials(args, name, done):
            rows.append(row_of(trial))
            results.parent.mkdir(parents=True, exist_ok=True)
            with open_to_grow(results, "a") as file:
                file.write(json.dumps(rows[-1]) + "\n")
            outcome = "escaped" if trial.escaped else "stuck"
            console.print(f"{name} {trial.episode_id}: {outcome} after {len(trial.motions)} steps")
    write_together({args.out / "traps.csv": as_csv(rows), args.out / "traps.md": as_markdown(rows)})
    console.print(as_table(rows))
    return 0


class Row(msgspec.Struct):
    """A line of results.jsonl."""

    trap: Name
    episode_id: Name
    agent: Name
    escaped: bool
    steps: ReadCount
    steps_in_trap: ReadCount
    collisions: ReadCount
    trapped: bool
    spl: Number
    forward_mean_m: Number | None
    deepest_mm: Number


def run_trials(args: Args, name: str, done: Set[str]) -> Iterator[Trial]:
    """Runs an agent in the episodes that are not done, and draws the pictures."""
    spec = find_agent(name)
    truth = ("semantic",) if spec.uses_segmentation else ()
    sensors = tuple(dict.fromkeys((*spec.sensors, *truth)))
    env = ObjectNavEnv(split=args.split, sensors=sensors, max_steps=args.max_steps)
    try:
        agent = make_agent(name, env)
        episodes = wanted(env, args)
        firsts = {each.house: each.episode_id for each in reversed(episodes)}
        for episode in episodes:
            if episode.episode_id in done:
                continue
            trial = run_trial(env, agent, name, episode)
            if args.pictures and (firsts[episode.house] == episode.episode_id or not trial.escaped):
                write_picture(args.out / "pictures", env, agent, trial)
            yield trial
    finally:
        env.close()


def write_picture(folder: Path, env: ObjectNavEnv, agent: Agent, trial: Trial) -> None:
    """Writes the picture of a trial."""
    belief = map_painter.draw_map(agent, whole=True) if isinstance(agent, StubbornAgent) else None
    path = folder / f"{trial.episode_id}_{trial.agent}.png"
    save_picture(path, draw_trial(env, trial, belief))


def make_agent(name: str, env: ObjectNavEnv) -> Agent:
    """Returns the agent of a name, with ground-truth segmentation.

    Raises:
        ConfigError: there is no such agent.
    """
    spec = find_agent(name)
    return build_agent(name, spec, env, segmenter=GroundTruthSegmenter(), verifier=AcceptAll(), config=spec.config)


def wanted(env: ObjectNavEnv, args: Args) -> list[Episode]:
    """Returns the episodes to run, trap by trap.

    Raises:
        ConfigError: a name of a trap is unknown.
    """
    unknown = sorted(set(args.traps) - set(env.split.houses))
    if unknown:
        raise ConfigError(f"No trap '{unknown[0]}'. Available: {', '.join(env.split.houses)}.")
    of_trap: dict[str, list[Episode]] = {}
    for episode in env.split.episodes:
        if not args.traps or episode.house in args.traps:
            of_trap.setdefault(episode.house, []).append(episode)
    return [episode for episodes in of_trap.values() for episode in episodes[: args.headings]]


def row_of(trial: Trial) -> dict[str, Any]:
    """Returns one episode as a row of the CSV."""
    forwards_m = trial.forwards_m
    return {
        "trap": trial.trap,
        "episode_id": trial.episode_id,
        "agent": trial.agent,
        "escaped": trial.escaped,
        "steps": len(trial.motions),
        "steps_in_trap": trial.steps_in_trap,
        "collisions": int(trial.metrics["collisions"]),
        "trapped": bool(trial.metrics["trapped"]),
        "spl": round(float(trial.metrics["spl"]), 3),
        "forward_mean_m": round(float(np.mean(forwards_m)), 4) if forwards_m else None,
        "deepest_mm": round(1000 * trial.deepest_m, 2),
    }


def as_csv(rows: Sequence[dict[str, Any]]) -> str:
    """Returns all rows as CSV text."""
    stream = io.StringIO()
    writer = csv.DictWriter(stream, COLUMNS)
    writer.writeheader()
    writer.writerows(rows)
    return stream.getvalue()


def grid(rows: Sequence[dict[str, Any]]) -> tuple[list[str], list[list[str]]]:
    """Returns header and lines of the table: a line for each trap, then the totals; a column for each agent."""
    names = sorted({row["agent"] for row in rows})
    traps = list(dict.fromkeys(row["trap"] for row in rows))
    lines = []
    for trap in traps:
        cells = [[row for row in rows if (row["trap"], row["agent"]) == (trap, name)] for name in names]
        lines.append([trap, *(_cell(cell) for cell in cells)])
    every = [[row for row in rows if row["agent"] == name] for name in names]
    lines.append(["**success**", *(f"**{sum(r['escaped'] for r in of)}/{len(of)}**" for of in every)])
    for label, key in (("steps in the trap, median", "steps_in_trap"), ("collisions, median", "collisions")):
        lines.append([label, *(f"{np.median([row[key] for row in of]):.0f}" for of in every)])
    lines.append(["metres per forward, mean", *(f"{_forward_m(of):.2f}" for of in every)])
    lines.append(["deepest contact, mm", *(f"{max(row['deepest_mm'] for row in of):.1f}" for of in every)])
    return ["trap", *names], lines


def as_markdown(rows: Sequence[dict[str, Any]]) -> str:
    """Returns the table for docs/traps.md."""
    header, lines = grid(rows)
    rule = ["---", *("---:" for _ in header[1:])]
    return "".join("| " + " | ".join(line) + " |\n" for line in (header, rule, *lines))


def as_table(rows: Sequence[dict[str, Any]]) -> Table:
    """Returns the table for the terminal."""
    header, lines = grid(rows)
    table = Table(title="successes (steps in the trap, collisions: medians)")
    table.add_column(header[0])
    for name in header[1:]:
        table.add_column(name, justify="right")
    for line in lines:
        table.add_row(*(cell.strip("*") for cell in line))
    return table


def _cell(rows: Sequence[dict[str, Any]]) -> str:
    """Returns successes out of episodes, with medians of steps in the trap and of collisions."""
    if not rows:
        return "-"
    steps = np.median([row["steps_in_trap"] for row in rows])
    collisions = np.median([row["collisions"] for row in rows])
    return f"{sum(row['escaped'] for row in rows)}/{len(rows)} ({steps:.0f}, {collisions:.0f})"


def _forward_m(rows: Sequence[dict[str, Any]]) -> float:
    """Returns the mean displacement of a forward action."""
    moved = [row["forward_mean_m"] for row in rows if row["forward_mean_m"] is not None]
    return float(np.mean(moved)) if moved else 0.0
