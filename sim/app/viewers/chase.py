"""Renders the robot in third person: from behind and above, with everything between it and the eye cut away.

Obstacles that no camera renders, such as panes of glass, are tinted where they are in front of visible surfaces.
The near plane lies just before the robot, so that no wall or ceiling hides it, and the room ahead stays whole. What
the plane cuts through is drawn as a solid section. Colours are shaded as those of the robot's camera
(`sim.renderer.shading`).
"""

from __future__ import annotations

import itertools
import math
import weakref
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.app.viewers.viewer import Colour
from sim.core.geometry.pose import Pose
from sim.core.interface import MPCAT40_ID, CameraModel
from sim.env.scene import Scene
from sim.gl import mujoco
from sim.houses.labels import RENDERED_GROUPS, collidable_geoms, geoms_of, opacity, rendered_geoms
from sim.houses.proposals import box_around, geom_box
from sim.renderer.lamps import Lamps
from sim.renderer.occlusion import Visibility
from sim.renderer.opengl import Z_FAR_M, Z_NEAR_M, SharedContext, free_frame_buffers, make_frame_buffer
from sim.renderer.profiles import get_profile
from sim.renderer.scene import GeomScene
from sim.renderer.shading import make_shading
from sim.robot.body import PREFIX
from sim.world.world import World

BEHIND_M, ABOVE_M = 1.9, 1.95
"""Position of the eye relative to the robot's position on the floor."""
AIM_M = (0.45, 0.45)
"""The optical axis goes through the point this far ahead of the robot, at this height."""
CUT_M = 0.45
"""The near plane is at least this much nearer to the eye than the robot's axis."""
FAR_M = 9.0
"""Geoms farther from the eye than this are left out."""
HFOV_RAD = math.radians(70.0)
HIDDEN: Colour = (40, 170, 240)
"""Tint of obstacles that no camera renders."""
_TINT, _IN_FRONT_M = 0.4, 0.06
"""Weight of the tint, and the smallest distance of an invisible surface in front of the visible one."""
_COVER_M = 0.12
"""If a visible surface is within this distance of a point of an invisible geom, the point is not an invisible obstacle
but the collision geom of visible furniture."""
_INSIDE, _PANE_M = 0.8, 0.08
"""An invisible geom is part of visible furniture if at least this share of its volume is inside the box around the
visible parts of its object. The exception is a pane, which is thinner than the second number: the pane of a glass door
is inside the box around its frame."""
_AXES = np.vstack([np.eye(3), -np.eye(3)])
_SPECK_PX = 12
"""Smallest area whose outline is drawn."""
SECTION: Colour = (70, 74, 84)
"""Colour of the inside of walls and furniture that the near plane cuts through."""
_APART_M = 0.02
"""Surfaces at least this far apart are different ones."""
_NOTHING = np.float32(1.0 / Z_FAR_M)
"""Inverse depth of a pixel that shows nothing, 1 / m."""
OUTSIDE: Colour = (36, 40, 48)
"""Colour of pixels that show nothing: the outside of the house."""
_DARK, _LENS, _ARROW = (0.10, 0.12, 0.16, 1.0), (0.35, 0.75, 1.0, 1.0), (0.13, 0.35, 0.80, 1.0)
_LENS_M, _BAND_M = 0.045, 0.05
"""Radius of the lens and half the height of the band around the robot, below its top."""


class _Eye(NamedTuple):
    """Where the camera is, what it looks at, and where its image begins."""

    at_m: NDArray[np.float64]
    """(3,) optical centre."""
    axes: NDArray[np.float64]
    """(3, 3) forward, left and up as rows."""
    near_m: float
    """Distance of the near plane."""

    def inverse(self, depth: NDArray[np.float32]) -> NDArray[np.float32]:
        """Returns the inverse of the depth in 1 / m for the rows of OpenGL's depth buffer, from top to bottom."""
        return depth[::-1] * np.float32(_depth_slope(self.near_m)) + _NOTHING


