"""Reports which agent escapes from which trap: a table (terminal, Markdown, CSV) and pictures of the paths.

    stubborn traps report --out runs/traps

    stubborn traps report --split contact-val --agents oracle stubborn --out runs/contact

Each agent runs every trap from the start headings of the split. The same command continues an interrupted run, with the
same split and --max-steps only (`config.json`). A picture shows the plan of the trap with the robot's true path (blue)
and the contacts that stopped it (red), and the agent's map at the end.
Traps of families also get curves with intervals and a picture of each family (`sim.app.commands.traps.family_report`).
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from msgspec.structs import asdict

from sim.app import cli
from sim.app.analysis import display
from sim.app.analysis.tables import Cell, ResultTable, to_markdown, to_rich
from sim.app.commands.traps.family_report import facts_of, family_table, write_family_report
from sim.app.commands.traps.picture import draw_trial
from sim.app.commands.traps.trial import TrapResult, Trial, run_trial
from sim.app.composition.agents import build_agent, find_agent, free_agent
from sim.app.composition.record import code_of
from sim.app.evaluation.config_fields import differing_fields, field_text
from sim.app.options import RunOptions
from sim.core.files import csv_text, file_name, open_to_grow, write_atomically, write_together
from sim.core.files import write_picture as save_picture
from sim.core.interface import Agent, ConfigError
from sim.core.reading import convert, read_json, read_lines
from sim.core.vocabulary import counted
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.episodes.splits import Split, load_split
from sim.robot.config import PHYSICS_VERSION
from sim.training.figures import require_packages
from stubborn.agent import StubbornAgent
from stubborn.detection.verification import AcceptAll
from stubborn.drawing import map_painter
from stubborn.segmentation.ground_truth import GroundTruthSegmenter

DEFAULT_AGENTS = ("oracle", "stubborn-i", "stubborn-ii", "stubborn-iii", "stubborn-iv", "stubborn-v")


@dataclass(frozen=True, kw_only=True)
class Args:
    """Report which agent escapes from which trap: a table, and pictures of the paths."""

    out: cli.OutFolder
    """Folder for config.json, results.jsonl, traps.csv, traps.md and pictures/; for traps of families also tables and
    curves."""
    split: str = "traps"
    """The traps: a shipped split, or a folder of yours with episodes (`stubborn episodes --recipe traps`)."""
    agents: tuple[str, ...] = DEFAULT_AGENTS
    """Agents of `stubborn run`, also your own as package.module:NAME."""
    traps: tuple[str, ...] = ()
    """Names of scenes; all if not given. A wrong name lists them."""
    headings: cli.Count = 3
    """Number of start headings of each trap."""
    max_steps: cli.Count = 500
    """Largest number of actions of an episode."""
    pictures: cli.OnUnlessNo = True
    """Do not draw paths and families; by default, the path of every episode in which the agent did not escape is drawn,
    and for traps of no family that of the first heading."""


def main(args: Args) -> int:
    """Runs the missing episodes, then writes the table."""
    console = display.make_console()
    split = load_split(args.split)
    episodes, facts = selected_episodes(split, args), facts_of(split)
    if facts:
        require_packages("matplotlib")
    for name in args.agents:
        find_agent(name)  # a wrong name is refused before anything is written
    write_or_compare_config(args, split)
    results = args.out / "results.jsonl"
    lines = read_lines(results, TrapResult, what="Results")
    if lines.torn:
        console.print(lines.torn)
        os.truncate(results, lines.whole_bytes)
    ids = {episode.episode_id for episode in episodes}
    rows = [row for row in lines.values if row.episode_id in ids]
    for name in args.agents:
        done = {row.episode_id for row in rows if row.agent == name}
        for trial in run_trials(args, name, episodes, done):
            rows.append(trial.result())
            with open_to_grow(results, "a") as file:
                file.write(json.dumps(asdict(rows[-1])) + "\n")
            outcome = "escaped" if trial.escaped else "stuck"
            console.print(f"{name} {trial.episode_id}: {outcome} after {counted(len(trial.motions), 'step')}")
    table = table_of(rows)
    write_together({args.out / "traps.csv": as_csv(rows), args.out / "traps.md": to_markdown([table])})
    write_family_report(args.out, rows, args.split, facts, pictures=args.pictures)
    console.print(to_rich(family_table([row for row in rows if row.trap in facts], facts) if facts else table))
    return 0


def write_or_compare_config(args: Args, split: Split) -> None:
    """Writes `config.json`, or compares it where there are results.

    Raises:
        ConfigError: the results are of another split, version of the physics, --max-steps or code of a user's agent.
    """
    file = args.out / "config.json"
    own = {name: code_of(RunOptions(agent=name)).partition("+")[2] for name in args.agents}
    own_code = {name: code for name, code in own.items() if code}
    same = {"split_identity": split.identity, "physics": PHYSICS_VERSION, "max_steps": args.max_steps}
    if (args.out / "results.jsonl").exists():
        before = read_json(file, dict[str, object], what="Config") if file.exists() else {}
        known = convert(before.get("own_code", {}), dict[str, str], where=f"Config '{file}', field 'own_code'")
        of_known = {name: own_code.get(name, code) for name, code in known.items()}
        for path, was, now in differing_fields({**before, "own_code": known}, {**same, "own_code": of_known}):
            raise ConfigError(
                f"--out '{args.out}' holds results with {path} = {field_text(was)}, this command has "
                f"{field_text(now)}; choose another folder."
            )
        own_code = known | own_code
    write_atomically(file, json.dumps({**same, "own_code": own_code}, indent=2) + "\n")


def run_trials(args: Args, name: str, episodes: Sequence[Episode], done: Set[str]) -> Iterator[Trial]:
    """Runs an agent in the episodes that are not done, and draws the pictures."""
    spec = find_agent(name)
    truth = ("semantic",) if spec.uses_segmentation else ()
    sensors = tuple(dict.fromkeys((*spec.sensors, *truth)))
    env = ObjectNavEnv(split=args.split, sensors=sensors, look=spec.looks, max_steps=args.max_steps)
    agent = None
    try:
        agent = make_agent(name, env)
        others = [episode for episode in reversed(episodes) if env.split.sidecar(episode.house).trap is None]
        first_of_others = {episode.house: episode.episode_id for episode in others}
        for episode in episodes:
            if episode.episode_id in done:
                continue
            trial = run_trial(env, agent, name, episode)
            if args.pictures and (first_of_others.get(episode.house) == episode.episode_id or not trial.escaped):
                write_picture(args.out / "pictures", env, agent, trial)
            yield trial
    finally:
        free_agent(agent)
        env.close()


def write_picture(folder: Path, env: ObjectNavEnv, agent: Agent, trial: Trial) -> None:
    """Writes the picture of a trial."""
    belief = map_painter.draw_map(agent) if isinstance(agent, StubbornAgent) else None
    path = folder / f"{trial.episode_id}_{file_name(trial.agent)}.png"
    save_picture(path, draw_trial(env, trial, belief))


def make_agent(name: str, env: ObjectNavEnv) -> Agent:
    """Returns the agent of a name, with ground-truth segmentation.

    Raises:
        ConfigError: there is no such agent.
    """
    spec = find_agent(name)
    return build_agent(name, spec, env, segmenter=GroundTruthSegmenter(), verifier=AcceptAll(), config=spec.config)


def selected_episodes(split: Split, args: Args) -> list[Episode]:
    """Returns the episodes to run, trap by trap.

    Raises:
        ConfigError: a name of a trap is unknown.
    """
    unknown = sorted(set(args.traps) - set(split.houses))
    if unknown:
        raise ConfigError(f"No trap '{unknown[0]}'. Available: {', '.join(split.houses)}.")
    of_trap: dict[str, list[Episode]] = {}
    for episode in split.episodes:
        if not args.traps or episode.house in args.traps:
            of_trap.setdefault(episode.house, []).append(episode)
    return [episode for episodes in of_trap.values() for episode in episodes[: args.headings]]


def table_of(rows: Sequence[TrapResult]) -> ResultTable:
    """Returns the table: a line for each trap, then the totals; a column for each agent."""
    names = sorted({row.agent for row in rows})
    lines: list[tuple[str, list[Cell | str]]] = []
    for trap in dict.fromkeys(row.trap for row in rows):
        cells = [[row for row in rows if (row.trap, row.agent) == (trap, name)] for name in names]
        lines.append((trap, [_cell(cell) for cell in cells]))
    every = [[row for row in rows if row.agent == name] for name in names]
    lines.append(("success", [f"{sum(r.escaped for r in of)}/{len(of)}" for of in every]))
    for label, key in (("steps in the trap, median", "steps_in_trap"), ("collisions, median", "collisions")):
        lines.append((label, [f"{np.median([getattr(row, key) for row in of]):.0f}" for of in every]))
    lines.append(("metres per forward, mean", [f"{_forward_m(of):.2f}" for of in every]))
    lines.append(("deepest contact, mm", [f"{max(row.deepest_mm for row in of):.1f}" for of in every]))
    return ResultTable("traps", "successes (steps in the trap, collisions: medians)", ("trap", *names), lines)


def as_csv(rows: Sequence[TrapResult]) -> str:
    """Returns all rows as CSV text."""
    names = TrapResult.__struct_fields__
    return csv_text(names, (asdict(row).values() for row in rows), end="\r\n")


def _cell(rows: Sequence[TrapResult]) -> str:
    """Returns successes out of episodes, with medians of steps in the trap and of collisions."""
    if not rows:
        return "-"
    steps = np.median([row.steps_in_trap for row in rows])
    collisions = np.median([row.collisions for row in rows])
    return f"{sum(row.escaped for row in rows)}/{len(rows)} ({steps:.0f}, {collisions:.0f})"


def _forward_m(rows: Sequence[TrapResult]) -> float:
    """Returns the mean displacement of a forward action."""
    moved = [row.forward_mean_m for row in rows if row.forward_mean_m is not None]
    return float(np.mean(moved)) if moved else 0.0
