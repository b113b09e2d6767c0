"""Builds the page of one run, or of two runs of the same episodes, from their files; no episode is run again."""

from __future__ import annotations

import json
import os
import re
import shlex
import urllib.parse
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from typing import Any

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from sim.analysis.comparison import Line, Run, differences_table, require_same_episodes
from sim.analysis.report.drawings import Trajectories, draw_episodes, read_trajectories, video_of
from sim.analysis.report.figures import causes, groups, interval_note, means, verdict
from sim.analysis.report.words import explain, outcome
from sim.errors import ConfigError
from sim.evaluation.bootstrap import MIN_PAIRS

NO_DEFAULT = (
    "agent", "explorer", "semantics", "weights", "verifier", "split", "house", "labels", "root", "robot", "goal",
    "start_deg", "episodes",
)  # fmt: skip
"""Options of `sim.run` that the command of a run names if they have a value."""
DEFAULTS: Mapping[str, Any] = {
    "verification": "naive-bayes", "seed": 0, "profile": "fast", "noise": "none", "workers": 1,
}  # fmt: skip
"""Options of `sim.run` that the command of a run names if their value differs from this one."""


@dataclass(frozen=True)
class Column:
    """A column of the table of episodes."""

    title: str
    is_number: bool = True
    second: bool = True
    """True: hidden in a narrow window."""


@dataclass(frozen=True)
class Row:
    """The row of an episode in the table."""

    episode_id: str
    goal: str
    house: str
    outcomes: Sequence[str]
    """One for each run."""
    tokens: Sequence[str]
    """Values of the filter of outcomes that select this episode."""
    numbers: Sequence[tuple[str, float | None]]
    """Text and value of the other columns."""
    collisions: int


@dataclass(frozen=True)
class RunFacts:
    """Facts about a run at the top of the page."""

    label: str
    """`A` or `B`; "" for a single run."""
    name: str
    facts: Sequence[tuple[str, Any]]
    command: str
    notes: Sequence[str]


_NUMBERS = (("SPL", "spl", 2), ("steps", "num_steps", 0), ("path m", "path_length", 1))
_ALONE = (*_NUMBERS, ("left m", "distance_to_goal", 1), ("collisions", "collisions", 0))
_IN_PAIRS = (("SPL", "spl", 2), ("steps", "num_steps", 0), ("collisions", "collisions", 0))
_TOKENS = {"failed": "not found", "only-a": "only A found it", "only-b": "only B found it"}
_TOKENS |= {"both": "both found it", "neither": "neither found it"}


def build_page(runs: Sequence[Run], *, out_folder: Path, command: str) -> str:
    """Returns the HTML of the report.

    Args:
        runs: one run, or two runs of the same episodes.
        out_folder: folder of the page; links to videos are relative to it.
        command: the command that made the page, for its footer.

    Raises:
        ConfigError: no episode has ended yet, or the two runs are not of the same episodes.
    """
    for run in runs:
        if not run.lines:
            raise ConfigError(f"'{run.path}' has no result yet: its first episode has not ended.")
    both = len(runs) == 2
    episode_ids = require_same_episodes(*runs) if both else list(runs[0].lines)
    episode_ids.sort(key=_by_number)
    lines = [[run.lines[i] for i in episode_ids] for run in runs]
    trajectories, unreadable = read_trajectories(runs, episode_ids)
    drawings, undrawn = draw_episodes(runs, trajectories)
    labels = ["A", "B"] if both else [""]
    rows = [_row(i, of) for i, of in zip(episode_ids, zip(*lines, strict=True), strict=True)]
    episodes = [
        _episode(runs, trajectories, row, out_folder) | drawings.episodes.get(row.episode_id, {"goal": row.goal})
        for row in rows
    ]
    template = _environment().from_string(_part("report.html.j2"))
    return template.render(
        title=_title(runs),
        both=both,
        runs=[_facts(run, label, trajectories, i) for i, (run, label) in enumerate(zip(runs, labels, strict=True))],
        notes=[*unreadable, *undrawn],
        count=len(episode_ids),
        means=means(lines),
        interval_note=interval_note(lines),
        fields=differences_table(*runs) if both else None,
        by_goal=groups(lines, "goal"),
        by_house=groups(lines, "house"),
        causes=causes(lines),
        errors=list(_errors(lines, labels)),
        columns=_columns(both),
        outcomes=_outcomes(rows),
        rows=rows,
        data={
            "runs": labels,
            "plans": drawings.plans,
            "areas": drawings.areas,
            "episodes": episodes,
            "why_no_picture": "There is no trajectory of this episode, so there is no picture.",
        },
        css=Markup(_part("report.css")),  # our own files
        js=Markup(_part("report.js")),
        min_pairs=MIN_PAIRS,
        made_by=command,
        version=version("stubborn-objectnav"),
    )


