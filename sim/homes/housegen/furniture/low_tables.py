"""Coffee, side, bedside and hall tables.

Sizes follow Panero & Zelnik, Human Dimension and Interior Space (coffee tables 0.33-0.48 m high), and usual retail
dimensions (side and bedside tables 0.45-0.65 m high and 0.35-0.55 m wide; consoles 0.75-0.85 m high and 0.30-0.42 m
deep).
"""

from __future__ import annotations

import math

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, centred, inset, polar
from sim.homes.housegen.furniture.shapes import hoop
from sim.homes.housegen.furniture.workbench import Workbench


def coffee_shelf(w: Workbench) -> None:
    """Builds a low rectangular table with a shelf between its legs."""
    width, depth, height = w.width(0.90, 1.25), w.depth(0.50, 0.65), w.length(0.40, 0.47)
    wood = w.look("wood")
    x, y = parts.slab(w, depth, width, (height - 0.035, height), wood)
    w.legs(inset(x, 0.01), inset(y, 0.01), (0.0, height - 0.035), 0.05, wood)
    w.box(inset(x, 0.03), inset(y, 0.03), (0.13, 0.15), wood)


def coffee_drum(w: Workbench) -> None:
    """Builds a coffee table that is a solid drum."""
    radius, height = 0.5 * w.width(0.65, 0.90), w.length(0.33, 0.42)
    parts.round_top(w, radius, (height - 0.02, height), w.look("wood"))
    w.cylinder(
        (0.0, 0.0), (0.0, height - 0.02), radius - 0.02, w.look("wicker") if w.chance(0.5) else w.look("lacquer")
    )


def coffee_glass(w: Workbench) -> None:
    """Builds a coffee table with a glass sheet on a brass frame and a wooden shelf below it."""
    width, depth, height, metal = w.width(0.90, 1.20), w.depth(0.55, 0.70), w.length(0.38, 0.45), w.look("brass")
    x, y = parts.slab(w, depth, width, (height - 0.012, height), w.look("glass"))
    w.legs(x, y, (0.0, height - 0.012), 0.02, metal)
    w.box(inset(x, 0.02), inset(y, 0.02), (0.118, 0.13), w.look("wood"))
    for z in (height - 0.022, 0.12):
        for side in BOTH_SIDES:
            w.box(
                x,
                (side * 0.5 * width - 0.01 - 0.01 * side, side * 0.5 * width + 0.01 - 0.01 * side),
                around(z, 0.01),
                metal,
                solid=False,
            )
            w.box(
                (side * 0.5 * depth - 0.01 - 0.01 * side, side * 0.5 * depth + 0.01 - 0.01 * side),
                y,
                around(z, 0.01),
                metal,
                solid=False,
            )


def coffee_hairpin(w: Workbench) -> None:
    """Builds a coffee table with a thick round board on three hairpin legs."""
    radius, height, iron = 0.5 * w.width(0.70, 0.95), w.length(0.38, 0.45), w.look("iron")
    parts.round_top(w, radius, (height - 0.04, height), w.look("wood"))
    for i in range(3):
        a = math.tau * i / 3 + 0.5
        foot = (*polar(0.78 * radius, a), 0.006)
        for turn in (-0.22, 0.22):
            head = (*polar(0.62 * radius, a + turn), height - 0.04)
            w.rod(foot, head, 0.006, iron, round_ends=True)


def coffee_blocks(w: Workbench) -> None:
    """Builds a coffee table with a stone slab on two stone blocks."""
    width, depth, height, stone = w.width(0.95, 1.25), w.depth(0.55, 0.70), w.length(0.32, 0.38), w.look("stone")
    parts.slab(w, depth, width, (height - 0.05, height), stone)
    for y in (-0.28 * width, 0.28 * width):
        w.box((-0.36 * depth, 0.36 * depth), around(y, 0.07), (0.0, height - 0.05), stone)


def side_tripod(w: Workbench) -> None:
    """Builds a small round table on three legs."""
    radius, height, wood = 0.5 * w.width(0.38, 0.52), w.length(0.48, 0.60), w.look("wood")
    parts.round_top(w, radius, (height - 0.022, height), w.look("lacquer") if w.chance(0.4) else wood)
    for i in range(3):
        a = math.tau * i / 3 + 0.4
        c, s = math.cos(a), math.sin(a)
        w.rod(
            (0.9 * radius * c, 0.9 * radius * s, 0.012),
            (0.5 * radius * c, 0.5 * radius * s, height - 0.02),
            0.014,
            wood,
            round_ends=True,
        )


def side_cube(w: Workbench) -> None:
    """Builds an open cube with a top, two sides and a shelf."""
    width, height, wood = w.width(0.38, 0.50), w.length(0.45, 0.58), w.look("wood")
    depth = w.depth(0.35, 0.45)
    x, y = parts.slab(w, depth, width, (height - 0.02, height), wood)
    for side in BOTH_SIDES:
        w.box(x, around(side * (0.5 * width - 0.01), 0.01), (0.0, height - 0.02), wood)
    w.box((x[0], x[1] - 0.01), inset(y, 0.02), (0.16, 0.18), wood)
    w.box((x[0], x[0] + 0.01), inset(y, 0.02), (0.18, height - 0.02), wood)


