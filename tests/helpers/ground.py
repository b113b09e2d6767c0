"""The input of an explorer, for tests of explorers without an agent."""

from __future__ import annotations

from sim.core.geometry.grid import GridFrame, Window
from sim.core.geometry.pose import Pose
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


def area(navmap: NavMap, x_m: tuple[float, float], y_m: tuple[float, float]) -> tuple[slice, slice]:
    """Returns the cells of a rectangle of the map."""
    (row_0, col_0), (row_1, col_1) = navmap.frame.cell(x_m[0], y_m[0]), navmap.frame.cell(x_m[1], y_m[1])
    return slice(row_0, row_1 + 1), slice(col_0, col_1 + 1)


def see(navmap: NavMap, x_m: tuple[float, float], y_m: tuple[float, float], *, wall: bool = False) -> None:
    """Marks a rectangle of the map as seen, with `wall` as an obstacle too."""
    cells = area(navmap, x_m, y_m)
    navmap.frames_in_view[cells] = 1
    navmap.seen_obstacle[cells] |= wall
    navmap.grow_known(*cells)


def corridor(x_m: tuple[float, float] = (-4.0, 4.0)) -> NavMap:
    """Returns a map of ground between walls, open at both ends, with the robot's trail in its middle."""
    navmap = NavMap.empty(GridFrame.around_start(400, 0.05))
    see(navmap, x_m, (-1.0, 1.0))
    for y_m in ((-1.1, -1.0), (1.0, 1.1)):
        see(navmap, x_m, y_m, wall=True)
    navmap.trail[navmap.frame.cell(0.0, 0.0)] = True
    return navmap
