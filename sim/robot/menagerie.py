"""Robots of MuJoCo Menagerie (`--robot menagerie:NAME`), from the package `mujoco-menagerie` of the extra `menagerie`.

The package downloads the files of a robot when they are needed for the first time, or reads a checkout of Menagerie
that the environment variable MENAGERIE_ROOT names. What is not in these files is in a sidecar of ours
(`sidecars/<name>.json`, in the format of `sim.robot.foreign`). Only robots with a differential drive have one. Sources:

| robot | pose of the arms | track and speed |
|---|---|---|
| Stretch 2, 3 | "stow" of Hello Robot's `stretch_body` 0.7.31 | `wheel_separation_m` and largest motion there |
| TIAGo | the keyframe "home" of its model | of its model; the default speed, which is about the actuators' range |
| RBY1-A | hanging, as in its model | of its model, and the actuators' range |
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sim.core.interface import ConfigError

PREFIX = "menagerie:"
SIDECARS = Path(__file__).with_name("sidecars")
ENTRIES: Mapping[str, str] = {
    "hello_robot_stretch": "stretch",
    "hello_robot_stretch_3": "stretch",
    "pal_tiago": "tiago",
    "rainbow_robotics_rby1": "rby1a_1.2",
}
"""Robots with a sidecar, and which of their models it describes."""
_ROLLS_SIDEWAYS = "drives in all directions"
NOT_DIFFERENTIAL: Mapping[str, str] = {
    "google_robot": "has a base without wheels",
    "pal_tiago_dual": f"has four omnidirectional wheels and {_ROLLS_SIDEWAYS}",
    "robot_soccer_kit": f"has three omnidirectional wheels and {_ROLLS_SIDEWAYS}",
    "stanford_tidybot": f"has powered casters and {_ROLLS_SIDEWAYS}",
}
"""Robots with a mobile base but without a differential drive, and the drive that they have."""


def is_menagerie(robot: Path | str) -> bool:
    """Returns whether a robot is named as one of Menagerie."""
    return str(robot).startswith(PREFIX)


def menagerie_files(robot: Path | str) -> tuple[Path, Path]:
    """Returns the MJCF file of `menagerie:NAME` and its sidecar; the model is downloaded if necessary.

    Raises:
        ConfigError: the robot is unknown, it has no differential drive, the package is not installed, or the model
            cannot be downloaded.
    """
    name = str(robot).removeprefix(PREFIX)
    if name not in ENTRIES:
        raise ConfigError(f"--robot {robot}: {_refusal(name)} The robots are: {', '.join(ENTRIES)}.")
    return _model_file(name), SIDECARS / f"{name}.json"


def _refusal(name: str) -> str:
    """Returns a sentence that says why a robot of this name is not available."""
    if name in NOT_DIFFERENTIAL:
        return f"this robot {NOT_DIFFERENTIAL[name]}; the simulator drives robots with a differential drive only."
    try:
        known = _package().names()
    except ConfigError:
        known = []
    if name in known:
        return "this robot has no wheels; the simulator drives robots with a differential drive only."
    return "there is no such robot."


def _model_file(name: str) -> Path:
    """Returns the MJCF file of a robot; raises ConfigError if it is not available."""
    menagerie = _package()
    try:
        file = menagerie.get(name).xml(ENTRIES[name])
    except (menagerie.MenagerieError, OSError) as error:
        reason = " ".join(str(error).split())
        raise ConfigError(
            f"--robot {PREFIX}{name}: the model cannot be downloaded: {reason}. The environment variable "
            "MENAGERIE_ROOT may name a checkout of Menagerie."
        ) from None
    if not file.is_file():
        raise ConfigError(f"--robot {PREFIX}{name}: the file '{file}' does not exist.")
    return file


def _package() -> Any:
    """Returns the package `mujoco_menagerie`; raises ConfigError if it is not installed."""
    try:
        import mujoco_menagerie  # an extra: most runs do without
    except ImportError:
        raise ConfigError(
            f"--robot {PREFIX}NAME needs the extra `menagerie`: pip install 'stubborn-objectnav[menagerie]'."
        ) from None
    return mujoco_menagerie
