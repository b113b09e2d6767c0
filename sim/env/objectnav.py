"""The Gymnasium environment: world, camera and task in one loop."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from sim.env.scene import Scene, SceneCache
from sim.episodes.drawing import sample_episode
from sim.episodes.splits import Episode, Split, load_split, one_house
from sim.errors import EpisodeError
from sim.geometry.pose import Pose
from sim.interface import GOAL_CATEGORIES, MAX_STEPS, MPCAT40, SENSORS, Action, CameraModel, ConfigError
from sim.robot.config import RobotConfig
from sim.robot.drive import Motion
from sim.sensors.noise import NoiseConfig, SensorNoise, get_noise, noise_from_dict


class ObjectNavEnv(gymnasium.Env[Any, Any]):  # its spaces are typed by what they hold, not by what they are
    """Find an object of a category in an apartment you have not seen.

    ## Actions
    `Discrete(4)`: 0 STOP, 1 MOVE_FORWARD (0.25 m), 2 TURN_LEFT (30 deg), 3 TURN_RIGHT (30 deg). Each is a closed-loop
    motion of a wheeled robot; it ends early where the body is blocked.

    ## Observations
    | key | shape | dtype | meaning |
    |---|---|---|---|
    | rgb | (h, w, 3) | uint8 | colour |
    | depth | (h, w) | float32 | metres along the optical axis; 0: none or < 0.5 m; 5.0: 5 m or farther |
    | semantic | (h, w) | uint8 | mpcat40 id |
    | gps | (2,) | float32 | metres forward and left of the start pose |
    | compass | (1,) | float32 | yaw against the start heading, in (-pi, pi] |
    | objectgoal | (1,) | int64 | index into `sim.interface.GOAL_CATEGORIES` |

    The first three only when they are in `sensors`.

    ## Reward
    1 for a STOP that succeeds (a visible point of an instance within 1.0 m), else 0.

    ## End
    `terminated` at STOP, `truncated` after `max_steps` actions.

    ## Starting state
    `reset(seed=...)` draws an episode of the split, or a start and a goal in the house;
    `reset(options={"episode_id": ...})` takes that episode of the split, `options={"episode": Episode(...)}` any.

    ## Info
    The metrics of the task so far (`success`, `spl`, `distance_to_goal`, `collisions`, ...), `episode_id`, `house`,
    `goal`, and `collided`: true when a body contact stopped the last move.

    Args:
        split: name of a shipped split or a folder laid out like one.
        house: one MJCF file, in place of a split; episodes are then drawn in it.
        labels: label rules for a house from elsewhere.
        goal: only episodes with this goal category.
        start: with `house`, the start pose of every episode.
        sensors: image sensors in the observation.
        truth: images that are rendered besides and kept in `truth_images`, for whoever may know the truth.
        profile: rendering profile, `fast` or `good`.
        noise: of sensors and drive, a preset of `sim.sensors.noise` or a config; what counts is never noisy.
            A house whose sidecar (`sim.houses.sidecar`) fixes noise keeps that.
        render_mode: `rgb_array` or None.
        max_steps: actions until truncation.
        camera: intrinsics and mount height.
        robot: the body and how it drives.

    Raises:
        ConfigError: an unknown split, goal, sensor, profile or noise.
        HouseError: a house that breaks the house format.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 4}  # noqa: RUF012 - Gymnasium declares it so

    def __init__(
        self,
        *,
        split: str | Path = "val",
        house: str | Path | None = None,
        labels: str | Path | None = None,
        goal: str | None = None,
        start: Pose | None = None,
        sensors: Sequence[str] = SENSORS,
        truth: Sequence[str] = (),
        profile: str = "fast",
        noise: str | NoiseConfig = "none",
        render_mode: str | None = None,
        max_steps: int = MAX_STEPS,
        camera: CameraModel | None = None,
        robot: RobotConfig | None = None,
    ) -> None:
        _check_options(sensors, goal, render_mode)
        self.split: Split = load_split(split) if house is None else one_house(house, labels=labels)
        self.goal, self.start = goal, start
        self.sensors = tuple(sensors)
        self.truth_images: dict[str, NDArray] = {}
        """What was rendered last, without noise; holds `truth` and may hold more."""
        self._truth = tuple(truth)
        self.render_mode = render_mode
        self.camera_model = camera or CameraModel()
        self.robot_model = (robot or RobotConfig()).model
        self._own_noise = SensorNoise(noise if isinstance(noise, NoiseConfig) else get_noise(noise), self.camera_model)
        self._noise = self._own_noise
        self.observation_space = observation_space(self.sensors, self.camera_model)
        self.action_space = spaces.Discrete(len(Action))
        self._episodes = [episode for episode in self.split.episodes if goal in (None, episode.goal)]
        if house is None and not self._episodes:
            raise ConfigError(f"Split '{self.split.name}' has no episode with goal '{goal}'.")
        self._scenes = SceneCache(
            lambda name: Scene(
                self.split.load_house(name),
                robot=robot or RobotConfig(),
                camera=self.camera_model,
                profile=profile,
                max_steps=max_steps,
            )
        )
        self._scene: Scene | None = None
        self._episode: Episode | None = None
        self._motion: Motion | None = None

    @property
    def scene(self) -> Scene:
        """World, camera and task of the running episode; the truth, for oracles and pictures."""
        if self._scene is None:
            raise gymnasium.error.ResetNeeded("Call reset() before the first step.")
        return self._scene

    @property
    def episode(self) -> Episode:
        """The running episode."""
        if self._episode is None:
            raise gymnasium.error.ResetNeeded("Call reset() before the first step.")
        return self._episode

    @property
    def motion(self) -> Motion | None:
        """What the last action did, contacts included; None before the first."""
        return self._motion

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[dict[str, NDArray], dict[str, Any]]:
        """Start an episode; see the class."""
        super().reset(seed=seed)
        episode = self._choose(options or {})
        self._scene = None  # the last house need not stay while the next one is made
        self._scene = self._scenes.get(episode.house)
        self._noise = self._noise_in(episode.house)
        # A child of the seed takes no number from the stream that draws episodes.
        conditions = self._noise.begin(self.np_random.spawn(1)[0], self._scene.gloss)
        self._scene.world.reset(episode.start, conditions)
        self._scene.task.begin(episode.goal, episode.start)
        self._episode, self._motion = episode, None
        observation, semantic = self._look()
        self._scene.task.look(semantic)
        return observation, self._info(collided=False)

    def step(self, action: int) -> tuple[dict[str, NDArray], float, bool, bool, dict[str, Any]]:
        """Carry out one action; see the class."""
        scene = self.scene
        motion = self._motion = scene.world.move(Action(action))
        observation, semantic = self._look()
        scene.task.observe(Action(action), motion, semantic)
        reward = float(scene.task.success)
        return observation, reward, scene.task.terminated, scene.task.truncated, self._info(motion.collided)

    def draw_episode(self, rng: np.random.Generator, *, episode_id: str = "drawn") -> Episode:
        """A new episode in the one house of this environment, with its `goal` and `start` where they are fixed.

        What the environment leaves open, the sidecar of the house may fix.

        Raises:
            EpisodeError: the goal is not in the house or has no way to it, or the robot does not fit at the start.
        """
        (house,) = self.split.houses
        fixed = self.split.sidecar(house)
        goal, start = self.goal or fixed.goal, self.start or fixed.start
        return sample_episode(self._scenes.get(house), house, rng, goal=goal, start=start, episode_id=episode_id)

    def render(self) -> NDArray[np.uint8] | None:
        """What the robot's camera sees in colour, uint8 (h, w, 3), in render mode `rgb_array`."""
        if self.render_mode is None:
            return None
        world = self.scene.world
        return self.scene.camera.render(world.data, world.camera_pose, ("rgb",))["rgb"]

    def close(self) -> None:
        """Free the renderers."""
        self._scenes.close()

    def _choose(self, options: Mapping[str, Any]) -> Episode:
        if "episode" in options:
            return options["episode"]
        if "episode_id" in options:
            return self.split.episode(options["episode_id"])
        if self._episodes:
            return self._episodes[self.np_random.integers(len(self._episodes))]
        return self.draw_episode(self.np_random)

    def _noise_in(self, house: str) -> SensorNoise:
        """The noise that the house's sidecar fixes, else the environment's."""
        fixed = self.split.sidecar(house).noise
        return SensorNoise(noise_from_dict(fixed), self.camera_model) if fixed else self._own_noise

    def _look(self) -> tuple[dict[str, NDArray], NDArray[np.uint8]]:
        """The observation, and the true segmentation that the task's metrics need even where no agent sees it."""
        world, start = self.scene.world, self.episode.start
        wanted = sorted({*self.sensors, *self._truth, "semantic", *self._noise.needs(self.sensors)})
        images = self.truth_images = self.scene.camera.render(world.data, world.camera_pose, wanted)
        pose = world.pose.relative_to(start)
        observation = {name: images[name] for name in self.sensors}
        observation["gps"] = np.array([pose.x_m, pose.y_m], np.float32)
        observation["compass"] = np.array([pose.yaw_rad], np.float32)
        observation["objectgoal"] = np.array([GOAL_CATEGORIES.index(self.episode.goal)], np.int64)
        return self._noise.apply(observation, images), images["semantic"]

    def _info(self, collided: bool) -> dict[str, Any]:
        episode = self.episode
        return {
            "episode_id": episode.episode_id,
            "house": episode.house,
            "goal": episode.goal,
            "collided": collided,
            **self.scene.task.metrics(),
        }


