"""Washstands of the pool `wide`."""

from __future__ import annotations

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.parts import BOTH_SIDES, FeetKind, FrontKind, HandleKind
from sim.housegen.furniture.shapes import chamfered_box
from sim.housegen.furniture.workbench import Workbench


def vanity_frame(w: Workbench) -> None:
    """Builds a washstand of legs and rails with a shelf for towels below its top."""
    width, depth, height = w.width(0.65, 1.30), w.depth(0.44, 0.54), w.length(0.76, 0.86)
    frame = w.look(w.choice(("wood", "iron", "brass", "lacquer")))
    top = w.look(w.choice(("wood", "stone")))
    thick = w.length(0.025, 0.06)
    x, y = parts.footprint(depth, width)
    w.box(x, y, (height - thick, height), top)
    w.legs((x[0] + 0.01, x[1] - 0.02), (y[0] + 0.02, y[1] - 0.02), (0.0, height - thick), thick, frame)
    if w.chance(0.5):
        under = height - thick - w.length(0.10, 0.18)
        w.box((x[0] + 0.015, x[1] - 0.035), (y[0] + 0.025, y[1] - 0.025), (under, height - thick), frame)
        parts.styled_drawers(
            w,
            x[1] - 0.035,
            (y[0] + 0.07, y[1] - 0.07),
            (under, height - thick),
            frame,
            w.look("brass"),
            "flat",
            "knob",
            w.whole(1, 2),
        )
    low = w.length(0.12, 0.28)
    for edge in (y[0] + 0.022, y[1] - 0.022 - 0.02):
        w.box((x[0] + 0.02, x[1] - 0.03), (edge, edge + 0.02), (low - 0.02, low), frame)
    slats = w.choice((1, 4, 5))
    each = (depth - 0.05) / slats
    for i in range(slats):
        start = x[0] + 0.02 + i * each
        w.box(
            (start, start + each - (0.02 if slats > 1 else 0.0)), (y[0] + 0.02, y[1] - 0.02), (low, low + 0.018), frame
        )
    at = y[0] + 0.18
    for _ in range(w.whole(1, 3)):
        if at > y[1] - 0.15:
            break
        kind, tall = w.choice(("towel", "wicker")), w.length(0.08, 0.26)
        size = (0.3, 0.24, tall)
        w.mesh(chamfered_box(size, 0.02), (0.0, at, low + 0.018 + 0.5 * tall), w.new_look(kind), solid=False)
        at += 0.29
    if w.chance(0.4):
        w.box((x[0], x[0] + 0.02), y, (height, height + 0.1), top)
    _basins(w, width, depth, height)


def _basins(w: Workbench, width: float, depth: float, height: float) -> None:
    """Adds one basin in the middle or to one side, or two, and declares the free surface beside them."""
    spots = (-0.25 * width, 0.25 * width) if width > 1.2 and w.chance(0.6) else (0.0,)
    if len(spots) == 1 and width > 0.95 and w.chance(0.4):
        spots = (w.choice(BOTH_SIDES) * (0.5 * width - 0.32),)
    basin = w.make("sink", use="vessel")
    for at in spots:
        w.put(basin, (0.02, at, height))
    reach = 0.5 * basin.size_m[1] + 0.04
    edges = [-0.5 * width + 0.03, *(e for at in spots for e in (at - reach, at + reach)), 0.5 * width - 0.03]
    for low, high in zip(edges[::2], edges[1::2], strict=True):
        if high - low > 0.1:
            w.top((-0.5 * depth + 0.06, 0.5 * depth - 0.06), (low, high), height)


def vanity_drawers(w: Workbench) -> None:
    """Builds a washstand with a column of drawers beside doors, and a top that overhangs."""
    width, depth, height = w.width(0.75, 1.60), w.depth(0.46, 0.56), w.length(0.76, 0.86)
    look, metal = parts.wood_look(w), w.look(w.choice(("brass", "metal", "dark")))
    kind: FeetKind = w.choice(("bun", "taper", "block", "plinth", "cabriole"))
    foot = w.length(0.07, 0.11) if kind in ("bun", "plinth", "block") else w.length(0.12, 0.25)
    x, y = parts.footprint(depth, width)
    stone = w.look(w.choice(("stone", "ceramic", "wood")))
    w.box((x[0], x[1] - 0.03), (y[0] + 0.015, y[1] - 0.015), (foot, height - 0.03), look)
    w.box(x, y, (height - 0.03, height), stone)
    if w.chance(0.6):
        w.box((x[0], x[0] + 0.02), y, (height, height + w.length(0.08, 0.2)), stone)
    share, side = w.length(0.28, 0.42) * width, w.choice(BOTH_SIDES)
    z = (foot + 0.015, height - 0.045)
    left, right = (y[0] + 0.025, y[0] + share), (y[0] + share, y[1] - 0.025)
    if side > 0:
        left, right = (-left[1], -left[0]), (-right[1], -right[0])
    grip: HandleKind = w.choice(("knob", "bar", "slot"))
    front: FrontKind = w.choice(("flat", "frame", "raised"))
    parts.styled_drawers(w, x[1] - 0.03, left, parts.graded_rows(*z, w.whole(2, 3), 1.1), look, metal, "flat", grip)
    if w.chance(0.3):
        parts.styled_drawers(w, x[1] - 0.03, right, parts.graded_rows(*z, 2, 1.0), look, metal, "flat", grip)
    else:
        parts.styled_doors(w, x[1] - 0.03, right, z, 1 if width < 0.9 else 2, look, metal, front, grip)
    parts.feet(w, (x[0], x[1] - 0.03), y, foot + 0.001, kind, look)
    _basins(w, width, depth, height)


STYLES: tuple[Style, ...] = (
    Style("cabinet", "vanity_frame", "wide", vanity_frame, ("vanity",)),
    Style("cabinet", "vanity_drawers", "wide", vanity_drawers, ("vanity",)),
)
