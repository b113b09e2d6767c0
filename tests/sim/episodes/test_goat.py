"""Files of GOAT-Bench and HM3D-OVON: what is written is read again, and has what their loaders look up."""

from __future__ import annotations

import gzip
from dataclasses import replace
from pathlib import Path

import pytest

from sim.core.errors import ConfigError, EpisodeError
from sim.core.geometry.pose import Pose
from sim.core.goals import GoalSpec, PictureCamera
from sim.episodes import habitat
from sim.episodes.episode import Episode
from sim.episodes.goat import goat_house, ovon_house
from sim.episodes.other_files import read_others
from sim.episodes.splits import load_split, read_index
from sim.task.objectnav import Task
from sim.world.world import World
from tests.helpers.worlds import room, with_box, with_facts

CAMERA = PictureCamera(x_m=0.0, y_m=0.0, z_m=1.2, yaw_rad=0.0)
GOALS = (
    GoalSpec("chair", "category"),
    GoalSpec("the white table", "description"),
    GoalSpec("couch", "words"),
    GoalSpec("the desk next to the sofa", "description", None, 1),
    GoalSpec("chair", "category", None, 0),
)
CHAIN = Episode("chain_7", "home", "chair", Pose(0.5, 0.25, 1.0), 1.5, GOALS)


@pytest.fixture(scope="module")
def task() -> Task:
    house, facts = room(10, 6), {"table_00": "name: desk; colour: white", "table_01": "name: dining table"}
    for name, (x, y) in {"chair_00": (4.0, 0.0), "chair_01": (3.0, 2.0), "table_00": (-4.0, 1.0),
                         "sofa_00": (-4.0, 0.4), "table_01": (0.0, -2.4)}.items():  # fmt: skip
        house = with_box(house, name, centre_m=(x, y, 0.25), half_m=(0.2, 0.2, 0.25))
    return Task(World(with_facts(house, **facts)))


def test_chains_are_read_as_they_were_written(task: Task, tmp_path: Path) -> None:
    content = goat_house(task, [CHAIN], "stubborn/mine/home.xml", step_cells=4, most=50)
    file = tmp_path / "home.json.gz"
    file.write_bytes(habitat.zipped_json(content))
    ((read,), _) = read_others(file)
    assert replace(read, start=CHAIN.start) == CHAIN
    assert (read.start.x_m, read.start.y_m, read.start.yaw_rad) == pytest.approx((0.5, 0.25, 1.0))


