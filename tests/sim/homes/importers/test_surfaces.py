"""Triangles become visual meshes that show the same, collision geoms that leave doorways open, and flat floors."""

from __future__ import annotations

import base64
import contextlib
import io
import json
import os
import struct
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.core.errors import HouseError
from sim.homes.importers import collision, surfaces
from sim.homes.importers.collision import CELL_M, collision_boxes, convex_parts, joined_cells
from sim.homes.importers.floors import find_levels, make_storeys
from sim.homes.importers.surfaces import Paint, Surface, read_surfaces
from sim.homes.importers.visual import make_skins, pixels_at, samples, spacing_within
from tests.helpers import wording
from tests.helpers.scanned import DOOR_Y_M, PIECES, Mesh, Piece, painted, triangles_of, trimesh, uneven

WALLS = next(piece for piece in PIECES if piece.kind == "wall")
INNER_WALL = Piece("wall", 0, WALLS.boxes[3:], WALLS.rgb)


def surface_of(mesh: Mesh, paint: Paint | None = None) -> Surface:
    return Surface("", "", np.asarray(mesh.vertices), np.asarray(mesh.faces, dtype=np.int32), paint or Paint())


def doorway_m(boxes: np.ndarray) -> float:
    """Returns the width in y that boxes leave free at x = 4, below 0.9 m."""
    there = boxes[(boxes[:, 0] < 4.1) & (boxes[:, 3] > 3.9) & (boxes[:, 2] < 0.9)]
    below = there[there[:, 4] < np.mean(DOOR_Y_M), 4].max()
    return float(there[there[:, 1] > np.mean(DOOR_Y_M), 1].min() - below)


def test_boxes_contain_the_surface_and_leave_a_doorway_its_width() -> None:
    mesh = triangles_of(INNER_WALL, edge_m=0.5)
    corners = np.asarray(mesh.triangles)
    boxes = collision_boxes(corners)
    assert doorway_m(boxes) == pytest.approx(DOOR_Y_M[1] - DOOR_Y_M[0], abs=0.006)  # boxes are at least 1 cm thick
    scan = uneven(np.asarray(mesh.vertices))[mesh.faces]
    boxes = collision_boxes(scan)
    assert doorway_m(boxes) > DOOR_Y_M[1] - DOOR_Y_M[0] - 0.03
    assert len(boxes) < 30  # the grid is placed so that the noise does not spread a wall over two layers
    points = samples(scan[::7], CELL_M)[0]
    inside = np.all((points[:, None] >= boxes[:, :3] - 2e-4) & (points[:, None] <= boxes[:, 3:] + 2e-4), axis=2)
    assert np.asarray(inside).any(axis=1).mean() > 0.995


def test_the_inside_of_furniture_is_filled_and_that_of_walls_is_not() -> None:
    corners = np.asarray(trimesh.creation.box(bounds=[[0, 0, 0], [1, 1, 0.5]]).triangles)
    hollow, filled = (collision_boxes(corners, is_filled=is_filled) for is_filled in (False, True))
    assert filled.tolist() == [[0.0, 0.0, 0.0, 1.0, 1.0, 0.5]]
    middle = np.array([0.5, 0.5, 0.25])
    assert not ((hollow[:, :3] < middle) & (middle < hollow[:, 3:])).all(axis=1).any()


def test_the_inside_of_a_skirting_board_is_free() -> None:
    sides = (((0, 0, 0), (4, 0.02, 0.1)), ((0, 3.98, 0), (4, 4, 0.1)),
             ((0, 0, 0), (0.02, 4, 0.1)), ((3.98, 0, 0), (4, 4, 0.1)))  # fmt: skip
    ring = triangles_of(Piece("skirting", 0, sides, (0, 0, 0)))
    boxes, middle = collision_boxes(np.asarray(ring.triangles), is_filled=True), np.array([2, 2, 0.05])
    assert not ((boxes[:, :3] < middle) & (middle < boxes[:, 3:])).all(axis=1).any()


@settings(max_examples=25)
@given(st.integers(0, 2**32 - 1), st.floats(0.1, 0.9))
def test_joined_cells_cover_the_filled_cells_once_and_nothing_else(seed: int, share: float) -> None:
    filled = np.random.default_rng(seed).random((5, 6, 4)) < share
    ranges, of_cell = joined_cells(filled)
    count = np.zeros(filled.shape, dtype=int)
    for x0, y0, z0, x1, y1, z1 in ranges.tolist():
        count[x0:x1, y0:y1, z0:z1] += 1
    assert np.array_equal(count, filled)
    assert np.array_equal(of_cell >= 0, filled)


