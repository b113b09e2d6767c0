"""Loads a house file and refuses files that break a rule of the house format (docs/houses.md)."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from sim.core.errors import HouseError
from sim.core.interface import MPCAT40_ID
from sim.core.invocation import command
from sim.core.paths import assets_dir
from sim.core.reading import MAX_BYTES, read_bytes, read_json, reason_of
from sim.core.store import kept, key_of
from sim.gl import mujoco
from sim.houses.foreign import make_walls_solid, remove_unsupported, void_notes
from sim.houses.geoms import data_at_rest
from sim.houses.house import House
from sim.houses.labels import ROBOT_PREFIX, Labels, collidable_geoms, describe_geom, read_labels
from sim.houses.mjcf import TEXTURE_VARIABLE, read_spec, require_few_contacts, require_sizes
from sim.houses.references import add_files, require_root, shipped_textures_sum

FLOOR_TOLERANCE_M = 0.01
"""Largest distance of the top of the ground floor from z = 0."""
_NOT_CONVEX = {
    int(mujoco.mjtGeom.mjGEOM_HFIELD): "height field",
    int(mujoco.mjtGeom.mjGEOM_SDF): "signed distance field",
}
_FLOOR_SHAPES = (int(mujoco.mjtGeom.mjGEOM_PLANE), int(mujoco.mjtGeom.mjGEOM_BOX))
MIN_AMBIENT = 0.3
"""A scene without lamps keeps its light if its headlight has at least this ambient part."""
AMBIENT, HEADLIGHT = 0.5, 0.2
"""Ambient and diffuse part of the headlight that is set."""
SIDES = (((0.45, 0.3, -0.85), 0.25), ((-0.6, -0.35, -0.7), 0.12))
"""Direction and strength of two added lights without shadows: the walls of a corner then differ in brightness."""


def no_such_house(path: Path) -> HouseError:
    """Returns the error for a house file that does not exist; it names a shipped house of this name if there is one."""
    message = f"House '{path}': there is no such file."
    shipped = (folder / f"{path.stem}.xml" for folder in sorted(assets_dir().iterdir()))
    file = next((file for file in shipped if file.is_file()), None)
    if path.parent != Path() or file is None:
        return HouseError(message)
    near = file.is_relative_to(Path.cwd())
    return HouseError(f"{message} The shipped house is '{file.relative_to(Path.cwd()) if near else file}'.")


def load_house(path: Path, *, labels_path: Path | None = None, root: Path | None = None) -> House:
    """Returns the house of one MJCF file; paths of textures and meshes are relative to it.

    Args:
        path: the MJCF file.
        labels_path: a JSON file of label rules, `{"regex over names": "category"}`, for a third-party scene. Elements
            that a house may not contain are then removed and reported in the house's `notes`.
        root: a folder that the house may use in addition to its own (`sim.houses.references`).

    A file that was checked before, and all files that it uses, are read again only when its specification is used.

    Raises:
        HouseError: the file is missing, is not MJCF, or breaks a rule of the house format; the message names file, geom
            and rule.
    """
    path = Path(path)
    rules = None if labels_path is None else read_rules(Path(labels_path))
    if not path.is_file():
        raise no_such_house(path)
    require_root(root)
    made: list[House] = []

    def load() -> tuple[str, ...]:
        made.append(_read(path, rules, root))
        return made[0].notes

    checksum = _checksum(path, rules, root)
    limit = os.environ.get(TEXTURE_VARIABLE)  # a house that was checked with another one is checked again
    notes = kept(checksum and key_of("house", checksum, limit), tuple[str, ...], load)
    if made:
        return replace(made[0], checksum=checksum)

    def read() -> mujoco.MjSpec:
        spec = _read(path, rules, root).spec
        if _checksum(path, rules, root) != checksum:  # its model would be kept in place of that of the loaded one
            raise HouseError(f"House '{path}' was changed after it was loaded; load it again.")
        return spec

    return House(path.stem, read, rules, path, notes, checksum)


def _checksum(path: Path, rules: Mapping[str, str] | None, root: Path | None) -> str | None:
    """Returns the checksum of a house file, all files that it uses and its label rules; None: it is unknown."""
    try:
        digest = hashlib.sha256(read_bytes(path, what="House", error=HouseError, most=MAX_BYTES))
        add_files(digest, path, root)
    except HouseError:
        return None  # too many files; or one that cannot be read, of which `read_spec` says what is wrong
    digest.update(repr((shipped_textures_sum(), rules if rules is None else tuple(rules.items()))).encode())
    return digest.hexdigest()


def _read(path: Path, rules: dict[str, str] | None, root: Path | None) -> House:
    """Returns the house of a file after checking it; see `load_house`."""
    try:
        spec = read_spec(path, root=root)
        notes = () if rules is None else remove_unsupported(spec)
        model = compiled(spec)
        require_sizes(model)
        require_few_contacts(model)
        house = House(path.stem, spec, rules, path)
        labels = _validated(house, model)
        notes += add_light(spec)
    except HouseError as error:
        raise HouseError(f"House '{path}': {error}") from None
    if rules is not None:
        notes = (*notes, *make_walls_solid(spec, model, labels), *void_notes(model, labels))
    return replace(house, notes=notes)


def read_rules(path: Path) -> dict[str, str]:
    """Returns the label rules of a JSON file.

    Raises:
        HouseError: the file is missing or is not one JSON object of strings.
    """
    if not path.is_file():
        raise HouseError(f"Label rules '{path}': there is no such file.")
    try:
        return read_json(path, dict[str, str], what="Label rules", error=HouseError)
    except HouseError as error:
        raise HouseError(f'{error} They must be one JSON object {{"regex over names": "category"}}.') from None


def _validated(house: House, model: mujoco.MjModel) -> Labels:
    """Returns the labels of a compiled house; the refusal of a house without rules says how to give some."""
    try:
        return validate_house(house, model)
    except HouseError as error:
        hint = f" A scene from elsewhere needs --labels: `{command('label')}` proposes the rules."
        raise HouseError(str(error) if house.rules is not None else f"{error}{hint}") from None


def validate_house(house: House, model: mujoco.MjModel) -> Labels:
    """Returns the labels of a compiled house after checking it against the house format.

    Raises:
        HouseError: it breaks a rule; the message names geom and rule but not the house.
    """
    for count, kind, elements in (
        (model.ncam, "camera", house.spec.cameras),
        (model.nu, "actuator", house.spec.actuators),
        (model.ntendon, "tendon", house.spec.tendons),
    ):
        if count:
            raise HouseError(f"a house must not have {kind}s, but this one has {kind} {_quote(elements[0].name)}.")
    for element in (*house.spec.bodies, *house.spec.geoms, *house.spec.joints, *house.spec.sites):
        if element.name.startswith(ROBOT_PREFIX):
            raise HouseError(
                f"names with the prefix '{ROBOT_PREFIX}' are the robot's, but there is {_quote(element.name)}."
            )
    if model.nflex or model.nskin:
        raise HouseError("a house consists of geoms, but this one has a flex or a skin, which cannot be labelled.")
    for shape, kind in _NOT_CONVEX.items():
        for geom in np.flatnonzero(model.geom_type == shape).tolist():
            raise HouseError(
                f"{describe_geom(model, geom)} is a {kind}, which is not supported: use boxes, meshes or other "
                "convex geoms."
            )
    labels = read_labels(model, rules=house.rules, ignore_prefix="")
    try:
        _require_floor(model, labels, has_rules=house.rules is not None)
    except HouseError as error:
        raise HouseError(" ".join([str(error), *void_notes(model, labels)])) from None
    _require_low_planes(model)
    return labels


def _require_low_planes(model: mujoco.MjModel) -> None:
    """Raises a HouseError if a plane faces up above the ground: everything below it is inside of it."""
    data = data_at_rest(model)
    planes = np.flatnonzero((model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE) & collidable_geoms(model))
    for geom in planes.tolist():
        z_m = float(data.geom_xpos[geom, 2])
        if z_m > FLOOR_TOLERANCE_M and data.geom_xmat[geom, 8] > 0.5:
            raise HouseError(
                f"{describe_geom(model, geom)} is a plane at z = {z_m:.2f} m that faces up, so that all space below it "
                "is solid; use a box for a floor above the ground."
            )


def _require_floor(model: mujoco.MjModel, labels: Labels, *, has_rules: bool) -> None:
    """Raises a HouseError when no collision geom is a floor at z = 0."""
    floors = np.flatnonzero((labels.geom_category == MPCAT40_ID["floor"]) & collidable_geoms(model))
    if floors.size == 0:
        remedy = "get the category 'floor' from a label rule" if has_rules else "be labelled floor_<number>"
        raise HouseError(
            f"it has no floor: at least one collision geom (a plane or a box) must {remedy}, with its top at z = 0."
        )
    data = data_at_rest(model)
    tops = {int(geom): _top_z_m(model, data, int(geom)) for geom in floors if model.geom_type[geom] in _FLOOR_SHAPES}
    if not any(abs(top) <= FLOOR_TOLERANCE_M for top in tops.values()):
        geom = min(tops, key=lambda g: abs(tops[g])) if tops else int(floors[0])
        shape = f"its top is at z = {tops[geom]:.3f} m" if tops else "it is neither a plane nor a box"
        raise HouseError(
            f"the floor of the ground storey must be a plane or a box with its top at z = 0, but the nearest is "
            f"{describe_geom(model, geom)}: {shape}."
        )


def _top_z_m(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> float:
    """Returns the height of the top of a plane or a box in the world."""
    z = float(data.geom_xpos[geom, 2])
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_PLANE:
        return z
    return z + float(np.abs(data.geom_xmat[geom, 6:9]) @ model.geom_size[geom])


def _quote(name: str) -> str:
    return f"'{name}'" if name else "without a name"


def compiled(spec: mujoco.MjSpec) -> mujoco.MjModel:
    """Returns the model of a specification.

    Raises:
        HouseError: MuJoCo refuses it.
    """
    try:
        return spec.compile()
    except (ValueError, OSError, MemoryError) as error:
        raise HouseError(f"it is not an MJCF file that MuJoCo can read: {reason_of(error)}") from None


def add_light(spec: mujoco.MjSpec) -> tuple[str, ...]:
    """Adds light to a scene without lamps if its headlight is weak; returns a sentence if it has added light.

    A bare room of medium grey then has a mean grey level of about 80 of 255 in the images of the robot's camera.
    """
    head = spec.visual.headlight
    if any(light.active for light in spec.lights) or (head.active and np.mean(head.ambient) >= MIN_AMBIENT):
        return ()
    head.active = 1
    head.ambient, head.diffuse, head.specular = [AMBIENT] * 3, [HEADLIGHT] * 3, [0.0] * 3
    for direction, strength in SIDES:
        light = spec.worldbody.add_light()
        light.type = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
        light.pos, light.dir = [0.0, 0.0, 3.0], list(direction)
        light.ambient, light.diffuse, light.specular = [0.0] * 3, [strength] * 3, [0.0] * 3
        light.castshadow = False
    return ("Added light: the scene has no lamps and a weak headlight.",)
