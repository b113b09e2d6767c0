"""The words for objects: everyday names, synonyms, kinds and more general words, and what they mean.

`sim/core/words/vocabulary.csv` has a row for each word. Names are those that house files give to instances
(`sim.houses.instance_facts`); all other words mean a set of names, or a whole category of mpcat40. Most come from
WordNet 3.0, whose licence lies beside the file; `tools.maintenance.make_vocabulary` makes it.
"""

from __future__ import annotations

import csv
import functools
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

from sim.core.interface import MPCAT40

FILE = Path(__file__).parent / "words" / "vocabulary.csv"
NO_OBJECTS = frozenset({"void", "wall", "floor", "ceiling", "door", "window", "stairs", "column", "beam", "railing"})
"""Categories that are no goals in words: the building itself."""
UNSEEN = frozenset(
    {
        "rocking chair", "four-poster bed", "potted tree", "bolster", "wall scroll", "daybed", "console table",
        "media cabinet", "coat stand", "dumbbell rack", "exercise bike", "suitcase", "duffel bag", "teddy bear",
        "tea set", "candlesticks", "hourglass", "spice rack", "drying rack", "linen shelf", "toaster oven",
        "dishwasher", "wood stove", "bench", "washing machine", "bonsai", "floor cushion", "laundry basket",
    }
)  # fmt: skip
"""Names that are asked for in the splits `words-unseen`: no training may use them as labels."""
_S_ENDINGS = ("ss", "us", "is", "as")
"""Endings of words that are no plurals."""
_UNCOUNTABLE = ("gym equipment", "seating", "lighting", "shelving", "toilet paper")
_ONE_OF: Mapping[str, str] = MappingProxyType(
    {"appliances": "an appliance", "furniture": "a piece of furniture", "objects": "an object", "misc": "an object"}
)
"""What one object of a category is called where the name of the category is no name for it."""
_OPENING = re.compile(r"^(find|go to|look for) ", re.IGNORECASE)
_OBJECT = re.compile(r"_\d+$")
_ARTICLE = re.compile(r"^(the|an?) ", re.IGNORECASE)
_AFTER_NOUN = re.compile(r" (?:of|in|inside|from|on|under|below|next to|beside|near|by|at|with) ")
_VOWEL_SOUND = re.compile(r"[aeio]|u(?!ni|ti|se)|hour", re.IGNORECASE)


class Found(NamedTuple):
    """What a phrase means."""

    names: frozenset[str]
    """Everyday names, and categories in words for objects without a name."""
    word: str
    """The words of the phrase that mean it."""
    before: tuple[str, ...]
    """The words before them."""


@dataclass(frozen=True, eq=False)
class Vocabulary:
    """The words of the file."""

    categories: Mapping[str, tuple[str, ...]]
    """The mpcat40 categories of each name."""
    words: Mapping[str, tuple[str, frozenset[str]]]
    """For each word its relation (`name`, `category`, `synonym`, `kind`, `general`, `phrase` or `other`) and names."""

    def find(self, phrase: str) -> Found | None:
        """Returns what a phrase means by its longest last part that is a word: "wooden kitchen chair" is a chair.

        None: no last part of it is a word, or it is a compound with another meaning, such as "flower bed".
        """
        words = normal_form(phrase).split()
        for first in range(len(words)):
            word = self.listed(" ".join(words[first:]))
            if word is not None:
                relation, names = self.words[word]
                return None if relation == "other" else Found(names, word, tuple(words[:first]))
        return None

    def listed(self, word: str) -> str | None:
        """Returns the spelling under which a word in its normal form is listed; None: it is not known."""
        return next((form for form in _forms(word) if form in self.words), None)

    def categories_of(self, names: frozenset[str]) -> tuple[str, ...]:
        """Returns the categories of some names, in the order of `MPCAT40`."""
        of_names = {category for name in names for category in self.categories.get(name, ())}
        return tuple(category for category in MPCAT40 if category in of_names)

    def main_category(self, names: frozenset[str]) -> str:
        """Returns the category that most of some names have; of a name with several, the first counts most."""
        weights: dict[str, float] = {}
        for name in names:
            for place, category in enumerate(self.categories[name]):
                weights[category] = weights.get(category, 0.0) + 1.0 / (1 + place)
        return max(weights, key=lambda category: (weights[category], -MPCAT40.index(category)))


