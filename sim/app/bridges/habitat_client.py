"""Runs code that is written for Habitat, unchanged, in the process of an agent: `stubborn_client` describes its use.

The first half, the names of Habitat without the classes that need a simulator, also serves `sim.app.bridges.habitat`.
`stubborn agent-client` appends this module to `stubborn_client`, so that users copy one file; it needs nothing but
Python 3.6 or newer, and PyYAML if the code reads a configuration file.
"""

import ast
import contextlib
import copy
import importlib
import importlib.util
import inspect
import json
import logging
import os
import re
import runpy
import sys
from collections.abc import Iterable, Iterator, Mapping
from importlib.abc import Loader
from importlib.machinery import ModuleSpec
from types import ModuleType, SimpleNamespace
from typing import Any

from sim.app.bridges.stubborn_client import HABITAT_ACTIONS, Link, Observation, serve

LOG = logging.getLogger("habitat")
HABITAT_MODULES = {
    "habitat": "Agent Benchmark Challenge Config Env RLEnv get_config read_write logger",
    "habitat.config": "Config get_config read_write",
    "habitat.config.default": "Config get_config read_write",
    "habitat.config.read_write": "read_write",
    "habitat.core": "",
    "habitat.core.agent": "Agent",
    "habitat.core.benchmark": "Benchmark",
    "habitat.core.challenge": "Challenge",
    "habitat.core.env": "Env RLEnv",
    "habitat.core.logging": "logger",
    "habitat.core.simulator": "Observations",
    "habitat.sims": "",
    "habitat.sims.habitat_simulator": "",
    "habitat.sims.habitat_simulator.actions": "HabitatSimActions",
    "habitat.tasks": "",
    "habitat.tasks.nav": "",
    "habitat.tasks.nav.object_nav_task": "ObjectGoal ObjectGoalNavEpisode",
    "habitat.tasks.nav.shortest_path_follower": "ShortestPathFollower",
}
"""The modules of Habitat that agents import, with their names; the stand-in for Habitat provides these."""
NOT_IN_THE_STAND_IN = "is not part of the stand-in for Habitat, which is not installed here (docs/habitat.md)"
EMPTY_PACKAGES = ("detectron2",)
"""Packages that do not install from PyPI and that agents import without using them: their modules are empty here."""
OF_THE_RUN = ("config", "task_config")
"""Names of required arguments of an agent's constructor that get the configuration of the run."""
NOT_DECLARED = "Removed from the configuration: %s (--config agent.looks=true declares LOOK_UP and LOOK_DOWN)."
CALL = re.compile(r"([A-Za-z_][\w.]*):([A-Za-z_]\w*)\(\)")
"""A value `module:NAME()` of an argument: the result of this function."""


class Config(dict):
    """A tree of values with attribute access, like the configurations of yacs and OmegaConf that Habitat uses."""

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            content = f"It has: {', '.join(map(str, self))}." if self else "It is empty."
            raise AttributeError(f"The configuration has no '{name}' here. {content}") from None

    def __setattr__(self, name: str, value: object) -> None:
        self[name] = value

    def merge_from_list(self, pairs: "Iterable[object]") -> None:
        """Changes the configuration by paths and values alternately."""
        override(self, pairs)

    def clone(self) -> "Config":
        """Returns a copy that shares nothing with this one."""
        return copy.deepcopy(self)

    def freeze(self) -> None:
        """Does nothing: a configuration can always be changed."""

    def defrost(self) -> None:
        """Does nothing: a configuration can always be changed."""


@contextlib.contextmanager
def read_write(config):
    """Does nothing: a configuration can always be changed."""
    yield config


def to_config(value: object) -> Any:
    """Returns nested dicts as a `Config`; lists and dicts are copied."""
    if isinstance(value, dict):
        return Config({str(key): to_config(item) for key, item in value.items()})
    return [to_config(item) for item in value] if isinstance(value, list) else value


def merge(config: Config, changes: "Mapping") -> None:
    """Writes the values of nested dicts into a configuration, in place."""
    for key, value in changes.items():
        inner = config.get(str(key))
        if isinstance(inner, Config) and isinstance(value, dict):
            merge(inner, value)
        else:
            config[str(key)] = to_config(value)


