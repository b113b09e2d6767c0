"""Places hazards of some families on shortest paths between rooms."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from sim.gl import mujoco
from sim.homes.housegen.furniture.item import Look, Pool
from sim.homes.housegen.hazards import doors, glass, legs, loose, overhangs, scans, slabs
from sim.homes.housegen.hazards.floor_map import FloorMap, Path
from sim.homes.housegen.hazards.hazard import Design, PlacedHazard, Sketch
from sim.homes.housegen.structure.openings import Opening
from sim.homes.housegen.surfaces.materials import look

DESIGNS = MappingProxyType[str, tuple[Design, ...]](
    {
        "glass": glass.DESIGNS,
        "slab": slabs.DESIGNS,
        "overhang": overhangs.DESIGNS,
        "legs": legs.DESIGNS,
        "scan": scans.DESIGNS,
        "loose": loose.DESIGNS,
        "door": doors.DESIGNS,
    }
)
"""The designs of each family."""
FAMILIES: tuple[str, ...] = tuple(DESIGNS)
SHARES = MappingProxyType({"glass": 2, "slab": 2, "overhang": 1, "legs": 1, "scan": 2, "loose": 1, "door": 1})
"""Relative number of hazards of each family: more of those that only a collision shows."""
MIN_HAZARDS, MAX_HAZARDS, FLOOR_M2 = 6, 14, 11.0
"""Least and largest number of hazards, and the floor area for each."""
TRIES, TRIES_OF_ONE = 60, 20
"""Places that are tried for one hazard, and for each design that is drawn for it."""
APART_M = 0.8
"""Least distance between hazards."""
FROM_ENDS_M, LOOK_M = 0.4, 0.3
"""Part at either end of a path that is left out, and length over which its direction is measured."""


def draw_hazards(
    rng: np.random.Generator,
    families: Sequence[str],
    pool: Pool,
    spec: mujoco.MjSpec,
    openings: Sequence[Opening],
    count: int | None = None,
) -> tuple[PlacedHazard, ...]:
    """Returns hazards for a house, the families in turn; fewer than `count` if no further place is found.

    Args:
        rng: generator of all random choices.
        families: names of `FAMILIES`.
        pool: pool of the looks.
        spec: the house without hazards; it is not changed.
        openings: its openings.
        count: number of hazards; one for each `FLOOR_M2` when None.
    """
    floor = FloorMap(spec, openings)
    if count is None:
        area_m2 = sum(room.area_m2 for room in floor.rooms)
        count = int(np.clip(round(area_m2 / FLOOR_M2), MIN_HAZARDS, MAX_HAZARDS))
    looks = {"frame": look("metal", rng, pool), "dots": look("paper", rng, pool)}
    placed: list[PlacedHazard] = []
    turns = [family for family in families for _ in range(SHARES[family])]
    order = [turns[int(n)] for n in rng.permutation(len(turns)).tolist()]
    for n in range(count + len(order)):  # another family takes the turn of one that found no place
        hazard = _draw_hazard(rng, order[n % len(order)], pool, looks, floor) if len(placed) < count else None
        if hazard is not None:
            placed.append(hazard)
    return tuple(placed)


def _draw_hazard(
    rng: np.random.Generator, family: str, pool: Pool, looks: Mapping[str, Look], floor: FloorMap
) -> PlacedHazard | None:
    """Returns one hazard of a family on a path; None if no place is found."""
    designs = DESIGNS[family]
    design = designs[0]
    for attempt in range(TRIES):
        if attempt % TRIES_OF_ONE == 0:
            design = designs[int(rng.integers(len(designs)))]
        path = floor.draw_path(rng)
        place = _place_on(rng, path) if path is not None else None
        if place is None:
            continue
        sketch = Sketch(family, *place, rng, pool, looks, floor)
        if not design(sketch):
            continue
        hazard = sketch.finish()
        if floor.try_add(hazard.footprints(), APART_M):
            return hazard
    return None


def _place_on(rng: np.random.Generator, path: Path) -> tuple[float, float, float] | None:
    """Returns a random position on a path and the direction of the path there; None on a path that is too short."""
    along_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    if along_m[-1] < 2.0 * FROM_ENDS_M + 0.2:
        return None
    at_m = float(rng.uniform(FROM_ENDS_M, along_m[-1] - FROM_ENDS_M))
    x, y = (float(np.interp(at_m, along_m, path[:, i])) for i in (0, 1))
    dx, dy = (
        float(np.interp(at_m + LOOK_M, along_m, path[:, i]) - np.interp(at_m - LOOK_M, along_m, path[:, i]))
        for i in (0, 1)
    )
    return round(x, 3), round(y, 3), math.atan2(dy, dx)
