"""Items at their poses, and lamps: the content of a house, before `builder` writes it."""

from __future__ import annotations

from dataclasses import dataclass

from sim.core.geometry.pose import Pose
from sim.homes.housegen.furniture.item import Item


@dataclass(frozen=True)
class Hinge:
    """The upright hinge of a door leaf, at the origin of the item."""

    angle_rad: float
    """How far the leaf is open where it is placed; 0 closes the doorway."""
    widest_rad: float
    """How far it opens."""
    turns_left: bool
    """Whether it opens counter-clockwise, seen from above."""


@dataclass(frozen=True)
class PlacedItem:
    """An item with the world pose of its origin; the yaw is the heading of its front."""

    item: Item
    x_m: float = 0.0
    y_m: float = 0.0
    z_m: float = 0.0
    yaw_rad: float = 0.0
    hinge: Hinge | None = None
    """Set for a door leaf that the robot can push; everything else without a free joint is fixed."""

    def to_world(self, x_m: float, y_m: float) -> tuple[float, float]:
        """Returns the world position in plan of a point of the item's frame."""
        return Pose(self.x_m, self.y_m, self.yaw_rad).place_of(x_m, y_m)


@dataclass(frozen=True)
class Lamp:
    """A light: directional with a `direction`, else a spot that shines down from `pos_m`."""

    pos_m: tuple[float, float, float]
    diffuse: tuple[float, float, float]
    direction: tuple[float, float, float] | None = None
    shadow: bool = False
