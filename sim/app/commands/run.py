"""Run episodes: `stubborn run`, or `stubborn run --agent oracle --episodes 100 --workers 2`."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from rich.table import Table

from sim.app import cli
from sim.app.analysis import display
from sim.app.composition.agents import SPECS
from sim.app.options import RunOptions
from sim.core.invocation import RUN_STOPPED
from sim.core.vocabulary import counted
from sim.task.result import EpisodeResult
from stubborn.agents import EXPLORERS

Args = RunOptions
"""The options of this command, under the name that every command has."""


def main(options: RunOptions) -> int:
    """Runs the episodes that the options ask for; returns the exit status."""
    console = display.make_console()
    if options.list_agents:
        console.print(agent_table())
        return 0
    from sim.app.composition.environments import episodes_of  # these import MuJoCo, which a list does not need
    from sim.app.composition.running import run_missing
    from sim.app.composition.setup import resolve

    setup = resolve(options)
    if options.house is None and options.split == "test":
        print("The split test is for a last measurement: do not base choices on its results.", file=sys.stderr)
    episodes, split, notes = episodes_of(setup)
    for note in notes:
        console.print(f"House '{split['name']}': {note}", soft_wrap=True)
    out = options.out or Path("runs") / time.strftime("%Y-%m-%d_%H-%M-%S")
    count = len(episodes)
    if (shard := setup.shard) is not None:
        shard.require_own_numbers(out)
        episodes, out = shard.select(episodes), out / shard.folder
        if not episodes:
            console.print(f"Shard {options.shard} holds none of the {counted(count, 'episode')}.")
            return 0
    setup = replace(setup, options=replace(options, episodes=count, out=out))
    results, summary = run_missing(setup, episodes, split, console)
    display.print_results(console, results, summary)
    failed = first_failure(results) if options.house is None else None
    display.print_where_to_look(console, out, video=options.video, failed=failed, sharded=options.shard is not None)
    return 1 if summary["errors"] else 0


def first_failure(results: Iterable[EpisodeResult]) -> str | None:
    """Returns the ID of the first episode that failed without an error; None: there is none."""
    return next((result.episode_id for result in results if not result.success and not result.is_error), None)


def agent_table() -> Table:
    """Returns the table that `--list-agents` prints: agents with their descriptions, and the explorers."""
    table = Table("agent", "description", box=None)
    for name, spec in SPECS.items():
        table.add_row(name, spec.description)
    table.add_section()
    table.add_row("--explorer", "for agents that take one: " + ", ".join(EXPLORERS))
    return table


def entry(argv: Sequence[str] | None = None) -> int:
    """Runs the command line; returns its exit status."""
    status = cli.run(RunOptions, main, argv, stopped=RUN_STOPPED)
    return status if argv is not None else cli.leave_soon(status)
