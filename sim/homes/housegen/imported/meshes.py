"""Turns the file of a model into few meshes of plain colour, in the frame of an item and in metres.

Reading is by trimesh, of the extra `models`; `reduction` reduces the triangles of a model.
"""

from __future__ import annotations

import functools
import posixpath
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.core.errors import HouseError
from sim.homes.housegen.imported.scene_files import library, load_scene
from sim.homes.housegen.imported.sources import Entry, Skipped
from sim.homes.housegen.mjcf.triangles import Facets, triangle_areas

MAX_SOURCE_TRIANGLES = 1_500_000
MAX_PARTS = 6
"""Colours of a model; the parts of the most similar colours are joined."""
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

    @property
    def areas_m2(self) -> NDArray[np.float64]:
        """Areas (m,) of the triangles."""
        return triangle_areas(self.vertices_m[self.faces])


def check_installed() -> None:
    """Raises ConfigError if a package of the extra `models` is missing."""
    for module in ("trimesh", "fast_simplification", "PIL"):
        library(module)


def read_parts(entry: Entry) -> tuple[Part, ...]:
    """Returns the meshes of a model at their full number of triangles.

    Raises:
        Skipped: the file cannot be read, or has no surface.
    """
    kind = posixpath.splitext(entry.file)[1].lower().lstrip(".")
    if kind not in _FORMATS:
        raise Skipped(f"unsupported format '{kind}'; use {', '.join(_FORMATS)}")
    content = entry.read(entry.file)
    losses = Counter[str]()
    try:
        read = functools.partial(_read_next_to, entry, posixpath.dirname(entry.file))
        scene = load_scene(content, kind, where="its mesh", most=MAX_SOURCE_TRIANGLES, read=read, losses=losses)
        trimesh = library("trimesh")
        raw = [_coloured(mesh) for mesh in scene.dump() if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces)]
    except HouseError as error:
        raise Skipped(str(error).rstrip(".")) from None
    except Exception as error:  # trimesh computes parts of a scene when they are asked for
        raise Skipped(f"its mesh cannot be read ({type(error).__name__}: {str(error)[:80]})") from None
    refused = next((sentence for sentence in losses if sentence.startswith("A picture ")), None)
    if refused is not None:
        raise Skipped(refused.rstrip("."))
    if not raw or not all(np.isfinite(part.vertices_m).all() for part in raw):
        raise Skipped("its mesh has no triangles, or a vertex that is not finite")
    return _joined(_fitted([part for part in raw if part.rgba[3] > 0.02], entry))


def _read_next_to(entry: Entry, folder: str, name: str) -> bytes:
    return entry.read(posixpath.join(folder, name))


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
    settings = getattr(material, "kwargs", None) or {}
    for key, opposite in (("d", False), ("tr", True)):
        try:
            value = float(np.atleast_1d(settings[key])[-1])
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
        samples, weights = pixels[rows, columns], triangle_areas(vertices[faces])
    weights = weights * samples[:, 3] + 1e-9
    return (samples[:, :3] * weights[:, None]).sum(axis=0) / weights.sum()


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
    groups = [([part], float(part.areas_m2.sum()), np.array(part.rgba)) for part in parts]
    groups = [group for group in groups if group[1] > 1e-7]
    if not groups:
        raise Skipped("its mesh has no area")
    while len(groups) > 1:
        colours, sizes = np.array([group[2] for group in groups]), np.array([group[1] for group in groups])
        apart = np.abs(colours[:, None] - colours[None]).sum(axis=2)
        cost = apart * np.minimum(sizes[:, None], sizes[None]) / sizes.sum() + np.eye(len(groups)) * 9.0
        cost[apart < 0.04] = 0.0
        np.fill_diagonal(cost, 9.0)
        i, j = sorted(int(n) for n in np.unravel_index(int(cost.argmin()), cost.shape))
        if len(groups) <= MAX_PARTS and cost[i, j] > 0.002:
            break
        total = sizes[i] + sizes[j]
        colour = (colours[i] * sizes[i] + colours[j] * sizes[j]) / total
        groups[i] = (groups[i][0] + groups[j][0], float(total), colour)
        del groups[j]
    return tuple(merged(group, colour) for group, _, colour in groups)


def merged(parts: Sequence[Part], colour: NDArray[np.float64]) -> Part:
    """Returns one part of several, in a colour."""
    r, g, b, a = (round(float(v), 3) for v in colour)
    vertices, faces = stacked([(part.vertices_m, part.faces) for part in parts])
    return Part(vertices, faces, (r, g, b, 1.0 if a > 0.9 else _SEE_THROUGH))


def stacked(meshes: Sequence[Facets]) -> Facets:
    """Returns the vertices (n, 3) and the triangles (m, 3) of several meshes as one."""
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in meshes[:-1])])
    faces = np.vstack([faces + start for (_, faces), start in zip(meshes, starts, strict=True)])
    return np.vstack([vertices for vertices, _ in meshes]), faces.astype(np.int32)
