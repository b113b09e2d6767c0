"""The external eye: silhouettes, matches, intervals, and the process of the detector."""

from __future__ import annotations

import json
import math
import stat
import sys
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest

from sim.core.errors import ConfigError
from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel
from sim.core.pictures import decode_picture
from sim.gl import mujoco
from tools.research import external_eye
from tools.research.external_eye import (
    FILES,
    SeenView,
    by_style,
    difference,
    false_detections,
    missed,
    read_views,
    scores,
    write_sheets,
)
from tools.research.external_eye_scores import Detection, Truth, match, paired_difference, share_with_interval, whole_px

CAMERA, HERE = CameraModel(), Pose(0.0, 0.0, 0.0, 0.0)
CHAIR = Truth("chair_00", "chair", (100.0, 100.0, 200.0, 300.0), counted=True)
SEEN = Detection("chair", (110.0, 100.0, 200.0, 310.0), 0.3)


def _px_of(geom: str, assets: str = "") -> float:
    """Returns the silhouette of one geom, pixels."""
    model = mujoco.MjModel.from_xml_string(f"<mujoco><asset>{assets}</asset><worldbody>{geom}</worldbody></mujoco>")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return whole_px(model, data, [0], HERE, CAMERA)


def test_a_plate_that_faces_the_camera_has_the_area_of_its_projection() -> None:
    wanted = 0.4 * 0.6 * CAMERA.focal_px**2 / 2.0**2
    assert _px_of('<geom type="box" size="0.0001 0.2 0.3" pos="2 0 0.88"/>') == pytest.approx(wanted, rel=0.03)


def test_parts_beyond_the_border_of_the_picture_count() -> None:
    edge_m = 2.0 * math.tan(0.5 * CAMERA.hfov_rad)
    plate = '<geom type="box" size="0.0001 0.2 0.3" pos="2 {} 0.88"/>'
    assert _px_of(plate.format(edge_m)) == pytest.approx(_px_of(plate.format(0.0)), rel=0.03)


@pytest.mark.parametrize(
    ("geom", "wanted_m2"),
    [
        ('<geom type="sphere" size="0.2" pos="4 0 0.88"/>', math.pi * 0.04),
        ('<geom type="cylinder" size="0.2 0.3" pos="4 0 0.88"/>', 0.24),
        ('<geom type="capsule" size="0.2 0.1" pos="4 0 0.88"/>', math.pi * 0.04 + 0.08),
    ],
)
def test_round_geoms_have_about_the_area_of_their_outline(geom: str, wanted_m2: float) -> None:
    assert _px_of(geom) == pytest.approx(wanted_m2 * CAMERA.focal_px**2 / 16.0, rel=0.17)


def test_a_mesh_with_a_gap_has_no_hull() -> None:
    two = "0 -0.3 0  0 -0.2 0  0 -0.2 0.3  0.01 -0.25 0.1  0 0.2 0  0 0.3 0  0 0.3 0.3  0.01 0.25 0.1"
    faces = "0 1 2  0 3 1  1 3 2  2 3 0  4 5 6  4 7 5  5 7 6  6 7 4"
    mesh = f'<mesh name="two" inertia="shell" vertex="{two}" face="{faces}"/>'
    area = _px_of('<geom type="mesh" mesh="two" pos="3 0 0.8"/>', mesh)
    assert area < 0.5 * 0.6 * 0.3 * CAMERA.focal_px**2 / 9.0


def test_an_object_is_found_once_by_the_better_of_two_boxes() -> None:
    worse = replace(SEEN, score=0.2)
    assert match([CHAIR], [worse, SEEN], {}) == ([True], [False, True])


def test_a_box_elsewhere_or_of_another_class_is_wrong() -> None:
    elsewhere, other = replace(SEEN, box=(400.0, 0.0, 500.0, 90.0)), replace(SEEN, category="couch")
    assert match([CHAIR], [elsewhere, other], {}) == ([False], [False, False])


def test_a_box_around_an_object_that_does_not_count_is_neither_right_nor_wrong() -> None:
    assert match([replace(CHAIR, counted=False)], [SEEN], {}) == ([False], [None])
    stool = replace(CHAIR, category="stool")
    assert match([stool], [SEEN], {"chair": ("stool",)}) == ([False], [None])
    assert match([stool], [SEEN], {}) == ([False], [False])


def test_the_interval_holds_the_share_and_narrows_with_more_houses() -> None:
    few = share_with_interval({"a": 4, "b": 1}, {"a": 5, "b": 5})
    many = share_with_interval({f"{n}": 4 - 3 * (n % 2) for n in range(40)}, dict.fromkeys(map(str, range(40)), 5))
    assert few[0] == many[0] == 0.5
    assert few[1] <= 0.5 <= few[2]
    assert many[2] - many[1] < few[2] - few[1]
    assert many[2] - many[1] == pytest.approx(2 * 1.96 * 0.3 / math.sqrt(40), rel=0.1)  # of a normal distribution
    assert math.isnan(share_with_interval({}, {})[0])


