"""The tools take a scene from elsewhere: they propose and check labels, and make pictures, episodes and views of it."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from sim.app import cli
from sim.app.commands import episodes as make_episodes
from sim.app.commands import gallery, run
from sim.app.commands import label as label_house
from sim.app.commands.views import generate as generate_views
from sim.app.viewers import house_pictures
from sim.app.viewers.house_pictures import storeys
from sim.core.errors import ConfigError
from sim.core.interface import GOAL_CATEGORIES, MPCAT40_ID, CameraModel
from sim.episodes.splits import load_split
from sim.gl import mujoco
from sim.houses.house import House
from sim.houses.labels import read_labels
from sim.houses.load import load_house
from sim.training.segmentation.dataset import list_shards, read_shard
from tests.helpers.foreign import SCENE, write_scene
from tests.helpers.worlds import room, sofa_room, two_storeys, with_box


@pytest.fixture(autouse=True)
def _small_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sim.app.viewers.house_pictures.TOP_PX", (280, 220))
    monkeypatch.setattr("sim.app.viewers.house_pictures.VIEWS_CAMERA", CameraModel(width_px=160, height_px=120))


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    return write_scene(tmp_path_factory.mktemp("scene") / "elsewhere")


def read(file: Path) -> NDArray:
    picture = cv2.imread(str(file))
    assert picture is not None
    return picture


def of(scene: tuple[Path, Path]) -> list[str]:
    return ["--house", str(scene[0]), "--labels", str(scene[1])]


def test_proposed_labels_can_be_written_edited_and_checked(
    scene: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, picture = tmp_path / "labels.json", tmp_path / "labels.png"
    propose = ["--house", str(scene[0]), "--out", str(file)]
    assert cli.run(label_house.Args, label_house.main, [*propose, "--picture", str(picture)]) == 0
    output = capsys.readouterr().out
    assert "Goals: cabinet, cushion, sofa, stool." in output
    assert "Gadget" in output
    assert "no label" in output
    assert "WARNING" not in output
    rules = json.loads(file.read_text())
    assert rules["^Gadget$"] == "void"
    file.write_text(json.dumps({**rules, "^Gadget$": "plant"}))
    check = ["--house", str(scene[0]), "--labels", str(file)]
    assert cli.run(label_house.Args, label_house.main, check) == 0
    output = capsys.readouterr().out
    assert "Goals: cabinet, cushion, sofa, plant, stool." in output
    assert "'flat' can be used with these labels." in output
    assert read(picture).shape == (220, 2 * 280, 3)


def test_names_with_brackets_or_colons_are_printed_as_they_are(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    house = with_box(room(4, 4), "lamp[/left]:bed:", centre_m=(1.0, 1.0, 0.5), half_m=(0.2, 0.2, 0.5))
    (tmp_path / "lit.xml").write_text(house.spec.to_xml())
    out = tmp_path / "[old]" / "labels.json"
    words = ["--house", str(tmp_path / "lit.xml"), "--out", str(out)]
    assert cli.run(label_house.Args, label_house.main, words) == 0
    printed = capsys.readouterr().out
    assert "lamp[/left]:bed:" in printed
    assert f"rules to {out}." in printed


def test_pictures_of_two_houses_of_one_name_are_refused(tmp_path: Path) -> None:
    houses = (tmp_path / "a" / "same.xml", tmp_path / "b" / "same.xml")
    with pytest.raises(ConfigError, match=r"--houses.*'same'"):
        gallery.main(gallery.Args(houses=houses, out=tmp_path))


def test_proposed_labels_never_replace_a_file(scene: tuple[Path, Path], capsys: pytest.CaptureFixture[str]) -> None:
    before = scene[1].read_bytes()
    options = ["--house", str(scene[0]), "--out", str(scene[1])]
    assert cli.run(label_house.Args, label_house.main, options) == 2
    assert "exists; check it with --labels" in capsys.readouterr().err
    assert scene[1].read_bytes() == before


def write_arm(folder: Path) -> Path:
    """Writes a scene in which nothing is a floor: an arm above a table."""
    (folder / "arm.xml").write_text(
        '<mujoco><worldbody><geom name="table" type="plane" size="1 1 .1" pos="0 0 -.3"/><body name="arm">'
        '<geom name="upper" type="sphere" size=".1"/></body></worldbody></mujoco>'
    )
    return folder / "arm.xml"


def test_proposed_labels_without_a_floor_are_warned_of_with_the_word_for_rules(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options = ["--house", str(write_arm(tmp_path)), "--out", str(tmp_path / "arm.json")]
    assert cli.run(label_house.Args, label_house.main, options) == 0
    output = capsys.readouterr().out
    assert "1 visible geom has no category (void)." in output
    assert "WARNING: a run would refuse 'arm' with these labels: it has no floor" in output
    assert "must get the category 'floor' from a label rule" in output


def test_the_label_picture_names_void_objects_and_has_unlit_colours_that_differ(
    scene: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    texts: list[str] = []
    monkeypatch.setattr(house_pictures, "_outlined", lambda picture, text, *rest: texts.append(text))
    house = load_house(scene[0], labels_path=scene[1])
    labels = read_labels(house.spec.copy().compile(), rules=house.rules)
    colours = house_pictures.distinct_colours(labels.categories())
    picture = house_pictures.draw_top(house, colours=colours)
    assert {"Gadget: void", "Widget: void", "Couch.001: sofa"} <= set(texts)
    colours_seen = {tuple(colour) for colour in picture.reshape(-1, 3).tolist()}
    for category in ("sofa", "wall", "floor", "void"):
        assert tuple(colours[MPCAT40_ID[category]].tolist()) in colours_seen, category


def test_label_colours_are_far_from_each_other_and_from_structure() -> None:
    categories = [*GOAL_CATEGORIES]
    colours = house_pictures.distinct_colours(["wall", "floor", *categories]).astype(int)
    used = colours[[MPCAT40_ID[name] for name in ("void", "wall", "floor", *categories)]]
    away = np.linalg.norm(used[:, None] - used[None], axis=2) + 1000 * np.eye(len(used))
    assert away.min() >= 40
    sofa, table = (
        house_pictures.distinct_colours(["sofa", "table", "chair"])[MPCAT40_ID[name]].astype(int)
        for name in ("sofa", "table")
    )
    assert np.linalg.norm(sofa - table) >= 150


def test_names_in_the_label_picture_do_not_cover_each_other(monkeypatch: pytest.MonkeyPatch) -> None:
    places: list[tuple[int, int]] = []
    monkeypatch.setattr(house_pictures, "_outlined", lambda picture, text, left_base, line_px: places.append(left_base))
    boxes = "".join(f'<geom name="lamp_{i}" size=".1" pos="0 0 {i}"/>' for i in range(4))
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{boxes}</worldbody></mujoco>")
    picture = np.zeros((400, 400, 3), np.uint8)
    house_pictures._write_names(picture, model, [(f"lamp_{i}", [i]) for i in range(4)], np.zeros(3), 50.0)
    bases = sorted(base for _, base in places)
    assert (np.diff(bases) >= 8).all()


def test_inner_walls_of_a_house_without_ambient_light_are_not_black_from_above(tmp_path: Path) -> None:
    top = house_pictures.draw_top(room(4, 4))
    assert (top.max(axis=2) < 40).mean() < 0.01


def test_labels_without_a_floor_are_refused_after_the_table(
    scene: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "few.json").write_text('{"^Couch": "sofa"}')
    options = ["--house", str(scene[0]), "--labels", str(tmp_path / "few.json")]
    assert cli.run(label_house.Args, label_house.main, options) == 2
    captured = capsys.readouterr()
    assert "Couch.001" in captured.out
    assert "has no floor" in captured.err
    assert "must get the category 'floor' from a label rule" in captured.err


def test_the_refusal_of_a_scene_names_the_labels_option(
    scene: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(scene[0].parent, tmp_path / "alone", ignore=shutil.ignore_patterns(scene[1].name))
    assert run.entry(["--house", str(tmp_path / "alone" / scene[0].name), "--episodes", "1"]) == 2
    assert "A scene from elsewhere needs --labels: `stubborn label` proposes" in capsys.readouterr().err


def test_the_gallery_draws_a_house_without_rooms(scene: tuple[Path, Path], tmp_path: Path) -> None:
    assert cli.run(gallery.Args, gallery.main, [*of(scene), "--out", str(tmp_path)]) == 0
    assert sorted(file.name for file in tmp_path.iterdir()) == ["flat_top.png", "flat_views.png"]
    top = read(tmp_path / "flat_top.png")
    assert top.std() > 20.0
    assert read(tmp_path / "flat_views.png").shape[1] >= 160


def test_lamps_light_the_views_of_the_gallery() -> None:
    dark = sofa_room().spec.copy()
    lit = dark.copy()
    lit.worldbody.add_light(pos=(0.0, 0.0, 2.4), dir=(0.0, 0.0, -1.0), diffuse=(1.0, 1.0, 1.0))
    views = [house_pictures.draw_views(House("home", spec)) for spec in (dark, lit)]
    assert views[0] is not None
    assert views[1] is not None
    assert views[1].mean() > views[0].mean() + 4.0


def test_the_gallery_draws_a_house_with_nothing_to_look_at(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = room(4, 4).spec.copy()
    for site in list(spec.worldbody.sites):
        spec.delete(site)
    (tmp_path / "bare.xml").write_text(spec.to_xml())
    assert cli.run(gallery.Args, gallery.main, ["--houses", str(tmp_path / "bare.xml"), "--out", str(tmp_path)]) == 0
    assert "there are no views" in capsys.readouterr().out
    assert (tmp_path / "bare_top.png").is_file()


def test_episodes_of_a_scene_make_a_split_that_needs_nothing_else(scene: tuple[Path, Path], tmp_path: Path) -> None:
    out = tmp_path / "split"
    options = [*of(scene), "--episodes", "2", "--out", str(out)]
    assert cli.run(make_episodes.Args, make_episodes.main, options) == 0
    moved = out.rename(tmp_path / "moved")
    (moved / "split.json.gz").rename(moved / "moved.json.gz")
    split = load_split(moved)
    assert [episode.house for episode in split.episodes] == ["flat", "flat"]
    first, second = load_house(scene[0], labels_path=scene[1]), split.load_house("flat")
    labels = [read_labels(house.spec.copy().compile(), rules=house.rules) for house in (first, second)]
    np.testing.assert_array_equal(labels[0].geom_category, labels[1].geom_category)
    assert [instance.name for instance in labels[0].instances] == [instance.name for instance in labels[1].instances]
    assert {file.name.split("_", 1)[1] for file in (moved / "files").iterdir()} == {
        "cube.obj", "arch.obj", "wood.png",
    }  # fmt: skip
    options = ["--split", str(moved), "--agent", "oracle", "--episodes", "1", "--out", str(tmp_path / "run")]
    assert run.entry(options) == 0


def test_other_labels_are_another_split(scene: tuple[Path, Path], tmp_path: Path) -> None:
    options = [*of(scene), "--episodes", "1", "--out", str(tmp_path / "split")]
    assert cli.run(make_episodes.Args, make_episodes.main, options) == 0
    before = load_split(tmp_path / "split").sha256
    rules = json.loads((tmp_path / "split" / "labels.json").read_text())
    (tmp_path / "split" / "labels.json").write_text(json.dumps({**rules, "^Gadget": "plant"}))
    assert load_split(tmp_path / "split").sha256 != before


def test_views_of_a_scene_have_its_labels(scene: tuple[Path, Path], tmp_path: Path) -> None:
    few = ["--views", "3", "--shrink", "4", "--profile", "fast", "--out", str(tmp_path)]
    assert cli.run(generate_views.Args, generate_views.main, [*of(scene), *few]) == 0
    (shard,) = list_shards(tmp_path)
    assert len(list(read_shard(shard))) == 3


@pytest.mark.parametrize(
    ("module", "options", "message"),
    [
        (make_episodes, ["--labels", "x.json"], "--labels and --root need --house"),
        (make_episodes, ["--house", "x.xml"], "--house needs --out"),
        (make_episodes, [], "needs --split"),
        (generate_views, ["--labels", "x.json", "--out", "{tmp}"], "--labels and --root need --house"),
        (generate_views, ["--house", "x.xml", "--split", "val", "--out", "{tmp}"], "--house excludes --split"),
        (gallery, ["--root", "x", "--sheet", "--out", "{tmp}"], "--labels and --root need --house"),
    ],
)
def test_options_of_a_house_belong_to_one(module, options, message, tmp_path, capsys) -> None:
    words = [word.replace("{tmp}", str(tmp_path)) for word in options]
    assert cli.run(module.Args, module.main, words) == 2
    assert message in capsys.readouterr().err


def test_visual_walls_become_solid_boxes_and_meshes_stay(tmp_path: Path) -> None:
    visual = SCENE.replace(
        '<default class="plaster"><geom ', '<default class="plaster"><geom contype="0" conaffinity="0" '
    )
    house, labels = write_scene(tmp_path / "s", scene=visual)
    loaded = load_house(house, labels_path=labels)
    assert loaded.notes[2].startswith("Made solid: 6 visual walls (Shell.N, Shell.S, ")
    solid = {geom.name: geom.contype for geom in loaded.spec.geoms}
    assert solid["Shell.N"] == 1
    assert solid["Arch.look"] == 0


def test_storeys_of_a_scene_whose_bodies_have_no_names_are_cut() -> None:
    house = two_storeys()
    for storey, height_m in ((0, 0.5), (1, 3.5)):
        body = house.spec.worldbody.add_body(pos=[0.5, 0.5, height_m])
        body.add_geom(name=f"misc_{storey:02d}", type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.1, 0.1, 0.1])
    kept = [{geom.name for geom in storey.spec.geoms if geom.name.startswith("misc")} for storey in storeys(house)]
    assert kept == [{"misc_00"}, {"misc_01"}]
    single = with_box(room(3, 3), "misc_00", centre_m=(0, 0, 0.5), half_m=(0.1, 0.1, 0.1))
    single.spec.worldbody.add_body()
    assert storeys(single) == [single]


def test_a_small_scene_on_a_wide_plane_fills_its_picture() -> None:
    spec = mujoco.MjSpec.from_string(
        '<mujoco><worldbody><geom name="Ground" type="plane" size="20 20 .1"/>'
        '<geom name="Box" type="box" size="1 1 .2" pos="0 0 .2" rgba="1 0 0 1"/></worldbody></mujoco>'
    )
    house = House("wide", spec, rules={"Ground": "floor", "Box": "table"})
    colours = house_pictures.distinct_colours(["floor", "table"])
    picture = house_pictures.draw_top(house, colours=colours)
    assert (picture == colours[MPCAT40_ID["table"]]).all(axis=2).mean() > 0.05
