"""Cabinets, chests of drawers, shelves.

Ranges after Neufert, Architects' Data (wardrobes 0.58-0.65 m deep and 1.90-2.40 m high, sideboards 0.40-0.48 m deep
and 0.75-0.90 m high, chests 0.40-0.50 m deep, book shelves 0.25-0.38 m deep with 0.28-0.36 m between boards) and the
60 cm grid of European kitchens (wall units 0.30-0.37 m deep and 0.60-0.75 m high, 1.40 m above the floor).
"""

from __future__ import annotations

from sim.houses.furniture import parts
from sim.houses.furniture.catalogue import Style
from sim.houses.furniture.item import Look
from sim.houses.furniture.shapes import chamfered_box
from sim.houses.furniture.workbench import Range, Workbench

_BOTH = (-1, 1)
_BOARD = 0.018


def _case(w: Workbench, depth: float, width: float, z: Range, look: Look, *, foot: float = 0.0) -> tuple[float, Range]:
    """A closed body from z[0] to z[1] that things stand on; its front plane and y range."""
    x, y = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)
    w.box(x, y, z, look)
    if foot:
        w.box((x[0] + 0.02, x[1] - 0.05), (y[0] + 0.02, y[1] - 0.02), (z[0] - foot, z[0]), w.look("dark"))
    w.top((x[0] + 0.03, x[1] - 0.03), (y[0] + 0.05, y[1] - 0.05), z[1])
    return x[1], y


def _body(w: Workbench) -> Look:
    """Painted or plain wood."""
    return w.look("lacquer") if w.chance(0.45) else w.look("wood")


# ---- cabinets ----------------------------------------------------------------------------------------------------


def wardrobe_doors(w: Workbench) -> None:
    """Two to four tall doors on a plinth."""
    width, depth, height = w.width(0.90, 1.90), w.depth(0.58, 0.64), w.height(1.95, 2.30)
    look = _body(w)
    x, y = _case(w, depth, width, (0.07, height), look, foot=0.07)
    parts.doors(w, x, y, (0.07, height), max(2, round(width / 0.48)), look, w.look("metal"), w.choice(("bar", "knob")))


def wardrobe_sliding(w: Workbench) -> None:
    """Two or three wide sliding leaves, one of them a mirror-like pane."""
    width, depth, height = w.width(1.40, 2.20), w.depth(0.60, 0.66), w.height(2.00, 2.30)
    body, front, metal = w.look("lacquer"), w.look("wood"), w.look("metal")
    w.box((-0.5 * depth, 0.5 * depth - 0.06), (-0.5 * width, 0.5 * width), (0.0, height), body)
    w.box((0.5 * depth - 0.06, 0.5 * depth), (-0.5 * width, 0.5 * width), (0.0, 0.05), body)
    w.box((0.5 * depth - 0.06, 0.5 * depth), (-0.5 * width, 0.5 * width), (height - 0.05, height), body)
    leaves = 2 if width < 1.8 else 3
    each = width / leaves
    glazed = w.whole(0, leaves - 1)
    for i in range(leaves):
        x = 0.5 * depth - 0.06 + 0.025 * (i % 2)
        y = (-0.5 * width + i * each, -0.5 * width + (i + 1) * each)
        w.box((x, x + 0.022), y, (0.05, height - 0.05), w.look("screen") if i == glazed else front)
        for edge in (y[0] + 0.012, y[1] - 0.012):
            w.box((x + 0.022, x + 0.030), (edge - 0.012, edge + 0.012), (0.05, height - 0.05), metal, solid=False)


def sideboard_legs(w: Workbench) -> None:
    """Long low cabinet on legs: doors beside drawers."""
    width, depth, height = w.width(1.20, 1.80), w.depth(0.40, 0.47), w.length(0.74, 0.86)
    wood, foot = w.look("wood"), w.length(0.14, 0.20)
    front = w.look("lacquer") if w.chance(0.4) else wood
    x, y = _case(w, depth, width, (foot, height), wood)
    third = y[0] + (y[1] - y[0]) / 3
    parts.drawers(w, x, (y[0] + 0.015, third), (foot + 0.015, height - 0.02), 3, 1, front, w.look("brass"), "knob")
    parts.doors(w, x, (third, y[1] - 0.015), (foot + 0.015, height - 0.02), 2, front, w.look("brass"), "knob")
    w.legs((-0.5 * depth + 0.06, 0.5 * depth - 0.06), (y[0] + 0.10, y[1] - 0.10), (0.0, foot), 0.035, wood, splay=0.025)


