"""Selects and makes the furniture of one home, so that no design is seen more than twice unless it belongs to a set.

A design is a style with certain looks and a certain size. The source counts the items in the rooms and chooses the
style with the fewest items. Where the pool has no style left that the home has fewer than `MAX_ALIKE` times, it makes
a variant of one: the same structure in other colours, or in a clearly different size, is a different design.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import TypeVar, Unpack

import numpy as np

from sim.homes.housegen.furnishing.placement import Placement, RoomLayout
from sim.homes.housegen.furniture import CATALOGUE
from sim.homes.housegen.furniture.catalogue import Catalogue
from sim.homes.housegen.furniture.item import Hints, Item, Look, Pool
from sim.homes.housegen.surfaces import materials

T = TypeVar("T")
MAX_ALIKE = 2
"""Largest number of items of one design in a home, outside the sets."""
SETS: Mapping[tuple[str, str | None], int] = MappingProxyType(
    {
        ("chair", "dining"): 2, ("stool", "bar"): 1, ("chest_of_drawers", "nightstand"): 3, ("table", "nightstand"): 3,
        ("counter", "run"): 1, ("counter", "island"): 1, ("cabinet", "kitchen_wall"): 1, ("lighting", "ceiling"): 3,
        ("curtain", None): 1, ("blinds", None): 1,
    }
)  # fmt: skip
"""Category and use of items that belong to a set, and the number of designs in a home: the chairs round a table, the
stools at a kitchen island, a pair of nightstands, the units of a kitchen, ceiling lamps, curtains and blinds."""
_ONE_STYLE = frozenset(("counter",))
"""Categories with only one style in a home, in any size."""
VARIANT_SIZE = 0.12
"""Share by which one side of an item differs when its size makes it another design."""
_VARIANT_DRAWS = 8
_MISFIT = 0.3
"""Weight of an item for which no position was found, relative to a placed one, when a style is chosen."""

MAX_SMALL_STYLES = 12
"""Styles of small objects in a home, each one mesh; from then on they are seen in other colours. Meshes take most of
the bytes of a house file."""
REQUIRED = frozenset(
    ("bed", "cabinet", "chest_of_drawers", "shelving", "sink", "toilet", "shower", "bathtub", "appliances", "table",
     "gym_equipment", "sofa", "fireplace", "mirror")
)  # fmt: skip
"""In these categories a third item of a design is made if no variant was found; rooms go without the others."""

Design = tuple[str, str, frozenset[tuple[Look, str]], tuple[float, float, float]]
"""Category, style, looks and size of an item. A look with a palette comes with the name of its mesh, which has the
colours."""


def design_of(item: Item) -> Design:
    """Returns the design of an item."""
    looks = frozenset(
        (geom.look, geom.mesh.name if geom.mesh is not None and geom.mesh.texture_uv is not None else "")
        for geom in item.geoms
    )
    return item.category, item.style, looks, item.size_m


def is_same_design(a: Design, b: Design) -> bool:
    """Returns whether two designs have the same style, the same looks and nearly the same size."""
    return a[:3] == b[:3] and all(
        abs(x - y) <= VARIANT_SIZE * max(x, y) + 0.005 for x, y in zip(a[3], b[3], strict=True)
    )


class FurnitureSource:
    """A source of furniture for one home, which counts the items in its rooms."""

    def __init__(
        self,
        rng: np.random.Generator,
        pool: Pool,
        clutter: float,
        home_rooms: frozenset[str],
        catalogue: Catalogue = CATALOGUE,
        *,
        reshape: bool = False,
    ) -> None:
        self.rng = rng
        self.pool: Pool = pool
        self.clutter = clutter
        """0 without small objects, 1 with many."""
        self.home_rooms = home_rooms
        """Kinds of rooms that the home has."""
        self._catalogue = catalogue
        self._reshape = reshape
        self._designs: dict[str, list[Item]] = {}
        self._made: dict[tuple[str, str], list[Design]] = {}
        self._small_styles: set[str] = set()
        self._returned: Counter[tuple[str, str]] = Counter()
        self._tried: dict[str, set[str]] = {}
        self._set_style: dict[str, str] = {}
        self._next_items: dict[str, list[Item]] = {}
        self._window_looks: list[dict[str, Look]] = []
        self._layouts: list[RoomLayout] = []
        self._before: tuple[Counter[int], Counter[tuple[str, str]]] = (Counter(), Counter())
        """Items by identity and by style in the rooms that are finished."""

    def enter(self, layout: RoomLayout) -> None:
        """Takes note of a room that is furnished from now on, so that its items are counted."""
        others = [known for known in self._layouts if known is not layout]
        self._before = (_items(others), _styles(others))
        self._layouts = [*others, layout]

    def make(self, category: str, *uses: str, fresh: bool = False, **hints: Unpack[Hints]) -> Item | None:
        """Returns an item for the first of the uses for which the pool has a style, or for any use when none is given.

        `fresh` returns another style than the calls before it if there is one, for a position where those did not fit.
        Returns None if the pool has no style that fits.
        """
        hints = Hints(**{name: value for name, value in hints.items() if value is not None})  # type: ignore[typeddict-item]
        if category not in self._catalogue.categories:
            return None
        for use in uses or (None,):
            if self._catalogue.styles(category, self.pool, use):
                if (category, use) in SETS:
                    return self._of_set(category, use, fresh, hints)
                return self._single(category, use, fresh, hints)
        return None

    def has_unused(self, category: str, *uses: str) -> bool:
        """Returns whether the pool has a style for one of the uses that the home has fewer than `MAX_ALIKE` times."""
        placed = self._placed_styles()
        return any(
            placed[category, style.name] < MAX_ALIKE
            for use in uses or (None,)
            for style in self._catalogue.styles(category, self.pool, use)
        )

    def placements(self) -> list[Placement]:
        """Returns the items of the rooms so far."""
        return [placement for layout in self._layouts for placement in layout.placements]

    def uses_of(self, item: Item) -> tuple[str, ...]:
        """Returns the uses of an item's style."""
        for style in self._catalogue.styles(item.category, self.pool):
            if style.name == item.style:
                return style.uses
        return ()

    def _single(self, category: str, use: str | None, fresh: bool, hints: Hints) -> Item | None:
        """Returns an item of the style that the home has least often.

        A third item of one design is returned only if the category is in `REQUIRED` and no variant was found; None if
        no item is possible.
        """
        key = repr((category, use, sorted(hints.items())))
        style = self._least_used(category, use, key, fresh)
        self._returned[category, style] += 1
        now = _items(self._layouts[-1:])
        if category == "objects":  # the same for any use
            key = category
        known = [item for item in self._designs.setdefault(key, []) if item.style == style]
        for item in known:
            if self._before[0][id(item)] + now[id(item)] < MAX_ALIKE and category not in ("picture", "floor"):
                return item
        alike = self._made.setdefault((category, style), [])
        made = self._variant(known, alike) or self._new(category, style, use, hints)
        for _ in range(_VARIANT_DRAWS):
            if not any(is_same_design(design_of(made), other) for other in alike):
                break
            made = self._new(category, style, use, hints)
        else:
            if category not in REQUIRED:
                return None
        alike.append(design_of(made))
        if any(geom.look.texture in materials.palettes(self.pool) for geom in made.geoms):
            self._small_styles.add(style)
        self._designs[key].append(made)
        return made

    def _variant(self, known: Sequence[Item], alike: Sequence[Design]) -> Item | None:
        """Returns a small object that exists already in the colours of another palette; it shares the mesh."""
        for item in known:
            looks = {geom.look for geom in item.geoms}
            if len(looks) == 1 and next(iter(looks)).texture in materials.palettes(self.pool):
                for palette in materials.palettes(self.pool):
                    geoms = tuple(replace(geom, look=replace(geom.look, texture=palette)) for geom in item.geoms)
                    made = replace(item, geoms=geoms)
                    if not any(is_same_design(design_of(made), other) for other in alike):
                        return made
        return None

    def _new(self, category: str, style: str, use: str | None, hints: Hints) -> Item:
        asked: Hints = hints if use is None else {"use": use, **hints}
        return self._catalogue.make_item(
            category, self.rng, pool=self.pool, style=style, reshape=self._reshape, **asked
        )

    def _least_used(self, category: str, use: str | None, key: str, fresh: bool) -> str:
        """Returns a style that the home has least often, one that the last calls did not return where `fresh`."""
        placed = self._placed_styles()
        names = [style.name for style in self._catalogue.styles(category, self.pool, use)]
        tried = self._tried.setdefault(key, set())
        if not fresh:
            tried.clear()
        untried = [name for name in names if name not in tried] or names
        if category == "objects" and len(self._small_styles) >= MAX_SMALL_STYLES:
            untried = [name for name in untried if name in self._small_styles] or untried

        def weight(name: str) -> float:
            count = placed[category, name]
            return count + _MISFIT * max(0, self._returned[category, name] - count)

        least = min(weight(name) for name in untried)
        chosen = self.pick([name for name in untried if weight(name) <= least + 0.05])
        tried.add(chosen)
        return chosen

    def _of_set(self, category: str, use: str | None, fresh: bool, hints: Hints) -> Item:
        """Returns one of the few designs of a set, all of them in turn; `fresh` allows one more."""
        key = repr((category, use, sorted(hints.items())))
        known = self._designs.setdefault(key, [])
        if len(known) >= SETS[category, use] + fresh:
            items = self._next_items.setdefault(key, [])
            if not items:
                items.extend(known[n] for n in self.rng.permutation(len(known)).tolist())
            return items.pop()
        names = [style.name for style in self._catalogue.styles(category, self.pool, use)]
        if category in _ONE_STYLE:
            style = self._set_style.setdefault(repr((category, use)), self.pick(names))
        else:
            style = self.pick([name for name in names if name not in {item.style for item in known}] or names)
        known.append(self._new(category, style, use, hints))
        return known[-1]

    def _placed_styles(self) -> Counter[tuple[str, str]]:
        """Returns how many items of each category and style stand in the home."""
        placed = self._before[1].copy()
        placed.update(_styles(self._layouts[-1:]))
        return placed

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


def _items(layouts: Sequence[RoomLayout]) -> Counter[int]:
    """Returns how often each item stands in some rooms, by its identity."""
    return Counter(id(placement.item) for layout in layouts for placement in layout.placements)


def _styles(layouts: Sequence[RoomLayout]) -> Counter[tuple[str, str]]:
    """Returns how many items of each category and style stand in some rooms."""
    return Counter(
        (placement.item.category, placement.item.style) for layout in layouts for placement in layout.placements
    )
