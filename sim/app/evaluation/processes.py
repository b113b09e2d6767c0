"""Runs work items in spawned processes of this machine, and ends those that hang or lose their parent."""

from __future__ import annotations

import contextlib
import ctypes
import importlib
import io
import multiprocessing as mp
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait

from sim.app.evaluation.watch import TICK_S, Calls, watched_as
from sim.app.evaluation.workers import (
    ItemRunner,
    ItemT,
    OnStart,
    ResultT,
    RunnerSpec,
    WorkerLost,
    run_here,
    run_in_pool,
)
from sim.app.options import RunOptions, is_process
from sim.core.errors import ConfigError
from sim.core.reading import reason_of

LAST_WORDS_S = 5.0
"""Longest time in which a process may end with its threads and exit handlers; then it is killed."""
_PR_SET_PDEATHSIG = 1  # sys/prctl.h


@dataclass(frozen=True)
class Isolation:
    """Whether items need a process other than this one, and how long a call of the agent may take there."""

    needed: bool = False
    """True: a single worker is a process of its own, too, which can crash or hang without harm to this process."""
    limit_s: float = 0.0
    """Longest time of a call of the agent (`sim.app.evaluation.watch`); 0: no limit."""


def isolation_of(options: RunOptions) -> Isolation:
    """Returns whether the episodes of a run need a process of their own, and how long a call of the agent may take.

    A user's code needs one: it may hang, crash, or change the state of its process. An agent `process:COMMAND` has a
    process already, and `ProcessAgent` ends a call that takes too long, so that the loaded house is not lost.
    """
    if is_process(options.agent):
        return Isolation()
    limit_s = options.step_limit_s
    own_process = bool(options.own_code) or options.step_timeout is not None
    return Isolation(needed=own_process and limit_s > 0.0, limit_s=limit_s)


