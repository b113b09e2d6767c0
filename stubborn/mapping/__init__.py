"""From observations to map layers: obstacles, collision marks, object scores."""
