"""Replays the actions of a submission in physics, without its agent, and judges the result of each episode.

    stubborn verify my_agent.json.gz --workers 4

Success, SPL, distances, collisions and the length of the path are recomputed for every episode; for one episode in ten,
drawn at random, the true frames are rendered too, for the first sight of the goal and the area seen. An episode is

- equal: every number is that of the replay;
- within tolerance: lengths differ by at most --tolerance-m, because another kind of processor or library rounds
  differently and contacts amplify it;
- different: the result does not come from these actions in this house with this robot.

A replay proves what the actions achieve. It does not prove how the agent chose them: its observations are declared.
Episodes whose actions are the oracle's, or whose path is hardly longer than the shortest one, are counted.
Exit status: 0 if no episode is different, 1 if one is, 2 if the file is refused.
"""

from __future__ import annotations

import json
import secrets
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Annotated

import tyro

from sim.app import cli
from sim.app.analysis.metrics import SPL, SUCCESS, mean_cell
from sim.app.composition.agents import SPECS
from sim.app.submissions.audit import FRAMES, AuditOptions, Checked, check, counts, verdicts
from sim.app.submissions.checks import PLACES, isolation_text, truth_of
from sim.app.submissions.leaderboard import results_of
from sim.app.submissions.report import report_of
from sim.app.submissions.verdicts import TOLERANCE_M, Verdict
from sim.core.errors import ConfigError
from sim.core.files import write_atomically
from sim.core.paths import processor
from sim.core.reading import printable
from sim.core.vocabulary import counted

MAX_TOLERANCE_M = 0.1
"""With more, a replay would prove nothing about lengths."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Replay the actions in a submission, and check its results."""

    file: Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="FILE")]
    """The submission, written by `stubborn submit`."""
    split: Path | None = None
    """Folder of its split; by default the shipped split of the same name."""
    frames: cli.Share = FRAMES
    """Share of the episodes whose true frames are rendered."""
    draw_seed: cli.Seed | None = None
    """Draws these episodes; by default a new number, which is printed."""
    tolerance_m: cli.Positive = TOLERANCE_M
    """Largest difference of lengths in metres, for files from another kind of processor."""
    workers: cli.Count = 1
    """Number of processes."""
    nonstandard: bool = False
    """Replay also a run with another robot, camera, task or noise than the standard ones."""
    report: cli.OutFile | None = None
    """JSON file for the outcome."""


def main(args: Args) -> int:
    """Verifies the file, prints every episode and a summary; returns the exit status."""
    if args.tolerance_m > MAX_TOLERANCE_M:
        raise ConfigError(f"--tolerance-m must be at most {MAX_TOLERANCE_M:g} m, got {args.tolerance_m:g} m.")
    options = AuditOptions(
        split=args.split,
        frames=args.frames,
        draw_seed=secrets.randbits(32) if args.draw_seed is None else args.draw_seed,
        tolerance_m=args.tolerance_m,
        workers=args.workers,
        nonstandard=args.nonstandard,
    )
    report = audit(args.file, options)
    if args.report is not None:
        write_atomically(args.report, json.dumps(report, indent=2) + "\n")
    return int(report["different"] != 0)


def audit(file: Path, options: AuditOptions) -> Mapping[str, object]:
    """Verifies a submission, prints the outcome, and returns it as JSON (`sim.app.submissions.report`)."""
    checked = check(file, options, truth_of_agents())
    for line in _head(checked):
        print(printable(line), flush=True)
    outcome: list[Verdict] = []
    seconds, total = 0.0, len(checked.submission.episodes)
    for verdict, took_s in verdicts(checked, options):
        outcome.append(verdict)
        print(printable(f"[{len(outcome)}/{total}] {_line(verdict)}"), flush=True)
        seconds += took_s
    for line in _summary(checked, options, outcome, seconds):
        print(printable(line))
    return report_of(checked, options, outcome, seconds)


def truth_of_agents() -> Mapping[str, bool]:
    """Returns whether each agent that ships uses ground truth."""
    return {name: spec.uses_ground_truth for name, spec in SPECS.items()}


def _head(checked: Checked) -> Iterator[str]:
    manifest = checked.submission.manifest
    split = manifest.split
    yield (
        f"'{manifest.name}' by {', '.join(manifest.authors) or 'authors not named'}: {checked.covers} of {split.name} "
        f"{split.version} ({split.sha256[:12]}), seed {manifest.seed}, physics {manifest.physics}."
    )
    here = {"processor": processor(), **{name: version(name) for name in ("mujoco", "numpy")}}
    for name, value in here.items():
        if manifest.versions.get(name) != value:
            yield f"Made with {name} {manifest.versions.get(name)}, replayed with {value}: lengths may differ a little."
    for change in checked.changes:
        yield f"Not the standard: {change}."


def _line(verdict: Verdict) -> str:
    frames = " (with frames)" if verdict.framed else ""
    return f"{verdict.episode_id}: {verdict.judgement}{frames}{': ' + verdict.text if verdict.text else ''}."


def _summary(checked: Checked, options: AuditOptions, outcome: list[Verdict], seconds: float) -> Iterator[str]:
    """Yields the lines after the episodes."""
    count, inputs = counts(outcome), checked.submission.manifest.inputs
    framed = sum(verdict.framed for verdict in outcome)
    by_judgement = ", ".join(
        f"{count[name]} {name}" for name in ("equal", "within tolerance", "different", "error") if count[name]
    )
    yield (
        f"{counted(len(outcome), 'episode')}: {by_judgement}. Frames of {framed} were rendered (--draw-seed "
        f"{options.draw_seed}). {_speed(len(outcome) - count['error'], seconds)}"
    )
    results = results_of(checked.submission)
    yield f"Success {mean_cell(SUCCESS, results).text()} %, SPL {mean_cell(SPL, results).text()} (95 % intervals)."
    if count["different"]:
        yield (
            f"NOT VERIFIED: {counted(count['different'], 'episode')} differed in the replay. A tolerance repairs "
            "neither success nor collisions; ask the authors to run the different episodes again."
        )
    elif count["error"] == len(outcome):
        yield "Nothing was verified: all episodes ended with an error."
    else:
        rest = (
            f" {counted(count['error'], 'episode')} ended with an error and left no actions." if count["error"] else ""
        )
        yield f"Verified: these actions lead to these results.{rest}"
    yield _known_paths(checked, outcome)
    yield (
        f"Declared by the authors; a replay cannot prove it: agent '{inputs.agent}' "
        f"{PLACES[isolation_text(inputs)]}; segmentation {checked.segmentation}; ground truth {truth_of(inputs)}; "
        f"sensors {', '.join(inputs.sensors) or 'none'}"
        f"{'; the seed, which has no effect on physics without noise' if inputs.noise == 'none' else ''}."
    )


def _known_paths(checked: Checked, outcome: list[Verdict]) -> str:
    """Returns the sentences on actions that repeat a known path, and on what the split says about them."""
    oracle, shortest = (sum(verdict.known_path == kind for verdict in outcome) for kind in ("oracle", "shortest"))
    found = (
        f"Known paths: in {oracle} of {len(outcome)} episodes every action is the oracle's, and {shortest} more reach "
        "the goal on a path at most 5 % longer than the shortest one."
    )
    if checked.origin == "public":
        found += (
            " The split is public: a replay cannot tell an agent that searches from one that repeats stored actions."
        )
    return found


def _speed(episodes: int, seconds: float) -> str:
    return f"{3600.0 * episodes / seconds:,.0f} episodes an hour a core." if seconds > 0.0 else "Nothing was replayed."
