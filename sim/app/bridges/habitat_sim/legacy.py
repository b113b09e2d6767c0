"""What scripts for older versions of habitat-lab use and version 0.3 no longer has, for `stubborn habitat SCRIPT`.

`get_config` without a file is the configuration of a split here; it can be changed, has the methods of yacs, and also
the tree of 2021 (`config.SIMULATOR.RGB_SENSOR.WIDTH`), whose changes are carried over to the one of today. `Env` takes
this project's options, such as `split` and `episodes`; `Benchmark` and `Challenge` run an agent through its episodes.
"""

from __future__ import annotations

import contextlib
import importlib
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import habitat
import habitat.config.default
import habitat.core.benchmark
import habitat.core.env
import habitat.core.utils
import numpy as np
from habitat.config.default_structured_configs import HabitatSimSemanticSensorConfig
from habitat.core.logging import logger
from habitat.core.registry import registry
from habitat.datasets import make_dataset as lab_dataset
from habitat.utils.visualizations import utils as pictures
from omegaconf import DictConfig, ListConfig, OmegaConf

from sim.app.bridges.habitat_sim.lab import get_config as config_of_split
from sim.app.bridges.habitat_sim.settings import Configuration
from sim.core.errors import ConfigError

_MAIN = "habitat.simulator.agents.main_agent"
PLACES: Mapping[str, str] = {
    "ENVIRONMENT": "habitat.environment",
    "SIMULATOR": "habitat.simulator",
    "SIMULATOR.AGENT_0": _MAIN,
    "SIMULATOR.RGB_SENSOR": f"{_MAIN}.sim_sensors.rgb_sensor",
    "SIMULATOR.DEPTH_SENSOR": f"{_MAIN}.sim_sensors.depth_sensor",
    "SIMULATOR.SEMANTIC_SENSOR": f"{_MAIN}.sim_sensors.semantic_sensor",
    "TASK": "habitat.task",
    "TASK.SUCCESS": "habitat.task.measurements.success",
    "TASK.DISTANCE_TO_GOAL": "habitat.task.measurements.distance_to_goal",
    "DATASET": "habitat.dataset",
}
"""Where the trees of 2021 are today."""
MOVED: Mapping[str, str] = {
    "gym.spaces.dict_space": "gym.spaces.dict",
    "habitat.utils.gym_adapter": "habitat.gym.gym_wrapper",
    "habitat_baselines.utils.env_utils": "habitat_baselines.common.habitat_env_factory",
}
"""Modules that have another name today."""
OF_2021 = "configs/"
"""Folder of the configurations in repositories of habitat-lab until 2022, whose files are not here."""
OPTIONS = frozenset({"split", "episodes", "seed", "max_steps", "categories", "width_px", "height_px"})
"""The options of `Env`."""
SENSORS = "SIMULATOR.AGENT_0.SENSORS"
_options: dict[str, Any] = {}
_told: set[str] = set()


def install(**options: Any) -> None:
    """Gives habitat-lab the names of older versions in this process; `options` have priority over those of scripts."""
    _options.clear()
    _options.update({name: value for name, value in options.items() if value is not None})
    for name, function in (("merge_from_list", _merge_from_list), ("clone", _clone), ("freeze", _nothing)):
        setattr(DictConfig, name, function)
    DictConfig.defrost = _nothing
    Configuration.SCENE = property(lambda config: config.sim_cfg.scene_id)  # pyright: ignore[reportAttributeAccessIssue]
    challenge = ModuleType("habitat.core.challenge")
    challenge.Challenge = Challenge  # pyright: ignore[reportAttributeAccessIssue]
    sys.modules["habitat.core.challenge"] = challenge
    names = {"Env": Env, "Benchmark": Benchmark, "Challenge": Challenge, "Config": DictConfig, "get_config": get_config}
    names |= {"make_dataset": make_dataset}
    for module in (habitat, habitat.config.default, habitat.core.env, habitat.core.benchmark):
        vars(module).update({name: value for name, value in names.items() if module is habitat or name in vars(module)})
    for module, name, value in (
        (habitat.config, "Config", DictConfig),
        (habitat.config.default, "Config", DictConfig),
        (habitat.core.utils, "try_cv2_import", lambda: importlib.import_module("cv2")),
        (pictures, "append_text_to_image", pictures.append_text_underneath_image),
    ):
        setattr(module, name, value)
    for old, new in MOVED.items():
        with contextlib.suppress(ImportError):
            sys.modules[old] = importlib.import_module(new)


