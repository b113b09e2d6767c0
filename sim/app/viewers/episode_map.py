"""Draws a map of the starts and goals of the episodes of a house, with one part for each storey."""

from __future__ import annotations

import math
from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.app.viewers.topview import BLOCKED, FREE, INSTANCE, OBSTACLE, PATH, ROBOT
from sim.core.vocabulary import counted, plain
from sim.episodes.episode import Episode
from sim.task.objectnav import Task

Picture = NDArray[np.uint8]
HEIGHT_PX, MARGIN_PX, TITLE_PX = 640, 16, 30
ARROW_M = 0.35
"""Length of the line from a start in the direction in which the robot looks."""
TEXT = 0.45
"""Font scale of the names of goals."""
_FONT = cv2.FONT_HERSHEY_SIMPLEX
_AROUND = ((-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1))
"""Pixels by which text is moved for its outline."""


def draw_episode_map(task: Task, episodes: Sequence[Episode]) -> Picture:
    """Returns the starts and goals of the episodes of one house, uint8 (h, w, 3) RGB.

    Args:
        task: the task in the house.
        episodes: episodes of this house; the storeys on which they start are drawn next to each other.
    """
    storeys = sorted({episode.start.floor_z_m for episode in episodes})
    tiles = [
        _draw_storey(task, [episode for episode in episodes if episode.start.floor_z_m == z_m], z_m) for z_m in storeys
    ]
    picture = np.full((TITLE_PX + HEIGHT_PX, sum(tile.shape[1] for tile in tiles), 3), 255, np.uint8)
    picture[TITLE_PX:] = np.hstack(tiles)
    colours = "starts and headings blue, goals green, obstacles dark grey, too narrow or outside beige"
    text = f"{episodes[0].house}: {counted(len(episodes), 'episode')}; {colours}"
    size = min(0.5, 0.5 * (picture.shape[1] - 2 * MARGIN_PX) / cv2.getTextSize(text, _FONT, 0.5, 1)[0][0])
    cv2.putText(picture, text, (MARGIN_PX, 20), _FONT, size, ROBOT, 1, cv2.LINE_AA)
    return picture


def _draw_storey(task: Task, episodes: Sequence[Episode], floor_z_m: float) -> Picture:
    """Returns the map of one storey, y up: the area in which the robot can be, and the goals."""
    space = task.truth.space(floor_z_m)
    goals = sorted({episode.goal for episode in episodes})
    footprints = {goal: task.truth.region(goal, floor_z_m).footprints for goal in goals}
    x, y = space.frame.axes()
    cols, rows = (np.flatnonzero(space.free.any(axis=axis)) for axis in (0, 1))
    boxes = [footprint.bounds_m for of_goal in footprints.values() for footprint in of_goal]
    corners = np.array([(x[cols[0]], y[rows[0]], x[cols[-1]], y[rows[-1]]), *boxes])  # (n, 4)
    low, high = corners[:, :2].min(axis=0) - 0.3, corners[:, 2:].max(axis=0) + 0.3
    px_m = (HEIGHT_PX - 2 * MARGIN_PX) / float(max(high - low))
    picture = np.full((HEIGHT_PX, round((high[0] - low[0]) * px_m) + 2 * MARGIN_PX, 3), BLOCKED, np.uint8)

    def at(points_m: NDArray[np.floating]) -> NDArray[np.int32]:
        """Returns the pixels (n, 2) of points (n, 2)."""
        pixels = (np.asarray(points_m) - low) * px_m
        height = HEIGHT_PX - MARGIN_PX - 0.5 * (HEIGHT_PX - 2 * MARGIN_PX - (high[1] - low[1]) * px_m)
        return np.rint(np.stack([MARGIN_PX + pixels[:, 0], height - pixels[:, 1]], axis=1)).astype(np.int32)

    corner, step = at(np.array([[x[0], y[0]]]))[0].astype(np.float64), space.frame.cell_m * px_m
    to_picture = np.array([[step, 0.0, corner[0]], [0.0, -step, corner[1]]])  # of column and row of a cell
    size = (picture.shape[1], picture.shape[0])
    free = cv2.warpAffine(space.free.astype(np.uint8), to_picture, size, flags=cv2.INTER_NEAREST)
    picture[free > 0] = FREE
    for polygon in space.obstacles:
        cv2.fillConvexPoly(picture, at(polygon.vertices_m), OBSTACLE, cv2.LINE_AA)
    for of_goal in footprints.values():
        for part in (part for footprint in of_goal for part in footprint.parts):
            cv2.fillConvexPoly(picture, at(part.vertices_m), INSTANCE, cv2.LINE_AA)
    for episode in episodes:
        pose = episode.start
        ahead = np.array([math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)]) * ARROW_M
        here = np.array([pose.x_m, pose.y_m])
        begin, end = at(np.array([here, here + ahead])).tolist()
        cv2.line(picture, begin, end, PATH, 2, cv2.LINE_AA)
        cv2.circle(picture, begin, max(3, round(0.1 * px_m)), PATH, -1, cv2.LINE_AA)
    taken: list[tuple[int, int, int, int]] = []
    for goal, of_goal in footprints.items():
        for footprint in of_goal:
            x0, y0, x1, y1 = footprint.bounds_m
            _write(picture, plain(goal), at(np.array([[0.5 * (x0 + x1), 0.5 * (y0 + y1)]]))[0], taken)
    return picture


def _write(picture: Picture, text: str, middle: NDArray[np.int32], taken: list[tuple[int, int, int, int]]) -> None:
    """Writes a text with a light outline near a pixel without overlap; leaves it out if there is no free place.

    `taken` holds left, top, right and bottom of each text so far.
    """
    (width, height), _ = cv2.getTextSize(text, _FONT, TEXT, 1)
    left_px = int(np.clip(middle[0] - width // 2, 2, max(2, picture.shape[1] - width - 2)))
    for shift in (0, 1, -1, 2, -2):
        base = int(middle[1]) + height // 2 + shift * (height + 4)
        box = (left_px - 2, base - height - 2, left_px + width + 2, base + 2)
        if not any(box[0] < t[2] and t[0] < box[2] and box[1] < t[3] and t[1] < box[3] for t in taken):
            taken.append(box)
            for dx, dy in _AROUND:  # the same glyphs: those of thicker text are wider
                cv2.putText(picture, text, (left_px + dx, base + dy), _FONT, TEXT, FREE, 1, cv2.LINE_AA)
            cv2.putText(picture, text, (left_px, base), _FONT, TEXT, ROBOT, 1, cv2.LINE_AA)
            return
