"""Draws cameras whose pictures are goals: each shows one object of a house clearly, seen from another height and angle.

As in InstanceImageNav, the camera is not the robot's: it has another height, tilt and field of view. A picture is taken
where a person could stand. It must show the object about in the middle, with at least 5 % of its pixels and more than
any other object, no other object of its category with as much as a third of those, and nothing close in front of the
camera. An object that has a twin in its room, with the same name, colour and material, is not asked for: no picture
could tell the two apart.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sim.core.goals import PictureCamera
from sim.core.vocabulary import NO_OBJECTS
from sim.renderer.camera import Camera
from sim.task.meaning import HouseObject
from sim.task.objectnav import Task

_HFOV_DEG = (55.0, 65.0, 75.0, 90.0)
_HEIGHT_M = (0.8, 1.5)
_AIM = 0.12
"""The camera looks past the middle of the object by at most this share of its field of view, in each direction."""
_OFF_MIDDLE = 0.18
"""The mean of the object's pixels is at most this share of the width away from the middle of the picture."""
_MIN_SHARE, _MAX_SHARE = 0.05, 0.6
"""Share of the pixels that show the object."""
_RIVAL_SHARE = 1.0 / 3.0
"""Most pixels that show another object of its category, as a share of the object's."""
_CLOSE_M, _CLOSE_SHARE = 0.4, 0.05
"""At most this share of the pixels shows anything nearer than this."""
_DISTANCES = 0.8, 3.5
"""Least and most distance from the middle of the object, as a multiple of its size, limited to `_FARTHEST_M`."""
_FARTHEST_M = 4.0
_TRIES = 12


class GoalPictures:
    """Draws the pictures of the objects of one house.

    Args:
        task: of the house.
    """

    def __init__(self, task: Task) -> None:
        self._task, self._meaning = task, task.truth.meaning
        self._renderers: dict[float, Camera] = {}

    def close(self) -> None:
        """Frees the renderers."""
        while self._renderers:
            self._renderers.popitem()[1].close()

    def has_twin(self, item: HouseObject) -> bool:
        """Returns whether the room has another object with the same name, colour and material."""
        look = item.facts
        return any(
            other is not item and other.room is item.room and other.facts == look
            for other in self._meaning.named((item.name,))
        )

    def of(self, item: HouseObject, rng: np.random.Generator) -> PictureCamera | None:
        """Returns the camera of a picture of an object; None: none was found."""
        if self.has_twin(item):
            return None
        footprint, space = item.footprint, self._task.truth.space(item.footprint.floor_z_m)
        region = self._task.truth.region(item.instance.name, footprint.floor_z_m)
        x0, y0, x1, y1 = footprint.bounds_m
        middle = np.array([0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.5 * sum(footprint.z_m)])
        size_m = max(x1 - x0, y1 - y0, footprint.z_m[1] - footprint.z_m[0])
        places = space.frame.to_metres(np.argwhere(space.largest_part()))
        away = np.hypot(places[:, 0] - middle[0], places[:, 1] - middle[1])
        least, most = (min(factor * size_m + 0.4, _FARTHEST_M) for factor in _DISTANCES)
        places = places[(away >= least) & (away <= most)]
        rng.shuffle(places)
        places = places[: 4 * _TRIES]
        places = places[region.sees(footprint, places)] if len(places) else places
        for x_m, y_m in places[:_TRIES].tolist():
            hfov_deg = float(rng.choice(_HFOV_DEG))
            camera = _aimed(x_m, y_m, footprint.floor_z_m, middle, hfov_deg, rng)
            if self._shows(item, camera):
                return camera
        return None

    def _shows(self, item: HouseObject, camera: PictureCamera) -> bool:
        """Returns whether a picture shows an object as a goal needs."""
        images = self._renderer(camera).render(self._task.world.data, camera.pose, ("depth", "geom"))
        labels = self._task.world.labels
        objects = np.append(labels.geom_instance, np.int32(-1))[images["geom"]]
        counts = np.bincount(objects[objects >= 0], minlength=len(labels.instances))
        number = labels.instances.index(item.instance)
        own = int(counts[number])
        if not _MIN_SHARE * objects.size <= own <= _MAX_SHARE * objects.size:
            return False
        middle = np.argwhere(objects == number).mean(axis=0) / len(objects) - 0.5
        near = np.count_nonzero(images["depth"] == 0.0)
        if np.abs(middle).max() > _OFF_MIDDLE or near > _CLOSE_SHARE * objects.size:
            return False
        for other, count in zip(labels.instances, counts.tolist(), strict=True):
            most = _RIVAL_SHARE if other.category == item.instance.category else 1.0
            if other != item.instance and other.category not in NO_OBJECTS and count > most * own:
                return False
        return True

    def _renderer(self, camera: PictureCamera) -> Camera:
        """Returns the renderer for a field of view, at a quarter of the resolution."""
        if camera.hfov_rad not in self._renderers:
            side_px = camera.width_px // 4
            model = replace(camera.model, width_px=side_px, height_px=side_px, min_depth_m=_CLOSE_M)
            world = self._task.world
            self._renderers[camera.hfov_rad] = Camera(world.model, world.labels, camera=model)
        return self._renderers[camera.hfov_rad]


def _aimed(
    x_m: float, y_m: float, floor_z_m: float, middle: NDArray[np.float64], hfov_deg: float, rng: np.random.Generator
) -> PictureCamera:
    """Returns a camera at a place that looks at about the middle of an object."""
    z_m, hfov_rad = floor_z_m + float(rng.uniform(*_HEIGHT_M)), math.radians(hfov_deg)
    past_rad, under_rad = (hfov_rad * rng.uniform(-_AIM, _AIM, 2)).tolist()
    off_m = math.hypot(middle[0] - x_m, middle[1] - y_m)
    return PictureCamera(
        x_m=round(x_m, 3),
        y_m=round(y_m, 3),
        z_m=round(z_m, 3),
        yaw_rad=round(math.atan2(middle[1] - y_m, middle[0] - x_m) + past_rad, 4),
        pitch_rad=round(math.atan2(z_m - middle[2], off_m) + under_rad, 4),
        hfov_rad=round(hfov_rad, 4),
    )
