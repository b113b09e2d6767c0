"""Routes over the map: fast marching, the next action, the untrap mode."""
