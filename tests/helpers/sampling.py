"""Samples of test cases that differ from commit to commit, so that all cases are tested over time."""

from __future__ import annotations

import functools
import random
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

CaseT = TypeVar("CaseT")
ALL_CASES = False
"""Set by `--all-cases`."""


@functools.cache
def commit() -> str:
    """Returns the hash of the checked-out commit, or a constant word without git."""
    answer = subprocess.run(
        ["git", "rev-parse", "HEAD"], cwd=Path(__file__).parent, capture_output=True, text=True, check=False
    )
    return answer.stdout.strip() or "no-git"


def sample(cases: Sequence[CaseT], count: int) -> list[CaseT]:
    """Returns `count` cases sampled with the commit as the seed; all of them under `--all-cases`."""
    if ALL_CASES or count >= len(cases):
        return list(cases)
    chosen = random.Random(commit()).sample(range(len(cases)), count)
    return [cases[i] for i in sorted(chosen)]
