"""Part (h): the same work with one worker and with two."""

from __future__ import annotations

import os
import time
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from sim.app.commands.bench.figures import Figure, Goal
from sim.app.commands.bench.stages import SENSORS, Rig, Setting, stubborn_agent
from sim.app.evaluation.processes import Processes
from sim.app.evaluation.workers import RunnerSpec
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.splits import load_split

ROUNDS = 2


@dataclass(frozen=True)
class Piece:
    """A number of steps in a house; see `sim.app.evaluation.workers.WorkItem`."""

    episode_id: str
    house: str


class PieceRunner:
    """Runs pieces of equal work; see `sim.app.evaluation.workers.Runner`."""

    def __init__(self, steps: int) -> None:
        cv2.setNumThreads(1)
        self._steps = steps
        self._env = ObjectNavEnv(split="val", sensors=SENSORS)
        self._agent = stubborn_agent(self._env)
        self._rigs: dict[str, Rig] = {}

    def run(self, piece: Piece) -> dict[str, Any]:
        """Runs steps of the episodes of a house and returns the process id and its processor time."""
        if piece.house not in self._rigs:
            episodes = [episode for episode in self._env.split.episodes if episode.house == piece.house]
            self._rigs = {piece.house: Rig(self._env, self._agent, episodes, stops=False)}
            self._rigs[piece.house].step()
        began_s = time.process_time()
        for _ in range(self._steps):
            self._rigs[piece.house].step()
        return {"episode_id": piece.episode_id, "pid": os.getpid(), "cpu_s": time.process_time() - began_s}

    def close(self) -> None:
        """Frees the renderer."""
        self._env.close()


def two_workers(setting: Setting) -> list[Figure]:
    """(h) Measures steps per second of two workers against one, while all are busy."""
    amount = setting.amount
    (house, *_), count = load_split("val").houses, amount.pieces
    pieces = [Piece(str(number), house) for number in range(count)]
    rates: dict[int, list[tuple[float, float]]] = {1: [], 2: []}
    for _ in range(ROUNDS if count > 8 else 1):
        for workers, found in rates.items():
            found.append(_steps_a_second(pieces, workers, amount.piece_steps))
    (one, one_cpu), (two, two_cpu) = (np.max(rates[workers], axis=0).tolist() for workers in (1, 2))
    goal = Goal(of="ratio", sign=">=", bound=1.7)
    return [
        Figure(part="h", what="steps a second, 2 workers", value=two, unit="/s", against="1 worker", baseline=one,
               ratio=two / one, goal=goal, count=count),
        Figure(part="h", what="steps a second of processor time, 2 workers", value=two_cpu, unit="/s",
               against="1 worker", baseline=one_cpu, ratio=two_cpu / one_cpu, count=count),
    ]  # fmt: skip


def _steps_a_second(pieces: list[Piece], workers: int, steps: int) -> tuple[float, float]:
    """Returns steps per second, from when every worker has ended a piece to when the first is idle.

    The second value is per second of processor time, which depends little on other processes of the machine.
    """
    spec = RunnerSpec("sim.app.commands.bench.scaling:PieceRunner", steps)
    ended: list[tuple[float, int]] = []
    cpu_s, began_s = 0.0, time.perf_counter()
    for line in Processes(workers).run(spec, pieces, on_death=_raise):
        ended.append((time.perf_counter(), line["pid"]))
        cpu_s += line["cpu_s"]
    of_processors = steps * len(ended) / cpu_s
    first = next(i for i in range(len(ended)) if len({pid for _, pid in ended[: i + 1]}) == workers)
    last = len(ended) - workers
    if last <= first:  # too few pieces to measure that interval
        return steps * len(ended) / (ended[-1][0] - began_s), of_processors
    return steps * (last - first) / (ended[last][0] - ended[first][0]), of_processors


def _raise(piece: Piece, reason: str) -> Any:
    raise RuntimeError(f"House '{piece.house}': {reason}")
