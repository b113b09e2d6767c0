"""What other nodes ask of the robot, kept between the thread of ROS 2 and that of the simulation; and its pace."""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from sim.core.interface import MOVES, Action


@dataclass
class Counts:
    """Numbers of messages and periods of an episode."""

    commands: int = 0
    """Velocities or actions that arrived."""
    refused_commands: int = 0
    """Those of them that were not finite, no action, or too late."""
    periods: int = 0
    late_periods: int = 0
    """Periods that began later than the pace asks for, because the simulation is slower."""
    messages: int = 0
    """Messages that were published."""
    failed_messages: int = 0
    """Those that ROS 2 refused."""


@dataclass
class Requests:
    """The requests of other nodes that have not been carried out. All methods may be called from any thread."""

    counts: Counts = field(default_factory=Counts)
    stop_target: tuple[float, float] | None = None
    """The place for which the next STOP is, in the start frame."""
    stop_confidence: float | None = None
    _changed: threading.Condition = field(default_factory=threading.Condition)
    _velocity: tuple[float, float] = (0.0, 0.0)
    _velocity_at_s: float = -math.inf
    _actions: deque[Action] = field(default_factory=deque)
    _flags: set[str] = field(default_factory=set)
    """Of `stop`, `step`, `reset` and `next_episode`."""
    _paused: bool = False
    _running: bool = False

    def begin(self) -> None:
        """Forgets the requests for the last episode; a pause stays."""
        with self._changed:
            self._running = True
            self.counts = Counts()
            self.stop_target = self.stop_confidence = None
            self._velocity, self._velocity_at_s = (0.0, 0.0), -math.inf
            self._actions.clear()
            self._flags.clear()

    def end(self) -> None:
        """Refuses further flags until the next episode begins."""
        with self._changed:
            self._running = False

    def command(self, speed_m_s: float, rate_rad_s: float, now_s: float) -> None:
        """Takes a velocity at a simulated time; one that is not finite is refused."""
        with self._changed:
            self.counts.commands += 1
            if math.isfinite(speed_m_s) and math.isfinite(rate_rad_s):
                self._velocity, self._velocity_at_s = (speed_m_s, rate_rad_s), now_s
            else:
                self.counts.refused_commands += 1

    def velocity(self, now_s: float, timeout_s: float) -> tuple[float, float]:
        """Returns the velocity that holds at a simulated time; a command that is older than the timeout has ended."""
        with self._changed:
            return self._velocity if now_s - self._velocity_at_s <= timeout_s else (0.0, 0.0)

    def act(self, number: int) -> None:
        """Takes a discrete action; another number is refused."""
        with self._changed:
            self.counts.commands += 1
            if number in MOVES:
                self._actions.append(Action(number))
                self._changed.notify_all()
            else:
                self.counts.refused_commands += 1

    def discard_actions(self) -> None:
        """Refuses the actions that were chosen before the next observation."""
        with self._changed:
            self.counts.refused_commands += len(self._actions)
            self._actions.clear()

    def action(self, within_s: float) -> Action | None:
        """Returns the next action; without one, None after the time or as soon as a flag other than `step` is up."""
        with self._changed:
            self._changed.wait_for(lambda: bool(self._actions or self._flags - {"step"}), within_s)
            if "stop" in self._flags:
                self._flags.discard("stop")
                return Action.STOP
            return self._actions.popleft() if self._actions else None

    def raise_flag(self, name: str) -> str | None:
        """Asks for something that happens once.

        Returns:
            Why the request is refused: no episode is running, or `step` without a pause; None: it is accepted.
        """
        with self._changed:
            if not self._running:
                return "No episode is running."
            if name == "step" and not self._paused:
                return "Time is not paused."
            self._flags.add(name)
            self._changed.notify_all()
            return None

    def take(self, name: str) -> bool:
        """Returns whether something was asked for, and forgets it."""
        with self._changed:
            asked = name in self._flags
            self._flags.discard(name)
            return asked

    def asked(self, name: str) -> bool:
        """Returns whether something is asked for; the request stays."""
        with self._changed:
            return name in self._flags

    def pause(self, paused: bool) -> None:
        """Stops or starts simulated time."""
        with self._changed:
            self._paused = paused
            if not paused:
                self._flags.discard("step")
            self._changed.notify_all()

    @property
    def paused(self) -> bool:
        """True: simulated time stands still."""
        with self._changed:
            return self._paused

    def wait(self, within_s: float) -> None:
        """Waits until a flag is up or the pause changes, at most for a time."""
        with self._changed:
            paused = self._paused
            self._changed.wait_for(lambda: bool(self._flags) or self._paused != paused, within_s)


class Pace:
    """The wall time at which each period begins.

    Args:
        period_s: simulated time of a period.
        speed: simulated seconds in a second; 0: as fast as possible.
        now: returns the time, seconds.
    """

    def __init__(self, period_s: float, speed: float, now: Callable[[], float] = time.monotonic) -> None:
        self._wall_s = period_s / speed if speed > 0.0 else 0.0
        self._now = now
        self.restart()

    def restart(self) -> None:
        """Lets the next period begin now."""
        self._next_s = self._now()

    def remaining_s(self) -> float:
        """Returns the time until the next period, at least 0."""
        return max(0.0, self._next_s - self._now())

    def begin(self) -> bool:
        """Begins a period; returns whether it is late by more than a period, so that the pace starts anew."""
        now_s = self._now()
        late = self._wall_s > 0.0 and now_s - self._next_s > self._wall_s
        self._next_s = (now_s if late else self._next_s) + self._wall_s
        return late
