"""Resizes our furniture to the dimensions of an imported object: an item of its category, or a labelled solid.

A few items are drawn for a use; the one with the proportions nearest to the requested size is stretched to it. If all
proportions differ too much, or if we have no such furniture, the object is a box, a ball or a cylinder of its size.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from sim.homes.housegen.furniture import CATALOGUE
from sim.homes.housegen.furniture.item import Geom, Item, Look, Pool, Surface
from sim.homes.housegen.furniture.reshape import fitted
from sim.homes.housegen.surfaces import materials
from sim.houses.taxonomies import Entry

Place = Literal["floor", "top", "wall"]
"""The support of an object: the floor, another object, a wall."""
PLACES: tuple[Place, ...] = ("floor", "top", "wall")
SHAPES = ("box", "ball", "can")
"""Values of `Entry.use` for plain solids instead of furniture: a box, an ellipsoid, an upright cylinder."""
DRAWS = 4
"""Number of items that are drawn; the best of them is stretched."""
MAX_STRETCH = 2.5
"""Largest factor by which a side of an item is stretched or shrunk."""
HINT_RANGE = (0.6, 1.6)
"""Range of the sizes that are requested from a style, relative to its own size."""
ROUND_RATIO = 1.3
"""An object becomes a cylinder only if its width and depth differ by at most this factor."""
_COUNTER = {"with_sink": False, "with_hob": False}
_HINTS = {"counter": _COUNTER, "sofa": {"cushions": 0}}
_MATERIALS = ("plastic", "book", "ceramic", "cardboard", "bright")
_OF_CATEGORY = {"appliances": "appliance", "gym_equipment": "iron", "table": "wood", "bed": "bedding", "sofa": "fabric"}


@dataclass(frozen=True)
class Fitted:
    """An item of the requested size."""

    item: Item
    is_furniture: bool
    """False for a box, a ball or a cylinder."""


class Fitter:
    """Makes the items of one house; the same asset at the same kind of place is the same item."""

    def __init__(self, rng: np.random.Generator, pool: Pool) -> None:
        self._rng = rng
        self._pool: Pool = pool
        self._made: dict[tuple[str, Place, tuple[float, float, float]], Fitted] = {}

    def fit(self, asset: str, entry: Entry, size_m: tuple[float, float, float], place: Place) -> Fitted:
        """Returns an item of a size.

        Args:
            asset: name of the asset, by which items are made once.
            entry: its category and use.
            size_m: depth, width, height in metres.
            place: its support.
        """
        key = (asset, place, size_m)
        if key not in self._made:
            self._made[key] = self._fit(entry, size_m, place)
        return self._made[key]

    def _fit(self, entry: Entry, size_m: tuple[float, float, float], place: Place) -> Fitted:
        if entry.use in SHAPES or entry.category not in CATALOGUE.categories:
            return Fitted(self._solid(entry.category, entry.use, size_m), is_furniture=False)
        uses = entry.use.split("/")
        number = PLACES.index(place)
        use = (uses[number] if number < len(uses) else "") or uses[0] or None
        best, stretch = self._best(entry.category, use, size_m)
        if stretch > MAX_STRETCH or (place == "top" and best.mount == "floor" and best.category in ("chair", "bed")):
            return Fitted(self._solid(entry.category, "box", size_m), is_furniture=False)
        return Fitted(fitted(best, size_m), is_furniture=True)

    def _best(self, category: str, use: str | None, size_m: tuple[float, float, float]) -> tuple[Item, float]:
        """Returns the item, of those drawn, that needs the least stretching, and its largest factor."""
        hints: dict[str, Any] = {**_HINTS.get(category, {}), **({} if use is None else {"use": use})}
        fits: list[tuple[float, int, Item]] = []
        for number in range(DRAWS):
            item = CATALOGUE.make_item(category, self._rng, pool=self._pool, **hints)
            asked: dict[str, Any] = {
                name: float(np.clip(new, HINT_RANGE[0] * old, HINT_RANGE[1] * old))
                for name, new, old in zip(("depth_m", "width_m", "height_m"), size_m, item.size_m, strict=True)
            }
            again = CATALOGUE.make_item(category, self._rng, pool=self._pool, style=item.style, **hints, **asked)
            for item_tried in (item, again):
                fits.append((_stretch(item_tried, size_m), 2 * number + (item_tried is again), item_tried))
        stretch, _, best = min(fits, key=lambda fit: fit[:2])
        return best, stretch

    def _solid(self, category: str, shape: str, size_m: tuple[float, float, float]) -> Item:
        """Returns a labelled box, ellipsoid or cylinder on z = 0."""
        names = (_OF_CATEGORY[category],) if category in _OF_CATEGORY else _MATERIALS
        look = materials.look(names[int(self._rng.integers(len(names)))], self._rng, self._pool)
        depth, width, height = (max(side, 0.004) for side in size_m)
        at, half = (0.0, 0.0, round(height / 2, 4)), (depth / 2, width / 2, height / 2)
        if shape == "ball":
            geom = Geom("ellipsoid", half, at, look)
        elif shape == "can" and max(depth, width) <= ROUND_RATIO * min(depth, width):
            geom = Geom("cylinder", (0.25 * (depth + width), height / 2), at, look)
        else:
            geom = Geom("box", half, at, look)
        top = Surface((0.0, 0.0, height), (half[0], half[1]))
        return Item(category, "solid", (depth, width, height), (geom,), surfaces=() if shape == "ball" else (top,))


def tinted(look: Look, rgb: tuple[float, float, float]) -> Look:
    """Returns a plain look of this colour with the reflectance of another one."""
    r, g, b = (round(part, 3) for part in rgb)
    return Look((r, g, b, 1.0), None, 1.0, look.specular, look.shininess)


def _stretch(item: Item, size_m: tuple[float, float, float]) -> float:
    return max(
        math.exp(abs(math.log(max(new, 1e-3) / max(old, 1e-3)))) for new, old in zip(size_m, item.size_m, strict=True)
    )
