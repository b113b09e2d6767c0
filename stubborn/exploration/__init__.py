"""Explorers choose where to look for the goal while no candidate is known."""
