"""Habitat's environment over the splits and houses of this project."""

from __future__ import annotations

import contextlib
import math
import numbers
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike, NDArray

from sim.app.bridges.habitat.config import Config, log_ignored, make_config, settings_of
from sim.app.bridges.habitat.conversions import Conversion, Observations, to_action
from sim.app.bridges.habitat.episodes import ObjectGoalNavEpisode, to_habitat
from sim.app.bridges.habitat.shortest_path import ShortestPaths
from sim.core.errors import AgentError, ConfigError, EpisodeError
from sim.core.interface import Action, CameraModel
from sim.env.objectnav import ObjectNavEnv
from sim.episodes import habitat
from sim.episodes.episode import Episode
from sim.episodes.seeds import drawing_generator, episode_seeds

DRAWN_EPISODES = 5
"""Number of episodes that are drawn in a house file if `episodes` is not given."""
_defaults: dict[str, Any] = {}


Metrics = dict[str, float | dict[str, float]]
"""The metrics of an episode by Habitat's names; `collisions` has two numbers."""


@contextlib.contextmanager
def default_options(**options: Any) -> Iterator[None]:
    """Sets default options of each `Env` that is made inside the `with` block; `stubborn habitat` uses it for scripts.

    These options have priority over a configuration, and the arguments of `Env` have priority over these options.
    """
    before = dict(_defaults)
    _defaults.update(options)
    try:
        yield
    finally:
        _defaults.clear()
        _defaults.update(before)


