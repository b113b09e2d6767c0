"""The instances of a compiled house as boxes with a heading, for the rules on how furniture stands."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.gl import mujoco
from sim.houses.house import Room
from sim.houses.instance_facts import read_instance_facts
from sim.houses.labels import Labels

SHALLOW_M = 0.13
"""An item on a wall that is no deeper than this is not in the way."""
_NOT_ON_FLOOR = frozenset(
    ("floor", "wall", "ceiling", "window", "door", "curtain", "blinds", "void", "stairs", "railing")
)


@dataclass(frozen=True)
class Standing:
    """An instance where it stands."""

    label: str
    name: str
    """Everyday name; the words of its category where the file has none."""
    category: str
    low: NDArray[np.float64]  # (3,) metres
    high: NDArray[np.float64]  # (3,) metres
    at: NDArray[np.float64]  # (2,) origin of its body, metres
    front: NDArray[np.float64]  # (2,) unit vector: the heading of its body
    geoms: tuple[int, ...] = ()

    @property
    def middle(self) -> NDArray[np.float64]:
        """The middle (2,) of its box in plan."""
        return 0.5 * (self.low + self.high)[:2]

    def gap_m(self, other: Standing) -> float:
        """Returns the distance between two boxes in plan, 0 where they overlap."""
        return float(np.linalg.norm(np.maximum(0.0, np.maximum(self.low - other.high, other.low - self.high))[:2]))

    def overlap_m(self, other: Standing) -> NDArray[np.float64]:
        """Returns the overlap (3,) along each axis, negative for a gap."""
        return np.minimum(self.high, other.high) - np.maximum(self.low, other.low)


def read_standing(model: mujoco.MjModel, data: mujoco.MjData, labels: Labels) -> list[Standing]:
    """Returns all instances with their boxes."""
    facts = read_instance_facts(model, labels)
    low, high = _boxes(model, data)
    items = []
    for instance in labels.instances:
        ids = np.array(instance.geom_ids)
        body = int(model.geom_bodyid[ids[0]])
        while body and model.body(body).name != instance.name:
            body = int(model.body_parentid[body])
        x_axis = data.xmat[body].reshape(3, 3)[:2, 0]
        name = facts[instance.name].name if instance.name in facts else ""
        items.append(
            Standing(
                instance.name,
                name or instance.category.replace("_", " "),
                instance.category,
                low[ids].min(axis=0),
                high[ids].max(axis=0),
                data.xpos[body][:2].copy(),
                x_axis / max(float(np.linalg.norm(x_axis)), 1e-9),
                tuple(instance.geom_ids),
            )
        )
    return items


def _boxes(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the lowest and highest corners (ngeom, 3) of the world-aligned boxes around all geoms, metres.

    Those of meshes are of their vertices: the frame of a mesh is turned, which makes the box of its own box too large.
    """
    rotation = data.geom_xmat.reshape(-1, 3, 3)
    middle = data.geom_xpos + np.einsum("nij,nj->ni", rotation, model.geom_aabb[:, :3])
    reach = np.einsum("nij,nj->ni", np.abs(rotation), model.geom_aabb[:, 3:])
    low, high = middle - reach, middle + reach
    for geom in np.flatnonzero(model.geom_type == mujoco.mjtGeom.mjGEOM_MESH.value).tolist():
        mesh = model.geom_dataid[geom]
        first = model.mesh_vertadr[mesh]
        vertices = model.mesh_vert[first : first + model.mesh_vertnum[mesh]] @ rotation[geom].T + data.geom_xpos[geom]
        low[geom], high[geom] = vertices.min(axis=0), vertices.max(axis=0)
    return low, high


def is_in(room: Room, item: Standing) -> bool:
    """Returns whether the middle of an item lies in a room."""
    z_m = 0.5 * float(item.low[2] + item.high[2])
    return room.contains(*item.middle.tolist()) and any(abs(z_m - c[2]) <= h[2] + 0.05 for c, h in room.boxes)


def blocks_floor(item: Standing, floor_z_m: float, up_to_m: float = 0.9) -> bool:
    """Returns whether an item is in the way of a person: no rug, nothing high above, nothing shallow on a wall."""
    if item.category in _NOT_ON_FLOOR or item.category == "objects":
        return False
    if item.low[2] > floor_z_m + 0.3 and (item.high - item.low)[:2].min() < SHALLOW_M:
        return False
    return item.low[2] < floor_z_m + up_to_m and item.high[2] > floor_z_m + 0.05
