"""Cabinets: wardrobes, sideboards, media benches, kitchen wall units, washstands.

Sizes follow Neufert, Architects' Data (wardrobes 0.58-0.65 m deep and 1.90-2.40 m high, sideboards 0.40-0.48 m deep
and 0.70-0.90 m high) and the 60 cm grid of European kitchens (wall units 0.30-0.37 m deep and 0.60-0.75 m high,
1.40 m above the floor).
"""

from __future__ import annotations

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, centred, inset
from sim.homes.housegen.furniture.shapes import chamfered_box
from sim.homes.housegen.furniture.workbench import Range, Workbench


def wardrobe_doors(w: Workbench) -> None:
    """Builds a wardrobe with two to four tall doors on a plinth."""
    width, depth, height = w.width(0.90, 1.90), w.depth(0.58, 0.64), w.height(1.95, 2.30)
    look = parts.wood_look(w)
    x, y = parts.case(w, depth, width, (0.07, height), look, foot=0.07)
    parts.plain_doors(
        w, x, y, (0.07, height), max(2, round(width / 0.48)), look, w.look("metal"), w.choice(("bar", "knob"))
    )


def wardrobe_sliding(w: Workbench) -> None:
    """Builds a wardrobe with two or three wide sliding doors, one of them like a mirror."""
    width, depth, height = w.width(1.40, 2.20), w.depth(0.60, 0.66), w.height(2.00, 2.30)
    body, front, metal = w.look("lacquer"), w.look("wood"), w.look("metal")
    w.box((-0.5 * depth, 0.5 * depth - 0.06), centred(width), (0.0, height), body)
    w.box((0.5 * depth - 0.06, 0.5 * depth), centred(width), (0.0, 0.05), body)
    w.box((0.5 * depth - 0.06, 0.5 * depth), centred(width), (height - 0.05, height), body)
    leaves = 2 if width < 1.8 else 3
    pitch = width / leaves
    glazed = w.whole(0, leaves - 1)
    for i in range(leaves):
        x = 0.5 * depth - 0.06 + 0.025 * (i % 2)
        y = (-0.5 * width + i * pitch, -0.5 * width + (i + 1) * pitch)
        w.box((x, x + 0.022), y, (0.05, height - 0.05), w.look("screen") if i == glazed else front)
        for edge in inset(y, 0.012):
            w.box((x + 0.022, x + 0.030), around(edge, 0.012), (0.05, height - 0.05), metal, solid=False)


def armoire(w: Workbench) -> None:
    """Builds an old wardrobe with a cornice, two panelled doors over a drawer, and ball feet."""
    width, depth, height = w.width(1.00, 1.35), w.depth(0.56, 0.62), w.height(1.90, 2.15)
    wood = w.look("wood")
    x, y = parts.footprint(depth, width)
    w.box(x, y, (0.10, height - 0.08), wood)
    w.box((x[0], x[1] + 0.05), (y[0] - 0.05, y[1] + 0.05), (height - 0.08, height - 0.03), wood)
    w.box((x[0], x[1] + 0.08), (y[0] - 0.08, y[1] + 0.08), (height - 0.03, height), wood)
    w.box((x[0], x[1] + 0.03), (y[0] - 0.03, y[1] + 0.03), (0.10, 0.15), wood)
    for sx in inset(x, 0.07, 0.05):
        for side in BOTH_SIDES:
            w.ellipsoid((sx, side * (0.5 * width - 0.06), 0.055), (0.055, 0.055, 0.055), wood)
    parts.plain_drawers(w, x[1], y, (0.16, 0.40), 1, 1, wood, w.look("brass"), "cup")
    parts.plain_doors(w, x[1], y, (0.40, height - 0.09), 2, wood, w.look("brass"), "knob")
    panel = wood if wood.texture is None else w.look("wood")
    for c in (-0.25 * width, 0.25 * width):
        for z in ((0.50, 0.95), (1.10, height - 0.20)):
            w.mesh(
                chamfered_box((0.03, 0.30 * width, z[1] - z[0]), 0.014),
                (x[1] + parts.FRONT_M, c, 0.5 * (z[0] + z[1])),
                panel,
                solid=False,
            )


def sideboard_legs(w: Workbench) -> None:
    """Builds a long low cabinet on legs with doors next to drawers."""
    width, depth, height = w.width(1.20, 1.80), w.depth(0.40, 0.47), w.length(0.74, 0.86)
    wood, foot = w.look("wood"), w.length(0.14, 0.20)
    front = w.look("lacquer") if w.chance(0.4) else wood
    x, y = parts.case(w, depth, width, (foot, height), wood)
    third = y[0] + (y[1] - y[0]) / 3
    parts.plain_drawers(
        w, x, (y[0] + 0.015, third), (foot + 0.015, height - 0.02), 3, 1, front, w.look("brass"), "knob"
    )
    parts.plain_doors(w, x, (third, y[1] - 0.015), (foot + 0.015, height - 0.02), 2, front, w.look("brass"), "knob")
    w.legs(centred(depth, 0.06), inset(y, 0.10), (0.0, foot), 0.035, wood, splay=0.025)


