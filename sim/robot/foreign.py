"""Loads a third-party differential-drive robot from an MJCF file and its sidecar (`--robot`).

Next to `carrier.xml` there is a sidecar `carrier.json`; those of Menagerie's robots ship (`sim.robot.menagerie`):

| key | meaning |
|---|---|
| `wheel_joints` | names of the hinges of the left and the right wheel; of four or more: the left ones, then the right |
| `wheel_radius_m` | metres |
| `track_m` | distance between the middles of the tyres; default: that of the wheels' joints |
| `casters` | names of geoms or bodies that only slide on the floor; default: none |
| `joints` | names of other joints and their positions, rad or m, in which they are fixed; default: 0 |
| `heading_deg` | direction that is ahead in the file, counter-clockwise from +x; default: 0 |
| `radius_m`, `height_m` | size of the upright cylinder around the body; default: measured. A robot without collision
geoms needs both: the cylinder is then its body |
| `camera_height_m`, `camera_forward_m` | position of the level camera above the floor and ahead of the axle (0.88, 0) |
| `camera_hfov_deg` | horizontal field of view of the camera (79) |
| `cameras` | further cameras by name, each with fields of `sim.renderer.mounted.CameraConfig`; default: none |
| `speed_m_s`, `acceleration_m_s2` | largest speed and acceleration of a forward (0.5, 1) |

A geom without a name is called `<body>.<number>`, with its number in the body, from 0.

The file shows the robot at rest: +x ahead (or `heading_deg`), wheels on the ground. Masses, inertias and collision
shapes are those of the file. The rest is replaced: the base is held upright, each wheel collides as a sphere of its
radius, and all other joints are fixed. Two motors drive the wheels, with the force of the default robot or, for a
heavier robot, with the same force per kilogram.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypedDict, TypeGuard, cast

from sim.core.interface import CLIMB_M, CameraModel, ConfigError
from sim.core.reading import read_bytes, read_json, sha256_of
from sim.houses.references import files_of
from sim.robot.config import BodyConfig, DriveConfig, RobotConfig, RobotFile, WheelConfig
from sim.robot.measurement import CYLINDER_SKIN_M, RobotMeasurements, measure
from sim.robot.menagerie import is_menagerie, menagerie_files

KEYS = (
    "wheel_joints", "wheel_radius_m", "track_m", "casters", "joints", "heading_deg", "radius_m", "height_m",
    "speed_m_s", "acceleration_m_s2",
)  # fmt: skip
CAMERA_KEYS = ("camera_height_m", "camera_forward_m", "camera_hfov_deg", "cameras")
LARGEST_M = 1000.0
"""Largest number of a sidecar, also of degrees."""
SKIN_M = CYLINDER_SKIN_M
"""`BodyConfig.skin_m` of third-party bodies, which may have shapes of any kind."""
MAX_WHEELS = 12
MIN_CLEARANCE_M = 0.005
"""Least distance between the body's skin and the floor, so that the body does not rub on the floor."""
WHEEL_MASS_SHARE = 0.01
"""Share of the robot's mass that is declared for each wheel; the simulated masses are those of the file."""
CLIMBED_SHARE = 0.18
"""Height that a wheel climbs from rest with friction 0.7, relative to its radius."""
CASTER_OFFSET_SHARE = 0.8
"""Declared distance of the casters from the centre, relative to the body's radius."""


def load_robot(robot: Path | str, *, root: Path | None = None) -> tuple[RobotConfig, CameraModel]:
    """Returns the robot of an MJCF file with its sidecar, or of `menagerie:NAME`, and its camera.

    Args:
        robot: the file, or the name.
        root: another folder whose files the robot may use, such as `../meshes` (`--root`).

    Raises:
        ConfigError: a file is missing or breaks a rule of this module, or Menagerie has no such robot; the message
            names the file and the rule.
    """
    path, sidecar_file = _files_of(robot)
    for file, what in ((path, "robot"), (sidecar_file, "sidecar of the robot")):
        if not file.is_file():
            raise ConfigError(f"--robot: the {what} '{file}' does not exist.")
    try:
        sidecar = _read_sidecar(sidecar_file)
        return _robot_config(path, sidecar, root), _camera(sidecar)
    except ConfigError as error:
        raise ConfigError(f"Robot '{path}': {error}") from None


