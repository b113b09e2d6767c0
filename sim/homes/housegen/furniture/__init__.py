"""Furniture: parametric styles for every category that a home has.

A module of this package that declares `STYLES` is a family of furniture: its styles are in `CATALOGUE` without an entry
elsewhere.

A style belongs to one pool and is built with the palettes and textures of that pool only
(`sim.homes.housegen.surfaces.materials`). A held-out house therefore shows structures, sizes, colours and textures that
no house of `train` shows. Every category has styles in both pools, goal categories at least four in `train` and two in
`heldout`, and every `use` exists in both.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from types import ModuleType

from sim.homes.housegen.furniture.catalogue import Catalogue, Style


def _families() -> Iterator[ModuleType]:
    """Yields the modules of this folder that declare styles, by name."""
    for name in sorted(module.name for module in pkgutil.iter_modules(__path__) if not module.ispkg):
        module = importlib.import_module(f"{__name__}.{name}")
        if "STYLES" in vars(module):
            yield module


def shipped_styles() -> Iterator[Style]:
    """Yields the styles of all families, in the order in which houses draw from them."""
    for family in _families():
        yield from family.STYLES


CATALOGUE = Catalogue(shipped_styles())
"""All shipped styles."""
