"""Draws a trial: the trap from above with invisible geoms in colour, the robot's true path, and the agent's map."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.commands.traps.trial import Trial
from sim.env.objectnav import ObjectNavEnv
from sim.geometry.grid import GridFrame
from sim.gl import mujoco
from sim.housegen.traps.site import INVISIBLE_GROUP
from sim.houses.house import House
from sim.houses.labels import read_labels, rendered_geoms
from sim.interface import MPCAT40_ID

Picture = NDArray[np.uint8]
HEIGHT_PX = 480
FOVY_DEG = 6.0
MARGIN_M = 0.3
PATH, STOPPED, START, END = (40, 90, 220), (225, 30, 30), (20, 150, 60), (20, 20, 20)
PAPER = (245, 245, 245)
INVISIBLE = (0.2, 0.75, 0.95, 1.0)
"""Colour of geoms that cameras do not render."""


def draw_trial(env: ObjectNavEnv, trial: Trial, belief: Picture | None) -> Picture:
    """Returns the top view and, if there is a map, the map next to it, uint8 (h, w, 3)."""
    top = TopView(env.scene.world.house, env.scene.task.truth.space(env.episode.start.floor_z_m).frame)
    top.path(trial.positions_m)
    for _, contact in trial.stops:
        top.dot(contact.position_m[:2], STOPPED, 3)
    top.dot(trial.positions_m[0], START, 6)
    top.dot(trial.positions_m[-1], END, 6)
    outcome = "escaped" if trial.escaped else "stuck"
    title = f"{trial.episode_id}, {trial.agent}: {outcome}, {len(trial.motions)} steps"
    for colour, thickness in ((END, 3), (PAPER, 1)):  # mostly on the black surroundings of a scene
        cv2.putText(top.image, title, (8, 18), cv2.FONT_HERSHEY_SIMPLEX, 0.45, colour, thickness, cv2.LINE_AA)
    if belief is None:
        return top.image
    width = round(belief.shape[1] * HEIGHT_PX / belief.shape[0])
    small = np.asarray(cv2.resize(belief, (width, HEIGHT_PX), interpolation=cv2.INTER_AREA), np.uint8)
    return np.hstack([top.image, small])


class TopView:
    """A picture of a scene from above without its ceiling, on which paths and points are drawn in metres."""

    def __init__(self, house: House, frame: GridFrame) -> None:
        low_m = np.array(frame.origin_xy_m)
        size_m = np.array(frame.shape[::-1]) * frame.cell_m
        self._middle_m = low_m + 0.5 * size_m
        half_x, half_y = 0.5 * size_m + MARGIN_M
        self._px_m = HEIGHT_PX / (2.0 * half_y)
        self._width_px = 2 * round(half_x * self._px_m)
        self.image: Picture = self._render(_without_ceiling(house), half_y)

    def path(self, places_m: list[tuple[float, float]]) -> None:
        """Draws the path of the robot's centre."""
        points = np.array([self._pixel(place) for place in places_m], np.int32)
        cv2.polylines(self.image, [points.reshape(-1, 1, 2)], False, PATH, 2, cv2.LINE_AA)

    def dot(self, place_m: tuple[float, float], colour: tuple[int, int, int], radius_px: int) -> None:
        """Draws a point."""
        cv2.circle(self.image, self._pixel(place_m), radius_px, colour, -1, cv2.LINE_AA)

    def _pixel(self, place_m: tuple[float, float]) -> tuple[int, int]:
        """Returns the pixel of a point."""
        x = 0.5 * self._width_px + (place_m[0] - self._middle_m[0]) * self._px_m
        y = 0.5 * HEIGHT_PX - (place_m[1] - self._middle_m[1]) * self._px_m
        return round(x), round(y)

    def _render(self, model: mujoco.MjModel, half_y_m: float) -> Picture:
        """Renders a model from above."""
        vis = model.vis
        vis.global_.offwidth, vis.global_.offheight, vis.global_.fovy = self._width_px, HEIGHT_PX, FOVY_DEG
        model.stat.extent, vis.map.znear, vis.map.zfar = 10.0, 0.01, 10.0
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        camera = mujoco.MjvCamera()
        camera.lookat[:] = (*self._middle_m, 0.0)
        camera.distance = half_y_m / math.tan(math.radians(0.5 * FOVY_DEG))
        camera.azimuth, camera.elevation = 90.0, -90.0
        renderer = mujoco.Renderer(model, HEIGHT_PX, self._width_px)
        try:
            option = mujoco.MjvOption()
            option.sitegroup[:] = 0
            option.geomgroup[INVISIBLE_GROUP] = 1
            renderer.update_scene(data, camera, option)
            renderer.scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = False
            return np.asarray(renderer.render().copy(), np.uint8)
        finally:
            renderer.close()


def _without_ceiling(house: House) -> mujoco.MjModel:
    """Returns the scene without ceiling, with invisible geoms in `INVISIBLE`."""
    spec = house.spec.copy()
    model = spec.compile()
    labels, shown = read_labels(model, rules=house.rules, ignore_prefix=""), rendered_geoms(model)
    for geom in spec.geoms:
        if labels.geom_category[geom.id] == MPCAT40_ID["ceiling"]:
            geom.material, geom.rgba = "", (0.0, 0.0, 0.0, 0.0)
        elif not shown[geom.id]:
            geom.material, geom.rgba = "", INVISIBLE
    return spec.compile()
