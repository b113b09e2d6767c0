"""A differential-drive robot from elsewhere in place of ours: its MJCF file and a small sidecar (`--robot`).

Beside `carrier.xml` lies `carrier.json`:

| key | meaning |
|---|---|
| `wheel_joints` | names of the hinges of the left and the right wheel |
| `wheel_radius_m` | metres |
| `casters` | names of geoms or bodies that only slide on the floor; none if not given |
| `radius_m`, `height_m` | of the upright cylinder that holds the body; measured if not given |
| `camera_height_m`, `camera_forward_m` | where the level camera sits: above the floor, ahead of the axle (0.88, 0) |
| `camera_hfov_deg` | how wide it sees (79) |

Masses, inertias and the shapes that collide are the file's. The file shows it at rest: +x ahead, wheels on the ground.
What this program needs otherwise is put in its place: the base is held upright, a wheel touches as a sphere of its
radius, two motors as strong for its weight as ours turn the wheels, and joints that are no wheels stand still.
"""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.gl import mujoco
from sim.houses.geoms import geom_polytope
from sim.interface import CameraModel, ConfigError
from sim.robot.config import BodyConfig, RobotConfig, RobotFile, WheelConfig

KEYS = ("wheel_joints", "wheel_radius_m", "casters", "radius_m", "height_m")
CAMERA_KEYS = ("camera_height_m", "camera_forward_m", "camera_hfov_deg")
MIN_CLEARANCE_M = 0.005
"""Below the skin of the body, or it would rub on the floor it drives on."""
STRAIGHT = 0.999
"""Cosine of the angle by which a wheel's axle may be off the robot's left."""
LEVEL_M = 0.002
"""How far the two wheels may be off one line across the robot."""


@dataclass(frozen=True)
class Wheel:
    """One wheel as the file has it."""

    joint: str
    centre_m: NDArray[np.float64]  # (3,) in the file's world
    sign: float
    """1 where a positive turn drives ahead, else -1."""


@dataclass(frozen=True)
class Measured:
    """What a robot's file says of it."""

    wheels: tuple[Wheel, Wheel]
    mass_kg: float
    com_height_m: float
    reach_m: float
    """How far the colliding body reaches from the axis in plan."""
    bottom_m: float
    top_m: float

    @property
    def middle_m(self) -> NDArray[np.float64]:
        """(3,) the middle of the axle, in the file's world."""
        return 0.5 * (self.wheels[0].centre_m + self.wheels[1].centre_m)


def load_robot(path: Path) -> tuple[RobotConfig, CameraModel]:
    """The robot in an MJCF file with the sidecar beside it, and its camera.

    Raises:
        ConfigError: a file is missing or breaks a rule of this module; names the file and what is missing.
    """
    path = Path(path).resolve()
    sidecar_file = path.with_suffix(".json")
    for file, what in ((path, "robot"), (sidecar_file, "sidecar of the robot")):
        if not file.is_file():
            raise ConfigError(f"--robot: the {what} '{file}' is not there.")
    try:
        return _configured(path, _read_sidecar(sidecar_file))
    except ConfigError as error:
        raise ConfigError(f"Robot '{path}': {error}") from None


def robot_sha256(path: Path) -> str:
    """Over the robot's file and its sidecar, so that results name what they were made with."""
    return hashlib.sha256(path.read_bytes() + path.with_suffix(".json").read_bytes()).hexdigest()


def foreign_body(file: RobotFile) -> tuple[mujoco.MjSpec, mujoco.MjsBody]:
    """The file's specification, stripped to what stands still but for its wheels; and the body that holds all of it.

    Raises:
        ConfigError: MuJoCo cannot read the file, or the wheels' joints are not in it.
    """
    try:
        spec = mujoco.MjSpec.from_file(str(file.path))
    except (ValueError, OSError) as error:
        raise ConfigError(f"it is no MJCF file that MuJoCo can read: {' '.join(str(error).split())}") from None
    for number, body in enumerate(spec.bodies):
        body.name = body.name or f"body_{number}"  # below, a name is a body
    folder = file.path.parent
    for assets, where in ((spec.meshes, spec.meshdir), (spec.textures, spec.texturedir)):
        for asset in assets:
            if asset.file:
                asset.file = str((folder / where / asset.file).resolve())
    spec.meshdir = spec.texturedir = ""
    groups = (spec.keys, spec.sensors, spec.actuators, spec.equalities, spec.tendons, spec.excludes, spec.pairs)
    for elements in (*groups, spec.cameras, spec.lights):
        for element in list(elements):
            spec.delete(element)
    names = {joint.name: joint.type for joint in spec.joints}
    for name in file.wheel_joints:
        if name not in names:
            hinges = [name for name, kind in names.items() if name and kind == mujoco.mjtJoint.mjJNT_HINGE]
            there = ", ".join(hinges) or "no hinge with a name"
            raise ConfigError(f"it has no joint '{name}', which the sidecar names in wheel_joints. It has: {there}.")
    for joint in list(spec.joints):
        if joint.name not in file.wheel_joints:
            spec.delete(joint)
    roots = {_root_of(spec, spec.joint(name).parent).name for name in file.wheel_joints}
    if len(roots) != 1:
        raise ConfigError(f"its wheels hang on different bodies of the world: {', '.join(sorted(roots))}.")
    spec.option = mujoco.MjSpec().option  # the world's count
    return spec, _root_of(spec, spec.joint(file.wheel_joints[0]).parent)


