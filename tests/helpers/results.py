"""Reads the result lines of runs, for comparisons of two runs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from sim.app.evaluation.rollout import TIMES


def lines_of(out: Path) -> list[dict[str, Any]]:
    """Returns the result lines of a run without their times, in the order of their episode ids."""
    lines = [json.loads(line) for line in (out / "results.jsonl").read_text().splitlines()]
    kept = [{key: value for key, value in line.items() if key not in TIMES} for line in lines]
    return sorted(kept, key=lambda line: line["episode_id"])
