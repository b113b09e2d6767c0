"""Draws floor plans: rooms as rectangles in rows along corridors, and the connections between them.

A home has one to three wings. A wing is a corridor with a row of rooms on either side. The public rooms (living room,
kitchen, dining room) may form a block at one end of the main wing. The corridor of another wing starts in a gap in one
of the rows of the main wing. A plan is drawn in a frame whose main corridor runs along +x, then mirrored and turned.
"""

from __future__ import annotations

from sim.housegen.floor_plan.drawing import draw_floor_plan
from sim.housegen.floor_plan.plan import FloorPlan, Join, PlanError

__all__ = ["FloorPlan", "Join", "PlanError", "draw_floor_plan"]
