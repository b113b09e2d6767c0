"""Shelves with books and small objects.

Sizes follow Neufert, Architects' Data (book shelves 0.25-0.38 m deep, 0.28-0.36 m between boards, to 2.05 m high).
"""

from __future__ import annotations

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts import around, centred, inset
from sim.homes.housegen.furniture.shapes import chamfered_box, turned
from sim.homes.housegen.furniture.workbench import Range, Workbench


def _books(w: Workbench, x: Range, y: Range, z: float, room: float) -> None:
    """Adds a row of books on a board at height z: one box with painted spines, sometimes with a single leaning book."""
    high = min(room - 0.03, w.length(0.20, 0.26))
    wide = max(high + 0.02, (y[1] - y[0]) * w.length(0.55, 0.95))
    wide = min(wide, y[1] - y[0])
    start = y[0] if w.chance(0.5) else y[1] - wide
    w.box(
        (x[0] + 0.02, min(x[1] - 0.02, x[0] + 0.02 + 0.85 * high)),
        (start, start + wide),
        (z, z + high),
        w.new_look("books"),
        solid=False,
    )


def _boards(w: Workbench, x: Range, y: Range, levels: list[float], thick: float, look: Look) -> None:
    for z in levels:
        w.box(x, y, (z, z + thick), look)


def bookcase(w: Workbench) -> None:
    """Builds a tall bookcase with five boards full of books."""
    width, depth, height = w.width(0.70, 1.00), w.depth(0.28, 0.34), w.height(1.80, 2.05)
    look = parts.wood_look(w)
    x, y = parts.footprint(depth, width)
    for edge in centred(width, 0.011):
        w.box(x, around(edge, 0.011), (0.0, height), look)
    w.box((x[0], x[0] + 0.008), inset(y, 0.022), (0.04, height), look)
    count = 5
    step = (height - 0.10) / count
    levels = [0.06 + i * step for i in range(count)]
    _boards(w, (x[0] + 0.008, x[1]), inset(y, 0.022), [*levels, height - 0.022], 0.022, look)
    w.box((x[0], x[1] - 0.02), inset(y, 0.022), (0.0, 0.06), look)
    for z in levels:
        _books(w, (x[0], x[1]), inset(y, 0.03), z + 0.022, step - 0.022)


def ladder_shelf(w: Workbench) -> None:
    """Builds a leaning ladder with four boards that get deeper towards the floor."""
    width, height, depth = w.width(0.55, 0.75), w.height(1.70, 1.90), w.depth(0.40, 0.48)
    wood = w.look("wood")
    x0, x1, y = -0.5 * depth, 0.5 * depth, centred(width)
    for edge in centred(width, 0.015):
        w.bar((x1 - 0.02, edge, 0.0), (x0 + 0.02, edge, height), 0.03, 0.03, wood)
    for i in range(4):
        z = 0.25 + i * (height - 0.45) / 3
        front = x1 - (x1 - x0) * z / height
        w.box((x0, front), y, (z, z + 0.022), wood)
        w.box((x0, x0 + 0.012), y, (z + 0.022, z + 0.06), wood, solid=False)
        if i < 3:
            _books(w, (x0, max(front, x0 + 0.2)), inset(y, 0.04), z + 0.022, 0.4)
    w.bar((x0 + 0.02, 0.0, height - 0.02), (x0 + 0.02, 0.0, height), width, 0.03, wood)


def wall_boards(w: Workbench) -> None:
    """Builds two or three boards on the wall with books and a vase."""
    width, depth, count = w.width(0.70, 1.20), w.depth(0.20, 0.26), w.whole(2, 3)
    look, metal, y = parts.wood_look(w), w.look("iron"), centred(width)
    w.mount_height_m = 1.15
    for i in range(count):
        z = 0.14 + 0.36 * i
        w.box((0.0, depth), y, (z, z + 0.025), look)
        for edge in (-0.36 * width, 0.36 * width):
            w.bar((0.006, edge, z - 0.12), (depth - 0.05, edge, z), 0.012, 0.012, metal, solid=False)
        _books(w, (0.0, depth), inset(y, 0.06, 0.20), z + 0.025, 0.30)
        w.ellipsoid((0.5 * depth, y[1] - 0.10, z + 0.095), (0.06, 0.06, 0.07), w.new_look("ceramic"), solid=False)


def pipe_shelf(w: Workbench) -> None:
    """Builds a steel frame with boards and a crossed back."""
    width, depth, height = w.width(0.80, 1.10), w.depth(0.32, 0.38), w.height(1.60, 1.85)
    iron, wood = w.look("iron"), w.look("wood")
    x, y = parts.footprint(depth, width)
    w.legs(x, y, (0.0, height), 0.028, iron)
    levels = [0.12 + i * (height - 0.16) / 3 for i in range(4)]
    _boards(w, x, y, levels, 0.035, wood)
    w.bar((x[0] + 0.01, y[0] + 0.02, 0.14), (x[0] + 0.01, y[1] - 0.02, height - 0.02), 0.008, 0.008, iron, solid=False)
    w.bar((x[0] + 0.01, y[1] - 0.02, 0.14), (x[0] + 0.01, y[0] + 0.02, height - 0.02), 0.008, 0.008, iron, solid=False)
    for z in levels[:3]:
        _books(w, x, inset(y, 0.05), z + 0.035, 0.4)


