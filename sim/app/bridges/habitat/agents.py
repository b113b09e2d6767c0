"""Runs agents with Habitat's interface as agents of this project: `--agent habitat:package.module:CLASS`.

The fields of the agent's configuration are the arguments of the class's constructor and `BRIDGE_FIELDS`;
`--config agent.KEY=VALUE` sets them. A required argument called `config` or `task_config` gets the configuration of the
run (`sim.app.bridges.habitat.config.make_config`), with the entries of a YAML file if its value names one. A value of
the form `module:NAME()` is replaced by the result of that function; `--config` may have one, a settings file may not.
"""

from __future__ import annotations

import contextlib
import dataclasses
import inspect
import sys
import typing
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from sim.app.bridges.habitat.config import keeping_looks, make_config, with_entries_of
from sim.app.bridges.habitat.conversions import Conversion, to_action
from sim.app.bridges.habitat_client import OF_THE_RUN, Config, called, takes_config
from sim.app.bridges.process_command import BridgeConfig
from sim.app.bridges.stubborn_client import seed_generators
from sim.core.errors import ConfigError
from sim.core.interface import Action, AgentSpec, CameraModel, Observation, RobotModel, SuccessRule

Json = bool | int | float | str | list | dict | None
"""Allowed values of an argument whose annotation is not in `_PLAIN`."""
_PLAIN = (bool, int, float, str)
BRIDGE_FIELDS: tuple[tuple[str, Any, Any], ...] = (
    ("categories", str, "mp3d"),
    ("normalize_depth", bool, True),
)
"""Name, type and default of the fields that `Conversion` takes."""


class HabitatAgent:
    """An agent of this project (`sim.core.interface.Agent`) that calls an agent with Habitat's interface.

    Args:
        agent: an object with `reset()` and `act(observations)`.
        conversion: converts the observations.
    """

    def __init__(self, agent: Any, conversion: Conversion) -> None:
        self.agent, self._conversion, self._seed = agent, conversion, 0

    def reset(self, goal: str, seed: int) -> None:
        """Starts an episode. Habitat's agents get no seed; therefore this method seeds the global generators.

        Raises:
            AgentError: the agent's data set has no such goal category.
        """
        self._conversion.goal_number(goal)
        self._seed = seed
        seed_generators(seed)
        self.agent.reset()

    def next_goal(self, goal: str) -> None:
        """Gives the agent the next goal of a chain; an agent without a method `next_goal` is reset.

        Raises:
            AgentError: as `reset`.
        """
        if callable(getattr(self.agent, "next_goal", None)):
            self._conversion.goal_number(goal)
            self.agent.next_goal(goal)
        else:
            self.reset(goal, self._seed)

    def act(self, observation: Observation) -> Action:
        """Returns the next action.

        Raises:
            AgentError: the agent returned something other than an action.
        """
        return to_action(self.agent.act(self._conversion.observations(observation)))


def spec_of(name: str, declared: object) -> AgentSpec:
    """Returns the declaration of an agent with Habitat's interface.

    Args:
        name: the agent's name, for messages.
        declared: a class or factory of such agents, whose sensors `--config sensors=[...]` declares; or an `AgentSpec`
            whose `make` returns such an agent.

    Raises:
        ConfigError: it has another type, or an argument of the constructor has the name of a field of the bridge.
    """
    if isinstance(declared, AgentSpec):
        return _wrapped(name, declared)
    if not callable(declared):
        raise ConfigError(f"Agent '{name}' must be a class, a factory or an AgentSpec, got {type(declared).__name__}.")
    arguments = _arguments(declared)
    own = {"looks", *(field[0] for field in BRIDGE_FIELDS)}
    taken = own & {argument.name for argument in arguments}
    if taken:
        raise ConfigError(
            f"Agent '{name}' has an argument '{min(taken)}', which is also a field of the bridge; give a function "
            "without this argument that makes the agent."
        )
    config = _config_of(declared, arguments)

    def make(
        *,
        camera: CameraModel,
        robot: RobotModel,
        success: SuccessRule,
        config: BridgeConfig,
        max_steps: int,
        **_: object,
    ) -> HabitatAgent:
        of_the_run = make_config(camera=camera, robot=robot, success=success, max_steps=max_steps, looks=config.looks)
        positional, by_name = _values(name, arguments, config, of_the_run)
        with own_command_line(), keeping_looks(config.looks):
            agent = declared(*positional, **by_name)
        _require_methods(name, agent)
        return HabitatAgent(agent, _conversion(camera, config))

    description = (inspect.getdoc(declared) or "").partition("\n")[0]
    return AgentSpec(make=make, description=description, config=config, uses_segmentation=False, goals=_goals)


@contextlib.contextmanager
def own_command_line() -> Iterator[None]:
    """Hides the options of this process from code that reads `sys.argv` inside the `with` block."""
    before = sys.argv
    sys.argv = before[:1]
    try:
        yield
    finally:
        sys.argv = before


