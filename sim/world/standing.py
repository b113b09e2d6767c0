"""The instances of a compiled house as boxes with a heading, for the rules on how furniture stands."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.gl import mujoco
from sim.houses.geoms import world_boxes
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
    front: NDArray[np.float64]  # (2,) unit vector: the heading of its body

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
    low, high = world_boxes(model, data, np.arange(model.ngeom))
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
                x_axis / max(float(np.linalg.norm(x_axis)), 1e-9),
            )
        )
    return items


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
