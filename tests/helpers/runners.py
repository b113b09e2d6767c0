"""Runners and agents for tests, without physics."""

from __future__ import annotations

import atexit
import os
import signal
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sim.app.evaluation.watch import count_steps, marked
from sim.core.interface import Action, Observation


@dataclass
class Script:
    """An agent that reads its actions from a list."""

    actions: list[Action]
    before: Callable[[int], None] = lambda _: None
    """Called before each action with the number of actions before it."""

    def reset(self, goal: str, seed: int) -> None:
        self.goal, self.left = goal, list(self.actions)

    def act(self, observation: object) -> Action:
        self.before(len(self.actions) - len(self.left))
        return self.left.pop(0)


class OwnError(BaseException):
    """An error of a user that cannot be unpickled."""

    def __init__(self, first: str, second: str) -> None:
        super().__init__(first)


def _loop() -> None:
    while True:
        pass


def _start_thread() -> None:
    threading.Thread(target=time.sleep, args=(300,)).start()
    atexit.register(time.sleep, 300)


def _raise() -> None:
    raise OwnError("first", "second")


HANGING = {
    "loop": _loop,
    "kernel": lambda: sum(range(10**13)),  # it does not return to the interpreter
    "stop": lambda: os.kill(os.getpid(), signal.SIGSTOP),
    "thread": _start_thread,
    "raise": _raise,
}
"""Actions of a user's code on its process, by name."""


@dataclass(frozen=True)
class Job:
    """A work item; `kill` is a file that gets a letter from each worker that the item kills (only the first)."""

    episode_id: str
    house: str
    kill: Path | None = None
    always: bool = False
    fail: bool = False
    hang: str = ""


class JobRunner:
    """A runner whose result line holds its process id and how often it changed houses; a letter of an id is a step."""

    def __init__(self) -> None:
        self.house: str | None = None
        self.changes = 0

    def run(self, item: Job) -> dict[str, Any]:
        if item.kill is not None and (item.always or not item.kill.exists()):
            with item.kill.open("a") as marker:
                marker.write("x")
            os.kill(os.getpid(), signal.SIGKILL)
        if item.hang:
            with marked(f"The job {item.episode_id}"):
                HANGING[item.hang]()
        if item.fail:
            raise ValueError(f"{item.episode_id} cannot be done")
        count_steps(len(item.episode_id))
        self.changes += item.house != self.house
        self.house = item.house
        return {"episode_id": item.episode_id, "pid": os.getpid(), "changes": self.changes}

    def close(self) -> None:
        self.house = None


def make_runner(config: None) -> JobRunner:
    """Entry point `tests.helpers.runners:make_runner`."""
    return JobRunner()


def slow_double(milliseconds: int) -> int:
    """Returns twice the number after that number of milliseconds."""
    time.sleep(milliseconds / 1000)
    return 2 * milliseconds


def die_the_first_time(marker: Path) -> str:
    """Creates the file `marker` and kills the process; returns the file's name if it already exists."""
    if not marker.exists():
        die(marker.touch())
    return marker.name


def write_pid_and_sleep(marker: Path) -> None:
    """Writes the id of this process to a file, and sleeps longer than any test."""
    marker.write_text(str(os.getpid()))
    time.sleep(300)


def die(item: object) -> None:
    """Kills the process."""
    os.kill(os.getpid(), signal.SIGKILL)


class Faulty(Exception):
    """An error in an agent of a user."""


class FaultyAgent:
    """An `Agent` that raises at its second action if the file `$STUBBORN_TEST_FAULT` exists, and stops at its third."""

    def reset(self, goal: str, seed: int) -> None:
        self.step = 0

    def act(self, observation: Observation) -> Action:
        self.step += 1
        if self.step == 2 and Path(os.environ["STUBBORN_TEST_FAULT"]).exists():
            raise Faulty("it [bold]broke[/bold]")
        return Action.TURN_LEFT if self.step < 3 else Action.STOP


def make_faulty(**options: object) -> FaultyAgent:
    """Entry point `tests.helpers.runners:make_faulty`."""
    return FaultyAgent()


class Quitter:
    """An `Agent` that stops at once."""

    def reset(self, goal: str, seed: int) -> None:
        """Does nothing: the agent has no state."""

    def act(self, observation: Observation) -> Action:
        return Action.STOP


def make_unable(**options: object) -> Quitter:
    """Entry point of an agent whose actions are none."""
    agent = Quitter()
    agent.act = lambda observation: "left"  # type: ignore[method-assign,assignment,return-value]
    return agent


def make_quitter(**options: object) -> Quitter:
    """Entry point `tests.helpers.runners:make_quitter`."""
    return Quitter()
