"""`--view`: shows the house from above in MuJoCo's viewer while an episode runs.

The viewer gets copies of model and data, so that moving an object with the mouse changes no result. The robot's motion
is interpolated between two actions. Ceilings are put into geom group 4, which the viewer does not draw by default (key
4 shows it). Closing the window does not end the run.
"""

from __future__ import annotations

import copy
import importlib
import sys
import threading
import time
import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np

from sim.app.viewers.viewer import Moment
from sim.core.interface import MPCAT40_ID, ConfigError
from sim.core.vocabulary import in_words
from sim.env.objectnav import ObjectNavEnv
from sim.env.scene import Scene
from sim.gl import mujoco
from sim.robot.body import PREFIX, ROBOT_GROUP
from sim.task.explanations import ACTION_WORDS
from sim.task.result import RolloutResult, outcome_of

ACTION_S = 0.3
"""Display time of an action; in the simulation it takes up to two seconds."""
FRAMES_PER_S = 30
CEILING_GROUP = 4
_OPENING_S = 30.0
"""A window that is not open after this time is an error."""
_CLOSING_S = 5.0


def require_display() -> None:
    """Raises ConfigError if no window can be opened."""
    if sys.platform == "darwin":
        raise ConfigError("--view: on macOS MuJoCo's viewer needs mjpython, which this command does not use.")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # glfw warns of the error that is raised below
        import glfw  # a dependency of mujoco; searches for a window system on import

        if not glfw.init():
            raise ConfigError(
                "--view needs a display: DISPLAY and WAYLAND_DISPLAY must name a running server. "
                "--video writes a video instead."
            )


class LiveView:
    """A viewer that shows each episode in a window (`sim.app.viewers.viewer.Viewer`)."""

    def __init__(self) -> None:
        self._handle: Any = None
        self._scene: Scene | None = None
        self._closed_by_user = False

    def begin(self, env: ObjectNavEnv) -> None:
        """Opens a window for the house, unless one is open or the user has closed it."""
        self._env = env
        if self._handle is not None and not self._handle.is_running():
            self._closed_by_user = True
        if self._closed_by_user:
            return
        if env.scene is not self._scene:
            self.close()
            self._open(env.scene)
        self._before = env.scene.world.data.qpos.copy()
        self._show(self._before)

    def decided(self, moment: Moment) -> None:
        """Shows the chosen action as text."""
        if self._is_open:
            names = "Looking for\nStep\nAction\nHouse"
            goal = in_words(self._env.scene.task.goal)
            right = f"{goal}\n{moment.step}\n{ACTION_WORDS[moment.action]}\n{self._env.episode.house}"
            place = mujoco.mjtGridPos.mjGRID_TOPLEFT.value
            self._handle.set_texts((mujoco.mjtFontScale.mjFONTSCALE_100.value, place, names, right))

    def moved(self, info: Mapping[str, object]) -> None:
        """Shows the motion of the action."""
        if not self._is_open:
            return
        after = self._env.scene.world.data.qpos.copy()
        velocity = np.empty(self._model.nv)
        mujoco.mj_differentiatePos(self._model, velocity, 1.0, self._before, after)
        frames = max(1, round(ACTION_S * FRAMES_PER_S))
        for frame in range(1, frames + 1):
            qpos = self._before.copy()
            mujoco.mj_integratePos(self._model, qpos, velocity, frame / frames)
            self._show(qpos if frame < frames else after)
            time.sleep(1.0 / FRAMES_PER_S)
        self._before = after

    def end(self, result: RolloutResult) -> None:
        """Shows the outcome for a second."""
        if self._is_open:
            place = mujoco.mjtGridPos.mjGRID_TOPLEFT.value
            words = (
                mujoco.mjtFontScale.mjFONTSCALE_100.value,
                place,
                in_words(self._env.scene.task.goal),
                outcome_of(result),
            )
            self._handle.set_texts(words)
            self._handle.sync()
            time.sleep(1.0)

    def close(self) -> None:
        """Closes the window."""
        if self._handle is not None:
            self._handle.close()
            for thread in self._threads:  # it must not draw while the window system is shut down at exit
                thread.join(_CLOSING_S)
        self._handle = self._scene = None

    @property
    def _is_open(self) -> bool:
        return self._handle is not None and self._handle.is_running()

    def _open(self, scene: Scene) -> None:
        world = scene.world
        self._model, self._data = copy.copy(world.model), mujoco.MjData(world.model)
        ceiling = world.labels.geom_category == MPCAT40_ID["ceiling"]
        self._model.geom_group[ceiling] = CEILING_GROUP
        self._model.geom_group[self._model.geom_group == ROBOT_GROUP] = 0  # hidden from the sensors, but not here
        self._data.qpos[:] = world.data.qpos
        threads_before = set(threading.enumerate())
        self._handle, self._scene = _launch(self._model, self._data), scene
        self._threads = [thread for thread in threading.enumerate() if thread not in threads_before]
        with self._handle.lock():
            camera = self._handle.cam
            camera.type = mujoco.mjtCamera.mjCAMERA_TRACKING.value
            camera.trackbodyid = _robot_body(self._model)
            camera.distance, camera.elevation, camera.azimuth = 6.0, -65.0, 90.0

    def _show(self, qpos: np.ndarray) -> None:
        with self._handle.lock():
            self._data.qpos[:] = qpos
            mujoco.mj_kinematics(self._model, self._data)
            mujoco.mj_comPos(self._model, self._data)  # the point that the camera follows
            mujoco.mj_camlight(self._model, self._data)
        self._handle.sync()


def _robot_body(model: mujoco.MjModel) -> int:
    """Returns the id of the robot's root body."""
    return next(i for i in range(model.nbody) if model.body(i).name.startswith(PREFIX))


def _launch(model: mujoco.MjModel, data: mujoco.MjData) -> Any:
    """Returns the viewer's handle; unlike `launch_passive` it does not wait forever for a window that cannot open.

    Raises:
        ConfigError: the window did not open.
    """
    viewer = importlib.import_module("mujoco.viewer")
    handles: list[Any] = []
    opener = threading.Thread(
        target=lambda: handles.append(
            viewer.launch_passive(model, data, show_left_ui=False, show_right_ui=False)  # draws in its own thread
        ),
        daemon=True,
    )
    opener.start()
    opener.join(_OPENING_S)
    if not handles:
        raise ConfigError("--view: MuJoCo's viewer did not open; the display may have no OpenGL.")
    return handles[0]
