"""Records the calls and steps of an agent, so that a call that never returns is ended and a run reports its progress.

A worker writes the beginning and the end of each call, and the number of steps of its episode, to memory that it shares
with the process that started it (`sim.app.evaluation.executors`). Nothing in the worker itself can end a call, which
may loop in C or have stopped the process.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator, MutableSequence
from multiprocessing.context import SpawnContext

from sim.app import cli

Steps = Callable[[], int | None]
"""Returns the number of steps of a running episode so far; None: not known in this process."""
WHERE_BYTES = 240
"""Longest description of a call, in bytes."""
TICK_S = 0.25
"""Interval at which workers are checked."""
BETWEEN_CALLS_S = 1800.0
"""Longest time without a call, in which houses are loaded and kernels are compiled."""
FACTORY_S = 120.0
"""Smallest time limit for the factory of an agent, which loads weights; `--step-timeout` may be shorter."""


class Calls:
    """Memory of one worker, shared with the process that watches it.

    Args:
        context: the context that starts the processes.
        limit_s: longest time of a call; 0: no limit.
    """

    def __init__(self, context: SpawnContext, *, limit_s: float) -> None:
        self._mark = context.RawArray("d", 1)  # time of the last begin, or minus the time of the last end
        self._where = context.RawArray("c", WHERE_BYTES)
        self._least_s = context.RawArray("d", 1)  # smallest limit of the running call
        self.step_count: MutableSequence[int] = context.RawArray("q", 1)
        """One number: the steps of the running episode."""
        self.limit_s = limit_s
        self._seen, self._waited_s, self._looked_s = 0.0, 0.0, time.monotonic()

    @property
    def where(self) -> str:
        """The running call, for example "Agent 'mine:make', step 3"; "" between two calls."""
        return self._where.value.decode(errors="replace") if self._mark[0] > 0.0 else ""

    def begin(self, where: str, least_s: float = 0.0) -> None:
        """Marks the beginning of a call, in the worker; its limit is at least `least_s`."""
        self._least_s[0] = least_s
        self._where.value = where.encode(errors="replace")[: WHERE_BYTES - 1]
        self._mark[0] = time.monotonic()

    def end(self) -> None:
        """Marks the end of a call, in the worker."""
        self._mark[0] = -time.monotonic()

    def rest(self) -> None:
        """Sets waiting time and steps to 0, because the worker gets new work now."""
        self.step_count[0] = 0
        self._waited_s, self._looked_s = 0.0, time.monotonic()

    def overdue(self) -> str:
        """Returns a sentence if no call has begun or ended for too long, else ""; called by the process that watches.

        Time in which that process itself was stopped, for example by Ctrl-Z, does not count.
        """
        now_s, mark = time.monotonic(), self._mark[0]
        passed_s, self._looked_s = min(now_s - self._looked_s, 2.0 * TICK_S), now_s
        self._waited_s = self._waited_s + passed_s if mark == self._seen else 0.0
        self._seen = mark
        limit_s = max(self.limit_s, self._least_s[0] if mark > 0.0 else BETWEEN_CALLS_S)
        if self.limit_s == 0.0 or self._waited_s <= limit_s:
            return ""
        return (
            f"{self.where or 'The worker'}: no answer within {limit_s:g} s (--step-timeout), so its process was ended"
        )


_calls: Calls | None = None
"""The calls of this worker; None: this process is not a watched worker."""
_step_count: MutableSequence[int] = [0]
"""One number: the steps of the episode that runs in this process."""


def watched_as(calls: Calls) -> None:
    """Makes this process a watched worker: `marked` and `count_steps` write to `calls` from here on."""
    global _calls, _step_count
    _calls, _step_count = calls, calls.step_count


def count_steps(steps: int) -> None:
    """Sets the number of steps of the episode that runs in this process."""
    _step_count[0] = steps


def counted_steps() -> int:
    """Returns the number of steps of the episode that runs in this process."""
    return _step_count[0]


def is_stop(error: BaseException) -> bool:
    """Returns whether an error is Ctrl-C or SIGTERM; False in a worker, where only a user's code can raise it."""
    return _calls is None and cli.is_stop(error)


@contextlib.contextmanager
def marked(where: str, least_s: float = 0.0) -> Iterator[None]:
    """Records a call of the agent while the `with` block runs; its time limit is at least `least_s`."""
    if _calls is None:
        yield
        return
    _calls.begin(where, least_s)
    try:
        yield
    finally:
        _calls.end()
