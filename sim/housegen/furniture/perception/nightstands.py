"""Bedside chests of drawers of the pool `wide`."""

from __future__ import annotations

import itertools

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.parts import BOTH_SIDES, FeetKind, FrontKind, HandleKind
from sim.housegen.furniture.shapes import chamfered_box
from sim.housegen.furniture.workbench import Workbench


def bedside_niche(w: Workbench) -> None:
    """Builds a bedside cabinet with an open niche above or below a drawer."""
    width, depth, height = w.width(0.38, 0.56), w.depth(0.32, 0.44), w.length(0.46, 0.66)
    kind: FeetKind = w.choice(("taper", "splay", "sled", "plinth", "block"))
    foot = w.length(0.03, 0.08) if kind in ("plinth", "block") else w.length(0.12, 0.26)
    look = parts.wood_look(w)
    face = w.look(w.choice(("wood", "lacquer", "wood"))) if w.chance(0.5) else look
    x, y = parts.footprint(depth, width)
    middle = foot + w.choice((0.42, 0.5, 0.58)) * (height - foot)
    over = w.chance(0.5)
    niche = (middle, height - 0.02) if over else (foot + 0.02, middle)
    drawer = (foot, middle) if over else (middle, height)
    w.box((x[0], x[1] - 0.018), y, drawer, look)
    for edge in (y[0], y[1] - 0.018):
        w.box(x, (edge, edge + 0.018), (foot, height), look)
    w.box((x[0], x[0] + 0.012), y, niche, look)
    w.box(x, y, (height - 0.02, height), look)
    w.box(x, y, (foot, foot + 0.02), look)
    grip: HandleKind = w.choice(("knob", "slot", "tab", "bar"))
    front: FrontKind = w.choice(("flat", "flat", "frame", "cane"))
    fronts = (drawer[0] + (0.02 if over else 0.0), drawer[1] - (0.0 if over else 0.02))
    parts.styled_drawers(w, x[1] - 0.018, (y[0] + 0.018, y[1] - 0.018), fronts, face, w.look("brass"), front, grip)
    if w.chance(0.6):
        at = w.length(-0.25, 0.1) * width
        for i in range(w.whole(1, 3)):
            high = niche[0] + 0.022 * (i + 1)
            w.box((-0.1, 0.08), (at, at + 0.16), (high - 0.022, high), w.new_look("book"), solid=False)
    if w.chance(0.3):
        w.box((x[0], x[0] + 0.015), y, (height, height + 0.06), look)
    parts.feet(w, x, y, foot + 0.001, kind, w.look("wood") if kind != "sled" else w.look("iron"), 0.035)
    parts.top_surface(w, x, y, height)


def bedside_locker(w: Workbench) -> None:
    """Builds a hospital locker on castors with a drawer, an open gap and a door."""
    width, depth, height = w.width(0.40, 0.50), w.depth(0.40, 0.48), w.length(0.70, 0.86)
    shell = w.look(w.choice(("appliance", "lacquer", "plastic")))
    face = w.look(w.choice(("wood", "plastic", "appliance")))
    x, y = parts.footprint(depth, width)
    gap = (w.length(0.44, 0.50), w.length(0.56, 0.60))
    w.box((x[0], x[1] - 0.018), y, (0.08, gap[0]), shell)
    w.box((x[0], x[1] - 0.018), y, (gap[1], height - 0.02), shell)
    for edge in (y[0], y[1] - 0.02):
        w.box(x, (edge, edge + 0.02), (0.08, height), shell)
    w.box((x[0], x[0] + 0.015), y, gap, shell)
    inner, metal = (y[0] + 0.02, y[1] - 0.02), w.look("metal")
    grip: HandleKind = w.choice(("bar", "cup", "slot"))
    parts.styled_doors(w, x[1] - 0.018, inner, (0.09, gap[0]), 1, face, metal, "flat", grip)
    parts.styled_drawers(w, x[1] - 0.018, inner, (gap[1], height - 0.03), face, metal, "flat", grip)
    w.mesh(chamfered_box((depth + 0.02, width + 0.02, 0.03), 0.012), (0.0, 0.0, height), face)
    if w.chance(0.6):
        for s in BOTH_SIDES:
            edge = s * (0.5 * width - 0.01)
            w.rod((x[0] + 0.03, edge, height + 0.06), (x[1] - 0.06, edge, height + 0.06), 0.008, metal, solid=False)
            for end in (x[0] + 0.03, x[1] - 0.06):
                w.rod((end, edge, height), (end, edge, height + 0.06), 0.008, metal, solid=False)
    if w.chance(0.5):
        s = w.choice(BOTH_SIDES)
        rail = s * (0.5 * width + 0.025)
        w.rod((x[0] + 0.05, rail, 0.5), (x[1] - 0.05, rail, 0.5), 0.009, metal, solid=False)
        for end in (x[0] + 0.06, x[1] - 0.06):
            w.rod((end, s * 0.5 * width, 0.5), (end, rail, 0.5), 0.008, metal, solid=False)
    parts.feet(w, x, y, 0.082, "castor", w.look("metal"), 0.03)
    parts.top_surface(w, x, y, height + 0.015)