def bedside_legs(w: Workbench) -> None:
    """Builds a bedside table: one drawer box on four legs."""
    width, depth, height = w.width(0.40, 0.52), w.depth(0.36, 0.44), w.length(0.48, 0.62)
    wood, legs = w.look("lacquer") if w.chance(0.4) else w.look("wood"), w.look("wood")
    x, y = parts.slab(w, depth, width, (height - 0.02, height), wood)
    w.box(inset(x, 0.01, 0.02), inset(y, 0.01), (height - 0.20, height - 0.02), wood)
    parts.plain_drawers(
        w,
        x[1] - 0.02,
        inset(y, 0.01),
        (height - 0.195, height - 0.025),
        1,
        1,
        wood,
        w.look("brass"),
        w.choice(("knob", "bar")),
    )
    w.legs(inset(x, 0.03, 0.04), inset(y, 0.03), (0.0, height - 0.19), 0.03, legs, splay=0.015)


def bedside_wire(w: Workbench) -> None:
    """Builds a bedside table: a round tray on a wire basket."""
    radius, height, iron = 0.5 * w.width(0.40, 0.48), w.length(0.46, 0.56), w.look("iron")
    parts.round_top(w, radius, (height - 0.015, height), w.look("wood"))
    n = 8
    for i in range(n):
        a = math.tau * i / n
        w.rod((*polar(0.72 * radius, a), 0.0), (*polar(0.92 * radius, a), height - 0.01), 0.005, iron)
    w.cylinder((0.0, 0.0), (0.0, 0.012), 0.75 * radius, iron)


def console(w: Workbench) -> None:
    """Builds a narrow hall table with slender legs and one or two drawers."""
    width, depth, height = w.width(0.90, 1.30), w.depth(0.30, 0.40), w.length(0.76, 0.84)
    wood = w.look("wood")
    x, y = parts.slab(w, depth, width, (height - 0.025, height), wood)
    w.box(inset(x, 0.01, 0.03), inset(y, 0.03), (height - 0.15, height - 0.025), wood)
    parts.plain_drawers(
        w, x[1] - 0.03, inset(y, 0.04), (height - 0.145, height - 0.03), 1, 2, wood, w.look("brass"), "knob"
    )
    w.legs(inset(x, 0.01, 0.02), inset(y, 0.02), (0.0, height - 0.025), 0.04, wood)


def console_arc(w: Workbench) -> None:
    """Builds a narrow hall table: a stone shelf on two metal hoops."""
    width, depth, height, metal = w.width(0.90, 1.20), w.depth(0.30, 0.38), w.length(0.76, 0.82), w.look("brass")
    parts.slab(w, depth, width, (height - 0.03, height), w.look("stone"))
    for y in centred(width, 0.10):
        w.box(centred(depth, 0.02), around(y, 0.012), (0.0, 0.025), metal)
        for x in centred(depth, 0.03):
            w.box(around(x, 0.012), around(y, 0.012), (0.0, height - 0.03), metal)
    w.rod(
        (-0.5 * depth + 0.03, -0.5 * width + 0.10, 0.02),
        (-0.5 * depth + 0.03, 0.5 * width - 0.10, height - 0.04),
        0.008,
        metal,
    )


def console_drawers(w: Workbench) -> None:
    """Builds a narrow table with two drawers, a lower shelf and turned legs."""
    width, depth, height = w.width(0.90, 1.30), w.depth(0.30, 0.38), w.length(0.76, 0.84)
    wood, metal = w.look("wood"), w.look("brass")
    x, y = parts.footprint(depth, width)
    w.box(x, y, (height - 0.025, height), wood)
    w.box(inset(x, 0.02, 0.025), inset(y, 0.02), (height - 0.16, height - 0.025), wood)
    for c in (-0.24 * width, 0.24 * width):
        w.box((x[1] - 0.025, x[1] - 0.012), around(c, 0.2 * width), (height - 0.15, height - 0.035), wood, solid=False)
        w.ball((x[1] - 0.004, c, height - 0.09), 0.014, metal, solid=False)
    w.legs(inset(x, 0.03), inset(y, 0.03), (0.0, height - 0.15), 0.045, wood, round_=True)
    w.box(inset(x, 0.02), inset(y, 0.02), (0.14, 0.16), wood)
    w.top(x, y, height)


def drum_stool_table(w: Workbench) -> None:
    """Builds a small round table with a hoop near the floor on three legs."""
    r, height, wood, metal = 0.5 * w.width(0.42, 0.52), w.length(0.48, 0.56), w.look("wood"), w.look("iron")
    w.cylinder((0.0, 0.0), (height - 0.03, height), r, wood)
    for n in range(3):
        a = math.tau * n / 3
        w.rod((*polar(0.8 * r, a), 0.0), (*polar(0.6 * r, a), height - 0.03), 0.012, metal)
    w.mesh(hoop(0.78 * r, 0.02, 0.02), (0.0, 0.0, 0.12), metal, solid=False)
    half = 0.62 * r
    w.top((-half, half), (-half, half), height)


STYLES = (
    Style("table", "coffee_shelf", "train", coffee_shelf, ("coffee",)),
    Style("table", "coffee_drum", "train", coffee_drum, ("coffee",)),
    Style("table", "coffee_glass", "train", coffee_glass, ("coffee",)),
    Style("table", "coffee_hairpin", "heldout", coffee_hairpin, ("coffee",)),
    Style("table", "coffee_blocks", "heldout", coffee_blocks, ("coffee",)),
    Style("table", "side_tripod", "train", side_tripod, ("side",)),
    Style("table", "side_cube", "train", side_cube, ("side", "nightstand")),
    Style("table", "bedside_legs", "train", bedside_legs, ("nightstand",)),
    Style("table", "bedside_wire", "heldout", bedside_wire, ("nightstand", "side")),
    Style("table", "console", "train", console, ("console",)),
    Style("table", "console_arc", "heldout", console_arc, ("console",)),
    Style("table", "console_drawers", "heldout", console_drawers, ("console",)),
    Style("table", "drum_stool_table", "heldout", drum_stool_table, ("side",)),
)
