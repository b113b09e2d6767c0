"""Display cabinets and media furniture of the pool `wide`."""

from __future__ import annotations

import itertools
import math

import numpy as np

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.parts import BOTH_SIDES, FeetKind, FrontKind, HandleKind
from sim.housegen.furniture.shapes import named_mesh
from sim.housegen.furniture.workbench import Workbench


def vitrine(w: Workbench) -> None:
    """Builds a glass showcase with shelves between thin posts."""
    width, depth, height = w.width(0.45, 1.10), w.depth(0.34, 0.45), w.height(1.30, 1.95)
    frame = w.look(w.choice(("wood", "brass", "iron", "lacquer", "metal")))
    post = w.length(0.014, 0.045)
    foot = w.length(0.06, 0.30)
    base = foot + (w.length(0.18, 0.5) if w.chance(0.5) else 0.04)
    x, y = parts.footprint(depth, width)
    w.box(x, y, (foot, base), frame)
    if base - foot > 0.1:
        parts.styled_drawers(
            w, x[1], (y[0] + 0.01, y[1] - 0.01), (foot + 0.01, base - 0.01), frame, w.look("metal"), "flat", "knob", 2
        )
    for px in (x[0], x[1] - post):
        for py in (y[0], y[1] - post):
            w.box((px, px + post), (py, py + post), (base, height), frame)
    w.box(x, y, (height - 0.03, height), frame)
    glass = w.look("glass")
    w.box((x[1] - 0.006, x[1] - 0.001), (y[0] + post, y[1] - post), (base, height - 0.03), glass)
    for edge in (y[0] + 0.002, y[1] - 0.006):
        w.box((x[0] + post, x[1] - post), (edge, edge + 0.004), (base, height - 0.03), glass)
    back = w.look("mirror") if w.chance(0.2) else frame
    w.box((x[0], x[0] + 0.006), (y[0] + post, y[1] - post), (base, height - 0.03), back if w.chance(0.6) else glass)
    if width > 0.7:
        w.box((x[1] - 0.014, x[1] + 0.002), (-0.5 * post, 0.5 * post), (base, height - 0.03), frame, solid=False)
    parts.handle(w, w.choice(("knob", "bar")), (x[1], 0.05, 0.5 * (base + height)), 0.14, w.look("brass"), upright=True)
    shelves = w.whole(2, 4)
    step = (height - 0.03 - base) / (shelves + 1)
    for i in range(shelves + 1):
        z = base + i * step
        if i:
            w.box(
                (x[0] + 0.004, x[1] - 0.008),
                (y[0] + 0.004, y[1] - 0.004),
                (z - 0.008, z),
                glass if w.chance(0.7) else frame,
            )
        parts.shelf_objects(w, (x[0] + 0.06, x[1] - 0.06), (y[0] + 0.06, y[1] - 0.06), z, 2 if width < 0.8 else 3, step)
    kind: FeetKind = w.choice(("block", "plinth")) if foot < 0.1 else w.choice(("taper", "splay", "cabriole"))
    parts.feet(w, x, y, foot + 0.001, kind, frame, 0.04)


