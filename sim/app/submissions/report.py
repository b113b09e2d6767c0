"""The outcome of a verification as JSON.

The leaderboard keeps the outcomes of its own verifications in the user's cache. It never reads the report next to a
submission, which may come from the authors.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import msgspec

from sim.app.submissions.audit import AuditOptions, Checked, counts
from sim.app.submissions.sealing import Origin
from sim.app.submissions.verdicts import Verdict
from sim.core.paths import cache_dir, processor
from sim.core.reading import Count, Number, read_json
from sim.robot.config import PHYSICS_VERSION


class Report(msgspec.Struct):
    """The fields of a report that are read."""

    sha256: Annotated[str, msgspec.Meta(pattern=r"^[0-9a-f]{64}\Z")]
    """SHA-256 of the submission."""
    physics: Count
    episodes: Count
    equal: Count
    within_tolerance: Count
    different: Count
    errors: Count
    """Episodes that ended with an error: they count as failures, and have no actions to replay."""
    frames: Count
    is_first: bool
    nonstandard: Annotated[tuple[str, ...], msgspec.Meta(max_length=1000)]
    tolerance_m: Number
    origin: Origin = "public"
    """Who drew the split."""
    oracle_paths: Count | None = None
    """Episodes whose actions are the oracle's; None: an older version, which did not compare them."""
    shortest_paths: Count | None = None
    """Further successes on a path hardly longer than the shortest one (`sim.app.submissions.verdicts`)."""


def report_of(
    checked: Checked, options: AuditOptions, verdicts: Sequence[Verdict], seconds: float
) -> dict[str, object]:
    """Returns the outcome of a verification; `seconds` of processor time were needed."""
    count = counts(verdicts)
    return {
        "sha256": checked.sha256,
        "physics": PHYSICS_VERSION,
        "episodes": len(verdicts),
        "equal": count["equal"],
        "within_tolerance": count["within tolerance"],
        "different": count["different"],
        "errors": count["error"],
        "frames": sum(verdict.framed for verdict in verdicts),
        "is_first": checked.is_first,
        "nonstandard": list(checked.changes),
        "tolerance_m": options.tolerance_m,
        "origin": checked.origin,
        "oracle_paths": sum(verdict.known_path == "oracle" for verdict in verdicts),
        "shortest_paths": sum(verdict.known_path == "shortest" for verdict in verdicts),
        "draw_seed": options.draw_seed,
        "processor": processor(),
        "seconds": round(seconds, 1),
        "remarks": [
            f"{verdict.episode_id}: {verdict.judgement}: {verdict.text}" for verdict in verdicts if verdict.text
        ],
    }


def is_of(report: Report, checked: Checked, tolerance_m: float) -> bool:
    """Returns whether a report is the outcome of verifying this file with this version of the physics."""
    entries = checked.submission.episodes
    errors = sum(entry.result.is_error for entry in entries)
    counted = report.equal + report.within_tolerance + report.different + report.errors
    stated = (report.sha256, report.physics, report.episodes, counted, report.errors, report.is_first)
    setting = (list(report.nonstandard), report.tolerance_m, report.origin)
    return (
        stated == (checked.sha256, PHYSICS_VERSION, len(entries), len(entries), errors, checked.is_first)
        and setting == (list(checked.changes), tolerance_m, checked.origin)
        and None not in (report.oracle_paths, report.shortest_paths)
    )


def kept_file(checked: Checked) -> Path:
    """Returns the file in the user's cache of the outcome of verifying a submission."""
    split = checked.submission.manifest.split.sha256
    return cache_dir() / "verified" / f"{checked.sha256}_{split[:16]}_{PHYSICS_VERSION}.json"


def read_report(file: Path) -> Report:
    """Returns the report in a file.

    Raises:
        ConfigError: it cannot be read, or has another form.
    """
    return read_json(file, Report, what="Report")
