"""The pictures that a model is shown: the map and camera views, with numbers at the places to choose from."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.files import write_atomically
from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel
from sim.core.pictures import jpeg_of
from stubborn.agent import StubbornAgent
from stubborn.drawing.canvas import Canvas
from stubborn.drawing.map_painter import paint_layers

MAP_PX = 640
NUMBER: tuple[int, int, int] = (200, 20, 110)
"""Colour of the discs behind numbers, and of outlines."""
MAX_VIEWS = 60
"""Views that are remembered: the latest ones that differ."""
MIN_MOVE_M, MIN_TURN_RAD = 0.5, math.radians(25.0)
"""A view is remembered if the robot moved or turned by this since the last one."""
LABEL_M = 0.3
"""Height above the floor at which a number is drawn."""
MIN_AHEAD_M, IN_FRONT_M = 0.6, 0.5
"""A place is in view if it is at least this far ahead, and no surface is nearer than it by more than this."""


def map_picture(agent: StubbornAgent, places_xy_m: NDArray[np.float64], pose: Pose) -> NDArray[np.uint8]:
    """Returns the known part of the agent's map with numbered places, (640, 640, 3); the start's heading is up."""
    known = agent.navmap.known_window(margin_cells=6)
    view = agent.navmap.view(known)
    canvas = Canvas(paint_layers(view, agent.config.mapping.candidate_score), view.frame, MAP_PX)
    canvas.robot(pose, agent.robot.radius_m)
    canvas.scale_bar()
    for number, (x_m, y_m) in enumerate(places_xy_m.tolist(), start=1):
        _draw_number(canvas.image, canvas.pixel(x_m, y_m), number)
    return canvas.image


@dataclass(frozen=True)
class _View:
    pose: Pose
    rgb: NDArray[np.uint8]
    horizon_m: NDArray[np.float32]
    """(w,) distance along the optical axis of the surface at the camera's height in each column; 0: unknown."""


