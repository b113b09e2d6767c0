"""A home of two rooms by the rules of each of Habitat's formats is imported with its labels, rooms, places and door."""

from __future__ import annotations

import functools
import gzip
import json
import re
import shutil
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from sim.app.commands.importing import habitat as command
from sim.core.errors import ConfigError, HouseError
from sim.episodes.splits import load_split
from sim.homes.importers.habitat import find_sources, import_source
from sim.homes.importers.habitat_episodes import read_scenes, scene_name
from sim.homes.importers.habitat_files import ObjectInstance, SceneInstance, Semantics, read_dataset
from sim.homes.importers.habitat_names import category_of
from sim.homes.importers.habitat_scans import read_hm3d, read_hm3d_text, read_house_text
from sim.homes.importers.habitat_scenes import _Reader
from sim.homes.importers.losses import Losses
from sim.homes.importers.mesh_house import MeshConfig
from sim.houses.geoms import data_at_rest
from sim.houses.house import House, read_rooms
from sim.houses.labels import read_labels
from sim.houses.load import load_house
from sim.houses.proposals import geom_box
from sim.world.check import check_own_house
from tests.helpers import wording
from tests.helpers.messages import require_result_or_one_line
from tests.helpers.scanned import trimesh, write_dataset, write_episodes, write_hm3d, write_mp3d

SAMPLES = Path(__file__).parents[5] / "shared" / "worlds" / "habitat"
INSTANCES = {"bed": 1, "chair": 1, "picture": 1, "plant": 1, "table": 1}


def imported(path: Path, out: Path, **options: Any) -> House:
    """Returns the only house of a path, imported by the command."""
    assert command.main(command.Args(path=path, out=out, pictures=0, **options)) == 0
    (file,) = out.glob("*.xml")
    return load_house(file)


def ends_of(house: House, instance: str) -> NDArray[np.float64]:
    """Returns lowest and highest corner (6,) of the collision boxes of an instance, in the world."""
    model = house.spec.copy().compile()
    data = data_at_rest(model)
    geoms = next(each.geom_ids for each in read_labels(model, ignore_prefix="").instances if each.name == instance)
    boxes = [geom_box(model, data, geom) for geom in geoms if model.geom_group[geom] == 3]
    return np.concatenate([np.min([low for low, _ in boxes], axis=0), np.max([high for _, high in boxes], axis=0)])


WRITERS: dict[str, Callable[[Path], Path]] = {
    "hm3d": lambda folder: write_hm3d(folder, pictures=False),
    "mp3d": lambda folder: write_mp3d(folder, edge_m=1.0),
    "data set": write_dataset,
}


@pytest.fixture(scope="module")
def homes(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[Path, Path, House]]:
    """Source, folder and house of each format."""
    made = {}
    for name, write in WRITERS.items():
        folder = tmp_path_factory.mktemp(name.replace(" ", "_"))
        source = write(folder / "source")
        made[name] = (source, folder / "out", imported(source, folder / "out", texture_px=64))
    return made


@pytest.mark.costly
@pytest.mark.parametrize(
    ("name", "kinds", "chairs"),
    [("hm3d", ["room", "room"], 1), ("mp3d", ["living_room", "bedroom"], 1),
     ("data set", ["living_room", "bedroom"], 2)],
)  # fmt: skip
def test_a_home_has_its_instances_and_rooms_and_an_open_door(
    homes: dict[str, tuple[Path, Path, House]], name: str, kinds: list[str], chairs: int
) -> None:
    house = homes[name][2]
    model = house.spec.copy().compile()
    labels = read_labels(model, ignore_prefix="")
    goals = Counter(each.category for each in labels.instances if each.category in INSTANCES)
    assert goals == INSTANCES | {"chair": chairs}
    assert ends_of(house, "bed_00") == pytest.approx([6, 2.4, 0, 7.9, 3.9, 0.5], abs=0.03)
    assert ends_of(house, "chair_00") == pytest.approx([0.7, 1.4, 0, 1.2, 1.9, 0.9], abs=0.03)
    rooms = read_rooms(model)
    assert [room.kind for room in rooms] == kinds
    assert sum(room.area_m2 for room in rooms) == pytest.approx(32.0, rel=0.04)
    if name != "mp3d":  # its surface is uneven, and its check costs the same again
        assert check_own_house(house)[0] == []


