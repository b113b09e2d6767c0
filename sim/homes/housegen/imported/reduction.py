"""Reduces the meshes of a model to a number of triangles, by fast-simplification of the extra `models`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from sim.homes.housegen.imported.meshes import Part, merged
from sim.homes.housegen.imported.scene_files import library
from sim.homes.housegen.imported.sources import Skipped

MAX_TRIANGLES, MAX_PLANT_TRIANGLES = 1_500, 2_000
"""Triangles of a model after its reduction, exceeded where its shape would be lost; a plant has many leaves."""
MIN_TRIANGLES = 12
"""Triangles that every connected piece may have."""
MAX_ERROR, ERROR_POINTS, QUERIES = 0.03, 4_000, 600
"""Largest distance of a reduced piece from the piece, relative to its diagonal, and the points that measure it."""
UNIT_M = 1e-3
"""Vertices are multiples of this length, as in house files."""


def reduced(parts: Sequence[Part], most: int = MAX_TRIANGLES) -> tuple[Part, ...]:
    """Returns the parts with about `most` triangles in total at most.

    Every connected piece is reduced by itself, so that the reduction does not remove a thin leg or a rail. Of very many
    pieces (leaves) the largest stay.

    Raises:
        Skipped: nothing is left of the model.
    """
    pieces = [(n, piece) for n, part in enumerate(parts) for piece in _pieces(_clean(part))]
    pieces.sort(key=lambda entry: -float(entry[1].areas_m2.sum()))
    least = np.cumsum([min(MIN_TRIANGLES, len(piece.faces)) for _, piece in pieces])
    pieces = pieces[: int((least <= most).sum())]
    weights = np.sqrt([len(piece.faces) * piece.areas_m2.sum() for _, piece in pieces])
    made: dict[int, list[Part]] = {}
    for (n, piece), share in zip(pieces, weights / max(1e-9, float(weights.sum())), strict=True):
        made.setdefault(n, []).append(_simplified(piece, max(MIN_TRIANGLES, int(share * most))))
    joined = [_clean(merged(of_part, np.array(parts[n].rgba))) for n, of_part in sorted(made.items())]
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


def _simplified(piece: Part, faces_wanted: int) -> Part:
    """Returns a piece with about `faces_wanted` triangles, or more if it would lose its extent.

    The library fails on some pieces that are not the surface of a body; their vertices are joined on a grid instead.
    """
    simplify = library("fast_simplification").simplify
    if faces_wanted >= len(piece.faces):
        return piece
    for target in (faces_wanted, 2 * faces_wanted, 4 * faces_wanted):
        if target >= len(piece.faces):
            return piece
        # Its limits on the error are for lengths of about 100.
        scale = 100.0 / float(np.ptp(piece.vertices_m, axis=0).max())
        vertices, faces = simplify((piece.vertices_m * scale).astype(np.float32), piece.faces, target_count=target)
        made = _clean(Part(np.asarray(vertices) / scale, np.asarray(faces, dtype=np.int32), piece.rgba))
        if len(made.faces) <= 2 * target and is_alike(made, piece):
            return made
    return _clustered(piece, 2 * faces_wanted)


def is_alike(made: Part, piece: Part) -> bool:
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
    area = float(piece.areas_m2.sum())
    made_area = float(made.areas_m2.sum())
    return all((np.abs(a - b) <= tolerance).all() for a, b in ends) and 0.6 * area <= made_area <= 1.4 * area


def _scattered(part: Part) -> NDArray[np.float64]:
    """Returns points on the triangles of a part, evenly spread, the same in each run."""
    weights = part.areas_m2
    rng = np.random.default_rng(0)
    chosen = part.faces[rng.choice(len(weights), size=ERROR_POINTS, p=weights / weights.sum())]
    shares = rng.dirichlet((1.0, 1.0, 1.0), size=ERROR_POINTS)
    return (part.vertices_m[chosen] * shares[:, :, None]).sum(axis=1)


def _clustered(piece: Part, faces_wanted: int) -> Part:
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
        if len(made.faces) <= faces_wanted:
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
