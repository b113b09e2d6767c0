"""Rendering of recorded episodes: those without an action are left out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import Action, ConfigError
from sim.robot.drive import Motion
from sim.task.trajectory import Recorder, trajectory_file, write_trajectory
from sim.training.cloned.demonstrations import list_demonstrations, read_demonstration
from tests.helpers.results import write_lines
from tests.helpers.worlds import room, with_box
from tools.training import render_demonstrations


def test_an_episode_that_failed_at_its_first_action_is_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    house = with_box(room(6, 4), "bed_00", centre_m=(1.9, 0.0, 0.5), half_m=(0.5, 0.6, 0.5))
    monkeypatch.setattr(render_demonstrations, "split_of", lambda _: SimpleNamespace(load_house=lambda _: house))
    run = tmp_path / "run"
    run.mkdir()
    (run / "config.json").write_text("{}")
    for steps in (0, 2):
        recorder = Recorder(Pose(-1.0, 0.0, 0.0), distance_m=2.0, goal_on_storey=True)
        for _ in range(steps):
            recorder.move(Motion(Action.TURN_LEFT, 0.0, 0.5, 1.0, "reached", ()), Pose(-1.0, 0.0, 0.5), 2.0)
        write_trajectory(trajectory_file(run, f"e{steps}"), recorder.trajectory(end_reason="error"), None)
    write_lines(run, *({"episode_id": name, "end_reason": "error", "success": 0.0} for name in ("e0", "e2")))
    args = render_demonstrations.Args(runs=(run,), out=tmp_path / "out", failed=True, width_px=16, height_px=12)
    assert render_demonstrations.main(args) == 0
    (file,) = list_demonstrations([tmp_path / "out"])
    assert file.stem == "e2"
    assert len(read_demonstration(file).actions) == 2
    assert "wrote 1 episodes with 2 frames" in (printed := capsys.readouterr().out)
    assert "1 without an action were left out" in printed
    with pytest.raises(ConfigError, match=r"e2.npz.*16.*12.*--out"):
        render_demonstrations.main(replace(args, width_px=32, height_px=24))
