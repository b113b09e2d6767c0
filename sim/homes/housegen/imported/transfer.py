"""The transfer test: ten houses in which imported models, kept out of all training, replace our own furniture."""

from __future__ import annotations

from sim.homes.housegen.floor_plan.rooms import PlanKind
from sim.homes.housegen.splits.recipes import Recipe

FIRST_SEED = 50_000
_SHAPES: tuple[tuple[PlanKind, float, tuple[str, ...]], ...] = (
    ("flat", 95.0, ("gym",)),
    ("corridor", 140.0, ("office",)),
    ("loop", 130.0, ("gym", "laundry")),
    ("openplan", 130.0, ()),
    ("split", 150.0, ("office",)),
    ("greatroom", 150.0, ("gym",)),
    ("lshape", 150.0, ("laundry",)),
    ("studio", 58.0, ()),
    ("loop", 180.0, ("office", "gym")),
    ("flat", 120.0, ("office",)),
)
"""Kind of plan, area in square metres, and required rooms beyond the usual ones."""

TRANSFER_TEST: tuple[Recipe, ...] = tuple(
    Recipe(f"transfer_{n:02d}", FIRST_SEED + n, "heldout", kind, area_m2, rooms, movable=False)
    for n, (kind, area_m2, rooms) in enumerate(_SHAPES)
)
"""Recipes of its houses. Where a model is missing, they have held-out styles, which training has not seen either."""
