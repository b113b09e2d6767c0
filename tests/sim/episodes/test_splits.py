"""Splits written and read again, and conversions between Habitat's frame and ours."""

from __future__ import annotations

import gzip
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.core.errors import EpisodeError, HouseError
from sim.core.geometry.pose import Pose
from sim.core.goals import GoalSpec, PictureCamera
from sim.core.interface import ConfigError, wrap_angle
from sim.core.paths import assets_dir
from sim.episodes import habitat
from sim.episodes.episode import Episode
from sim.episodes.splits import house_files, house_sum, load_split, one_house, read_index, shipped_splits, write_split
from tests.helpers import wording
from tests.helpers.worlds import room, with_box

metres = st.floats(-50.0, 50.0)
yaws = st.floats(-math.pi, math.pi, exclude_min=True)

EPISODES = (
    Episode("tiny_0000", "b", "bed", Pose(-1.25, 0.5, 2.0), 2.5),
    Episode("tiny_0001", "a", "bed", Pose(0.125, -0.5, -3.0, 0.0), 3.0),
    Episode("tiny_0002", "b", "bed", Pose(-1.0, 0.0, 0.0), 2.0),
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    folder = tmp_path / "tiny"
    folder.mkdir()
    house = with_box(room(8, 4), "bed_00", centre_m=(2.5, 0, 0.25), half_m=(0.5, 1.0, 0.25))
    for name in ("a", "b"):
        (folder / f"{name}.xml").write_text(house.spec.to_xml())
    write_split(folder, EPISODES, {"a": {"bed": []}, "b": {"bed": []}}, version="1.2.0")
    return folder


@given(x=metres, y=metres, z=metres, yaw=yaws)
def test_a_pose_to_habitat_and_back_is_identity(x, y, z, yaw):
    state = habitat.to_agent_state(Pose(x, y, yaw, z))
    back = habitat.from_agent_state(state["position"], state["rotation"])
    assert (back.x_m, back.y_m, back.floor_z_m) == (x, y, z)
    assert wrap_angle(back.yaw_rad - yaw) == pytest.approx(0.0, abs=1e-12)


@given(yaw=yaws, pitch=st.floats(-1.5, 1.5))
def test_a_tilted_camera_to_habitat_and_back_is_identity(yaw: float, pitch: float) -> None:
    back = habitat.from_tilted_rotation(habitat.to_tilted_rotation(yaw, pitch))
    assert wrap_angle(back[0] - yaw) == pytest.approx(0.0, abs=1e-9)
    assert back[1] == pytest.approx(pitch, abs=1e-9)


@given(yaw=yaws, pitch=st.floats(-1.5, 1.5))
def test_a_tilted_camera_looks_in_the_same_direction_in_both_frames(yaw: float, pitch: float) -> None:
    *axis, w = habitat.to_tilted_rotation(yaw, pitch)
    forward = np.array([0.0, 0.0, -1.0])
    turned = forward + 2.0 * np.cross(axis, np.cross(axis, forward) + w * forward)
    expected = (math.cos(yaw) * math.cos(pitch), math.sin(yaw) * math.cos(pitch), -math.sin(pitch))
    assert habitat.from_position(turned.tolist()) == pytest.approx(expected, abs=1e-9)


def test_goals_that_are_more_than_a_text_are_read_as_they_were_written(folder: Path) -> None:
    camera = PictureCamera(x_m=0.5, y_m=-1.0, z_m=1.5, yaw_rad=0.25, pitch_rad=0.5, width_px=64, height_px=48)
    goals = (
        GoalSpec("bed", "category"),
        GoalSpec("the red chair in the bedroom", "description"),
        GoalSpec("bed_00", "picture", camera),
        GoalSpec("bed", "category", repeats=0),
    )
    chain = replace(EPISODES[0], goals=goals)
    write_split(folder, (chain, *EPISODES[1:]), {"a": {}, "b": {}}, version="1.2.0")
    read = load_split(folder).episode("tiny_0000")
    back = read.goals[2].camera
    assert read.is_chain
    assert [replace(goal, camera=None) if goal.camera is None else goal.text for goal in read.goals] == [
        goals[0],
        goals[1],
        "bed_00",
        goals[3],
    ]
    assert back is not None
    assert vars(back) == pytest.approx(vars(camera), abs=1e-9)
    index = read_index(folder)
    assert index.in_words
    assert index.pictures


def test_an_episode_file_of_version_4_keeps_its_bytes_but_for_rounded_headings(tmp_path: Path) -> None:
    shipped, home = load_split("words-seen"), assets_dir() / "words-seen"
    folder = tmp_path / "words-seen"
    goals = {house: {} for house in shipped.houses}
    write_split(folder, shipped.episodes, goals, version=shipped.version, houses_of="val")
    written = sorted(folder.rglob("*.gz"))
    assert len(written) == 31
    for file in written:
        assert _without_headings(file) == _without_headings(home / file.relative_to(folder))


def _without_headings(file: Path) -> str:
    """Returns the JSON of a file of episodes, in its order; a heading is not read and written to its last digit."""
    content = json.loads(gzip.decompress(file.read_bytes()))
    for episode in content["episodes"]:
        episode["start_rotation"] = [round(value, 9) for value in episode["start_rotation"]]
    return json.dumps(content)


@given(yaw=yaws)
def test_a_heading_has_the_same_direction_in_both_frames(yaw):
    x, y, z, w = habitat.to_rotation(yaw)
    forward = np.array([0.0, 0.0, -1.0])  # Habitat's agents look along -z; v' = v + 2 q x (q x v + w v)
    axis = np.array([x, y, z])
    turned = forward + 2.0 * np.cross(axis, np.cross(axis, forward) + w * forward)
    assert habitat.from_position(turned.tolist()) == pytest.approx((math.cos(yaw), math.sin(yaw), 0.0), abs=1e-9)


def test_up_is_y_there_and_z_here_and_the_frames_have_one_handedness():
    assert habitat.to_position(1.0, 2.0, 3.0) == [1.0, 3.0, -2.0]
    axes = np.array([habitat.to_position(*axis) for axis in np.eye(3).tolist()])
    assert np.linalg.det(axes) == pytest.approx(1.0)


def test_a_split_written_and_read_is_the_same_in_the_same_order(folder):
    split = load_split(folder)
    assert [episode.episode_id for episode in split.episodes] == ["tiny_0000", "tiny_0001", "tiny_0002"]
    for written, read in zip(EPISODES, split.episodes, strict=True):
        assert (read.house, read.goal, read.shortest_path_m) == (written.house, written.goal, written.shortest_path_m)
        assert read.start.distance_to(written.start) == 0.0
        assert read.start.yaw_rad == pytest.approx(written.start.yaw_rad, abs=1e-12)
    assert split.name == "tiny"
    assert split.version == "1.2.0"
    assert split.houses == ("a", "b")
    assert split.load_house("a").name == "a"
    assert split.episode("tiny_0001").house == "a"


def test_a_folder_here_with_the_name_of_a_shipped_split_is_not_read_in_two_ways(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "traps").mkdir()
    (tmp_path / "traps" / "alone.xml").write_text(room(3, 3).spec.to_xml())
    assert load_split("traps").version != "mine"  # a folder that is no split
    write_split(Path("traps"), [Episode("t0", "alone", "sofa", Pose(0.0, 0.0, 0.0))], {"alone": {}}, version="mine")
    with pytest.raises(ConfigError, match=r"\./traps"):
        load_split("traps")
    assert load_split("./traps").version == "mine"


def test_the_files_have_the_fields_that_habitats_loader_reads(folder):
    content = json.loads(gzip.decompress((folder / "content" / "b.json.gz").read_bytes()))
    assert set(content) == {
        "category_to_task_category_id",
        "category_to_mp3d_category_id",
        "goals_by_category",
        "episodes",
    }
    entry = content["episodes"][0]
    assert f"{Path(entry['scene_id']).name}_{entry['object_category']}" in content["goals_by_category"]
    assert len(entry["start_position"]) == 3
    assert np.linalg.norm(entry["start_rotation"]) == pytest.approx(1.0)


def test_the_hash_changes_with_a_house_and_with_an_episode_only(folder):
    before = load_split(folder).sha256
    write_split(folder, EPISODES, {"a": {"bed": []}, "b": {"bed": []}}, version="1.2.0")
    assert load_split(folder).sha256 == before
    write_split(folder, EPISODES[:2], {"a": {"bed": []}, "b": {"bed": []}}, version="1.2.0")
    fewer = load_split(folder).sha256
    (folder / "a.xml").write_text((folder / "a.xml").read_text() + "\n")
    assert len({before, fewer, load_split(folder).sha256}) == 3


def test_files_that_a_house_uses_belong_to_its_checksum_and_a_change_is_noticed(folder):
    (folder / "part.xml").write_text('<mujoco><asset><mesh name="m" file="m.obj"/></asset></mujoco>')
    (folder / "meshes").mkdir()
    (folder / "meshes" / "m.obj").write_text("v 0 0 0\n")
    text = (folder / "a.xml").read_text()
    (folder / "a.xml").write_text(
        text.replace("<worldbody>", '<compiler meshdir="meshes"/><include file="part.xml"/><worldbody>', 1)
    )
    for file in (folder / "meshes" / "m.obj", folder / "part.xml"):
        split, one = load_split(folder), one_house(folder / "a.xml")
        split.require_unchanged("a")
        file.write_text(file.read_text() + "\n")
        assert load_split(folder).sha256 != split.sha256
        assert one_house(folder / "a.xml").sha256 != one.sha256
        split.require_unchanged("b")
        with pytest.raises(HouseError, match="'a'"):
            split.require_unchanged("a")


def test_a_split_is_written_as_the_same_bytes_each_time(folder):
    files = sorted(folder.rglob("*.gz"))
    before = [file.read_bytes() for file in files]
    write_split(folder, EPISODES, {"a": {"bed": []}, "b": {"bed": []}}, version="1.2.0")
    assert [file.read_bytes() for file in files] == before


def test_an_unknown_split_is_refused_with_the_names_that_exist():
    with pytest.raises(ConfigError, match="Unknown split 'nowhere'") as refused:
        load_split("nowhere")
    assert all(name in str(refused.value) for name in shipped_splits())


def test_a_folder_without_episodes_is_refused(tmp_path):
    with pytest.raises(ConfigError, match=r"has no .*json\.gz"):
        load_split(tmp_path)


@pytest.mark.parametrize(
    ("file", "content"),
    [
        ("tiny.json.gz", b"not gzip"),
        ("tiny.json.gz", gzip.compress(b"[1, 2]", mtime=0)),
        ("tiny.json.gz", gzip.compress(b'{"order": ["no_such"]}', mtime=0)),
        ("content/a.json.gz", gzip.compress(b'{"episodes": [{"episode_id": "x"}]}', mtime=0)),
        ("content/a.json.gz", gzip.compress(b"{", mtime=0)),
    ],
)
def test_a_broken_episode_file_is_named(folder, file, content):
    (folder / file).write_bytes(content)
    with pytest.raises(ConfigError, match=Path(file).name):
        load_split(folder)


def test_episodes_without_their_house_are_refused(folder):
    (folder / "b.xml").unlink()
    with pytest.raises(ConfigError, match=r"no b\.xml"):
        load_split(folder)


def test_an_unknown_episode_or_house_is_refused_with_the_closest_name(folder):
    split = load_split(folder)
    with pytest.raises(EpisodeError, match=r"no episode 'tiny_00003'.*Did you mean 'tiny_000"):
        split.episode("tiny_00003")
    with pytest.raises(HouseError, match=wording.IT_HAS_A_B):
        split.load_house("c")
    with pytest.raises(HouseError, match="has no house 'attic'"):
        load_split(folder).sidecar("attic")


def test_one_house_is_a_split_without_episodes(folder):
    split = one_house(folder / "a.xml")
    assert split.houses == ("a",)
    assert split.episodes == ()
    assert split.load_house("a").name == "a"
    with pytest.raises(HouseError, match=wording.NO_SUCH_FILE):
        one_house(folder / "z.xml")


def test_two_houses_that_differ_in_their_endings_only_are_refused(tmp_path: Path) -> None:
    for name in ("flat.xml", "flat.MJCF", "other.XML", "flat.json"):
        (tmp_path / name).touch()
    with pytest.raises(ConfigError, match=wording.HAVE_ONE_NAME):
        house_files(tmp_path)
    (tmp_path / "flat.MJCF").unlink()
    assert list(house_files(tmp_path)) == ["flat", "other"]


def test_a_file_that_a_house_may_not_read_does_not_count_in_its_checksum(tmp_path: Path) -> None:
    secret = tmp_path / "elsewhere" / "secret.txt"
    house = tmp_path / "split" / "house.xml"
    for folder in (secret.parent, house.parent):
        folder.mkdir()
    house.write_text('<mujoco><include file="../elsewhere/secret.txt"/></mujoco>')
    secret.write_text("one")
    closed, opened = house_sum(house), house_sum(house, root=secret.parent)
    secret.write_text("two")
    assert house_sum(house) == closed
    assert house_sum(house, root=secret.parent) != opened
