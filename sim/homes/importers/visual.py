"""Makes the visual meshes of an object from its surfaces: within a number of triangles, pictures kept or baked.

An object within its number of triangles keeps its triangles, texture coordinates and pictures. Of another one, surfaces
of plain colour are reduced by colour; those with pictures or colours of vertices are reduced together, and what they
show is baked into a new picture, in which each triangle has half of a square. The sides of the squares are powers of
two, sorted by size along a Z-order curve, so that they fill the picture without gaps and mipmaps do not mix them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from sim.homes.housegen.imported.meshes import Part, stacked
from sim.homes.housegen.imported.reduction import is_alike, reduced
from sim.homes.housegen.imported.scene_files import library
from sim.homes.housegen.imported.sources import Skipped
from sim.homes.housegen.mjcf.triangles import triangle_areas
from sim.homes.importers.surfaces import WHITE, Surface

WELD_M = 5e-4
"""Vertices nearer to each other than this are one when triangles are reduced."""
TEXEL_M = 0.02
"""Side of a pixel of a baked picture on the surface, unless the picture would be too large."""
MIN_SQUARE, MAX_SQUARE = 4, 256
MAX_SAMPLES = 3_000_000
"""Number of points of the source that give their colours to a baked picture."""
CREASE = math.cos(math.radians(40.0))
"""Triangles that meet at a larger angle have an edge between them; others are shaded as one smooth surface."""


@dataclass(frozen=True, eq=False)
class Skin:
    """A mesh of a house, metres."""

    vertices_m: NDArray[np.float64]  # (n, 3)
    faces: NDArray[np.int32]  # (m, 3)
    rgba: tuple[float, float, float, float]
    uv: NDArray[np.float64] | None = None  # (n, 2), v upwards
    picture: NDArray[np.uint8] | None = None  # (h, w, 3)
    normals: NDArray[np.float64] | None = None  # (n, 3); None: computed by MuJoCo


def make_skins(surfaces: Sequence[Surface], triangles: int, texture_px: int) -> list[Skin]:
    """Returns the visual meshes of an object.

    Args:
        surfaces: of the object, at least one.
        triangles: about the largest number of triangles.
        texture_px: side of a baked picture at most, rounded up to a power of two.
    """
    total = sum(len(surface.faces) for surface in surfaces)
    painted = [
        surface for surface in surfaces if surface.paint.picture is not None or surface.paint.vertex_rgb is not None
    ]
    plain = [surface for surface in surfaces if surface not in painted]
    if total <= triangles:
        pictured = [surface for surface in painted if surface.paint.picture is not None]
        coloured = [surface for surface in painted if surface.paint.picture is None]
        return [*_kept([*plain, *pictured]), *_baked_all(coloured, total, texture_px)]
    shares = [triangles * sum(len(surface.faces) for surface in group) // total for group in (plain, painted)]
    return [*_plain(plain, max(shares[0], 12)), *_baked_all(painted, max(shares[1], 12), texture_px)]


def _kept(surfaces: Sequence[Surface]) -> list[Skin]:
    """Returns a mesh for each picture and colour, with all triangles."""
    groups: dict[tuple[object, ...], list[Surface]] = {}
    for surface in surfaces:
        groups.setdefault((id(surface.paint.picture), surface.paint.rgba), []).append(surface)
    return [_skin_of(group) for group in groups.values()]


def _skin_of(group: Sequence[Surface]) -> Skin:
    vertices, faces = stacked([(surface.vertices_m, surface.faces) for surface in group])
    paint = group[0].paint
    uv = (
        None
        if paint.picture is None
        else np.vstack([surface.paint.uv for surface in group if surface.paint.uv is not None])
    )
    return Skin(vertices, faces, paint.rgba, uv, paint.picture)


def _plain(surfaces: Sequence[Surface], triangles: int) -> list[Skin]:
    """Returns a reduced mesh for each colour."""
    if not surfaces:
        return []
    joined = _kept(surfaces)
    parts = [Part(patch.vertices_m, patch.faces, patch.rgba) for patch in joined]
    try:
        return [Skin(part.vertices_m, part.faces, part.rgba) for part in reduced(parts, triangles)]
    except Skipped:  # smaller than the resolution of the reduction
        return joined


def _baked_all(surfaces: Sequence[Surface], triangles: int, texture_px: int) -> list[Skin]:
    """Returns one reduced mesh with a baked picture, or an empty list without surfaces."""
    if not surfaces:
        return []
    vertices, faces = _simplified(*welded(surfaces), triangles)
    if not len(faces):
        return []
    corners, of_vertex, squares, texel_m = _layout(vertices, faces, texture_px)
    picture = _picture(surfaces, corners, squares, texel_m)
    height, width = picture.shape[:2]
    uv = squares.uv_px.reshape(-1, 2) / (width, height)
    normals = _normals(corners, of_vertex, len(vertices))
    return [Skin(corners.reshape(-1, 3), np.arange(3 * len(corners), dtype=np.int32).reshape(-1, 3),
                 WHITE, np.stack([uv[:, 0], 1.0 - uv[:, 1]], axis=1), picture,
                 normals.reshape(-1, 3))]  # fmt: skip


def welded(surfaces: Sequence[Surface]) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Returns vertices (n, 3) and faces (m, 3) of all surfaces as one mesh, with equal vertices joined."""
    points, faces = stacked([(surface.vertices_m, surface.faces) for surface in surfaces])
    _, first, index = np.unique(
        np.rint(points / WELD_M).astype(np.int64), axis=0, return_index=True, return_inverse=True
    )
    faces = index.reshape(-1)[faces]
    whole = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    return points[first], faces[whole].astype(np.int32)


