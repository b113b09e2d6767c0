"""Runs many work items on workers that may die: it assigns items, retries lost ones and ends when all are done.

Each item gives one result line. A worker builds its runner when its first item arrives, and keeps a loaded house while
items in that house remain. When a worker dies, its item is tried once more; no other item is affected. This module
does not depend on the kind of worker (process, Ray actor); see `sim.app.evaluation.executors`.
"""

from __future__ import annotations

import functools
import importlib
import logging
import pickle
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, Protocol, TypeVar, cast

from sim.app.evaluation.own_code import text_of
from sim.app.evaluation.watch import Steps, counted_steps
from sim.core.errors import WorkersError

_log = logging.getLogger(__name__)
ItemT = TypeVar("ItemT", bound="WorkItem")
ResultT = TypeVar("ResultT")
OnStart = Callable[[ItemT, Steps], None]
"""Called when an item begins, with the item and a function that returns the number of its steps so far."""
MAX_TRIES = 2
"""Number of times that an item is started; if its worker dies each time, the item is an error."""
MAX_FAILED_STARTS = 3
"""Number of workers that may die in succession before any of them was ready."""


class WorkItem(Protocol):
    """One unit of work; items of the same house should go to the same worker."""

    @property
    def episode_id(self) -> str: ...  # noqa: D102
    @property
    def house(self) -> str: ...  # noqa: D102


class Runner(Protocol):
    """An object that a worker builds once and that runs one item after the other."""

    def run(self, item: Any) -> Any: ...  # noqa: D102
    def close(self) -> None: ...  # noqa: D102


@dataclass(frozen=True)
class _Packed:
    """A pickled argument."""

    content: bytes


@dataclass(frozen=True)
class RunnerSpec:
    """A recipe to build a `Runner` in any process: `module:function` and its one argument (picklable).

    In another process only `build` reads the argument: a worker first enters the folder of the user's code,
    and an error is then reported as that of an item.
    """

    entry: str
    config: object

    def __reduce__(self) -> tuple[Callable[..., RunnerSpec], tuple[str, _Packed]]:
        """Pickles the argument as bytes."""
        packed = self.config if isinstance(self.config, _Packed) else _Packed(pickle.dumps(self.config))
        return RunnerSpec, (self.entry, packed)

    def build(self) -> Runner:
        """Imports the function and returns its result."""
        module, function = self.entry.split(":")
        config = pickle.loads(self.config.content) if isinstance(self.config, _Packed) else self.config
        return getattr(importlib.import_module(module), function)(config)


class WorkerLost(Exception):
    """A worker died; the message gives the reason where it is known.

    Args:
        reason: a sentence without its full stop.
        final: True: the worker's item is not tried again.
    """

    def __init__(self, reason: str, *, final: bool = False) -> None:
        super().__init__(reason)
        self.final = final

    def __reduce__(self) -> tuple[Callable[[str], WorkerLost], tuple[str]]:
        """Returns the form for pickling, with both arguments."""
        return functools.partial(WorkerLost, final=self.final), (str(self),)


class Worker(Protocol):
    """A worker process or actor. It reports once that it is ready, then answers each item with a line or an error."""

    def send(self, item: object) -> None:
        """Sends it an item. If it has died since, `receive` reports it."""
        ...

    def steps(self) -> int | None:
        """Returns the number of steps of its item so far; None: not known."""
        ...

    def receive(self) -> object:
        """Returns its message, after `WorkerPool.wait` has returned it.

        Raises:
            WorkerLost: it died.
            WorkersError: it cannot work here, and no other worker could.
        """
        ...


WorkerT = TypeVar("WorkerT", bound=Worker)


class WorkerPool(Protocol[WorkerT]):
    """Starts and stops workers of one kind, all with the same runner."""

    def start(self) -> WorkerT:
        """Starts one more worker; it may never get ready where there is no free processor."""
        ...

    def wait(self, workers: Sequence[WorkerT]) -> Sequence[WorkerT]:
        """Returns those of the given workers that have a message or died; blocks until there is one."""
        ...

    def stop(self, workers: Sequence[WorkerT]) -> None:
        """Ends workers, busy or idle."""
        ...


class ItemRunner:
    """The part of a worker that builds the runner for the first item and runs items; it never raises."""

    def __init__(self, spec: RunnerSpec) -> None:
        self._spec = spec
        self._runner: Runner | None = None

    def run(self, item: object) -> object:
        """Returns the item's line, or the exception that building or running raised."""
        try:
            if self._runner is None:
                self._runner = self._spec.build()
            return self._runner.run(item)
        except BaseException as error:  # a user's code may raise `GeneratorExit`, for example
            return _sendable(error)

    def close(self) -> None:
        """Closes the runner, if it was built."""
        if self._runner is not None:
            self._runner.close()


