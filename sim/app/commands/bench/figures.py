"""A figure of a benchmark with its baseline, ratio and goal, and functions that time work."""

from __future__ import annotations

import contextlib
import functools
import operator
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

CaseT = TypeVar("CaseT")
_COMPARE = {">=": operator.ge, "<=": operator.le}


@dataclass(frozen=True, kw_only=True)
class Goal:
    """A bound that a figure should reach."""

    of: Literal["ratio", "value"]
    sign: Literal[">=", "<="]
    bound: float

    def __str__(self) -> str:
        return f"{'' if self.of == 'ratio' else 'value '}{self.sign} {self.bound:g}"


@dataclass(frozen=True, kw_only=True)
class Figure:
    """One line of the table."""

    part: str
    """Letter of the part."""
    what: str
    value: float
    unit: str
    against: str
    """Description of the baseline."""
    baseline: float
    """In the same unit."""
    ratio: float
    """baseline / value for a speed-up, value / baseline for a share or a growth."""
    goal: Goal | None = None
    count: int = 0
    """Number of measurements of each of the two."""

    @property
    def met(self) -> bool | None:
        """True if the goal is reached; None without a goal."""
        if self.goal is None:
            return None
        return bool(_COMPARE[self.goal.sign](getattr(self, self.goal.of), self.goal.bound))

    def to_json(self) -> dict[str, Any]:
        """Returns the figure as JSON types."""
        kept = {key: value for key, value in vars(self).items() if key != "goal"}
        return kept | {"goal": str(self.goal) if self.goal else None, "met": self.met}


def speedup(ours: NDArray[np.float64], theirs: NDArray[np.float64]) -> float:
    """Returns how many times faster ours is: the median over cases of the ratio."""
    return float(np.median(theirs / ours))


def timed(work: Callable[[], object]) -> float:
    """Returns the milliseconds that a call takes."""
    began_s = time.perf_counter()
    work()
    return 1e3 * (time.perf_counter() - began_s)


def interleaved(
    works: Mapping[str, Callable[[CaseT], object]], cases: Sequence[CaseT], *, repeats: int
) -> dict[str, NDArray[np.float64]]:
    """Returns the milliseconds of each work in each case, (cases,): the smallest of several tries.

    The works take turns in every try, and each is run once before it is timed.
    """
    ms = {name: np.full(len(cases), np.inf) for name in works}
    for i, case in enumerate(cases):
        for repeat in range(repeats + (i == 0)):
            for name, work in works.items():
                taken = timed(functools.partial(work, case))
                if repeat or i:
                    ms[name][i] = min(ms[name][i], taken)
    return ms


@contextlib.contextmanager
def stopwatch(parts: Mapping[str, Sequence[tuple[type, str]]]) -> Iterator[dict[str, float]]:
    """A context in which the milliseconds spent in methods of some classes are summed, by name of the part."""
    ms = dict.fromkeys(parts, 0.0)
    originals: list[tuple[type, str, Any]] = []
    for part, methods in parts.items():
        for owner, name in methods:
            original = getattr(owner, name)
            originals.append((owner, name, original))
            setattr(owner, name, _counting(original, part, ms))
    try:
        yield ms
    finally:
        for owner, name, original in originals:
            setattr(owner, name, original)


def _counting(original: Callable[..., Any], part: str, ms: dict[str, float]) -> Callable[..., Any]:
    @functools.wraps(original)
    def counted(*args: Any, **options: Any) -> Any:
        began_s = time.perf_counter()
        try:
            return original(*args, **options)
        finally:
            ms[part] += 1e3 * (time.perf_counter() - began_s)

    return counted
