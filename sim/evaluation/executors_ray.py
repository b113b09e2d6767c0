"""Work on the machines of a Ray cluster (https://docs.ray.io), an extra: `pip install 'stubborn-objectnav[ray]'`.

Every machine needs the same code installed, at the same versions; a worker where that is not so is refused. Workers go
to the folder in which the run was started, where their machine has it, so that relative paths mean the same.
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

from sim.errors import ConfigError, WorkersError
from sim.evaluation.workers import Bench, ItemT, PlayerSpec, WorkerLost, play_with
from sim.paths import code_hash

try:
    ray: Any = importlib.import_module("ray")  # by its name: who type-checks this need not have it
except ModuleNotFoundError:
    raise ConfigError("--executor ray needs the extra `ray`: pip install 'stubborn-objectnav[ray]'.") from None
RayError, RayTaskError = ray.exceptions.RayError, ray.exceptions.RayTaskError

KNOCK_S = 5.0
NO_ROOM_TOLD_AFTER_S = 30.0
_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class RayCluster:
    """One processor a worker, wherever in the cluster there is one free."""

    workers: int

    @classmethod
    def connect(cls, address: str | None = None, *, workers: int) -> RayCluster:
        """Join a cluster, once a process.

        Args:
            address: `HOST:PORT` of its head; None: the one that this machine belongs to.
            workers: how many at most; those for which there is no room do not start.

        Raises:
            ConfigError: there is no cluster.
        """
        if not ray.is_initialized():
            try:
                _knock(address)
                ray.init(address=address or "auto", log_to_driver=False, logging_level=logging.ERROR)
            except (OSError, RuntimeError, ValueError) as error:  # ConnectionError, or what gRPC makes of it
                told = str(error).strip().split("\n")[0]
                raise ConfigError(
                    f"No Ray cluster answers at --address {address or 'auto'} ({told}). Start one with "
                    "`ray start --head` and join it from other machines with `ray start --address HOST:6379`."
                ) from None
        return cls(workers)

    def run(self, spec: PlayerSpec, items: Sequence[ItemT], *, on_death: Callable[[ItemT], Any]) -> Iterator[Any]:
        """See `sim.evaluation.executors.Executor`."""
        yield from play_with(_Actors(spec), items, size=self.workers, on_death=on_death)


class Station:
    """The actor: what a worker is on its machine."""

    def __init__(self, spec: PlayerSpec, folder: str) -> None:
        if os.path.isdir(folder):
            os.chdir(folder)
        self._bench = Bench(spec)

    def about(self) -> dict[str, str]:
        """What must be the same everywhere."""
        return _about_here()

    def play(self, item: Any) -> Any:
        """See `Bench.play`."""
        return self._bench.play(item)


class _Actor:
    """See `sim.evaluation.workers.Worker`."""

    def __init__(self, spec: PlayerSpec) -> None:
        # A lost actor is replaced by `sim.evaluation.workers`, which knows what it was doing.
        options = {"num_cpus": 1, "max_restarts": 0, "max_task_retries": 0, "scheduling_strategy": "SPREAD"}
        self.actor: Any = ray.remote(Station).options(**options).remote(spec, os.getcwd())
        self.answer: Any = self.actor.about.remote()
        self.ready = False

    def send(self, item: Any) -> None:
        self.answer = self.actor.play.remote(item)

    def receive(self) -> Any:
        try:
            said: Any = ray.get(self.answer)
        except RayTaskError as error:
            raise WorkersError(f"A worker of the Ray cluster cannot work: {error.cause}") from None
        except RayError as error:
            raise WorkerLost(str(error).strip().split("\n")[0]) from None
        if not self.ready:
            _require_same(said)
            self.ready = True
        return said


class _Actors:
    """See `sim.evaluation.workers.Crew`."""

    def __init__(self, spec: PlayerSpec) -> None:
        self._spec = spec

    def hire(self) -> _Actor:
        return _Actor(self._spec)

    def wait(self, workers: Sequence[_Actor]) -> list[_Actor]:
        answers = {worker.answer: worker for worker in workers}
        while True:
            done, _ = ray.wait(list(answers), timeout=NO_ROOM_TOLD_AFTER_S)
            if done:
                return [answers[answer] for answer in done]
            if not any(worker.ready for worker in workers):
                _log.warning("No processor of the Ray cluster is free for one of %d workers.", len(workers))

    def dismiss(self, workers: Sequence[_Actor]) -> None:
        for worker in workers:
            with contextlib.suppress(RayError):
                ray.kill(worker.actor)


def _knock(address: str | None) -> None:
    """Raise OSError or ValueError where nobody listens: Ray itself takes two minutes to say so."""
    host, colon, port = (address or "").rpartition(":")
    if colon and "://" not in host:
        socket.create_connection((host, int(port)), timeout=KNOCK_S).close()


def _about_here() -> dict[str, str]:
    return {"code": code_hash(), **{package: version(package) for package in ("mujoco", "numpy")}}


def _require_same(there: dict[str, str]) -> None:
    for name, here in _about_here().items():
        if there[name] != here:
            raise WorkersError(
                f"A machine of the Ray cluster has {name} {there[name]}, this one {here}: the same lines need the same "
                "code and packages everywhere."
            )