def normal_form(phrase: str) -> str:
    """Returns a phrase in lower case, with single spaces in place of hyphens and punctuation, without an article."""
    words = re.sub(r"[^\w']+", " ", phrase.lower().replace("_", " ")).split()
    while words and words[0] in ("a", "an", "the", "some", "any", "my", "our", "your"):
        del words[0]
    return " ".join(words)


def plain(name: str) -> str:
    """Returns a name as people read it, "chest of drawers"; a goal in words and an object's name, "towel_00", stay."""
    if _OBJECT.search(name):
        return name
    return "television" if name == "tv_monitor" else name.replace("_", " ")


def counted(number: int, noun: str, plural: str = "") -> str:
    """Returns a number with its noun: "1 episode", "2 episodes"; `plural` is for nouns that take no plain s."""
    return f"{number} {noun if number == 1 else plural or noun + 's'}"


def in_words(goal: str) -> str:
    """Returns the name of a category, "chest of drawers", or a goal in words from its noun phrase on."""
    return _ARTICLE.sub("", _OPENING.sub("", plain(goal).strip()))


def is_plural(goal: str) -> bool:
    """Returns whether the noun of a category or of a goal in words is plural: "the slippers under the bed"."""
    noun = _noun(goal)
    return noun.endswith("s") and not noun.endswith(_S_ENDINGS)


def with_article(goal: str) -> str:
    """Returns a category or a goal in words with its article, if it takes one: "an armchair", "clothes"."""
    if goal in _ONE_OF:
        return _ONE_OF[goal]
    phrase = _OPENING.sub("", plain(goal).strip())
    if _ARTICLE.match(phrase) or _noun(goal).endswith(_UNCOUNTABLE) or is_plural(goal):
        return phrase
    return f"{'an' if _VOWEL_SOUND.match(phrase) else 'a'} {phrase}"


def _noun(goal: str) -> str:
    """Returns the words of a goal before its conditions that follow the noun: "red chair" of "the red chair in ..."."""
    return _AFTER_NOUN.split(in_words(goal), maxsplit=1)[0]


@functools.cache
def vocabulary() -> Vocabulary:
    """Returns the words of the file; it is read on first use."""
    with FILE.open(encoding="utf-8", newline="") as file:
        rows = [(row["word"], row["relation"], row["means"].split(";")) for row in csv.DictReader(file)]
    categories = {word: tuple(means) for word, relation, means in rows if relation == "name"}
    for category in MPCAT40:
        if category not in NO_OBJECTS:
            categories.setdefault(category.replace("_", " "), (category,))
    members: dict[str, set[str]] = {}
    for name, of_name in categories.items():
        for category in of_name:
            members.setdefault(category, set()).add(name)
    words: dict[str, tuple[str, frozenset[str]]] = {
        normal_form(category): ("category", frozenset(names)) for category, names in members.items()
    }
    for word, relation, means in rows:
        key = normal_form(word)
        if relation == "name":
            words.setdefault(key, ("name", frozenset((word,))))
        elif key not in words:
            names = {name for mean in means if mean for name in _expanded(mean, members)}
            words[key] = relation, frozenset(names)
    return Vocabulary(MappingProxyType(categories), MappingProxyType(words))


def _expanded(mean: str, members: Mapping[str, set[str]]) -> set[str]:
    return members.get(mean[1:], set()) if mean.startswith("@") else {mean}


def _forms(word: str) -> list[str]:
    """Returns the spellings under which a word may be listed: itself, its singulars and plural, each without spaces."""
    forms = [word, *singulars(word), f"{word}s"]
    return forms + [form.replace(" ", "") for form in forms if " " in form]


def singulars(word: str) -> list[str]:
    """Returns the possible singulars of an English noun; an empty list if it has no ending of a plural."""
    if not word.endswith("s") or word.endswith(_S_ENDINGS):
        return []
    result = [word[:-1]]
    if word.endswith("ies"):
        result.insert(0, word[:-3] + "y")
    elif word.endswith("ves"):
        result = [word[:-3] + "f", word[:-3] + "fe", word[:-1]]
    elif word.endswith(("ches", "shes", "xes", "sses")):
        result.insert(0, word[:-2])
    return result
