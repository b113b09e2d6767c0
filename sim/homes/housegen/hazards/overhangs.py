"""Tables with tops of clear glass: depth shows their two end frames and an apparent passage between them."""

from __future__ import annotations

from sim.homes.housegen.furniture.item import Geom
from sim.homes.housegen.hazards.hazard import UNSEEN, Sketch, box, post


def console(s: Sketch) -> bool:
    """Adds a high narrow table; the lower edge of its top is below the top of the robot."""
    return _table(s, (1.2, 1.7), (0.35, 0.5), s.uniform(0.79, 0.84))


def low_table(s: Sketch) -> bool:
    """Adds a low table."""
    return _table(s, (1.1, 1.5), (0.5, 0.7), s.uniform(0.36, 0.46))


DESIGNS = (console, low_table)


def _table(s: Sketch, lengths: tuple[float, float], depths: tuple[float, float], top: float) -> bool:
    """Adds a table that stands across the path; the lower side of its top is at `top`."""
    s.align()
    y, x = 0.5 * s.uniform(*lengths), 0.5 * s.uniform(*depths)
    shift = s.uniform(-0.3, 0.3) * y
    metal = s.looks["frame"]
    legs: list[Geom] = []
    for side in (-1, 1):
        at = shift + side * (y - 0.015)
        legs += [post(sx * (x - 0.02), at, (0.0, top), 0.012, metal) for sx in (-1, 1)]
        legs.append(box((-x, x), (at - 0.012, at + 0.012), (top - 0.02, top + 0.012), metal))
    glass = box((-x, x), (shift - y + 0.03, shift + y - 0.03), (top, top + 0.012), UNSEEN)
    s.add("table", legs, (glass,))
    return True
