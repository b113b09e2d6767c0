"""Dressers of the pool `wide`."""

from __future__ import annotations

import itertools
import math

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.parts import BOTH_SIDES, FeetKind, FrontKind, HandleKind
from sim.housegen.furniture.shapes import chamfered_box, frustum
from sim.housegen.furniture.workbench import Workbench


def _curved_footprint(depth: float, width: float, bulge: float, waves: bool) -> list[tuple[float, float]]:
    """Returns the footprint of a case whose front bows out, or waves in and out if `waves`."""
    outline = [(-0.5 * depth, 0.5 * width), (-0.5 * depth, -0.5 * width)]
    for i in range(13):
        s = i / 6 - 1
        back = 0.5 - 0.5 * math.cos(2 * math.pi * s) if waves else s * s
        outline.append((0.5 * depth - bulge * back, 0.5 * width * s))
    return outline


def curved_commode(w: Workbench) -> None:
    """Builds a commode with a bowed or waved front and an overhanging top."""
    width, depth, height = w.width(0.75, 1.30), w.depth(0.44, 0.56), w.length(0.76, 0.95)
    look, metal = parts.wood_look(w), w.look(w.choice(("brass", "iron", "metal")))
    waves, bulge, rows = w.chance(0.4), w.length(0.06, 0.13), w.whole(2, 4)
    kind: FeetKind = w.choice(("cabriole", "bun", "taper"))
    foot = w.length(0.07, 0.10) if kind == "bun" else w.length(0.12, 0.32)
    x, y = parts.footprint(depth, width)
    w.mesh(
        parts.prism(_curved_footprint(depth, width - 0.03, bulge, waves), height - 0.03 - foot), (0.0, 0.0, foot), look
    )
    w.mesh(
        parts.prism(_curved_footprint(depth + 0.05, width, bulge, waves), 0.03),
        (0.025, 0.0, height - 0.03),
        w.look("stone") if w.chance(0.35) else look,
    )
    front = parts.darker(look, 0.8) if look.texture is None and w.chance(0.3) else look
    edges = parts.graded_rows(foot + 0.02, height - 0.05, rows, w.choice((1.0, 1.2)))
    shade = parts.prism(_curved_footprint(depth, width - 0.08, bulge, waves), round(edges[-1] - edges[0], 4))
    w.mesh(shade, (0.008, 0.0, edges[0]), parts.darker(look), solid=False)
    grip: HandleKind = w.choice(("drop", "knob", "cup", "bar"))
    for low, high in itertools.pairwise(edges):
        outline = _curved_footprint(depth, width - 0.09, bulge * ((width - 0.09) / width) ** 2, waves)
        w.mesh(parts.prism(outline, round(high - low - 0.012, 4)), (0.018, 0.0, low + 0.006), front, solid=False)
        for side in BOTH_SIDES:
            share = 0.5 if waves else 0.55
            back = bulge if waves else bulge * share**2
            at = (x[1] + 0.016 - back, side * share * 0.5 * (width - 0.06), 0.5 * (low + high))
            parts.handle(w, grip, at, 0.10, metal)
    parts.feet(w, (x[0], x[1] - bulge), (y[0] + 0.01, y[1] - 0.01), foot + 0.002, kind, look, 0.055)
    parts.top_surface(w, (x[0], x[1] - bulge), y, height)


def step_chest(w: Workbench) -> None:
    """Builds a chest whose columns of drawers and doors rise like steps to one side."""
    columns = w.whole(2, 4)
    width, depth = w.width(0.32 * columns, 0.46 * columns), w.depth(0.36, 0.46)
    first, rise = w.length(0.28, 0.5), w.length(0.2, 0.48 - 0.05 * columns)
    look, metal, side = parts.wood_look(w), w.look(w.choice(("iron", "brass", "dark"))), w.choice(BOTH_SIDES)
    grip: HandleKind = w.choice(("drop" if columns < 4 else "knob", "knob", "bar", "slot"))
    front: FrontKind = w.choice(("flat", "frame")) if columns == 2 else "flat"
    x, _ = parts.footprint(depth, width)
    each = width / columns
    for i in range(columns):
        high = first + i * rise
        left = side * (-0.5 * width + (i + 0.5) * each) - 0.5 * each
        y = (left, left + each)
        w.box(x, y, (0.0, high - 0.025), look)
        over = 0.012 if i + 1 == columns else 0.0
        w.box((x[0], x[1] + 0.02), (y[0] - over, y[1] + over), (high - 0.025, high), look)
        inner = (y[0] + 0.015, y[1] - 0.015)
        base = 0.03
        if high > 0.75 and w.chance(0.6):
            base = 0.03 + 0.55 * high
            parts.styled_doors(w, x[1], inner, (0.03, base), 1, look, metal, front, "knob" if grip == "drop" else grip)
        rows = max(1, round((high - base) / 0.26))
        parts.styled_drawers(w, x[1], inner, parts.graded_rows(base, high - 0.035, rows, 1.0), look, metal, front, grip)
        parts.top_surface(w, x, y, high)


