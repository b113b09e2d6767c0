"""The benchmark measures each part, alternates between versions, and its table agrees with its figures."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.app.commands.bench import bench, figures, report
from sim.app.commands.bench.calibration import Calibration
from sim.app.commands.bench.figures import Figure, Goal, interleaved, stopwatch
from sim.app.commands.bench.growth import MAP_CELLS, hall, memory_mb
from sim.app.commands.bench.rendering import QUALITIES, PlainRenderer
from sim.app.commands.bench.stages import free_poses
from sim.core.interface import ConfigError
from sim.episodes.splits import load_split
from sim.gl import mujoco
from sim.houses.house import House
from sim.renderer.camera import Camera
from sim.world.world import World

FIGURE = Figure(
    part="a", what="a frame", value=2.0, unit="ms", against="another", baseline=10.0, ratio=5.0, count=3,
    goal=Goal(of="ratio", sign=">=", bound=4.0),
)  # fmt: skip
CALM = Calibration(render_ms=10.0, step_ms=1.0, fast_marching_ms=8.0)


def test_works_take_turns_and_the_least_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    done: list[tuple[str, int]] = []
    slow = iter([1.0, 1.0, 5.0, 7.0, 3.0, 8.0, 6.0, 4.0, 2.0, 5.0])

    def taken(work: Callable[[], object]) -> float:
        work()
        return next(slow)

    monkeypatch.setattr(figures, "timed", taken)
    works: dict[str, Callable[[int], object]] = {
        "ours": lambda case: done.append(("ours", case)),
        "theirs": lambda case: done.append(("theirs", case)),
    }
    ms = interleaved(works, [0, 1], repeats=2)
    assert [name for name, _ in done] == ["ours", "theirs"] * 5
    assert ms["ours"].tolist() == [3.0, 2.0]  # the first round does not count
    assert ms["theirs"].tolist() == [7.0, 4.0]


class Clerk:
    def work(self, seconds: float) -> float:
        return seconds


def test_a_stopwatch_counts_methods_and_leaves_them_as_they_were() -> None:
    plain = Clerk.work
    with stopwatch({"office": [(Clerk, "work")]}) as ms:
        assert Clerk().work(3.0) == 3.0
        assert 0.0 < ms["office"] < 1e3
        first = ms["office"]
        Clerk().work(1.0)
        assert ms["office"] > first
    assert Clerk.work is plain


@pytest.mark.parametrize(
    ("goal", "met"),
    [
        (Goal(of="ratio", sign=">=", bound=5.0), True),
        (Goal(of="ratio", sign=">=", bound=5.1), False),
        (Goal(of="value", sign="<=", bound=2.0), True),
        (Goal(of="value", sign="<=", bound=1.9), False),
        (None, None),
    ],
)
def test_a_figure_is_met_according_to_its_goal(goal: Goal | None, met: bool | None) -> None:
    assert Figure(**{**vars(FIGURE), "goal": goal}).met is met


@pytest.mark.costly
@pytest.mark.parametrize("quality", QUALITIES)
def test_the_baseline_draws_what_our_camera_draws(quality: str) -> None:
    split = load_split("val")
    world = World(split.load_house("val_00"))
    mujoco.mj_forward(world.model, world.data)
    plain, camera = PlainRenderer(world, quality), Camera(world.model, world.labels)
    try:
        for pose in free_poses(world, 2, np.random.default_rng(0)):
            theirs = plain.render(pose, ("depth", "semantic"))
            ours = camera.render(world.data, pose, ("depth", "geom"))
            seen = (ours["depth"] > 0.5) & (ours["depth"] < 5.0)
            assert (theirs["semantic"][..., 0] == ours["geom"]).mean() > 0.97
            assert np.abs(theirs["depth"] - ours["depth"])[seen].max() < 5.0  # an edge may be another's
            assert np.median(np.abs(theirs["depth"] - ours["depth"])[seen]) < 1e-3
    finally:
        plain.close()
        camera.close()


def test_a_hall_has_as_many_geoms_as_asked_and_is_a_house() -> None:
    for count in (100, 300):
        world = World(House("hall", hall(count)))
        geoms = [world.model.geom(i).name for i in range(world.model.ngeom)]
        assert sum(not name.startswith("stubborn_robot/") for name in geoms) == count


def test_memory_is_reported_in_megabytes() -> None:
    memory = memory_mb()
    assert 30 < memory["VmRSS"] <= memory["VmHWM"] < 20_000


def test_the_paper_s_map_is_the_one_that_others_are_compared_with() -> None:
    from stubborn.agent import AgentConfig

    assert MAP_CELLS[1] == AgentConfig().map_cells


def test_a_machine_that_is_not_quiet_gives_a_warning() -> None:
    busy = Calibration(render_ms=13.0, step_ms=1.0, fast_marching_ms=8.1)
    assert bench.drifts({"a": CALM, "end": CALM}) == []
    assert bench.drifts({"a": CALM, "b": busy, "end": CALM}) == [
        "The machine was not quiet: the fixed render took 10.00 to 13.00 ms in the course of this run."
    ]


def test_a_page_keeps_all_but_what_is_between_its_marks(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(f"before\n{report.BEGIN}\nold\n{report.END}\nafter\n")
    about = {"processor": "P", "cores": 2, "gl_renderer": "G", "LP_NUM_THREADS": "1", "load": 0.1, "code": "c0de"}
    text = report.to_markdown([FIGURE], {**about, "versions": {"mujoco": "4"}}, CALM, "stubborn bench")
    for _ in range(2):
        report.write_between_marks(page, text)
    written = page.read_text()
    assert written.startswith(f"before\n{report.BEGIN}\n")
    assert written.endswith(f"{report.END}\nafter\n")
    assert "old" not in written
    assert written.count("| a | a frame | 2.00 ms | 10.0 ms: another | 5.00 | >= 4 | yes |") == 1
    assert "mujoco 4" in written
    page.write_text("no marks")
    with pytest.raises(ConfigError, match="has no place for the table"):
        report.write_between_marks(page, text)


def run_quickly(parts: str, tmp_path: Path) -> dict[str, Any]:
    assert bench.main(bench.Args(parts=parts, quick=True, out=tmp_path / "bench.json")) == 0
    written = json.loads((tmp_path / "bench.json").read_text())
    assert set(written["calibration"]) == {*parts.split(","), "end"}
    assert written["machine"]["LP_NUM_THREADS"] == "1"
    assert {figure["part"] for figure in written["figures"]} == set(parts.split(","))
    for figure in written["figures"]:
        assert figure["value"] >= 0.0
        assert figure["ratio"] >= 0.0
        assert figure["baseline"] > 0.0
    return written


@pytest.mark.costly
def test_a_quick_run_writes_figures_machine_and_calibration(tmp_path: Path) -> None:
    written = run_quickly("c", tmp_path)
    shares = [figure["ratio"] for figure in written["figures"] if figure["what"].startswith("of it")]
    assert 0.8 < sum(shares) <= 1.0


@pytest.mark.slow
def test_every_part_runs(tmp_path: Path) -> None:
    written = run_quickly(",".join(bench.PARTS), tmp_path)
    shares = {"gt": 0.0, "rednet": 0.0}
    for figure in written["figures"]:
        if figure["part"] == "d" and figure["what"].startswith("of it"):
            shares[figure["what"].split(", ")[1]] += figure["ratio"]
    assert shares["gt"] == pytest.approx(1.0)
    assert shares["rednet"] == pytest.approx(1.0)
