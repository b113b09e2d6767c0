"""A house plan: one storey of a house on a grid of 5 cm, with the heights of everything that a camera can see.

A plan is what remains of a house for a camera and a robot on a plane: above each cell the spans of height that are
occupied and by which instance, the distance to the border of the free space, the floor, the rooms, and the places
where a STOP succeeds. `sim.homes.plans.export` computes it from an MJCF house; reading and using it needs no MuJoCo.
"""

from __future__ import annotations

import io
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import msgspec
import numpy as np
from numpy.typing import NDArray

from sim.core.errors import HouseError
from sim.core.files import write_atomically
from sim.core.geometry.fast_marching import distances
from sim.core.geometry.grid import GridFrame
from sim.core.interface import GOAL_CATEGORIES, MPCAT40, MPCAT40_ID
from sim.core.reading import Metres, Name, parse_json, read_npz, reason_of

CELL_M = 0.05
"""Edge of a cell of a plan."""
FORMAT = 1
"""Version of the file format; it is increased when the arrays change their meaning."""
HEIGHT_UNIT_M = 0.0125
"""Unit of the heights in a file, one byte each: up to 3.19 m above the floor."""
MAX_FILE_BYTES = 512 << 20
"""Largest plan in memory; that of a house of 800 m2 has 5 MB."""
_ARRAYS = ("slack_m", "floor", "room", "succeeds", "span_start", "span_low_m", "span_high_m", "span_instance")


@dataclass(frozen=True, eq=False, kw_only=True)
class Plan:
    """One storey of a house. Arrays over the ground are (rows, cols) on `frame`, which is in the world's plane."""

    name: str
    """Name of the house and the storey: `storey_name`."""
    frame: GridFrame
    floor_z_m: float
    """Height of the storey's floor in the world; all heights of the plan are above it."""
    ceiling_m: float
    """Height of the ceiling."""
    radius_m: float
    """Radius of the robot that the free space is for."""
    slack_m: NDArray[np.float32]
    """Distance of the robot's centre to the border of the free space, positive inside."""
    floor: NDArray[np.bool_]
    """True: the cell's centre is on a floor of the storey."""
    room: NDArray[np.int16]
    """Index into `rooms`; -1: in no room."""
    rooms: tuple[str, ...]
    """Names of the rooms, such as `room_bedroom_00`."""
    succeeds: NDArray[np.uint32]
    """Bit g is set where a STOP for goal category g of `GOAL_CATEGORIES` succeeds."""
    span_start: NDArray[np.int32]
    """(cells + 1,) The spans of cell i, in row-major order, are those from `span_start[i]` to `span_start[i + 1]`."""
    span_low_m: NDArray[np.float32]
    """(spans,) Lower end of each occupied span of height."""
    span_high_m: NDArray[np.float32]
    """(spans,) Upper end. Of several spans of a cell, those of walls come last."""
    span_instance: NDArray[np.uint16]
    """(spans,) Index into `instances`."""
    instances: tuple[str, ...]
    """Names of the instances."""
    categories: NDArray[np.uint8]
    """(instances,) mpcat40 id of each instance."""
    source: Mapping[str, object] = field(default_factory=dict)
    """Origin of the house: JSON types."""
    _distance_m: dict[str, NDArray[np.float32]] = field(default_factory=dict, repr=False, init=False)

    @property
    def free(self) -> NDArray[np.bool_]:
        """The cells where the robot's centre may be at the cell's centre."""
        return self.slack_m > 0.0

    def goals(self) -> tuple[str, ...]:
        """Returns the goal categories for which a STOP succeeds somewhere."""
        bits = int(np.bitwise_or.reduce(self.succeeds, axis=None))
        return tuple(goal for number, goal in enumerate(GOAL_CATEGORIES) if bits >> number & 1)

    def success_cells(self, goal: str) -> NDArray[np.bool_]:
        """Returns the cells where a STOP for a goal succeeds at the cell's centre."""
        return (self.succeeds >> np.uint32(GOAL_CATEGORIES.index(goal)) & np.uint32(1)).astype(np.bool_)

    def distance_m(self, goal: str) -> NDArray[np.float32]:
        """Returns the geodesic distance from each cell to the nearest one where a STOP succeeds; inf: no path."""
        if goal not in self._distance_m:
            self._distance_m[goal] = distances(self.success_cells(goal), self.free, self.frame.cell_m)
        return self._distance_m[goal]

    def occupied(self, low_m: float, high_m: float) -> NDArray[np.bool_]:
        """Returns the cells with a span between two heights, or a part of one: they block the sight there."""
        here = (self.span_low_m <= high_m) & (self.span_high_m >= low_m)
        return np.bincount(self.span_cell[here], minlength=self.floor.size).reshape(self.floor.shape) > 0

    @property
    def span_cell(self) -> NDArray[np.int64]:
        """(spans,) The row-major cell of each span."""
        return np.repeat(np.arange(self.floor.size), np.diff(self.span_start))

    def span_goals(self) -> NDArray[np.int8]:
        """Returns for each span the index of its category in `GOAL_CATEGORIES`; -1: it is not a goal."""
        goal_of = np.full(len(MPCAT40), -1, np.int8)
        goal_of[[MPCAT40_ID[goal] for goal in GOAL_CATEGORIES]] = np.arange(len(GOAL_CATEGORIES))
        return goal_of[self.categories][self.span_instance]


