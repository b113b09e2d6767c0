"""Wardrobes of the pool `wide`."""

from __future__ import annotations

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.parts import BOTH_SIDES, FeetKind, FrontKind, HandleKind
from sim.housegen.furniture.shapes import chamfered_box, frustum
from sim.housegen.furniture.workbench import Workbench


def wardrobe_combi(w: Workbench) -> None:
    """Builds an asymmetric wardrobe with tall doors on one side and drawers with open shelves on the other."""
    width, depth, height = w.width(1.10, 1.90), w.depth(0.50, 0.62), w.height(1.80, 2.20)
    look, side = parts.wood_look(w), w.choice(BOTH_SIDES)
    face = w.look(w.choice(("wood", "lacquer", "lacquer")))
    metal, foot = w.look(w.choice(("metal", "dark", "brass"))), w.length(0.05, 0.14)
    share = w.length(0.45, 0.66) * width
    x, y = parts.footprint(depth, width)
    split = side * (0.5 * width - share)
    tall = (split, y[1]) if side > 0 else (y[0], split)
    rest = (y[0], split) if side > 0 else (split, y[1])
    low = foot + w.length(0.60, 1.0)
    top = height if w.chance(0.6) else low + w.length(0.3, 0.6)
    w.box(x, tall, (foot, height), look)
    w.box(x, rest, (foot, low), look)
    parts.open_case(w, (x[0], x[1] - 0.04), rest, (low, top), 0.02, look)
    front: FrontKind = w.choice(("flat", "frame", "cane"))
    grip: HandleKind = w.choice(("bar", "knob", "rail", "slot"))
    parts.styled_doors(w, x[1], tall, (foot, height), max(1, round(share / 0.5)), face, metal, front, grip)
    edges = parts.graded_rows(foot, low, w.whole(2, 4), 1.1)
    parts.styled_drawers(w, x[1], rest, edges, face, metal, "flat", "bar" if grip == "rail" else grip)
    shelves = w.whole(1, 2) if top - low > 0.5 else 0
    step = (top - low) / (shelves + 1)
    for i in range(shelves + 1):
        z = low + i * step
        if i:
            w.box((x[0], x[1] - 0.05), (rest[0] + 0.02, rest[1] - 0.02), (z - 0.018, z), look)
        parts.shelf_objects(w, x, (rest[0] + 0.03, rest[1] - 0.03), z + (0.0 if i else 0.02), 2, step - 0.04)
    parts.feet(w, x, y, foot + 0.001, w.choice(("plinth", "block", "taper")), w.look("dark") if foot < 0.09 else look)