def test_an_episode_that_index_and_content_have_counts_once(tmp_path: Path) -> None:
    entry = {
        "episode_id": 0, "scene_id": "hm3d/val/00800-x/x.basis.glb", "start_position": [0, 0, 0],
        "start_rotation": [0, 0, 0, 1], "object_category": "chair",
    }  # fmt: skip
    (tmp_path / "content").mkdir()
    for name in ("val.json.gz", "content/x.json.gz"):
        (tmp_path / name).write_bytes(gzip.compress(json.dumps({"episodes": [entry]}).encode()))
    assert [len(each.entries) for each in read_scenes(tmp_path).values()] == [1]


def test_a_dynamic_chair_is_turned_and_can_be_pushed(homes: dict[str, tuple[Path, Path, House]]) -> None:
    model = homes["data set"][2].spec.copy().compile()
    assert model.njnt == 1
    body = int(model.jnt_bodyid[0])
    assert model.body_mass[body] == pytest.approx(4.0)
    data = data_at_rest(model)
    geoms = np.flatnonzero((model.geom_bodyid == body) & (model.geom_group == 3))
    back = geoms[data.geom_xpos[geoms, 2].argmax()]
    # The back of the chair is at +y of its seat; turned by 90 degrees counter-clockwise it is at -x.
    assert data.geom_xpos[back, :2] - data.xpos[body, :2] == pytest.approx([-0.225, 0.0], abs=0.01)


