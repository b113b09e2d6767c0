"""Furniture: parametric styles for every category that a home has.

A module of this package, or of `perception`, that declares `STYLES` is a family of furniture: its styles are in
`CATALOGUE` without an entry elsewhere.

A style belongs to one pool and is built with the palettes and textures of that pool only
(`sim.housegen.surfaces.materials`). A held-out house therefore shows structures, sizes, colours and textures that no
house of `train` shows. Every category
has styles in both pools, goal categories at least four in `train` and two in `heldout`, and every `use` exists in
both. Styles of the pool `wide` have the colours of `train` and add variety for training perception; they were designed
without looking at the held-out ones.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from types import ModuleType

from sim.housegen.furniture import perception
from sim.housegen.furniture.catalogue import Catalogue, Style

_PERCEPTION_FIRST = ("chairs", "office_chairs", "tables", "desks", "wardrobes", "sideboards", "displays", "wall_units")
"""Modules of `perception` that come first. Random draws depend on the order; a new module needs no entry."""


def _perception_order(name: str) -> tuple[int, str]:
    """Returns the sort key of a module of `perception`, given by its name in that folder."""
    first = _PERCEPTION_FIRST.index(name) if name in _PERCEPTION_FIRST else len(_PERCEPTION_FIRST)
    return first, name


def _families() -> Iterator[ModuleType]:
    """Yields the modules that declare styles: those of this folder by name, then those of `perception`."""
    names = sorted(module.name for module in pkgutil.iter_modules(__path__) if not module.ispkg)
    prefix = f"{perception.__name__}."
    of_perception = (m.name.removeprefix(prefix) for m in pkgutil.walk_packages(perception.__path__, prefix))
    names += [f"perception.{name}" for name in sorted(of_perception, key=_perception_order)]
    for name in names:
        module = importlib.import_module(f"{__name__}.{name}")
        if "STYLES" in vars(module):
            yield module


def shipped_styles() -> Iterator[Style]:
    """Yields the styles of all families, in the order in which houses draw from them."""
    for family in _families():
        yield from family.STYLES


CATALOGUE = Catalogue(shipped_styles())
"""All shipped styles."""
