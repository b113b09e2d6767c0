"""Reads the parts that the ground depends on from the specification of a house: rooms, doorways, rugs and fixtures."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sim.gl import mujoco
from sim.homes.housegen.structure.openings import HALF_WALL_M

_EPS_M = 1e-3
_FIXTURES = ("shower", "bathtub", "sink")
"""Categories of the fixtures that wet the floor in front of them."""
_BOX, _CYLINDER = mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_CYLINDER


@dataclass(frozen=True)
class RoomFloor:
    """The floor of one room."""

    body: str
    """Name of its body; the body's frame is the world's, `z_m` higher."""
    kind: str
    """Kind of the room, for example `bathroom`."""
    texture: str
    """Name of its texture; "" without one."""
    bounds_m: tuple[float, float, float, float]
    """Smallest x and y, largest x and y between the walls."""
    z_m: float

    def contains(self, x_m: float, y_m: float) -> bool:
        """Returns whether a place in plan lies between the walls of the room."""
        x0, y0, x1, y1 = self.bounds_m
        return x0 <= x_m <= x1 and y0 <= y_m <= y1


@dataclass(frozen=True)
class Doorway:
    """An inner doorway with a frame."""

    x_m: float
    y_m: float
    yaw_rad: float
    """Direction along the wall."""
    width_m: float
    """Between the jambs."""
    material: str
    """Name of the material of the frame."""
    rooms: tuple[RoomFloor, RoomFloor]


@dataclass(frozen=True)
class RugShape:
    """A rug as it is rendered."""

    body: str
    half_m: tuple[float, float]
    """Half its size along x and y of its body; the radius twice for a round one."""
    height_m: float
    is_round: bool


@dataclass(frozen=True)
class Fixture:
    """A fixture of a room with water."""

    x_m: float
    y_m: float
    yaw_rad: float
    """Direction of its front."""
    room: RoomFloor


@dataclass(frozen=True)
class Survey:
    """The parts of a house that its ground depends on, in the order of the file."""

    rooms: tuple[RoomFloor, ...]
    doorways: tuple[Doorway, ...]
    rugs: tuple[RugShape, ...]
    fixtures: tuple[Fixture, ...]


def survey(spec: mujoco.MjSpec) -> Survey:
    """Returns the survey of a house of `sim.homes.housegen.mjcf.builder` while its ground is still level."""
    bodies = list(spec.worldbody.bodies)
    floors = [body for body in bodies if body.name.startswith("floor_")]
    rooms = _rooms(spec, [body for body in floors if _is_room_floor(body)])
    return Survey(
        rooms,
        _doorways(spec, bodies, rooms),
        tuple(rug for body in floors if not _is_room_floor(body) and (rug := _rug(body)) is not None),
        _fixtures(bodies, rooms),
    )


def ground_slabs(spec: mujoco.MjSpec) -> list[mujoco.MjsGeom]:
    """Returns the invisible slabs that carry the robot while the ground is level."""
    return [geom for geom in spec.worldbody.geoms if geom.name.startswith("floor_")]


def _is_room_floor(body: mujoco.MjsBody) -> bool:
    """Returns whether a body is the floor of a room and not a rug: its boxes end at the ground."""
    return all(geom.type == _BOX and abs(geom.pos[2] + geom.size[2]) < _EPS_M for geom in body.geoms)


def _rooms(spec: mujoco.MjSpec, floors: list[mujoco.MjsBody]) -> tuple[RoomFloor, ...]:
    """Returns the floors of all rooms; a floor and the site of its room have the same extent except for the walls."""
    rooms = []
    sites = [site for site in spec.worldbody.sites if site.name.startswith("room_")]
    for body in floors:
        low = np.min([geom.pos[:2] - geom.size[:2] for geom in body.geoms], axis=0) + HALF_WALL_M
        high = np.max([geom.pos[:2] + geom.size[:2] for geom in body.geoms], axis=0) - HALF_WALL_M
        centre = np.array([*(0.5 * (low + high)), body.pos[2]])
        site = min(sites, key=lambda site: float(np.abs(site.pos - [0.0, 0.0, site.size[2]] - centre).sum()))
        kind = site.name.removeprefix("room_").rsplit("_", 1)[0]
        (x0, y0), (x1, y1) = low.tolist(), high.tolist()
        texture = _texture(spec, body.geoms[0].material)
        rooms.append(RoomFloor(body.name, kind, texture, (x0, y0, x1, y1), float(body.pos[2])))
    return tuple(rooms)


def _texture(spec: mujoco.MjSpec, material: str) -> str:
    return spec.material(material).textures[mujoco.mjtTextureRole.mjTEXROLE_RGB]


def _doorways(spec: mujoco.MjSpec, bodies: list[mujoco.MjsBody], rooms: tuple[RoomFloor, ...]) -> tuple[Doorway, ...]:
    """Returns the doorways between two rooms; those where a hazard stands are left out."""
    hazards = [site for site in spec.worldbody.sites if site.name.startswith("hazard_")]
    grounds = []
    for body in bodies:
        jambs = [geom for geom in body.geoms if geom.type == _BOX and geom.contype]
        if not body.name.startswith("door_") or len(jambs) != 2:
            continue
        x, y, z = body.pos.tolist()
        yaw = _yaw(body)
        dx, dy = -2.0 * HALF_WALL_M * math.sin(yaw), 2.0 * HALF_WALL_M * math.cos(yaw)
        storey = [room for room in rooms if abs(room.z_m - z) < _EPS_M]
        sides = [next((room for room in storey if room.contains(x + s * dx, y + s * dy)), None) for s in (1, -1)]
        near = (abs(site.pos[:2] - [x, y]) < site.size[:2] + 0.15 for site in hazards)
        if sides[0] is None or sides[1] is None or any(inside.all() for inside in near):
            continue
        inner = [abs(geom.pos[0]) - geom.size[0] for geom in jambs]
        grounds.append(Doorway(x, y, yaw, float(sum(inner)), jambs[0].material, (sides[0], sides[1])))
    return tuple(grounds)


def _rug(body: mujoco.MjsBody) -> RugShape | None:
    """Returns the outline and the height of a rug; None for one of meshes only, which stays a picture."""
    half, height, is_round = np.zeros(2), 0.0, False
    for geom in body.geoms:
        if geom.type == _CYLINDER:
            is_round, reach, top = True, np.full(2, geom.size[0]), geom.pos[2] + geom.size[1]
        elif geom.type == _BOX:
            size = axis_sizes(geom)
            reach, top = np.abs(geom.pos[:2]) + size[:2], geom.pos[2] + size[2]
        else:  # bands and fringes: parts of a rug that has a box or a cylinder too
            continue
        half, height = np.maximum(half, reach), max(height, float(top))
    return RugShape(body.name, (float(half[0]), float(half[1])), height, is_round) if height > 0.0 else None


def _fixtures(bodies: list[mujoco.MjsBody], rooms: tuple[RoomFloor, ...]) -> tuple[Fixture, ...]:
    grounds = []
    for body in bodies:
        if body.name.rsplit("_", 1)[0] not in _FIXTURES:
            continue
        x, y, z = body.pos.tolist()
        room = next((r for r in rooms if r.contains(x, y) and -_EPS_M < z - r.z_m < 1.5), None)
        if room is not None:
            grounds.append(Fixture(x, y, _yaw(body), room))
    return tuple(grounds)


def axis_sizes(geom: mujoco.MjsGeom) -> np.ndarray:
    """Returns half the size (3,) along the axes of the body of a box that is turned by quarter turns."""
    rotation = np.zeros(9)
    quat = np.asarray(geom.quat, np.float64)
    mujoco.mju_quat2Mat(rotation, quat / np.linalg.norm(quat))
    return np.abs(rotation.reshape(3, 3)) @ geom.size


def _yaw(body: mujoco.MjsBody) -> float:
    w, _, _, z = body.quat.tolist()
    return round(2.0 * math.atan2(z, w), 3)
