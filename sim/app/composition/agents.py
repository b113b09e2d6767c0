"""Finds agents by name: those of `stubborn`, the oracle of `sim`, and your own.

Your own are named `package.module:NAME`, `habitat:package.module:CLASS` if they have Habitat's interface, or
`process:COMMAND` if they run in another process.
"""

from __future__ import annotations

import contextlib
import dataclasses
import inspect
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Protocol, cast

from sim.app.bridges.process_command import ProcessConfig, fault_of_namespaces, is_bounded
from sim.app.composition.imports import import_attribute
from sim.app.evaluation.own_code import described
from sim.app.evaluation.watch import FACTORY_S, is_stop, marked
from sim.app.options import HABITAT, is_process
from sim.app.services.vlm import agent as vlm
from sim.core.errors import AgentError, ConfigError, ObjectNavError, did_you_mean
from sim.core.interface import Agent, AgentFactory, AgentSpec, CameraModel, Closable, RobotModel, Segmenter, SuccessRule
from sim.core.paths import assets_dir
from sim.houses.sidecar import sidecar_path
from stubborn import agents
from stubborn.agent import AgentConfig
from stubborn.detection.verification import Verifier
from stubborn.exploration.explorer import ExplorerConfig

if TYPE_CHECKING:  # a list of the agents needs neither MuJoCo nor OpenGL
    from sim.env.objectnav import ObjectNavEnv
    from sim.episodes.splits import Split
    from sim.task.config import TaskConfig


def _make_oracle(*, truth: ObjectNavEnv, **_: object) -> Agent:
    from sim.env.oracle import Oracle

    return Oracle(truth)


SPECS: Mapping[str, AgentSpec] = MappingProxyType(
    {
        **agents.SPECS,
        "vlm": vlm.SPEC,
        "oracle": AgentSpec(
            make=_make_oracle,
            description="follows the true shortest path; an upper bound",
            sensors=(),
            uses_segmentation=False,
            uses_ground_truth=True,
            words=(),
            pictures=(),
        ),
    }
)
"""The agents that `--agent` takes by name."""
EXPLORERS: Mapping[str, ExplorerConfig] = agents.EXPLORERS
"""The explorers that `--explorer` takes by name."""


def find_agent(name: str) -> AgentSpec:
    """Returns the specification of an agent.

    Args:
        name: one of `SPECS`, or `package.module:NAME`, where NAME is an `AgentSpec` or a factory. A plain factory
            declares nothing, so that its agent gets RGB and depth and no ground truth; the same holds for
            `process:COMMAND`. After `habitat:`, NAME is a class, a factory or an `AgentSpec` of agents with Habitat's
            interface (`sim.app.bridges.habitat.agents`).

    Raises:
        ConfigError: the name is unknown.
    """
    if name in SPECS:
        return SPECS[name]
    if name.startswith(HABITAT):
        return _find_habitat_agent(name)
    if is_process(name):
        from sim.app.bridges.process import process_spec

        return process_spec(name)
    if not all(name.partition(":")[1:]):
        raise ConfigError(
            f"Unknown agent '{name}'.{did_you_mean(name, SPECS)}"
            f" Available: {', '.join(SPECS)}, or your own as package.module:NAME, "
            "habitat:package.module:CLASS, or in a process of its own as process:COMMAND."
        )
    declared = import_attribute(name)
    if isinstance(declared, AgentSpec):
        return declared
    if not callable(declared):
        raise ConfigError(f"Agent '{name}' must be an AgentSpec or a factory, got {type(declared).__name__}.")
    return AgentSpec(make=cast(AgentFactory, declared), description=(inspect.getdoc(declared) or "").partition("\n")[0])


def _find_habitat_agent(name: str) -> AgentSpec:
    """Returns the specification of an agent with Habitat's interface; see `find_agent`."""
    from sim.app.bridges.habitat import agents as bridge
    from sim.app.bridges.habitat import stand_in

    if not all(name.removeprefix(HABITAT).partition(":")):
        raise ConfigError(f"--agent '{name}' must have the form habitat:package.module:CLASS.")
    stand_in.install()
    with bridge.own_command_line():
        declared = import_attribute(name, stand_in.lacking, prefix=HABITAT)
    return bridge.spec_of(name, declared)


def notes_on(name: str, config: object) -> tuple[str, ...]:
    """Returns sentences about an agent with a configuration after `find_agent`; a run prints them in its header."""
    if isinstance(config, ProcessConfig) and config.boundary == "auto" and not is_bounded(config):
        return (f"The agent's process has no boundary, since namespaces are not possible: {fault_of_namespaces()}.",)
    if not name.startswith(HABITAT):
        return ()
    from sim.app.bridges.habitat import stand_in

    return (stand_in.NOTE,) if stand_in.installed() else ()