def media_low(w: Workbench) -> None:
    """Television bench: an open compartment between drop fronts."""
    width, depth, height = w.width(1.20, 1.80), w.depth(0.38, 0.45), w.length(0.42, 0.52)
    body = _body(w)
    x, y = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)
    w.box(x, y, (height - 0.03, height), body)
    w.box(x, y, (0.06, 0.085), body)
    w.box((x[0], x[0] + 0.012), y, (0.085, height - 0.03), body)
    w.box((x[0] + 0.03, x[1] - 0.05), (y[0] + 0.05, y[1] - 0.05), (0.0, 0.06), w.look("dark"))
    third = width / 3
    for side in _BOTH:
        low, high = sorted((side * 0.5 * width, side * (0.5 * width - third)))
        w.box((x[0], x[1] - parts.FRONT_M), (low, high), (0.085, height - 0.03), body)
        parts.drawers(w, x[1] - parts.FRONT_M, (low, high), (0.085, height - 0.03), 1, 1, body, w.look("metal"), "bar")
    w.box((x[0] + 0.012, x[1] - 0.06), (-0.5 * third, 0.5 * third), (0.5 * height - 0.01, 0.5 * height + 0.01), body)
    w.box((x[0] + 0.08, x[1] - 0.08), (-0.18, 0.18), (0.085, 0.14), w.look("dark"), solid=False)
    w.top((x[0] + 0.03, x[1] - 0.03), (y[0] + 0.05, y[1] - 0.05), height)


def wall_unit(w: Workbench) -> None:
    """Kitchen wall cupboard."""
    width, depth, height = w.width(0.60, 1.80), w.depth(0.32, 0.36), w.height(0.60, 0.75)
    w.mount_height_m = 1.42
    look = w.look("lacquer") if w.chance(0.6) else w.look("wood")
    y = (-0.5 * width, 0.5 * width)
    w.box((0.0, depth), y, (0.0, height), look)
    parts.doors(w, depth, y, (0.0, height), max(1, round(width / 0.5)), look, w.look("metal"), "bar", high=True)


def vanity_doors(w: Workbench) -> None:
    """Bathroom washstand: cupboard, top and basin; the basin is a sink of its own."""
    width, depth, height = w.width(0.70, 1.20), w.depth(0.46, 0.52), w.length(0.80, 0.86)
    look = _body(w)
    x, y = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)
    w.box((x[0], x[1] - 0.03), (y[0] + 0.01, y[1] - 0.01), (0.10, height - 0.03), look)
    w.box((x[0] + 0.02, x[1] - 0.10), (y[0] + 0.03, y[1] - 0.03), (0.0, 0.10), w.look("dark"))
    w.box(x, y, (height - 0.03, height), w.look("stone"))
    parts.doors(
        w,
        x[1] - 0.03,
        (y[0] + 0.01, y[1] - 0.01),
        (0.10, height - 0.04),
        max(2, round(width / 0.5)),
        look,
        w.look("metal"),
        "bar",
    )
    w.put(w.make("sink", use="vessel"), (0.02, 0.0, height))
    for side in _BOTH:
        if 0.5 * width > 0.45:
            low, high = sorted((side * 0.32, side * (0.5 * width - 0.03)))
            w.top((x[0] + 0.05, x[1] - 0.05), (low, high), height)


def display(w: Workbench) -> None:
    """Dresser: cupboard below, glazed shelves with crockery above."""
    width, depth, height = w.width(0.85, 1.20), w.depth(0.38, 0.44), w.height(1.80, 2.05)
    look = _body(w)
    x, y = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)
    base = 0.86
    w.box(x, y, (0.0, base), look)
    parts.doors(w, x[1], y, (0.06, base - 0.18), 2, look, w.look("brass"), "knob")
    parts.drawers(w, x[1], y, (base - 0.17, base - 0.02), 1, 2, look, w.look("brass"), "knob")
    w.box((x[0], x[1] + 0.025), y, (base, base + 0.025), look)
    front = x[1] - 0.10
    w.box((x[0], x[0] + 0.012), y, (base + 0.025, height), look)
    for side in _BOTH:
        edge = side * (0.5 * width - 0.011)
        w.box((x[0], front), (edge - 0.011, edge + 0.011), (base + 0.025, height), look)
    for z in (base + 0.40, base + 0.72):
        w.box((x[0] + 0.012, front - 0.02), (y[0] + 0.02, y[1] - 0.02), (z, z + 0.016), look)
    w.box((x[0], front + 0.02), (y[0] - 0.015, y[1] + 0.015), (height - 0.03, height), look)
    w.box((front - 0.006, front), (y[0] + 0.022, y[1] - 0.022), (base + 0.025, height - 0.03), w.look("glass"))
    w.box((front - 0.012, front + 0.006), (-0.02, 0.02), (base + 0.025, height - 0.03), look, solid=False)
    for i in range(3):
        w.cylinder(
            (0.5 * (x[0] + front), (i - 1) * 0.28 * width),
            (base + 0.416, base + 0.50),
            0.05,
            w.new_look("ceramic"),
            solid=False,
        )


