"""Styles of furniture that houses for training leave out, so that a network can be selected on furniture it never saw.

About one in `WITHHELD_PART` styles of each goal category is withheld, of our own styles in the pool `train`
and of imported models of the split `train`. A hash of the name decides, so that every machine and every
catalogue agrees. The pool `heldout` and the models of the transfer test are not concerned: they judge, never select.
"""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Literal, Protocol

from sim.core.interface import GOAL_CATEGORIES
from sim.homes.housegen.furniture import CATALOGUE
from sim.homes.housegen.furniture.catalogue import Catalogue, Style

Withheld = Literal["without", "only"]
"""without: no withheld style is shown. only: withheld styles replace the others wherever there is one for the use."""
WITHHELD_PART = 5
WITHOUT_USES = frozenset(("sofa",))
"""Categories that rooms never ask for by use: replacing styles replace all others, independent of their uses."""


class _OfCategory(Protocol):
    """A style or an imported model."""

    @property
    def category(self) -> str: ...
    @property
    def uses(self) -> tuple[str, ...]: ...


def restricted(catalogue: Catalogue, which: Withheld | None) -> Catalogue:
    """Returns the catalogue without the withheld styles, or with them in place of others; None returns it as it is."""
    if which is None:
        return catalogue
    others = [style for style in catalogue.all_styles if not is_withheld(style)]
    if which == "without":
        return Catalogue(others)
    withheld = [style for style in catalogue.all_styles if is_withheld(style)]
    kept = (remaining for style in others if (remaining := without_covered(style, withheld)) is not None)
    return Catalogue([*kept, *withheld])


def is_withheld(style: Style) -> bool:
    """Returns whether a style is withheld."""
    if style.pool == "heldout" or style.category not in GOAL_CATEGORIES:
        return False
    key = style.category, style.name
    return key in _withheld_own() or (key not in _own() and _drawn(*key) % WITHHELD_PART == 0)


def without_covered(style: Style, replacing: Sequence[_OfCategory]) -> Style | None:
    """Returns a style with the uses that no replacing style or model has; None if no use is left."""
    of_category = [other for other in replacing if other.category == style.category]
    if not of_category:
        return style
    covered = {use for other in of_category for use in other.uses}
    uses = tuple(use for use in style.uses if use not in covered)
    return replace(style, uses=uses) if uses and style.category not in WITHOUT_USES else None


def _drawn(category: str, name: str) -> int:
    return int(hashlib.sha256(f"withheld {category}/{name}".encode()).hexdigest()[:12], 16)


@functools.lru_cache(maxsize=1)
def _own() -> frozenset[tuple[str, str]]:
    return frozenset((style.category, style.name) for style in CATALOGUE.all_styles)


@functools.lru_cache(maxsize=1)
def _withheld_own() -> frozenset[tuple[str, str]]:
    """Returns category and name of our own withheld styles: each use keeps a style of its pool."""
    chosen = []
    for category in GOAL_CATEGORIES:
        candidates = [style for style in CATALOGUE.styles(category) if style.pool != "heldout"]
        count = max(1, len(candidates) // WITHHELD_PART)
        for style in sorted(candidates, key=lambda style: _drawn(style.category, style.name) % WITHHELD_PART):
            rest = [other for other in candidates if other is not style]
            if count and _covers(rest, style):
                candidates, count = rest, count - 1
                chosen.append((style.category, style.name))
    return frozenset(chosen)


def _covers(rest: Iterable[Style], style: Style) -> bool:
    """Returns whether other styles of its pool are left for each use of a style."""
    alike = [other for other in rest if other.pool == style.pool]
    return all(any(use is None or use in other.uses for other in alike) for use in style.uses or (None,))
