"""Demonstrations for imitation: small camera images at each pose of an episode, with the actions.

One npz file holds one episode. No pickle; an action with images of 64 x 48 pixels takes about 0.6 KB.
"""

from __future__ import annotations

import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import msgspec
import numpy as np
from jaxtyping import Float32, UInt8, UInt16
from numpy.typing import NDArray

from sim.core.files import write_atomically
from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES, MOVES, MPCAT40, ConfigError
from sim.core.reading import Name, parse_json, read_npz, reason_of
from sim.renderer.camera import Camera
from sim.world.world import World

FORMAT = 1
"""Version of the file format; it is increased when the arrays change their meaning."""
MAX_FILE_BYTES = 256 << 20
_ARRAYS = {"depth_mm": (np.uint16, 3), "semantic": (np.uint8, 3), "poses": (np.float32, 2), "actions": (np.uint8, 1)}
"""Dtype and number of axes of each array."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Demonstration:
    """An episode of n actions; index i of an array is the moment before action i."""

    depth_mm: UInt16[np.ndarray, "n h w"]
    """`Observation["depth"]` in millimetres."""
    semantic: UInt8[np.ndarray, "n h w"]
    """True mpcat40 ids."""
    poses: Float32[np.ndarray, "n 3"]
    """Metres forward and left of the start pose, and yaw against its heading: `gps` and `compass` without noise."""
    actions: UInt8[np.ndarray, " n"]
    """Values of `sim.core.interface.Action`."""
    goal: str
    """Goal category."""
    house: str
    success: bool


class _About(msgspec.Struct):
    """The JSON in `about`."""

    format: Annotated[int, msgspec.Meta(ge=FORMAT, le=FORMAT)]
    goal: Name
    house: Name
    success: bool


def demonstrate(
    poses: Sequence[Pose], actions: Sequence[int], world: World, camera: Camera, *, goal: str, house: str, success: bool
) -> Demonstration:
    """Renders the camera's views at the poses of an episode; nothing moves, and the sensors have no noise.

    Args:
        poses: the robot's pose in the world before each action.
        actions: values of `Action`, at least one.
        world: the house; it is reset to the state of its file.
        camera: of the world's model; its size is that of the images.
        goal: goal category of the episode.
        house: name of the house.
        success: whether the episode succeeded.

    Raises:
        ConfigError: `poses` is empty, because the episode has no action.
        EpisodeError: the robot does not fit where the episode starts.
    """
    if not poses:
        raise ConfigError("A demonstration needs at least one action, and this episode has none.")
    world.reset(poses[0])
    images = []
    for pose in poses:
        eye = Pose(*pose.ahead(world.config.camera_forward_m), pose.yaw_rad, pose.floor_z_m)
        images.append(camera.render(world.data, eye, ("depth", "semantic")))
    relative = [pose.relative_to(poses[0]) for pose in poses]
    return Demonstration(
        depth_mm=np.rint(1000.0 * np.array([image["depth"] for image in images])).astype(np.uint16),
        semantic=np.array([image["semantic"] for image in images]),
        poses=np.array([(pose.x_m, pose.y_m, pose.yaw_rad) for pose in relative], np.float32),
        actions=np.array(actions, np.uint8),
        goal=goal,
        house=house,
        success=success,
    )


def write_demonstration(file: Path, shown: Demonstration) -> None:
    """Writes one file, completely or not at all.

    Raises:
        ConfigError: it cannot be written.
    """
    about = {"format": FORMAT, "goal": shown.goal, "house": shown.house, "success": shown.success}
    content = io.BytesIO()
    np.savez_compressed(
        content,
        depth_mm=shown.depth_mm,
        semantic=shown.semantic,
        poses=shown.poses,
        actions=shown.actions,
        about=np.frombuffer(json.dumps(about).encode(), np.uint8),
    )
    try:
        write_atomically(file, content.getvalue())
    except OSError as error:
        raise ConfigError(f"Cannot write the demonstration '{file}': {error.strerror}.") from None


def read_demonstration(file: Path) -> Demonstration:
    """Returns the demonstration in a file.

    Raises:
        ConfigError: the file does not exist, or it is not a demonstration.
    """
    arrays = read_npz(file, (*_ARRAYS, "about"), what="demonstration", most_bytes=MAX_FILE_BYTES)
    try:
        about = parse_json(arrays.pop("about").tobytes(), _About, where="its header 'about'")
        _check(arrays, about.goal)
    except ValueError as error:
        raise ConfigError(f"'{file}' is not a demonstration: {reason_of(error)}.") from None
    return Demonstration(**arrays, goal=about.goal, house=about.house, success=about.success)


def list_demonstrations(folders: Sequence[Path]) -> list[Path]:
    """Returns the files of demonstrations in some folders and the folders in them, each once.

    Raises:
        ConfigError: a folder has no demonstration.
    """
    demonstrations: list[Path] = []
    for folder in folders:
        files = sorted(file.resolve() for file in folder.rglob("*.npz"))
        if not files:
            raise ConfigError(
                f"No demonstration in '{folder}': `python -m tools.training.render_demonstrations` "
                "of the repository writes them."
            )
        demonstrations += files
    return list(dict.fromkeys(demonstrations))


def _check(arrays: Mapping[str, NDArray[Any]], goal: str) -> None:
    """Raises ValueError if the arrays do not fit each other, or hold numbers without meaning."""
    count = len(arrays["actions"]) if arrays["actions"].ndim else 0
    for name, (kind, axes) in _ARRAYS.items():
        array = arrays[name]
        if array.dtype != kind or array.ndim != axes or len(array) != count:
            raise ValueError(f"{name} is {array.dtype} {array.shape} for {count} actions")
    if count == 0:
        raise ValueError("it has no action")
    if arrays["depth_mm"].shape != arrays["semantic"].shape or arrays["poses"].shape[1:] != (3,):
        raise ValueError(f"the images are {arrays['depth_mm'].shape} and {arrays['semantic'].shape}")
    if goal not in GOAL_CATEGORIES:
        raise ValueError(f"{goal!r} is not a goal category")
    if np.any(arrays["actions"] >= len(MOVES)) or np.any(arrays["semantic"] >= len(MPCAT40)):
        raise ValueError("an action or a category is out of range")
    if not np.isfinite(arrays["poses"]).all():
        raise ValueError("a pose is not finite")