def get_config(
    config_path: str | None = None,
    overrides: Sequence[Any] | None = None,
    configs_dir: str | None = None,
    *,
    config_paths: str | Sequence[str] | None = None,
    opts: Sequence[Any] | None = None,
) -> Any:
    """Returns the configuration of the split, changed by files and by overrides.

    Args:
        config_path: YAML files of either layout, separated by commas; `config_paths` is its name until 2021. The
            name of a file that comes with habitat-lab gives that configuration.
        overrides: texts `path=value`, or paths and values alternately; `opts` is their name until 2021.
        configs_dir: exists for scripts that give it.

    Raises:
        ConfigError: a file does not exist, or an override has no value.
    """
    given = config_path if config_path is not None else config_paths
    files = given.split(",") if isinstance(given, str) else [str(path) for path in given or ()]
    config = _open(config_of_split(str(_options.get("split", "val"))))
    for file in files:
        if Path(file).is_file():
            _merge(config, OmegaConf.load(file))
        elif (Path(habitat.config.default._HABITAT_CFG_DIR) / file).is_file():
            config = _open(config_of_split(str(_options.get("split", "val")), base=file))
        elif file.startswith(OF_2021):
            _tell(f"Configuration '{file}' of an older habitat-lab: the task of this project is used.")
        else:
            raise ConfigError(f"Configuration file '{file}' does not exist.")
    _add_tree_of_2021(config)
    _merge_from_list(config, _pairs(overrides if overrides is not None else opts))
    return config


def make_dataset(id_dataset: str, *, config: Any = None, **arguments: Any) -> Any:
    """Returns a data set, for a configuration of either layout; the option `--split` has priority.

    Scenes that the split does not have are left out; if it has none of them, all of its houses are used.

    Args:
        id_dataset: its registered name.
        config: `DATASET` of 2021, or `habitat.dataset`; None makes an empty data set.
        arguments: those of habitat-lab.
    """
    if config is None:
        return lab_dataset(id_dataset, **arguments)
    config = OmegaConf.create({str(key).lower(): value for key, value in config.items()})
    if "split" in _options:
        id_dataset = config_of_split(_name_of_split(_options)).habitat.dataset.type
        known = registry.get_dataset(id_dataset).get_scenes_to_load(config)
        scenes = [Path(str(scene)).stem for scene in config.content_scenes]  # without .glb
        config.content_scenes = [scene for scene in scenes if scene in known] or ["*"]
    return lab_dataset(id_dataset, config=config, **arguments)


def _name_of_split(options: Mapping[str, Any]) -> str:
    return str(options["split"]) + ("-hm3d" if options.get("categories") == "hm3d" else "")


