"""Reads the body of a third-party robot from its MJCF file and measures it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.core.interface import ConfigError
from sim.gl import mujoco
from sim.houses.attachments import use_absolute_paths
from sim.houses.geoms import geom_polytope
from sim.houses.mjcf import read_spec, require_sizes
from sim.robot.config import RobotFile
from sim.robot.posing import pose_joints

MIN_AXLE_COSINE = 0.999
"""Smallest cosine of the angle between a wheel's axle and the robot's y axis."""
RADIUS_TOLERANCE = 0.25
"""Largest difference of a wheel's declared radius from that of its geoms, as a share of the latter."""
CYLINDER_SKIN_M = 0.005
"""The cylinder of a robot without collision geoms is smaller by this, the skin of third-party bodies."""
CYLINDER_CLEARANCE_SHARE = 0.3
"""Height of the lower side of that cylinder above the floor, relative to the radius of the wheels."""
LEVEL_M = 0.002
"""Largest offset of the two wheels from each other along x and z."""


@dataclass(frozen=True)
class Wheel:
    """One wheel in the pose of the file."""

    joint: str
    centre_m: NDArray[np.float64]  # (3,) of its tyre, in the world of the file, turned so that the robot faces +x
    sign: float
    """1 when a positive joint velocity drives ahead, else -1."""
    offset_m: float = 0.0
    """Distance of the tyre's middle from the joint's anchor along the joint's axis."""


@dataclass(frozen=True)
class RobotMeasurements:
    """Measurements of a robot in the pose of its file; heights are above the floor below its wheels."""

    wheels: tuple[Wheel, Wheel]
    """Left and right; of several wheels a side, their middle."""
    sides: tuple[tuple[Wheel, ...], tuple[Wheel, ...]]
    """All wheels, left and right."""
    mass_kg: float
    com_height_m: float
    reach_m: float
    """Largest distance in plan of the hull from the middle of the axle."""
    bottom_m: float
    """Lowest point of the hull."""
    lowest: str
    """Name of the geom with this point."""
    top_m: float
    """Highest point of the hull."""

    @property
    def middle_m(self) -> NDArray[np.float64]:
        """The middle (3,) of the axle in the world of the file, turned so that the robot faces +x."""
        return 0.5 * (self.wheels[0].centre_m + self.wheels[1].centre_m)


@dataclass(frozen=True)
class CollisionGeoms:
    """The collision geoms of a robot by their role (elements of an `MjSpec`)."""

    wheels: tuple[Any, ...]
    casters: tuple[Any, ...]
    hull: tuple[Any, ...]
    """All others."""


def read_body(file: RobotFile) -> tuple[mujoco.MjSpec, mujoco.MjsBody]:
    """Returns the file's specification without joints other than the wheels', and the top body of the robot.

    Bodies without a name are named `body_<number>` and geoms without one `<body>.<number>`, with their number in the
    body.

    Raises:
        ConfigError: MuJoCo cannot read the file, it does not have the wheel joints, or a joint cannot be posed.
    """
    spec = read_spec(file.path, root=file.root, error=ConfigError)
    for number, body in enumerate(spec.bodies):
        body.name = body.name or f"body_{number}"  # the code below identifies bodies by name
        for index, geom in enumerate(body.geoms):
            geom.name = geom.name or f"{body.name}.{index}"
    use_absolute_paths(spec, file.path.parent)
    _delete_unused_elements(spec)
    _require_wheel_joints(spec, file)
    pose_joints(spec, file.pose)
    _delete_other_joints(spec, file)
    roots = {_root_of(spec, spec.joint(name).parent).name for name in file.wheel_joints}
    if len(roots) != 1:
        raise ConfigError(f"its wheels belong to different bodies of the world: {', '.join(sorted(roots))}.")
    spec.option = mujoco.MjSpec().option  # those of the world are used
    spec.compiler.fusestatic = False  # its top body has no joint now and would be fused with the world
    root = _root_of(spec, spec.joint(file.wheel_joints[0]).parent)
    return spec, root


