"""The part of the trap report for traps of families: a table, curves with intervals, and a picture of each family.

It writes `families.md` (successes and collisions by family and difficulty), `curves.csv` and `curves.png` (over the
width of the gap, the length of panes and the number of hidden objects), `families.png` (by family) and
`families/<family>.png`.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sim.app.analysis.report.figures import proportion
from sim.app.analysis.tables import ResultTable, to_markdown
from sim.app.commands.traps.curves import QUANTITIES, Point, Rows, curve, point_of
from sim.app.commands.traps.picture import draw_family
from sim.app.commands.traps.trial import TrapResult
from sim.core.files import csv_text, write_picture, write_together
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.splits import Split
from sim.homes.housegen.traps.families.catalogue import FAMILIES
from sim.homes.housegen.traps.families.family import DIFFICULTIES
from sim.houses.sidecar import TrapFacts
from sim.training.figures import empty_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DPI = 110
MARKERS = "osD^vP*X"
COUNTS = (1, 3, 10, 30)
"""Ticks of the axis of hidden objects."""


def facts_of(split: Split) -> dict[str, TrapFacts]:
    """Returns the facts of those traps of a split that belong to a family, by name."""
    traps = {house: split.sidecar(house).trap for house in split.houses}
    return {house: facts for house, facts in traps.items() if facts is not None}


def write_family_report(
    folder: Path, rows: Rows, split: str, facts: Mapping[str, TrapFacts], *, pictures: bool
) -> None:
    """Writes tables, curves and pictures of the rows whose traps belong to families.

    Args:
        folder: where the files go.
        rows: results of all agents.
        split: name or folder of the split.
        facts: of its traps, by name.
        pictures: whether the pictures of the families are drawn.
    """
    ours = [row for row in rows if row.trap in facts]
    if not ours:
        return
    points = [point for quantity in QUANTITIES for point in curve(ours, facts, quantity)]
    table = to_markdown([family_table(ours, facts)])
    write_together({folder / "families.md": table, folder / "curves.csv": as_csv(points)})
    draw_curves(points).savefig(folder / "curves.png", dpi=DPI)
    draw_families(ours, facts).savefig(folder / "families.png", dpi=DPI)
    if pictures:
        draw_family_pictures(folder / "families", split, facts)


def family_table(rows: Rows, facts: Mapping[str, TrapFacts]) -> ResultTable:
    """Returns the table of successes and mean collisions of each agent, by family and by difficulty."""
    agents = sorted({row.agent for row in rows})
    families = _families_of(rows, facts)
    parts = [(name, {"family": name}) for name in families]
    parts += [(f"all, {name}", {"difficulty": name}) for name in DIFFICULTIES]
    lines = [
        (label, [_cell(_of(rows, facts, agent, **part)) for agent in agents]) for label, part in [*parts, ("all", {})]
    ]
    return ResultTable("families", "successes (95 % interval)", ("family", *agents), lines)


def as_csv(points: Sequence[Point]) -> str:
    """Returns the points of all curves as CSV text."""
    rows = (dataclasses.astuple(point) for point in points)
    return csv_text(
        [field.name for field in dataclasses.fields(Point)],
        ([round(value, 4) if isinstance(value, float) else value for value in row] for row in rows),
        end="\r\n",
    )


def draw_curves(points: Sequence[Point]) -> Figure:
    """Returns a figure: success above, collisions below, a column for each quantity, a line for each agent."""
    figure = empty_figure(4.4 * len(QUANTITIES), 6.6)
    axes = figure.subplots(2, len(QUANTITIES), squeeze=False)
    agents = sorted({point.agent for point in points})
    for column, quantity in enumerate(QUANTITIES):
        for number, agent in enumerate(agents):
            of = [point for point in points if (point.agent, point.quantity) == (agent, quantity.name)]
            x = np.array([point.middle for point in of])
            for row, name in enumerate(("success", "collisions")):
                _bars(axes[row][column], x, of, name, agent, number, line="-")
        axes[1][column].set_xlabel(quantity.label)
        for row in (0, 1):
            axes[row][column].locator_params(axis="x", nbins=5)
        if quantity.name == "hidden_objects":
            for row in (0, 1):
                axes[row][column].set_xscale("log")
                axes[row][column].set_xticks(COUNTS, map(str, COUNTS), minor=False)
                axes[row][column].minorticks_off()
    _finish(axes[0].tolist(), axes[1].tolist())
    return figure


def draw_families(rows: Rows, facts: Mapping[str, TrapFacts]) -> Figure:
    """Returns a figure: success above, collisions below, a place for each family, a marker for each agent."""
    families = _families_of(rows, facts)
    agents = sorted({row.agent for row in rows})
    figure = empty_figure(max(6.0, 1.1 * len(families) + 1.5), 6.6)
    axes = figure.subplots(2, 1, sharex=True)
    for number, agent in enumerate(agents):
        of = [_of(rows, facts, agent, family=name) for name in families]
        known = [(i, point_of(agent, families[i], of_family)) for i, of_family in enumerate(of) if of_family]
        x = np.array([i for i, _ in known]) + 0.5 * (number + 1) / (len(agents) + 1) - 0.25
        for axis, name in zip(axes, ("success", "collisions"), strict=True):
            _bars(axis, x, [point for _, point in known], name, agent, number, line="")
    axes[1].set_xticks(range(len(families)), families, rotation=20, ha="right")
    axes[1].set_xlim(-0.6, len(families) - 0.4)
    _finish([axes[0]], [axes[1]])
    return figure


def draw_family_pictures(folder: Path, name: str, facts: Mapping[str, TrapFacts]) -> None:
    """Writes one picture for each family of a split, with the first trap of each difficulty."""
    env = ObjectNavEnv(split=name, sensors=("rgb",))
    split = env.split
    try:
        for family in dict.fromkeys(trap.family for trap in facts.values()):
            of = [episode for episode in split.episodes if episode.house in facts]
            of = [episode for episode in of if facts[episode.house].family == family]
            first = {facts[episode.house].difficulty: episode for episode in reversed(of)}
            shown = [first[name] for name in DIFFICULTIES if name in first]
            if shown:
                write_picture(folder / f"{family}.png", draw_family(env, shown))
    finally:
        env.close()


def _families_of(rows: Rows, facts: Mapping[str, TrapFacts]) -> list[str]:
    """Returns the families of some rows in the order of the catalogue, then those that it lacks."""
    families = {facts[row.trap].family for row in rows}
    return [*(name for name in FAMILIES if name in families), *sorted(families - set(FAMILIES))]


def _of(
    rows: Rows, facts: Mapping[str, TrapFacts], agent: str, *, family: str | None = None, difficulty: str | None = None
) -> list[TrapResult]:
    """Returns the rows of an agent, of one family or difficulty or of all."""
    return [
        row for row in rows
        if row.agent == agent
        and family in (None, facts[row.trap].family)
        and difficulty in (None, facts[row.trap].difficulty)
    ]  # fmt: skip


def _cell(rows: Rows) -> str:
    """Returns successes out of episodes, with the interval of the rate, the mean number of collisions, and falls."""
    if not rows:
        return "-"
    share = proportion([row.escaped for row in rows], [row.trap for row in rows])
    low, high = (round(100 * value) for value in share.interval)
    fell = sum(row.fell for row in rows)
    falls = f", {fell} fell" if fell else ""
    collisions = np.mean([row.collisions for row in rows])
    return f"{share.count}/{share.of} ({low}-{high} %), {collisions:.1f} collisions{falls}"


def _bars(axes: Axes, x: np.ndarray, points: Sequence[Point], name: str, agent: str, number: int, *, line: str) -> None:
    """Draws one quantity of points with its intervals."""
    value, low, high = (np.array([getattr(p, name + end) for p in points]) for end in ("", "_low", "_high"))
    if len(value):
        axes.errorbar(
            x, value, yerr=[np.maximum(value - low, 0.0), np.maximum(high - value, 0.0)], label=agent, capsize=2,
            marker=MARKERS[number % len(MARKERS)], markersize=5, linestyle=line, linewidth=1.2, color=f"C{number}",
        )  # fmt: skip


def _finish(above: Sequence[Axes], below: Sequence[Axes]) -> None:
    """Adds grids, limits, the labels of the rows of success (above) and collisions (below), and one legend."""
    for row, label in ((above, "success rate"), (below, "collisions of an episode, mean")):
        row[0].set_ylabel(label)
        for axes in row:
            axes.grid(alpha=0.3)
            axes.set_ylim(bottom=0.0)
    for axes in above:
        axes.set_ylim(-0.03, 1.03)
    above[0].figure.legend(*above[0].get_legend_handles_labels(), fontsize=8, loc="outside upper left", ncols=4)
