"""Reads and writes `<name>.json` next to `<name>.xml`: the start, goal and sensor noise that a scene prescribes.

For a trap of a family it also holds the family's parameters and the shortest paths.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Literal

import msgspec

from sim.core.errors import HouseError
from sim.core.files import write_atomically
from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES
from sim.core.reading import Count, Metres, Name, read_json

Parameter = float | int | str
"""Value of a parameter of a trap."""


@dataclass(frozen=True, kw_only=True)
class TrapFacts:
    """The family, difficulty and parameters of a trap of `stubborn traps --family`, and its shortest paths."""

    family: str
    difficulty: str
    seed: int
    parameters: Mapping[str, Parameter]
    """Parameters of the family, as `sim.homes.housegen.traps.families` names them."""
    gap_m: float
    """Width of the narrowest passage of the route to the goal."""
    hidden_length_m: float
    """Total length in plan of the hidden panes, stools, sills, rows of legs, or of the drop."""
    hidden_objects: int
    """Number of hidden geoms."""
    shortest_path_m: float
    """Geodesic distance from the start to the nearest place where a STOP succeeds."""
    open_path_m: float
    """The same distance without the hidden obstacles."""
    fewest_actions: int
    """Number of turns and forwards of a route that a breadth-first search over poses found."""


@dataclass(frozen=True, kw_only=True)
class Sidecar:
    """The start, goal and noise that a scene prescribes; None or empty: not prescribed."""

    start: Pose | None = None
    goal: str | None = None
    noise: Mapping[str, object] = field(default_factory=dict)
    """Sensor noise of every episode in this scene, in the form that `sim.sensors.noise` reads."""
    reason: str = ""
    """Purpose of the scene, in one line."""
    zone_m: tuple[float, float, float, float] | None = None
    """x0, y0, x1, y1 of the trap: steps inside it count as steps in the trap."""
    trap: TrapFacts | None = None
    """None: the scene is of no family."""


EMPTY_SIDECAR = Sidecar()


class _Start(msgspec.Struct, forbid_unknown_fields=True):
    x_m: Metres
    y_m: Metres
    yaw_rad: Metres
    floor_z_m: Metres = 0.0


class _Trap(msgspec.Struct, forbid_unknown_fields=True):
    family: Name
    difficulty: Name
    seed: Count
    parameters: dict[Name, float | int | Name]
    gap_m: Metres
    hidden_length_m: Metres
    hidden_objects: Count
    shortest_path_m: Metres
    open_path_m: Metres
    fewest_actions: Count


class _Content(msgspec.Struct, forbid_unknown_fields=True):
    """The file."""

    reason: str = ""
    goal: Literal[GOAL_CATEGORIES] | None = None  # pyright: ignore[reportInvalidTypeForm] - the values of a tuple
    start: _Start | None = None
    zone_m: tuple[Metres, Metres, Metres, Metres] | None = None
    noise: dict[str, object] | None = None
    trap: _Trap | None = None


def sidecar_path(house_file: Path) -> Path:
    """Returns the path of the sidecar of a house file, whether it exists or not."""
    return house_file.with_suffix(".json")


def read_sidecar(house_file: Path) -> Sidecar:
    """Returns the sidecar next to a house file; `EMPTY_SIDECAR` if the file does not exist.

    Raises:
        HouseError: it is not a JSON object, has an unknown key, or a value that is not allowed.
    """
    file = sidecar_path(house_file)
    if not file.is_file():
        return EMPTY_SIDECAR
    content = read_json(file, _Content, what="Sidecar", error=HouseError)
    start, (x0, y0, x1, y1) = content.start, content.zone_m or (0.0, 0.0, 0.0, 0.0)
    return Sidecar(
        start=None if start is None else Pose(start.x_m, start.y_m, start.yaw_rad, start.floor_z_m),
        goal=content.goal,
        noise=content.noise or {},
        reason=content.reason,
        zone_m=None if content.zone_m is None else (x0, y0, x1, y1),
        trap=None if content.trap is None else TrapFacts(**msgspec.structs.asdict(content.trap)),
    )


def write_sidecar(house_file: Path, sidecar: Sidecar) -> None:
    """Writes the sidecar of a house file; the same content gives the same bytes."""
    content: dict[str, object] = {"reason": sidecar.reason, "goal": sidecar.goal}
    if sidecar.start is not None:
        start = sidecar.start
        content["start"] = {"x_m": start.x_m, "y_m": start.y_m, "yaw_rad": start.yaw_rad}
        if start.floor_z_m:
            content["start"]["floor_z_m"] = start.floor_z_m
    if sidecar.zone_m is not None:
        content["zone_m"] = list(sidecar.zone_m)
    if sidecar.noise:
        content["noise"] = dict(sidecar.noise)
    if sidecar.trap is not None:
        content["trap"] = {**asdict(sidecar.trap), "parameters": dict(sidecar.trap.parameters)}
    text = json.dumps(content, indent=2, allow_nan=False)
    write_atomically(sidecar_path(house_file), text + "\n")