class Env:
    """Runs episodes one after the other, in the order of the split and then again from its beginning.

    `reset()` starts the next episode and returns its first observations; `step(action)` returns the next ones, until
    `episode_over` is True. `get_metrics()` uses Habitat's names: `success`, `spl`, `soft_spl` (and `softspl`, its name
    until 2021), `distance_to_goal` (inf: no path), `num_steps`, and `collisions` with `count` and `is_collision`.

    Args:
        config: a configuration of `get_config`; the environment takes `SETTINGS` from it. None: the defaults.
        dataset: exists only for scripts that give it, and must be None: houses and episodes come from a split.
        split: name of a shipped split, or a folder with the same layout.
        house: one MJCF file in place of a split.
        episodes: number of episodes, the first of the split; None: all, or `DRAWN_EPISODES` with `house`.
        seed: seed of sensor noise and, with `house`, of the episodes; the same as `--seed`.
        categories: numbering of `objectgoal`, a key of `CATEGORIES`; only episodes with its goals are run.
        options: further arguments of `sim.env.objectnav.ObjectNavEnv`, such as `noise`, `profile` and `sensors`.

    Raises:
        ConfigError, EpisodeError, HouseError: an option or value of the configuration is not allowed.
    """

    def __init__(self, config: Mapping[str, object] | None = None, dataset: None = None, **options: Any) -> None:
        if dataset is not None:
            raise ConfigError("Env takes no dataset: split= names a split, house= an MJCF file.")
        log_ignored(config or {})
        options = settings_of(config or {}) | _defaults | {k: v for k, v in options.items() if v is not None}
        _check_types(options)
        if "house" in options:
            options.pop("split", None)
        self._seed = int(options.pop("seed", 0))
        count = options.pop("episodes", None)
        normalize_depth = bool(options.pop("normalize_depth", True))
        camera = _camera(options)
        categories = options.pop("categories", "mp3d")
        self._conversion = Conversion(camera=camera, categories=categories, normalize_depth=normalize_depth)
        options.setdefault("sensors", ("rgb", "depth"))
        self._env = ObjectNavEnv(camera=camera, **options)
        self._listed = self._first_episodes(count)
        self._number = -1
        self._episode = self._listed[0]
        self._info: dict[str, Any] = {}
        self._over = True
        self.sim = Simulator(self._env)
        self.config = config if config is not None else self._own_config()
        self.action_space = spaces.Discrete(len(Action))
        self.observation_space = self._conversion.space(
            {sensor.name: sensor.space(camera) for sensor in self._env.sensors}
        )

    @property
    def episodes(self) -> list[ObjectGoalNavEpisode]:
        """The episodes, in their order."""
        return [to_habitat(self._env.split, episode) for episode in self._listed]

    @episodes.setter
    def episodes(self, chosen: Iterable[ObjectGoalNavEpisode]) -> None:
        """Chooses some of these episodes, and their order; the next `reset` starts the first one."""
        known = {episode.episode_id: episode for episode in self._listed}
        ids = [episode.episode_id for episode in chosen]
        other = next((episode_id for episode_id in ids if episode_id not in known), None)
        if other is not None or not ids:
            raise ConfigError(
                f"episodes must be one or more of env.episodes, got {'none' if other is None else other}."
            )
        self._listed = [known[episode_id] for episode_id in ids]
        self.rewind()

    @property
    def number_of_episodes(self) -> int:
        """The number of episodes."""
        return len(self._listed)

    @property
    def current_episode(self) -> ObjectGoalNavEpisode:
        """The running episode; before the first `reset`, the first episode."""
        return to_habitat(self._env.split, self._episode)

    @property
    def episode_over(self) -> bool:
        """Whether the episode has ended, so that `reset` must be called next."""
        return self._over

    def rewind(self) -> None:
        """Makes the next `reset` start the first episode."""
        self._number = -1

    def reset(self) -> Observations:
        """Starts the next episode and returns its observations."""
        self._number = (self._number + 1) % len(self._listed)
        self._episode = self._listed[self._number]
        seed = episode_seeds(self._seed, self._episode.episode_id).environment
        observation, self._info = self._env.reset(seed=seed, options={"episode": self._episode})
        self._over = False
        return self._conversion.observations(observation)

    def step(self, action: object, **others: object) -> Observations:
        """Carries out an action (a number, a name, or a dict with the key `action`) and returns the observations.

        Raises:
            AgentError: `action` is not an action.
            EpisodeError: the episode is over.
        """
        observation, _, terminated, truncated, self._info = self._env.step(to_action(action))
        self._over = terminated or truncated
        return self._conversion.observations(observation)

    def get_metrics(self) -> Metrics:
        """Returns the metrics so far, with Habitat's names (see the class).

        Raises:
            EpisodeError: no episode has begun.
        """
        info = self._info
        if not info:
            raise EpisodeError("get_metrics needs an episode: call reset first.")
        distance_m = info["distance_to_goal"]
        return {
            "distance_to_goal": math.inf if distance_m is None else float(distance_m),
            "success": float(info["success"]),
            "spl": float(info["spl"]),
            "soft_spl": float(info["soft_spl"]),
            "softspl": float(info["soft_spl"]),
            "num_steps": int(info["num_steps"]),
            "collisions": {"count": int(info["collisions"]), "is_collision": bool(info["collided"])},
        }

    def seed(self, seed: int) -> None:
        """Sets the seed of sensor noise from the next `reset` on."""
        self._seed = int(seed)

    def close(self) -> None:
        """Frees the renderers; the environment cannot be used any more."""
        self._env.close()

    def __getattr__(self, name: str) -> object:
        raise _lacks(self, "Env", name)

    def __enter__(self) -> Env:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _first_episodes(self, count: int | None) -> list[Episode]:
        """Returns the first episodes with a goal of the data set; in a house file, episodes are drawn."""
        env, goals = self._env, self._conversion.goals
        if count is not None and count < 1:
            raise ConfigError(f"episodes must be at least 1, got {count}.")
        if not env.split.episodes:
            rngs = (drawing_generator(self._seed, i) for i in range(count or DRAWN_EPISODES))
            names = ",".join(env.split.houses)
            drawn = [env.draw_episode(rng, episode_id=f"{names}_{i:04d}") for i, rng in enumerate(rngs)]
            return [self._known(episode) for episode in drawn]
        known = [
            episode for episode in env.split.episodes if episode.goal in goals and env.goal in (None, episode.goal)
        ]
        if not known:
            raise ConfigError(f"Split '{env.split.name}' has no episode with a goal of {', '.join(goals)}.")
        if count is not None and count > len(known):
            raise ConfigError(f"episodes must be 1 to {len(known)}, got {count}.")
        return known[:count]

    def _known(self, episode: Episode) -> Episode:
        try:
            self._conversion.goal_number(episode.goal)
        except AgentError as error:
            raise ConfigError(str(error)) from None
        return episode

    def _own_config(self) -> Config:
        env = self._env
        return make_config(
            camera=env.camera_model,
            robot=env.robot_model,
            success=env.success_rule,
            max_steps=env.task_config.max_steps,
            split=env.split.name,
        )