def display_arch(w: Workbench) -> None:
    """Builds a tall cabinet with an arched head and shelves above doors."""
    width, depth = w.width(0.70, 1.10), w.depth(0.32, 0.44)
    spring, arch = w.length(1.35, 1.65), w.length(0.16, 0.5) * width
    look, metal = parts.wood_look(w), w.look(w.choice(("brass", "dark")))
    foot, base = w.length(0.03, 0.12), w.length(0.35, 0.85)
    x, y = parts.footprint(depth, width)
    n = 12
    curve = [(0.5 * width * math.cos(math.pi * i / n), arch * math.sin(math.pi * i / n)) for i in range(n + 1)]
    w.box((x[0], x[0] + 0.016), y, (base, spring), look)
    panel = np.array([(px, py, z) for px in (0.0, 0.016) for py, z in curve])
    w.mesh(named_mesh("arch", panel), (x[0], 0.0, spring), look)
    for low, high in itertools.pairwise(curve):
        w.bar(
            (0.0, low[0] * 0.985, spring + low[1] - 0.008),
            (0.0, high[0] * 0.985, spring + high[1] - 0.008),
            depth,
            0.022,
            look,
        )
    for edge in (y[0], y[1] - 0.022):
        w.box(x, (edge, edge + 0.022), (base, spring), look)
    w.box(x, y, (foot, base), look)
    parts.styled_doors(
        w,
        x[1],
        (y[0] + 0.012, y[1] - 0.012),
        (foot + 0.01, base - 0.015),
        2,
        look,
        metal,
        w.choice(("flat", "frame", "cane")),
        w.choice(("knob", "bar", "tab")),
    )
    shelves = w.whole(2, 3)
    step = (spring + 0.05 - base) / shelves
    for i in range(shelves + 1):
        z = base + i * step
        if i:
            w.box((x[0] + 0.01, x[1] - 0.03), (y[0] + 0.02, y[1] - 0.02), (z - 0.018, z), look)
        if i < shelves:
            parts.shelf_objects(w, x, (y[0] + 0.05, y[1] - 0.05), z, 2, step)
    if w.chance(0.5):
        glass = w.look("glass")
        w.box((x[1] - 0.012, x[1] - 0.006), (y[0] + 0.02, y[1] - 0.02), (base, spring), glass)
        pane = np.array([(px, 0.96 * py, 0.96 * z) for px in (0.0, 0.006) for py, z in curve])
        w.mesh(named_mesh("arch", pane), (x[1] - 0.012, 0.0, spring), glass)
        w.box((x[1] - 0.016, x[1]), (-0.014, 0.014), (base, spring + arch - 0.01), look, solid=False)
    parts.feet(w, x, y, foot + 0.001, w.choice(("block", "plinth")), look)


def hoosier(w: Workbench) -> None:
    """Builds a kitchen hutch: doors and drawers, an open worktop, and a shallow cupboard or rack above it."""
    width, depth, height = w.width(0.85, 1.35), w.depth(0.42, 0.55), w.height(1.65, 2.0)
    look, metal = parts.wood_look(w), w.look(w.choice(("iron", "brass", "metal")))
    top, worktop = w.look(w.choice(("wood", "steel", "stone"))), w.length(0.80, 0.90)
    foot, gap = w.length(0.06, 0.16), w.length(0.25, 0.42)
    x, y = parts.footprint(depth, width)
    upper = x[0] + w.length(0.26, 0.34)
    w.box(x, y, (foot, worktop - 0.03), look)
    w.box((x[0], x[1] + 0.03), (y[0] - 0.02, y[1] + 0.02), (worktop - 0.03, worktop), top)
    front: FrontKind = w.choice(("frame", "raised", "flat"))
    share = w.choice((0.4, 0.55)) * width
    side = w.choice(BOTH_SIDES)
    left, right = (y[0] + 0.01, y[0] + share), (y[0] + share, y[1] - 0.01)
    if side > 0:
        left, right = (-right[1], -right[0]), (-left[1], -left[0])
    wide, narrow = (left, right) if left[1] - left[0] > right[1] - right[0] else (right, left)
    parts.styled_doors(
        w, x[1], wide, (foot + 0.01, worktop - 0.05), 1 if wide[1] - wide[0] < 0.6 else 2, look, metal, front, "knob"
    )
    parts.styled_drawers(
        w, x[1], narrow, parts.graded_rows(foot + 0.01, worktop - 0.05, w.whole(2, 4), 1.15), look, metal, "flat", "cup"
    )
    w.box((x[0], x[0] + 0.018), y, (worktop, height), look)
    for edge in (y[0], y[1] - 0.025):
        w.box((x[0], upper - 0.06), (edge, edge + 0.025), (worktop, worktop + gap), look)
    z = (worktop + gap, height)
    if w.chance(0.7):
        w.box((x[0], upper), y, z, look)
        parts.styled_doors(
            w,
            upper,
            (y[0] + 0.01, y[1] - 0.01),
            (z[0] + 0.01, z[1] - 0.02),
            w.whole(2, 4),
            look,
            metal,
            w.choice(("flat", "frame")),
            "knob",
        )
        w.top((x[0] + 0.03, upper - 0.03), (y[0] + 0.05, y[1] - 0.05), height)
    else:
        parts.open_case(w, (x[0], upper), y, z, 0.022, look, back=False)
        middle = 0.5 * (z[0] + z[1])
        w.box((x[0], upper - 0.02), (y[0] + 0.02, y[1] - 0.02), (middle - 0.009, middle + 0.009), look)
        for low in (z[0] + 0.022, middle + 0.009):
            parts.shelf_objects(w, (x[0] + 0.02, upper), (y[0] + 0.05, y[1] - 0.05), low, 3, 0.5 * (z[1] - z[0]) - 0.03)
    w.top((upper + 0.03, x[1] - 0.03), (y[0] + 0.05, y[1] - 0.05), worktop)
    parts.feet(w, x, y, foot + 0.001, w.choice(("block", "taper", "plinth", "bun")), look)