def robot_cameras(robot: Path | str) -> dict[str, Any]:
    """Returns the further cameras that a robot's sidecar declares: fields by the name of the camera.

    Raises:
        ConfigError: the sidecar breaks a rule of this module.
    """
    path, sidecar_file = _files_of(robot)
    cameras = cast(dict[str, Any], _read_sidecar(sidecar_file).get("cameras", {}))
    if not (isinstance(cameras, dict) and all(isinstance(fields, dict) for fields in cameras.values())):
        raise ConfigError(f"Robot '{path}': \"cameras\" in its sidecar must be an object of cameras by name.")
    return cameras


def robot_sha256(robot: Path | str, *, root: Path | None = None) -> str:
    """Returns the checksum of a robot's file, its sidecar and the files that it uses; it identifies it in results."""
    path, sidecar = _files_of(robot)
    digest = hashlib.sha256(read_bytes(path, what="--robot: the robot"))
    digest.update(read_bytes(sidecar, what="--robot: the sidecar of the robot"))
    for file in files_of(path, root):  # a robot in a single file keeps its checksum
        digest.update(bytes.fromhex(sha256_of(file, what="--robot: a file of the robot")))
    return digest.hexdigest()


def absolute_robot(robot: Path | str) -> str:
    """Returns the name or path of a robot that stays valid if the current folder changes."""
    return str(robot if is_menagerie(robot) else Path(robot).absolute())


def _files_of(robot: Path | str) -> tuple[Path, Path]:
    """Returns the MJCF file of a robot and its sidecar."""
    if is_menagerie(robot):
        return menagerie_files(robot)
    path = Path(robot).resolve()
    return path, path.parent / f"{path.stem}.json"


class _Sidecar(TypedDict, total=False):
    """The content of a sidecar; `KEYS` and `CAMERA_KEYS` explain it."""

    wheel_joints: list[str]
    casters: list[str]
    joints: dict[str, float]


def _robot_config(path: Path, sidecar: _Sidecar, root: Path | None) -> RobotConfig:
    joints, casters = sidecar.get("wheel_joints", []), sidecar.get("casters", [])
    wheel_radius_m = _positive(sidecar, "wheel_radius_m")
    file = RobotFile(
        path,
        tuple(joints),
        tuple(casters),
        heading_rad=math.radians(_number(sidecar, "heading_deg", "degrees")),
        track_m=_positive(sidecar, "track_m") if "track_m" in sidecar else None,
        pose=tuple(sorted((name, float(position)) for name, position in sidecar.get("joints", {}).items())),
        cylinder_m=_cylinder_m(sidecar),
        root=root,
    )
    measured = measure(file, wheel_radius_m)
    body = _body(sidecar, measured)
    wheels = _wheels(measured, wheel_radius_m, body)
    return RobotConfig(
        base="planar",
        climb_m=_climb_m(body, wheels),
        body=body,
        wheels=wheels,
        drive=_drive(sidecar),
        file=file,
        camera_forward_m=_number(sidecar, "camera_forward_m", "metres"),
    )


def _cylinder_m(sidecar: Mapping[str, object]) -> tuple[float, float] | None:
    """Returns radius and height of the cylinder, if the sidecar has both."""
    if not {"radius_m", "height_m"} <= sidecar.keys():
        return None
    return _positive(sidecar, "radius_m"), _positive(sidecar, "height_m")


def _wheels(measured: RobotMeasurements, radius_m: float, body: BodyConfig) -> WheelConfig:
    """Returns wheels with motors of the default lag and at least the default force, in proportion to the weight."""
    default = RobotConfig()
    weight = max(1.0, measured.mass_kg / default.body.mass_kg)
    inertia = weight * (radius_m / default.wheels.radius_m) ** 2
    return WheelConfig(
        radius_m=radius_m,
        half_track_m=0.5 * float(measured.wheels[0].centre_m[1] - measured.wheels[1].centre_m[1]),
        mass_kg=WHEEL_MASS_SHARE * measured.mass_kg,
        armature_kg_m2=inertia * default.wheels.armature_kg_m2,
        motor_gain_nm_s=inertia * default.wheels.motor_gain_nm_s,
        max_torque_nm=weight * radius_m / default.wheels.radius_m * default.wheels.max_torque_nm,
        caster_offset_m=CASTER_OFFSET_SHARE * body.radius_m,
    )


