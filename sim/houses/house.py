"""A loaded house: a MuJoCo specification without a robot, and its rooms."""

from __future__ import annotations

import functools
import itertools
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim.gl import mujoco

Box = tuple[tuple[float, float, float], tuple[float, float, float]]
"""Centre and half sizes of an axis-aligned box in the world, metres."""

_ROOM = re.compile(r"(?P<room>room_(?P<kind>[a-z][a-z_]*?)_\d+)(?:_\d+)?")


@dataclass(frozen=True)
class House:
    """A house in the house format, without a robot."""

    name: str
    source: mujoco.MjSpec | Callable[[], mujoco.MjSpec]
    """The specification, or a function that reads it when it is first used."""
    rules: Mapping[str, str] | None = None
    """Label rules of a third-party scene, in the form that `read_labels` takes; None for a native house."""
    path: Path | None = None
    notes: tuple[str, ...] = ()
    """Sentences on the elements that were removed from a third-party scene (`sim.houses.foreign`)."""
    checksum: str | None = None
    """Hash of the file and of all other files that it uses; None for a house that was made in memory."""

    @functools.cached_property
    def spec(self) -> mujoco.MjSpec:
        """The specification. It is never changed; a caller that needs another one takes `spec.copy()`."""
        return self.source() if callable(self.source) else self.source


@dataclass(frozen=True)
class Room:
    """The extent of one room as a union of boxes."""

    name: str
    """Name of the room's site, for example `room_bedroom_00`."""
    kind: str
    """Kind of the room, for example `bedroom`."""
    boxes: tuple[Box, ...]

    @property
    def floor_z_m(self) -> float:
        """Height of the room's floor: the bottom of its lowest box."""
        return min(centre[2] - half[2] for centre, half in self.boxes)

    @property
    def area_m2(self) -> float:
        """Area of the union of the boxes in plan."""
        edges = [_sides_m(box) for box in self.boxes]
        xs = sorted({x for edge in edges for x in edge[0:2]})
        ys = sorted({y for edge in edges for y in edge[2:4]})
        return sum(
            (x1 - x0) * (y1 - y0)
            for x0, x1 in itertools.pairwise(xs)
            for y0, y1 in itertools.pairwise(ys)
            if self.contains(0.5 * (x0 + x1), 0.5 * (y0 + y1))
        )

    def contains(self, x_m: float, y_m: float) -> bool:
        """Returns whether a position lies in the room in plan, its edge included."""
        return any(x0 <= x_m <= x1 and y0 <= y_m <= y1 for x0, x1, y0, y1 in map(_sides_m, self.boxes))


def read_rooms(model: mujoco.MjModel) -> tuple[Room, ...]:
    """Returns the rooms that sites of the world body declare, in the model's order."""
    boxes: dict[str, tuple[str, list[Box]]] = {}
    for site in range(model.nsite):
        if (match := _room_of(model, site)) is not None:
            boxes.setdefault(match["room"], (match["kind"], []))[1].append(site_box(model, site))
    return tuple(Room(name, kind, tuple(parts)) for name, (kind, parts) in boxes.items())


def sites_without_room(model: mujoco.MjModel) -> list[str]:
    """Returns the names of the sites that are named like a room and declare none."""
    return [
        name
        for site in range(model.nsite)
        if (name := model.site(site).name).lower().startswith("room") and _room_of(model, site) is None
    ]


def _room_of(model: mujoco.MjModel, site: int) -> re.Match[str] | None:
    """Returns the name and the kind of the room that a site declares; None if it declares none."""
    is_box = model.site_bodyid[site] == 0 and model.site_type[site] == mujoco.mjtGeom.mjGEOM_BOX
    return _ROOM.fullmatch(model.site(site).name) if is_box else None


def site_box(model: mujoco.MjModel, site: int) -> Box:
    """Returns the axis-aligned box around a box site of the world body."""
    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, model.site_quat[site])
    half = np.abs(rotation.reshape(3, 3)) @ model.site_size[site]
    x, y, z = (float(value) for value in model.site_pos[site])
    hx, hy, hz = (float(value) for value in half)
    return (x, y, z), (hx, hy, hz)


def _sides_m(box: Box) -> tuple[float, float, float, float]:
    """Returns the smallest and largest x, the smallest and largest y."""
    (x, y, _), (hx, hy, _) = box
    return x - hx, x + hx, y - hy, y + hy
