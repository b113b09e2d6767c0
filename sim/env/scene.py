"""Scenes: the compiled world of one house with the robot, its camera and the task; and a small cache of them."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Mapping
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sim.core.goals import GoalSpec, PictureCamera
from sim.core.interface import CameraModel, ConfigError
from sim.env.memory import return_freed_memory
from sim.houses.house import House
from sim.renderer.camera import Camera
from sim.renderer.gloss import geom_gloss
from sim.renderer.mounted import MountedCameras
from sim.renderer.opengl import SharedContext
from sim.renderer.profiles import RenderProfile
from sim.robot.config import RobotConfig
from sim.task.config import TaskConfig
from sim.task.objectnav import Task
from sim.task.result import Limit
from sim.world.world import World


class Scene:
    """World, camera and task of one house."""

    def __init__(
        self,
        house: House,
        *,
        robot: RobotConfig,
        camera: CameraModel,
        profile: str | RenderProfile,
        task: TaskConfig | None = None,
        steps_per_action: int = 1,
        limit: Limit = "max_steps",
        shared: SharedContext | None = None,
    ) -> None:
        """`shared` is the OpenGL context of several scenes; each of them has one of its own by default."""
        config = task or TaskConfig()
        self.notes = house.notes
        """See `House.notes`."""
        self.world = World(house, robot=robot, rule=config.success)
        self.world.camera_height_m = camera.height_m
        self.camera = Camera(self.world.model, self.world.labels, camera=camera, profile=profile, shared=shared)
        self.mounted = MountedCameras(self.world.model, self.world.labels, profile=profile, shared=shared)
        """Renders further cameras."""
        self.gloss = geom_gloss(self.world.model, self.world.labels)  # (ngeom,)
        self.task = Task(self.world, config, camera=camera, steps_per_action=steps_per_action, limit=limit)
        self._profile, self._shared = profile, shared
        self._pictures: dict[PictureCamera, Mapping[str, NDArray]] = {}

    def picture_of(self, goal: GoalSpec, image: Literal["rgb", "semantic"] = "rgb") -> NDArray[np.uint8] | None:
        """Returns the picture of a goal, uint8 (h, w, 3), or its true categories (h, w); None: it has no picture.

        A picture is rendered once, with the rendering profile of the robot's camera; call this after `World.reset`.
        """
        if goal.camera is None:
            return None
        if goal.camera not in self._pictures:
            world = self.world
            camera = Camera(
                world.model, world.labels, camera=goal.camera.model, profile=self._profile, shared=self._shared
            )
            self._pictures[goal.camera] = camera.render(world.data, goal.camera.pose, ("rgb", "semantic"))
            camera.close()
        return self._pictures[goal.camera][image]

    def close(self) -> None:
        """Frees the renderers."""
        self.camera.close()
        self.mounted.close()


class SceneCache:
    """A cache of the scenes used last; another scene takes 0.1 s, or most of a second if its house was never seen.

    It holds one scene by default, because a run goes house by house and a scene takes 40 to 90 MB.

    Args:
        make: makes the scene of a house.
        size: number of scenes that are kept.

    Raises:
        ConfigError: the size is less than 1.
    """

    def __init__(self, make: Callable[[str], Scene], *, size: int = 1) -> None:
        if not isinstance(size, int) or size < 1:
            raise ConfigError(f"cached_houses must be a whole number from 1 on, got {size!r}.")
        self._make = make
        self._size = size
        self._scenes: OrderedDict[str, Scene] = OrderedDict()

    def get(self, house: str) -> Scene:
        """Returns the scene of a house; it is made if it is not in the cache."""
        if house in self._scenes:
            self._scenes.move_to_end(house)
            return self._scenes[house]
        while len(self._scenes) >= self._size:
            self._scenes.popitem(last=False)[1].close()
            return_freed_memory()
        self._scenes[house] = self._make(house)
        return self._scenes[house]

    def close(self) -> None:
        """Frees all scenes."""
        while self._scenes:
            self._scenes.popitem()[1].close()
