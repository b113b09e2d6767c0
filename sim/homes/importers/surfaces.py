"""Reads the triangles of GLB, glTF, OBJ and PLY files by node and material, with pictures and colours.

Reading is by trimesh, of the extra `import`. What a file could ask for is limited before it is decoded: its size, the
numbers that its accessors announce, its nodes and their loops, its pixels, and references to other files, which must
lie in the folder of the file or below it.
"""

from __future__ import annotations

import functools
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.errors import ConfigError, HouseError, ObjectNavError
from sim.core.reading import printable, read_bytes, reason_of
from sim.homes.housegen.imported.scene_files import gltf_parts, library, load_scene
from sim.homes.housegen.imported.sources import Skipped, path_inside
from sim.homes.housegen.mjcf.triangles import triangle_areas
from sim.houses.proposals import category_of_name

FORMATS = ("glb", "gltf", "obj", "ply")
MAX_FILE_BYTES = 1 << 30
MAX_TRIANGLES = 20_000_000
"""Triangles of a file, those of repeated meshes counted each time."""
FARTHEST_M = 2_000.0
"""Largest coordinate of a vertex."""
GREY, WHITE = (0.7, 0.7, 0.7, 1.0), (1.0, 1.0, 1.0, 1.0)
Up = Literal["y", "z"]
"""The axis of a file that points up: y in glTF and in Habitat, z in Matterport's scans and in this project."""
Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""Turns a y-up frame to ours: (x, y, z) becomes (x, -z, y)."""


@dataclass(frozen=True, eq=False)
class Paint:
    """The appearance of a surface."""

    rgba: tuple[float, float, float, float] = GREY
    """Colour, by which the picture is multiplied."""
    picture: NDArray[np.uint8] | None = None  # (h, w, 3), the first row at the top
    uv: NDArray[np.float64] | None = None  # (n, 2) for each vertex, v upwards
    vertex_rgb: NDArray[np.uint8] | None = None  # (n, 3)


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles of one material of one node, metres."""

    node: str
    material: str
    vertices_m: NDArray[np.float64]  # (n, 3)
    faces: NDArray[np.int32]  # (m, 3)
    paint: Paint = field(default_factory=Paint)
    face_ids: NDArray[np.int64] | None = None  # (m,), from the property `object_id` of a PLY file

    def part(self, chosen: NDArray[np.bool_]) -> Surface:
        """Returns the surface of some of the triangles (m,), with the vertices that they use."""
        faces = self.faces[chosen]
        used, index = np.unique(faces, return_inverse=True)
        paint = replace(
            self.paint,
            uv=None if self.paint.uv is None else self.paint.uv[used],
            vertex_rgb=None if self.paint.vertex_rgb is None else self.paint.vertex_rgb[used],
        )
        ids = None if self.face_ids is None else self.face_ids[chosen]
        return Surface(
            self.node, self.material, self.vertices_m[used], index.reshape(-1, 3).astype(np.int32), paint, ids
        )

    def moved(self, transform: NDArray[np.float64]) -> Surface:
        """Returns the surface moved by a 4 x 4 matrix; one that mirrors also reverses the triangles."""
        vertices = self.vertices_m @ transform[:3, :3].T + transform[:3, 3]
        mirrors = bool(np.linalg.det(transform[:3, :3]) < 0.0)
        faces = np.ascontiguousarray(self.faces[:, ::-1]) if mirrors else self.faces
        return replace(self, vertices_m=vertices, faces=faces)

    @property
    def corners_m(self) -> NDArray[np.float64]:
        """The corners (m, 3, 3) of the triangles: triangle, corner, xyz."""
        return self.vertices_m[self.faces]

    @property
    def area_m2(self) -> float:
        """Area of all triangles."""
        return float(triangle_areas(self.corners_m).sum())


def check_installed() -> None:
    """Raises ConfigError if a package of the extra `import` is missing."""
    for module in ("trimesh", "fast_simplification", "PIL"):
        library(module, extra="import")