def etagere(w: Workbench) -> None:
    """Builds a shelf with glass boards between slim brass posts, with vases and a few books."""
    width, depth, height = w.width(0.60, 0.85), w.depth(0.32, 0.38), w.height(1.60, 1.85)
    brass, glass = w.look("brass"), parts.tinted_glass(w.look("glass"))
    x, y = parts.footprint(depth, width)
    w.legs(inset(x, 0.01), inset(y, 0.01), (0.0, height), 0.02, brass, round_=True)
    for i in range(4):
        z = 0.10 + i * (height - 0.13) / 3
        w.box(x, y, (z, z + 0.012), glass)
        w.box((x[1] - 0.008, x[1]), y, (z - 0.008, z + 0.014), brass, solid=False)
        if i in (0, 2):
            _books(w, x, inset(y, 0.06), z + 0.012, 0.4)
        elif i == 1:
            w.ellipsoid((0.0, 0.1, z + 0.112), (0.08, 0.08, 0.10), w.look("pot"), solid=False)
            w.cylinder((0.0, -0.14), (z + 0.012, z + 0.17), 0.045, w.look("ceramic"), solid=False)


def niches(w: Workbench) -> None:
    """Builds open boxes of different sizes on the wall, with books and vases in them."""
    width, depth, look = w.width(0.80, 1.20), w.depth(0.20, 0.25), parts.wood_look(w)
    w.mount_height_m = 1.10
    y0 = -0.5 * width
    cells = ((y0, y0 + 0.55 * width, 0.0, 0.36), (y0 + 0.45 * width, y0 + width, 0.36, 0.72))
    for low, high, z0, z1 in cells:
        for z in (z0, z1 - 0.018):
            w.box((0.0, depth), (low, high), (z, z + 0.018), look)
        for c in (low, high - 0.018):
            w.box((0.0, depth), (c, c + 0.018), (z0 + 0.018, z1 - 0.018), look)
        w.box((0.0, 0.008), (low, high), (z0, z1), look)
        _books(w, (0.008, depth), (low + 0.03, high - 0.10), z0 + 0.018, z1 - z0 - 0.04)
    w.mesh(
        turned([(0.0, 0.04), (0.10, 0.06), (0.17, 0.03)], 12, hull=True),
        (0.5 * depth, y0 + 0.18 * width, 0.36),
        w.look("pot"),
        solid=False,
    )


def cubes(w: Workbench) -> None:
    """Builds square pigeonholes with boxes or books; hint `width_m` determines their number."""
    look = parts.wood_look(w)
    width = w.width(0.74, 1.50)
    columns, rows = max(1, round((width - 0.04) / 0.36)), w.whole(2, 4)
    cell, depth = (width - 0.03) / columns, 0.38
    height = rows * 0.36 + 0.04
    x, y = parts.footprint(depth, width)
    for i in range(columns + 1):
        c = y[0] + 0.015 + i * cell
        w.box(x, around(c, 0.015), (0.0, height), look)
    for j in range(rows + 1):
        c = 0.02 + j * 0.36
        w.box(x, y, around(c, 0.015), look)
    w.box((x[0], x[0] + 0.006), y, (0.0, height), look)
    for i in range(columns):
        for j in range(rows):
            y0, z0 = y[0] + 0.035 + i * cell, 0.035 + j * 0.36
            if w.chance(0.45):
                w.mesh(
                    chamfered_box((0.33, round(cell - 0.05, 2), 0.30), 0.02),
                    (0.0, y0 + 0.5 * cell - 0.02, z0 + 0.15),
                    w.new_look("fabric"),
                    solid=False,
                )
            elif w.chance(0.6):
                _books(w, x, (y0, y0 + cell - 0.04), z0, 0.33)
    w.top(inset(x, 0.03), inset(y, 0.05), height)


STYLES = (
    Style("shelving", "bookcase", "train", bookcase, ("bookcase",)),
    Style("shelving", "ladder_shelf", "train", ladder_shelf, ("bookcase",)),
    Style("shelving", "wall_boards", "train", wall_boards, ("wall",), "wall"),
    Style("shelving", "pipe_shelf", "heldout", pipe_shelf, ("bookcase",)),
    Style("shelving", "etagere", "heldout", etagere, ("bookcase",)),
    Style("shelving", "niches", "heldout", niches, ("wall",), "wall"),
    Style("shelving", "cubes", "train", cubes, ("bookcase",)),
)
