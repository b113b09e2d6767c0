"""Beds of the pool `wide`."""

from __future__ import annotations

import itertools
import math

import numpy as np

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.item import MeshShape
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import chamfered_box, frustum, named_mesh, pillow
from sim.housegen.furniture.workbench import Workbench


def mattress_size(w: Workbench, widest: float = 1.80) -> tuple[float, float]:
    """Returns (length, width) of a mattress; hint `width_m` selects the largest width that is not above it."""
    hinted = w.hints.get("width_m")
    widths = [v for v in (0.80, 0.90, 1.00, 1.20, 1.40, 1.60, 1.80) if v <= widest + 1e-6]
    if hinted is not None:
        width = max((v for v in widths if v <= float(hinted) + 1e-6), default=0.80)
    else:
        width = w.choice(widths[1:])
    return w.choice((1.90, 1.95, 2.00, 2.05, 2.10)), width


def _unmade_quilt(w: Workbench, length: float, width: float, thick: float, hang: float) -> MeshShape:
    """Returns the mesh of an unmade quilt, from a skewed head edge to x = `length`, hanging down at its sides."""
    n, m = 7, 7
    xs, ys = np.linspace(0.0, 1.0, n), np.linspace(-0.5, 0.5, m)
    skew, bumps = w.rng.uniform(-0.35, 0.35), w.rng.uniform(0.4, 1.6, (n, m))
    start = 0.5 * abs(skew) * width + skew * ys * width + w.rng.uniform(0.0, 0.08, m)
    top, bottom = [], []
    for i in range(n):
        for j in range(m):
            edge = j in (0, m - 1)
            x, y = start[j] + (length - start[j]) * xs[i], ys[j] * width * (1.02 if edge else 1.0)
            z = 0.35 * thick if edge or i in (0, n - 1) else thick * bumps[i, j]
            top.append((x, y, z))
            bottom.append((x, y, -hang * (w.rng.uniform(0.6, 1.0) if edge or i == n - 1 else 0.1)))
    faces: list[tuple[int, int, int]] = []
    k = n * m
    for i in range(n - 1):
        for j in range(m - 1):
            a, b, c, d = i * m + j, (i + 1) * m + j, (i + 1) * m + j + 1, i * m + j + 1
            faces += [(a, b, c), (a, c, d), (k + a, k + c, k + b), (k + a, k + d, k + c)]
    rim = [*range(m - 1), *(i * m + m - 1 for i in range(n - 1))]
    rim += [*((n - 1) * m + j for j in range(m - 1, 0, -1)), *(i * m for i in range(n - 1, 0, -1))]
    for a, b in zip(rim, [*rim[1:], rim[0]], strict=True):
        faces += [(a, b, k + b), (a, k + b, k + a)]
    return named_mesh("quilt", top + bottom, faces)


def _pillows(w: Workbench, x: float, width: float, top: float) -> None:
    """Adds one or two layers of pillows, lying or leaning on the headboard, and sometimes a small cushion."""
    places = 2 if width > 1.1 else 1
    each = min(w.length(0.5, 0.8), width / places - 0.04)
    standing = w.chance(0.35)
    for layer in range(w.choice((1, 1, 2))):
        look = w.new_look("linen") if w.chance(0.5) else w.new_look("bedding")
        for i in range(places):
            y = (i - 0.5 * (places - 1)) * width / places + w.rng.uniform(-0.03, 0.03)
            if standing:
                w.mesh(pillow((0.44, each, 0.15), 4.0), (x + 0.17 + 0.12 * layer, y, top + 0.20), look, tilt=1.15)
            else:
                shape = pillow((w.length(0.38, 0.5), each, w.length(0.1, 0.17)), 4.0)
                w.mesh(shape, (x + 0.27 + 0.12 * layer, y, top + 0.045 + 0.08 * layer), look, tilt=-0.1)
    if w.chance(0.25):
        w.mesh(pillow((0.40, 0.42, 0.14), 4.0), (x + 0.55, 0.0, top + 0.15), w.new_look("fabric"), tilt=0.9)


