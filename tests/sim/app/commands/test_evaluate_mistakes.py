"""Sheets with the images and the network's output in failed episodes."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from sim.app.analysis.comparison import Run, read_run
from sim.app.commands import run
from sim.app.commands.evaluate import mistakes as show_mistakes
from sim.app.commands.evaluate.mistakes import Args
from sim.app.viewers.palette import PALETTE
from sim.core.interface import MPCAT40_ID, ConfigError
from sim.task.trajectory import Trajectory, read_trajectory, trajectory_file
from stubborn.segmentation.network import NetworkSegmenter
from tests.helpers import wording
from tests.helpers.worlds import room, with_box


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Returns a folder with two recorded episodes in which the agent stops at once, far from the sofa."""
    folder = tmp_path_factory.mktemp("recorded")
    house = with_box(room(9, 4), "sofa_00", centre_m=(4.0, 0, 0.4), half_m=(0.4, 0.8, 0.4))
    (folder / "lounge.xml").write_text(house.spec.to_xml())
    options = ["--agent", "tests.helpers.runners:make_quitter", "--house", str(folder / "lounge.xml"), "--record"]
    assert (
        run.entry(
            [*options, "--episodes", "2", "--start-deg", "-3 0 0", "--noise", "realsense", "--out", str(folder / "run")]
        )
        == 0
    )
    return folder


@pytest.mark.costly
def test_a_row_an_episode_shows_the_picture_of_the_stop(recorded: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = recorded / "sheets" / "false.png"
    assert show_mistakes.main(Args(run=recorded / "run", out=out)) == 0
    lines = capsys.readouterr().out.splitlines()
    assert sorted(line.split(" ")[0] for line in lines[:2]) == sorted(read_run(recorded / "run").results)
    assert lines[0].startswith("lounge_0000 sofa, step 1: ")
    assert lines[2] == f"2 episodes that failed by false_detection, in {out}."
    sheet = np.asarray(cv2.imread(str(out)))[..., ::-1]
    height_px = show_mistakes.PANEL_PX * 480 // 640 + show_mistakes.CAPTION_PX
    assert sheet.shape == (2 * height_px + show_mistakes.CAPTION_PX, 4 * show_mistakes.PANEL_PX, 3)
    headings = sheet[: show_mistakes.CAPTION_PX].reshape(show_mistakes.CAPTION_PX, 4, show_mistakes.PANEL_PX, 3)
    assert (headings.min(axis=(0, 2, 3)) < 100).all()  # each panel has a title
    trajectory = read_trajectory(trajectory_file(recorded / "run", "lounge_0000"))
    house = read_run(recorded / "run").config["house"]
    images = show_mistakes.render_at(
        show_mistakes.World(show_mistakes.split_of(read_run(recorded / "run")).load_house(Path(str(house)).stem)),
        trajectory.poses[-1],
    )
    ahead = images["semantic"][270, 320]
    assert ahead == MPCAT40_ID["sofa"]
    column = show_mistakes.PANEL_PX + show_mistakes.PANEL_PX // 2  # the true categories are the second panel
    row = 2 * show_mistakes.CAPTION_PX + 270 * show_mistakes.PANEL_PX // 640
    assert sheet[row, column].tolist() == PALETTE[ahead].tolist()


@pytest.mark.costly
def test_omitted_failures_are_reported_with_the_option_that_draws_them(
    recorded: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(recorded / "run", tmp_path / "run")
    first, second = (json.loads(line) for line in (tmp_path / "run" / "results.jsonl").read_text().splitlines())
    others = [first, second | {"failure": "stopped_short"}]
    (tmp_path / "run" / "results.jsonl").write_text("".join(json.dumps(line) + "\n" for line in others))
    args = Args(run=tmp_path / "run", out=tmp_path / "a.png")
    assert show_mistakes.main(args) == 0
    assert capsys.readouterr().out.endswith(" Failures by other causes are drawn with --cause stopped_short (1).\n")
    assert show_mistakes.main(replace(args, cause="explore")) == 1
    assert "--cause false_detection (1), --cause stopped_short (1)." in capsys.readouterr().out
    assert show_mistakes.main(Args(run=recorded / "run", out=tmp_path / "a.png", count=1)) == 0
    assert "1 episode of 2 (--count 2 draws all) that failed by false_detection" in capsys.readouterr().out


def test_the_decisive_frame_is_the_last_or_the_one_that_shows_most(recorded: Path) -> None:
    trajectory = read_trajectory(trajectory_file(recorded / "run", "lounge_0000"))
    shares = np.array([0.01, np.nan, 0.2, 0.05], np.float32)
    longer = Trajectory(
        **{name: getattr(trajectory, name) for name in trajectory.__dataclass_fields__}
        | {"goal_share": shares, "actions": np.zeros(3, np.uint8)}
    )
    assert show_mistakes.decisive_step(longer) == 3  # it stopped there
    assert show_mistakes.decisive_step(replace(longer, end_reason="max_steps")) == 2
    unknown = replace(longer, end_reason="max_steps", goal_share=np.full_like(longer.goal_share, np.nan))
    assert show_mistakes.decisive_step(unknown) == 0


def test_words_name_the_true_categories_where_the_goal_is_seen() -> None:
    semantic = np.full((8, 8), MPCAT40_ID["chair"], np.uint8)
    semantic[:, 6:] = MPCAT40_ID["wall"]
    score = np.zeros((4, 4), np.float32)
    assert show_mistakes.in_words(semantic, score + 0.3) == "nothing scored above 0.5, at most 0.30"
    score[:] = 0.9
    assert show_mistakes.in_words(semantic, score) == "taken for it: chair 75%, wall 25%"


def test_runs_of_other_segmentation_and_without_such_failures_are_reported(
    recorded: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert show_mistakes.main(Args(run=recorded / "run", out=tmp_path / "a.png", cause="missed_detection")) == 1
    assert "failed by missed_detection" in capsys.readouterr().out
    other = tmp_path / "gt"
    other.mkdir()
    config = json.loads((recorded / "run" / "config.json").read_text())
    (other / "config.json").write_text(json.dumps(config | {"semantics": "gt"}))
    (other / "results.jsonl").write_text((recorded / "run" / "results.jsonl").read_text())
    with pytest.raises(ConfigError, match="--semantics gt"):
        show_mistakes.main(Args(run=other, out=tmp_path / "a.png"))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"robot": "robots/mine.xml"}, "another robot"),
        ({"config": {"camera": {"height_m": 0.5}}}, wording.ANOTHER_CAMERA_THAN_OURS),
        ({"config": {"robot": {"camera_forward_m": 0.1}}}, wording.ANOTHER_ROBOT_THAN_OURS),
        ({"settings": {"detector.weights": "gone.safetensors"}}, "gone.safetensors"),
        ({"files_sha256": {"weights": "0" * 64}}, "other weights"),
    ],
)
def test_a_run_of_another_camera_or_network_is_not_drawn_with_this_one(
    recorded: Path, changes: dict[str, object], message: str
) -> None:
    run_of = read_run(recorded / "run")
    with pytest.raises(ConfigError, match=message):
        show_mistakes.segmenter_of(replace(run_of, config={**run_of.config, **changes}))


