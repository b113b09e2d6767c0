"""Imported models: geometry, labels, splits, refused models, and houses that contain them."""

from __future__ import annotations

import importlib
import json
import zipfile
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from sim.core.errors import ConfigError
from sim.gl import mujoco
from sim.homes.housegen.furniture import CATALOGUE
from sim.homes.housegen.furniture.catalogue import Catalogue
from sim.homes.housegen.generator import HouseConfig, generate_house
from sim.homes.housegen.imported import reduction
from sim.homes.housegen.imported.catalogue import ImportedFurniture, style_of
from sim.homes.housegen.imported.labels import label_of
from sim.homes.housegen.imported.library import (
    TRANSFER_PART,
    Model,
    Shape,
    _drawn,
    import_entries,
    import_model,
    read_index,
    read_shape,
    transfer_list,
    with_splits,
    write_index,
)
from sim.homes.housegen.imported.meshes import Part, check_installed
from sim.homes.housegen.imported.reduction import MAX_TRIANGLES, reduced
from sim.homes.housegen.imported.solids import collision_boxes, top_of
from sim.homes.housegen.imported.sources import Entry, Skipped, read_source
from sim.homes.housegen.mjcf.builder import HouseBuilder
from sim.homes.housegen.mjcf.movables import split_movable
from sim.homes.housegen.mjcf.placed import PlacedItem
from sim.houses.writing import house_text
from tests.helpers import wording
from tests.helpers.models import CHAIR, MATERIALS, obj_text, properties, write_catalogue, write_folder

pytest.importorskip("trimesh")
pytest.importorskip("fast_simplification")


def entries_of(folder: Path) -> list[Entry]:
    return [found for found in read_source(folder) if isinstance(found, Entry)]


def imported(folder: Path, name: str) -> tuple[Model, Shape]:
    return import_model(next(entry for entry in entries_of(folder) if entry.name == name))


def import_all(source: Path, out: Path) -> list[Model]:
    found = list(import_entries(entries_of(source), out))
    models = with_splits([made for made in found if isinstance(made, Model)])
    write_index(out, models, [])
    return models


@pytest.fixture(scope="module")
def eight_chairs(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Model]]:
    """Returns a folder of imported models with eight chairs, and the models."""
    folder = tmp_path_factory.mktemp("imported")
    return folder / "out", import_all(write_folder(folder / "source", chairs=8), folder / "out")


def reasons(folder: Path) -> list[str]:
    """Returns the reasons why models of a source are left out, when it is read or when they are imported."""
    found = list(read_source(folder))
    left_out = [entry[1] for entry in found if not isinstance(entry, Entry)]
    for entry in found:
        if isinstance(entry, Entry):
            try:
                import_model(entry)
            except Skipped as reason:
                left_out.append(str(reason))
    return left_out


# ---- geometry --------------------------------------------------------------------------------------------------------


def test_a_model_is_upright_in_metres_with_its_back_at_the_smallest_x(tmp_path: Path) -> None:
    model, shape = imported(write_folder(tmp_path), "chair0")
    assert model.size_m == pytest.approx((0.5, 0.5, 0.9), abs=0.002)
    cloth = max(shape.parts, key=lambda part: part.rgba[2])
    assert cloth.rgba[:3] == pytest.approx((0.1, 0.2, 0.8), abs=0.01)
    high = cloth.vertices_m[cloth.vertices_m[:, 2] > 0.8]
    assert high[:, 0].max() < -0.15


def test_front_deg_turns_the_model(tmp_path: Path) -> None:
    folder = write_folder(tmp_path)
    rows = (folder / "models.csv").read_text()
    (folder / "models.csv").write_text(rows.replace("0.9,0,", "0.9,90,"))
    _, shape = imported(folder, "chair0")
    cloth = max(shape.parts, key=lambda part: part.rgba[2])
    high = cloth.vertices_m[cloth.vertices_m[:, 2] > 0.8]
    # The file's +x is the front now, so that the chair's back, at the file's smallest z, is on the left.
    assert abs(high[:, 0].mean()) < 0.05
    assert high[:, 1].mean() > 0.2