class ChaseView:
    """Renders pictures of the robot in one scene.

    Args:
        scene: world of the house.
        width_px: width of the pictures.
        height_px: height of the pictures.
        finer: a picture is rendered this many times wider and higher, and reduced, so that edges are smooth.

    Raises:
        RenderError: there is no OpenGL context.
    """

    def __init__(self, scene: Scene, *, width_px: int = 400, height_px: int = 250, finer: int = 1) -> None:
        model = scene.world.model
        self._finer, width_px, height_px = finer, finer * width_px, finer * height_px
        self._world = scene.world
        self._size = CameraModel(width_px=width_px, height_px=height_px, hfov_rad=HFOV_RAD)
        self._rect = mujoco.MjrRect(0, 0, width_px, height_px)
        self._color = np.zeros((height_px, width_px, 3), np.uint8)
        self._depth = np.zeros((height_px, width_px), np.float32)
        profile = get_profile("fast")
        context = SharedContext(self._size)
        self._gl = context.gl
        with self._gl.as_current():
            self._context = make_frame_buffer(model, self._size, profile)
        self._finalizer = weakref.finalize(self, free_frame_buffers, context, {self._context}, is_own=True)
        self._finalizer.atexit = False  # OpenGL may be unloaded before the process ends
        robot = np.flatnonzero(geoms_of(model, PREFIX) & (opacity(model) > 0.0))
        visual = rendered_geoms(model)
        self._geoms = np.union1d(np.flatnonzero(visual), robot)
        self._hidden = np.flatnonzero(hidden_obstacles(scene.world))
        self._scene = GeomScene(model, unhidden=[*robot.tolist(), *self._hidden.tolist()])
        self._lamps = Lamps(model, Visibility(model, visual, self._size, Z_NEAR_M), np.flatnonzero(visual))
        self._shading = make_shading(model, self._size, profile)
        up = math.tan(0.5 * self._size.vfov_rad)
        self._slopes = (up * width_px / height_px, up)

    def render(self) -> NDArray[np.uint8]:
        """Returns the picture of the world's current state, uint8 RGB (height_px, width_px, 3)."""
        with self._gl.as_current():
            return self._render()

    def _render(self) -> NDArray[np.uint8]:
        """Returns the picture; the OpenGL context is current."""
        data, pose = self._world.data, self._world.pose
        eye_m, axes = eye_and_axes(pose)
        robot_m = np.array([pose.x_m, pose.y_m, pose.floor_z_m + 0.5 * self._world.robot.height_m])
        near_m = max(Z_NEAR_M, float((robot_m - eye_m) @ axes[0]) - max(CUT_M, self._reach_m(axes[0])))
        eye = _Eye(eye_m, axes, near_m)
        shown, hidden = (self._in_range(geoms, eye) for geoms in (self._geoms, self._hidden))
        lamps = self._lamps.choose(data, robot_m, axes[0] * np.array([1.0, 1.0, 0.0]))
        self._lamps.switch_on(lamps)
        self._fill(shown, eye)
        self._lamps.restore()
        self._mark_front()
        picture, inverse = self._drawn(eye)
        cut = self._cut(shown, eye)
        if cut.size:
            self._fill_sections(picture, inverse, cut, eye)
        if hidden.size:
            self._tint(picture, inverse, hidden, eye)
        height_px, width_px = (side // self._finer for side in picture.shape[:2])
        return cv2.resize(picture, (width_px, height_px), interpolation=cv2.INTER_AREA).astype(np.uint8, copy=False)

    def close(self) -> None:
        """Frees the renderer."""
        self._finalizer()

    def _reach_m(self, direction: NDArray) -> float:
        """Returns how far the cylinder around the robot reaches from its middle along a direction, (3,)."""
        robot = self._world.robot
        return robot.radius_m * math.hypot(direction[0], direction[1]) + 0.5 * robot.height_m * abs(float(direction[2]))

    def _in_range(self, geoms: NDArray[np.intp], eye: _Eye) -> NDArray[np.intp]:
        """Returns those of the given geoms that are near enough to be drawn and in front of the near plane."""
        model, offset = self._world.model, self._world.data.geom_xpos[geoms] - eye.at_m
        bound = np.where(model.geom_rbound > 0.0, model.geom_rbound, np.inf)[geoms]
        return geoms[(np.linalg.norm(offset, axis=1) < FAR_M + bound) & (offset @ eye.axes[0] + bound > eye.near_m)]

    def _cut(self, geoms: NDArray[np.intp], eye: _Eye) -> NDArray[np.intp]:
        """Returns those of the given geoms that the near plane may cut through; planes have no inside."""
        bound_m, offset = self._world.model.geom_rbound[geoms], self._world.data.geom_xpos[geoms] - eye.at_m
        return geoms[(bound_m > 0.0) & (np.abs(offset @ eye.axes[0] - eye.near_m) < bound_m)]

    def _fill(self, geoms: NDArray[np.intp], eye: _Eye) -> None:
        """Fills the scene with geoms."""
        self._scene.fill(self._world.data, geoms, eye.at_m, eye.axes, self._slopes, eye.near_m)

    def _fill_sections(
        self, picture: NDArray[np.uint8], inverse: NDArray[np.float32], cut: NDArray[np.intp], eye: _Eye
    ) -> None:
        """Paints the pixels that show the inside of a cut geom, except where they would hide the robot.

        Changes the picture (h, w, 3) and the inverse of its depth (h, w), 1 / m.
        """
        self._fill(cut, eye)
        self._scene.scene.nlight = 0
        self._scene.scene.flags[:] = 0  # draws faces that look away from the eye, too
        inside = self._inverse_depth(eye)
        mask = (inside > _NOTHING) & (1.0 / inside < 1.0 / inverse - _APART_M)
        rows, columns = np.nonzero(mask)
        left = self._slopes[0] * (1.0 - 2.0 * (columns + 0.5) / mask.shape[1])
        up = self._slopes[1] * (1.0 - 2.0 * (rows + 0.5) / mask.shape[0])
        rays = eye.axes[0] + left[:, None] * eye.axes[1] + up[:, None] * eye.axes[2]
        pose = self._world.pose
        away_m = (eye.at_m + rays / inverse[mask][:, None])[:, :2] - (pose.x_m, pose.y_m)
        mask[mask] = np.linalg.norm(away_m, axis=1) > self._world.robot.radius_m + _APART_M
        picture[mask], inverse[mask] = SECTION, inside[mask]

    def _inverse_depth(self, eye: _Eye) -> NDArray[np.float32]:
        """Renders the filled scene and returns the inverse of its depth (h, w) in 1 / m."""
        mujoco.mjr_restoreBuffer(self._context)
        mujoco.mjr_render(self._rect, self._scene.scene, self._context)
        mujoco.mjr_readPixels(None, self._depth, self._rect, self._context)
        return eye.inverse(self._depth)

    def _tint(
        self, picture: NDArray[np.uint8], inverse: NDArray[np.float32], hidden: NDArray[np.intp], eye: _Eye
    ) -> None:
        """Tints invisible obstacles in front of visible surfaces, and draws their edges.

        Changes the picture (h, w, 3); `inverse` (h, w) is the inverse of its depth, 1 / m.
        """
        self._fill(hidden, eye)
        for geom in self._scene.scene.geoms[: self._scene.scene.ngeom]:
            geom.rgba[3], geom.transparent = 1.0, 0  # MuJoCo writes no depth for transparent geoms
        before = self._inverse_depth(eye)
        mask = (before > _NOTHING) & (1.0 / before < 1.0 / inverse - _IN_FRONT_M)
        tint = np.array(HIDDEN, np.float32)
        picture[mask] = ((1.0 - _TINT) * picture[mask] + _TINT * tint).astype(np.uint8)
        outlines, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
        cv2.drawContours(
            picture, [outline for outline in outlines if cv2.contourArea(outline) > _SPECK_PX], -1, HIDDEN, self._finer
        )

    def _drawn(self, eye: _Eye) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        """Returns the picture of the filled scene, and the inverse of its depth (h, w) in 1 / m."""
        flags = self._scene.scene.flags
        flags[:] = 0
        flags[mujoco.mjtRndFlag.mjRND_CULL_FACE] = 1
        mujoco.mjr_restoreBuffer(self._context)
        mujoco.mjr_render(self._rect, self._scene.scene, self._context)
        mujoco.mjr_readPixels(self._color, self._depth, self._rect, self._context)
        # The shading expects the depth buffer of the robot's camera, whose near plane is another one.
        raw = self._depth * np.float32(_depth_slope(eye.near_m) / _depth_slope(Z_NEAR_M))
        picture = self._color[::-1].copy()
        if self._shading is not None:
            picture = self._shading.apply(self._color, raw, self._world.data, None, eye.at_m, eye.axes, None)
        picture[raw[::-1] <= 0.0] = OUTSIDE
        return picture, eye.inverse(self._depth)

    def _mark_front(self) -> None:
        """Adds an arrow, and a band with a lens to the default robot, which show where the robot's front is.

        They lean with the body.
        """
        robot, body = self._world.robot, self._world.body_pose
        forward, _, up = body.axes
        top_m = body.point(0.0, 0.0, robot.height_m)
        band_m = top_m - 2.2 * _BAND_M * up
        lens_m, reach = band_m + robot.radius_m * forward, 0.8 * robot.radius_m * forward
        if self._world.config.file is None:
            self._add(mujoco.mjtGeom.mjGEOM_CYLINDER, (robot.radius_m + 0.003, _BAND_M, 0.0), band_m, _DARK)
            self._add(mujoco.mjtGeom.mjGEOM_SPHERE, (_LENS_M, 0.0, 0.0), lens_m, _LENS)
        lid_m = top_m + 0.03 * up
        arrow = self._add(mujoco.mjtGeom.mjGEOM_ARROW, (0.01, 0.01, 0.01), lid_m, _ARROW)
        mujoco.mjv_connector(arrow, mujoco.mjtGeom.mjGEOM_ARROW, 0.022, lid_m - reach, lid_m + reach)

    def _add(
        self, kind: mujoco.mjtGeom, size: tuple[float, float, float], at_m: NDArray, rgba: tuple[float, ...]
    ) -> mujoco.MjvGeom:
        """Adds a geom to the filled scene that is not in the world, upright in the robot's frame, and returns it."""
        scene, turned = self._scene.scene, self._world.body_pose.axes.T.ravel()
        geom = scene.geoms[scene.ngeom]
        mujoco.mjv_initGeom(geom, kind, np.array(size), at_m, turned, np.array(rgba, np.float32))
        scene.ngeom += 1
        return geom


def hidden_obstacles(world: World) -> NDArray[np.bool_]:
    """Returns (ngeom,) True for obstacles that no camera renders; floors, ceilings and the robot do not count."""
    model, labels = world.model, world.labels
    flat = np.isin(labels.geom_category, [MPCAT40_ID["floor"], MPCAT40_ID["ceiling"]])
    hidden = collidable_geoms(model) & ~rendered_geoms(model) & (opacity(model) > 0.0) & ~flat
    hidden &= ~geoms_of(model, PREFIX)
    for geom in np.flatnonzero(hidden).tolist():
        hidden[geom] = _covered_share(world, geom) < 0.5 and not _is_inside_visible(world, geom)
    return hidden


def _is_inside_visible(world: World, geom: int) -> bool:
    """Returns whether a geom is between visible parts of its own object, like a box between the legs of a table."""
    model, data, number = world.model, world.data, int(world.labels.geom_instance[geom])
    own = world.labels.instances[number].geom_ids if number >= 0 else ()
    visible = np.intersect1d(np.array(own, np.int64), np.flatnonzero(rendered_geoms(model)))
    if not visible.size or 2.0 * model.geom_aabb[geom, 3:].min() < _PANE_M:
        return False
    low, high = box_around(model, data, visible.tolist())
    other_low, other_high = geom_box(model, data, geom)
    both = np.prod(np.maximum(np.minimum(high, other_high) - np.maximum(low, other_low), 0.0))
    return bool(both >= _INSIDE * np.prod(other_high - other_low))


def _covered_share(world: World, geom: int) -> float:
    """Returns the share of nine points across the two longest sides of a geom that are near a visible surface."""
    model, data = world.model, world.data
    middle, half = model.geom_aabb[geom, :3], model.geom_aabb[geom, 3:].copy()
    half[int(np.argmin(half))] = 0.0
    steps = np.unique(np.array(list(itertools.product((-0.6, 0.0, 0.6), repeat=3))) * half, axis=0)
    points = data.geom_xpos[geom] + (middle + steps) @ data.geom_xmat[geom].reshape(3, 3).T
    groups = np.array([group < RENDERED_GROUPS for group in range(6)], np.uint8)
    hit, far_m = np.zeros(len(_AXES), np.int32), np.zeros(len(_AXES))
    covered = 0
    for point in points:
        mujoco.mj_multiRay(model, data, point, _AXES.ravel(), groups, 1, -1, hit, far_m, None, len(_AXES), _COVER_M)
        covered += bool(np.any((hit >= 0) & (far_m <= _COVER_M)))  # the cutoff skips geoms but does not bound distances
    return covered / len(points)


def _depth_slope(near_m: float) -> float:
    """Returns by how much the inverse of the depth grows from the far plane to the near plane, 1 / m."""
    return (Z_FAR_M - near_m) / (Z_FAR_M * near_m)


def eye_and_axes(pose: Pose) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the eye behind and above a robot, (3,) in the world, and the axes (forward, left, up) as rows."""
    c, s = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
    eye_m = np.array([pose.x_m - BEHIND_M * c, pose.y_m - BEHIND_M * s, pose.floor_z_m + ABOVE_M])
    aim_m = np.array([pose.x_m + AIM_M[0] * c, pose.y_m + AIM_M[0] * s, pose.floor_z_m + AIM_M[1]])
    forward = (aim_m - eye_m) / np.linalg.norm(aim_m - eye_m)
    left_axis = np.array([-s, c, 0.0])
    return eye_m, np.stack([forward, left_axis, np.cross(forward, left_axis)])
