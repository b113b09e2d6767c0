"""Goals of a house that a robot can reach, with view points as in Habitat's files, and those it cannot reach."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.pose import Pose
from sim.episodes import habitat
from sim.houses.house import Room
from sim.task.footprints import Footprint
from sim.task.objectnav import Task
from sim.task.success import GoalRegion
from sim.world.freespace import FreeSpace
from sim.world.storeys import storey_floors

VIEW_STEP_CELLS = 10
"""View points are this many cells of the free space apart: 0.25 m."""
MAX_VIEW_POINTS = 24
"""Largest number of view points of an instance, spread evenly over those possible."""
_DECIMALS = 3


@dataclass(frozen=True)
class HouseGoals:
    """The goals of one storey of a house."""

    listed: Mapping[str, list[habitat.Goal]]
    """For each goal category with an instance that can be reached, Habitat's goals with their view points."""
    unreachable: tuple[str, ...]
    """Names of goal instances for which no place of the free space satisfies success."""


def storeys_of(task: Task) -> tuple[float, ...]:
    """Returns the heights of the floors of a house's storeys, by its rooms, the lowest first; (0.0,) without rooms."""
    levels_m = sorted({round(room.floor_z_m, _DECIMALS) + 0.0 for room in task.world.rooms})
    return tuple(storey_floors(levels_m, task.config.success.same_storey_m)) or (0.0,)


def find_reachable_goals(
    task: Task,
    *,
    max_view_points: int = MAX_VIEW_POINTS,
    step_cells: int = VIEW_STEP_CELLS,
    floor_z_m: float = 0.0,
) -> HouseGoals:
    """Returns the goals of a storey that a robot in its largest free space can reach, and those it cannot.

    Args:
        task: of the house.
        max_view_points: most view points of an instance.
        step_cells: distance of the places that may be view points, in cells of the free space.
        floor_z_m: height of the storey's floor.
    """
    lister = GoalLister(task, max_view_points=max_view_points, step_cells=step_cells, floor_z_m=floor_z_m)
    listed: dict[str, list[habitat.Goal]] = {}
    unreachable: list[str] = []
    for goal in task.truth.goals():
        entries, missed = lister.of(goal)
        unreachable += missed
        if entries:
            listed[goal] = entries
    return HouseGoals(listed, tuple(unreachable))


class GoalLister:
    """Lists the objects of goals of one storey with their view points.

    Args:
        task: of the house.
        max_view_points: most view points of an instance.
        step_cells: distance of the places that may be view points, in cells of the free space.
        floor_z_m: height of the storey's floor.
    """

    def __init__(
        self,
        task: Task,
        *,
        max_view_points: int = MAX_VIEW_POINTS,
        step_cells: int = VIEW_STEP_CELLS,
        floor_z_m: float = 0.0,
    ) -> None:
        same_storey_m = task.config.success.same_storey_m
        self._task, self._most, self._floor_z_m = task, max_view_points, floor_z_m
        self._rooms = [room for room in task.world.rooms if abs(room.floor_z_m - floor_z_m) < same_storey_m]
        self._space = task.truth.space(floor_z_m)
        self._inside = self._space.largest_part()
        self._coarse_m = self._space.frame.to_metres(_spread(self._inside, step_cells))
        self._numbers = {instance.name: i for i, instance in enumerate(task.world.labels.instances, start=1)}

    def of(self, goal: str) -> tuple[list[habitat.Goal], list[str]]:
        """Returns Habitat's goals for the objects that satisfy a goal, and the names of those that are out of reach."""
        listed: list[habitat.Goal] = []
        unreachable: list[str] = []
        region = self._task.truth.region(goal, self._floor_z_m)
        for footprint in region.footprints:
            views = view_points(region, footprint, self._coarse_m, at_most=self._most)
            if not len(views):
                near = _near(self._space, self._inside, region, footprint)
                views = view_points(region, footprint, near, at_most=self._most)
            if len(views):
                listed.append(_to_habitat(footprint, self._numbers[footprint.instance.name], views, self._rooms))
            else:
                unreachable.append(footprint.instance.name)
        return listed, unreachable


def view_points(
    region: GoalRegion, footprint: Footprint, places_m: NDArray[np.float64], *, at_most: int = MAX_VIEW_POINTS
) -> NDArray[np.float64]:
    """Returns (n, 2) some of the places (m, 2) where a STOP succeeds for an instance."""
    places_m = places_m[footprint.near(places_m, region.distance_m)]
    places_m = places_m[region.reaches(footprint, places_m)] if len(places_m) else places_m
    if len(places_m) <= at_most:
        return places_m
    return places_m[np.linspace(0, len(places_m) - 1, at_most).round().astype(np.int64)]


def _near(space: FreeSpace, inside: NDArray[np.bool_], region: GoalRegion, footprint: Footprint) -> NDArray[np.float64]:
    """Returns (n, 2) centres of the cells of a mask around a footprint, metres."""
    rows, cols = space.frame.index_of(footprint.bounds_m, region.distance_m)
    corner = np.array([rows.start, cols.start])
    return space.frame.to_metres(np.argwhere(inside[rows, cols]) + corner)


def _spread(mask: NDArray[np.bool_], step_cells: int) -> NDArray[np.int64]:
    """Returns (n, 2) the True cells on the coarse grid of view points."""
    cells = np.argwhere(mask)
    return cells[np.all(cells % step_cells == step_cells // 2, axis=1)]


def _to_habitat(footprint: Footprint, number: int, views_m: NDArray[np.float64], rooms: Iterable[Room]) -> habitat.Goal:
    """Returns an instance as an entry of Habitat's `goals_by_category`; `number` is its place among the labels, from 1.

    That is its number in images of Habitat's semantic sensors.
    """
    x0, y0, x1, y1 = footprint.bounds_m
    x, y, z = 0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.5 * sum(footprint.z_m)
    room = next((room.name for room in rooms if room.contains(x, y)), None)
    poses = [Pose(vx, vy, float(np.arctan2(y - vy, x - vx)), footprint.floor_z_m) for vx, vy in views_m.tolist()]
    return {
        "position": _rounded(habitat.to_position(x, y, z)),
        "radius": None,
        "object_id": number,
        "object_name": footprint.instance.name,
        "object_name_id": None,
        "object_category": footprint.instance.category,
        "room_id": room,
        "room_name": room,
        "view_points": [
            {"agent_state": {"position": _rounded(s["position"]), "rotation": _rounded(s["rotation"])}, "iou": None}
            for s in map(habitat.to_agent_state, poses)
        ],
    }


def _rounded(values: Sequence[float]) -> list[float]:
    return [round(value, _DECIMALS) + 0.0 for value in values]