def collision_geoms(root: mujoco.MjsBody, file: RobotFile) -> CollisionGeoms:
    """Returns the collision geoms below the top body of a robot.

    Raises:
        ConfigError: a caster is not in the file, or no geom is left for the hull and there is no cylinder.
    """
    wheels, casters, hull = [], [], []
    bodies = [root, *root.find_all("body")]
    turning = [body for body in bodies if any(joint.name in file.wheel_joints for joint in body.joints)]
    wheel_bodies = {body.name for top in turning for body in (top, *top.find_all("body"))}
    names = set()
    for body in bodies:
        for geom in body.geoms:
            if geom.name in file.casters or body.name in file.casters:
                names |= {geom.name, body.name}
                casters.append(geom)
            elif geom.contype or geom.conaffinity:
                (wheels if body.name in wheel_bodies else hull).append(geom)
    missing = [name for name in file.casters if name not in names]
    if missing:
        raise ConfigError(f"it has no geom and no body '{missing[0]}', which the sidecar names in casters.")
    if not hull and file.cylinder_m is None:
        raise ConfigError(
            "it has no collision geom other than wheels and casters: its body needs one, or radius_m and height_m in "
            "the sidecar, the size of a cylinder that is its body."
        )
    return CollisionGeoms(tuple(wheels), tuple(casters), tuple(hull))


def measure(file: RobotFile, wheel_radius_m: float) -> RobotMeasurements:
    """Returns the measurements of a robot.

    Raises:
        ConfigError: its two wheels are not next to each other, or it does not face +x.
    """
    spec, root = read_body(file)
    hull = collision_geoms(root, file).hull
    try:
        model = spec.compile()
    except ValueError as error:
        raise ConfigError(f"it cannot be compiled: {' '.join(str(error).split())}") from None
    require_sizes(model, error=ConfigError)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    turn = turn_to_x(file)
    on_left, on_right = (tuple(_wheel(model, data, name, turn) for name in side) for side in file.sides)
    sides = on_left, on_right
    for wheel in (*sides[0], *sides[1]):
        _require_radius(model, data, wheel, turn, wheel_radius_m)
    left, right = _wheels(file, sides)
    middle = 0.5 * (left.centre_m + right.centre_m)
    ground_m = float(middle[2]) - wheel_radius_m
    body = model.body(root.name).id
    com_height_m = float(data.subtree_com[body][2]) - ground_m
    if not hull and file.cylinder_m is not None:
        reach_m, top_m = (size_m - CYLINDER_SKIN_M for size_m in file.cylinder_m)
        bottom_m = min(CYLINDER_CLEARANCE_SHARE * wheel_radius_m, 0.4 * top_m)
        return RobotMeasurements(
            (left, right), sides, float(model.body_subtreemass[body]), com_height_m, reach_m, bottom_m, "", top_m
        )
    parts = [geom_polytope(model, data, model.geom(geom.name).id).vertices_m @ turn.T for geom in hull]
    vertices = np.concatenate(parts)
    return RobotMeasurements(
        wheels=(left, right),
        sides=sides,
        mass_kg=float(model.body_subtreemass[body]),
        com_height_m=com_height_m,
        reach_m=float(np.hypot(*(vertices[:, :2] - middle[:2]).T).max()),
        bottom_m=float(vertices[:, 2].min()) - ground_m,
        lowest=hull[int(np.argmin([part[:, 2].min() for part in parts]))].name,
        top_m=float(vertices[:, 2].max()) - ground_m,
    )


def turn_to_x(file: RobotFile) -> NDArray[np.float64]:
    """Returns the rotation (3, 3) about z that turns the robot of a file to +x."""
    cos, sin = math.cos(file.heading_rad), math.sin(file.heading_rad)
    return np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])


def _delete_unused_elements(spec: mujoco.MjSpec) -> None:
    """Deletes all elements other than bodies, joints, geoms and assets."""
    groups = (spec.keys, spec.sensors, spec.actuators, spec.equalities, spec.tendons, spec.excludes, spec.pairs)
    for elements in (*groups, spec.cameras, spec.lights):
        for element in list(elements):
            spec.delete(element)


def _require_wheel_joints(spec: mujoco.MjSpec, file: RobotFile) -> None:
    """Raises ConfigError if a wheel's joint does not exist."""
    types = {joint.name: joint.type for joint in spec.joints}
    for name in file.wheel_joints:
        if name not in types:
            hinges = [name for name, kind in types.items() if name and kind == mujoco.mjtJoint.mjJNT_HINGE]
            raise ConfigError(
                f"it has no joint '{name}', which the sidecar names in wheel_joints. The hinges are: "
                f"{', '.join(hinges) or 'none that has a name'}."
            )


def _delete_other_joints(spec: mujoco.MjSpec, file: RobotFile) -> None:
    """Deletes all joints other than those of the wheels."""
    for joint in list(spec.joints):
        if joint.name not in file.wheel_joints:
            spec.delete(joint)


