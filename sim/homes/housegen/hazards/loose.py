"""Light objects on the path that slide when the robot bumps into them: toys, boxes, bins, baskets and foot stools."""

from __future__ import annotations

import math

from sim.homes.housegen.furniture.item import Geom
from sim.homes.housegen.hazards.hazard import Sketch, box

CARD, PLASTIC, FELT = 0.35, 0.3, 0.25
"""Sliding friction of cardboard, plastic and felt glides."""


def toys(s: Sketch) -> bool:
    """Adds two to four toys that are lower than the obstacle band of the agent's map."""
    for i in range(int(s.rng.integers(2, 5))):
        at = (s.uniform(-0.35, 0.35), (i - 1) * 0.3 + s.uniform(-0.06, 0.06))
        turn, paint = s.uniform(0.0, math.tau), s.look("paint")
        if s.rng.random() < 0.5:
            body = box((-0.09, 0.09), (-0.045, 0.045), (0.0, 0.06), paint)
            cab = box((-0.05, 0.03), (-0.04, 0.04), (0.06, 0.09), s.look("plastic"))
            s.add_movable("objects", [body, cab], 0.35, PLASTIC, at=at, yaw_rad=turn)
        else:
            edge = s.uniform(0.025, 0.04)
            s.add_movable(
                "objects",
                [box((-edge, edge), (-edge, edge), (0.0, 2 * edge), paint)],
                0.2,
                PLASTIC,
                at=at,
                yaw_rad=turn,
            )
    return True


def carton(s: Sketch) -> bool:
    """Adds an empty cardboard box."""
    x, y = (0.5 * v for v in s.rng.uniform(0.25, 0.42, 2).tolist())
    high, card = s.uniform(0.15, 0.32), s.look("cardboard")
    s.add_movable("objects", [box((-x, x), (-y, y), (0.0, high), card)], 0.8, CARD, yaw_rad=s.uniform(0.0, math.tau))
    return True


def bin_(s: Sketch) -> bool:
    """Adds a waste bin or a basket."""
    radius, high = s.uniform(0.12, 0.17), s.uniform(0.26, 0.36)
    look = s.look("metal" if s.rng.random() < 0.5 else "plastic")
    rim = Geom("cylinder", (radius + 0.006, 0.012), (0.0, 0.0, high - 0.012), s.look("dark"), solid=False)
    s.add_movable("objects", [Geom("cylinder", (radius, high / 2), (0.0, 0.0, high / 2), look), rim], 1.2, PLASTIC)
    return True


def stool(s: Sketch) -> bool:
    """Adds a light foot stool on four legs."""
    half, high, wood = s.uniform(0.15, 0.18), s.uniform(0.34, 0.44), s.look("wood")
    seat = box((-half, half), (-half, half), (high - 0.04, high), s.look("fabric"))
    legs = [
        box((x - 0.015, x + 0.015), (y - 0.015, y + 0.015), (0.0, high - 0.04), wood)
        for x in (0.02 - half, half - 0.02) for y in (0.02 - half, half - 0.02)
    ]  # fmt: skip
    s.add_movable("stool", [seat, *legs], 2.5, FELT, yaw_rad=s.uniform(0.0, math.tau))
    return True


DESIGNS = (toys, toys, carton, bin_, stool)