def _body(sidecar: Mapping[str, object], measured: RobotMeasurements) -> BodyConfig:
    """Returns the upright cylinder around the body and its skin."""
    if measured.bottom_m - SKIN_M < MIN_CLEARANCE_M - 1e-6:
        raise ConfigError(
            f"its body reaches down to {measured.bottom_m:.3f} m above the floor with '{measured.lowest}', but must "
            f"stay at least {MIN_CLEARANCE_M + SKIN_M:.3f} m above it; name sliding parts in casters."
        )
    radius_m = _positive(sidecar, "radius_m", measured.reach_m + SKIN_M)
    height_m = _positive(sidecar, "height_m", measured.top_m + SKIN_M)
    for name, declared, needed in (("radius_m", radius_m, measured.reach_m), ("height_m", height_m, measured.top_m)):
        if declared < needed + SKIN_M - 1e-6:
            raise ConfigError(
                f"{name} in the sidecar is {declared:.3f} m, but the collision geoms reach {needed:.3f} m and have a "
                f"skin of {SKIN_M:.3f} m: give at least {needed + SKIN_M:.3f}."
            )
    clearance_m = min(measured.bottom_m - SKIN_M, 0.4 * height_m)
    return BodyConfig(
        radius_m=radius_m,
        height_m=height_m,
        clearance_m=clearance_m,
        waist_m=0.5 * (clearance_m + height_m),
        skin_m=SKIN_M,
        mass_kg=measured.mass_kg,
        com_height_m=measured.com_height_m,
    )


def _drive(sidecar: Mapping[str, object]) -> DriveConfig:
    """Returns the controller, with the limits of the robot's base."""
    default = DriveConfig()
    return replace(
        default,
        speed_m_s=_positive(sidecar, "speed_m_s", default.speed_m_s),
        acceleration_m_s2=_positive(sidecar, "acceleration_m_s2", default.acceleration_m_s2),
    )


def _climb_m(body: BodyConfig, wheels: WheelConfig) -> float:
    """Returns the height of the highest edge that the robot climbs, at most that of the default robot."""
    return min(CLIMB_M, CLIMBED_SHARE * wheels.radius_m, body.clearance_m)


def _camera(sidecar: Mapping[str, object]) -> CameraModel:
    return CameraModel(
        height_m=_positive(sidecar, "camera_height_m", CameraModel().height_m),
        hfov_rad=math.radians(_positive(sidecar, "camera_hfov_deg", math.degrees(CameraModel().hfov_rad))),
    )


def _number(sidecar: Mapping[str, object], key: str, unit: str) -> float:
    """Returns a number that may be negative; 0 when it is not given."""
    value = sidecar.get(key, 0.0)
    if not _is_number(value):
        raise ConfigError(f'"{key}" in its sidecar must be a number of {unit}; it is {json.dumps(value)}.')
    return float(value)


def _read_sidecar(file: Path) -> _Sidecar:
    try:
        content = read_json(file, dict[str, object], what="its sidecar")
    except ConfigError as error:
        raise ConfigError(f"{error} It must be one JSON object.") from None
    unknown = [key for key in content if key not in (*KEYS, *CAMERA_KEYS)]
    if unknown:
        keys = ", ".join((*KEYS, *CAMERA_KEYS))
        raise ConfigError(f"its sidecar has the unknown key '{unknown[0]}'. The keys are: {keys}.")
    joints, casters = content.get("wheel_joints"), content.get("casters", [])
    if not (
        isinstance(joints, list)
        and len(joints) % 2 == 0
        and 2 <= len(joints) <= MAX_WHEELS
        and _are_names(joints)
        and len(set(joints)) == len(joints)
    ):
        raise ConfigError(
            'its sidecar needs "wheel_joints": ["<left>", "<right>"], the names of two joints, or of '
            f"as many left ones and then right ones, at most {MAX_WHEELS}."
        )
    if not (isinstance(casters, list) and _are_names(casters)):
        raise ConfigError('"casters" in its sidecar must be a list of names.')
    pose = content.get("joints", {})
    if not (isinstance(pose, dict) and all(_is_number(position) for position in pose.values())):
        raise ConfigError('"joints" in its sidecar must be an object with a position, rad or m, for each joint.')
    if moved := [name for name in joints if name in pose]:
        raise ConfigError(f"\"joints\" in its sidecar must not name the wheel joint '{moved[0]}'.")
    return cast(_Sidecar, content)


def _is_number(value: object) -> TypeGuard[float]:
    return not isinstance(value, bool) and isinstance(value, int | float) and abs(value) <= LARGEST_M


def _are_names(values: Sequence[object]) -> bool:
    return all(isinstance(value, str) and value for value in values)


def _positive(sidecar: Mapping[str, object], key: str, default: float | None = None) -> float:
    value = sidecar.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value <= LARGEST_M:
        raise ConfigError(
            f'its sidecar needs "{key}", a number > 0; it has {json.dumps(value)}. At most {LARGEST_M:g} is allowed.'
        )
    return float(value)
