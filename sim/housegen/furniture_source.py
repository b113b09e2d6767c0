"""Selects and makes the furniture of one home: from one pool, with one random generator, in few designs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any, TypeVar

import numpy as np

from sim.housegen import materials
from sim.housegen.furniture import CATALOGUE
from sim.housegen.furniture.catalogue import Catalogue
from sim.housegen.furniture.item import Item, Look, Pool

T = TypeVar("T")
DESIGNS: Mapping[str, int] = MappingProxyType(
    {
        "objects": 4, "picture": 6, "cushion": 4, "floor": 3, "bed": 3, "plant": 2, "mirror": 2, "cabinet": 2,
        "shelving": 2, "towel": 2, "lighting": 2, "stool": 2, "sink": 2, "tv_monitor": 2, "gym_equipment": 99,
    }
)  # fmt: skip
"""Largest number of designs of a category for each use in one home; 1 for the other categories."""
SETS = frozenset(("counter",))
"""Categories of which a home has one style only, in any size."""
ONE_DESIGN = frozenset(("ceiling", "office", "bar", "nightstand", "desk", "media"))
"""Uses of which a home has one design only."""


class FurnitureSource:
    """A source of furniture for one home, which makes items that should look alike (dining chairs) only once."""

    def __init__(
        self,
        rng: np.random.Generator,
        pool: Pool,
        clutter: float,
        home_rooms: frozenset[str],
        catalogue: Catalogue = CATALOGUE,
    ) -> None:
        self.rng = rng
        self.pool: Pool = pool
        self.clutter = clutter
        """0 without small objects, 1 with many."""
        self.home_rooms = home_rooms
        """Kinds of rooms that the home has."""
        self._catalogue = catalogue
        self._designs: dict[str, list[Item]] = {}
        self._used_styles: dict[tuple[str, str | None], list[str]] = {}
        self._next_items: dict[str, list[Item]] = {}
        self._window_looks: list[dict[str, Look]] = []

    def make(self, category: str, *uses: str, fresh: bool = False, **hints: Any) -> Item | None:
        """Returns an item for the first of the uses for which the pool has a style, or for any use when none is given.

        The same hints return one of the home's few designs again; `fresh` allows one more design. Returns None where
        the pool has no style that fits.
        """
        if category not in self._catalogue.categories:
            return None
        for use in uses or (None,):
            if self._catalogue.styles(category, self.pool, use):
                return self._design(category, use, fresh, hints)
        return None

    def _design(self, category: str, use: str | None, fresh: bool, hints: Mapping[str, Any]) -> Item:
        """Returns a new design, or one of those made before, all of them in turn, when there are enough."""
        key = repr((category, use, sorted(hints.items())))
        known = self._designs.setdefault(key, [])
        most = 1 if use in ONE_DESIGN else DESIGNS.get(category, 1)
        if len(known) >= most + fresh:
            items = self._next_items.setdefault(key, [])
            if not items:
                items.extend(known[n] for n in self.rng.permutation(len(known)).tolist())
            return items.pop()
        style = self._style(category, use)
        asked = hints if use is None else {"use": use, **hints}
        item = self._catalogue.make_item(category, self.rng, pool=self.pool, style=style, **asked)
        known.append(item)
        return item

    def _style(self, category: str, use: str | None) -> str:
        """Returns a style that the home does not have yet if there is one; categories of `SETS` keep their style."""
        used = self._used_styles.setdefault((category, use), [])
        if category in SETS and used:
            return used[0]
        every = [style.name for style in self._catalogue.styles(category, self.pool, use)]
        chosen = self.pick([style for style in every if style not in used] or every)
        if len(used) == len(every):
            used.clear()
        used.append(chosen)
        return chosen

    def looks(self, *names: str) -> dict[str, Look]:
        """Returns looks of some materials, for the hint `looks` of items that should match."""
        return {name: materials.look(name, self.rng, self.pool) for name in names}

    def window_looks(self) -> dict[str, Look]:
        """Returns the looks of the home's curtains and blinds, with one of its two curtain fabrics."""
        if not self._window_looks:
            base = self.looks("iron", "wood", "lacquer", "linen", "metal")
            self._window_looks = [base | self.looks("curtain") for _ in range(2)]
        return self.pick(self._window_looks)

    def chance(self, probability: float) -> bool:
        """Returns True with this probability."""
        return bool(self.rng.random() < probability)

    def clutter_chance(self, probability: float) -> bool:
        """Returns True with this probability at clutter 0.5, never at clutter 0, twice as often at clutter 1."""
        return self.chance(min(1.0, 2.0 * probability * self.clutter))

    def pick(self, options: Sequence[T]) -> T:
        """Returns a random one of the options."""
        return options[int(self.rng.integers(len(options)))]

    def uniform(self, low: float, high: float) -> float:
        """Returns a random number between two others."""
        return float(self.rng.uniform(low, high))
