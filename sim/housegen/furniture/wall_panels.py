"""Mirrors and boards.

Usual retail dimensions: wall mirrors 0.45-0.80 m wide, full-length ones 1.50-1.80 m high, boards 0.60-1.40 m wide.
"""

from __future__ import annotations

from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.pictures import frame
from sim.housegen.furniture.workbench import Workbench


def wall_mirror(w: Workbench) -> None:
    """Builds a framed rectangular mirror."""
    width, height = w.width(0.45, 0.80), w.height(0.60, 1.00)
    w.mount_height_m = 1.05
    frame(w, width, height, 0.025, 0.028, w.look("metal"))
    w.box((0.0, 0.014), (-0.5 * width + 0.02, 0.5 * width - 0.02), (0.02, height - 0.02), w.look("mirror"), solid=False)


def round_mirror(w: Workbench) -> None:
    """Builds a round mirror in a thin rim."""
    r = 0.5 * w.width(0.50, 0.80)
    w.mount_height_m = 1.52 - r
    w.rod((0.0, 0.0, r), (0.022, 0.0, r), r, w.look("brass"))
    w.rod((0.0, 0.0, r), (0.025, 0.0, r), r - 0.02, w.look("mirror"), solid=False)


def standing_mirror(w: Workbench) -> None:
    """Builds a full-length mirror that leans on a stand."""
    width, height, wood = w.width(0.42, 0.60), w.height(1.50, 1.75), w.look("wood")
    y = 0.5 * width
    lean = 0.12
    for side in BOTH_SIDES:
        w.bar((0.14, side * (y - 0.02), 0.0), (0.14 - lean, side * (y - 0.02), height), 0.04, 0.03, wood)
    for z in (0.12, height - 0.03):
        x = 0.14 - lean * z / height
        w.box((x - 0.015, x + 0.015), (-y, y), (z - 0.025, z + 0.025), wood)
    w.bar((0.137, 0.0, 0.12), (0.143 - lean, 0.0, height - 0.04), 2 * y - 0.06, 0.012, w.look("mirror"))
    w.bar((-0.22, 0.0, 0.0), (0.04, 0.0, 0.72 * height), 0.05, 0.02, wood)
    w.box((0.04, 0.07), (-y + 0.02, y - 0.02), (0.70 * height, 0.73 * height), wood)


def arched_mirror(w: Workbench) -> None:
    """Builds a full-length mirror with a round top that leans on the wall."""
    width, height = w.width(0.50, 0.70), w.height(1.50, 1.80)
    r, metal = 0.5 * width, w.look("metal")
    straight = height - r
    w.box((0.0, 0.03), (-r, r), (0.0, straight), metal)
    w.rod((0.0, 0.0, straight), (0.03, 0.0, straight), r, metal)
    w.box((0.02, 0.034), (-r + 0.02, r - 0.02), (0.02, straight), w.look("mirror"), solid=False)
    w.rod((0.02, 0.0, straight), (0.034, 0.0, straight), r - 0.02, w.look("mirror"), solid=False)


def cork_board(w: Workbench) -> None:
    """Builds a pin board with notes."""
    width, height = w.width(0.60, 1.00), w.height(0.45, 0.70)
    w.mount_height_m = 1.15
    frame(w, width, height, 0.02, 0.02, w.look("wood"))
    w.box((0.0, 0.010), (-0.5 * width + 0.015, 0.5 * width - 0.015), (0.015, height - 0.015), w.look("wicker"))
    for _ in range(5):
        y, z = w.length(-0.36, 0.36) * width, height * w.length(0.25, 0.75)
        w.box((0.008, 0.013), (y - 0.05, y + 0.05), (z - 0.06, z + 0.06), w.new_look("paper"), solid=False)


def whiteboard(w: Workbench) -> None:
    """Builds a white board with a pen tray."""
    width, height, metal = w.width(0.90, 1.40), w.height(0.60, 0.90), w.look("metal")
    w.mount_height_m = 0.95
    frame(w, width, height, 0.02, 0.022, metal)
    w.box((0.0, 0.012), (-0.5 * width + 0.015, 0.5 * width - 0.015), (0.015, height - 0.015), w.look("ceramic"))
    w.box((0.0, 0.07), (-0.25 * width, 0.25 * width), (-0.012, 0.0), metal)


def chalk_board(w: Workbench) -> None:
    """Builds a black board in a wooden frame with scribbles and a ledge."""
    width, height = w.width(0.60, 1.10), w.height(0.50, 0.80)
    w.mount_height_m = 1.05
    frame(w, width, height, 0.035, 0.025, w.look("wood"))
    w.box((0.0, 0.012), (-0.5 * width + 0.03, 0.5 * width - 0.03), (0.03, height - 0.03), w.look("char"))
    for i in range(3):
        z = height * (0.72 - 0.17 * i)
        w.box(
            (0.008, 0.014),
            (-0.36 * width, w.length(0.0, 0.36) * width),
            (z - 0.008, z + 0.008),
            w.look("paper"),
            solid=False,
        )
    w.box((0.0, 0.06), (-0.4 * width, 0.4 * width), (0.0, 0.015), w.look("wood"), solid=False)


def planner(w: Workbench) -> None:
    """Builds a wall planner: a grid of coloured cards on a steel sheet."""
    width, height, steel = w.width(0.60, 1.00), w.height(0.50, 0.75), w.look("steel")
    w.mount_height_m = 1.10
    w.box((0.0, 0.012), (-0.5 * width, 0.5 * width), (0.0, height), steel)
    for i in range(4):
        for j in range(3):
            if w.chance(0.75):
                y, z = (i - 1.5) * 0.22 * width, (0.22 + 0.28 * j) * height
                w.box(
                    (0.010, 0.015),
                    (y - 0.08 * width, y + 0.08 * width),
                    (z - 0.09 * height, z + 0.09 * height),
                    w.new_look("paint"),
                    solid=False,
                )


STYLES = (
    Style("mirror", "rectangular", "train", wall_mirror, ("wall",), "wall"),
    Style("mirror", "round", "heldout", round_mirror, ("wall",), "wall"),
    Style("mirror", "standing", "train", standing_mirror, ("standing",)),
    Style("mirror", "arched", "heldout", arched_mirror, ("standing",), "wall"),
    Style("board_panel", "cork_board", "train", cork_board, (), "wall"),
    Style("board_panel", "whiteboard", "heldout", whiteboard, (), "wall"),
    Style("board_panel", "chalk_board", "train", chalk_board, (), "wall"),
    Style("board_panel", "planner", "heldout", planner, (), "wall"),
)
