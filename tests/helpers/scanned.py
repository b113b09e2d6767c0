"""A home of two rooms as triangles, written here by the rules of the data sets of Habitat, z up.

The rooms are x = 0 to 4 and x = 4 to 8, both y = 0 to 4; between them is a wall of 10 cm with a doorway of 80 cm at
y = 1.6 to 2.4. In the eastern room are a bed and a plant, in the western one a table, a chair and a picture.
"""

from __future__ import annotations

import gzip
import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from sim.homes.housegen.imported.scene_files import library

trimesh = library("trimesh")
Mesh: TypeAlias = Any
Box = tuple[tuple[float, float, float], tuple[float, float, float]]
DOOR_Y_M = (1.6, 2.4)
CEILING_M = 2.5


@dataclass(frozen=True)
class Piece:
    """An object: the name of its type, its room and its boxes, lowest and highest corner, metres."""

    kind: str
    room: int
    boxes: tuple[Box, ...]
    rgb: tuple[int, int, int]


PIECES = (
    Piece("floor", 0, (((0, 0, -0.1), (4, 4, 0)),), (150, 110, 70)),
    Piece("floor", 1, (((4, 0, -0.1), (8, 4, 0)),), (120, 120, 130)),
    Piece("ceiling", 0, (((0, 0, CEILING_M), (8, 4, CEILING_M + 0.1)),), (240, 240, 240)),
    Piece("wall", 0, (
        ((-0.1, -0.1, 0), (0, 4.1, CEILING_M)), ((0, -0.1, 0), (8, 0, CEILING_M)), ((0, 4, 0), (8, 4.1, CEILING_M)),
        ((3.95, 0, 0), (4.05, DOOR_Y_M[0], CEILING_M)), ((3.95, DOOR_Y_M[1], 0), (4.05, 4, CEILING_M)),
        ((3.95, DOOR_Y_M[0], 2.1), (4.05, DOOR_Y_M[1], CEILING_M)),
    ), (210, 205, 190)),
    Piece("wall", 1, (((8, -0.1, 0), (8.1, 4.1, CEILING_M)),), (200, 210, 190)),
    Piece("bed", 1, (((6, 2.4, 0), (7.9, 3.9, 0.5)),), (60, 80, 160)),
    Piece("potted plant", 1, (((7.4, 0.2, 0), (7.8, 0.6, 1.2)),), (40, 140, 50)),
    Piece("table", 0, (
        ((0.4, 0.4, 0.7), (1.6, 1.2, 0.75)), ((0.4, 0.4, 0), (0.46, 0.46, 0.7)), ((1.54, 0.4, 0), (1.6, 0.46, 0.7)),
        ((0.4, 1.14, 0), (0.46, 1.2, 0.7)), ((1.54, 1.14, 0), (1.6, 1.2, 0.7)),
    ), (140, 90, 50)),
    Piece("office chair", 0, (((0.7, 1.4, 0), (1.2, 1.9, 0.45)), ((0.7, 1.85, 0.45), (1.2, 1.9, 0.9))), (170, 50, 50)),
    Piece("picture", 0, (((1.6, 3.96, 1.2), (2.4, 3.99, 1.8)),), (200, 160, 60)),
)  # fmt: skip


Y_UP = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])


def triangles_of(piece: Piece, *, edge_m: float = 10.0) -> Mesh:
    """Returns a piece as triangles with edges of at most `edge_m`."""
    made = trimesh.util.concatenate([trimesh.creation.box(bounds=np.array(box)) for box in piece.boxes])
    vertices, faces = trimesh.remesh.subdivide_to_size(made.vertices, made.faces, edge_m, max_iter=12)
    return trimesh.Trimesh(vertices, faces, process=False)


def painted(mesh: Mesh, rgb: tuple[int, int, int]) -> Mesh:
    """Returns a mesh with a picture: its colour with darker lines every metre, and texture coordinates."""
    pixels = np.full((64, 64, 3), rgb, np.uint8)
    pixels[:4], pixels[:, :4] = np.array(rgb) // 2, np.array(rgb) // 2
    corners = np.asarray(mesh.triangles)
    normal = np.abs(np.asarray(mesh.face_normals)).argmax(axis=1)
    axes = np.array([[1, 2], [0, 2], [0, 1]])[normal]
    uv = np.take_along_axis(corners, axes[:, None].repeat(3, axis=1), axis=2).reshape(-1, 2)
    flat = trimesh.Trimesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), process=False)
    material = trimesh.visual.material.PBRMaterial(baseColorTexture=Image.fromarray(pixels))
    flat.visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
    return flat