def armoire(w: Workbench) -> None:
    """Old wardrobe: cornice, two panelled doors over a drawer, ball feet."""
    width, depth, height = w.width(1.00, 1.35), w.depth(0.56, 0.62), w.height(1.90, 2.15)
    wood = w.look("wood")
    x, y = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)
    w.box(x, y, (0.10, height - 0.08), wood)
    w.box((x[0], x[1] + 0.05), (y[0] - 0.05, y[1] + 0.05), (height - 0.08, height - 0.03), wood)
    w.box((x[0], x[1] + 0.08), (y[0] - 0.08, y[1] + 0.08), (height - 0.03, height), wood)
    w.box((x[0], x[1] + 0.03), (y[0] - 0.03, y[1] + 0.03), (0.10, 0.15), wood)
    for sx in (x[0] + 0.07, x[1] - 0.05):
        for side in _BOTH:
            w.ellipsoid((sx, side * (0.5 * width - 0.06), 0.055), (0.055, 0.055, 0.055), wood)
    parts.drawers(w, x[1], y, (0.16, 0.40), 1, 1, wood, w.look("brass"), "cup")
    parts.doors(w, x[1], y, (0.40, height - 0.09), 2, wood, w.look("brass"), "knob")
    panel = wood if wood.texture is None else w.look("wood")
    for side in _BOTH:
        c = side * 0.25 * width
        for z in ((0.50, 0.95), (1.10, height - 0.20)):
            w.mesh(
                chamfered_box((0.03, 0.30 * width, z[1] - z[0]), 0.014),
                (x[1] + parts.FRONT_M, c, 0.5 * (z[0] + z[1])),
                panel,
                solid=False,
            )


def tambour(w: Workbench) -> None:
    """Sideboard with fluted fronts on a sled of metal."""
    width, depth, height = w.width(1.30, 1.80), w.depth(0.40, 0.46), w.length(0.70, 0.80)
    wood, metal = w.look("wood"), w.look("brass")
    x, y = _case(w, depth, width, (0.16, height), wood)
    slats = 15
    for i in range(slats):
        c = y[0] + (i + 0.5) * width / slats
        w.box(
            (x, x + 0.016),
            (c - 0.30 * width / slats, c + 0.30 * width / slats),
            (0.18, height - 0.02),
            wood,
            solid=False,
        )
    for side in _BOTH:
        c = side * (0.5 * width - 0.15)
        w.box((-0.5 * depth + 0.03, 0.5 * depth - 0.03), (c - 0.01, c + 0.01), (0.0, 0.02), metal)
        for sx in _BOTH:
            cx = sx * (0.5 * depth - 0.04)
            w.box((cx - 0.01, cx + 0.01), (c - 0.01, c + 0.01), (0.02, 0.16), metal)


def wall_unit_glazed(w: Workbench) -> None:
    """Kitchen wall cupboard: framed glass doors over a pale back with a shelf."""
    width, depth, height = w.width(0.60, 1.80), w.depth(0.30, 0.35), w.height(0.60, 0.75)
    w.mount_height_m = 1.42
    look, y = w.look("lacquer"), (-0.5 * width, 0.5 * width)
    w.box((0.0, 0.02), y, (0.0, height), look)
    for z in ((0.0, 0.02), (0.5 * height - 0.008, 0.5 * height + 0.008), (height - 0.02, height)):
        w.box((0.02, depth - 0.02), y, z, look)
    count = max(1, round(width / 0.5))
    each = width / count
    for i in range(count + 1):
        c = min(max(y[0] + i * each, y[0] + 0.02), y[1] - 0.02)
        w.box((0.02, depth), (c - 0.02, c + 0.02), (0.0, height), look)
    w.box((depth - 0.012, depth - 0.006), (y[0] + 0.04, y[1] - 0.04), (0.02, height - 0.02), w.look("glass"))
    for z in ((0.0, 0.045), (height - 0.045, height)):
        w.box((depth - 0.018, depth), (y[0] + 0.04, y[1] - 0.04), z, look)


