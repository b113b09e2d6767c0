"""Desks of the pool `wide`."""

from __future__ import annotations

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.workbench import Workbench


def desk_hutch(w: Workbench) -> None:
    """Builds a desk with shelves above its back edge, on panels, loop frames or four legs."""
    width, depth, height = w.width(0.95, 1.45), w.depth(0.52, 0.70), w.length(0.72, 0.76)
    wood, thick, legs = (
        w.look("wood") if w.chance(0.6) else w.look("lacquer"),
        0.025,
        w.choice(("panel", "loop", "post")),
    )
    x, y = parts.footprint(depth, width)
    w.box(x, y, (height - thick, height), wood)
    if legs == "post":
        w.legs((x[0] + 0.01, x[1] - 0.01), (y[0] + 0.01, y[1] - 0.01), (0.0, height - thick), 0.05, wood)
        w.box((x[0] + 0.02, x[1] - 0.02), (y[0] + 0.02, y[1] - 0.02), (height - 0.12, height - thick), wood)
        parts.plain_drawers(
            w,
            x[1] - 0.02,
            (y[0] + 0.07, y[1] - 0.07),
            (height - 0.12, height - thick),
            1,
            2,
            wood,
            w.look("brass"),
            "knob",
        )
    for side in BOTH_SIDES if legs != "post" else ():
        if legs == "panel":
            w.box((x[0], x[1] - 0.03), parts.centred(side * (0.5 * width - 0.02), 0.025), (0.0, height - thick), wood)
        else:
            parts.tube_frame(
                w, (x[0] + 0.03, x[1] - 0.03), side * (0.5 * width - 0.05), (0.0, height - thick), 0.03, w.look("iron")
            )
    if legs != "post":
        w.box(parts.centred(x[0] + 0.05, 0.02), (y[0] + 0.03, y[1] - 0.03), (height - 0.25, height - thick), wood)
    deep, tall = x[0] + w.length(0.18, 0.28), height + w.length(0.25, 0.60)
    for c in (y[0] + 0.01, y[1] - 0.01):
        w.box((x[0], deep), parts.centred(c, 0.02), (height, tall), wood)
    w.box((x[0], deep), y, (tall, tall + 0.02), wood)
    rows = 1 if tall < height + 0.35 else 2
    for i in range(1, rows):
        z = height + i * (tall - height) / rows
        w.box((x[0], deep), (y[0] + 0.02, y[1] - 0.02), (z - 0.01, z + 0.01), wood)
    if w.chance(0.7):
        w.box((x[0], x[0] + 0.01), (y[0] + 0.02, y[1] - 0.02), (height, tall), wood)
    for i in range(w.whole(0, 3)):
        c = (-0.28, 0.28, 0.0)[i] * width
        w.box((x[0] + 0.01, deep), parts.centred(c, 0.015), (tall - (tall - height) / rows, tall), wood)
    w.top((deep + 0.05, x[1] - 0.04), (y[0] + 0.06, y[1] - 0.06), height)
    w.top((x[0] + 0.03, deep - 0.03), (y[0] + 0.06, y[1] - 0.06), tall + 0.02)


def desk_kneehole(w: Workbench) -> None:
    """Builds a desk on two drawer pedestals, often with a back panel, and sometimes with a leather top."""
    width, depth, height = w.width(1.20, 1.80), w.depth(0.60, 0.85), w.length(0.73, 0.78)
    wood, metal = w.look("wood") if w.chance(0.7) else w.look("lacquer"), w.look("brass")
    x, y = parts.slab(w, depth, width, (height - w.length(0.02, 0.045), height), wood)
    under, foot, each = height - 0.02, w.length(0.05, 0.16), min(0.45, 0.3 * width)
    rows, handle = w.whole(2, 4), w.choice(("knob", "bar", "cup"))
    for side in BOTH_SIDES:
        span = parts.on_side(side, 0.5 * width - 0.03 - each, 0.5 * width - 0.03)
        w.box((x[0] + 0.03, x[1] - 0.04), span, (foot, under), wood)
        parts.plain_drawers(w, x[1] - 0.04, span, (foot, under - 0.03), rows, 1, wood, metal, handle)
        if foot < 0.10:
            w.box((x[0] + 0.05, x[1] - 0.06), (span[0] + 0.02, span[1] - 0.02), (0.0, foot), wood)
        else:
            w.legs((x[0] + 0.04, x[1] - 0.05), span, (0.0, foot), 0.04, wood)
    knee = (y[0] + 0.03 + each, y[1] - 0.03 - each)
    if w.chance(0.7):
        w.box((x[0] + 0.05, x[1] - 0.05), knee, (under - 0.11, under), wood)
        w.box(
            (x[1] - 0.05, x[1] - 0.035),
            (knee[0] + 0.01, knee[1] - 0.01),
            (under - 0.10, under - 0.03),
            wood,
            solid=False,
        )
    if w.chance(0.7):
        w.box((x[0] + 0.04, x[0] + 0.06), knee, (w.choice((0.05, 0.3)), under), wood)
    if w.chance(0.4):
        field = (height - 0.004, height + 0.002)
        w.box((x[0] + 0.07, x[1] - 0.07), (y[0] + 0.08, y[1] - 0.08), field, w.look("leather"), solid=False)


