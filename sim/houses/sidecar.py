"""What a scene fixes about itself in `<name>.json` beside `<name>.xml`: start, goal, sensor noise, why it is there."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sim.errors import HouseError
from sim.geometry.pose import Pose
from sim.interface import GOAL_CATEGORIES


@dataclass(frozen=True, kw_only=True)
class Sidecar:
    """A scene's own start, goal and noise; None or empty: not fixed."""

    start: Pose | None = None
    goal: str | None = None
    noise: Mapping[str, Any] = field(default_factory=dict)
    """Sensor noise of every episode in this scene, as `sim.sensors.noise` reads it."""
    reason: str = ""
    """What the scene is for, in one line."""
    zone_m: tuple[float, float, float, float] | None = None
    """x0, y0, x1, y1 of the trap itself: steps inside it are steps in the trap."""


NOTHING_FIXED = Sidecar()


def sidecar_path(house_file: Path) -> Path:
    """Where the sidecar of a house file lies, if there is one."""
    return house_file.with_suffix(".json")


def read_sidecar(house_file: Path) -> Sidecar:
    """The sidecar beside a house file; `NOTHING_FIXED` when there is none.

    Raises:
        HouseError: it is no JSON object, has an unknown key, or a value that cannot be.
    """
    file = sidecar_path(house_file)
    if not file.is_file():
        return NOTHING_FIXED
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
        return _parse(content)
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise HouseError(f"Sidecar '{file}': {error}") from None


def write_sidecar(house_file: Path, sidecar: Sidecar) -> None:
    """Write the sidecar of a house file; the same content gives the same bytes."""
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
    sidecar_path(house_file).write_text(text + "\n", encoding="utf-8")


def _parse(content: Mapping[str, Any]) -> Sidecar:
    known = ("reason", "goal", "start", "zone_m", "noise")
    for key in content:
        if key not in known:
            raise ValueError(f"unknown key '{key}'. It may have: {', '.join(known)}.")
    goal, zone = content.get("goal"), content.get("zone_m")
    if goal is not None and goal not in GOAL_CATEGORIES:
        raise ValueError(f"goal '{goal}' is no goal category. There is: {', '.join(GOAL_CATEGORIES)}.")
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
