"""A trap: a scene with its sidecar (start, goal, and the reason why agents get stuck)."""

from __future__ import annotations

from dataclasses import dataclass

from sim.core.geometry.pose import Pose
from sim.homes.housegen.traps.site import TrapSite
from sim.houses.sidecar import Sidecar


@dataclass(frozen=True)
class Trap:
    """A trap scene and its sidecar."""

    site: TrapSite
    sidecar: Sidecar

    @property
    def start(self) -> Pose:
        """The sidecar's start, which every trap has."""
        assert self.sidecar.start is not None
        return self.sidecar.start

    @property
    def goal(self) -> str:
        """The sidecar's goal, which every trap has."""
        assert self.sidecar.goal is not None
        return self.sidecar.goal