def _wheels(file: RobotFile, sides: tuple[tuple[Wheel, ...], ...]) -> tuple[Wheel, Wheel]:
    """Returns the left and the right wheel, or the middles of the wheels of each side."""
    left, right = (
        side[0] if len(side) == 1 else Wheel("", np.mean([wheel.centre_m for wheel in side], axis=0), 1.0)
        for side in sides
    )
    across = left.centre_m - right.centre_m
    if across[1] <= 0.0 or np.hypot(across[0], across[2]) > LEVEL_M:
        raise ConfigError(
            "its wheels must be next to each other with the first of wheel_joints on the left (+y), but they are at "
            f"{_format(left.centre_m)} and {_format(right.centre_m)} m{_turned(file)}."
            + (" Of several wheels a side, wheel_joints names the left ones first." if file.skids else "")
        )
    if file.track_m is None:
        return left, right
    out_m = 0.5 * (file.track_m - float(across[1]))
    return _shifted(left, out_m), _shifted(right, -out_m)


def _shifted(wheel: Wheel, left_m: float) -> Wheel:
    """Returns a wheel with its tyre farther to the left."""
    return replace(wheel, centre_m=wheel.centre_m + np.array([0.0, left_m, 0.0]), offset_m=wheel.sign * left_m)


def _wheel(model: mujoco.MjModel, data: mujoco.MjData, name: str, turn: NDArray[np.float64]) -> Wheel:
    joint = model.joint(name).id
    if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_SLIDE:
        raise ConfigError(
            f"its wheel joint '{name}' is a slide, and wheels turn on hinges. A base that slides along x and y without "
            "wheels is not driven here; name the hinges of its wheels, if it has some."
        )
    if model.jnt_type[joint] != mujoco.mjtJoint.mjJNT_HINGE:
        raise ConfigError(f"its wheel joint '{name}' is not a hinge.")
    axis = turn @ data.xaxis[joint]
    if abs(axis[1]) < MIN_AXLE_COSINE:
        raise ConfigError(
            f"the axle of '{name}' points along {_format(axis)}, but must point left or right (y): the file has to "
            "show the robot with +x ahead, or heading_deg in the sidecar has to give its direction."
        )
    return Wheel(name, turn @ data.xanchor[joint], math.copysign(1.0, float(axis[1])))


def _require_radius(
    model: mujoco.MjModel, data: mujoco.MjData, wheel: Wheel, turn: NDArray[np.float64], declared_m: float
) -> None:
    """Raises ConfigError if a wheel's geoms reach much farther, or less far, from the axle than its declared radius."""
    top = int(model.joint(wheel.joint).bodyid[0])
    bodies = [body for body in range(model.nbody) if _is_below(model, body, top)]
    geoms = np.flatnonzero(np.isin(model.geom_bodyid, bodies))
    solid = geoms[(model.geom_contype[geoms] != 0) | (model.geom_conaffinity[geoms] != 0)]
    geoms = solid if solid.size else geoms
    if not geoms.size:
        return
    vertices = np.concatenate([geom_polytope(model, data, int(geom)).vertices_m for geom in geoms]) @ turn.T
    radius_m = float(np.hypot(*(vertices - wheel.centre_m)[:, [0, 2]].T).max())
    if not (1.0 - RADIUS_TOLERANCE) * radius_m <= declared_m <= (1.0 + RADIUS_TOLERANCE) * radius_m:
        raise ConfigError(
            f"wheel_radius_m in the sidecar is {declared_m:g} m, but the wheel of '{wheel.joint}' has a radius of "
            f"about {radius_m:.2g} m in the file."
        )


def _is_below(model: mujoco.MjModel, body: int, top: int) -> bool:
    while body not in (0, top):
        body = int(model.body_parentid[body])
    return body == top


def _root_of(spec: mujoco.MjSpec, body: mujoco.MjsBody) -> mujoco.MjsBody:
    """Returns the child of the world body that contains a body."""
    while body.parent is not None and body.parent.name != spec.worldbody.name:
        body = body.parent
    return body


def _turned(file: RobotFile) -> str:
    return f" when heading_deg = {math.degrees(file.heading_rad):g} is turned to +x" if file.heading_rad else ""


def _format(vector: NDArray[np.float64]) -> str:
    return "(" + ", ".join(f"{value:.3f}" for value in vector) + ")"