def display(w: Workbench) -> None:
    """Builds a dresser: a cupboard below glazed shelves with crockery."""
    width, depth, height = w.width(0.85, 1.20), w.depth(0.38, 0.44), w.height(1.80, 2.05)
    look = parts.wood_look(w)
    x, y = parts.footprint(depth, width)
    base = 0.86
    w.box(x, y, (0.0, base), look)
    parts.plain_doors(w, x[1], y, (0.06, base - 0.18), 2, look, w.look("brass"), "knob")
    parts.plain_drawers(w, x[1], y, (base - 0.17, base - 0.02), 1, 2, look, w.look("brass"), "knob")
    w.box((x[0], x[1] + 0.025), y, (base, base + 0.025), look)
    front = x[1] - 0.10
    w.box((x[0], x[0] + 0.012), y, (base + 0.025, height), look)
    for edge in centred(width, 0.011):
        w.box((x[0], front), around(edge, 0.011), (base + 0.025, height), look)
    for z in (base + 0.40, base + 0.72):
        w.box((x[0] + 0.012, front - 0.02), inset(y, 0.02), (z, z + 0.016), look)
    w.box((x[0], front + 0.02), (y[0] - 0.015, y[1] + 0.015), (height - 0.03, height), look)
    w.box((front - 0.006, front), inset(y, 0.022), (base + 0.025, height - 0.03), w.look("glass"))
    w.box((front - 0.012, front + 0.006), (-0.02, 0.02), (base + 0.025, height - 0.03), look, solid=False)
    for i in range(3):
        w.cylinder(
            (0.5 * (x[0] + front), (i - 1) * 0.28 * width),
            (base + 0.416, base + 0.50),
            0.05,
            w.new_look("ceramic"),
            solid=False,
        )


def tambour(w: Workbench) -> None:
    """Builds a sideboard with fluted fronts on a metal sled base."""
    width, depth, height = w.width(1.30, 1.80), w.depth(0.40, 0.46), w.length(0.70, 0.80)
    wood, metal = w.look("wood"), w.look("brass")
    x, y = parts.case(w, depth, width, (0.16, height), wood)
    slats = 15
    for i in range(slats):
        c = y[0] + (i + 0.5) * width / slats
        w.box((x, x + 0.016), around(c, 0.30 * width / slats), (0.18, height - 0.02), wood, solid=False)
    for c in centred(width, 0.15):
        w.box(centred(depth, 0.03), around(c, 0.01), (0.0, 0.02), metal)
        for cx in centred(depth, 0.04):
            w.box(around(cx, 0.01), around(c, 0.01), (0.02, 0.16), metal)


def media_low(w: Workbench) -> None:
    """Builds a television bench with an open compartment between drop fronts."""
    width, depth, height = w.width(1.20, 1.80), w.depth(0.38, 0.45), w.length(0.42, 0.52)
    body = parts.wood_look(w)
    x, y = parts.footprint(depth, width)
    w.box(x, y, (height - 0.03, height), body)
    w.box(x, y, (0.06, 0.085), body)
    w.box((x[0], x[0] + 0.012), y, (0.085, height - 0.03), body)
    w.box(inset(x, 0.03, 0.05), inset(y, 0.05), (0.0, 0.06), w.look("dark"))
    third = width / 3
    for side in BOTH_SIDES:
        span = parts.on_side(side, 0.5 * width - third, 0.5 * width)
        w.box((x[0], x[1] - parts.FRONT_M), span, (0.085, height - 0.03), body)
        parts.plain_drawers(w, x[1] - parts.FRONT_M, span, (0.085, height - 0.03), 1, 1, body, w.look("metal"), "bar")
    w.box(inset(x, 0.012, 0.06), centred(third), around(0.5 * height, 0.01), body)
    w.box(inset(x, 0.08), (-0.18, 0.18), (0.085, 0.14), w.look("dark"), solid=False)
    w.top(inset(x, 0.03), inset(y, 0.05), height)


