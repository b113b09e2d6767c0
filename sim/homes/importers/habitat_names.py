"""Categories of mpcat40 for the names that Habitat's data sets give to objects and rooms."""

from __future__ import annotations

import re
from collections.abc import Mapping

from sim.core.interface import MPCAT40
from sim.houses.proposals import category_of_name
from sim.houses.taxonomies import entries

UNKNOWN = "misc"
"""Category of objects without an annotation, or with a name that the tables lack."""
_LABELS = {"unlabeled": UNKNOWN, "void": UNKNOWN, "chest": "chest_of_drawers"}
_LETTERS: Mapping[str, str] = {
    "a": "bathroom", "b": "bedroom", "c": "closet", "d": "dining_room", "e": "entryway", "f": "family_room",
    "g": "garage", "h": "hallway", "i": "library", "j": "laundry", "k": "kitchen", "l": "living_room",
    "m": "meeting_room", "n": "lounge", "o": "office", "p": "porch", "r": "recreation_room", "s": "stairs",
    "t": "toilet", "u": "utility_room", "v": "tv_room", "w": "gym", "x": "outdoor", "y": "balcony", "z": "room",
    "B": "bar", "C": "classroom", "D": "dining_booth", "S": "spa", "Z": "junk", "-": "room",
}  # fmt: skip
"""Kinds of regions in Matterport3D's .house files."""


def category_of(name: str) -> str | None:
    """Returns the category of a name, or None: by the table, else by its words (`sim.houses.proposals`).

    Args:
        name: for example `potted plant`, `chest_of_drawers_03` or `picture/window`; of several, the first counts.
    """
    key = re.sub(r"[\s_-]*\d*$", "", re.sub(r"[\s_]+", " ", name.lower())).strip()
    label = key.replace(" ", "_")
    if label in MPCAT40 or label in _LABELS:
        return _LABELS.get(label, label)
    entry = entries("habitat").get(key)
    if entry is not None:
        return entry.category
    first, slash, _ = name.partition("/")
    return category_of(first) if slash and first.strip() else category_of_name(name)


def category_of_label(label: str) -> str:
    """Returns the category of a label of mpcat40 itself, as .house files have it."""
    name = label.replace("#", "_").replace(" ", "_").lower()
    return _LABELS.get(name, name if name in MPCAT40 else UNKNOWN)


def kind_of_region(label: str) -> str:
    """Returns the kind of a room of a .house file: `b` is a bedroom."""
    return _LETTERS.get(label, "room")
