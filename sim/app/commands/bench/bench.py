"""Measures the speed of all parts, each figure against a baseline that is measured in the same run.

stubborn bench                                             # all parts, half an hour at most
stubborn bench --parts a,b,d                               # rendering, the agent's step
stubborn bench --parts j                                   # steps per second by image size and sensors
stubborn bench --out runs/bench.json --markdown docs/performance.md
stubborn bench --quick                                     # tests that everything runs; its figures have no meaning

Absolute figures depend on the machine and on its load; ratios depend on them much less. Before each part and at the
end, three fixed pieces of work are timed; they show how steady the machine was. See docs/performance.md.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import cv2
from rich.console import Console

from sim.app import cli
from sim.app.analysis import display
from sim.app.commands.bench import (
    bridged,
    driving,
    growth,
    learning,
    making,
    rendering,
    report,
    scaling,
    starting,
    stepping,
)
from sim.app.commands.bench.calibration import Calibration, Calibrator
from sim.app.commands.bench.figures import Figure
from sim.app.commands.bench.stages import QUICK, Amount, Setting
from sim.core.files import write_atomically

PARTS: Mapping[str, Callable[[Setting], list[Figure]]] = {
    "a": rendering.three_images,
    "b": rendering.two_images,
    "c": stepping.environment_step,
    "d": stepping.agent_step,
    "e": stepping.whole_episodes,
    "f": making.views_to_disk,
    "g": making.new_houses,
    "h": scaling.two_workers,
    "i": growth.growth,
    "j": learning.steps_of_training,
    "k": starting.starts,
    "l": bridged.agent_in_a_process,
    "m": driving.velocities,
    "n": driving.lidar,
}
MAX_DRIFT = 1.15
"""A calibration that changes by a larger factor between two parts gives a warning."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Measure parts, print the figures and write them to files."""

    parts: str = ",".join(PARTS)
    """Letters of parts, separated by commas: a, b rendering; c the environment's step; d the agent's step; e episodes;
    f views; g houses; h workers; i growth; j steps of a training; k starts;
    l an agent in a process of its own; m velocities; n the lidar."""
    quick: bool = False
    """Measure as little as possible, to test that everything runs."""
    out: cli.OutFile | None = None
    """A JSON file for all figures."""
    markdown: cli.OutFile | None = None
    """A page into which the table is written, between its two marks."""


def main(args: Args) -> int:
    """Measures the parts; returns 1 if a goal is missed (never with --quick)."""
    os.environ["LP_NUM_THREADS"] = "1"  # for figures and baselines; llvmpipe reads it when it starts
    wanted = cli.chosen(args.parts, PARTS, option="--parts")
    if args.markdown is not None:
        report.around_marks(args.markdown)  # refused before the measurements
    console = display.make_console()
    cv2.setNumThreads(1)
    about, calibrations = report.machine(), {}
    figures: list[Figure] = []
    calibrator, tries = Calibrator(), 3 if args.quick else 20
    for part in wanted:
        calibrations[part] = calibrator.measure(tries)
        figures += measured(part, Setting(QUICK if args.quick else Amount(), calibrator), console)
    calibrations["end"] = calibrator.measure(tries)
    calibrator.close()
    first = next(iter(calibrations.values()))
    console.print(report.to_table(figures))
    console.print(report.calibration_line(first), highlight=False, soft_wrap=True)
    for warning in drifts(calibrations):
        console.print(warning, highlight=False, soft_wrap=True)
    if args.out is not None:
        write_atomically(args.out, report.to_json(figures, about, calibrations).encode())
    if args.markdown is not None:
        report.write_between_marks(args.markdown, report.to_markdown(figures, about, first, command_of(args)))
    return int(not args.quick and any(figure.met is False for figure in figures))


def measured(part: str, setting: Setting, console: Console) -> list[Figure]:
    """Returns the figures of a part and prints its duration."""
    began_s = time.perf_counter()
    figures = PARTS[part](setting)
    console.print(f"({part}) measured in {time.perf_counter() - began_s:.0f} s", highlight=False)
    return figures


def drifts(calibrations: Mapping[str, Calibration]) -> list[str]:
    """Returns warnings about fixed work whose duration changed: other processes were running."""
    warnings = []
    for name in ("render_ms", "step_ms", "fast_marching_ms"):
        values = [getattr(calibration, name) for calibration in calibrations.values()]
        if max(values) > MAX_DRIFT * min(values):
            warnings.append(
                f"The machine was not quiet: the fixed {name.removesuffix('_ms').replace('_', ' ')} took "
                f"{min(values):.2f} to {max(values):.2f} ms in the course of this run."
            )
    return warnings


def command_of(args: Args) -> str:
    """Returns the command that measures the same parts."""
    parts = "" if cli.chosen(args.parts, PARTS, option="--parts") == list(PARTS) else f" --parts {args.parts}"
    return "stubborn bench" + parts + (" --quick" if args.quick else "")
