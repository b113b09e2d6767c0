"""Writes descriptions of objects of a house; each description provably fits exactly one object.

A description has a name and one to three further conditions: colour, material, room, size, or a place next to, on or
under something. An object satisfies the conditions clearly, and every other object of the same name fails one of them
clearly: colours that may be confused, gaps near the limit and nearly equal sizes prove nothing. The text is read again
by `sim.core.wishes`, and the objects that the task finds for it must be just the one.

Whether a colour can be seen is measured in pictures: it must be the most frequent one of the object's pixels.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from sim.core.colours import COLOUR_NAMES, ColourName, colour_numbers
from sim.core.errors import ConfigError, EpisodeError
from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel
from sim.core.wishes import MATERIALS, Beside, Place, Wish, parse_wish
from sim.renderer.camera import Camera
from sim.renderer.profiles import RenderProfile
from sim.task.meaning import HouseObject
from sim.task.objectnav import Task

_CONFUSED: Sequence[frozenset[str]] = (
    frozenset(("white", "grey", "beige")), frozenset(("black", "grey", "brown")), frozenset(("brown", "orange", "red")),
    frozenset(("pink", "red", "purple")), frozenset(("yellow", "beige", "orange", "brown")),
    frozenset(("blue", "purple", "grey")), frozenset(("green", "grey", "yellow")),
)  # fmt: skip
"""Groups of colours that may be confused with each other."""
_SAID_MATERIALS = ("wood", "metal", "glass", "leather", "fabric", "stone", "wicker")
_NEAR_M, _FAR_M = 0.45, 1.1
"""Gaps that are clearly next to each other, and clearly not."""
_SIZE_RATIO = 1.25
"""Sizes that differ by this factor are clearly different."""
_MIN_PIXELS, _MIN_SHARE = 400, 0.4
"""Pixels of an object from which its colour is measured, and share of them that its colour must have."""
_ROUND, _NOT_ROUND = 0.95, 0.8
"""Roundness (`HouseObject.roundness`) from which an object is clearly round, and up to which it is clearly not."""
_SHAPED = frozenset({"coffee table", "dining table", "side table", "stool", "pouf", "ottoman", "floor cushion"})
"""Objects that are described as round if they are."""
_LANDMARKS = frozenset(
    {
        "bed", "four-poster bed", "sofa", "corner sofa", "desk", "dining table", "coffee table", "television", "fridge",
        "cooker", "wardrobe", "toilet", "bathtub", "shower", "washbasin", "fireplace", "bookcase", "window",
        "washing machine", "chest of drawers", "nightstand", "armchair", "kitchen sink", "sideboard", "mirror", "rug",
    }
)  # fmt: skip
"""Objects that descriptions name as places."""
_ADJECTIVES = {name: name for name in MATERIALS.values()} | {"wood": "wooden"}


_OF_COURSE: Mapping[str, frozenset[str]] = MappingProxyType(
    {
        "green": frozenset({"cactus", "potted plant", "potted tree", "bonsai", "flowers"}),
        "glass": frozenset({"mirror", "standing mirror", "shower"}),
        "metal": frozenset({"cooker", "hob", "fridge", "washing machine", "dishwasher", "wood stove", "fireplace"}),
        "fabric": frozenset({"towel rail", "towel stand", "towel ladder", "towel radiator", "towels"}),
    }
)  # fmt: skip
"""Words that describe none of these objects: people expect them, or they are true only of what hangs on the object."""
_UNCOLOURED = frozenset({"towel rail", "towel stand", "towel ladder", "towel radiator", "linen shelf", "laundry shelf"})
"""Objects whose colour is that of what hangs or lies on them."""
_NAMED_BY_ROOM = frozenset(
    {
        "kitchen sink", "kitchen counter", "kitchen island", "kitchen trolley", "bathroom shelf", "vanity cabinet",
        "laundry shelf", "nightstand",
    }
)  # fmt: skip
"""Objects that have the name of their room: no room is said with them."""
_SAID_ROOMS = {
    "laundry": "laundry room",
    "living_room": "living room",
    "dining_room": "dining room",
    "stair_hall": "hallway",
}


@dataclass(frozen=True)
class Description:
    """A text that fits one object."""

    text: str
    level: int
    """Number of conditions besides the name: 1, 2 or 3."""
    instance: str
    """Label of the object."""


class Descriptions:
    """Writes the descriptions of one house.

    Args:
        task: of the house.
        camera: the robot's camera; its pictures show colours.
        profile: rendering profile of the pictures.
    """

    def __init__(self, task: Task, camera: CameraModel, profile: str | RenderProfile = "good") -> None:
        self._task, self._meaning = task, task.truth.meaning
        self._camera = Camera(task.world.model, task.world.labels, camera=camera, profile=profile)
        self._model = camera
        self._seen_colours: dict[str, ColourName | None] = {}
        self._places: dict[float, NDArray[np.float64]] = {}
        """Places where the robot may stand, (n, 2) metres, by floor."""

    def close(self) -> None:
        """Frees the renderer."""
        self._camera.close()

    def of(self, item: HouseObject, rng: np.random.Generator) -> Iterator[Description]:
        """Yields descriptions of an object, the shortest first, each with random words of several that say the same."""
        base = Wish(item.name, frozenset((item.name,)), item.name)
        conditions = list[Wish]()
        for condition in self._conditions(item, base):  # later ones take longer, and often the first ones suffice
            conditions.append(condition)
            yield from self._proved(_joined(base, (condition,)), 1, item, rng)
        for level in (2, 3):
            for chosen in itertools.combinations(conditions, level):
                yield from self._proved(_joined(base, chosen), level, item, rng)

    def _proved(
        self, wish: Wish | None, level: int, item: HouseObject, rng: np.random.Generator
    ) -> Iterator[Description]:
        """Yields the description of an object by a wish, if there is a wish and it is proved."""
        if wish is not None and self.proves(wish, item):
            text = _text(wish, rng)
            if self._reads_as(text, item):
                yield Description(text, level, item.instance.name)

    def proves(self, wish: Wish, item: HouseObject) -> bool:
        """Returns whether an object satisfies a wish clearly, and every other one clearly does not."""
        others = [other for other in self._meaning.named(wish.names) if other is not item]
        rest = replace(wish, size=None, count=None)
        if not self._clearly_fits(rest, item):
            return False
        rivals = [other for other in others if not self._clearly_fails(rest, other)]
        if wish.size is None:
            return not rivals
        if wish.count is not None and len(rivals) + 1 != wish.count:
            return False
        if len(rivals) < 2 or not all(self._clearly_fits(rest, rival) for rival in rivals):
            return False  # a superlative compares three or more, and nothing that perhaps is to be compared
        sizes = [rival.size_m for rival in rivals]
        if wish.size == "largest":
            return item.size_m >= _SIZE_RATIO * max(sizes)
        return item.size_m * _SIZE_RATIO <= min(sizes)

    def seen_colour(self, item: HouseObject) -> ColourName | None:
        """Returns the colour of most pixels of an object in pictures from up to three places; None: no clear one."""
        name = item.instance.name
        if name not in self._seen_colours:
            self._seen_colours[name] = self._measured_colour(item)
        return self._seen_colours[name]

    def _conditions(self, item: HouseObject, base: Wish) -> Iterator[Wish]:
        """Yields wishes with one condition each that an object satisfies."""
        colour, material = item.facts.colour, item.facts.material
        said = colour is not None and item.name not in _UNCOLOURED and item.name not in _OF_COURSE.get(colour, ())
        if said and self.seen_colour(item) == colour:
            yield replace(base, colour=colour)
        if item.room_kind and item.name not in _NAMED_BY_ROOM:
            yield replace(base, rooms=(item.room_kind,))
        if material in _SAID_MATERIALS and item.name not in _OF_COURSE.get(material, ()):
            yield replace(base, material=material)
        if item.name in _SHAPED and item.roundness >= _ROUND:
            yield replace(base, shape="round")
        yield replace(base, size="largest")
        yield replace(base, size="smallest")
        for name in sorted(_LANDMARKS - {item.name}):
            for place in ("on",) if name == "rug" else ("next to", "on", "under"):
                beside = Beside(place, frozenset((name,)), name)
                if self._is_clearly_at(item, beside) and not (place == "next to" and item.name == "place setting"):
                    yield replace(base, beside=(beside,))
                    break

    def _clearly_fits(self, wish: Wish, item: HouseObject) -> bool:
        return (
            (wish.colour is None or (item.facts.colour == wish.colour == self.seen_colour(item)))
            and wish.material in ("", item.facts.material)
            and (not wish.rooms or item.room_kind in wish.rooms)
            and (wish.shape is None or item.roundness >= _ROUND)
            and all(self._is_clearly_at(item, beside) for beside in wish.beside)
        )

    def _clearly_fails(self, wish: Wish, item: HouseObject) -> bool:
        if wish.colour is not None and self._has_another_colour(item, wish.colour):
            return True
        if wish.material and item.facts.material is not None and item.facts.material != wish.material:
            return True
        if wish.rooms and item.room_kind and item.room_kind not in wish.rooms:
            return True
        if wish.shape is not None and item.roundness <= _NOT_ROUND:
            return True
        return any(self._is_clearly_not_at(item, beside) for beside in wish.beside)

    def _has_another_colour(self, item: HouseObject, colour: ColourName) -> bool:
        own = item.facts.colour
        if own is None or own == colour or self.seen_colour(item) != own:
            return False
        return not any(own in group and colour in group for group in _CONFUSED)

    def _is_clearly_at(self, item: HouseObject, beside: Beside) -> bool:
        if beside.place == "next to":
            return 0.0 < self._meaning.gap_m(item, beside.names) <= _NEAR_M
        if beside.names == {"rug"} and not self._is_middle_on_rug(item):
            return False  # one leg on it is not enough
        return self._meaning.is_at(item, beside)

    def _is_middle_on_rug(self, item: HouseObject) -> bool:
        x0, y0, x1, y1 = item.footprint.bounds_m
        middle = np.array([[0.5 * (x0 + x1), 0.5 * (y0 + y1)]])
        rugs = (other.outline for other in self._meaning.objects if other.name == "rug")
        return any(rug is not None and bool(rug.contains(middle).all()) for rug in rugs)

    def _is_clearly_not_at(self, item: HouseObject, beside: Beside) -> bool:
        return self._meaning.gap_m(item, beside.names) >= (_FAR_M if beside.place == "next to" else _NEAR_M)

    def _reads_as(self, text: str, item: HouseObject) -> bool:
        """Returns whether the task finds just this object for a text."""
        try:
            found = self._meaning.satisfying(parse_wish(text))
        except (ConfigError, EpisodeError):
            return False
        return found == (item.instance,)

    def _measured_colour(self, item: HouseObject) -> ColourName | None:
        world, counts = self._task.world, np.zeros(len(COLOUR_NAMES), np.int64)
        geoms = np.array(item.instance.geom_ids)
        for pose in self._views_of(item):
            images = self._camera.render(world.data, pose, ("rgb", "geom"))
            shown = np.isin(images["geom"], geoms)
            if np.count_nonzero(shown) >= _MIN_PIXELS:
                counts += np.bincount(colour_numbers(images["rgb"][shown] / 255.0), minlength=len(COLOUR_NAMES))
        best = int(np.argmax(counts))
        return COLOUR_NAMES[best] if counts.sum() and counts[best] >= _MIN_SHARE * counts.sum() else None

    def _views_of(self, item: HouseObject) -> list[Pose]:
        """Returns up to three poses from which an object can be seen, 1.2 to 2.5 m away where there are such."""
        footprint = item.footprint
        x0, y0, x1, y1 = footprint.bounds_m
        x_m, y_m = 0.5 * (x0 + x1), 0.5 * (y0 + y1)
        space = self._task.truth.space(footprint.floor_z_m)
        region = self._task.truth.region(item.instance.name, footprint.floor_z_m)
        if footprint.floor_z_m not in self._places:
            self._places[footprint.floor_z_m] = space.frame.to_metres(np.argwhere(space.largest_part()))
        places = self._places[footprint.floor_z_m]
        away = np.hypot(places[:, 0] - x_m, places[:, 1] - y_m)
        for least, most in ((1.3, 2.2), (0.7, 3.0)):
            near = places[(away >= least) & (away <= most)]
            near = near[:: max(1, len(near) // 60)]
            near = near[region.sees(footprint, near)] if len(near) else near
            if len(near):
                picked = near[np.linspace(0, len(near) - 1, min(3, len(near))).round().astype(int)]
                return [
                    Pose(float(x), float(y), float(np.arctan2(y_m - y, x_m - x)), footprint.floor_z_m)
                    for x, y in picked
                ]
        return []


def _joined(base: Wish, chosen: Sequence[Wish]) -> Wish | None:
    """Returns the wish with all conditions of others; None: two of them exclude each other."""
    colour = [wish.colour for wish in chosen if wish.colour]
    material = [wish.material for wish in chosen if wish.material]
    size = [wish.size for wish in chosen if wish.size]
    shape = [wish.shape for wish in chosen if wish.shape]
    rooms = [wish.rooms for wish in chosen if wish.rooms]
    beside = [wish.beside for wish in chosen if wish.beside]
    if max(map(len, (colour, material, size, rooms, beside))) > 1:
        return None
    return replace(
        base, colour=next(iter(colour), None), material=next(iter(material), ""), size=next(iter(size), None),
        rooms=next(iter(rooms), ()), beside=next(iter(beside), ()), shape=next(iter(shape), None),
    )  # fmt: skip


_PLACE_WORDS: dict[Place, tuple[str, ...]] = {
    "next to": ("next to", "beside", "near"), "on": ("on",), "under": ("under",),
}  # fmt: skip
_SIZE_WORDS = {"largest": ("largest", "biggest"), "smallest": ("smallest",)}
_BEGINNINGS = ("", "", "", "find ", "go to ", "look for ")


def _text(wish: Wish, rng: np.random.Generator) -> str:
    """Returns a wish in plain English, with random words of those that say the same."""

    def one(words: Sequence[str]) -> str:
        return words[int(rng.integers(len(words)))]

    words = [one(_BEGINNINGS) + "the"]
    if wish.size is not None:
        words.append(one(_SIZE_WORDS[wish.size]))
    if wish.shape is not None:
        words.append(wish.shape)
    if wish.colour is not None:
        words.append(wish.colour)
    if wish.material:
        words.append(_ADJECTIVES[wish.material])
    words.append(wish.noun)
    for beside in wish.beside:
        words += [one(_PLACE_WORDS[beside.place]), "the", beside.words]
    if wish.rooms:
        words += ["in", "the", _SAID_ROOMS.get(wish.rooms[0], wish.rooms[0])]
    return " ".join(words)