def storey_name(house: str, number: int) -> str:
    """Returns the name of the plan of a storey; the lowest one, number 0, has the name of the house."""
    return house if number == 0 else f"{house}_storey_{number}"


def house_of(name: str) -> str:
    """Returns the name of the house in the name of a plan: `storey_name` without the storey."""
    return re.sub(r"_storey_\d+$", "", name)


def write_plan(path: Path, plan: Plan) -> None:
    """Writes a plan as a compressed npz file; heights are rounded to `HEIGHT_UNIT_M`."""
    arrays: dict[str, NDArray] = {name: getattr(plan, name) for name in _ARRAYS} | {"categories": plan.categories}
    arrays["slack_m"] = plan.slack_m.astype(np.float16)
    for name in ("span_low_m", "span_high_m"):
        arrays[name] = np.clip(np.rint(arrays[name] / HEIGHT_UNIT_M), 0, 255).astype(np.uint8)
    about = {
        "format": FORMAT,
        "name": plan.name,
        "origin_xy_m": plan.frame.origin_xy_m,
        "cell_m": plan.frame.cell_m,
        "floor_z_m": plan.floor_z_m,
        "ceiling_m": plan.ceiling_m,
        "radius_m": plan.radius_m,
        "rooms": plan.rooms,
        "instances": plan.instances,
        "source": plan.source,
    }
    content = io.BytesIO()
    np.savez_compressed(content, about=np.array(json.dumps(about)), **arrays)  # pyright: ignore[reportArgumentType] - arrays only
    write_atomically(path, content.getvalue())


def read_plan(path: Path) -> Plan:
    """Returns the plan in a file.

    Raises:
        HouseError: the file does not exist, or it is not a plan of this format.
    """
    what = "house plan (`stubborn houses plans` writes them)"
    arrays = read_npz(path, (*_ARRAYS, "categories", "about"), what=what, most_bytes=MAX_FILE_BYTES, error=HouseError)
    try:
        about = parse_json(str(arrays.pop("about")), _About, where="its header 'about'", error=HouseError)
        if about.format != FORMAT:
            raise ValueError(f"its format is {about.format}, this version reads {FORMAT}")
        _check(about, arrays)
    except ValueError as error:
        raise HouseError(f"'{path}' is not a {what}: {reason_of(error)}.") from None
    for name in ("span_low_m", "span_high_m"):
        arrays[name] = arrays[name].astype(np.float32) * np.float32(HEIGHT_UNIT_M)
    arrays["slack_m"] = arrays["slack_m"].astype(np.float32)
    return Plan(
        name=about.name,
        frame=GridFrame(origin_xy_m=about.origin_xy_m, shape=arrays["floor"].shape, cell_m=about.cell_m),
        floor_z_m=about.floor_z_m,
        ceiling_m=about.ceiling_m,
        radius_m=about.radius_m,
        rooms=about.rooms,
        instances=about.instances,
        source=about.source,
        **arrays,
    )


class _About(msgspec.Struct):
    """The JSON in `about`."""

    format: int
    name: Name
    origin_xy_m: tuple[Metres, Metres]
    cell_m: Annotated[float, msgspec.Meta(ge=0.001, le=1.0)]
    floor_z_m: Metres
    ceiling_m: Metres
    radius_m: Annotated[float, msgspec.Meta(gt=0.0, le=10.0)]
    rooms: tuple[Name, ...]
    instances: tuple[Name, ...]
    source: Mapping[str, object]


def _check(about: _About, arrays: Mapping[str, NDArray]) -> None:
    """Raises ValueError if arrays do not fit each other: compiled functions index them without a check."""
    floor, start, spans = arrays["floor"], arrays["span_start"], arrays["span_low_m"].size
    kinds = {"slack_m": "f", "floor": "b", "room": "i", "succeeds": "u", "span_start": "i", "span_low_m": "u",
             "span_high_m": "u", "span_instance": "u", "categories": "u"}  # fmt: skip
    for name, kind in kinds.items():
        if arrays[name].dtype.kind != kind:
            raise ValueError(f"{name} is of type {arrays[name].dtype}")
    if floor.ndim != 2 or any(arrays[name].shape != floor.shape for name in ("slack_m", "room", "succeeds")):
        raise ValueError("the arrays over the ground have different shapes")
    if any(arrays[name].shape != (spans,) for name in ("span_low_m", "span_high_m", "span_instance")):
        raise ValueError("the arrays of spans have different lengths")
    if start.shape != (floor.size + 1,) or start[0] != 0 or start[-1] != spans or bool((np.diff(start) < 0).any()):
        raise ValueError("span_start does not count the spans of the cells")
    ends = (("span_instance", len(about.instances)), ("categories", len(MPCAT40)), ("room", len(about.rooms)))
    if any(arrays[name].size and int(arrays[name].max()) >= end for name, end in ends):
        raise ValueError("an index is out of range")
    if arrays["categories"].shape != (len(about.instances),) or bool(np.isnan(arrays["slack_m"]).any()):
        raise ValueError("categories or slack_m are not those of the instances and cells")
