"""Supports that every free-form generator of the pool `wide` draws from: legs, runners, panels, pedestals, plinths."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Literal

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts import BOTH_SIDES
from sim.homes.housegen.furniture.shapes import Ring, frustum, loft
from sim.homes.housegen.furniture.workbench import Range, Workbench

BaseKind = Literal[
    "square", "round", "taper", "splay", "turned", "hairpin", "sled", "panel", "frame", "pedestal", "trestle", "cross",
    "plinth",
]  # fmt: skip
LEGS: tuple[BaseKind, ...] = ("square", "round", "taper", "splay", "turned", "hairpin")
"""Kinds with one leg at each corner."""
LIGHT: tuple[BaseKind, ...] = (*LEGS, *LEGS, "sled", "panel", "frame", "trestle", "cross")
"""Kinds for tables, benches and chairs."""
LOW: tuple[BaseKind, ...] = ("square", "round", "taper", "splay", "turned", "sled", "plinth")
"""Kinds for sofas and cases."""


def frame_look(w: Workbench, metal: float = 0.4) -> Look:
    """Returns the look of a frame: metal or paint with the probability `metal`, otherwise wood or lacquer."""
    return parts.tube_look(w) if w.chance(metal) else parts.wood_look(w, 0.35)


def add_base(w: Workbench, x: Range, y: Range, high: float, kinds: Sequence[BaseKind], look: Look) -> BaseKind:
    """Adds a support of a drawn kind from the floor up to z = `high` below the footprint x, y, and returns its kind."""
    kind = w.choice(kinds)
    thick = min(w.length(0.02, 0.06), 0.22 * (y[1] - y[0]))
    top = high + 0.004
    if kind in LEGS:
        _legs(w, x, y, top, kind, thick, look)
    elif kind in ("sled", "frame", "panel", "trestle", "cross"):
        _ends(w, x, y, top, kind, thick, look)
    elif kind == "pedestal":
        pedestal(w, (0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1])), min(x[1] - x[0], y[1] - y[0]), top, look)
    else:
        gap = w.length(0.0, 0.06)
        w.box((x[0] + 0.3 * gap, x[1] - gap), (y[0] + gap, y[1] - gap), (0.0, top), look)
    return kind


def _legs(w: Workbench, x: Range, y: Range, top: float, kind: BaseKind, thick: float, look: Look) -> None:
    """Adds four legs with their tops in the corners of x, y, and often stretchers between them."""
    inset, lean = w.length(0.0, 0.05) + thick, w.length(0.02, 0.22) * top if kind == "splay" else 0.0
    xs, ys = (x[0] + inset, x[1] - inset), (y[0] + inset, y[1] - inset)
    foot = w.length(0.35, 0.8) * thick
    profile = [w.length(0.35, 0.75) * thick for _ in range(5)]
    for (px, sx), (py, sy) in itertools.product(zip(xs, BOTH_SIDES, strict=True), zip(ys, BOTH_SIDES, strict=True)):
        if kind == "square":
            w.box(parts.centred(px, thick), parts.centred(py, thick), (0.0, top), look)
        elif kind == "round":
            w.cylinder((px, py), (0.0, top), 0.5 * thick, look)
        elif kind == "turned":
            rings = [Ring(top * i / 4, r, r) for i, r in enumerate(profile)]
            w.mesh(loft(rings, 8), (px, py, 0.0), look)
        elif kind == "hairpin":
            for dx, dy in ((0.05, 0.0), (0.0, 0.05)):
                w.rod((px, py, 0.005), (px - sx * dx, py - sy * dy, top), 0.006, look)
        else:
            leg = frustum((foot, foot), (1.2 * thick, 1.2 * thick), top, (-sx * lean, -sy * lean))
            w.mesh(leg, (px + sx * lean, py + sy * lean, 0.0), look)
    if kind in ("square", "round", "turned") and top > 0.3 and w.chance(0.4):
        z = w.length(0.15, 0.5) * top
        for side in ys:
            w.rod((xs[0], side, z), (xs[1], side, z), 0.2 * thick + 0.003, look)
        middle = 0.5 * (xs[0] + xs[1])
        for px in (middle,) if w.chance(0.5) else xs:
            w.rod((px, ys[0], z), (px, ys[1], z), 0.2 * thick + 0.003, look)


def _ends(w: Workbench, x: Range, y: Range, top: float, kind: BaseKind, thick: float, look: Look) -> None:
    """Adds two equal supports near the ends of y, most of them joined by a rail."""
    inset, r = w.length(0.02, 0.14) * (y[1] - y[0]), 0.35 * thick + 0.003
    x0, x1 = x[0] + 0.02 + r, x[1] - 0.02 - r
    foot = w.length(0.3, 1.0)
    for side, end in ((-1, y[0] + inset), (1, y[1] - inset)):
        py = end - side * 0.5 * thick
        if kind == "sled":
            parts.tube_along(w, [(x0, py, top - r), (x0, py, r), (x1, py, r), (x1, py, top - r)], r, look)
        elif kind == "frame":
            parts.tube_frame(w, (x0, x1), py, (0.0, top), min(thick, 0.3 * top), look)
        elif kind == "panel":
            short = 0.5 * (1.0 - max(foot, 0.55)) * (x1 - x0)
            w.box((x0 + short, x1 - short), parts.centred(py, thick), (0.0, top), look)
        elif kind == "trestle":
            middle = 0.5 * (x0 + x1)
            for sign in BOTH_SIDES:
                reach = 0.5 * (x1 - x0)
                w.bar((middle + sign * reach, py, 0.0), (middle + sign * (1 - foot) * reach, py, top), thick, r, look)
            w.box((x0, x1), parts.centred(py, thick), (top - 0.03, top), look)
        else:
            w.bar((x0, py - 0.25 * thick, 0.0), (x1, py - 0.25 * thick, top), 0.5 * thick, thick, look)
            w.bar((x1, py + 0.25 * thick, 0.0), (x0, py + 0.25 * thick, top), 0.5 * thick, thick, look)
    rail = {"cross": 0.5, "trestle": 0.93}.get(kind, 0.85)
    if kind == "panel":
        w.box(parts.centred(0.5 * (x0 + x1), 0.02), (y[0] + inset, y[1] - inset), (rail * top - 0.06, rail * top), look)
    else:
        for px in (0.5 * (x0 + x1),) if kind in ("cross", "trestle") else (x0, x1):
            low = 0.5 if kind == "cross" else 1.0
            z = low * top - r
            w.rod((px, y[0] + inset, z), (px, y[1] - inset, z), r, look)


def pedestal(w: Workbench, at: tuple[float, float], wide: float, top: float, look: Look) -> None:
    """Adds a turned column on a disc, a cone, a block or crossed feet, that is at most `wide` metres wide."""
    reach, waist = 0.5 * wide * w.length(0.62, 0.95), w.length(0.022, 0.06)
    kind, power = w.choice(("disc", "cone", "drum", "feet", "turned")), w.choice((2.0, 2.0, 6.0))
    head = max(waist, 0.4 * reach)
    if kind == "feet":
        count = w.choice((3, 4, 4, 5))
        for i in range(count):
            a = math.tau * i / count + math.pi / 4
            x, y = at[0] + reach * math.cos(a), at[1] + reach * math.sin(a)
            w.rod((at[0], at[1], 0.12 * top + 0.03), (x, y, 0.018), 0.018, look)
        w.cylinder(at, (0.08 * top, top), waist, look)
        w.cylinder(at, (top - 0.02, top), head, look)
        return
    profiles = {
        "disc": ((0.0, reach), (0.02, reach), (0.035, waist), (top - 0.05, waist), (top, head)),
        "cone": ((0.0, reach), (0.02, reach), (w.length(0.3, 0.7) * top, 1.4 * waist), (top, head)),
        "drum": ((0.0, 0.8 * reach), (w.length(0.3, 0.6) * top, w.length(0.35, 0.8) * reach), (top, 0.8 * reach)),
        "turned": (
            (0.0, reach), (0.04, 0.8 * reach), (0.25 * top, w.length(0.8, 2.2) * waist), (0.45 * top, waist),
            (0.7 * top, w.length(0.8, 2.0) * waist), (top, head),
        ),
    }  # fmt: skip
    w.mesh(loft([Ring(z, r, r, power=power) for z, r in profiles[kind]], 12), (*at, 0.0), look)
