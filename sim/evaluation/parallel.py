"""The same work on many things, over workers, results in order; or a share of the things, for a batch scheduler."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from sim.errors import ConfigError, WorkersError
from sim.evaluation.executors import Executor, Processes
from sim.evaluation.workers import PlayerSpec

ThingT = TypeVar("ThingT")
ResultT = TypeVar("ResultT")


@dataclass(frozen=True)
class Share:
    """Every `parts`-th thing from the `part`-th on: what one of several machines does of the work."""

    part: int = 0
    parts: int = 1

    @classmethod
    def parse(cls, text: str) -> Share:
        """What `--shard i/n` means.

        Raises:
            ConfigError: it is not of that form, or there is no such part.
        """
        match = re.fullmatch(r"(\d+)/(\d+)", text)
        if match is None or not int(match[1]) < int(match[2]):
            raise ConfigError(f'--shard must be "i/n" with 0 <= i < n, got "{text}".')
        return cls(int(match[1]), int(match[2]))

    @property
    def folder(self) -> str:
        """Name of the folder that this share's results go to, below that of the whole."""
        return f"shard_{self.part}_of_{self.parts}"

    def takes(self, number: int) -> bool:
        """Whether the thing with this number is in the share."""
        return number % self.parts == self.part

    def of(self, things: Sequence[ThingT]) -> Sequence[ThingT]:
        """The share of some things."""
        return things[self.part :: self.parts]


def ordered_map(
    work: Callable[[ThingT], ResultT],
    things: Sequence[ThingT],
    *,
    workers: int = 1,
    executor: Executor | None = None,
) -> Iterator[ResultT]:
    """Yield `work(thing)` for each thing, in their order.

    A worker that dies costs its thing one more try.

    Args:
        work: picklable, when there are workers.
        things: each one piece of work.
        workers: 1 works in this process; more are spawned.
        executor: where to work, in place of so many processes.

    Raises:
        WorkersError: a thing whose worker died twice.
        Exception: whatever `work` raised.
    """
    executor = executor or Processes(workers)
    pieces = [_Piece(number, thing) for number, thing in enumerate(things)]
    early: dict[int, ResultT] = {}
    following = 0
    for number, result in executor.run(PlayerSpec("sim.evaluation.parallel:Workman", work), pieces, on_death=_give_up):
        early[number] = result
        while following in early:
            yield early.pop(following)
            following += 1


@dataclass(frozen=True)
class _Piece:
    """A thing as an item of work; see `sim.evaluation.workers.Item`."""

    number: int
    thing: Any

    @property
    def episode_id(self) -> str:
        return str(self.number)

    @property
    def house(self) -> str:
        """The same for all: there is nothing that a worker keeps from one to the next."""
        return ""


class Workman:
    """A `Player` that applies one function."""

    def __init__(self, work: Callable[[Any], Any]) -> None:
        self._work = work

    def play(self, piece: _Piece) -> tuple[int, Any]:
        """The number of the piece, and what the function makes of its thing."""
        return piece.number, self._work(piece.thing)

    def close(self) -> None:
        """Nothing is kept."""


def _give_up(piece: _Piece) -> Any:
    raise WorkersError(f"The worker died twice over {piece.thing}.")
