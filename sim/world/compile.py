"""Compiles a house and a robot into one MuJoCo model and keeps the house's labels.

The house is first compiled alone to read its labels. Then the collision masks of `sim.robot.body` are set, static
bodies are fused (a geom of the world body costs half of a geom in its own body), the robot is attached, and the result
is compiled again. Geoms keep their names; an unnamed geom is named after its instance.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sim.core.errors import HouseError
from sim.core.interface import MPCAT40_ID
from sim.core.reading import read_bytes
from sim.core.store import kept, key_of
from sim.gl import mujoco
from sim.houses.house import House, Room, read_rooms
from sim.houses.labels import COVER_MASK, Instance, Labels, read_labels
from sim.houses.references import add_files
from sim.robot.body import FLOOR_MASK, MOVABLE_MASK, PREFIX, STATIC_MASK
from sim.robot.config import RobotConfig
from sim.robot.mounting import robot_spec

_FLOOR = MPCAT40_ID["floor"]


_MODEL_FILE = "world.mjb"


@dataclass(frozen=True)
class _Compiled:
    """The compiled model of a house with a robot in MuJoCo's binary form, its labels and its rooms."""

    model: NDArray[np.uint8]  # (bytes,)
    labels: Labels
    rooms: tuple[Room, ...]


def world_key(house: House, config: RobotConfig) -> str | None:
    """Returns the key under which all that depends on a house with a robot alone is kept; None: it is not kept."""
    if house.checksum is None:
        return None
    digest = hashlib.sha256()
    if config.file is not None:
        try:
            digest.update(read_bytes(config.file.path, what="Robot", error=HouseError))
            add_files(digest, config.file.path, config.file.root)
        except HouseError:
            return None  # the reader of the robot says what is wrong
    return key_of("world", house.checksum, config, digest.hexdigest())


def compile_world(
    house: House, config: RobotConfig, *, key: str | None = None
) -> tuple[mujoco.MjModel, Labels, tuple[Room, ...]]:
    """Returns the compiled model of a house with a robot, its labels and its rooms. `house.spec` is not changed.

    Args:
        house: the house.
        config: the robot.
        key: `world_key` of both; the result is then kept in the user's cache (`sim.core.store`).

    Raises:
        HouseError: a visible geom has no label, or the house cannot be compiled, alone or with a robot.
    """
    made: list[mujoco.MjModel] = []

    def make() -> _Compiled:
        model, labels, rooms = _compiled_world(house, config)
        made.append(model)
        content = np.empty(mujoco.mj_sizeModel(model), np.uint8)
        mujoco.mj_saveModel(model, None, content)
        return _Compiled(content, labels, rooms)

    world = kept(key, _Compiled, make)
    model = made[0] if made else mujoco.MjModel.from_binary_path(_MODEL_FILE, {_MODEL_FILE: world.model.tobytes()})
    return model, world.labels, world.rooms


def _compiled_world(house: House, config: RobotConfig) -> tuple[mujoco.MjModel, Labels, tuple[Room, ...]]:
    spec = house.spec.copy()
    spec.compiler.discardvisual = False  # visual geoms belong to the house
    spec.compiler.settotalmass = -1.0  # would scale the robot as well
    spec.memory = -1  # as much as the world needs
    alone = _compile(spec, f"House '{house.name}'")
    labels = read_labels(alone, rules=house.rules, ignore_prefix="")
    rooms = read_rooms(alone)
    names = _name_geoms(spec, labels)
    _set_collision_masks(spec, alone, labels)
    _set_options(spec, config)
    spec.attach(robot_spec(config), prefix=PREFIX, frame=spec.worldbody.add_frame())
    spec.compiler.fusestatic = True
    model = _compile(spec, f"House '{house.name}' with a robot")
    return model, _renumber(labels, names, model), rooms


def _compile(spec: mujoco.MjSpec, description: str) -> mujoco.MjModel:
    """Compiles a specification; MuJoCo's error becomes a HouseError of one line."""
    try:
        return spec.compile()
    except ValueError as error:
        raise HouseError(f"{description}: {' '.join(str(error).split())}") from None


def _name_geoms(spec: mujoco.MjSpec, labels: Labels) -> list[str]:
    """Gives each unnamed geom a unique name; returns all names in the order of geom ids of the house alone."""
    geoms = spec.geoms
    taken = {geom.name for geom in geoms}
    for geom in geoms:
        if geom.name:
            continue
        instance = int(labels.geom_instance[geom.id])
        stem = labels.instances[instance].name if instance >= 0 else "geom"
        number = geom.id
        while f"{stem}:{number}" in taken:
            number += len(geoms)
        geom.name = f"{stem}:{number}"
        taken.add(geom.name)
    return [geom.name for geom in sorted(geoms, key=lambda geom: geom.id)]


def _set_collision_masks(spec: mujoco.MjSpec, alone: mujoco.MjModel, labels: Labels) -> None:
    """Sets the collision masks (see `sim.robot.body`) and margins of the house; visual geoms stay visual."""
    movable = alone.body_weldid[alone.geom_bodyid] != 0
    for geom in spec.geoms:
        if geom.contype == 0 and geom.conaffinity == 0:
            continue
        if movable[geom.id]:
            mask = MOVABLE_MASK
        elif labels.geom_category[geom.id] == _FLOOR:
            mask = COVER_MASK if (geom.contype, geom.conaffinity) == COVER_MASK else FLOOR_MASK
        else:
            mask = STATIC_MASK
        geom.contype, geom.conaffinity = mask
        geom.margin = geom.gap = 0.0  # the hull's skin is the only margin


def _set_options(spec: mujoco.MjSpec, config: RobotConfig) -> None:
    """Replaces the physics options of the file by those that every house has."""
    spec.option = mujoco.MjSpec().option
    option = spec.option
    option.timestep = config.physics.timestep_s
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    option.solver = mujoco.mjtSolver.mjSOL_NEWTON
    option.impratio = 5.0  # at 1, tyres creep by 2 mm/s on a slope of 8 deg; at 10, round furniture never sleeps
    option.iterations, option.ls_iterations = 20, 20
    option.enableflags = int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    # MULTICCD gives wrong normals for a cylinder on a box's corner; an automatic reset would hide a NaN.
    option.disableflags = int(mujoco.mjtDisableBit.mjDSBL_MULTICCD) | int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)


def _renumber(labels: Labels, names: list[str], model: mujoco.MjModel) -> Labels:
    """Returns the labels of the house alone with the geom ids of the world's model; `names` are those of its geoms."""
    new_id = np.array([model.geom(name).id for name in names], dtype=np.int64)
    category = np.zeros(model.ngeom, dtype=np.uint8)
    category[new_id] = labels.geom_category
    owner = np.full(model.ngeom, -1, dtype=np.int32)
    owner[new_id] = labels.geom_instance
    instances = tuple(
        Instance(instance.name, instance.category, tuple(sorted(new_id[list(instance.geom_ids)].tolist())))
        for instance in labels.instances
    )
    return replace(labels, instances=instances, geom_category=category, geom_instance=owner)
