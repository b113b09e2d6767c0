"""`--rerun` and `--rerun-save`: writes each episode as a Rerun recording (https://rerun.io), the extra `rerun`.

=========================  ====================================================================================
entity                     content, on the timeline `step`
=========================  ====================================================================================
/world/robot               true pose in the house's frame
/world/robot/camera/rgb    the colour image on its pinhole
/seen/depth, /semantic     depth and segmentation of the agent's observation, at half size
/world/points/NNN          coloured points of the depth image of step NNN, from the robot's true pose
/world/path                the robot's true path so far
/world/believed            the path according to `gps` and `compass`, with their noise
/world/contacts            contacts that stopped a motion
/map                       the agent's map, or the true floor plan where it has none
/distance_to_goal          metres, geodesic
/log                       actions, collisions, the outcome
=========================  ====================================================================================

Each episode has its file `<out>/rerun/<episode_id>.rrd`, so that a run can be resumed and use several workers.
"""

from __future__ import annotations

import importlib
import importlib.util
import math
import os
import socket
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.app.viewers.palette import PALETTE
from sim.app.viewers.topview import TopView
from sim.app.viewers.viewer import MapPainter, Moment
from sim.core.files import episode_file, part_file
from sim.core.geometry.pose import Pose
from sim.core.interface import MPCAT40, CameraModel, ConfigError
from sim.core.vocabulary import in_words
from sim.env.objectnav import ObjectNavEnv
from sim.task.explanations import ACTION_WORDS
from sim.task.result import RolloutResult, outcome_of

FOLDER = "rerun"
PORT = 9876
"""The port of Rerun's viewer."""
POINT_STRIDE_PX = 8
"""Every n-th row and column of the depth image gives points."""
IMAGE_STRIDE_PX = 2
"""Depth and segmentation are stored at half size; they are 6 times as large as the compressed colour image."""
MAP_PX = 480
_JPEG_QUALITY = 85
_IMAGES = {"rgb": "world/robot/camera/rgb", "depth": "seen/depth", "semantic": "seen/semantic"}
"""The entity of each image; images at half size cannot be children of the pinhole."""


def require_rerun(*, window: bool) -> None:
    """Raises ConfigError if Rerun is not installed, or if a window is needed and there is no display."""
    if importlib.util.find_spec("rerun") is None:
        option = "--rerun" if window else "--rerun-save"
        raise ConfigError(f"{option} needs the package rerun-sdk, an extra: pip install 'stubborn-objectnav[rerun]'.")
    display = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if window and not display and not _viewer_listens():
        raise ConfigError(
            f"--rerun needs a display, or a viewer of Rerun that listens on port {PORT}; --rerun-save writes files."
        )


def rerun_file(run: Path, episode_id: str) -> Path:
    """Returns the recording of an episode."""
    return episode_file(run / FOLDER, episode_id, ".rrd")


def points_in_world(
    depth: NDArray[np.float32], camera: CameraModel, pose: Pose, *, stride_px: int, forward_m: float = 0.0
) -> tuple[NDArray[np.float32], NDArray[np.intp], NDArray[np.intp]]:
    """Returns points (n, 3) in the world of the pixels that have a distance, and their rows and columns.

    Args:
        depth: (h, w) metres; 0 and the farthest value give no point.
        camera: the camera of the depth image.
        pose: pose of the robot.
        stride_px: only every n-th row and column is used.
        forward_m: distance of the camera in front of the robot's axis.
    """
    rows, cols = np.mgrid[stride_px // 2 : depth.shape[0] : stride_px, stride_px // 2 : depth.shape[1] : stride_px]
    d = depth[rows, cols]
    valid = (d > 0.0) & (d < camera.max_depth_m)
    rows, cols, d = rows[valid], cols[valid], d[valid]
    left_m = d * (0.5 * camera.width_px - 0.5 - cols) / camera.focal_px
    up = d * (0.5 * camera.height_px - 0.5 - rows) / camera.focal_px
    cos, sin, ahead = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad), d + forward_m
    x_m, y_m = pose.x_m + cos * ahead - sin * left_m, pose.y_m + sin * ahead + cos * left_m
    points = [x_m, y_m, pose.floor_z_m + camera.height_m + up]
    return np.stack(points, axis=1).astype(np.float32), rows, cols


