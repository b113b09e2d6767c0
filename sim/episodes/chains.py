"""Draws chains of goals in a house: 5 to 10 goals of mixed kinds, of which some ask for an earlier goal once more.

- The objects of a goal are none of an earlier goal's, unless it is a second visit, which asks for just the same
  objects, in the same or in other words. At least one other goal lies between the two visits.
- From every place where a STOP for a goal succeeds there is a path to the next goal, of at least `MIN_APART_M`: no
  goal is reached before it was asked for.

A kind of goals is an entry of `KINDS` of the command that calls this, a function that lists goals of a house.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim.core.goals import GoalSpec
from sim.task.objectnav import Task

MIN_GOALS, MAX_GOALS = 5, 10
MIN_APART_M = 1.0
"""Length of the shortest path from a place where a STOP succeeds to the next goal."""
SECOND_VISITS = 0.3
"""Share of second visits among the goals from the third on, as far as the house allows."""


@dataclass(frozen=True)
class _Asked:
    """A goal with the labels of its objects."""

    goal: GoalSpec
    objects: frozenset[str]


class ChainDrawer:
    """Draws chains on one storey of a house.

    Args:
        task: of the house.
        goals: the goals of each kind in a random order; those that cannot be reached on the storey are left out.
        floor_z_m: height of the storey's floor.
    """

    def __init__(self, task: Task, goals: Mapping[str, Sequence[GoalSpec]], floor_z_m: float) -> None:
        self._task, self._floor_z_m = task, floor_z_m
        self._inside = task.truth.space(floor_z_m).largest_part()
        self.goals = {kind: [self._asked(goal) for goal in of_kind] for kind, of_kind in goals.items()}
        self.goals = {kind: [a for a in of_kind if self._is_reachable(a.goal)] for kind, of_kind in self.goals.items()}

    def draw(self, rng: np.random.Generator) -> tuple[GoalSpec, ...]:
        """Returns a chain; (): the house has too few goals. Kinds take turns in a random order."""
        length = int(rng.integers(MIN_GOALS, MAX_GOALS + 1))
        chain: list[_Asked] = []
        kinds: list[str] = []
        while len(chain) < length:
            again = len(chain) >= 2 and rng.random() < SECOND_VISITS
            following = self._second_visit(chain, rng) if again else None
            kinds = kinds or list(rng.permutation(list(self.goals)))
            following = following or self._first_visit(chain, kinds, rng)
            if following is None:
                break
            chain.append(following)
        return tuple(asked.goal for asked in chain) if len(chain) >= MIN_GOALS else ()

    def _first_visit(self, chain: list[_Asked], kinds: list[str], rng: np.random.Generator) -> _Asked | None:
        """Returns a goal with new objects, of the next kind that has one; None: there is none."""
        used = frozenset[str]().union(*(asked.objects for asked in chain))
        for kind in [*kinds, *self.goals]:
            fitting = [asked for asked in self.goals[kind] if not asked.objects & used]
            for number in rng.permutation(len(fitting)).tolist():
                if not chain or self._is_apart(chain[-1].goal, fitting[number].goal):
                    if kind in kinds:
                        kinds.remove(kind)
                    return fitting[number]
        return None

    def _second_visit(self, chain: list[_Asked], rng: np.random.Generator) -> _Asked | None:
        """Returns a goal that asks for the objects of an earlier one, at most once each; None: there is none."""
        twice = {asked.goal.repeats for asked in chain}
        earlier = [i for i, asked in enumerate(chain[:-1]) if i not in twice and asked.goal.repeats is None]
        for number in rng.permutation(earlier).tolist() if earlier else []:
            first = chain[number]
            words = [
                asked.goal for of_kind in self.goals.values() for asked in of_kind if asked.objects == first.objects
            ]
            goal = words[int(rng.integers(len(words)))]
            if self._is_apart(chain[-1].goal, goal):
                return _Asked(replace(goal, repeats=number), first.objects)
        return None

    def _asked(self, goal: GoalSpec) -> _Asked:
        return _Asked(goal, frozenset(instance.name for instance in self._task.truth.instances(goal)))

    def _is_reachable(self, goal: GoalSpec) -> bool:
        target = self._task.truth.target(goal.text, self._floor_z_m)
        return bool((target.reached & self._inside).any())

    def _is_apart(self, before: GoalSpec, after: GoalSpec) -> bool:
        """Returns whether the path from each place where a STOP for one goal succeeds to the next is long enough."""
        ends = self._task.truth.target(before.text, self._floor_z_m).reached & self._inside
        lengths_m = self._task.truth.target(after.text, self._floor_z_m).distance_m[ends]
        return bool(np.isfinite(lengths_m).all() and lengths_m.min() >= MIN_APART_M)
