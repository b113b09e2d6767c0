"""Trap scenes: between start and goal is an obstacle that depth does not show, or shows too late."""
