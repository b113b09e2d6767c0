"""Turns the file of a model into few meshes of plain colour, in the frame of an item and in metres.

Reading is by trimesh, and the reduction to a number of triangles by fast-simplification: the extra `models`.
"""

from __future__ import annotations

import importlib
import io
import posixpath
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from sim.errors import ConfigError
from sim.housegen.imported.sources import Entry, Skipped

MAX_TRIANGLES, MAX_PLANT_TRIANGLES = 1_500, 2_000
"""Triangles of a model after its reduction, exceeded where its shape would be lost; a plant has many leaves."""
MAX_SOURCE_TRIANGLES = 1_500_000
LEAST_TRIANGLES = 12
"""Triangles that every connected piece may have."""
MAX_ERROR, ERROR_POINTS, QUERIES = 0.03, 4_000, 600
"""Largest distance of a reduced piece from the piece, relative to its diagonal, and the points that measure it."""
MAX_PARTS = 6
"""Colours of a model; the parts of the most similar colours are joined."""
UNIT_M = 1e-3
"""Vertices are multiples of this length, as in house files."""
_FORMATS = ("obj", "glb", "gltf", "ply", "stl", "off")
DARKEST = 0.03
"""Smallest red, green and blue: light and shade cannot be seen on black."""
_SEE_THROUGH = 0.35
"""Opacity of glass."""


@dataclass(frozen=True)
class Part:
    """The triangles of one colour."""

    vertices_m: NDArray[np.float64]  # (n, 3)
    faces: NDArray[np.int32]  # (m, 3)
    rgba: tuple[float, float, float, float]


def check_installed() -> None:
    """Raises ConfigError if a package of the extra `models` is missing."""
    for module in ("trimesh", "fast_simplification", "PIL"):
        _library(module)


def read_parts(entry: Entry) -> tuple[Part, ...]:
    """Returns the meshes of a model at their full number of triangles.

    Raises:
        Skipped: the file cannot be read, or has no surface.
    """
    trimesh = _library("trimesh")
    kind = posixpath.splitext(entry.file)[1].lower().lstrip(".")
    if kind not in _FORMATS:
        raise Skipped(f"its format '{kind}' is none of {', '.join(_FORMATS)}")
    content = entry.read(entry.file)
    resolver = _resolver(trimesh, entry.read, posixpath.dirname(entry.file))
    try:
        scene = trimesh.load_scene(io.BytesIO(content), file_type=kind, resolver=resolver, process=False)
        raw = [_coloured(mesh) for mesh in scene.dump() if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces)]
    except Exception as error:  # a reader meets any error in a broken file
        raise Skipped(f"its mesh cannot be read ({type(error).__name__}: {str(error)[:80]})") from None
    if sum(len(part.faces) for part in raw) > MAX_SOURCE_TRIANGLES:
        raise Skipped(f"it has more than {MAX_SOURCE_TRIANGLES} triangles")
    if not raw or not all(np.isfinite(part.vertices_m).all() for part in raw):
        raise Skipped("its mesh has no triangles, or a vertex that is no number")
    return _joined(_fitted([part for part in raw if part.rgba[3] > 0.02], entry))


def _library(name: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError:
        raise ConfigError(
            f"Reading models needs the package '{name}', which is not installed: pip install "
            "'stubborn-objectnav[models]'."
        ) from None


def _resolver(trimesh: Any, read: Callable[[str], bytes], folder: str) -> Any:
    """Returns trimesh's access to the files that a model names: materials, textures, buffers."""

    class Inside(trimesh.resolvers.Resolver):
        def __init__(self) -> None: ...

        def get(self, name: str) -> bytes:
            try:
                return read(posixpath.join(folder, str(name).strip().replace("\\", "/")))
            except Skipped as error:  # trimesh goes without a material or a picture that is missing
                raise FileNotFoundError(str(error)) from None

        def write(self, name: str, data: object) -> None:
            raise PermissionError(name)

        def keys(self) -> list[str]:
            return []

        def namespaced(self, namespace: str) -> Any:
            return _resolver(trimesh, read, posixpath.join(folder, namespace))

    return Inside()


# ---- colour ----------------------------------------------------------------------------------------------------------


def _coloured(mesh: Any) -> Part:
    """Returns a mesh of one material with its mean colour; a picture counts where the triangles show it."""
    vertices, faces = np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces, dtype=np.int32)
    material = getattr(mesh.visual, "material", None)
    rgba = np.array([0.7, 0.7, 0.7, 1.0])
    if material is not None:
        rgba = np.asarray(material.main_color, dtype=float)[:4] / 255.0
        rgba[3] = _opacity(material, rgba[3])
        shown = _shown_colour(mesh, material, vertices, faces)
        rgba[:3] = rgba[:3] if shown is None else shown
    elif getattr(mesh.visual, "kind", None) in ("vertex", "face"):
        rgba = np.asarray(mesh.visual.main_color, dtype=float) / 255.0
    if getattr(material, "doubleSided", False):
        faces = np.concatenate([faces, faces[:, ::-1]])
    r, g, b = (round(float(v), 3) for v in np.clip(rgba[:3], DARKEST, 1.0))
    return Part(vertices, faces, (r, g, b, float(rgba[3])))


