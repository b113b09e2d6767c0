"""Free-form tables of the pool `wide`: any top on any base, with drawers, shelves or a hutch."""

from __future__ import annotations

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.free.bases import LIGHT, add_base, frame_look, pedestal
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.shapes import Ring, loft
from sim.homes.housegen.furniture.workbench import Workbench


def _top(w: Workbench, deep: float, wide: float, high: float, thick: float, look: Look) -> float:
    """Adds a rectangular, rounded or elliptical top; returns the share of its sides that corners below it may have."""
    power = w.choice((0.0, 0.0, 0.0, 2.0, 3.0, 7.0))
    if not power:
        parts.slab(w, deep, wide, (high - thick, high), look)
        return 0.94
    edge = w.length(0.92, 1.0)
    rings = [(high - thick, edge), (high - 0.4 * thick, 1.0), (high, 1.0)]
    outline = [Ring(z, 0.5 * s * deep, 0.5 * s * wide, power=power) for z, s in rings]
    w.mesh(loft(outline, 24, hull=True), (0.0, 0.0, 0.0), look)
    share = 0.33 if power < 4 else 0.42
    w.top((-share * deep, share * deep), (-share * wide, share * wide), high)
    return 0.5 ** (1.0 / power) - 0.03


def _table(w: Workbench, deep: float, wide: float, high: float, *, column: float, extras: float) -> None:
    """Builds a table; `column` is the probability of a pedestal, `extras` of an apron, drawers or a shelf each."""
    frame, thick = frame_look(w, 0.35), w.length(0.012, 0.06)
    top = frame if w.chance(0.35) else w.look(w.choice(("wood", "wood", "lacquer", "stone", "metal")))
    inset = min(w.length(0.72, 0.94), _top(w, deep, wide, high, thick, top))
    under = high - thick
    x, y = (-0.5 * inset * deep, 0.5 * inset * deep), (-0.5 * inset * wide, 0.5 * inset * wide)
    if w.chance(column):
        if wide > 1.6 * deep:
            for side in parts.BOTH_SIDES:
                pedestal(w, (0.0, side * 0.28 * wide), min(0.8 * deep, 0.4 * wide), under, frame)
        else:
            pedestal(w, (0.0, 0.0), 0.9 * min(deep, wide), under, frame)
        return
    apron = w.length(0.05, 0.16) if w.chance(extras) else 0.0
    if apron:
        w.box((x[0] + 0.01, x[1] - 0.01), (y[0] + 0.01, y[1] - 0.01), (under - apron, under + 0.002), frame)
        if apron > 0.08 and w.chance(0.5):
            count, grip = w.whole(1, 3), w.choice(("bar", "knob", "cup", "slot", "none"))
            edges = [under - apron + 0.005, under - 0.005]
            span, metal = (0.9 * y[0], 0.9 * y[1]), w.look("brass")
            parts.styled_drawers(w, x[1] - 0.012, span, edges, frame, metal, "flat", grip, count)
    kind = add_base(w, x, y, under - max(0.0, apron - 0.01), LIGHT, frame)
    if kind in ("square", "round", "turned", "panel") and w.chance(0.6 * extras):
        z = w.length(0.18, 0.45) * high
        w.box((x[0] + 0.02, x[1] - 0.02), (y[0] + 0.02, y[1] - 0.02), (z, z + 0.02), w.choice((frame, top)))


def free_dining_table(w: Workbench) -> None:
    """Builds a dining table of any top and base."""
    deep = w.depth(0.74, 1.0)
    wide = deep if w.chance(0.25) and w.hints.get("width_m") is None else w.width(1.15, 2.1)
    _table(w, deep, max(wide, 0.75), w.length(0.72, 0.77), column=0.25, extras=0.45)


def free_coffee_table(w: Workbench) -> None:
    """Builds a coffee table of any top and base."""
    _table(w, w.depth(0.48, 0.75), w.width(0.60, 1.25), w.length(0.32, 0.48), column=0.2, extras=0.5)


def free_side_table(w: Workbench) -> None:
    """Builds a side table of any top and base."""
    wide = w.width(0.34, 0.58)
    _table(w, wide * w.choice((1.0, w.length(0.75, 1.0))), wide, w.length(0.44, 0.64), column=0.4, extras=0.4)


def free_console(w: Workbench) -> None:
    """Builds a narrow console table of any top and base."""
    _table(w, w.depth(0.28, 0.42), w.width(0.80, 1.40), w.length(0.74, 0.88), column=0.05, extras=0.5)


def free_bedside_table(w: Workbench) -> None:
    """Builds a bedside table of any top and base."""
    _table(w, w.depth(0.34, 0.44), w.width(0.38, 0.56), w.length(0.44, 0.64), column=0.2, extras=0.75)


def free_desk(w: Workbench) -> None:
    """Builds a desk: a top on any base, often with a block of drawers or a panel at its back."""
    deep, wide, high = w.depth(0.54, 0.78), w.width(0.95, 1.60), w.length(0.71, 0.76)
    _table(w, deep, wide, high, column=0.0, extras=0.3)
    if w.chance(0.4):
        side, look, each = w.choice(parts.BOTH_SIDES), parts.wood_look(w), w.length(0.30, 0.42)
        y = parts.on_side(side, 0.42 * wide - each, 0.42 * wide)
        z = (w.choice((0.0, 0.0, 0.3)) * high, high - 0.055)
        w.box((-0.4 * deep, 0.38 * deep), y, (z[0], high - 0.008), look)
        edges = parts.graded_rows(z[0] + 0.01, z[1], w.whole(1, 4), w.choice((1.0, 1.3)))
        parts.styled_drawers(w, 0.38 * deep, y, edges, look, w.look("steel"), "flat", w.choice(("bar", "knob", "slot")))
    elif w.chance(0.4):
        low = w.length(0.3, 0.7) * high
        w.box((-0.32 * deep, -0.32 * deep + 0.018), (-0.34 * wide, 0.34 * wide), (low, high - 0.01), parts.wood_look(w))


STYLES: tuple[Style, ...] = (
    Style("table", "free_dining", "wide", free_dining_table, ("dining",)),
    Style("table", "free_coffee", "wide", free_coffee_table, ("coffee",)),
    Style("table", "free_side", "wide", free_side_table, ("side",)),
    Style("table", "free_console", "wide", free_console, ("console",)),
    Style("table", "free_bedside", "wide", free_bedside_table, ("nightstand",)),
    Style("table", "free_desk", "wide", free_desk, ("desk",)),
)
