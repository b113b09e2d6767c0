"""What a home's rooms ask furniture from: one pool, one random stream, and the home's own style."""

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
"""How many designs of a category, for each use, one home has at most (else one): people buy by the set."""
SETS = frozenset(("counter",))
"""Categories whose things are of one style in a home, whatever their sizes."""
ONE_DESIGN = frozenset(("ceiling", "office", "bar", "nightstand", "desk", "media"))
"""Uses whose things are all alike in a home."""


class FurnitureSource:
    """Makes items for one home. What should look alike all over it (dining chairs, door handles) is made once."""

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
        """0 bare, 1 full of things."""
        self.home_rooms = home_rooms
        """Kinds of rooms that the home has."""
        self._catalogue = catalogue
        self._designs: dict[str, list[Item]] = {}
        self._shown: dict[tuple[str, str | None], list[str]] = {}
        self._bags: dict[str, list[Item]] = {}
        self._window_looks: list[dict[str, Look]] = []

    def make(self, category: str, *uses: str, fresh: bool = False, **hints: Any) -> Item | None:
        """An item for the first of these uses that the pool has a style for, for any use when none is given.

        The same hints give one of the home's few designs again; with `fresh` there may be one more of them. Returns
        None where the pool has nothing that fits.
        """
        if category not in self._catalogue.categories:
            return None
        for use in uses or (None,):
            if self._catalogue.styles(category, self.pool, use):
                return self._design(category, use, fresh, hints)
        return None

    def _design(self, category: str, use: str | None, fresh: bool, hints: Mapping[str, Any]) -> Item:
        key = repr((category, use, sorted(hints.items())))
        known = self._designs.setdefault(key, [])
        if len(known) >= self._variety(category, use) + fresh:
            bag = self._bags.setdefault(key, [])
            if not bag:
                bag.extend(known[n] for n in self.rng.permutation(len(known)).tolist())
            return bag.pop()
        style = self._style(category, use)
        asked = hints if use is None else {"use": use, **hints}
        item = self._catalogue.make_item(category, self.rng, pool=self.pool, style=style, **asked)
        known.append(item)
        return item

    def _style(self, category: str, use: str | None) -> str:
        """A style that the home has not yet, while there is one; sets keep theirs."""
        shown = self._shown.setdefault((category, use), [])
        if category in SETS and shown:
            return shown[0]
        every = [style.name for style in self._catalogue.styles(category, self.pool, use)]
        chosen = self.pick([style for style in every if style not in shown] or every)
        if len(shown) == len(every):
            shown.clear()
        shown.append(chosen)
        return chosen

    def _variety(self, category: str, use: str | None) -> int:
        return 1 if use in ONE_DESIGN else DESIGNS.get(category, 1)

    def looks(self, *names: str) -> dict[str, Look]:
        """Fixed looks of some materials, for hint `looks`: things that should match."""
        return {name: materials.look(name, self.rng, self.pool) for name in names}

    def window_looks(self) -> dict[str, Look]:
        """Looks of curtains and blinds: the home's, with one of its two curtain fabrics."""
        if not self._window_looks:
            base = self.looks("iron", "wood", "lacquer", "linen", "metal")
            self._window_looks = [base | self.looks("curtain") for _ in range(2)]
        return self.pick(self._window_looks)

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
