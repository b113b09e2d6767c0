"""Part (h): the same work with one worker and with two."""

from __future__ import annotations

import itertools
import os
import time
from dataclasses import dataclass
from typing import Any

from sim.env import ObjectNavEnv
from sim.episodes import load_split
from sim.executors import Processes
from sim.runner import PlayerSpec
from tools.benchmarks.figures import Figure, Goal
from tools.benchmarks.stages import SENSORS, Rig, Setting, stubborn_agent

ROUNDS = 2


@dataclass(frozen=True)
class Piece:
    """So many steps in a house; see `sim.runner.Item`."""

    episode_id: str
    house: str


class PiecePlayer:
    """Plays pieces of equal work; see `sim.runner.Player`."""

    def __init__(self, steps: int) -> None:
        self._steps = steps
        self._env = ObjectNavEnv(split="val", sensors=SENSORS)
        self._agent = stubborn_agent(self._env)
        self._rigs: dict[str, Rig] = {}

    def play(self, piece: Piece) -> dict[str, Any]:
        """So many steps of the house's episodes, and the process that played them."""
        if piece.house not in self._rigs:
            here = [episode for episode in self._env.split.episodes if episode.house == piece.house]
            self._rigs = {piece.house: Rig(self._env, self._agent, here, stops=False)}
            self._rigs[piece.house].step()
        for _ in range(self._steps):
            self._rigs[piece.house].step()
        return {"episode_id": piece.episode_id, "pid": os.getpid()}

    def close(self) -> None:
        """Free the renderer."""
        self._env.close()


def two_workers(setting: Setting) -> list[Figure]:
    """(h) Steps a second of two workers against one, while all of them have something to do."""
    amount = setting.amount
    houses = load_split("val").houses[:2]
    pieces = [Piece(str(i), house) for i, house in zip(range(amount.pieces), itertools.cycle(houses))]
    rates: dict[int, list[float]] = {1: [], 2: []}
    for _ in range(ROUNDS if amount.pieces > 8 else 1):
        for workers, found in rates.items():
            found.append(amount.piece_steps * _pieces_a_second(pieces, workers, amount.piece_steps))
    one, two = max(rates[1]), max(rates[2])
    goal = Goal(of="ratio", sign=">=", bound=1.7)
    return [
        Figure(part="h", what="steps a second, 2 workers", value=two, unit="/s", against="1 worker", baseline=one,
               ratio=two / one, goal=goal, count=len(pieces))
    ]  # fmt: skip


def _pieces_a_second(pieces: list[Piece], workers: int, steps: int) -> float:
    """Pieces of so many steps, from when every worker has ended one to when the first has nothing to do."""
    spec = PlayerSpec("tools.benchmarks.scaling:PiecePlayer", steps)
    ended: list[tuple[float, int]] = []
    began_s = time.perf_counter()
    for line in Processes(workers).run(spec, pieces, on_death=_never):
        ended.append((time.perf_counter(), line["pid"]))
    first = next(i for i in range(len(ended)) if len({pid for _, pid in ended[: i + 1]}) == workers)
    last = len(ended) - workers
    if last <= first:  # too few to say
        return len(ended) / (ended[-1][0] - began_s)
    return (last - first) / (ended[last][0] - ended[first][0])


def _never(piece: Piece) -> Any:
    raise RuntimeError(f"A worker died twice in house '{piece.house}'.")
