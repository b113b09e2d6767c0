"""What is true of a house when an episode starts: where the robot fits, where a goal counts, how far that is.

Computed when first asked for and kept: every episode of a house starts from the same state. Things stand where the
house's file puts them, so the answers do not hang on who played before.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.errors import EpisodeError
from sim.gl import mujoco
from sim.interface import GOAL_CATEGORIES
from sim.task.success import GoalRegion, Surroundings
from sim.world.freespace import FreeSpace
from sim.world.world import World


@dataclass(frozen=True, eq=False)
class Target:
    """One goal category on one storey."""

    region: GoalRegion
    reached: NDArray[np.bool_]  # (rows, cols) free cells at which a STOP succeeds
    distance_m: NDArray[np.float32]  # (rows, cols) geodesic distance to the nearest of them; inf: no way


class GroundTruth:
    """Free space and goals of one world, for its task, its oracle and whoever makes episodes."""

    def __init__(self, world: World) -> None:
        self.world = world
        self._at_rest = mujoco.MjData(world.model)
        mujoco.mj_kinematics(world.model, self._at_rest)
        self._spaces: dict[float, FreeSpace] = {}
        self._surroundings: dict[float, Surroundings] = {}
        self._targets: dict[tuple[str, float], Target] = {}

    def space(self, floor_z_m: float = 0.0) -> FreeSpace:
        """Free space of the storey whose floor is at this height."""
        if floor_z_m not in self._spaces:
            world = self.world
            self._spaces[floor_z_m] = FreeSpace(
                world.model, self._at_rest, world.labels, rooms=world.rooms, robot=world.robot, floor_z_m=floor_z_m
            )
        return self._spaces[floor_z_m]

    def target(self, goal: str, floor_z_m: float = 0.0) -> Target:
        """Where a STOP for a goal succeeds on a storey, and how far that is from everywhere.

        A storey without an instance in a house that has one elsewhere gives no place and no way.

        Raises:
            EpisodeError: there is no such goal category, or the house has no instance of it.
        """
        if (goal, floor_z_m) not in self._targets:
            space, region = self.space(floor_z_m), self._region(goal, floor_z_m, self._at_rest)
            reached = region.mask(space)
            self._targets[goal, floor_z_m] = Target(region, reached, space.geodesic(reached))
        return self._targets[goal, floor_z_m]

    def goals(self) -> tuple[str, ...]:
        """The goal categories that the house has an instance of, in the contract's order."""
        return tuple(goal for goal in GOAL_CATEGORIES if self.world.labels.of_category(goal))

    def succeeds_now(self, goal: str, x_m: float, y_m: float, floor_z_m: float) -> bool:
        """Whether a STOP at this place succeeds with things where they now are in the world."""
        return self._region_now(goal, floor_z_m).succeeds(x_m, y_m)

    def nearest_now_m(self, goal: str, x_m: float, y_m: float, floor_z_m: float) -> float | None:
        """Metres in plan to the nearest instance on a storey, walls ignored, with things where they now are.

        None where the storey has no instance.
        """
        return self._region_now(goal, floor_z_m).nearest_m(x_m, y_m)

    def _region_now(self, goal: str, floor_z_m: float) -> GoalRegion:
        if self._may_have_moved(goal):
            return self._region(goal, floor_z_m, self.world.data)
        return self.target(goal, floor_z_m).region

    def _region(self, goal: str, floor_z_m: float, data: mujoco.MjData) -> GoalRegion:
        if goal not in GOAL_CATEGORIES:
            raise EpisodeError(f"Unknown goal '{goal}'. There is: {', '.join(GOAL_CATEGORIES)}.")
        world = self.world
        if floor_z_m not in self._surroundings:
            self._surroundings[floor_z_m] = Surroundings.of(
                world.model, self._at_rest, world.labels, floor_z_m=floor_z_m
            )
        around = self._surroundings[floor_z_m]
        region = GoalRegion(world.model, data, world.labels, goal, floor_z_m=floor_z_m, surroundings=around)
        if not region.exists:
            raise EpisodeError(
                f"House '{world.house.name}' has no '{goal}'. It has: {', '.join(self.goals()) or 'no goal'}."
            )
        return region

    def _may_have_moved(self, goal: str) -> bool:
        model = self.world.model
        geoms = [geom for instance in self.world.labels.of_category(goal) for geom in instance.geom_ids]
        return bool(np.any(model.body_weldid[model.geom_bodyid[geoms]] != 0))