def _wrapped(name: str, spec: AgentSpec) -> AgentSpec:
    """Returns a specification of agents of this project, from one whose agents have Habitat's interface."""

    def make(*, camera: CameraModel, max_steps: int, **parts: Any) -> HabitatAgent:
        with own_command_line(), keeping_looks(spec.looks):
            agent: Any = spec.build(name, max_steps=max_steps, camera=camera, **parts)
        _require_methods(name, agent)
        return HabitatAgent(agent, _conversion(camera, parts["config"]))

    painter = spec.painter
    draw: Callable[[Any], Any] | None = None if painter is None else lambda adapter: painter(adapter.agent)
    return dataclasses.replace(spec, make=make, painter=draw, goals=_goals)


def _conversion(camera: CameraModel, config: BridgeConfig) -> Conversion:
    """Returns the conversion that an agent's configuration describes."""
    return Conversion(camera=camera, **{field: getattr(config, field, default) for field, _, default in BRIDGE_FIELDS})


def _goals(config: BridgeConfig) -> tuple[str, ...]:
    """Returns the goal categories that the agent knows."""
    return _conversion(CameraModel(), config).goals


def _require_methods(name: str, agent: object) -> None:
    """Raises ConfigError if an object is not an agent with Habitat's interface."""
    missing = [method for method in ("reset", "act") if not callable(getattr(agent, method, None))]
    if missing:
        raise ConfigError(f"Agent '{name}': a {type(agent).__name__} has no method {' and '.join(missing)}.")


def _arguments(make: Callable[..., object]) -> list[inspect.Parameter]:
    """Returns the arguments of a class or factory, except for *args; an empty list if Python does not know them."""
    try:
        signature = inspect.signature(make)
    except (TypeError, ValueError):
        return []
    return [
        argument for argument in signature.parameters.values() if argument.kind is not inspect.Parameter.VAR_POSITIONAL
    ]


def _config_of(make: Callable[..., object], arguments: list[inspect.Parameter]) -> BridgeConfig:
    """Returns a frozen dataclass object with the arguments and the fields of the bridge, with their defaults."""
    fields: list[Any] = []
    hints = _hints(make)
    for argument in arguments:
        if argument.kind is inspect.Parameter.VAR_KEYWORD:
            fields.append((argument.name, dict[str, Json] | None, None))
            continue
        kind: Any = hints.get(argument.name)
        shown = _shown(argument)
        plain = kind in _PLAIN and isinstance(shown, (kind, type(None)))
        fields.append((argument.name, kind | None if plain else Json, shown))
    fields += BRIDGE_FIELDS
    checked = {"__post_init__": _goals}  # refuses values that are not allowed
    return dataclasses.make_dataclass(
        "HabitatAgentConfig", fields, bases=(BridgeConfig,), frozen=True, kw_only=True, namespace=checked
    )()


def _hints(make: Callable[..., object]) -> dict[str, object]:
    """Returns the annotations of a class's constructor or of a factory; an empty dict if they cannot be read."""
    try:
        return typing.get_type_hints(make.__init__ if isinstance(make, type) else make)
    except Exception:  # names that exist only for type checkers
        return {}


def _shown(argument: inspect.Parameter) -> bool | int | float | str | None:
    """Returns the default of an argument for the configuration; None if it is required, or not a plain value."""
    default = argument.default
    if isinstance(default, Path):
        return str(default)
    plain = isinstance(default, (bool, int, float, str)) and type(default) in _PLAIN
    return default if plain else None


def _values(
    name: str, arguments: list[inspect.Parameter], config: BridgeConfig, of_the_run: Config
) -> tuple[list[object], dict[str, object]]:
    """Returns the positional arguments and the arguments by name: those that are set, and the run's configuration.

    Raises:
        ConfigError: a required argument is not set.
    """
    positional: list[object] = []
    by_name: dict[str, object] = {}
    missing: list[str] = []
    for argument in arguments:
        chosen = getattr(config, argument.name)
        if argument.kind is inspect.Parameter.VAR_KEYWORD:
            by_name |= {key: _result(item) for key, item in (chosen or {}).items()}
            continue
        value = _result(chosen)
        required = argument.default is inspect.Parameter.empty
        if value is None and required and argument.name in OF_THE_RUN:
            value = of_the_run
        elif required and argument.name in OF_THE_RUN and isinstance(value, str) and _names_file(argument, value):
            value = with_entries_of(of_the_run, Path(value))
        elif value is None and required:
            missing.append(argument.name)
        if value is None or (not required and value == _shown(argument)):
            if argument.kind is inspect.Parameter.POSITIONAL_ONLY and not required:
                positional.append(argument.default)  # later ones keep their places
            continue
        if argument.kind is inspect.Parameter.POSITIONAL_ONLY:
            positional.append(value)
        else:
            by_name[argument.name] = value
    if missing:
        raise ConfigError(
            f"Agent '{name}' needs the argument {' and '.join(missing)}: give --config "
            + " ".join(f"agent.{argument}=VALUE" for argument in missing)
            + "."
        )
    return positional, by_name


def _names_file(argument: inspect.Parameter, value: str) -> bool:
    """Returns whether the value of an argument that takes a configuration names a YAML file."""
    return takes_config(argument) and value.endswith((".yaml", ".yml"))


def _result(value: object) -> object:
    """Returns the result of the function that a text `module:NAME()` names; returns any other value unchanged."""
    with own_command_line():
        return called(value)
