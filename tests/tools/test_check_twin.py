"""The comparison of the twin with recorded runs: the agent of a run, runs that it refuses, and its lines."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from sim.app.analysis.comparison import read_run
from sim.app.composition.options import RunOptions
from sim.app.composition.setup import resolve
from sim.core.configuration import as_json
from sim.core.geometry.pose import Pose
from sim.core.interface import Action, ConfigError
from sim.homes.plans.export import export_plans
from sim.homes.plans.plan import write_plan
from sim.robot.drive import Motion
from sim.task.trajectory import Recorder, trajectory_file, write_trajectory
from tests.helpers.worlds import room, with_box
from tools.research import check_twin

LINE = {
    "episode_id": "e0", "house": "flat", "goal": "bed", "agent": "stubborn", "seed": 0, "end_reason": "max_steps",
    "success": 0.0, "area_seen_m2": 9.0, "steps_to_first_sight": 40, "num_steps": 3, "collisions": 0,
}  # fmt: skip
FAILED = {name: LINE[name] for name in ("house", "goal")} | {"episode_id": "e1", "end_reason": "error", "success": 0.0}


@pytest.fixture
def run(tmp_path: Path) -> Path:
    """Returns a recorded run of an episode in a plan of two rooms, and of one that failed."""
    house = with_box(room(9, 5), "bed_00", centre_m=(3.4, 1.2, 0.3), half_m=(0.9, 0.9, 0.3))
    house = with_box(house, "wall_10", centre_m=(0.5, 1.2, 1.25), half_m=(0.05, 1.3, 1.25))
    (plan,) = export_plans(house, {})
    write_plan(tmp_path / "plans" / "flat.npz", plan)
    recorder = Recorder(Pose(-3.0, 1.0, 3.0), distance_m=5.0, goal_on_storey=True)
    for number in range(1, 4):
        pose = Pose(-3.0, 1.0, 3.0 - 0.5 * number)
        recorder.move(Motion(Action.TURN_RIGHT, 0.0, -0.5, 1.0, "reached", ()), pose, 5.0)
    folder = tmp_path / "run"
    write_trajectory(trajectory_file(folder, "e0"), recorder.trajectory(end_reason="max_steps"), {})
    (folder / "results.jsonl").write_text("".join(json.dumps(line) + "\n" for line in (LINE, FAILED)))
    record(folder)
    return folder


def record(folder: Path, *, robot: str | None = None, **options: Any) -> Any:
    """Writes the `config.json` of a run with some options and a robot file; returns the configuration of its agent."""
    defaults: dict[str, Any] = {"semantics": "gt", "verification": "none"}
    chosen = RunOptions(**(defaults | options))
    config = resolve(chosen).config
    names = ("agent", "explorer", "semantics")
    content = {name: getattr(chosen, name) for name in names} | {"robot": robot, "config": as_json(config)}
    (folder / "config.json").write_text(json.dumps(content))
    return config.agent


@pytest.mark.parametrize(
    "options",
    [
        *({"agent": name} for name in ("stubborn", "stubborn-ii", "single-frame", "frontier-avoid", "semexp", "poni")),
        {"explorer": "tour"},
        {"config": ("agent.planning.dilation_m=0.1", "agent.mapping.obstacle_stride_px=4")},
        {"explorer": "semexp", "config": ("agent.explorer.semantics=shuffled",)},
    ],
)
def test_the_agent_has_the_explorer_and_the_settings_of_the_run(run: Path, options: dict[str, Any]):
    expected = record(run, **options)
    assert check_twin.agent_config(read_run(run)) == expected


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"agent": "stubborn-plus"}, "the agent 'stubborn-plus', which the twin cannot run. Available: stubborn, "),
        ({"agent": "latest-frame"}, "the twin cannot run"),
        ({"agent": "random"}, "the twin cannot run"),
        ({"agent": "oracle"}, "the twin cannot run"),
        ({"config": ("task.max_steps=300",)}, "has another task than the twin"),
        ({"config": ("camera.height_m=1.0",)}, "has another camera than the twin"),
        ({"robot": "cart.xml"}, r"has a robot of its own \(cart.xml\)"),
        ({"noise": "realsense"}, "has another noise than the twin"),
        ({"semantics": "noisy"}, "has --semantics noisy; the twin has ground truth"),
    ],
)
def test_a_run_that_the_twin_cannot_repeat_is_refused(run: Path, options: dict[str, Any], message: str):
    record(run, **options)
    with pytest.raises(ConfigError, match=message):
        check_twin.main(check_twin.Args(plans=run.parent / "plans", runs=(run,), explore=True))


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("results.jsonl", "{\n", "line 1 is not JSON"),
        ("results.jsonl", json.dumps(FAILED) + "\n", "has no trajectory: give folders of runs made with --record"),
        ("results.jsonl", json.dumps(LINE | {"area_seen_m2": None}) + "\n", "its results have no 'area_seen_m2'"),
        ("results.jsonl", json.dumps(LINE | {"house": "../flat"}) + "\n", "leads out of its folder"),
        ("config.json", "[]", "expected object, got array"),
        ("config.json", "{}", "has no field 'agent'"),
        ("config.json", '{"agent": "stubborn", "semantics": "gt"}', "has no field 'config'"),
        ("config.json", '{"agent": "stubborn", "semantics": "gt", "config": {}}', "has no field 'config.camera'"),
        ("trajectories/e0.npz", "", "is not a trajectory"),
    ],
)
def test_a_broken_run_is_named_in_a_sentence(run: Path, name: str, content: str, message: str):
    (run / name).write_text(content)
    with pytest.raises(ConfigError, match=message):
        check_twin.main(check_twin.Args(plans=run.parent / "plans", runs=(run,), explore=True))


def test_each_episode_has_a_line_of_each_comparison(run: Path, capsys: pytest.CaptureFixture[str]):
    record(run, explorer="tour")
    args = check_twin.Args(plans=run.parent / "plans", runs=(run,), explore=True, out=run.parent / "new" / "out.jsonl")
    assert check_twin.main(args) == 0
    assert args.out is not None
    lines = [json.loads(line) for line in args.out.read_text().splitlines()]
    assert [line["kind"] for line in lines] == ["replay", "explore", "shifted"]
    assert {line["episode_id"] for line in lines} == {"e0"}
    assert lines[0]["real"]["area_seen_m2"] == 9.0
    assert lines[0]["twin"]["area_seen_m2"] > 0.5
    assert lines[1]["twin"]["end_reason"] == "stop"
    printed = capsys.readouterr().out
    assert "run: stubborn in the twin, 1 episodes" in printed
