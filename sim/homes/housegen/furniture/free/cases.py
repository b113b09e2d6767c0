"""Free-form cabinets, chests of drawers and counters of the pool `wide`: a body whose front is divided at random.

The front of a body is cut into fields, alternately upright and level, and each field gets doors, drawers, an open
compartment or glass. Supports, tops, fronts and handles are drawn from `parts`.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.free.bases import LIGHT, LOW, add_base, frame_look
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts import FrontKind, HandleKind
from sim.homes.housegen.furniture.workbench import Range, Workbench

FieldKind = Literal["doors", "drawers", "open", "glass"]
_HANDLES: tuple[HandleKind, ...] = ("bar", "bar", "knob", "knob", "cup", "drop", "tab", "slot", "rail", "none")
_COST: dict[FrontKind, int] = {"flat": 0, "cane": 1, "frame": 2, "raised": 2, "slats": 8}
"""Geoms of a front beyond its panel."""
MOST_GEOMS = 24
"""Geoms that the fronts of one piece have at most, nearly."""
_FRONTS: tuple[FrontKind, ...] = ("flat", "flat", "frame", "raised", "cane", "slats")


@dataclass(frozen=True)
class Fronts:
    """The design that the fronts of one piece share."""

    look: Look
    metal: Look
    panel: FrontKind
    grip: HandleKind
    depth: float
    """Depth of its open compartments, in metres."""


def _draw_fronts(w: Workbench, depth: float, body: Look) -> Fronts:
    look = body if w.chance(0.65) else w.look(w.choice(("lacquer", "wood", "bright")))
    metal = w.look(w.choice(("brass", "chrome", "iron", "dark", "steel", "wood")))
    return Fronts(look, metal, w.choice(_FRONTS), w.choice(_HANDLES), depth)


def _cuts(w: Workbench, low: float, high: float, count: int) -> list[Range]:
    """Returns `count` ranges that fill a range, equal or of random sizes, in random order."""
    shares = [1.0] * count if w.chance(0.4) else [w.length(0.5, 1.5) for _ in range(count)]
    edges = [low]
    for share in shares:
        edges.append(edges[-1] + share * (high - low) / sum(shares))
    return list(itertools.pairwise(edges))


@dataclass(frozen=True)
class Field:
    """One field of a front and how it is divided."""

    y: Range
    z: Range
    kind: FieldKind
    rows: int = 1
    columns: int = 1


def divide(
    w: Workbench, x: float, y: Range, z: Range, fronts: Fronts, kinds: Sequence[FieldKind], field: float
) -> None:
    """Fills the front in the plane x: cuts it at random into fields of about `field` metres, and fills each.

    The design of the fronts gets plainer where there are many of them.
    """
    fields = _plan(w, y, z, kinds, field)
    count = sum(f.rows * f.columns for f in fields if f.kind in ("doors", "drawers"))
    open_fields = sum(2 + f.rows for f in fields if f.kind in ("open", "glass"))
    left = (MOST_GEOMS - open_fields) / max(1, count) - (1.0 if fronts.grip == "none" else 2.0)
    if _COST[fronts.panel] > left:
        fronts = replace(fronts, panel="flat")
    if count > MOST_GEOMS // 2:
        fronts = replace(fronts, grip="slot" if fronts.grip == "slot" and count < 14 else "none")
    for f in fields:
        if f.kind == "drawers":
            edges = parts.graded_rows(f.z[0], f.z[1], f.rows, w.choice((1.0, 1.0, 1.15, 1.35)))
            parts.styled_drawers(w, x, f.y, edges, fronts.look, fronts.metal, fronts.panel, fronts.grip, f.columns)
        elif f.kind == "doors":
            parts.styled_doors(w, x, f.y, f.z, f.columns, fronts.look, fronts.metal, fronts.panel, fronts.grip)
        else:
            _compartment(w, x, f, fronts)


def _plan(w: Workbench, y: Range, z: Range, kinds: Sequence[FieldKind], size: float) -> list[Field]:
    """Returns the fields of a front: columns, each of one field or of two above each other."""
    columns = max(1, min(4, round((y[1] - y[0]) / (size * w.length(0.8, 1.6)))))
    level = w.choice((0.0, 0.0, w.length(0.22, 0.45), w.length(0.55, 0.8)))
    upper, same = w.choice(kinds), w.chance(0.5)
    fields = []
    for span in _cuts(w, *y, columns):
        cut = z[0] + level * (z[1] - z[0])
        for low, high in ((z[0], cut), (cut, z[1])):
            if high - low < 0.08:
                continue
            kind = upper if same and high == z[1] else w.choice(kinds)
            wide, tall = span[1] - span[0], high - low
            if kind == "drawers":
                rows = max(1, min(5, round(tall / w.length(0.14, 0.28))))
                fields.append(Field(span, (low, high), kind, rows, 2 if wide > 0.75 and w.chance(0.5) else 1))
            elif kind == "doors":
                fields.append(Field(span, (low, high), kind, 1, max(1, round(wide / w.length(0.38, 0.65)))))
            else:
                fields.append(Field(span, (low, high), kind, max(1, min(4, round(tall / w.length(0.28, 0.42))))))
    return fields


def _compartment(w: Workbench, x: float, field: Field, fronts: Fronts) -> None:
    """Adds an open or glazed compartment before the body, which is dark inside, with shelves and objects."""
    deep, board, y, z = fronts.depth, 0.018, field.y, field.z
    w.box((x, x + 0.002), y, z, parts.darker(fronts.look, 0.55), solid=False)
    for edge in (y[0], y[1] - board):
        w.box((x, x + deep), (edge, edge + board), z, fronts.look)
    for i in range(field.rows + 1):
        low = z[0] + i * (z[1] - z[0] - board) / field.rows
        w.box((x, x + deep), y, (low, low + board), fronts.look)
        if i < field.rows and w.chance(0.35):
            room = (z[1] - z[0]) / field.rows - 2 * board
            parts.shelf_objects(w, (x, x + deep), (y[0] + 0.04, y[1] - 0.04), low + board, w.whole(1, 2), room)
    if field.kind == "glass":
        w.box((x + deep - 0.004, x + deep), (y[0] + board, y[1] - board), (z[0] + board, z[1] - board), w.look("glass"))
        if w.chance(0.6):
            bar = parts.centred(0.5 * (y[0] + y[1]), 0.03)
            w.box((x + deep - 0.006, x + deep + 0.012), bar, z, fronts.look, solid=False)


def _body(
    w: Workbench, deep: float, wide: float, high: float, foot: float, kinds: Sequence[FieldKind], field: float,
    *, light: bool = False,
) -> None:  # fmt: skip
    """Builds a case on a base, with a top, and divides its front."""
    body = parts.wood_look(w)
    x, y = parts.footprint(deep, wide)
    recess = min(w.length(0.10, 0.22), 0.5 * deep) if "open" in kinds or "glass" in kinds else 0.0
    over, top = w.length(0.0, 0.03), w.length(0.015, 0.045)
    front = x[1] - recess - 0.025
    side = w.length(0.012, 0.04)
    inner = (y[0] + over + side, y[1] - over - side)
    z = (foot, high - top)
    w.box((x[0], front), (y[0] + over, y[1] - over), z, body)
    fronts = _draw_fronts(w, recess, body)
    if recess:
        for a in (y[0] + over, inner[1]):
            w.box((front, x[1] - 0.01), (a, a + side), z, body)
    if foot:
        add_base(w, (x[0], x[1] - 0.01), y, foot, LIGHT if light else LOW, body if w.chance(0.5) else frame_look(w))
    w.box(x, y, (high - top, high), body if w.chance(0.6) else w.look(w.choice(("stone", "wood", "lacquer"))))
    divide(w, front, inner, (z[0] + side, z[1] - 0.006), fronts, kinds, field)
    parts.top_surface(w, x, y, high)


def _foot(w: Workbench, highest: float) -> float:
    return w.choice((0.0, 0.05, w.length(0.06, highest)))


def free_wardrobe(w: Workbench) -> None:
    """Builds a wardrobe of any division, front and base."""
    wide = w.width(0.80, 2.0)
    kinds: tuple[tuple[FieldKind, ...], ...] = (("doors",), ("doors", "doors", "drawers"), ("doors", "open", "drawers"))
    _body(w, w.depth(0.52, 0.64), wide, w.height(1.70, 2.20), _foot(w, 0.14), w.choice(kinds), 0.7)


def free_sideboard(w: Workbench) -> None:
    """Builds a sideboard of any division, front and base."""
    wide = w.width(0.85, 1.80)
    kinds: tuple[tuple[FieldKind, ...], ...] = (("doors", "drawers"), ("doors",), ("doors", "open", "drawers"))
    _body(w, w.depth(0.34, 0.48), wide, w.height(0.68, 0.98), _foot(w, 0.28), w.choice(kinds), 0.5, light=w.chance(0.4))


def free_display(w: Workbench) -> None:
    """Builds a tall display cabinet of any division, with glass."""
    wide = w.width(0.60, 1.20)
    kinds: tuple[tuple[FieldKind, ...], ...] = (("glass",), ("glass", "glass", "doors"), ("glass", "glass", "open"))
    _body(w, w.depth(0.32, 0.44), wide, w.height(1.35, 2.05), _foot(w, 0.18), w.choice(kinds), 0.55)


def free_media(w: Workbench) -> None:
    """Builds a low media cabinet of any division, front and base."""
    wide = w.width(1.10, 2.0)
    kinds: tuple[tuple[FieldKind, ...], ...] = (("doors", "open"), ("drawers", "open"), ("open",), ("doors", "drawers"))
    _body(w, w.depth(0.34, 0.46), wide, w.height(0.36, 0.60), _foot(w, 0.2), w.choice(kinds), 0.55, light=w.chance(0.4))


def free_dresser(w: Workbench) -> None:
    """Builds a chest of drawers of any rows, columns, front and base."""
    kinds: tuple[tuple[FieldKind, ...], ...] = (("drawers",), ("drawers",), ("drawers", "drawers", "doors"))
    _body(w, w.depth(0.40, 0.52), w.width(0.60, 1.45), w.height(0.68, 1.25), _foot(w, 0.2), w.choice(kinds), 0.6)


def free_bedside(w: Workbench) -> None:
    """Builds a bedside chest of any division, front and base."""
    kinds: tuple[tuple[FieldKind, ...], ...] = (("drawers",), ("drawers", "open"), ("drawers", "doors"))
    wide, high = w.width(0.36, 0.58), w.height(0.42, 0.66)
    _body(w, w.depth(0.32, 0.44), wide, high, _foot(w, 0.24), w.choice(kinds), 0.6, light=w.chance(0.3))


def free_run(w: Workbench) -> None:
    """Builds a kitchen counter of any division, front and worktop, if asked with a sink and a hob."""
    wide, deep, high = w.width(1.10, 2.80), w.depth(0.58, 0.68), w.height(0.85, 0.94)
    body, thick, x, y = parts.wood_look(w), w.length(0.02, 0.07), *parts.footprint(deep, wide)
    hole, free = parts.worktop_fittings(w, y, high)
    under, foot, back = high - thick, w.length(0.06, 0.16), w.length(0.02, 0.06)
    front = x[1] - back - 0.02
    ends = w.choice((0.0, 0.0, 0.02, 0.06))
    inner = (y[0] + 0.005, y[1] - 0.005)
    _hollow_body(w, (x[0], front), inner, (foot, under), body, hole)
    w.box(
        (x[0], front - w.length(0.0, 0.08)),
        (y[0] + 0.01, y[1] - 0.01),
        (0.0, foot),
        w.look(w.choice(("dark", "stone", "metal"))),
    )
    stone = w.look(w.choice(("stone", "wood", "steel", "lacquer", "masonry")))
    parts.worktop(w, x, y, (under, high), stone, hole)
    if w.chance(0.45):
        w.box((x[0], x[0] + 0.02), y, (high, high + w.choice((0.05, 0.12, 0.3))), stone)
    for side in parts.BOTH_SIDES if ends else ():
        w.box((front - 0.02, x[1] - 0.01), parts.on_side(side, 0.5 * wide - ends, 0.5 * wide), (0.0, under), body)
    fronts = _draw_fronts(w, 0.02, body)
    options: tuple[tuple[FieldKind, ...], ...] = (("doors",), ("doors", "drawers"), ("drawers",))
    kinds = w.choice(options)
    divide(w, front, (y[0] + ends + 0.006, y[1] - ends - 0.006), (foot + 0.005, under - 0.01), fronts, kinds, 1.0)
    for span in free:
        w.top((x[0] + 0.05, x[1] - 0.05), (span[0] + 0.05, span[1] - 0.05), high)


def _hollow_body(w: Workbench, x: Range, y: Range, z: Range, look: Look, hole: tuple[Range, Range] | None) -> None:
    """Adds the body of a counter, which is lower below a sink."""
    if hole is None:
        w.box(x, y, z, look)
        return
    sink = hole[1]
    w.box(x, (y[0], sink[0]), z, look)
    w.box(x, (sink[1], y[1]), z, look)
    w.box(x, sink, (z[0], z[1] - 0.16), look)
    w.box((x[1] - 0.04, x[1]), sink, (z[1] - 0.16, z[1]), look)


STYLES: tuple[Style, ...] = (
    Style("cabinet", "free_wardrobe", "wide", free_wardrobe, ("wardrobe",)),
    Style("cabinet", "free_sideboard", "wide", free_sideboard, ("sideboard",)),
    Style("cabinet", "free_display", "wide", free_display, ("display",)),
    Style("cabinet", "free_media", "wide", free_media, ("media",)),
    Style("chest_of_drawers", "free_dresser", "wide", free_dresser, ("dresser",)),
    Style("chest_of_drawers", "free_bedside", "wide", free_bedside, ("nightstand",)),
    Style("counter", "free_run", "wide", free_run, ("run",)),
)
