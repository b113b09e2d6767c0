"""One house ready to play in: the compiled world with the robot, its camera and the task; and a small cache of them."""

from __future__ import annotations

import contextlib
import ctypes
from collections import OrderedDict
from collections.abc import Callable

from sim.houses.house import House
from sim.interface import MAX_STEPS, CameraModel
from sim.robot.config import RobotConfig
from sim.sensors.camera import Camera
from sim.sensors.gloss import geom_gloss
from sim.task.objectnav import Task
from sim.world.world import World


class Scene:
    """World, camera and task of one house; they live and end together."""

    def __init__(
        self, house: House, *, robot: RobotConfig, camera: CameraModel, profile: str, max_steps: int = MAX_STEPS
    ) -> None:
        self.world = World(house, robot=robot)
        self.camera = Camera(self.world.model, self.world.labels, camera=camera, profile=profile)
        self.gloss = geom_gloss(self.world.model, self.world.labels)  # (ngeom,)
        self.task = Task(self.world, max_steps=max_steps)

    def close(self) -> None:
        """Free the renderer."""
        self.camera.close()


class SceneCache:
    """Keeps the scenes used last, since compiling a house and charting its free space takes most of a second.

    One by default: a run plays house by house, and a scene holds 40 to 80 MB.
    """

    def __init__(self, make: Callable[[str], Scene], *, size: int = 1) -> None:
        self._make = make
        self._size = size
        self._scenes: OrderedDict[str, Scene] = OrderedDict()

    def get(self, house: str) -> Scene:
        """The scene of that house, made if it is not there."""
        if house in self._scenes:
            self._scenes.move_to_end(house)
            return self._scenes[house]
        while len(self._scenes) >= self._size:
            self._scenes.popitem(last=False)[1].close()
            _give_back_memory()
        self._scenes[house] = self._make(house)
        return self._scenes[house]

    def close(self) -> None:
        """Free all of them."""
        while self._scenes:
            self._scenes.popitem()[1].close()


def _give_back_memory() -> None:
    """Let the C library return what a house has left behind: glibc keeps tens of megabytes, in ever smaller pieces."""
    with contextlib.suppress(OSError, AttributeError):  # another C library
        ctypes.CDLL(None).malloc_trim(0)