def parts_of(root: mujoco.MjsBody, file: RobotFile) -> tuple[list[Any], list[Any], list[Any]]:
    """The colliding geoms of a robot: of the wheels, of the casters, and of the hull, which is all else.

    Raises:
        ConfigError: a caster is not in the file, or nothing is left for the hull.
    """
    wheels, casters, hull = [], [], []
    bodies = [root, *root.find_all("body")]
    turning = [body for body in bodies if any(joint.name in file.wheel_joints for joint in body.joints)]
    wheel_bodies = {body.name for top in turning for body in (top, *top.find_all("body"))}
    found = set()
    for body in bodies:
        for geom in body.geoms:
            if geom.name in file.casters or body.name in file.casters:
                found |= {geom.name, body.name}
                casters.append(geom)
            elif geom.contype or geom.conaffinity:
                (wheels if body.name in wheel_bodies else hull).append(geom)
    missing = [name for name in file.casters if name not in found]
    if missing:
        raise ConfigError(f"it has no geom and no body '{missing[0]}', which the sidecar names in casters.")
    if not hull:
        raise ConfigError("nothing of it collides but wheels and casters: its body needs a geom that collides.")
    return wheels, casters, hull


def measure(file: RobotFile, wheel_radius_m: float) -> Measured:
    """Where its wheels are, what it weighs, how much room it takes.

    Raises:
        ConfigError: it does not stand on two wheels beside each other, heading along +x.
    """
    spec, root = foreign_body(file)
    _, _, hull = parts_of(root, file)
    for number, geom in enumerate(hull):
        geom.name = geom.name or f"hull_{number}"
    try:
        model = spec.compile()
    except ValueError as error:
        raise ConfigError(f"it cannot be compiled: {' '.join(str(error).split())}") from None
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    wheels = [_wheel(model, data, name) for name in file.wheel_joints]
    left, right = wheels
    across = left.centre_m - right.centre_m
    if across[1] <= 0.0 or np.hypot(across[0], across[2]) > LEVEL_M:
        raise ConfigError(
            "its wheels must stand beside each other with the first of wheel_joints on the left (+y), but they are at "
            f"{_told(left.centre_m)} and {_told(right.centre_m)} m."
        )
    middle = 0.5 * (left.centre_m + right.centre_m)
    ground_m = float(middle[2]) - wheel_radius_m
    vertices = np.concatenate([geom_polytope(model, data, model.geom(geom.name).id).vertices_m for geom in hull])
    body = model.body(root.name).id
    com_m = float(data.subtree_com[body][2]) - ground_m
    reach_m = float(np.hypot(*(vertices[:, :2] - middle[:2]).T).max())
    bottom_m, top_m = float(vertices[:, 2].min()) - ground_m, float(vertices[:, 2].max()) - ground_m
    return Measured((left, right), float(model.body_subtreemass[body]), com_m, reach_m, bottom_m, top_m)


def _configured(path: Path, sidecar: dict[str, Any]) -> tuple[RobotConfig, CameraModel]:
    joints, casters = sidecar["wheel_joints"], sidecar.get("casters", [])
    radius_m = _positive(sidecar, "wheel_radius_m")
    file = RobotFile(path, (joints[0], joints[1]), tuple(casters))
    measured = measure(file, radius_m)
    body, ours = _body(sidecar, measured), RobotConfig()
    # As strong and as quick for its weight as ours: the same push for each kilogram, the same lag of the motors.
    weight = max(1.0, measured.mass_kg / ours.body.mass_kg)
    inertia = weight * (radius_m / ours.wheels.radius_m) ** 2
    wheels = WheelConfig(
        radius_m=radius_m,
        half_track_m=0.5 * float(measured.wheels[0].centre_m[1] - measured.wheels[1].centre_m[1]),
        mass_kg=0.01 * measured.mass_kg,
        armature_kg_m2=inertia * ours.wheels.armature_kg_m2,
        motor_gain_nm_s=inertia * ours.wheels.motor_gain_nm_s,
        max_torque_nm=weight * radius_m / ours.wheels.radius_m * ours.wheels.max_torque_nm,
        caster_offset_m=0.8 * body.radius_m,
    )
    camera = CameraModel(
        height_m=_positive(sidecar, "camera_height_m", CameraModel().height_m),
        hfov_rad=math.radians(_positive(sidecar, "camera_hfov_deg", math.degrees(CameraModel().hfov_rad))),
    )
    forward_m = sidecar.get("camera_forward_m", 0.0)
    if isinstance(forward_m, bool) or not isinstance(forward_m, int | float):
        raise ConfigError(
            f'"camera_forward_m" in its sidecar must be a number of metres; it is {json.dumps(forward_m)}.'
        )
    return RobotConfig(body=body, wheels=wheels, file=file, camera_forward_m=float(forward_m)), camera


