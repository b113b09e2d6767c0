"""Furnishes rooms: rules by kind of room (room_rules), built from groups of furniture and single steps."""

from __future__ import annotations

from sim.housegen.furnishing.room_rules import furnish

__all__ = ["furnish"]