class Simulator:
    """The part of Habitat's simulator that evaluation scripts read."""

    def __init__(self, env: ObjectNavEnv) -> None:
        self.env = env
        """The environment of this project."""
        self.paths = ShortestPaths(env)
        """Shortest paths on the storey of the running episode."""

    @property
    def previous_step_collided(self) -> bool:
        """Whether a body contact stopped the last move."""
        motion = self.env.motion
        return motion is not None and bool(motion.collided)

    def get_agent_state(self, agent_id: int = 0) -> AgentState:
        """Returns the robot's true pose in Habitat's frame."""
        state = habitat.to_agent_state(self.env.scene.world.pose)
        return AgentState(np.array(state["position"], np.float32), np.array(state["rotation"], np.float32))

    def geodesic_distance(self, position_a: ArrayLike, position_b: ArrayLike, episode: object = None) -> float:
        """Returns the length of the shortest path from a place to the nearest of one or several; inf: no path.

        The free space is that at the start of the episode; a place that is not free counts as the free cell nearest
        to it.

        Args:
            position_a: (3,) metres, Habitat's frame.
            position_b: (3,) or (n, 3) metres, Habitat's frame.
            episode: exists for scripts that give it; the running episode counts.
        """
        return self.paths.distance_m(position_a, position_b)

    def __getattr__(self, name: str) -> object:
        raise _lacks(self, "Env.sim", name)


class AgentState:
    """A pose in Habitat's frame: y up, an agent without rotation looks along -z."""

    def __init__(self, position: NDArray[np.float32], rotation: NDArray[np.float32]) -> None:
        self.position = position
        """Metres, float32 (3,)."""
        self.rotation = rotation
        """A quaternion xyzw, float32 (4,)."""


def _lacks(owner: object, what: str, name: str) -> AttributeError:
    """Returns the error for an attribute that Habitat's class has and ours does not."""
    names = sorted({n for n in (*dir(type(owner)), *vars(owner)) if not n.startswith("_")})
    return AttributeError(f"{what} of this project has no '{name}'. It has: {', '.join(names)}.")


_TYPES: Mapping[str, tuple[type | tuple[type, ...], str]] = {
    **dict.fromkeys(("episodes", "seed", "max_steps", "width_px", "height_px"), (numbers.Integral, "an integer")),
    **dict.fromkeys(("hfov_deg", "min_depth_m", "max_depth_m"), (numbers.Real, "a number")),
    "normalize_depth": (bool, "True or False"),
    "camera": ((Mapping, CameraModel), "a CameraModel or a dict of its fields"),
}
"""Types of options, and their names in messages."""


def _check_types(options: Mapping[str, object]) -> None:
    """Raises ConfigError for an option of another type than `_TYPES` says."""
    for name, (kind, words) in _TYPES.items():
        value = options.get(name)
        if value is not None and (not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool)):
            raise ConfigError(f"{name} must be {words}, got {value!r:.100}.")


def _camera(options: dict[str, Any]) -> CameraModel:
    """Returns the camera that the options describe, and removes its settings from the options."""
    fields: dict[str, Any] = {}
    for name in ("width_px", "height_px", "min_depth_m", "max_depth_m"):
        if name in options:
            fields[name] = options.pop(name)
    if "hfov_deg" in options:
        fields["hfov_rad"] = math.radians(options.pop("hfov_deg"))
    if "position" in options:
        fields["height_m"] = _height_m(options.pop("position"))
    camera = options.pop("camera", None)
    if isinstance(camera, CameraModel):
        return camera
    return CameraModel(**fields | dict(camera or {}))


def _height_m(position: Iterable[float]) -> float:
    """Returns the height of a camera of Habitat's from its position: right, up and back, metres.

    Raises:
        ConfigError: it is something else, or not on the robot's axis.
    """
    try:
        right_m, up_m, back_m = map(float, position)
    except (TypeError, ValueError):
        raise ConfigError(f"POSITION of a camera is [0, height, 0] in metres, got {position!r}.") from None
    if right_m or back_m:
        raise ConfigError(f"POSITION of a camera must lie on the robot's axis, [0, height, 0], got {position!r}.")
    return up_m