def test_the_colour_of_a_picture_is_that_of_the_places_shown(tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    folder = write_folder(tmp_path)
    picture = np.zeros((64, 64, 3), np.uint8)
    picture[:, :32] = (250, 10, 10)
    image.fromarray(picture).save(folder / "wood.png")
    (folder / "model.mtl").write_text("newmtl wood\nKd 1 1 1\nmap_Kd wood.png\n")
    (folder / "table.obj").write_text(
        "mtllib model.mtl\nusemtl wood\nv 0 0 0\nv 1 0 0\nv 1 1 1\nv 0 1 1\nv 0 1 0\n"
        "vt 0.1 0.1\nvt 0.3 0.1\nvt 0.3 0.3\nvt 0.1 0.3\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\nf 1/1 2/2 5/4\n"
    )
    _, shape = imported(folder, "table")
    assert shape.parts[0].rgba[:3] == pytest.approx((0.98, 0.04, 0.04), abs=0.03)


def test_a_model_with_a_picture_of_another_format_is_left_out_with_the_formats(tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    folder = write_folder(tmp_path)
    image.new("RGB", (8, 8)).save(folder / "wood.png", "EPS")
    (folder / "model.mtl").write_text("newmtl wood\nKd 1 1 1\nmap_Kd wood.png\n")
    (reason,) = set(reasons(folder))
    assert reason == "A picture has an unsupported format; use PNG, JPEG, WebP, BMP, GIF"


def test_a_table_collides_as_its_top_and_its_legs_and_carries_objects(tmp_path: Path) -> None:
    _, shape = imported(write_folder(tmp_path), "table")
    assert 3 <= len(shape.boxes_m) <= 12
    middle = [box for box in shape.boxes_m if (box[:2] < 0.1).all() and (box[3:5] > -0.1).all()]
    assert len(middle) == 1
    assert middle[0][2] > 0.6  # the robot's path between the legs is free
    x0, y0, x1, y1, z = shape.top_m
    assert z == pytest.approx(0.74, abs=0.01)
    assert (x1 - x0, y1 - y0) == pytest.approx((0.8, 1.4), abs=0.06)


def test_a_fine_mesh_keeps_its_extent_and_its_thin_pieces() -> None:
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.creation.icosphere(subdivisions=6, radius=0.4)
    rod = trimesh.creation.cylinder(radius=0.01, height=1.5)
    part = Part(
        np.vstack([ball.vertices, rod.vertices]), np.vstack([ball.faces, rod.faces + len(ball.vertices)]), (1, 0, 0, 1)
    )
    (made,) = reduced([part])
    assert len(made.faces) <= 1.2 * MAX_TRIANGLES < len(part.faces)
    assert np.ptp(made.vertices_m, axis=0) == pytest.approx([0.8, 0.8, 1.5], abs=0.02)


def test_a_piece_that_the_library_destroys_is_joined_on_a_grid(monkeypatch: pytest.MonkeyPatch) -> None:
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.creation.icosphere(subdivisions=5, radius=0.4)
    destroyer = SimpleNamespace(simplify=lambda vertices, faces, target_count: (0.3 * vertices, faces[:target_count]))
    monkeypatch.setattr(reduction, "library", lambda name: destroyer)
    (made,) = reduced([Part(np.asarray(ball.vertices), np.asarray(ball.faces), (1, 0, 0, 1))])
    assert np.ptp(made.vertices_m, axis=0) == pytest.approx([0.8, 0.8, 0.8], abs=0.05)
    assert len(made.faces) <= 2 * MAX_TRIANGLES


def test_a_model_in_a_house_collides_with_its_boxes_only(tmp_path: Path) -> None:
    models = import_all(write_folder(tmp_path / "source"), tmp_path / "out")
    table = next(model for model in models if model.category == "table")
    style = style_of(tmp_path / "out", table, "train")
    item = Catalogue([style]).make_item("table", np.random.default_rng(0), pool="train")
    builder = HouseBuilder("test")
    builder.add(PlacedItem(item))
    model = builder.spec.compile()
    hits = (model.geom_contype != 0) | (model.geom_conaffinity != 0)
    assert hits.sum() == len(read_shape(tmp_path / "out", table).boxes_m)
    assert (model.geom_group[hits] == 3).all()
    assert set(model.geom_type[~hits]) == {int(mujoco.mjtGeom.mjGEOM_MESH)}
    plant = replace(item, category="plant")  # plants can be pushed, but not imported ones
    assert split_movable(plant) == (plant, ())


def test_only_the_pot_of_a_plant_collides() -> None:
    trimesh = pytest.importorskip("trimesh")
    pot = trimesh.creation.box((0.3, 0.3, 0.3), transform=trimesh.transformations.translation_matrix((0, 0, 0.15)))
    crown = trimesh.creation.box((1.0, 1.0, 0.5), transform=trimesh.transformations.translation_matrix((0, 0, 1.0)))
    parts = tuple(Part(np.asarray(m.vertices), np.asarray(m.faces), (0, 1, 0, 1)) for m in (pot, crown))
    assert collision_boxes(parts, "plant")[:, 5].max() <= 0.31
    assert collision_boxes(parts, "chair")[:, 5].max() > 1.2
    assert top_of((parts[0],)) is None or top_of((parts[0],))[4] == pytest.approx(0.3, abs=0.01)  # type: ignore[index]


# ---- labels and splits -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "group", "size_m", "category", "use"),
    [
        ("Chair", "Living room", (0.5, 0.5, 0.9), "chair", "dining"),
        ("Chair", "Office", (0.6, 0.6, 1.0), "chair", "office"),
        ("Stool", "Kitchen", (0.4, 0.4, 0.78), "stool", "bar"),
        ("Table", "Living room", (0.7, 1.1, 0.53), "table", "coffee"),
        ("Table", "Living room", (0.9, 1.6, 0.75), "table", "dining"),
        ("Ficus", "Living room", (0.4, 0.4, 0.8), "plant", "floor"),
    ],
)
def test_labels_follow_name_group_and_size(name: str, group: str, size_m: tuple, category: str, use: str) -> None:
    label = label_of(name, group, size_m)
    assert label is not None
    assert (label.category, label.uses[0]) == (category, use)


@pytest.mark.parametrize(("name", "group"), [("Chair", "Vehicles"), ("Double vanity", "Bathroom"), ("Thing", "")])
def test_models_without_a_sure_label_are_left_out(name: str, group: str) -> None:
    assert label_of(name, group, (0.5, 0.5, 0.9)) is None


def test_the_shipped_catalogue_has_every_category_use_and_mount_of_the_labels() -> None:
    from sim.homes.housegen.imported.labels import _RULES

    for rule in _RULES:
        if rule.label is not None:
            known = {use for style in CATALOGUE.styles(rule.label.category) for use in style.uses}
            assert set(rule.label.uses) <= known, rule
            for use in rule.label.uses or (None,):
                mounts = {style.mount for style in CATALOGUE.styles(rule.label.category, use=use)}
                assert rule.label.mount in mounts, rule


def test_the_split_depends_on_names_and_gives_the_transfer_test_a_model(
    eight_chairs: tuple[Path, list[Model]],
) -> None:
    _, models = eight_chairs
    chairs = [model for model in models if model.category == "chair"]
    assert {model.split for model in chairs} == {"train", "transfer"}
    three = [replace(models[0], ident=f"my_models#{name}.obj") for name in ("a", "c", "d")]
    assert not any(_drawn(model) % TRANSFER_PART == 0 for model in three)
    assert [model.split for model in with_splits(three)].count("transfer") == 1
    assert not any(model.split == "transfer" for model in with_splits(three[:2]))
    again = with_splits(list(reversed(models)))
    assert {m.ident: m.split for m in again} == {m.ident: m.split for m in models}


def test_the_list_of_the_repository_decides_for_its_sources(eight_chairs: tuple[Path, list[Model]]) -> None:
    _, models = eight_chairs
    listed = with_splits(models, {models[2].ident: models[2].sha256})
    assert [model.split for model in listed].count("transfer") == 1
    assert listed[2].split == "transfer"
    assert len(transfer_list()) > 40


# ---- refused models --------------------------------------------------------------------------------------------------


def test_bad_entries_of_a_catalogue_are_left_out_with_a_reason(tmp_path: Path) -> None:
    flat = "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n"
    entries = [
        properties("good", "/chair.obj"),
        properties("missing", "/nothing.obj"),
        properties("outside", "/../../etc/passwd.obj"),
        properties("degenerate", "/flat.obj"),
        properties("text", "/text.obj"),
        properties("huge", "/chair.obj", width="90000"),
        properties("nan", "/chair.obj", width="nan"),
        properties("sizeless", "/chair.obj", width="wide"),
        properties("door", "/chair.obj", doorOrWindow="true"),
        properties("other", "/chair.obj", name="Thing"),
        properties("format", "/chair.doc"),
    ]
    files = {"chair.obj": obj_text(CHAIR), "model.mtl": MATERIALS, "flat.obj": flat, "text.obj": "hello\n"}
    files["chair.doc"] = files["chair.obj"]
    write_catalogue(tmp_path / "test.sh3f", entries, files)
    (tmp_path / "broken.sh3f").write_bytes(b"PK no zip")
    found = reasons(tmp_path)
    assert len(found) == len(entries)  # the broken file is among them, the good one is not
    for part in ("leads out of the zip", "has no 'nothing.obj'", "a door", "no category", "format 'doc'", "90", "nan"):
        assert any(part in reason for reason in found), part


def test_a_model_that_announces_more_numbers_than_it_has_bytes_is_left_out(tmp_path: Path) -> None:
    accessor = {"componentType": 5126, "count": 60_000_000, "type": "VEC3"}
    gltf = {
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "accessors": [accessor],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    }  # fmt: skip
    folder = write_folder(tmp_path)
    (folder / "chair0.obj").rename(folder / "chair0.gltf")
    (folder / "chair0.gltf").write_text(json.dumps(gltf))
    (folder / "models.csv").write_text((folder / "models.csv").read_text().replace("chair0.obj", "chair0.gltf"))
    (reason,) = reasons(folder)
    assert "announces more than" in reason


def test_an_error_that_nobody_expected_leaves_out_one_model(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(parts: object, *_: object) -> object:
        if len(seen) == 0:
            seen.append(parts)
            raise ZeroDivisionError("by\nzero")
        return reduced(parts, MAX_TRIANGLES)  # type: ignore[arg-type]

    seen: list[object] = []
    monkeypatch.setattr("sim.homes.housegen.imported.library.reduced", broken)
    found = list(import_entries(entries_of(write_folder(tmp_path / "in")), tmp_path / "out"))
    assert [made for made in found if not isinstance(made, Model)] == [
        ("chair0", "it cannot be imported (ZeroDivisionError: by zero)")
    ]
    assert len(found) == 2


def test_numbers_and_texts_that_python_cannot_hold_are_left_out_with_a_reason(tmp_path: Path) -> None:
    many = "9" * 5000
    entries = [
        properties("a", "/chair.obj", creator="A \\ud800 \\ud83d\\ude00"),
        properties("b", "/chair.obj", width=many),
    ]
    write_catalogue(tmp_path / "a" / "a.sh3f", entries, {"chair.obj": obj_text(CHAIR), "model.mtl": MATERIALS})
    with zipfile.ZipFile(tmp_path / "a" / "b.sh3f", "w") as archive:
        archive.writestr("PluginFurnitureCatalog.properties", f"name#{many}=Chair\n")
    assert len(reasons(tmp_path / "a")) == 1
    (model,) = import_all(tmp_path / "a", tmp_path / "out")
    assert model.author == "A \N{REPLACEMENT CHARACTER} \N{GRINNING FACE}"
    folder = write_folder(tmp_path / "b")
    table = (folder / "models.csv").read_text()
    (folder / "models.csv").write_text(
        table + f"cha\0ir.obj,chair,dining,0.5,0.5,0.9,0,,,floor\nchair0.obj,chair,dining,{many},0.5,0.9,0,,,floor\n"
    )
    found = reasons(folder)
    assert len(found) == 2
    assert any("cha\\x00ir.obj" in reason for reason in found)
    (folder / "models.csv").unlink()
    row = '[[model]]\nfile = "chair0.obj"\ncategory = "chair"\nwidth_m = {}\ndepth_m = 1\nheight_m = 1\n'
    (folder / "models.toml").write_text(row.format("9" * 400))
    assert any("cannot be read" in reason for reason in reasons(folder))
    (folder / "models.toml").write_text(row.format(many))
    with pytest.raises(ConfigError, match=r"models\.toml' cannot be read"):
        reasons(folder)


def test_models_with_uses_by_which_no_room_asks_are_left_out_with_those_that_exist(tmp_path: Path) -> None:
    table = write_folder(tmp_path, chairs=2) / "models.csv"
    table.write_text(table.read_text().replace("chair0.obj,chair,dining", "chair0.obj,chair,diningg"))
    found = list(read_source(tmp_path))
    assert [each[1] for each in found if not isinstance(each, Entry)] == [
        "category 'chair' has no use 'diningg'. Available: dining, office, arm"
    ]
    assert len(entries_of(tmp_path)) == 2


def test_a_truncated_zip_is_left_out(tmp_path: Path) -> None:
    file = write_catalogue(tmp_path / "a.sh3f", [properties("a", "/chair.obj")], {"chair.obj": obj_text(CHAIR)})
    content = bytearray(file.read_bytes())
    at = content.index(b"usemtl")
    content[at : at + 6] = b"xxxxxx"  # the checksum is wrong now
    file.write_bytes(bytes(content))
    assert any("broken" in reason for reason in reasons(tmp_path))


def test_a_row_must_not_name_a_file_outside_of_the_folder(tmp_path: Path) -> None:
    folder = write_folder(tmp_path / "in")
    (tmp_path / "secret.obj").write_text(obj_text(CHAIR))
    table = folder / "models.csv"
    table.write_text(table.read_text().replace("chair0.obj,", "../secret.obj,", 1))
    assert any("leads out of the folder" in reason for reason in reasons(folder))


def test_a_folder_without_models_or_with_a_broken_table_is_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"\.sh3f file"):
        list(read_source(tmp_path))
    (tmp_path / "models.toml").write_text("[[model]\n")
    with pytest.raises(ConfigError, match=wording.CANNOT_BE_READ):
        list(read_source(tmp_path))


def test_a_missing_package_is_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> None:
        raise ImportError(name)

    monkeypatch.setattr(importlib, "import_module", missing)
    with pytest.raises(ConfigError, match=r"stubborn-objectnav\[models\]"):
        check_installed()


def test_a_folder_that_was_not_imported_or_lost_a_file_is_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=wording.STUBBORN_IMPORT_FURNITURE):
        read_index(tmp_path)
    models = import_all(write_folder(tmp_path / "source"), tmp_path / "out")
    (tmp_path / "out" / "meshes" / f"{models[0].key}.npz").write_bytes(b"no zip")
    with pytest.raises(ConfigError, match=wording.MAKES_IT_AGAIN):
        read_shape(tmp_path / "out", models[0])