def add(config: Config, entries: "Mapping") -> None:
    """Adds entries of nested dicts that a run's configuration lacks, in place; logs those that it has otherwise."""
    others = list(_added(config, entries, ""))
    if others:
        LOG.warning("The run determines %s.", ", ".join(others))


def _added(config: Config, entries: "Mapping", place: str) -> "Iterator[str]":
    """Adds entries, and yields text on each that has another value already."""
    for key, value in entries.items():
        present = config.setdefault(str(key), to_config(value))
        if isinstance(present, Config) and isinstance(value, dict):
            yield from _added(present, value, f"{place}{key}.")
        elif present != value:
            yield f"{place}{key}={present!r}, not {value!r}"


def override(config: Config, overrides: "Iterable[object] | None") -> None:
    """Changes a configuration, in place, by texts `path=value`, or by paths and values alternately.

    Raises:
        ValueError: a path has no value.
    """
    remaining = list(overrides or ())
    while remaining:
        path, separator, text = str(remaining.pop(0)).partition("=")
        if not separator and not remaining:
            raise ValueError(f"An override has the form path=value, got '{path}'.")
        tree: Any = text if separator else remaining.pop(0)
        tree = parsed(tree) if isinstance(tree, str) else tree
        for name in reversed(path.lstrip("+").split(".")):
            tree = {name: tree}
        merge(config, tree)


def parsed(text: str) -> object:
    """Returns the value of a text in JSON or Python, such as `false` and `False`; the text itself if it is neither."""
    for read in (json.loads, ast.literal_eval):
        with contextlib.suppress(ValueError, SyntaxError, MemoryError, RecursionError):
            return read(text)
    return text


def remove_other_actions(config: Config, known: "list[str]") -> "set[str]":
    """Removes the actions whose names are not known from a configuration; returns their names."""
    names = {name.lower() for name in known}
    new = config.get("habitat")
    removed = set()
    for tree, name in ((config.get("TASK"), "POSSIBLE_ACTIONS"), (new and new.get("task"), "actions")):
        listed = tree.get(name) if isinstance(tree, Config) else None
        if not isinstance(tree, Config) or not isinstance(listed, (list, Config)):
            continue
        others = {str(action) for action in listed if str(action).lower() not in names}
        if isinstance(listed, Config):
            tree[name] = Config({key: value for key, value in listed.items() if key not in others})
        else:
            tree[name] = [action for action in listed if str(action) not in others]
        removed |= others
    return removed


class StandIn(Loader):
    """An entry of `sys.meta_path` that provides `HABITAT_MODULES`.

    Args:
        objects: the objects by their names in Habitat.
    """

    def __init__(self, objects):
        self._objects = objects

    def find_spec(self, fullname, path=None, target=None):
        """Returns the specification of a module of the stand-in; raises ModuleNotFoundError for others of Habitat."""
        if fullname.partition(".")[0] != "habitat":
            return None
        if fullname not in HABITAT_MODULES:
            raise ModuleNotFoundError(f"'{fullname}' {NOT_IN_THE_STAND_IN}", name=fullname)
        is_package = any(name.startswith(fullname + ".") for name in HABITAT_MODULES)
        return ModuleSpec(fullname, self, is_package=is_package)

    def create_module(self, spec):
        """Returns a module whose other names are refused with their reason."""
        return _Module(spec.name)

    def exec_module(self, module):
        """Adds the names to a module; for the package `habitat`, it imports all modules of the stand-in."""
        self._fill(module)
        if module.__name__ == "habitat":
            modules = [importlib.import_module(name) for name in HABITAT_MODULES]
            for part in modules:
                self._fill(part)  # again: a function may have the name of a module

    def _fill(self, module):
        vars(module).update({name: self._objects[name] for name in HABITAT_MODULES[module.__name__].split()})


class _Module(ModuleType):
    def __getattr__(self, name: str) -> object:
        raise AttributeError(f"'{self.__name__}.{name}' {NOT_IN_THE_STAND_IN}")