def chest_on_chest(w: Workbench) -> None:
    """Builds a tall chest of two stages, the upper one narrower."""
    width, depth = w.width(0.75, 1.05), w.depth(0.44, 0.54)
    kind: FeetKind = w.choice(("cabriole", "bun", "block", "taper"))
    foot = w.length(0.30, 0.48) if kind in ("cabriole", "taper") else w.length(0.08, 0.14)
    look, metal = parts.wood_look(w), w.look(w.choice(("brass", "iron")))
    waist = foot + (w.length(0.24, 0.38) if foot > 0.2 else w.length(0.50, 0.70))
    height = waist + w.length(0.50, 0.75)
    x, y = parts.footprint(depth, width)
    shrink = w.length(0.03, 0.07)
    upper = (y[0] + shrink, y[1] - shrink)
    grip: HandleKind = w.choice(("drop", "knob", "cup"))
    front: FrontKind = "raised" if grip == "cup" and w.chance(0.5) else "flat"
    w.box(x, y, (foot, waist), look)
    w.box((x[0], x[1] + 0.015), (y[0] - 0.015, y[1] + 0.015), (waist, waist + 0.025), look)
    w.box((x[0], x[1] - shrink), upper, (waist + 0.025, height), look)
    w.box((x[0], x[1] + 0.03 - shrink), (upper[0] - 0.03, upper[1] + 0.03), (height, height + 0.03), look)
    low = parts.graded_rows(foot + 0.02, waist - 0.01, 1 if foot > 0.2 else w.whole(2, 3), 1.15)
    parts.styled_drawers(w, x[1], (y[0] + 0.02, y[1] - 0.02), low, look, metal, front, grip)
    high = parts.graded_rows(waist + 0.04, height - 0.15, w.whole(2, 3), 1.15)
    inner = (upper[0] + 0.02, upper[1] - 0.02)
    parts.styled_drawers(w, x[1] - shrink, inner, high, look, metal, front, grip)
    parts.styled_drawers(
        w, x[1] - shrink, inner, (height - 0.15, height - 0.02), look, metal, "flat", grip, w.whole(1, 3)
    )
    parts.feet(w, x, y, foot, kind, look, 0.06)
    parts.top_surface(w, (x[0], x[1] - shrink), upper, height + 0.03)


def basket_chest(w: Workbench) -> None:
    """Builds an open frame with baskets or canvas boxes as drawers."""
    rows, columns = w.whole(2, 4), w.whole(1, 3)
    width, depth = w.width(0.34 * columns, 0.44 * columns), w.depth(0.32, 0.44)
    foot, pitch = w.length(0.05, 0.22), w.length(0.20, 0.29)
    frame = w.look(w.choice(("wood", "lacquer", "iron", "bright")))
    stuff = w.look(w.choice(("wicker", "fabric", "linen", "steel")))
    height = foot + rows * pitch + 0.02
    x, y = parts.footprint(depth, width)
    w.box(x, y, (height, height + 0.022), w.look("wood") if w.chance(0.6) else frame)
    for edge in (y[0], y[1] - 0.028):
        if columns > 1 and w.chance(0.35):
            w.box(x, (edge, edge + 0.02), (0.0, height), frame)
            continue
        for post in (x[0], x[1] - 0.028):
            w.box((post, post + 0.028), (edge, edge + 0.028), (0.0, height), frame)
    each = (width - 0.05) / columns
    taper = w.choice((0.86, 0.94, 1.0))
    for row in range(rows):
        z = foot + row * pitch
        w.box((x[0] + 0.005, x[1] - 0.005), (y[0] + 0.004, y[1] - 0.004), (z - 0.015, z), frame)
        for column in range(columns):
            if row + column > 0 and w.chance(0.1):
                continue
            tall, wide = round(0.82 * pitch, 3), each - 0.02
            at = y[0] + 0.025 + (column + 0.5) * each
            w.mesh(frustum((taper * (depth - 0.03), taper * wide), (depth - 0.03, wide), tall), (0.015, at, z), stuff)
            parts.handle(w, "cup", (0.5 * depth - 0.012, at, z + 0.75 * tall), 0.10, w.look("dark"))
    parts.top_surface(w, x, y, height + 0.022)


