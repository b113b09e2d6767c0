"""The table of episodes: its columns, its rows, and the choices of its filter."""

from __future__ import annotations

import itertools
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from sim.app.analysis.comparison import LETTERS
from sim.app.analysis.report.figures import goal_group
from sim.core.vocabulary import plain
from sim.task.explanations import outcome
from sim.task.result import EpisodeResult


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
    cells: Sequence[Sequence[tuple[int, str]]]
    """Cells with outcomes: number of the run and its outcome. Of one and of two runs each has a cell of its own."""
    tokens: Sequence[str]
    """Values of the filter of outcomes that select this episode."""
    numbers: Sequence[tuple[str, float | None]]
    """Text and value of the other columns."""
    collisions: int
    goal_groups: Sequence[str]
    """Values of the filter of goals that select this episode: the goal, or the groups of the goals of a chain."""

    @property
    def outcomes(self) -> list[str]:
        """One for each run."""
        return [name for cell in self.cells for _, name in cell]


_MARKS = {True: "\N{CHECK MARK}", False: "\N{BALLOT X}"}
_NUMBERS = (("SPL", "spl", 2), ("steps", "num_steps", 0), ("path m", "path_length", 1))
_ALONE = (*_NUMBERS, ("to go m", "distance_to_goal", 1), ("collisions", "collisions", 0))
_IN_PAIRS = (("SPL", "spl", 2), ("steps", "num_steps", 0), ("collisions", "collisions", 0))
_TOKENS = {"failed": "not found", "only-a": "only A found it", "only-b": "only B found it"}
_TOKENS |= {"both": "both found it", "neither": "neither found it"}
_TOKENS |= {"all": "all runs found it", "some": "some runs found it", "none": "no run found it"}


def columns_of(runs: int) -> list[Column]:
    """Returns the columns of the table for a number of runs."""
    words = [Column("episode", False, False), Column("goal", False, False), Column("house", False)]
    if runs == 1:
        return [*words, Column("outcome", False, False), *(Column(title) for title, _, _ in _ALONE)]
    if runs == 2:
        pairs = [Column(f"{title} {label}") for title, _, _ in _IN_PAIRS for label in LETTERS[:2]]
        return [*words, Column("A", False, False), Column("B", False, False), *pairs, Column("SPL B - A")]
    return [*words, Column("outcomes", False, False), Column("found by"), Column("mean SPL")]


def row_of(episode_id: str, lines: Sequence[EpisodeResult]) -> Row:
    """Returns the row of an episode from its line in each run."""
    named = list(enumerate(outcome(line) for line in lines))
    cells = [[text] for text in named] if len(lines) <= 2 else [named]
    collisions = sum(result.collisions for result in lines)
    tokens = _tokens([name for _, name in named])
    groups = [lines[0].goal] if lines[0].goals is None else sorted({goal_group(goal) for goal in lines[0].goals})
    return Row(episode_id, _goal(lines), lines[0].house, cells, tokens, _numbers(lines), collisions, groups)


def _goal(lines: Sequence[EpisodeResult]) -> str:
    """Returns the goal; the goals of a chain have a mark for each run that says whether it found them."""
    if (goals := lines[0].goals) is None:
        return lines[0].goal
    found = [[_MARKS[goal.success == 1.0] for goal in line.goals or ()] for line in lines]
    ticked = itertools.zip_longest(*found, fillvalue=_MARKS[False])
    return ", ".join(f"{''.join(marks)} {plain(goal.goal)}" for goal, marks in zip(goals, ticked, strict=True))


def _numbers(lines: Sequence[EpisodeResult]) -> list[tuple[str, float | None]]:
    if len(lines) > 2:
        successes = sum(result.success == 1.0 for result in lines)
        mean = sum(result.spl for result in lines) / len(lines)
        return [(f"{successes} of {len(lines)}", float(successes)), _shown(mean, 2)]
    numbers: list[tuple[str, float | None]] = []
    for _, key, digits in _ALONE if len(lines) == 1 else _IN_PAIRS:
        numbers += [_shown(getattr(result, key), digits) for result in lines]
    if len(lines) == 2:
        numbers.append(_shown(_difference(numbers[0][1], numbers[1][1]), 2, sign="+"))
    return numbers


def facts_of_line(result: EpisodeResult) -> list[str]:
    """Returns the numbers of an episode in words, for the picture of one of several runs."""
    shown = [f"{title} {_shown(getattr(result, key), digits)[0]}" for title, key, digits in _ALONE]
    confidence = result.stop_confidence
    return [*shown, *([] if confidence is None else [f"confidence at STOP {confidence:.2f}"])]


def _difference(first: float | None, second: float | None) -> float | None:
    return None if first is None or second is None else second - first


def _shown(value: float | None, digits: int, sign: str = "") -> tuple[str, float | None]:
    return ("-" if value is None else f"{value:{sign}.{digits}f}", value)


def _tokens(outcomes: Sequence[str]) -> list[str]:
    """Returns `found`, or `failed` and the cause; for several runs which of them found the goal, and the causes."""
    failures = sorted({name for name in outcomes if name != "found"})
    if len(outcomes) == 1:
        return ["failed", *(name for name in failures if name != "failed")] if failures else ["found"]
    successes = [name == "found" for name in outcomes]
    if len(outcomes) > 2:
        return ["all" if all(successes) else "some" if any(successes) else "none", *failures]
    token = {(True, True): "both", (True, False): "only-a", (False, True): "only-b", (False, False): "neither"}
    return [token[successes[0], successes[1]], *failures]


def outcome_choices(rows: Sequence[Row]) -> list[tuple[str, str, int]]:
    """Returns the choices of the filter of outcomes: token, words, and number of episodes."""
    counts = Counter(token for row in rows for token in row.tokens)
    order = ["found", "both", "only-a", "only-b", "neither", "all", "some", "none", "failed"]
    tokens = [token for token in order if token in counts] + sorted(set(counts).difference(order))
    return [(token, _TOKENS.get(token, token.replace("_", " ")), counts[token]) for token in tokens]


def by_number(name: str) -> list[tuple[int, str]]:
    """Returns a sort key that puts `val_9` before `val_10`."""
    return [(int(part), "") if part.isdecimal() else (-1, part) for part in re.split(r"(\d+)", name)]