def uneven(vertices_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns vertices with the noise of a scan, 1 cm, the same for equal vertices."""
    x, y, z = vertices_m.T
    return vertices_m + 0.01 * np.stack([np.sin(7 * y + 5 * z), np.sin(6 * x + 4 * z), np.sin(5 * x + 3 * y)], axis=1)


def write_hm3d(folder: Path, *, name: str = "00800-two", edge_m: float = 10.0, pictures: bool = True) -> Path:
    """Writes a scan by the rules of HM3D, with the colours of instances in pictures or at vertices; returns its folder.

    The first line of the text is the header; instance n has the colour n * 0x010203; `unknown` has no category.
    """
    stem = name.partition("-")[2]
    place = folder / name
    place.mkdir(parents=True, exist_ok=True)
    shown, semantic, lines = trimesh.Scene(), trimesh.Scene(), ["HM3D Semantic Annotations"]
    for number, piece in enumerate(PIECES, start=1):
        mesh = triangles_of(piece, edge_m=edge_m)
        if edge_m < 5.0:
            mesh.vertices = uneven(np.asarray(mesh.vertices))
        shown.add_geometry(painted(mesh, piece.rgb), node_name=f"chunk_{number}")
        red, green, blue = number, 2 * number, 3 * number
        lines.append(f'{number},{red:02X}{green:02X}{blue:02X},"{piece.kind}",{piece.room}')
        coloured = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
        if pictures:
            coloured = painted(coloured, (red, green, blue))
            coloured.visual.material.baseColorTexture = Image.new("RGB", (8, 8), (red, green, blue))
        else:
            coloured.visual.vertex_colors = [red, green, blue, 255]
        semantic.add_geometry(coloured)
    shown.export(place / f"{stem}.glb")
    semantic.export(place / f"{stem}.semantic.glb")
    (place / f"{stem}.semantic.txt").write_text("\n".join([*lines, '99,0A0A0A,"unknown, or not",0']) + "\n")
    return place


LABELS = {"potted plant": (14, "plant"), "office chair": (3, "chair")}
"""mpcat40 of the pieces whose name is not their category."""


def write_glb(folder: Path, *, names: dict[str, str] | None = None) -> Path:
    """Writes the home of two rooms as a GLB file, y up, a node for each piece."""
    scene = trimesh.Scene()
    for number, piece in enumerate(PIECES):
        name = (names or {}).get(piece.kind, piece.kind.replace(" ", "_"))
        made = triangles_of(piece)
        made.apply_transform(Y_UP)
        scene.add_geometry(made, node_name=f"{name}.{number:03d}", geom_name=f"{name}.{number:03d}")
    folder.mkdir(parents=True, exist_ok=True)
    scene.export(folder / "flat.glb")
    return folder / "flat.glb"


def write_mp3d(folder: Path, *, name: str = "two", edge_m: float = 10.0) -> Path:
    """Writes a scan by the rules of Matterport3D in Habitat's form, a PLY file with `object_id`; returns its folder."""
    place = folder / name
    place.mkdir(parents=True, exist_ok=True)
    vertices, faces, start = [], [], 0
    lines = [
        "ASCII 1.1",
        "H two two 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0",
        "L 0 2 - 0 0 0 0 0 0 8 4 2.5",
    ]
    lines += ["R 0 0 0 0 l 2 2 1 0 0 0 4 4 2.5 2.5 0 0 0 0", "R 1 0 0 0 b 6 2 1 4 0 0 8 4 2.5 2.5 0 0 0 0"]
    for number, piece in enumerate(PIECES):
        ident, label = LABELS.get(piece.kind, (number, piece.kind))
        lines.append(f"C {number} {number} {piece.kind.replace(' ', '#')} {ident} {label} 0 0 0 0 0")
        lines.append(f"O {number} {piece.room} {number} 0 0 0 1 0 0 0 1 0 1 1 1 0 0 0 0 0 0 0 0")
        mesh = triangles_of(piece, edge_m=edge_m)
        points = uneven(np.asarray(mesh.vertices)) if edge_m < 5.0 else np.asarray(mesh.vertices)
        vertices += [struct.pack("<fff3B", *point, *piece.rgb) for point in points.tolist()]
        faces += [struct.pack("<B3ii", 3, *(corner + start for corner in face), number) for face in mesh.faces.tolist()]
        start += len(points)
    head = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float y\n"
        "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nproperty int object_id\nend_header\n"
    )
    (place / f"{name}_semantic.ply").write_bytes(head.encode() + b"".join(vertices) + b"".join(faces))
    (place / f"{name}.house").write_text("\n".join(lines) + "\n")
    return place


