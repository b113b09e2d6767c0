"""Facts about a run at the top of a page: options, versions, the command, and what its folder lacks."""

from __future__ import annotations

import contextlib
import shlex
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

from sim.app.analysis.comparison import Run
from sim.app.analysis.report.drawings import Trajectories
from sim.app.analysis.report.media import picture_of, video_of
from sim.app.evaluation.parallel import Shard
from sim.app.evaluation.results import RunRecord, can_be_repeated, segmentation_of
from sim.app.options import RunOptions
from sim.core.configuration import assignments_of
from sim.core.errors import ConfigError
from sim.core.option_types import meanings

_NAMED = ("agent", "semantics", "split", "episodes")
"""Options that the command of a run names although they have their default."""
_LEFT_OUT = ("executor", "address", "out", "view", "rerun")
"""Recorded options that the command of a run does not name: they are of the machine, or show a running episode."""


@dataclass(frozen=True)
class RunFacts:
    """Facts about a run at the top of the page."""

    label: str
    """`A`, `B` and so on; "" for a single run."""
    name: str
    facts: Sequence[tuple[str, object]]
    command: str
    """"": `stubborn run` cannot repeat the run, which a person or nodes of ROS 2 drove."""
    notes: Sequence[str]
    hint: str
    """A sentence about what the run lacks, and how to get it; "" if it lacks nothing."""


def facts_of(run: Run, label: str, trajectories: Trajectories, index: int) -> RunFacts:
    """Returns the facts about a run, which is number `index` of the runs of the trajectories."""
    config = run.config
    split, versions = config.get("split_identity") or {}, config.get("versions", {})
    codes = config.get("codes") or [versions.get("code", "unknown")]
    facts = [
        ("folder", run.path),
        ("agent", config.get("agent")),
        ("explorer", config.get("explorer")),
        ("segmentation", segmentation_of(config)),
        ("houses", f"{split.get('name')} {split.get('version')} ({str(split.get('sha256'))[:8]})"),
        ("noise", config.get("noise")),
        ("profile", config.get("profile")),
        ("seed", config.get("seed")),
        ("code", " or ".join(map(str, codes))),
        ("renderer", versions.get("gl_renderer")),
    ]
    shown = [(name, value) for name, value in facts if value is not None]
    return RunFacts(
        label,
        run.path.resolve().name,
        shown,
        command_of(config) if can_be_repeated(config) else "",
        list(_notes(run, trajectories, index)),
        _hint(run, trajectories, index),
    )


def command_of(config: RunRecord) -> str:
    """Returns the command of a run without `--out`."""
    words, options = ["stubborn", "run"], cast(Mapping[str, Any], config)
    absent = {"split"} if options.get("house") else {"episodes"} if options.get("only") else set[str]()
    for name, option in meanings(RunOptions).items():
        value = options.get(name)
        is_default = name not in _NAMED and value == getattr(RunOptions, name)
        if is_default or value in (None, [], False) or not option.recorded or name in absent.union(_LEFT_OUT):
            continue
        if name == "episodes":  # config.json counts each replicate
            value //= options.get("replicates") or 1
        values = [] if value is True else value if isinstance(value, list) else [value]
        words += [f"--{name.replace('_', '-')}", *map(str, values)]
    if settings := options.get("settings"):
        words += ["--config", *assignments_of(settings)]
    return shlex.join(words)


def _notes(run: Run, trajectories: Trajectories, index: int) -> Iterable[str]:
    """Yields sentences about what is missing in a run."""
    planned, count, out = run.config.get("episodes"), len(run.results), run.path
    if isinstance(planned, int):
        if shard := run.config.get("shard"):
            with contextlib.suppress(ConfigError):  # a shard of version 0.1 was numbered from 0
                planned, out = len(Shard.parse(str(shard)).select(range(planned))), run.path.parent
        if count < planned:
            rest = f" The command with --out {out} runs the rest." if can_be_repeated(run.config) else ""
            yield f"Not finished: {count} of {planned} episodes have ended.{rest}"
    errors = sum(result.is_error for result in run.results.values())
    if errors:
        yield f"{errors} of {count} episodes ended with an error; they count as failures and are listed below."
    falls = sum(result.end_reason == "fallen" for result in run.results.values())
    if falls:
        yield f"In {falls} of {count} episodes the robot drove over an edge and fell."
    if len(run.config.get("codes") or []) > 1:
        yield "The episodes were run by more than one version of the code."
    for name, option, count, of in _missing(run, trajectories, index):
        if 0 < count < of:
            yield f"{count} of {of} episodes have no {name} (they were run without {option})."


def _hint(run: Run, trajectories: Trajectories, index: int) -> str:
    """Returns a sentence about what no episode of the run has, and how to get it; "" if there is nothing."""
    absent = [(name, option) for name, option, count, of in _missing(run, trajectories, index) if count == of > 0]
    if not absent or not can_be_repeated(run.config):
        return ""
    names, options = (
        " and no ".join(name for name, _ in absent),
        " and ".join(dict.fromkeys(option for _, option in absent)),
    )
    return f"There are no {names}. The command above with {options} and another --out runs the same episodes with them."


def _missing(run: Run, trajectories: Trajectories, index: int) -> list[tuple[str, str, int, int]]:
    """Returns for each kind of file its name, its option, and how many episodes lack it, among how many."""
    ended = [i for i in trajectories if not run.results[i].is_error]
    kinds = (
        ("trajectories (plans with paths)", "--record", [trajectories[i][index] for i in ended]),
        ("pictures of the end", "--record", [picture_of(run, i) for i in ended]),
        ("videos", "--video", [video_of(run, i) for i in ended]),
    )
    return [(name, option, sum(file is None for file in of), len(of)) for name, option, of in kinds]
