"""Runs work items on the machines of a Ray cluster (https://docs.ray.io); `pip install 'stubborn-objectnav[ray]'`.

Every machine needs the same code and packages at the same versions; a worker with others is refused. Workers change to
the folder in which the run was started, if their machine has it, so that relative paths have the same meaning.
"""

from __future__ import annotations

import contextlib
import importlib
import logging
import os
import socket
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

from sim.app.evaluation.processes import Isolation, Supervisor
from sim.app.evaluation.workers import ItemRunner, ItemT, OnStart, ResultT, RunnerSpec, WorkerLost, run_in_pool
from sim.core import invocation
from sim.core.errors import ConfigError, WorkersError
from sim.core.paths import code_hash

try:
    ray: Any = importlib.import_module("ray")  # by name, so that type checking works without ray
except ModuleNotFoundError:
    raise ConfigError("--executor ray needs the extra `ray`: pip install 'stubborn-objectnav[ray]'.") from None
RayError, RayTaskError = ray.exceptions.RayError, ray.exceptions.RayTaskError

CONNECT_TIMEOUT_S = 5.0
WARN_AFTER_S = 30.0
_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class RayCluster:
    """Workers with one processor each, on any machine of a cluster that has one free."""

    workers: int
    isolation: Isolation

    @classmethod
    def connect(cls, address: str | None = None, *, workers: int, isolation: Isolation | None = None) -> RayCluster:
        """Joins a cluster, once per process.

        Args:
            address: `HOST:PORT` of its head; None: the cluster that this machine belongs to.
            workers: largest number of workers; those without a free processor do not start.
            isolation: whether a user's code needs a process of its own on each machine; None: it does not.

        Raises:
            ConfigError: there is no cluster.
        """
        if not ray.is_initialized():
            try:
                _check_port(address)
                ray.init(address=address or "auto", log_to_driver=False, logging_level=logging.ERROR)
            except (OSError, RuntimeError, ValueError) as error:  # ConnectionError, or an error of gRPC
                reason = str(error).strip().split("\n")[0]
                start = f"{invocation.beside_python('ray')} start"
                raise ConfigError(
                    f"No Ray cluster answers at --address {address or 'auto'} ({reason}). Start one with "
                    f"`{start} --head` and join it from other machines with `{start} --address HOST:6379`."
                ) from None
        return cls(workers, isolation or Isolation())

    def run(
        self,
        spec: RunnerSpec,
        items: Sequence[ItemT],
        *,
        on_death: Callable[[ItemT, str], ResultT],
        on_start: OnStart[ItemT] | None = None,
    ) -> Iterator[ResultT]:
        """See `sim.app.evaluation.executors.Executor`."""
        pool = _ActorPool(spec, self.isolation)
        yield from run_in_pool(pool, items, max_workers=self.workers, on_death=on_death, on_start=on_start)


class WorkerActor:
    """The actor that runs items on a machine of the cluster."""

    def __init__(self, spec: RunnerSpec, folder: str, isolation: Isolation) -> None:
        if os.path.isdir(folder):
            os.chdir(folder)
        self._runner = Supervisor(spec, limit_s=isolation.limit_s) if isolation.needed else ItemRunner(spec)

    def versions(self) -> dict[str, str]:
        """Returns the versions that must be the same on all machines."""
        return _versions()

    def run(self, item: object) -> object:
        """See `ItemRunner.run`; it also returns a `WorkerLost`."""
        return self._runner.run(item)


class _Actor:
    """See `sim.app.evaluation.workers.Worker`."""

    def __init__(self, spec: RunnerSpec, isolation: Isolation) -> None:
        # A lost actor is replaced by `sim.app.evaluation.workers`, which knows its item.
        options = {"num_cpus": 1, "max_restarts": 0, "max_task_retries": 0, "scheduling_strategy": "SPREAD"}
        self.actor: Any = ray.remote(WorkerActor).options(**options).remote(spec, os.getcwd(), isolation)
        self.answer: Any = self.actor.versions.remote()
        self.ready = False

    def send(self, item: object) -> None:
        self.answer = self.actor.run.remote(item)

    def steps(self) -> None:
        """Returns None: the steps are counted on another machine."""

    def receive(self) -> object:
        try:
            message: Any = ray.get(self.answer)
        except RayTaskError as error:
            raise WorkersError(f"A worker of the Ray cluster cannot work: {error.cause}") from None
        except RayError as error:
            raise WorkerLost(str(error).strip().split("\n")[0]) from None
        if not self.ready:
            _require_same(message)
            self.ready = True
        if isinstance(message, WorkerLost):  # the process of the actor, which another actor replaces
            with contextlib.suppress(RayError):
                ray.kill(self.actor)
            raise message
        return message


class _ActorPool:
    """See `sim.app.evaluation.workers.WorkerPool`."""

    def __init__(self, spec: RunnerSpec, isolation: Isolation) -> None:
        self._spec, self._isolation = spec, isolation

    def start(self) -> _Actor:
        return _Actor(self._spec, self._isolation)

    def wait(self, workers: Sequence[_Actor]) -> list[_Actor]:
        answers = {worker.answer: worker for worker in workers}
        while True:
            done, _ = ray.wait(list(answers), timeout=WARN_AFTER_S)
            if done:
                return [answers[answer] for answer in done]
            if not any(worker.ready for worker in workers):
                _log.warning("No processor of the Ray cluster is free for one of %d workers.", len(workers))

    def stop(self, workers: Sequence[_Actor]) -> None:
        for worker in workers:
            with contextlib.suppress(RayError):
                ray.kill(worker.actor)


def _check_port(address: str | None) -> None:
    """Raises OSError or ValueError if no process listens; Ray itself takes two minutes to report that."""
    host, colon, port = (address or "").rpartition(":")
    if colon and "://" not in host:
        socket.create_connection((host, int(port)), timeout=CONNECT_TIMEOUT_S).close()


def _versions() -> dict[str, str]:
    return {"code": code_hash(), **{package: version(package) for package in ("mujoco", "numpy")}}


def _require_same(remote: dict[str, str]) -> None:
    """Raises WorkersError if the versions of another machine differ from those of this one."""
    for name, here in _versions().items():
        if remote[name] != here:
            raise WorkersError(
                f"A machine of the Ray cluster has {name} {remote[name]}, this one {here}: identical "
                "results need the same code and packages on all machines."
            )
