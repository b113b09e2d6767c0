"""Makes results of episodes for tests, and reads those of runs without their times."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import msgspec

from sim.app.evaluation.results import read_results
from sim.task.result import EpisodeResult, GoalResult, RolloutResult, metrics_without_episode

ENTRIES: dict[str, Any] = msgspec.to_builtins(metrics_without_episode(4.2)) | {
    "episode_id": "val_0000",
    "house": "val_00",
    "goal": "bed",
    "agent": "stubborn",
    "uses_ground_truth": False,
    "isolated": False,
    "semantics": "gt",
    "seed": 0,
    "motion": "contacts",
    "success": 1.0,
    "spl": 0.5,
    "soft_spl": 0.5,
    "distance_to_goal": 0.0,
    "num_steps": 10,
    "path_length": 8.4,
    "gt_explored": True,
    "trapped": False,
    "end_reason": "stop",
    "stop_confidence": None,
    "wall_time_s": 1.5,
    "steps_per_s": 6.67,
}
"""A line of `results.jsonl`: a success of the agent `stubborn`."""


def a_result(**changes: Any) -> EpisodeResult:
    """Returns the result of `ENTRIES` with some changes."""
    return msgspec.convert(ENTRIES | changes, EpisodeResult)


def a_goal(**changes: Any) -> GoalResult:
    """Returns the result of a goal of a chain, as of `ENTRIES` with some changes."""
    of_goal = {"goal": "bed", "kind": "words", "goat_success": 1.0, "goat_spl": 1.0}
    names = [field.name for field in msgspec.structs.fields(GoalResult)]
    lines = ENTRIES | of_goal | changes
    return msgspec.convert({name: lines[name] for name in names if name in lines}, GoalResult)


def write_lines(folder: Path, *lines: dict[str, Any]) -> None:
    """Writes the `results.jsonl` of a run: for each line, what differs from `ENTRIES`."""
    text = "".join(json.dumps(ENTRIES | line) + "\n" for line in lines)
    (folder / "results.jsonl").write_text(text)


def lines_of(out: Path) -> list[dict[str, Any]]:
    """Returns the result lines of a run without their times, in the order of their episode ids."""
    results = sorted(read_results(out / "results.jsonl").values, key=lambda result: result.episode_id)
    return [result.without_times().as_json() for result in results]


def entries_of(result: RolloutResult) -> dict[str, Any]:
    """Returns the entries of a result without its times."""
    return msgspec.to_builtins(result.without_times())


def rows(file: Path) -> list[dict[str, str]]:
    """Returns the rows of a CSV file."""
    with file.open(newline="") as stream:
        return list(csv.DictReader(stream))
