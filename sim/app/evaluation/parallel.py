"""Applies one function to many items on several workers, with results in order; and shards of a list of items."""

from __future__ import annotations

import re
import reprlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from sim.app.evaluation.executors import Executor
from sim.app.evaluation.processes import Processes
from sim.app.evaluation.workers import ResultT, RunnerSpec
from sim.core.errors import ConfigError, WorkersError

T = TypeVar("T")


@dataclass(frozen=True)
class Shard:
    """The part of the work that one of several machines processes: every `count`-th item, from item `index` on."""

    index: int = 0
    """Number of the shard, from 0 on; options and names of folders count from 1."""
    count: int = 1

    @classmethod
    def parse(cls, text: str) -> Shard:
        """Returns the shard that `--shard i/n` names.

        Raises:
            ConfigError: the text does not have this form, or there is no such shard.
        """
        match = re.fullmatch(r"([0-9]{1,9})/([0-9]{1,9})", text)
        if match is None or not 1 <= int(match[1]) <= int(match[2]):
            raise ConfigError(f'--shard must be "i/n" with 1 <= i <= n (1/2 and 2/2 are all of 2), got "{text}".')
        return cls(int(match[1]) - 1, int(match[2]))

    @property
    def folder(self) -> str:
        """Name of the folder for the results of this shard, inside the folder of the whole."""
        return f"shard_{self.index + 1}_of_{self.count}"

    def require_own_numbers(self, whole: Path) -> None:
        """Raises ConfigError if the folder of the whole run holds shards that are numbered from 0."""
        if (whole / f"shard_0_of_{self.count}").exists():
            raise ConfigError(
                f"--out '{whole}' holds shards of version 0.1, which are numbered from 0 to {self.count - 1}; give "
                "another --out, or finish them with that version. `stubborn merge` reads them."
            )

    def contains(self, number: int) -> bool:
        """Returns True if the item with this number is in the shard."""
        return number % self.count == self.index

    def select(self, items: Sequence[T]) -> Sequence[T]:
        """Returns the items that are in the shard."""
        return items[self.index :: self.count]


def ordered_map(
    function: Callable[[T], ResultT],
    items: Sequence[T],
    *,
    workers: int = 1,
    executor: Executor | None = None,
) -> Iterator[ResultT]:
    """Yields `function(item)` for each item, in the order of the items.

    When a worker dies, its item is tried once more.

    Args:
        function: picklable, if there are workers.
        items: each is one unit of work.
        workers: 1 runs in this process; more are spawned.
        executor: replaces the processes of this machine.

    Raises:
        WorkersError: the worker of an item died twice.
        Exception: any exception that `function` raised.
    """

    def give_up(numbered: _NumberedItem[T], reason: str) -> tuple[int, ResultT]:
        raise WorkersError(f"Item {numbered.number + 1}, {reprlib.repr(numbered.item)}: {reason}")

    executor = executor or Processes(workers if len(items) > 1 else 1)
    numbered = [_NumberedItem(number, item) for number, item in enumerate(items)]
    early: dict[int, ResultT] = {}
    following = 0
    spec = RunnerSpec("sim.app.evaluation.parallel:FunctionRunner", function)
    for number, result in executor.run(spec, numbered, on_death=give_up):
        early[number] = result
        while following in early:
            yield early.pop(following)
            following += 1


@dataclass(frozen=True)
class _NumberedItem(Generic[T]):
    """An item with its position; see `sim.app.evaluation.workers.WorkItem`."""

    number: int
    item: T

    @property
    def episode_id(self) -> str:
        return str(self.number)

    @property
    def house(self) -> str:
        """The same for all items, because a worker keeps no state between items."""
        return ""


class FunctionRunner(Generic[T, ResultT]):
    """A `Runner` that applies one function."""

    def __init__(self, function: Callable[[T], ResultT]) -> None:
        self._function = function

    def run(self, numbered: _NumberedItem[T]) -> tuple[int, ResultT]:
        """Returns the number of the item and the function's result."""
        return numbered.number, self._function(numbered.item)

    def close(self) -> None:
        """Does nothing: no state is kept."""