def vanity_floating(w: Workbench) -> None:
    """Washstand hung on the wall: one wide drawer block under a slab with a basin on it."""
    width, depth = w.width(0.70, 1.20), w.depth(0.45, 0.50)
    w.mount_height_m = 0.42
    wood, y = w.look("wood"), (-0.5 * width, 0.5 * width)
    w.box((0.0, depth - 0.03), y, (0.0, 0.40), wood)
    w.box((0.0, depth), (y[0] - 0.01, y[1] + 0.01), (0.40, 0.43), w.look("stone"))
    parts.drawers(w, depth - 0.03, y, (0.0, 0.39), 2, 1, wood, w.look("metal"), "bar")
    w.put(w.make("sink", use="vessel"), (0.5 * depth + 0.02, 0.0, 0.43))


def media_legs(w: Workbench) -> None:
    """Television bench: a slatted tray on a metal frame with one closed box."""
    width, depth, height = w.width(1.20, 1.70), w.depth(0.36, 0.42), w.length(0.45, 0.55)
    wood, iron = w.look("wood"), w.look("iron")
    x, y = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)
    w.box(x, y, (height - 0.035, height), wood)
    w.box((x[0] + 0.01, x[1] - 0.01), (y[0] + 0.01, y[1] - 0.01), (0.15, 0.175), wood)
    w.legs((x[0] + 0.005, x[1] - 0.005), (y[0] + 0.005, y[1] - 0.005), (0.0, height - 0.035), 0.025, iron)
    side = w.choice(_BOTH)
    low, high = sorted((side * 0.47 * width, side * 0.10 * width))
    w.box((x[0] + 0.02, x[1] - 0.03), (low, high), (0.175, height - 0.035), wood)
    parts.doors(w, x[1] - 0.03, (low, high), (0.175, height - 0.035), 1, wood, w.look("brass"), "knob")
    w.box(
        (x[0] + 0.08, x[1] - 0.08),
        (-side * 0.30 * width - 0.15, -side * 0.30 * width + 0.15),
        (0.175, 0.24),
        w.look("dark"),
        solid=False,
    )
    w.top((x[0] + 0.03, x[1] - 0.03), (y[0] + 0.05, y[1] - 0.05), height)


# ---- chests of drawers -------------------------------------------------------------------------------------------


def dresser(w: Workbench) -> None:
    """Wide chest, three rows of two drawers, on short legs."""
    width, depth, height = w.width(0.95, 1.50), w.depth(0.42, 0.50), w.length(0.74, 0.88)
    look, foot = _body(w), w.length(0.08, 0.14)
    x, y = _case(w, depth, width, (foot, height), look)
    parts.drawers(
        w,
        x,
        (y[0] + 0.012, y[1] - 0.012),
        (foot + 0.012, height - 0.03),
        3,
        2,
        look,
        w.look("metal"),
        w.choice(("bar", "knob", "cup")),
    )
    w.legs((-0.5 * depth + 0.03, 0.5 * depth - 0.03), (y[0] + 0.03, y[1] - 0.03), (0.0, foot), 0.05, w.look("wood"))


def tallboy(w: Workbench) -> None:
    """Narrow and tall: five drawers."""
    width, depth, height = w.width(0.45, 0.65), w.depth(0.40, 0.46), w.length(1.05, 1.30)
    look = _body(w)
    x, y = _case(w, depth, width, (0.05, height), look, foot=0.05)
    parts.drawers(
        w,
        x,
        (y[0] + 0.01, y[1] - 0.01),
        (0.06, height - 0.025),
        w.whole(4, 6),
        1,
        look,
        w.look("metal"),
        w.choice(("bar", "knob")),
    )


