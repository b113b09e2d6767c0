"""The furniture that each kind of room of a generated house must have, and the check of it.

A requirement counts instances by their mpcat40 category, some by their everyday name. An instance belongs to a room if
the room's site contains the middle of its bounding box. The longest side of that box tells a cooker from a toaster and
a dresser from a nightstand.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from sim.houses.house import Room
from sim.world.standing import Standing, is_in


@dataclass(frozen=True)
class Piece:
    """An instance in a room."""

    category: str
    """mpcat40 name with underscores."""
    longest_m: float
    """Longest side of its bounding box."""
    name: str = ""
    """Everyday name; "" where the file does not say."""


@dataclass(frozen=True)
class Requirement:
    """A number of instances that a room must have, all of some categories together."""

    what: str
    """The requirement in words, after "it has no" or "it needs"."""
    categories: tuple[str, ...]
    count: int = 1
    longest_m: float = 0.0
    """Instances do not count if their longest side is smaller."""
    from_m2: float = 0.0
    """Smallest floor area of a room to which the requirement applies."""
    names: tuple[str, ...] = ()
    """Everyday names that count; any when empty. An instance without a name counts by its category."""

    def counted(self, pieces: Iterable[Piece]) -> int:
        """Returns the number of pieces that count."""
        return sum(
            piece.category in self.categories
            and piece.longest_m >= self.longest_m
            and (not self.names or piece.name in ("", *self.names))
            for piece in pieces
        )


GUEST_TOILET_M2 = 3.2
"""A bathroom below this floor area is a guest toilet, which needs no shower and no bathtub."""
_KITCHEN = (
    Requirement("counter", ("counter",), longest_m=0.7),
    Requirement("sink", ("sink",)),
    Requirement("large appliances (fridge, cooker, hob, dishwasher ...)", ("appliances",), 2, 0.4),
    Requirement("fridge", ("appliances",), longest_m=0.4, names=("fridge",)),
    Requirement("cooker or hob", ("appliances",), longest_m=0.4, names=("cooker", "hob")),
)
_USEFUL = Requirement(
    "useful piece (console, bench, shelf, chest, hooks or mirror)",
    ("table", "seating", "shelving", "cabinet", "chest_of_drawers", "clothes", "mirror", "stool", "chair"),
    from_m2=5.0,
)
_STORAGE = ("cabinet", "chest_of_drawers", "shelving", "clothes")

REQUIREMENTS: Mapping[str, tuple[Requirement, ...]] = MappingProxyType(
    {
        "kitchen": _KITCHEN,
        "bathroom": (
            Requirement("toilet", ("toilet",)),
            Requirement("sink", ("sink",)),
            Requirement("shower or bathtub", ("shower", "bathtub"), from_m2=GUEST_TOILET_M2),
        ),
        "bedroom": (
            Requirement("bed", ("bed",)),
            Requirement(
                "wardrobe or clothes rack", ("cabinet", "clothes"), longest_m=0.7, names=("wardrobe", "clothes rack")
            ),
        ),
        "living_room": (
            Requirement("sofa or other seat", ("sofa", "seating", "chair")),
            Requirement("screen, fireplace or table to sit at", ("tv_monitor", "fireplace", "table")),
        ),
        "dining_room": (
            Requirement("dining table", ("table",), longest_m=0.7, names=("dining table",)),
            Requirement("chairs", ("chair",), 2),
        ),
        "studio": (
            *_KITCHEN,
            Requirement("bed", ("bed",)),
            Requirement("sofa or other seat", ("sofa", "seating", "chair")),
        ),
        "office": (
            Requirement("desk", ("table",), longest_m=0.7, names=("desk",)),
            Requirement("chair", ("chair",)),
            Requirement("shelf or cabinet", ("shelving", "cabinet", "chest_of_drawers"), longest_m=0.7),
        ),
        "gym": (Requirement("pieces of gym equipment", ("gym_equipment",), 2),),
        "laundry": (
            Requirement("washing machine", ("appliances",), longest_m=0.6),
            Requirement("counter, sink, drying rack or basket", ("counter", "sink", "clothes")),
        ),
        "closet": (
            Requirement("wardrobe, chest, shelf or clothes rack", _STORAGE, longest_m=0.7),
            Requirement("wardrobes, chests, shelves or clothes racks", _STORAGE, 2, longest_m=0.7, from_m2=4.0),
        ),
        "hallway": (_USEFUL,),
        "stair_hall": (_USEFUL,),
    }
)
"""Requirements by kind of room; the other kinds have no requirements."""


def missing_pieces(kind: str, area_m2: float, pieces: Sequence[Piece]) -> list[str]:
    """Returns a clause ("has no sink") for each requirement that a room of this kind and area does not meet."""
    faults = []
    for requirement in REQUIREMENTS.get(kind, ()):
        count = requirement.counted(pieces)
        if area_m2 < requirement.from_m2 or count >= requirement.count:
            continue
        faults.append(
            f"has no {requirement.what}"
            if requirement.count == 1
            else f"has {count} of {requirement.count} {requirement.what}"
        )
    return faults


def unmet_requirements(standing: Sequence[Standing], rooms: Sequence[Room]) -> list[str]:
    """Returns a sentence for each requirement that a room of a compiled house does not meet.

    Args:
        standing: the instances of the house.
        rooms: its rooms.
    """
    return [
        f"{room.name} {clause}"
        for room in rooms
        for clause in missing_pieces(room.kind, room.area_m2, [_piece(item) for item in standing if is_in(room, item)])
    ]


def _piece(item: Standing) -> Piece:
    name = "" if item.name == item.category.replace("_", " ") else item.name
    return Piece(item.category, float((item.high - item.low).max()), name)