def test_convex_parts_leave_the_gap_of_a_frame_open() -> None:
    pytest.importorskip("coacd")
    posts = [trimesh.creation.box(bounds=box) for box in (((0, 0, 0), (0.1, 0.4, 1)), ((0, 1.2, 0), (0.1, 1.6, 1)))]
    parts = convex_parts([surface_of(trimesh.util.concatenate(posts))])
    assert sorted(round(float(part[:, 1].max()), 2) for part in parts) == pytest.approx([0.4, 1.6], abs=0.03)


def test_a_surface_within_its_budget_keeps_picture_and_triangles() -> None:
    picture = np.full((4, 4, 3), 7, np.uint8)
    mesh = trimesh.creation.box()
    skin = make_skins([surface_of(mesh, Paint(picture=picture, uv=np.zeros((8, 2))))], 100, 64)[0]
    assert skin.picture is picture
    assert len(skin.faces) == 12


def test_a_reduced_surface_shows_its_colours_where_they_were() -> None:
    mesh = trimesh.creation.icosphere(subdivisions=4, radius=0.5)
    rgb = np.where(mesh.vertices[:, 2:] > 0, [200, 30, 30], [30, 30, 200]).astype(np.uint8)
    skin = make_skins([surface_of(mesh, Paint((1.0, 1.0, 1.0, 1.0), vertex_rgb=rgb))], 300, 256)[0]
    assert 200 < len(skin.faces) <= 400
    assert skin.uv is not None
    assert skin.picture is not None
    middle, shown = skin.vertices_m[skin.faces].mean(axis=1), pixels_at(skin.picture, skin.uv[skin.faces].mean(axis=1))
    clear = np.abs(middle[:, 2]) > 0.1
    assert np.array_equal(shown[clear, 0] > 128, middle[clear, 2] > 0)


def test_an_uneven_floor_with_a_hole_becomes_one_flat_level() -> None:
    mesh = trimesh.Trimesh(*trimesh.remesh.subdivide_to_size(
        np.array([[0, 0, 1], [4, 0, 1], [4, 3, 1], [0, 3, 1.0]]), np.array([[0, 1, 2], [0, 2, 3]]), 0.3
    ), process=False)  # fmt: skip
    corners = uneven(np.asarray(mesh.vertices))[mesh.faces]
    middle = corners.mean(axis=1)
    holed = corners[~((np.abs(middle[:, :2] - (2, 1.5)) < 0.7).all(axis=1))]
    (level,) = find_levels(holed)
    assert level == pytest.approx(1.0, abs=0.01)
    (storey,) = make_storeys([level], holed, np.zeros((0, 3, 3)))
    assert storey.floor.area_m2 == pytest.approx(12.0, rel=0.04)
    with pytest.raises(HouseError, match=wording.NO_LEVEL_FLOOR):
        find_levels(corners[:3])


# ---- reading ---------------------------------------------------------------------------------------------------------


def glb(header: dict[str, Any], data: bytes = b"") -> bytes:
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(data), b"BIN\0") + data if data else b""
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


TRIANGLE = {
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36}],
}  # fmt: skip
CORNERS = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)


@pytest.mark.parametrize(
    ("changed", "data", "reason"),
    [
        ({"nodes": [{"mesh": 0, "children": [1]}, {"children": [0]}]}, CORNERS, wording.ITS_NODES_FORM_A_LOOP),
        ({"nodes": [{"mesh": 0, "children": [7]}]}, CORNERS, wording.A_CHILD_THAT_DOES_NOT_EXIST),
        ({"nodes": [{"children": [2]}, {"children": [2]}, {"mesh": 0}]}, CORNERS, wording.THE_CHILD_OF_SEVERAL),
        ({"buffers": [{"byteLength": 36, "uri": "../../secret.bin"}]}, b"", wording.OUTSIDE_OF_ITS_FOLDER),
        ({"extensionsRequired": ["KHR_draco_mesh_compression"]}, CORNERS, "compressed by Draco"),
        ({"nodes": []}, CORNERS, "x.glb"),
        ({}, CORNERS[:-4] + struct.pack("<f", np.nan), "not finite"),
        ({}, CORNERS[:-4] + struct.pack("<f", 1e9), "beyond 2000 m"),
    ],
)
def test_hostile_meshes_are_one_line(changed: dict[str, Any], data: bytes, reason: str, tmp_path: Path) -> None:
    file = tmp_path / "scene" / "x.glb"
    file.parent.mkdir()
    (tmp_path / "secret.bin").write_bytes(CORNERS)
    file.write_bytes(glb({**TRIANGLE, **changed}, data))
    with pytest.raises(HouseError, match=reason) as caught:
        read_surfaces(file)
    assert "\n" not in str(caught.value)
    assert "scene" in str(caught.value)


