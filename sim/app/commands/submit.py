"""Packs a recorded run into one file, with which anybody can check its results (`stubborn verify`).

    stubborn run --agent process:"python my_agent.py" --split val --episodes 200 --record --out runs/mine
    stubborn submit runs/mine --name "My agent" --authors "A. Author" --out my_agent.json.gz

The file holds the configuration and the versions of the run, the result line and the actions of each episode, and the
values of the options. It holds no code, no weights and no images.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from sim.app import cli
from sim.app.analysis.comparison import read_run
from sim.app.evaluation.results import segmentation_of
from sim.app.submissions.checks import PLACES, isolation_text, truth_of
from sim.app.submissions.contents import SUFFIX, write_submission
from sim.app.submissions.leaderboard import MIN_EPISODES
from sim.app.submissions.packing import About, pack
from sim.core.errors import ConfigError
from sim.core.invocation import command
from sim.core.vocabulary import counted


@dataclass(frozen=True, kw_only=True)
class Args:
    """Pack a recorded run into a submission."""

    run: Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="RUN")]
    """Folder of a run that was made with --record."""
    name: str
    """Name of the row in a table: the method."""
    authors: tuple[str, ...]
    """Names of the authors."""
    description: str = ""
    """Describes the method of the agent and its training data, in one line of at most 2,000 characters."""
    links: tuple[str, ...] = ()
    """Addresses (https://...) of a paper or of code."""
    out: cli.OutFile | None = None
    """The file, NAME.json.gz; by default next to the run, with its name."""


def main(args: Args) -> int:
    """Writes the submission and prints what it declares; returns the exit status."""
    out = args.out or args.run.resolve().with_name(args.run.resolve().name + SUFFIX)
    if not out.name.endswith(SUFFIX):
        raise ConfigError(f"--out '{out}' must end with {SUFFIX}.")
    about = About(name=args.name, authors=args.authors, description=args.description, links=args.links)
    submission = pack(read_run(args.run), about)
    size = write_submission(out, submission)
    inputs, count = submission.manifest.inputs, len(submission.episodes)
    isolated = PLACES[isolation_text(inputs)]
    print(f"{out}: {counted(count, 'episode')} of {submission.manifest.split.name}, {size / 1000:.0f} KB.")
    segmentation = segmentation_of(submission.config_tree(where=str(out)))
    print(
        f"Declared: agent '{inputs.agent}' {isolated}; segmentation {segmentation}; ground truth {truth_of(inputs)}; "
        f"noise {inputs.noise}."
    )
    if count < MIN_EPISODES:
        print(f"A leaderboard shows submissions of {MIN_EPISODES} episodes and more.")
    print(f"Check it: {command('verify', out)}")
    return 0
