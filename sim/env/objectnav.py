"""The Gymnasium environment: world, sensors and task in one loop."""

from __future__ import annotations

import reprlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from sim.core.configuration import as_settings
from sim.core.errors import HouseError
from sim.core.geometry.pose import Pose
from sim.core.interface import (
    MOVES,
    SENSORS,
    Action,
    CameraModel,
    ConfigError,
    RobotModel,
    SuccessRule,
    require_action,
)
from sim.core.wishes import require_goal
from sim.env.chosen_split import chosen_split
from sim.env.scene import Scene, SceneCache
from sim.episodes.drawing import sample_drive, sample_episode
from sim.episodes.episode import Episode, require_start
from sim.episodes.splits import Split
from sim.renderer.mounted import CameraConfig
from sim.renderer.opengl import SharedContext
from sim.renderer.profiles import RenderProfile, get_profile
from sim.robot.config import RobotConfig
from sim.robot.drive import Motion
from sim.sensors.cameras import cameras_of, with_cameras
from sim.sensors.noise import NoiseConfig, SensorNoise, noise_from_dict
from sim.sensors.scan import ScanConfig, ScanSensor
from sim.sensors.sensor import Sensor, SensorContext, declared_fields
from sim.sensors.standard import STANDARD_SENSORS, resolve_sensors
from sim.task.config import TaskConfig
from sim.task.result import Limit

_ASKED = frozenset(("goal", "picture"))
"""The fields of `SensorContext` that change with the goal of a chain."""
StepResult = tuple[dict[str, NDArray], float, bool, bool, dict[str, Any]]
"""Observation, reward, terminated, truncated and info of a step, as Gymnasium declares them."""