def handleless(w: Workbench) -> None:
    """Modern chest, three broad fronts with shadow gaps."""
    width, depth, height = w.width(0.80, 1.30), w.depth(0.42, 0.48), w.length(0.70, 0.85)
    body, front = w.look("wood"), w.look("lacquer")
    x, y = _case(w, depth, width, (0.04, height), body, foot=0.04)
    tall = (height - 0.06) / 3
    for i in range(3):
        z = 0.045 + i * tall
        w.box((x, x + 0.02), (y[0] + 0.006, y[1] - 0.006), (z + 0.004, z + tall - 0.022), front, solid=False)


def bedside_chest(w: Workbench) -> None:
    """Bedside chest of two or three drawers."""
    width, depth, height = w.width(0.40, 0.52), w.depth(0.36, 0.44), w.length(0.48, 0.62)
    look = _body(w)
    x, y = _case(w, depth, width, (0.06, height), look, foot=0.06)
    parts.drawers(
        w,
        x,
        (y[0] + 0.01, y[1] - 0.01),
        (0.07, height - 0.025),
        w.whole(2, 3),
        1,
        look,
        w.look("brass"),
        w.choice(("knob", "bar")),
    )


def campaign(w: Workbench) -> None:
    """Chest with brass corners and flush handles on bun feet."""
    width, depth, height = w.width(0.90, 1.20), w.depth(0.44, 0.50), w.length(0.80, 0.95)
    wood, brass = w.look("wood"), w.look("brass")
    x, y = _case(w, depth, width, (0.09, height), wood)
    parts.drawers(w, x, y, (0.10, 0.62 * height), 2, 1, wood, brass, "none")
    parts.drawers(w, x, y, (0.62 * height, height - 0.02), 1, 2, wood, brass, "none")
    for c, z in (
        (-0.25 * width, 0.25 * height),
        (0.25 * width, 0.25 * height),
        (-0.25 * width, 0.48 * height),
        (0.25 * width, 0.48 * height),
        (-0.25 * width, 0.80 * height),
        (0.25 * width, 0.80 * height),
    ):
        w.box((x + 0.016, x + 0.022), (c - 0.05, c + 0.05), (z - 0.025, z + 0.025), brass, solid=False)
    for side in _BOTH:
        for z in (0.09, height - 0.06):
            edge = side * (0.5 * width - 0.028)
            w.box((x - 0.05, x + 0.021), (edge - 0.03, edge + 0.03), (z, z + 0.06), brass, solid=False)
        for sx in (-0.5 * depth + 0.06, 0.5 * depth - 0.06):
            w.ellipsoid((sx, side * (0.5 * width - 0.06), 0.05), (0.05, 0.05, 0.05), wood)


def apothecary(w: Workbench) -> None:
    """A wall of small square drawers with knobs, on a stand."""
    width, depth, height = w.width(0.80, 1.05), w.depth(0.36, 0.42), w.length(0.95, 1.10)
    wood = w.look("wood")
    x, y = _case(w, depth, width, (0.34, height), wood)
    parts.drawers(
        w, x, (y[0] + 0.02, y[1] - 0.02), (0.36, height - 0.03), 3, 4, w.look("lacquer"), w.look("brass"), "knob"
    )
    w.legs((-0.5 * depth + 0.01, 0.5 * depth - 0.01), (y[0] + 0.02, y[1] - 0.02), (0.0, 0.35), 0.045, wood)
    w.box((-0.5 * depth + 0.02, 0.5 * depth - 0.02), (y[0] + 0.04, y[1] - 0.04), (0.10, 0.12), wood)


def bedside_drum(w: Workbench) -> None:
    """Round bedside chest: a drum with two curved fronts."""
    radius, height = 0.5 * w.width(0.40, 0.48), w.length(0.48, 0.58)
    look, metal = w.look("lacquer"), w.look("brass")
    w.cylinder((0.0, 0.0), (0.05, height), radius, look)
    w.cylinder((0.0, 0.0), (0.0, 0.05), radius - 0.04, w.look("dark"))
    for z in (0.06, 0.5 * (height + 0.05), height - 0.012):
        w.cylinder((0.0, 0.0), (z - 0.006, z + 0.006), radius + 0.004, metal, solid=False)
    for z in (0.28 * height + 0.03, 0.72 * height):
        w.ball((radius + 0.012, 0.0, z), 0.016, metal, solid=False)
    half = 0.6 * radius
    w.top((-half, half), (-half, half), height)


# ---- shelving ----------------------------------------------------------------------------------------------------