def test_a_second_import_makes_nothing_and_takes_habitats_own_episodes(
    homes: dict[str, tuple[Path, Path, House]], tmp_path: Path, capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    source, out, _ = homes["hm3d"]
    monkeypatch.setattr("sim.app.commands.importing.habitat.import_source", None)
    file = write_episodes(tmp_path, "00800-two/two.basis.glb")
    imported(source, out, episodes=file.parents[1], texture_px=64)
    episodes = {each.goal: each for each in load_split(out).episodes}
    assert set(episodes) == {"plant", "chair"}
    start = episodes["plant"].start
    assert (start.x_m, start.y_m, start.floor_z_m) == (1.0, 3.0, 0.0)
    assert start.yaw_rad == pytest.approx(np.pi / 2)
    assert episodes["plant"].shortest_path_m == pytest.approx(6.2, abs=0.7)
    lines = capsys.readouterr().out
    assert "Episode left out: no free place is near its start. (1 x)" in lines
    assert "Episode left out: the house has no toilet. (1 x)" in lines
    assert "Goal without an instance at its place: chair. (1 x)" in lines
    assert "Goals of the files that fit. (2 x)" in lines
    assert "Episodes of 1 scenes that are not here were left out." in lines


def test_pictures_name_the_instances(tmp_path: Path) -> None:
    source = write_hm3d(tmp_path)
    made = read_hm3d(source / "two.semantic.txt", Losses(), 64)
    assert Counter(each.category for each in made.objects) == INSTANCES | {"floor": 2, "wall": 2, "ceiling": 1}


def test_scenes_are_named_by_their_file() -> None:
    assert scene_name("hm3d/val/00800-x/x.basis.glb") == "x"
    assert scene_name("mp3d/2azQ/2azQ.glb") == "2azQ"
    assert scene_name("data/hssd/scenes/102.scene_instance.json") == "102"


@pytest.mark.parametrize(
    ("name", "category"),
    [("potted plant", "plant"), ("chest_of_drawers_03", "chest_of_drawers"), ("ceiling lamp", "lighting"),
     ("picture/window", "picture"), ("Floor", "floor"), ("shower wall", "shower"), ("zzz", None)],
)  # fmt: skip
def test_names_of_the_data_sets_have_categories(name: str, category: str | None) -> None:
    assert category_of(name) == category


def test_classes_and_regions_are_found_as_hssd_names_them(tmp_path: Path) -> None:
    for folder in ("semantics/scenes", "scenes"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "semantics" / "words.json").write_text('{"classes": [{"id": 3, "name": "couch"}]}')
    region = {"label": "den", "poly_loop": [[0, 0, 0], [1, 0, 0], [0, 0, 1]], "floor_height": 0}
    own = tmp_path / "semantics" / "scenes" / "a.semantic_config.json"
    own.write_text(json.dumps({"region_annotations": [region]}))
    file, name = tmp_path / "x.scene_dataset_config.json", "%%CONFIG_NAME_AS_ASSET_FILENAME%%.semantic_config.json"
    for named, section in (
        (name, {"default_attributes": {"semantic_descriptor_filename": "../words.json"},
                "paths": {".json": ["semantics/scenes/*"]}}),
        ("map", {"map": "semantics/words.json"}), ("map", {"map": "../../words.json"}),
    ):  # fmt: skip
        scenes = {"default_attributes": {"semantic_scene_instance": named}}
        file.write_text(json.dumps({"scene_instances": scenes, "semantic_scene_descriptor_instances": section}))
        found = read_dataset(file).semantics(SceneInstance(ObjectInstance("home")), "a")
        assert [each.name for each in found.classes] == ([] if ".." in section.get("map", "") else ["couch"])
        assert [each.label for each in found.region_annotations] == (["den"] if named == name else [])


# ---- broken files ----------------------------------------------------------------------------------------------------


def failure(path: Path) -> str:
    with pytest.raises((HouseError, ConfigError)) as caught:
        import_source(find_sources(path)[0], MeshConfig())
    message = str(caught.value)
    assert "\n" not in message
    assert str(path.parent) in message
    return message


def test_broken_scans_are_one_line_with_file_and_place(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=wording.HAS_NO_HOUSE_OF_HABITAT_S_DATA_SETS):
        find_sources(tmp_path)
    scan = write_hm3d(tmp_path / "a")
    text = (scan / "two.semantic.txt").read_text()
    for broken, reason in (
        ("nothing\n", "line 1: "), (text + "7,XX,wall,0\n", "line 13: expected"),
        (text + f'{2**63},0C0C0C,"wall",0\n', "line 13: expected"),
        (text + f'12,0C0C0C,"wall",{2**63}\n', "line 13: expected"),
        (text + f'{"9" * 5000},0C0C0C,"wall",0\n', "line 13: expected"),
        (text + '12,0A0A0A,"wall",0\n', "line 13: the colour 0A0A0A is not allowed or occurs twice"),
    ):  # fmt: skip
        (scan / "two.semantic.txt").write_text(broken)
        assert reason in failure(scan)
    (scan / "two.semantic.txt").write_text(text)
    (scan / "two.semantic.glb").write_bytes(b"glTF" + b"\0" * 40)
    assert "damaged GLB file" in failure(scan)
    (scan / "two.glb").unlink()
    assert "'two.glb'" in failure(scan)
    scan = write_mp3d(tmp_path / "b")
    text = (scan / "two.house").read_text()
    for number in ("x", str(2**63), "9" * 5000):
        (scan / "two.house").write_text(text.replace("O 3 ", f"O {number} "))
        assert "is not a line of this format" in failure(scan)
    (scan / "two.house").write_text(text)
    ply = (scan / "two_semantic.ply").read_bytes()
    (scan / "two_semantic.ply").write_bytes(ply.replace(b"object_id", b"object_ix"))
    assert "'object_id'" in failure(scan)
    (scan / "two_semantic.ply").write_bytes(ply.replace(b"element vertex ", b"element vertex 99999999"))
    assert "announces" in failure(scan)


def test_broken_data_sets_are_one_line_and_broken_objects_are_left_out(tmp_path: Path) -> None:
    file = write_dataset(tmp_path / "a")
    (tmp_path / "secret.glb").write_bytes(b"")
    objects, stage = file.parent / "objects", file.parent / "stages" / "home.stage_config.json"
    stage.write_text('{"render_asset": "home.glb", "is_collidable": false}')
    (objects / "thing_5.glb").unlink()
    config = json.loads((objects / "thing_6.object_config.json").read_text())
    (objects / "thing_6.object_config.json").write_text(json.dumps(config | {"render_asset": "../../secret.glb"}))
    (objects / "thing_7.object_config.json").write_text(json.dumps(config | {"up": [0, 0, 0]}))
    left_out = import_source(find_sources(file)[0], MeshConfig()).report["left_out"]
    assert len(left_out) == 3
    assert "thing_5.glb" in next(each for each in left_out if "thing_5" in each)
    assert "is outside of the data set" in next(each for each in left_out if "thing_6:" in each)
    assert "not at a right angle" in next(each for each in left_out if "thing_7:" in each)
    (file.parent / "stages" / "home.glb").unlink()
    assert "home.glb" in failure(file)
    stage.unlink()
    assert "no configuration 'stages/home'" in failure(file)
    file.write_text("[]")
    assert "expected" in failure(file)


def test_a_scene_of_too_many_instances_is_refused_before_they_are_placed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sim.homes.importers.mesh_house.MAX_OBJECTS", 2)
    monkeypatch.setattr("sim.homes.importers.habitat_scenes.read_surfaces", lambda *_, **__: pytest.fail("it was read"))
    assert re.search(r"it has \d+ objects; at most 2 are allowed", failure(write_dataset(tmp_path)))


def test_a_mesh_may_have_millimetres_and_its_instance_a_small_scale(tmp_path: Path) -> None:
    file = write_dataset(tmp_path)
    mesh = trimesh.load(tmp_path / "objects" / "thing_5.glb")
    mesh.apply_scale(1000.0).export(tmp_path / "objects" / "thing_5.glb")
    config = tmp_path / "objects" / "thing_5.object_config.json"
    config.write_text(json.dumps(json.loads(config.read_text()) | {"units_to_meters": 0.001}))
    instance = ObjectInstance("thing_5", non_uniform_scale=(0.5, 1.0, 1.0), translation_origin="asset_local")
    reader = _Reader(read_dataset(file), Semantics(), SceneInstance(instance), Losses(), 64, "Scene")
    size_m = np.ptp(reader.placed(instance, "objects").corners_m.reshape(-1, 3), axis=0)
    assert size_m == pytest.approx([0.5 * 1.9, 1.5, 0.5], abs=1e-4)  # the bed


@pytest.mark.costly
def test_the_folder_of_a_data_set_may_be_named_by_a_dot(tmp_path: Path) -> None:
    file = write_dataset(tmp_path)
    content = json.loads(file.read_text())
    for section in ("stages", "objects", "scene_instances"):
        for suffix, patterns in content.get(section, {}).get("paths", {}).items():
            content[section]["paths"][suffix] = [".", "./.", *(f"./{pattern}" for pattern in patterns)]
    file.write_text(json.dumps(content))
    assert import_source(find_sources(file)[0], MeshConfig()).report["rooms"] > 0


_JSON = st.recursive(
    st.none() | st.booleans() | st.floats(width=32) | st.text(max_size=4),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from(["stage_instance", "object_instances", "template_name", "translation", "rotation"]), inner
        )
    ),
    max_leaves=6,
)


