"""Many items of work over workers that may die: who gets what, what is tried again, when it is over.

Each item gives one result line. A worker builds its player when its first item comes, and keeps the house it has
loaded as long as there is an item left in it. A worker that dies costs its item one more try and nothing else. Where
the workers are (`sim.evaluation.executors`) is not known here.
"""

from __future__ import annotations

import importlib
import logging
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, Protocol, TypeVar

from sim.errors import WorkersError

_log = logging.getLogger(__name__)
Line = dict[str, Any]
ItemT = TypeVar("ItemT", bound="Item")
MAX_TRIES = 2
"""How often an item is started before a dying worker makes it an error."""
MAX_FAILED_STARTS = 3
"""How many workers may die one after the other before any of them was ready for work."""


class Item(Protocol):
    """One unit of work; items of the same house should meet the same worker."""

    @property
    def episode_id(self) -> str: ...  # noqa: D102
    @property
    def house(self) -> str: ...  # noqa: D102


class Player(Protocol):
    """What a worker builds once: plays one item after the other."""

    def play(self, item: Any) -> Any: ...  # noqa: D102
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


class WorkerLost(Exception):
    """A worker died; why, where that is known."""


class Worker(Protocol):
    """One worker somewhere. It says once that it is ready, then answers each item with a line or an exception."""

    def send(self, item: Any) -> None:
        """Hand it an item. One that has died meanwhile says so in `receive`."""
        ...

    def receive(self) -> Any:
        """What it said, after `Crew.wait` has named it.

        Raises:
            WorkerLost: it died.
            WorkersError: it cannot work here, and no other could.
        """
        ...


WorkerT = TypeVar("WorkerT", bound=Worker)


class Crew(Protocol[WorkerT]):
    """Workers of one kind, all for the same player."""

    def hire(self) -> WorkerT:
        """Start one more; it may take its time, even for ever where there is no room."""
        ...

    def wait(self, workers: Sequence[WorkerT]) -> Sequence[WorkerT]:
        """Those of some workers that have said something or died; blocks until there is one."""
        ...

    def dismiss(self, workers: Sequence[WorkerT]) -> None:
        """End them, whatever they are doing."""
        ...


class Bench:
    """What runs where a worker is: builds the player for the first item, plays, and never raises."""

    def __init__(self, spec: PlayerSpec) -> None:
        self._spec = spec
        self._player: Player | None = None

    def play(self, item: Any) -> Any:
        """The item's line, or the exception that building or playing raised."""
        try:
            if self._player is None:
                self._player = self._spec.build()
            return self._player.play(item)
        except Exception as error:
            return error

    def close(self) -> None:
        """Close the player, if there is one."""
        if self._player is not None:
            self._player.close()


def play_here(spec: PlayerSpec, items: Sequence[ItemT]) -> Iterator[Any]:
    """Yield the result line of each item, played in this process, house by house."""
    player = spec.build()
    try:
        for item in sorted(items, key=lambda item: item.house):  # stable: keeps the order within a house
            yield player.play(item)
    finally:
        player.close()


def play_with(crew: Crew[Any], items: Sequence[ItemT], *, size: int, on_death: Callable[[ItemT], Any]) -> Iterator[Any]:
    """Yield a result line for each item, in the order in which they end.

    Args:
        crew: whom to hire.
        items: the work.
        size: how many workers at most.
        on_death: the line of an item whose worker died `MAX_TRIES` times.

    Raises:
        WorkersError: workers die before they are ready for work.
        Exception: whatever a player raised.
    """
    shift = _Shift(crew, _Queue(list(items)), min(size, len(items)), on_death)
    try:
        yield from shift.lines()
    finally:
        crew.dismiss([post.worker for post in shift.posts])


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
class _Post(Generic[ItemT]):
    """What is known of one worker."""

    worker: Any
    ready: bool = False
    item: ItemT | None = None
    house: str | None = None

    @property
    def idle(self) -> bool:
        return self.ready and self.item is None


@dataclass
class _Shift(Generic[ItemT]):
    crew: Crew[Any]
    queue: _Queue[ItemT]
    size: int
    on_death: Callable[[ItemT], Any]
    posts: list[_Post[ItemT]] = field(default_factory=list)
    tries: dict[str, int] = field(default_factory=dict)
    failed_starts: int = 0

    def lines(self) -> Iterator[Any]:
        while True:
            self._staff()
            waited_for = {id(post.worker): post for post in self.posts if not post.idle}
            if not self.queue.items and all(post.item is None for post in waited_for.values()):
                return
            for worker in self.crew.wait([post.worker for post in waited_for.values()]):
                yield from self._hear(waited_for[id(worker)])

    def _staff(self) -> None:
        """Give every idle worker something to do, and hire where there is more to do."""
        for post in self.posts:
            if post.idle:
                self._hand_out(post)
        starting = sum(not post.ready for post in self.posts)
        for _ in range(min(self.size - len(self.posts), len(self.queue.items) - starting)):
            self.posts.append(_Post(self.crew.hire()))

    def _hand_out(self, post: _Post[ItemT]) -> None:
        busy = {other.house for other in self.posts if other.item is not None and other.house is not None}
        post.item = self.queue.take(post.house, busy)
        if post.item is not None:
            post.house = post.item.house
            post.worker.send(post.item)

    def _hear(self, post: _Post[ItemT]) -> Iterator[Any]:
        """What a worker has said: that it is ready, a line, or nothing any more."""
        try:
            said = post.worker.receive()
        except WorkerLost as loss:
            self.posts.remove(post)
            yield from self._bury(post, loss)
            return
        was_ready, post.ready, post.item = post.ready, True, None
        self.failed_starts = 0
        self._hand_out(post)  # before the caller does something with the line
        if isinstance(said, BaseException):
            raise said
        if was_ready:
            yield said

    def _bury(self, post: _Post[ItemT], loss: WorkerLost) -> Iterator[Any]:
        """The item of a dead worker is tried again, or becomes an error."""
        item = post.item
        if item is None:
            self.failed_starts += 1
            if self.failed_starts >= MAX_FAILED_STARTS:
                raise WorkersError(f"{self.failed_starts} workers died as they started ({loss}).")
            return
        self.tries[item.episode_id] = self.tries.get(item.episode_id, 0) + 1
        _log.warning("A worker was lost over '%s' (%s).", item.episode_id, loss)
        if self.tries[item.episode_id] < MAX_TRIES:
            self.queue.items.insert(0, item)
        else:
            yield self.on_death(item)