def media_frame(w: Workbench) -> None:
    """Builds a television stand of two or three boards or panes between posts, panels or tubes."""
    width, depth, height = w.width(0.90, 1.60), w.depth(0.38, 0.48), w.length(0.42, 0.60)
    board = w.look(w.choice(("wood", "glass", "dark", "lacquer")))
    frame = w.look(w.choice(("metal", "iron", "chrome", "wood")))
    shelves, thick = w.whole(2, 3), w.length(0.012, 0.035)
    x, y = parts.footprint(depth, width)
    foot = w.length(0.05, 0.12)
    rack = w.choice(("tubes", "posts", "panels", "hoops"))
    inset = w.choice((0.03, 0.12)) if rack != "hoops" else 0.0
    step = (height - thick - foot) / (shelves - 1)
    for i in range(shelves):
        z = foot + i * step
        back = 0.0 if i in (0, shelves - 1) or w.chance(0.5) else inset
        w.box(x, (y[0] + back, y[1] - back), (z, z + thick), board)
        if i < shelves - 1 and w.chance(0.8):
            at, wide = w.length(-0.3, 0.05) * width, w.length(0.25, 0.42)
            box = w.look(w.choice(("dark", "metal")))
            w.box((x[0] + 0.06, x[1] - 0.06), (at, at + wide), (z + thick, z + thick + 0.06), box, solid=False)
    for s in BOTH_SIDES:
        at = s * (0.5 * width - inset)
        for px in (x[0] + 0.03, x[1] - 0.03):
            if rack == "tubes":
                w.cylinder((px, at), (0.0, height), 0.02, frame)
            elif rack == "panels":
                w.box((px - 0.02, px + 0.02), (at - 0.012, at + 0.012), (0.0, foot), frame)
            else:
                w.box((px - 0.015, px + 0.015), (at - 0.015, at + 0.015), (0.0, height), frame)
        if rack == "panels":
            w.box((x[0] + 0.02, x[1] - 0.02), (at - 0.012, at + 0.012), (foot, height - 0.001), frame)
        if rack == "hoops":
            for z in (0.01, height - 0.01):
                w.box((x[0] + 0.03, x[1] - 0.03), (at - 0.015, at + 0.015), (z - 0.01, z + 0.01), frame)
    parts.top_surface(w, x, y, height)


