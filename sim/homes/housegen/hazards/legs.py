"""Objects on thin legs or flat feet: depth shows a thin pole, while the feet on the floor are below every map."""

from __future__ import annotations

import math

from sim.homes.housegen.furniture.item import Geom, Look
from sim.homes.housegen.hazards.hazard import Sketch, box, post, rod

POLE_M = 0.012


def stands(s: Sketch) -> bool:
    """Adds a row of coat or music stands across the path; the gaps between their poles are closed by flat feet."""
    count = int(s.rng.integers(2, 4))
    reach = s.uniform(0.30, 0.36)
    gap = 2.0 * reach + s.uniform(0.02, 0.12)
    metal, turn = s.look("metal"), s.uniform(0.0, 0.3)
    for i in range(count):
        y = (i - 0.5 * (count - 1)) * gap
        s.add("furniture", _stand(metal, reach, s.uniform(1.35, 1.7)), at=(0.0, y), yaw_rad=turn)
    return True


def floor_lamp(s: Sketch) -> bool:
    """Adds a floor lamp on a flat round foot in the middle of the path."""
    metal, radius = s.look("metal"), s.uniform(0.24, 0.32)
    foot = Geom("cylinder", (radius, 0.02), (0.0, 0.0, 0.02), metal)
    shade = Geom("cylinder", (0.16, 0.11), (0.0, 0.0, 1.55), s.look("shade"), solid=False)
    s.add("lighting", [foot, post(0.0, 0.0, (0.04, 1.5), POLE_M, metal), shade])
    return True


def easels(s: Sketch) -> bool:
    """Adds one or two easels with three thin splayed legs across the path."""
    count = int(s.rng.integers(1, 3))
    wood, spread = s.look("wood"), s.uniform(0.34, 0.42)
    for i in range(count):
        y = (i - 0.5 * (count - 1)) * (2.0 * spread + 0.1)
        feet = [(spread * math.cos(a), spread * math.sin(a)) for a in (0.2, 0.2 + math.tau / 3, 0.2 + 2 * math.tau / 3)]
        legs = [rod((x, y_, 0.0), (0.12 * x, 0.12 * y_, 1.45), 0.011, wood) for x, y_ in feet]
        board = box((-0.05, -0.03), (-0.28, 0.28), (0.95, 1.4), s.look("paper"), solid=False)
        s.add("objects", [*legs, board], at=(0.0, y), yaw_rad=s.uniform(0.0, math.tau))
    return True


def trestles(s: Sketch) -> bool:
    """Adds a pair of trestles with spreaders close to the floor."""
    s.align()
    wood, half = s.look("wood"), 0.5 * s.uniform(0.7, 0.9)
    gap = s.uniform(0.7, 0.85)
    for side in (-1, 1):
        y, geoms = side * gap / 2, []
        for x in (-half, half):
            geoms += [rod((x, sy * 0.2, 0.0), (x, sy * 0.02, 0.74), 0.012, wood) for sy in (-1, 1)]
        geoms.append(box((-half, half), (-0.03, 0.03), (0.74, 0.78), wood))
        s.add("furniture", geoms, at=(0.0, y))
    low = (-half, -half + 0.04)
    s.add("objects", [box(low, (-gap / 2 + 0.26, gap / 2 - 0.26), (0.0, 0.06), wood)])
    return True


DESIGNS = (stands, stands, floor_lamp, easels, trestles)


def _stand(look: Look, reach: float, high: float) -> list[Geom]:
    """Returns a coat or music stand: a pole on two crossed flat feet, with hooks at its top."""
    feet = [
        box((-reach, reach), (-0.015, 0.015), (0.02, 0.05), look),
        box((-0.015, 0.015), (-reach, reach), (0.02, 0.05), look),
    ]
    ends = [(reach - 0.02, 0.0), (0.02 - reach, 0.0), (0.0, reach - 0.02), (0.0, 0.02 - reach)]
    glides = [box((x - 0.015, x + 0.015), (y - 0.015, y + 0.015), (0.0, 0.02), look, solid=False) for x, y in ends]
    hooks = [box((-0.14, 0.14), (-0.01, 0.01), (high - 0.05, high - 0.03), look, solid=False)]
    return [*feet, *glides, *hooks, post(0.0, 0.0, (0.05, high), POLE_M, look)]
