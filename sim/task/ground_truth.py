"""Facts about a house at the start of an episode: free space, places where a STOP succeeds, distances to them.

They are computed on first use and kept, because every episode of a house starts from the same state: objects are where
the house file puts them, whatever episodes ran before. Only the test at STOP uses the objects and door leaves where
they are then.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sim.core.errors import EpisodeError
from sim.core.geometry.grid import GridFrame
from sim.core.goals import NO_GOAL, GoalSpec
from sim.core.interface import GOAL_CATEGORIES, CameraModel, SuccessRule
from sim.core.invocation import command
from sim.core.store import kept, key_of
from sim.core.wishes import category_of_label, parse_wish, require_goal
from sim.gl import mujoco
from sim.houses.geoms import data_at_rest
from sim.houses.labels import Instance, rendered_geoms
from sim.task.footprints import Footprint
from sim.task.meaning import MAX_LISTED, Meaning
from sim.task.seen_floor import SeenFloor, floor_cells
from sim.task.success import SIGHT_BLOCKERS, GoalRegion, Surroundings, sight_blockers
from sim.world.freespace import FreeSpace
from sim.world.leaves import hinged_leaves, moved
from sim.world.world import World

_NO_OBJECTS = frozenset({"void", "floor", "ceiling"})


@dataclass(frozen=True, eq=False)
class Target:
    """One goal on one storey."""

    region: GoalRegion
    reached: NDArray[np.bool_]  # (rows, cols) free cells at which a STOP succeeds
    distance_m: NDArray[np.float32]  # (rows, cols) geodesic distance to the nearest of them; inf: no path


@dataclass(frozen=True)
class _Reached:
    """What is kept of a target."""

    footprints: tuple[Footprint | None, ...]
    """Of all instances of the goal."""
    reached: NDArray[np.bool_]  # (free cells,)
    distance_m: NDArray[np.float32]  # (free cells,)


class GroundTruth:
    """Free space and goals of one world, for its task, its oracle and the tools that make episodes.

    Args:
        world: the compiled house with its robot.
        success: when a STOP succeeds.
        camera: the robot's camera, whose height is that of the line of sight unless the rule has another.
    """

    def __init__(self, world: World, *, success: SuccessRule | None = None, camera: CameraModel | None = None) -> None:
        self.world = world
        self.success = success or SuccessRule()
        self.camera = camera or CameraModel()
        self._sight_height_m = self.success.sight_height_with(self.camera)
        self._at_rest = data_at_rest(world.model)
        self._leaves = hinged_leaves(world.model, self._at_rest, world.labels)
        self._spaces: dict[float, FreeSpace] = {}
        self._floors: dict[float, tuple[GridFrame, NDArray[np.bool_]]] = {}
        self._surroundings: dict[float, Surroundings] = {}
        self._regions: dict[tuple[str, float], GoalRegion] = {}
        self._targets: dict[tuple[str, float], Target] = {}
        self._instances: dict[str, tuple[Instance, ...]] = {}
        self.meaning = Meaning(world, self._at_rest)
        """The objects that satisfy goals in words."""

    def instances(self, goal: str | GoalSpec) -> tuple[Instance, ...]:
        """Returns all objects of the house that satisfy a goal.

        Args:
            goal: a goal category, whose instances they are; the label of one instance (`chair_03`); or words
                (`sim.core.wishes`). Those of a picture are the object that it shows.

        Raises:
            EpisodeError: the goal has a word that is not known, or no object satisfies it, unless it is a category; the
                message says what there is.
        """
        goal = str(goal)
        if goal not in self._instances:
            labels = self.world.labels
            if goal == NO_GOAL.text:
                self._instances[goal] = ()
            elif goal in GOAL_CATEGORIES:
                self._instances[goal] = labels.of_category(goal)
            else:
                require_goal(goal)
                named = tuple(instance for instance in labels.instances if instance.name == goal)
                category = None if named else category_of_label(goal)
                if category is not None:
                    others = ", ".join(instance.name for instance in labels.of_category(category)[:MAX_LISTED])
                    raise EpisodeError(self._absent(goal, others or self._what_it_has()))
                self._instances[goal] = named or self.meaning.satisfying(parse_wish(goal))
        return self._instances[goal]

    def space(self, floor_z_m: float = 0.0) -> FreeSpace:
        """Returns the free space of the storey whose floor is at this height."""
        if floor_z_m not in self._spaces:
            world = self.world
            self._spaces[floor_z_m] = FreeSpace(
                world.model,
                self._at_rest,
                world.labels,
                rooms=world.rooms,
                robot=world.robot,
                rule=self.success,
                floor_z_m=floor_z_m,
                key=world.key,
            )
        return self._spaces[floor_z_m]

    def unseen_floor(self, floor_z_m: float = 0.0) -> SeenFloor:
        """Returns the floor of a storey before the camera has seen any of it."""
        if floor_z_m not in self._floors:
            space = self.space(floor_z_m)
            self._floors[floor_z_m] = floor_cells(space.frame, space.floors)
        return SeenFloor(*self._floors[floor_z_m], floor_z_m, self.camera)

    def target(self, goal: str, floor_z_m: float = 0.0) -> Target:
        """Returns the places of a storey where a STOP for a goal succeeds, and the distance to them from everywhere.

        A storey without an instance, in a house that has one elsewhere, has no such place, and no path to one.

        Raises:
            EpisodeError: the goal is unknown, or the house has no instance of it.
        """
        if (goal, floor_z_m) not in self._targets:
            space, instances, at_rest = self.space(floor_z_m), self.instances(goal), self._at_rest
            footprints = self._surroundings_of(floor_z_m).footprints

            def make() -> _Reached:
                region = self._existing(self.region(goal, floor_z_m))
                reached = region.mask(space)
                outlines = tuple(footprints.of(at_rest, instance) for instance in instances)
                return _Reached(outlines, reached[space.free], space.geodesic(reached)[space.free])

            key = self._key_of("target", tuple(instance.name for instance in instances), floor_z_m)
            known = kept(key, _Reached, make)
            for instance, outline in zip(instances, known.footprints, strict=True):
                footprints.remember(at_rest, instance, outline)
            region = self._existing(self.region(goal, floor_z_m))
            reached, distance_m = np.zeros_like(space.free), np.full(space.free.shape, np.inf, np.float32)
            reached[space.free], distance_m[space.free] = known.reached, known.distance_m
            self._targets[goal, floor_z_m] = Target(region, reached, distance_m)
        return self._targets[goal, floor_z_m]

    def target_now(self, goal: str, floor_z_m: float = 0.0) -> Target:
        """Returns the same with objects and door leaves where they are now, in the free space of the start."""
        space, region = self.space(floor_z_m), self._region_now(goal, floor_z_m)
        reached = region.mask(space)
        return Target(region, reached, space.geodesic(reached))

    def region(self, goal: str, floor_z_m: float = 0.0) -> GoalRegion:
        """Returns the region of a storey where a STOP for a goal succeeds, with objects where the house file puts them.

        Raises:
            EpisodeError: the goal is unknown.
        """
        if (goal, floor_z_m) not in self._regions:
            self._regions[goal, floor_z_m] = self._region(goal, floor_z_m, self._at_rest)
        return self._regions[goal, floor_z_m]

    def goals(self) -> tuple[str, ...]:
        """Returns the goal categories that have a rendered object in the house, in the contract's order."""
        rendered, of_category = rendered_geoms(self.world.model), self.world.labels.of_category
        return tuple(
            goal
            for goal in GOAL_CATEGORIES
            if any(rendered[list(instance.geom_ids)].any() for instance in of_category(goal))
        )

    def require_goals(self) -> tuple[str, ...]:
        """Returns `goals`; raises EpisodeError if there are none, with the categories that the house has."""
        goals = self.goals()
        if not goals:
            raise EpisodeError(
                f"House '{self.world.house.name}' has no object of a goal category ({', '.join(GOAL_CATEGORIES)}). It "
                f"has: {self._what_it_has()}. A person can drive in it: {command('web', '--house', 'FILE')}"
            )
        return goals

    def _what_it_has(self) -> str:
        return ", ".join(self.goals() or self.world.labels.categories()) or "no labels"

    def succeeds_now(self, goal: str, x_m: float, y_m: float, floor_z_m: float) -> bool:
        """Returns whether a STOP at this place succeeds, with objects where they are now in the world."""
        return self._region_now(goal, floor_z_m).succeeds(x_m, y_m)

    def nearest_now_m(self, goal: str, x_m: float, y_m: float, floor_z_m: float) -> float | None:
        """Returns the metres in plan to the nearest instance on a storey, walls ignored, objects where they are now.

        None where the storey has no instance.
        """
        return self._region_now(goal, floor_z_m).nearest_m(x_m, y_m)

    def category_at(self, x_m: float, y_m: float, floor_z_m: float, *, goal: str, within_m: float) -> str | None:
        """Returns the category of the object at a place of a storey, at the present positions of the objects.

        Args:
            x_m: place in the world.
            y_m: place in the world.
            floor_z_m: height of the storey's floor.
            goal: the goal, which has priority, because footprints overlap: a cushion may lie on a sofa.
            within_m: largest distance in plan from the place to the footprint of the object.

        Returns:
            The goal if an instance is near enough, else the category of the nearest object; if several are equally
            near, that of the smallest. A wall, a door or a window counts only if there is no other object. None: there
            is no object.
        """
        off_m = self.nearest_now_m(goal, x_m, y_m, floor_z_m)
        if off_m is not None and off_m <= within_m:
            return goal
        world, place = self.world, np.array([[x_m, y_m]])
        candidates: list[tuple[bool, float, float, str]] = []
        for instance in world.labels.instances:
            if instance.category in _NO_OBJECTS or not self._may_be_within(instance.geom_ids, x_m, y_m, within_m):
                continue
            footprint = self._surroundings_of(floor_z_m).footprints.of(world.data, instance)
            if footprint is None or abs(footprint.floor_z_m - floor_z_m) >= self.success.same_storey_m:
                continue
            distance_m = 0.0 if footprint.contains(place)[0] else float(footprint.boundary_m.query(place)[0][0])
            if distance_m <= within_m:
                x0, y0, x1, y1 = footprint.bounds_m
                is_structure = instance.category in SIGHT_BLOCKERS
                candidates.append((is_structure, distance_m, (x1 - x0) * (y1 - y0), instance.category))
        return min(candidates)[-1] if candidates else None

    def _may_be_within(self, geoms: tuple[int, ...], x_m: float, y_m: float, within_m: float) -> bool:
        """Returns False if all bounding spheres of the geoms are farther than `within_m` from the place, in plan."""
        model, data = self.world.model, self.world.data
        radius_m = np.where(model.geom_rbound[list(geoms)] > 0.0, model.geom_rbound[list(geoms)], np.inf)
        off_m = np.hypot(*(data.geom_xpos[list(geoms), :2] - (x_m, y_m)).T)
        return bool(np.any(off_m - radius_m <= within_m))

    def _region_now(self, goal: str, floor_z_m: float) -> GoalRegion:
        """Returns the region with objects and door leaves where they are now in the world."""
        surroundings, data = self._surroundings_of(floor_z_m), self.world.data
        if moved(self._leaves, data, self._at_rest.qpos):
            height_m = floor_z_m + self._sight_height_m
            blockers = sight_blockers(self.world.model, data, self.world.labels, height_m)
            surroundings = replace(surroundings, blockers=blockers)
        elif not self._may_have_moved(goal):
            return self.target(goal, floor_z_m).region
        return self._existing(self._region(goal, floor_z_m, data, surroundings))

    def _region(
        self, goal: str, floor_z_m: float, data: mujoco.MjData, surroundings: Surroundings | None = None
    ) -> GoalRegion:
        return GoalRegion(
            data,
            self.instances(goal),
            goal,
            surroundings=surroundings or self._surroundings_of(floor_z_m),
            success=self.success,
            floor_z_m=floor_z_m,
        )

    def _surroundings_of(self, floor_z_m: float) -> Surroundings:
        world = self.world
        if floor_z_m not in self._surroundings:
            self._surroundings[floor_z_m] = Surroundings.of(
                world.model,
                self._at_rest,
                world.labels,
                sight_height_m=self._sight_height_m,
                floor_z_m=floor_z_m,
                key=world.key,
            )
        return self._surroundings[floor_z_m]

    def _key_of(self, *parts: object) -> str | None:
        """Returns the key under which a result for the state of the house file is kept."""
        world = self.world
        return world.key and key_of(world.key, self.success, self._sight_height_m, *parts)

    def _existing(self, region: GoalRegion) -> GoalRegion:
        """Returns the region; raises EpisodeError if no storey of the house has an instance."""
        if not region.exists and region.goal != NO_GOAL.text:
            raise EpisodeError(self._absent(region.goal, self._what_it_has()))
        return region

    def _absent(self, goal: str, has: str) -> str:
        return f"House '{self.world.house.name}' has no '{goal}'. It has: {has}."

    def _may_have_moved(self, goal: str) -> bool:
        """Returns whether an object that satisfies a goal is on a body that can move."""
        model = self.world.model
        geoms = [geom for instance in self.instances(goal) for geom in instance.geom_ids]
        return bool(np.any(model.body_weldid[model.geom_bodyid[geoms]] != 0))
