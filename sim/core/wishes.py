"""Goals in words: "the red chair next to the bed in the bedroom" as conditions that can be tested.

The same reading serves the task, which finds the objects of a house that satisfy a wish, the agent, which tests it on
the objects of its map, and the page in which a person types it. A word that is not known is an error, not a guess.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Literal, get_args

from sim.core.colours import ColourName
from sim.core.errors import ConfigError, EpisodeError, did_you_mean
from sim.core.interface import GOAL_CATEGORIES, MPCAT40_ID
from sim.core.reading import printable
from sim.core.vocabulary import normal_form, vocabulary

Size = Literal["largest", "smallest"]
Shape = Literal["round"]
Place = Literal["next to", "on", "under"]

MAX_TEXT = 300
"""Largest number of characters of a goal."""
_COLOURS: Mapping[str, ColourName] = MappingProxyType(
    {name: name for name in get_args(ColourName)}
    | {"gray": "grey", "cream": "beige", "tan": "beige", "ivory": "white", "violet": "purple", "golden": "yellow"}
)  # type: ignore[assignment]
MATERIALS: Mapping[str, str] = MappingProxyType(
    {
        "wood": "wood", "wooden": "wood", "lacquer": "lacquer", "lacquered": "lacquer", "painted": "lacquer",
        "fabric": "fabric", "cloth": "fabric", "upholstered": "fabric", "leather": "leather", "metal": "metal",
        "metallic": "metal", "steel": "metal", "iron": "metal", "glass": "glass", "stone": "stone", "marble": "stone",
        "brick": "brick", "ceramic": "ceramic", "porcelain": "ceramic", "plastic": "plastic", "wicker": "wicker",
        "rattan": "wicker", "cardboard": "cardboard", "paper": "paper", "rubber": "rubber",
    }
)  # fmt: skip
"""The material of house files (`sim.houses.instance_facts`) that each word means."""
ROOMS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "bedroom": ("bedroom", "studio"), "bathroom": ("bathroom",), "restroom": ("bathroom",),
        "washroom": ("bathroom",), "kitchen": ("kitchen",), "living room": ("living_room", "studio"),
        "lounge": ("living_room",), "sitting room": ("living_room",), "dining room": ("dining_room",),
        "hallway": ("hallway", "stair_hall"), "hall": ("hallway", "stair_hall"), "corridor": ("hallway",),
        "entrance": ("hallway",), "stairwell": ("stair_hall",), "stair hall": ("stair_hall",), "office": ("office",),
        "study": ("office",), "home office": ("office",), "closet": ("closet",), "walk in closet": ("closet",),
        "dressing room": ("closet",), "laundry": ("laundry",), "laundry room": ("laundry",),
        "utility room": ("laundry",), "gym": ("gym",), "fitness room": ("gym",), "studio": ("studio",),
    }
)  # fmt: skip
"""The kinds of rooms (`room_KIND_NN` of a house file) that each word means."""
_SIZES: Mapping[str, Size] = MappingProxyType(
    {word: "largest" for word in ("largest", "biggest", "larger", "bigger")}
    | {word: "smallest" for word in ("smallest", "smaller")}
)  # type: ignore[assignment]
_SHAPES: Mapping[str, Shape] = MappingProxyType({"round": "round", "circular": "round"})
_PLACES: Mapping[str, Place] = MappingProxyType(
    {word: "next to" for word in ("next to", "beside", "near", "by", "close to", "at")}
    | {word: "on" for word in ("on top of", "on")}
    | {word: "under" for word in ("under", "underneath", "below", "beneath")}
)  # type: ignore[assignment]
_NUMBERS: Mapping[str, int] = MappingProxyType({"two": 2, "three": 3, "four": 4, "five": 5, "six": 6})
_BEGINNINGS = re.compile(
    r"^(please )?((can you |could you )?(go to|drive to|walk to|navigate to|find|look for|search for|show|bring|take"
    r"|get)"
    r"( me to| us to| me| us)?|where is|i want( to see| to find)?|i need|i am looking for)\b"
)


def _one_of(words: Iterable[str]) -> str:
    """Returns a pattern for one of some words, the longest that fits."""
    return f"({'|'.join(sorted(words, key=len, reverse=True))})"


_PLACED = f" (?:that is |which is |standing |lying |hanging )?{_one_of(_PLACES)} "
_BEFORE_PLACE = re.compile(_PLACED)
_IN_ROOM = re.compile(f" (?:in|of|inside|from) (?:the |a |an |my |our )?{_one_of(ROOMS)}(?=$|{_PLACED}| in )")
"""A room at the end of a wish, or before a place: "the chair in the bedroom next to the window"."""
_IN_UNKNOWN = re.compile(r"^(.+?) (?:in|inside) (?:the |a |an |my |our )?(.+)$")
_POLITE_END = re.compile(r" please$")
_OF_N = re.compile(rf"^(\w+) (?:one )?of (?:the |all )?(?:({'|'.join(_NUMBERS)}|\d) )?(.+)$")


@dataclass(frozen=True)
class Beside:
    """A condition on the place of an object relative to another one."""

    place: Place
    names: frozenset[str]
    """Everyday names of the other object."""
    words: str
    """The other object as the wish names it."""


@dataclass(frozen=True)
class Wish:
    """The conditions of a goal in words; "", None and empty: no condition."""

    text: str
    """The wish in a normal form: the same object in other words of politeness has the same text."""
    names: frozenset[str]
    """Everyday names of which the object has one (`sim.core.vocabulary`)."""
    noun: str
    """The word for the object."""
    colour: ColourName | None = None
    material: str = ""
    size: Size | None = None
    """The extreme of the objects that satisfy all other conditions."""
    count: int | None = None
    """The number of objects that satisfy all conditions but `size`."""
    rooms: tuple[str, ...] = ()
    """Kinds of rooms of which the object is in one."""
    beside: tuple[Beside, ...] = ()
    shape: Shape | None = None
    """The outline of the object from above."""

    @property
    def categories(self) -> tuple[str, ...]:
        """The mpcat40 categories of the names."""
        return vocabulary().categories_of(self.names)

    @property
    def is_plain(self) -> bool:
        """True: only the names count."""
        conditions = self.colour, self.material, self.size, self.count, self.rooms, self.beside, self.shape
        return not any(conditions)


class WishError(ConfigError):
    """A wish with an unknown word, or in a form that is not read."""


def parse_wish(text: str) -> Wish:
    """Returns the conditions of a wish in English.

    Raises:
        WishError: it is empty or too long, or has a word that is not known; the message names the word.
    """
    if not text.strip() or len(text) > MAX_TEXT:
        raise WishError(f"A goal in words has 1 to {MAX_TEXT} characters, got {len(text)}.")
    rest = normal_form(_BEGINNINGS.sub("", _POLITE_END.sub("", normal_form(text))))
    in_rooms = [match[1] for match in _IN_ROOM.finditer(f" {rest}")]
    if len(in_rooms) > 1:
        raise WishError(f"A goal may name one room, got '{in_rooms[0]}' and '{in_rooms[1]}'.")
    room = "".join(in_rooms)
    rest = _IN_ROOM.sub("", f" {rest}").strip()
    is_word = rest in vocabulary().words  # "something to sit on" is one
    head, *others = [_first(rest)] if is_word else _split_places(rest)
    beside = tuple(Beside(place, *_other(words)) for place, words in others)
    wish = _noun_phrase(rest, head[1], beside)
    if room and wish.rooms not in ((), ROOMS[room]):
        raise WishError(f"A goal may name one room, got two in '{rest} in the {room}'.")
    return replace(wish, text=f"{wish.text} in the {room}", rooms=ROOMS[room]) if room else wish


def _first(phrase: str) -> tuple[Place, str]:
    """Returns the first phrase in the form of the others; its place is not used."""
    return "on", phrase


def _split_places(rest: str) -> list[tuple[Place, str]]:
    """Returns the phrases of a wish between its words for places, each with the word before it."""
    parts = _BEFORE_PLACE.split(f" {rest} ")
    phrases = [parts[0], *parts[2::2]]
    places: list[Place] = [_PLACES[word] for word in parts[1::2]]
    if any(not normal_form(str(phrase)) for phrase in phrases):
        if len(parts) == 1:
            raise WishError("A goal in words must name an object, such as 'chair'.")
        raise WishError(f"The goal '{rest}' must name an object on each side of '{parts[1]}'.")
    later: list[tuple[Place, str]] = list(zip(places, map(str.strip, map(str, phrases[1:])), strict=True))
    return [_first(phrases[0].strip()), *later]


def _other(words: str) -> tuple[frozenset[str], str]:
    """Returns the names of the other object of a place, which has no conditions of its own."""
    if normal_form(words) in ("window", "windows", "door", "wall"):
        return frozenset((normal_form(words).removesuffix("s"),)), normal_form(words)
    wish = _noun_phrase(words, words, ())
    if not wish.is_plain:
        raise WishError(
            f"'{words}' may only be the name of an object, such as '{wish.noun}': the goal is placed by it."
        )
    return wish.names, wish.noun


def _noun_phrase(text: str, phrase: str, beside: tuple[Beside, ...]) -> Wish:
    """Returns the wish of a phrase without places: "largest of the two red chairs"."""
    phrase, count, size = normal_form(phrase), None, None
    if (match := _OF_N.match(phrase)) and match[1] in _SIZES:
        size, phrase = _SIZES[match[1]], normal_form(match[3])
        count = None if match[2] is None else _NUMBERS.get(match[2]) or int(match[2])
    *adjectives, last = phrase.split() or [""]
    shape: Shape | None = next((_SHAPES[word] for word in adjectives if word in _SHAPES), None)
    # Before the compounds are read: a "round table" is also a conference.
    phrase = " ".join([word for word in adjectives if word not in _SHAPES] + [last])
    found = vocabulary().find(phrase)
    if found is None:
        raise _unknown(phrase)
    colour, material, rooms, words = None, "", (), list(found.before)
    for word in words:
        if word in _COLOURS and colour is None:
            colour = _COLOURS[word]
        elif word in MATERIALS and not material:
            material = MATERIALS[word]
        elif word in _SIZES and size is None:
            size = _SIZES[word]
        elif word in ROOMS and not rooms:
            rooms = ROOMS[word]
        elif word not in ("the", "and"):
            raise _unknown(word, before=found.word)
    return Wish(normal_form(text), found.names, found.word, colour, material, size, count, rooms, beside, shape)


def _unknown(word: str, before: str = "") -> WishError:
    objects = [known for known, (relation, _) in vocabulary().words.items() if relation != "other"]
    conditions = [*_COLOURS, *MATERIALS, *_SIZES, *_SHAPES, *ROOMS]
    if before and word in conditions:
        raise WishError(f"A goal has one colour, material, size and room; '{word}' before '{before}' is a second one.")
    if before:
        hint = did_you_mean(f"{word} {before}", objects, 0.9) or did_you_mean(word, conditions, 0.7)
        return WishError(
            f"The word '{word}' before '{before}' is not known.{hint} Known are colours "
            f"({', '.join(get_args(ColourName))}), materials, 'round', 'largest' and 'smallest', and rooms."
        )
    if (match := _IN_UNKNOWN.match(word)) and vocabulary().find(match[1]) is not None:
        rooms = ", ".join(dict.fromkeys(kinds[0].replace("_", " ") for kinds in ROOMS.values()))
        return WishError(f"No room is known as '{match[2]}'.{did_you_mean(match[2], ROOMS)} Rooms: {rooms}.")
    condition, _, rest = word.partition(" ")
    while rest and condition in conditions:
        word, (condition, _, rest) = rest, rest.partition(" ")
    return WishError(f"No object is known as '{word}'.{did_you_mean(word, objects, 0.82)}")


def require_goal(goal: str) -> None:
    """Raises EpisodeError if a goal is neither a category, nor the label of an instance, nor words that are known."""
    if goal in GOAL_CATEGORIES or category_of_label(goal) is not None:
        return
    try:
        parse_wish(goal)
    except WishError as error:
        raise EpisodeError(
            f"Unknown goal '{printable(goal)}'. {error} Categories: {', '.join(GOAL_CATEGORIES)}."
        ) from None


def category_of_label(goal: str) -> str | None:
    """Returns the category of the label of an instance (`chair_03`); None: it is not one."""
    category, _, number = goal.rpartition("_")
    numbered = number.isascii() and number.isdigit()
    return category if numbered and category in MPCAT40_ID and category != "void" else None


def categories_of(goal: str) -> tuple[str, ...]:
    """Returns the mpcat40 categories of the objects that a goal may mean.

    Args:
        goal: a category, the label of an instance (`chair_03`), or words; "": no goal.

    Raises:
        WishError: a word is not known.
    """
    if not goal:
        return ()
    category = category_of_label(goal) or goal
    return (category,) if category in MPCAT40_ID else parse_wish(goal).categories
