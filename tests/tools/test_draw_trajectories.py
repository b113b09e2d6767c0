"""Pictures of recorded episodes agree with the trajectory."""

from __future__ import annotations

import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest

from sim.app.analysis.comparison import read_run
from sim.app.commands import run
from sim.core.geometry.grid import GridFrame
from sim.core.interface import ConfigError
from sim.task.trajectory import read_trajectory, trajectory_file
from tests.helpers.worlds import room, with_box
from tools.research import draw_trajectories

FRAME = GridFrame(origin_xy_m=(-3.0, -2.0), shape=(160, 240), cell_m=0.025)
HEIGHT_PX = round(160 * FRAME.cell_m * draw_trajectories.PX_M)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Returns a run of two recorded episodes in which the agent stops at once."""
    folder = tmp_path_factory.mktemp("recorded")
    house = with_box(room(6, 4), "sofa_00", centre_m=(2.5, 0, 0.4), half_m=(0.4, 0.8, 0.4))
    (folder / "lounge.xml").write_text(house.spec.to_xml())
    options = ["--agent", "tests.helpers.runners:make_quitter", "--house", str(folder / "lounge.xml"), "--record"]
    assert run.entry([*options, "--episodes", "2", "--out", str(folder / "run")]) == 0
    return folder


def test_x_goes_right_and_y_up_at_the_scale_of_the_picture() -> None:
    corner, right, up = draw_trajectories.to_pixels(FRAME, np.array([[-3, -2], [-2, -2], [-3, -1]]), HEIGHT_PX)
    assert corner.tolist() == [0, HEIGHT_PX]
    assert (right - corner).tolist() == [draw_trajectories.PX_M, 0]
    assert (up - corner).tolist() == [0, -draw_trajectories.PX_M]


@pytest.mark.slow
def test_each_failed_episode_gets_a_picture_with_the_end_of_its_path(
    recorded: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert draw_trajectories.main(draw_trajectories.Args(runs=(recorded / "run",))) == 0
    output = capsys.readouterr().out
    for episode_id, line in read_run(recorded / "run").lines.items():
        assert f"{episode_id} sofa: {line['failure']} (stop); 1 steps, 0.0 m" in output
        file = recorded / "run" / "pictures" / f"{episode_id}.png"
        picture = np.asarray(cv2.imread(str(file)))[..., ::-1]
        trajectory = read_trajectory(trajectory_file(recorded / "run", episode_id))
        x_m, y_m = trajectory.positions_m[-1].tolist()
        from_bottom = picture.shape[0] - draw_trajectories.CHART_PX
        # The plan lies above the chart and begins 0.25 m outside the room.
        pixel_m = 1.0 / draw_trajectories.PX_M
        for place_m, colour in (((2.5, 0.0), draw_trajectories.INSTANCE), ((x_m, y_m), draw_trajectories.INK)):
            column = round((place_m[0] + 3.25) / pixel_m)
            row = round(from_bottom - (place_m[1] + 2.25) / pixel_m)
            assert picture[row, column].tolist() == list(colour), place_m


def test_an_episode_without_a_trajectory_is_skipped_and_named(
    recorded: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(recorded / "run", tmp_path / "run")
    first, second = read_run(tmp_path / "run").lines
    trajectory_file(tmp_path / "run", first).unlink()
    args = draw_trajectories.Args(runs=(tmp_path / "run",), out=tmp_path / "pictures")
    assert draw_trajectories.main(args) == 0
    assert f"No trajectory, not drawn: {first} (" in capsys.readouterr().out
    assert [file.stem for file in (tmp_path / "pictures").iterdir()] == [second]
    trajectory_file(tmp_path / "run", second).unlink()
    assert draw_trajectories.main(args) == 1  # nothing could be drawn


def test_a_house_that_has_changed_since_is_refused(recorded: Path) -> None:
    file = recorded / "lounge.xml"
    before = file.read_text()
    try:
        file.write_text(before + "\n")
        with pytest.raises(ConfigError, match="another version of 'lounge'"):
            draw_trajectories.main(draw_trajectories.Args(runs=(recorded / "run",)))
    finally:
        file.write_text(before)


def test_an_unknown_episode_is_refused(recorded: Path) -> None:
    with pytest.raises(ConfigError, match="no episode 'nowhere'"):
        draw_trajectories.main(draw_trajectories.Args(runs=(recorded / "run",), episodes=("nowhere",)))


def test_two_runs_are_drawn_side_by_side(recorded: Path, tmp_path: Path) -> None:
    shutil.copytree(recorded / "run", tmp_path / "other")
    episode_id = next(iter(read_run(recorded / "run").lines))
    args = draw_trajectories.Args(
        runs=(recorded / "run", tmp_path / "other"), episodes=(episode_id,), out=tmp_path / "pictures"
    )
    assert draw_trajectories.main(args) == 0
    picture = np.asarray(cv2.imread(str(tmp_path / "pictures" / f"{episode_id}.png")))
    width_px = (picture.shape[1] - draw_trajectories.GAP_PX) // 2
    left, gap, right = np.split(picture, [width_px, width_px + draw_trajectories.GAP_PX], axis=1)
    assert (gap == 255).all()
    assert right.shape == left.shape
    chart = slice(-draw_trajectories.CHART_PX, None)
    assert (left[chart] == right[chart]).all()


def test_two_runs_that_agree_give_no_pictures(
    recorded: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(recorded / "run", tmp_path / "other")
    args = draw_trajectories.Args(runs=(recorded / "run", tmp_path / "other"), out=tmp_path / "pictures")
    assert draw_trajectories.main(args) == 0
    assert not (tmp_path / "pictures").exists()
    assert "The runs succeed in the same episodes: nothing to draw." in capsys.readouterr().out


def test_no_run_is_refused() -> None:
    with pytest.raises(ConfigError, match="Give the folder of a run"):
        draw_trajectories.main(draw_trajectories.Args(runs=()))
