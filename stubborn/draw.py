"""Pictures of what an agent believes, for the README and for finding out why it failed."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.geometry.grid import GridFrame
from sim.geometry.pose import Pose
from sim.interface import Action, Agent
from stubborn.agent import StubbornAgent
from stubborn.navmap import NavMap
from stubborn.planning.planner import Plan, trace

Colour = tuple[int, int, int]

UNKNOWN: Colour = (214, 214, 214)
SEEN_FREE: Colour = (252, 252, 250)
SEEN_OBSTACLE: Colour = (62, 66, 77)
SWEPT: Colour = (219, 234, 250)
BUMPED_WIDE: Colour = (246, 178, 107)
BUMPED_NARROW: Colour = (204, 65, 37)
CANDIDATE: Colour = (56, 158, 80)
SET_ASIDE: Colour = (160, 205, 168)
REJECTED: Colour = (176, 122, 190)
TRAIL: Colour = (111, 160, 220)
PLAN: Colour = (32, 84, 190)
GOAL: Colour = (228, 28, 130)
ROBOT: Colour = (20, 20, 20)

LEGEND: tuple[tuple[str, Colour], ...] = (
    ("seen obstacle", SEEN_OBSTACLE),
    ("bumped, wide", BUMPED_WIDE),
    ("bumped, narrow", BUMPED_NARROW),
    ("visited", TRAIL),
    ("target", CANDIDATE),
    ("set aside", SET_ASIDE),
    ("rejected", REJECTED),
    ("plan", PLAN),
    ("goal", GOAL),
)
GROUND: tuple[tuple[str, Colour], ...] = (("driven over", SWEPT), ("floor seen", SEEN_FREE), ("never seen", UNKNOWN))
"""What the pale colours mean, where there is room to say so."""


def draw_belief(agent: StubbornAgent, *, size_px: int = 720, whole: bool = False) -> NDArray[np.uint8]:
    """The agent's map around the robot, uint8 RGB (size_px, size_px + legend, 3); x is up, y is left.

    `whole` shows all that is known instead of the local window.
    """
    pose = agent.pose or Pose(0.0, 0.0, 0.0)
    window = agent.navmap.frame.window_at(pose.x_m, pose.y_m, agent.config.window_cells)
    if whole:
        known = agent.navmap.known_window(margin_cells=10).frame
        x_m, y_m = known.mesh()
        edge_cells = min(max(known.shape), min(agent.navmap.frame.shape))
        window = agent.navmap.frame.window_at(float(x_m.mean()), float(y_m.mean()), edge_cells)
    view = agent.navmap.view(window)
    canvas = _Canvas(_paint_layers(view, agent.config.target.candidate_score), view.frame, size_px)
    _draw_intention(canvas, agent, pose)
    canvas.robot(pose, agent.robot.radius_m)
    caption = f"{agent.goal}, step {agent.step}"
    return np.hstack([canvas.image, _legend(size_px, caption)])


class BeliefPainter:
    """A film of what an agent believes: the picture stays where it is and grows in strides, so that it can be followed.

    Called once a step by whoever shows the map; a new episode needs no word, it is noticed by the new map.
    """

    legend = (*LEGEND, *GROUND)
    """Name and colour of all that is drawn."""

    def __init__(self, agent: StubbornAgent, *, show_plan: bool = True) -> None:
        self.agent = agent
        self.show_plan = show_plan
        """Whether the way ahead and its goal are drawn."""
        self._navmap: NavMap | None = None
        self._middle_m, self._side_m = (0.0, 0.0), _SMALLEST_SIDE_M

    def paint(self, size_px: int) -> NDArray[np.uint8]:
        """The map as it stands, uint8 RGB (size_px, size_px, 3); the start's heading is up."""
        agent = self.agent
        if agent.navmap is not self._navmap:
            self._navmap, self._side_m = agent.navmap, _SMALLEST_SIDE_M
            self._middle_m = (0.0, 0.0)
        pose = agent.pose or Pose(0.0, 0.0, 0.0)
        self._frame_all(pose)
        cells = round(self._side_m / agent.config.cell_m)
        view = agent.navmap.view(agent.navmap.frame.window_at(*self._middle_m, cells))
        canvas = _Canvas(_paint_layers(view, agent.config.target.candidate_score), view.frame, size_px)
        if self.show_plan:
            _draw_intention(canvas, agent, pose)
        canvas.robot(pose, agent.robot.radius_m)
        if size_px >= _ROOM_FOR_WORDS_PX:
            canvas.scale_bar()
        return canvas.image

    def words(self) -> str:
        """What the agent is about; "" where its plan is not shown."""
        return describe_intention(self.agent) if self.show_plan else ""

    def _frame_all(self, pose: Pose) -> None:
        """Widen the picture when what is known, or the robot, comes near its edge."""
        low, high = _extent_xy_m(self.agent.navmap, pose)
        half_m = 0.5 * self._side_m - _EDGE_M
        if np.all(low >= np.subtract(self._middle_m, half_m)) and np.all(high <= np.add(self._middle_m, half_m)):
            return
        side_m = float((high - low).max()) + 2.0 * _EDGE_M + 0.5 * _STRIDE_M
        frame = self.agent.navmap.frame
        self._side_m = min(math.ceil(side_m / _STRIDE_M) * _STRIDE_M, min(frame.shape) * frame.cell_m)
        middle = 0.5 * (low + high)
        self._middle_m = float(middle[0]), float(middle[1])