def plastic_tower(w: Workbench) -> None:
    """Builds a tower of rounded plastic drawers on castors or small feet."""
    columns, rows = w.choice((1, 1, 2)), w.whole(3, 5)
    width, depth = w.width(0.36 * columns, 0.52 * columns), w.depth(0.36, 0.46)
    pitch, foot = w.length(0.16, 0.25), w.length(0.04, 0.07)
    frame = w.look("plastic")
    box = w.new_look(w.choice(("plastic", "plastic", "appliance")))
    height = foot + rows * pitch + 0.03
    x, y = parts.footprint(depth, width)
    w.box((x[0], x[0] + 0.015), (y[0] + 0.01, y[1] - 0.01), (foot, height), frame)
    for edge in (y[0] + 0.004, y[1] - 0.024):
        w.box((x[0], x[1] - 0.02), (edge, edge + 0.02), (foot, height - 0.01), frame)
    for i in range(rows + 1):
        size = (depth, width, 0.024 if i < rows else 0.04)
        w.mesh(chamfered_box(size, 0.011), (0.0, 0.0, foot + i * pitch + 0.012), frame)
    each = (width - 0.05) / columns
    hand = w.choice(("lip", "hole", "knob"))
    for i in range(rows):
        for column in range(columns):
            tall, at = round(pitch - 0.034, 3), y[0] + 0.025 + (column + 0.5) * each
            z = foot + i * pitch + 0.024
            box_size = (round(depth - 0.02, 3), round(each - 0.01, 3), tall)
            w.mesh(chamfered_box(box_size, 0.02), (0.012, at, z + 0.5 * tall), box)
            face = x[1] + 0.002
            if hand == "lip":
                w.box((face - 0.01, face + 0.02), (at - 0.08, at + 0.08), (z + tall - 0.05, z + tall - 0.035), box)
            elif hand == "hole":
                w.ellipsoid((face, at, z + 0.7 * tall), (0.003, 0.05, 0.014), w.look("dark"), solid=False)
            else:
                parts.handle(w, "knob", (face, at, z + 0.5 * tall), 0.0, frame)
    parts.feet(w, x, y, foot + 0.003, w.choice(("castor", "block")), frame, 0.035)
    parts.top_surface(w, x, y, height)


def mirror_dresser(w: Workbench) -> None:
    """Builds a low dresser with a mirror at its back and sometimes small drawers beside it."""
    width, depth, height = w.width(0.95, 1.55), w.depth(0.42, 0.52), w.length(0.68, 0.82)
    look, metal = parts.wood_look(w), w.look(w.choice(("brass", "metal")))
    kind: FeetKind = w.choice(("taper", "splay", "bun", "plinth", "cabriole"))
    foot = w.length(0.06, 0.09) if kind in ("bun", "plinth") else w.length(0.12, 0.26)
    x, y = parts.footprint(depth, width)
    w.box(x, y, (foot, height), look)
    front: FrontKind = w.choice(("flat", "raised", "frame"))
    grip: HandleKind = w.choice(("knob", "cup", "bar", "cup"))
    parts.styled_drawers(
        w,
        x[1],
        (y[0] + 0.02, y[1] - 0.02),
        parts.graded_rows(foot + 0.02, height - 0.02, w.whole(2, 3), 1.1),
        look,
        metal,
        front,
        grip,
        w.whole(1, 2) if front == "flat" else 1,
    )
    parts.feet(w, x, y, foot, kind, look)
    wide, tall = round(w.choice((0.45, 0.6, 0.8)) * width, 2), w.length(0.55, 0.85)
    w.box((x[0], x[0] + 0.022), (-0.3 * wide, 0.3 * wide), (height, height + 0.5 * tall), look)
    w.put(w.make("mirror", use="wall", width_m=wide, height_m=tall), (x[0] + 0.022, 0.0, height))
    side = w.chance(0.5) and 0.5 * (width - wide) > 0.14
    if side:
        for s in BOTH_SIDES:
            low, high = sorted((s * (0.5 * wide + 0.02), s * (0.5 * width - 0.01)))
            w.box((x[0] + 0.02, x[0] + 0.2), (low, high), (height, height + 0.12), look)
            parts.styled_drawers(
                w, x[0] + 0.2, (low, high), (height + 0.01, height + 0.11), look, metal, "flat", "knob"
            )
    parts.top_surface(w, (x[0] + (0.2 if side else 0.06), x[1]), y, height)


