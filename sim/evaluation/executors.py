"""Executors: run work items in this process, in processes of this machine, or on the machines of a Ray cluster.

An `Executor` takes items and yields result lines; a worker that dies is handled the same way by all of them
(`sim.evaluation.workers`).
"""

from __future__ import annotations

import contextlib
import multiprocessing as mp
import os
import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Any, Protocol

from sim.errors import ConfigError
from sim.evaluation.workers import ItemRunner, ItemT, RunnerSpec, WorkerLost, run_here, run_in_pool

EXECUTORS = ("local", "ray")
"""Names of `--executor`."""


class Executor(Protocol):
    """A place where work items are run."""

    def run(
        self,
        spec: RunnerSpec,
        items: Sequence[ItemT],
        *,
        on_death: Callable[[ItemT], Any],
        on_start: Callable[[ItemT], None] | None = None,
    ) -> Iterator[Any]:
        """Yields a result line for each item, in the order in which the items end.

        Args:
            spec: how each worker builds its runner.
            items: the work.
            on_death: returns the line of an item whose worker died twice.
            on_start: called in this process when an item begins.

        Raises:
            WorkersError: no worker can be started.
            Exception: any exception that a runner raised.
        """
        ...


def make_executor(name: str, *, workers: int, address: str | None = None) -> Executor:
    """Returns the executor with this name, one of `EXECUTORS`.

    Args:
        name: `local` or `ray`.
        workers: number of processes, on this machine or over the cluster.
        address: of the Ray cluster; None: the cluster that this machine belongs to.

    Raises:
        ConfigError: an unknown name, options that contradict each other, no `ray` installed, or no cluster there.
    """
    if name not in EXECUTORS:
        raise ConfigError(f"Unknown --executor '{name}'. Available: {', '.join(EXECUTORS)}.")
    if workers < 1:
        raise ConfigError(f"--workers must be at least 1, got {workers}.")
    if name == "local":
        if address is not None:
            raise ConfigError(f"--address '{address}' needs --executor ray.")
        return Processes(workers)
    from sim.evaluation.executors_ray import RayCluster  # an extra

    return RayCluster.connect(address, workers=workers)


@dataclass(frozen=True)
class Processes:
    """Processes of this machine; they are spawned, because OpenGL does not survive a fork. 1: this process."""

    workers: int = 1

    def run(
        self,
        spec: RunnerSpec,
        items: Sequence[ItemT],
        *,
        on_death: Callable[[ItemT], Any],
        on_start: Callable[[ItemT], None] | None = None,
    ) -> Iterator[Any]:
        """See `Executor`."""
        if self.workers == 1 or len(items) <= 1:
            yield from run_here(spec, items, on_start=on_start)
        else:
            pool = ProcessPool(spec, threads=max(1, _processors() // self.workers))
            yield from run_in_pool(pool, items, max_workers=self.workers, on_death=on_death, on_start=on_start)


class _Process:
    """A spawned process at the other end of a pipe; see `sim.evaluation.workers.Worker`."""

    def __init__(self, spec: RunnerSpec, *, threads: int) -> None:
        context = mp.get_context("spawn")
        self.connection, child_connection = context.Pipe()
        self.process = context.Process(target=_worker_main, args=(spec, child_connection), daemon=True)
        with _environment(OMP_NUM_THREADS=str(threads)):  # libraries read it when they are imported
            self.process.start()
        self.busy = True
        child_connection.close()

    def send(self, item: Any) -> None:
        self.busy = True
        with contextlib.suppress(OSError):  # it died while idle: `receive` finds the pipe closed
            self.connection.send(item)

    def receive(self) -> Any:
        try:
            message = self.connection.recv()
        except (EOFError, OSError):
            self.process.join()
            self.connection.close()
            raise WorkerLost(f"its process ended with status {self.process.exitcode}") from None
        self.busy = False
        return message


class ProcessPool:
    """Starts and stops processes of this machine; see `sim.evaluation.workers.WorkerPool`.

    Args:
        spec: how each process builds its runner.
        threads: number of threads of NumPy and PyTorch in each process, unless `OMP_NUM_THREADS` is set. Without a
            limit each process would use all processors, and the processes would wait for each other.
    """

    def __init__(self, spec: RunnerSpec, *, threads: int = 1) -> None:
        self._spec = spec
        self._threads = threads

    def start(self) -> _Process:
        """Spawns one process."""
        return _Process(self._spec, threads=self._threads)

    def wait(self, workers: Sequence[_Process]) -> list[_Process]:
        """Returns the workers with a message in their pipe, or whose pipe is closed."""
        ready = wait([worker.connection for worker in workers])
        return [worker for worker in workers if worker.connection in ready]

    def stop(self, workers: Sequence[_Process]) -> None:
        """Terminates busy workers and lets idle ones exit, since they may hold a renderer."""
        for worker in workers:
            worker.process.terminate() if worker.busy else worker.send(None)
        for worker in workers:
            worker.process.join()
            worker.connection.close()


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


def _end_with_parent() -> None:
    """Ends this worker as soon as the process that started it is gone, also in the middle of an episode."""
    parent = mp.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)


def _worker_main(spec: RunnerSpec, connection: Connection) -> None:
    """Reports that the worker is ready and runs items until None arrives or the parent process is gone."""
    runner = ItemRunner(spec)
    threading.Thread(target=_end_with_parent, daemon=True, name="parent").start()
    try:
        connection.send(None)
        while (item := connection.recv()) is not None:
            connection.send(runner.run(item))
    except (EOFError, OSError, KeyboardInterrupt):
        return
    finally:
        runner.close()