def test_a_run_whose_agent_did_not_use_the_segmentation_is_not_drawn_with_it(tmp_path: Path) -> None:
    run_of = Run(tmp_path, {"agent": "random", "semantics": "rednet", "segmentation": {"name": None}}, {})
    with pytest.raises(ConfigError, match="did not use --semantics; its segmentation is none"):
        show_mistakes.segmenter_of(run_of)


def test_another_motion_changes_no_picture_and_a_goal_in_words_has_no_score(recorded: Path) -> None:
    run_of = read_run(recorded / "run")
    tree = run_of.config.get("config", {})
    sliding = {**tree, "robot": {**tree.get("robot", {}), "motion": "sliding"}}
    segmenter = show_mistakes.segmenter_of(replace(run_of, config={**run_of.config, "config": sliding}))
    images = {
        "rgb": np.zeros((480, 640, 3), np.uint8),
        "depth": np.ones((480, 640), np.float32),
        "semantic": np.ones((480, 640), np.uint8),
    }
    panels, text = show_mistakes.draw(images, segmenter, "nightstand")
    assert text == "this goal has no score"
    assert (panels[:, -show_mistakes.PANEL_PX :] == 255).all()


def test_a_run_with_a_segmentation_of_ones_own_is_drawn_with_it(
    recorded: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(recorded / "run", tmp_path / "run")
    config = json.loads((tmp_path / "run" / "config.json").read_text())
    config |= {"semantics": "tests.helpers.segmentations:FLAT", "settings": {"detector.level": 0.625}}
    (tmp_path / "run" / "config.json").write_text(json.dumps(config))
    assert show_mistakes.main(Args(run=tmp_path / "run", out=tmp_path / "a.png", count=1)) == 0
    assert "sofa, step 1: taken for it: wall 45%, floor 34%" in capsys.readouterr().out
    score = np.asarray(cv2.imread(str(tmp_path / "a.png")))[-100:, -100:, ::-1]
    assert (score == [255, 95, 95]).all()  # 0.625 of red


@pytest.mark.parametrize("mirrored", [True, False])
def test_the_network_of_a_run_is_mirrored_as_in_the_run_and_another_precision_is_named(
    recorded: Path, mirrored: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    run_of = read_run(recorded / "run")
    tree = {**run_of.config["config"], "detector": {"mirrored": mirrored}}
    for precision in ("bf16", "fp32"):
        config = {**run_of.config, "config": tree, "segmentation": {"precision": precision}}
        network = show_mistakes.segmenter_of(replace(run_of, config=config))
        assert isinstance(network, NetworkSegmenter)
        assert network.mirrored == mirrored
        here = "bf16" if network.bf16 else "fp32"
        sentence = f"The network computed in {precision} in the run and computes in {here} here; "
        assert capsys.readouterr().out.startswith(sentence) == (precision != here)