def _body(sidecar: dict[str, Any], measured: Measured) -> BodyConfig:
    """The upright cylinder that holds the body, skin included."""
    skin_m = BodyConfig().skin_m
    if measured.bottom_m - skin_m < MIN_CLEARANCE_M - 1e-6:
        raise ConfigError(
            f"its body reaches down to {measured.bottom_m:.3f} m above the floor, but must leave "
            f"{MIN_CLEARANCE_M + skin_m:.3f} m; name what slides on the floor in casters."
        )
    radius_m = _positive(sidecar, "radius_m", measured.reach_m + skin_m)
    height_m = _positive(sidecar, "height_m", measured.top_m + skin_m)
    for name, given, needed in (("radius_m", radius_m, measured.reach_m), ("height_m", height_m, measured.top_m)):
        if given < needed + skin_m - 1e-6:
            raise ConfigError(
                f"{name} in the sidecar is {given:.3f} m, but what collides reaches {needed:.3f} m and has a skin of "
                f"{skin_m:.3f} m: give at least {needed + skin_m:.3f}."
            )
    clearance_m = min(measured.bottom_m - skin_m, 0.4 * height_m)
    return BodyConfig(
        radius_m=radius_m,
        height_m=height_m,
        clearance_m=clearance_m,
        waist_m=0.5 * (clearance_m + height_m),
        mass_kg=measured.mass_kg,
        com_height_m=measured.com_height_m,
    )


def _wheel(model: mujoco.MjModel, data: mujoco.MjData, name: str) -> Wheel:
    joint = model.joint(name).id
    if model.jnt_type[joint] != mujoco.mjtJoint.mjJNT_HINGE:
        raise ConfigError(f"its joint '{name}' is no hinge, so it turns no wheel.")
    axis = data.xaxis[joint]
    if abs(axis[1]) < STRAIGHT:
        raise ConfigError(
            f"the axle of '{name}' points along {_told(axis)}, but must point left or right (y): the file has to show "
            "the robot with +x ahead."
        )
    return Wheel(name, data.xanchor[joint].copy(), math.copysign(1.0, float(axis[1])))


def _read_sidecar(file: Path) -> dict[str, Any]:
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except (ValueError, OSError) as error:
        raise ConfigError(f"its sidecar '{file.name}' is no JSON: {error}.") from None
    if not isinstance(content, dict):
        raise ConfigError(f"its sidecar '{file.name}' must be one JSON object.")
    unknown = [key for key in content if key not in (*KEYS, *CAMERA_KEYS)]
    if unknown:
        there = ", ".join((*KEYS, *CAMERA_KEYS))
        raise ConfigError(f"its sidecar has '{unknown[0]}', which is no key. There is: {there}.")
    joints, casters = content.get("wheel_joints"), content.get("casters", [])
    if not (isinstance(joints, list) and len(joints) == 2 and _are_names(joints) and joints[0] != joints[1]):
        raise ConfigError('its sidecar needs "wheel_joints": ["<left>", "<right>"], the names of two joints.')
    if not (isinstance(casters, list) and _are_names(casters)):
        raise ConfigError('"casters" in its sidecar must be a list of names.')
    return content


def _are_names(values: list[Any]) -> bool:
    return all(isinstance(value, str) and value for value in values)


def _positive(sidecar: dict[str, Any], key: str, default: float | None = None) -> float:
    value = sidecar.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int | float) or not (math.isfinite(value) and value > 0.0):
        raise ConfigError(f'its sidecar needs "{key}", a number > 0; it has {json.dumps(value)}.')
    return float(value)


def _root_of(spec: mujoco.MjSpec, body: mujoco.MjsBody) -> mujoco.MjsBody:
    """The body below the world that holds a body."""
    while body.parent is not None and body.parent.name != spec.worldbody.name:
        body = body.parent
    return body


def _told(vector: NDArray[np.float64]) -> str:
    return "(" + ", ".join(f"{value:.3f}" for value in vector) + ")"