def find_explorer(name: str) -> ExplorerConfig:
    """Returns the configuration of an explorer, whose `make` builds it.

    Args:
        name: one of `stubborn.agents.EXPLORERS`, or `package.module:NAME`, where NAME is such a configuration.

    Raises:
        ConfigError: there is no such explorer.
    """
    if name in agents.EXPLORERS:
        return agents.EXPLORERS[name]
    if not all(name.partition(":")[1:]):
        raise ConfigError(
            f"Unknown --explorer '{name}'.{did_you_mean(name, agents.EXPLORERS)} Available: "
            f"{', '.join(agents.EXPLORERS)}, or your own as package.module:NAME."
        )
    declared = import_attribute(name)
    if not dataclasses.is_dataclass(declared) or isinstance(declared, type) or not isinstance(declared, ExplorerConfig):
        got = "the class" if isinstance(declared, type) else f"'{type(declared).__name__}'"
        raise ConfigError(
            f"--explorer '{name}' must be an object of a dataclass with a method make(camera); got {got}. "
            "docs/agents.md has an example."
        )
    return declared


def takes_explorer(spec: AgentSpec) -> bool:
    """Returns whether an agent explores with the explorer that `--explorer` names."""
    return isinstance(spec.config, AgentConfig)


class KnownRobot(Protocol):
    """The facts of robot and task that an agent may know: an `ObjectNavEnv` has them, and so has any other robot."""

    @property
    def camera_model(self) -> CameraModel: ...  # noqa: D102
    @property
    def robot_model(self) -> RobotModel: ...  # noqa: D102
    @property
    def success_rule(self) -> SuccessRule: ...  # noqa: D102
    @property
    def task_config(self) -> TaskConfig: ...  # noqa: D102


def build_agent(
    name: str,
    spec: AgentSpec,
    env: KnownRobot,
    *,
    segmenter: Segmenter,
    verifier: Verifier,
    config: object,
    step_timeout_s: float = 0.0,
    out: Path | None = None,
) -> Agent:
    """Returns a new agent for an environment.

    Args:
        name: as for `find_agent`.
        spec: its specification.
        env: the environment.
        segmenter, verifier, config: its parts.
        step_timeout_s: largest time of its calls; 0: no limit.
        out: folder of the results, which an agent in namespaces does not see.

    Raises:
        ConfigError: the factory does not take the arguments of `sim.core.interface.AgentFactory`.
    """
    parts: dict[str, object] = {
        "camera": env.camera_model,
        "robot": env.robot_model,
        "success": env.success_rule,
        "segmenter": segmenter,
        "verifier": verifier,
        "config": config,
    }
    if spec.uses_ground_truth:
        parts["truth"] = env
    if is_process(name):
        parts["hidden"] = hidden_from_agents(env, out)
    try:
        with marked(f"Agent '{name}', its factory", FACTORY_S):
            return spec.build(name, max_steps=env.task_config.max_steps, step_timeout_s=step_timeout_s, **parts)
    except BaseException as error:
        if isinstance(error, ConfigError) and _resets_without_arguments(spec.make):
            raise ConfigError(
                f"{error} An agent with Habitat's interface is given as --agent habitat:{name}."
            ) from None
        if is_stop(error) or (isinstance(error, ObjectNavError) and not isinstance(error, AgentError)):
            raise
        raise ConfigError(f"Agent '{name}' cannot be built: {described(error, below=__file__)}") from error


def free_agent(agent: Agent | None) -> None:
    """Frees what an agent holds, such as a process; errors of the user's code are dropped, as its results are there."""
    if isinstance(agent, Closable):
        with contextlib.suppress(Exception):
            agent.close()


def hidden_from_agents(env: KnownRobot, out: Path | None) -> list[Path]:
    """Returns the files and folders that an agent in namespaces does not see: houses, episodes and results."""
    split: Split | None = getattr(env, "split", None)  # a robot elsewhere has none
    here, files = Path.cwd(), [Path(file).resolve() for file in (split.house_paths.values() if split else ())]
    folders = {assets_dir().resolve(), *([] if out is None else [out.resolve()])}
    folders |= {file.parent for file in files if not here.is_relative_to(file.parent)}
    single = {path for file in files if here.is_relative_to(file.parent) for path in (file, sidecar_path(file))}
    paths = sorted(path for path in (*folders, *single) if path.exists())
    return [path for path in paths if not any(path != other and path.is_relative_to(other) for other in folders)]


def _resets_without_arguments(factory: object) -> bool:
    """Returns whether a class has the methods of a Habitat agent, `reset()` and `act(observations)`."""
    if not inspect.isclass(factory) or not callable(getattr(factory, "act", None)):
        return False
    reset = getattr(factory, "reset", None)
    return inspect.isfunction(reset) and len(inspect.signature(reset).parameters) == 1
