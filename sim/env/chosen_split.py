"""Chooses the houses and episodes of an environment: a split, some of its houses, or MJCF files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from sim.core.errors import ConfigError
from sim.episodes.splits import HOUSE_SUFFIXES, Split, load_split, split_of_files


def chosen_split(
    split: str | Path,
    house: str | Path | None = None,
    houses: Sequence[str | Path] = (),
    *,
    labels: str | Path | None = None,
    root: str | Path | None = None,
) -> Split:
    """Returns the split that the options of an environment name; a split of MJCF files has no episodes.

    Args:
        split: name of a shipped split, or a folder with the same layout.
        house: one MJCF file in place of the split.
        houses: names of houses of the split, or several MJCF files in place of the split.
        labels: label rules of the MJCF files.
        root: another folder whose files the MJCF files may use.

    Raises:
        ConfigError: there is no such split or house, or the options contradict each other.
        HouseError: there is no such file.
    """
    if not isinstance(split, str | Path):
        raise ConfigError(f"split must be the name or the folder of a split, got {split!r}.")
    if isinstance(houses, str | Path):
        raise ConfigError(f"houses must be a list of names or files, got '{houses}'; house= takes one file.")
    if house is not None and houses:
        raise ConfigError("house and houses exclude each other: give all files in houses.")
    are_files = [_is_file_name(house) for house in houses]
    if any(are_files) and not all(are_files):
        name = houses[are_files.index(False)]
        raise ConfigError(f"houses must be names of the split or MJCF files, not both; '{name}' is a name.")
    if house is not None or any(are_files):
        return split_of_files(houses if house is None else (house,), labels=labels, root=root)
    if labels is not None or root is not None:
        raise ConfigError("labels and root need house: the houses of a split have their own.")
    chosen = load_split(split)
    return _with_houses(chosen, [str(house) for house in houses]) if houses else chosen


def _with_houses(split: Split, names: Sequence[str]) -> Split:
    """Returns a split with only some of its houses and their episodes."""
    unknown = [name for name in names if name not in split.house_paths]
    if unknown:
        there_is = ", ".join(split.houses[:5]) + (" ..." if len(split.houses) > 5 else "")
        raise ConfigError(f"Split '{split.name}' has no house '{unknown[0]}'. It has: {there_is}.")
    episodes = tuple(episode for episode in split.episodes if episode.house in names)
    if split.episodes and not episodes:
        raise ConfigError(f"Split '{split.name}' has no episode in {', '.join(names)}.")
    return replace(split, house_paths={name: split.house_paths[name] for name in names}, episodes=episodes)


def _is_file_name(house: str | Path) -> bool:
    return isinstance(house, Path) or Path(house).suffix.lower() in HOUSE_SUFFIXES or Path(house).name != house