def test_a_triangle_is_read_and_turned_upright(tmp_path: Path) -> None:
    (tmp_path / "x.glb").write_bytes(glb(TRIANGLE, CORNERS))
    surface = read_surfaces(tmp_path / "x.glb", up="y")[0]
    assert surface.corners_m.tolist() == [[[0, 0, 0], [1, 0, 0], [0, 0, 1]]]


def test_a_node_of_several_materials_is_one_node_with_the_name_of_the_file(tmp_path: Path) -> None:
    part = {"attributes": {"POSITION": 0}}
    named = {
        "scenes": [{"nodes": [0, 1, 3]}], "meshes": [{"name": "stool", "primitives": [part, part]}],
        "nodes": [{"name": "Sofa", "mesh": 0}, {"name": "Lamp", "children": [2]}, {"name": "Lamp_00abcd", "mesh": 0},
                  {"mesh": 0}],
    }  # fmt: skip
    (tmp_path / "x.glb").write_bytes(glb({**TRIANGLE, **named}, CORNERS))
    nodes = Counter(surface.node for surface in read_surfaces(tmp_path / "x.glb"))
    assert nodes == {"Sofa": 2, "Lamp_00abcd": 2, "stool_3": 2}


@pytest.mark.parametrize(("mode", "opacity"), [({}, 1.0), ({"alphaMode": "BLEND"}, 0.2)])
def test_only_materials_that_blend_are_transparent(mode: dict[str, str], opacity: float, tmp_path: Path) -> None:
    material = {"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 0.2]}, **mode}
    meshes = [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}]
    (tmp_path / "x.glb").write_bytes(glb({**TRIANGLE, "materials": [material], "meshes": meshes}, CORNERS))
    assert read_surfaces(tmp_path / "x.glb")[0].paint.rgba == pytest.approx((1.0, 0.0, 0.0, opacity))


def test_pictures_that_a_file_moves_are_reported(tmp_path: Path) -> None:
    (tmp_path / "x.glb").write_bytes(glb({**TRIANGLE, "extensionsUsed": ["KHR_texture_transform"]}, CORNERS))
    losses = Counter[str]()
    read_surfaces(tmp_path / "x.glb", losses=losses)
    assert "moves or scales its pictures" in str(losses)