class RerunLog:
    """A viewer that logs each episode as a recording of its own (`sim.app.viewers.viewer.Viewer`)."""

    def __init__(self, run: Path | None, painter: MapPainter | None = None) -> None:
        """Logs to files under `run`, or to Rerun's viewer if it is None; `painter` draws the agent's map."""
        self._rr: Any = importlib.import_module("rerun")
        self._run, self._painter = run, painter
        self._stream: Any = None
        self._part: Path | None = None

    def begin(self, env: ObjectNavEnv) -> None:
        """Starts the episode's recording."""
        self.close()
        rr, episode = self._rr, env.episode
        self._env, self._map = env, self._painter or TopView(env)
        self._believed: list[tuple[float, float, float]] = []
        self._stream = rr.RecordingStream("stubborn", recording_id=f"{episode.episode_id}-{os.getpid()}")
        if self._run is None:
            self._stream.spawn(port=PORT)
        else:
            self._part = part_file(rerun_file(self._run, episode.episode_id), what="recording")
            self._stream.save(self._part)
        self._stream.send_recording_name(f"{episode.episode_id}: {in_words(episode.goal)}")
        self._stream.send_blueprint(self._blueprint())
        self._log_static()

    def decided(self, moment: Moment) -> None:
        """Logs images, poses, map and the chosen action."""
        self._stream.set_time("step", sequence=moment.step)
        self._log_images(moment)
        self._log_poses(moment)
        self._stream.log("map", self._rr.Image(self._map.paint(MAP_PX)).compress(jpeg_quality=95))
        self._text("; ".join(filter(None, [ACTION_WORDS[moment.action], self._map.words()])))

    def moved(self, info: Mapping[str, object]) -> None:
        """Logs the outcome of the action."""
        if info["distance_to_goal"] is not None:
            self._stream.log("distance_to_goal", self._rr.Scalars(info["distance_to_goal"]))
        if info["collided"]:
            self._text("collision", level="WARN")

    def end(self, result: RolloutResult) -> None:
        """Logs the outcome of the episode and completes the file."""
        level = "INFO" if result.success == 1.0 else "ERROR"
        self._text(f"{outcome_of(result)} after {result.num_steps} steps", level=level)
        self._disconnect()
        if self._part is not None and self._run is not None:
            self._part.replace(rerun_file(self._run, self._env.episode.episode_id))
            self._part = None

    def close(self) -> None:
        """Discards the recording of an unfinished episode."""
        self._disconnect()
        if self._part is not None:
            self._part.unlink(missing_ok=True)
            self._part = None

    def _disconnect(self) -> None:
        if self._stream is not None:
            self._stream.flush()
            self._stream.disconnect()
            self._stream = None

    def _blueprint(self) -> Any:
        """Returns a layout with the house and all points so far, the images, and the map."""
        rrb = importlib.import_module("rerun.blueprint")
        return rrb.Blueprint(
            rrb.Horizontal(
                rrb.Vertical(
                    rrb.Spatial3DView(origin="world", name="house"),
                    rrb.TimeSeriesView(origin="distance_to_goal", name="distance to the goal"),
                    row_shares=[3, 1],
                ),
                rrb.Vertical(*(rrb.Spatial2DView(origin=entity, name=name) for name, entity in _IMAGES.items())),
                rrb.Vertical(
                    rrb.Spatial2DView(origin="map", name="map"), rrb.TextLogView(origin="log"), row_shares=[3, 1]
                ),
                column_shares=[3, 2, 2],
            ),
            collapse_panels=True,
        )

    def _log_static(self) -> None:
        rr, camera = self._rr, self._env.camera_model
        self._stream.log("/", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        names = [(i, in_words(name), tuple(PALETTE[i].tolist())) for i, name in enumerate(MPCAT40)]
        self._stream.log("/", rr.AnnotationContext(names), static=True)
        pinhole = rr.Pinhole(
            focal_length=camera.focal_px,
            width=camera.width_px,
            height=camera.height_px,
            camera_xyz=rr.ViewCoordinates.FLU,
            image_plane_distance=0.5,
        )
        mount = (self._env.robot_model.camera_forward_m, 0.0, camera.height_m)
        self._stream.log("world/robot/camera", rr.Transform3D(translation=mount), static=True)
        self._stream.log("world/robot/camera", pinhole, static=True)

    def _log_images(self, moment: Moment) -> None:
        rr, every = self._rr, slice(None, None, IMAGE_STRIDE_PX)
        self._stream.log(_IMAGES["rgb"], rr.Image(moment.seen("rgb")).compress(jpeg_quality=_JPEG_QUALITY))
        depth_mm = (moment.seen("depth")[every, every] * np.float32(1000.0)).astype(np.uint16)
        self._stream.log(_IMAGES["depth"], rr.DepthImage(depth_mm, meter=1000.0))
        self._stream.log(_IMAGES["semantic"], rr.SegmentationImage(moment.seen("semantic")[every, every]))

    def _log_poses(self, moment: Moment) -> None:
        """Logs poses, points and contacts in the frame of the house."""
        rr, env = self._rr, self._env
        pose, task = env.scene.world.pose, env.scene.task
        half = 0.5 * pose.yaw_rad
        here = (pose.x_m, pose.y_m, pose.floor_z_m)
        turned = rr.Quaternion(xyzw=(0.0, 0.0, math.sin(half), math.cos(half)))
        self._stream.log("world/robot", rr.Transform3D(translation=here, quaternion=turned))
        points, rows, cols = points_in_world(
            moment.seen("depth"),
            env.camera_model,
            pose,
            stride_px=POINT_STRIDE_PX,
            forward_m=env.robot_model.camera_forward_m,
        )
        self._stream.log(
            f"world/points/{moment.step:03d}", rr.Points3D(points, colors=moment.seen("rgb")[rows, cols], radii=0.01)
        )
        trajectory = task.trajectory()
        path = np.column_stack([trajectory.positions_m, trajectory.poses[:, 3] + 0.02])
        self._stream.log("world/path", rr.LineStrips3D([path], colors=[(32, 84, 190)], radii=0.015))
        start = env.episode.start
        forward_m, left_m = moment.observation["gps"].tolist()
        self._believed.append((*start.place_of(forward_m, left_m), start.floor_z_m + 0.03))
        self._stream.log("world/believed", rr.LineStrips3D([self._believed], colors=[(228, 28, 130)], radii=0.01))
        if len(trajectory.contacts):
            stops = np.column_stack([trajectory.contacts[:, 1:], np.full(len(trajectory.contacts), here[2] + 0.4)])
            self._stream.log("world/contacts", rr.Points3D(stops, colors=[(204, 42, 32)], radii=0.05))

    def _text(self, words: str, *, level: str = "INFO") -> None:
        self._stream.log("log", self._rr.TextLog(words, level=level))


def _viewer_listens() -> bool:
    try:
        with socket.create_connection(("127.0.0.1", PORT), timeout=0.5):
            return True
    except OSError:
        return False
