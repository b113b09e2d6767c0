"""Explorers choose where to look for the goal while there is no candidate."""
