"""Brute-force untrap mode (paper: Path Planning Module): turn and push until a forward moves the robot.

The paper's robot is round and can always turn. The shoulder of another one may touch something at its side, so that
turns are blocked: then the mode begins too, with a turn to the other side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from sim.core.interface import Action, ConfigError

_BLOCKED_TURNS = 2
"""The mode begins after this many turns that did not turn the robot, without a forward or another turn between."""
_OTHER_SIDE = {Action.TURN_LEFT: Action.TURN_RIGHT, Action.TURN_RIGHT: Action.TURN_LEFT}


@dataclass(frozen=True, kw_only=True)
class UntrapConfig:
    """Defines when the mode begins."""

    failed_forwards: int = 10
    """The mode begins after this many failed forwards without one that moved the robot."""
    turns_reset: bool = True
    """True: a turn that turned the robot resets the count, so that the failed forwards are consecutive steps as in the
    paper's text. False: only a forward that moved the robot does, as in the published code."""

    def __post_init__(self) -> None:
        if self.failed_forwards < 1:
            raise ConfigError(f"UntrapConfig.failed_forwards must be >= 1, got {self.failed_forwards}.")


class Untrap:
    """Counts failed forwards and, once the robot is trapped, alternates a turn and a forward until a forward moves.

    The side of the turns alternates from one entry to the next, left first in every episode.
    """

    def __init__(self, failed_forwards: float, *, turns_reset: bool = True) -> None:
        """The mode begins after `failed_forwards` failed forwards, see `UntrapConfig`; infinite: never."""
        self.failed_forwards = failed_forwards
        self.turns_reset = turns_reset
        self.reset()

    def reset(self) -> None:
        """Forgets the last episode."""
        self._failed = 0
        self._blocked_turns = 0
        self.active = False
        """True while the mode chooses the actions."""
        self._side = Action.TURN_RIGHT  # the first entry turns to the other side
        self._turn_next = True

    def observe(self, action: Action | None, failed: bool) -> None:
        """Notes the outcome of the last action.

        Args:
            action: the action; None: there was none.
            failed: for a forward, as in `stubborn.mapping.collision_marks.is_collision`; for a turn, True if the robot
                did not turn.
        """
        if action is Action.MOVE_FORWARD:
            self._failed, self._blocked_turns = self._failed + 1 if failed else 0, 0
            self.active = self.active and failed
            if self._failed >= self.failed_forwards:
                self._begin(_OTHER_SIDE[self._side])
        elif action is Action.TURN_LEFT or action is Action.TURN_RIGHT:
            self._blocked_turns = self._blocked_turns + 1 if failed else 0
            if self.turns_reset and not failed:
                self._failed = 0
            if self._blocked_turns >= _BLOCKED_TURNS and math.isfinite(self.failed_forwards):
                self._begin(_OTHER_SIDE[action])

    def _begin(self, side: Action) -> None:
        """Begins the mode with a turn to a side, if it is not active."""
        if not self.active:
            self.active, self._side, self._turn_next = True, side, True

    def next_action(self) -> Action | None:
        """Returns the action of the mode, or None while the robot is not trapped."""
        if not self.active:
            return None
        turn, self._turn_next = self._turn_next, not self._turn_next
        return self._side if turn else Action.MOVE_FORWARD