class Env(habitat.core.env.Env):
    """Habitat's environment; without a configuration that of a split.

    Args:
        config: of `get_config`, of either layout.
        dataset: episodes in place of those of the configuration.
        options: `split`, `episodes` (the first ones, in their order), `seed`, `max_steps`, `categories` (`mp3d` or
            `hm3d`), `width_px` and `height_px`.
    """

    def __init__(self, config: Any = None, dataset: Any = None, **options: Any) -> None:
        options |= _options
        unknown = sorted(set(options) - OPTIONS)
        if unknown:
            raise ConfigError(f"Env has no option '{unknown[0]}'.")
        if config is None:
            config = get_config()
        config = _carried_over(config)
        if "split" in options or options.get("categories") == "hm3d":
            name = _name_of_split({"split": "val", **options})
            config.habitat.dataset.type = config_of_split(name).habitat.dataset.type
        if "max_steps" in options:
            config.habitat.environment.max_episode_steps = int(options["max_steps"])
        if "seed" in options:
            config.habitat.seed = int(options["seed"])
        for sensor in config.habitat.simulator.agents.main_agent.sim_sensors.values():
            sensor.width, sensor.height = options.get("width_px", sensor.width), options.get("height_px", sensor.height)
        if dataset is None:
            dataset = lab_dataset(config.habitat.dataset.type, config=config.habitat.dataset)
            count = options.get("episodes")
            if count is not None and not 1 <= int(count) <= len(dataset.episodes):
                raise ConfigError(f"episodes must be 1 to {len(dataset.episodes)}, got {count}.")
            dataset.episodes = dataset.episodes[: None if count is None else int(count)]
            order = config.habitat.environment.iterator_options
            order.shuffle, order.group_by_scene = False, False
        super().__init__(config, dataset)


class Benchmark:
    """Runs an agent through the episodes of an `Env`; `eval_remote` must be False."""

    def __init__(self, config_paths: str | None = None, eval_remote: bool = False) -> None:
        if eval_remote:
            raise ConfigError("eval_remote must be False: there is no evaluation server.")
        self._env = Env(get_config(config_paths))

    def evaluate(self, agent: Any, num_episodes: int | None = None) -> dict[str, float]:
        """Returns the means of the measures that are numbers."""
        count = len(self._env.episodes) if num_episodes is None else num_episodes
        if count < 1:
            raise ConfigError(f"num_episodes must be at least 1, not {count}.")
        rows = []
        for _ in range(count):
            observations = self._env.reset()
            agent.reset()
            while not self._env.episode_over:
                observations = self._env.step(agent.act(observations))
            rows.append({k: v for k, v in self._env.get_metrics().items() if isinstance(v, (int, float))})
        self._env.close()
        return {name: float(np.mean([row[name] for row in rows])) for name in rows[0]}


class Challenge(Benchmark):
    """The loop of Habitat's challenges: the configuration is the file that CHALLENGE_CONFIG_FILE names."""

    def __init__(self, eval_remote: bool = False) -> None:
        super().__init__(os.environ.get("CHALLENGE_CONFIG_FILE"), eval_remote)

    def submit(self, agent: Any) -> None:
        """Evaluates an agent and logs its measures."""
        for name, value in self.evaluate(agent).items():
            logger.info(f"{name}: {value}")


def _open(config: Any) -> Any:
    """Returns a configuration that can be changed, with a semantic sensor that is off until a script lists it."""
    OmegaConf.set_readonly(config, False)
    OmegaConf.set_struct(config, False)
    sensors = config.habitat.simulator.agents.main_agent.sim_sensors
    if "semantic_sensor" not in sensors:
        camera = {name: sensors.depth_sensor[name] for name in ("position", "orientation", "hfov", "width", "height")}
        sensors.semantic_sensor = {**vars(HabitatSimSemanticSensorConfig()), "type": "", **camera}
    return config


def _use_sensors(config: Any, names: Any) -> None:
    """Turns the semantic sensor on if it is listed; colour, depth and pose are always there."""
    if "SEMANTIC_SENSOR" in names:
        config.habitat.simulator.agents.main_agent.sim_sensors.semantic_sensor.type = "HabitatSimSemanticSensor"


def _add_tree_of_2021(config: Any) -> None:
    """Adds the tree of 2021, with the values of today's."""
    old: Any = OmegaConf.create({})
    for place, today in PLACES.items():
        tree = OmegaConf.select(config, today)
        if tree is not None:
            OmegaConf.update(old, place, _upper(tree), force_add=True, merge=True)
    old.SEED = config.habitat.seed
    config.merge_with(old)
    before = {key: value for key, value in OmegaConf.to_container(config).items() if key.isupper()}
    OmegaConf.update(config, "_before", before, force_add=True)