def painter_of(agent: Agent) -> BeliefPainter | None:
    """Who draws this agent's map; None for an agent that has none."""
    return BeliefPainter(agent) if isinstance(agent, StubbornAgent) else None


_SMALLEST_SIDE_M, _STRIDE_M, _EDGE_M = 8.0, 2.0, 0.25
_ROOM_FOR_WORDS_PX = 240


def _extent_xy_m(navmap: NavMap, pose: Pose) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Smallest and largest x and y of what was seen and of the robot."""
    view = navmap.view(navmap.known_window(margin_cells=0))
    seen = (view.frames_in_view > 0) | view.seen_obstacle
    rows, cols = np.flatnonzero(seen.any(axis=1)), np.flatnonzero(seen.any(axis=0))
    if rows.size == 0:
        return np.array(pose.xy_m), np.array(pose.xy_m)
    x_m, y_m = view.frame.centres(rows[[0, -1]], cols[[0, -1]])
    low, high = np.stack([x_m, y_m], axis=1)
    return np.minimum(low, pose.xy_m), np.maximum(high, pose.xy_m)


def describe_intention(agent: StubbornAgent) -> str:
    """What the agent did last, in a few words."""
    if agent.last_action is None:
        return "about to start"
    if agent.last_action is Action.STOP:
        return "stops: the target is in reach"
    if agent.approach is not None:
        return "looks at a candidate" if agent.approach.route is None else "goes to a candidate"
    if agent.route is None:
        return "gets unstuck or looks around"
    return (
        "explores: to a corner" if agent.explorer.goal_xy_m(agent.route.plan.frame) else "explores: to the next place"
    )


def trace_xy_m(plan: Plan, pose: Pose) -> NDArray[np.float64]:
    """The way from the robot down the plan, (n, 2) metres."""
    cells = trace(plan, pose, max_cells=plan.frame.shape[0] * 6)
    x_m, y_m = plan.frame.centres([c[0] for c in cells], [c[1] for c in cells])
    return np.stack([x_m, y_m], axis=1)


def _draw_intention(canvas: _Canvas, agent: StubbornAgent, pose: Pose) -> None:
    """The way ahead, the cells that would end it, and what it is for: a corner or a candidate."""
    if agent.route is not None:
        plan = agent.route.plan
        canvas.outline(plan.goal, plan.frame, GOAL)
        canvas.line(trace_xy_m(plan, pose), PLAN)
    if agent.route is not None and agent.approach is None:
        goal_xy_m = agent.explorer.goal_xy_m(agent.route.plan.frame)
        if goal_xy_m is not None:
            canvas.cross(goal_xy_m, GOAL)
    if agent.approach is not None:
        x_m, y_m = agent.navmap.frame.centres(*agent.approach.cell)
        canvas.ring((float(x_m), float(y_m)), CANDIDATE)


def _paint_layers(view: NavMap, candidate_score: float) -> NDArray[np.uint8]:
    """One pixel a cell, (rows, cols, 3); later layers cover earlier ones."""
    image = np.full((*view.frame.shape, 3), UNKNOWN, np.uint8)
    target = view.score_max > candidate_score
    for mask, colour in (
        (view.frames_in_view > 0, SEEN_FREE),
        (view.visited, SWEPT),
        (view.bumped_wide & ~view.visited, BUMPED_WIDE),
        (view.bumped_narrow & ~view.visited, BUMPED_NARROW),
        (view.trail, TRAIL),
        (view.seen_obstacle, SEEN_OBSTACLE),
        (target, CANDIDATE),
        (target & view.set_aside, SET_ASIDE),
        (target & view.rejected, REJECTED),
    ):
        image[mask] = colour
    return image


class _Canvas:
    """The enlarged picture; takes world metres. Image up is +x, image left is +y."""

    def __init__(self, cells: NDArray[np.uint8], frame: GridFrame, size_px: int) -> None:
        self.frame, self.scale = frame, size_px / max(frame.shape)
        turned = np.ascontiguousarray(cells.transpose(1, 0, 2)[::-1, ::-1])
        size = (round(frame.shape[0] * self.scale), round(frame.shape[1] * self.scale))
        way = cv2.INTER_NEAREST if self.scale >= 1.0 else cv2.INTER_AREA  # shrunk, a wall of one cell must not be lost
        enlarged = cv2.resize(turned, size, interpolation=way)
        self.image = np.full((size_px, size_px, 3), UNKNOWN, np.uint8)
        self.image[: size[1], : size[0]] = enlarged
        self.mark_px = min(12, max(3, size_px // 36))
        """Half the size of a mark."""
        self.width_px = 2 if size_px >= _ROOM_FOR_WORDS_PX else 1

    def pixel(self, x_m: float, y_m: float) -> tuple[int, int]:
        """(u, v) of a world point."""
        frame = self.frame
        u_cells = frame.shape[0] - (y_m - frame.origin_xy_m[1]) / frame.cell_m
        v_cells = frame.shape[1] - (x_m - frame.origin_xy_m[0]) / frame.cell_m
        return round(u_cells * self.scale), round(v_cells * self.scale)

    def line(self, points_xy_m: NDArray[np.float64], colour: Colour) -> None:
        points = np.array([self.pixel(float(x), float(y)) for x, y in points_xy_m], np.int32)
        cv2.polylines(self.image, [points.reshape(-1, 1, 2)], False, colour, self.width_px, cv2.LINE_AA)

    def cross(self, xy_m: tuple[float, float], colour: Colour) -> None:
        """A place; one beyond the picture is marked at its edge."""
        edge_px, width_px = 3 * self.mark_px // 2, 2 * self.width_px - 1
        place = self._held_inside(xy_m)
        cv2.drawMarker(self.image, place, colour, cv2.MARKER_CROSS, edge_px, width_px, cv2.LINE_AA)

    def ring(self, xy_m: tuple[float, float], colour: Colour) -> None:
        cv2.circle(self.image, self._held_inside(xy_m), self.mark_px - 1, colour, self.width_px, cv2.LINE_AA)

    def scale_bar(self) -> None:
        """One metre, in the lower left corner."""
        bottom, metre_px = self.image.shape[0] - 10, round(self.scale / self.frame.cell_m)
        cv2.line(self.image, (10, bottom), (10 + metre_px, bottom), ROBOT, 2)
        cv2.putText(self.image, "1 m", (10, bottom - 6), cv2.FONT_HERSHEY_SIMPLEX, 0.45, ROBOT, 1, cv2.LINE_AA)

    def _held_inside(self, xy_m: tuple[float, float]) -> tuple[int, int]:
        u, v = self.pixel(*xy_m)
        edge_px = self.image.shape[0] - 1 - self.mark_px
        return min(max(u, self.mark_px), edge_px), min(max(v, self.mark_px), edge_px)

    def outline(self, mask: NDArray[np.bool_], frame: GridFrame, colour: Colour) -> None:
        contours, _ = cv2.findContours(mask.view(np.uint8).copy(), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        for contour in contours:
            cols_rows = contour.reshape(-1, 2)
            x_m, y_m = frame.centres(cols_rows[:, 1], cols_rows[:, 0])
            points = np.array([self.pixel(float(x), float(y)) for x, y in zip(x_m, y_m, strict=True)], np.int32)
            cv2.polylines(self.image, [points.reshape(-1, 1, 2)], True, colour, 1, cv2.LINE_AA)

    def robot(self, pose: Pose, radius_m: float) -> None:
        small_px = max(1, self.image.shape[0] // 110)
        radius_px = max(small_px, round(radius_m / self.frame.cell_m * self.scale))
        middle, rim_px = self.pixel(pose.x_m, pose.y_m), self.width_px
        cv2.circle(self.image, middle, radius_px, (255, 255, 255), -1, cv2.LINE_AA)
        cv2.circle(self.image, middle, radius_px, ROBOT, rim_px, cv2.LINE_AA)
        ahead = self.pixel(*pose.ahead(max(2.0 * radius_m, 4.0 * small_px * self.frame.cell_m / self.scale)))
        cv2.arrowedLine(self.image, middle, ahead, ROBOT, rim_px, cv2.LINE_AA, tipLength=0.35)


def _legend(height_px: int, caption: str) -> NDArray[np.uint8]:
    """The column that says which colour means what."""
    image = np.full((height_px, 190, 3), 255, np.uint8)
    cv2.putText(image, caption, (10, 24), cv2.FONT_HERSHEY_SIMPLEX, 0.48, ROBOT, 1, cv2.LINE_AA)
    for i, (name, colour) in enumerate(LEGEND):
        top = 44 + 26 * i
        cv2.rectangle(image, (10, top), (26, top + 16), colour, -1)
        cv2.putText(image, name, (36, top + 13), cv2.FONT_HERSHEY_SIMPLEX, 0.45, ROBOT, 1, cv2.LINE_AA)
    return image
