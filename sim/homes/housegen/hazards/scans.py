"""Invisible clusters as scanned houses have them: the remains of a mesh that collide and are not rendered."""

from __future__ import annotations

import math
from dataclasses import replace

from sim.homes.housegen.furniture.item import Geom
from sim.homes.housegen.hazards.hazard import UNSEEN, Sketch, box

WAY_M = (0.57, 0.68)
"""Width that debris leaves free in a doorway."""


def lump(s: Sketch) -> bool:
    """Adds a cluster of boxes in the middle of the path."""
    boxes = []
    for _ in range(int(s.rng.integers(2, 5))):
        x, y = s.rng.uniform(-0.22, 0.22, 2).tolist()
        a, b = s.rng.uniform(0.04, 0.16, 2).tolist()
        boxes.append(_turned(box((x - a, x + a), (y - b, y + b), (0.0, s.uniform(0.1, 1.1)), UNSEEN), s))
    s.add("misc", [], tuple(boxes))
    return True


def posts(s: Sketch) -> bool:
    """Adds thin posts in staggered rows; each gap between them is wide enough for the robot."""
    pitch = s.uniform(0.60, 0.68)
    rows = int(s.rng.integers(2, 4))
    boxes = []
    for row in range(rows):
        for i in range(3):
            x, y = (row - 0.5 * (rows - 1)) * pitch, (i - 1.0 + (0.25 if row % 2 else -0.25)) * pitch
            boxes.append(box((x - 0.02, x + 0.02), (y - 0.02, y + 0.02), (0.0, s.uniform(0.3, 1.3)), UNSEEN))
    s.add("misc", [], tuple(boxes))
    return True


def doorway(s: Sketch) -> bool:
    """Adds debris at one or both sides of a doorway, so that a narrower passage stays."""
    opening = s.draw_opening("door", "opening", bare=True)
    if opening is None:
        return False
    width = s.move_into(opening)
    spare = width - s.uniform(*WAY_M)
    if spare < 0.1:
        return False
    left = spare * float(s.rng.choice([0.0, 0.5, 1.0]))
    half, deep, boxes = 0.5 * width, s.uniform(0.08, 0.25), []
    for y0, y1 in ((half - left, half - 0.03), (0.03 - half, spare - left - half)):
        if y1 - y0 > 0.03:
            boxes.append(box((-deep, deep), (y0, y1), (0.0, s.uniform(0.2, 1.6)), UNSEEN))
    s.add("misc", [], tuple(boxes))
    return bool(boxes)


def sheets(s: Sketch) -> bool:
    """Adds thin upright fragments on both sides of the path and across it."""
    boxes = []
    for side in (-1, 0, 1):
        length = s.uniform(0.3, 0.8)
        x, y = s.uniform(-0.5, 0.5), side * s.uniform(0.6, 0.75)
        turn = s.uniform(-0.5, 0.5) + (math.pi / 2 if side == 0 else 0.0)
        sheet = box((x - length / 2, x + length / 2), (y - 0.012, y + 0.012), (0.0, s.uniform(0.4, 1.4)), UNSEEN)
        boxes.append(replace(sheet, euler_rad=(0.0, 0.0, turn)))
    s.add("misc", [], tuple(boxes))
    return True


DESIGNS = (lump, posts, posts, doorway, doorway, sheets)


def _turned(geom: Geom, s: Sketch) -> Geom:
    """Returns a box turned about its own vertical axis by a random angle."""
    return replace(geom, euler_rad=(0.0, 0.0, s.uniform(0.0, math.pi)))
