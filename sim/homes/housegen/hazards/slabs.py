"""Slabs below the height at which maps begin: boards and podiums block the robot, thresholds do not."""

from __future__ import annotations

from sim.homes.housegen.hazards.hazard import Sketch, box

HIGH_M = (0.04, 0.08)
"""Heights that block: the robot climbs 12 mm, and the obstacle band of the agent's map begins at 10 cm."""
THRESHOLD_M = (0.005, 0.011)
"""Heights that the robot climbs: a higher threshold would close the only door of many rooms."""


def plinth(s: Sketch) -> bool:
    """Adds one long low plinth across the path."""
    s.align()
    half, shift = 0.5 * s.uniform(0.7, 1.6), s.uniform(-0.25, 0.25)
    depth, high = s.uniform(0.15, 0.4), s.uniform(*HIGH_M)
    s.add("objects", [box((-depth / 2, depth / 2), (shift - half, shift + half), (0.0, high), s.look("wood"))])
    return True


def podium(s: Sketch) -> bool:
    """Adds a low podium with a lip all around, as under a reading chair."""
    s.align()
    x, y = 0.5 * s.uniform(0.6, 1.1), 0.5 * s.uniform(0.8, 1.5)
    high, wood = s.uniform(0.05, 0.08), s.look("wood")
    base = box((-x + 0.03, x - 0.03), (-y + 0.03, y - 0.03), (0.0, high - 0.02), s.look("lacquer"))
    s.add("furniture", [base, box((-x, x), (-y, y), (high - 0.02, high), wood)])
    return True


def planks(s: Sketch) -> bool:
    """Adds two or three boards in the shape of an L or a U, open towards the robot's approach."""
    high, wide = s.uniform(*HIGH_M), s.uniform(0.10, 0.16)
    half = 0.5 * s.uniform(1.0, 1.7)
    wood = s.look("wood")
    s.add("objects", [box((0.0, wide), (-half, half), (0.0, high), wood)])
    for side in (-1, 1):
        if s.rng.random() < 0.75:
            length, y = s.uniform(0.5, 1.1), sorted((side * half, side * (half - wide)))
            s.add("objects", [box((-0.02 - length, -0.02), (y[0], y[1]), (0.0, high), wood)])
    return True


def threshold(s: Sketch) -> bool:
    """Adds a flat threshold in a doorway; the robot climbs it."""
    opening = s.draw_opening("door")
    if opening is None:
        return False
    half, top = 0.5 * s.move_into(opening) - 0.005, s.uniform(*THRESHOLD_M)
    s.add("door", [box((-0.07, 0.07), (-half, half), (0.0, top), s.look("wood"))])
    return True


DESIGNS = (plinth, plinth, plinth, podium, podium, planks, planks, planks, threshold)
