"""Computes the next action on the true shortest path, as a hint for a person who drives."""

from __future__ import annotations

from sim.core.interface import Action
from sim.env.objectnav import ObjectNavEnv
from sim.env.oracle import Oracle


class Hints:
    """The hints of one episode: the next action of the oracle."""

    def __init__(self, env: ObjectNavEnv, goal: str) -> None:
        self._env, self._goal = env, goal
        self._oracle = Oracle(env)
        self._step: int | None = None
        self._given: Action | None = None

    def at(self, step: int, last: Action | None) -> Action | None:
        """Returns the oracle's next action; None if the goal cannot be reached.

        Args:
            step: number of actions so far.
            last: the last of these actions; None: no action was taken.
        """
        if step == self._step:
            return self._given
        # The oracle takes any other action for a blocked step; it is reset unless the person followed its hint.
        followed = self._step is not None and step == self._step + 1 and last == self._given
        reachable = self._env.scene.task.goal_metrics().distance_to_goal is not None
        if reachable and not followed:
            self._oracle.reset(self._goal, 0)
        self._given = self._oracle.act({}) if reachable else None
        self._step = step
        return self._given