def test_a_file_is_decompressed_once(task: Task, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file, read = tmp_path / "home.json.gz", []
    content = goat_house(task, [CHAIN], "stubborn/mine/home.xml", step_cells=4, most=50)
    file.write_bytes(habitat.zipped_json(content))

    class Counted(gzip.GzipFile):
        def read(self, size: int | None = -1) -> bytes:
            read.append(size)
            return super().read(size)

    monkeypatch.setattr("sim.core.reading.gzip.GzipFile", Counted)
    assert len(read_others(file)[0]) == len(read) == 1


def test_goats_loader_finds_one_list_of_each_category_and_each_object_in_it(task: Task) -> None:
    content = goat_house(task, [CHAIN], "stubborn/mine/home.xml", step_cells=4, most=50)
    (episode,) = content["episodes"]
    assert [task[1] for task in episode["tasks"]] == ["object", "description", "object", "description", "object"]
    for category, kind, object_id, _ in episode["tasks"]:  # as in goat_bench/dataset/goat_dataset.py
        (objects,) = [of for of in content["goals"].values() if of[0]["object_category"] == category]
        assert all(entry["view_points"] for entry in objects)
        assert objects[0]["children_object_categories"] == []
        if kind == "description":
            (entry,) = [entry for entry in objects if entry["object_id"] == object_id]
            assert entry["lang_desc"]
    assert len(content["goals"]["home.xml_chair"]) == 2


def test_a_picture_is_written_with_its_camera_and_read(task: Task, tmp_path: Path) -> None:
    chain = replace(CHAIN, goals=(GOALS[0], GoalSpec("table_00", "picture", CAMERA), *GOALS[1:3]))
    content = goat_house(task, [chain], "stubborn/mine/home.xml", step_cells=4, most=50)
    assert content["episodes"][0]["tasks"][1:3] == [
        ["table_object", "image", "table_00", 0], ["table_object", "description", "table_00", None],
    ]  # fmt: skip
    (entry,) = content["goals"]["home.xml_table_object"]
    assert entry["image_goals"][0]["image_dimensions"] == (512, 512)
    assert entry["lang_desc"] == "the white table"
    file = tmp_path / "home.json.gz"
    file.write_bytes(habitat.zipped_json(content))
    ((read,), _) = read_others(file)
    assert [goal.kind for goal in read.goals] == ["category", "picture", "description", "words"]
    camera = read.goals[1].camera
    assert camera is not None
    assert camera.yaw_rad == pytest.approx(CAMERA.yaw_rad)
    assert (camera.x_m, camera.z_m, camera.pitch_rad) == pytest.approx((CAMERA.x_m, CAMERA.z_m, CAMERA.pitch_rad))
    content["episodes"][0]["tasks"][1][3] = 1
    file.write_bytes(habitat.zipped_json(content))
    with pytest.raises(EpisodeError, match="no picture 1"):
        read_others(file)


def test_a_goal_in_words_is_a_category_of_ovon(task: Task) -> None:
    episode = Episode("one", "home", "a seat", Pose(0.5, 0.25, 1.0), 1.5)
    content = ovon_house(task, [episode], "stubborn/mine/home.xml", step_cells=4, most=50)
    objects = content["goals_by_category"]["home.xml_a seat"]
    assert {entry["object_id"] for entry in objects} == {"chair_00", "chair_01", "sofa_00"}
    assert {entry["object_category"] for entry in objects} == {"a seat"}
    assert content["episodes"][0]["object_category"] == "a seat"
    assert all(int(entry["object_id"].split("_")[-1]) >= 0 for entry in objects)  # as in ovon_dataset.py


@pytest.mark.parametrize("of_houses", ["mine", "val"])
@pytest.mark.parametrize(("kind", "index"), [("goat", {"goals": {}, "episodes": []}), ("ovon", {"episodes": []})])
def test_a_folder_of_either_format_is_a_split_in_the_houses_of_its_scenes(
    kind: str, index: dict[str, object], of_houses: str, task: Task, tmp_path: Path
) -> None:
    home, folder = tmp_path / of_houses / "home.xml", tmp_path / "val_seen"
    home.parent.mkdir()
    home.write_text(room(4, 4).spec.to_xml())
    (folder / "content").mkdir(parents=True)
    (folder / "val_seen.json.gz").write_bytes(habitat.zipped_json(index))
    asked = CHAIN if kind == "goat" else Episode("one", "home", "a seat", Pose(0.5, 0.25, 1.0), 1.5)
    write = goat_house if kind == "goat" else ovon_house
    content = write(task, [asked], str(home), step_cells=4, most=50)
    (folder / "content" / "home.json.gz").write_bytes(habitat.zipped_json(content))
    split = load_split(folder)
    assert split.house_paths == {"home": home}
    assert [replace(episode, start=asked.start) for episode in split.episodes] == [asked]
    assert read_index(folder).in_words
    assert not read_index(folder).pictures
    del content["episodes"][0]["info"]  # as other programs write them
    (folder / "content" / "home.json.gz").write_bytes(habitat.zipped_json(content))
    assert [episode.episode_id for episode in load_split(folder).episodes] == [f"home_{asked.episode_id}"]
    content["episodes"] += [{**content["episodes"][0], "scene_id": "elsewhere/other.xml"}]
    (folder / "content" / "home.json.gz").write_bytes(habitat.zipped_json(content))
    with pytest.raises(ConfigError, match="in one folder, not in"):
        load_split(folder)


def test_shipped_houses_are_found_and_a_wider_goal_of_ovon_is_refused(task: Task, tmp_path: Path) -> None:
    folder = tmp_path / "val_unseen"
    (folder / "content").mkdir(parents=True)
    (folder / "val_unseen.json.gz").write_bytes(habitat.zipped_json({"episodes": []}))
    episode = Episode("one", "val_02", "a seat", Pose(0.5, 0.25, 1.0), 1.5)
    content = ovon_house(task, [episode], "stubborn/val/val_02.xml", step_cells=4, most=50)
    file = folder / "content" / "val_02.json.gz"
    file.write_bytes(habitat.zipped_json(content))
    split = load_split(folder)
    assert split.house_file("val_02") == load_split("val").house_file("val_02")
    assert split.episodes[0].specs == (GoalSpec("a seat", "words"),)
    content["episodes"][0]["children_object_categories"] = ["armchair"]
    file.write_bytes(habitat.zipped_json(content))
    with pytest.raises(EpisodeError, match="children_object_categories must be empty"):
        read_others(file)
    with pytest.raises(ConfigError, match="children_object_categories must be empty"):
        load_split(folder)
