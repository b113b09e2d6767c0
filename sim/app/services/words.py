"""Words for objects in requests of agents and in replies of detectors, as categories of this project."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from sim.core.interface import MPCAT40
from sim.core.vocabulary import normal_form, vocabulary

COCO: Mapping[str, str] = MappingProxyType(
    {
        "chair": "chair", "sofa": "couch", "plant": "potted plant", "bed": "bed", "table": "dining table",
        "toilet": "toilet", "tv_monitor": "tv", "sink": "sink",
    }
)  # fmt: skip
"""The categories that COCO has, and their names there."""
_LONGEST = 4
"""Words of the longest phrase that is looked for in a sentence."""


def category_of(phrase: str) -> str | None:
    """Returns the category that a word or a phrase names; None: it names none."""
    category = normal_form(phrase).replace(" ", "_")
    if category in MPCAT40[1:]:
        return category
    found = vocabulary().find(phrase)
    return None if found is None else vocabulary().main_category(found.names)


def categories_in(text: str) -> frozenset[str]:
    """Returns the categories whose words are in a sentence, the longest phrases first."""
    words, result, first = normal_form(text).split(), set[str](), 0
    while first < len(words):
        ends = range(min(first + _LONGEST, len(words)), first, -1)
        end = next((end for end in ends if vocabulary().listed(" ".join(words[first:end]))), None)
        category = None if end is None else category_of(" ".join(words[first:end]))
        if category is not None:
            result.add(category)
        first = end or first + 1
    return frozenset(result)