def write_dataset(folder: Path, *, scene: dict[str, Any] | None = None) -> Path:
    """Writes a data set of one scene, with the building as its stage and y up; returns the file of the data set.

    The chair is twice in the scene, once turned by 90 degrees at (5, 1), where it can be pushed.
    """
    for name in ("stages", "objects", "scenes", "semantics"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    stage, instances, classes = trimesh.Scene(), [], []
    for number, piece in enumerate(PIECES):
        mesh = painted(triangles_of(piece), piece.rgb)
        if piece.kind in ("floor", "wall", "ceiling"):
            stage.add_geometry(_y_up(mesh), node_name=f"part_{number}")
            continue
        name, middle = f"thing_{number}", 0.5 * (mesh.bounds[0] + mesh.bounds[1])
        middle[2] = mesh.bounds[0][2]
        mesh.apply_translation(-middle)
        trimesh.Scene(_y_up(mesh)).export(folder / "objects" / f"{name}.glb")
        classes.append({"id": number, "name": piece.kind.replace(" ", "_")})
        config = {"render_asset": f"{name}.glb", "semantic_id": number, "mass": 4.0}
        (folder / "objects" / f"{name}.object_config.json").write_text(json.dumps(config))
        x, y, z = middle.tolist()
        placed = {"template_name": f"objects/{name}", "translation_origin": "asset_local", "translation": [x, z, -y]}
        instances.append(placed)
        if piece.kind == "office chair":
            half = 0.5**0.5
            instances.append(
                placed | {"translation": [5, z, -1], "rotation": [half, 0, half, 0], "motion_type": "DYNAMIC"}
            )
    stage.export(folder / "stages" / "home.glb")
    (folder / "stages" / "home.stage_config.json").write_text('{"render_asset": "home.glb"}')
    regions = [
        {"label": kind, "floor_height": 0.0, "extrusion_height": 2.5,
         "poly_loop": [[x, 0, 0], [x + 4, 0, 0], [x + 4, 0, -4], [x, 0, -4]]}
        for kind, x in (("living room", 0), ("bedroom", 4))
    ]  # fmt: skip
    semantics = {"classes": classes, "region_annotations": regions}
    (folder / "semantics" / "names.semantic_config.json").write_text(json.dumps(semantics))
    content = {"stage_instance": {"template_name": "stages/home"}, "object_instances": instances,
               "semantic_scene_instance": "names"}  # fmt: skip
    (folder / "scenes" / "flat.scene_instance.json").write_text(json.dumps(content if scene is None else scene))
    file = folder / "homes.scene_dataset_config.json"
    file.write_text(json.dumps({
        "stages": {"paths": {".json": ["stages"]}}, "objects": {"paths": {".json": ["objects"]}},
        "scene_instances": {"paths": {".json": ["scenes"]}},
        "semantic_scene_descriptor_instances": {"names": "semantics/names.semantic_config.json"},
    }))  # fmt: skip
    return file


def _y_up(mesh: Mesh) -> Mesh:
    """Returns a mesh in a frame whose y points up: (x, y, z) becomes (x, z, -y)."""
    turned = mesh.copy()
    turned.apply_transform(np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1.0]]))
    return turned


def write_episodes(folder: Path, scene: str) -> Path:
    """Writes an episode file as Habitat's, y up, for a scene of this home; returns the file.

    The first two episodes fit; the third starts in the bed, the fourth asks for a goal that is not there, the fifth is
    of another scene. One of the two goals `chair` is where no chair is.
    """
    starts = {"0": ("plant", (1.0, 0.05, -3.0)), "1": ("chair", (5.0, 0.02, -3.0)), "2": ("chair", (7.0, 0.0, -3.2)),
              "3": ("toilet", (1.0, 0.0, -3.0)), "4": ("plant", (1.0, 0.0, -3.0))}  # fmt: skip
    episodes = [
        {"episode_id": ident, "scene_id": f"hm3d/val/{scene}" if ident != "4" else "hm3d/val/x/other.basis.glb",
         "start_position": at, "start_rotation": [0, 0, 0, 1], "object_category": goal,
         "info": {"geodesic_distance": 5.0}}
        for ident, (goal, at) in starts.items()
    ]  # fmt: skip
    file = scene.rpartition("/")[2]
    goals = {f"{file}_plant": [{"position": [7.6, 0.6, -0.4], "object_id": 7, "object_category": "plant"}],
             f"{file}_chair": [{"position": [0.95, 0.4, -1.6], "object_id": 9, "object_category": "chair"},
                               {"position": [3.0, 0.4, -3.0], "object_id": 1, "object_category": "chair"}]}  # fmt: skip
    path = folder / "content" / "two.json.gz"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(gzip.compress(json.dumps({"episodes": episodes, "goals_by_category": goals}).encode()))
    return path
