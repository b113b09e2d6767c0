"""Read a house file and refuse, in one sentence, what breaks the house format (contract, section 3)."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from sim.errors import HouseError
from sim.gl import mujoco
from sim.houses.foreign import adopt, tell_void
from sim.houses.house import House
from sim.houses.labels import Labels, collidable_geoms, describe_geom, read_labels
from sim.interface import MPCAT40_ID

FLOOR_TOLERANCE_M = 0.01
"""How far the top of the ground floor may be from z = 0."""
_NOT_CONVEX = {
    int(mujoco.mjtGeom.mjGEOM_HFIELD): "height field",
    int(mujoco.mjtGeom.mjGEOM_SDF): "signed distance field",
}
_FLOOR_SHAPES = (int(mujoco.mjtGeom.mjGEOM_PLANE), int(mujoco.mjtGeom.mjGEOM_BOX))


def load_house(path: Path, *, labels_path: Path | None = None) -> House:
    """The house in one MJCF file; textures and meshes are found relative to it.

    Args:
        path: the MJCF file.
        labels_path: a JSON file of label rules, `{"regex over names": "category"}`, for a house from elsewhere. What
            no house holds is then left out, and told in the house's `notes`.

    Raises:
        HouseError: the file is missing, is no MJCF, or breaks a rule of the house format; names file, geom and rule.
    """
    path = Path(path)
    rules = None if labels_path is None else read_rules(Path(labels_path))
    if not path.is_file():
        raise HouseError(f"House '{path}': there is no such file.")
    try:
        spec = mujoco.MjSpec.from_file(str(path.resolve()))
        notes = () if rules is None else adopt(spec)
        model = spec.compile()
    except (ValueError, OSError) as error:
        raise HouseError(f"House '{path}' is no MJCF file that MuJoCo can read: {_one_line(error)}") from None
    house = House(path.stem, spec, rules, path)
    try:
        labels = validate_house(house, model)
    except HouseError as error:
        raise HouseError(f"House '{path}': {error}") from None
    return replace(house, notes=(*notes, *tell_void(model, labels)))


def read_rules(path: Path) -> dict[str, str]:
    """Label rules from a JSON file.

    Raises:
        HouseError: the file is missing or is not one JSON object of strings.
    """
    if not path.is_file():
        raise HouseError(f"Label rules '{path}': there is no such file.")
    try:
        rules = json.loads(path.read_text(encoding="utf-8"))
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise HouseError(f"Label rules '{path}' are no JSON: {error}.") from None
    if not isinstance(rules, dict) or not all(isinstance(value, str) for value in rules.values()):
        raise HouseError(f'Label rules \'{path}\' must be one JSON object {{"regex over names": "category"}}.')
    return rules


def validate_house(house: House, model: mujoco.MjModel) -> Labels:
    """The labels of a compiled house, once it is known to keep the house format.

    Raises:
        HouseError: it does not; the message names geom and rule but not the house.
    """
    for count, what, names in (
        (model.ncam, "camera", house.spec.cameras),
        (model.nu, "actuator", house.spec.actuators),
    ):
        if count:
            raise HouseError(f"a house holds no {what}, but this one has {what} {_quoted(names[0].name)}.")
    if model.nflex or model.nskin:
        raise HouseError("a house is made of geoms, but this one has a flex or a skin, which cannot be labelled.")
    for shape, what in _NOT_CONVEX.items():
        for geom in np.flatnonzero(model.geom_type == shape).tolist():
            raise HouseError(
                f"{describe_geom(model, geom)} is a {what}: a house is made of boxes, meshes and the like."
            )
    labels = read_labels(model, rules=house.rules, ignore_prefix="")
    try:
        _require_floor(model, labels)
    except HouseError as error:
        raise HouseError(" ".join([str(error), *tell_void(model, labels)])) from None
    return labels


def _require_floor(model: mujoco.MjModel, labels: Labels) -> None:
    """Refuse a house without a floor at z = 0 that carries wheels."""
    floors = np.flatnonzero((labels.geom_category == MPCAT40_ID["floor"]) & collidable_geoms(model))
    if floors.size == 0:
        raise HouseError(
            "it is without floor: at least one geom that collides (a plane or a box) must be labelled "
            "floor_<number>, its top at z = 0."
        )
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    tops = {int(geom): top_z_m(model, data, int(geom)) for geom in floors if model.geom_type[geom] in _FLOOR_SHAPES}
    if not any(abs(top) <= FLOOR_TOLERANCE_M for top in tops.values()):
        geom = min(tops, key=lambda g: abs(tops[g])) if tops else int(floors[0])
        found = f"its top is at z = {tops[geom]:.3f} m" if tops else "it is neither a plane nor a box"
        raise HouseError(
            f"the floor of the ground storey is a plane or a box with its top at z = 0, but the nearest is "
            f"{describe_geom(model, geom)}: {found}."
        )


def top_z_m(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> float:
    """Height of the top of a plane or box floor in the world."""
    z = float(data.geom_xpos[geom, 2])
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_PLANE:
        return z
    return z + float(np.abs(data.geom_xmat[geom, 6:9]) @ model.geom_size[geom])


def _quoted(name: str) -> str:
    return f"'{name}'" if name else "without a name"


def _one_line(error: Exception) -> str:
    """MuJoCo's message of several lines as one."""
    return " ".join(str(error).split())
