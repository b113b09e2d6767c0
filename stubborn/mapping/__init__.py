"""Map layers from observations: obstacles, collision marks, object scores."""