def _books(w: Workbench, x: Range, y: Range, z: float, room: float) -> None:
    """A row of books on a board at height z: one box with painted spines, sometimes a lone one leaning."""
    high = min(room - 0.03, w.length(0.20, 0.26))
    wide = max(high + 0.02, (y[1] - y[0]) * w.length(0.55, 0.95))
    wide = min(wide, y[1] - y[0])
    start = y[0] if w.chance(0.5) else y[1] - wide
    w.box(
        (x[0] + 0.02, min(x[1] - 0.02, x[0] + 0.02 + 0.85 * high)),
        (start, start + wide),
        (z, z + high),
        w.new_look("books"),
        solid=False,
    )


def _boards(w: Workbench, x: Range, y: Range, levels: list[float], thick: float, look: Look) -> None:
    for z in levels:
        w.box(x, y, (z, z + thick), look)


def bookcase(w: Workbench) -> None:
    """Tall bookcase, five boards full of books."""
    width, depth, height = w.width(0.70, 1.00), w.depth(0.28, 0.34), w.height(1.80, 2.05)
    look = _body(w)
    x, y = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)
    for side in _BOTH:
        edge = side * (0.5 * width - 0.011)
        w.box(x, (edge - 0.011, edge + 0.011), (0.0, height), look)
    w.box((x[0], x[0] + 0.008), (y[0] + 0.022, y[1] - 0.022), (0.04, height), look)
    count = 5
    step = (height - 0.10) / count
    levels = [0.06 + i * step for i in range(count)]
    _boards(w, (x[0] + 0.008, x[1]), (y[0] + 0.022, y[1] - 0.022), [*levels, height - 0.022], 0.022, look)
    w.box((x[0], x[1] - 0.02), (y[0] + 0.022, y[1] - 0.022), (0.0, 0.06), look)
    for z in levels:
        _books(w, (x[0], x[1]), (y[0] + 0.03, y[1] - 0.03), z + 0.022, step - 0.022)


def cubes(w: Workbench) -> None:
    """Square pigeonholes: boxes in some, books in others."""
    look = _body(w)
    columns, rows = w.whole(2, 4), w.whole(2, 4)
    cell, depth = 0.36, 0.38
    width, height = columns * cell + 0.04, rows * cell + 0.04
    x, y = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)
    for i in range(columns + 1):
        c = y[0] + 0.02 + i * cell
        w.box(x, (c - 0.015, c + 0.015), (0.0, height), look)
    for j in range(rows + 1):
        c = 0.02 + j * cell
        w.box(x, y, (c - 0.015, c + 0.015), look)
    w.box((x[0], x[0] + 0.006), y, (0.0, height), look)
    for i in range(columns):
        for j in range(rows):
            y0, z0 = y[0] + 0.035 + i * cell, 0.035 + j * cell
            if w.chance(0.45):
                w.mesh(
                    chamfered_box((0.33, 0.31, 0.30), 0.02),
                    (0.0, y0 + 0.165, z0 + 0.15),
                    w.new_look("fabric"),
                    solid=False,
                )
            elif w.chance(0.6):
                _books(w, x, (y0, y0 + cell - 0.03), z0, cell - 0.03)
    w.top((x[0] + 0.03, x[1] - 0.03), (y[0] + 0.05, y[1] - 0.05), height)


def ladder_shelf(w: Workbench) -> None:
    """Leaning ladder with four boards that grow towards the floor."""
    width, height, depth = w.width(0.55, 0.75), w.height(1.70, 1.90), w.depth(0.40, 0.48)
    wood = w.look("wood")
    x0, x1, y = -0.5 * depth, 0.5 * depth, (-0.5 * width, 0.5 * width)
    for side in _BOTH:
        edge = side * (0.5 * width - 0.015)
        w.bar((x1 - 0.02, edge, 0.0), (x0 + 0.02, edge, height), 0.03, 0.03, wood)
    for i in range(4):
        z = 0.25 + i * (height - 0.45) / 3
        front = x1 - (x1 - x0) * z / height
        w.box((x0, front), y, (z, z + 0.022), wood)
        w.box((x0, x0 + 0.012), y, (z + 0.022, z + 0.06), wood, solid=False)
        if i < 3:
            _books(w, (x0, max(front, x0 + 0.2)), (y[0] + 0.04, y[1] - 0.04), z + 0.022, 0.4)
    w.bar((x0 + 0.02, 0.0, height - 0.02), (x0 + 0.02, 0.0, height), width, 0.03, wood)


