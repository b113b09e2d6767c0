"""Executors: run work items in this process, in processes of this machine, or on the machines of a Ray cluster.

An `Executor` takes items and yields result lines; a worker that dies is handled the same way by all of them
(`sim.app.evaluation.workers`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Protocol

from sim.app.evaluation.processes import Isolation, Processes
from sim.app.evaluation.workers import ItemT, OnStart, ResultT, RunnerSpec
from sim.core.errors import ConfigError

EXECUTORS = ("local", "ray")
"""Names of `--executor`."""


class Executor(Protocol):
    """A place where work items are run."""

    def run(
        self,
        spec: RunnerSpec,
        items: Sequence[ItemT],
        *,
        on_death: Callable[[ItemT, str], ResultT],
        on_start: OnStart[ItemT] | None = None,
    ) -> Iterator[ResultT]:
        """Yields a result line for each item, in the order in which the items end.

        Args:
            spec: how each worker builds its runner.
            items: the work.
            on_death: returns the line of an item whose workers died, from the item and the reason.
            on_start: called in this process when an item begins, with the item and the number of its steps so far.

        Raises:
            WorkersError: no worker can be started.
            Exception: any exception that a runner raised.
        """
        ...


def make_executor(
    name: str, *, workers: int, address: str | None = None, isolation: Isolation | None = None
) -> Executor:
    """Returns the executor with this name, one of `EXECUTORS`.

    Args:
        name: `local` or `ray`.
        workers: number of processes, on this machine or over the cluster.
        address: of the Ray cluster; None: the cluster that this machine belongs to.
        isolation: whether the items need a process of their own; None: they do not.

    Raises:
        ConfigError: the name is unknown, options contradict each other, `ray` is not installed, or no cluster answers.
    """
    if name not in EXECUTORS:
        raise ConfigError(f"Unknown --executor '{name}'. Available: {', '.join(EXECUTORS)}.")
    if workers < 1:
        raise ConfigError(f"--workers must be at least 1, got {workers}.")
    isolation = isolation or Isolation()
    if name == "local":
        if address is not None:
            raise ConfigError(f"--address '{address}' needs --executor ray.")
        return Processes(workers, isolation)
    from sim.app.evaluation.executors_ray import RayCluster  # needs the extra `ray`

    return RayCluster.connect(address, workers=workers, isolation=isolation)