@dataclass(frozen=True)
class Processes:
    """Runs items in processes of this machine, which are spawned, because OpenGL does not survive a fork."""

    workers: int = 1
    """Number of processes; 1: items are run in this process, unless `isolation` needs another."""
    isolation: Isolation = Isolation()

    def run(
        self,
        spec: RunnerSpec,
        items: Sequence[ItemT],
        *,
        on_death: Callable[[ItemT, str], ResultT],
        on_start: OnStart[ItemT] | None = None,
    ) -> Iterator[ResultT]:
        """See `Executor`."""
        if self.workers == 1 and not self.isolation.needed:
            yield from run_here(spec, items, on_start=on_start)
        else:
            threads = max(1, _processors() // self.workers)
            pool = ProcessPool(spec, threads=threads, limit_s=self.isolation.limit_s)
            yield from run_in_pool(pool, items, max_workers=self.workers, on_death=on_death, on_start=on_start)


class _Process:
    """A spawned process with a pipe to it; see `sim.app.evaluation.workers.Worker`.

    It first sends a message that it is ready.

    Args:
        spec, threads, limit_s: see `ProcessPool`.
    """

    def __init__(self, spec: RunnerSpec, *, threads: int, limit_s: float) -> None:
        context = mp.get_context("spawn")
        self.connection, child_connection = context.Pipe()
        try:
            self.calls = Calls(context, limit_s=limit_s)
        except OSError as error:  # for example a read-only /dev/shm of a container
            raise ConfigError(
                f"Processes of workers need shared memory (/dev/shm), which cannot be used here: {reason_of(error)}. "
                "Give --workers 1 --step-timeout 0, which needs none."
            ) from None
        from_main_thread = threading.current_thread() is threading.main_thread()
        args = (child_connection, self.calls, spec, from_main_thread)
        self.process = context.Process(target=_worker_main, args=args, daemon=True)
        with _environment(OMP_NUM_THREADS=str(threads)):  # libraries read this variable when they are imported
            self.process.start()
        self.busy = True
        self.loss = ""
        """The reason why this process was killed; "" if it was not."""
        child_connection.close()

    def send(self, item: object) -> None:
        self.busy = True
        self.calls.rest()
        with contextlib.suppress(OSError):  # the process died while it was idle: `receive` finds the pipe closed
            self.connection.send(item)

    def steps(self) -> int:
        return self.calls.step_count[0]

    def receive(self) -> object:
        try:
            if self.loss:  # the process was killed, but a process that it forked may keep the pipe open
                raise EOFError
            message = self.connection.recv()
        except Exception:  # the pipe was closed, or a user's code wrote to it
            where, killed = self.calls.where, self.loss
            self.end(within_s=LAST_WORDS_S)
            at = f"{where}: its process" if where else "The process of the worker"
            loss = killed or f"{at} ended with status {self.process.exitcode}"
            raise WorkerLost(loss, final=bool(killed)) from None
        self.busy = False
        return message

    def is_overdue(self) -> bool:
        """Kills the process if it has shown no activity for too long; returns whether it was killed."""
        self.loss = self.loss or (self.calls.overdue() if self.busy else "")
        if self.loss:
            self.process.kill()
        return bool(self.loss)

    def end(self, *, within_s: float) -> None:
        """Waits for the end of the process, and kills it if its threads and exit handlers do not return."""
        self.process.join(within_s)
        if self.process.is_alive():
            self.process.kill()
            self.process.join()
        self.connection.close()


class ProcessPool:
    """Starts and stops processes of this machine; see `sim.app.evaluation.workers.WorkerPool`.

    Args:
        spec: how each process builds its runner.
        threads: number of threads of NumPy and PyTorch in each process, unless `OMP_NUM_THREADS` is set. Without a
            limit each process would use all processors, and the processes would wait for each other.
        limit_s: longest time of a call of the agent; 0: no limit.
    """

    def __init__(self, spec: RunnerSpec, *, threads: int = 1, limit_s: float = 0.0) -> None:
        self._spec = spec
        self._threads = threads
        self._limit_s = limit_s

    def start(self) -> _Process:
        """Spawns one process."""
        return _Process(self._spec, threads=self._threads, limit_s=self._limit_s)

    def wait(self, workers: Sequence[_Process]) -> list[_Process]:
        """Returns the workers that sent a message, closed their pipe, or were killed because they were too slow."""
        while True:
            ready = wait([worker.connection for worker in workers], TICK_S if self._limit_s else None)
            if ended := [worker for worker in workers if worker.connection in ready or worker.is_overdue()]:
                return ended

    def stop(self, workers: Sequence[_Process]) -> None:
        """Terminates busy workers and lets idle ones exit, which may hold a renderer; kills those that do not end."""
        for worker in workers:
            worker.process.terminate() if worker.busy else worker.send(None)
        until_s = time.monotonic() + LAST_WORDS_S
        for worker in workers:
            worker.end(within_s=max(0.0, until_s - time.monotonic()))


class Supervisor:
    """Runs items in one process of its own, for the actor of a cluster; see `sim.app.evaluation.workers.ItemRunner`.

    Args:
        spec: how the process builds its runner.
        limit_s: longest time of a call of the agent; 0: no limit.
    """

    def __init__(self, spec: RunnerSpec, *, limit_s: float) -> None:
        self._pool = ProcessPool(spec, limit_s=limit_s)
        self._process: _Process | None = None

    def run(self, item: object) -> object:
        """Returns the item's line, the exception that it raised, or a `WorkerLost` if the process ended."""
        try:
            if self._process is None:
                self._process = self._pool.start()
                self._answer(self._process)
            self._process.send(item)
            return self._answer(self._process)
        except WorkerLost as loss:
            self._process = None
            return loss

    def close(self) -> None:
        """Ends the process."""
        if self._process is not None:
            self._pool.stop([self._process])
            self._process = None

    def _answer(self, process: _Process) -> object:
        self._pool.wait([process])
        return process.receive()


def _processors() -> int:
    """Returns the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextlib.contextmanager
def _environment(**defaults: str) -> Iterator[None]:
    """Adds variables that are not set to the environment of the processes started inside the block."""
    added = [name for name in defaults if name not in os.environ]
    os.environ.update({name: defaults[name] for name in added})
    try:
        yield
    finally:
        for name in added:
            del os.environ[name]


def _end_with_parent(*, by_kernel: bool) -> None:
    """Ends this worker as soon as the process that started it has ended, even in the middle of an episode.

    A thread waits for that end. A worker that was stopped (SIGSTOP) runs no thread; on Linux the kernel kills it.

    Args:
        by_kernel: whether the kernel may kill the worker. It does so as soon as the thread that started it has ended.
    """
    if by_kernel:
        with contextlib.suppress(OSError, AttributeError):  # not Linux
            ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    parent = mp.parent_process()

    def watch() -> None:
        if parent is not None:
            wait([parent.sentinel])
            os._exit(1)

    threading.Thread(target=watch, daemon=True, name="parent").start()


def _worker_main(connection: Connection, calls: Calls, spec: RunnerSpec, from_main_thread: bool) -> None:
    """Reports that the worker is ready and runs items until None arrives or the parent process has ended."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches all processes; the parent process ends the workers
    _end_with_parent(by_kernel=from_main_thread)
    watched_as(calls)
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(line_buffering=True)  # an agent's output is not lost if the process is killed
    with contextlib.suppress(Exception):  # `ItemRunner` reports the error
        importlib.import_module(spec.entry.partition(":")[0])
    runner = ItemRunner(spec)
    try:
        connection.send(None)
        while (item := connection.recv()) is not None:
            connection.send(runner.run(item))
    except (EOFError, OSError):
        return
    finally:
        runner.close()
