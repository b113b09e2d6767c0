"""Routes over the map, the next action, and the measures against collisions."""
