"""Finds the house of a scene."""

from __future__ import annotations

import functools
from pathlib import Path

from sim.core.errors import HouseError
from sim.episodes.splits import HOUSE_SUFFIXES, Split, load_split, shipped_splits
from sim.houses.house import House
from sim.houses.load import load_house

shipped_split = functools.cache(load_split)
"""Returns a shipped split; to read one takes a few tenths of a second, and each scene needs it."""


def find_house(scene_id: str) -> House:
    """Returns the house of a scene.

    Args:
        scene_id: an MJCF file, a path that ends in `split/house.xml` with a shipped split, or a scene of another format
            (`X.glb`) with a house `X.xml` beside it.

    Raises:
        HouseError: there is no such house.
    """
    path = Path(scene_id)
    split = _split_of(path)
    if split is not None and path.stem in split.houses and (not path.is_file() or split.house_list is not None):
        return split.load_house(path.stem)
    for file in (path, path.with_suffix(".xml")) if path.name else ():
        if file.suffix in HOUSE_SUFFIXES and file.is_file():
            return load_house(file)
    raise HouseError(
        f"There is no house '{scene_id}': neither a file, nor SPLIT/HOUSE.xml of a shipped split "
        f"({', '.join(shipped_splits())}). Scenes of other simulators must be imported first (docs/worlds.md)."
    )


def _split_of(path: Path) -> Split | None:
    """Returns the shipped split that a path names; None if it names none."""
    return shipped_split(path.parent.name) if path.parent.name in shipped_splits() else None