def _opacity(material: Any, usual: float) -> float:
    """Returns the opacity of a material; OBJ files have `d`, or `Tr` for its opposite."""
    given = getattr(material, "kwargs", None) or {}
    for key, opposite in (("d", False), ("tr", True)):
        try:
            value = float(np.atleast_1d(given[key])[-1])
        except (KeyError, TypeError, ValueError, IndexError):
            continue
        return 1.0 - value if opposite else value
    return usual


def _shown_colour(mesh: Any, material: Any, vertices: NDArray, faces: NDArray) -> NDArray[np.float64] | None:
    """Returns the mean colour of the places of a material's picture that the triangles show; None without one."""
    picture = getattr(material, "image", None) or getattr(material, "baseColorTexture", None)
    uv = getattr(mesh.visual, "uv", None)
    if picture is None:
        return None
    picture.thumbnail((128, 128))
    pixels = np.asarray(picture.convert("RGBA"), dtype=float) / 255.0
    if uv is None or len(uv) != len(vertices) or not np.isfinite(uv).all():
        samples, weights = pixels.reshape(-1, 4), np.ones(pixels.shape[0] * pixels.shape[1])
    else:
        middle = np.mod(uv[faces].mean(axis=1), 1.0)
        columns = np.minimum((middle[:, 0] * pixels.shape[1]).astype(int), pixels.shape[1] - 1)
        rows = np.minimum(((1.0 - middle[:, 1]) * pixels.shape[0]).astype(int), pixels.shape[0] - 1)
        samples, weights = pixels[rows, columns], _areas(vertices, faces)
    weights = weights * samples[:, 3] + 1e-9
    return (samples[:, :3] * weights[:, None]).sum(axis=0) / weights.sum()


def _areas(vertices: NDArray, faces: NDArray) -> NDArray[np.float64]:
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


# ---- size ------------------------------------------------------------------------------------------------------------


def _fitted(parts: Sequence[Part], entry: Entry) -> list[Part]:
    """Returns the parts turned upright, with the front towards +x and the size that the source gives."""
    if not parts:
        raise Skipped("all of it is invisible")
    turned = [(part.vertices_m @ entry.rotation.T)[:, [2, 0, 1]] for part in parts]
    used = np.vstack([vertices[np.unique(part.faces)] for vertices, part in zip(turned, parts, strict=True)])
    low, high = used.min(axis=0), used.max(axis=0)
    extent = high - low
    if sorted(extent)[1] < 1e-9:
        raise Skipped("its mesh has no extent")
    scale = np.array(entry.size_m) / np.maximum(extent, 1e-6 * extent.max())
    origin = np.array([0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), low[2]])
    return [
        Part((vertices - origin) * scale, part.faces, part.rgba) for vertices, part in zip(turned, parts, strict=True)
    ]


