"""The input of an explorer, for tests of explorers without an agent."""

from __future__ import annotations

from sim.geometry.grid import Window
from sim.geometry.pose import Pose
from stubborn.exploration.explorer import Explorer, Ground, run_explorer
from stubborn.mapping.navmap import CollisionLayer, NavMap
from stubborn.planning.avoidance import visited_ground
from stubborn.planning.planner import Planner, PlanningConfig, Route

PLANNER = Planner(PlanningConfig(), visited_ground)
START = Pose(0.0, 0.0, 0.0)
BOTH_LAYERS = (CollisionLayer.PESSIMISTIC, CollisionLayer.OPTIMISTIC)


def whole(navmap: NavMap) -> Window:
    """Returns the whole map as a window."""
    return navmap.frame.part(slice(None), slice(None))


def ground(
    navmap: NavMap,
    pose: Pose = START,
    window: Window | None = None,
    layers: tuple[CollisionLayer, ...] = BOTH_LAYERS,
    goal: str = "chair",
) -> Ground:
    """Returns the ground of a map; by default the local window is the whole map."""
    return Ground(navmap, window or whole(navmap), pose, layers, PLANNER, goal)


def route_of(explorer: Explorer, on: Ground) -> Route:
    """Returns the route that an explorer chooses; it must choose one."""
    choice = run_explorer(explorer, on)
    assert isinstance(choice, Route)
    return choice
