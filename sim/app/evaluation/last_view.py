"""The camera picture at the end of an episode: `pictures/<episode_id>.jpg` in the folder of a run."""

from __future__ import annotations

from pathlib import Path

from sim.core.files import episode_file, write_atomically
from sim.core.interface import ConfigError
from sim.core.pictures import jpeg_of
from sim.env.objectnav import ObjectNavEnv

FOLDER = "pictures"
QUALITY = 85
"""JPEG quality: 640 x 480 takes 15 to 45 KB."""


def picture_file(run: Path, episode_id: str) -> Path:
    """Returns the picture of an episode in a run."""
    return episode_file(run / FOLDER, episode_id, ".jpg")


def write_last_view(env: ObjectNavEnv, run: Path, episode_id: str) -> None:
    """Writes what the camera sees now, without noise, whatever sensors the agent has.

    Args:
        env: the environment of the episode that has just ended.
        run: folder of the run; the file goes to `pictures/` in it.
        episode_id: of the episode.

    Raises:
        ConfigError: the folder is not writable.
    """
    world = env.scene.world
    rgb = env.scene.camera.render(world.data, world.camera_pose, ("rgb",))["rgb"]
    file = picture_file(run, episode_id)
    try:
        write_atomically(file, jpeg_of(rgb, QUALITY))
    except OSError as error:
        raise ConfigError(f"Cannot write the picture '{file}': {error.strerror}.") from None