def _joined(parts: Sequence[Part]) -> tuple[Part, ...]:
    """Returns at most `MAX_PARTS` parts of different colours: those of the most similar colours are joined."""
    groups = [([part], float(_areas(part.vertices_m, part.faces).sum()), np.array(part.rgba)) for part in parts]
    groups = [group for group in groups if group[1] > 1e-7]
    if not groups:
        raise Skipped("its mesh has no area")
    while len(groups) > 1:
        colours, areas = np.array([group[2] for group in groups]), np.array([group[1] for group in groups])
        apart = np.abs(colours[:, None] - colours[None]).sum(axis=2)
        cost = apart * np.minimum(areas[:, None], areas[None]) / areas.sum() + np.eye(len(groups)) * 9.0
        cost[apart < 0.04] = 0.0
        np.fill_diagonal(cost, 9.0)
        i, j = sorted(int(n) for n in np.unravel_index(int(cost.argmin()), cost.shape))
        if len(groups) <= MAX_PARTS and cost[i, j] > 0.002:
            break
        total = areas[i] + areas[j]
        colour = (colours[i] * areas[i] + colours[j] * areas[j]) / total
        groups[i] = (groups[i][0] + groups[j][0], float(total), colour)
        del groups[j]
    return tuple(_one(group, colour) for group, _, colour in groups)


def _one(parts: Sequence[Part], colour: NDArray[np.float64]) -> Part:
    starts = np.cumsum([0, *(len(part.vertices_m) for part in parts[:-1])])
    faces = np.vstack([part.faces + start for part, start in zip(parts, starts, strict=True)]).astype(np.int32)
    r, g, b, a = (round(float(v), 3) for v in colour)
    return Part(np.vstack([part.vertices_m for part in parts]), faces, (r, g, b, 1.0 if a > 0.9 else _SEE_THROUGH))


# ---- number of triangles ---------------------------------------------------------------------------------------------


def reduced(parts: Sequence[Part], most: int = MAX_TRIANGLES) -> tuple[Part, ...]:
    """Returns the parts with about `most` triangles in total at most.

    Every connected piece is reduced by itself, so that the reduction does not remove a thin leg or a rail. Of very many
    pieces (leaves) the largest stay.

    Raises:
        Skipped: nothing is left of the model.
    """
    pieces = [(n, piece) for n, part in enumerate(parts) for piece in _pieces(_clean(part))]
    pieces.sort(key=lambda found: -float(_areas(found[1].vertices_m, found[1].faces).sum()))
    least = np.cumsum([min(LEAST_TRIANGLES, len(piece.faces)) for _, piece in pieces])
    pieces = pieces[: int((least <= most).sum())]
    weights = np.sqrt([len(piece.faces) * _areas(piece.vertices_m, piece.faces).sum() for _, piece in pieces])
    made: dict[int, list[Part]] = {}
    for (n, piece), share in zip(pieces, weights / max(1e-9, float(weights.sum())), strict=True):
        made.setdefault(n, []).append(_simplified(piece, max(LEAST_TRIANGLES, int(share * most))))
    joined = [_clean(_one(of_part, np.array(parts[n].rgba))) for n, of_part in sorted(made.items())]
    joined = [part for part in joined if len(part.faces) >= 2 and len(part.vertices_m) >= 4]
    if not joined:
        raise Skipped("nothing is left of its mesh at the resolution of 1 mm")
    return tuple(joined)


def _pieces(part: Part) -> list[Part]:
    """Returns the connected pieces of a part; triangles that touch at a vertex are connected."""
    count = len(part.vertices_m)
    if not len(part.faces):
        return []
    rows, columns = part.faces[:, [0, 1]].ravel(), part.faces[:, [1, 2]].ravel()
    graph = coo_array((np.ones(len(rows), dtype=bool), (rows, columns)), shape=(count, count))
    _, of_vertex = connected_components(graph, directed=False)
    of_face = of_vertex[part.faces[:, 0]]
    order = np.argsort(of_face, kind="stable")
    groups = np.split(part.faces[order], np.flatnonzero(np.diff(of_face[order])) + 1)
    return [_used(Part(part.vertices_m, faces, part.rgba)) for faces in groups]


