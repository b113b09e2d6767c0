"""Pictures of an agent's map and of its current route."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.pose import Pose
from sim.core.interface import Action, Agent
from stubborn.agent import StubbornAgent
from stubborn.drawing.canvas import BACKGROUND, ROBOT, ROOM_FOR_TEXT_PX, Canvas, Colour
from stubborn.mapping.navmap import NavMap
from stubborn.planning.planner import Route
from stubborn.planning.steering import trace

UNKNOWN: Colour = BACKGROUND
SEEN_FREE: Colour = (252, 252, 250)
SEEN_OBSTACLE: Colour = (62, 66, 77)
SWEPT: Colour = (219, 234, 250)
LARGE_MARK: Colour = (250, 196, 132)
SMALL_MARK: Colour = (232, 128, 24)
CANDIDATE: Colour = (228, 28, 130)
SET_ASIDE: Colour = (244, 160, 204)
REJECTED: Colour = (142, 104, 84)
TRAIL: Colour = (32, 84, 190)
ROUTE: Colour = (0, 158, 170)

LEGEND: tuple[tuple[str, Colour], ...] = (
    ("obstacle", SEEN_OBSTACLE),
    ("large mark", LARGE_MARK),
    ("small mark", SMALL_MARK),
    ("driven path", TRAIL),
    ("candidate", CANDIDATE),
    ("set aside", SET_ASIDE),
    ("rejected", REJECTED),
    ("route, its end", ROUTE),
)
"""Name and colour of each item; a colour that is also in the true plan has the same meaning."""
GROUND: tuple[tuple[str, Colour], ...] = (("driven over", SWEPT), ("floor seen", SEEN_FREE), ("never seen", UNKNOWN))
"""The pale colours of the ground, for legends that have space for them."""
_SMALLEST_SIDE_M, _STRIDE_M, _EDGE_M = 8.0, 2.0, 0.25


def draw_map(agent: StubbornAgent, *, size_px: int = 720) -> NDArray[np.uint8]:
    """Returns the known part of the agent's map, uint8 RGB (size_px, size_px + legend, 3); x is up, y is left."""
    pose = agent.pose or Pose(0.0, 0.0, 0.0)
    known = agent.navmap.known_window(margin_cells=10).frame
    x_m, y_m = known.mesh()
    edge_cells = min(max(known.shape), min(agent.navmap.frame.shape))
    view = agent.navmap.view(agent.navmap.frame.window_at(float(x_m.mean()), float(y_m.mean()), edge_cells))
    canvas = Canvas(paint_layers(view, agent.config.mapping.candidate_score), view.frame, size_px)
    _draw_intention(canvas, agent, pose)
    canvas.robot(pose, agent.robot.radius_m)
    caption = f"{agent.goal}, step {agent.step}"
    return np.hstack([canvas.image, _legend(size_px, caption)])


class AgentMapPainter:
    """A `sim.app.viewers.viewer.MapPainter` of the agent's map, for videos.

    The area of the picture does not move and grows in large steps. `paint` is called at each step; a new map means a
    new episode.
    """

    legend = (*LEGEND, *GROUND)
    """Name and colour of each item in the picture."""

    def __init__(self, agent: StubbornAgent) -> None:
        self.agent = agent
        self._navmap: NavMap | None = None
        self._middle_m, self._side_m = (0.0, 0.0), _SMALLEST_SIDE_M

    def paint(self, size_px: int) -> NDArray[np.uint8]:
        """Returns the current map, uint8 RGB (size_px, size_px, 3); the start's heading is up."""
        agent = self.agent
        if agent.navmap is not self._navmap:
            self._navmap, self._side_m = agent.navmap, _SMALLEST_SIDE_M
            self._middle_m = (0.0, 0.0)
        pose = agent.pose or Pose(0.0, 0.0, 0.0)
        self._grow(pose)
        cells = round(self._side_m / agent.config.cell_m)
        view = agent.navmap.view(agent.navmap.frame.window_at(*self._middle_m, cells))
        canvas = Canvas(paint_layers(view, agent.config.mapping.candidate_score), view.frame, size_px)
        _draw_intention(canvas, agent, pose)
        canvas.robot(pose, agent.robot.radius_m)
        if size_px >= ROOM_FOR_TEXT_PX:
            canvas.scale_bar()
        return canvas.image

    def words(self) -> str:
        """Returns the agent's current activity."""
        return describe_intention(self.agent)

    def _grow(self, pose: Pose) -> None:
        """Enlarges the area of the picture when the known ground, or the robot, comes near its edge."""
        low, high = _extent_xy_m(self.agent.navmap, pose)
        half_m = 0.5 * self._side_m - _EDGE_M
        if np.all(low >= np.subtract(self._middle_m, half_m)) and np.all(high <= np.add(self._middle_m, half_m)):
            return
        side_m = float((high - low).max()) + 2.0 * _EDGE_M + 0.5 * _STRIDE_M
        frame = self.agent.navmap.frame
        self._side_m = min(math.ceil(side_m / _STRIDE_M) * _STRIDE_M, min(frame.shape) * frame.cell_m)
        middle = 0.5 * (low + high)
        self._middle_m = float(middle[0]), float(middle[1])


