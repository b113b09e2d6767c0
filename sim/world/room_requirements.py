"""The furniture that each kind of room of a generated house must have, and the check of it.

A requirement counts instances by their mpcat40 category, some by their everyday name. An instance belongs to a room if
the room's site contains the middle of its bounding box. The longest side of that box tells a cooker from a toaster and
a dresser from a nightstand.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from sim.gl import mujoco
from sim.houses.house import Room
from sim.houses.instance_facts import read_instance_facts
from sim.houses.labels import Labels

SITE_MARGIN_M = 0.05
"""The middle of an instance may lie this far above or below a room's site."""


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


def unmet_requirements(model: mujoco.MjModel, data: mujoco.MjData, labels: Labels, rooms: Sequence[Room]) -> list[str]:
    """Returns a sentence for each requirement that a room of a compiled house does not meet.

    Args:
        model: the compiled house.
        data: its state; kinematics must be computed.
        labels: the labels of its geoms.
        rooms: its rooms.

    Raises:
        HouseError: the text of an instance has another form than docs/houses.md describes.
    """
    pieces: dict[str, list[Piece]] = {room.name: [] for room in rooms}
    facts = read_instance_facts(model, labels)
    categories = {name for room in rooms for need in REQUIREMENTS.get(room.kind, ()) for name in need.categories}
    for instance in labels.instances:
        if instance.category not in categories:
            continue
        low, high = _box(model, data, instance.geom_ids)
        for room in rooms:
            if _holds(room, 0.5 * (low + high)):
                name = facts[instance.name].name if instance.name in facts else ""
                pieces[room.name].append(Piece(instance.category, float((high - low).max()), name))
    return [
        f"{room.name} {clause}"
        for room in rooms
        for clause in missing_pieces(room.kind, room.area_m2, pieces[room.name])
    ]


def _box(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: Sequence[int]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the lowest and highest corner (3,) of the world-aligned box around some geoms, metres."""
    ids = np.array(geoms)
    rotation = data.geom_xmat[ids].reshape(-1, 3, 3)
    middle = data.geom_xpos[ids] + np.einsum("nij,nj->ni", rotation, model.geom_aabb[ids, :3])
    reach = np.einsum("nij,nj->ni", np.abs(rotation), model.geom_aabb[ids, 3:])
    return (middle - reach).min(axis=0), (middle + reach).max(axis=0)


def _holds(room: Room, point_m: NDArray[np.float64]) -> bool:
    """Returns whether a point (3,) lies in one of the boxes of a room."""
    slack = np.array([0.0, 0.0, SITE_MARGIN_M])
    return any(bool((np.abs(point_m - centre) <= np.add(half, slack)).all()) for centre, half in room.boxes)