class ObjectNavEnv(gymnasium.Env[Any, Any]):  # the observation is a dict of arrays, which `spaces.Dict` does not type
    """Find an object of a category in an apartment that the agent has not seen before.

    ## Actions
    `Discrete(4)`: 0 STOP, 1 MOVE_FORWARD (0.25 m), 2 TURN_LEFT (30 deg), 3 TURN_RIGHT (30 deg). Each is a closed-loop
    motion of a wheeled robot; it ends early if the body is blocked.

    ## Observations
    A dict with one array for each sensor: those in `sensors`, and always `gps`, `compass` and `objectgoal`. Shapes,
    dtypes and units are in `sim.core.interface.Observation`.

    ## Reward
    1 for a STOP that succeeds (a visible point of an instance within 1.0 m, see `SuccessRule`), else 0.

    ## End
    `terminated` at STOP and when the robot drives over an edge (`end_reason` is `fallen`), `truncated` after
    `max_steps` actions.

    ## Starting state
    `reset(seed=...)` samples an episode of the split, or a start and a goal in the house;
    `reset(options={"episode_id": ...})` takes that episode of the split, and `options={"episode": Episode(...)}` takes
    any other.

    ## Info
    The metrics of the task so far (`success`, `spl`, `distance_to_goal`, `collisions`, ...), `episode_id`, `house`,
    `goal`, and `collided`: true if a body contact stopped the last move.

    ## Chains
    In an episode with several goals a STOP, or `max_steps` actions, ends a goal, and the next one begins where the
    robot is; `gps` and `compass` still refer to the start of the episode. `terminated` and `truncated` come with the
    end of the last goal, and `terminated` with a fall. Each STOP that succeeds is rewarded by 1. The metrics in `info`
    are those of the present goal; `goal_number` counts goals from 0. After the action that ended a goal `ended_goal`
    has its metrics, and at the end `chain` has those of the chain (`sim.task.chain`) with those of all `goals`.

    Args:
        split: name of a shipped split, or a folder with the same layout.
        house: one MJCF file instead of a split; episodes are then sampled in it.
        houses: only the episodes of these houses of the split, by name; or several MJCF files instead of a split.
        labels: label rules for a house with other names.
        root: another folder whose files the house may use, in addition to its own folder.
        goal: only episodes with this goal: a category, or words (docs/words.md).
        start: with `house`, the start pose of every episode.
        sensors: sensors in the observation: names of `sim.sensors.standard`, or objects with the interface
            `sim.sensors.sensor.Sensor`.
        truth: further images, rendered and kept in `truth_images`, for users of the ground truth.
        profile: rendering profile: `fast`, `good`, an object, or a dict of the fields that differ from `fast`.
        noise: noise of sensors and drive: the name of a preset of `sim.sensors.noise`, a `NoiseConfig`, or a dict, such
            as `{"preset": "realsense", "pose": {"gps_std_m": 0.1}}`. The metrics are never noisy. A house whose
            sidecar (`sim.houses.sidecar`) fixes noise keeps its own.
        render_mode: `rgb_array` or None.
        task: when a STOP succeeds, and the number of actions. This and the other configurations, `success`, `camera`,
            `scan` and `robot`, may also be a dict of some of their fields: `camera={"width_px": 128, "height_px": 96}`.
        success: replaces `task.success`.
        max_steps: replaces `task.max_steps`.
        camera: intrinsics and mount height.
        cameras: further cameras by name (`sim.renderer.mounted`): `cameras={"left": {"yaw_deg": 60}}` adds the keys
            `left_rgb` and `left_depth` to the observation.
        look: also allows the actions 4 LOOK_UP and 5 LOOK_DOWN, which tilt the first camera by 30 degrees, at most by
            60; they count as steps, and the sensor `tilt` reads the tilt.
        scan: the lidar of the sensor `scan`.
        robot: body and drive.
        cached_houses: number of houses that stay loaded, those that were used last. To load a house for the first time
            takes most of a second, later a fifth of it (`sim.core.store`); a loaded house takes 40 to 90 MB.

    Raises:
        ConfigError: an unknown split, goal, sensor, profile, noise, or field of a configuration.
        EpisodeError: an unknown goal, or a start with numbers out of range.
        HouseError: a house that violates the house format.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 4}  # noqa: RUF012 - declared by Gymnasium

    def __init__(
        self,
        *,
        split: str | Path = "val",
        house: str | Path | None = None,
        houses: Sequence[str | Path] = (),
        labels: str | Path | None = None,
        root: str | Path | None = None,
        goal: str | None = None,
        start: Pose | None = None,
        sensors: Sequence[str | Sensor] = SENSORS,
        truth: Sequence[str] = (),
        profile: str | RenderProfile | Mapping[str, object] = "fast",
        noise: str | NoiseConfig | Mapping[str, object] = "none",
        render_mode: str | None = None,
        task: TaskConfig | Mapping[str, object] | None = None,
        success: SuccessRule | Mapping[str, object] | None = None,
        max_steps: int | None = None,
        camera: CameraModel | Mapping[str, object] | None = None,
        cameras: Mapping[str, CameraConfig | Mapping[str, object]] | None = None,
        look: bool = False,
        scan: ScanConfig | Mapping[str, object] | None = None,
        robot: RobotConfig | Mapping[str, object] | None = None,
        cached_houses: int = 1,
    ) -> None:
        _check_options(goal, start, render_mode)
        self.split: Split = chosen_split(split, house, houses, labels=labels, root=root)
        if start is not None and (self.split.episodes or len(self.split.houses) != 1):
            raise ConfigError("start needs house: the episodes of a split have their own.")
        self.goal, self.start = goal, start
        self.scan_config = as_settings(scan, ScanConfig(), name="scan")
        all_sensors = resolve_sensors(with_cameras(sensors, cameras or {}))
        self.sensors = _with_scan(all_sensors, self.scan_config)
        self._cameras = cameras_of(self.sensors)
        self.truth_images: dict[str, NDArray] = {}
        """Images that were rendered last, without noise: at least those of `truth`."""
        if isinstance(truth, str):
            raise ConfigError(f"truth must be a tuple of names of images, got '{truth}'.")
        self._truth = tuple(truth)
        self.render_mode = render_mode
        self.camera_model = as_settings(camera, CameraModel(), name="camera")
        self.task_config = _with_changes(as_settings(task, TaskConfig(), name="task"), success, max_steps)
        self._profile = (
            get_profile(profile)
            if isinstance(profile, str)
            else as_settings(profile, get_profile("fast"), name="profile")
        )
        self._robot = as_settings(robot, RobotConfig(), name="robot")
        self._default_noise = self._make_noise(noise if isinstance(noise, NoiseConfig) else noise_from_dict(noise))
        self._noise = self._default_noise
        self.observation_space = spaces.Dict({sensor.name: sensor.space(self.camera_model) for sensor in self.sensors})
        self.actions = tuple(Action) if look else MOVES
        """The actions that are allowed."""
        self.action_space = spaces.Discrete(len(self.actions))
        self._episodes = [episode for episode in self.split.episodes if goal in (None, episode.goal)]
        if self.split.episodes and not self._episodes:
            raise ConfigError(
                f"Split '{self.split.name}' has no episode with goal '{goal}'. Other words need a house (house=)."
            )
        self._scenes = SceneCache(self._make_scene, size=cached_houses)
        self._shared: SharedContext | None = None
        self._scene: Scene | None = None
        self._episode: Episode | None = None
        self._motion: Motion | None = None
        self._pictures: list[NDArray[np.uint8] | None] = []  # those of the goals
        self._steps_per_action = 1
        self._limit: Limit = "max_steps"
        self._closed = False

    @property
    def scene(self) -> Scene:
        """World, camera and task of the running episode: the ground truth, for oracles and viewers."""
        if self._closed:
            raise gymnasium.error.ClosedEnvironmentError("The environment is closed: make another one.")
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
    def robot_config(self) -> RobotConfig:
        """Body and drive of the robot."""
        return self._robot

    @property
    def robot_model(self) -> RobotModel:
        """Size of the robot and position of its camera."""
        return self._robot.model

    @property
    def success_rule(self) -> SuccessRule:
        """The conditions under which a STOP succeeds."""
        return self.task_config.success

    @property
    def motion(self) -> Motion | None:
        """The last action as it was carried out, with its contacts; None before the first action."""
        return self._motion

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, object] | None = None
    ) -> tuple[dict[str, NDArray], dict[str, Any]]:
        """Starts an episode; see the class."""
        if self._closed:
            raise gymnasium.error.ClosedEnvironmentError("The environment is closed: make another one.")
        super().reset(seed=seed)
        episode = self._choose(options or {})
        # Frees the last house before the next one is compiled; a step after a reset that failed is refused.
        self._scene = self._episode = self._motion = None
        scene = self._scenes.get(episode.house)
        self._noise = self._noise_in(episode.house)
        # A spawned child takes no number from the stream that draws episodes.
        conditions = self._noise.begin(self.np_random.spawn(1)[0], scene.gloss)
        scene.world.reset(episode.start, conditions)
        self._pictures = [scene.picture_of(goal) for goal in episode.specs]
        scene.task.begin(episode.specs, episode.start)
        self._scene, self._episode = scene, episode
        observation = self._observe()
        self._require_in_space(observation)
        scene.task.look(self.truth_images)
        return observation, self._info(collided=False)

    def step(self, action: int) -> StepResult:
        """Carries out one action; see the class."""
        self.scene.task.require_running()
        remedy = "" if Action.LOOK_UP in self.actions else " look=True adds LOOK_UP and LOOK_DOWN."
        return self._outcome(self.scene.world.move(require_action(action, self.actions, remedy)))

    def _outcome(self, motion: Motion) -> StepResult:
        """Returns what `step` returns after a motion."""
        scene, self._motion = self.scene, motion
        observation = self._observe()
        number = scene.task.goal_number
        scene.task.observe(motion.action, motion, self.truth_images)
        if scene.task.goal_number != number:
            asked = [sensor for sensor in self._noise.sensors if not _ASKED.isdisjoint(declared_fields(sensor))]
            observation |= self._readings(asked)
        reward = float(scene.task.success)
        return observation, reward, scene.task.terminated, scene.task.truncated, self._info(motion.collided)

    def draw_episode(
        self, rng: np.random.Generator, *, episode_id: str = "drawn", house: str | None = None, goal: str | None = None
    ) -> Episode:
        """Returns a new episode in a house of this environment; a running episode ends, because the robot is moved.

        A goal or start that is not given is that of the environment, otherwise that of the house's sidecar, otherwise
        random; a house that is not given is random.

        Raises:
            EpisodeError: the goal is not in the house or cannot be reached, or the robot does not fit at the start.
        """
        houses = self.split.houses
        if house is None:
            house = houses[0] if len(houses) == 1 else houses[rng.integers(len(houses))]
        fixed = self.split.sidecar(house)
        goal, start = goal or self.goal or fixed.goal, self.start or fixed.start
        task = self._scene_for_drawing(house).task
        return sample_episode(task, house, rng, goal=goal, start=start, episode_id=episode_id)

    def draw_drive(self, rng: np.random.Generator, *, episode_id: str) -> Episode:
        """Returns a new episode without a goal in the only house, for a person who drives; a running episode ends.

        Raises:
            EpisodeError: the robot does not fit at the start.
        """
        (house,) = self.split.houses
        start = self.start or self.split.sidecar(house).start
        return sample_drive(self._scene_for_drawing(house).task, house, rng, start=start, episode_id=episode_id)

    def notes_on(self, house: str) -> tuple[str, ...]:
        """Returns sentences about what was changed in a house when it was loaded, see `House.notes`."""
        return self._scenes.get(house).notes

    def picture_categories(self) -> NDArray[np.uint8] | None:
        """Returns the true category of each pixel of the goal's picture, mpcat40 ids (h, w); None: it is no picture."""
        return self.scene.picture_of(self.episode.specs[self.scene.task.goal_number], "semantic")

    def render(self) -> NDArray[np.uint8] | None:
        """Returns the colour image of the robot's camera, uint8 (h, w, 3), in render mode `rgb_array`."""
        if self.render_mode is None:
            return None
        world = self.scene.world
        return self.scene.camera.render(world.data, world.camera_pose, ("rgb",))["rgb"]

    def close(self) -> None:
        """Frees the renderers; the environment cannot be used any more."""
        self._closed = True
        self._scene = None
        self._scenes.close()
        if self._shared is not None:
            self._shared.close()

    def _scene_for_drawing(self, house: str) -> Scene:
        """Returns the scene of a house and forgets the running episode, so that `step` refuses to continue it."""
        self._scene = self._episode = self._motion = None
        return self._scenes.get(house)

    def _choose(self, options: Mapping[str, Any]) -> Episode:
        unknown = sorted(set(options) - {"episode", "episode_id"})
        if unknown or len(options) > 1:
            raise ConfigError(
                f"reset takes one of the options episode and episode_id, got {', '.join(map(str, options))}."
            )
        if "episode" in options and not isinstance(options["episode"], Episode):
            raise ConfigError(f"options['episode'] must be an Episode, got {reprlib.repr(options['episode'])}.")
        if "episode" in options:
            return options["episode"]
        if "episode_id" in options:
            if self._episode is not None and options["episode_id"] == self._episode.episode_id:
                return self._episode  # one that was drawn is in no split
            return self.split.episode(options["episode_id"])
        if self._episodes:
            return self._episodes[self.np_random.integers(len(self._episodes))]
        return self.draw_episode(self.np_random)

    def _make_scene(self, house: str) -> Scene:
        if self._shared is None:
            self._shared = SharedContext(self.camera_model)
        return Scene(
            self.split.load_house(house),
            robot=self._robot,
            camera=self.camera_model,
            profile=self._profile,
            task=self.task_config,
            steps_per_action=self._steps_per_action,
            limit=self._limit,
            shared=self._shared,
        )

    def _make_noise(self, config: NoiseConfig) -> SensorNoise:
        return SensorNoise(config, self.camera_model, self.sensors)

    def _noise_in(self, house: str) -> SensorNoise:
        """Returns the noise that the house's sidecar fixes, else the environment's."""
        fixed = self.split.sidecar(house).noise
        try:
            return self._make_noise(noise_from_dict(fixed)) if fixed else self._default_noise
        except (ConfigError, TypeError) as error:
            raise HouseError(f"House '{house}': the noise in its sidecar is not allowed: {error}") from None

    def _require_in_space(self, observation: dict[str, NDArray]) -> None:
        """Raises ConfigError if the first reading of a user's sensor is not in its space."""
        for sensor in (sensor for sensor in self.sensors if sensor.name not in STANDARD_SENSORS):
            space, reading = sensor.space(self.camera_model), observation[sensor.name]
            if not space.contains(reading):
                raise ConfigError(
                    f"Sensor '{sensor.name}' read {reading!r}, which is not in its space {space}; a reading is an "
                    "array of the space's shape and dtype."
                )

    def _observe(self) -> dict[str, NDArray]:
        """Returns the observation; the true images that the metrics need are rendered even if no agent gets them."""
        world = self.scene.world
        needed = {name for sensor in self._noise.sensors for name in sensor.images}
        names = sorted({*self.scene.task.images, *needed, *self._truth, *self._noise.images})
        first = [name for name in names if ":" not in name]
        images = self.truth_images = self.scene.camera.render(world.data, world.camera_pose, first)
        for camera, config in self._cameras.items():
            asked = [name.partition(":")[2] for name in names if name.startswith(f"{camera}:")]
            views = self.scene.mounted.render(world.data, world.body_pose, config, asked)
            images |= {f"{camera}:{image}": view for image, view in views.items()}
        return self._noise.apply(self._readings(self._noise.sensors), images)

    def _readings(self, sensors: Sequence[Sensor]) -> dict[str, NDArray]:
        """Returns the readings of some sensors in the images that were rendered last."""
        world, task, images = self.scene.world, self.scene.task, self.truth_images
        number = task.goal_number
        fields = {
            "goal": task.goals[number].told,
            "picture": self._pictures[number],
            "collided": self._motion is not None and self._motion.collided,
            "odometry": world.odometry,
            "pose": world.body_pose,
            "start": self.episode.start,
            "motion": self._motion,
            "model": world.model,
            "data": world.data,
            "glass": world.glass,
            "labels": world.labels,
            "tilt": world.tilt_rad,
        }
        return {sensor.name: sensor.read(SensorContext(sensor, images, **fields)) for sensor in sensors}

    def _info(self, collided: bool) -> dict[str, object]:
        episode, task = self.episode, self.scene.task
        info: dict[str, object] = {
            "episode_id": episode.episode_id,
            "house": episode.house,
            "goal": task.goal,
            "collided": collided,
            **task.goal_metrics().as_info(),
        }
        if task.is_chain:
            info["goal_number"] = task.goal_number
            if task.ended_goal is not None:
                info["ended_goal"] = task.ended_goal.as_info()
            if task.done:
                info["chain"] = task.metrics().as_info()
        return info


