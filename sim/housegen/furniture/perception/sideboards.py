"""Sideboards and shoe cabinets of the pool `wide`."""

from __future__ import annotations

import math

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.parts import BOTH_SIDES, FeetKind, FrontKind, HandleKind
from sim.housegen.furniture.shapes import frustum
from sim.housegen.furniture.workbench import Workbench


def sideboard_wine(w: Workbench) -> None:
    """Builds a buffet with a bottle rack between cupboards, below a row of drawers."""
    width, depth, height = w.width(1.00, 1.60), w.depth(0.38, 0.48), w.length(0.82, 0.96)
    look, metal = parts.wood_look(w), w.look(w.choice(("iron", "brass")))
    top, foot = w.look("wood"), w.length(0.06, 0.14)
    x, y = parts.footprint(depth, width)
    third, split = w.length(0.30, 0.42), height - 0.2
    mid = (-0.5 * third, 0.5 * third) if w.chance(0.6) else (y[1] - third - 0.02, y[1] - 0.02)
    w.box((x[0], x[1] + 0.025), (y[0] - 0.02, y[1] + 0.02), (height - 0.03, height), top)
    w.box(x, y, (split, height - 0.03), look)
    parts.styled_drawers(
        w,
        x[1],
        (y[0] + 0.01, y[1] - 0.01),
        (split + 0.01, height - 0.04),
        look,
        metal,
        "flat",
        w.choice(("cup", "knob", "bar")),
        w.whole(2, 3),
    )
    w.box((x[0], x[0] + 0.02), y, (foot, split), look)
    w.box(x, y, (foot, foot + 0.02), look)
    front: FrontKind = w.choice(("frame", "raised", "flat"))
    for span in ((y[0], mid[0]), (mid[1], y[1])):
        w.box(x, span, (foot, split), look)
        if span[1] - span[0] > 0.1:
            count = 2 if span[1] - span[0] > 0.75 else 1
            inner = (span[0] + 0.01, span[1] - 0.01)
            parts.styled_doors(w, x[1], inner, (foot + 0.01, split), count, look, metal, front, "knob")
    cells, room = w.whole(2, 3), split - foot - 0.02
    for i in range(1, cells):
        z = foot + 0.02 + i * room / cells
        w.box((x[0], x[1] - 0.01), mid, (z - 0.007, z + 0.007), look)
        at = mid[0] + i * third / cells
        w.box((x[0], x[1] - 0.01), (at - 0.007, at + 0.007), (foot + 0.02, split), look)
    for i in range(cells * cells):
        if w.chance(0.5):
            at = mid[0] + (i % cells + 0.5) * third / cells
            z = foot + 0.02 + (i // cells) * room / cells + 0.046
            w.rod((x[0] + 0.05, at, z), (x[1] - 0.02, at, z), 0.04, w.new_look("pot"), solid=False)
    if w.chance(0.4):
        w.box((x[0], x[0] + 0.02), y, (height, height + 0.14), top)
    parts.feet(w, x, y, foot + 0.001, w.choice(("block", "plinth")), look)
    parts.top_surface(w, x, y, height)


def sideboard_altar(w: Workbench) -> None:
    """Builds an East Asian cabinet with an overhanging top and a round metal plate on its doors."""
    width, depth, height = w.width(0.90, 1.60), w.depth(0.36, 0.46), w.length(0.78, 0.95)
    look, brass = w.look(w.choice(("wood", "lacquer", "wood"))), w.look(w.choice(("brass", "iron")))
    foot, over = w.length(0.10, 0.28), w.length(0.04, 0.16)
    body = 0.5 * width - over
    x = (-0.5 * depth, 0.5 * depth)
    w.box(x, (-0.5 * width, 0.5 * width), (height - 0.03, height), look)
    if w.chance(0.6):
        for s in BOTH_SIDES:
            w.mesh(
                frustum((depth, 0.05), (depth, 0.02), 0.045, (0.0, s * 0.015)),
                (0.0, s * (0.5 * width - 0.025), height),
                look,
            )
    w.box((x[0], x[1] - 0.02), (-body, body), (foot, height - 0.03), look)
    for s in BOTH_SIDES:
        for px in (x[0] + 0.02, x[1] - 0.02):
            w.box((px - 0.02, px + 0.02), (s * body - 0.025, s * body + 0.025), (0.0, height - 0.03), look)
        bracket = frustum((0.02, 0.02), (0.02, 0.14), min(0.09, foot), (0.0, -s * 0.06))
        w.mesh(bracket, (x[1] - 0.012, s * (body - 0.035), foot - min(0.09, foot)), look, solid=False)
    split = height - 0.05
    face = x[1] - 0.02
    if w.chance(0.6):
        parts.styled_drawers(
            w, face, (-body + 0.03, body - 0.03), (split - 0.16, split), look, brass, "flat", "drop", w.whole(2, 4)
        )
        split -= 0.16
    doors = 4 if width > 1.2 and w.chance(0.6) else 2
    parts.styled_doors(
        w,
        face,
        (-body + 0.03, body - 0.03),
        (foot + 0.01, split),
        doors,
        look,
        brass,
        w.choice(("flat", "frame")),
        "none",
    )
    z, radius = 0.5 * (foot + split), min(w.length(0.06, 0.13), 0.35 * (split - foot))
    front = face + parts.FRONT_M
    w.rod((front - 0.002, 0.0, z), (front + 0.006, 0.0, z), radius, brass, solid=False)
    w.box((front, front + 0.02), (-0.012, 0.012), (z - 0.05, z + 0.05), brass, solid=False)
    parts.top_surface(w, x, (-body, body), height)


def sideboard_barn(w: Workbench) -> None:
    """Builds a sideboard with one or two sliding barn doors before open shelves."""
    width, depth, height = w.width(1.20, 1.80), w.depth(0.38, 0.46), w.length(0.72, 0.92)
    wood, iron = w.look("wood"), w.look("iron")
    frame = iron if w.chance(0.4) else parts.wood_look(w)
    leaf = w.look("lacquer") if w.chance(0.4) else wood
    foot, x = w.length(0.05, 0.16), (-0.5 * depth, 0.5 * depth)
    y = (-0.5 * width, 0.5 * width)
    w.box((x[0], x[1] + 0.02), (y[0] - 0.015, y[1] + 0.015), (height - 0.035, height), wood)
    parts.open_case(w, (x[0], x[1] - 0.03), y, (foot, height - 0.035), 0.025, frame)
    bays = w.whole(2, 3)
    rows = w.whole(1, 2)
    step = (height - 0.085 - foot) / (rows + 1)
    for i in range(1, bays):
        at = y[0] + i * width / bays
        w.box((x[0], x[1] - 0.03), (at - 0.01, at + 0.01), (foot, height - 0.035), frame)
    for i in range(rows + 1):
        z = foot + 0.025 + i * step
        if i:
            w.box((x[0], x[1] - 0.04), (y[0] + 0.02, y[1] - 0.02), (z - 0.018, z), wood)
        parts.shelf_objects(w, x, (y[0] + 0.06, y[1] - 0.06), z, bays + 1, step - 0.04)
    rail = height - 0.07
    w.rod((x[1] - 0.008, y[0], rail), (x[1] - 0.008, y[1], rail), 0.012, iron, solid=False)
    w.box((x[1] - 0.03, x[1] - 0.005), y, (foot, foot + 0.025), frame, solid=False)
    each = width / bays
    spots = [0, bays - 1] if bays == 3 and w.chance(0.5) else [w.whole(0, bays - 1)]
    for spot in spots:
        span = (y[0] + spot * each + 0.01, y[0] + (spot + 1) * each - 0.01)
        z = (foot + 0.01, rail + 0.012)
        w.box((x[1] - 0.01, x[1] + 0.012), span, z, leaf)
        w.bar(
            (x[1] + 0.014, span[0] + 0.03, z[0] + 0.03),
            (x[1] + 0.014, span[1] - 0.03, z[1] - 0.03),
            0.05,
            0.008,
            leaf if leaf != wood else parts.darker(wood, 0.8),
            solid=False,
        )
        for edge in (z[0], z[1] - 0.06):
            w.box((x[1], x[1] + 0.016), span, (edge, edge + 0.05), parts.darker(leaf, 0.85), solid=False)
        for at in (span[0] + 0.07, span[1] - 0.09):
            w.box((x[1], x[1] + 0.018), (at, at + 0.02), (z[1] - 0.08, z[1] + 0.02), iron, solid=False)
    parts.feet(w, x, y, foot + 0.001, w.choice(("block", "castor", "sled")), frame, 0.045)
    parts.top_surface(w, x, y, height)


def sideboard_round_ends(w: Workbench) -> None:
    """Builds a sideboard with open half-round ends beside doors or drawers."""
    width, depth, height = w.width(1.10, 1.80), w.depth(0.36, 0.46), w.length(0.70, 0.90)
    look = parts.wood_look(w)
    face = w.look(w.choice(("wood", "lacquer"))) if w.chance(0.5) else look
    foot, reach = w.length(0.04, 0.16), min(0.5 * depth, 0.22)
    inner = 0.5 * width - reach
    x = (-0.5 * depth, 0.5 * depth)
    outline = []
    for s in BOTH_SIDES:
        for i in range(9):
            a = math.pi * (i / 8 - 0.5) - (0.0 if s > 0 else math.pi)
            outline.append((-s * 0.5 * depth * math.sin(a) * s, s * inner + reach * math.cos(a)))
    outline = sorted(outline, key=lambda p: math.atan2(p[1], p[0]))
    rows = w.whole(2, 3)
    step = (height - foot - 0.025) / rows
    for i in range(rows + 1):
        w.mesh(parts.prism(outline, 0.025), (0.0, 0.0, foot + i * step), look)
    w.box((x[0], x[1] - 0.02), (-inner, inner), (foot, height), look)
    for s in BOTH_SIDES:
        for i in range(rows):
            if w.chance(0.6):
                z, material = foot + 0.025 + i * step, w.choice(("pot", "ceramic", "book"))
                w.cylinder(
                    (0.0, s * (inner + 0.5 * reach)),
                    (z, z + w.length(0.08, 0.7 * step)),
                    0.055,
                    w.new_look(material),
                    solid=False,
                )
    metal = w.look(w.choice(("brass", "dark")))
    grip: HandleKind = w.choice(("knob", "slot", "tab", "bar"))
    z = (foot + 0.025, height - 0.002)
    front: FrontKind = w.choice(("flat", "cane", "frame"))
    if w.chance(0.6):
        parts.styled_doors(
            w, x[1] - 0.02, (-inner, inner), z, max(2, round(2 * inner / 0.45)), face, metal, front, grip
        )
    else:
        parts.styled_drawers(
            w, x[1] - 0.02, (-inner, inner), parts.graded_rows(*z, rows, 1.0), face, metal, "flat", grip, w.whole(1, 2)
        )
    kind: FeetKind = w.choice(("plinth", "block")) if foot < 0.09 else w.choice(("taper", "splay", "sled"))
    parts.feet(w, x, (-inner, inner), foot + 0.001, kind, w.look("wood"))
    parts.top_surface(w, x, (-inner, inner), height)


def shoe_cabinet(w: Workbench) -> None:
    """Builds a thin shoe cabinet with broad flaps, one of which may be tilted out."""
    columns = w.choice((1, 2, 2))
    width, depth, rows = (
        w.width(0.50 * columns, 0.80 * columns),
        w.depth(0.18, 0.30),
        w.whole(2, 3 if columns > 1 else 4),
    )
    foot, tall = w.length(0.03, 0.14), w.length(0.30, 0.42)
    look = parts.wood_look(w)
    face = w.look("wood") if w.chance(0.3) else look
    height = foot + rows * tall + 0.04
    x, y = parts.footprint(depth, width)
    w.box((x[0], x[1] - 0.02), y, (foot, height), look)
    w.box((x[0], x[1] + 0.015), (y[0] - 0.01, y[1] + 0.01), (height, height + 0.02), w.look("wood"))
    inner = (y[0] + 0.015, y[1] - 0.015)
    edges = parts.graded_rows(foot + 0.01, height - 0.02, rows, 1.0)
    grip: HandleKind = w.choice(("knob", "slot", "cup", "bar"))
    tilted = w.whole(0, 2 * rows)
    w.box((x[1] - 0.02, x[1] - 0.017), inner, (edges[0], edges[-1]), parts.darker(look), solid=False)
    each = (inner[1] - inner[0]) / columns
    for row in range(rows):
        for column in range(columns):
            span = (inner[0] + column * each, inner[0] + (column + 1) * each)
            z = (edges[row], edges[row + 1])
            if row * columns + column == tilted:
                lean = 0.35
                gap = 0.5 * (z[1] - z[0]) * math.sin(lean)
                w.box(
                    (x[1] - 0.02 + gap, x[1] + gap),
                    (span[0] + 0.006, span[1] - 0.006),
                    (z[0], z[1] - 0.015),
                    face,
                    tilt=lean,
                    solid=False,
                )
                continue
            front = parts.front_panel(w, x[1] - 0.02, span, z, face, "flat")
            parts.handle(w, grip, (front, 0.5 * (span[0] + span[1]), z[1] - 0.05), 0.14, w.look("metal"))
    parts.feet(w, x, y, foot + 0.001, w.choice(("block", "taper")) if foot > 0.05 else "plinth", w.look("wood"), 0.03)
    w.top((x[0] + 0.02, x[1] - 0.02), (y[0] + 0.05, y[1] - 0.05), height + 0.02)


STYLES: tuple[Style, ...] = (
    Style("cabinet", "sideboard_wine", "wide", sideboard_wine, ("sideboard",)),
    Style("cabinet", "sideboard_altar", "wide", sideboard_altar, ("sideboard",)),
    Style("cabinet", "sideboard_barn", "wide", sideboard_barn, ("sideboard",)),
    Style("cabinet", "sideboard_round_ends", "wide", sideboard_round_ends, ("sideboard",)),
    Style("cabinet", "shoe_cabinet", "wide", shoe_cabinet, ("sideboard",)),
)
