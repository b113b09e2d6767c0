"""An agent with a map, in 127 lines. docs/tutorials/first_agent.md explains how it was built from a random one."""

from __future__ import annotations

from collections import deque

import cv2
import numpy as np

from sim import Action, AgentSpec, CameraModel, Observation, Segmenter

CELL_M, CELLS = 0.05, 1200  # a map of 60 x 60 m, with the start in the middle


class MapAgent:
    """Drives to the nearest unseen floor, and to the goal as soon as the map shows it."""

    def __init__(self, camera: CameraModel, segmenter: Segmenter) -> None:
        self.camera, self.segmenter = camera, segmenter

    def reset(self, goal: str, seed: int) -> None:
        """Forgets the map of the previous episode."""
        self.anchor, self.idle = np.zeros(2), 0
        self.goal, self.before, self.action, self.aim = goal, np.zeros(2), Action.TURN_LEFT, None
        self.obstacle, self.felt, self.seen, self.found = np.zeros((4, CELLS, CELLS), np.uint8)
        cv2.circle(self.seen, (CELLS // 2, CELLS // 2), round(1.5 / CELL_M), 1, -1)  # the camera cannot see this floor

    def act(self, observation: Observation) -> Action:
        """Updates the map, then stops, or takes one step along the path."""
        place, yaw = observation["gps"], float(observation["compass"][0])
        self._see(observation, place, yaw)
        ahead = np.array([np.cos(yaw), np.sin(yaw)])
        if self.action is Action.MOVE_FORWARD and np.hypot(*(place - self.before)) < 0.15:
            cv2.circle(self.felt, cell(place + 0.3 * ahead), 2, 1, -1)  # something that the depth does not show
        self.before = place
        cv2.circle(self.seen, cell(place), round(0.5 / CELL_M), 1, -1)  # nor the floor below the robot
        self.idle = 0 if np.hypot(*(place - self.anchor)) > 0.5 else self.idle + 1
        self.anchor = place if self.idle == 0 else self.anchor
        if self.idle > 20 and self.aim:  # it gives the aim up
            cv2.circle(self.seen, self.aim, round(0.5 / CELL_M), 1, -1)
            self.idle, self.aim = 1, None
        rows, cols = np.nonzero(self.found)
        if np.any(np.hypot(cols - cell(place)[0], rows - cell(place)[1]) * CELL_M < 0.8):
            return Action.STOP
        step = self._next(place)
        if step is None:  # the marks of collisions may be wrong
            self.felt[:], self.action = 0, Action.TURN_LEFT
            return self.action
        x, y = (step - place) @ np.array([[ahead[0], -ahead[1]], [ahead[1], ahead[0]]])
        turn = Action.TURN_LEFT if y >= 0.0 else Action.TURN_RIGHT
        self.action = Action.MOVE_FORWARD if abs(np.arctan2(y, x)) < 0.3 else turn
        return self.action

    def _see(self, observation: Observation, place: np.ndarray, yaw: float) -> None:
        """Enters what the camera shows into the map."""
        depth = observation["depth"]
        x, y, height = points(depth, self.camera, place, yaw)
        target = cv2.resize(self.segmenter.scores(observation, self.goal).target, depth.shape[::-1]) > 0.5
        target = cv2.erode(target.astype(np.uint8), np.ones((9, 9))) > 0  # the rim may be background
        valid = (depth > 0.0) & (depth < self.camera.max_depth_m)
        body = (height > 0.15) & (height < 0.9) & (depth < 3.0)
        for layer, shown in ((self.obstacle, body), (self.seen, height < 0.9), (self.found, target)):
            col, row = cell(np.stack([x[valid & shown], y[valid & shown]]))
            layer[row, col] = 1

    def _next(self, place: np.ndarray) -> np.ndarray | None:
        """Returns a point 0.4 m along the shortest path to the goal or to the nearest unseen place; None: no path."""
        unseen = cv2.erode(1 - self.seen, np.ones((9, 9)))
        disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (29, 29))  # of 0.7 m: everywhere in it the agent stops
        wanted = cv2.dilate(self.found, disc) if self.found.any() else unseen
        if self.aim and unseen[self.aim[1], self.aim[0]] and not self.found.any():
            wanted = np.zeros_like(unseen)  # it keeps its aim: two equally near places would turn it back and forth
            wanted[self.aim[1], self.aim[0]] = 1
        for margin_m in (0.2, 0.1):  # rather not through narrow gaps
            width = 2 * round(margin_m / CELL_M) + 1
            blocked = cv2.dilate(
                self.obstacle | self.felt, cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (width, width))
            )
            cv2.circle(blocked, cell(place), 4, 0, -1)  # the robot stands here, so it can leave
            blocked[[0, -1]], blocked[:, [0, -1]] = 1, 1  # the search stays in the map
            path = shortest_path(cell(place), wanted, blocked)
            if path:
                self.aim = path[-1]
                return (np.array(path[:8][-1]) - CELLS // 2) * CELL_M
        self.aim = None
        return None


def points(depth: np.ndarray, camera: CameraModel, place: np.ndarray, yaw: float) -> np.ndarray:
    """Returns x and y relative to the start, and the height above the floor, of each pixel (3, h, w), in metres."""
    v, u = np.mgrid[0 : depth.shape[0], 0 : depth.shape[1]]
    left = -(u - 0.5 * depth.shape[1]) / camera.focal_px * depth
    height = camera.height_m - (v - 0.5 * depth.shape[0]) / camera.focal_px * depth
    x = place[0] + np.cos(yaw) * depth - np.sin(yaw) * left
    y = place[1] + np.sin(yaw) * depth + np.cos(yaw) * left
    return np.stack([x, y, height])


def shortest_path(start: tuple, wanted: np.ndarray, blocked: np.ndarray) -> list[tuple]:
    """Returns the cells (column, row) to the nearest wanted cell, by breadth-first search; []: there is no path."""
    came_from, queue = {start: start}, deque([start])
    while queue:
        at = queue.popleft()
        if wanted[at[1], at[0]] and at != start:
            path = [at]
            while came_from[path[-1]] != start:
                path.append(came_from[path[-1]])
            return path[::-1]
        for dx, dy in ((1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)):
            to = at[0] + dx, at[1] + dy
            if to not in came_from and not blocked[to[1], to[0]]:
                came_from[to] = at
                queue.append(to)
    return []


def cell(place: np.ndarray) -> tuple:
    """Returns column and row of a place, or of several places (2, n), in metres; the nearest ones of the map."""
    return tuple(np.clip(np.round(place / CELL_M).astype(int) + CELLS // 2, 0, CELLS - 1))


def make(*, camera: CameraModel, segmenter: Segmenter, **others: object) -> MapAgent:
    """Returns the agent; `others` are the parts of `AgentFactory` that it does not use."""
    return MapAgent(camera, segmenter)


AGENT = AgentSpec(make=make, description="goes to the nearest unseen floor", sensors=("depth",))
