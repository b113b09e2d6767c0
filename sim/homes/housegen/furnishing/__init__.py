"""Furnishes rooms (furnish_room): rules by kind of room (room_rules), built from groups and single steps."""

from __future__ import annotations

from sim.homes.housegen.furnishing.furnish_room import FurnishError, furnish

__all__ = ["FurnishError", "furnish"]
