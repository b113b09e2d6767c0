"""The configuration tree of a run: everything besides the episode and the seed that determines its result."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, is_dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

from sim.composition.agents import find_agent, find_explorer
from sim.composition.options import RunOptions
from sim.composition.segmenters import KINDS, NetworkConfig, detector_config, file_sha256
from sim.configuration import as_json, parse_assignments, read_settings, with_fields
from sim.errors import ConfigError
from sim.evaluation.own_code import hash_of_own
from sim.interface import AgentSpec, CameraModel
from sim.paths import code_hash
from sim.robot.config import RobotConfig
from sim.robot.foreign import load_robot, robot_sha256
from sim.sensors.noise import NoiseConfig, get_noise
from sim.sensors.opengl import describe_gl
from sim.sensors.profiles import RenderProfile, get_profile
from sim.sensors.sensor import Sensor
from sim.task.config import TaskConfig
from stubborn.agent import AgentConfig
from stubborn.detection.verification import FittedVerifier, Verifier, verifier_for

NOT_RECORDED = ("list_agents", "retry_errors", "config", "config_file")
"""Options that the tree itself records, or that start no run."""


@dataclass(frozen=True, kw_only=True)
class VerificationConfig:
    """How the agent verifies a candidate before it stops."""

    method: str = "naive-bayes"
    """naive-bayes (the paper's), logistic, threshold or none."""
    parameters: Path | None = None
    """File of fitted parameters; None takes those shipped for the kind of segmentation."""
    least_probability: float | None = None
    """A candidate is accepted when it is true with a higher probability than this; None: that of the fit, which the
    configuration of a run holds in its place."""

    def __post_init__(self) -> None:
        if self.least_probability is not None and not 0.0 <= self.least_probability < 1.0:
            raise ConfigError(f"VerificationConfig.least_probability must lie in [0, 1), got {self.least_probability}.")


@dataclass(frozen=True, kw_only=True)
class RunConfig:
    """The tree that `config.json` records under "config" and whose fields `--config FIELD=VALUE` sets."""

    agent: Any
    """Configuration of the agent (`AgentSpec.config`); None: it has none."""
    detector: Any
    """Configuration of the segmentation (`SegmentationKind.config`); None: it has none."""
    verification: VerificationConfig
    robot: RobotConfig
    camera: CameraModel
    sensors: tuple[str, ...]
    """Sensors in the agent's observation, by name: those that agent and segmentation declare."""
    profile: RenderProfile
    noise: NoiseConfig
    task: TaskConfig


def configuration_of(options: RunOptions, spec: AgentSpec | None = None) -> RunConfig:
    """Returns the configuration tree of a run: presets by name, then the settings file, then `--config`.

    Args:
        options: of the run.
        spec: the agent's specification; that of `options.agent` when None.

    Raises:
        ConfigError: an unknown name, or a value that is not allowed.
    """
    spec = spec or find_agent(options.agent)
    robot, camera = (RobotConfig(), CameraModel()) if options.robot is None else load_robot(options.robot)
    tree = RunConfig(
        agent=_agent_config(options, spec),
        detector=detector_config(options.semantics, options.weights),
        verification=VerificationConfig(method=options.verification, parameters=options.verifier),
        robot=robot,
        camera=camera,
        sensors=_sensor_names(spec, options.semantics),
        profile=get_profile(options.profile),
        noise=get_noise(options.noise),
        task=TaskConfig(),
    )
    tree = with_fields(tree, _settings(options))
    tree = replace(tree, verification=_with_bar(options, tree.verification))
    missing = [name for name in _sensor_names(spec, options.semantics) if name not in tree.sensors]
    if missing:
        raise ConfigError(f"sensors: agent '{options.agent}' with {options.semantics} needs {', '.join(missing)}.")
    if "semantic" in tree.sensors and not spec.uses_ground_truth:
        raise ConfigError(
            f"sensors: 'semantic' is ground truth, and agent '{options.agent}' does not declare uses_ground_truth."
        )
    return tree


def verifier_of(options: RunOptions, config: VerificationConfig) -> Verifier:
    """Returns the verifier of a run.

    Raises:
        ConfigError: there are no such parameters, or no such method.
    """
    verifier = verifier_for(options.semantics, KINDS[options.semantics].spec, config.parameters, config.method)
    if isinstance(verifier, FittedVerifier) and config.least_probability is not None:
        return replace(verifier, least_probability=config.least_probability)
    return verifier


def _with_bar(options: RunOptions, config: VerificationConfig) -> VerificationConfig:
    """Returns the configuration with the probability that a candidate needs; that of the fit where none is set."""
    if config.least_probability is not None:
        return config
    verifier = verifier_of(options, config)
    fitted = verifier if isinstance(verifier, FittedVerifier) else FittedVerifier
    return replace(config, least_probability=fitted.least_probability)


def record_of(options: RunOptions, config: RunConfig, split: dict[str, Any]) -> dict[str, Any]:
    """Returns the content of `config.json`: options, configuration tree, checksums of files, split and versions."""
    flat = {name: value for name, value in as_json(options).items() if name not in NOT_RECORDED}
    return flat | {
        "settings": as_json(_settings(options)),
        "config": as_json(config),
        "files_sha256": _checksums(options, config),
        "split_identity": split,
        "versions": versions(options),
    }


def versions(options: RunOptions) -> dict[str, str]:
    """Returns the versions that a result depends on: packages, the GL renderer, and what `code_of` gives."""
    packages = ("stubborn-objectnav", "mujoco", "numpy")
    return {name: version(name) for name in packages} | {"gl_renderer": describe_gl(), "code": code_of(options)}


def code_of(options: RunOptions) -> str:
    """Returns a hash of the code of a run, such as "3353e768d2c2".

    With an agent or explorer of the user, whose modules are imported by now, "+" and a hash of these follow.
    """
    names = [name for name in (options.agent, options.explorer) if name is not None]
    own = hash_of_own(module for module, separator, _ in (name.partition(":") for name in names) if separator)
    return f"{code_hash()}+{own}" if own else code_hash()


def truth_images(spec: AgentSpec, semantics: str) -> tuple[str, ...]:
    """Returns the true images that the segmentation of an agent reads in the environment."""
    return KINDS[semantics].spec.truth if spec.uses_segmentation else ()


def _settings(options: RunOptions) -> dict[str, Any]:
    """Returns path and value of each field that the settings file or `--config` sets."""
    settings = {} if options.config_file is None else read_settings(options.config_file)
    return settings | parse_assignments(options.config)


def _agent_config(options: RunOptions, spec: AgentSpec) -> Any:
    """Returns the default configuration of the agent, with the explorer of `--explorer`."""
    if options.explorer is None:
        return spec.config
    if not isinstance(spec.config, AgentConfig):
        raise ConfigError(f"--explorer: agent '{options.agent}' takes no explorer.")
    return replace(spec.config, explorer=find_explorer(options.explorer))


def sensors_of(spec: AgentSpec, config: RunConfig) -> tuple[str | Sensor, ...]:
    """Returns the sensors of the observation: the agent's own objects, and names of standard sensors."""
    own = {each.name: each for each in spec.sensors if not isinstance(each, str)}
    return tuple(own.get(name, name) for name in config.sensors)


def _sensor_names(spec: AgentSpec, semantics: str) -> tuple[str, ...]:
    own = [each if isinstance(each, str) else each.name for each in spec.sensors]
    read = (*own, *(("depth", *KINDS[semantics].spec.sensors) if spec.uses_segmentation else ()))
    return tuple(dict.fromkeys(read))


def _checksums(options: RunOptions, config: RunConfig) -> dict[str, str]:
    """Returns the SHA-256 of the user's or shipped files that the result depends on."""
    found = {}
    if isinstance(config.detector, NetworkConfig):
        found["weights"] = file_sha256(config.detector.weights)
    if config.verification.parameters is not None:
        found["verifier"] = file_sha256(config.verification.parameters)
    if options.robot is not None:
        found["robot"] = robot_sha256(options.robot)
    return found | {name: file_sha256(file) for name, file in _files_in(config.agent, "agent")}


def _files_in(tree: Any, name: str) -> Iterator[tuple[str, Path]]:
    """Yields path and file of each field of a configuration that names a file, such as weights of an explorer."""
    if is_dataclass(tree) and not isinstance(tree, type):
        for field in fields(tree):
            yield from _files_in(getattr(tree, field.name), f"{name}.{field.name}")
    elif isinstance(tree, (str, Path)) and Path(tree).suffix and Path(tree).is_file():
        yield name, Path(tree)
