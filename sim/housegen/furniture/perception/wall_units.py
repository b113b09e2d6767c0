"""Kitchen wall units of the pool `wide`."""

from __future__ import annotations

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.parts import BOTH_SIDES, FrontKind, HandleKind
from sim.housegen.furniture.workbench import Workbench


def wall_unit_open(w: Workbench) -> None:
    """Builds a kitchen wall unit, partly with doors and partly open, sometimes with cups on hooks below it."""
    width, depth, height = w.width(0.60, 1.80), w.depth(0.26, 0.36), w.height(0.50, 0.80)
    w.mount_height_m = 1.42
    look, metal = parts.wood_look(w), w.look(w.choice(("metal", "dark", "brass")))
    half, count = 0.5 * width, max(1, round(width / 0.45))
    shut = count // 2 if w.chance(0.5) else (count + 1) // 2
    split = -half + shut * width / count
    side = w.choice(BOTH_SIDES)
    span, rest = (-half, split), (split, half)
    if side < 0:
        span, rest = (-split, half), (-half, -split)
    if shut:
        w.box((0.0, depth - 0.018), span, (0.0, height), look)
        parts.styled_doors(
            w,
            depth - 0.018,
            span,
            (0.0, height),
            shut,
            look,
            metal,
            w.choice(("flat", "frame")),
            w.choice(("knob", "bar")),
        )
    if rest[1] - rest[0] > 0.05:
        parts.open_case(w, (0.0, depth), rest, (0.0, height), 0.018, look)
        shelves = w.whole(1, 2)
        step = height / (shelves + 1)
        for i in range(shelves + 1):
            if i:
                w.box((0.0, depth - 0.02), (rest[0] + 0.01, rest[1] - 0.01), (i * step - 0.009, i * step + 0.009), look)
            count = max(1, round((rest[1] - rest[0]) / 0.22))
            parts.shelf_objects(
                w,
                (0.02, depth),
                (rest[0] + 0.03, rest[1] - 0.03),
                i * step + (0.009 if i else 0.018),
                min(count, 4),
                step - 0.03,
            )
    if w.chance(0.4):
        w.rod((depth - 0.06, -half + 0.03, -0.01), (depth - 0.06, half - 0.03, -0.01), 0.008, metal, solid=False)
        for i in range(min(4, max(1, int(width / 0.3)))):
            at = -half + 0.1 + i * 0.2
            if at < half - 0.05:
                w.cylinder((depth - 0.06, at), (-0.11, -0.015), 0.035, w.new_look("ceramic"), solid=False)


def wall_unit_tiers(w: Workbench) -> None:
    """Builds a kitchen wall unit of two tiers: doors below and low flaps above."""
    width, depth, height = w.width(0.60, 1.80), w.depth(0.32, 0.38), w.height(0.75, 0.95)
    w.mount_height_m = 1.42
    look, metal = parts.wood_look(w), w.look(w.choice(("metal", "dark", "brass")))
    upper = w.new_look("lacquer") if w.chance(0.3) else look
    half, split = 0.5 * width, height - w.length(0.24, 0.36)
    inset = w.choice((0.0, 0.0, 0.08))
    w.box((0.0, depth - 0.018), (-half, half), (0.0, split), look)
    w.box((0.0, depth - inset - 0.018), (-half, half), (split, height), upper)
    grip: HandleKind = w.choice(("bar", "knob", "slot", "rail"))
    front: FrontKind = w.choice(("flat", "frame"))
    y = (-half, half)
    parts.styled_doors(w, depth - 0.018, y, (0.0, split), max(1, round(width / 0.45)), look, metal, front, grip)
    parts.styled_drawers(
        w,
        depth - inset - 0.018,
        y,
        (split, height),
        upper,
        metal,
        "flat",
        grip if grip != "knob" else "slot",
        max(1, round(width / 0.8)),
    )
    if w.chance(0.3):
        w.box((0.0, depth + 0.02), y, (height, height + 0.03), look)


STYLES: tuple[Style, ...] = (
    Style("cabinet", "wall_unit_open", "wide", wall_unit_open, ("kitchen_wall",), "wall"),
    Style("cabinet", "wall_unit_tiers", "wide", wall_unit_tiers, ("kitchen_wall",), "wall"),
)
