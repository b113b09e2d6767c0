"""Draws a trial: the trap from above with its invisible obstacles and the robot's true path, and the agent's map."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.app.commands.traps.trial import Trial
from sim.app.viewers.chase import hidden_obstacles
from sim.app.viewers.house_pictures import camera_at, render
from sim.app.viewers.text import BOLD, text_width, write
from sim.app.viewers.viewer import Colour
from sim.core.geometry.grid import GridFrame
from sim.core.interface import MPCAT40_ID
from sim.env.objectnav import ObjectNavEnv
from sim.gl import mujoco
from sim.houses.geoms import geom_polytope
from sim.houses.house import House
from sim.houses.labels import read_labels
from sim.world.world import World

Picture = NDArray[np.uint8]
HEIGHT_PX = 480
HEAD_PX, FOOT_PX = 32, 26
"""Height of the title above the scene and of the legend below it."""
FOVY_DEG = 6.0
MARGIN_M = 0.3
PATH, STOPPED, START, END = (40, 90, 220), (225, 30, 30), (20, 150, 60), (20, 20, 20)
INVISIBLE: Colour = (20, 160, 225)
"""Colour of obstacles that cameras do not render."""
LEGEND = (
    ("driven path", PATH),
    ("start", START),
    ("end", END),
    ("contact that stopped", STOPPED),
    ("invisible", INVISIBLE),
)
PAPER, INK = (245, 245, 245), (30, 30, 30)
_TINT = 0.4
_LEAN_M = (0.18, 0.30)
"""A point of an invisible obstacle is drawn this far to the right and up for each metre of its height: from exactly
above, a pane of glass would look like a line."""


def draw_trial(env: ObjectNavEnv, trial: Trial, belief: Picture | None) -> Picture:
    """Returns the top view and, if there is a map, the map next to it, uint8 (h, w, 3), between title and legend."""
    world = env.scene.world
    top = TopView(world.house, env.scene.task.truth.space(env.episode.start.floor_z_m).frame)
    top.invisible(world)
    top.path(trial.positions_m)
    for _, contact in trial.stops:
        top.dot(contact.position_m[:2], STOPPED, 4)
    top.dot(trial.positions_m[0], START, 7)
    top.dot(trial.positions_m[-1], END, 7)
    picture = top.image
    if belief is not None:
        width = round(belief.shape[1] * HEIGHT_PX / belief.shape[0])
        small = np.asarray(cv2.resize(belief, (width, HEIGHT_PX), interpolation=cv2.INTER_AREA), np.uint8)
        picture = np.hstack([picture, small])
    outcome = "escaped" if trial.escaped else "stuck"
    title = f"{trial.episode_id}, {trial.agent}: {outcome}, {len(trial.motions)} steps"
    return _framed(picture, title)


def _framed(picture: Picture, title: str) -> Picture:
    """Returns a picture with a title above it and the legend of the top view below it."""
    wide = picture.shape[1]
    head, foot = (np.full((high, wide, 3), PAPER, np.uint8) for high in (HEAD_PX, FOOT_PX))
    write(head, title, (10, 22), wide - 20, 18, INK, BOLD)
    x_px = 10
    for words, colour in LEGEND:
        cv2.circle(foot, (x_px + 6, FOOT_PX // 2), 6, colour, -1, cv2.LINE_AA)
        write(foot, words, (x_px + 18, 18), wide - x_px, 14, INK)
        x_px += 38 + text_width(words, 14)
    return np.vstack([head, picture, foot])


class TopView:
    """A picture of a scene from above without its ceiling, on which paths and points are drawn in metres."""

    def __init__(self, house: House, frame: GridFrame) -> None:
        low_m = np.array(frame.origin_xy_m)
        size_m = np.array(frame.shape[::-1]) * frame.cell_m
        self._middle_m = low_m + 0.5 * size_m
        half_x, half_y = 0.5 * size_m + MARGIN_M
        self._px_m = HEIGHT_PX / (2.0 * half_y)
        self._width_px = 2 * round(half_x * self._px_m)
        camera = camera_at(np.array([*self._middle_m, 0.0]), azimuth_deg=90.0, elevation_deg=-90.0)
        camera.distance = half_y / math.tan(math.radians(0.5 * FOVY_DEG))
        size_px = (self._width_px, HEIGHT_PX)
        self.image: Picture = render(_without_ceiling(house), camera, size_px, fovy_deg=FOVY_DEG)

    def path(self, places_m: list[tuple[float, float]]) -> None:
        """Draws the path of the robot's centre."""
        points = np.array([self._pixel(place) for place in places_m], np.int32)
        cv2.polylines(self.image, [points.reshape(-1, 1, 2)], False, PATH, 2, cv2.LINE_AA)

    def dot(self, place_m: tuple[float, float], colour: tuple[int, int, int], radius_px: int) -> None:
        """Draws a point."""
        cv2.circle(self.image, self._pixel(place_m), radius_px, colour, -1, cv2.LINE_AA)

    def invisible(self, world: World) -> None:
        """Draws obstacles that no camera renders as tinted surfaces, sheared to the right and up by their height."""
        surfaces = np.zeros(self.image.shape[:2], np.uint8)
        outlines = []
        for geom in np.flatnonzero(hidden_obstacles(world)).tolist():
            corners_m = geom_polytope(world.model, world.data, geom).vertices_m
            leaning_m = corners_m[:, :2] + corners_m[:, 2:] * _LEAN_M
            points = [self._pixel((x, y)) for x, y in leaning_m.tolist()]
            outline = cv2.convexHull(np.array(points, np.int32))
            cv2.fillConvexPoly(surfaces, outline, 1)
            outlines.append(outline)
        covered = surfaces > 0
        self.image[covered] = ((1.0 - _TINT) * self.image[covered] + _TINT * np.array(INVISIBLE)).astype(np.uint8)
        cv2.polylines(self.image, outlines, True, INVISIBLE, 2, cv2.LINE_AA)

    def _pixel(self, place_m: tuple[float, float]) -> tuple[int, int]:
        """Returns the pixel of a point."""
        x = 0.5 * self._width_px + (place_m[0] - self._middle_m[0]) * self._px_m
        y = 0.5 * HEIGHT_PX - (place_m[1] - self._middle_m[1]) * self._px_m
        return round(x), round(y)


def _without_ceiling(house: House) -> mujoco.MjModel:
    """Returns the scene without ceiling."""
    spec = house.spec.copy()
    labels = read_labels(spec.compile(), rules=house.rules, ignore_prefix="")
    for geom in spec.geoms:
        if labels.geom_category[geom.id] == MPCAT40_ID["ceiling"]:
            geom.material, geom.rgba = "", (0.0, 0.0, 0.0, 0.0)
    return spec.compile()