def graded_chest(w: Workbench) -> None:
    """Builds a chest whose drawers are deeper towards the floor, below a row of small drawers."""
    width, depth = w.width(0.70, 1.45), w.depth(0.40, 0.52)
    height = w.length(0.72, 1.25) if width < 1.0 else w.length(0.66, 0.86)
    kind: FeetKind = w.choice(("taper", "splay", "sled", "block", "castor", "plinth"))
    foot = w.length(0.05, 0.09) if kind in ("block", "castor", "plinth") else w.length(0.13, 0.30)
    body = parts.wood_look(w)
    face = w.look(w.choice(("wood", "lacquer"))) if w.chance(0.4) else body
    metal = w.look(w.choice(("brass", "iron", "metal", "dark")))
    front: FrontKind = w.choice(("flat", "frame", "raised", "cane"))
    grip: HandleKind = w.choice(("tab", "slot", "rail", "drop", "knob", "cup"))
    x, y = parts.footprint(depth, width)
    board = 0.0 if w.chance(0.4) else 0.02
    w.box(x, y, (foot, height - board), body)
    if board:
        w.box((x[0], x[1] + 0.02), (y[0] - 0.015, y[1] + 0.015), (height - board, height), w.look("wood"))
    split = height - board - w.length(0.13, 0.19)
    inner, low = (y[0] + 0.015, y[1] - 0.015), foot + 0.015
    parts.styled_drawers(
        w,
        x[1],
        inner,
        parts.graded_rows(low, split, max(1, round((split - low) / 0.24)), 1.2),
        body if front == "cane" else face,
        metal,
        front,
        grip,
        2 if width > 1.15 else 1,
    )
    parts.styled_drawers(w, x[1], inner, (split, height - board - 0.012), face, metal, "flat", "knob", w.whole(2, 4))
    parts.feet(w, x, y, foot + 0.002, kind, w.look("iron") if kind == "sled" else w.look("wood"))
    parts.top_surface(w, x, y, height)


def steel_drawers(w: Workbench) -> None:
    """Builds a steel filing cabinet with deep drawers, label holders and recessed or bar handles."""
    columns = w.choice((1, 1, 2))
    width, depth = w.width(0.40 * columns, 0.47 * columns), w.depth(0.40, 0.60)
    rows, pitch = w.whole(2, 4), w.length(0.24, 0.32)
    look, metal = w.look(w.choice(("appliance", "lacquer", "steel"))), w.look("chrome")
    foot = w.length(0.03, 0.07)
    height = foot + rows * pitch + 0.03
    x, y = parts.footprint(depth, width)
    w.box(x, y, (foot, height), look)
    parts.feet(w, x, y, foot + 0.001, w.choice(("castor", "block", "plinth")), w.look("dark"), 0.03)
    edges = parts.graded_rows(foot + 0.01, height - 0.02, rows, 1.0)
    parts.styled_drawers(w, x[1], y, edges, look, metal, "flat", "none", columns)
    each = width / columns
    grip: HandleKind = w.choice(("slot", "bar", "cup"))
    for low in edges[:-1]:
        for i in range(columns):
            at, face = y[0] + (i + 0.5) * each, x[1] + parts.FRONT_M
            parts.handle(w, grip, (face, at, low + 0.55 * pitch), 0.14, metal)
            w.box(
                (face, face + 0.003),
                (at - 0.04, at + 0.04),
                (low + 0.72 * pitch, low + 0.84 * pitch),
                w.look("paper"),
                solid=False,
            )
    parts.top_surface(w, x, y, height)


STYLES: tuple[Style, ...] = (
    Style("chest_of_drawers", "curved_commode", "wide", curved_commode, ("dresser",)),
    Style("chest_of_drawers", "step_chest", "wide", step_chest, ("dresser",)),
    Style("chest_of_drawers", "chest_on_chest", "wide", chest_on_chest, ("dresser",)),
    Style("chest_of_drawers", "basket_chest", "wide", basket_chest, ("dresser",)),
    Style("chest_of_drawers", "plastic_tower", "wide", plastic_tower, ("dresser",)),
    Style("chest_of_drawers", "mirror_dresser", "wide", mirror_dresser, ("dresser",)),
    Style("chest_of_drawers", "graded_chest", "wide", graded_chest, ("dresser",)),
    Style("chest_of_drawers", "steel_drawers", "wide", steel_drawers, ("dresser",)),
)
