"""Players for tests of the runner: real processes, no physics."""

from __future__ import annotations

import os
import signal
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sim.interface import Action, Observation


@dataclass(frozen=True)
class Errand:
    """An item of work; `kill` is a file that gets a letter from each player that dies over it, the first one."""

    episode_id: str
    house: str
    kill: Path | None = None
    always: bool = False
    fail: bool = False


class ErrandPlayer:
    """Answers with its process and how often it had to change houses."""

    def __init__(self) -> None:
        self.house: str | None = None
        self.changes = 0

    def play(self, item: Errand) -> dict[str, Any]:
        if item.kill is not None and (item.always or not item.kill.exists()):
            with item.kill.open("a") as marker:
                marker.write("x")
            os.kill(os.getpid(), signal.SIGKILL)
        if item.fail:
            raise ValueError(f"errand {item.episode_id} cannot be done")
        self.changes += item.house != self.house
        self.house = item.house
        return {"episode_id": item.episode_id, "pid": os.getpid(), "changes": self.changes}

    def close(self) -> None:
        self.house = None


def make_player(config: None) -> ErrandPlayer:
    """Entry point `tests.helpers.players:make_player`."""
    return ErrandPlayer()


def slow_double(milliseconds: int) -> int:
    """Twice as much, after so long."""
    time.sleep(milliseconds / 1000)
    return 2 * milliseconds


def die_the_first_time(marker: Path) -> str:
    """Die, but leave the file `marker`, over which nobody dies again."""
    if not marker.exists():
        die(marker.touch())
    return marker.name


def die(thing: object) -> None:
    """The process ends at once, as if killed."""
    os.kill(os.getpid(), signal.SIGKILL)


class Quitter:
    """An `Agent` that stops at once."""

    def reset(self, goal: str, seed: int) -> None:
        """Nothing to forget."""

    def act(self, observation: Observation) -> Action:
        return Action.STOP


def make_quitter(**known: object) -> Quitter:
    """Entry point `tests.helpers.players:make_quitter`."""
    return Quitter()
