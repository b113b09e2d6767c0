"""The objects of a house that satisfy a goal in words, by the true state of the house.

What a house file says about an object (`sim.houses.instance_facts`) is its name, colour and material; sizes, rooms and
places are computed from the geometry. An object without a name has the name of its category.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property

import cv2
import numpy as np

from sim.core.errors import EpisodeError, HouseError
from sim.core.vocabulary import NO_OBJECTS, in_words, vocabulary
from sim.core.wishes import Beside, Wish
from sim.gl import mujoco
from sim.houses.house import Room
from sim.houses.instance_facts import InstanceFacts, read_instance_facts
from sim.houses.labels import Instance
from sim.task.footprints import Footprint, Footprints, house_floors
from sim.world.world import World

NEXT_TO_M = 0.6
"""Objects with at most this gap in plan are next to each other."""
ROUND = 0.9
"""Roundness from which an object is round."""
_ON_M = 0.08
"""Largest gap between the top of an object and the bottom of one that lies on it."""
_OVERHEAD_M = 1.8
"""An object whose lowest point is higher above its floor, such as a ceiling lamp, is no goal."""
MAX_LISTED = 40
"""Largest number of names that a message lists."""


class HouseObject:
    """One object of a house.

    Args:
        instance: the object.
        facts: what the house file says about it.
        outline: computes its footprint, which is None if nothing of it is rendered.
        room_at: finds the room of a footprint; None: it is outside of all rooms.
    """

    def __init__(
        self,
        instance: Instance,
        facts: InstanceFacts,
        outline: Callable[[Instance], Footprint | None],
        room_at: Callable[[Footprint], Room | None],
    ) -> None:
        self.instance, self.facts = instance, facts
        self._outline, self._room_at = outline, room_at

    @property
    def name(self) -> str:
        """Its everyday name, or that of its category."""
        return self.facts.name or in_words(self.instance.category)

    @cached_property
    def outline(self) -> Footprint | None:
        """Its footprint; None: nothing of it is rendered."""
        return self._outline(self.instance)

    @property
    def footprint(self) -> Footprint:
        """Its footprint, where it has one."""
        assert self.outline is not None, f"{self.instance.name} is not rendered"
        return self.outline

    @cached_property
    def room(self) -> Room | None:
        """The room in which the middle of its footprint is; None: outside of all rooms."""
        return self._room_at(self.footprint)

    @property
    def room_kind(self) -> str:
        """Kind of the room, such as `bedroom`; "": outside of all rooms."""
        return "" if self.room is None else self.room.kind

    @property
    def size_m(self) -> float:
        """The cube root of its bounding box's volume, metres."""
        x0, y0, x1, y1 = self.footprint.bounds_m
        z0, z1 = self.footprint.z_m
        return float(np.cbrt(max(x1 - x0, 0.05) * max(y1 - y0, 0.05) * max(z1 - z0, 0.05)))

    @cached_property
    def roundness(self) -> float:
        """The area of the hull of its outline from above, as a share of the smallest circle around it; 1: a circle."""
        hull = cv2.convexHull(self.footprint.boundary_points_m.astype(np.float32))
        _, radius_m = cv2.minEnclosingCircle(hull)
        return cv2.contourArea(hull) / (np.pi * max(radius_m, 1e-6) ** 2)

    @cached_property
    def is_goal(self) -> bool:
        """Whether a robot can be sent to it: rendered, not a part of the building, and not overhead."""
        if self.instance.category in NO_OBJECTS or self.outline is None:
            return False
        return self.footprint.z_m[0] - self.footprint.floor_z_m <= _OVERHEAD_M


