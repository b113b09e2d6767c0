"""Words for objects, as agents and the COCO data set use them, and the categories of this project that they name."""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import MappingProxyType

from sim.core.interface import MPCAT40

OTHER_WORDS: Mapping[str, str] = MappingProxyType(
    {
        "armchair": "chair",
        "couch": "sofa",
        "dining table": "table",
        "desk": "table",
        "coffee table": "table",
        "side table": "table",
        "potted plant": "plant",
        "house plant": "plant",
        "tv": "tv_monitor",
        "television": "tv_monitor",
        "monitor": "tv_monitor",
        "dresser": "chest_of_drawers",
        "nightstand": "chest_of_drawers",
        "painting": "picture",
        "framed photograph": "picture",
        "photograph": "picture",
        "cupboard": "cabinet",
        "wardrobe": "cabinet",
        "pillow": "cushion",
        "countertop": "counter",
        "lamp": "lighting",
        "shelf": "shelving",
        "bookshelf": "shelving",
        "refrigerator": "appliances",
        "fridge": "appliances",
        "oven": "appliances",
        "clothing": "clothes",
    }
)
"""Words in addition to the names of the categories."""
COCO: Mapping[str, str] = MappingProxyType(
    {
        "chair": "chair",
        "sofa": "couch",
        "plant": "potted plant",
        "bed": "bed",
        "table": "dining table",
        "toilet": "toilet",
        "tv_monitor": "tv",
        "sink": "sink",
    }
)
"""The categories that COCO has, and their names there."""
_CATEGORIES: Mapping[str, str] = {name.replace("_", " "): name for name in MPCAT40[1:]} | OTHER_WORDS
_IN_TEXT = re.compile(rf"\b({'|'.join(sorted(map(re.escape, _CATEGORIES), key=len, reverse=True))})(?:s|es)?\b")


def category_of(phrase: str) -> str | None:
    """Returns the category that a word or two name; None: none does."""
    words = " ".join(phrase.lower().replace("_", " ").split())
    singular = (words, words.removesuffix("s"), words.removesuffix("es"))
    return next((_CATEGORIES[word] for word in singular if word in _CATEGORIES), None)


def categories_in(text: str) -> frozenset[str]:
    """Returns the categories whose words are in a sentence."""
    return frozenset(_CATEGORIES[match] for match in _IN_TEXT.findall(text.lower().replace("_", " ")))