def desk_gaming(w: Workbench) -> None:
    """Builds a desk with slanted metal legs, a dark top and often a raised board for screens."""
    width, depth, height = w.width(1.10, 1.60), w.depth(0.60, 0.75), w.length(0.73, 0.76)
    frame, top = w.look("metal"), w.look("dark") if w.chance(0.6) else w.look("lacquer")
    x, y = parts.footprint(depth, width)
    w.box(x, y, (height - 0.022, height), top)
    kind, apart = w.choice(("k", "z")), 0.5 * width - w.length(0.08, 0.2)
    for side in BOTH_SIDES:
        c = side * apart
        w.box((x[0] + 0.02, x[1] - 0.02), parts.centred(c, 0.06), (0.0, 0.03), frame)
        w.box((x[0] + 0.04, x[1] - 0.06), parts.centred(c, 0.06), (height - 0.05, height - 0.022), frame)
        a, b = (x[0] + 0.10, c, height - 0.04), (x[1] - 0.12, c, 0.02)
        if kind == "z":
            w.bar((a[0], c, 0.02), (b[0], c, height - 0.04), 0.06, 0.05, frame)
        else:
            knee = (x[0] + 0.16, c, 0.5 * height)
            w.bar((x[0] + 0.30, c, 0.02), knee, 0.06, 0.05, frame)
            w.bar(knee, (x[0] + 0.30, c, height - 0.04), 0.06, 0.05, frame)
            w.bar(knee, b, 0.06, 0.04, frame)
    rail = x[0] + 0.16 if kind == "k" else -0.01
    w.box(parts.centred(rail, 0.04), (-apart, apart), parts.centred(0.5 * height - 0.01, 0.04), frame)
    if w.chance(0.6):
        rise, span = w.length(0.09, 0.14), (y[0] + w.length(0.05, 0.25), y[1] - w.length(0.05, 0.25))
        for c in (span[0] + 0.03, span[1] - 0.03):
            w.box((x[0] + 0.02, x[0] + 0.18), parts.centred(c, 0.03), (height, height + rise), frame)
        w.box((x[0], x[0] + 0.22), span, (height + rise, height + rise + 0.018), top)
        w.top((x[0] + 0.24, x[1] - 0.05), (y[0] + 0.05, y[1] - 0.05), height)
        w.top((x[0] + 0.01, x[0] + 0.21), (span[0] + 0.02, span[1] - 0.02), height + rise + 0.018)
    else:
        w.top((x[0] + 0.05, x[1] - 0.05), (y[0] + 0.05, y[1] - 0.05), height)
    if w.chance(0.5):
        glow = (height - 0.016, height - 0.008)
        w.box((x[1] - 0.002, x[1] + 0.004), (y[0] + 0.05, y[1] - 0.05), glow, w.look("glow"), solid=False)
    side = w.choice(BOTH_SIDES)
    w.cylinder((0.1, side * (0.5 * width + 0.03)), (height - 0.09, height - 0.01), 0.04, frame, solid=False)


def desk_tray(w: Workbench) -> None:
    """Builds a writing desk: a thin box with drawers or open slots, with a low rim and often splayed legs."""
    width, depth, height = w.width(0.90, 1.35), w.depth(0.48, 0.65), w.length(0.73, 0.77)
    wood, front = w.look("wood"), parts.wood_look(w)
    x, y, deep = parts.centred(0.0, depth), parts.centred(0.0, width), w.length(0.08, 0.14)
    w.box(x, y, (height - 0.018, height), wood)
    w.box((x[0], x[1] - 0.02), y, (height - deep, height - deep + 0.015), wood)
    w.box((x[0], x[0] + 0.015), y, (height - deep, height), wood)
    dividers = w.whole(1, 2)
    for c in (y[0] + 0.01, y[1] - 0.01, *((-0.17 * width, 0.17 * width) if dividers == 2 else (0.0,))):
        w.box((x[0], x[1] - 0.01), parts.centred(c, 0.016), (height - deep, height - 0.018), wood)
    if w.chance(0.7):
        span = (y[0] + 0.02, w.choice((0.0, y[1] - 0.02)))
        knob = w.look("brass")
        z = (height - deep, height - 0.016)
        parts.plain_drawers(w, x[1] - 0.028, span, z, 1, w.whole(1, 2), front, knob, w.choice(("knob", "none")))
        w.box((x[0] + 0.05, x[1] - 0.028), (span[0] + 0.01, span[1] - 0.01), (z[0] + 0.01, z[1] - 0.002), wood)
    rim = w.choice((0.0, 0.03, 0.12))
    if rim:
        w.box((x[0], x[0] + 0.015), y, (height, height + rim), wood)
        for c in (y[0] + 0.008, y[1] - 0.008):
            w.box((x[0], x[0] + 0.4 * depth), parts.centred(c, 0.016), (height, height + 0.7 * rim), wood)
    thin, splay = w.length(0.025, 0.045), w.choice((0.0, 0.05, 0.08))
    w.legs(
        (x[0] + 0.08, x[1] - 0.09), (y[0] + 0.09, y[1] - 0.09), (0.0, height - deep + 0.005), thin, wood, splay=splay
    )
    w.top((x[0] + 0.08, x[1] - 0.04), (y[0] + 0.06, y[1] - 0.06), height)


STYLES: tuple[Style, ...] = (
    Style("table", "desk_hutch", "wide", desk_hutch, ("desk",)),
    Style("table", "desk_kneehole", "wide", desk_kneehole, ("desk",)),
    Style("table", "desk_gaming", "wide", desk_gaming, ("desk",)),
    Style("table", "desk_tray", "wide", desk_tray, ("desk",)),
)
