"""Common code of importers of MJCF scenes: a scene on its way to a split, its floor, its rooms and its report."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sim.core.errors import HouseError
from sim.core.files import inside, write_atomically
from sim.gl import mujoco
from sim.homes.housegen.floor_plan.rectangles import Rect
from sim.houses.geoms import data_at_rest
from sim.houses.house import House
from sim.houses.load import compiled, validate_house
from sim.houses.mjcf import read_spec
from sim.houses.packing import PackedFile, write_files
from sim.houses.proposals import geom_box


@dataclass(frozen=True)
class Scene:
    """A house of another project, ready to be written."""

    name: str
    text: str
    """The MJCF file, which uses `files`."""
    files: Mapping[str, PackedFile]
    rules: Mapping[str, str]
    """Label rules."""
    report: Mapping[str, Any]


def write_scene(out: Path, scene: Scene, *, pack: bool) -> None:
    """Writes a scene into the folder of a split, and reads it once as the simulator does.

    Args:
        out: the folder.
        scene: it may have been made from hostile data.
        pack: whether to copy its meshes and textures; otherwise they are linked where possible.

    Raises:
        HouseError: the house that was written violates the house format.
    """
    for name in scene.files:
        inside(out, name, what="name of a file")
    write_files(out, scene.files, pack=pack)
    written = inside(out, f"{scene.name}.xml", what="name of a house")
    write_atomically(written, scene.text)
    try:
        spec = read_spec(written)
        validate_house(House(scene.name, spec, scene.rules, written), compiled(spec))
    except HouseError as error:
        raise HouseError(f"House '{scene.report['source']}': {error}") from None


def floor_height(model: mujoco.MjModel) -> float:
    """Returns the height of the floor that collides, a plane or a box named "floor"; 0 without one, or within 1 mm."""
    geom = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, "floor")
    if geom < 0:
        return 0.0
    data = data_at_rest(model)
    plane = model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_PLANE
    top = float(data.geom_xpos[geom, 2]) if plane else float(geom_box(model, data, geom)[1][2])
    return top if abs(top) > 1e-3 else 0.0


def lower(spec: mujoco.MjSpec, by_m: float) -> None:
    """Moves everything in the world down."""
    world = spec.worldbody
    for element in (*world.bodies, *world.geoms, *world.sites, *world.lights, *world.frames):
        if getattr(element, "frame", None) is None:
            element.pos = [element.pos[0], element.pos[1], element.pos[2] - by_m]


def add_room(spec: mujoco.MjSpec, name: str, rect: Rect, top_m: float) -> None:
    """Adds a box site that declares a room, or a part of one, from z = 0 to `top_m`."""
    x, y = rect.centre
    spec.worldbody.add_site(
        name=name, type=mujoco.mjtGeom.mjGEOM_BOX, group=4, pos=[x, y, top_m / 2],
        size=[rect.width_m / 2, rect.depth_m / 2, top_m / 2],
    )  # fmt: skip


def box_of(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> Rect:
    """Returns the rectangle around a geom in plan."""
    (x0, y0, _), (x1, y1, _) = (np.asarray(corner).tolist() for corner in geom_box(model, data, geom))
    return Rect(x0, y0, x1, y1)
