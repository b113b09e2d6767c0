"""Furniture: parametric families of every category that a flat has, by style and pool.

The rule of the pools: a style belongs to one pool and is built with that pool's palettes and textures only
(`sim.housegen.materials`), so a held-out house shows structures, sizes, colours and textures that no train house does.
Every category has styles in both, goal categories at least four in train and two held out, and every `use` exists in
both. Styles of the pool `wide`, in train's colours, widen what perception is trained on; they were designed without a
look at the held-out ones.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from sim.errors import ConfigError
from sim.housegen.furniture import (
    appliances,
    armchairs,
    baths,
    beds,
    cabinets,
    chairs,
    chests,
    clothes,
    counters,
    cushions,
    gym,
    hearths,
    lamps,
    low_tables,
    objects,
    oddments,
    office_chairs,
    pictures,
    plants,
    screens,
    seats,
    shelves,
    sinks,
    small_appliances,
    sofas,
    stools,
    structure,
    tables,
    toilets,
    towels,
    wall_panels,
    wide,
    windows,
)
from sim.housegen.furniture.catalogue import HINTS, Style
from sim.housegen.furniture.item import Item, Pool
from sim.housegen.furniture.workbench import Workbench

_MODULES = (
    appliances,
    armchairs,
    baths,
    beds,
    cabinets,
    chairs,
    chests,
    clothes,
    counters,
    cushions,
    gym,
    hearths,
    lamps,
    low_tables,
    objects,
    oddments,
    office_chairs,
    pictures,
    plants,
    screens,
    seats,
    shelves,
    sinks,
    small_appliances,
    sofas,
    stools,
    structure,
    tables,
    toilets,
    towels,
    wall_panels,
    windows,
    wide,
)


def _catalogue() -> dict[str, dict[str, Style]]:
    catalogue: dict[str, dict[str, Style]] = {}
    for module in _MODULES:
        for style in module.STYLES:
            of_category = catalogue.setdefault(style.category, {})
            if style.name in of_category:
                raise ValueError(f"Style '{style.name}' of '{style.category}' is declared twice.")
            of_category[style.name] = style
    return catalogue


CATALOGUE: dict[str, dict[str, Style]] = _catalogue()
"""Every style by category and name."""


def styles(category: str, pool: Pool | None = None, use: str | None = None) -> tuple[str, ...]:
    """Names of the styles of a category, of one pool and for one use if asked.

    Raises:
        ConfigError: no such category.
    """
    fitting = (s for s in _styles(category) if pool is None or s.shown_in(pool))
    return tuple(s.name for s in fitting if use is None or use in s.uses)


def make_item(category: str, rng: np.random.Generator, *, pool: Pool, style: str | None = None, **hints: Any) -> Item:
    """Build one piece of furniture.

    The same arguments and the same state of `rng` give the same item. A style belongs to one pool; without
    `style` one is drawn among the pool's that fit `use`. Hints that a style has no place for are passed over.

    Args:
        category: mpcat40 name with underscores (`CATALOGUE` has all); rugs are of category "floor".
        rng: source of every draw.
        pool: "train", "heldout" or "wide", which has train's styles and more.
        style: name of a style of that pool; None draws one.
        **hints: see the tables.

    ================ =============================================================================================
    category         `use` (every use exists in both pools)
    ================ =============================================================================================
    chair            dining, office, arm
    stool            bar (seat 0.62-0.78 m), low (0.42-0.47 m)
    seating          bench, plain (a bench without a back), ottoman (small, low, free-standing: poufs, bean bags)
    sofa             (none); corner: an L or an oval that wants a corner or the middle of a room
    cushion          throw (lies on sofas, beds), floor (on the floor by itself)
    table            dining, coffee, desk, side, nightstand, console
    bed              (none); `width_m` is the mattress's at most
    cabinet          wardrobe, sideboard, display, media, kitchen_wall (mount wall), vanity (brings its own sink)
    chest_of_drawers dresser, nightstand
    shelving         bookcase (on the floor), wall
    counter          run (back to a wall), island (fronts towards +x, where stools go)
    sink             standing (for bathrooms, laundries; mount floor or wall), vessel and inset (children of others)
    shower           (none): a closed back at smallest x; cabins also close a corner at smallest y
    bathtub          (none): long side along y
    towel            rail (mount wall), floor (ladders, stands), top (stacks and rolls)
    clothes          rack (stands on the floor), hooks (mount wall), floor (heaps, baskets), top (folded)
    tv_monitor       tv (mount top: on a media cabinet), tv_wall, monitor (top: on a desk), tv_floor
    mirror           wall, standing
    plant            floor (on the floor), top (on a table or shelf)
    lighting         ceiling, floor, table (top), wall
    appliances       fridge, stove, washing_machine, dishwasher; microwave, small (top); hood (wall); hob (a child)
    gym_equipment    machine, weights, small
    objects          top (books, clocks), kitchen (bowls, kettles), both mount top; floor (boxes, suitcases), bin
    furniture        piano, screen
    floor            rug
    ================ =============================================================================================

    ================= ============================================================================================
    other hints       meaning
    ================= ============================================================================================
    width_m           the outer width along y: exact for curtain, blinds, counter, cabinet kitchen_wall, railing, floor,
                      picture, mirror, board_panel, shelving; nearly so for most others
    depth_m, height_m likewise along x and z; curtains and columns take `height_m` from the floor up. A blind is as long
                      as it is let down: hang it with its upper edge at the window's, at z = top - item.size_m[2]
    with_sink         counter run: True, False; None draws. The sink is a child labelled sink
    with_hob          counter run at least 1.3 m wide: likewise, a child labelled appliances
    cushions          sofa: how many loose cushions (0-3), children labelled cushion
    looks             {"wood": Look, "fabric": Look, ...}: looks taken instead of drawn ones, so that a room can match
    ================= ============================================================================================

    Returns:
        An item whose frame and mount `item.py` explains. Wall items: the back is at x = 0 and the origin at the
        middle of the lower edge; `mount_height_m` is the usual height of that edge above the floor (0: stands on it).
        Ceiling items: z = 0 is the ceiling, everything hangs below. What stands on a top has z = 0 on that top.
        `mass_kg` is set where a light thing may be movable.

    Raises:
        ConfigError: no such category, style in this pool, use, or hint.
    """
    unknown = sorted(set(hints) - HINTS)
    if unknown:
        raise ConfigError(f"make_item knows no hint '{unknown[0]}'. It knows: {', '.join(sorted(HINTS))}.")
    chosen = _choose(category, rng, pool, style, hints.get("use"))
    bench = Workbench(rng, pool, hints, make_item)
    chosen.build(bench)
    return bench.finish(category, chosen.name, chosen.mount, walk_over=chosen.walk_over)


def _styles(category: str) -> tuple[Style, ...]:
    if category not in CATALOGUE:
        raise ConfigError(f"No furniture of category '{category}'. There is: {', '.join(sorted(CATALOGUE))}.")
    return tuple(CATALOGUE[category].values())


def _choose(category: str, rng: np.random.Generator, pool: Pool, name: str | None, use: str | None) -> Style:
    of_pool = [s for s in _styles(category) if s.shown_in(pool)]
    if name is not None:
        named = [s for s in of_pool if s.name == name]
        if not named:
            raise ConfigError(
                f"'{category}' has no style '{name}' in pool '{pool}'. It has: {', '.join(s.name for s in of_pool)}."
            )
        return named[0]
    fitting = [s for s in of_pool if use is None or use in s.uses]
    if not fitting:
        uses = sorted({u for s in of_pool for u in s.uses})
        raise ConfigError(
            f"'{category}' has no style for use '{use}' in pool '{pool}'. Its uses: {', '.join(uses) or 'none'}."
        )
    return fitting[int(rng.integers(len(fitting)))]
