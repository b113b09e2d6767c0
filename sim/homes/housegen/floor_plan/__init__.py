"""Draws floor plans: rooms as rectangles in rows along corridors, and the connections between them.

Most kinds have one to three wings (draw_plan.py). A wing is a corridor with a row of rooms on either side. The public
rooms (living room, kitchen, dining room) may form a block at one end of the main wing. The corridor of another wing
starts in a gap in one of the rows of the main wing. The other kinds are `greatroom` (great_room.py: zones of one room
behind partial walls), `split` (split_plan.py: public rooms between two wings), `loop` (chain_plan.py and ring_plan.py:
rooms or corridors lead round a core) and `estate` (ring_plan.py: a ring round a core, with wings). A plan is drawn in a
frame with the main corridor along +x, then mirrored and turned.
"""

from __future__ import annotations

from sim.homes.housegen.floor_plan.draw_plan import draw_floor_plan
from sim.homes.housegen.floor_plan.plan import FloorPlan, Join, PlanError

__all__ = ["FloorPlan", "Join", "PlanError", "draw_floor_plan"]