def _environment() -> Environment:
    """Returns a template environment that escapes all values and writes JSON without spaces."""
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True)
    environment.filters["plain"] = lambda name: str(name).replace("_", " ")
    environment.globals["verdict"] = verdict
    environment.policies["json.dumps_kwargs"] = {
        "separators": (",", ":"),
        "ensure_ascii": False,
        "allow_nan": False,
    }
    return environment


def _part(name: str) -> str:
    return (files("sim.analysis.report") / "page" / name).read_text(encoding="utf-8")


def _title(runs: Sequence[Run]) -> str:
    names = [f"{run.config.get('agent', 'an agent')}" for run in runs]
    split = runs[0].config.get("split_identity", {}).get("name", "unknown houses")
    return f"{' against '.join(names)} on {split}"


def _facts(run: Run, label: str, trajectories: Trajectories, index: int) -> RunFacts:
    config = run.config
    split, versions = config.get("split_identity", {}), config.get("versions", {})
    codes = config.get("codes") or [versions.get("code", "unknown")]
    facts = [
        ("folder", run.path),
        ("agent", config.get("agent")),
        ("explorer", config.get("explorer")),
        ("semantics", config.get("semantics")),
        ("houses", f"{split.get('name')} {split.get('version')} ({str(split.get('sha256'))[:8]})"),
        ("noise", config.get("noise")),
        ("profile", config.get("profile")),
        ("seed", config.get("seed")),
        ("code", " or ".join(map(str, codes))),
        ("renderer", versions.get("gl_renderer")),
    ]
    shown = [(name, value) for name, value in facts if value is not None]
    return RunFacts(label, run.path.resolve().name, shown, command_of(config), list(_notes(run, trajectories, index)))


def command_of(config: Mapping[str, Any]) -> str:
    """Returns the command of a run without `--out`."""
    words = ["python", "-m", "sim.run"]
    for key in (*NO_DEFAULT, *DEFAULTS):
        value = config.get(key)
        if value is None or value == DEFAULTS.get(key) or (key == "split" and config.get("house")):
            continue
        words += [f"--{key.replace('_', '-')}", str(value)]
    if config.get("settings"):
        words += ["--config", *(f"{path}={_setting(value)}" for path, value in config["settings"].items())]
    return shlex.join([*words, "--record"])


def _setting(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value)


def _notes(run: Run, trajectories: Trajectories, index: int) -> Iterable[str]:
    """Yields sentences about what is missing in a run."""
    wanted, count = run.config.get("episodes"), len(run.lines)
    if isinstance(wanted, int) and count < wanted:
        yield (
            f"Not finished: {count} of {wanted} episodes have ended. The same command with --out {run.path} runs the "
            "rest."
        )
    errors = sum(line.get("end_reason") == "error" for line in run.lines.values())
    if errors:
        yield f"{errors} of {count} episodes ended with an error; they count as failures and are listed below."
    falls = sum(line.get("end_reason") == "fallen" for line in run.lines.values())
    if falls:
        yield f"In {falls} of {count} episodes the robot drove over an edge and fell."
    if len(run.config.get("codes") or []) > 1:
        yield "The episodes were run by more than one version of the code."
    missing = sum(of_runs[index] is None for of_runs in trajectories.values()) - errors
    if missing >= len(trajectories) - errors and len(trajectories) > errors:
        yield (
            "There are no trajectories, so there are no pictures. The command below, with --record and another --out, "
            "runs the same episodes and writes them."
        )
    elif missing > 0:
        yield f"{missing} episodes have no trajectory (they were run without --record), so no picture."


