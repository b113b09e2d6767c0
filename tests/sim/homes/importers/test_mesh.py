"""A home that is one mesh gets objects by the names of its nodes, a flat floor, and walls that leave its door open."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
import trimesh
from hypothesis import example, given, settings
from hypothesis import strategies as st

from sim.app import cli
from sim.app.commands import episodes
from sim.app.commands.importing import folder
from sim.app.commands.importing import mesh as command
from sim.app.commands.importing.folder import ImportArgs, Made, Work, file_works, import_all
from sim.core.errors import ConfigError, EpisodeError, HouseError
from sim.gl import mujoco
from sim.homes.importers import mesh_house
from sim.homes.importers.losses import Losses
from sim.homes.importers.mesh import files_of, find_files, import_mesh
from sim.homes.importers.mesh_house import MeshConfig, MeshObject, Shape, build_house
from sim.homes.importers.obj import read_obj
from sim.homes.importers.surfaces import Paint, Surface
from sim.houses.geoms import data_at_rest
from sim.houses.house import House, read_rooms
from sim.houses.labels import read_labels
from sim.houses.load import load_house
from sim.houses.proposals import geom_box
from sim.world.check import check_own_house
from tests.helpers import wording
from tests.helpers.messages import require_result_or_one_line
from tests.helpers.scanned import PIECES, triangles_of, write_glb


def write_obj(folder: Path) -> Path:
    """Writes the home as an OBJ file, z up, an object for each piece, with two materials."""
    lines, count = ["mtllib flat.mtl"], 0
    for number, piece in enumerate(PIECES):
        made = triangles_of(piece)
        lines += [f"o {piece.kind.replace(' ', '_')}.{number}", f"usemtl m{number % 2}"]
        lines += ["v " + " ".join(f"{value:.4f}" for value in vertex) for vertex in made.vertices]
        lines += ["f " + " ".join(str(corner + 1 + count) for corner in face) for face in made.faces]
        count += len(made.vertices)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "flat.mtl").write_text("newmtl m0\nKd 1 0 0\nnewmtl m1\nKd 0 0 1\n")
    (folder / "flat.obj").write_text("\n".join(lines))
    return folder / "flat.obj"


@pytest.fixture(scope="module")
def split(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("mesh")
    assert command.main(command.Args(path=write_glb(folder), out=folder / "out", pictures=0)) == 0
    return folder / "out"


def categories(house: House) -> list[str]:
    labels = read_labels(house.spec.copy().compile(), ignore_prefix="")
    return sorted({each.category for each in labels.instances})


def test_nodes_have_the_categories_of_their_names_and_places_of_the_source(split: Path) -> None:
    house = load_house(split / "flat.xml")
    assert categories(house) == ["bed", "ceiling", "chair", "floor", "picture", "plant", "table", "wall"]
    model = house.spec.copy().compile()
    data = data_at_rest(model)
    (bed,) = read_labels(model, ignore_prefix="").of_category("bed")
    boxes = [geom for geom in bed.geom_ids if model.geom_group[geom] == 3]
    low = (data.geom_xpos[boxes] - model.geom_size[boxes]).min(axis=0)
    high = (data.geom_xpos[boxes] + model.geom_size[boxes]).max(axis=0)
    assert low == pytest.approx([6.0, 2.4, 0.0], abs=0.06)
    assert high == pytest.approx([7.9, 3.9, 0.5], abs=0.06)
    assert sum(room.area_m2 for room in read_rooms(model)) == pytest.approx(32.0, abs=1.5)


def test_the_robot_passes_the_door(split: Path) -> None:
    assert check_own_house(load_house(split / "flat.xml"))[0] == []


@pytest.mark.costly
def test_a_table_counts_first_and_the_proposed_one_can_be_edited(split: Path, tmp_path: Path) -> None:
    table = json.loads((split / "categories" / "flat.json").read_text())
    assert table[r"^office_chair\.008$"] == "chair"
    table = {"office_chair": "stool", "bed": "void", **table}
    (tmp_path / "table.json").write_text(json.dumps(table))
    file = write_glb(tmp_path, names={"table": "Object"})
    args = command.Args(path=file, categories=tmp_path / "table.json", out=tmp_path / "out", pictures=0)
    assert command.main(args) == 0
    found = categories(load_house(tmp_path / "out" / "flat.xml"))
    assert "stool" in found
    assert "objects" in found
    assert not {"chair", "bed", "table"} & set(found)
    report = json.loads((tmp_path / "out" / "import.json").read_text())["flat"]
    assert report["left_out"] == {"bed.005: the table says void": 1}


@pytest.mark.costly
def test_an_obj_file_keeps_its_objects_and_colours(tmp_path: Path) -> None:
    file = write_obj(tmp_path)
    surfaces = read_obj(file, texture_px=64, losses=Losses().changes)
    assert [each.node for each in surfaces] == [f"{p.kind.replace(' ', '_')}.{n}" for n, p in enumerate(PIECES)]
    assert surfaces[1].paint.rgba == (0.0, 0.0, 1.0, 1.0)
    scene = import_mesh(file, rules={}, up="z", config=MeshConfig())
    assert scene.house.report["furniture"]["chair"] == 1


def test_lines_that_other_readers_accept_lose_no_home(tmp_path: Path) -> None:
    """A comment with a backslash, a face on two lines, a colour of one number, and colours that are not numbers."""
    corners = "# C:\\homes\\\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl grey\nf 1 \\\n2 3\nusemtl odd\nf 1 2 3"
    (tmp_path / "home.obj").write_text(f"mtllib m.mtl\n{corners}")
    (tmp_path / "m.mtl").write_text("newmtl grey\nKd 0.5\nd\nnewmtl odd\nKd spectral a.rfl\nd nan\n")
    losses = Losses()
    grey, odd = read_obj(tmp_path / "home.obj", texture_px=16, losses=losses.changes)
    assert grey.paint.rgba == (0.5, 0.5, 0.5, 1.0)
    assert odd.paint.rgba == (0.7, 0.7, 0.7, 1.0)
    assert sum(losses.changes.values()) == 3


MATERIALS = """
newmtl red
Kd 1 0 0
d 0.25
newmtl first
Kd 1 0 0
map_Kd -s 2 2 2 -clamp on my picture.png
newmtl last
map_Kd my picture.png
Kd 1 0 0
"""


def test_materials_of_an_obj_file_have_an_opacity_and_a_picture_whose_name_has_spaces(tmp_path: Path) -> None:
    faces = [f"usemtl {name}\nf 1/1 2/1 3/1" for name in ("red", "first", "last")]
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0"
    (tmp_path / "home.obj").write_text("\n".join(["mtllib all kinds.mtl", corners, *faces]))
    (tmp_path / "all kinds.mtl").write_text(MATERIALS)
    cv2.imwrite(str(tmp_path / "my picture.png"), np.full((4, 4, 3), 90, np.uint8))
    losses = Losses()
    red, first, last = read_obj(tmp_path / "home.obj", texture_px=64, losses=losses.changes)
    assert red.paint.rgba == (1.0, 0.0, 0.0, 0.25)
    for each in (first, last):
        assert each.paint.rgba == (1.0, 1.0, 1.0, 1.0)
        assert each.paint.picture is not None
    assert not losses.changes
    assert {file.name for file in files_of(tmp_path / "home.obj")} == {"all kinds.mtl", "my picture.png"}
    with (tmp_path / "all kinds.mtl").open("a") as materials:
        materials.write("newmtl far\nmap_Kd ..\\outside.png\nnewmtl near\nmap_Kd sub\\b.png\n")
    (tmp_path / "sub").mkdir()
    found = {file.relative_to(tmp_path.resolve()).as_posix() for file in files_of(tmp_path / "home.obj")}
    assert found == {"all kinds.mtl", "my picture.png", "sub/b.png"}


def test_an_obj_file_may_name_several_files_of_materials_in_one_line(tmp_path: Path) -> None:
    for name, colour in (("a", "1 0 0"), ("b", "0 1 0")):
        (tmp_path / f"{name}.mtl").write_text(f"newmtl {name}\nKd {colour}\n")
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
    (tmp_path / "home.obj").write_text(f"mtllib a.mtl b.mtl\n{corners}usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n")
    losses = Losses()
    read = read_obj(tmp_path / "home.obj", texture_px=64, losses=losses.changes)
    assert [surface.paint.rgba[:3] for surface in read] == [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]
    assert not losses.changes
    assert {file.name for file in files_of(tmp_path / "home.obj")} == {"a.mtl", "b.mtl"}


@pytest.mark.costly
def test_a_home_is_imported_again_when_its_materials_change(tmp_path: Path) -> None:
    file, out = write_obj(tmp_path), tmp_path / "out"
    file.write_text(file.read_text().replace("mtllib flat.mtl", "mtllib other.mtl"))
    materials = (tmp_path / "flat.mtl").rename(tmp_path / "other.mtl")
    args = command.Args(path=file, out=out, pictures=0, up="z")
    assert command.main(args) == 0
    assert 'rgba="0 0 1 1"' in (out / "flat.xml").read_text()
    materials.write_text(materials.read_text().replace("Kd 0 0 1", "Kd 0 1 0"))
    assert command.main(args) == 0
    assert 'rgba="0 0 1 1"' not in (out / "flat.xml").read_text()


def test_the_parts_of_a_gltf_file_are_its_buffers_and_pictures(tmp_path: Path) -> None:
    parts = {"buffers": [{"uri": "a%20b.bin"}, {}], "images": [{"uri": "data:image/png;base64,AA"}, {"uri": "c.png"}]}
    (tmp_path / "home.gltf").write_text(json.dumps(parts))
    assert files_of(tmp_path / "home.gltf") == [tmp_path / "a b.bin", tmp_path / "c.png"]
    (tmp_path / "home.gltf").write_text("{")
    assert files_of(tmp_path / "home.gltf") == []


def test_an_object_may_be_a_single_triangle_and_a_rug_lies_flat_although_a_mat_on_a_table_does_not(
    tmp_path: Path,
) -> None:
    def box(name: str, low: tuple[float, ...], high: tuple[float, ...]) -> MeshObject:
        made = trimesh.creation.box(bounds=[low, high])
        return MeshObject("rug", name, Shape((Surface(name, "", made.vertices, made.faces.astype(np.int32), Paint()),)))

    rug = box("rug", (0.0, 0.0, 0.0), (1.0, 1.0, 0.015))
    mat = replace(rug, position_m=(2.0, 0.0, 0.7))
    corners = np.array([[0.0, 0.0, 0.5], [0.3, 0.0, 0.5], [0.0, 0.3, 0.9]])
    flag = Shape((Surface("flag", "", corners, np.array([[0, 1, 2]], np.int32), Paint()),))
    floor = replace(box("floor", (0.0, 0.0, -0.1), (4.0, 4.0, 0.0)), category="floor")
    counts = []
    for order in ([rug, mat], [mat, rug], [rug], [mat]):
        objects = [floor, MeshObject("objects", "flag", flag, is_solid=False), *order]
        made = build_house("home", "here", objects, (), MeshConfig(), Losses())
        counts.append(made.report["collision_geoms"])
    assert counts[0] == counts[1] == counts[3] > counts[2] == 0


@pytest.mark.costly
def test_a_home_in_one_node_gets_a_floor_and_walls(tmp_path: Path) -> None:
    whole = trimesh.util.concatenate(
        [triangles_of(piece, edge_m=0.5) for piece in PIECES if piece.kind in ("floor", "wall")]
    )
    whole.export(tmp_path / "scan.ply")
    scene = import_mesh(tmp_path / "scan.ply", rules={}, up="auto", config=MeshConfig())
    assert scene.house.report["area_m2"] == pytest.approx(32.0, abs=2.0)
    assert any("level triangles of the walls" in each for each in scene.house.report["changes"])


@pytest.mark.parametrize("width_m", [1.0, 2.5])
def test_a_rug_in_a_home_of_one_node_is_not_its_floor_and_hides_it(width_m: float, tmp_path: Path) -> None:
    home = trimesh.Scene()
    whole = [triangles_of(piece) for piece in PIECES if piece.kind in ("floor", "wall")]
    home.add_geometry(trimesh.util.concatenate(whole), node_name="Apartment")
    home.add_geometry(trimesh.creation.box(bounds=[[1, 1, 0], [1 + width_m, 3, 0.01]]), node_name="Rug")
    home.export(tmp_path / "flat.glb")
    house = import_mesh(tmp_path / "flat.glb", rules={}, up="z", config=MeshConfig()).house
    assert house.report["area_m2"] == pytest.approx(32.0, abs=2.0)
    text = next(text for name, text in house.files.items() if name.endswith(".xml"))
    assets = {name: content for name, content in house.files.items() if isinstance(content, bytes)}
    model = mujoco.MjModel.from_xml_string(str(text), assets)
    shown = [geom for geom in range(model.ngeom) if "floor" in model.body(model.geom_bodyid[geom]).name]
    tops_m = sorted(geom_box(model, data_at_rest(model), geom)[1][2] for geom in shown)
    assert tops_m == pytest.approx([0.0, 0.004], abs=1e-4)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("f 1 2 3", wording.LINE_1_VERTEX_1_DOES_NOT_EXIST),
        ("v 0 0 0\nv x 0 0", "line 2"),
        ("v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3", "not finite"),
        ("v 0 0 0", wording.HAS_NO_TRIANGLES),
        ("mtllib ../other.mtl", wording.OUTSIDE_OF_ITS_FOLDER),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3", wording.NO_LEVEL_FLOOR),
        ("v 0 0 0\nv 1 0 0\nf 1 2", "three vertices"),
        ("v 0 0 0\nf" + " 1" * 20_000, "at most 10,000"),
        ("mtllib a\0b", wording.OUTSIDE_OF_ITS_FOLDER),
    ],
)
def test_a_broken_file_is_one_line_with_file_and_place(text: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "home.obj").write_text(text)
    with pytest.raises(HouseError, match=message) as caught:
        import_mesh(tmp_path / "home.obj", rules={}, up="auto", config=MeshConfig())
    assert str(tmp_path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_folder_without_meshes_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=wording.HAS_NO_FILE_OF_A_HOME):
        find_files(tmp_path)


LINES = st.sampled_from(
    ["v 0 0 0", "v 9 0 0", "v 9 9 0", "v 1e3 0 2", "vt 0 1", "f 1 2 3", "f 1/1 2/1 -1/1 4", "f 1//2 2 3", "f",
     "o floor", "g chair", "usemtl m", "mtllib m.mtl", "mtllib", "v 1", "f 1 2 99999999999999", "vt nan nan",
     "\x00 \ud800"]
)  # fmt: skip


@settings(max_examples=60)
@given(st.lists(LINES, max_size=12))
@example(["v 0 0 0", "v 0 0 0", "v 1", "f 1 2 3"])
@example(["v 0 0 0", "v 1 0 0", "v 0 1 0", "vt", "vt 1", "f 1/1 2/2 3/1"])
def test_any_lines_of_an_obj_file_give_surfaces_or_one_line(
    tmp_path_factory: pytest.TempPathFactory, lines: list[str]
) -> None:
    file = tmp_path_factory.getbasetemp() / "any.obj"
    file.write_text("\n".join(lines), errors="replace")
    require_result_or_one_line(lambda: read_obj(file, texture_px=16, losses=Losses().changes), "any.obj")


def test_a_home_has_few_objects(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mesh_house, "MAX_OBJECTS", 3)
    lines = ["v 0 0 0", "v 3 0 0", "v 3 0 3", *(f"o part{number}\nf 1 2 3" for number in range(4))]
    (tmp_path / "home.obj").write_text("\n".join(lines))
    with pytest.raises(HouseError, match="it has 4 objects; at most 3 are allowed"):
        import_mesh(tmp_path / "home.obj", rules={}, up="y", config=MeshConfig())


def test_files_outside_of_the_folder_are_not_hashed_and_a_broken_one_ends_no_import(tmp_path: Path) -> None:
    folder = tmp_path / "homes"
    folder.mkdir()
    (tmp_path / "large.bin").write_bytes(b"x")
    (folder / "inside.bin").write_bytes(b"x")
    uris = ["../large.bin", str(tmp_path / "large.bin"), "a\0b", "inside.bin"]
    (folder / "a.gltf").write_text(json.dumps({"buffers": [{"uri": uri} for uri in uris]}))
    assert [part.name for part in files_of(folder / "a.gltf")] == ["inside.bin"]
    (folder / "b.glb").mkdir()
    works = list(file_works([folder / "b.glb", folder / "a.gltf"], files_of))
    assert [work.name for work in works] == ["b", "a"]


def test_a_picture_that_is_refused_is_reported_and_the_home_is_kept(tmp_path: Path) -> None:
    (tmp_path / "home.mtl").write_text("newmtl a\nmap_Kd a.png\nnewmtl b\nmap_Kd b.png\n")
    (tmp_path / "a.png").write_bytes(b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 8 8\n")
    (tmp_path / "b.png").write_bytes(cv2.imencode(".png", np.full((8, 8, 3), 200, np.uint8))[1].tobytes()[:60])
    corners = "v 0 0 0\nv 3 0 0\nv 3 0 3\nvt 0 0\n"
    (tmp_path / "home.obj").write_text(f"mtllib home.mtl\n{corners}usemtl a\nf 1/1 3/1 2/1\nusemtl b\nf 1/1 3/1 2/1\n")
    losses = Counter[str]()
    read = read_obj(tmp_path / "home.obj", texture_px=64, losses=losses)
    assert [surface.paint.picture for surface in read] == [None, None]
    assert sorted(losses) == [
        "Picture 'a.png' has an unsupported format; use PNG, JPEG, WebP, BMP, GIF. It was left out.",
        "Picture 'b.png' is damaged and cannot be read. It was left out.",
    ]


def _made(source: Path) -> Made:
    if source.stem == "b":
        raise RecursionError("maximum recursion depth exceeded\nin a file of somebody")
    return Made({"house": source.stem, "rooms": 1, "area_m2": 9.0, **Losses().as_json()})


def test_an_error_that_nobody_expected_is_named_and_the_other_homes_are_imported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    works = [Work(name, b"", Path(name)) for name in ("a", "b", "c")]
    assert import_all(ImportArgs(out=tmp_path, pictures=0), works, _made, total=3, options="") == 1
    printed = capsys.readouterr()
    assert "b: left out: it cannot be imported (RecursionError: maximum recursion depth exceeded in a" in printed.err
    assert "2 houses with 2 rooms" in printed.out


def test_an_import_that_was_stopped_goes_on_with_the_houses_that_are_left(tmp_path: Path) -> None:
    tried = list[str]()

    def stopped(source: Path) -> Made:
        tried.append(source.stem)
        if tried == ["a", "c"]:
            raise KeyboardInterrupt
        (tmp_path / f"{source.stem}.xml").touch()
        return _made(source)

    works = [Work(name, b"", Path(name)) for name in ("a", "c")]
    with pytest.raises(KeyboardInterrupt):
        import_all(ImportArgs(out=tmp_path, pictures=0), works, stopped, total=2, options="")
    assert import_all(ImportArgs(out=tmp_path, pictures=0), works, stopped, total=2, options="") == 0
    assert tried == ["a", "c", "c"]


def test_the_time_left_is_said_while_homes_are_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(folder, "PROGRESS_S", -1.0)
    works = [Work(name, b"", Path(name)) for name in ("a", "c")]
    import_all(ImportArgs(out=tmp_path, pictures=0), works, _made, total=2, options="")
    assert [line for line in capsys.readouterr().out.splitlines() if "left." in line] == [
        "1 house, about 0 min 0 s left."
    ]


@pytest.mark.costly
@pytest.mark.parametrize(("given", "works"), [("auto", True), ("z", True), ("y", False)])
def test_a_room_whose_file_has_z_up_is_turned_if_it_has_no_floor_otherwise(
    given: str, works: bool, tmp_path: Path
) -> None:
    room = trimesh.Scene()
    boxes = {"floor": ((5, 4, 0.1), (0, 0, -0.05)), "sofa": ((1.8, 0.8, 0.7), (0, 1.4, 0.35))}
    boxes |= {f"wall_{y}": ((5, 0.1, 2.6), (0, y, 1.3)) for y in (-2, 2)}
    boxes |= {f"wall_x{x}": ((0.1, 4, 2.6), (x, 0, 1.3)) for x in (-2.5, 2.5)}
    for name, (size, place) in boxes.items():
        box = trimesh.creation.box(size)
        box.apply_translation(place)
        room.add_geometry(box, node_name=name, geom_name=name)
    room.export(tmp_path / "room.glb")
    if not works:
        with pytest.raises(HouseError, match="no level floor"):
            import_mesh(tmp_path / "room.glb", rules={}, up=given, config=MeshConfig())  # type: ignore[arg-type]
        return
    scene = import_mesh(tmp_path / "room.glb", rules={}, up=given, config=MeshConfig())  # type: ignore[arg-type]
    assert ("z points up, not y" in str(scene.house.report)) == (given == "auto")


def test_folders_without_meshes_of_their_own_are_searched(tmp_path: Path) -> None:
    for name in ("b/home.glb", "a/deep/flat.PLY", "a/notes.txt"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes(b"")
    assert find_files(tmp_path) == [tmp_path / "a/deep/flat.PLY", tmp_path / "b/home.glb"]
    (tmp_path / "b/c.glb").write_bytes(b"")
    (tmp_path / "a/home.glb").write_bytes(b"")  # in the sorted list, another file lies between the two homes
    with pytest.raises(ConfigError, match="2 homes of the name 'home'"):
        find_files(tmp_path)
    (tmp_path / "own.obj").write_bytes(b"")
    assert find_files(tmp_path) == [tmp_path / "own.obj"]


@pytest.mark.costly
def test_a_home_without_a_goal_says_what_it_has_and_where_a_person_can_drive(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rules = tmp_path / "rules.json"
    kinds = {"wall": "wall", "floor": "floor", "door": "door", "": "objects"}
    rules.write_text(json.dumps({f"(?i){name}": kind for name, kind in kinds.items()}))
    out = tmp_path / "out"
    assert command.main(command.Args(path=write_glb(tmp_path), categories=rules, out=out, pictures=1)) == 0
    printed = " ".join(capsys.readouterr().out.split())
    there_is = "It has: wall, floor, objects"
    assert f"flat has no object of a goal category. {there_is}" in printed
    assert f"web --house {out / 'flat.xml'}" in printed
    with pytest.raises(EpisodeError, match=there_is):
        episodes.main(cli.parse(episodes.Args, ["--split", str(out)]))
