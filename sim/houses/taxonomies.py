"""The table from other projects' names of objects to the categories of mpcat40 (`taxonomies.csv`).

Its column `source` says where a category comes from: `mp3d` is Matterport3D's category_mapping.tsv, `hm3d` is HM3DSem's
hm3dsem_category_mappings.tsv, and `ours` is a decision of this project, for names that neither table has or for which
both have `misc`. Its column `use` names the furniture that replaces the object (`sim.homes.importers.fitting`).
"""

from __future__ import annotations

import functools
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Literal

from sim.core.reading import read_csv

Taxonomy = Literal["ai2thor", "habitat", "robocasa"]
"""AI2-THOR's object types, also those of ProcTHOR and MolmoSpaces; names in Habitat's data sets (HM3D, MP3D, HSSD) of
which `sim.houses.proposals` knows another category, or none; the beginnings of RoboCasa's fixture names."""
FILE = Path(__file__).with_name("taxonomies.csv")


@dataclass(frozen=True)
class Entry:
    """One name of a taxonomy."""

    category: str
    """mpcat40 name with underscores."""
    use: str
    """"" when the category has no uses."""
    source: str
    """`mp3d`, `hm3d` or `ours`."""


@functools.cache
def entries(taxonomy: Taxonomy) -> Mapping[str, Entry]:
    """Returns the entries of a taxonomy by name."""
    rows = read_csv(FILE, what="Table of taxonomies")
    return MappingProxyType(
        {row["name"]: Entry(row["category"], row["use"], row["source"]) for row in rows if row["taxonomy"] == taxonomy}
    )


def words_of(name: str) -> tuple[str, ...]:
    """Returns the words of a name in lower case: `TVStand_2`, `tv_stand` and `tv stand` are ("tv", "stand")."""
    return tuple(word.lower() for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+", name))


def category_of_ending(words: tuple[str, ...]) -> str | None:
    """Returns the category of the longest name of at least two words in the table that `words` end with, or None."""
    for first in range(len(words) - 1):
        if category := _by_words().get(words[first:]):
            return category
    return None


@functools.cache
def _by_words() -> Mapping[tuple[str, ...], str]:
    names = {**entries("habitat"), **entries("ai2thor")}
    return {words_of(name): entry.category for name, entry in names.items()}
