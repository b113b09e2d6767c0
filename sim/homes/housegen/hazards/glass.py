"""Panes and doors of clear glass: they collide, depth and colour show only their frames, handles and safety dots."""

from __future__ import annotations

import math

from sim.homes.housegen.furniture.item import Geom
from sim.homes.housegen.hazards.hazard import UNSEEN, Sketch, box

GLASS_M, HIGH_M, PROFILE_M = 0.012, 2.05, 0.03
"""Thickness and height of panes, and the thickness of their frames."""
DOTS_M, DOT_M = 1.42, 0.03
"""Height and size of the safety dots on a pane: above the robot, so that no obstacle map contains them."""
WAY_M = (0.58, 0.76)
"""Width of the passage that stays open next to a pane."""
LEAF_RAD = (math.radians(55.0), math.radians(100.0))


def partition(s: Sketch) -> bool:
    """Adds a pane across the whole room, with a passage at the end that is farther from the path."""
    s.align()
    return _across(s, "window")


def sliding_door(s: Sketch) -> bool:
    """Adds fixed and sliding panes that close a wide opening up to a passage at one end."""
    opening = s.draw_opening("opening", "open")
    if opening is None:
        return False
    low, high = opening.clear_span()
    s.move_into(opening, s.uniform(low + 0.3, high - 0.3))
    return _across(s, "door")


def screen(s: Sketch) -> bool:
    """Adds a free-standing screen across the path, often with wings at its ends towards the robot's approach."""
    s.align()
    half = 0.5 * s.uniform(1.2, 2.2)
    shift = s.uniform(-0.5, 0.5) * half
    wings = [s.uniform(0.5, 1.1) if s.rng.random() < 0.7 else 0.0 for _ in range(2)]
    _pane(s, "window", (0.0, shift - half), (0.0, shift + half))
    for side, wing in zip((-1, 1), wings, strict=True):
        if wing:
            y = shift + side * (half - 0.5 * PROFILE_M)
            _pane(s, "window", (-0.05, y), (-wing, y))
    return True


def door_leaf(s: Sketch) -> bool:
    """Adds a glass leaf to a doorway that has none: ajar, or closed where another route exists."""
    opening = s.draw_opening("door", bare=True)
    if opening is None:
        return False
    width = s.move_into(opening) - 0.09
    if s.rng.random() < 0.3:
        _leaf(s, width, (0.0, -0.5 * width), math.pi / 2)
    else:
        _leaf(s, width, *s.draw_hinge(width, s.uniform(*LEAF_RAD)))
    return True


DESIGNS = (partition, partition, sliding_door, sliding_door, screen, door_leaf)


def _across(s: Sketch, category: str) -> bool:
    """Adds a pane across the free width at the sketch, often with a wing at its free end."""
    free_m = {side: s.floor.free_length_m(s.x_m, s.y_m, s.yaw_rad + side * math.pi / 2) for side in (1, -1)}
    way_m = s.uniform(*WAY_M)
    near = 1 if free_m[1] <= free_m[-1] else -1
    end_m = free_m[-near] - way_m
    if end_m < 0.25 or free_m[near] + end_m > 4.0:
        return False
    wing_m = s.uniform(0.5, 1.2) if s.rng.random() < 0.5 else 0.0
    _pane(s, category, (0.0, near * (free_m[near] - 0.03)), (0.0, -near * end_m))
    if wing_m:
        y = -near * (end_m - 0.5 * PROFILE_M)
        _pane(s, category, (-0.05, y), (-wing_m, y))
    return True


def _pane(s: Sketch, category: str, begin: tuple[float, float], end: tuple[float, float]) -> None:
    """Adds an upright pane between two points in a frame of posts and rails; the lower rail lies on the floor."""
    length, yaw = math.dist(begin, end), math.atan2(end[1] - begin[1], end[0] - begin[0])
    metal, half = s.looks["frame"], 0.5 * PROFILE_M
    frame: list[Geom] = [
        box(x, (-half, half), (0.0, HIGH_M), metal) for x in ((0.0, PROFILE_M), (length - PROFILE_M, length))
    ]
    frame.append(box((0.0, length), (-half, half), (0.0, 0.012), metal, solid=False))
    frame.append(box((0.0, length), (-half, half), (HIGH_M - 0.04, HIGH_M), metal, solid=False))
    glass = box((PROFILE_M, length - PROFILE_M), (-0.5 * GLASS_M, 0.5 * GLASS_M), (0.0, HIGH_M), UNSEEN)
    s.add(category, [*frame, *_dots(s, length)], (glass,), at=begin, yaw_rad=yaw)


def _leaf(s: Sketch, width: float, hinge: tuple[float, float], yaw_rad: float) -> None:
    """Adds a frameless door leaf with hinges, a handle and safety dots."""
    metal, half = s.looks["frame"], 0.5 * GLASS_M
    seen: list[Geom] = [
        box((0.0, 0.06), (-half - 0.006, half + 0.006), (z, z + 0.09), metal, solid=False) for z in (0.0, 1.9)
    ]
    seen.append(box((width - 0.09, width - 0.065), (-0.05, 0.05), (0.95, 1.25), metal, solid=False))
    glass = box((0.0, width), (-half, half), (0.0, HIGH_M - 0.05), UNSEEN)
    s.add("door", [*seen, *_dots(s, width)], (glass,), at=hinge, yaw_rad=yaw_rad)


def _dots(s: Sketch, length: float) -> list[Geom]:
    """Returns a row of safety dots along a pane."""
    count = max(2, int(length / 0.25))
    half, white = 0.5 * GLASS_M + 0.001, s.looks["dots"]
    at = [length * (i + 0.5) / count for i in range(count)]
    return [
        box((x - DOT_M / 2, x + DOT_M / 2), (-half, half), (DOTS_M, DOTS_M + DOT_M), white, solid=False) for x in at
    ]