def _simplified(piece: Part, wanted: int) -> Part:
    """Returns a piece with about `wanted` triangles, or more where it would lose its extent.

    The library fails on some pieces that are no surface of a body; their vertices are joined on a grid instead.
    """
    library = _library("fast_simplification")
    if wanted >= len(piece.faces):
        return piece
    for target in (wanted, 2 * wanted, 4 * wanted):
        if target >= len(piece.faces):
            return piece
        # Its limits on the error are for lengths of about 100.
        scale = 100.0 / float(np.ptp(piece.vertices_m, axis=0).max())
        vertices, faces = library.simplify(
            (piece.vertices_m * scale).astype(np.float32), piece.faces, target_count=target
        )
        made = _clean(Part(np.asarray(vertices) / scale, np.asarray(faces, dtype=np.int32), piece.rgba))
        if len(made.faces) <= 2 * target and _is_alike(made, piece):
            return made
    return _clustered(piece, 2 * wanted)


def _is_alike(made: Part, piece: Part) -> bool:
    """Returns whether a reduced piece has about the extent, the area and the surface of the piece."""
    if not len(made.faces):
        return False
    reach = MAX_ERROR * float(np.linalg.norm(np.ptp(piece.vertices_m, axis=0))) + 0.002
    ours, theirs = _scattered(made), _scattered(piece)
    pairs = ((ours, theirs), (theirs, ours))
    if max(np.quantile(KDTree(a).query(b[:QUERIES])[0], 0.97) for a, b in pairs) > reach:
        return False
    tolerance = 0.004 + 0.03 * np.ptp(piece.vertices_m, axis=0)
    ends = zip((made.vertices_m.min(axis=0), made.vertices_m.max(axis=0)),
               (piece.vertices_m.min(axis=0), piece.vertices_m.max(axis=0)), strict=True)  # fmt: skip
    area = float(_areas(piece.vertices_m, piece.faces).sum())
    made_area = float(_areas(made.vertices_m, made.faces).sum())
    return all((np.abs(a - b) <= tolerance).all() for a, b in ends) and 0.6 * area <= made_area <= 1.4 * area


def _scattered(part: Part) -> NDArray[np.float64]:
    """Returns points on the triangles of a part, evenly spread, the same in each run."""
    areas = _areas(part.vertices_m, part.faces)
    rng = np.random.default_rng(0)
    chosen = part.faces[rng.choice(len(areas), size=ERROR_POINTS, p=areas / areas.sum())]
    weights = rng.dirichlet((1.0, 1.0, 1.0), size=ERROR_POINTS)
    return (part.vertices_m[chosen] * weights[:, :, None]).sum(axis=1)


def _clustered(piece: Part, wanted: int) -> Part:
    """Returns a piece with all vertices in a cell of a grid joined, the grid as fine as the number allows."""
    low, extent = piece.vertices_m.min(axis=0), float(np.ptp(piece.vertices_m, axis=0).max())
    made = piece
    for cells in (64, 48, 32, 24, 16, 12, 8, 6):
        index = np.rint((piece.vertices_m - low) / extent * cells).astype(np.int64)
        _, group = np.unique(index, axis=0, return_inverse=True)
        group = group.reshape(-1)
        middle = np.stack([np.bincount(group, piece.vertices_m[:, k]) for k in range(3)], axis=1)
        joined = np.asarray(middle / np.bincount(group)[:, None], dtype=np.float64)
        made = _clean(Part(joined, group[piece.faces].astype(np.int32), piece.rgba))
        if len(made.faces) <= wanted:
            return made
    return made


def _used(part: Part) -> Part:
    """Returns a part without the vertices that no triangle has."""
    used, faces = np.unique(part.faces, return_inverse=True)
    return Part(part.vertices_m[used], faces.reshape(-1, 3).astype(np.int32), part.rgba)


def _clean(part: Part) -> Part:
    """Returns a part with vertices in whole millimetres, each once, and without triangles that have no area."""
    grid = np.rint(part.vertices_m / UNIT_M).astype(np.int64)
    unique, index = np.unique(grid, axis=0, return_inverse=True)
    faces = index.reshape(-1)[part.faces]
    a, b, c = (unique[faces[:, k]] for k in range(3))
    faces = faces[np.abs(np.cross(b - a, c - a)).sum(axis=1) > 0]
    first = np.argmin(faces, axis=1)[:, None]  # each triangle once for each of its sides
    faces = np.unique(np.take_along_axis(faces, (first + np.arange(3)) % 3, axis=1), axis=0)
    return _used(Part(np.asarray(unique * UNIT_M, dtype=np.float64), faces.astype(np.int32), part.rgba))