def test_parts_by_material_belong_to_the_object_above_them(tmp_path: Path) -> None:
    named = {
        "nodes": [{"name": "Chair_0", "children": [1, 2]}, {"name": "Object_1", "mesh": 0},
                  {"name": "Object_2", "mesh": 0}, {"name": "Sofa", "children": [4, 5]},
                  {"name": "Sofa_Red_0", "mesh": 0}, {"name": "Sofa_cushion", "mesh": 0},
                  {"name": "Root", "children": [7]}, {"name": "Object_9", "mesh": 0}],
        "scenes": [{"nodes": [0, 3, 6]}], "materials": [{"name": "Red"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
    }  # fmt: skip
    (tmp_path / "x.glb").write_bytes(glb({**TRIANGLE, **named}, CORNERS))
    nodes = Counter(surface.node for surface in read_surfaces(tmp_path / "x.glb"))
    assert nodes == {"Chair_0": 2, "Sofa": 1, "Sofa_cushion": 1, "Object_9": 1}


@settings(max_examples=25)
@given(st.data())
def test_any_bytes_are_surfaces_or_one_line(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    content = bytearray(glb(TRIANGLE, CORNERS))
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    file = tmp_path_factory.mktemp("any") / "x.glb"
    file.write_bytes(bytes(content[: data.draw(st.integers(0, len(content)))]))
    fault, found = "", []
    try:
        found = read_surfaces(file)
    except HouseError as error:
        fault = str(error)
    assert all(np.isfinite(surface.vertices_m).all() for surface in found)
    assert "\n" not in fault
    assert "x.glb" in fault or found


def test_pictures_of_a_mesh_are_read_once_and_reduced(tmp_path: Path) -> None:
    scene = trimesh.Scene([painted(triangles_of(PIECES[0]), (200, 100, 50))])
    scene.export(tmp_path / "x.glb")
    (surface,) = read_surfaces(tmp_path / "x.glb", texture_px=16)
    assert surface.paint.picture is not None
    assert surface.paint.picture.shape == (16, 16, 3)
    assert surface.paint.picture[8, 8].tolist() == [200, 100, 50]


# ---- pictures that are no pictures -----------------------------------------------------------------------------------


def eps(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[bytes, Path]:
    """Returns an EPS picture, and the file that exists when Ghostscript has been started."""
    started = tmp_path / "started"
    program = tmp_path / "bin" / "gs"
    program.parent.mkdir()
    program.write_text(f"#!/bin/sh\ntouch {started}\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{program.parent}:{os.environ['PATH']}")
    monkeypatch.setattr("PIL.EpsImagePlugin.gs_binary", None)
    content = io.BytesIO()
    PIL.Image.new("RGB", (8, 8)).save(content, "EPS")
    with contextlib.suppress(OSError):
        PIL.Image.open(io.BytesIO(content.getvalue())).load()
    assert started.exists(), "Pillow would start the program"
    started.unlink()
    return content.getvalue(), started


def pictured(image: dict[str, Any], data: bytes) -> bytes:
    """Returns a GLB file of a triangle with a picture, whose bytes may be the second buffer view."""
    header = {
        **TRIANGLE, "images": [image], "textures": [{"source": 0}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
        "accessors": [*TRIANGLE["accessors"], {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC2"}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": len(data)}
        ],
        "buffers": [{"byteLength": 36 + len(data)}],
    }  # fmt: skip
    return glb(header, CORNERS + data + b"\0" * (-len(data) % 4))


@pytest.mark.parametrize("kind", ["png", "jpeg"])
@pytest.mark.parametrize("source", ["view", "data", "file"])
def test_a_picture_in_postscript_starts_no_program_and_is_reported(
    source: str, kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    content, started = eps(tmp_path, monkeypatch)
    (tmp_path / "a.eps").write_bytes(content)
    image: dict[str, Any] = {
        "view": {"bufferView": 1}, "data": {"uri": f"data:image/{kind};base64,{base64.b64encode(content).decode()}"},
        "file": {"uri": "a.eps"},
    }[source]  # fmt: skip
    (tmp_path / "x.glb").write_bytes(pictured({**image, "mimeType": f"image/{kind}"}, content))
    losses = Counter[str]()
    (surface,) = read_surfaces(tmp_path / "x.glb", texture_px=16, losses=losses)
    assert not started.exists()
    assert surface.paint.picture is None
    assert list(losses) == ["A picture has an unsupported format; use PNG, JPEG, WebP, BMP, GIF."]


def test_a_damaged_picture_is_reported_and_the_mesh_is_kept(tmp_path: Path) -> None:
    content = io.BytesIO()
    PIL.Image.fromarray(np.random.default_rng(0).integers(0, 255, (64, 64, 3), np.uint8)).save(content, "PNG")
    losses = Counter[str]()
    (tmp_path / "x.glb").write_bytes(pictured({"bufferView": 1}, content.getvalue()[:-4000]))
    (surface,) = read_surfaces(tmp_path / "x.glb", texture_px=16, losses=losses)
    assert surface.paint.picture is None
    assert list(losses) == ["A picture is damaged and cannot be read."]


@pytest.mark.costly
def test_a_picture_that_a_ply_file_lacks_prints_nothing(tmp_path: Path) -> None:
    (tmp_path / "x.ply").write_text(
        "ply\nformat ascii 1.0\ncomment TextureFile no.png\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
    )
    code = (
        "import sys, pathlib; from sim.homes.importers.surfaces import read_surfaces as read; "
        "print(len(read(pathlib.Path(sys.argv[1]))))"
    )
    words = [sys.executable, "-c", code, str(tmp_path / "x.ply")]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("1\n", "")


# ---- limits ----------------------------------------------------------------------------------------------------------


def test_the_surface_of_an_object_has_few_points_however_large_it_is() -> None:
    garden = np.array([[[0, 0, 0], [100, 0, 0], [100, 100, 0]], [[0, 0, 0], [100, 100, 0], [0, 100, 0.0]]])
    spokes = np.arange(0.0, 6.2, 1e-4)
    rim = np.stack([5 * np.cos(spokes), 5 * np.sin(spokes), 0 * spokes], axis=1)
    fan = np.stack([np.broadcast_to(rim[0], rim[1:-1].shape), rim[1:-1], rim[2:]], axis=1)
    for corners in (garden, fan):
        spacing = spacing_within(corners, 0.025, 500_000)
        assert 0.025 < spacing < 2.0
        count = len(samples(corners, spacing)[0])
        assert 100_000 < count <= 500_000 + 4 * len(corners)
    assert spacing_within(garden[:, :, :] * 0.01, 0.025, 500_000) == 0.025


def test_boxes_of_a_garden_still_contain_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(collision, "MAX_POINTS", 20_000)
    garden = np.array([[[0, 0, 0], [100, 0, 0], [100, 100, 0]], [[0, 0, 0], [100, 100, 0], [0, 100, 0.0]]])
    boxes = collision_boxes(garden)
    assert boxes[:, :2].min() == 0.0
    assert boxes[:, 3:5].max() == 100.0


@pytest.mark.parametrize(
    "changed",
    [
        {"accessors": [{"componentType": 5126, "count": 60_000_000, "type": "VEC3"}]},
        {"accessors": [{"componentType": 5126, "count": 1_000, "type": "MAT4"}]},
        {
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}] * 5_000}],
            "accessors": [{"componentType": 5126, "count": 1_000, "type": "VEC3"}],
        },
    ],
)
def test_a_gltf_file_has_few_numbers_for_its_bytes(changed: dict[str, Any], tmp_path: Path) -> None:
    (tmp_path / "x.glb").write_bytes(glb({**TRIANGLE, **changed}, CORNERS))
    with pytest.raises(HouseError, match=r"announces more than [\d,]+ numbers, the limit for [\d,]+ bytes"):
        read_surfaces(tmp_path / "x.glb")


def test_triangles_and_vertices_count_for_each_node(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(surfaces, "MAX_TRIANGLES", 100)
    nodes = {"scenes": [{"nodes": list(range(50))}], "nodes": [{"mesh": 0}] * 50}
    (tmp_path / "x.glb").write_bytes(glb({**TRIANGLE, **nodes}, CORNERS))
    with pytest.raises(HouseError, match="more than 100 triangles or vertices"):
        read_surfaces(tmp_path / "x.glb")
    (tmp_path / "y.glb").write_bytes(glb({**TRIANGLE, "nodes": [{"mesh": 0}] * 20_001}, CORNERS))
    with pytest.raises(HouseError, match="nodes"):
        read_surfaces(tmp_path / "y.glb")


PLY = "ply\nformat {} 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"


@pytest.mark.parametrize("kind", ["ascii", "binary_little_endian"])
def test_a_face_of_a_ply_file_has_few_vertices(kind: str, tmp_path: Path) -> None:
    head = PLY.format(kind) + "property list uint uint vertex_indices\nend_header\n"
    corners, numbers = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32), np.arange(100_000, dtype="<u4") % 3
    if kind == "ascii":
        lines = [" ".join(map(str, row)) for row in (*corners.tolist(), [100_000, *numbers.tolist()])]
        body = "\n".join(lines).encode() + b"\n"
    else:
        body = corners.tobytes() + struct.pack("<I", 100_000) + numbers.tobytes()
    (tmp_path / "x.ply").write_bytes(head.encode() + body)
    with pytest.raises(HouseError, match="a face with more than 10,000 vertices"):
        read_surfaces(tmp_path / "x.ply")


def test_a_broken_node_is_named_and_left_out_and_the_others_are_kept(tmp_path: Path) -> None:
    header = {
        **TRIANGLE, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "name": "chair"}, {"mesh": 0, "name": "sky", "translation": [9e4, 0, 0]}],
    }  # fmt: skip
    (tmp_path / "x.glb").write_bytes(glb(header, CORNERS))
    losses = Counter[str]()
    (surface,) = read_surfaces(tmp_path / "x.glb", losses=losses)
    assert surface.node == "chair"
    assert list(losses) == ["'sky' was left out: a vertex is not finite or beyond 2000 m."]