class Meaning:
    """The objects of a house, and which of them satisfy a wish; objects are where the house file puts them.

    Args:
        world: the compiled house.
        data: its state, with kinematics computed.
    """

    def __init__(self, world: World, data: mujoco.MjData) -> None:
        self._world, self._data = world, data
        self._gaps: dict[tuple[str, frozenset[str]], float] = {}

    @cached_property
    def objects(self) -> tuple[HouseObject, ...]:
        """All instances. Their geometry is computed on first use: that of a whole house takes seconds."""
        world, data = self._world, self._data
        try:
            facts = read_instance_facts(world.model, world.labels)
        except HouseError as error:
            raise HouseError(f"{self._house}: {error}") from None
        footprints = Footprints(world.model, house_floors(world.model, data, world.labels))
        return tuple(
            HouseObject(
                instance,
                facts.get(instance.name, InstanceFacts()),
                lambda instance: footprints.of(data, instance),
                self._room_of,
            )
            for instance in world.labels.instances
        )

    def satisfying(self, wish: Wish) -> tuple[Instance, ...]:
        """Returns the objects that satisfy a wish.

        Raises:
            EpisodeError: there is none; the message says what there is.
        """
        candidates = self.candidates(wish)
        if wish.count is not None and len(candidates) != wish.count:
            raise EpisodeError(f"{self._house} has {len(candidates)} objects for '{wish.text}', not {wish.count}.")
        if not candidates:
            raise EpisodeError(self._nothing_for(wish))
        if wish.size is not None:
            extreme = max if wish.size == "largest" else min
            best_m = extreme(item.size_m for item in candidates)
            candidates = tuple(item for item in candidates if item.size_m == best_m)
        return tuple(item.instance for item in candidates)

    def candidates(self, wish: Wish) -> tuple[HouseObject, ...]:
        """Returns the objects that satisfy all conditions of a wish but its size."""
        return tuple(item for item in self.named(wish.names) if self._fits(item, wish))

    def named(self, names: Iterable[str]) -> tuple[HouseObject, ...]:
        """Returns the objects with one of some names that a robot can be sent to."""
        return tuple(item for item in self._of_names(names) if item.is_goal)

    def gap_m(self, item: HouseObject, names: frozenset[str]) -> float:
        """Returns the gap in plan between an object and the nearest other one with one of some names; inf: none.

        Objects in different rooms are not near each other, but windows, doors and walls belong to all.
        """
        key = item.instance.name, names
        if key not in self._gaps:
            gaps = [_gap_m(item.footprint, other.footprint) for other in self._others(item, names)]
            self._gaps[key] = min(gaps, default=float("inf"))
        return self._gaps[key]

    def is_at(self, item: HouseObject, beside: Beside) -> bool:
        """Returns whether an object is at a place relative to another one."""
        if beside.place == "next to":
            return self.gap_m(item, beside.names) <= NEXT_TO_M
        return any(
            _gap_m(item.footprint, other.footprint) == 0.0
            and (_is_on(item, other) if beside.place == "on" else _is_under(item, other))
            for other in self._others(item, beside.names)
        )

    def names(self) -> Counter[str]:
        """Returns the names of all objects that can be goals, with how often each occurs."""
        return Counter(item.name for item in self.objects if item.is_goal)

    @property
    def _house(self) -> str:
        return f"House '{self._world.house.name}'"

    @cached_property
    def _by_name(self) -> Mapping[str, Sequence[tuple[int, HouseObject]]]:
        """The objects by name, with their places among all objects."""
        objects = defaultdict[str, list[tuple[int, HouseObject]]](list)
        for place, item in enumerate(self.objects):
            objects[item.name].append((place, item))
        return objects

    def _of_names(self, names: Iterable[str]) -> list[HouseObject]:
        """Returns the objects with one of some names, in the order of the house."""
        by_name = self._by_name
        return [item for _, item in sorted(pair for name in set(names) for pair in by_name.get(name, ()))]

    def _fits(self, item: HouseObject, wish: Wish) -> bool:
        return (
            wish.colour in (None, item.facts.colour)
            and wish.material in ("", item.facts.material)
            and (not wish.rooms or item.room_kind in wish.rooms)
            and (wish.shape is None or item.roundness >= ROUND)
            and all(self.is_at(item, beside) for beside in wish.beside)
        )

    def _others(self, item: HouseObject, names: frozenset[str]) -> list[HouseObject]:
        return [
            other
            for other in self._of_names(names)
            if other is not item
            and other.outline is not None
            and (other.room is item.room or other.instance.category in NO_OBJECTS)
            and abs(other.footprint.floor_z_m - item.footprint.floor_z_m) < 1.0
        ]

    def _room_of(self, footprint: Footprint) -> Room | None:
        x0, y0, x1, y1 = footprint.bounds_m
        storey = (room for room in self._world.rooms if abs(room.floor_z_m - footprint.floor_z_m) < 1.0)
        return next((room for room in storey if room.contains(0.5 * (x0 + x1), 0.5 * (y0 + y1))), None)

    def _nothing_for(self, wish: Wish) -> str:
        same = self.named(wish.names)
        if not same:
            listed = self.names().keys() & vocabulary().categories.keys()  # a house may have names that are no words
            names = ", ".join(sorted(listed)[:MAX_LISTED]) + (", ..." if len(listed) > MAX_LISTED else "")
            return f"{self._house} has no '{wish.noun}'. It has: {names}."
        return f"{self._house} has no '{wish.text}'. It has: {_described(same)}."


def _described(objects: Sequence[HouseObject]) -> str:
    """Returns what is known of some objects: "red armchair (bedroom), armchair (office)"."""
    texts = Counter(
        " ".join(filter(None, (item.facts.colour, item.facts.material, item.name)))
        + (f" ({item.room_kind.replace('_', ' ')})" if item.room_kind else "")
        for item in objects
    )
    return ", ".join(text if count == 1 else f"{count} x {text}" for text, count in sorted(texts.items()))


def _gap_m(a: Footprint, b: Footprint) -> float:
    """Returns the gap between two footprints in plan; 0 where they overlap."""
    (ax0, ay0, ax1, ay1), (bx0, by0, bx1, by1) = a.bounds_m, b.bounds_m
    if np.hypot(max(ax0 - bx1, bx0 - ax1, 0.0), max(ay0 - by1, by0 - ay1, 0.0)) > 2.0:
        return 2.0  # far enough for all purposes
    points_a, points_b = np.asarray(a.boundary_m.data), np.asarray(b.boundary_m.data)
    if a.contains(points_b).any() or b.contains(points_a).any():
        return 0.0
    return float(a.boundary_m.query(points_b)[0].min())


def _is_on(item: HouseObject, other: HouseObject) -> bool:
    return abs(item.footprint.z_m[0] - other.footprint.z_m[1]) <= _ON_M or (
        other.footprint.z_m[0] < item.footprint.z_m[0] < other.footprint.z_m[1]
        and item.footprint.z_m[0] > item.footprint.floor_z_m + _ON_M
    )


def _is_under(item: HouseObject, other: HouseObject) -> bool:
    return item.footprint.z_m[1] < other.footprint.z_m[1] and not _is_on(item, other)
