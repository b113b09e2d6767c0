"""Where work is done: in this process, in processes of this machine, or on the machines of a Ray cluster.

An `Executor` takes items and gives lines; what a dying worker costs is the same everywhere (`sim.evaluation.workers`).
"""

from __future__ import annotations

import contextlib
import multiprocessing as mp
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Any, Protocol

from sim.errors import ConfigError
from sim.evaluation.workers import Bench, ItemT, PlayerSpec, WorkerLost, play_here, play_with

EXECUTORS = ("local", "ray")
"""Names of `--executor`."""


class Executor(Protocol):
    """Somewhere to work."""

    def run(self, spec: PlayerSpec, items: Sequence[ItemT], *, on_death: Callable[[ItemT], Any]) -> Iterator[Any]:
        """Yield a result line for each item, in the order in which they end.

        Args:
            spec: how each worker builds its player.
            items: the work.
            on_death: the line of an item whose worker died twice.

        Raises:
            WorkersError: no worker can be started.
            Exception: whatever a player raised.
        """
        ...


def make_executor(name: str, *, workers: int, address: str | None = None) -> Executor:
    """The executor of that name, one of `EXECUTORS`.

    Args:
        name: `local` or `ray`.
        workers: how many processes, on this machine or over the cluster.
        address: of the Ray cluster; None: the one that this machine belongs to.

    Raises:
        ConfigError: an unknown name, options that do not go together, no `ray` installed or no cluster there.
    """
    if name not in EXECUTORS:
        raise ConfigError(f"Unknown --executor '{name}'. There is: {', '.join(EXECUTORS)}.")
    if workers < 1:
        raise ConfigError(f"--workers must be at least 1, got {workers}.")
    if name == "local":
        if address is not None:
            raise ConfigError(f"--address '{address}' goes with --executor ray.")
        return Processes(workers)
    from sim.evaluation.executors_ray import RayCluster  # an extra

    return RayCluster.connect(address, workers=workers)


@dataclass(frozen=True)
class Processes:
    """Processes of this machine, spawned, never forked: OpenGL does not survive a fork. One is this process."""

    workers: int = 1

    def run(self, spec: PlayerSpec, items: Sequence[ItemT], *, on_death: Callable[[ItemT], Any]) -> Iterator[Any]:
        """See `Executor`."""
        if self.workers == 1 or len(items) <= 1:
            yield from play_here(spec, items)
        else:
            yield from play_with(ProcessCrew(spec), items, size=self.workers, on_death=on_death)


class _Process:
    """A spawned process at the other end of a pipe; see `sim.evaluation.workers.Worker`."""

    def __init__(self, spec: PlayerSpec) -> None:
        context = mp.get_context("spawn")
        self.connection, theirs = context.Pipe()
        self.process = context.Process(target=_work, args=(spec, theirs), daemon=True)
        self.process.start()
        self.busy = True
        theirs.close()

    def send(self, item: Any) -> None:
        self.busy = True
        with contextlib.suppress(OSError):  # it died while idle: `receive` finds the pipe closed
            self.connection.send(item)

    def receive(self) -> Any:
        try:
            said = self.connection.recv()
        except (EOFError, OSError):
            self.process.join()
            self.connection.close()
            raise WorkerLost(f"its process ended with status {self.process.exitcode}") from None
        self.busy = False
        return said


class ProcessCrew:
    """Processes of this machine as a `sim.evaluation.workers.Crew`."""

    def __init__(self, spec: PlayerSpec) -> None:
        self._spec = spec

    def hire(self) -> _Process:
        """Spawn one."""
        return _Process(self._spec)

    def wait(self, workers: Sequence[_Process]) -> list[_Process]:
        """Those with something in their pipe, or whose pipe is closed."""
        ready = wait([worker.connection for worker in workers])
        return [worker for worker in workers if worker.connection in ready]

    def dismiss(self, workers: Sequence[_Process]) -> None:
        """End the idle ones gently, for they may hold a renderer."""
        for worker in workers:
            worker.process.terminate() if worker.busy else worker.send(None)
        for worker in workers:
            worker.process.join()
            worker.connection.close()


def _work(spec: PlayerSpec, connection: Connection) -> None:
    """A worker's life: be ready, play what comes, end at None or when the parent is gone."""
    bench = Bench(spec)
    try:
        connection.send(None)
        while (item := connection.recv()) is not None:
            connection.send(bench.play(item))
    except (EOFError, OSError, KeyboardInterrupt):
        return
    finally:
        bench.close()