def _errors(lines: Sequence[Sequence[Line]], labels: Sequence[str]) -> Iterable[tuple[str, str, str]]:
    for label, of_run in zip(labels, lines, strict=True):
        for line in of_run:
            if line.get("end_reason") == "error":
                yield label, line["episode_id"], str(line.get("error") or "no reason was recorded")


def _columns(both: bool) -> list[Column]:
    words = [Column("episode", False, False), Column("goal", False, False), Column("house", False)]
    if not both:
        return [*words, Column("outcome", False, False), *(Column(title) for title, _, _ in _ALONE)]
    pairs = [Column(f"{title} {label}") for title, _, _ in _IN_PAIRS for label in ("A", "B")]
    return [*words, Column("A", False, False), Column("B", False, False), *pairs, Column("SPL B - A")]


def _row(episode_id: str, lines: Sequence[Line]) -> Row:
    outcomes = [outcome(line) for line in lines]
    numbers: list[tuple[str, float | None]] = []
    for _, key, digits in _ALONE if len(lines) == 1 else _IN_PAIRS:
        values = [None if line.get(key) is None else float(line[key]) for line in lines]
        numbers += [_shown(value, digits) for value in values]
    if len(lines) == 2:
        numbers.append(_shown(_difference(numbers[0][1], numbers[1][1]), 2, sign="+"))
    collisions = sum(int(line.get("collisions") or 0) for line in lines)
    goal, house = str(lines[0]["goal"]), str(lines[0]["house"])
    return Row(episode_id, goal, house, outcomes, _tokens(outcomes), numbers, collisions)


def _difference(first: float | None, second: float | None) -> float | None:
    return None if first is None or second is None else second - first


def _shown(value: float | None, digits: int, sign: str = "") -> tuple[str, float | None]:
    return ("-" if value is None else f"{value:{sign}.{digits}f}", value)


def _tokens(outcomes: Sequence[str]) -> list[str]:
    """Returns `found`, or `failed` and the cause; for two runs which of them found the goal, and the causes."""
    failures = sorted({name for name in outcomes if name != "found"})
    if len(outcomes) == 1:
        return ["failed", *(name for name in failures if name != "failed")] if failures else ["found"]
    found = [name == "found" for name in outcomes]
    token = {(True, True): "both", (True, False): "only-a", (False, True): "only-b", (False, False): "neither"}
    return [token[found[0], found[1]], *failures]


def _outcomes(rows: Sequence[Row]) -> list[tuple[str, str, int]]:
    """Returns the choices of the filter of outcomes: token, words, and number of episodes."""
    counts = Counter(token for row in rows for token in row.tokens)
    order = ["found", "both", "only-a", "only-b", "neither", "failed"]
    tokens = [token for token in order if token in counts] + sorted(set(counts).difference(order))
    return [(token, _TOKENS.get(token, token.replace("_", " ")), counts[token]) for token in tokens]


def _episode(runs: Sequence[Run], trajectories: Trajectories, row: Row, out_folder: Path) -> dict[str, Any]:
    """Returns the data of an episode that the page needs besides its drawing."""
    lines = [run.lines[row.episode_id] for run in runs]
    words = [explain(line, trajectory) for line, trajectory in zip(lines, trajectories[row.episode_id], strict=True)]
    videos = [_link(video_of(run, row.episode_id), out_folder) for run in runs]
    return {"id": row.episode_id, "outcomes": row.outcomes, "words": words, "videos": videos}


def _by_number(name: str) -> list[tuple[int, str]]:
    """Returns a sort key that puts `val_9` before `val_10`."""
    return [(int(part), "") if part.isdigit() else (-1, part) for part in re.split(r"(\d+)", name)]


def _link(file: Path | None, folder: Path) -> str | None:
    if file is None:
        return None
    return urllib.parse.quote(os.path.relpath(file.resolve(), folder.resolve()))
