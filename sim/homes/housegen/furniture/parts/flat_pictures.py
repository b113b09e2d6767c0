"""Pictures of flat shapes: the screens of televisions and computers, and photographs."""

from __future__ import annotations

import math

from sim.homes.housegen.furniture.parts.palette_mesh import (
    ACCENTS,
    BROWN,
    CARD,
    CREAM,
    DARK,
    GREEN,
    METAL,
    TINT,
    WHITE,
    PaletteMesh,
)
from sim.homes.housegen.furniture.parts.spans import around
from sim.homes.housegen.furniture.workbench import Range, Workbench

_STEP_M = 0.0006
"""Distance between two layers of a picture."""


def show_television(w: Workbench, x: float, y: Range, z: Range, *, tilt: float = 0.0) -> None:
    """Adds a picture on a television that is on: a landscape, a match, or a speaker in a studio; it does not collide.

    Args:
        w: the workbench.
        x: the surface of the screen.
        y: horizontal range of the picture.
        z: vertical range of the picture.
        tilt: rotation of the screen about its middle, as in `Workbench.box`.
    """
    page, accents = Page(x, y, z, tilt), [w.choice(ACCENTS) for _ in range(3)]
    kind = w.choice(("landscape", "match", "studio"))
    if kind == "landscape":
        page.box(TINT, (0.0, 1.0), (0.0, 1.0))
        page.disc(CREAM, w.length(0.2, 0.8), 0.74, 0.1)
        page.box(accents[0], (0.0, 1.0), (0.0, 0.48))
        page.box(GREEN, (0.0, 1.0), (0.0, 0.30))
        page.box(accents[1], (0.55, 0.80), (0.22, 0.50))
    elif kind == "match":
        page.box(GREEN, (0.0, 1.0), (0.0, 1.0))
        page.box(accents[0], (0.0, 1.0), (0.72, 1.0))
        page.box(WHITE, (0.49, 0.51), (0.0, 0.72))
        for i in range(6):
            c, level = 0.08 + 0.15 * i, w.length(0.1, 0.5)
            page.box(accents[1 + i % 2], (c, c + 0.03), (level, level + 0.16))
    else:
        page.box(accents[0], (0.0, 1.0), (0.0, 1.0))
        page.box(METAL, (0.08, 0.36), (0.35, 0.9))
        page.box(DARK, (0.46, 0.86), (0.0, 0.45))
        page.disc(CREAM, 0.66, 0.60, 0.15)
        page.box(WHITE, (0.0, 1.0), (0.0, 0.14))
    page.put(w)


def show_computer(w: Workbench, x: float, y: Range, z: Range, *, tilt: float = 0.0, turn: float = 0.0) -> None:
    """Adds a desktop with a window of text on a computer screen; it does not collide.

    Args:
        w: the workbench.
        x: the surface of the screen.
        y: horizontal range of the picture.
        z: vertical range of the picture.
        tilt: rotation of the screen about its middle, as in `Workbench.box`.
        turn: rotation of the screen about the vertical, as in `Workbench.box`.
    """
    page, accent = Page(x, y, z, tilt, turn), w.choice(ACCENTS)
    page.box(accent, (0.0, 1.0), (0.0, 1.0))
    page.box(DARK, (0.0, 1.0), (0.0, 0.07))
    page.box(WHITE, (0.12, 0.74), (0.18, 0.92))
    page.box(METAL, (0.12, 0.74), (0.86, 0.92))
    for i in range(5):
        page.box(DARK, (0.17, w.length(0.4, 0.68)), (0.74 - 0.11 * i, 0.77 - 0.11 * i))
    page.box(w.choice(ACCENTS), (0.79, 0.94), (0.55, 0.85))
    page.put(w)


def photograph(w: Workbench, page: Page) -> None:
    """Adds a photograph to a page: a person, a house, or hills under the sun."""
    one, two, kind = w.choice(ACCENTS), w.choice(ACCENTS), w.choice(("person", "house", "hills"))
    page.box(one if kind == "person" else TINT, (0.0, 1.0), (0.0, 1.0))
    if kind == "person":
        page.box(two, (0.2, 0.8), (0.0, 0.36))
        page.box(CARD, (0.36, 0.64), (0.36, 0.74))
        page.box(BROWN, (0.34, 0.66), (0.66, 0.80))
    elif kind == "house":
        page.box(GREEN, (0.0, 1.0), (0.0, 0.3))
        page.box(one, (0.3, 0.7), (0.2, 0.55))
        page.box(BROWN, (0.24, 0.76), (0.55, 0.68))
    else:
        page.box(CREAM, (0.62, 0.78), (0.66, 0.84))
        page.box(one, (0.0, 1.0), (0.0, 0.5))
        page.box(GREEN, (0.0, 0.7), (0.0, 0.32))


class Page:
    """Layers of flat shapes on a surface; places are shares of its width, from its right, and of its height."""

    def __init__(
        self, x: float, y: Range, z: Range, tilt: float = 0.0, turn: float = 0.0, *, mesh: PaletteMesh | None = None
    ) -> None:
        """Starts a picture in front of x in a new mesh, or in one that is shared with other pictures."""
        self._mesh, self._y, self._z, self._layer = mesh or PaletteMesh(), y, z, 0
        self._middle = (x, 0.5 * (y[0] + y[1]), 0.5 * (z[0] + z[1]))
        self._tilt, self._turn = tilt, turn

    def box(self, column: int, across: Range, up: Range) -> None:
        """Adds a rectangle in front of all earlier shapes."""
        (y0, y1), (z0, z1) = self._y, self._z
        self._layer += 1
        half_y, half_z = 0.5 * (across[1] - across[0]) * (y1 - y0), 0.5 * (up[1] - up[0]) * (z1 - z0)
        out, along, rise = self._layer * _STEP_M, 0.5 * (across[0] + across[1]), 0.5 * (up[0] + up[1])
        dy, dz = y0 + along * (y1 - y0) - self._middle[1], z0 + rise * (z1 - z0) - self._middle[2]
        cos, sin = math.cos(self._tilt), math.sin(self._tilt)
        dx, dz = out * cos + dz * sin, dz * cos - out * sin
        cos, sin = math.cos(self._turn), math.sin(self._turn)
        cx, cy = self._middle[0] + dx * cos - dy * sin, self._middle[1] + dx * sin + dy * cos
        cz = self._middle[2] + dz
        self._mesh.box(around(cx, 0.0004), around(cy, half_y), around(cz, half_z), column,
                       tilt=self._tilt, turn=self._turn)  # fmt: skip

    def disc(self, column: int, across: float, up: float, radius: float) -> None:
        """Adds a round shape of two crossed rectangles; `radius` is a share of the height."""
        wide = radius * (self._z[1] - self._z[0]) / (self._y[1] - self._y[0])
        for a, b in ((1.0, 0.6), (0.6, 1.0)):
            self.box(column, around(across, a * wide), around(up, b * radius))

    def put(self, w: Workbench, *, emission: float = 0.35) -> None:
        """Adds the picture to the item as one geom that emits this share of its colours."""
        self._mesh.put(w, emission=emission)
