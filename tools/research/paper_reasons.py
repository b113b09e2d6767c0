"""Tables that ask why Table IV of the paper is not replicated, from the archive of result lines.

The first asks whether corners need long homes: corners against frontiers, by thirds of the shortest path. The second
asks what SemExp has without measures against collisions: both agents by whether corners were trapped.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sim.app.analysis.metrics import EXPLORED, FIRST_SIGHT, SPL, TRAPPED, difference_cell, mean_cell
from sim.app.analysis.tables import Cell, ResultTable, with_corrections
from sim.app.commands.reproduce.runs import AgentSetup, RunKey
from sim.task.result import EpisodeResult
from tools.research.result_archive import VERSION, ArchivedRun

EPISODES = {"val": 100, "large": 200}
"""The first episodes of each split, which both agents have."""
THIRDS = ("nearest third", "middle third", "farthest third")


def reasons(runs: Mapping[RunKey, ArchivedRun]) -> list[ResultTable]:
    """Returns the two tables; raises KeyError if the archive lacks a run."""
    rows: list[tuple[str, list[Cell | str]]] = []
    for split, count in EPISODES.items():
        corners, frontier = (_lines(runs, split, agent, "", count) for agent in ("stubborn", "frontier-avoid"))
        lengths_m = np.array([result.shortest_path for result in corners], np.float64)
        edges_m = np.percentile(lengths_m, [0.0, 100 / 3, 200 / 3, 100.0])
        third = np.clip(np.searchsorted(edges_m, lengths_m, side="right") - 1, 0, 2)
        for number, name in enumerate(THIRDS):
            span = f"{edges_m[number]:.1f} to {edges_m[number + 1]:.1f} m"
            chosen = [[r for r, t in zip(lines, third, strict=True) if t == number] for lines in (frontier, corners)]
            rows.append((f"{split}, {name}: {span} ({len(chosen[0])})", _differences(*chosen)))
        rows.append((f"{split}, all ({count})", _differences(frontier, corners)))
    header = ("episodes", EXPLORED.title, SPL.title, FIRST_SIGHT.title)
    by_length = ResultTable("by_length", "stubborn - frontier-avoid, by the shortest path to the goal", header, rows)
    return [with_corrections(by_length), with_corrections(_by_trap(runs))]


def _differences(second: Sequence[EpisodeResult], first: Sequence[EpisodeResult]) -> list[Cell | str]:
    return [difference_cell(metric, second, first) for metric in (EXPLORED, SPL, FIRST_SIGHT)]


def _by_trap(runs: Mapping[RunKey, ArchivedRun]) -> ResultTable:
    """Returns GT exploration of corners and SemExp without measures, by whether corners were trapped."""
    corners, semexp = (
        _lines(runs, "val", "stubborn-i", options, EPISODES["val"]) for options in ("", "--explorer semexp")
    )
    rows: list[tuple[str, list[Cell | str]]] = []
    for name, wanted in (("trapped", True), ("not trapped", False)):
        pairs = [(a, b) for a, b in zip(corners, semexp, strict=True) if bool(a.trapped) is wanted]
        first, second = ([pair[i] for pair in pairs] for i in (0, 1))
        rows.append(
            (
                f"stubborn-i is {name} ({len(pairs)})",
                [mean_cell(EXPLORED, first), mean_cell(EXPLORED, second), difference_cell(EXPLORED, second, first)],
            )
        )
    trapped = [mean_cell(TRAPPED, corners), mean_cell(TRAPPED, semexp), difference_cell(TRAPPED, semexp, corners)]
    rows.append((f"trapped %, all ({len(corners)})", list(trapped)))
    header = ("episodes of val", "stubborn-i", "stubborn-i --explorer semexp", "difference")
    return ResultTable("by_trap", "GT exploration % without measures against collisions", header, rows)


def _lines(runs: Mapping[RunKey, ArchivedRun], split: str, agent: str, options: str, count: int) -> list[EpisodeResult]:
    return runs[RunKey(split, AgentSetup(agent, options, "gt"), VERSION)].first_results(count)