class Views:
    """The views of an episode in which places can be marked.

    Args:
        camera: of the views.
        forward_m: the camera is mounted this far ahead of the robot's axis.
    """

    def __init__(self, camera: CameraModel, forward_m: float) -> None:
        self._camera, self._forward_m = camera, forward_m
        self.forget()

    def forget(self) -> None:
        """Starts a new episode."""
        self._views: list[_View] = []

    def add(self, pose: Pose, rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> None:
        """Remembers a view if it differs from the last one; otherwise it takes its place.

        Args:
            pose: of the robot.
            rgb: (h, w, 3).
            depth: (h, w) metres.
        """
        eye = Pose(*pose.ahead(self._forward_m), pose.yaw_rad)
        view = _View(eye, rgb, depth[depth.shape[0] // 2])
        if len(self._views) > 1:
            before = self._views[-2].pose
            turned_rad = abs(math.remainder(eye.yaw_rad - before.yaw_rad, math.tau))
            if eye.distance_to(before) < MIN_MOVE_M and turned_rad < MIN_TURN_RAD:
                self._views.pop()
        self._views = [*self._views[1 - MAX_VIEWS :], view]

    def with_numbers(self, places_xy_m: NDArray[np.float64]) -> tuple[list[NDArray[np.uint8]], list[int]]:
        """Returns views with numbered places, and the index of the view of each place, -1: it is in none.

        Args:
            places_xy_m: (n, 2) metres.
        """
        pictures, shown, view_of = list[NDArray[np.uint8]](), dict[int, int](), list[int]()
        for number, (x_m, y_m) in enumerate(places_xy_m.tolist(), start=1):
            pixels = [self._pixel(view, x_m, y_m) for view in self._views]
            seen = [(place[1], index, place[0]) for index, place in enumerate(pixels) if place is not None]
            if not seen:
                view_of.append(-1)
                continue
            _, index, pixel = min(seen)
            if index not in shown:
                shown[index] = len(pictures)
                pictures.append(self._views[index].rgb.copy())
            _draw_number(pictures[shown[index]], pixel, number)
            view_of.append(shown[index])
        return pictures, view_of

    def _pixel(self, view: _View, x_m: float, y_m: float) -> tuple[tuple[int, int], float] | None:
        """Returns the pixel (u, v) of a place in a view and its distance ahead in metres; None: it is not in view."""
        camera, place = self._camera, Pose(x_m, y_m, 0.0).relative_to(view.pose)
        if place.x_m < MIN_AHEAD_M:
            return None
        u = round(0.5 * camera.width_px - camera.focal_px * place.y_m / place.x_m)
        v = round(0.5 * camera.height_px + camera.focal_px * (camera.height_m - LABEL_M) / place.x_m)
        margin = camera.width_px // 40
        if not (margin <= u < camera.width_px - margin and v < 2 * camera.height_px):
            return None
        surface_m = float(view.horizon_m[u])
        if 0.0 < surface_m < min(place.x_m, camera.max_depth_m) - IN_FRONT_M:
            return None
        return (u, min(v, camera.height_px - camera.height_px // 12)), place.x_m


def outlined(rgb: NDArray[np.uint8], mask: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """Returns a view with the outline of a mask over it.

    Args:
        rgb: (h, w, 3).
        mask: at a whole fraction of its size.
    """
    whole = cv2.resize(mask.astype(np.uint8), (rgb.shape[1], rgb.shape[0]), interpolation=cv2.INTER_NEAREST)
    contours, _ = cv2.findContours(whole, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    return np.asarray(cv2.drawContours(rgb.copy(), contours, -1, NUMBER, max(1, rgb.shape[1] // 213)), np.uint8)


def directions(places_xy_m: NDArray[np.float64], pose: Pose, views: Sequence[int] | None) -> str:
    """Returns a line for each place: its number, distance and direction, and whether a view shows it."""
    lines = []
    for number, (x_m, y_m) in enumerate(places_xy_m.tolist(), start=1):
        place = Pose(x_m, y_m, 0.0).relative_to(pose)
        degrees = round(math.degrees(math.atan2(place.y_m, place.x_m)))
        side = "ahead" if abs(degrees) < 3 else f"{abs(degrees)} degrees to the {'left' if degrees > 0 else 'right'}"
        shown = ""
        if views is not None:
            shown = ", in no view" if views[number - 1] < 0 else f", in view {views[number - 1] + 1}"
        lines.append(f"{number}: {math.hypot(place.x_m, place.y_m):.1f} m away, {side}{shown}")
    return "\n".join(lines)


def write_transcript(folder: Path, name: str, text: str, pictures: Sequence[NDArray[np.uint8]]) -> None:
    """Writes a question and its reply as NAME.txt, and its pictures as NAME_1.jpg and so on.

    A goal in words may come from a file: characters of the name other than letters and digits become `_`.
    """
    name = re.sub(r"\W", "_", name)
    folder.mkdir(parents=True, exist_ok=True)
    write_atomically(folder / f"{name}.txt", text)
    for number, picture in enumerate(pictures, start=1):
        write_atomically(folder / f"{name}_{number}.jpg", jpeg(picture))


def jpeg(picture: NDArray[np.uint8]) -> bytes:
    """Returns an RGB picture (h, w, 3) as the JPEG that a model gets."""
    return jpeg_of(picture, 90)


def _draw_number(image: NDArray[np.uint8], pixel: tuple[int, int], number: int) -> None:
    """Draws a number on a disc."""
    radius = max(5, image.shape[1] // 50)
    cv2.circle(image, pixel, radius, NUMBER, -1, cv2.LINE_AA)
    cv2.circle(image, pixel, radius, (255, 255, 255), max(1, radius // 6), cv2.LINE_AA)
    text, scale = str(number), radius / 18
    (wide, high), _ = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, scale, 2)
    corner = pixel[0] - wide // 2, pixel[1] + high // 2
    cv2.putText(image, text, corner, cv2.FONT_HERSHEY_SIMPLEX, scale, (255, 255, 255), 2, cv2.LINE_AA)
