"""Writes the figures as a table for the terminal, as JSON, and as Markdown inside a page."""

from __future__ import annotations

import json
import os
import platform
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

from rich.table import Table

from sim.app.commands.bench.calibration import Calibration
from sim.app.commands.bench.figures import Figure
from sim.core.files import write_atomically
from sim.core.interface import ConfigError
from sim.core.paths import code_hash, processor
from sim.core.reading import read_text
from sim.renderer.opengl import describe_gl

BEGIN, END = "<!-- bench: begin -->", "<!-- bench: end -->"
_BEGIN = re.compile(r"<!-- bench: begin\b.*?-->")
"""The first mark; a page may have a note in it."""
COLUMNS = ("part", "what", "measured", "baseline", "ratio", "goal", "")


def machine() -> dict[str, Any]:
    """Returns processor, system, load and versions."""
    packages = ("mujoco", "numpy", "opencv-python-headless", "scikit-fmm", "numba")
    return {
        "processor": processor(),
        "cores": len(os.sched_getaffinity(0)),
        "system": f"{platform.system()} {platform.machine()}",
        "load": round(os.getloadavg()[0], 2),
        "gl_renderer": describe_gl(),
        "LP_NUM_THREADS": os.environ.get("LP_NUM_THREADS"),
        "versions": {"python": platform.python_version()} | {name: version(name) for name in packages},
        "code": code_hash(),
    }


def rows(figures: Sequence[Figure]) -> list[tuple[str, ...]]:
    """Returns the cells of each figure in the order of `COLUMNS`."""
    verdict = {True: "yes", False: "no", None: ""}
    return [
        (
            figure.part,
            figure.what,
            _quantity(figure.value, figure.unit),
            f"{_quantity(figure.baseline, figure.unit)}: {figure.against}",
            f"{figure.ratio:.2f}",
            str(figure.goal or ""),
            verdict[figure.met],
        )
        for figure in figures
    ]


def to_table(figures: Sequence[Figure]) -> Table:
    """Returns the table for the terminal."""
    table = Table(title="Benchmarks", title_justify="left")
    for column in COLUMNS:
        table.add_column(column, justify="right" if column in ("measured", "ratio") else "left")
    for row in rows(figures):
        table.add_row(*row)
    return table


def calibration_line(calibration: Calibration) -> str:
    """Returns a sentence with the times of the fixed pieces of work."""
    return (
        f"Calibration: the fixed render {calibration.render_ms:.2f} ms, 200 fixed mj_step "
        f"{calibration.step_ms:.2f} ms, the fixed fast marching {calibration.fast_marching_ms:.2f} ms."
    )


def to_json(figures: Sequence[Figure], about: Mapping[str, Any], calibrations: Mapping[str, Calibration]) -> str:
    """Returns machine, calibrations before each part and after the last, and figures as JSON."""
    content = {
        "machine": about,
        "calibration": {when: asdict(calibration) for when, calibration in calibrations.items()},
        "figures": [figure.to_json() for figure in figures],
    }
    return json.dumps(content, indent=1) + "\n"


def to_markdown(figures: Sequence[Figure], about: Mapping[str, Any], calibration: Calibration, command: str) -> str:
    """Returns the table with its notes."""
    head = [f"| {' | '.join(COLUMNS)} |", "|---|---|--:|---|--:|---|---|"]
    body = [f"| {' | '.join(row)} |" for row in rows(figures)]
    versions = ", ".join(f"{name} {number}" for name, number in about["versions"].items())
    notes = [
        f"`{command}` on {about['processor']}, {about['cores']} cores, {about['gl_renderer']}, "
        f"LP_NUM_THREADS={about['LP_NUM_THREADS']}; load {about['load']} when it began; {versions}; "
        f"code {about['code']}.",
        calibration_line(calibration),
    ]
    return "\n".join([*head, *body, "", *("\n\n".join(notes).split("\n"))]) + "\n"


def write_between_marks(page: Path, text: str) -> None:
    """Writes a text between the two marks of a page; raises ConfigError like `around_marks`."""
    before, after = around_marks(page)
    write_atomically(page, f"{before}\n\n{text}\n{after}")


def around_marks(page: Path) -> tuple[str, str]:
    """Returns the text of a page up to its first mark and from its second mark on.

    Raises:
        ConfigError: there is no such page, or it has no marks.
    """
    old = read_text(page, what="--markdown")
    begin = _BEGIN.search(old)
    _, end, after = old[begin.end() :].partition(END) if begin else ("", "", "")
    if begin is None or not end:
        raise ConfigError(f"--markdown '{page}' has no place for the table: two lines, {BEGIN} and {END}.")
    return old[: begin.end()], end + after


def _quantity(value: float, unit: str) -> str:
    digits = 0 if abs(value) >= 100 else 1 if abs(value) >= 10 else 2
    return f"{value:.{digits}f} {unit}"
