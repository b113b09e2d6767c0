"""A mesh of many coloured parts that is one geom: small objects would otherwise need a geom for each colour.

The material `small` has a palette as its texture: `COLUMNS` columns of one colour each
(`sim.homes.housegen.surfaces.textures`). All vertices of a part have the same texture coordinate, so that the part has
the colour of one column. Another palette shows the same mesh in other colours.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sim.homes.housegen.furniture.item import MeshShape
from sim.homes.housegen.furniture.shapes import BOX_CORNERS, BOX_FACES, hashed_mesh, ring_faces
from sim.homes.housegen.furniture.transforms import roll_tilt_turn
from sim.homes.housegen.furniture.workbench import Range, Workbench

COLUMNS = 16
"""Colours of a palette."""
WHITE, CREAM, DARK, METAL, WOOD, BROWN = range(6)
"""Columns of colours that are nearly the same in all palettes."""
ACCENTS = tuple(range(6, 12))
"""Columns of strong colours, which differ between palettes."""
GREEN, TINT, CARD, HIDE = range(12, 16)
"""Leaves, glass, cardboard and bread, leather."""


class PaletteMesh:
    """The parts of one mesh while it is built; lengths in metres, in the frame of the item."""

    def __init__(self) -> None:
        self._vertices: list[NDArray[np.float64]] = []
        self._faces: list[NDArray[np.int32]] = []
        self._columns: list[int] = []

    def box(
        self, x: Range, y: Range, z: Range, column: int, *, roll: float = 0.0, tilt: float = 0.0, turn: float = 0.0
    ) -> None:
        """Adds the box with these ranges, rolled about x, then tilted about y, then turned about z, at its middle."""
        half = np.array([0.5 * (hi - lo) for lo, hi in (x, y, z)])
        middle = np.array([0.5 * (hi + lo) for lo, hi in (x, y, z)])
        rotation = roll_tilt_turn(roll, tilt, turn)
        self._add(middle + (BOX_CORNERS * half) @ rotation.T, BOX_FACES, column)

    def round(
        self,
        at: tuple[float, float],
        rings: Sequence[tuple[float, float]],
        column: int,
        *,
        sides: int = 8,
        wide: float = 1.0,
    ) -> None:
        """Adds a body of revolution about the vertical through `at` from (z, radius) of its rings; radii above 0.

        Rings may go down again to form a cup. Radii along y are `wide` times as large.
        """
        points, faces = _revolved(rings, sides)
        self._add(points * (1.0, wide, 1.0) + (*at, 0.0), faces, column)

    def roll(self, x: float, z: float, rings: Sequence[tuple[float, float]], column: int, *, sides: int = 8) -> None:
        """Adds a body of revolution about the line along y through x and z, from (y, radius) of its rings."""
        points, faces = _revolved(rings, sides)
        self._add(points[:, [1, 2, 0]] + (x, 0.0, z), faces, column)

    def cup(self, at: tuple[float, float], z: Range, radius: float, column: int, *, sides: int = 6) -> None:
        """Adds a cup, glass or bowl that is open at its top."""
        low, high = z
        rings = [(low, 0.8 * radius), (high, radius), (low + 0.25 * (high - low), 0.7 * radius)]
        self.round(at, rings, column, sides=sides)

    def ball(self, at: tuple[float, float, float], radius: float, column: int, *, sides: int = 6) -> None:
        """Adds a ball of few faces."""
        x, y, z = at
        rings = [(z - 0.95 * radius, 0.35 * radius), (z - 0.45 * radius, 0.9 * radius)]
        rings += [(2 * z - height, r) for height, r in reversed(rings)]
        self.round((x, y), rings, column, sides=sides)

    def put(self, w: Workbench, *, solid: bool = False, emission: float = 0.0) -> None:
        """Adds the mesh to an item as one geom of the material `small`; a solid mesh collides as its convex hull."""
        look = replace(w.look("small"), emission=emission)
        w.add("mesh", (), (0.0, 0.0, 0.0), np.eye(3), look, solid=solid, mesh=self._shape())

    def _add(self, vertices: NDArray[np.float64], faces: NDArray[np.int32], column: int) -> None:
        self._faces.append(faces + sum(len(part) for part in self._vertices))
        self._vertices.append(vertices)
        self._columns += [column] * len(vertices)

    def _shape(self) -> MeshShape:
        across = np.round((np.array(self._columns) + 0.5) / COLUMNS, 2)
        texture_uv = np.column_stack([across, np.zeros(len(across))])
        return hashed_mesh("s", np.vstack(self._vertices), np.vstack(self._faces), texture_uv)


def in_one_mesh(build: Callable[[Workbench, PaletteMesh], None], *, solid: bool = False) -> Callable[[Workbench], None]:
    """Returns the `build` of a style whose parts are added to one mesh; if solid, it collides as its convex hull."""

    def built(w: Workbench) -> None:
        mesh = PaletteMesh()
        build(w, mesh)
        mesh.put(w, solid=solid)

    return built


def _revolved(rings: Sequence[tuple[float, float]], sides: int) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Returns corners and triangles of a body of revolution about z, closed at both ends."""
    turns = (np.arange(sides) + 0.5) * (2.0 * np.pi / sides)
    circle = np.column_stack([np.cos(turns), np.sin(turns)])
    points = [np.column_stack([radius * circle, np.full(sides, z)]) for z, radius in rings]
    return np.vstack(points), np.array(ring_faces(len(rings), sides), dtype=np.int32)
