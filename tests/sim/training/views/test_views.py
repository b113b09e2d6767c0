"""Labelled views: their poses, their shards, and the files of a killed or broken run."""

from __future__ import annotations

import errno
import itertools
import json
import os
import re
import tarfile
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from sim.core.interface import MPCAT40_ID, CameraModel, ConfigError
from sim.env.scene import Scene
from sim.robot.config import RobotConfig
from sim.training.views import shards
from sim.training.views.shards import PNG_OPTIONS, read_note, write_index, write_shard
from sim.training.views.views import View, is_bare, sample_views
from tests.helpers import wording
from tests.helpers.worlds import room, with_box

RECORD = {"house": "room", "seed": 0}


@pytest.fixture(scope="module")
def scene():
    house = with_box(room(6, 5), "sofa_00", centre_m=(1.5, 0.5, 0.4), half_m=(0.4, 0.9, 0.4))
    scene = Scene(house, robot=RobotConfig(), camera=CameraModel(), profile="fast")
    yield scene
    scene.close()


def views_of(scene: Scene, seed: int = 0, count: int = 6, block_px: int = 2, **more: Any) -> list[View]:
    rng = np.random.default_rng(seed)
    return list(sample_views(scene, rng, count, stem="v", record=RECORD, block_px=block_px, **more))


def test_views_are_from_free_space_and_show_the_objects_of_the_house(scene: Scene) -> None:
    views = views_of(scene, count=12)
    space = scene.task.truth.space(0.0)
    for view in views:
        pose = view.record["pose"]
        assert space.clearance(pose["x_m"], pose["y_m"]) >= RobotConfig().model.radius_m - 0.02
        assert view.rgb.shape == (240, 320, 3)
        assert view.depth_mm.shape == view.semantic.shape == (240, 320)
        assert not is_bare(view.semantic, (view.depth_mm / 1000.0).astype(np.float32))
    assert {view.record["pose_kind"] for view in views} == {"path", "anywhere"}
    assert any((view.semantic == MPCAT40_ID["sofa"]).mean() > 0.05 for view in views)


def test_path_views_follow_one_another_as_a_robot_moves(scene: Scene) -> None:
    """Along a path, the headings are multiples of 30 deg from the first one."""
    from sim.training.views.poses import path_poses

    space = scene.task.truth.space(0.0)
    poses = list(path_poses(space, np.argwhere(space.largest_part()), np.random.default_rng(3)))
    assert len(poses) > 3
    for before, after in itertools.pairwise(poses):
        turn = np.degrees(after.yaw_rad - before.yaw_rad)
        moved = before.distance_to(after)
        assert (moved, round(turn) % 360) in [(0.0, 30), (0.0, 330)] or (abs(moved - 0.25) < 1e-6 and abs(turn) < 1e-6)


def test_a_near_bare_wall_is_rejected_and_a_far_one_or_an_object_is_not() -> None:
    wall = np.full((480, 640), MPCAT40_ID["wall"], np.uint8)
    assert is_bare(wall, np.full((480, 640), 0.8, np.float32))
    assert is_bare(wall, np.zeros((480, 640), np.float32))
    assert not is_bare(wall, np.full((480, 640), 2.0, np.float32))
    with_picture = wall.copy()
    with_picture[100:220, 100:300] = MPCAT40_ID["picture"]
    assert not is_bare(with_picture, np.full((480, 640), 0.8, np.float32))


def test_depth_is_in_millimetres_and_the_record_holds_the_pose(scene: Scene) -> None:
    view = views_of(scene, count=1, block_px=1)[0]
    entry = view.record["pose"]
    from sim.core.geometry.pose import Pose

    again = scene.camera.render(scene.world.data, Pose(**entry), ("depth",))["depth"]
    assert np.median(np.abs(view.depth_mm / 1000.0 - again)) < 0.002
    fx = view.record["intrinsics"]["fx_px"]
    assert fx == pytest.approx(CameraModel().focal_px)