def _sendable(error: BaseException) -> BaseException:
    """Returns an error if it can be pickled, else one with its text; classes of users may take any arguments."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return WorkersError(f"{type(error).__name__}: {text_of(error)}")
    return error


def run_here(spec: RunnerSpec, items: Sequence[ItemT], *, on_start: OnStart[ItemT] | None = None) -> Iterator[Any]:
    """Yields the result line of each item, run in this process, house by house; `on_start` is called before each."""
    runner = spec.build()
    try:
        for item in sorted(items, key=lambda item: item.house):  # stable: keeps the order within a house
            if on_start is not None:
                on_start(item, counted_steps)
            yield runner.run(item)
    finally:
        runner.close()


def run_in_pool(
    pool: WorkerPool[WorkerT],
    items: Sequence[ItemT],
    *,
    max_workers: int,
    on_death: Callable[[ItemT, str], ResultT],
    on_start: OnStart[ItemT] | None = None,
) -> Iterator[ResultT]:
    """Yields a result line for each item, in the order in which the items end.

    Args:
        pool: starts the workers.
        items: the work.
        max_workers: largest number of workers at a time.
        on_death: returns the line of an item whose workers died `MAX_TRIES` times, or that took too long, from the
            item and the reason.
        on_start: see `OnStart`.

    Raises:
        WorkersError: workers die before they are ready.
        Exception: any exception that a runner raised.
    """
    scheduler = _Scheduler(pool, _Queue(list(items)), min(max_workers, len(items)), on_death, on_start)
    try:
        yield from scheduler.lines()
    finally:
        pool.stop([slot.worker for slot in scheduler.slots])


@dataclass
class _Queue(Generic[ItemT]):
    """Waiting items, given out house by house."""

    items: list[ItemT]

    def take(self, house: str | None, busy_houses: set[str]) -> ItemT | None:
        """Removes and returns the next item for a worker: of its house, else of an idle house, else any."""
        if not self.items:
            return None
        for is_wanted in (
            lambda item: item.house == house,
            lambda item: item.house not in busy_houses,
            lambda item: True,
        ):
            for i, item in enumerate(self.items):
                if is_wanted(item):
                    return self.items.pop(i)
        raise AssertionError("unreachable: the last filter accepts every item")


@dataclass
class _WorkerSlot(Generic[WorkerT, ItemT]):
    """The state of one worker."""

    worker: WorkerT
    ready: bool = False
    item: ItemT | None = None
    house: str | None = None

    @property
    def idle(self) -> bool:
        return self.ready and self.item is None


@dataclass
class _Scheduler(Generic[WorkerT, ItemT, ResultT]):
    """Assigns the items of a queue to the workers of a pool."""

    pool: WorkerPool[WorkerT]
    queue: _Queue[ItemT]
    max_workers: int
    on_death: Callable[[ItemT, str], ResultT]
    on_start: OnStart[ItemT] | None = None
    slots: list[_WorkerSlot[WorkerT, ItemT]] = field(default_factory=list)
    tries: dict[str, int] = field(default_factory=dict)
    failed_starts: int = 0

    def lines(self) -> Iterator[ResultT]:
        while True:
            self._assign_all()
            pending = {id(slot.worker): slot for slot in self.slots if not slot.idle}
            if not self.queue.items and all(slot.item is None for slot in pending.values()):
                return
            for worker in self.pool.wait([slot.worker for slot in pending.values()]):
                yield from self._receive(pending[id(worker)])

    def _assign_all(self) -> None:
        """Assigns an item to every idle worker, and starts workers for the remaining items."""
        for slot in self.slots:
            if slot.idle:
                self._assign(slot)
                self._report_start(slot)
        starting = sum(not slot.ready for slot in self.slots)
        for _ in range(min(self.max_workers - len(self.slots), len(self.queue.items) - starting)):
            self.slots.append(_WorkerSlot(self.pool.start()))

    def _assign(self, slot: _WorkerSlot[WorkerT, ItemT]) -> None:
        busy = {other.house for other in self.slots if other.item is not None and other.house is not None}
        slot.item = self.queue.take(slot.house, busy)
        if slot.item is not None:
            slot.house = slot.item.house
            slot.worker.send(slot.item)

    def _report_start(self, slot: _WorkerSlot[WorkerT, ItemT]) -> None:
        """Calls `on_start` for the item that a worker got."""
        if self.on_start is not None and slot.item is not None:
            self.on_start(slot.item, slot.worker.steps)

    def _receive(self, slot: _WorkerSlot[WorkerT, ItemT]) -> Iterator[ResultT]:
        """Handles one message of a worker: that it is ready, a line, or its death."""
        try:
            message = slot.worker.receive()
        except WorkerLost as loss:
            self.slots.remove(slot)
            yield from self._retry_or_fail(slot, loss)
            return
        was_ready, slot.ready, slot.item = slot.ready, True, None
        self.failed_starts = 0
        self._assign(slot)  # before the caller uses the line, so that the worker does not wait
        if isinstance(message, BaseException):
            raise message
        if was_ready:
            yield cast(ResultT, message)
        self._report_start(slot)  # after the line of the item before it

    def _retry_or_fail(self, slot: _WorkerSlot[WorkerT, ItemT], loss: WorkerLost) -> Iterator[ResultT]:
        """Puts the item of a dead worker back into the queue, or yields its error line."""
        item = slot.item
        if item is None:
            self.failed_starts += 1
            if self.failed_starts >= MAX_FAILED_STARTS:
                raise WorkersError(f"{self.failed_starts} workers died as they started ({loss}).")
            return
        self.tries[item.episode_id] = self.tries.get(item.episode_id, 0) + 1
        _log.warning("A worker was lost in '%s' (%s).", item.episode_id, loss)
        if loss.final:
            yield self.on_death(item, f"{loss}.")
        elif self.tries[item.episode_id] < MAX_TRIES:
            self.queue.items.insert(0, item)
        else:
            yield self.on_death(item, f"{loss}; {MAX_TRIES} workers were lost in this episode.")
