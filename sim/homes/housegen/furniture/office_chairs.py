"""Office chairs on castors.

Sizes follow EN 1335 (seat 0.40-0.51 m high, base 0.60-0.70 m across) and Panero & Zelnik, Human Dimension and
Interior Space.
"""

from __future__ import annotations

import math

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around
from sim.homes.housegen.furniture.shapes import chamfered_box, strip
from sim.homes.housegen.furniture.workbench import Workbench

OFFICE_KG = 12.0


def _star_base(w: Workbench, radius: float, look: Look, seat: float) -> None:
    """Adds five feet on castors under a gas spring."""
    dark = w.look("rubber")
    for i in range(5):
        angle = math.tau * i / 5 + 0.3
        c, s = math.cos(angle), math.sin(angle)
        w.bar((0.0, 0.0, 0.09), (radius * c, radius * s, 0.058), 0.035, 0.022, look)
        w.ball((radius * c, radius * s, 0.028), 0.028, dark)
    w.cylinder((0.0, 0.0), (0.07, 0.5 * seat + 0.05), 0.028, dark)
    w.cylinder((0.0, 0.0), (0.5 * seat, seat), 0.016, w.look("chrome"))


def task_chair(w: Workbench) -> None:
    """Builds an office chair on a five-star base with a padded seat, a thin back on a stalk and optional armrests."""
    w.mass_kg = OFFICE_KG
    seat, half, height = w.length(0.44, 0.50), 0.5 * w.length(0.46, 0.50), w.length(0.86, 1.02)
    cloth, dark = w.look("fabric"), w.look("dark")
    _star_base(w, w.length(0.28, 0.32), dark, seat - 0.06)
    w.mesh(chamfered_box((0.46, 2 * half, 0.07), 0.025), (0.02, 0.0, seat - 0.035), cloth)
    w.box((-0.10, 0.10), (-0.10, 0.10), (seat - 0.095, seat - 0.06), dark)
    w.bar((-0.08, 0.0, seat - 0.08), (-0.26, 0.0, seat - 0.06), 0.06, 0.02, dark)
    w.bar((-0.255, 0.0, seat - 0.07), (-0.29, 0.0, seat + 0.25), 0.06, 0.02, dark)
    back = height - seat - 0.12
    w.mesh(chamfered_box((0.045, 2 * half - 0.04, back), 0.02), (-0.255, 0.0, height - 0.5 * back), cloth, tilt=-0.1)
    if w.chance(0.6):
        for side in BOTH_SIDES:
            y = side * (half + 0.025)
            w.box((-0.02, 0.02), around(y, 0.012), (seat - 0.08, seat + 0.19), dark)
            w.bar((0.0, y, seat - 0.075), (0.0, side * 0.09, seat - 0.075), 0.03, 0.014, dark)
            w.box((-0.12, 0.12), around(y, 0.035), (seat + 0.19, seat + 0.215), dark)


def conference_chair(w: Workbench) -> None:
    """Builds a chair with a ribbed sling between polished side frames on a four-foot swivel base with castors."""
    w.mass_kg = OFFICE_KG
    seat, half, height = w.length(0.43, 0.48), 0.5 * w.length(0.46, 0.50), w.length(0.80, 0.88)
    chrome, cover = w.look("chrome"), w.look("leather")
    _star_base(w, 0.29, chrome, seat - 0.03)
    path = [
        (0.24, seat - 0.03),
        (0.18, seat),
        (-0.14, seat - 0.025),
        (-0.21, seat + 0.03),
        (-0.25, seat + 0.15),
        (-0.33, height),
    ]
    w.mesh(strip(path[::-1], 0.018, 2 * half - 0.03), (0.0, 0.0, 0.0), cover)
    for side in BOTH_SIDES:
        y = side * (half - 0.012)
        w.bent_rod([(x, y, z - 0.008) for x, z in path[1:]], 0.012, chrome)
        w.cylinder((0.10, side * half), (seat - 0.01, seat + 0.2), 0.01, chrome)
        w.bar((0.14, side * half, seat + 0.2), (-0.26, side * half, seat + 0.2), 0.04, 0.02, cover)
    w.box((-0.06, 0.06), (-half + 0.01, half - 0.01), (seat - 0.045, seat - 0.02), chrome)


def executive(w: Workbench) -> None:
    """Builds a chair with a high padded leather back, a headrest and closed arms on a five-star base."""
    w.mass_kg = OFFICE_KG + 6
    seat, half, height = w.length(0.46, 0.51), 0.5 * w.length(0.50, 0.56), w.length(1.08, 1.20)
    leather, dark = w.look("leather"), w.look("dark")
    _star_base(w, 0.33, w.look("chrome"), seat - 0.08)
    w.mesh(chamfered_box((0.50, 2 * half - 0.06, 0.12), 0.04), (0.02, 0.0, seat - 0.06), leather)
    w.box((-0.14, 0.14), (-0.14, 0.14), (seat - 0.14, seat - 0.10), dark)
    for i, (low, high) in enumerate(((-0.07, 0.24), (0.24, 0.45), (0.45, height - seat))):
        size = (0.11 - 0.01 * i, 2 * half - 0.04 - 0.04 * i, high - low + 0.01)
        w.mesh(
            chamfered_box(size, 0.035),
            (-0.235 - 0.22 * (0.5 * (low + high)), 0.0, seat + 0.5 * (low + high)),
            leather,
            tilt=-0.16,
        )
    for y in (-half, half):
        w.mesh(chamfered_box((0.32, 0.07, 0.05), 0.02), (0.0, y, seat + 0.21), leather)
        w.bar((0.12, y, seat + 0.20), (0.06, y * 0.9, seat - 0.06), 0.03, 0.04, dark)
        w.bar((-0.13, y, seat + 0.20), (-0.14, y * 0.9, seat - 0.06), 0.03, 0.04, dark)


STYLES = (
    Style("chair", "task_chair", "train", task_chair, ("office",)),
    Style("chair", "conference", "train", conference_chair, ("office",)),
    Style("chair", "executive", "heldout", executive, ("office",)),
)
