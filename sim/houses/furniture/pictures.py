"""Flat things on walls: pictures, mirrors, boards.

Usual retail dimensions: pictures 0.30-1.20 m wide, hung with their middle at 1.45-1.60 m; mirrors 0.45-0.80 m wide.
"""

from __future__ import annotations

from sim.houses.furniture.catalogue import Style
from sim.houses.furniture.item import Look
from sim.houses.furniture.workbench import Workbench

_BOTH = (-1, 1)


def _frame(w: Workbench, width: float, height: float, border: float, thick: float, look: Look) -> None:
    """Four mouldings round a rectangle that starts at z = 0 on the wall."""
    y = 0.5 * width
    w.box((0.0, thick), (-y, y), (0.0, border), look)
    w.box((0.0, thick), (-y, y), (height - border, height), look)
    for side in _BOTH:
        c = side * (y - 0.5 * border)
        w.box((0.0, thick), (c - 0.5 * border, c + 0.5 * border), (border, height - border), look)


def framed_abstract(w: Workbench) -> None:
    """Framed sheet with mat and three to five coloured shapes."""
    width, height = w.width(0.40, 1.00), w.height(0.40, 0.90)
    w.mount_height_m = 1.52 - 0.5 * height
    border = w.length(0.02, 0.045)
    _frame(w, width, height, border, 0.03, w.look("wood") if w.chance(0.6) else w.look("dark"))
    w.box(
        (0.0, 0.012),
        (-0.5 * width + border, 0.5 * width - border),
        (border, height - border),
        w.look("paper"),
        solid=False,
    )
    inner_y, inner_z = 0.5 * width - border - 0.04, 0.5 * height - border - 0.04
    for i in range(w.whole(3, 5)):
        dy, dz = w.length(0.2, 0.6) * inner_y, w.length(0.2, 0.6) * inner_z
        y = w.length(-1.0, 1.0) * (inner_y - dy)
        z = 0.5 * height + w.length(-1.0, 1.0) * (inner_z - dz)
        x = 0.013 + 0.002 * i
        if w.chance(0.5):
            w.box((0.010, x), (y - dy, y + dy), (z - dz, z + dz), w.new_look("paint"), solid=False)
        else:
            w.rod((0.010, y, z), (x, y, z), min(dy, dz), w.new_look("paint"), solid=False)


def canvas_landscape(w: Workbench) -> None:
    """Unframed canvas: sky, sun, bands of hills."""
    width, height = w.width(0.60, 1.20), w.height(0.45, 0.80)
    w.mount_height_m = 1.52 - 0.5 * height
    w.box((0.0, 0.032), (-0.5 * width, 0.5 * width), (0.0, height), w.new_look("paint"))
    level, x = 0.55 * height, 0.034
    w.rod(
        (0.03, 0.22 * width, 0.70 * height),
        (x, 0.22 * width, 0.70 * height),
        0.12 * height,
        w.new_look("paint"),
        solid=False,
    )
    for _ in range(3):
        x += 0.002
        w.box((0.03, x), (-0.5 * width, 0.5 * width), (0.0, level), w.new_look("paint"), solid=False)
        level *= w.length(0.5, 0.75)


def wall_mirror(w: Workbench) -> None:
    """Framed rectangular mirror."""
    width, height = w.width(0.45, 0.80), w.height(0.60, 1.00)
    w.mount_height_m = 1.05
    _frame(w, width, height, 0.025, 0.028, w.look("metal"))
    w.box((0.0, 0.014), (-0.5 * width + 0.02, 0.5 * width - 0.02), (0.02, height - 0.02), w.look("mirror"), solid=False)


def round_mirror(w: Workbench) -> None:
    """Round mirror in a thin rim."""
    r = 0.5 * w.width(0.50, 0.80)
    w.mount_height_m = 1.52 - r
    w.rod((0.0, 0.0, r), (0.022, 0.0, r), r, w.look("brass"))
    w.rod((0.0, 0.0, r), (0.025, 0.0, r), r - 0.02, w.look("mirror"), solid=False)


def cork_board(w: Workbench) -> None:
    """Pin board with notes."""
    width, height = w.width(0.60, 1.00), w.height(0.45, 0.70)
    w.mount_height_m = 1.15
    _frame(w, width, height, 0.02, 0.02, w.look("wood"))
    w.box((0.0, 0.010), (-0.5 * width + 0.015, 0.5 * width - 0.015), (0.015, height - 0.015), w.look("wicker"))
    for _ in range(5):
        y, z = w.length(-0.36, 0.36) * width, height * w.length(0.25, 0.75)
        w.box((0.008, 0.013), (y - 0.05, y + 0.05), (z - 0.06, z + 0.06), w.new_look("paper"), solid=False)


def whiteboard(w: Workbench) -> None:
    """White board with a pen tray."""
    width, height, metal = w.width(0.90, 1.40), w.height(0.60, 0.90), w.look("metal")
    w.mount_height_m = 0.95
    _frame(w, width, height, 0.02, 0.022, metal)
    w.box((0.0, 0.012), (-0.5 * width + 0.015, 0.5 * width - 0.015), (0.015, height - 0.015), w.look("ceramic"))
    w.box((0.0, 0.07), (-0.25 * width, 0.25 * width), (-0.012, 0.0), metal)


STYLES = (
    Style("picture", "framed_abstract", "train", framed_abstract, (), "wall"),
    Style("picture", "canvas_landscape", "heldout", canvas_landscape, (), "wall"),
    Style("mirror", "rectangular", "train", wall_mirror, ("wall",), "wall"),
    Style("mirror", "round", "heldout", round_mirror, ("wall",), "wall"),
    Style("board_panel", "cork_board", "train", cork_board, (), "wall"),
    Style("board_panel", "whiteboard", "heldout", whiteboard, (), "wall"),
)