def media_corner(w: Workbench) -> None:
    """Builds a television cabinet with cut-off back corners and an open slot above its doors."""
    width, depth, height = w.width(0.85, 1.25), w.depth(0.42, 0.55), w.length(0.45, 0.65)
    look, foot = parts.wood_look(w), w.length(0.03, 0.07)
    back, cut = w.length(0.4, 0.6) * width, w.length(0.4, 0.65) * depth
    x, y = parts.footprint(depth, width)
    outline = [
        (x[1], y[0]),
        (x[1], y[1]),
        (x[1] - depth + cut, y[1]),
        (x[0], 0.5 * back),
        (x[0], -0.5 * back),
        (x[1] - depth + cut, y[0]),
    ]
    inner = [(0.94 * px - 0.02, 0.96 * py) for px, py in outline]
    slot = height - w.length(0.14, 0.2)
    w.mesh(parts.prism(inner, slot - foot), (0.0, 0.0, foot), look)
    w.mesh(parts.prism([(0.9 * px, 0.9 * py) for px, py in outline], foot), (-0.01, 0.0, 0.0), w.look("dark"))
    w.mesh(parts.prism(outline, 0.03), (0.0, 0.0, height - 0.03), look)
    w.mesh(parts.prism(outline, 0.02), (0.0, 0.0, slot), look)
    w.box((x[0] + 0.01, x[0] + 0.03), (-0.5 * back, 0.5 * back), (slot, height - 0.02), look)
    for s in BOTH_SIDES:
        w.box(
            (x[1] - 0.24, x[1] - 0.03),
            (s * (0.5 * width - 0.03) - 0.012, s * (0.5 * width - 0.03) + 0.012),
            (slot, height - 0.02),
            look,
        )
    w.box((x[0] + 0.1, x[1] - 0.06), (-0.2, 0.2), (slot + 0.02, slot + 0.075), w.look("dark"), solid=False)
    face = 0.94 * x[1] - 0.02
    span = (0.96 * y[0] + 0.01, 0.96 * y[1] - 0.01)
    front: FrontKind = w.choice(("frame", "flat", "raised"))
    parts.styled_doors(w, face, span, (foot + 0.01, slot - 0.01), 2, look, w.look("brass"), front, "knob")
    if w.chance(0.5):
        for s in BOTH_SIDES:
            low, high = sorted((s * 0.06, s * (span[1] - 0.05)))
            w.box((face, face + 0.036), (low, high), (foot + 0.05, slot - 0.05), w.look("screen"), solid=False)
    w.top((x[0] + 0.05, x[1] - 0.03), (-0.5 * back, 0.5 * back), height)


def media_offset(w: Workbench) -> None:
    """Builds a long low worktop beside a higher open block."""
    width, depth, high = w.width(1.30, 2.00), w.depth(0.36, 0.45), w.length(0.30, 0.40)
    body, face, side = parts.wood_look(w), w.look(w.choice(("wood", "lacquer"))), w.choice(BOTH_SIDES)
    x, y = parts.footprint(depth, width)
    block, tall = w.length(0.35, 0.5), high + w.length(0.12, 0.4)
    edge = side * 0.5 * width
    span = (edge - block, edge) if side > 0 else (edge, edge + block)
    rest = (y[0], span[0]) if side > 0 else (span[1], y[1])
    metal = w.look(w.choice(("dark", "brass")))
    parts.open_case(w, (x[0], x[1] - 0.01), span, (0.0, tall), 0.03, face)
    parts.shelf_objects(w, x, (span[0] + 0.04, span[1] - 0.04), 0.03, 2, tall - 0.08)
    if tall > 0.55:
        middle = 0.5 * tall
        w.box((x[0], x[1] - 0.02), (span[0] + 0.02, span[1] - 0.02), (middle - 0.01, middle + 0.01), face)
    low = w.length(0.05, 0.12)
    w.box((x[0], x[1] - 0.02), rest, (low, high), body)
    columns = w.whole(2, 3)
    grip: HandleKind = w.choice(("slot", "none", "knob", "tab"))
    parts.styled_drawers(
        w,
        x[1] - 0.02,
        rest,
        (low + 0.005, high - 0.02),
        face if w.chance(0.5) else body,
        metal,
        w.choice(("flat", "cane", "frame")),
        grip,
        columns,
    )
    far = -edge + side * 0.05
    ends = sorted((far, far + side * 0.04))
    w.box((x[0] + 0.03, x[1] - 0.05), (ends[0], ends[1]), (0.0, low), metal)
    w.top((x[0] + 0.03, x[1] - 0.03), (rest[0] + 0.04, rest[1] - 0.04), high)
    w.top((x[0] + 0.04, x[1] - 0.04), (span[0] + 0.04, span[1] - 0.04), tall)


STYLES: tuple[Style, ...] = (
    Style("cabinet", "vitrine", "wide", vitrine, ("display",)),
    Style("cabinet", "display_arch", "wide", display_arch, ("display",)),
    Style("cabinet", "hoosier", "wide", hoosier, ("sideboard", "display")),
    Style("cabinet", "media_frame", "wide", media_frame, ("media",)),
    Style("cabinet", "media_corner", "wide", media_corner, ("media",)),
    Style("cabinet", "media_offset", "wide", media_offset, ("media",)),
)
