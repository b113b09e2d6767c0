"""Boards on walls: cork boards, whiteboards, chalk boards, planners.

Usual retail dimensions: 0.60-1.40 m wide.
"""

from __future__ import annotations

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.parts import around, centred
from sim.homes.housegen.furniture.pictures import frame
from sim.homes.housegen.furniture.workbench import Workbench


def cork_board(w: Workbench) -> None:
    """Builds a pin board with notes."""
    width, height = w.width(0.60, 1.00), w.height(0.45, 0.70)
    w.mount_height_m = 1.15
    frame(w, width, height, 0.02, 0.02, w.look("wood"))
    w.box((0.0, 0.010), centred(width, 0.015), (0.015, height - 0.015), w.look("wicker"))
    for _ in range(5):
        y, z = w.length(-0.36, 0.36) * width, height * w.length(0.25, 0.75)
        w.box((0.008, 0.013), around(y, 0.05), around(z, 0.06), w.new_look("paper"), solid=False)


def whiteboard(w: Workbench) -> None:
    """Builds a white board with a pen tray."""
    width, height, metal = w.width(0.90, 1.40), w.height(0.60, 0.90), w.look("metal")
    w.mount_height_m = 0.95
    frame(w, width, height, 0.02, 0.022, metal)
    w.box((0.0, 0.012), centred(width, 0.015), (0.015, height - 0.015), w.look("ceramic"))
    w.box((0.0, 0.07), (-0.25 * width, 0.25 * width), (-0.012, 0.0), metal)


def chalk_board(w: Workbench) -> None:
    """Builds a black board in a wooden frame with scribbles and a ledge."""
    width, height = w.width(0.60, 1.10), w.height(0.50, 0.80)
    w.mount_height_m = 1.05
    frame(w, width, height, 0.035, 0.025, w.look("wood"))
    w.box((0.0, 0.012), centred(width, 0.03), (0.03, height - 0.03), w.look("char"))
    for i in range(3):
        z = height * (0.72 - 0.17 * i)
        w.box(
            (0.008, 0.014), (-0.36 * width, w.length(0.0, 0.36) * width), around(z, 0.008), w.look("paper"), solid=False
        )
    w.box((0.0, 0.06), (-0.4 * width, 0.4 * width), (0.0, 0.015), w.look("wood"), solid=False)


def planner(w: Workbench) -> None:
    """Builds a wall planner: a grid of coloured cards on a steel sheet."""
    width, height, steel = w.width(0.60, 1.00), w.height(0.50, 0.75), w.look("steel")
    w.mount_height_m = 1.10
    w.box((0.0, 0.012), centred(width), (0.0, height), steel)
    for i in range(4):
        for j in range(3):
            if w.chance(0.75):
                y, z = (i - 1.5) * 0.22 * width, (0.22 + 0.28 * j) * height
                w.box(
                    (0.010, 0.015), around(y, 0.08 * width), around(z, 0.09 * height), w.new_look("paint"), solid=False
                )


STYLES = (
    Style("board_panel", "cork_board", "train", cork_board, (), "wall"),
    Style("board_panel", "whiteboard", "heldout", whiteboard, (), "wall"),
    Style("board_panel", "chalk_board", "train", chalk_board, (), "wall"),
    Style("board_panel", "planner", "heldout", planner, (), "wall"),
)