def test_a_paired_difference_has_the_sign_of_the_change() -> None:
    value, low, _ = paired_difference({"a": 1, "b": 2}, {"a": 3, "b": 4}, {"a": 4, "b": 4})
    assert value == 0.5
    assert low > 0.0


def test_the_table_counts_at_each_score() -> None:
    views = [SeenView("house", HERE, (CHAIR,), (SEEN,))]
    by_score = {score: scores(views, score)[0] for score in (0.25, 0.5)}
    assert (by_score[0.25]["found"], by_score[0.25]["objects"]) == (1, 1)
    assert (by_score[0.5]["found"], by_score[0.5]["detections"]) == (0, 0)


def test_the_styles_of_a_class_are_counted_apart() -> None:
    views = [SeenView("house", HERE, (replace(CHAIR, style="shell"), replace(CHAIR, counted=False)), (SEEN,))]
    assert by_style(views, 0.25) == [{"category": "chair", "style": "shell", "score": 0.25, "objects": 1, "found": 1}]


def test_runs_are_compared_by_the_objects_that_count_in_both() -> None:
    second = replace(CHAIR, name="chair_01", box=(300.0, 100.0, 400.0, 300.0))
    third = replace(CHAIR, name="chair_02", box=(500.0, 100.0, 600.0, 300.0))
    before = [SeenView("house", HERE, (CHAIR, second, replace(third, counted=False)), ())]
    after = [SeenView("house", HERE, (CHAIR, replace(second, counted=False), third), (SEEN,))]
    change = difference(before, after, "chair", 0.25)
    assert (change["paired_objects"], change["found_before"], change["found_after"]) == (1, 0, 1)


def test_views_are_read_as_they_were_written(tmp_path: Path) -> None:
    views = [SeenView("house", HERE, (CHAIR,), (SEEN,))]
    (tmp_path / "views.json").write_text(json.dumps([asdict(view) for view in views]), encoding="utf-8")
    assert read_views(tmp_path) == views
    with pytest.raises(ConfigError, match="absent"):
        read_views(tmp_path / "absent")


def test_missed_objects_and_false_detections_are_listed_and_drawn(tmp_path: Path) -> None:
    bed, doubtful = Detection("bed", SEEN.box, 0.3), replace(SEEN, score=0.2)
    view = SeenView("house", HERE, (CHAIR,), (bed, doubtful))
    assert missed(view) == []
    assert false_detections(view) == [bed]
    assert missed(replace(view, detections=(bed,))) == [CHAIR]
    assert false_detections(replace(view, truths=(replace(CHAIR, counted=False),), detections=(SEEN,))) == []
    write_sheets(tmp_path, {"missed_dining table": [np.full((4, 4, 3), 9, np.uint8)] * 7})
    (file,) = tmp_path.iterdir()
    assert file.name == "missed_dining_table.png"
    assert decode_picture(file.read_bytes(), where="the sheet").shape == (8, 24, 3)


def test_missing_packages_and_a_missing_node_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(external_eye.shutil, "which", lambda _: sys.executable)
    with pytest.raises(ConfigError, match="npm install --prefix"):
        external_eye.Detector(tmp_path)
    monkeypatch.setattr(external_eye.shutil, "which", lambda _: None)
    with pytest.raises(ConfigError, match=r"Node\.js"):
        external_eye.Detector(tmp_path)


def _detector(folder: Path, monkeypatch: pytest.MonkeyPatch, script: str) -> external_eye.Detector:
    """Returns a detector whose process is a Python script in place of Node.js."""
    for name in FILES:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).touch()
    program = folder / "node"
    program.write_text(f"#!{sys.executable}\nimport sys\n{script}\n", encoding="utf-8")
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setattr(external_eye.shutil, "which", lambda _: str(program))
    return external_eye.Detector(folder)


def test_boxes_come_back_in_pixels_of_the_view(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    reply = (
        "sys.stdin.buffer.read(512 * 512 * 3); print('[[0, 0, 256, 512, 0.5, 56], [0, 0, 9, 9, 0.9, 1]]', flush=True)"
    )
    with _detector(tmp_path, monkeypatch, reply) as detector:
        detections = detector.detect(np.zeros((480, 640, 3), np.uint8))
    assert detections == [Detection("chair", (0.0, 0.0, 320.0, 480.0), 0.5)]


def test_a_detector_that_ends_is_an_error_with_its_last_words(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with (
        _detector(tmp_path, monkeypatch, "print('no such module', file=sys.stderr); sys.exit(1)") as detector,
        pytest.raises(ConfigError, match="no such module"),
    ):
        detector.detect(np.zeros((480, 640, 3), np.uint8))