def media_legs(w: Workbench) -> None:
    """Builds a television bench: a slatted tray on a metal frame with one closed box."""
    width, depth, height = w.width(1.20, 1.70), w.depth(0.36, 0.42), w.length(0.45, 0.55)
    wood, iron = w.look("wood"), w.look("iron")
    x, y = parts.footprint(depth, width)
    w.box(x, y, (height - 0.035, height), wood)
    w.box(inset(x, 0.01), inset(y, 0.01), (0.15, 0.175), wood)
    w.legs(inset(x, 0.005), inset(y, 0.005), (0.0, height - 0.035), 0.025, iron)
    side = w.choice(BOTH_SIDES)
    span = parts.on_side(side, 0.10 * width, 0.47 * width)
    w.box(inset(x, 0.02, 0.03), span, (0.175, height - 0.035), wood)
    parts.plain_doors(w, x[1] - 0.03, span, (0.175, height - 0.035), 1, wood, w.look("brass"), "knob")
    w.box(inset(x, 0.08), around(-side * 0.30 * width, 0.15), (0.175, 0.24), w.look("dark"), solid=False)
    w.top(inset(x, 0.03), inset(y, 0.05), height)


def wall_unit(w: Workbench) -> None:
    """Builds a kitchen wall cupboard."""
    width, depth, height = w.width(0.60, 1.80), w.depth(0.32, 0.36), w.height(0.60, 0.75)
    w.mount_height_m = 1.42
    look = w.look("lacquer") if w.chance(0.6) else w.look("wood")
    y = centred(width)
    w.box((0.0, depth), y, (0.0, height), look)
    parts.plain_doors(
        w, depth, y, (0.0, height), max(1, round(width / 0.5)), look, w.look("metal"), "bar", low_handles=True
    )


def wall_unit_glazed(w: Workbench) -> None:
    """Builds a kitchen wall cupboard with framed glass doors in front of a pale back with a shelf."""
    width, depth, height = w.width(0.60, 1.80), w.depth(0.30, 0.35), w.height(0.60, 0.75)
    w.mount_height_m = 1.42
    look, y = w.look("lacquer"), centred(width)
    w.box((0.0, 0.02), y, (0.0, height), look)
    for z in ((0.0, 0.02), around(0.5 * height, 0.008), (height - 0.02, height)):
        w.box((0.02, depth - 0.02), y, z, look)
    count = max(1, round(width / 0.5))
    pitch = width / count
    for i in range(count + 1):
        c = min(max(y[0] + i * pitch, y[0] + 0.02), y[1] - 0.02)
        w.box((0.02, depth), around(c, 0.02), (0.0, height), look)
    w.box((depth - 0.012, depth - 0.006), inset(y, 0.04), (0.02, height - 0.02), w.look("glass"))
    for z in ((0.0, 0.045), (height - 0.045, height)):
        w.box((depth - 0.018, depth), inset(y, 0.04), z, look)


def vanity_doors(w: Workbench) -> None:
    """Builds a bathroom washstand with a cupboard, a top and a basin; the basin is a separate sink."""
    width, depth, height = w.width(0.70, 1.20), w.depth(0.46, 0.52), w.length(0.80, 0.86)
    look = parts.wood_look(w)
    x, y = parts.footprint(depth, width)
    w.box((x[0], x[1] - 0.03), inset(y, 0.01), (0.10, height - 0.03), look)
    w.box(inset(x, 0.02, 0.10), inset(y, 0.03), (0.0, 0.10), w.look("dark"))
    w.box(x, y, (height - 0.03, height), w.look("stone"))
    parts.plain_doors(
        w, x[1] - 0.03, inset(y, 0.01), (0.10, height - 0.04), max(2, round(width / 0.5)), look, w.look("metal"), "bar"
    )
    w.put(w.make("sink", use="vessel"), (0.02, 0.0, height))
    for side in BOTH_SIDES:
        if 0.5 * width > 0.45:
            w.top(inset(x, 0.05), parts.on_side(side, 0.32, 0.5 * width - 0.03), height)


def vanity_floating(w: Workbench) -> None:
    """Builds a washstand on the wall: one wide drawer block under a slab with a basin on it."""
    width, depth = w.width(0.70, 1.20), w.depth(0.45, 0.50)
    w.mount_height_m = 0.42
    wood, y = w.look("wood"), centred(width)
    w.box((0.0, depth - 0.03), y, (0.0, 0.40), wood)
    w.box((0.0, depth), (y[0] - 0.01, y[1] + 0.01), (0.40, 0.43), w.look("stone"))
    parts.plain_drawers(w, depth - 0.03, y, (0.0, 0.39), 2, 1, wood, w.look("metal"), "bar")
    w.put(w.make("sink", use="vessel"), (0.5 * depth + 0.02, 0.0, 0.43))