def _simplified(
    vertices: NDArray[np.float64], faces: NDArray[np.int32], triangles: int
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Returns a mesh of about a number of triangles."""
    if len(faces) <= triangles:
        return vertices, faces
    # Its limits on the error are for lengths of about 100.
    middle, scale = vertices.mean(axis=0), 100.0 / max(1e-6, float(np.ptp(vertices, axis=0).max()))
    small, source = ((vertices - middle) * scale).astype(np.float32), Part(vertices, faces, WHITE)
    target = max(4, triangles)
    while target < len(faces):
        points, made = library("fast_simplification", extra="import").simplify(small, faces, target_count=target)
        points, made = np.asarray(points, dtype=np.float64) / scale + middle, np.asarray(made, dtype=np.int32)
        made = made[triangle_areas(points[made]) > 1e-10]
        if len(made) >= 2 and is_alike(Part(points, made, WHITE), source):
            return points, made
        target *= 2
    return vertices, faces


# ---- baking ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Squares:
    """The places of triangles in a picture, pixels."""

    corner_px: NDArray[np.int64]  # (m, 2) column and row of the first pixel of the square
    side_px: NDArray[np.int64]  # (m,)
    second: NDArray[np.bool_]  # (m,) True: the half with the large columns and rows
    uv_px: NDArray[np.float64]  # (m, 3, 2) column and row of each corner, rows downwards
    size_px: tuple[int, int]
    """Width and height of the picture."""


def _layout(
    vertices: NDArray[np.float64], faces: NDArray[np.int32], texture_px: int
) -> tuple[NDArray[np.float64], NDArray[np.int32], _Squares, float]:
    """Returns corners (m, 3, 3) of the triangles with the largest angle first, their vertices, places and the texel."""
    corners = vertices[faces]
    edges = np.linalg.norm(corners[:, [2, 0, 1]] - corners[:, [1, 2, 0]], axis=2)  # opposite of each corner
    first = edges.argmax(axis=1)
    turn = (first[:, None] + np.arange(3)) % 3
    rows = np.arange(len(faces))[:, None]
    corners, of_vertex = corners[rows, turn], faces[rows, turn]
    legs_m = np.maximum(
        np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1), np.linalg.norm(corners[:, 2] - corners[:, 0], axis=1)
    )
    texel_m = TEXEL_M
    while True:
        wanted_px = np.clip(legs_m / texel_m + 3.0, MIN_SQUARE, min(MAX_SQUARE, texture_px))
        side = (2 ** np.ceil(np.log2(wanted_px))).astype(np.int64)
        units = int(((side // MIN_SQUARE) ** 2).sum()) // 2 + int(side.max() // MIN_SQUARE) ** 2
        if units * MIN_SQUARE**2 <= texture_px**2 or side.max() == MIN_SQUARE:
            break
        texel_m *= 1.25
    return corners, of_vertex, _packed(side), texel_m


def _packed(side: NDArray[np.int64]) -> _Squares:
    """Returns the places of triangles in squares of these sides."""
    order = np.argsort(-side, kind="stable")
    sizes, counts = np.unique(-side, return_counts=True)
    start, second = np.zeros(len(side), dtype=np.int64), np.zeros(len(side), dtype=np.bool_)
    used, done = 0, 0
    for size, count in zip((-sizes).tolist(), counts.tolist(), strict=True):
        mine, area = order[done : done + count], (size // MIN_SQUARE) ** 2
        start[mine] = used + np.arange(count) // 2 * area
        second[mine] = np.arange(count) % 2 == 1
        used, done = used + (count + 1) // 2 * area, done + count
    bits = max(0, math.ceil(math.log2(max(1, used))))
    width, height = MIN_SQUARE * 2 ** ((bits + 1) // 2), MIN_SQUARE * 2 ** (bits // 2)
    corner = MIN_SQUARE * np.stack([_every_second_bit(start), _every_second_bit(start >> 1)], axis=1)
    edge = side.astype(np.float64)
    near = np.stack([np.full(len(side), 0.5), np.full(len(side), 0.5)], axis=1)
    right, down = near.copy(), near.copy()
    right[:, 0] = down[:, 1] = edge - 2.5
    uv = np.stack([near, right, down], axis=1)
    uv = np.asarray(np.where(second[:, None, None], edge[:, None, None] - uv, uv) + corner[:, None], dtype=np.float64)
    return _Squares(corner, side, second, uv, (width, height))


def _every_second_bit(code: NDArray[np.int64]) -> NDArray[np.int64]:
    """Returns the numbers that the even bits of codes form: one coordinate along a Z-order curve."""
    codes = np.zeros_like(code)
    for bit in range(24):
        codes |= ((code >> (2 * bit)) & 1) << bit
    return codes


def _picture(
    surfaces: Sequence[Surface], corners: NDArray[np.float64], squares: _Squares, texel_m: float
) -> NDArray[np.uint8]:
    """Returns the picture (h, w, 3) in which each triangle shows the colours of the nearest points of the source."""
    width, height = squares.size_px
    area_m2 = sum(surface.area_m2 for surface in surfaces)
    spacing_m = max(texel_m, math.sqrt(area_m2 / MAX_SAMPLES))
    everything = np.concatenate([surface.corners_m for surface in surfaces])
    spacing_m = spacing_within(everything, spacing_m, 4 * MAX_SAMPLES)  # long thin triangles have many for their area
    sampled = [samples(surface.corners_m, spacing_m) for surface in surfaces]
    colours = np.vstack([
        _colours(surface, face, weights) for surface, (_, face, weights) in zip(surfaces, sampled, strict=True)
    ])  # fmt: skip
    tree = KDTree(np.vstack([points for points, _, _ in sampled]), balanced_tree=False, compact_nodes=False)
    picture = np.zeros((height, width, 3), dtype=np.uint8)
    for side in np.unique(squares.side_px).tolist():
        mine = np.flatnonzero(squares.side_px == side)
        for some in np.array_split(mine, max(1, len(mine) * side**2 // 2_000_000)):
            _bake(picture, some, side, corners, squares, tree, colours)
    return picture


def _bake(
    picture: NDArray[np.uint8], chosen: NDArray[np.int64], side: int, corners: NDArray[np.float64],
    squares: _Squares, tree: KDTree, colours: NDArray[np.float64],
) -> None:  # fmt: skip
    """Writes the pixels of some triangles; their squares have one common side."""
    column, row = np.meshgrid(np.arange(side), np.arange(side))
    first = (column + row + 1 <= side).ravel()
    inner = side - 3.0
    for is_second in (False, True):
        mine = chosen[squares.second[chosen] == is_second]
        half = ~first if is_second else first
        if not len(mine):
            continue
        across, down = column.ravel()[half], row.ravel()[half]
        u, v = (side - 1 - across, side - 1 - down) if is_second else (across, down)
        share = np.clip(np.stack([u, v], axis=1) / inner, 0.0, 1.0)
        share /= np.maximum(1.0, share.sum(axis=1, keepdims=True))
        a, b, c = (corners[mine, n][:, None] for n in range(3))
        points = a + share[None, :, :1] * (b - a) + share[None, :, 1:] * (c - a)
        near = tree.query(points.reshape(-1, 3), k=min(2, tree.n), eps=0.5)[1].reshape(len(mine), len(across), -1)
        at = squares.corner_px[mine]
        picture[at[:, 1:] + down, at[:, :1] + across] = np.rint(colours[near].mean(axis=2)).astype(np.uint8)


def samples(
    corners_m: NDArray[np.float64], spacing_m: float
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
    """Returns points that cover triangles, the triangle of each and its weights of the three corners.

    The points are in rows along the longest side of a triangle, so that long and thin ones get few.

    Args:
        corners_m: (m, 3, 3).
        spacing_m: largest distance of neighbouring points of a row, and of neighbouring rows.
    """
    first, base, height = _base_and_height(corners_m)
    turn = (first[:, None] + np.arange(3)) % 3
    along, across = (_steps(length / spacing_m) for length in (base, height))
    corners, faces, shares = [], [], []
    for n, rows in np.unique(np.stack([along, across], axis=1), axis=0).tolist():
        mine = np.flatnonzero((along == n) & (across == rows))
        u, t = (axis.ravel() for axis in np.meshgrid(np.linspace(0.0, 1.0, n + 1), np.linspace(0.0, 1.0, rows + 1)))
        weights = np.stack([(1.0 - t) * (1.0 - u), (1.0 - t) * u, t], axis=1)  # (k, 3)
        of_corner = np.zeros((len(mine), *weights.shape))
        np.put_along_axis(of_corner, np.broadcast_to(turn[mine][:, None, :], of_corner.shape), weights[None], axis=2)
        corners.append(np.einsum("mkc,mcd->mkd", of_corner, corners_m[mine]).reshape(-1, 3))
        faces.append(np.repeat(mine, len(weights)))
        shares.append(of_corner.reshape(-1, 3))
    return np.vstack(corners), np.concatenate(faces), np.vstack(shares)


def spacing_within(corners_m: NDArray[np.float64], spacing_m: float, most: int) -> float:
    """Returns the spacing, or a larger one with which `samples` gives at most so many points and 4 for each triangle.

    Args:
        corners_m: (m, 3, 3).
        spacing_m: wanted distance of neighbouring points.
        most: number of points.
    """
    _, base, height = _base_and_height(corners_m)
    while ((_steps(base / spacing_m) + 1) * (_steps(height / spacing_m) + 1)).sum() > most + 4 * len(corners_m):
        spacing_m *= 1.25
    return spacing_m


def _base_and_height(
    corners_m: NDArray[np.float64],
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """Returns the first corner (m,) of the longest side of triangles, the length of this side, and the height on it."""
    sides = np.linalg.norm(corners_m[:, [1, 2, 0]] - corners_m, axis=2)  # from each corner to the next
    base = sides.max(axis=1)
    return sides.argmax(axis=1), base, 2.0 * triangle_areas(corners_m) / np.maximum(base, 1e-12)


def _steps(wanted_px: NDArray[np.float64]) -> NDArray[np.int64]:
    """Returns lengths rounded up to whole pixels, with few different values."""
    whole = np.maximum(1, np.ceil(wanted_px)).astype(np.int64)
    unit = 2 ** np.maximum(0, np.floor(np.log2(whole)).astype(np.int64) - 2)
    return -(-whole // unit) * unit


def _colours(surface: Surface, face: NDArray[np.int64], weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the colours (k, 3), 0 to 255, of points of a surface."""
    paint, corners = surface.paint, surface.faces[face]
    if paint.vertex_rgb is not None:
        rgb = np.einsum("kc,kcd->kd", weights, paint.vertex_rgb[corners].astype(np.float64))
    elif paint.picture is not None and paint.uv is not None:
        rgb = pixels_at(paint.picture, np.einsum("kc,kcd->kd", weights, paint.uv[corners])).astype(np.float64)
    else:
        rgb = np.full((len(face), 3), 255.0)
    return rgb * np.asarray(paint.rgba[:3])


def pixels_at(picture: NDArray[np.uint8], uv: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Returns the pixels (k, 3) of a picture at texture coordinates (k, 2), v upwards; the picture repeats."""
    height, width = picture.shape[:2]
    u, v = np.mod(uv, 1.0).T
    columns = np.minimum((u * width).astype(np.int64), width - 1)
    rows = np.minimum(((1.0 - v) * height).astype(np.int64), height - 1)
    return picture[rows, columns]


def _normals(corners: NDArray[np.float64], of_vertex: NDArray[np.int32], count: int) -> NDArray[np.float64]:
    """Returns the normals (m, 3, 3) of the corners: the mean at their vertex, or the triangle's own at an edge."""
    own = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    summed = np.stack([
        np.bincount(of_vertex.ravel(), np.repeat(own[:, axis], 3), minlength=count) for axis in range(3)
    ], axis=1)  # fmt: skip
    own = own / np.maximum(np.linalg.norm(own, axis=1, keepdims=True), 1e-12)
    mean = summed / np.maximum(np.linalg.norm(summed, axis=1, keepdims=True), 1e-12)
    at = mean[of_vertex]
    smooth = (at * own[:, None]).sum(axis=2) > CREASE
    return np.where(smooth[:, :, None], at, own[:, None])
