"""Builds the `Setup` of a run from its options. Every name is looked up here, once, and never again later.

Environment, agent, viewers, results and workers are made from the setup (`sim.app.composition.runner`, `record`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Annotated, Any

from sim.app.bridges.process_command import BridgeConfig
from sim.app.composition.agents import find_agent, find_explorer, takes_explorer
from sim.app.composition.segmenters import (
    NetworkConfig,
    SegmentationKind,
    detector_config,
    find_segmentation,
    is_calibrated,
)
from sim.app.composition.transfer import Reference, Unpacker, packed
from sim.app.evaluation.parallel import Shard
from sim.app.options import WORLD, RunOptions
from sim.app.viewers import selection
from sim.core.configuration import parse_assignments, read_settings, with_absolute_paths, with_fields
from sim.core.errors import ConfigError
from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES, TRUE_IMAGES, AgentSpec, CameraModel, SegmenterSpec, reads_truth
from sim.core.invocation import command
from sim.core.reading import printable
from sim.episodes.habitat import IndexFile
from sim.episodes.splits import Split, absolute_split, read_index
from sim.houses.references import require_root
from sim.renderer.mounted import CameraConfig
from sim.renderer.profiles import RenderProfile, get_profile
from sim.robot.config import RobotConfig
from sim.robot.foreign import absolute_robot, load_robot, robot_cameras
from sim.sensors.cameras import camera_sensors, cameras_by_name
from sim.sensors.noise import NoiseConfig, get_noise
from sim.sensors.scan import ScanConfig
from sim.sensors.sensor import Sensor
from sim.task.config import TaskConfig
from stubborn.detection.verification import (
    ACCEPT_ALL,
    DEFAULT_KIND,
    FittedVerifier,
    Verifier,
    has_parameters,
    verifier_for,
)

MAX_KEY_LENGTH = 200
"""Largest length of `--seed-key`."""


@dataclass(frozen=True, kw_only=True)
class VerificationConfig:
    """Selects how the agent verifies a candidate before it stops."""

    method: str = "naive-bayes"
    """`naive-bayes` (the paper's) or `none`."""
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
    robot: Annotated[RobotConfig, WORLD]
    camera: Annotated[CameraModel, WORLD]
    sensors: tuple[str, ...]
    """Sensors in the agent's observation, by name: those that agent and segmentation declare."""
    cameras: Annotated[Mapping[str, CameraConfig], WORLD]
    """Further cameras by name, `cameras.left.yaw_deg=60`; their images are `left_rgb`, `left_depth`, ..."""
    scan: Annotated[ScanConfig, WORLD]
    """The lidar of the sensor `scan`."""
    profile: Annotated[RenderProfile, WORLD]
    noise: Annotated[NoiseConfig, WORLD]
    task: Annotated[TaskConfig, WORLD]


@dataclass(frozen=True, kw_only=True)
class Setup:
    """Everything that determines the results of a run except episode and seed, looked up once from its options.

    A worker gets it by value; a user's code travels as its name (`sim.app.composition.transfer`).
    """

    options: RunOptions
    agent: AgentSpec
    """The agent that `options.agent` names, as its code declares it."""
    segmentation: SegmentationKind
    """The segmentation that `options.semantics` names."""
    config: RunConfig
    settings: Mapping[str, object]
    """Path and value of each field that the settings file or `--config` sets."""
    verifier: Verifier
    shard: Shard | None
    """The part of the episodes that `--shard` chooses; None: all."""
    start: Pose | None
    """With `--house`, the start of every episode; None: starts are sampled."""
    planned: str | None = None
    """Checksum of the split or house from which the episodes were planned; None: it is not checked."""

    def __reduce__(self) -> tuple[Callable[[bytes], Setup], tuple[bytes]]:
        """Returns the form for pickling."""
        return _received, (packed(vars(self), dict(self._own_code())),)

    def _own_code(self) -> Iterator[tuple[int, Reference]]:
        """Yields the `id` of each object of the user's code, and its name."""
        objects = {"agent": self.agent, "semantics": self.segmentation}
        explorer = getattr(self.config.agent, "explorer", None)
        configs = {"agent": self.config.agent, "explorer": explorer, "semantics": self.config.detector}
        for option, name in self.options.own_code.items():
            if option in objects:
                yield id(objects[option]), Reference(option, name)
            if configs[option] is not None:
                yield id(type(configs[option])), Reference(option, name, "class")

    def with_absolute_paths(self) -> Setup:
        """Returns this setup with absolute paths, which stay valid if the current folder changes."""
        robot, given = self.config.robot, self.options.robot
        if robot.file is not None:
            robot = replace(robot, file=with_absolute_paths(robot.file))
        options = with_absolute_paths(self.options)
        options = replace(options, split=absolute_split(options.split), robot=given and absolute_robot(given))
        return replace(self, options=options, config=replace(self.config, robot=robot))

    def require_planned(self, split: Split) -> None:
        """Raises ConfigError if a split is not the one from which the episodes were planned."""
        if self.planned not in (None, split.sha256):
            raise ConfigError(
                f"The houses or episodes of '{split.name}' have changed since this run was planned; start it again."
            )

    @property
    def spec(self) -> AgentSpec:
        """The declaration of the agent; `--config` declares the sensors and the actions of code that cannot."""
        config, sensors = self.config.agent, self.config.sensors
        if not isinstance(config, BridgeConfig):
            return self.agent
        return replace(
            self.agent, sensors=sensors, looks=config.looks, uses_ground_truth=any(map(reads_truth, sensors))
        )

    @property
    def sensors(self) -> tuple[str | Sensor, ...]:
        """The sensors of the observation: the agent's own objects, and names of standard sensors."""
        own = {sensor.name: sensor for sensor in _own_sensors(self.spec, self.segmentation)}
        return tuple(own.get(name, name) for name in self.config.sensors)

    @property
    def truth(self) -> tuple[str, ...]:
        """The true images that the agent's segmentation reads in the environment."""
        return self.segmentation.spec.truth if self.spec.uses_segmentation else ()

    @property
    def uses_ground_truth(self) -> bool:
        """True: the agent, one of its sensors or a user's segmentation declares ground truth.

        The segmentations that ship do not count here, because `semantics` names them.
        """
        own = self.segmentation.own if self.spec.uses_segmentation else None
        return self.spec.uses_ground_truth or (own is not None and own.spec.uses_ground_truth)

    @property
    def segmentation_name(self) -> str:
        """Name of the segmentation that the agent acts on, as it is shown to users; "" if it has none."""
        if not self.spec.uses_segmentation:
            return self.spec.own_segmentation
        return "ground truth" if self.options.semantics == "gt" else self.options.semantics

    @property
    def borrowed_parameters(self) -> str:
        """A sentence if no parameters are fitted to this kind of segmentation, so that others are used; else ""."""
        spec, chosen = self.segmentation.spec, self.config.verification
        if not self.spec.uses_segmentation or not spec.needs_verification or has_parameters(spec.kind):
            return ""
        if chosen.parameters is not None or chosen.method == ACCEPT_ALL:
            return ""
        return (
            f"No parameters are fitted to segmentation of kind '{spec.kind}': verification and fusion use those of "
            f"'{DEFAULT_KIND}' (`{command('train', 'verifier')}` and `{command('train', 'fusion')}` fit your own). "
            f"If `stubborn` rejects what it should not, `--verification {ACCEPT_ALL}` accepts every candidate."
        )

    @property
    def missing_calibration(self) -> str:
        """A sentence if the network's weights have no calibration; else ""."""
        detector = self.config.detector
        if not (self.spec.uses_segmentation and isinstance(detector, NetworkConfig)):
            return ""
        if detector.temperature is not None or is_calibrated(detector.weights):
            return ""
        return (
            f"The scores of '{detector.weights}' are not calibrated; verification and fusion misjudge them: "
            f"`{command('evaluate')} --calibrate` fits and stores a calibration."
        )


def resolve(options: RunOptions, spec: AgentSpec | None = None) -> Setup:
    """Returns the setup of a run: presets by name, then the settings file, then `--config`.

    Args:
        options: of the run.
        spec: the agent's specification; None: that of `options.agent`.

    Raises:
        ConfigError: options contradict each other, a name does not exist, or a value is not allowed.
    """
    _check(options)
    shard = _shard(options)
    segmentation = find_segmentation(options.semantics, options.weights)
    spec = spec or find_agent(options.agent)
    settings = {} if options.config_file is None else read_settings(options.config_file)
    _require_no_code(settings, options.config_file)
    settings |= parse_assignments(options.config)
    config = with_fields(_presets(options, spec, segmentation), settings)
    verification, verifier = _verified(segmentation.spec, config.verification)
    keys = (sensor.name for sensor in camera_sensors(config.cameras))
    sensors = tuple(dict.fromkeys((*config.sensors, *keys)))
    config = replace(config, verification=verification, sensors=sensors)
    setup = Setup(
        options=options,
        agent=spec,
        segmentation=segmentation,
        config=config,
        settings=settings,
        verifier=verifier,
        shard=shard,
        start=_start_pose(options.start_deg),
    )
    _check_sensors(setup)
    return setup


def _require_no_code(settings: Mapping[str, object], file: Path | None) -> None:
    """Raises ConfigError if a settings file calls a function, which only the command line may do."""
    from sim.app.bridges.habitat_client import CALL

    for path, value in settings.items():
        words = value if isinstance(value, list) else [value]
        call = next((word for word in words if isinstance(word, str) and CALL.fullmatch(word)), None)
        if call is not None:
            raise ConfigError(
                f"--config-file '{file}': '{path}' would call the function '{printable(call)}'; a file must not run "
                f"code. Give it on the command line: --config '{path}={printable(call)}'."
            )


def _received(content: bytes) -> Setup:
    return Setup(**Unpacker(content).load())


def _check(options: RunOptions) -> None:
    """Raises ConfigError if options contradict each other or are out of range."""
    for option, value in (("--labels", options.labels), ("--start-deg", options.start_deg)):
        if options.house is None and value is not None:
            raise ConfigError(f"{option} needs --house.")
    if options.root is not None and options.house is None and options.robot is None:
        raise ConfigError("--root needs --house or --robot: a file that may use this folder, too.")
    require_root(options.root)
    if options.verifier is not None and options.verification == ACCEPT_ALL:
        raise ConfigError(f"--verifier has no effect with --verification {ACCEPT_ALL}, which accepts every candidate.")
    if options.only and options.house is not None:
        raise ConfigError("--only names episodes of a split; with --house, episodes are sampled.")
    if options.retry_errors and options.out is None:
        raise ConfigError("--retry-errors needs --out: the folder of the run.")
    if options.seed_key is not None and not 1 <= len(options.seed_key) <= MAX_KEY_LENGTH:
        raise ConfigError(f"--seed-key must have 1 to {MAX_KEY_LENGTH} characters, got {len(options.seed_key)}.")
    selection.check(options)


def _shard(options: RunOptions) -> Shard | None:
    """Returns the part of the episodes that `--shard` chooses; raises ConfigError if there is no such part."""
    if options.shard is None:
        return None
    shard = Shard.parse(options.shard)
    if options.out is None:
        raise ConfigError(f"--shard {options.shard} needs --out: one folder for all shards.")
    return shard


def _start_pose(start_deg: str | None) -> Pose | None:
    """Returns the pose in the text "X Y YAW" (metres and degrees); None for None.

    Raises:
        ConfigError: the text does not hold three finite numbers.
    """
    if start_deg is None:
        return None
    try:
        x_m, y_m, yaw_deg = (float(word) for word in start_deg.split())
    except ValueError:
        raise ConfigError(
            f'--start-deg must be three numbers "X Y YAW" in metres and degrees, got "{start_deg}".'
        ) from None
    if not all(math.isfinite(value) for value in (x_m, y_m, yaw_deg)):
        raise ConfigError(f'--start-deg must be finite, got "{start_deg}".')
    return Pose(x_m, y_m, math.radians(yaw_deg))


def _presets(options: RunOptions, spec: AgentSpec, segmentation: SegmentationKind) -> RunConfig:
    """Returns the configuration tree before the user's settings."""
    robot, camera = (
        (RobotConfig(), CameraModel()) if options.robot is None else load_robot(options.robot, root=options.root)
    )
    return RunConfig(
        agent=_agent_config(options, spec),
        detector=detector_config(segmentation, options.weights),
        verification=VerificationConfig(method=options.verification, parameters=options.verifier),
        robot=replace(robot, motion=options.motion),
        camera=camera,
        sensors=_sensor_names(spec, segmentation, _for_goals(options, spec)),
        cameras={} if options.robot is None else cameras_by_name(robot_cameras(options.robot)),
        scan=ScanConfig(),
        profile=get_profile(options.profile),
        noise=get_noise(options.noise),
        task=TaskConfig(),
    )


def _agent_config(options: RunOptions, spec: AgentSpec) -> object:
    """Returns the default configuration of the agent, with the explorer of `--explorer`."""
    if options.explorer is None:
        return spec.config
    explorer = find_explorer(options.explorer)
    if not takes_explorer(spec):
        raise ConfigError(f"--explorer: agent '{options.agent}' takes no explorer.")
    return replace(spec.config, explorer=explorer)


def _for_goals(options: RunOptions, spec: AgentSpec) -> tuple[str, ...]:
    """Returns the sensors that an agent reads in addition for the goals of a run: words or pictures."""
    index = IndexFile() if options.house is not None else read_index(options.split)
    in_words = index.in_words or options.goal not in (None, *GOAL_CATEGORIES)
    return (*((spec.words or ()) if in_words else ()), *((spec.pictures or ()) if index.pictures else ()))


def _sensor_names(spec: AgentSpec, segmentation: SegmentationKind, for_goals: tuple[str, ...] = ()) -> tuple[str, ...]:
    """Returns the names of the sensors that an agent and its segmentation declare, then those for its goals."""
    read = (*spec.sensors, *(("depth", *segmentation.spec.sensors) if spec.uses_segmentation else ()), *for_goals)
    return tuple(dict.fromkeys(sensor if isinstance(sensor, str) else sensor.name for sensor in read))


def _own_sensors(spec: AgentSpec, segmentation: SegmentationKind) -> list[Sensor]:
    """Returns the sensors of an agent and of its segmentation that are objects, and not names of standard sensors."""
    read = (*spec.sensors, *(segmentation.spec.sensors if spec.uses_segmentation else ()))
    return [sensor for sensor in read if not isinstance(sensor, str)]


def _check_sensors(setup: Setup) -> None:
    """Raises ConfigError if a sensor is missing, or shows the truth to an agent that does not declare it."""
    options, spec, segmentation, sensors = setup.options, setup.spec, setup.segmentation, setup.config.sensors
    missing = [name for name in _sensor_names(spec, segmentation) if name not in sensors]
    if missing:
        raise ConfigError(f"sensors: agent '{options.agent}' with {options.semantics} needs {', '.join(missing)}.")
    own = _own_sensors(spec, segmentation)
    for sensor in own:
        same_name = [other for other in own if other.name == sensor.name and other is not sensor]
        if same_name and same_name[0] != sensor:
            raise ConfigError(
                f"Agent '{options.agent}' and {options.semantics} have two sensors named '{sensor.name}'."
            )
        if not spec.uses_ground_truth and sensor in spec.sensors and _noise_reads_truth(sensor):
            raise ConfigError(
                f"sensors: the noise of '{sensor.name}' reads ground truth; agent '{options.agent}' must declare "
                "uses_ground_truth."
            )
    if "semantic" in segmentation.spec.sensors and segmentation.own is not None and not spec.uses_ground_truth:
        raise ConfigError(
            f"--semantics '{options.semantics}': the sensor 'semantic' is ground truth; declare truth=('semantic',), "
            "and read it in the environment that the factory gets as `truth`."
        )
    true = [name for name in sensors if reads_truth(name)]
    if true and not spec.uses_ground_truth:
        raise ConfigError(
            f"sensors: '{true[0]}' is ground truth, and agent '{options.agent}' does not declare uses_ground_truth."
        )


def _noise_reads_truth(sensor: Sensor) -> bool:
    """Returns whether the noise of a sensor is of a user's class and declares true images."""
    shipped = {type(getattr(NoiseConfig(), field.name)) for field in fields(NoiseConfig)}
    if sensor.noise is None or type(sensor.noise) in shipped:
        return False
    model = sensor.noise.model(CameraModel())
    return model is not None and not TRUE_IMAGES.isdisjoint(model.images)


def _verified(spec: SegmenterSpec, config: VerificationConfig) -> tuple[VerificationConfig, Verifier]:
    """Returns a configuration with the probability that a candidate needs, and its verifier.

    Raises:
        ConfigError: there are no such parameters, or no such method.
    """
    verifier = verifier_for(spec, config.parameters, config.method)
    fitted = verifier if isinstance(verifier, FittedVerifier) else None
    if config.least_probability is None:
        return replace(config, least_probability=(fitted or FittedVerifier).least_probability), verifier
    if fitted is None:
        return config, verifier
    return config, replace(fitted, least_probability=config.least_probability)