def sliding_wardrobe(w: Workbench) -> None:
    """Builds a wardrobe with two sliding doors, one of them a mirror, and rails above and below."""
    width, depth, height = w.width(1.20, 1.90), w.depth(0.56, 0.64), w.height(1.95, 2.15)
    body, panel, metal = w.look("wood"), w.look("lacquer"), w.look("metal")
    x, y = parts.case(w, depth, width, (0.05, height), body, foot=0.05)
    middle = 0.5 * (y[0] + y[1])
    w.box((x, x + 0.012), (y[0] + 0.02, middle + 0.03), (0.09, height - 0.05), panel, solid=False)
    w.box((x, x + 0.022), (middle - 0.03, y[1] - 0.02), (0.09, height - 0.05), w.look("mirror"), solid=False)
    for z in (0.07, height - 0.035):
        w.box((x, x + 0.026), inset(y, 0.01), around(z, 0.012), metal, solid=False)
    w.box((x, x + 0.028), (middle - 0.04, middle - 0.025), (0.09, height - 0.05), metal, solid=False)


def slatted_sideboard(w: Workbench) -> None:
    """Builds a sideboard with slatted doors on a sled base."""
    width, depth, height = w.width(1.20, 1.60), w.depth(0.40, 0.46), w.length(0.72, 0.84)
    wood, body, metal = w.look("wood"), w.look("lacquer"), w.look("iron")
    x, y = parts.case(w, depth, width, (0.16, height), body)
    _slatted_doors(w, x, y, (0.18, height - 0.03), wood)
    posts = centred(depth, 0.06)
    for edge in centred(width, 0.06):
        w.box(centred(depth, 0.03), around(edge, 0.014), (0.0, 0.02), metal)
        for post in posts:
            w.box(around(post, 0.012), around(edge, 0.014), (0.02, 0.17), metal)


def _slatted_doors(w: Workbench, x: float, y: Range, z: Range, look: Look) -> None:
    """Adds three hinged doors of slats side by side, each with a slot as its handle."""
    joints = inset(y, 0.003), inset(z, 0.003)
    w.box((x, x + parts.SHADOW_M), *joints, parts.darker(look), solid=False)
    pitch, tall = (y[1] - y[0]) / 3, z[1] - z[0]
    up, half = z[0] + 0.68 * tall, 0.5 * min(0.18, 0.5 * tall)
    face = x + parts.FRONT_M
    for i in range(3):
        left = y[0] + i * pitch
        _slatted_front(w, x, (left + parts.GAP_M, left + pitch - parts.GAP_M), inset(z, parts.GAP_M), look)
        hand = left + (pitch - 0.035 if i % 2 == 0 else 0.035)
        slot = around(hand, 0.007), (up - half - 0.006, up + half + 0.006)
        w.box(around(face, 0.002), *slot, w.look("dark"), solid=False)


def _slatted_front(w: Workbench, x: float, y: Range, z: Range, look: Look) -> None:
    """Adds a board with two to seven horizontal slats before a dark field."""
    face = x + parts.FRONT_M
    w.box((x, face), y, z, look, solid=False)
    edge = min(0.06, 0.22 * (y[1] - y[0]), 0.22 * (z[1] - z[0]))
    y, z = inset(y, edge), inset(z, edge)
    w.box((x, face + 0.001), y, z, parts.darker(look, 0.5), solid=False)
    rows = max(2, min(7, round((z[1] - z[0]) / 0.12)))
    step = (z[1] - z[0]) / rows
    for i in range(rows):
        w.box((x, face + 0.008), y, (z[0] + i * step, z[0] + (i + 0.7) * step), look, solid=False)


STYLES = (
    Style("cabinet", "wardrobe_doors", "train", wardrobe_doors, ("wardrobe",)),
    Style("cabinet", "wardrobe_sliding", "train", wardrobe_sliding, ("wardrobe",)),
    Style("cabinet", "armoire", "heldout", armoire, ("wardrobe",)),
    Style("cabinet", "sideboard_legs", "train", sideboard_legs, ("sideboard",)),
    Style("cabinet", "display", "train", display, ("sideboard", "display")),
    Style("cabinet", "tambour", "heldout", tambour, ("sideboard", "display")),
    Style("cabinet", "media_low", "train", media_low, ("media",)),
    Style("cabinet", "media_legs", "heldout", media_legs, ("media",)),
    Style("cabinet", "wall_unit", "train", wall_unit, ("kitchen_wall",), "wall"),
    Style("cabinet", "wall_unit_glazed", "heldout", wall_unit_glazed, ("kitchen_wall",), "wall"),
    Style("cabinet", "vanity_doors", "train", vanity_doors, ("vanity",)),
    Style("cabinet", "vanity_floating", "heldout", vanity_floating, ("vanity",), "wall"),
    Style("cabinet", "sliding_wardrobe", "heldout", sliding_wardrobe, ("wardrobe",)),
    Style("cabinet", "slatted_sideboard", "heldout", slatted_sideboard, ("sideboard",)),
)