def bedside_box(w: Workbench) -> None:
    """Builds one or two flat drawers on long legs, sometimes with a shelf near the floor."""
    width, depth, height = w.width(0.38, 0.60), w.depth(0.34, 0.45), w.length(0.50, 0.68)
    look, box = parts.wood_look(w), w.length(0.13, 0.24)
    legs = w.look(w.choice(("wood", "iron", "brass", "metal"))) if w.chance(0.5) else look
    x, y = parts.footprint(depth, width)
    base = height - box
    w.box((x[0] + 0.01, x[1] - 0.02), (y[0] + 0.01, y[1] - 0.01), (base, height - 0.018), look)
    w.box((x[0], x[1] + 0.01), y, (height - 0.018, height), w.look("stone") if w.chance(0.2) else look)
    grip: HandleKind = w.choice(("knob", "cup", "tab", "drop", "slot"))
    edges = parts.graded_rows(base, height - 0.02, 2 if box > 0.2 else 1, 1.0)
    parts.styled_drawers(
        w, x[1] - 0.02, (y[0] + 0.015, y[1] - 0.015), edges, look, w.look("brass"), w.choice(("flat", "frame")), grip
    )
    shape = w.choice(("taper", "straight", "cabriole"))
    if shape == "straight":
        w.legs((x[0] + 0.01, x[1] - 0.02), (y[0] + 0.01, y[1] - 0.01), (0.0, base), w.length(0.022, 0.045), legs)
    else:
        parts.feet(w, (x[0] + 0.01, x[1] - 0.01), y, base, "cabriole" if shape == "cabriole" else "taper", legs, 0.04)
    if shape == "straight" and w.chance(0.7):
        z = w.length(0.08, 0.2)
        slats = w.choice((1, 4))
        each = (depth - 0.04) / slats
        for edge in (y[0] + 0.012, y[1] - 0.032):
            w.box((x[0] + 0.015, x[1] - 0.025), (edge, edge + 0.02), (z - 0.016, z), legs)
        for i in range(slats):
            low = x[0] + 0.015 + i * each
            w.box((low, low + each - 0.015), (y[0] + 0.012, y[1] - 0.012), (z, z + 0.016), look)
    parts.top_surface(w, x, y, height)


def bedside_padded(w: Workbench) -> None:
    """Builds an upholstered bedside block with padded fronts on a thin metal base."""
    width, depth, height = w.width(0.42, 0.60), w.depth(0.38, 0.46), w.length(0.42, 0.56)
    cloth, metal = w.look(w.choice(("leather", "fabric"))), w.look(w.choice(("brass", "dark", "chrome")))
    foot, rows = w.length(0.03, 0.12), w.whole(1, 3)
    x, y = parts.footprint(depth, width)
    w.mesh(chamfered_box((depth, width, height - foot), 0.03), (0.0, 0.0, 0.5 * (foot + height)), cloth)
    edges = parts.graded_rows(foot + 0.02, height - 0.02, rows, 1.0)
    w.box((x[1] - 0.01, x[1] + 0.004), (y[0] + 0.03, y[1] - 0.03), (edges[0], edges[-1]), w.look("dark"), solid=False)
    for low, high in itertools.pairwise(edges):
        size = (0.05, round(width - 0.04, 3), round(high - low - 0.012, 3))
        w.mesh(chamfered_box(size, 0.015), (x[1], 0.0, 0.5 * (low + high)), cloth)
        parts.handle(w, w.choice(("bar", "knob")), (x[1] + 0.024, 0.0, high - 0.05), 0.12, metal)
    parts.feet(w, x, y, foot + 0.003, w.choice(("plinth", "block", "sled")), metal, 0.03)
    if w.chance(0.5):
        w.box((x[0] + 0.02, x[1] - 0.02), (y[0] + 0.02, y[1] - 0.02), (height - 0.002, height + 0.012), w.look("stone"))
        height += 0.012
    parts.top_surface(w, x, y, height)


STYLES: tuple[Style, ...] = (
    Style("chest_of_drawers", "bedside_niche", "wide", bedside_niche, ("nightstand",)),
    Style("chest_of_drawers", "bedside_locker", "wide", bedside_locker, ("nightstand",)),
    Style("chest_of_drawers", "bedside_box", "wide", bedside_box, ("nightstand",)),
    Style("chest_of_drawers", "bedside_padded", "wide", bedside_padded, ("nightstand",)),
)