class EmptyModules(Loader):
    """The last entry of `sys.meta_path`: it provides `EMPTY_PACKAGES` that are not installed."""

    def __init__(self):
        self.imported = []
        """The packages that were imported."""

    def find_spec(self, fullname, path=None, target=None):
        """Returns the specification of a module of these packages."""
        return ModuleSpec(fullname, self, is_package=True) if fullname.split(".")[0] in EMPTY_PACKAGES else None

    def create_module(self, spec):
        """Returns a module that has each name, as an `_Unusable`."""
        if "." not in spec.name:
            self.imported.append(spec.name)
            LOG.info("%s is not installed: empty modules take its place.", spec.name)
        return _EmptyModule(spec.name)

    def exec_module(self, module):
        """Does nothing."""


class _EmptyModule(ModuleType):
    def __getattr__(self, name: str) -> object:
        if name.startswith("__"):
            raise AttributeError(name)
        return _Unusable(f"{self.__name__}.{name}")


class _Unusable:
    """An object of a package that is not installed: it can be imported, and not used."""

    def __init__(self, name):
        self._name = name

    def __call__(self, *_: object, **__: object) -> object:
        package = self._name.split(".")[0]
        raise ImportError(f"'{self._name}' is used, but {package} is not installed", name=self._name)

    __mro_entries__ = __call__

    def __getattr__(self, name: str) -> object:
        if name.startswith("__"):
            raise AttributeError(name)
        return self()


class Agent:
    """Base class of agents with Habitat's interface."""

    def reset(self):
        """Prepares for an episode; called before each one."""
        raise NotImplementedError

    def act(self, observations):
        """Returns the action for the observations: a number, a name, or a dict with the key `action`."""
        raise NotImplementedError


class _Benchmark:
    """Gives the agent of an evaluation script to the simulator, which runs the episodes; the script ends there."""

    def __init__(self, config_paths=None, eval_remote=False, **options):
        if eval_remote:
            raise ValueError("eval_remote must be False: there is no evaluation server.")

    def evaluate(self, agent, num_episodes=None):
        """Serves the agent until the simulator ends, and then ends the script."""
        serve(agent)
        sys.exit(0)


class _Challenge(_Benchmark):
    """Habitat's loop for challenges."""

    def __init__(self, eval_remote=False, **options):
        _Benchmark.__init__(self, None, eval_remote)

    def submit(self, agent):
        """Serves the agent until the simulator ends, and then ends the script."""
        self.evaluate(agent)


class _Env:
    """Refuses to be made: the episodes run in the simulator."""

    def __init__(self, *_: object, **__: object) -> None:
        raise RuntimeError(
            "An agent has no episodes of its own here: `stubborn habitat setup` makes an environment with habitat-lab"
        )


class HabitatActions:
    """Habitat's table of action numbers: attribute, item and iteration, in lower or upper case."""

    def __getattr__(self, name: str) -> int:
        if name.lower() not in HABITAT_ACTIONS:
            raise AttributeError("HabitatSimActions has no '{}'. It has: {}.".format(name, ", ".join(HABITAT_ACTIONS)))
        return HABITAT_ACTIONS[name.lower()]

    def __getitem__(self, name: str) -> int:
        return HABITAT_ACTIONS[name.lower()]

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and name.lower() in HABITAT_ACTIONS

    def __iter__(self):
        return iter(HABITAT_ACTIONS)

    def __len__(self) -> int:
        return len(HABITAT_ACTIONS)

    def has_action(self, name: str) -> bool:
        """Returns whether there is an action of this name."""
        return name in self


class _Record(SimpleNamespace):
    """An object with attributes, in place of Habitat's classes of episodes."""


def _get_config(config_path=None, overrides=None, configs_dir=None, *, config_paths=None, opts=None):
    """Returns the configuration of the run, with what YAML files add to it, changed by overrides."""
    config_path = config_paths if config_path is None else config_path
    overrides = opts if overrides is None else overrides
    config = _config_of_the_run()
    known = list(config.TASK.POSSIBLE_ACTIONS)
    paths = config_path.split(",") if isinstance(config_path, str) else [str(path) for path in config_path or ()]
    for path in paths:
        if not os.path.isfile(path):
            LOG.warning("There is no configuration file '%s': the task of the run is used.", path)
            continue
        add(config, _read_yaml(path))
    override(config, overrides)
    removed = remove_other_actions(config, known)
    if removed:
        LOG.warning(NOT_DECLARED, ", ".join(sorted(removed)))
    return config


