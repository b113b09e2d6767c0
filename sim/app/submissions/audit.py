"""Audits a submission, as `stubborn verify` does: checks it, replays its actions, and judges every episode."""

from __future__ import annotations

import functools
import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from sim.app.evaluation.parallel import ordered_map
from sim.app.evaluation.results import segmentation_of
from sim.app.submissions.checks import coverage, require_consistent, truth_of
from sim.app.submissions.contents import Entry, Submission, read_submission
from sim.app.submissions.replay import Job, replay_house
from sim.app.submissions.sealing import Origin, origin_of
from sim.app.submissions.setting import Setting, setting_of
from sim.app.submissions.verdicts import TOLERANCE_M, Verdict, judge
from sim.core.errors import ConfigError
from sim.core.reading import sha256_of
from sim.episodes.splits import load_split, shipped_splits

FRAMES = 0.1
"""Share of the episodes whose frames are rendered; a frame takes as long as its action."""


@dataclass(frozen=True, kw_only=True)
class AuditOptions:
    """How a submission is verified."""

    split: Path | None = None
    """Folder of its split; None: the shipped split of its name."""
    frames: float = FRAMES
    """Share of the episodes whose frames are rendered, at least one if it is not 0."""
    draw_seed: int
    """Draws these episodes; the authors must not know it."""
    tolerance_m: float = TOLERANCE_M
    workers: int = 1
    nonstandard: bool = False
    """Whether robot, camera and task may differ from the standard."""


@dataclass(frozen=True, kw_only=True)
class Checked:
    """A submission that is consistent, and has not been replayed yet."""

    file: Path
    sha256: str
    submission: Submission
    setting: Setting
    is_first: bool
    """Its episodes are the first ones of the split."""
    covers: str
    """The episodes as text."""
    changes: Sequence[str]
    """Differences of its setting from the standard."""
    origin: Origin
    """Who drew its split."""
    segmentation: str
    """The segmentation and its weights, as the authors declare them."""
    job: Job
    house_of: Mapping[str, str] = field(repr=False)


def check(file: Path, options: AuditOptions, truth_of_agents: Mapping[str, bool]) -> Checked:
    """Returns a submission that passed all checks without a replay.

    Args:
        file: the submission.
        options: see `AuditOptions`.
        truth_of_agents: whether each agent that ships with the simulator uses ground truth.

    Raises:
        ConfigError: it cannot be read, contradicts itself, its split or this version, or has another setting.
    """
    submission, where = read_submission(file), f"Submission '{file}'"
    config = submission.config_tree(where=where)
    setting = setting_of(config, where=where)
    name = submission.manifest.split.name
    if options.split is None and name not in shipped_splits():
        raise ConfigError(
            f"{where} was made on the split '{name}', which does not ship; give its folder with --split (`stubborn "
            "leaderboard`: --splits). That of a sealed split is made after the deadline (`stubborn seal reveal`)."
        )
    chosen = name if options.split is None else str(options.split)
    split = load_split(chosen)
    require_consistent(submission, config, setting, split, where=where)
    inputs = submission.manifest.inputs
    if truth_of_agents.get(inputs.agent) and truth_of(inputs) != "yes":
        raise ConfigError(f"{where} declares no ground truth, and its agent '{inputs.agent}' uses it.")
    changes = setting.changes()
    if changes and not options.nonstandard:
        raise ConfigError(
            f"{where} was not made with the standard robot, camera, task and noise: {changes[0]}"
            f"{f', and {len(changes) - 1} more' if len(changes) > 1 else ''}; --nonstandard replays it all the same."
        )
    is_first, covers = coverage(submission, split)
    return Checked(
        file=file,
        sha256=sha256_of(file, what="Submission"),
        submission=submission,
        setting=setting,
        is_first=is_first,
        covers=covers,
        changes=changes,
        origin=origin_of(split, options.split),
        segmentation=segmentation_of(config),
        job=Job(split=chosen, setting=setting, seed=submission.manifest.seed),
        house_of={entry.result.episode_id: entry.result.house for entry in submission.episodes},
    )


def verdicts(checked: Checked, options: AuditOptions) -> Iterator[tuple[Verdict, float]]:
    """Yields the verdict on each episode, house by house, and the seconds of processor time that its replay took."""
    entries = checked.submission.episodes
    framed = drawn(entries, options)
    groups: dict[str, list[tuple[Entry, bool]]] = {}
    for entry in entries:
        if entry.result.is_error:
            yield judge(entry, None), 0.0
        else:
            episode_id = entry.result.episode_id
            groups.setdefault(checked.house_of[episode_id], []).append((entry, episode_id in framed))
    work = list(groups.values())
    replays = ordered_map(functools.partial(replay_house, checked.job), work, workers=options.workers)
    for group, verdicts in zip(work, replays, strict=True):
        for (entry, _), replay in zip(group, verdicts, strict=True):
            yield judge(entry, replay, tolerance_m=options.tolerance_m), replay.seconds


def drawn(entries: Sequence[Entry], options: AuditOptions) -> set[str]:
    """Returns the ids of the episodes whose frames are rendered."""
    ids = sorted(entry.result.episode_id for entry in entries if not entry.result.is_error)
    count = min(len(ids), math.ceil(options.frames * len(ids)))
    rng = np.random.default_rng(options.draw_seed)
    return {ids[number] for number in rng.choice(len(ids), count, replace=False)} if count else set()


def counts(verdicts: Sequence[Verdict]) -> Counter[str]:
    """Returns the number of episodes by judgement."""
    return Counter(verdict.judgement for verdict in verdicts)
