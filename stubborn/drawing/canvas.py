"""Enlarges a picture of a grid and draws on it in world metres. Image up is +x, image left is +y."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose

Colour = tuple[int, int, int]

BACKGROUND: Colour = (214, 214, 214)
ROBOT: Colour = (20, 20, 20)
ROOM_FOR_TEXT_PX = 240
"""A picture of at least this size has text and thicker lines."""


class Canvas:
    """A picture of a grid; all positions are in world metres."""

    def __init__(self, cells: NDArray[np.uint8], frame: GridFrame, size_px: int) -> None:
        """Enlarges an image with one pixel per cell, (rows, cols, 3), to `size_px` pixels at its longer edge."""
        self.frame, self.scale = frame, size_px / max(frame.shape)
        turned = np.ascontiguousarray(cells.transpose(1, 0, 2)[::-1, ::-1])
        size = (round(frame.shape[0] * self.scale), round(frame.shape[1] * self.scale))
        method = cv2.INTER_NEAREST if self.scale >= 1.0 else cv2.INTER_AREA  # a wall of one cell must not disappear
        enlarged = cv2.resize(turned, size, interpolation=method)
        self.image = np.full((size_px, size_px, 3), BACKGROUND, np.uint8)
        self.image[: size[1], : size[0]] = enlarged
        self.mark_px = min(12, max(3, size_px // 36))
        """Half the size of a mark."""
        self.width_px = 2 if size_px >= ROOM_FOR_TEXT_PX else 1

    def pixel(self, x_m: float, y_m: float) -> tuple[int, int]:
        """Returns the pixel (u, v) of a point."""
        frame = self.frame
        u_cells = frame.shape[0] - (y_m - frame.origin_xy_m[1]) / frame.cell_m
        v_cells = frame.shape[1] - (x_m - frame.origin_xy_m[0]) / frame.cell_m
        return round(u_cells * self.scale), round(v_cells * self.scale)

    def line(self, points_xy_m: NDArray[np.float64], colour: Colour) -> None:
        """Draws a line through points (n, 2)."""
        points = np.array([self.pixel(float(x), float(y)) for x, y in points_xy_m], np.int32)
        cv2.polylines(self.image, [points.reshape(-1, 1, 2)], False, colour, self.width_px, cv2.LINE_AA)

    def cross(self, xy_m: tuple[float, float], colour: Colour) -> None:
        """Draws a cross; a cross beyond the picture is drawn at its edge."""
        edge_px, width_px = 3 * self.mark_px // 2, 2 * self.width_px - 1
        place = self._pixel_inside(xy_m)
        cv2.drawMarker(self.image, place, colour, cv2.MARKER_CROSS, edge_px, width_px, cv2.LINE_AA)

    def ring(self, xy_m: tuple[float, float], colour: Colour) -> None:
        """Draws a ring; a ring beyond the picture is drawn at its edge."""
        cv2.circle(self.image, self._pixel_inside(xy_m), self.mark_px - 1, colour, self.width_px, cv2.LINE_AA)

    def scale_bar(self) -> None:
        """Draws a bar of one metre in the lower left corner."""
        bottom, metre_px = self.image.shape[0] - 10, round(self.scale / self.frame.cell_m)
        cv2.line(self.image, (10, bottom), (10 + metre_px, bottom), ROBOT, 2)
        cv2.putText(self.image, "1 m", (10, bottom - 6), cv2.FONT_HERSHEY_SIMPLEX, 0.45, ROBOT, 1, cv2.LINE_AA)

    def _pixel_inside(self, xy_m: tuple[float, float]) -> tuple[int, int]:
        u, v = self.pixel(*xy_m)
        edge_px = self.image.shape[0] - 1 - self.mark_px
        return min(max(u, self.mark_px), edge_px), min(max(v, self.mark_px), edge_px)

    def outline(self, mask: NDArray[np.bool_], frame: GridFrame, colour: Colour) -> None:
        """Draws the outline of the cells of a mask over another grid."""
        contours, _ = cv2.findContours(mask.view(np.uint8).copy(), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        for contour in contours:
            cols_rows = contour.reshape(-1, 2)
            x_m, y_m = frame.centres(cols_rows[:, 1], cols_rows[:, 0])
            points = np.array([self.pixel(float(x), float(y)) for x, y in zip(x_m, y_m, strict=True)], np.int32)
            cv2.polylines(self.image, [points.reshape(-1, 1, 2)], True, colour, 1, cv2.LINE_AA)

    def robot(self, pose: Pose, radius_m: float) -> None:
        """Draws the robot and its heading."""
        small_px = max(1, self.image.shape[0] // 110)
        radius_px = max(small_px, round(radius_m / self.frame.cell_m * self.scale))
        middle, rim_px = self.pixel(pose.x_m, pose.y_m), self.width_px
        cv2.circle(self.image, middle, radius_px, (255, 255, 255), -1, cv2.LINE_AA)
        cv2.circle(self.image, middle, radius_px, ROBOT, rim_px, cv2.LINE_AA)
        ahead = self.pixel(*pose.ahead(max(2.0 * radius_m, 4.0 * small_px * self.frame.cell_m / self.scale)))
        cv2.arrowedLine(self.image, middle, ahead, ROBOT, rim_px, cv2.LINE_AA, tipLength=0.35)