@pytest.mark.costly
@settings(max_examples=8)
@given(_JSON)
def test_any_scene_is_one_line(tmp_path_factory: pytest.TempPathFactory, scene: Any) -> None:
    file = write_any(tmp_path_factory.getbasetemp() / "any_scene")
    (file.parent / "scenes" / "flat.scene_instance.json").write_text(json.dumps(scene))
    failure(file)


def write_any(folder: Path) -> Path:
    """Writes a data set without meshes once."""
    if not folder.is_dir():
        (folder / "scenes").mkdir(parents=True)
        (folder / "x.scene_dataset_config.json").write_text('{"scene_instances": {"paths": {".json": ["scenes"]}}}')
    return folder / "x.scene_dataset_config.json"


@settings(max_examples=40)
@given(st.text(st.sampled_from('0123456789ABFx,"\nORC #l'), max_size=80))
def test_any_annotations_are_read_or_one_line(tmp_path_factory: pytest.TempPathFactory, text: str) -> None:
    file = tmp_path_factory.getbasetemp() / "any.txt"
    for head, read in (("HM3D Semantic Annotations\n", lambda path: read_hm3d_text(path, Losses())),
                       ("ASCII 1.1\n", read_house_text)):  # fmt: skip
        file.write_text(head + text)
        require_result_or_one_line(functools.partial(read, file), "line")


@pytest.mark.skipif(not SAMPLES.is_dir(), reason="the samples are not here")
def test_habitats_test_data_set_is_imported(tmp_path: Path) -> None:
    source = SAMPLES / "test_assets" / "dataset_tests" / "dataset_0"
    shutil.copytree(source, tmp_path / "source")
    house = imported(tmp_path / "source", tmp_path / "out")
    assert [room.kind for room in read_rooms(house.spec.copy().compile())] == ["bedroom", "bathroom"]
    report = json.loads((tmp_path / "out" / "import.json").read_text())["dataset_test_scene"]
    assert report["furniture"] == {"dataset_test_object1": 1, "dataset_test_object2": 1}


@pytest.mark.costly
def test_a_part_of_a_handle_names_a_template_if_it_is_part_of_one_only(
    homes: dict[str, tuple[Path, Path, House]], tmp_path: Path
) -> None:
    file = write_dataset(tmp_path)
    scene = next(file.parent.rglob("*.scene_instance.json"))
    whole = scene.read_text()
    names = {entry["template_name"] for entry in json.loads(whole)["object_instances"]}
    name = sorted(names, key=len)[-1]
    (before,) = json.loads((homes["data set"][1] / "import.json").read_text()).values()
    scene.write_text(whole.replace(json.dumps(name), json.dumps(name[:-1] if name[:-1] not in names else name[1:])))
    after = import_source(find_sources(file)[0], MeshConfig()).report
    several = [other for other in names if name[:-1] in other.rpartition("/")[2]]
    assert (after["left_out"] == before["left_out"]) == (len(several) == 1)
    scene.write_text(whole.replace(json.dumps(name), json.dumps("thing")))
    left_out = import_source(find_sources(file)[0], MeshConfig()).report["left_out"]
    assert any("is part of several" in reason for reason in left_out)
