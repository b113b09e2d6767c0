"""Many episodes over one or several processes.

Work is a list of items; each gives one result line. Workers are spawned, never forked (OpenGL does not survive a
fork), and keep the house they have loaded as long as there is an episode left in it. A worker that dies costs its
episode one more try and nothing else.
"""

from __future__ import annotations

import contextlib
import importlib
import multiprocessing as mp
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from typing import Any, Generic, Protocol, TypeVar

Line = dict[str, Any]
ItemT = TypeVar("ItemT", bound="Item")
MAX_TRIES = 2
"""How often an episode is started before a dying worker makes it an error."""


class Item(Protocol):
    """One unit of work; items of the same house should meet the same worker."""

    @property
    def episode_id(self) -> str: ...  # noqa: D102
    @property
    def house(self) -> str: ...  # noqa: D102


class Player(Protocol):
    """What a worker builds once: plays one item after the other."""

    def play(self, item: Any) -> Line: ...  # noqa: D102
    def close(self) -> None: ...  # noqa: D102


@dataclass(frozen=True)
class PlayerSpec:
    """How to build a `Player` in any process: `module:function` and its one argument (picklable)."""

    entry: str
    config: Any

    def build(self) -> Player:
        """Import the function and call it."""
        module, function = self.entry.split(":")
        return getattr(importlib.import_module(module), function)(self.config)


def run_items(
    spec: PlayerSpec, items: Sequence[ItemT], *, workers: int, on_death: Callable[[ItemT], Line]
) -> Iterator[Line]:
    """Yield a result line for each item, in the order in which they end.

    Args:
        spec: how each process builds its player.
        items: the work.
        workers: 1 plays in this process; more are spawned.
        on_death: the line of an item whose worker died `MAX_TRIES` times.
    """
    if workers == 1 or len(items) <= 1:
        player = spec.build()
        try:
            for item in sorted(items, key=lambda item: item.house):  # stable: keeps the order within a house
                yield player.play(item)
        finally:
            player.close()
        return
    pool = _Pool(spec, _Queue(list(items)), min(workers, len(items)))
    try:
        yield from pool.lines(on_death)
    finally:
        pool.stop()


@dataclass
class _Queue(Generic[ItemT]):
    """Items that wait, handed out house by house."""

    items: list[ItemT]

    def take(self, house: str | None, busy_houses: set[str]) -> ItemT | None:
        """The next item for a worker: of its own house, else of one nobody plays, else of any."""
        if not self.items:
            return None
        for wanted in (
            lambda item: item.house == house,
            lambda item: item.house not in busy_houses,
            lambda item: True,
        ):
            for i, item in enumerate(self.items):
                if wanted(item):
                    return self.items.pop(i)
        raise AssertionError("unreachable: the last filter accepts all")


@dataclass
class _Worker(Generic[ItemT]):
    process: Any
    connection: Connection
    item: ItemT | None = None
    house: str | None = None


@dataclass
class _Pool(Generic[ItemT]):
    spec: PlayerSpec
    queue: _Queue[ItemT]
    size: int
    workers: list[_Worker[ItemT]] = field(default_factory=list)
    tries: dict[str, int] = field(default_factory=dict)

    def lines(self, on_death: Callable[[ItemT], Line]) -> Iterator[Line]:
        for _ in range(self.size):
            self._hand_out(self._spawn())
        while busy := {worker.connection: worker for worker in self.workers if worker.item is not None}:
            for ready in wait(list(busy)):
                worker = busy[ready]  # pyright: ignore[reportArgumentType]
                line = self._receive(worker, on_death)
                if line is not None:
                    yield line

    def stop(self) -> None:
        for worker in self.workers:
            worker.process.terminate() if worker.item is not None else _say_goodbye(worker)
        for worker in self.workers:
            worker.process.join()
            worker.connection.close()

    def _spawn(self) -> _Worker[ItemT]:
        context = mp.get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=_work, args=(self.spec, theirs), daemon=True)
        process.start()
        theirs.close()
        worker: _Worker[ItemT] = _Worker(process, ours)
        self.workers.append(worker)
        return worker

    def _hand_out(self, worker: _Worker[ItemT]) -> None:
        busy = {other.house for other in self.workers if other.item is not None and other.house is not None}
        worker.item = self.queue.take(worker.house, busy)
        if worker.item is None:
            return
        worker.house = worker.item.house
        with contextlib.suppress(OSError):  # it died while idle: `_receive` finds the pipe closed
            worker.connection.send(worker.item)

    def _receive(self, worker: _Worker[ItemT], on_death: Callable[[ItemT], Line]) -> Line | None:
        item = worker.item
        assert item is not None
        try:
            outcome = worker.connection.recv()
        except (EOFError, OSError):
            return self._bury(worker, item, on_death)
        worker.item = None
        self._hand_out(worker)
        if isinstance(outcome, BaseException):
            raise outcome
        return outcome

    def _bury(self, worker: _Worker[ItemT], item: ItemT, on_death: Callable[[ItemT], Line]) -> Line | None:
        """Replace a dead worker; its episode is tried again, or becomes an error."""
        worker.process.join()
        worker.connection.close()
        self.workers.remove(worker)
        self.tries[item.episode_id] = self.tries.get(item.episode_id, 0) + 1
        line = None
        if self.tries[item.episode_id] < MAX_TRIES:
            self.queue.items.insert(0, item)
        else:
            line = on_death(item)
        if self.queue.items:
            self._hand_out(self._spawn())
        return line


def _say_goodbye(worker: _Worker) -> None:
    try:
        worker.connection.send(None)
    except OSError:
        worker.process.terminate()


def _work(spec: PlayerSpec, connection: Connection) -> None:
    """A worker's life: build the player, play what comes, end at None or when the parent is gone."""
    try:
        player = spec.build()
    except Exception as error:
        connection.recv()
        connection.send(error)
        return
    try:
        while (item := connection.recv()) is not None:
            try:
                connection.send(player.play(item))
            except Exception as error:
                connection.send(error)
    except (EOFError, KeyboardInterrupt):
        return
    finally:
        player.close()
