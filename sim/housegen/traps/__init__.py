"""Scenes made to hold a robot: what depth cannot see, or sees too late, between the start and the goal."""