def bedding(w: Workbench, x0: float, length: float, width: float, top: float, thick: float, hang: float) -> None:
    """Adds a mattress from x0 towards the foot with tucked, crumpled, folded or spread bedding, and pillows."""
    linen, duvet, x1 = w.look("linen"), w.look("bedding"), x0 + length
    w.mesh(
        chamfered_box((length, width, thick), min(0.05, 0.3 * thick)), (0.5 * (x0 + x1), 0.0, top - 0.5 * thick), linen
    )
    kind = w.choice(("tucked", "rumpled", "rumpled", "folded", "spread"))
    cover = length
    if kind == "tucked":
        cover = w.length(0.62, 0.85) * length
        size = (cover, width + 0.02, thick - 0.02)
        w.mesh(chamfered_box(size, 0.03), (x1 - 0.5 * cover + 0.01, 0.0, top - 0.5 * size[2] + 0.018), duvet)
        w.box(
            (x1 - cover - 0.01, x1 - cover + w.length(0.15, 0.35)),
            parts.centred(0.0, width + 0.03),
            (top - 0.5 * thick, top + 0.025),
            w.new_look("linen"),
        )
    elif kind == "rumpled":
        cover = w.length(0.5, 0.8) * length
        shape = _unmade_quilt(w, cover, width + 0.06, w.length(0.05, 0.11), min(hang, thick + 0.05))
        w.mesh(shape, (x1 - cover + 0.02, 0.0, top), duvet)
    elif kind == "folded":
        cover = w.length(0.35, 0.6)
        size = (cover, width * w.length(0.6, 0.98), w.length(0.12, 0.2))
        w.mesh(chamfered_box(size, 0.05), (x1 - 0.5 * cover - 0.06, 0.0, top + 0.5 * size[2] - 0.01), duvet)
        w.box((x0 + 0.05, x1 - 0.02), parts.centred(0.0, width + 0.006), (top - 0.06, top + 0.004), w.new_look("linen"))
    else:
        cover = length - w.length(0.0, 0.5)
        flare = hang * 0.15
        spread = frustum((cover + 0.06, width + 0.06 + flare), (cover, width + 0.03), hang + 0.03)
        w.mesh(spread, (x1 - 0.5 * cover + 0.03, 0.0, top - hang), duvet, solid=False)
        if w.chance(0.5):
            strip = w.length(0.4, 0.6)
            z = (top - 0.3 * hang, top + 0.04)
            w.box(
                parts.centred(x1 - 0.35, strip), parts.centred(0.0, width + 0.05), z, w.new_look("fabric"), solid=False
            )
    _pillows(w, x0, width, top + (0.03 if kind == "spread" and cover > length - 0.2 else 0.0))
    w.top((x1 - 0.9, x1 - 0.2), (-0.5 * width + 0.15, 0.5 * width - 0.15), top + 0.05, "seat")


