"""Holds the requests of the page's users, shared between the server and the thread that simulates."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple

from sim.app.evaluation.results import RunRecord
from sim.app.options import RunOptions
from sim.core.errors import ConfigError
from sim.core.interface import MOVES, Action

Driver = Literal["agent", "person"]
SPEEDS = (1.0, 2.0, 5.0, 60.0)
"""Actions per second that the page offers; the last is as fast as the machine allows."""
_WAITING_ACTIONS = 4
"""Largest number of a person's actions that wait. Older ones are dropped, so that the robot stops soon after a key is
released."""


class Interrupted(KeyboardInterrupt):
    """The episode must end without a result: a user has requested another one or ended it, or the server stops.

    Any error but a KeyboardInterrupt would count as a failure of the agent (`sim.app.evaluation.rollout.ask`).
    """


@dataclass(frozen=True, kw_only=True)
class EpisodeRequest:
    """A user's request for an episode (`sim.app.web.choices` makes it)."""

    split: str
    house: str
    goal: str
    episode_id: str | None = None
    """Id of the episode; None: another one of this house and goal each time."""
    driver: Driver = "agent"
    options: RunOptions
    """Options of the run that the episode belongs to; they name agent, segmentation and explorer."""
    record: RunRecord | None = None
    """The `config.json` of the finished run to which the episode belongs; None: it belongs to none."""

    def as_json(self) -> dict[str, object]:
        """Returns the part that the page shows, as JSON types."""
        chosen: dict[str, object] = {
            name: getattr(self, name) for name in ("split", "house", "goal", "episode_id", "driver")
        }
        options = self.options
        return chosen | {"agent": options.agent, "semantics": options.semantics, "explorer": options.explorer or ""}


class Choice(NamedTuple):
    """The action that is due, and its source: the agent or a person."""

    action: Action
    driver: Driver


class Controls:
    """The state of the controls; all methods may be called from any thread."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._request: EpisodeRequest | None = None
        self._actions: deque[Action] = deque(maxlen=_WAITING_ACTIONS)
        self._steps, self._stopping, self._closed, self._redraw = 0, False, False, False
        self._next_s = 0.0
        self._alone = False
        """True: the episode has no goal, and only a person drives."""
        self.driver: Driver = "agent"
        self.paused = self.hints = False
        self.per_s = SPEEDS[1]

    def obey(self, message: Mapping[str, object]) -> None:
        """Carries out one command of the page.

        Args:
            message: `do` is pause, run, step, speed (`per_s`), hints (`on`), agent, person, act (`action`) or stop.

        Raises:
            ConfigError: there is no such command, or its value is not allowed.
        """
        do = message.get("do")
        with self._changed:
            if do in ("pause", "run"):
                self.paused, self._steps = do == "pause", 0
            elif do == "step":
                self.paused, self._steps = True, min(self._steps + 1, _WAITING_ACTIONS)
            elif do == "speed":
                self.per_s = _speed(message.get("per_s"))
                self._next_s = 0.0
            elif do == "hints":
                self.hints, self._redraw = message.get("on") is True, True
            elif do == "agent" and self._alone:
                raise ConfigError("This episode has no goal, and so no agent to hand back to.")
            elif do in ("agent", "person"):
                self._hand_to("agent" if do == "agent" else "person")
            elif do == "act":
                action = _action(message.get("action"))
                self._hand_to("person")
                self._actions.append(action)
            elif do == "stop":
                self._stopping = True
            else:
                raise ConfigError(f"There is no command {str(do)[:40]!r}.")
            self._changed.notify_all()

    def redraw(self) -> None:
        """Requests the pictures of the current moment again, because a client shows others."""
        with self._changed:
            self._redraw = True
            self._changed.notify_all()

    def ask_for(self, request: EpisodeRequest) -> None:
        """Stores a request for another episode; the running one ends."""
        with self._changed:
            self._request = request
            self._changed.notify_all()

    def close(self) -> None:
        """Ends the episode, and all calls that wait."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()

    def next_request(self) -> EpisodeRequest | None:
        """Waits for a request, prepares the controls for it and returns it; None when the server stops."""
        with self._changed:
            self._changed.wait_for(lambda: self._request is not None or self._closed)
            if self._closed:
                return None
            request, self._request = self._request, None
            assert request is not None
            self._stopping, self._steps, self._next_s = False, 0, 0.0
            self.paused, self._alone = False, not request.goal
            self._actions.clear()
            self._hand_to(request.driver)
            return request

    def choose(self, advised: Action) -> Choice | None:
        """Waits until an action is due and returns it: `advised`, the agent's action, or that of a person.

        Returns None if the current moment must be shown again.

        Raises:
            Interrupted: the episode must end.
        """
        with self._changed:
            while True:
                if self._closed or self._stopping or self._request is not None:
                    raise Interrupted
                if self._redraw:
                    self._redraw = False
                    return None
                if self.driver == "person":
                    if self._actions:
                        return Choice(self._actions.popleft(), "person")
                    wait_s = None
                elif self._steps > 0:
                    self._steps -= 1
                    return Choice(advised, "agent")
                else:
                    wait_s = None if self.paused else self._next_s - time.monotonic()
                    if wait_s is not None and wait_s <= 0.0:
                        self._next_s = time.monotonic() + 1.0 / self.per_s
                        return Choice(advised, "agent")
                self._changed.wait(wait_s)

    def _hand_to(self, driver: Driver) -> None:
        if driver != self.driver:
            self._actions.clear()
        self.driver = driver


def _speed(value: object) -> float:
    if not isinstance(value, (int, float)) or isinstance(value, bool) or value not in SPEEDS:
        raise ConfigError(f"The speed must be one of {', '.join(f'{speed:g}' for speed in SPEEDS)} actions per second.")
    return float(value)


def _action(value: object) -> Action:
    if isinstance(value, bool) or value not in MOVES:
        raise ConfigError(f"The action must be one of {', '.join(str(int(action)) for action in MOVES)}.")
    return Action(value)
