"""Builds what a run records: `config.json`, versions, results with their episode and agent, and their recordings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import cast

import msgspec

from sim.app.bridges.process_command import files_of, is_bounded, is_file
from sim.app.composition.segmenters import NetworkConfig, file_sha256, precision_of
from sim.app.composition.setup import Setup
from sim.app.evaluation.own_code import hash_of_own
from sim.app.evaluation.results import RunRecord, SplitIdentity
from sim.app.evaluation.rollout import rollout_result
from sim.app.options import RunOptions, is_process
from sim.core.configuration import as_json
from sim.core.option_types import meanings
from sim.core.paths import code_hash, processor
from sim.episodes.episode import Episode
from sim.renderer.opengl import describe_gl
from sim.robot.config import PHYSICS_VERSION
from sim.robot.foreign import robot_sha256
from sim.task.result import EpisodeResult, RolloutResult, metrics_without_episode
from sim.task.trajectory import Recording, SplitName, StartPose


def record_of(setup: Setup, split: Mapping[str, str]) -> RunRecord:
    """Returns the content of `config.json`: options, configuration tree, checksums of files, split and versions.

    Paths are absolute, so that the run can be read from any folder.
    """
    setup = setup.with_absolute_paths()
    recorded = [name for name, option in meanings(RunOptions).items() if option.recorded]
    options = {name: as_json(getattr(setup.options, name)) for name in recorded}
    derived = RunRecord(
        settings=as_json(setup.settings),
        config=as_json(setup.config),
        physics=PHYSICS_VERSION,
        segmentation=_segmentation_of(setup),
        files_sha256=_checksums(setup),
        split_identity=cast(SplitIdentity, dict(split)),
        versions=versions(setup.options),
    )
    return cast(RunRecord, options | derived)


def versions(options: RunOptions) -> dict[str, str]:
    """Returns the versions that a result depends on: packages, processor, GL renderer, and `code_of`."""
    packages = ("stubborn-objectnav", "mujoco", "numpy")
    here = {"processor": processor(), "gl_renderer": describe_gl(), "code": code_of(options)}
    return {name: version(name) for name in packages} | here


def code_of(options: RunOptions) -> str:
    """Returns a hash of the code of a run, such as "3353e768d2c2".

    If an agent, explorer or segmentation is a user's, "+" and a hash of its modules follow, which must be imported
    already. For an agent in a process of its own, it is a hash of the files that its command names and of the modules
    that they import from their folder.
    """
    own = hash_of_own(options.own_modules, files_of(options.agent) if is_process(options.agent) else ())
    return f"{code_hash()}+{own}" if own else code_hash()


def _checksums(setup: Setup) -> dict[str, str]:
    """Returns the SHA-256 of the user's or shipped files that the result depends on."""
    checksums, config = dict[str, str](), setup.config
    if isinstance(config.detector, NetworkConfig):
        checksums["weights"] = file_sha256(config.detector.weights)
    else:
        checksums |= {name: file_sha256(file) for name, file in _files_in(config.detector, "detector")}
    if config.verification.parameters is not None:
        checksums["verifier"] = file_sha256(config.verification.parameters)
    if setup.options.robot is not None:
        checksums["robot"] = robot_sha256(setup.options.robot, root=setup.options.root)
    return checksums | {name: file_sha256(file) for name, file in _files_in(config.agent, "agent")}


def _segmentation_of(setup: Setup) -> dict[str, object]:
    """Returns the name of the segmentation that the agent acts on and, if `--semantics` names it, its declaration."""
    if not setup.spec.uses_segmentation:
        return {"name": setup.segmentation_name or None}
    spec, verified = setup.segmentation.spec, not setup.borrowed_parameters
    declared = as_json(replace(spec, sensors=tuple(x if isinstance(x, str) else x.name for x in spec.sensors)))
    declaration: dict[str, object] = {"name": setup.segmentation_name, **declared, "has_fitted_parameters": verified}
    precision = precision_of(setup.config.detector)
    return declaration if precision is None else declaration | {"precision": precision}


def _files_in(tree: object, name: str) -> Iterator[tuple[str, Path]]:
    """Yields path and file of each field of a configuration that names a file, such as weights of an explorer."""
    if is_dataclass(tree) and not isinstance(tree, type):
        for field in fields(tree):
            yield from _files_in(getattr(tree, field.name), f"{name}.{field.name}")
    elif isinstance(tree, (str, Path)) and Path(tree).suffix and is_file(Path(tree)):
        yield name, Path(tree)


def error_result(setup: Setup, episode: Episode, error: str) -> EpisodeResult:
    """Returns the result of an episode that could not be run to its end."""
    return result_of(setup, episode, rollout_result(metrics_without_episode(episode.shortest_path_m), error))


def result_of(setup: Setup, episode: Episode, result: RolloutResult) -> EpisodeResult:
    """Returns the result of an episode with the episode, the agent and the segmentation."""
    return EpisodeResult(
        **msgspec.structs.asdict(result),
        episode_id=episode.episode_id,
        house=episode.house,
        goal=episode.goal,
        agent=setup.options.agent,
        uses_ground_truth=setup.uses_ground_truth,
        isolated="namespace" if is_bounded(setup.config.agent) else is_process(setup.options.agent),
        semantics=setup.options.semantics,
        seed=setup.options.seed,
        motion=setup.config.robot.motion,
    )


def recording_of(
    setup: Setup, episode: Episode, result: EpisodeResult, split: SplitName, versions: dict[str, str]
) -> Recording:
    """Returns what a recorded trajectory says about its episode."""
    start = episode.start
    return Recording(
        profile=setup.options.profile,
        noise=setup.options.noise,
        split=split,
        versions=versions,
        start=StartPose(start.x_m, start.y_m, start.yaw_rad, start.floor_z_m),
        scores=result.without_times(),
    )