def _upper(tree: Any) -> dict[str, Any]:
    """Returns a tree with keys in upper case; subtrees without a place of their own are kept."""
    return {
        str(key).upper(): _upper(value) if isinstance(value, DictConfig) else value
        for key, value in tree.items()
        if not (isinstance(value, DictConfig) and str(key) in ("agents", "sim_sensors", "measurements", "lab_sensors"))
    }


def _carried_over(config: Any) -> Any:
    """Returns today's tree with the changes that a script made in that of 2021; tells those that have no place."""
    if "habitat" not in config:
        config = OmegaConf.create({"habitat": config})
    config = config.copy()
    OmegaConf.set_readonly(config, False)
    OmegaConf.set_struct(config, False)
    if "_before" in config:
        before = config._before
        for path, value in _leaves(config, skip=("habitat", "_before")):
            if OmegaConf.select(before, path) == value:
                continue
            if path == SENSORS:
                _use_sensors(config, value)
                continue
            today = _today(path)
            if today is None or OmegaConf.select(config, today) is None:
                _tell(f"The configuration's {path}={value!r} has no effect here.")
            else:
                OmegaConf.update(config, today, value)
        main = config.habitat.simulator.agents.main_agent.sim_sensors
        if "semantic_sensor" in main and not main.semantic_sensor.get("type"):
            del main["semantic_sensor"]
    return OmegaConf.create({"habitat": config.habitat})


def _today(path: str) -> str | None:
    """Returns the path of today for one of the tree of 2021; None: it has none."""
    if path == "SEED":
        return "habitat.seed"
    place = max((p for p in PLACES if path.startswith(f"{p}.")), key=len, default=None)
    return place and f"{PLACES[place]}{path[len(place) :].lower()}"


def _leaves(tree: Any, *, skip: Sequence[str] = (), path: str = "") -> Iterator[tuple[str, Any]]:
    for key in tree:
        if key in skip:
            continue
        value = tree[key]
        if isinstance(value, DictConfig):
            yield from _leaves(value, path=f"{path}{key}.")
        else:
            yield f"{path}{key}", value


def _merge(config: Any, changes: Any) -> None:
    """Merges a file into a configuration: the tree of today as it is, that of 2021 translated."""
    for path, value in _leaves(changes, skip=("defaults",)):
        today = _today(path)
        known = OmegaConf.select(config, today or path)
        if today is not None and (known is None or isinstance(known, DictConfig)):  # such as a list of measures
            OmegaConf.update(config, path, value, force_add=True)  # the script may read it
            if path == SENSORS:
                _use_sensors(config, value)
            else:
                _tell(f"The configuration's {path}={value!r} has no effect here.")
        else:
            OmegaConf.update(config, today or path, value, force_add=True)


def _pairs(overrides: Sequence[Any] | None) -> list[Any]:
    """Returns paths and values alternately."""
    pairs: list[Any] = []
    for item in overrides or ():
        path, separator, text = str(item).partition("=")
        if separator and len(pairs) % 2 == 0:
            pairs += [path, OmegaConf.create(f"value: {text}").value]
        else:
            pairs.append(item)
    return pairs


def _merge_from_list(config: Any, pairs: Sequence[Any]) -> None:
    """Changes a configuration by paths and values alternately, as yacs does."""
    if len(pairs) % 2:
        raise ConfigError(f"Overrides are paths and values alternately, got {list(pairs)!r}.")
    for path, value in zip(pairs[::2], pairs[1::2], strict=True):
        known = OmegaConf.select(config, str(path))
        if known is None:
            raise ConfigError(f"The configuration has no '{path}'.")
        OmegaConf.update(config, str(path), list(value) if isinstance(known, ListConfig) else value)


def _clone(config: Any) -> Any:
    return config.copy()


def _nothing(config: Any) -> None:
    """Does nothing: this configuration can always be changed."""


def _tell(sentence: str) -> None:
    """Logs a sentence once."""
    if sentence not in _told:
        _told.add(sentence)
        logger.warning(sentence)