def bunk(w: Workbench) -> None:
    """Builds two beds above each other between four posts, with guard rails and a ladder, of wood or steel tube."""
    length, width = mattress_size(w, 1.20)
    tube = w.chance(0.35)
    look = w.look("iron") if tube else parts.wood_look(w)
    post = 0.04 if tube else w.length(0.06, 0.09)
    high, low, thick = w.length(1.55, 1.75), w.length(0.30, 0.45), w.length(0.12, 0.18)
    half, x = 0.5 * width + 0.5 * post, (-0.5 * post, length + 0.5 * post)
    upper = high - w.length(0.28, 0.36)
    for px in x:
        for side in BOTH_SIDES:
            w.box(parts.centred(px, post), parts.centred(side * half, post), (0.0, high), look)
        for z in (low, upper, high - 0.05) if tube else (low + 0.12, upper, high - 0.08):
            w.box(parts.centred(px, 0.025), (-half, half), (z - 0.06, z + (0.03 if tube else 0.07)), look)
    for z in (low, upper):
        for side in BOTH_SIDES:
            w.box(x, parts.centred(side * half, 0.025), (z - 0.12 if not tube else z - 0.05, z), look)
        w.box(x, (-half, half), (z - thick, z - thick + 0.03), look)
    side = w.choice(BOTH_SIDES)
    gap = w.length(0.4, 0.5)
    w.box(x, parts.centred(-side * half, 0.02), (high - 0.11, high - 0.03), look)
    w.box((x[0], x[1] - gap), parts.centred(side * half, 0.02), (high - 0.11, high - 0.03), look)
    w.box(parts.centred(x[1] - gap, 0.04), parts.centred(side * half, 0.02), (upper - 0.05, high - 0.03), look)
    foot = side * (half + w.choice((0.03, 0.25)))
    for rx in (x[1] - gap + 0.03, x[1] - 0.06):
        w.bar((rx, foot, 0.0), (rx, side * (half + 0.02), upper), 0.04, 0.03, look)
    for i in range(4):
        share = (i + 1) / 5
        y = foot + share * (side * (half + 0.02) - foot)
        w.rod((x[1] - gap + 0.03, y, share * upper), (x[1] - 0.06, y, share * upper), 0.016, look)
    for z in (low, upper):
        w.mesh(
            chamfered_box((length, width, thick), 0.03), (0.5 * length, 0.0, z - 0.5 * thick + 0.03), w.look("linen")
        )
        w.mesh(pillow((0.38, min(0.65, width - 0.1), 0.13), 4.0), (0.24, 0.0, z + 0.07), w.look("linen"))
        cover = w.length(0.55, 0.8) * length
        shape = _unmade_quilt(w, cover, width - 0.02, w.length(0.04, 0.09), 0.03)
        w.mesh(shape, (length - cover - 0.01, 0.0, z + 0.035), w.new_look("bedding"))
    w.top((0.6, length - 0.3), (-0.3 * width, 0.3 * width), low + 0.08, "seat")


def hospital(w: Workbench) -> None:
    """Builds a care bed on castors with a jointed mattress, end boards and often side rails."""
    length, width = 2.0, min(0.90, mattress_size(w, 1.0)[1])
    frame, board = w.look("metal"), w.look("plastic") if w.chance(0.5) else w.look("wood")
    top, thick, raised = w.length(0.48, 0.68), w.length(0.12, 0.16), w.choice((0.0, 0.25, 0.5, 0.8))
    half, base = 0.5 * width + 0.02, top - thick
    w.box((-0.02, length + 0.02), (-half, half), (base - 0.05, base), frame)
    for x in (0.25, length - 0.25):
        w.box(parts.centred(x, 0.08), (-0.6 * half, 0.6 * half), (0.14, base - 0.04), frame)
    w.box((0.1, length - 0.1), (-0.65 * half, 0.65 * half), (0.12, 0.17), frame)
    for x in (0.15, length - 0.15):
        for side in BOTH_SIDES:
            w.rod((x, side * 0.6 * half - 0.015, 0.06), (x, side * 0.6 * half + 0.015, 0.06), 0.06, w.look("rubber"))
    for x, high in ((-0.04, base + w.length(0.38, 0.5)), (length + 0.04, base + w.length(0.25, 0.4))):
        w.mesh(chamfered_box((0.035, 2 * half, high - base + 0.1), 0.017), (x, 0.0, 0.5 * (high + base - 0.1)), board)
    hinge, linen = 0.75, w.look("linen")
    back = (0.5 * thick, 0.5 * hinge)
    at = (
        hinge - back[1] * math.cos(raised),
        0.0,
        base + back[0] + back[1] * math.sin(raised),
    )
    w.mesh(chamfered_box((hinge, width, thick), 0.03), at, linen, tilt=raised)
    w.mesh(
        chamfered_box((length - hinge + 0.04, width, thick), 0.03),
        (0.5 * (length + hinge) - 0.02, 0.0, base + 0.5 * thick),
        linen,
    )
    end = (hinge - (hinge - 0.22) * math.cos(raised), 0.0, top + (hinge - 0.22) * math.sin(raised) + 0.04)
    if raised:
        end = (end[0] + 0.6 * thick * math.sin(raised), 0.0, end[2] - 0.03)
        w.bar(
            (hinge - 0.45, 0.0, base - 0.02),
            (hinge - 0.5 * math.cos(raised), 0.0, base + 0.5 * math.sin(raised)),
            0.3,
            0.03,
            frame,
        )
    w.mesh(pillow((0.40, 0.6, 0.13), 4.0), end, linen, tilt=raised)
    cover = w.length(0.9, 1.15)
    w.mesh(
        _unmade_quilt(w, cover, width + 0.04, w.length(0.03, 0.07), thick),
        (length - cover + 0.01, 0.0, top),
        w.look("bedding"),
    )
    if w.chance(0.75):
        spans = ((0.25, 0.95), (1.1, 1.75)) if w.chance(0.5) else ((0.3, 1.7),)
        for side in BOTH_SIDES:
            y = side * (half + 0.02)
            for a, b in spans:
                for z in (top + 0.10, top + 0.22):
                    w.rod((a, y, z), (b, y, z), 0.014, frame, round_ends=True)
                for x in (a, b):
                    w.rod((x, y, base - 0.04), (x, y, top + 0.22), 0.014, frame, round_ends=True)
    w.top((1.1, length - 0.2), (-0.3, 0.3), top + 0.06, "seat")