def read_surfaces(
    file: Path, *, up: Up = "z", unit_m: float = 1.0, texture_px: int | None = None,
    losses: Counter[str] | None = None,
) -> list[Surface]:  # fmt: skip
    """Returns the surfaces of a file in our frame, nodes at their places.

    Args:
        file: the file.
        up: its upward axis.
        unit_m: its unit of length, metres.
        texture_px: larger pictures are reduced to this size; None: they stay.
        losses: gets sentences on the losses.

    Raises:
        HouseError: the file cannot be read, is too large, or has a number that is not allowed; one line.
        ConfigError: a package is not installed.
    """
    kind, losses = file.suffix.lower().lstrip("."), Counter() if losses is None else losses
    where = f"Mesh '{printable(str(file))}'"
    if kind not in FORMATS:
        raise HouseError(f"{where}: unsupported format '{printable(kind)}'; use {', '.join(FORMATS)}.")
    content = read_bytes(file, what="Mesh", error=HouseError, most=MAX_FILE_BYTES)
    read = functools.partial(read_inside, file.parent)
    scene = load_scene(content, kind, where=where, most=MAX_TRIANGLES, read=read, losses=losses, extra="import")
    frame = np.diag([unit_m, unit_m, unit_m, 1.0])
    frame[:3, :3] = frame[:3, :3] @ (Y_UP if up == "y" else np.eye(3))
    try:
        surfaces = list(_surfaces(scene, frame, texture_px, losses))
    except ObjectNavError:
        raise
    except Exception as error:  # trimesh computes parts of a scene when they are asked for
        raise HouseError(
            f"{where} cannot be read ({type(error).__name__}: {printable(reason_of(error))[:100]})."
        ) from None
    if not surfaces:
        raise HouseError(f"{where} has no triangles.{' '.join(['', *losses][:3])}")
    return surfaces


def _surfaces(
    scene: Any, frame: NDArray[np.float64], texture_px: int | None, losses: Counter[str]
) -> Iterator[Surface]:
    """Yields the surfaces of a scene of trimesh, moved by a 4 x 4 matrix."""
    painted = dict[int, NDArray[np.uint8] | None]()
    trimesh = library("trimesh", extra="import")
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        mesh = scene.geometry[name]
        if not isinstance(mesh, trimesh.Trimesh) or not len(mesh.faces):
            continue
        vertices = np.asarray(mesh.vertices, dtype=np.float64)
        faces = np.asarray(mesh.faces, dtype=np.int32)
        if faces.min() < 0 or faces.max() >= len(vertices):
            leave_out(str(node), "a triangle names a vertex that does not exist", losses)
            continue
        material = getattr(mesh.visual, "material", None)
        called = str(getattr(material, "name", None) or "")
        surface = Surface(
            _name_of(scene, str(node), called), called, vertices, faces,
            _paint(mesh, material, texture_px, painted, losses), _face_ids(mesh),
        ).moved(frame @ np.asarray(transform, dtype=np.float64))  # fmt: skip
        if is_near(surface.vertices_m, str(node), losses):
            yield surface


def _name_of(scene: Any, node: str, material: str) -> str:
    """Returns the name of a node; for each material of one of a glTF file, trimesh makes a child with a random name.

    Sketchfab makes such children, too: `Object_7`, or `Sofa_Leather_0` below `Sofa`. They are parts of the node above.
    """
    names, parents = scene.metadata["names"], scene.graph.transforms.parents
    if node not in names and re.fullmatch(f"{re.escape(str(parents.get(node)))}_[0-9a-f]{{6}}", node):
        node = str(parents[node])
    name, above = (names.get(each, each) for each in (node, str(parents.get(node))))
    is_part = re.fullmatch(r"Object_\d+", name) or (material and name.startswith(f"{above}_{material}_"))
    return above if is_part and category_of_name(above) is not None else name


def is_near(vertices_m: NDArray[np.float64], node: str, losses: Counter[str]) -> bool:
    """Returns whether all vertices of a node are finite and within `FARTHEST_M`; else the node is reported."""
    near = bool((np.abs(vertices_m) <= FARTHEST_M).all())
    if not near:
        leave_out(node, f"a vertex is not finite or beyond {FARTHEST_M:g} m", losses)
    return near


def leave_out(node: str, reason: str, losses: Counter[str]) -> None:
    """Reports a node that is left out."""
    losses[f"'{printable(node)[:60]}' was left out: {reason}."] += 1


