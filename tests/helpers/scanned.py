"""A home of two rooms as triangles, written here by the rules of the data sets of Habitat, z up.

The rooms are x = 0 to 4 and x = 4 to 8, both y = 0 to 4; between them is a wall of 10 cm with a doorway of 80 cm at
y = 1.6 to 2.4. In the eastern room are a bed and a plant, in the western one a table, a chair and a picture.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh
from numpy.typing import NDArray
from PIL import Image

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


def triangles_of(piece: Piece, *, edge_m: float = 10.0) -> trimesh.Trimesh:
    """Returns a piece as triangles with edges of at most `edge_m`."""
    made = trimesh.util.concatenate([trimesh.creation.box(bounds=np.array(box)) for box in piece.boxes])
    vertices, faces = trimesh.remesh.subdivide_to_size(made.vertices, made.faces, edge_m, max_iter=12)
    return trimesh.Trimesh(vertices, faces, process=False)


def painted(mesh: trimesh.Trimesh, rgb: tuple[int, int, int]) -> trimesh.Trimesh:
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
