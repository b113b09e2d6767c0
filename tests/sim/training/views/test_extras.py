"""Objects, normals and poses of views: they agree with colour, depth and labels, and are left out unless asked for."""

from __future__ import annotations

import itertools
import json
import tarfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from torch.utils.data import DataLoader

from examples.read_views import read_with_webdataset
from sim.app.commands.views import show as show_views
from sim.app.commands.views import unpack as unpack_views
from sim.core.errors import HouseError
from sim.core.geometry.pose import Pose
from sim.core.interface import FORWARD_M, MPCAT40_ID, CameraModel, ConfigError
from sim.env.scene import Scene
from sim.episodes.descriptions import Descriptions
from sim.robot.config import RobotConfig
from sim.training.segmentation.dataset import LabelledView, ViewDataset, decode_member, read_shard
from sim.training.views.coco import bounding_box, decode_mask, encode_mask
from sim.training.views.normals import surface_normals
from sim.training.views.shards import write_shard
from sim.training.views.views import EXTRAS, View, camera_to_world, sample_views
from tests.helpers import wording
from tests.helpers.worlds import room, with_box, with_facts

SMALL = CameraModel(width_px=160, height_px=120)


@pytest.fixture(scope="module")
def scene() -> Iterator[Scene]:
    """Returns a room of 6 x 5 m with a sofa and, in front of it, a table."""
    house = with_box(room(6, 5), "sofa_00", centre_m=(1.5, 0.5, 0.4), half_m=(0.4, 0.9, 0.4))
    house = with_box(house, "table_03", centre_m=(0.5, 0.5, 0.2), half_m=(0.3, 0.3, 0.2))
    scene = Scene(house, robot=RobotConfig(), camera=SMALL, profile="fast")
    yield scene
    scene.close()


@pytest.fixture(scope="module")
def views(scene: Scene) -> list[View]:
    return views_of(scene, count=6, extras=EXTRAS)