def _paint(
    mesh: Any, material: Any, texture_px: int | None, painted: dict[int, NDArray[np.uint8] | None], losses: Counter[str]
) -> Paint:
    """Returns the appearance of a mesh of trimesh; `painted` keeps decoded pictures by the identity of their source."""
    uv, rgba = getattr(mesh.visual, "uv", None), GREY
    if material is None:
        if getattr(mesh.visual, "kind", None) == "vertex":
            return Paint(WHITE, vertex_rgb=np.asarray(mesh.visual.vertex_colors, dtype=np.uint8)[:, :3])
        if getattr(mesh.visual, "kind", None) == "face":
            return Paint(tuple(float(v) / 255.0 for v in mesh.visual.main_color))  # type: ignore[arg-type]
        return Paint()
    factor = getattr(material, "baseColorFactor", None)
    factor = getattr(material, "diffuse", None) if factor is None else factor
    image = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
    if factor is not None:
        factors = np.asarray(factor, dtype=np.float64).ravel() / 255.0
        if len(factors) in (3, 4) and np.isfinite(factors).all():
            r, g, b, a = (float(v) for v in np.clip([*factors, 1.0][:4], 0.0, 1.0))
            is_opaque = getattr(material, "alphaMode", "BLEND") in (None, "OPAQUE")  # None: the default of glTF
            rgba = (r, g, b, 1.0 if is_opaque else a)
    elif image is not None:
        rgba = WHITE
    colours = getattr(mesh.visual, "vertex_attributes", {}).get("color")
    if image is None and colours is not None and len(colours) == len(mesh.vertices):
        return Paint(rgba, vertex_rgb=_bytes_of(np.asarray(colours)[:, :3]))
    if image is None or uv is None or len(uv) != len(mesh.vertices) or not np.isfinite(uv).all():
        return Paint(rgba)
    if id(image) not in painted:
        painted[id(image)] = _pixels(image, texture_px, losses)
    picture = painted[id(image)]
    return Paint(rgba) if picture is None else Paint(rgba, picture, np.asarray(uv, dtype=np.float64))


def _bytes_of(colours: NDArray[Any]) -> NDArray[np.uint8]:
    """Returns colours as bytes; numbers of floating point are from 0 to 1."""
    if np.issubdtype(colours.dtype, np.floating):
        return np.rint(np.clip(np.nan_to_num(colours), 0.0, 1.0) * 255.0).astype(np.uint8)
    return (colours >> 8).astype(np.uint8) if colours.dtype == np.uint16 else colours.astype(np.uint8)


def _pixels(image: Any, texture_px: int | None, losses: Counter[str]) -> NDArray[np.uint8] | None:
    """Returns the pixels of a picture (h, w, 3), at most `texture_px` along its longer side; None if it is damaged."""
    width, height = image.size
    try:
        small = image.convert("RGB")
    except (OSError, ValueError, SyntaxError):
        losses["A picture is damaged and cannot be read."] += 1
        return None
    image.close()  # its pixels would stay in memory as long as the scene
    if texture_px is not None and max(width, height) > texture_px:
        share = texture_px / max(width, height)
        small = small.resize((max(1, round(width * share)), max(1, round(height * share))), 4)  # 4: mean of the pixels
    return np.asarray(small, dtype=np.uint8)


def resized(picture: NDArray[np.uint8], most_px: int) -> NDArray[np.uint8]:
    """Returns a picture with at most `most_px` along its longer side."""
    height, width = picture.shape[:2]
    share = most_px / max(height, width)
    if share >= 1.0:
        return picture
    size = (max(1, round(width * share)), max(1, round(height * share)))
    return np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)


def _face_ids(mesh: Any) -> NDArray[np.int64] | None:
    """Returns the instance of each triangle of a PLY file with the property `object_id`, else None."""
    raw = mesh.metadata.get("_ply_raw") if isinstance(getattr(mesh, "metadata", None), dict) else None
    data = (raw or {}).get("face", {}).get("data")
    names = getattr(getattr(data, "dtype", None), "names", None) or (data.keys() if isinstance(data, dict) else ())
    if data is None or "object_id" not in names:
        return None
    ids = np.asarray(data["object_id"]).astype(np.int64).ravel()
    return ids if len(ids) == len(mesh.faces) else None


# ---- files that a mesh names ----------------------------------------------------------------------------------------


def parts_of(file: Path) -> Iterator[Path]:
    """Yields the files of its folder that a .gltf file names, buffers and pictures; nothing if it cannot be read."""
    try:
        names = list(gltf_parts(read_bytes(file, what="Mesh", error=HouseError, most=MAX_FILE_BYTES), f"Mesh '{file}'"))
    except HouseError:
        return
    for name in names:
        part = path_inside(file.parent, name)
        if part is not None:
            yield part


def read_inside(folder: Path, name: str) -> bytes:
    """Returns a file of the folder or below it.

    Raises:
        HouseError: it is outside of the folder.
        Skipped: it is missing or cannot be read.
    """
    target = path_inside(folder, name)
    if target is None:
        raise HouseError(f"A mesh in '{folder}' uses '{printable(name)[:100]}', which is outside of its folder.")
    try:
        return read_bytes(target, what="File", most=MAX_FILE_BYTES)
    except ConfigError as error:
        raise Skipped(str(error)) from None