# ---- houses ----------------------------------------------------------------------------------------------------------


def test_importing_twice_gives_the_same_bytes(tmp_path: Path) -> None:
    source = write_folder(tmp_path / "source")
    for out in ("a", "b"):
        import_all(source, tmp_path / out)
    files = sorted(path.relative_to(tmp_path / "a") for path in (tmp_path / "a").rglob("*.*"))
    assert files
    for file in files:
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()


def test_transfer_models_replace_our_own_styles_of_their_uses_only(eight_chairs: tuple[Path, list[Model]]) -> None:
    out, models = eight_chairs
    catalogue = ImportedFurniture(out, "transfer").catalogue("heldout")
    dining = catalogue.styles("chair", "heldout", "dining")
    assert len(dining) == sum(model.category == "chair" and model.split == "transfer" for model in models)
    assert catalogue.styles("chair", "heldout", "office") == CATALOGUE.styles("chair", "heldout", "office")
    mixed = ImportedFurniture(out, "train").catalogue("train").styles("chair", "train", "dining")
    assert len(mixed) > len(CATALOGUE.styles("chair", "train", "dining"))
    assert not {style.name for style in dining} & {style.name for style in mixed}
    alone = ImportedFurniture(out, "train", alone=True).catalogue("train").styles("chair", "train", "dining")
    assert len(alone) == len(mixed) - len(CATALOGUE.styles("chair", "train", "dining"))


@pytest.mark.costly
def test_a_house_shows_models_passes_its_check_and_names_authors(tmp_path: Path) -> None:
    import_all(write_folder(tmp_path / "source", chairs=12), tmp_path / "out")
    furniture = ImportedFurniture(tmp_path / "out", "transfer")
    config = HouseConfig(pool="heldout", kind="flat", area_m2=80.0)
    text = house_text(furniture.make_house(3, config).spec)
    assert text == house_text(furniture.make_house(3, config).spec)
    head = text[: text.index("-->")]
    assert "chair" in head
    assert "Somebody" in head
    assert "CC0 - - of a test" in head
    assert "Somebody" not in house_text(generate_house(3, config).spec)
