"""Packs a recorded run into a submission."""

from __future__ import annotations

import json
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import PurePath
from typing import cast

import msgspec
from numpy.typing import NDArray

from sim.app.analysis.comparison import Run
from sim.app.analysis.report.facts import command_of
from sim.app.evaluation.results import RunRecord
from sim.app.options import RunOptions
from sim.app.submissions.contents import FORMAT, PLACE_EVERY, Entry, Manifest, Submission
from sim.app.submissions.setting import setting_of
from sim.core.errors import ConfigError
from sim.core.option_types import meanings
from sim.core.reading import convert
from sim.robot.config import PHYSICS_VERSION
from sim.task.result import EpisodeResult
from sim.task.trajectory import Trajectory, read_trajectory, trajectory_file


@dataclass(frozen=True, kw_only=True)
class About:
    """The statements of the authors about a run."""

    name: str
    authors: Sequence[str]
    description: str = ""
    links: Sequence[str] = ()


def pack(run: Run, about: About) -> Submission:
    """Returns the submission of a run.

    Raises:
        ConfigError: the run is of one house, of an older version, or not recorded; or a text of the authors is not
            allowed.
    """
    config = run.config
    if config.get("house") is not None:
        raise ConfigError(
            f"'{run.path}' is a run in one house (--house); a submission needs a split, which `stubborn episodes "
            "--house FILE --out FOLDER` makes of it."
        )
    physics = config.get("physics")
    if physics != PHYSICS_VERSION:
        raise ConfigError(
            f"'{run.path}' was made with physics of version {physics}, this is version {PHYSICS_VERSION}; run it "
            f"again: {recording(run)}"
        )
    if not run.results:
        raise ConfigError(f"'{run.path}' holds no episode.")
    setting = setting_of(config, where=f"Run '{run.path}'")
    first = next(iter(run.results.values()))
    manifest = {
        "name": about.name,
        "authors": list(about.authors),
        "description": about.description,
        "links": list(about.links),
        "split": run.recorded("split_identity"),
        "seed": run.recorded("seed"),
        "physics": physics,
        "inputs": {
            "agent": run.recorded("agent"),
            "semantics": run.recorded("semantics"),
            "sensors": run.recorded("config")["sensors"],
            "noise": setting.noise_name,
            "uses_ground_truth": first.uses_ground_truth,
            "isolated": first.isolated,
        },
        "versions": run.recorded("versions"),
    }
    private = {name for name, option in meanings(RunOptions).items() if not option.published}
    kept = _without_folders({key: value for key, value in config.items() if key not in private})
    return Submission(
        format=FORMAT,
        manifest=convert(manifest, Manifest, where="The manifest"),
        config=msgspec.Raw(json.dumps(kept, allow_nan=False).encode()),
        episodes=list(_entries(run)),
    )


def _without_folders(value: object) -> object:
    """Returns a configuration in which files of the user, such as weights, have their name without its folder."""
    if isinstance(value, dict):
        return {key: _without_folders(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_without_folders(item) for item in value]
    return PurePath(value).name if isinstance(value, str) and PurePath(value).is_absolute() else value


def recording(run: Run) -> str:
    """Returns the command that runs the episodes of a run again and records them."""
    config = cast(RunRecord, {**run.config, "record": True, "video": False, "shard": None})
    return f"{command_of(config)} --out {shlex.quote(f'{run.path}_recorded')}"


def _entries(run: Run) -> Iterator[Entry]:
    """Yields the episodes of a run in the order of its results."""
    for episode_id, result in run.results.items():
        file = trajectory_file(run.path, episode_id)
        if result.is_error:
            yield Entry(result, "")
            continue
        if not file.is_file():
            raise ConfigError(
                f"'{run.path}' has no trajectory of '{episode_id}': a submission needs the actions of every episode. "
                f"Record them: {recording(run)}"
            )
        trajectory = read_trajectory(file)
        _require_of(trajectory, result, f"'{file}'")
        yield Entry(result, "".join(map(str, trajectory.actions.tolist())), places_of(trajectory.positions_m[1:]))


def _require_of(trajectory: Trajectory, result: EpisodeResult, where: str) -> None:
    """Raises ConfigError where a trajectory is not that of a result."""
    scores = None if trajectory.about is None else trajectory.about.scores
    for key in ("num_steps", "success", "path_length"):
        recorded = trajectory.num_steps if key == "num_steps" else getattr(scores, key, None)
        if recorded != getattr(result, key):
            raise ConfigError(
                f"{where} is of another result than its line: {key} is {recorded}, not {getattr(result, key)}."
            )


def places_of(positions_m: NDArray) -> tuple[tuple[float, float], ...]:
    """Returns the positions after every `PLACE_EVERY`-th action and the last one, of those after each action (n, 2)."""
    chosen = [*range(PLACE_EVERY - 1, len(positions_m), PLACE_EVERY)]
    if len(positions_m) and (not chosen or chosen[-1] != len(positions_m) - 1):
        chosen.append(len(positions_m) - 1)
    return tuple((round(float(x), 4), round(float(y), 4)) for x, y in positions_m[chosen])