def wardrobe_cloth(w: Workbench) -> None:
    """Builds a wardrobe of cloth over a frame of tubes, closed or open before its shelves."""
    width, depth, height = w.width(0.75, 1.40), w.depth(0.44, 0.52), w.height(1.55, 1.80)
    cloth, tube = w.look(w.choice(("fabric", "linen", "curtain"))), w.look(w.choice(("metal", "dark", "bright")))
    pitch = w.length(0.06, 0.16) if w.chance(0.5) else 0.0
    x, y = parts.footprint(depth, width)
    eaves, open_ = height - pitch, w.chance(0.6)
    share = w.choice((0.35, 0.5, 0.65))
    split = y[0] + share * width
    shut = (split, y[1]) if open_ else y
    w.box((x[0], x[0] + 0.006), y, (0.10, eaves), cloth)
    for edge in (y[0], y[1] - 0.006):
        w.box(x, (edge, edge + 0.006), (0.06, eaves), cloth)
    w.box((x[1] - 0.006, x[1]), shut, (0.08, eaves), cloth)
    if pitch:
        w.mesh(frustum((depth + 0.02, width + 0.02), (0.06, width - 0.1), pitch), (0.0, 0.0, eaves), cloth)
    else:
        w.box(x, y, (eaves - 0.02, eaves), cloth)
        w.top((x[0] + 0.06, x[1] - 0.06), (y[0] + 0.08, y[1] - 0.08), eaves)
    w.box((x[1] - 0.008, x[1] + 0.004), y, (eaves - 0.07, eaves - 0.01), parts.darker(cloth, 0.75), solid=False)
    for px in (x[0] + 0.014, x[1] - 0.014):
        for py in (y[0] + 0.014, y[1] - 0.014):
            w.rod((px, py, 0.0), (px, py, eaves), 0.011, tube)
    dark = parts.darker(cloth, 0.6)
    for seam in (0.25, 0.75) if w.chance(0.6) else (0.5,):
        at = shut[0] + seam * (shut[1] - shut[0])
        w.box((x[1], x[1] + 0.003), (at - 0.008, at + 0.008), (0.12, eaves - 0.08), dark, solid=False)
    if open_:
        low, high = y[0] + 0.01, split
        roll = eaves - 0.10
        w.rod((x[1], low + 0.02, roll), (x[1], high - 0.02, roll), 0.04, cloth, solid=False)
        rows = w.whole(2, 4)
        for i in range(rows):
            z = 0.12 + i * (eaves - 0.35) / rows
            w.box((x[0] + 0.006, x[1] - 0.02), (low - 0.004, high), (z, z + 0.012), tube)
            if w.chance(0.7):
                size = (0.3, round(0.7 * (high - low), 3), w.length(0.08, 0.2))
                heap = chamfered_box(size, 0.025)
                w.mesh(heap, (0.0, 0.5 * (low + high), z + 0.012 + 0.5 * size[2]), w.new_look("fabric"), solid=False)
        w.box((x[0] + 0.006, x[1] - 0.02), (split - 0.004, split + 0.004), (0.10, eaves - 0.02), cloth)


def wardrobe_lockers(w: Workbench) -> None:
    """Builds a row of narrow steel lockers with vent slots, one or two doors high."""
    columns, rows = w.whole(2, 4), w.choice((1, 1, 2))
    width, depth = w.width(0.32 * columns, 0.46 * columns), w.depth(0.42, 0.55)
    height, foot = w.height(1.65, 1.95), w.length(0.03, 0.16)
    look = w.look(w.choice(("appliance", "lacquer", "steel")))
    door = w.new_look("lacquer") if w.chance(0.4) else look
    x, y = parts.footprint(depth, width)
    slope = w.length(0.08, 0.16) if w.chance(0.3) else 0.0
    w.box(x, y, (foot, height - slope), look)
    if slope:
        w.mesh(
            frustum((depth, width), (0.04, width), slope, (0.02 - 0.5 * depth, 0.0)), (0.0, 0.0, height - slope), look
        )
    else:
        w.top((x[0] + 0.05, x[1] - 0.05), (y[0] + 0.05, y[1] - 0.05), height)
    dark = parts.darker(door)
    w.box((x[1], x[1] + 0.003), (y[0] + 0.01, y[1] - 0.01), (foot + 0.01, height - slope - 0.01), dark, solid=False)
    each, tall = width / columns, (height - slope - foot) / rows
    for i in range(columns):
        for j in range(rows):
            left, low = y[0] + i * each, foot + j * tall
            face = parts.front_panel(w, x[1], (left, left + each), (low, low + tall), door, "flat")
            middle = left + 0.5 * each
            for k in range(3 if columns * rows < 6 else 1):
                for z in (low + tall - 0.10 - 0.03 * k, low + 0.10 + 0.03 * k)[: 3 - rows]:
                    slot = (middle - 0.25 * each, middle + 0.25 * each)
                    w.box((face - 0.001, face + 0.002), slot, (z, z + 0.01), dark, solid=False)
            hand = (face, left + 0.15 * each, low + 0.52 * tall)
            parts.handle(w, "bar", hand, 0.08, w.look("metal"), upright=True)
    parts.feet(w, x, y, foot + 0.001, "block" if foot > 0.07 else "plinth", w.look("dark"), 0.03)