def pallet(w: Workbench) -> None:
    """Builds a mattress on one or two layers of pallets."""
    length, width = mattress_size(w)
    wood, dark, thick = w.look("wood"), w.look("dark"), w.length(0.14, 0.26)
    out = w.choice((0.0, 0.05, 0.25))
    half, x = 0.5 * width + (0.06 if out else 0.0), (-0.03, length + out)
    layers = w.whole(1, 2)
    for layer in range(layers):
        z = layer * 0.145
        w.box(x, (-half, half), (z + 0.12, z + 0.143), wood)
        for side in (-1, 0, 1):
            w.box(x, parts.centred(side * (half - 0.05), 0.10), (z, z + 0.022), wood)
            for cx in (x[0] + 0.07, 0.5 * (x[0] + x[1]), x[1] - 0.07):
                w.box(parts.centred(cx, 0.14), parts.centred(side * (half - 0.05), 0.10), (z + 0.022, z + 0.12), wood)
        w.box((x[0] + 0.2, x[1] - 0.2), (-half + 0.2, half - 0.2), (z, z + 0.12), dark)
    base = layers * 0.145 - 0.003
    if w.chance(0.5):
        tall = base + w.length(0.45, 0.75)
        for i in range(4):
            z = base + 0.05 + i * (tall - base) / 4
            w.box((-0.055, -0.03), (-half, half), (z, z + w.length(0.06, 0.1)), wood)
        for side in BOTH_SIDES:
            w.box((-0.09, -0.05), parts.centred(side * 0.7 * half, 0.09), (0.0, tall), wood)
    bedding(w, 0.0, length, width, base + thick, thick, thick)


