"""Poses that aim the camera at objects of rare goal categories, from near by, for training networks."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from sim.core.errors import HouseError
from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel
from sim.houses.labels import Instance, Labels, rendered_geoms
from sim.world.freespace import FreeSpace
from sim.world.world import World

RARE: Mapping[str, float] = MappingProxyType(
    {
        "stool": 4.0, "cushion": 4.0, "shower": 3.0, "bathtub": 3.0, "toilet": 3.0, "towel": 3.0, "sink": 2.0,
        "fireplace": 2.0, "seating": 2.0, "gym_equipment": 1.5, "sofa": 1.0, "chest_of_drawers": 1.0, "counter": 1.0,
    }
)  # fmt: skip
"""Goal categories with too few objects in other views, and how often they are drawn relative to each other."""
Aim = Literal["rare"]
"""At what a camera is aimed: `RARE`."""
DISTANCE_M = (1.0, 3.5)
"""Horizontal distance of the camera from the point of the object that it is aimed at."""
OFF_AXIS_RAD = 0.45
"""Largest angle between the optical axis and the direction of that point, seen from above."""
MIN_PIXELS = 100
"""Visible pixels of the object, of 640 x 480, below which a view is rejected: it may be partly hidden."""
_DRAWS = 12


def aimed_poses(
    world: World, space: FreeSpace, cells: NDArray[np.intp], rng: np.random.Generator, weights: Mapping[str, float]
) -> Iterator[tuple[Pose, dict[str, Any]]]:
    """Yields poses near objects without end: first the category is drawn, then the object, then a point of it.

    The record of a pose has `aim`: the category and the name of the instance.

    Raises:
        HouseError: the house has no object of these categories that is rendered and near a free position.
    """
    objects = _objects(world, weights)
    where_m = space.frame.to_metres(cells)  # (n, 2)
    failures = 0
    while objects and failures < 100:
        names = list(objects)
        share = np.array([weights[name] for name in names])
        category = names[int(rng.choice(len(names), p=share / share.sum()))]
        instance, geoms = objects[category][int(rng.integers(len(objects[category])))]
        x_m, y_m = world.data.geom_xpos[int(rng.choice(geoms)), :2]
        far_m = np.hypot(where_m[:, 0] - x_m, where_m[:, 1] - y_m)
        near = np.flatnonzero((far_m >= DISTANCE_M[0]) & (far_m <= DISTANCE_M[1]))
        if near.size == 0:
            failures += 1
            continue
        failures = 0
        here_x_m, here_y_m = where_m[_even_in_distance(far_m[near], rng, near)]
        yaw = math.atan2(y_m - here_y_m, x_m - here_x_m) + rng.uniform(-OFF_AXIS_RAD, OFF_AXIS_RAD)
        pose = Pose(float(here_x_m), float(here_y_m), float(yaw), space.floor_z_m)
        yield pose, {"pose_kind": "aimed", "aim": {"category": category, "instance": instance.name}}
    raise HouseError(f"House '{world.house.name}' has no object of {', '.join(weights)} near a free position.")


def shows(geom: NDArray[np.int32], labels: Labels, name: str, camera: CameraModel) -> bool:
    """Returns whether enough of an instance is visible in an image (h, w) of geoms."""
    number = next(i for i, instance in enumerate(labels.instances) if instance.name == name)
    owner = np.append(labels.geom_instance, -1)  # geom -1 takes the last
    fewest = MIN_PIXELS * camera.width_px * camera.height_px / (640 * 480)
    return bool((owner[geom] == number).sum() >= fewest)


def _objects(world: World, weights: Mapping[str, float]) -> dict[str, list[tuple[Instance, list[int]]]]:
    """Returns the objects of each category that has some, with their rendered geoms."""
    seen = rendered_geoms(world.model)
    targets: dict[str, list[tuple[Instance, list[int]]]] = {}
    for category in weights:
        for instance in world.labels.of_category(category):
            geoms = [geom for geom in instance.geom_ids if seen[geom]]
            if geoms:
                targets.setdefault(category, []).append((instance, geoms))
    return targets


def _even_in_distance(far_m: NDArray[np.float64], rng: np.random.Generator, cells: NDArray[np.intp]) -> int:
    """Returns one of the cells: the nearest in distance to one that is drawn evenly, of a few at random."""
    wanted_m = rng.uniform(*DISTANCE_M)
    some = rng.integers(len(cells), size=_DRAWS)
    return int(cells[some[np.argmin(np.abs(far_m[some] - wanted_m))]])
