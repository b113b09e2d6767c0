"""Draws a trap of a family: parameters by difficulty and seed, a scene that can be solved, and its shortest paths.

A draw is refused, and the next one tried, where a breadth-first search over poses (`sim.world.pose_search`) finds no
route to the goal, or where the hidden obstacles do not make the path longer.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from sim.core.errors import ConfigError, HouseError
from sim.gl import mujoco
from sim.homes.housegen.traps.families.catalogue import FAMILIES
from sim.homes.housegen.traps.families.family import DIFFICULTIES, Chance, Difficulty, Parameters, Scene
from sim.homes.housegen.traps.site import TrapSite
from sim.homes.housegen.traps.trap import Trap
from sim.houses.geoms import geom_polytope
from sim.houses.house import House
from sim.houses.labels import collidable_geoms
from sim.houses.sidecar import Sidecar, TrapFacts
from sim.task.objectnav import Task
from sim.world.pose_search import PoseRoute, PoseSearch
from sim.world.world import World

MARGIN_M = 0.01
"""Clearance of the searched route in addition to the robot's radius."""
DETOUR_M = 0.15
"""The hidden obstacles make the path longer by at least this."""
MAX_ACTIONS = 200
"""Largest number of actions of the searched route; an episode has 500."""
ATTEMPTS = 40


@dataclass(frozen=True)
class FamilyTrap:
    """A trap of a family, and a route through it."""

    trap: Trap
    parameters: Parameters
    route: PoseRoute
    """The route with the fewest actions that the search found."""

    @property
    def facts(self) -> TrapFacts:
        """The sidecar's facts, which every trap of a family has."""
        assert self.trap.sidecar.trap is not None
        return self.trap.sidecar.trap


def draw_trap(family: str, difficulty: Difficulty, seed: int) -> FamilyTrap:
    """Returns a trap; the same arguments give the same one.

    Raises:
        ConfigError: the family or the difficulty is unknown.
        HouseError: no draw could be solved.
    """
    if family not in FAMILIES:
        raise ConfigError(f"Unknown family of traps '{family}'. Available: {', '.join(FAMILIES)}.")
    if difficulty not in DIFFICULTIES:
        raise ConfigError(f"Unknown difficulty '{difficulty}'. Available: {', '.join(DIFFICULTIES)}.")
    name = f"{family}_{difficulty}_{seed:02d}"
    for attempt in range(ATTEMPTS):
        parameters = FAMILIES[family].draw(Chance(family, difficulty, seed, attempt))
        made = solve(parameters, name, difficulty, seed)
        if made is not None:
            return made
    raise HouseError(f"Trap '{name}': {ATTEMPTS} draws gave no trap that can be solved and needs a detour.")


def solve(parameters: Parameters, name: str, difficulty: Difficulty, seed: int) -> FamilyTrap | None:
    """Returns the trap with these parameters; None if it has no route, or needs no detour."""
    scene = parameters.build(name, seed)
    open_m = _distance_m(scene.site.without_hidden(), scene)[1]
    task, shortest_m = _distance_m(scene.site.spec, scene)
    if shortest_m is None or open_m is None or shortest_m < open_m + DETOUR_M:
        return None
    target = task.truth.target(scene.goal)
    inner = cv2.erode(target.reached.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(np.bool_)
    route = PoseSearch(task.truth.space(), margin_m=MARGIN_M).route(scene.start, inner)
    if route is None or len(route.actions) > MAX_ACTIONS:
        return None
    length_m, count = _extent(task, scene.site)
    x0, y0, x1, y1 = (round(value, 3) for value in scene.zone_m)
    facts = TrapFacts(
        family=parameters.family, difficulty=difficulty, seed=seed, parameters=parameters.numbers(),
        gap_m=parameters.gap_m, hidden_length_m=length_m, hidden_objects=count, shortest_path_m=round(shortest_m, 3),
        open_path_m=round(open_m, 3), fewest_actions=len(route.actions),
    )  # fmt: skip
    sidecar = Sidecar(
        start=scene.start, goal=scene.goal, reason=parameters.summary, trap=facts,
        zone_m=(x0, y0, x1, y1),
    )  # fmt: skip
    return FamilyTrap(Trap(scene.site, sidecar), parameters, route)


def _distance_m(spec: mujoco.MjSpec, scene: Scene) -> tuple[Task, float | None]:
    """Returns the task of a scene, and the length of the shortest path; None if no path exists."""
    task = Task(World(House(spec.modelname, spec)))
    return task, task.distance_from(scene.goal, scene.start)


def _extent(task: Task, site: TrapSite) -> tuple[float, int]:
    """Returns the length in plan of all hidden bodies, and the number of their collision geoms; a pit is one."""
    world, solid = task.world, collidable_geoms(task.world.model)
    length_m, count = (site.pit.rect.long_m, 1) if site.pit else (0.0, 0)
    for instance in world.labels.instances:
        geoms = [geom for geom in instance.geom_ids if solid[geom]] if instance.name in site.hidden else []
        if geoms:
            corners_m = [geom_polytope(world.model, world.data, geom).vertices_m[:, :2] for geom in geoms]
            length_m += max(cv2.minAreaRect(np.concatenate(corners_m).astype(np.float32))[1])
            count += len(geoms)
    return round(float(length_m), 3), count