def wall_boards(w: Workbench) -> None:
    """Two or three boards on the wall with books and a vase."""
    width, depth, count = w.width(0.70, 1.20), w.depth(0.20, 0.26), w.whole(2, 3)
    look, metal, y = _body(w), w.look("iron"), (-0.5 * width, 0.5 * width)
    w.mount_height_m = 1.15
    for i in range(count):
        z = 0.14 + 0.36 * i
        w.box((0.0, depth), y, (z, z + 0.025), look)
        for side in _BOTH:
            edge = side * 0.36 * width
            w.bar((0.006, edge, z - 0.12), (depth - 0.05, edge, z), 0.012, 0.012, metal, solid=False)
        _books(w, (0.0, depth), (y[0] + 0.06, y[1] - 0.20), z + 0.025, 0.30)
        w.ellipsoid((0.5 * depth, y[1] - 0.10, z + 0.095), (0.06, 0.06, 0.07), w.new_look("ceramic"), solid=False)


def pipe_shelf(w: Workbench) -> None:
    """Boards in a steel frame with a crossed back."""
    width, depth, height = w.width(0.80, 1.10), w.depth(0.32, 0.38), w.height(1.60, 1.85)
    iron, wood = w.look("iron"), w.look("wood")
    x, y = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)
    w.legs(x, y, (0.0, height), 0.028, iron)
    levels = [0.12 + i * (height - 0.16) / 3 for i in range(4)]
    _boards(w, x, y, levels, 0.035, wood)
    w.bar((x[0] + 0.01, y[0] + 0.02, 0.14), (x[0] + 0.01, y[1] - 0.02, height - 0.02), 0.008, 0.008, iron, solid=False)
    w.bar((x[0] + 0.01, y[1] - 0.02, 0.14), (x[0] + 0.01, y[0] + 0.02, height - 0.02), 0.008, 0.008, iron, solid=False)
    for z in levels[:3]:
        _books(w, x, (y[0] + 0.05, y[1] - 0.05), z + 0.035, 0.4)


def etagere(w: Workbench) -> None:
    """Glass boards between slim brass posts, vases and a few books."""
    width, depth, height = w.width(0.60, 0.85), w.depth(0.32, 0.38), w.height(1.60, 1.85)
    brass, glass = w.look("brass"), w.look("glass")
    x, y = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)
    w.legs((x[0] + 0.01, x[1] - 0.01), (y[0] + 0.01, y[1] - 0.01), (0.0, height), 0.02, brass, round_=True)
    for i in range(4):
        z = 0.10 + i * (height - 0.13) / 3
        w.box(x, y, (z, z + 0.012), glass)
        w.box((x[1] - 0.008, x[1]), y, (z - 0.008, z + 0.014), brass, solid=False)
        if i in (0, 2):
            _books(w, x, (y[0] + 0.06, y[1] - 0.06), z + 0.012, 0.4)
        elif i == 1:
            w.ellipsoid((0.0, 0.1, z + 0.112), (0.08, 0.08, 0.10), w.look("pot"), solid=False)
            w.cylinder((0.0, -0.14), (z + 0.012, z + 0.17), 0.045, w.look("ceramic"), solid=False)


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
    Style("chest_of_drawers", "dresser", "train", dresser, ("dresser",)),
    Style("chest_of_drawers", "tallboy", "train", tallboy, ("dresser",)),
    Style("chest_of_drawers", "handleless", "train", handleless, ("dresser",)),
    Style("chest_of_drawers", "bedside_chest", "train", bedside_chest, ("nightstand",)),
    Style("chest_of_drawers", "campaign", "heldout", campaign, ("dresser",)),
    Style("chest_of_drawers", "apothecary", "heldout", apothecary, ("dresser",)),
    Style("chest_of_drawers", "bedside_drum", "heldout", bedside_drum, ("nightstand",)),
    Style("shelving", "bookcase", "train", bookcase, ("bookcase",)),
    Style("shelving", "cubes", "train", cubes, ("bookcase",)),
    Style("shelving", "ladder_shelf", "train", ladder_shelf, ("bookcase",)),
    Style("shelving", "wall_boards", "train", wall_boards, ("wall",), "wall"),
    Style("shelving", "pipe_shelf", "heldout", pipe_shelf, ("bookcase",)),
    Style("shelving", "etagere", "heldout", etagere, ("bookcase",)),
)