def make_painter(agent: Agent) -> AgentMapPainter:
    """Returns a painter of the agent's map; for `AgentSpec.painter` of agents that are a `StubbornAgent`.

    Raises:
        TypeError: the agent is of another class.
    """
    if not isinstance(agent, StubbornAgent):
        raise TypeError(f"Only a StubbornAgent has a map to draw, got {type(agent).__name__}.")
    return AgentMapPainter(agent)


def describe_intention(agent: StubbornAgent) -> str:
    """Returns the agent's last decision, in a few words."""
    if agent.last_action is None:
        return "about to start"
    if agent.last_action is Action.STOP:
        return "stops, because the target is in reach"
    if agent.approach is not None:
        return "looks at a candidate" if agent.approach.route is None else "goes to a candidate"
    if agent.route is None:
        stuck = agent.untrap.active or agent.last_action is Action.MOVE_FORWARD  # forward: the map shows no path
        return "gets unstuck" if stuck else "looks around"
    return "explores the next place" if agent.route.goal.marker_xy_m is None else "explores towards a corner"


def trace_xy_m(route: Route, pose: Pose) -> NDArray[np.float64]:
    """Returns the path from the robot along the route, (n, 2) metres."""
    cells = trace(route, pose, max_cells=route.frame.shape[0] * 6)
    x_m, y_m = route.frame.centres([c[0] for c in cells], [c[1] for c in cells])
    return np.stack([x_m, y_m], axis=1)


def _extent_xy_m(navmap: NavMap, pose: Pose) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the smallest and the largest x and y of the robot and of the ground that was seen."""
    here = np.array(pose.xy_m)
    view = navmap.view(navmap.known_window(margin_cells=0))
    seen = (view.frames_in_view > 0) | view.seen_obstacle
    rows, cols = np.flatnonzero(seen.any(axis=1)), np.flatnonzero(seen.any(axis=0))
    if rows.size == 0:
        return here, here
    x_m, y_m = view.frame.centres(rows[[0, -1]], cols[[0, -1]])
    low, high = np.stack([x_m, y_m], axis=1)
    return np.minimum(low, here), np.maximum(high, here)


def _draw_intention(canvas: Canvas, agent: StubbornAgent, pose: Pose) -> None:
    """Draws the path ahead, the goal cells, and the corner or candidate that they belong to."""
    if agent.route is not None:
        goal = agent.route.goal
        canvas.outline(goal.cells, goal.free.frame, ROUTE)
        canvas.line(trace_xy_m(agent.route, pose), ROUTE)
        if goal.marker_xy_m is not None:
            canvas.cross(goal.marker_xy_m, ROUTE)
    if agent.approach is not None:
        x_m, y_m = agent.navmap.frame.centres(*agent.approach.cell)
        canvas.ring((float(x_m), float(y_m)), CANDIDATE)


def paint_layers(view: NavMap, candidate_score: float) -> NDArray[np.uint8]:
    """Returns one pixel per cell, (rows, cols, 3); later layers cover earlier ones."""
    image = np.full((*view.frame.shape, 3), UNKNOWN, np.uint8)
    target = view.score_max > candidate_score
    for mask, colour in (
        (view.frames_in_view > 0, SEEN_FREE),
        (view.visited, SWEPT),
        (view.pessimistic_marks & ~view.visited, LARGE_MARK),
        (view.optimistic_marks & ~view.visited, SMALL_MARK),
        (view.trail, TRAIL),
        (view.seen_obstacle, SEEN_OBSTACLE),
        (target, CANDIDATE),
        (target & view.set_aside, SET_ASIDE),
        (target & view.rejected, REJECTED),
    ):
        image[mask] = colour
    return image


def _legend(height_px: int, caption: str) -> NDArray[np.uint8]:
    """Returns a column with the colours and their meaning."""
    image = np.full((height_px, 190, 3), 255, np.uint8)
    cv2.putText(image, caption, (10, 24), cv2.FONT_HERSHEY_SIMPLEX, 0.48, ROBOT, 1, cv2.LINE_AA)
    for i, (name, colour) in enumerate(LEGEND):
        top = 44 + 26 * i
        cv2.rectangle(image, (10, top), (26, top + 16), colour, -1)
        cv2.putText(image, name, (36, top + 13), cv2.FONT_HERSHEY_SIMPLEX, 0.45, ROBOT, 1, cv2.LINE_AA)
    return image
