"""The frames of recorded episodes: each is run again by its recorded actions, with the robot's physics."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.app.analysis.comparison import Run
from sim.app.analysis.report.drawings import split_of
from sim.app.bridges.lerobot.features import picture_of, require_one_text, state_of
from sim.app.submissions.setting import setting_of
from sim.core.configuration import with_fields
from sim.core.errors import ConfigError, EpisodeError
from sim.core.geometry.pose import Pose
from sim.core.interface import Action
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.episodes.seeds import episode_seeds
from sim.renderer.profiles import get_profile
from sim.task.trajectory import read_trajectory, trajectory_file

MAX_OFF_M = 0.01
"""A replay whose robot is farther than this from its recorded place is not the recorded episode."""


@dataclass(frozen=True)
class Frame:
    """One moment of an episode with the action that follows."""

    rgb: NDArray[np.uint8]
    """(h, w, 3), with the noise of the run."""
    state: NDArray[np.float32]
    """See `features`."""
    action: Action
    reward: float
    """Of the action: 1 for a STOP that succeeds, else 0."""
    is_last: bool


class Replayer:
    """Replays the episodes of a run.

    Args:
        run: a run with `--record`.

    Raises:
        ConfigError: its split has changed, its robot is that of a file, or see `features.require_one_text`.
    """

    def __init__(self, run: Run) -> None:
        config = run.config
        setting = setting_of(config, where=f"'{run.path}'")
        require_one_text(split_of(run).episodes)
        house = config.get("house")
        worlds = (
            {"house": house, "labels": config.get("labels"), "root": config.get("root")}
            if house
            else {"split": run.recorded("split")}
        )
        self._run = run
        self._env = ObjectNavEnv(
            **worlds,
            sensors=("rgb",),
            profile=with_fields(get_profile("fast"), config.get("config", {}).get("profile", {})),
            robot=setting.robot,
            camera=setting.camera,
            task=setting.task,
            noise=setting.noise,
        )

    def close(self) -> None:
        """Frees the renderer."""
        self._env.close()

    def picture_shape(self, width_px: int) -> tuple[int, int]:
        """Returns rows and columns of the pictures of a dataset with this width.

        Raises:
            ConfigError: see `features.picture_of`.
        """
        camera = self._env.camera_model
        picture = picture_of(np.zeros((camera.height_px, camera.width_px, 3), np.uint8), width_px)
        return picture.shape[0], picture.shape[1]

    def frames(self, episode_id: str) -> Iterator[Frame]:
        """Yields the frames of an episode, one for each action.

        Raises:
            ConfigError: it was not recorded.
            EpisodeError: the replay does not follow the recorded path.
        """
        trajectory = read_trajectory(trajectory_file(self._run.path, episode_id))
        result, recording = self._run.results[episode_id], trajectory.about
        if recording is None:
            raise ConfigError(f"The trajectory of '{episode_id}' does not say where it began.")
        start = recording.start
        pose = Pose(start.x_m, start.y_m, start.yaw_rad, start.floor_z_m)
        episode = Episode(episode_id, result.house, result.goal, pose)
        seed = episode_seeds(result.seed, episode_id).environment
        observation, _ = self._env.reset(seed=seed, options={"episode": episode})
        for number, value in enumerate(trajectory.actions.tolist()):
            self._require_there(episode_id, number, trajectory.poses[number])
            state, rgb, action = state_of(observation), observation["rgb"], Action(value)
            observation, reward, terminated, truncated, _ = self._env.step(action)
            is_last = number + 1 == trajectory.num_steps
            if (terminated or truncated) != is_last:
                raise EpisodeError(f"The replay of '{episode_id}' ends at another step than the recorded episode.")
            yield Frame(rgb, state, action, reward, is_last)

    def _require_there(self, episode_id: str, step: int, pose: NDArray[np.float32]) -> None:
        here = self._env.scene.world.pose
        off_m = float(np.hypot(here.x_m - pose[0], here.y_m - pose[1]))
        if off_m > MAX_OFF_M:
            raise EpisodeError(
                f"The replay of '{episode_id}' is {off_m:.2f} m off the recorded path at step {step}: it was recorded "
                "with another version of the simulator, or on another kind of processor."
            )
