"""Fireplaces and stoves.

Sizes follow Neufert, Architects' Data: openings 0.60-1.00 m wide and 0.55-0.80 m high, mantels at 1.05-1.30 m.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, centred, inset, polar
from sim.homes.housegen.furniture.parts.leaves import Body, joined, tube
from sim.homes.housegen.furniture.shapes import turned
from sim.homes.housegen.furniture.workbench import Range, Workbench

_SHARES = ((0.0, 0.55, 0.0), (0.28, 1.0, 0.25), (0.62, 0.6, -0.3), (1.0, 0.0, 0.35))
"""Height and radius of the rings of a flame, as shares of its own, and how far they are shifted, in radii."""


def _opening(w: Workbench, x: Range, half: float, z: Range, outer: float, top: float, look: Look) -> None:
    """Adds a block from x[0] to x[1] with a dark recess |y| < `half` between heights z.

    The block is 2 * `outer` wide and `top` high.
    """
    char = w.look("char")
    for side in BOTH_SIDES:
        w.box(x, parts.on_side(side, half, outer), (0.0, top), look)
    w.box(x, (-half, half), (z[1], top), look)
    w.box((x[0], x[0] + 0.04), (-half, half), (0.0, z[1]), char)
    if z[0] > 0:
        w.box((x[0] + 0.04, x[1]), (-half, half), (0.0, z[0]), look)
    for edge in inset((-half, half), 0.004):
        w.box(inset(x, 0.04, 0.02), around(edge, 0.004), z, char, solid=False)


def _logs(w: Workbench, x: float, z: float, half: float) -> None:
    """Adds logs on a grate and one or two flames."""
    wood = w.look("wood")
    w.rod_y((x, z + 0.05), (-0.6 * half, 0.6 * half), 0.05, wood)
    w.rod((x - 0.06, -0.5 * half, z + 0.13), (x + 0.05, 0.5 * half, z + 0.13), 0.042, wood)
    if w.chance(0.6):
        tongues = ((-0.35 * half, 0.17, 0.05), (-0.08 * half, 0.30, 0.065), (0.28 * half, 0.22, 0.055))
        flames(w, x - 0.01, z + 0.12, tongues)


def mantel(w: Workbench) -> None:
    """Builds a classic surround: pilasters, a frieze and a shelf around a dark opening on a hearth."""
    half, high = 0.5 * w.length(0.62, 0.80), w.length(0.62, 0.74)
    outer, top, depth = half + w.length(0.18, 0.26), w.length(1.08, 1.22), w.length(0.30, 0.36)
    look = w.look("lacquer") if w.chance(0.5) else w.look("stone")
    _opening(w, (0.0, depth), half, (0.0, high), outer, top - 0.05, look)
    w.box((0.0, depth + 0.08), (-outer - 0.07, outer + 0.07), (top - 0.05, top), look)
    w.box((0.0, depth + 0.03), (-outer - 0.02, outer + 0.02), (top - 0.09, top - 0.05), look, solid=False)
    for side in BOTH_SIDES:
        c = side * (half + 0.5 * (outer - half))
        w.box((depth, depth + 0.025), around(c, 0.06), (0.0, top - 0.09), look, solid=False)
    w.box((depth, depth + 0.32), (-outer, outer), (0.0, 0.04), w.look("stone"))
    _logs(w, 0.5 * depth + 0.03, 0.0, half)
    w.top((0.05, depth + 0.03), (-outer, outer), top)


def stove_iron(w: Workbench) -> None:
    """Builds an iron stove on legs with a glazed door and a flue pipe to the ceiling."""
    iron, width, depth = w.look("iron"), w.length(0.48, 0.60), w.length(0.40, 0.46)
    w.box(centred(depth), centred(width), (0.22, 0.82), iron)
    w.legs(centred(depth, 0.02), centred(width, 0.02), (0.0, 0.23), 0.05, iron)
    w.box((-0.5 * depth - 0.02, 0.5 * depth + 0.03), (-0.5 * width - 0.03, 0.5 * width + 0.03), (0.82, 0.85), iron)
    w.box((0.5 * depth, 0.5 * depth + 0.02), (-0.38 * width, 0.38 * width), (0.30, 0.74), iron, solid=False)
    front = 0.5 * depth + 0.02
    w.box((front, front + 0.006), (-0.29 * width, 0.29 * width), (0.37, 0.67), w.look("char"), solid=False)
    flames(w, front, 0.38, ((-0.15 * width, 0.15, 0.035), (0.0, 0.24, 0.045), (0.14 * width, 0.18, 0.035)))
    w.cylinder((0.5 * depth + 0.035, 0.34 * width), (0.46, 0.58), 0.012, w.look("brass"), solid=False)
    w.cylinder((-0.05, 0.0), (0.84, 2.30), 0.075, iron)
    w.box(
        (-0.5 * depth - 0.08, 0.5 * depth + 0.30),
        (-0.5 * width - 0.18, 0.5 * width + 0.18),
        (0.0, 0.02),
        w.look("stone"),
    )


def brick_breast(w: Workbench) -> None:
    """Builds a brick chimney breast to the ceiling with a timber beam over the opening and a raised hearth."""
    half, high = 0.5 * w.length(0.65, 0.85), w.length(0.62, 0.74)
    outer, depth, top = half + w.length(0.25, 0.40), w.length(0.40, 0.50), w.height(2.45, 2.55)
    brick = w.look("masonry")
    _opening(w, (0.0, depth), half, (0.12, 0.12 + high), outer, top, brick)
    w.box(
        (depth - 0.02, depth + 0.10),
        (-half - 0.18, half + 0.18),
        (0.12 + high + 0.12, 0.12 + high + 0.26),
        w.look("wood"),
    )
    w.box((depth, depth + 0.35), (-outer, outer), (0.0, 0.12), w.look("stone"))
    _logs(w, 0.5 * depth + 0.04, 0.12, half)
    w.top((depth - 0.01, depth + 0.09), (-half - 0.12, half + 0.12), 0.12 + high + 0.26)


def linear(w: Workbench) -> None:
    """Builds a modern block with a long low fire slot."""
    outer, depth, top = 0.5 * w.width(1.40, 1.90), w.length(0.30, 0.38), w.length(1.05, 1.30)
    body = w.look("lacquer") if w.chance(0.5) else w.look("stone")
    half, z = 0.82 * outer, (0.32, 0.62)
    _opening(w, (0.0, depth), half, z, outer, top, body)
    w.box((0.05, depth - 0.03), (-half + 0.02, half - 0.02), (z[0], z[0] + 0.03), w.look("char"), solid=False)
    flames(w, 0.5 * depth, z[0] + 0.02, [((i - 3) * 0.27 * half, 0.13 + 0.04 * (i % 3), 0.04) for i in range(7)])
    w.top((0.04, depth - 0.04), (-outer + 0.05, outer - 0.05), top)


def rustic_stone(w: Workbench) -> None:
    """Builds a stepped stone surround with a thick wooden mantel board on corbels."""
    half, high = 0.5 * w.length(0.70, 0.90), w.length(0.65, 0.78)
    outer, depth, stone = half + w.length(0.28, 0.40), w.length(0.38, 0.46), w.look("masonry")
    top = high + 0.42
    _opening(w, (0.0, depth), half, (0.0, high), outer, top - 0.09, stone)
    w.box((0.0, 0.8 * depth), (-0.72 * outer, 0.72 * outer), (top, top + 0.55), stone)
    w.box((0.0, depth + 0.14), (-outer - 0.08, outer + 0.08), (top - 0.09, top), w.look("wood"))
    for c in inset((-outer, outer), 0.16):
        w.box((depth, depth + 0.09), around(c, 0.06), (top - 0.22, top - 0.09), stone, solid=False)
    w.box((depth, depth + 0.38), (-outer, outer), (0.0, 0.06), w.look("stone"))
    w.box((depth - 0.10, depth - 0.08), (-half + 0.03, half - 0.03), (0.0, 0.30), w.look("iron"), solid=False)
    _logs(w, 0.45 * depth, 0.0, half)
    w.top((depth - 0.05, depth + 0.12), (-outer, outer), top)


def electric(w: Workbench) -> None:
    """Builds a free-standing cabinet with a framed dark hearth between shelves."""
    outer, depth, top = 0.5 * w.width(1.20, 1.50), w.length(0.34, 0.40), w.length(0.85, 1.0)
    wood = parts.wood_look(w)
    half, high = 0.40, 0.62
    w.box((0.0, depth), (-outer, outer), (top - 0.04, top), wood)
    w.box((0.0, depth), (-outer, outer), (0.0, 0.08), wood)
    w.box((0.0, 0.015), (-outer, outer), (0.08, top - 0.04), wood)
    for c in (-outer + 0.0125, -half - 0.0125, half + 0.0125, outer - 0.0125):
        w.box((0.015, depth), around(c, 0.0125), (0.08, top - 0.04), wood)
    w.box((0.015, depth), (-half, half), (0.08 + high, top - 0.04), wood)
    w.box((0.015, depth - 0.03), (-half, half), (0.08, 0.08 + high), w.look("char"))
    flames(w, depth - 0.04, 0.14, [((i - 2) * 0.11, 0.18 + 0.07 * ((2 * i) % 3), 0.045) for i in range(5)])
    w.rod_y((depth - 0.03, 0.13), (-0.28, 0.28), 0.028, w.look("wood"), solid=False)
    for side in BOTH_SIDES:
        w.box((0.015, depth - 0.01), parts.on_side(side, half + 0.025, outer - 0.025), (0.46, 0.48), wood)
    w.top((0.04, depth - 0.04), (-outer + 0.05, outer - 0.05), top)


def suspended(w: Workbench) -> None:
    """Builds a conical metal hearth that hangs from its flue over a round stone."""
    iron, r, top = w.look("iron"), w.length(0.42, 0.52), w.height(2.35, 2.50)
    w.cylinder((0.0, 0.0), (0.0, 0.05), r + 0.12, w.look("stone"))
    w.mesh(turned([(0.28, 0.5 * r), (0.40, r), (0.46, r), (0.46, 0.9 * r), (0.36, 0.5 * r)], 16), (0.0, 0.0, 0.0), iron)
    w.cylinder((0.0, 0.0), (0.04, 0.30), 0.10, iron)
    w.mesh(turned([(0.86, 0.95 * r), (1.30, 0.12), (1.32, 0.12)], 16, hull=True), (0.0, 0.0, 0.0), iron)
    w.cylinder((0.0, 0.0), (1.30, top), 0.09, iron)
    for i in range(3):
        a = math.tau * i / 3 + 0.5
        w.rod((*polar(0.88 * r, a), 0.42), (*polar(0.88 * r, a), 0.90), 0.012, iron, solid=False)
    wood = w.look("wood")
    for a in (0.3, 1.4, 2.5):
        w.rod((*polar(-0.5 * r, a), 0.42), (*polar(0.5 * r, a), 0.46), 0.04, wood, solid=False)
    flames(w, 0.0, 0.46, ((-0.09, 0.2, 0.055), (0.0, 0.34, 0.075), (0.1, 0.24, 0.055)))


def tiled_stove(w: Workbench) -> None:
    """Builds a tall tiled stove: a stepped tower with a small iron door and a bench around its foot."""
    tile, width, depth = w.look("pot"), w.length(0.75, 0.90), w.length(0.60, 0.70)
    half = 0.5 * width
    w.box((0.0, depth + 0.22), (-half - 0.20, half + 0.20), (0.0, 0.42), tile)
    w.box((0.0, depth), (-half, half), (0.42, 1.35), tile)
    w.box((0.0, depth + 0.03), (-half - 0.03, half + 0.03), (1.35, 1.42), tile)
    w.box((0.0, depth - 0.08), (-half + 0.08, half - 0.08), (1.42, 2.0), tile)
    w.box((0.0, depth - 0.05), (-half + 0.05, half - 0.05), (2.0, 2.06), tile)
    grout = w.look("linen")
    for z in (0.65, 0.88, 1.12):
        w.box(around(depth, 0.003), (-half, half), around(z, 0.006), grout, solid=False)
    for i in range(1, 4):
        c = -half + i * width / 4
        w.box(around(depth, 0.003), around(c, 0.006), (0.42, 1.35), grout, solid=False)
    w.box((depth + 0.20, depth + 0.23), (-0.15, 0.15), (0.10, 0.34), w.look("iron"), solid=False)
    w.box((depth + 0.225, depth + 0.233), (-0.11, 0.11), (0.13, 0.31), w.look("char"), solid=False)
    flames(w, depth + 0.225, 0.135, ((-0.05, 0.11, 0.022), (0.01, 0.15, 0.026), (0.06, 0.1, 0.02)))


STYLES = (
    Style("fireplace", "mantel", "train", mantel),
    Style("fireplace", "stove_iron", "heldout", stove_iron),
    Style("fireplace", "brick_breast", "train", brick_breast),
    Style("fireplace", "linear", "train", linear),
    Style("fireplace", "rustic_stone", "train", rustic_stone),
    Style("fireplace", "electric", "train", electric),
    Style("fireplace", "suspended", "heldout", suspended),
    Style("fireplace", "tiled_stove", "heldout", tiled_stove),
)


def flames(w: Workbench, x: float, z: float, tongues: Sequence[tuple[float, float, float]]) -> None:
    """Adds pointed flames that rise from the height `z`, each with a lighter core on its front side.

    Args:
        w: the workbench.
        x: where the flames are, from the wall.
        z: height of their lower ends.
        tongues: position along y, height and radius of each flame.
    """
    fire = w.look("fire")
    outer = [_tongue(x, y, z, high, radius, 1.0 if i % 2 else -1.0) for i, (y, high, radius) in enumerate(tongues)]
    inner = [
        _tongue(x + 0.6 * radius, y, z, 0.6 * high, 0.55 * radius, 1.0 if i % 2 else -1.0)
        for i, (y, high, radius) in enumerate(tongues)
    ]
    w.mesh(joined("flames", outer), (0.0, 0.0, 0.0), fire, solid=False)
    w.mesh(joined("flames", inner), (0.0, 0.0, 0.0), _core(fire), solid=False)


def _tongue(x: float, y: float, z: float, high: float, radius: float, lean: float) -> Body:
    path = [(x, y + lean * shift * radius, z + share * high) for share, _, shift in _SHARES]
    return tube(path, [radius * wide for _, wide, _ in _SHARES])


def _core(fire: Look) -> Look:
    """Returns a lighter and yellower look."""
    r, g, b, a = fire.rgba
    light = (round(min(1.0, 0.5 + 0.5 * r), 3), round(0.45 + 0.5 * g, 3), round(0.3 + 0.5 * b, 3), a)
    return dataclasses.replace(fire, rgba=light)
