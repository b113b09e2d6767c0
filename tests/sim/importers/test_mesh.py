"""A home that is one mesh gets objects by the names of its nodes, a flat floor, and walls that leave its door open."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import trimesh
from hypothesis import example, given, settings
from hypothesis import strategies as st

from sim.commands.importing import mesh as command
from sim.errors import ConfigError, HouseError
from sim.gl import mujoco
from sim.houses.house import House, read_rooms
from sim.houses.labels import read_labels
from sim.houses.load import load_house
from sim.importers.losses import Losses
from sim.importers.mesh import find_files, import_mesh
from sim.importers.mesh_house import MeshConfig
from sim.importers.obj import read_obj
from sim.world.check import check_own_house
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
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    (bed,) = read_labels(model, ignore_prefix="").of_category("bed")
    boxes = [geom for geom in bed.geom_ids if model.geom_group[geom] == 3]
    low = (data.geom_xpos[boxes] - model.geom_size[boxes]).min(axis=0)
    high = (data.geom_xpos[boxes] + model.geom_size[boxes]).max(axis=0)
    assert low == pytest.approx([6.0, 2.4, 0.0], abs=0.06)
    assert high == pytest.approx([7.9, 3.9, 0.5], abs=0.06)
    assert sum(room.area_m2 for room in read_rooms(model)) == pytest.approx(32.0, abs=1.5)


def test_the_robot_passes_the_door(split: Path) -> None:
    assert check_own_house(load_house(split / "flat.xml"))[0] == []


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


def test_an_obj_file_keeps_its_objects_and_colours(tmp_path: Path) -> None:
    file = write_obj(tmp_path)
    surfaces = read_obj(file, texture_px=64, losses=Losses().changes)
    assert [each.node for each in surfaces] == [f"{p.kind.replace(' ', '_')}.{n}" for n, p in enumerate(PIECES)]
    assert surfaces[1].paint.rgba == (0.0, 0.0, 1.0, 1.0)
    scene = import_mesh(file, rules={}, up="z", config=MeshConfig())
    assert scene.house.report["furniture"]["chair"] == 1


def test_a_home_in_one_node_gets_a_floor_and_walls(tmp_path: Path) -> None:
    whole = trimesh.util.concatenate(
        [triangles_of(piece, edge_m=0.5) for piece in PIECES if piece.kind in ("floor", "wall")]
    )
    whole.export(tmp_path / "scan.ply")
    scene = import_mesh(tmp_path / "scan.ply", rules={}, up="auto", config=MeshConfig())
    assert scene.house.report["area_m2"] == pytest.approx(32.0, abs=2.0)
    assert any("level triangles of the walls" in each for each in scene.house.report["changes"])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("f 1 2 3", "line 1: .*vertex 1 does not exist"),
        ("v 0 0 0\nv x 0 0", "line 2"),
        ("v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3", "not finite"),
        ("v 0 0 0", "has no triangles"),
        ("mtllib ../other.mtl", "outside of its folder"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3", "no level floor"),
        ("v 0 0 0\nv 1 0 0\nf 1 2", "three vertices"),
    ],
)
def test_a_broken_file_is_one_line_with_file_and_place(text: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "home.obj").write_text(text)
    with pytest.raises(HouseError, match=message) as caught:
        import_mesh(tmp_path / "home.obj", rules={}, up="auto", config=MeshConfig())
    assert str(tmp_path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_folder_without_meshes_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="has no file of a home"):
        find_files(tmp_path)


LINES = st.sampled_from(
    ["v 0 0 0", "v 9 0 0", "v 9 9 0", "v 1e3 0 2", "vt 0 1", "f 1 2 3", "f 1/1 2/1 -1/1 4", "f 1//2 2 3", "f",
     "o floor", "g chair", "usemtl m", "mtllib m.mtl", "mtllib", "v 1", "f 1 2 99999999999999", "vt nan nan",
     "\x00 \ud800"]
)  # fmt: skip


@settings(max_examples=60, deadline=None)
@given(st.lists(LINES, max_size=12))
@example(["v 0 0 0", "v 0 0 0", "v 1", "f 1 2 3"])
@example(["v 0 0 0", "v 1 0 0", "v 0 1 0", "vt", "vt 1", "f 1/1 2/2 3/1"])
def test_any_lines_of_an_obj_file_give_surfaces_or_one_line(
    tmp_path_factory: pytest.TempPathFactory, lines: list[str]
) -> None:
    file = tmp_path_factory.getbasetemp() / "any.obj"
    file.write_text("\n".join(lines), errors="replace")
    fault = ""
    try:
        read_obj(file, texture_px=16, losses=Losses().changes)
    except HouseError as error:
        fault = str(error)
    assert "\n" not in fault
    assert "any.obj" in fault or not fault
