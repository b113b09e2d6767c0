"""Pictures of an agent's map and of its current route and goal."""
