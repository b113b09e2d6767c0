"""How the pieces of a room stand to each other and to its walls: each test furnishes one room with many seeds."""

from __future__ import annotations

import numpy as np
import pytest

from sim.homes.housegen.floor_plan.rectangles import Rect
from sim.homes.housegen.furnishing import furnish
from sim.homes.housegen.furnishing.furniture_source import FurnitureSource
from sim.homes.housegen.furnishing.placement import Placement, RoomLayout
from sim.homes.housegen.furniture.item import Pool
from sim.homes.housegen.structure.openings import Opening

SEEDS = range(12)
POOLS: tuple[Pool, ...] = ("train", "heldout")


def furnished(kind: str, width_m: float, depth_m: float, pool: Pool, seed: int) -> RoomLayout:
    """Returns a room with a doorway in the middle of its west wall and a window in its north wall."""
    rect = Rect(0.0, 0.0, width_m, depth_m)
    openings = (
        Opening("door", 0, 1, "west", 0.0, (0.5 * depth_m - 0.45, 0.5 * depth_m + 0.45), 0.0, 2.05),
        Opening("window", 0, None, "north", depth_m, (0.3 * width_m, 0.7 * width_m), 0.9, 2.1),
    )
    layout = RoomLayout(0, kind, rect, openings, 2.6)
    furnish(layout, FurnitureSource(np.random.default_rng(seed), pool, 0.5, frozenset((kind, "hallway"))))
    return layout


def of(layout: RoomLayout, *names: str) -> list[Placement]:
    return [p for p in layout.placements if p.item.category in names or p.item.name in names]


@pytest.mark.costly
@pytest.mark.parametrize("pool", POOLS)
def test_a_double_bed_has_a_nightstand_and_free_floor_on_both_sides(pool):
    for seed in SEEDS:
        layout = furnished("bedroom", 5.0, 4.4, pool, seed)
        (bed,) = of(layout, "bed")
        assert bed.side is not None
        lo, hi = bed.rect.span(bed.side)
        beside = [p.rect.span(bed.side) for p in of(layout, "nightstand", "side table") if p.side == bed.side]
        assert any(span[1] <= lo for span in beside)
        assert any(span[0] >= hi for span in beside)
        ends = layout.inner.span(bed.side)
        assert min(lo - ends[0], ends[1] - hi) > 0.5


@pytest.mark.costly
@pytest.mark.parametrize("kind", ["living_room", "office", "studio", "bedroom"])
def test_no_shelf_and_no_second_low_table_stands_in_the_middle_of_a_large_room(kind):
    for seed in SEEDS[:6]:
        layout = furnished(kind, 8.0, 6.0, "heldout", seed)
        assert all(shelf.side is not None for shelf in of(layout, "shelving"))
        assert len(of(layout, "coffee table")) <= 1