@pytest.fixture(scope="module")
def shards(views: list[View], tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("views")
    write_shard(folder, "views-000000", views, house="room", config={}, rgb_format="png")
    return folder


def views_of(scene: Scene, count: int, **more: Any) -> list[View]:
    return list(sample_views(scene, np.random.default_rng(0), count, stem="v", record={}, **more))


def test_extras_do_not_change_the_other_arrays_of_a_view(scene: Scene, views: list[View]) -> None:
    for plain, rich in zip(views_of(scene, count=3), views, strict=False):
        assert (plain.instances, plain.annotations, plain.normals) == (None, None, None)
        for name in ("rgb", "depth_mm", "semantic"):
            np.testing.assert_array_equal(getattr(plain, name), getattr(rich, name))
        assert set(rich.record) - set(plain.record) == {"T_world_cam"}


def test_the_renderer_of_descriptions_is_freed_after_an_error(scene: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    close, closed = Descriptions.close, []

    def counted(self: Descriptions) -> None:
        closed.append(self)
        close(self)

    monkeypatch.setattr(Descriptions, "close", counted)
    monkeypatch.setattr("sim.training.views.views.is_bare", lambda *_: True)
    with pytest.raises(HouseError, match="it shows too little"):
        views_of(scene, count=1, extras=("instances",))
    assert len(closed) == 1


def test_objects_are_described_by_texts_that_fit_no_other_one() -> None:
    house, places = room(6, 5), {"chair_00": (1.5, 1.5), "chair_01": (1.5, -1.5), "sofa_00": (-2.0, 0.0)}
    for name, (x_m, y_m) in places.items():
        house = with_box(house, name, centre_m=(x_m, y_m, 0.4), half_m=(0.3, 0.3, 0.4))
    house = with_box(house, "table_00", centre_m=(1.5, 0.6, 0.4), half_m=(0.3, 0.3, 0.4))
    stated = {"chair_00": "name: armchair", "chair_01": "name: armchair", "table_00": "name: desk"}
    scene = Scene(with_facts(house, **stated), robot=RobotConfig(), camera=SMALL, profile="fast")
    rich, plain = (views_of(scene, count=36, extras=extras) for extras in (("instances",), ()))
    truth = scene.task.truth
    texts = {
        (annotation["name"], annotation.get("description"))
        for view in rich
        for annotation in view.annotations or ()
        if annotation["area"] >= 0.01 * 160 * 120 and annotation["name"] in {*places, "table_00"}
    }
    found = {text: [instance.name for instance in truth.instances(text)] for _, text in texts if text}
    assert dict(texts).keys() == {"chair_00", "chair_01", "sofa_00", "table_00"}
    assert len(texts) == 4  # an object has the same text in all views
    assert all(found[text] == [name] for name, text in texts if text)
    assert "the armchair" in str(dict(texts)["chair_00"])
    assert dict(texts)["chair_01"] is None  # nothing tells it apart
    assert dict(texts)["sofa_00"] is None  # the house file does not state its name
    named = {note["name"]: note.get("everyday_name") for view in rich for note in view.annotations or ()}
    assert {name: named[name] for name in (*places, "table_00")} == {
        "chair_00": "armchair", "chair_01": "armchair", "sofa_00": None, "table_00": "desk",
    }  # fmt: skip
    for one, other in zip(rich, plain, strict=True):
        np.testing.assert_array_equal(one.rgb, other.rgb)
    few = views_of(scene, count=12, extras=("instances",))  # which is enough for one object
    described = {note["name"] for view in few for note in view.annotations or () if "description" in note}
    assert len(described) <= 1 < len([text for _, text in texts if text])
    scene.close()


def test_a_shard_without_extras_has_its_four_standard_members(scene: Scene, tmp_path: Path) -> None:
    write_shard(tmp_path, "views-000000", views_of(scene, count=1), house="room", config={})
    with tarfile.open(tmp_path / "views-000000.tar") as archive:
        assert [name.partition(".")[2] for name in archive.getnames()] == [
            "rgb.jpg", "depth.png", "semantic.png", "json",
        ]  # fmt: skip


def test_the_objects_of_a_view_are_those_of_its_labels(scene: Scene, views: list[View]) -> None:
    seen = set()
    for view in views:
        assert view.instances is not None
        masks = np.zeros(view.semantic.shape, np.uint8)
        for each in view.annotations or []:
            mask = decode_mask(each["segmentation"])
            assert each["area"] == mask.sum()
            assert each["bbox"] == bounding_box(mask)
            assert np.array_equal(mask, view.instances == each["id"])
            assert scene.world.labels.instances[each["id"] - 1].name == each["name"]
            masks[mask] = each["category_id"]
            seen.add(each["name"])
        furniture = np.isin(view.semantic, [MPCAT40_ID["sofa"], MPCAT40_ID["table"]])
        assert np.array_equal(masks, np.where(furniture, view.semantic, 0))
    assert seen == {"sofa_00", "table_03"}


def test_masks_survive_their_encoding() -> None:
    rng = np.random.default_rng(0)
    for _ in range(20):
        mask = rng.random((rng.integers(1, 7), rng.integers(1, 9))) < rng.random()
        encoded = encode_mask(mask)
        assert sum(encoded["counts"]) == mask.size
        assert np.array_equal(decode_mask(encoded), mask)
    corner = np.array([[1, 0], [1, 1]], bool)  # columns: 2 inside, then 1 outside, then 1 inside
    assert encode_mask(corner) == {"size": [2, 2], "counts": [0, 2, 1, 1]}
    assert bounding_box(np.pad(corner, ((3, 0), (5, 1)))) == [5, 3, 2, 2]


def test_normals_of_floor_and_walls_are_those_of_their_planes(scene: Scene) -> None:
    pose = Pose(-1.0, 0.0, 0.0)
    images = scene.camera.render(scene.world.data, pose, ("depth", "geom", "semantic"))
    normals = surface_normals(images["depth"], images["geom"], SMALL)
    valid = np.linalg.norm(normals, axis=-1) > 0.0
    assert valid[(images["depth"] > 0.0) & (images["depth"] < SMALL.max_depth_m)].mean() > 0.98
    np.testing.assert_allclose(np.linalg.norm(normals[valid], axis=-1), 1.0, atol=1e-5)
    for category, normal in (("floor", (0, -1, 0)), ("sofa", (0, 0, -1))):  # the sofa's front faces the camera
        own = normals[valid & (images["semantic"] == MPCAT40_ID[category])]
        assert np.quantile(own @ np.array(normal), 0.3) > np.cos(np.radians(1.0)), category
    assert normals[valid][:, 2].max() < 0.5


def test_depth_and_pose_put_the_pixels_of_the_floor_on_the_floor(views: list[View]) -> None:
    for view in views:
        at = view.record["intrinsics"]
        rows, cols = np.nonzero((view.semantic == MPCAT40_ID["floor"]) & (view.depth_mm > 0) & (view.depth_mm < 5000))
        z = view.depth_mm[rows, cols] / 1000.0
        x, y = (cols + 0.5 - at["cx_px"]) / at["fx_px"] * z, (rows + 0.5 - at["cy_px"]) / at["fy_px"] * z
        world = np.array(view.record["T_world_cam"]) @ np.stack([x, y, z, np.ones_like(z)])
        np.testing.assert_allclose(world[2], 0.0, atol=0.01)
        assert np.abs(world[0]).max() < 3.01  # the room's walls
        assert np.abs(world[1]).max() < 2.51


def test_the_pose_of_a_camera_is_a_rotation_that_looks_ahead() -> None:
    turned = camera_to_world(Pose(1.0, 2.0, np.pi / 2, 3.0), SMALL)
    np.testing.assert_allclose(turned[:3, :3] @ turned[:3, :3].T, np.eye(3), atol=1e-12)
    assert np.linalg.det(turned[:3, :3]) == pytest.approx(1.0)
    np.testing.assert_allclose(turned @ (0.0, 0.0, 1.0, 1.0), (1.0, 3.0, 3.0 + SMALL.height_m, 1.0), atol=1e-12)
    np.testing.assert_allclose(turned @ (1.0, 0.0, 0.0, 1.0), (2.0, 2.0, 3.0 + SMALL.height_m, 1.0), atol=1e-12)


def test_a_sequence_is_one_drive_without_gaps(scene: Scene) -> None:
    views = views_of(scene, count=10, sequence=5)
    assert [(view.record["sequence"], view.record["frame"]) for view in views] == [
        (number, frame) for number in range(2) for frame in range(5)
    ]
    for before, after in itertools.pairwise(view.record for view in views[:5]):
        moved = np.hypot(*(after["pose"][axis] - before["pose"][axis] for axis in ("x_m", "y_m")))
        turned = abs(np.degrees(after["pose"]["yaw_rad"] - before["pose"]["yaw_rad"])) % 360
        assert min(turned, 360 - turned) == pytest.approx(30.0 if moved < 0.1 else 0.0, abs=0.1)
        assert moved == pytest.approx(0.0, abs=1e-3) or moved == pytest.approx(FORWARD_M, abs=1e-3)
    with pytest.raises(HouseError, match=wording.NO_PATH_OF_500_VIEWS):
        views_of(scene, count=500, sequence=500)


def test_our_reader_and_webdataset_return_the_stored_arrays(views: list[View], shards: Path) -> None:
    ours = list(read_shard(shards / "views-000000.tar"))
    theirs = list(read_with_webdataset(str(shards / "views-000000.tar")))
    for view, mine, other in zip(views, ours, theirs, strict=True):
        assert view.instances is not None
        assert view.normals is not None
        assert other["depth.png"].dtype == other["instances.png"].dtype == np.uint16
        for name, stored in (("rgb", view.rgb), ("depth", view.depth_mm), ("semantic", view.semantic),
                             ("instances", view.instances), ("normals", view.normals)):  # fmt: skip
            np.testing.assert_array_equal(other[f"{name}.png"], stored)
        assert mine.instances is not None
        np.testing.assert_array_equal(np.rint(1000 * mine.depth_m), view.depth_mm)
        for name in ("rgb", "semantic", "instances"):
            np.testing.assert_array_equal(getattr(mine, name), getattr(view, name))
        assert mine.normals is not None
        assert np.abs(127.5 * (mine.normals + 1.0) - view.normals)[view.normals.any(axis=-1)].max() < 1e-3
        assert mine.annotations == view.annotations == other["coco.json"]
        assert mine.record == view.record == other["json"]


def test_a_view_dataset_without_transform_gives_the_views(shards: Path) -> None:
    data = ViewDataset([shards / "views-000000.tar"], shuffle=False)
    assert [view.key for view in data] == [f"v_{i:05d}" for i in range(6)]
    (batch, *_) = DataLoader(data, batch_size=4, collate_fn=list)
    assert [type(view) for view in batch] == [LabelledView] * 4


def test_a_broken_member_is_named() -> None:
    with pytest.raises(ConfigError, match=r"'a.depth.png'.*PNG.*JPEG"):
        decode_member("a.depth.png", b"text")
    assert decode_member("a.txt", b"text") is None


def test_views_become_one_coco_file(views: list[View], shards: Path, tmp_path: Path) -> None:
    unpack_views.main(unpack_views.Args(views=shards, out=tmp_path))
    coco = json.loads((tmp_path / "coco.json").read_text())
    assert [image["file_name"] for image in coco["images"]] == [f"rgb/{view.key}.png" for view in views]
    assert len(coco["annotations"]) == sum(len(view.annotations or []) for view in views)
    assert len({each["id"] for each in coco["annotations"]}) == len(coco["annotations"])
    names = {each["id"]: each["name"] for each in coco["categories"]}
    assert {names[each["category_id"]] for each in coco["annotations"]} == {"sofa", "table"}
    stored = cv2.imread(str(tmp_path / "normals" / f"{views[0].key}.png"))
    assert stored is not None
    np.testing.assert_array_equal(stored[..., ::-1], views[0].normals)


def test_a_sheet_shows_no_return_and_the_farthest_depth_in_different_colours(shards: Path) -> None:
    view = next(read_shard(shards / "views-000000.tar"))
    depth = np.full_like(view.depth_m, 5.0)
    depth[:, : depth.shape[1] // 2] = 0.0
    panel = show_views.draw(replace(view, depth_m=depth))[:, show_views.WIDTH_PX : 2 * show_views.WIDTH_PX]
    assert tuple(panel[150, 100]) == show_views.NO_RETURN_RGB
    assert tuple(panel[150, 300]) == (25, 25, 25)


def test_a_sheet_shows_objects_and_normals_where_there_are_some(views: list[View], shards: Path) -> None:
    with_all = show_views.draw(next(read_shard(shards / "views-000000.tar")))
    assert with_all.shape == (300, 5 * show_views.WIDTH_PX, 3)