def _with_changes(
    task: TaskConfig, success: SuccessRule | Mapping[str, object] | None, max_steps: int | None
) -> TaskConfig:
    """Returns the configuration of the task with the fields that are not None replaced."""
    if success is not None:
        task = replace(task, success=as_settings(success, task.success, name="success"))
    return task if max_steps is None else replace(task, max_steps=max_steps)


def _with_scan(sensors: tuple[Sensor, ...], scan: ScanConfig) -> tuple[Sensor, ...]:
    """Returns the sensors with this lidar in place of the standard one; a `ScanSensor` of another one stays."""
    return tuple(
        replace(sensor, config=scan) if isinstance(sensor, ScanSensor) and sensor == ScanSensor() else sensor
        for sensor in sensors
    )


def _check_options(goal: object, start: object, render_mode: object) -> None:
    if goal is not None and not isinstance(goal, str):
        raise ConfigError(f"goal must be a category or words, got {reprlib.repr(goal)}.")
    if goal is not None:
        require_goal(goal)
    if start is not None and not isinstance(start, Pose):
        raise ConfigError(f"start must be a Pose, got {reprlib.repr(start)}.")
    if start is not None:
        require_start(start)
    if render_mode not in (None, "rgb_array"):
        raise ConfigError(f"Unknown render_mode '{render_mode}'. Available: rgb_array.")