def test_the_same_seed_gives_the_same_bytes_and_another_one_others(scene: Scene, tmp_path: Path) -> None:
    sums = []
    for name, seed in (("a", 1), ("b", 1), ("c", 2)):
        note = write_shard(tmp_path / name, "views-000000", views_of(scene, seed), house="room", config={})
        sums.append(note.sha256)
    assert sums[0] == sums[1] != sums[2]
    assert (tmp_path / "a/views-000000.tar").read_bytes() == (tmp_path / "b/views-000000.tar").read_bytes()
    with tarfile.open(tmp_path / "a/views-000000.tar") as archive:
        assert {(entry.mtime, entry.uid, entry.uname) for entry in archive} == {(0, 0, "")}


def test_images_are_stored_without_loss_and_smaller_than_opencvs_own_choice_makes_them(scene: Scene) -> None:
    sizes = np.zeros(2, np.int64)
    for view in sample_views(scene, np.random.default_rng(3), 4, stem="s", record={}):
        for image in (view.depth_mm, view.semantic):
            ours, theirs = cv2.imencode(".png", image, PNG_OPTIONS)[1], cv2.imencode(".png", image)[1]
            assert np.array_equal(np.asarray(cv2.imdecode(ours, cv2.IMREAD_UNCHANGED)), image)
            sizes += len(ours), len(theirs)
    assert sizes[0] < sizes[1]


def test_a_shard_has_a_note_only_while_it_is_complete(scene: Scene, tmp_path: Path) -> None:
    tar, note = tmp_path / "views-000000.tar", tmp_path / "views-000000.json"
    assert read_note(tmp_path, "views-000000", verify=False) is None
    write_shard(tmp_path, "views-000000", views_of(scene, count=2), house="room", config={})
    assert read_note(tmp_path, "views-000000", verify=True) is not None
    whole = tar.read_bytes()
    tar.write_bytes(whole[:-512])
    assert read_note(tmp_path, "views-000000", verify=False) is None
    flipped = bytearray(whole)
    flipped[len(whole) // 2] ^= 1
    tar.write_bytes(bytes(flipped))
    assert read_note(tmp_path, "views-000000", verify=False) is not None  # the size is right
    assert read_note(tmp_path, "views-000000", verify=True) is None
    tar.write_bytes(whole)
    note.write_text(note.read_text()[:40])
    assert read_note(tmp_path, "views-000000", verify=False) is None


def test_a_full_disk_is_one_sentence_and_leaves_no_half_shard(
    scene: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    views = views_of(scene, count=3)

    def full(view: View, rgb_format: str) -> list[tuple[str, bytes]]:
        if view is views[2]:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return [("json", b"{}")]

    monkeypatch.setattr(shards, "_members", full)
    with pytest.raises(ConfigError, match=wording.NO_SPACE_LEFT_ON_DEVICE):
        write_shard(tmp_path, "views-000000", views, house="room", config={})
    assert list(tmp_path.iterdir()) == []


def test_the_index_counts_what_the_shards_hold(scene: Scene, tmp_path: Path) -> None:
    views = views_of(scene)
    notes = [
        write_shard(tmp_path, f"views-{i:06d}", views[3 * i : 3 * i + 3], house=f"h{i}", config={}) for i in range(2)
    ]
    index = write_index(tmp_path, notes, command="make them", config={"seed": 0})
    assert (index["views"], index["houses"], len(index["shards"])) == (6, 2, 2)
    sofa = MPCAT40_ID["sofa"]
    assert index["categories"]["sofa"]["pixels"] == sum(int((view.semantic == sofa).sum()) for view in views)
    assert index["categories"]["sofa"]["views"] == sum(bool((view.semantic == sofa).any()) for view in views)
    assert json.loads((tmp_path / "index.json").read_text()) == index


def test_the_card_names_the_shards_and_one_that_a_user_changed_is_kept(scene: Scene, tmp_path: Path) -> None:
    notes = [write_shard(tmp_path, "views-000000", views_of(scene, count=1), house="h", config={})]
    write_index(tmp_path, notes, command="make them", config={})
    card = tmp_path / "README.md"
    (pattern,) = re.findall(r'^  data_files: "(.*)"$', card.read_text().split("---")[1], re.MULTILINE)
    assert [file.name for file in tmp_path.glob(pattern)] == ["views-000000.tar"]
    card.write_text("Mine.")
    write_index(tmp_path, notes, command="make them", config={})
    assert card.read_text() == "Mine."