def _read_yaml(path: str) -> dict:
    """Returns the content of a file, read with PyYAML of the agent's environment."""
    yaml = importlib.import_module("yaml")
    with open(path) as file:
        content = yaml.safe_load(file) or {}
    if not isinstance(content, dict):
        raise ValueError(f"The configuration file '{path}' must hold a mapping, not a {type(content).__name__}.")
    return content


def _config_of_the_run() -> Config:
    """Returns the configuration that the simulator has sent."""
    request = Link.of_this_process().first[0] or {}
    return to_config(request.get("setup", {}).get("config", {}))


def _provide_habitat():
    """Makes `import habitat` work in this process if Habitat is not installed, and the import of `EMPTY_PACKAGES`."""
    sys.meta_path.append(EmptyModules())
    spec = importlib.util.find_spec("habitat")
    if spec is not None and spec.origin is not None:  # a folder of this name has no origin
        return
    LOG.addHandler(logging.StreamHandler())
    LOG.setLevel(logging.INFO)
    LOG.info("Habitat is not installed: stubborn_client.py provides those of its names that are imported.")
    sys.meta_path.insert(0, StandIn(stand_ins(get_config=_get_config)))


def stand_ins(**others):
    """Returns the objects of the stand-in by their names; `others` replace or complete them."""
    objects = {
        "Agent": Agent, "Benchmark": _Benchmark, "Challenge": _Challenge, "Config": Config, "Env": _Env,
        "HabitatSimActions": HabitatActions(), "ObjectGoal": _Record, "ObjectGoalNavEpisode": _Record,
        "Observations": Observation, "RLEnv": _Env, "ShortestPathFollower": _Env, "logger": LOG,
        "read_write": read_write,
    }  # fmt: skip
    objects.update(others)
    return objects


def _maker_of(name, words):
    """Returns a function that makes the agent `package.module:CLASS` with the arguments NAME=VALUE."""
    other = next((word for word in words if "=" not in word), None)
    if other is not None:
        sys.exit(f"The arguments of '{name}' have the form NAME=VALUE, got '{other}'.")

    def make(_):
        module, _, attribute = name.partition(":")
        build = getattr(importlib.import_module(module), attribute)
        arguments = dict(word.split("=", 1) for word in words)
        arguments = {key: called(parsed(text)) for key, text in arguments.items()}
        for argument in inspect.signature(build).parameters.values():
            if argument.name in OF_THE_RUN and argument.default is argument.empty and takes_config(argument):
                file = arguments.get(argument.name)
                if file is None or isinstance(file, str):
                    arguments[argument.name] = _get_config(file)
        return build(**arguments)

    return make


def takes_config(argument: inspect.Parameter) -> bool:
    """Returns whether an argument of an agent's constructor can be a configuration, not the name of a file."""
    return argument.annotation not in (str, "str")


def called(value: object) -> object:
    """Returns the result of the function that a text `module:NAME()` names; returns any other value unchanged."""
    call = CALL.fullmatch(value) if isinstance(value, str) else None
    if call is None:
        return value
    return getattr(importlib.import_module(call.group(1)), call.group(2))()


def main(words):
    """Runs code that is written for Habitat: a script with its arguments, or a class with those of its constructor."""
    if not words:
        sys.exit("stubborn_client.py needs a script, or package.module:CLASS, of an agent written for Habitat.")
    sys.modules["stubborn_client"] = sys.modules["__main__"]  # for agents that import it
    request = Link.of_this_process().first[0]
    if request is not None and request["setup"].get("interface") != "habitat":
        sys.exit("Give --config agent.interface=habitat, or end your program with stubborn_client.serve(agent)")
    _provide_habitat()
    if not os.path.isfile(words[0]) and ":" in words[0]:
        sys.argv, sys.path[0] = words[:1], os.getcwd()
        return serve(_maker_of(words[0], words[1:]))
    sys.argv, sys.path[0] = words, os.path.dirname(os.path.abspath(words[0]))
    runpy.run_path(words[0], run_name="__main__")
    sys.exit(f"'{words[0]}' has given no agent to habitat.Benchmark, habitat.Challenge or stubborn_client.serve.")


if __name__ == "__main__":
    main(sys.argv[1:])
