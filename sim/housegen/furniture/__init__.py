"""Furniture: parametric styles for every category that a home has.

A module of this package, or of `wide`, that declares `STYLES` is a family of furniture: its styles are in `CATALOGUE`
without an entry elsewhere.

A style belongs to one pool and is built with the palettes and textures of that pool only (`sim.housegen.materials`).
A held-out house therefore shows structures, sizes, colours and textures that no house of `train` shows. Every category
has styles in both pools, goal categories at least four in `train` and two in `heldout`, and every `use` exists in
both. Styles of the pool `wide` have the colours of `train` and add variety for training perception; they were designed
without looking at the held-out ones.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from types import ModuleType

from sim.housegen.furniture import wide
from sim.housegen.furniture.catalogue import Catalogue, Style

_WIDE_FIRST = ("chairs", "office_chairs", "tables", "desks", "wardrobes", "sideboards", "displays", "wall_units")
"""Modules of `wide` that come before the others. Random draws depend on the order; a new module needs no entry."""


def _wide_order(name: str) -> tuple[int, str]:
    return (_WIDE_FIRST.index(name) if name in _WIDE_FIRST else len(_WIDE_FIRST), name)


def _families() -> Iterator[ModuleType]:
    """Yields the modules that declare styles: those of this folder by name, then those of `wide`."""
    names = [f"{__name__}.{module.name}" for module in pkgutil.iter_modules(__path__) if not module.ispkg]
    wide_names = sorted((module.name for module in pkgutil.iter_modules(wide.__path__)), key=_wide_order)
    for name in (*sorted(names), *(f"{wide.__name__}.{name}" for name in wide_names)):
        module = importlib.import_module(name)
        if "STYLES" in vars(module):
            yield module


def shipped_styles() -> Iterator[Style]:
    """Yields the styles of all families, in the order in which houses draw from them."""
    for family in _families():
        yield from family.STYLES


CATALOGUE = Catalogue(shipped_styles())
"""All shipped styles."""
