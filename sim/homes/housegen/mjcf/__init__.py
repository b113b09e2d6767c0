"""Writes a house as MJCF: geoms of items are merged, get collision shapes, and become an `MjSpec` (builder)."""
