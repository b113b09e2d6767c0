"""Styles of furniture, and the catalogue from which houses draw them."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Unpack, get_args

import numpy as np

from sim.core.errors import ConfigError
from sim.core.interface import MPCAT40_ID
from sim.homes.housegen.furniture.item import Hints, Item, Mount, Pool
from sim.homes.housegen.furniture.names import name_of_style
from sim.homes.housegen.furniture.reshape import may_reshape, reshaped
from sim.homes.housegen.furniture.uses import fault_of_uses
from sim.homes.housegen.furniture.workbench import Workbench

HINTS = frozenset(Hints.__annotations__)
"""All hints that `Catalogue.make_item` accepts."""
RESHAPED_SHARE = 0.5
"""Probability that an item gets other proportions than those of its style, where this is asked for."""


@dataclass(frozen=True)
class Style:
    """A design that items of a category can have; sizes and looks are drawn each time an item is built."""

    category: str
    """mpcat40 name with underscores."""
    name: str
    """Unique within the category."""
    pool: Pool
    """The style appears in the houses of this pool."""
    build: Callable[[Workbench], None]
    """Puts the geoms of one item on the workbench."""
    uses: tuple[str, ...] = ()
    """Values of the hint `use` that the style satisfies; `uses` lists those of each category."""
    mount: Mount = "floor"
    walk_over: bool = False
    """True: items lie flat on the floor, and other objects may stand on them."""


class Catalogue:
    """An immutable collection of styles by category.

    The order of the styles in a category is fixed, and random draws depend on it: another order, or one more style,
    gives other houses from the same seeds.
    """

    def __init__(self, styles: Iterable[Style]) -> None:
        """Raises ConfigError for an unknown category or pool, for uses by which no room asks for the category, and for
        two styles of one name in a category."""
        by_category: dict[str, dict[str, Style]] = {}
        for style in styles:
            if style.category not in MPCAT40_ID:
                raise ConfigError(f"Style '{style.name}': mpcat40 has no category '{style.category}'.")
            if style.pool not in get_args(Pool):
                raise ConfigError(
                    f"Style '{style.name}': unknown pool '{style.pool}'. Available: {', '.join(get_args(Pool))}."
                )
            if fault := fault_of_uses(style.category, style.uses):
                raise ConfigError(f"Style '{style.name}': {fault}")
            same_category = by_category.setdefault(style.category, {})
            if style.name in same_category:
                raise ConfigError(f"The catalogue has two styles '{style.name}' of category '{style.category}'.")
            same_category[style.name] = style
        self._by_category: Mapping[str, tuple[Style, ...]] = MappingProxyType(
            {category: tuple(named.values()) for category, named in by_category.items()}
        )

    @property
    def categories(self) -> tuple[str, ...]:
        """All categories that have a style."""
        return tuple(self._by_category)

    @property
    def all_styles(self) -> tuple[Style, ...]:
        """The styles of all categories."""
        return tuple(itertools.chain(*self._by_category.values()))

    def styles(self, category: str, pool: Pool | None = None, use: str | None = None) -> tuple[Style, ...]:
        """Returns the styles of a category, restricted to those of a pool and a use if these are given.

        Raises:
            ConfigError: the catalogue has no such category.
        """
        if category not in self._by_category:
            raise ConfigError(
                f"No furniture of category '{category}'. Available: {', '.join(sorted(self.categories))}."
            )
        shown = (style for style in self._by_category[category] if pool is None or style.pool == pool)
        return tuple(style for style in shown if use is None or use in style.uses)

    def with_styles(self, *styles: Style) -> Catalogue:
        """Returns a new catalogue that has these styles as well, after the others of their categories.

        Raises:
            ConfigError: the catalogue has a style of the same category and name.
        """
        return Catalogue([*self.all_styles, *styles])

    def replacing(self, category: str, *styles: Style) -> Catalogue:
        """Returns a new catalogue in which a category has these styles and no others.

        Raises:
            ConfigError: the catalogue has no such category, or a style is of another category.
        """
        self.styles(category)
        for style in styles:
            if style.category != category:
                raise ConfigError(f"Style '{style.name}' is of category '{style.category}', not '{category}'.")
        kept = (styles if name == category else self.styles(name) for name in self.categories)
        return Catalogue(itertools.chain.from_iterable(kept))

    def make_item(
        self, category: str, rng: np.random.Generator, *, pool: Pool, style: str | None = None, reshape: bool = False,
        **hints: Unpack[Hints],
    ) -> Item:  # fmt: skip
        """Builds one piece of furniture.

        The same arguments and the same state of `rng` give the same item. Without `style`, one of the pool's styles
        that satisfy `use` is drawn. A hint that the style has no dimension or part for is ignored.

        Args:
            category: mpcat40 name with underscores (`categories` has all); rugs are of category "floor".
            rng: source of all random draws.
            pool: "train" or "heldout".
            style: name of a style of that pool; None draws one.
            reshape: whether the item, with the items on it, sometimes gets other proportions (`reshape.py`).
            **hints: see the tables.

        ================ =========================================================================================
        category         `use` (the shipped catalogue has every use in both `train` and `heldout`)
        ================ =========================================================================================
        chair            dining, office, arm
        stool            bar (seat 0.62-0.78 m), low (0.42-0.47 m)
        seating          bench, plain (a bench without a back), ottoman (small, low, free-standing: poufs, bean bags)
        sofa             (none); corner: an L or an oval, for a corner or the middle of a room
        cushion          throw (lies on sofas, beds), floor (lies on the floor)
        table            dining, coffee, desk, side, nightstand, console
        bed              (none); `width_m` is the largest allowed width of the mattress
        cabinet          wardrobe, sideboard, display, media, kitchen_wall (mount wall), vanity (has its own sink)
        chest_of_drawers dresser, nightstand
        shelving         bookcase, laundry (detergents), linen (folded clothes, shoe boxes), on the floor; wall
        counter          run (back to a wall), island (front towards +x, where stools go)
        sink             standing (for bathrooms, laundries; mount floor or wall), vessel and inset (children of others)
        shower           (none): closed back at smallest x; cabins are also closed at smallest y, for a corner
        bathtub          (none): long side along y
        towel            rail (mount wall), floor (ladders, stands), top (stacks and rolls)
        clothes          rack, drying (on the floor), hooks (mount wall), floor (heaps, baskets), top (folded)
        tv_monitor       tv (mount top: on a media cabinet), tv_wall, monitor (top: on a desk), tv_floor
        mirror           wall, standing
        plant            floor (on the floor), top (on a table or shelf)
        lighting         ceiling, floor, table (top), wall
        appliances       fridge, stove, washing_machine, dishwasher; microwave, small (top); hood (wall); hob (a child)
        gym_equipment    machine, weights, small
        objects          mount top: top, shelf, office, bedside, low, media, dresser, entry, table, kitchen, bath (the
                         place where they lie); on the floor: floor, bin, box, shoes, bag, toy, and cable and flat
                         (both without collisions); mount wall: toilet_paper, bath_wall
        furniture        piano, screen
        floor            rug
        ================ =========================================================================================

        ================= ========================================================================================
        other hints       meaning
        ================= ========================================================================================
        width_m           outer width along y: exact for curtain, blinds, counter, cabinet kitchen_wall, railing,
                          floor, picture, mirror, board_panel, shelving; approximate for most others
        depth_m, height_m the same along x and z. For curtains and columns, `height_m` is measured from the floor. The
                          height of a blind is the length that is let down: place its upper edge at the upper edge of
                          the window, at z = top - item.size_m[2]
        with_sink         counter run: True, False; None draws. The sink is a child with label sink
        with_hob          counter run of 1.3 m or more: the same, a child with label appliances
        cushions          sofa: number of loose cushions (0-3), children with label cushion
        looks             {"wood": Look, "fabric": Look, ...}: used instead of drawn looks, so that a room can match
        ================= ========================================================================================

        Returns:
            An item; `item.py` explains its frame and mount. Wall items have their back at x = 0 and their origin at
            the middle of the lower edge; `mount_height_m` is the usual height of that edge above the floor (0: the
            item stands on the floor). Ceiling items hang below z = 0. Items on a top have z = 0 on that top.
            `mass_kg` is set if the item is light enough to be movable.

        Raises:
            ConfigError: no such category, no such style or use in this pool, or an unknown hint.
        """
        unknown = sorted(set(hints) - HINTS)
        if unknown:
            raise ConfigError(f"make_item knows no hint '{unknown[0]}'. It knows: {', '.join(sorted(HINTS))}.")
        use = hints.get("use")
        chosen = self._named(category, pool, style) if style is not None else self._drawn(category, rng, pool, use)
        bench = Workbench(rng, pool, hints, functools.partial(self.make_item, reshape=reshape))
        chosen.build(bench)
        item = bench.finish(category, chosen.name, chosen.mount, walk_over=chosen.walk_over)
        uses = chosen.uses if use is None else (use, *chosen.uses)
        item = replace(item, name=name_of_style(category, chosen.name, uses))
        if reshape and rng.random() < RESHAPED_SHARE and may_reshape(item):
            return reshaped(item, rng, hints)
        return item

    def _named(self, category: str, pool: Pool, name: str) -> Style:
        of_pool = self.styles(category, pool)
        for style in of_pool:
            if style.name == name:
                return style
        known = ", ".join(style.name for style in of_pool)
        raise ConfigError(f"'{category}' has no style '{name}' in pool '{pool}'. It has: {known}.")

    def _drawn(self, category: str, rng: np.random.Generator, pool: Pool, use: str | None) -> Style:
        fitting = self.styles(category, pool, use)
        if fitting:
            return fitting[int(rng.integers(len(fitting)))]
        uses = sorted({use for style in self.styles(category, pool) for use in style.uses})
        for_use = "" if use is None else f" for use '{use}'"
        raise ConfigError(
            f"'{category}' has no style{for_use} in pool '{pool}'. Its uses: {', '.join(uses) or 'none'}."
        )