def wardrobe_ceiling(w: Workbench) -> None:
    """Builds a ceiling-high wardrobe with tall doors and a row of small doors above them."""
    width, depth, height = w.width(1.20, 2.30), w.depth(0.55, 0.65), w.height(2.25, 2.45)
    count = max(2, round(width / w.choice((0.42, 0.55))))
    look = parts.wood_look(w)
    x, y = parts.footprint(depth, width)
    split = height - w.length(0.35, 0.55)
    metal = w.look(w.choice(("metal", "brass", "iron")))
    w.box(x, y, (0.0, height), look)
    front: FrontKind = w.choice(("slats" if count < 4 else "frame", "frame", "flat"))
    grip: HandleKind = w.choice(("knob", "bar"))
    drawers = w.chance(0.4)
    low = 0.08 if not drawers else 0.45
    if drawers:
        parts.styled_drawers(
            w,
            x[1],
            (y[0] + 0.02, y[1] - 0.02),
            (0.08, low),
            look,
            metal,
            "flat",
            grip if grip == "bar" else "cup",
            max(1, count // 2),
        )
    parts.styled_doors(w, x[1], (y[0] + 0.02, y[1] - 0.02), (low, split), count, look, metal, front, grip)
    parts.styled_doors(w, x[1], (y[0] + 0.02, y[1] - 0.02), (split, height - 0.03), count, look, metal, "flat", grip)
    if w.chance(0.5):
        each = (width - 0.04) / count
        for i in range(count):
            if abs(i - 0.5 * (count - 1)) < 1.0:
                left = y[0] + 0.02 + i * each
                w.box(
                    (x[1], x[1] + 0.032),
                    (left + 0.05, left + each - 0.05),
                    (low + 0.06, split - 0.06),
                    w.look("mirror"),
                    solid=False,
                )
    if w.chance(0.5):
        w.box((x[1] - 0.01, x[1] + 0.05), (y[0] - 0.02, y[1] + 0.02), (height - 0.03, height), look)


def wardrobe_cane(w: Workbench) -> None:
    """Builds a slender wardrobe on legs with rounded corners and cane or framed doors."""
    width, depth, height = w.width(0.80, 1.30), w.depth(0.48, 0.60), w.height(1.65, 1.95)
    look, metal = parts.wood_look(w), w.look(w.choice(("brass", "dark")))
    kind: FeetKind = w.choice(("splay", "taper", "sled"))
    foot, radius = w.length(0.14, 0.30), w.length(0.02, 0.06)
    x, y = parts.footprint(depth, width)
    w.mesh(chamfered_box((depth, width, height - foot), radius), (0.0, 0.0, 0.5 * (foot + height)), look)
    split = height - radius
    low = foot + radius
    inner = (y[0] + radius, y[1] - radius)
    if w.chance(0.5):
        parts.styled_drawers(
            w, x[1] - 0.003, inner, (low, low + 0.22), look, metal, "flat", w.choice(("knob", "tab")), w.whole(1, 2)
        )
        low += 0.22
    grip: HandleKind = w.choice(("tab", "knob", "bar"))
    parts.styled_doors(
        w,
        x[1] - 0.003,
        inner,
        (low, split),
        2 if width < 1.1 else 3,
        look,
        metal,
        w.choice(("cane", "cane", "frame")),
        grip,
    )
    parts.feet(
        w,
        (x[0] + 0.03, x[1] - 0.03),
        (y[0] + 0.05, y[1] - 0.05),
        foot + 0.004,
        kind,
        w.look("wood") if kind != "sled" else w.look("iron"),
    )
    parts.top_surface(w, x, y, height)


STYLES: tuple[Style, ...] = (
    Style("cabinet", "wardrobe_combi", "wide", wardrobe_combi, ("wardrobe",)),
    Style("cabinet", "wardrobe_cloth", "wide", wardrobe_cloth, ("wardrobe",)),
    Style("cabinet", "wardrobe_lockers", "wide", wardrobe_lockers, ("wardrobe",)),
    Style("cabinet", "wardrobe_ceiling", "wide", wardrobe_ceiling, ("wardrobe",)),
    Style("cabinet", "wardrobe_cane", "wide", wardrobe_cane, ("wardrobe",)),
)