def box_spring(w: Workbench) -> None:
    """Builds upholstered boxes with a mattress and a topper, and a plain, channelled, winged or no headboard."""
    length, width = mattress_size(w)
    cloth, half, foot = w.look("fabric"), 0.5 * width + 0.01, w.length(0.05, 0.14)
    box, thick = w.length(0.20, 0.34), w.length(0.18, 0.28)
    base = foot + box
    halves = w.whole(1, 2) if width > 1.3 else 1
    for i in range(halves):
        y = (i - 0.5 * (halves - 1)) * 2 * half / halves
        w.mesh(
            chamfered_box((length, 2 * half / halves - 0.006, box), 0.02), (0.5 * length, y, foot + 0.5 * box), cloth
        )
    legs = w.look(w.choice(("wood", "chrome", "dark")))
    w.legs(
        (0.07, length - 0.07), (-half + 0.07, half - 0.07), (0.0, foot + 0.01), w.length(0.03, 0.07), legs, round_=True
    )
    head, kind = w.length(0.85, 1.35), w.choice(("none", "plain", "channels", "winged"))
    over = w.choice((0.0, 0.0, 0.1, 0.2))
    if kind == "channels":
        count = max(4, round(2 * (half + over) / 0.2))
        each = 2 * (half + over) / count
        for i in range(count):
            size = (0.09, each - 0.003, head - 0.02)
            w.mesh(chamfered_box(size, 0.025), (-0.045, (i + 0.5) * each - half - over, 0.5 * head), cloth)
    elif kind != "none":
        size = (0.11, 2 * (half + over * (kind == "plain")), head)
        w.mesh(chamfered_box(size, 0.02), (-0.055, 0.0, 0.5 * head), cloth)
    if kind == "winged":
        for side in BOTH_SIDES:
            w.mesh(frustum((0.34, 0.06), (0.24, 0.06), head, (-0.05, 0.0)), (0.06, side * (half + 0.03), 0.0), cloth)
    w.mesh(chamfered_box((length, width, thick), 0.03), (0.5 * length, 0.0, base + 0.5 * thick), w.new_look("linen"))
    topper = w.length(0.06, 0.10)
    bedding(w, 0.0, length, width, base + thick + topper, topper + 0.01, w.choice((0.15, 0.3, base + thick - 0.02)))


def arched(w: Workbench) -> None:
    """Builds a light bed frame with round legs and an arched headboard, solid, of cane or of rods."""
    length, width = mattress_size(w)
    look = w.look(w.choice(("wood", "wicker", "lacquer")))
    thick, low = w.length(0.16, 0.24), w.length(0.20, 0.34)
    half, base = 0.5 * width + w.choice((0.02, 0.06)), low + 0.03
    w.box((0.0, length + 0.03), (-half, half), (low - 0.02, base), look)
    for side in BOTH_SIDES:
        w.box((0.0, length + 0.03), parts.centred(side * half, 0.03), (low - 0.07, base + w.choice((0.0, 0.05))), look)
    w.legs(
        (0.12, length - 0.08),
        (-half + 0.09, half - 0.09),
        (0.0, low),
        w.length(0.035, 0.06),
        look,
        splay=w.choice((0.0, 0.04)),
        round_=True,
    )
    spring, rise = base + w.length(0.1, 0.35), w.length(0.45, 0.95) * half
    kind = w.choice(("solid", "cane", "fan"))
    angles = [math.pi * i / 12 for i in range(13)]
    edge = [(half * math.cos(a), spring + rise * math.sin(a)) for a in angles]
    for side in BOTH_SIDES:
        w.box(parts.centred(-0.02, 0.04), parts.centred(side * (half - 0.02), 0.04), (0.0, spring + 0.02), look)
    if kind != "fan":
        panel = [(px, y, z) for px in (-0.04, 0.0) for y, z in ((half, base - 0.05), (-half, base - 0.05), *edge)]
        w.mesh(named_mesh("arch", panel), (0.0, 0.0, 0.0), w.look("wicker") if kind == "cane" else look)
    if kind != "solid":
        for (ya, za), (yb, zb) in itertools.pairwise(edge):
            w.rod((-0.02, ya, za), (-0.02, yb, zb), 0.024, look, round_ends=True)
    if kind == "fan":
        w.rod((-0.02, -half, base), (-0.02, half, base), 0.018, look)
        for i in range(9):
            y, z = edge[2 + i]
            w.rod((-0.02, 0.35 * y, base), (-0.02, y, z), 0.009, look)
    bedding(w, 0.0, length, width, base + thick, thick, thick)


STYLES: tuple[Style, ...] = (
    Style("bed", "bunk", "wide", bunk),
    Style("bed", "hospital", "wide", hospital),
    Style("bed", "pallet", "wide", pallet),
    Style("bed", "box_spring", "wide", box_spring),
    Style("bed", "arched", "wide", arched),
)
