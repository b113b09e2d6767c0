"""The same work on many things, over processes, results in order."""

from __future__ import annotations

import multiprocessing as mp
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from typing import TypeVar

ItemT = TypeVar("ItemT")
ResultT = TypeVar("ResultT")


def ordered_map(work: Callable[[ItemT], ResultT], items: Sequence[ItemT], *, workers: int) -> Iterator[ResultT]:
    """Yield `work(item)` for each item, in their order.

    Args:
        work: picklable, when there are workers.
        items: each one piece of work.
        workers: 1 works in this process; more are spawned (OpenGL does not survive a fork).
    """
    if workers == 1 or len(items) <= 1:
        yield from map(work, items)
        return
    with ProcessPoolExecutor(min(workers, len(items)), mp_context=mp.get_context("spawn")) as pool:
        try:
            yield from pool.map(work, items)
        finally:
            pool.shutdown(cancel_futures=True)
