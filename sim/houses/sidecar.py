"""Reads and writes `<name>.json` beside `<name>.xml`: the start, goal and sensor noise that a scene prescribes."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sim.errors import HouseError
from sim.files import write_atomically
from sim.geometry.pose import Pose
from sim.interface import GOAL_CATEGORIES


@dataclass(frozen=True, kw_only=True)
class Sidecar:
    """The start, goal and noise that a scene prescribes; None or empty: not prescribed."""

    start: Pose | None = None
    goal: str | None = None
    noise: Mapping[str, Any] = field(default_factory=dict)
    """Sensor noise of every episode in this scene, in the form that `sim.sensors.noise` reads."""
    reason: str = ""
    """Purpose of the scene, in one line."""
    zone_m: tuple[float, float, float, float] | None = None
    """x0, y0, x1, y1 of the trap: steps inside it count as steps in the trap."""


EMPTY_SIDECAR = Sidecar()


def sidecar_path(house_file: Path) -> Path:
    """Returns the path of the sidecar of a house file, whether it exists or not."""
    return house_file.with_suffix(".json")


def read_sidecar(house_file: Path) -> Sidecar:
    """Returns the sidecar beside a house file; `EMPTY_SIDECAR` when there is none.

    Raises:
        HouseError: it is not a JSON object, has an unknown key, or a value that is not allowed.
    """
    file = sidecar_path(house_file)
    if not file.is_file():
        return EMPTY_SIDECAR
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
        return _parse(content)
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise HouseError(f"Sidecar '{file}': {error}") from None


def write_sidecar(house_file: Path, sidecar: Sidecar) -> None:
    """Writes the sidecar of a house file; the same content gives the same bytes."""
    content: dict[str, Any] = {"reason": sidecar.reason, "goal": sidecar.goal}
    if sidecar.start is not None:
        start = sidecar.start
        content["start"] = {"x_m": start.x_m, "y_m": start.y_m, "yaw_rad": start.yaw_rad}
        if start.floor_z_m:
            content["start"]["floor_z_m"] = start.floor_z_m
    if sidecar.zone_m is not None:
        content["zone_m"] = list(sidecar.zone_m)
    if sidecar.noise:
        content["noise"] = dict(sidecar.noise)
    text = json.dumps(content, indent=2, allow_nan=False)
    write_atomically(sidecar_path(house_file), text + "\n")


def _parse(content: Mapping[str, Any]) -> Sidecar:
    known = ("reason", "goal", "start", "zone_m", "noise")
    for key in content:
        if key not in known:
            raise ValueError(f"unknown key '{key}'. The keys are: {', '.join(known)}.")
    goal, zone = content.get("goal"), content.get("zone_m")
    if goal is not None and goal not in GOAL_CATEGORIES:
        raise ValueError(
            f"goal '{goal}' is not a goal category. The goal categories are: {', '.join(GOAL_CATEGORIES)}."
        )
    if zone is not None and len(zone) != 4:
        raise ValueError(f"zone_m must be [x0, y0, x1, y1], got {zone}.")
    x0, y0, x1, y1 = map(float, zone) if zone is not None else (0.0, 0.0, 0.0, 0.0)
    return Sidecar(
        start=None if content.get("start") is None else _pose(content["start"]),
        goal=goal,
        noise=dict(content.get("noise") or {}),
        reason=str(content.get("reason", "")),
        zone_m=None if zone is None else (x0, y0, x1, y1),
    )


def _pose(start: Mapping[str, float]) -> Pose:
    missing = sorted({"x_m", "y_m", "yaw_rad"} - set(start))
    unknown = sorted(set(start) - {"x_m", "y_m", "yaw_rad", "floor_z_m"})
    if missing or unknown:
        raise ValueError(f"start must have x_m, y_m and yaw_rad (and may have floor_z_m), got {dict(start)}.")
    values = {key: float(value) for key, value in start.items()}
    if not all(math.isfinite(value) for value in values.values()):
        raise ValueError(f"start must be finite, got {dict(start)}.")
    return Pose(**values)
