"""The structure of a home: openings of a floor plan, then walls, floors and ceilings, doors and windows, stairs."""
