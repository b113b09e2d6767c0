"""What a home's rooms ask furniture from: one pool, one random stream, and the home's own style."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np

from sim.houses import materials
from sim.houses.furniture import CATALOGUE, make_item, styles
from sim.houses.furniture.item import Item, Look, Pool

T = TypeVar("T")


class Kit:
    """Makes items for one home. What should look alike all over it (dining chairs, door handles) is made once."""

    def __init__(self, rng: np.random.Generator, pool: Pool, clutter: float, home_rooms: frozenset[str]) -> None:
        self.rng = rng
        self.pool: Pool = pool
        self.clutter = clutter
        """0 bare, 1 full of things."""
        self.home_rooms = home_rooms
        """Kinds of rooms that the home has."""
        self._same: dict[tuple[str, str], Item | None] = {}

    def make(self, category: str, *uses: str, **hints: Any) -> Item | None:
        """An item for the first of these uses that the pool has a style for, for any use when none is given.

        Returns None where the pool has nothing that fits.
        """
        if category not in CATALOGUE:
            return None
        for use in uses or (None,):
            if styles(category, self.pool, use):
                return make_item(category, self.rng, pool=self.pool, **({"use": use} if use else {}), **hints)
        return None

    def same(self, category: str, use: str) -> Item | None:
        """The home's one item of this kind: what one buys by the dozen, such as ceiling lamps."""
        if (category, use) not in self._same:
            self._same[category, use] = self.make(category, use)
        return self._same[category, use]

    def looks(self, *names: str) -> dict[str, Look]:
        """Fixed looks of some materials, for hint `looks`: things that should match."""
        return {name: materials.look(name, self.rng, self.pool) for name in names}

    def chance(self, probability: float) -> bool:
        """True with this probability."""
        return bool(self.rng.random() < probability)

    def clutter_chance(self, usual: float) -> bool:
        """True with the usual probability at clutter 0.5; never at 0, about twice as often at 1."""
        return self.chance(min(1.0, 2.0 * usual * self.clutter))

    def pick(self, options: Sequence[T]) -> T:
        """One of the options."""
        return options[int(self.rng.integers(len(options)))]

    def uniform(self, low: float, high: float) -> float:
        """A number between both."""
        return float(self.rng.uniform(low, high))