def observation_space(sensors: Sequence[str], camera: CameraModel) -> spaces.Dict:
    """The space of observations with these image sensors."""
    shape = (camera.height_px, camera.width_px)
    limit = np.finfo(np.float32).max
    images: dict[str, spaces.Space] = {
        "rgb": spaces.Box(0, 255, (*shape, 3), np.uint8),
        "depth": spaces.Box(0.0, camera.max_depth_m, shape, np.float32),
        "semantic": spaces.Box(0, len(MPCAT40) - 1, shape, np.uint8),
    }
    return spaces.Dict(
        {name: images[name] for name in sensors}
        | {
            "gps": spaces.Box(-limit, limit, (2,), np.float32),
            "compass": spaces.Box(-np.float32(np.pi), np.float32(np.pi), (1,), np.float32),
            "objectgoal": spaces.Box(0, len(GOAL_CATEGORIES) - 1, (1,), np.int64),
        }
    )


def _check_options(sensors: Sequence[str], goal: str | None, render_mode: str | None) -> None:
    for name in sensors:
        if name not in SENSORS:
            raise ConfigError(f"Unknown sensor '{name}'. There is: {', '.join(SENSORS)}.")
    if goal is not None and goal not in GOAL_CATEGORIES:
        raise EpisodeError(f"Unknown goal '{goal}'. There is: {', '.join(GOAL_CATEGORIES)}.")
    if render_mode not in (None, "rgb_array"):
        raise ConfigError(f"Unknown render_mode '{render_mode}'. There is: rgb_array.")
